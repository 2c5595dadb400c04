/// Whether runs of the real code grow: the other side of every prediction.
#pragma once

#include <complex>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace hmax {

/// Takes `steps` steps of size h with a method from a start near a state of rest and shows every state, the
/// first included. False when the run did not reach its end.
/// @param h      [s]
/// @param steps  > 0; steps + 1 states are shown when the run reaches its end
using ShowSteps =
    std::function<bool(double h, std::int64_t steps,
                       const std::function<void(const Eigen::Ref<const Eigen::VectorXd>& y)>& show)>;

/// The distance of a state from rest, in coordinates in which a mode of constant amplitude has a constant
/// distance.
/// The root of the energy is such a distance for an oscillation; |q| alone would swing with the phase.
using Distance = std::function<double(const Eigen::Ref<const Eigen::VectorXd>& y)>;

/// By how much the logarithm of the distance grew between the second and the last quarter of a run, each by
/// its largest distance: oscillation within a quarter takes no part. Infinity when the run broke down,
/// -infinity when nothing was left. Since the first step where the distance is ten thousand times that of
/// before and after it.
/// ln(max over n > 3N/4 of d_n) - ln(max over N/4 < n <= N/2 of d_n), d the distance, N = steps.
/// @param h  [s]
/// @param floor  a distance below this share of the first one is no growth yet
double observed_growth(const ShowSteps& run, const Distance& distance, double h, std::int64_t steps,
                       double floor = 0);

/// Two numbers that say how one motion of a linear model stands, such as its displacement and its velocity,
/// in one unit.
using MotionOf = std::function<Eigen::Vector2d(const Eigen::Ref<const Eigen::VectorXd>& y)>;

/// ln of the factor by which a step of size h multiplies a motion: of the largest |zeta| of the recurrence
///   z_(n+p) + c_(p-1) z_(n+p-1) + ... + c_0 z_n = 0,  p = degree,
/// fitted to the states of a run by least squares. A few steps tell what otherwise shows only after the beats
/// of a motion close to its limit. Infinity when the run broke down; nothing where a state is off the
/// recurrence by more than `disturbance` of the largest beside it.
/// @param degree  of the method in zeta; as many states at the start are left out
/// @param h       [s]
/// @param steps   >= 4 degree
/// @param disturbance  share of the motion, without unit, that other motions may have
std::optional<double> growth_of_recurrence(const ShowSteps& run, const MotionOf& motion, std::size_t degree,
                                           double h, std::int64_t steps, double disturbance = 1e-6);

/// No run that looks for growth is longer.
inline constexpr std::int64_t most_observed_steps = 2'000'000;

/// "a motion that changes sign in every step": what a multiplier other than zero makes of its motion.
std::string motion_in_words(std::complex<double> multiplier);

/// What integration found.
struct ObservedLimit {
  double h = 0;  ///< [s]; infinity when a thousand times the prediction did not grow, 0 when a thousandth did
  std::int64_t steps = 0;    ///< of each of the runs
  bool below_decays = true;  ///< no growth at 0.999 of the prediction
  bool above_grows = true;   ///< growth at 1.001 of it
};

/// What the model and the amplification say of runs close to a limit: how long they have to be.
struct ExpectedGrowth {
  double above = 0;  ///< ln of the factor by which a step at 1.001 of the limit multiplies the motion, > 0
  /// The same at 1 + share / 1000 of the limit, where growth has to be seen; 0: share times `above`.
  double close = 0;
  double beside = 0;  ///< ln of the largest factor below one that a step at the limit multiplies anything by,
                      ///< < 0; -infinity when there is none
  bool linear =
      false;  ///< a double eigenvalue with one eigenvector: growth in proportion to time at the limit
  /// ln of a factor that is growth and not what is seen at the limit itself: little where the distance is
  /// that of one motion, which a step multiplies by one number.
  double visible = 0.02;
  double share = 0.08;  ///< how much of the growth between the quarters at 1.001 of the limit that is
  double fall = 37;  ///< ln of the factor by which what `beside` multiplies has to fall before it is nothing
  double resolution = 1e-6;  ///< to which the limit is sought, relative
  double least = 512;        ///< steps of each run
  std::int64_t most = most_observed_steps;
};

/// How long a run has to be that shows a share of the growth that is expected at 1.001 of the limit, after
/// the rest has died away before the first quarter that is compared, or is outgrown; `least` steps at least,
/// `most` at most. With g = ln of the growth per step at 1 + share / 1000 of the limit: N = 2 t / g for the
/// growth, with t = visible, or ln 4 + visible where it is linear. The rest, exp(fall) times as large at
/// first, is gone after 4 fall / |beside| steps, and outgrown where g N >= fall + t, so that the last quarter
/// holds more than the second: the lesser of the two, and no less than for the growth.
std::int64_t steps_to_see(const ExpectedGrowth& expected);

/// Integrates at 0.999 and at 1.001 of a predicted limit, longer where neither tells, then closes in, by
/// secants and by halves, between a step that does not grow and one that does; away from the prediction where
/// both sides behave alike, so that a wrong prediction is reported with what is true. The runs are as long as
/// steps_to_see() says, and up to 64 times as long where that does not show what is expected.
/// @param run        of the real code, from a start near rest
/// @param predicted  [s], > 0
/// @return  h to expected.resolution of it; 0 or infinity where no change is found within a factor of 1000
ObservedLimit observe_limit(const ShowSteps& run, const Distance& distance, double predicted,
                            const ExpectedGrowth& expected);

/// The growth between the quarters that observed_growth() compares, of runs of so many steps of size h [s].
using GrowthAt = std::function<double(double h, std::int64_t steps)>;
/// The same by another measure of growth.
ObservedLimit observe_limit(const GrowthAt& growth, double predicted, const ExpectedGrowth& expected);

/// The same by growth_of_recurrence(), to 2e-4: runs of a dozen steps.
/// @return  nothing where the motion is not seen to obey a recurrence at one of the steps
std::optional<ObservedLimit> observe_limit_by_recurrence(const ShowSteps& run, const MotionOf& motion,
                                                         std::size_t degree, double predicted,
                                                         double disturbance = 1e-6);

/// The same run without motions that steps multiply by given roots, among which stands the conjugate of each
/// that is not real: shows
///   rest + product of (E - root) d_n,  E d_n = d_(n+1),  d_n = y_n - rest,
/// so many states less as there are roots; other motions are as they were but for constant factors.
/// Each factor (E - root) annihilates c root^n, so that one decaying or neutral motion does not hide the
/// growth of another. Real coefficients need conjugates in pairs.
/// @param roots  zeta at the step h
ShowSteps without_roots(ShowSteps run, Eigen::VectorXd rest,
                        std::function<std::vector<std::complex<double>>(double h)> roots);

/// Whether a run of so many steps at a step far beyond every time scale of the model grows faster than in
/// proportion to its length, which no stable method does.
bool grows_at(const ShowSteps& run, const Distance& distance, double h, std::int64_t steps = 4096);

}  // namespace hmax
