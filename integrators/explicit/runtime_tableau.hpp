/// An explicit Runge-Kutta method read at run time, for example from a user's file.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "integrators/explicit/tableau.hpp"

namespace hmax {

/// Coefficients of any explicit tableau, in the form the stepper asks for (see StaticCoefficients).
/// Invariants, kept by who makes one: a is strictly lower triangular, shape (s, s), row-major; b, b_err
/// and c have shape (s); b_err = b - b_hat is all zero without an embedded method; rows of a sum to c.
struct RuntimeTableau {
  static constexpr int order = 0, error_order = 0;      ///< known only at run time: see computed_order
  static constexpr std::size_t interpolant_degree = 3;  ///< cubic Hermite output
  template <class T>
  using Storage = std::vector<T>;

  std::string name;  ///< of the file or the user, for messages
  /// Shapes (s s), (s), (s), (s).
  std::vector<long double> a, b, b_err, c;
  int computed_order = 0;  ///< of b; at least 1, otherwise the method is not consistent
  int embedded_order = 0;  ///< of b - b_err; 0 without an embedded method
  bool fsal = false;       ///< the last stage is the first of the next step

  [[nodiscard]] std::size_t stages() const { return b.size(); }        ///< s
  [[nodiscard]] bool has_error() const { return embedded_order > 0; }  ///< b_err is not zero
  /// The first i entries of row i of a: those at and above the diagonal are zero.
  [[nodiscard]] std::span<const long double> stage_row(std::size_t i) const {
    return {a.data() + i * b.size(), i};
  }
  [[nodiscard]] std::span<const long double> weights() const { return b; }
  [[nodiscard]] std::span<const long double> error_weights() const { return b_err; }
  [[nodiscard]] long double node(std::size_t i) const { return c[i]; }  ///< c_i
  /// Calls f(i) for the stages 1 .. s-1.
  template <class F>
  void for_each_later_stage(F&& f) const {
    for (std::size_t i = 1; i < b.size(); ++i) f(i);
  }
};

/// Refuses coefficients that do not keep the invariants of RuntimeTableau, or do not reach the orders it
/// names.
/// @throws std::invalid_argument  naming what is wrong
void require_kept(const RuntimeTableau& tableau);

}  // namespace hmax
