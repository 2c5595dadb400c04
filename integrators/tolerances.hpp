/// What error a run steered by its error may make: relative and absolute tolerances.
#pragma once

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <string>

#include <Eigen/Core>

#include "core/instructions/device_code.hpp"

namespace hmax {

/// The tolerances where none are given: an error of 1e-6 of each number, and of 1e-9 near zero.
inline constexpr double default_rtol = 1e-6, default_atol = 1e-9;

/// Settings of a run steered by its error. Steps are given by their lengths.
/// @tparam AtolT  Real: one absolute tolerance for all components; a vector: one for each, shape (n)
template <class Real, class AtolT = Real>
struct Tolerances {
  Real rtol = static_cast<Real>(default_rtol);         ///< relative, > 0
  AtolT atol = AtolT(default_atol);                    ///< in the units of the state
  Real h_first = 0;                                    ///< 0: chosen from the right-hand side
  Real h_max = std::numeric_limits<Real>::infinity();  ///< longest step; infinity: a tenth of the span
};

/// With an absolute tolerance for each component: ComponentTolerances<double>{1e-6, Eigen::Vector2d(1e-9,
/// 1e-6)}.
template <class Real>
using ComponentTolerances = Tolerances<Real, Eigen::Vector<Real, Eigen::Dynamic>>;

namespace detail {

/// Whether there is an absolute tolerance for each component.
template <class Atol>
inline constexpr bool is_by_component = requires(const Atol& atol) {
  atol[0];
};

/// The absolute tolerance of component i.
template <class Atol>
HMAX_DEVICE auto atol_of(const Atol& atol, Eigen::Index i) {
  if constexpr (is_by_component<Atol>)
    return atol[i];
  else
    return atol;
}

/// The largest absolute tolerance.
template <class Atol>
auto largest_atol(const Atol& atol) {
  if constexpr (is_by_component<Atol>)
    return atol.maxCoeff();
  else
    return atol;
}

}  // namespace detail

/// Checks an absolute tolerance for each component; one number for all is not checked here.
/// @param n  components of the state
/// @throws std::invalid_argument  unless a vector has a positive and finite number for each of them
template <class Atol>
void check_atol(const Atol& atol, Eigen::Index n) {
  if constexpr (detail::is_by_component<Atol>) {
    if (atol.size() != n)
      throw std::invalid_argument("the absolute tolerance has " + std::to_string(atol.size()) +
                                  " components, but the state has " + std::to_string(n) +
                                  "; give one for each");
    for (Eigen::Index i = 0; i < n; ++i)
      if (!(atol[i] > 0) || !std::isfinite(atol[i]))
        throw std::invalid_argument("the absolute tolerance of component " + std::to_string(i) + " is " +
                                    std::to_string(atol[i]) + "; it must be positive and finite");
  }
}

/// The default tolerances for runs from y0: rtol = 1e-6, atol = 1e-9 max |y0_i|, or 1e-9 where y0 = 0. A
/// component that starts at zero is weighed by the size of the others: its own says nothing yet.
template <class State>
auto default_tolerances(const State& y0) {
  using Real = typename Eigen::NumTraits<typename State::Scalar>::Real;
  const Real size = y0.cwiseAbs().maxCoeff();
  return Tolerances<Real>{.atol = static_cast<Real>(default_atol) * (size > 0 ? size : Real(1))};
}

/// The same block by block, for states whose numbers have several units: of (q, v) with n degrees of freedom
/// {n, n}, atol = 1e-9 max |q_i| for positions and 1e-9 max |v_i| for velocities. A block that starts at zero
/// takes the size of the whole y0.
/// @param blocks  the lengths of the blocks in their order
/// @throws std::invalid_argument  where they do not add up to the size of y0, or one is not positive
template <class State>
auto default_tolerances(const State& y0, std::initializer_list<Eigen::Index> blocks) {
  using Real = typename Eigen::NumTraits<typename State::Scalar>::Real;
  if (std::accumulate(blocks.begin(), blocks.end(), Eigen::Index{0}) != y0.size() || std::min(blocks) < 1)
    throw std::invalid_argument("the blocks do not make up the state of " + std::to_string(y0.size()) +
                                " numbers; give lengths that add up to it");
  const Tolerances<Real> whole = default_tolerances(y0);
  ComponentTolerances<Real> tolerances{.rtol = whole.rtol, .atol = {}};
  // Every component first takes the tolerance of the whole state, which blocks of zeros keep.
  tolerances.atol.setConstant(y0.size(), whole.atol);
  Eigen::Index first = 0;
  for (const Eigen::Index length : blocks) {
    const auto block = y0.segment(first, length);
    if (block.cwiseAbs().maxCoeff() > 0)
      tolerances.atol.segment(first, length).setConstant(default_tolerances(block).atol);
    first += length;
  }
  return tolerances;
}

}  // namespace hmax
