/// A reference solution of the oscillator for any parameters, with a bound of its own error. It shares no
/// code with the methods that are measured against it.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "problems/oscillator/oscillator.hpp"

namespace hmax {

/// Piecewise Taylor polynomials of order 30 in long double on [0, valid_until()]. The step is a fixed
/// fraction of the radius of convergence that the coefficients themselves show. A second computation, of
/// order 24 with half the step, runs beside the first from the same start; their largest difference is the
/// error bound.
/// @source  [jorba2005software]; checked by tests/problems/oscillator/oscillator_reference_test.cpp
class OscillatorReference {
 public:
  using ExtendedState = BasicOscillator<long double>::State;

  /// @param y0     x(0) [m], x'(0) [m/s]
  /// @param t_end  end of the interval [s], finite and not negative
  /// @throws std::invalid_argument  for parameters that are no oscillator, a y0 that is not finite or such a
  /// t_end
  OscillatorReference(const OscillatorParameters& parameters, const Eigen::Vector2d& y0, double t_end);

  /// The end of the interval, or an earlier time: where the solution blows up (the steps shrink to rounding
  /// or the state leaves the range of double), or where the budget of 20000 polynomials is used up (a
  /// self-exciting model whose frequency grows without end).
  double valid_until() const { return valid_until_; }

  /// Whether the reference covers the interval that was asked for.
  bool complete() const { return complete_; }

  /// (x, v) at t; NaN outside [0, valid_until()]. Costs about 100 ns; thread-safe.
  Eigen::Vector2d at(double t) const { return extended_at(t).cast<double>(); }

  /// The same before it is rounded to double.
  ExtendedState extended_at(long double t) const;

  /// Bound of |at(t) - y(t)| in the maximum norm over [0, valid_until()]: four times the largest difference
  /// between the two computations, plus half a unit in the last place of the largest double returned.
  double error_bound() const { return error_bound(valid_until_); }

  /// The same over [0, t] only: tighter where errors grow with the solution.
  double error_bound(double t) const;

 private:
  static constexpr int taylor_order = 30;

  /// y(t) = sum_k coefficients[k] (t - start)^k up to the start of the next piece.
  struct Piece {
    long double coefficients[taylor_order + 1][2];
  };

  std::size_t piece_at(long double t) const;

  std::vector<Piece> pieces_;
  std::vector<long double> starts_;   // of each piece, and the end of the last one
  std::vector<double> bounds_;        // running bound up to the end of each piece
  std::vector<std::uint32_t> cells_;  // equal cells of [0, valid_until]: the piece at the left end of each
  double valid_until_ = 0;
  bool complete_ = false;
};

}  // namespace hmax
