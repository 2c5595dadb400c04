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
