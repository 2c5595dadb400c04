/// What the problems of the test set share: parameters by name, checked input, sparse matrices that keep
/// their pattern.
///
/// Beside the verbs of a system each problem has, for whoever lists and runs it: `id`, `note`, `source` (key
/// of references.bib), `stiff`, `t_end`, `Parameters` with `names`, `parameters()`, `states()` (names of the
/// components of y) and `y0()`. Parameters and initial values are doubles in every precision, so that float,
/// double and long double solve the same problem.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "problems/digits.hpp"
#include "problems/linearity.hpp"

namespace hmax {

/// The parameters of a problem by name: `p.*member` reads and writes the value.
template <class Parameters, std::size_t count>
using ParameterNames = std::array<std::pair<std::string_view, double Parameters::*>, count>;

/// The parameters of a problem that has none to choose.
struct NoParameters {
  static constexpr ParameterNames<NoParameters, 0> names{};
};

namespace detail {

/// @throws std::invalid_argument  when a parameter is not finite
template <class Parameters>
const Parameters& finite_parameters(const Parameters& parameters, std::string_view id) {
  for (const auto& [name, member] : Parameters::names)
    if (!std::isfinite(parameters.*member))
      throw std::invalid_argument("parameter " + std::string(name) + " of " + std::string(id) +
                                  " is not a finite number; give it a finite value");
  return parameters;
}

/// @throws std::invalid_argument  unless value > 0
inline void require_positive(double value, std::string_view name, std::string_view id) {
  if (!(value > 0))
    throw std::invalid_argument("parameter " + std::string(name) + " of " + std::string(id) + " is " +
                                shortest_digits(value) + " but must be positive");
}

/// A parameter that counts: how many grid points or masses there are.
/// @throws std::invalid_argument  unless it is a whole number from 1 to ten million
inline Eigen::Index count_of(double value, std::string_view name, std::string_view id) {
  if (!(value >= 1) || !(value <= 1e7) || value != std::floor(value))
    throw std::invalid_argument("parameter " + std::string(name) + " of " + std::string(id) + " is " +
                                shortest_digits(value) + " but must be a whole number from 1 to 10000000");
  return static_cast<Eigen::Index>(value);
}

/// 1 / r^3.
template <class Real>
Real inverse_cube(Real x, Real y) noexcept {
  using std::sqrt;
  const Real square = x * x + y * y;
  return Real(1) / (square * sqrt(square));
}

/// {"q1", "q2", ...}
inline void append_numbered(std::vector<std::string>& names, const std::string& stem, Eigen::Index count) {
  for (Eigen::Index i = 1; i <= count; ++i) names.push_back(stem + std::to_string(i));
}

/// Writes a square sparse matrix of one pattern. The first time, when A is empty, the pattern is built; later
/// only values are written and nothing is allocated.
/// @param n        A has shape (n, n)
/// @param entries  entries(emit) calls emit(row, column, value) for every entry, column after column and in
///                 each column from the top, always in the same order
template <class Real, class Entries>
void write_sparse(Eigen::SparseMatrix<Real>& A, Eigen::Index n, const Entries& entries) {
  if (A.rows() != n || A.cols() != n || A.nonZeros() == 0) {
    std::vector<Eigen::Triplet<Real>> triplets;
    entries([&](Eigen::Index row, Eigen::Index column, Real value) {
      triplets.emplace_back(static_cast<int>(row), static_cast<int>(column), value);
    });
    A.resize(n, n);
    A.setFromTriplets(triplets.begin(), triplets.end());
    return;
  }
  Real* next = A.valuePtr();
  entries([&](Eigen::Index, Eigen::Index, Real value) { *next++ = value; });
}

}  // namespace detail
}  // namespace hmax
