/// What error a run steered by its error may make: relative and absolute tolerances.
#pragma once

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include <Eigen/Core>

namespace hmax {

/// Settings of a run steered by its error. Steps are given by their lengths.
/// @tparam AtolT  Real: one absolute tolerance for all components; a vector: one for each, shape (n)
template <class Real, class AtolT = Real>
struct Tolerances {
  Real rtol;
  AtolT atol;
  Real h_first = 0;  ///< 0: chosen from the right-hand side
  Real h_max = std::numeric_limits<Real>::infinity();
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
auto atol_of(const Atol& atol, Eigen::Index i) {
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

}  // namespace hmax
