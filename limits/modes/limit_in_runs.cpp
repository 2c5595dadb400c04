#include "limits/modes/limit_in_runs.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "analysis/amplification/amplification.hpp"
#include "limits/modes/mode_start.hpp"

namespace hmax {

namespace {

/// A mode that limits the step, or the shape that does where the steps couple all modes, and what is to be
/// expected of its runs.
struct ModeToWatch {
  double h_max = 0;             ///< the limit that is predicted, of one step of the code [s], > 0
  Complex lambda{};             ///< of the mode [1/s]
  Growth growth{};              ///< what a step makes of it
  bool of_oscillation = false;  ///< `growth` is that of a displacement and a velocity
  bool coupled = false;         ///< a shape: runs begin in others, too
  /// The oscillation where what creeps of it can be told from everything else; else nothing.
  std::optional<MechanicalMode> oscillation{};
  /// Of the recurrence that its displacement and velocity may obey; nothing where they do not.
  std::optional<std::size_t> degree{};
  /// The largest factor below one by which a step of h_max multiplies part of the motion.
  double beside = 0;
  std::int64_t most_steps = 0;  ///< of a run
};

/// The largest |root| that dies away; 0 where none does.
double fading(const std::vector<Complex>& roots) {
  double slowest = 0;
  for (const Complex root : roots)
    if (const double size = std::abs(root); size < 1 - 1e-4) slowest = std::max(slowest, size);
  return slowest;
}

/// What a step makes of a mode of a row: of an oscillation as a whole where it steps positions and
/// velocities.
Growth growth_of(const Method& step, const std::vector<ModeMargin>& modes, const Linearised& near,
                 std::size_t i) {
  if (!step.amplification->of_oscillation) return step.amplification->of_eigenmode(modes.at(i).told);
  return step.amplification->of_oscillation(near.modes.curve ? oscillation_of(near, modes.at(i).mode.lambda)
                                                             : near.modes.spectrum.mechanical.at(i));
}

/// The largest factor below one by which a step of size h multiplies part of the motion of a mode.
double decay_of(const Method& step, const Growth& growth, double h) {
  if (growth.polynomial) return fading(growth.polynomial->roots(h));
  // The roots of a foreign method that looks back are not known: a weakly damped mode may outlast the start.
  return step.amplification->measured && step.steps_back > 0 ? 0.995 : 0;
}

/// The mode that limits a row, as runs from `start` are to show it.
ModeToWatch mode_to_watch(const Prediction& row, const Method& method, const Linearised& near,
                          const ModeStart& start) {
  const Method& step = method.analysed();
  const double h_max = *row.h_max / method.parts;
  ModeToWatch mode{.h_max = h_max, .lambda = row.limiting->lambda, .most_steps = most_steps(near)};
  if (const auto& motion = step.amplification->motion) mode.degree = motion->degree();
  if (row.coupled) {
    mode.growth.polynomial = row.coupled->of_shape;
    mode.of_oscillation = mode.coupled = true;
    mode.oscillation = row.coupled->shape;
    mode.beside = fading(mode.growth.polynomial->roots(h_max));
    return mode;
  }
  mode.of_oscillation = step.amplification->of_oscillation != nullptr;
  const auto at = std::ranges::min_element(
      row.modes, {}, [&](const ModeMargin& margin) { return std::abs(margin.mode.lambda - mode.lambda); });
  const auto i = static_cast<std::size_t>(at - row.modes.begin());
  mode.growth = growth_of(step, row.modes, near, i);
  mode.beside = decay_of(step, mode.growth, h_max);
  // Where the mode is watched alone, nothing else is to be seen beside it.
  for (std::size_t k = 0; !start.mode_alone && k < row.modes.size(); ++k)
    mode.beside = std::max(mode.beside, decay_of(step, growth_of(step, row.modes, near, k), h_max));
  const bool single = near.point.model.y.size() == 2;
  if ((start.mode_alone || single) && mode.growth.polynomial && mode.of_oscillation)
    mode.oscillation = oscillation_of(near, mode.lambda);
  return mode;
}

/// The root by which the motion of a mode goes on, nearest to exp(lambda h); others only methods of several
/// steps have.
std::vector<Complex>::const_iterator principal_root(const std::vector<Complex>& roots, Complex lambda,
                                                    double h) {
  return std::ranges::min_element(roots, {},
                                  [&](Complex root) { return std::abs(root - std::exp(lambda * h)); });
}

/// The logarithm of what a run from the mode shows of its growth at h. The run begins in the principal root;
/// another one begins as small as rounding and has to grow by so much more.
double visible_growth(const ModeToWatch& mode, double h) {
  const double whole = std::log(mode.growth.spectral_radius(h));
  if (!mode.growth.polynomial || mode.of_oscillation) return whole;
  const std::vector<Complex> roots = mode.growth.polynomial->roots(h);
  const auto near = principal_root(roots, mode.lambda, h);
  // Where that root decays, what is left is soon the other one.
  if (std::abs(*near) < 1 - 1e-4 || std::log(std::abs(*near)) > whole / 2) return whole;
  constexpr double from_rounding = 150;  // 2 ln 1e16, beside what is visible
  return whole / from_rounding;
}

/// How runs beside a limit are watched, and what they are expected to show.
struct Watch {
  ExpectedGrowth expected;
  ShowSteps run;
  Distance distance;
};

ObservedLimit observed_limit(const Watch& watch, double h_max) {
  return observe_limit(watch.run, watch.distance, h_max, watch.expected);
}

/// The eigenvalue with which an overdamped oscillation creeps back, beside a fast one; nothing for others.
std::optional<double> creeping(const MechanicalMode& mode) {
  const auto pair = eigenvalues_of(mode);
  if (pair[0].imag() != 0 || pair[0] == pair[1]) return std::nullopt;
  return std::max(pair[0].real(), pair[1].real());
}

/// Where fast damping sets the limit of an oscillation, what creeps fades so slowly that it would be waited
/// for the longest, and hides a growth that begins small: it is taken out, twice, since other modes creep
/// with roots nearby, of which the square of the distance is left.
void take_out_creep(Watch& watch, const ModeToWatch& mode, const Eigen::VectorXd& rest) {
  if (!mode.oscillation) return;
  const std::optional<double> lambda = creeping(*mode.oscillation);
  if (!lambda) return;
  const auto root_of_creep = [polynomial = *mode.growth.polynomial, lambda = *lambda](double h) {
    const std::vector<Complex> roots = polynomial.roots(h);
    return *principal_root(roots, lambda, h);
  };
  const Complex creep = root_of_creep(mode.h_max);
  // Not where it is what grows, and not where it dies away by itself.
  constexpr double soon = 0.9;
  if (creep.real() < soon || std::abs(creep.imag()) > 1e-9) return;
  std::vector<Complex> others = mode.growth.polynomial->roots(mode.h_max);
  others.erase(std::ranges::find(others, creep));
  watch.expected.beside = std::log(fading(others));
  watch.run = without_roots(watch.run, rest, [root_of_creep](double h) {
    return std::vector<Complex>(2, root_of_creep(h).real());
  });
}

/// Runs from the mode, watched by their distance from rest.
Watch watch_all(const ModeToWatch& mode, const ModeStart& start, const ShowSteps& run) {
  const double above = visible_growth(mode, 1.001 * mode.h_max),
               close = visible_growth(mode, (1 + 1e-3 * ExpectedGrowth{}.share) * mode.h_max);
  Watch watch{.expected = {.above = std::max(above, 1e-12),
                           .close = std::max(close, 0.0),
                           .beside = std::log(mode.beside),
                           .linear = start.defective,
                           .most = mode.most_steps},
              .run = run,
              .distance = start.distance};
  if (!mode.coupled) {
    if (start.mode_alone) watch.expected.fall = 10;
    // A mode starts in the only root of a one-step method, and the displacement of an oscillation in both
    // roots of a step that knows no more than it and its velocity: the one that grows is there from the
    // start.
    if (mode.growth.polynomial && (!mode.of_oscillation || mode.lambda.imag() != 0) &&
        mode.growth.polynomial->roots(mode.h_max).size() == (mode.of_oscillation ? 2U : 1U))
      watch.expected.fall = 5;
    // Beats of an oscillation at 0.999 of its limit last a hundred steps.
    if (start.large) {
      watch.expected.least = 256;
      watch.expected.resolution = 2e-4;
    }
  }
  take_out_creep(watch, mode, start.rest);
  return watch;
}

/// Whether runs on both sides of a limit grow and decay like powers of the largest root, as closely as tells
/// one side from the other: neither rounding nor another motion has a visible part in them.
bool is_power(const Watch& watch, const ModeToWatch& mode) {
  const std::int64_t steps = steps_to_see(watch.expected), half = steps / 2;
  return std::ranges::all_of(std::array{0.999 * mode.h_max, 1.001 * mode.h_max}, [&](double h) {
    const double of_root = std::log(mode.growth.spectral_radius(h)) * static_cast<double>(half);
    return std::abs(observed_growth(watch.run, watch.distance, h, steps) - of_root) <=
           0.25 * watch.expected.visible;
  });
}

/// The same watched by the amplitude of the mode alone, of which methods of first order make powers of one
/// root after a while: the least growth shows. Where that is not the principal one, the latter is taken out:
/// what is left has begun as small as the error of the first steps. Nothing where roots do not tell.
std::optional<Watch> watch_amplitude(const ModeToWatch& mode, const ModeStart& start, const ShowSteps& run) {
  if (mode.coupled || (mode.of_oscillation ? !start.motion : !start.amplitude)) return std::nullopt;
  Watch watch = watch_all(mode, start, run);
  if (mode.of_oscillation) {
    const MotionOf motion = start.motion(mode.h_max);
    watch.distance = [motion](const Eigen::Ref<const Eigen::VectorXd>& y) {
      const Eigen::Vector2d z = motion(y);
      return std::hypot(z[0], z[1]);
    };
    return watch;
  }
  watch.distance = start.amplitude;
  watch.expected.visible = 1e-5;
  watch.expected.fall = 20;
  // What a step multiplies by one number shows its growth within a few steps.
  if (start.large) {
    watch.expected.least = 4;
    watch.expected.resolution = 1e-5;
  }
  if (!mode.growth.polynomial) return watch;
  const double h = 1.001 * mode.h_max;
  const std::vector<Complex> roots = mode.growth.polynomial->roots(h);
  const auto principal = principal_root(roots, mode.lambda, h);
  const auto growing = std::ranges::max_element(roots, {}, [](Complex r) { return std::abs(r); });
  double beside = 0;
  for (auto root = roots.begin(); root != roots.end(); ++root)
    if (root != principal && root != growing) beside = std::max(beside, std::abs(*root));
  if (beside > 1 - 1e-4) return std::nullopt;
  watch.expected.above = std::max(std::log(std::abs(*growing)), 1e-12);
  watch.expected.close = 0;
  if (principal == growing) return watch;
  watch.expected.beside = std::log(beside);
  watch.run = without_roots(run, start.rest,
                            [lambda = mode.lambda, polynomial = *mode.growth.polynomial](double step) {
                              const std::vector<Complex> all = polynomial.roots(step);
                              const Complex root = *principal_root(all, lambda, step);
                              return std::vector<Complex>{root, std::conj(root)};
                            });
  watch.expected.visible = ExpectedGrowth{}.visible;
  if (is_power(watch, mode)) return watch;
  // Rounding keeps such a root in motion, by now more, by now less.
  watch.expected.visible = std::log(10.0);
  watch.expected.share = 0.5;
  watch.expected.resolution = 1e-4;
  return watch;
}

/// In the motion of the mode alone; nothing where it is not seen there.
std::optional<ObservedLimit> observe_alone(const ModeToWatch& mode, const ModeStart& start,
                                           const ShowSteps& run) {
  if (mode.degree && start.motion && start.large)
    if (const auto limit = observe_limit_by_recurrence(run, start.motion(mode.h_max), *mode.degree,
                                                       mode.h_max, start.disturbance))
      return limit;
  const std::optional<Watch> watch = watch_amplitude(mode, start, run);
  return watch ? std::optional(observed_limit(*watch, mode.h_max)) : std::nullopt;
}

/// Whether something beside the mode grows below the limit that it shows.
bool others_grow(const ModeToWatch& mode, const ModeStart& start, const ShowSteps& run,
                 const ObservedLimit& shown) {
  const double h = 0.999 * std::min(mode.h_max, shown.h);
  if (!start.large || !start.beside)
    return observed_growth(run, start.distance, h, shown.steps) > ExpectedGrowth{}.visible;
  // Of a large structure as few steps as show a mode that is one percent faster, where positions and
  // velocities are stepped, else ten. Beats of those nearest to the limit last longer, together they do not
  // double the distance.
  constexpr std::int64_t few = 24;
  return observed_growth(run, start.beside, h, few) > std::log(2.0);
}

}  // namespace

std::int64_t most_steps(const Linearised& near) {
  constexpr double most_numbers = 5e7, fewest = 8192;
  const auto states = static_cast<double>(near.point.model.y.size());
  return static_cast<std::int64_t>(
      std::clamp(most_numbers / states, fewest, static_cast<double>(most_observed_steps)));
}

ObservedLimit observe_limit(const Prediction& row, const Method& method, const Linearised& near,
                            const ModeStart& start, const ShowSteps& run) {
  const ModeToWatch mode = mode_to_watch(row, method, near, start);
  const auto alone = observe_alone(mode, start, run);
  if (alone && !others_grow(mode, start, run, *alone)) return *alone;
  return observed_limit(watch_all(mode, start, run), mode.h_max);
}

}  // namespace hmax
