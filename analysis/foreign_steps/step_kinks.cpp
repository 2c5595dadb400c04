#include "analysis/foreign_steps/step_kinks.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "analysis/foreign_steps/step_derivative.hpp"
#include "analysis/spectrum/lanczos.hpp"
#include "core/numbers.hpp"

namespace hmax {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// Of differences across a kink, as of runs.
constexpr double run_amplitude = 1e-6;
/// Of iterated differences, and the steps of each.
constexpr std::int64_t vectors = 4, stride = 8;

VectorXd random_direction(Index n, Index k) {
  const VectorXd numbers = start_vector(n + 11 * k).tail(n);
  return numbers.normalized();
}

/// Changes of a step by disturbances of one state.
class Changes {
 public:
  Changes(ForeignStepper& engine, const StateCoordinates& coordinates, const VectorXd& scale, int slot,
          const VectorXd& y, double h)
      : engine_(engine), coordinates_(coordinates), scale_(scale), slot_(slot), y_(y), h_(h) {
    next_ = engine.after(slot, y, h, 1);
  }

  /// (S(y + e v) - S(y)) / e
  [[nodiscard]] VectorXd along(const VectorXd& v, double e) const {
    const VectorXd moved = coordinates_.at(y_, e * v.cwiseProduct(scale_));
    return coordinates_.of(next_, engine_.after(slot_, moved, h_, 1)).cwiseQuotient(e * scale_);
  }

  /// What the differences leave that would be none of a linear step, and what they would be compared with.
  struct Left {
    double left = 0, moved = 0;
  };
  [[nodiscard]] Left opposites(const VectorXd& v, double e) const {
    const VectorXd ahead = along(v, e);
    return {(ahead + along(-v, e)).norm(), (ahead - v).norm()};
  }
  [[nodiscard]] Left sum(const VectorXd& v, const VectorXd& w, double e) const {
    const VectorXd both = along(v + w, e);
    return {(both - along(v, e) - along(w, e)).norm(), (both - v - w).norm()};
  }

 private:
  ForeignStepper& engine_;
  const StateCoordinates& coordinates_;
  const VectorXd& scale_;
  int slot_;
  const VectorXd& y_;
  double h_;
  VectorXd next_;
};

/// @param at     Left at an increment
/// @param noise  of differences at an increment
StepSmoothness smoothness_of(const std::function<Changes::Left(double)>& at,
                             const std::function<double(double)>& noise) {
  constexpr double share = 0.01, many = 30, alike = 3;
  constexpr int levels = 9;
  int bent = 0, longest = 0;
  double wider = infinity;
  for (int k = 0; k < levels; ++k) {
    const double e = std::pow(10, -3 - 0.5 * k);
    const Changes::Left here = at(e);
    const bool counts = here.left > share * here.moved + many * noise(e);
    if (counts && here.left > alike * wider) return StepSmoothness::jump;
    bent = counts && here.left > wider / alike ? bent + 1 : 0;
    longest = std::max(longest, bent);
    wider = here.left;
  }
  // Two decades.
  return longest >= 4 ? StepSmoothness::kink : StepSmoothness::smooth;
}

/// Whether what is iterated grows in the end, and its rate there; what grows in proportion to time and what
/// swings for a while does not: four times from the second quarter to the last one is looked at for longer,
/// up to a thousand times.
std::pair<bool, double> growth_of_iteration(const std::function<double()>& logarithm) {
  constexpr std::size_t first = steps_of_one_sided_growth / (vectors * stride), longest = 10 * first;
  constexpr double decided = 30, sure = 7;
  std::vector<double> sums;
  double sum = 0;
  const auto largest = [&](std::size_t from, std::size_t to) {
    const auto begin = sums.begin();
    return *std::max_element(begin + static_cast<std::ptrdiff_t>(from),
                             begin + static_cast<std::ptrdiff_t>(std::max(from + 1, to)));
  };
  double more = 0;
  for (std::size_t end = first;; end = longest) {
    while (sums.size() < end && std::abs(sum) < decided) sums.push_back(sum += logarithm());
    if (!std::isfinite(sum)) return {sum > 0, sum};
    const std::size_t n = sums.size();
    if (std::abs(sum) >= decided) return {sum > 0, sum / static_cast<double>(n)};
    more = largest(3 * n / 4, n) - largest(n / 4, n / 2);
    const bool grows = more > (end == longest ? sure / 2 : std::log(4.0));
    const double rate = 2 * more / static_cast<double>(n);
    if (!grows || end == longest) return {grows, rate};
  }
}

}  // namespace

std::string_view name_of(StepSmoothness smoothness) {
  constexpr std::array<std::string_view, 3> names{"smooth", "kink", "jump"};
  return names[static_cast<std::size_t>(smoothness)];
}

StepKink kink_of_step(ForeignStepper& engine, const StateCoordinates& coordinates, const VectorXd& scale,
                      int slot, const VectorXd& y, double h, const std::function<void()>& watch) {
  // Of more numbers one by one this would cost more than their derivative.
  constexpr Index most = 60;
  const Index n = coordinates.size();
  const StepDerivative derivative(engine, coordinates, scale, slot, y, h);
  StepKink found;
  if (!derivative.is_finite() || !std::isfinite(derivative.error())) return found;
  const Changes changes(engine, coordinates, scale, slot, y, h);
  // Rounding is no smaller for a smaller disturbance, and that of the chosen increment was of a vector whose
  // largest part is 1, not its norm.
  const double of_rounding = derivative.increment() * std::sqrt(static_cast<double>(n) / 3);
  const auto noise = [&](double e) { return derivative.error() * std::max(1.0, of_rounding / e); };
  const auto look = [&](const VectorXd& v, const std::function<Changes::Left(double)>& at) {
    if (watch) watch();
    const StepSmoothness kind = smoothness_of(at, noise);
    const bool is_new = kind == StepSmoothness::kink && found.kind == StepSmoothness::smooth;
    if (!is_new && kind != StepSmoothness::jump) return;
    Index most_moved = 0;
    v.cwiseAbs().maxCoeff(&most_moved);
    found = {.kind = kind, .number = coordinates.component(most_moved), .direction = v};
  };
  const auto both_ways = [&](const VectorXd& v) { return [&](double e) { return changes.opposites(v, e); }; };
  // Along one coordinate bodies may stay parallel that no other disturbance leaves so: no jumps there.
  for (Index j = 0; j < (n <= most ? n : 0) && found.kind == StepSmoothness::smooth; ++j) {
    const VectorXd v = VectorXd::Unit(n, j);
    if (smoothness_of(both_ways(v), noise) == StepSmoothness::kink) look(v, both_ways(v));
  }
  for (Index k = 0; k < 12 && found.kind != StepSmoothness::jump; ++k) {
    const VectorXd v = random_direction(n, k), w = random_direction(n, k + 12);
    look(v, both_ways(v));
    if (k < 4) look(v, [&](double e) { return changes.sum(v, w, e); });
  }
  return found;
}

double kink_along(ForeignStepper& engine, const StateCoordinates& coordinates, const VectorXd& scale,
                  int slot, const VectorXd& y, double h, const VectorXd& v, double increment) {
  return Changes(engine, coordinates, scale, slot, y, h).opposites(v, increment).left;
}

OneSidedGrowth one_sided_growth(ForeignStepper& engine, const StateCoordinates& coordinates,
                                const VectorXd& scale, int slot, const VectorXd& y, double h,
                                const std::function<void()>& watch) {
  const VectorXd next = engine.after(slot, y, h, stride);
  OneSidedGrowth worst{.rate = -infinity};
  if (!next.allFinite()) return {.grows = true, .rate = infinity, .motion = VectorXd::Zero(scale.size())};
  for (Index k = 0; k < vectors; ++k) {
    VectorXd x = (k % 2 ? -1 : 1) * random_direction(scale.size(), k / 2);
    // ln of the factor of a stride; x is of length 1 again.
    const auto advance = [&] {
      if (watch) watch();
      const VectorXd moved = coordinates.at(y, run_amplitude * x.cwiseProduct(scale));
      const VectorXd image =
          coordinates.of(next, engine.after(slot, moved, h, stride)).cwiseQuotient(run_amplitude * scale);
      const double size = image.norm();
      if (!std::isfinite(size)) return infinity;
      if (size > 0) x = image / size;
      return size > 0 ? std::log(size) : -infinity;
    };
    const auto [grows, rate] = growth_of_iteration(advance);
    if (k > 0 && (grows < worst.grows || (grows == worst.grows && !(rate > worst.rate)))) continue;
    worst = {.grows = grows, .rate = rate / static_cast<double>(stride), .motion = x.cwiseAbs()};
  }
  return worst;
}

}  // namespace hmax
