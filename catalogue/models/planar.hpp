/// Problems of two states in the plane: their field, frozen in time where they are driven, and their orbits.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "analysis/dynamics/basins.hpp"
#include "analysis/dynamics/differences.hpp"
#include "analysis/dynamics/oscillator_lanes.hpp"
#include "analysis/dynamics/phase_plane.hpp"
#include "catalogue/methods/method.hpp"
#include "integrators/tolerances.hpp"
#include "results/table.hpp"

namespace hmax {

/// @throws InputError unless the problem has two states
void require_planar(const Problem& problem);

/// The problem with f as it is at the instant t [s]: autonomous.
Problem frozen(const Problem& problem, double t);

/// The autonomous problem with its time running backwards, y' = -f(y).
Problem reversed(const Problem& problem);

/// f(t, .) and its Jacobian: the problem's own, or differences.
/// @param scale  typical size of both components, for the differences
/// @throws InputError unless the problem has two states
PlanarField planar_field(const Problem& problem, double t, const Eigen::Vector2d& scale);

/// The period of the force [s]: 2 pi / w of the oscillator, or the one that the user names.
/// @throws InputError where nothing is driven and no period is named, where it is not positive, or where f is
///                    not the same one period later
double drive_period(const Problem& problem, std::optional<double> named);

/// The tolerances of stroboscope(), of fate_of_starts(), and of orbits and default windows.
inline constexpr Tolerances<double> stroboscope_tolerances{1e-11, 1e-11}, basin_tolerances{1e-8, 1e-10},
    orbit_tolerances{1e-6, 1e-8};

/// Of motions smaller than this absolute tolerances are shares of the size.
inline constexpr double ordinary_size = 0.01;

/// The largest |y_i| of states that are finite; 0 of none.
template <class State>
double largest_of(const std::vector<State>& states) {
  double largest = 0;
  for (const State& y : states)
    if (y.allFinite()) largest = std::max(largest, y.cwiseAbs().maxCoeff());
  return largest;
}

/// One of these for motions of a size: of a small one the absolute tolerance is that share of it, to one
/// digit.
/// @param size  largest |y_i|, 0 where it is not known
Tolerances<double> tolerances_at(Tolerances<double> tolerances, double size);
/// Of motions in a window, whose size is that of the states at its corners, of the smaller component.
Tolerances<double> tolerances_in(const Window& window, const Tolerances<double>& tolerances);

/// The state one period after a state, see analysis/dynamics/poincare.hpp.
/// @param most_steps  after which a period is taken for one that diverges
VectorFunction stroboscope(const Problem& problem, double period, std::int64_t most_steps = 1'000'000,
                           const Tolerances<double>& tolerances = stroboscope_tolerances);

/// A window for the motions of one period of a driven problem: what of them is known beforehand. It holds the
/// looks, the motion between them, the equilibria that the force at t = 0 leaves, and of the oscillator the
/// largest amplitude A that one harmonic gives, ((k1 - m w^2 + 3/4 k3 A^2)^2 + (c w)^2) A^2 = P^2
/// [nayfeh1979nonlinear].
/// @param looks  of the motion from y0; empty where it diverges
Window window_of_motions(const Problem& problem, const std::vector<Eigen::VectorXd>& looks, double period);

/// What decides the fate of a start: the number of the stable equilibrium it comes to rest at, or a Fate.
/// Runs of dop_853 (radau_iia_5 where the problem is stiff) end as soon as they are trapped, when they have
/// left for a million window sizes, or undecided after the time in which the slowest equilibrium damps
/// twenty times what a trap needs, or the problem's own if that is longer.
/// @param problem     autonomous
/// @param equilibria   of the field; those that are not stable attract nothing
/// @param interrupted  leaves a start undecided once it is true
std::function<int(const Eigen::Vector2d&)> fate_of_starts(const Problem& problem, const Window& window,
                                                          const std::vector<Equilibrium>& equilibria,
                                                          const std::atomic<bool>* interrupted = nullptr);

/// The same for many starts in one call, with the same fates. Runs of the oscillator go side by side, each
/// with its own step control.
/// @param runner  where they go; it changes times, not fates
/// @param ended   called once for each start that has its fate, by whoever calls for the fates
/// @throws InputError where a device does not run the problem
FatesOf fates_of_starts(
    const Problem& problem, const Window& window, const std::vector<Equilibrium>& equilibria,
    const MotionRunner& runner = in_lanes(), const std::function<void()>& ended = [] {});

/// The way from `start` to t_end, every accepted step of a low order at tight tolerance, so dense that it can
/// be drawn as a line. It ends early when it diverges, is two window sizes outside, or has gone far enough to
/// have been seen.
/// Of the window the tolerances are too. Columns as states_with_units().
/// @param length  how far, in sizes of the window
Table orbit(const Problem& problem, const Eigen::Vector2d& start, double t_end, const Window& window,
            double length);

/// The way of a driven motion from one of its looks over a time, wherever it leads. Columns as of orbit().
/// @param looks  of the motion, which tell its size; not empty
Table way_of_motion(const Problem& problem, const std::vector<Eigen::VectorXd>& looks, double time);

/// A window that shows what matters when the user names none: the motion from y0 as long as it is no
/// runaway, and the equilibria within three times its size.
/// @param problem  autonomous
Window default_window(const Problem& problem);

}  // namespace hmax
