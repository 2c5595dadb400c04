#include "problems/oscillator/oscillator_reference.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "problems/digits.hpp"

namespace hmax {
namespace {

using Real = long double;
using State = BasicOscillator<Real>::State;

/// Step over radius of convergence: 0.18^28 = 1e-21, below the rounding of long double.
constexpr Real radius_fraction = 0.18L;
constexpr int check_order = 24;
constexpr std::size_t most_pieces = 20000;
/// A state beyond this overflows as double when it is cubed or squared for an energy.
constexpr Real largest_state = 1e100L;

/// Taylor coefficients of order 0 ... order of the solution through y at t, in the model's own variables:
///   x_(k+1) = v_k / (k+1)
///   v_(k+1) = (P C_k - c v_k - k1 x_k - k3 sum_j x_j u_(k-j)) / (m (k+1)),   u_k = sum_j x_j x_(k-j)
/// with C, S the series of cos(w t) and sin(w t).
void expand(const OscillatorParameters& p, Real t, const State& y, int order, Real (*coefficients)[2]) {
  Real x[32], u[32];
  const Real w = p.w;
  Real v = y[1];
  Real cosine = p.P != 0 ? std::cos(w * t) : 0;
  Real sine = p.P != 0 ? std::sin(w * t) : 0;
  x[0] = y[0];
  coefficients[0][0] = x[0];
  coefficients[0][1] = v;
  for (int k = 0; k < order; ++k) {
    const Real next = static_cast<Real>(k + 1);
    u[k] = 0;
    for (int j = 0; j <= k; ++j) u[k] += x[j] * x[k - j];
    Real cube = 0;
    for (int j = 0; j <= k; ++j) cube += x[j] * u[k - j];
    x[k + 1] = v / next;
    v = (p.P * cosine - p.c * v - p.k1 * x[k] - p.k3 * cube) / (p.m * next);
    const Real cosine_k = cosine;
    cosine = -w * sine / next;
    sine = w * cosine_k / next;
    coefficients[k + 1][0] = x[k + 1];
    coefficients[k + 1][1] = v;
  }
}

State evaluate(const Real (*coefficients)[2], int order, Real s) {
  Real x = coefficients[order][0];
  Real v = coefficients[order][1];
  for (int k = order - 1; k >= 0; --k) {
    x = x * s + coefficients[k][0];
    v = v * s + coefficients[k][1];
  }
  return {x, v};
}

/// The step: a fraction of the radius of convergence by the root test on the last three coefficients, each
/// against the first three (the state itself may be zero while it is being pushed). Infinite when the
/// solution is a polynomial.
Real step_size(const Real (*coefficients)[2], int order) {
  const auto norm = [&](int k) {
    return std::max(std::abs(coefficients[k][0]), std::abs(coefficients[k][1]));
  };
  Real radius = std::numeric_limits<Real>::infinity();
  for (int k = order - 2; k <= order; ++k) {
    if (norm(k) == 0) continue;
    Real estimate = 0;
    for (int j = 0; j < 3; ++j)
      estimate = std::max(estimate, std::pow(norm(j) / norm(k), 1 / static_cast<Real>(k - j)));
    radius = std::min(radius, estimate);
  }
  return radius_fraction * radius;
}

/// The piece at the left end of each of equal cells of [0, end], two for each piece.
/// @param starts  of each piece, and the end of the last one
std::vector<std::uint32_t> cells_over(const std::vector<Real>& starts, Real end) {
  const std::size_t pieces = starts.size() - 1;
  std::vector<std::uint32_t> cells(2 * pieces + 1);
  std::uint32_t piece = 0;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const Real left = end * static_cast<Real>(i) / static_cast<Real>(2 * pieces);
    while (piece + 1 < pieces && starts[piece + 1] <= left) ++piece;
    cells[i] = piece;
  }
  return cells;
}

}  // namespace

OscillatorReference::OscillatorReference(const OscillatorParameters& parameters, const Eigen::Vector2d& y0,
                                         double t_end) {
  const BasicOscillator<double> valid(parameters);
  if (!y0.allFinite())
    throw std::invalid_argument(
        "the initial state of the oscillator is not finite; give two finite numbers x, v");
  if (!(t_end >= 0) || !std::isfinite(t_end))
    throw std::invalid_argument("t_end is " + shortest_digits(t_end) +
                                "; give a finite time that is not negative");

  Real t = 0;
  State y = y0.cast<Real>();
  State check = y;
  Real difference = 0;
  Real largest = 0;
  starts_.push_back(0);
  do {
    if (pieces_.size() == most_pieces || !(y.cwiseAbs().maxCoeff() < largest_state)) break;
    Piece piece;
    expand(parameters, t, y, taylor_order, piece.coefficients);
    const Real h = step_size(piece.coefficients, taylor_order);
    if (!(h > 1e-15L * t) || h == 0) break;
    const bool last = !(t + h < t_end);
    const Real next = last ? static_cast<Real>(t_end) : t + h;
    const State y_next = evaluate(piece.coefficients, taylor_order, next - t);
    if (!y_next.allFinite()) break;

    // The second computation in two half steps; the dense outputs are compared inside the steps too.
    Real inner[check_order + 1][2];
    const Real half = (next - t) / 2;
    for (int i = 0; i < 2; ++i) {
      expand(parameters, t + i * half, check, check_order, inner);
      for (const Real s : {Real(0.25), Real(0.5), Real(0.75), Real(1)}) {
        const State coarse = evaluate(piece.coefficients, taylor_order, (i + s) * half);
        const State fine = evaluate(inner, check_order, s * half);
        difference = std::max(difference, (coarse - fine).cwiseAbs().maxCoeff());
        largest = std::max(largest, coarse.cwiseAbs().maxCoeff());
      }
      check = evaluate(inner, check_order, half);
    }
    pieces_.push_back(piece);
    starts_.push_back(next);
    bounds_.push_back(
        static_cast<double>(4 * difference + largest * (std::numeric_limits<double>::epsilon() / 2)));
    complete_ = last;
    t = next;
    y = y_next;
  } while (!complete_);

  // Rounding down keeps valid_until inside the last piece.
  valid_until_ = static_cast<double>(t);
  if (valid_until_ > t) valid_until_ = std::nextafter(valid_until_, 0.0);

  cells_ = cells_over(starts_, t);
}

/// Bisection between the pieces at both ends of the cell of t: one or two candidates, unless the steps vary
/// wildly.
std::size_t OscillatorReference::piece_at(long double t) const {
  const std::size_t last_cell = cells_.size() - 1;
  const Real end = starts_.back();
  const auto cell = end > 0 ? static_cast<std::size_t>(t / end * static_cast<Real>(last_cell)) : 0;
  // One cell more on either side: the division may round across an edge.
  const std::size_t first = cells_[cell > 0 ? cell - 1 : 0];
  const std::size_t last = cells_[std::min(cell + 2, last_cell)];
  const auto begin = starts_.begin();
  return static_cast<std::size_t>(std::upper_bound(begin + static_cast<std::ptrdiff_t>(first) + 1,
                                                   begin + static_cast<std::ptrdiff_t>(last) + 1, t) -
                                  begin) -
         1;
}

OscillatorReference::ExtendedState OscillatorReference::extended_at(long double t) const {
  if (!(t >= 0 && t <= valid_until_) || pieces_.empty())
    return State::Constant(std::numeric_limits<Real>::quiet_NaN());
  const std::size_t i = piece_at(t);
  return evaluate(pieces_[i].coefficients, taylor_order, t - starts_[i]);
}

double OscillatorReference::error_bound(double t) const {
  if (!(t >= 0 && t <= valid_until_) || pieces_.empty()) return std::numeric_limits<double>::quiet_NaN();
  return bounds_[piece_at(t)];
}

}  // namespace hmax
