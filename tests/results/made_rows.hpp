/// Runs that nobody measured, and what is the same in two records.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "results/row.hpp"

namespace hmax {

/// With all that is neither a time nor an error.
inline Row made_row(const std::string& method, double h, double t_end = 100) {
  Row row;
  row.key = {.problem = "liver_forced",
             .parameters = "m=1.45 c=2",
             .y0 = "0.5,1",
             .method = method,
             .mode = "fixed",
             .control = "none",
             .h = h,
             .t_end = t_end};
  row.outcome = "reached_end";
  row.t_reached = t_end;
  row.steps = std::lround(t_end / h);
  row.rhs = 4 * row.steps;
  return row;
}

/// Bit for bit, except that every NaN is one NaN.
inline bool same_bits(double a, double b) {
  return (std::isnan(a) && std::isnan(b)) ||
         std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}
inline bool same_bits(const std::vector<double>& a, const std::vector<double>& b) {
  return std::ranges::equal(a, b, [](double x, double y) { return same_bits(x, y); });
}
template <class T>
bool same_bits(const T& a, const T& b) {
  return a == b;
}

template <class Record, class Fields>
void expect_same_fields(const Record& a, const Record& b, const Fields& fields) {
  for (const auto& field : fields)
    std::visit([&](auto member) { EXPECT_TRUE(same_bits(a.*member, b.*member)) << field.name; },
               field.member);
}

}  // namespace hmax
