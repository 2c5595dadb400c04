#include "analysis/foreign_steps/step_probe.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "analysis/dynamics/growth.hpp"
#include "analysis/foreign_steps/hidden_state.hpp"
#include "analysis/foreign_steps/observed_steps.hpp"
#include "analysis/foreign_steps/slow_motions.hpp"
#include "analysis/foreign_steps/step_derivative.hpp"
#include "core/dense_solvers.hpp"
#include "core/errors.hpp"
#include "core/numbers.hpp"

namespace hmax {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr int home = 0, work = 1, at_rest = 2;
/// A motion that grows by less than this factor more than at h0 is no growth of the steps.
const double least_growth = std::log(10.0);

/// ln of the growth that runs show for certain.
constexpr double seen_growth = 15;
/// Between h_max and observed, as a share of h_max.
constexpr double allowed_gap = 0.05, allowed_gap_of_motion = 0.2;

/// What all parts of a probe need.
class Probe {
 public:
  Probe(ForeignStepper& engine, const ProbeSettings& settings)
      : engine_(engine), settings_(settings), coordinates_(engine.dim(), engine.quaternions()) {}

  ProbedLimit run();
  ProbedLimit compare();

 private:
  void look_at_start();
  bool only_trembles(double moved);
  void judge_start();
  VectorXd balanced(const VectorXd& unbalanced, double h);
  void choose_scales(double h);
  void check_smoothness();
  void find_limit();
  double distance_of_step(const VectorXd& y, double h);
  struct Rest {
    VectorXd y;
    double left = 0;   ///< how far a step of h moves it, in units of scales
    double error = 0;  ///< about how far it is from rest
  };
  Rest rest_near(VectorXd y, double h, double tolerance);
  VectorXd rest_at(double h);
  StepSpectrum spectrum_near(const VectorXd& y, double h);
  StepSpectrum at(double h);
  void look_where_it_settles(StepSpectrum& row);
  StepSpectrum along_motion(double h);
  void bisect(double low, double high);
  void explain_growth_at_least();
  void check_rest_at_limit();
  void check_pattern();
  void name_growing_numbers();
  void find_shares();
  void observe();
  bool runs_grow(double h);
  std::int64_t observed_steps();
  void bracket(double low, double high);
  void narrow(double low, double high, double resolution);
  void compare_with_runs();
  void observe_beyond_limits();
  void say_what_is_unresolved();
  void compare_rests();
  void say_what_steps_show();
  /// One of the two limits is wrong.
  void contradict(const std::string& text) {
    found_.contradiction = true;
    found_.status.push_back(text);
  }

  /// Sizes of numbers at the start.
  [[nodiscard]] VectorXd plain_scale() const {
    return coordinates_.scales(engine_.scales().size() > 0 ? engine_.scales() : scales_of(start_));
  }
  /// Between two states, in units of scales.
  [[nodiscard]] double distance(const VectorXd& a, const VectorXd& b) const {
    return coordinates_.of(a, b).cwiseQuotient(scale_).cwiseAbs().maxCoeff();
  }
  [[nodiscard]] double rest_tolerance() const { return is_single() ? 1e-6 : 1e-9; }
  [[nodiscard]] bool is_single() const { return engine_.is_single_precision(); }
  void tell(double share, std::string_view detail) const {
    if (settings_.watch) settings_.watch(share, detail);
  }
  [[nodiscard]] std::function<void()> watcher() const {
    return [this] { tell(share_, detail_); };
  }
  [[nodiscard]] GrowthRun growth_run(double h) const;
  [[nodiscard]] std::int64_t steps_of_motion(double h) const {
    return std::max<std::int64_t>(1, std::llround(*settings_.motion / h));
  }

  ForeignStepper& engine_;
  const ProbeSettings& settings_;
  StateCoordinates coordinates_;
  VectorXd start_, scale_;
  VectorXd rest_;  // at the step size that was last looked at
  VectorXd settled_;
  std::vector<StepMotion> slow_;  // of h0
  bool compares_ = false;
  StepPattern pattern_;
  ProbedLimit found_;
  double base_growth_ = 0, base_run_ = nan;
  bool is_linear_ = true;
  double share_ = 0;
  std::string detail_ = "steps";
};

void Probe::look_at_start() {
  start_ = engine_.state();
  if (!start_.allFinite()) {
    Index bad = 0;
    while (std::isfinite(start_[bad])) ++bad;
    throw InputError("number " + std::to_string(bad) + " of the state at the start is not finite");
  }
  rest_ = settled_ = start_;
  engine_.save(home);
  for (const Index first : engine_.quaternions())
    if (std::abs(start_.segment<4>(first).norm() - 1) > 1e-3)
      throw InputError("the quaternion at number " + std::to_string(first) + " of the state has length " +
                       rounded_text(start_.segment<4>(first).norm(), 3) + " instead of 1");
  scale_ = plain_scale();
  if (const Eigen::SparseMatrix<double> declared = engine_.pattern(); declared.size() > 0)
    pattern_ = StepPattern(coordinates_.pattern(declared));
  if (!engine_.after(home, start_, settings_.h0, 1).allFinite())
    throw InputError("a step of h0 from the start is not finite; take a smaller h0");
  if (settings_.motion) found_.state = ProbedState::motion;
  const std::vector<std::string> remarks =
      examine_hidden_state(engine_, coordinates_, scale_, home, start_, settings_.h0)
          .remarks(is_single() ? 1e-4 : 1e-8, engine_.has_hidden_state());
  found_.status.insert(found_.status.end(), remarks.begin(), remarks.end());
}

/// Whether a hundred steps go hardly farther than one: what a solver leaves, or the end of an oscillation.
bool Probe::only_trembles(double moved) {
  if (moved > (is_single() ? 1e-2 : 1e-6)) return false;
  const VectorXd later = engine_.after(home, start_, settings_.h0, 100);
  return later.allFinite() && distance(start_, later) <= 3 * moved;
}

void Probe::judge_start() {
  if (settings_.motion) return;
  const VectorXd next = engine_.after(home, start_, settings_.h0, 1);
  const double moved = distance(start_, next);
  found_.state = ProbedState::equilibrium;
  if (moved <= (is_single() ? 1e-5 : 1e-9) || only_trembles(moved)) return;
  // Engines whose solvers end early rest elsewhere at each step size, perhaps near.
  rest_ = rest_at(settings_.h0);
  const VectorXd away = coordinates_.of(start_, rest_).cwiseQuotient(plain_scale());
  if (rest_ != start_ && away.cwiseAbs().maxCoeff() < 0.1) return;
  rest_ = start_;
  found_.state = ProbedState::initial;
  Index most = 0;
  coordinates_.of(start_, next).cwiseQuotient(scale_).cwiseAbs().maxCoeff(&most);
  const Index i = coordinates_.component(most);
  found_.status.push_back("the state is no equilibrium, a step of h0 changes its number " +
                          std::to_string(i) + " by " + rounded_text(next[i] - start_[i], 2) +
                          ": h_max is that of this state; give the length of a motion to follow it");
}

/// The same scales in balance: of like size in positions and velocities, from what a step of size h makes of
/// them.
VectorXd Probe::balanced(const VectorXd& unbalanced, double h) {
  StepDerivative derivative(engine_, coordinates_, unbalanced, home, start_, h);
  if (!derivative.is_finite() || !std::isfinite(derivative.error())) return unbalanced;
  const VectorXd factors =
      coordinates_.size() > settings_.spectrum.matrix_to
          ? balancing_factors([&](const VectorXd& v) { return derivative.product(v); }, coordinates_.size())
          : balancing_factors(derivative.confirmed_matrix(
                pattern_, [this](double share) { tell(share_ + 0.02 * share, "first differences"); }));
  if (!factors.allFinite()) return unbalanced;
  VectorXd scale = unbalanced.cwiseProduct(factors.cwiseMax(1e-8));
  if (!is_single()) return scale;
  // In float numbers are moved by a good part of their size, or hardly at all.
  const VectorXd size = coordinates_.scales(start_.cwiseAbs());
  std::vector<double> parts;
  for (Index k = 0; k < scale.size(); ++k)
    if (size[k] > 0.01 * size.maxCoeff()) parts.push_back(scale[k] / size[k]);
  if (parts.empty()) return scale;
  const auto middle = parts.begin() + static_cast<std::ptrdiff_t>(parts.size() / 2);
  std::ranges::nth_element(parts, middle);
  return (scale / *middle).cwiseMax(0.01 * size);
}

void Probe::choose_scales(double h) {
  const VectorXd unbalanced = plain_scale();
  const VectorXd before = scale_;
  scale_ = balanced(unbalanced, h);
  if (!is_single()) return;
  // In float a velocity of what seems its size moves a position by less than the last place. The scales with
  // the least error.
  const VectorXd size = coordinates_.scales(start_.cwiseAbs());
  const double largest = size.maxCoeff();
  double least = StepDerivative(engine_, coordinates_, scale_, home, start_, h).error();
  for (const double more : {1.0, 30.0, 1000.0}) {
    VectorXd tried = unbalanced;
    for (Index k = 0; k < tried.size(); ++k)
      if (size[k] < 0.01 * largest) tried[k] *= more;
    tried = more > 1 ? balanced(tried, h) : before;
    const StepDerivative derivative(engine_, coordinates_, tried, home, start_, h);
    if (!derivative.is_finite() || !(derivative.error() < least)) continue;
    least = derivative.error();
    scale_ = tried;
  }
}

/// Whether a step near the limit has a derivative that tells what it does.
void Probe::check_smoothness() {
  if (found_.state == ProbedState::motion) return;
  const double h = std::isfinite(found_.h_max) ? 0.9 * found_.h_max : settings_.h0;
  const StepDerivative derivative(engine_, coordinates_, scale_, home, rest_, h);
  if (!derivative.is_finite()) return;
  if (derivative.error() > 0.01)
    found_.status.push_back("differences of the step at two increments differ by " +
                            rounded_text(derivative.error(), 2) +
                            ": the step is not smooth at this state, as at a contact that opens");
  else if (!(is_linear_ = derivative.is_linear()))
    found_.status.push_back(
        "the changes of two small disturbances do not add up: the step is not smooth at this state, as with "
        "impulses that are bounded; h_max says nothing, trust observed");
}

StepSpectrum Probe::along_motion(double h) {
  const std::int64_t steps = steps_of_motion(h);
  const double increment = is_single() ? 1e-3 : 1e-6;
  const double growth =
      growth_along_motion(engine_, coordinates_, scale_, home, work, h, steps, increment, watcher());
  StepSpectrum row;
  row.h = h;
  row.increment = increment;
  row.multiplier = {nan, nan};
  row.spectral_radius = std::exp(growth / static_cast<double>(steps));
  row.tolerance = least_growth / static_cast<double>(steps);
  row.motion = VectorXd::Zero(engine_.dim());
  if (found_.rows.empty()) base_growth_ = std::max(0.0, growth);
  row.grows = !std::isfinite(growth) || growth > 1.5 * base_growth_ + least_growth;
  return row;
}

/// How far a step of size h moves y, in units of scales.
double Probe::distance_of_step(const VectorXd& y, double h) {
  const VectorXd next = engine_.after(home, y, h, 1);
  return next.allFinite() ? distance(y, next) : infinity;
}

/// y = S(y) by Newton's method, (I - J) x = S(y) - y, of least norm where motions are free.
Probe::Rest Probe::rest_near(VectorXd y, double h, double tolerance) {
  const Index n = coordinates_.size();
  Rest rest{.y = std::move(y)};
  rest.left = rest.error = distance_of_step(rest.y, h);
  for (int k = 0; k < 10 && rest.left > tolerance && std::isfinite(rest.left); ++k) {
    StepDerivative derivative(engine_, coordinates_, scale_, home, rest.y, h);
    const VectorXd step = coordinates_.of(rest.y, derivative.next()).cwiseQuotient(scale_);
    const std::optional<Eigen::SparseMatrix<double>> grouped =
        pattern_.pays() ? derivative.grouped_matrix(pattern_) : std::nullopt;
    const Eigen::MatrixXd J = grouped ? Eigen::MatrixXd(*grouped) : derivative.matrix(pattern_);
    rest.error = infinity;
    if (!J.allFinite()) break;
    const Eigen::MatrixXd A = Eigen::MatrixXd::Identity(n, n) - J;
    const double threshold = std::max(1e-12, derivative.error() / A.norm());
    const VectorXd x = minimum_norm_solution(A, step, threshold);
    rest.error = x.cwiseAbs().maxCoeff();
    const VectorXd tried = coordinates_.at(rest.y, x.cwiseProduct(scale_));
    const double now = distance_of_step(tried, h);
    if (!(now < 0.5 * rest.left)) break;
    rest = {.y = tried, .left = now, .error = rest.error * now / rest.left};
  }
  return rest;
}

/// Engines that make constraints softer at large steps rest elsewhere there: from the last rest.
VectorXd Probe::rest_at(double h) {
  if (found_.state != ProbedState::equilibrium || coordinates_.size() > settings_.spectrum.eigenvalues_to ||
      distance_of_step(rest_, h) <= (is_single() ? 1e-3 : 1e-8))
    return rest_;
  const Rest found = rest_near(rest_, h, rest_tolerance());
  return found.left <= 1e3 * rest_tolerance() ? found.y : rest_;
}

StepSpectrum Probe::spectrum_near(const VectorXd& y, double h) {
  return spectrum_of_step(engine_, coordinates_, scale_, home, y, h, pattern_,
                          {.eigenvalues_to = settings_.spectrum.eigenvalues_to,
                           .matrix_to = settings_.spectrum.matrix_to,
                           .watch = watcher()});
}

/// Slow motions go a small share of their way in a step, so that what a step moves tells little of how far
/// away the rest is.
void Probe::look_where_it_settles(StepSpectrum& row) {
  if (found_.state == ProbedState::motion || coordinates_.size() > settings_.spectrum.eigenvalues_to) return;
  row.settles = false;
  const bool at_rest = found_.state == ProbedState::equilibrium;
  if (row.grows && at_rest && !compares_) return;
  const Rest found = rest_near(settled_, row.h, 1e-3 * rest_tolerance());
  if (!(found.error <= (is_single() ? 1e-2 : 1e-4))) return;
  row.settled = settled_ = found.y;
  StepSpectrum near = at_rest ? row : spectrum_near(found.y, row.h);
  row.settles = !near.grows;
  if (slow_.empty()) slow_ = slowest_motions(near.motions, scale_, 3);
  if (*row.settles || compares_) row.modes = continued_motions(slow_, near.motions, scale_);
}

StepSpectrum Probe::at(double h) {
  if (found_.state == ProbedState::equilibrium) rest_ = rest_at(h);
  StepSpectrum row = found_.state == ProbedState::motion ? along_motion(h) : spectrum_near(rest_, h);
  look_where_it_settles(row);
  row.motions.clear();
  found_.rows.push_back(row);
  if (row.grows && (!found_.critical || h < found_.critical->h))
    found_.critical = row;  // until the limit is known
  return row;
}

void Probe::bisect(double low, double high) {
  while (high - low > settings_.resolution * high) {
    const double middle = (low + high) / 2;
    (at(middle).grows ? high : low) = middle;
    share_ = std::min(0.6, share_ + 0.02);
  }
  found_.h_max = (low + high) / 2;
  // So close to the limit the motion that grows is hardly told from others.
  const StepSpectrum beyond = at(std::min(1.002 * found_.h_max, settings_.h1));
  if (beyond.grows) found_.critical = beyond;
  // Shorter steps may hide it among multipliers of modulus 1.
  if (found_.state == ProbedState::motion ||
      !is_growth_of_model(beyond, spectrum_near(rest_, 1.3 * beyond.h)))
    return;
  found_.h_max = nan;
  found_.status.push_back("motions grow at the same rate at every step size that shows it, " +
                          rounded_text(std::log(beyond.spectral_radius) / beyond.h, 2) +
                          " 1/s: the model itself is unstable at this state");
}

/// Whether what grows at h0 grows in the model: at half the step half as much a step.
void Probe::explain_growth_at_least() {
  found_.h_max = nan;
  const StepSpectrum row = found_.rows.front();
  if (found_.state == ProbedState::motion || !std::isfinite(row.spectral_radius)) {
    found_.status.push_back("steps of h0 cannot be done; take a smaller h0");
    return;
  }
  const double of_half = at(settings_.h0 / 2).spectral_radius - 1, of_whole = row.spectral_radius - 1;
  found_.status.push_back(
      std::abs(2 * of_half - of_whole) < 0.2 * of_whole
          ? "motions grow at every step size, at half of h0 half as much a step: the model itself is unstable at this state"
          : "motions grow at h0 already; take a smaller h0");
}

void Probe::find_limit() {
  const int count = settings_.h1 > settings_.h0 ? std::max(2, settings_.rows) : 1;
  double low = 0;
  for (int i = 0; i < count; ++i) {
    const double part = count > 1 ? static_cast<double>(i) / (count - 1) : 0;
    const double h =
        i + 1 == count ? settings_.h1 : settings_.h0 * std::pow(settings_.h1 / settings_.h0, part);
    share_ = 0.02 + 0.4 * static_cast<double>(i) / count;
    detail_ = "h = " + rounded_text(h, 4) + " s";
    tell(share_, detail_);
    // In float a short step moves positions by less than their last place.
    if (i == 0 || is_single()) choose_scales(h);
    if (i == 0) judge_start();
    if (at(h).grows) {
      if (low == 0) return explain_growth_at_least();
      bisect(low, h);
      return;
    }
    low = h;
  }
  found_.h_max = infinity;
}

/// Whether what was probed is at rest at the limit, and where that is.
void Probe::check_rest_at_limit() {
  if (found_.state != ProbedState::equilibrium || std::isnan(found_.h_max)) return;
  const double h = std::min(0.99 * found_.h_max, settings_.h1);
  const double off = distance_of_step(start_, h);
  if (!std::isfinite(off) || off <= 1e3 * rest_tolerance()) return;
  rest_ = rest_at(h);
  const bool is_rest = distance_of_step(rest_, h) <= 1e3 * rest_tolerance();
  const VectorXd other = is_rest ? rest_ : engine_.after(home, start_, h, 1);
  Index most = 0;
  coordinates_.of(start_, other).cwiseQuotient(scale_).cwiseAbs().maxCoeff(&most);
  const Index i = coordinates_.component(most);
  const std::string by = rounded_text(other[i] - start_[i], 2);
  if (!is_rest) found_.state = ProbedState::initial;
  found_.status.push_back("the state of rest depends on the step size: " +
                          (is_rest ? "at " + rounded_text(h, 3) + " s its number " + std::to_string(i) +
                                         " is off by " + by + "; each step size is probed at its own"
                                   : "a step of " + rounded_text(h, 3) + " s changes its number " +
                                         std::to_string(i) + " by " + by +
                                         "; h_max is that of the state of rest at small steps"));
}

void Probe::check_pattern() {
  if (!pattern_.undeclared()) return;
  const auto [row, column] = *pattern_.undeclared();
  found_.status.push_back("the declared pattern of the step is wrong and not used: number " +
                          std::to_string(coordinates_.component(row)) + " after a step depends on " +
                          (column < 0
                               ? std::string("more numbers than it says")
                               : "number " + std::to_string(coordinates_.component(column)) + " before it") +
                          "; declare these couplings, or a longer reach");
}

void Probe::name_growing_numbers() {
  if (!found_.critical || !(found_.critical->motion.maxCoeff() > 0)) return;
  const VectorXd& motion = found_.critical->motion;
  std::vector<Index> order(static_cast<std::size_t>(motion.size()));
  std::iota(order.begin(), order.end(), Index{0});
  std::ranges::sort(order,
                    [&](Index a, Index b) { return motion[a] != motion[b] ? motion[a] > motion[b] : a < b; });
  for (const Index i : order)
    if (found_.moving.size() < 4 && motion[i] > 0.1) found_.moving.push_back(i);
}

void Probe::find_shares() {
  if (engine_.parts().empty() || found_.state == ProbedState::motion || !std::isfinite(found_.h_max) ||
      !std::isfinite(std::abs(found_.critical->multiplier)) ||
      coordinates_.size() > settings_.spectrum.matrix_to)
    return;
  detail_ = "parts";
  found_.shares = shares_of_limit(engine_, coordinates_, scale_, home, rest_at(found_.critical->h),
                                  *found_.critical, watcher());
}

GrowthRun Probe::growth_run(double h) const {
  // As far as the step is linear, and above its rounding.
  const double increment = found_.rows.front().increment,
               amplitude =
                   is_single() ? std::clamp(increment / 5, 3e-5, 1e-3) : std::clamp(increment, 1e-7, 1e-6);
  GrowthRun run{.steps = found_.state == ProbedState::motion ? steps_of_motion(h) : found_.steps,
                .amplitude = amplitude,
                .bound = is_single() ? 100 * amplitude : 1e5 * amplitude,
                .most = is_single() ? 30.0 : 1e4,
                .follow = found_.state != ProbedState::equilibrium || rest_ != start_,
                .watch = watcher()};
  return run;
}

bool Probe::runs_grow(double h) {
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

/// Long enough that growth at 1.002 of the limit is seen, and not longer than the time allows.
std::int64_t Probe::observed_steps() {
  constexpr double most = 2e6;
  using Clock = std::chrono::steady_clock;
  engine_.restore(home);
  const auto begin = Clock::now();
  engine_.step(settings_.h0, 50);
  const double one = std::chrono::duration<double>(Clock::now() - begin).count() / 50;
  constexpr double least = 400;
  const double affordable = std::clamp(settings_.seconds_a_run / one, least, most);
  if (!is_linear_ || !std::isfinite(found_.h_max))
    return static_cast<std::int64_t>(std::min(affordable, 20000.0));
  const double rate = std::log(found_.critical->spectral_radius);
  return std::llround(std::clamp(rate > 0 ? 10 / rate : infinity, least, affordable));
}

void Probe::narrow(double low, double high, double resolution) {
  while (high - low > resolution * high) {
    const double middle = (low + high) / 2;
    (runs_grow(middle) ? high : low) = middle;
  }
  found_.observed = (low + high) / 2;
}

/// From a little on both sides of h_max away from it.
void Probe::bracket(double low, double high) {
  for (double away = 0.004; runs_grow(low); away *= 2) {
    high = low;
    low = found_.h_max * (1 - away);
    if (low < settings_.h0 / 2) {
      found_.observed = nan;
      return contradict("runs grow at h0 already, though no multiplier does; take a smaller h0");
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
void Probe::observe_beyond_limits() {
  if (std::isinf(found_.h_max)) {
    found_.observed = infinity;
    if (!runs_grow(settings_.h1)) return;
    found_.observed = nan;
    if (!runs_grow(settings_.h0)) narrow(settings_.h0, settings_.h1, 0.01);
    return contradict("multipliers and runs contradict each other: runs of " + std::to_string(found_.steps) +
                      " steps grow from " +
                      rounded_text(std::isnan(found_.observed) ? settings_.h0 : found_.observed, 3) +
                      " s on, though no multiplier does; use steps below that");
  }
  if (found_.state == ProbedState::motion || !std::isfinite(found_.rows.front().spectral_radius)) return;
  const double rate = std::log(found_.rows.front().spectral_radius);
  if (rate * static_cast<double>(found_.steps) > seen_growth && !runs_grow(settings_.h0))
    contradict("multipliers and runs contradict each other: a multiplier grows by " + rounded_text(rate, 2) +
               " a step of h0, and runs of " + std::to_string(found_.steps) + " steps do not grow");
}

/// Whether h_max and observed can both be true.
void Probe::compare_with_runs() {
  if (!std::isfinite(found_.h_max) || std::isnan(found_.observed)) return;
  const double shown = std::min(found_.observed, settings_.h1), gap = shown / found_.h_max - 1;
  const bool is_motion = found_.state == ProbedState::motion;
  if (std::abs(gap) <= 0.005) return;
  const std::string runs = is_motion ? "runs" : "runs of " + std::to_string(found_.steps) + " steps";
  if (gap > 0 && !is_motion) {
    const double rate = std::log(at((found_.h_max + shown) / 2).spectral_radius);
    if (rate * static_cast<double>(found_.steps) < seen_growth) {
      found_.contradiction = gap > allowed_gap;
      found_.status.push_back("undecided between " + rounded_text(found_.h_max, 4) + " s and " +
                              rounded_text(shown, 4) + " s: a multiplier grows by " + rounded_text(rate, 2) +
                              " a step between them, which " + runs + " do not show; use the smaller one");
      return;
    }
  }
  if (std::abs(gap) <= (is_motion ? allowed_gap_of_motion : allowed_gap)) return;
  contradict("multipliers and runs contradict each other: growth begins at " + rounded_text(found_.h_max, 4) +
             " s by multipliers, " +
             (std::isinf(found_.observed) ? "and not up to " + rounded_text(shown, 4)
                                          : "and at " + rounded_text(shown, 4)) +
             " s by " + runs + "; use the smaller one");
}

void Probe::observe() {
  found_.observed = found_.gap = nan;
  if (!settings_.observe) return;
  share_ = std::max(share_, 0.6);
  detail_ = "runs";
  found_.steps = found_.state == ProbedState::motion ? 0 : observed_steps();
  engine_.restore(home);
  if (rest_ != start_) engine_.set_state(rest_);
  engine_.save(at_rest);
  if (!std::isfinite(found_.h_max)) return observe_beyond_limits();
  bracket(0.998 * found_.h_max, std::min(settings_.h1, 1.002 * found_.h_max));
  found_.gap = (found_.observed - found_.h_max) / found_.h_max;
  if (!std::isfinite(found_.gap)) found_.gap = nan;
  compare_with_runs();
}

/// Multipliers may hide slow growth among others of modulus 1; where runs agree with h_max there is none to
/// speak of.
void Probe::say_what_is_unresolved() {
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

void Probe::compare_rests() {
  std::ranges::sort(found_.rows, {}, &StepSpectrum::h);
  const VectorXd first = found_.rows.front().settled;
  for (StepSpectrum& row : found_.rows) {
    if (first.size() == 0 || row.settled.size() == 0) continue;
    const double moved = (row.settled - first).norm();
    row.settled_moves = moved > 0 ? moved / first.norm() : 0;
  }
}

/// What steps of h1 make of the slowest motion and of the state of rest, where nothing grows up to there.
void Probe::say_what_steps_show() {
  if (!std::isinf(found_.h_max)) return;
  const StepSpectrum& last = found_.rows.back();
  std::string text = "no growth up to h1 = " + rounded_text(last.h, 4) + " s";
  if (!last.modes.empty() && !std::isnan(last.modes.front().omega_shown)) {
    const ShownMode& mode = last.modes.front();
    const auto ratio = [](double zeta) { return std::abs(zeta) < 1e-6 ? "0" : rounded_text(zeta, 2); };
    text += "; there the slowest mode is " + rounded_text(mode.omega_shown, 3) + " for " +
            rounded_text(mode.omega, 3) + " rad/s with damping ratio " + ratio(mode.zeta_shown) + " for " +
            ratio(mode.zeta) + " of steps of h0";
  }
  if (!last.settles && found_.state != ProbedState::motion)
    text += "; where they settle and their modes are found of up to " +
            std::to_string(settings_.spectrum.eigenvalues_to) + " numbers";
  if (last.settles && !*last.settles) text += "; there nothing settles";
  if (std::isfinite(last.settled_moves))
    text += "; it settles " + rounded_text(100 * last.settled_moves, 3) + " % away from where steps of h0 do";
  found_.status.push_back(text);
}

ProbedLimit Probe::run() {
  found_.model = engine_.name();
  found_.dim = engine_.dim();
  look_at_start();
  find_limit();
  check_rest_at_limit();
  check_smoothness();
  check_pattern();
  name_growing_numbers();
  find_shares();
  observe();
  say_what_is_unresolved();
  engine_.restore(home);
  compare_rests();
  say_what_steps_show();
  return found_;
}

ProbedLimit Probe::compare() {
  compares_ = true;
  found_.model = engine_.name();
  found_.dim = engine_.dim();
  found_.h_max = found_.observed = found_.gap = nan;
  look_at_start();
  choose_scales(settings_.h0);
  const std::vector<std::string> remarks = found_.status;
  judge_start();
  found_.status = remarks;  // where the state goes is looked for
  at(settings_.h0);
  const StepSpectrum row = at(settings_.h1);
  if (row.grows) found_.status.push_back(motion_in_words(row.multiplier) + " grows");
  for (const StepSpectrum& each : found_.rows)
    if (each.settled.size() == 0)
      found_.status.push_back("no state of rest of steps of " + rounded_text(each.h, 4) + " s was found");
  engine_.restore(home);
  compare_rests();
  return found_;
}

/// @throws InputError  for step sizes that make no sense, and for more numbers than `most`
void check_question(const ForeignStepper& engine, const ProbeSettings& settings, Index most) {
  const auto is_size = [](double h) { return std::isfinite(h) && h > 0; };
  if (!is_size(settings.h0) || !is_size(settings.h1) || settings.h1 < settings.h0)
    throw InputError("step sizes are from h0 " + to_text(settings.h0) + " to h1 " + to_text(settings.h1) +
                     "; give two positive numbers, the smaller one first");
  if (settings.motion && !(*settings.motion >= settings.h1 && std::isfinite(*settings.motion)))
    throw InputError("motion " + to_text(*settings.motion) +
                     " is shorter than a step of h1; give its length in seconds");
  if (engine.dim() > most)
    throw InputError("the state has " + std::to_string(engine.dim()) + " numbers, and a probe takes up to " +
                     std::to_string(most) + "; probe a smaller scene of the same engine");
}

}  // namespace

std::string_view name_of(ProbedState state) {
  constexpr std::array<std::string_view, 3> names{"equilibrium", "initial", "motion"};
  return names[static_cast<std::size_t>(state)];
}

ProbedLimit probe_steps(ForeignStepper& engine, const ProbeSettings& settings) {
  check_question(engine, settings, most_probed_numbers);
  return Probe(engine, settings).run();
}

ProbedLimit compare_steps(ForeignStepper& engine, const ProbeSettings& settings) {
  check_question(engine, settings, settings.spectrum.eigenvalues_to);
  return Probe(engine, settings).compare();
}

}  // namespace hmax
