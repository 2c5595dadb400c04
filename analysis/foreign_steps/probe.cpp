#include "analysis/foreign_steps/probe.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "analysis/dynamics/growth.hpp"
#include "analysis/foreign_steps/hidden_state.hpp"
#include "analysis/foreign_steps/slow_motions.hpp"
#include "analysis/foreign_steps/step_kinks.hpp"
#include "analysis/spectrum/lanczos.hpp"
#include "core/errors.hpp"
#include "core/numbers.hpp"

namespace hmax {

using Eigen::Index;
using Eigen::VectorXd;

void StepProbe::look_at_start() {
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
    throw InputError("a step of h0 from the start cannot be done or is not finite; take a smaller h0");
  if (settings_.motion) found_.state = ProbedState::motion;
  const std::vector<std::string> remarks =
      examine_hidden_state(engine_, coordinates_, scale_, home, start_, settings_.h0)
          .remarks(is_single() ? 1e-4 : 1e-8, engine_.has_hidden_state());
  found_.status.insert(found_.status.end(), remarks.begin(), remarks.end());
}

/// Whether a hundred steps go hardly farther than one: what a solver leaves, or the end of an oscillation.
bool StepProbe::only_trembles(double moved) {
  if (moved > (is_single() ? 1e-2 : 1e-6)) return false;
  const VectorXd later = engine_.after(home, start_, settings_.h0, 100);
  return later.allFinite() && distance(start_, later) <= 3 * moved;
}

void StepProbe::judge_start() {
  if (settings_.motion) return;
  const VectorXd next = engine_.after(home, start_, settings_.h0, 1);
  const double moved = distance(start_, next);
  found_.state = ProbedState::equilibrium;
  if (moved <= (is_single() ? 1e-5 : 1e-9) || only_trembles(moved)) return;
  // Rounding of what nothing but small numbers balances.
  constexpr double rounding = 1e-12;
  if (coordinates_.of(start_, next).cwiseQuotient(plain_scale()).cwiseAbs().maxCoeff() <= rounding) return;
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
VectorXd StepProbe::balanced(const VectorXd& unbalanced, double h) {
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

void StepProbe::choose_scales(double h) {
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

/// Whether differences near the limit tell what a step does.
void StepProbe::check_smoothness() {
  if (found_.state == ProbedState::motion || found_.smoothness != StepSmoothness::smooth) return;
  const double h = std::isfinite(found_.h_max) ? 0.9 * found_.h_max : settings_.h0;
  const StepDerivative derivative(engine_, coordinates_, scale_, home, rest_, h);
  if (!derivative.is_finite() || !std::isfinite(derivative.error())) return;
  if (derivative.error() > 0.01)
    found_.status.push_back("differences of the step at two increments differ by " +
                            rounded_text(derivative.error(), 2) +
                            ": the step is not smooth at this state, as at a contact that opens");
  else if (is_single() && !derivative.is_linear())
    found_.status.push_back(
        "the changes of two small disturbances do not add up: the step is not smooth at this state, as with "
        "impulses that are bounded; h_max says nothing, trust observed");
}

/// The part of the scene whose numbers change the kink most, in steps of middle size: large ones soften
/// constraints whatever their numbers are.
std::string StepProbe::part_of_kink(const StepKink& kink) {
  const double h = std::sqrt(settings_.h0 * settings_.h1);
  const VectorXd y = rest_at(h);
  const auto size = [&] {
    return kink_along(engine_, coordinates_, scale_, home, y, h, kink.direction, 1e-5);
  };
  const std::vector<ScenePart> parts = engine_.parts();
  const double whole = size();
  double most = 1e-4 * whole;
  std::string place;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    watcher()();
    engine_.scale_part(i, 1.02, 1.01);
    const double change = std::abs(size() - whole);
    engine_.scale_part(i, 1, 1);
    if (!(change > most)) continue;
    most = change;
    place = " (" + parts[i].kind + " " + parts[i].name + ")";
  }
  return place;
}

void StepProbe::say_where_kink_is(const StepKink& kink) {
  found_.status.push_back(
      kink.kind == StepSmoothness::jump
          ? "the step jumps at this state, as with contacts that come and go: no derivative tells what it "
            "does, and no limit is predicted; observed has runs that are disturbed by 1e-4 of its scale"
          : "the state is at a kink of the step, where number " + std::to_string(kink.number) +
                " of the state changes" + part_of_kink(kink) +
                ", as with a contact or a limit that just touches, or a muscle at rest: growth comes in "
                "windows of step sizes, h_max is the smallest that was found, and narrower ones may be below");
}

/// In double: whether a step of h has a derivative at rest.
bool StepProbe::looks_at_kinks(double h) {
  if (found_.state == ProbedState::motion || is_single() || found_.smoothness != StepSmoothness::smooth)
    return false;
  detail_ = "kinks";
  rest_ = rest_at(h);
  const StepKink kink = kink_of_step(engine_, coordinates_, scale_, home, rest_, h, watcher());
  found_.smoothness = kink.kind;
  if (kink.kind == StepSmoothness::smooth) return false;
  say_where_kink_is(kink);
  return true;
}

StepSpectrum StepProbe::across_kink(double h) {
  const OneSidedGrowth growth = one_sided_growth(engine_, coordinates_, scale_, home, rest_, h, watcher());
  return {.h = h,
          .spectral_radius = std::exp(growth.rate),
          .multiplier = {nan, nan},
          .grows = growth.grows,
          .motion = motion_on_state(growth.motion, coordinates_, scale_, engine_.dim())};
}

bool StepProbe::hides_growth(const StepSpectrum& row) const {
  return row.h <= found_.h_max && !row.grows && !row.resolved && row.spectral_radius > 1.05;
}

/// Windows of growth begin at about one step size: those below the one that was found, in strides of 1 %.
void StepProbe::look_for_earlier_growth() {
  constexpr double share = 0.7, stride = 1.01;
  bool found = std::isfinite(found_.h_max);
  for (int search = 0; found && search < 20; ++search) {
    found = false;
    const double end = 0.999 * found_.h_max;
    double low = std::max(settings_.h0, share * end);
    for (double h = stride * low; h < end && !found; low = h, h *= stride)
      if (at(h).grows) {
        bisect(low, h);
        found = true;
      }
  }
}

/// A matrix of central differences is that of no side of a kink. What grows may have nothing to do with it,
/// as in a scene with a muscle at rest: then both limits are the same, and the matrix tells what grows.
void StepProbe::judge_across_kink() {
  if (found_.state == ProbedState::motion || is_single()) return;
  const double by_matrix = found_.h_max;
  looks_at_kinks(std::isfinite(by_matrix) ? 0.9 * by_matrix
                 : std::isnan(by_matrix)  ? settings_.h0
                                          : settings_.h1);
  if (std::isinf(by_matrix)) looks_at_kinks(settings_.h0);
  // What differences at two increments make to be of another size is no derivative.
  if (found_.smoothness == StepSmoothness::smooth &&
      std::ranges::any_of(found_.rows, [&](const StepSpectrum& row) { return hides_growth(row); })) {
    found_.smoothness = StepSmoothness::jump;
    say_where_kink_is({.kind = StepSmoothness::jump});
  }
  if (found_.smoothness == StepSmoothness::smooth) return;
  const std::optional<StepSpectrum> critical = found_.critical;
  forget_limit();
  if (found_.smoothness == StepSmoothness::jump) {
    at(settings_.h0);
    found_.critical.reset();
    return;
  }
  refuse_endless_search();
  find_limit();
  look_for_earlier_growth();
  if (critical && std::abs(found_.h_max / by_matrix - 1) < 0.005) {
    found_.h_max = by_matrix;
    found_.critical = critical;
  }
}

StepSpectrum StepProbe::along_motion(double h) {
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

/// Engines that make constraints softer at large steps rest elsewhere there: from the last rest.
VectorXd StepProbe::rest_at(double h) {
  if (found_.state != ProbedState::equilibrium || coordinates_.size() > settings_.spectrum.eigenvalues_to ||
      distance_of_step(rest_, h) <= (is_single() ? 1e-3 : 1e-8))
    return rest_;
  const StepRest found = rest_near(rest_, h, rest_tolerance());
  return found.left <= 1e3 * rest_tolerance() ? found.y : rest_;
}

StepSpectrum StepProbe::spectrum_near(const VectorXd& y, double h) {
  return spectrum_of_step(engine_, coordinates_, scale_, home, y, h, pattern_,
                          {.eigenvalues_to = settings_.spectrum.eigenvalues_to,
                           .matrix_to = settings_.spectrum.matrix_to,
                           .creep = creep_,
                           .watch = watcher()});
}

/// Slow motions go a small share of their way in a step, so that what a step moves tells little of how far
/// away the rest is.
void StepProbe::look_where_it_settles(StepSpectrum& row) {
  if (found_.state == ProbedState::motion || coordinates_.size() > settings_.spectrum.eigenvalues_to) return;
  row.settles = false;
  const bool rests = found_.state == ProbedState::equilibrium;
  if (row.grows && rests && !compares_) return;
  const StepRest found = rest_near(settled_, row.h, 1e-3 * rest_tolerance());
  // Of a motion that is even and slow a short step shows little: what it moves counts by its length.
  const double share = is_single() ? 1 : std::max(1e-3, row.h / settings_.h1);
  if (!(found.error <= (is_single() ? 1e-2 : 1e-4) && found.left <= 1e3 * share * rest_tolerance())) return;
  row.settled = settled_ = found.y;
  StepSpectrum near = rests ? row : spectrum_near(found.y, row.h);
  row.settles = !near.grows;
  if (slow_.empty()) slow_ = slowest_motions(near.motions, scale_, 3);
  if (*row.settles || compares_) row.modes = continued_motions(slow_, near.motions, scale_);
}

StepSpectrum StepProbe::at(double h) {
  if (found_.state == ProbedState::equilibrium) rest_ = rest_at(h);
  StepSpectrum row = found_.state == ProbedState::motion         ? along_motion(h)
                     : found_.smoothness == StepSmoothness::kink ? across_kink(h)
                                                                 : spectrum_near(rest_, h);
  look_where_it_settles(row);
  row.motions.clear();
  found_.rows.push_back(row);
  if (row.grows && (!found_.critical || h < found_.critical->h))
    found_.critical = row;  // until the limit is known
  return row;
}

void StepProbe::bisect(double low, double high) {
  const bool at_kink = found_.smoothness == StepSmoothness::kink;
  while (high - low > (at_kink ? 10 : 1) * settings_.resolution * high) {
    const double middle = (low + high) / 2;
    (at(middle).grows ? high : low) = middle;
    share_ = std::min(0.6, share_ + 0.02);
  }
  found_.h_max = (low + high) / 2;
  if (at_kink) return;
  // So close to the limit the motion that grows is hardly told from others.
  const StepSpectrum beyond = at(std::min(1.002 * found_.h_max, settings_.h1));
  if (beyond.grows) found_.critical = beyond;
  if (found_.state == ProbedState::motion || fades(beyond)) return;
  // Shorter steps may hide it among multipliers of modulus 1.
  if (!is_growth_of_model(beyond, spectrum_near(rest_, 1.3 * beyond.h))) return;
  const double rate = std::log(beyond.spectral_radius) / beyond.h;
  if (creeps(rate)) return;
  found_.h_max = nan;
  found_.status.push_back("motions grow at the same rate at every step size that shows it, " +
                          rounded_text(rate, 2) + " 1/s: the model itself is unstable at this state");
}

/// A growth of the model that the longest runs hardly show is a creep, as of bodies on soft contacts: what
/// the steps add to it is sought. The time is that of 20,000 steps between h0 and h1.
bool StepProbe::creeps(double rate) {
  const double time = 20'000 * std::sqrt(settings_.h0 * settings_.h1);
  if (!(rate * time < std::log(4.0)) || creep_ > 0) return false;
  creep_ = 2 * rate;
  restart_ = true;
  found_.status.push_back("the model itself creeps at this state: a motion grows by " +
                          rounded_text(rate, 2) + " 1/s at every step size, which runs of " +
                          rounded_text(time, 2) + " s do not show; it does not count as growth");
  return true;
}

/// Whether growth that hardly exceeds its tolerance is that of the method at every step size, a power of h:
/// beyond a limit it would come hundreds of times as fast.
bool StepProbe::fades(const StepSpectrum& row) {
  const auto excess = [&](const StepSpectrum& of) { return std::abs(of.multiplier) - 1 - creep_ * of.h; };
  const double here = excess(row);
  if (!(here < 100 * row.tolerance) || 4 * row.h > settings_.h1) return false;
  const double twice = excess(spectrum_near(rest_, 2 * row.h)), power = std::log2(twice / here),
               next = std::log2(excess(spectrum_near(rest_, 4 * row.h)) / twice);
  if (!(power > 1.2 && power < 6.5 && std::abs(next - power) < 0.5) ||
      here > 1.5 * row.tolerance * std::exp2(power))
    return false;
  found_.h_max = nan;
  found_.status.push_back("no step size is stable: growth falls as h^" + rounded_text(next, 2) + ", to " +
                          rounded_text(here, 2) + " a step at " + rounded_text(row.h, 2) +
                          " s, and is not seen below, where damping may outweigh it");
  return true;
}

/// Whether what grows at h0 grows in the model, at half the step half as much a step, at all step sizes, or
/// beyond a limit.
void StepProbe::explain_growth_at_least() {
  found_.h_max = nan;
  const StepSpectrum row = found_.rows.front();
  if (found_.state == ProbedState::motion || !std::isfinite(row.spectral_radius)) {
    found_.status.push_back("steps of h0 cannot be done; take a smaller h0");
    return;
  }
  if (found_.smoothness == StepSmoothness::kink) {
    found_.status.push_back("motions grow at h0 already; take a smaller h0");
    return;
  }
  refuse_equal_steps(settings_.h0 / 2, settings_.h0);
  StepSpectrum least = row, half = at(settings_.h0 / 2);
  constexpr int halvings = 30;
  for (int i = 0; i < halvings; ++i) {
    const double of_half = half.spectral_radius - 1, of_whole = least.spectral_radius - 1;
    // Of steps far beyond a limit growth is in proportion, too.
    if (of_whole < 0.5 && std::abs(2 * of_half - of_whole) < 0.2 * of_whole) {
      if (!creeps(of_whole / least.h))
        found_.status.push_back(
            "motions grow at every step size, at half of it half as much a step: the model itself is unstable at this state");
      return;
    }
    if (!half.grows) break;
    least = half;
    half = spectrum_near(rest_, least.h / 2);
  }
  if (!fades(least))
    found_.status.push_back("motions grow at h0 already; take " +
                            (half.grows ? "a smaller h0" : "an h0 of " + rounded_text(half.h, 2) + " s"));
}

/// All but the last remark.
void StepProbe::forget_limit() {
  remarks_.push_back(found_.status.back());
  found_.status = remarks_;
  found_.rows.clear();
  found_.critical.reset();
  found_.h_max = nan;
  rest_ = settled_ = start_;
}

/// A limit with what creeps left aside, and across a kink.
void StepProbe::search() {
  remarks_ = found_.status;
  find_limit();
  if (restart_) {
    forget_limit();
    find_limit();
  }
  judge_across_kink();
}

int StepProbe::count_of_sizes() const {
  // At a kink growth comes and goes.
  constexpr double in_a_decade = 36;
  const double least = found_.smoothness == StepSmoothness::kink
                           ? std::ceil(in_a_decade * std::log10(settings_.h1 / settings_.h0))
                           : 0;
  return settings_.h1 > settings_.h0 ? std::max({2, settings_.rows, static_cast<int>(least)}) : 1;
}

double StepProbe::size_of(int i, int count) const {
  if (i + 1 == count) return settings_.h1;
  return settings_.h0 * std::pow(settings_.h1 / settings_.h0, static_cast<double>(i) / (count - 1));
}

/// About how many steps are to be done.
double StepProbe::steps_of_search() const {
  const int count = count_of_sizes();
  if (found_.smoothness == StepSmoothness::kink)
    return static_cast<double>(steps_of_one_sided_growth) * count;
  double steps = 0;
  if (settings_.motion) {
    // Three in each of two passes.
    for (int i = 0; i < count; ++i) steps += 6 * static_cast<double>(steps_of_motion(size_of(i, count)));
    return steps;
  }
  // Of a bisection, of the choice of an increment, and of products; about ten runs.
  constexpr double halvings = 14, increments = 102, products = 180, runs = 4000;
  const double sizes = count > 1 ? count + halvings : 1;
  const Index n = coordinates_.size();
  const bool has_groups = pattern_.pays(), has_matrix = n <= settings_.spectrum.matrix_to;
  const double columns = has_groups   ? static_cast<double>(pattern_.groups().size())
                         : has_matrix ? static_cast<double>(n)
                                      : products;
  // The first matrices may tell the pattern of the others.
  const double matrices = has_matrix && !has_groups && found_.rows.empty() ? std::min(3.0, sizes) : sizes;
  return sizes * increments + 2 * matrices * columns + (settings_.observe ? runs : 0);
}

void StepProbe::refuse_endless_search() {
  if (std::isinf(settings_.most_seconds)) return;
  const double steps = steps_of_search(), seconds = steps * seconds_of_step();
  if (seconds <= settings_.most_seconds) return;
  const bool at_kink = found_.smoothness == StepSmoothness::kink;
  engine_.restore(home);
  throw InputError(
      (at_kink
           ? "the state is at a kink of the step, as with a contact that just touches, and growth is sought at " +
                 std::to_string(count_of_sizes()) + " step sizes one by one, for about "
           : "a probe takes some " + rounded_text(steps, 2) + " steps here, about ") +
      rounded_text(seconds, 2) + " s, more than the limit of " + rounded_text(settings_.most_seconds, 3) +
      " s; allow more time, look at a shorter range of step sizes" +
      (at_kink             ? ", or move the contact"
       : settings_.motion  ? ", or take a shorter motion"
       : settings_.observe ? ", or do not run the engine"
                           : ""));
}

/// An engine that steps by a size of its own has no limit in that of a probe.
void StepProbe::refuse_equal_steps(double h, double other) {
  if (h == other) return;
  const VectorXd away = 1e-3 * start_vector(scale_.size()).cwiseProduct(scale_);
  for (const double sign : {1.0, -1.0}) {
    const VectorXd y = coordinates_.at(start_, sign * away);
    const VectorXd next = engine_.after(home, y, h, 1);
    // What does not move may begin to in longer runs.
    if (next == y || next != engine_.after(home, y, other, 1)) return;
  }
  engine_.restore(home);
  throw InputError(
      "steps of " + rounded_text(h, 3) + " s and of " + rounded_text(other, 3) +
      " s from a disturbed state are equal in all bits: the step does not depend on its size; pass "
      "it on to the engine. A model without time has no largest step");
}

void StepProbe::find_limit() {
  const int count = count_of_sizes();
  double low = 0;
  for (int i = 0; i < count; ++i) {
    const double h = size_of(i, count);
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
    if (i == 0) refuse_endless_search();
    low = h;
  }
  refuse_equal_steps(settings_.h0, settings_.h1);
  found_.h_max = infinity;
}

/// Whether what was probed is at rest at the limit, and where that is.
void StepProbe::check_rest_at_limit() {
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

void StepProbe::check_pattern() {
  if (!pattern_.undeclared()) return;
  const auto [row, column] = *pattern_.undeclared();
  found_.status.push_back("the declared pattern of the step is wrong and not used: number " +
                          std::to_string(coordinates_.component(row)) + " after a step depends on " +
                          (column < 0
                               ? std::string("more numbers than it says")
                               : "number " + std::to_string(coordinates_.component(column)) + " before it") +
                          "; declare these couplings, or a longer reach");
}

void StepProbe::name_growing_numbers() {
  if (!found_.critical || !(found_.critical->motion.maxCoeff() > 0)) return;
  const VectorXd& motion = found_.critical->motion;
  std::vector<Index> order(static_cast<std::size_t>(motion.size()));
  std::iota(order.begin(), order.end(), Index{0});
  std::ranges::sort(order,
                    [&](Index a, Index b) { return motion[a] != motion[b] ? motion[a] > motion[b] : a < b; });
  for (const Index i : order)
    if (found_.moving.size() < 4 && motion[i] > 0.1) found_.moving.push_back(i);
}

void StepProbe::find_shares() {
  if (engine_.parts().empty() || found_.state == ProbedState::motion || !std::isfinite(found_.h_max) ||
      !std::isfinite(std::abs(found_.critical->multiplier)) ||
      coordinates_.size() > settings_.spectrum.matrix_to)
    return;
  detail_ = "parts";
  found_.shares = shares_of_limit(engine_, coordinates_, scale_, home, rest_at(found_.critical->h),
                                  *found_.critical, watcher());
}

void StepProbe::compare_rests() {
  std::ranges::sort(found_.rows, {}, &StepSpectrum::h);
  const VectorXd first = found_.rows.front().settled;
  for (StepSpectrum& row : found_.rows) {
    if (first.size() == 0 || row.settled.size() == 0) continue;
    const double moved = (row.settled - first).norm();
    // Of two states of rest at zero each has what is left of the way there.
    row.settled_moves = moved > 10 * rest_tolerance() * (first - start_).norm() ? moved / first.norm() : 0;
  }
}

/// What steps of h1 make of the slowest motion and of the state of rest, where nothing grows up to there.
void StepProbe::say_what_steps_show() {
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

ProbedLimit StepProbe::run() {
  found_.model = engine_.name();
  found_.dim = engine_.dim();
  found_.h1 = settings_.h1;
  look_at_start();
  refuse_endless_search();
  search();
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

ProbedLimit StepProbe::compare() {
  compares_ = true;
  found_.model = engine_.name();
  found_.dim = engine_.dim();
  found_.h_max = found_.observed = found_.gap = nan;
  look_at_start();
  choose_scales(settings_.h0);
  const std::vector<std::string> remarks = found_.status;
  judge_start();
  found_.status = remarks;  // where the state goes is looked for
  looks_at_kinks(settings_.h1);
  at(settings_.h0);
  const StepSpectrum row = at(settings_.h1);
  refuse_equal_steps(settings_.h0, settings_.h1);
  if (row.grows) found_.status.push_back(motion_in_words(row.multiplier) + " grows");
  for (const StepSpectrum& each : found_.rows)
    if (each.settled.size() == 0)
      found_.status.push_back("no state of rest of steps of " + rounded_text(each.h, 4) + " s was found");
  engine_.restore(home);
  compare_rests();
  return found_;
}

namespace {

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
  return StepProbe(engine, settings).run();
}

ProbedLimit compare_steps(ForeignStepper& engine, const ProbeSettings& settings) {
  check_question(engine, settings, settings.spectrum.eigenvalues_to);
  return StepProbe(engine, settings).compare();
}

}  // namespace hmax
