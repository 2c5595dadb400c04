/// Kinks: states where the slopes of a model jump, as where a stop just touches.
#pragma once

#include <limits>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "catalogue/methods/problem.hpp"
#include "limits/point/operating_point.hpp"

namespace hmax {

/// A component of the state in which f kinks or jumps, and how far to both sides that is seen, in its unit.
struct KinkedComponent {
  Eigen::Index component;
  double reach;
};

enum class KinkPlace {
  at_state,      ///< the slopes jump at the state itself
  within_reach,  ///< or near it, or bend as much: central differences are no Jacobian there
};

/// The components in which the slopes of f on both sides of y differ by more than 1 %, at twice the
/// increments of central differences.
/// @param t     [s]
/// @param y     shape (dim), which is not empty
/// @param size  of the states: below a thousandth of it components are moved as ones of that size
/// @param most  so many at most
/// @cost  two calls of f a component, two more where it bends
std::vector<KinkedComponent> kinks_at(const Problem& problem, double t, const Eigen::VectorXd& y, double size,
                                      KinkPlace place,
                                      std::size_t most = std::numeric_limits<std::size_t>::max());

/// What is said of a limit at a point that is at a kink.
inline constexpr std::string_view at_a_kink =
    "the slopes of the model jump at this state: h_max is the limit of its stiffest side, and motions that "
    "cross the kink may fail at shorter steps";

/// Where the slopes of a model jump at an equilibrium, gives the point the linear model of the side with the
/// largest Jacobian. A Jacobian is that of one side, whichever the code takes.
/// @param problem  that of the point; bodies and what is linear stay as they are
/// @returns whether they jump
bool take_stiffest_side(OperatingPoint& point, const Problem& problem);

}  // namespace hmax
