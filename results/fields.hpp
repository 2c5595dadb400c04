/// The fields of stored records by name: one list of them makes the table of a store, what is written to it
/// and read from it, and the exports.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace hmax {

template <class Owner>
struct Field {
  std::string_view name;
  std::variant<std::string Owner::*, double Owner::*, std::int64_t Owner::*, bool Owner::*,
               std::vector<double> Owner::*>
      member;
};

/// visit(name, value) of every field of a record, in order.
template <class Record, class Fields, class Visit>
void each_field(Record& record, const Fields& fields, const Visit& visit) {
  for (const auto& field : fields)
    std::visit([&](auto member) { visit(field.name, record.*member); }, field.member);
}

}  // namespace hmax

/// Members under their own names, for the list of a table: {HMAX_FIELDS(Row, outcome, steps), ...}.
#define HMAX_FIELDS(Owner, ...) HMAX_EXPAND(HMAX_EACH(HMAX_FIELD, Owner, __VA_ARGS__))
#define HMAX_FIELD(Owner, name) \
  { #name, &Owner::name }

/// HMAX_EXPAND(HMAX_EACH(of, x, a, b)): of(x, a), of(x, b), for some sixty names.
#define HMAX_EACH(of, x, name, ...) of(x, name) __VA_OPT__(, HMAX_EACH_AGAIN HMAX_PARENS(of, x, __VA_ARGS__))
#define HMAX_EACH_AGAIN() HMAX_EACH
#define HMAX_PARENS ()
#define HMAX_EXPAND(...) HMAX_EXPAND3(HMAX_EXPAND3(HMAX_EXPAND3(HMAX_EXPAND3(__VA_ARGS__))))
#define HMAX_EXPAND3(...) HMAX_EXPAND2(HMAX_EXPAND2(HMAX_EXPAND2(HMAX_EXPAND2(__VA_ARGS__))))
#define HMAX_EXPAND2(...) HMAX_EXPAND1(HMAX_EXPAND1(HMAX_EXPAND1(HMAX_EXPAND1(__VA_ARGS__))))
#define HMAX_EXPAND1(...) __VA_ARGS__
