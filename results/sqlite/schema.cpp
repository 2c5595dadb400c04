#include "results/sqlite/schema.hpp"

#include <fmt/format.h>

#include "results/advice_record.hpp"
#include "results/limit_row.hpp"
#include "results/row.hpp"
#include "results/sqlite/columns.hpp"

namespace hmax {

namespace {

/// The fields as CREATE TABLE has them.
/// @param number  the type of numbers, none or " REAL"
template <class Fields>
std::string declared(const Fields& fields, std::string_view number = "") {
  const std::string_view types[] = {" TEXT", number, " INTEGER", " INTEGER", " TEXT"};
  std::string text;
  for (const auto& field : fields)
    text += fmt::format("  {}{} NOT NULL,\n", field.name, types[field.member.index()]);
  return text;
}

/// Tables whose rows have a number and a session.
std::string table(std::string_view name, const std::string& columns, const std::string& key) {
  return fmt::format(
      "CREATE TABLE {} (\n  id INTEGER PRIMARY KEY AUTOINCREMENT,\n  session INTEGER NOT NULL REFERENCES sessions(id),\n"
      "{}  digest TEXT NOT NULL,\n  UNIQUE ({})\n);\n",
      name, columns, key);
}

}  // namespace

std::string store_schema() {
  const std::string point = declared(point_key_fields, " REAL"),
                    question = declared(advice_key_fields, " REAL"),
                    names_of_question = sqlite::joined("", "", ", ", advice_key_fields);
  return R"sql(
CREATE TABLE notes (
  key TEXT NOT NULL PRIMARY KEY,
  value TEXT NOT NULL,
  digest TEXT NOT NULL
);
CREATE TABLE sessions (
  id INTEGER PRIMARY KEY AUTOINCREMENT,
  started TEXT NOT NULL,
  fingerprint TEXT NOT NULL,
  digest TEXT NOT NULL
);
)sql" + table("rows", declared(row_key_fields, " REAL") + declared(row_fields), std::string(order_of_rows)) +
         table("operating_points", point + "  document TEXT NOT NULL,\n",
               sqlite::joined("", "", ", ", point_key_fields)) +
         table("limits",
               "  point INTEGER NOT NULL REFERENCES operating_points(id),\n" + declared(limit_fields),
               "point, method") +
         table("advice", question + declared(advice_fields), names_of_question + ", method, options") +
         table("scenes", question + "  scene TEXT NOT NULL,\n", names_of_question) +
         table("answers", question + "  words TEXT NOT NULL,\n", names_of_question);
}

}  // namespace hmax
