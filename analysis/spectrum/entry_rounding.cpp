#include "analysis/spectrum/entry_rounding.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "problems/matrix_entries.hpp"

namespace hmax {

namespace {

/// Digits of the shortest decimal that reads back as the same number, without zeros at its ends.
int digits_of(double value) {
  std::array<char, 32> text{};
  const auto* end =
      std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::scientific).ptr;
  const auto* exponent = std::find(text.data(), const_cast<char*>(end), 'e');
  return static_cast<int>(std::count_if(static_cast<const char*>(text.data()), exponent,
                                        [](char c) { return c >= '0' && c <= '9'; }));
}

}  // namespace

double entry_rounding(const AnyMatrix& matrix) {
  constexpr int fewest = 6, most = 14;
  int digits = 0;
  each_entry(matrix, [&](Eigen::Index, Eigen::Index, double value) {
    if (digits <= most && std::isfinite(value) && value != 0) digits = std::max(digits, digits_of(value));
  });
  return fewest <= digits && digits <= most ? 0.5 * std::pow(10.0, 1 - digits) : 0;
}

double rounding_of_form(const AnyMatrix& A, double rounding, const Eigen::VectorXd& x) {
  double sum = 0;
  each_entry(A, [&](Eigen::Index i, Eigen::Index j, double value) {
    if (value == 0) return;
    const double decade = std::pow(10.0, std::floor(std::log10(std::abs(value))));
    sum += std::abs(x[i]) * decade * std::abs(x[j]);
  });
  return rounding * sum;
}

}  // namespace hmax
