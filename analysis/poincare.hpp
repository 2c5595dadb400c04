/// The stroboscopic view of a driven system: its state once in each period of the force, as it showed the
/// chaos of Duffing's equation [ueda1979randomly].
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "analysis/differences.hpp"
#include "integrators/control.hpp"
#include "integrators/controller.hpp"
#include "integrators/explicit_rk.hpp"
#include "integrators/integrate.hpp"
#include "integrators/tableaux.hpp"

namespace hmax {

/// y -> P(y), the state one period after y; f(t + period, .) = f(t, .), so that every look is the same map
/// and no phase is lost in a long run. NaN where the motion diverges. The order 8 of dop_853, each period
/// ending exactly at its end; the system is copied.
/// @param period     [s], positive
/// @param tolerance  relative and absolute, of each step
template <System S>
VectorFunction period_map(S system, double period, double tolerance = 1e-11) {
  return [system = std::move(system), period, tolerance](const Eigen::VectorXd& from) -> Eigen::VectorXd {
    using State = typename S::State;
    constexpr std::int64_t most_steps = 1'000'000;
    State y = from;
    const auto end =
        integrate(Rk<tableaux::Dop853, State>{}, system, Span<double>{0, period}, y,
                  Adaptive<double, DeadbandController>({tolerance, tolerance}, tableaux::Dop853::error_order),
                  ObserveNothing{}, most_steps);
    if (end.outcome != Outcome::reached_end) y.setConstant(std::numeric_limits<double>::quiet_NaN());
    return y;
  };
}

/// P^skip(y), P^(skip + 1)(y), ...: `count` looks after `skip` that are not kept; fewer when one is not
/// finite.
/// @throws std::invalid_argument when skip or count is negative
std::vector<Eigen::VectorXd> looks(const VectorFunction& map, Eigen::VectorXd y, int skip, int count);

/// The smallest p such that every look equals the one p looks later, to `tolerance` of the largest |y_i| and
/// 1e-12; nothing when there is none up to a quarter of the looks.
std::optional<int> period_of(const std::vector<Eigen::VectorXd>& looks, double tolerance = 1e-6);

/// The largest Lyapunov exponent of the orbit through y, per application of the map: the mean logarithm by
/// which a small separation grows, brought back to its size after each. Positive in chaos. NaN when the orbit
/// diverges. [benettin1976kolmogorov]
/// @param scale  shape (n), positive: the size of the motion
double largest_lyapunov(const VectorFunction& map, Eigen::VectorXd y, const Eigen::VectorXd& scale,
                        int count);

/// What is seen at one value of a parameter.
struct BifurcationColumn {
  double value;
  std::vector<Eigen::VectorXd> looks;  ///< fewer than asked for when the motion diverges
  std::optional<int> period;           ///< in looks
};

/// Looks for each value of a parameter.
/// @param map_at  the period map of a value
/// @param follow  each value starts where the one before has ended, instead of at y0: the branch is followed
/// @param going   called with the share that is done; the diagram ends early when it returns false
std::vector<BifurcationColumn> bifurcation(const std::function<VectorFunction(double)>& map_at,
                                           const std::vector<double>& values, const Eigen::VectorXd& y0,
                                           int skip, int count, bool follow,
                                           const std::function<bool(double)>& going = {});

}  // namespace hmax
