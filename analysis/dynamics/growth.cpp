#include "analysis/dynamics/growth.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <utility>
#include <vector>

#include "core/dense_solvers.hpp"
#include "core/numbers.hpp"

namespace hmax {

namespace {

/// A share of the first distance. What runs end in, rounding or what equations are solved to, grows and
/// decays by chance.
constexpr double noise = 1e-6;

/// From one quarter to the other growth in proportion to time makes at most a factor of four.
const double in_proportion = std::log(4.0) + ExpectedGrowth{}.visible;

/// ln of the factor that counts as growth.
double threshold_of(const ExpectedGrowth& expected) {
  return expected.linear ? in_proportion : expected.visible;
}

}  // namespace

// Maxima over quarters, not single states: what oscillates within a quarter has the same maximum in both.
double observed_growth(const ShowSteps& run, const Distance& distance, double h, std::int64_t steps,
                       double floor) {
  double start = 0, early = 0, late = 0;
  std::int64_t n = 0;
  bool broken = false;
  const bool ended = run(h, steps, [&](const Eigen::Ref<const Eigen::VectorXd>& y) {
    const double here = distance(y);
    broken = broken || !std::isfinite(here);
    // A first step from velocities that fast damping is about to stop carries them far, once.
    if (n <= 1)
      start = std::max(start, here);
    else if (n > steps / 4 && n <= steps / 2)
      early = std::max(early, here);
    else if (n > 3 * steps / 4)
      late = std::max(late, here);
    ++n;
  });
  if (!ended || broken || n < steps) return std::numeric_limits<double>::infinity();
  constexpr double least = std::numeric_limits<double>::min();
  // Largest distances of the second and the last quarter; a share of the first distance is a floor.
  const double growth = std::log(late) - std::log(std::max({early, floor * start, least}));
  // What a nonlinear model has caught far out before the quarters that are compared has grown all the same.
  constexpr double far_out = 1e4;
  return start > 0 && late > far_out * start ? std::max(growth, std::log(late / start)) : growth;
}

// Each equation is divided by the largest state in it, so that growth and decay weigh all alike.
std::optional<double> growth_of_recurrence(const ShowSteps& run, const MotionOf& motion, std::size_t degree,
                                           double h, std::int64_t steps, double disturbance) {
  std::vector<Eigen::Vector2d> z;
  const bool ended =
      run(h, steps, [&](const Eigen::Ref<const Eigen::VectorXd>& y) { z.push_back(motion(y)); });
  const bool broken = std::ranges::any_of(z, [](const auto& each) { return !each.allFinite(); });
  if (!ended || broken || z.size() < 3 * degree) return std::numeric_limits<double>::infinity();
  const auto p = static_cast<Eigen::Index>(degree), count = static_cast<Eigen::Index>(z.size()) - 2 * p;
  Eigen::MatrixXd before(2 * count, p);
  Eigen::VectorXd next(2 * count);
  for (Eigen::Index n = 0; n < count; ++n) {
    const auto state = [&](Eigen::Index j) { return z[static_cast<std::size_t>(p + n + j)]; };
    double largest = std::numeric_limits<double>::min();
    for (Eigen::Index j = 0; j <= p; ++j) largest = std::max(largest, state(j).cwiseAbs().maxCoeff());
    for (Eigen::Index j = 0; j < p; ++j) before.block(2 * n, j, 2, 1) = state(j) / largest;
    next.segment(2 * n, 2) = state(p) / largest;
  }
  const Eigen::VectorXd c = minimum_norm_solution(before, -next, 1e-9);
  if (!((before * c + next).cwiseAbs().maxCoeff() <= disturbance)) return std::nullopt;
  // The companion matrix of the recurrence.
  Eigen::MatrixXd companion = Eigen::MatrixXd::Zero(p, p);
  companion.topRightCorner(p - 1, p - 1).setIdentity();
  companion.bottomRows(1) = -c.transpose();
  return std::log(dense_eigenvalues(companion).cwiseAbs().maxCoeff());
}

std::int64_t steps_to_see(const ExpectedGrowth& expected) {
  // Half of the run lies between the two quarters that are compared; what dies away has a quarter of it.
  // N / 2 steps lie between the quarters: g N / 2 = threshold.
  const double growth = std::max(expected.close, expected.share * expected.above);
  const double to_grow = 2 * threshold_of(expected) / growth;
  // Growth in proportion to time outgrows nothing.
  const double to_decay = 4 * expected.fall / -expected.beside,
               to_outgrow = expected.linear ? std::numeric_limits<double>::infinity()
                                            : (expected.fall + threshold_of(expected)) / growth;
  const double steps = std::ceil(std::max(to_grow, std::min(to_decay, to_outgrow)));
  return static_cast<std::int64_t>(
      std::clamp(steps, expected.least, std::max(expected.least, static_cast<double>(expected.most))));
}

namespace {

/// The step at which growth begins, between one that decays and one that grows.
/// @param excess  growth over a threshold at a step, at_low and at_high at both ends
template <class Excess>
double onset_between(const Excess& excess, double low, double high, double at_low, double at_high,
                     double resolution) {
  // Growth is nearly a straight line between close steps: by secants, a hair beyond where they cross so that
  // both ends close in, and by halves where that does not get on.
  for (int runs = 0; high - low > resolution * high; ++runs) {
    double next = (low + high) / 2;
    if (runs < 6 && std::isfinite(at_low) && std::isfinite(at_high)) {
      // Zero of the line through both ends, excess(h) = growth - threshold.
      const double crossing = low + (high - low) * at_low / (at_low - at_high);
      const double hair = 0.4 * resolution * high, margin = 0.05 * (high - low);
      next = std::clamp(crossing + (crossing - low < high - crossing ? hair : -hair), low + margin,
                        high - margin);
    }
    const double at_next = excess(next);
    (at_next > 0 ? high : low) = next;
    (at_next > 0 ? at_high : at_low) = at_next;
  }
  return (low + high) / 2;
}

}  // namespace

ObservedLimit observe_limit(const ShowSteps& run, const Distance& distance, double predicted,
                            const ExpectedGrowth& expected) {
  return observe_limit(
      [&](double h, std::int64_t steps) { return observed_growth(run, distance, h, steps, noise); },
      predicted, expected);
}

// First the two sides of the prediction, with longer runs where they do not tell; then outwards by 10 % a
// stride if both sides behave alike; last the onset between the two.
ObservedLimit observe_limit(const GrowthAt& growth, double predicted, const ExpectedGrowth& expected) {
  const double threshold = threshold_of(expected);
  ObservedLimit limit;
  limit.steps = steps_to_see(expected);
  const auto excess = [&](double h) { return growth(h, limit.steps) - threshold; };
  double low = 0.999 * predicted, high = 1.001 * predicted;
  double at_low = excess(low), at_high = excess(high);
  // A motion beside it that fades slowly hides growth, and what a first step stirs up looks like some: longer
  // runs tell, as long as they come nearer to what is expected.
  const auto as_expected = [&] { return !(at_low > 0) && at_high > 0; };
  constexpr std::int64_t longer = 4, longest = 64;
  for (const std::int64_t most = std::min(longest * limit.steps, expected.most);
       !as_expected() && longer * limit.steps <= most;) {
    limit.steps *= longer;
    const double before_low = std::exchange(at_low, excess(low)),
                 before_high = std::exchange(at_high, excess(high));
    const bool nearer = before_low > 0 ? at_low < before_low : at_high > before_high;
    if (!nearer) break;
  }
  limit.below_decays = !(at_low > 0);
  limit.above_grows = at_high > 0;
  // Where the prediction fails the truth is sought outwards from it.
  constexpr double farthest = 1e3;
  if (!limit.below_decays) {
    do {
      high = std::exchange(low, low / 1.1);
      at_high = std::exchange(at_low, excess(low));
    } while (low > predicted / farthest && at_low > 0);
    if (at_low > 0) {
      limit.h = 0;
      return limit;
    }
  }
  if (limit.below_decays && !limit.above_grows) {
    do {
      low = std::exchange(high, high * 1.1);
      at_low = std::exchange(at_high, excess(high));
    } while (high < farthest * predicted && !(at_high > 0));
    if (!(at_high > 0)) {
      limit.h = std::numeric_limits<double>::infinity();
      return limit;
    }
  }
  limit.h = onset_between(excess, low, high, at_low, at_high, expected.resolution);
  return limit;
}

std::optional<ObservedLimit> observe_limit_by_recurrence(const ShowSteps& run, const MotionOf& motion,
                                                         std::size_t degree, double predicted,
                                                         double disturbance) {
  const auto steps = static_cast<std::int64_t>(6 * degree);
  std::map<double, double> known;
  bool lost = false;  // at a step that obeys no recurrence
  const auto per_step = [&](double h) {
    const auto [at, is_new] = known.try_emplace(h);
    if (is_new) {
      const std::optional<double> growth = growth_of_recurrence(run, motion, degree, h, steps, disturbance);
      lost = lost || !growth;
      at->second = growth.value_or(0);
    }
    return at->second;
  };
  per_step(0.999 * predicted);
  per_step(1.001 * predicted);
  if (lost) return std::nullopt;
  const ExpectedGrowth expected{.above = 1,
                                .beside = -std::numeric_limits<double>::infinity(),
                                .visible = 1e-5,
                                .resolution = 2e-4,
                                .least = static_cast<double>(steps)};
  const GrowthAt growth = [&](double h, std::int64_t n) {
    const std::int64_t half = n / 2;
    return per_step(h) * static_cast<double>(half);
  };
  ObservedLimit limit = observe_limit(growth, predicted, expected);
  limit.steps = steps;
  if (lost) return std::nullopt;
  return limit;
}

// The states pass through the linear filter product of (E - root), of as many coefficients as roots plus
// one.
ShowSteps without_roots(ShowSteps run, Eigen::VectorXd rest,
                        std::function<std::vector<std::complex<double>>(double h)> roots) {
  return [run = std::move(run), rest = std::move(rest), roots = std::move(roots)](
             double h, std::int64_t steps, const auto& show) {
    // The coefficients of the product, ascending in E.
    std::vector<std::complex<double>> c{1};
    for (const std::complex<double> root : roots(h)) {
      c.insert(c.begin(), 0);
      // c(E) <- (E - root) c(E).
      for (std::size_t j = 0; j + 1 < c.size(); ++j) c[j] -= root * c[j + 1];
    }
    const std::size_t size = c.size();
    std::vector<Eigen::VectorXd> d(size);
    Eigen::VectorXd shown(rest.size());
    std::size_t n = 0;
    return run(h, steps + static_cast<std::int64_t>(size) - 1,
               [&](const Eigen::Ref<const Eigen::VectorXd>& y) {
                 // A ring of the last states, as many as the product has coefficients.
                 d[n % size] = y - rest;
                 if (++n < size) return;
                 shown = rest;
                 for (std::size_t j = 0; j < size; ++j) shown += c[j].real() * d[(n + j) % size];
                 show(shown);
               });
  };
}

bool grows_at(const ShowSteps& run, const Distance& distance, double h, std::int64_t steps) {
  // From one quarter to the other linear growth makes at most a factor of 4, so does not count.
  return observed_growth(run, distance, h, steps, noise) > in_proportion;
}

std::string motion_in_words(std::complex<double> multiplier) {
  if (std::abs(multiplier.imag()) > 1e-6 * std::abs(multiplier))
    return "a motion that comes round every " +
           short_number(2 * std::numbers::pi / std::abs(std::arg(multiplier)), 4) + " steps";
  return multiplier.real() < 0 ? "a motion that changes sign in every step" : "a motion without oscillation";
}

}  // namespace hmax
