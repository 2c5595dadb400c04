#include <algorithm>
#include <chrono>
#include <cmath>

#include "analysis/foreign_steps/probe.hpp"
#include "core/numbers.hpp"

namespace hmax {
namespace {

/// ln of the growth that runs show for certain.
constexpr double seen_growth = 15;
/// Of disturbances where the step jumps, in units of scales.
constexpr double jump_amplitude = 1e-4;
/// Between h_max and observed, as a share of h_max.
constexpr double allowed_gap = 0.05, allowed_gap_of_motion = 0.2;

}  // namespace

/// As many as found_.steps, but not so many that a creep of the model is seen.
std::int64_t StepProbe::steps_of_run(double h) const {
  const double most = creep_ > 0 ? std::log(4.0) / (creep_ * h) : infinity;
  return most < static_cast<double>(found_.steps) ? static_cast<std::int64_t>(std::ceil(most)) : found_.steps;
}

GrowthRun StepProbe::growth_run(double h) const {
  // As far as the step is linear, and above its rounding.
  const double increment = found_.rows.front().increment,
               amplitude =
                   is_single() ? std::clamp(increment / 5, 3e-5, 1e-3) : std::clamp(increment, 1e-7, 1e-6);
  GrowthRun run{.steps = found_.state == ProbedState::motion ? steps_of_motion(h) : steps_of_run(h),
                .amplitude = amplitude,
                .bound = is_single() ? 100 * amplitude : 1e5 * amplitude,
                .most = is_single() ? 30.0 : 1e4,
                .follow = found_.state != ProbedState::equilibrium || rest_ != start_,
                .watch = watcher()};
  if (found_.smoothness == StepSmoothness::jump) {
    // Beyond what the jumps make of it.
    run.amplitude = jump_amplitude;
    run.bound = run.most = 1e3;
    run.bound *= jump_amplitude;
    run.follow = true;
  }
  return run;
}

bool StepProbe::runs_grow(double h) {
  share_ = std::min(0.99, share_ + 0.02);
  detail_ = "runs with h = " + rounded_text(h, 5) + " s";
  if (found_.state != ProbedState::motion)
    return run_grows(engine_, coordinates_, scale_, at_rest, h, growth_run(h));
  const auto growth = [&](double size) {
    return growth_of_run(engine_, coordinates_, scale_, home, size, growth_run(size));
  };
  if (std::isnan(base_run_)) base_run_ = std::max(0.0, growth(settings_.h0));
  const double here = growth(h);
  return !std::isfinite(here) || here > 1.5 * base_run_ + least_growth;
}

/// The elapsed time of a step of h0: the least of some, since other programs may run in between.
double StepProbe::seconds_of_step() {
  using Clock = std::chrono::steady_clock;
  constexpr int steps = 10;
  double least = infinity, spent = 0;
  for (int sample = 0; sample < 5 && spent < 0.1; ++sample) {
    engine_.restore(home);
    const auto begin = Clock::now();
    engine_.step(settings_.h0, steps);
    const double seconds = std::chrono::duration<double>(Clock::now() - begin).count();
    spent += seconds;
    least = std::min(least, seconds / steps);
  }
  return least;
}

/// Long enough that growth at 1.002 of the limit is seen, and not longer than the time allows.
std::int64_t StepProbe::observed_steps() {
  constexpr double least = 400, most = 2e6;
  const double affordable = std::clamp(settings_.seconds_a_run / seconds_of_step(), least, most);
  if (found_.smoothness != StepSmoothness::smooth || !std::isfinite(found_.h_max))
    return static_cast<std::int64_t>(std::min(affordable, 20000.0));
  const double rate = std::log(found_.critical->spectral_radius);
  return std::llround(std::clamp(rate > 0 ? 10 / rate : infinity, least, affordable));
}

void StepProbe::narrow(double low, double high, double resolution) {
  while (high - low > resolution * high) {
    const double middle = (low + high) / 2;
    (runs_grow(middle) ? high : low) = middle;
  }
  found_.observed = (low + high) / 2;
}

/// A step size a little beyond h_max; at a kink, where growth comes in windows, the one that was seen to
/// grow.
double StepProbe::beyond_limit() const {
  double least = infinity;
  for (const StepSpectrum& row : found_.rows)
    if (row.grows && row.h > found_.h_max) least = std::min(least, row.h);
  const double usual = 1.002 * found_.h_max;
  return found_.smoothness == StepSmoothness::kink ? std::min(least, usual) : usual;
}

void StepProbe::contradict_at_least() {
  contradict("grow at h0 already", "runs grow at h0 already, though no multiplier does; take a smaller h0");
}

/// From a little on both sides of h_max away from it.
void StepProbe::bracket(double low, double high) {
  for (double away = 0.004; runs_grow(low); away *= 2) {
    high = low;
    low = found_.h_max * (1 - away);
    if (low < settings_.h0 / 2) {
      found_.observed = nan;
      return contradict_at_least();
    }
  }
  for (double away = 0.004; !runs_grow(high); away *= 2) {
    if (high >= settings_.h1) {
      found_.observed = infinity;
      return;
    }
    low = high;
    high = std::min(settings_.h1, found_.h_max * (1 + away));
  }
  narrow(low, high, settings_.resolution);
}

/// Where multipliers grow at h0 already, or nowhere.
void StepProbe::observe_beyond_limits() {
  if (std::isinf(found_.h_max)) {
    found_.observed = infinity;
    if (!runs_grow(settings_.h1)) return;
    found_.observed = nan;
    if (runs_grow(settings_.h0)) return contradict_at_least();
    narrow(settings_.h0, settings_.h1, 0.01);
    const std::string grow = "grow from " + rounded_text(found_.observed, 3) + " s on";
    return contradict(grow, "multipliers and runs contradict each other: runs of " +
                                std::to_string(found_.steps) + " steps " + grow +
                                ", though no multiplier does; use steps below that");
  }
  if (found_.state == ProbedState::motion || !std::isfinite(found_.rows.front().spectral_radius)) return;
  const double rate = std::log(found_.rows.front().spectral_radius);
  if (rate * static_cast<double>(found_.steps) > seen_growth && !runs_grow(settings_.h0))
    contradict("do not grow at h0", "multipliers and runs contradict each other: a multiplier grows by " +
                                        rounded_text(rate, 2) + " a step of h0, and runs of " +
                                        std::to_string(found_.steps) + " steps do not grow");
}

/// Where the step jumps runs are all there is. What a jump moves is no smaller for a smaller disturbance: the
/// scales are those of the scene, not those that balance differences.
void StepProbe::observe_jumping() {
  if (found_.state != ProbedState::equilibrium) {
    found_.steps = 0;
    found_.status.push_back(
        "near runs of a motion separate at each jump, so that no run tells where steps grow");
    return;
  }
  scale_ = plain_scale();
  constexpr int sizes = 24;
  double low = 0;
  found_.observed = infinity;
  for (int i = 0; i < sizes; ++i) {
    const double h =
        settings_.h0 * std::pow(settings_.h1 / settings_.h0, static_cast<double>(i) / (sizes - 1));
    if (runs_grow(h)) {
      if (low > 0) return narrow(low, h, 0.01);
      found_.observed = nan;
      found_.status.push_back("such runs grow at h0 already");
      return;
    }
    low = h;
    if (settings_.h1 == settings_.h0) return;
  }
}

/// Whether h_max and observed can both be true.
void StepProbe::compare_with_runs() {
  if (!std::isfinite(found_.h_max) || std::isnan(found_.observed)) return;
  const double shown = std::min(found_.observed, settings_.h1), gap = shown / found_.h_max - 1;
  const bool is_motion = found_.state == ProbedState::motion;
  if (std::abs(gap) <= 0.005) return;
  const std::string runs = is_motion ? "runs" : "runs of " + std::to_string(found_.steps) + " steps";
  const std::string until =
      (std::isinf(found_.observed) ? "not up to " : "at ") + rounded_text(shown, 4) + " s";
  if (gap > 0 && found_.smoothness == StepSmoothness::kink) {
    // Runs begin in one direction, and differences in four.
    found_.status.push_back("at this kink growth begins at " + rounded_text(found_.h_max, 4) +
                            " s by one-sided differences, and " + until + " by " + runs +
                            ", which begin with one disturbance; use the smaller one");
    return;
  }
  if (gap > 0 && found_.state == ProbedState::equilibrium) {
    const double middle = (found_.h_max + shown) / 2, rate = std::log(at(middle).spectral_radius);
    if (rate * static_cast<double>(steps_of_run(middle)) < seen_growth) {
      found_.contradiction = gap > allowed_gap && creep_ == 0;
      found_.status.push_back("undecided between " + rounded_text(found_.h_max, 4) + " s and " +
                              rounded_text(shown, 4) + " s: a multiplier grows by " + rounded_text(rate, 2) +
                              " a step between them, which " + runs + " do not show; use the smaller one");
      return;
    }
  }
  if (std::abs(gap) <= (is_motion ? allowed_gap_of_motion : allowed_gap)) return;
  contradict((std::isinf(found_.observed) ? "do not grow up to " : "grow from ") + rounded_text(shown, 4) +
                 (std::isinf(found_.observed) ? " s" : " s on") + "; use the smaller limit",
             "multipliers and runs contradict each other: growth begins at " + rounded_text(found_.h_max, 4) +
                 " s by multipliers, and " + until + " by " + runs + "; use the smaller one");
}

void StepProbe::observe() {
  found_.observed = found_.gap = nan;
  if (!settings_.observe) return;
  share_ = std::max(share_, 0.6);
  detail_ = "runs";
  found_.steps = found_.state == ProbedState::motion ? 0 : observed_steps();
  engine_.restore(home);
  if (rest_ != start_) engine_.set_state(rest_);
  engine_.save(at_rest);
  if (found_.smoothness == StepSmoothness::jump) return observe_jumping();
  if (!std::isfinite(found_.h_max)) return observe_beyond_limits();
  found_.steps = found_.state == ProbedState::motion ? 0 : steps_of_run(found_.h_max);
  bracket(0.998 * found_.h_max, std::min(settings_.h1, beyond_limit()));
  found_.gap = (found_.observed - found_.h_max) / found_.h_max;
  if (!std::isfinite(found_.gap)) found_.gap = nan;
  compare_with_runs();
}

/// Multipliers may hide slow growth among others of modulus 1; where runs agree with h_max there is none to
/// speak of.
void StepProbe::say_what_is_unresolved() {
  const bool agree = std::isinf(found_.h_max) ? std::isinf(found_.observed) : std::abs(found_.gap) < 0.01;
  if (agree || std::isnan(found_.h_max)) return;
  double first = infinity, unseen = 0;
  for (const StepSpectrum& row : found_.rows) {
    if (row.resolved) continue;
    first = std::min(first, row.h);
    unseen = std::max(unseen, row.tolerance);
  }
  if (std::isinf(first)) return;
  found_.status.push_back("undecided between " + rounded_text(first, 3) + " s and " +
                          rounded_text(std::min(found_.h_max, settings_.h1), 3) +
                          " s: many multipliers have modulus 1, and growth of less than " +
                          rounded_text(unseen, 2) + " a step is not seen among them" +
                          (settings_.observe ? "" : "; let the engine run"));
}

}  // namespace hmax
