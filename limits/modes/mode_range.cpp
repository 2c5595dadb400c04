#include "limits/modes/mode_range.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>
#include <utility>

#include "analysis/amplification/amplification.hpp"
#include "analysis/spectrum/entry_rounding.hpp"
#include "analysis/spectrum/extreme_eigenvalues.hpp"
#include "analysis/statics/static_solution.hpp"
#include "core/input_error.hpp"
#include "core/numbers.hpp"
#include "core/size_limits.hpp"
#include "limits/modes/mode_curve.hpp"

namespace hmax {
namespace {

/// First exits of eigenvalues of which the method is told the same spectral radius.
std::vector<double> exits_of(const Amplification& amplification, std::vector<Eigenmode> modes,
                             double radius) {
  for (Eigenmode& mode : modes) mode.radius = radius;
  return largest_stable_step(amplification, modes).of_modes;
}

/// What all modes that are not known could do at worst, and what to do about it.
class WorstInRange {
 public:
  WorstInRange(const Amplification& amplification, ModeRange& modes, double radius)
      : amplification_(amplification), modes_(modes), radius_(radius), range_(modes.tangents->box()) {}

  /// Real eigenvalues up to the rest, and oscillations of the range up to it.
  [[nodiscard]] RangeLimit operator()(double rest) const {
    DampingRange range = range_;
    double fastest = 0;
    for (const MechanicalMode& corner : range.corners) fastest = std::max(fastest, corner.gamma);
    fastest = std::min(fastest, rest);
    range.cut(0, 1, rest * rest);
    RangeLimit worst = smallest_exit(range, [&](std::span<const MechanicalMode> pairs) {
      std::vector<Eigenmode> told;
      for (const MechanicalMode& pair : pairs) told.emplace_back(eigenvalues_of(pair)[0]);
      return exits_of(amplification_, std::move(told), radius_);
    });
    const double real = exits_of(amplification_, {Eigenmode(-fastest)}, radius_).front();
    return real < worst.h_max ? RangeLimit{real, {.kappa = 0, .gamma = fastest}} : worst;
  }

  /// Cuts off the worst mode by the tangent that is likely to cut off most. False where none of them may.
  /// @param inside  modes in the range
  bool cut(const MechanicalMode& worst, std::span<const MechanicalMode> inside) {
    std::optional<std::size_t> best;
    double most = 1e-9;  // of the box
    for (std::size_t i = 0; i < modes_.tangents->size(); ++i) {
      if (used_.contains(i)) continue;
      const double beyond = modes_.tangents->beyond(i, worst, inside);
      if (beyond > most) std::tie(best, most) = std::pair(i, beyond);
    }
    if (!best) return false;
    used_.insert(*best);
    modes_.tangents->cut(range_, *best);
    return true;
  }
  void cut_by_damping(double rho) { range_.cut(-1, rho, 0); }

 private:
  const Amplification& amplification_;
  ModeRange& modes_;
  double radius_;
  DampingRange range_;
  std::set<std::size_t> used_;
};

/// Whether the stiffness has a negative eigenvalue, as far as that is affordable to know.
bool may_buckle(const LinearModel& model, double kappa_max, bool is_body) {
  const MechanicalPart& part = *model.mechanical;
  if (affords_slow_end(model, is_body)) {
    const ExtremeStiffnesses least = smallest_stiffnesses(part, std::min<Eigen::Index>(7, part.mass.size()));
    // Within the rounding of few decimals it is a rigid-body mode.
    const double rounding = entry_rounding(part.K) * kappa_max;
    const auto rigid =
        std::ranges::count_if(least.kappa, [&](double kappa) { return kappa < 0 && -kappa <= rounding; });
    return !least.converged || least.negative > rigid;
  }
  return negative_stiffness(model, kappa_max, is_body).has_value();
}

}  // namespace

const DampedEigenvalues* ModeRange::more(std::size_t search) {
  const std::lock_guard lock(more_mutex_);
  if (search >= searches.size()) return nullptr;
  while (more_.size() <= search) more_.push_back(searches[more_.size()]());
  return &more_[search];
}

std::optional<Eigen::VectorXcd> ModeRange::shape_of(Complex lambda) {
  const std::lock_guard lock(more_mutex_);
  const auto in = [&](const DampedEigenvalues& found) -> std::optional<Eigen::VectorXcd> {
    for (std::size_t i = 0; i < found.lambda.size(); ++i)
      if (std::abs(found.lambda[i] - lambda) <= 1e-12 * std::abs(lambda)) return found.shapes[i];
    return {};
  };
  auto shape = in(largest);
  for (auto more = more_.begin(); !shape && more != more_.end(); ++more) shape = in(*more);
  return shape;
}

double ModeRange::least_damping(const MechanicalPart& part) {
  std::call_once(damping_once_, [&] {
    if (!find && part.mass.size() <= most_cheaply_factored)
      least_damping_ = least_damping_per_stiffness(part);
  });
  return least_damping_;
}

std::optional<CoupledLimit> ModeRange::first_exit(const Amplification& single,
                                                  const MechanicalPart& part) const {
  const MotionMap& map = single.motion.value();
  return find ? proved_first_exit(map, find, most_c, most_k, single) : proved_first_exit(map, part, single);
}

bool set_range(const LinearModel& model, ModeSet& modes, Eigen::Index small, bool is_body) {
  if (!model.mechanical) return false;
  const MechanicalPart& part = *model.mechanical;
  if (part.mass.size() <= small || !part.symmetric || part.damping != Damping::general) return false;
  modes.range = std::make_shared<ModeRange>();
  ModeRange& range = *modes.range;
  const auto matrices = std::make_shared<const ScaledMatrices>(part);
  constexpr double roughly = 1e-3;
  const LargestEigenpair k = matrices->largest_k(roughly), c = matrices->largest_c(roughly);
  if (may_buckle(model, k.bound, is_body))
    range.growing = growing_eigenvalue(matrices->largest_of_sum(c.bound, k.bound), k.bound);
  const auto search = std::make_shared<DampedSearch>(matrices, k, c);
  constexpr Eigen::Index most_products = 1000, few_products = 300;
  range.largest = search->first(1, most_products);
  const auto add = [&](std::size_t count) {
    range.searches.emplace_back([search, count] { return search->first(count, few_products); });
  };
  add(2);
  if (part.mass.size() <= most_cheaply_factored) {
    range.searches.emplace_back([matrices, k, c] { return many_damped_eigenvalues(*matrices, k, c); });
  } else {
    add(5);
    add(12);
  }
  range.rest = range.largest.rest;
  modes.spectrum.lambda = range.largest.lambda;
  if (range.growing)
    modes.spectrum.lambda.emplace_back(*range.growing);
  else
    range.tangents = std::make_unique<RangeTangents>(matrices, c.bound, k.bound);
  return true;
}

bool set_largest(const LinearModel& model, ModeSet& modes) {
  if (model.y.size() <= most_dense_rows) return false;
  const AnyMatrix J = model.J();
  if (!is_sparse(J)) return false;
  constexpr Eigen::Index few_restarts = 40;  // at 100,000 unknowns seconds
  LargestEigenvalues largest =
      largest_eigenvalues(std::get<Eigen::SparseMatrix<double>>(J), 4, small_enough_for_dense, few_restarts);
  if (!largest.converged)
    throw input_error(
        "the largest eigenvalues of {} states lie so close together that they did not converge, and all of "
        "them are too many; `hmax run` with --method and --h shows whether a step holds",
        model.y.size());
  modes.range = std::make_shared<ModeRange>();
  modes.range->open = true;
  for (Complex& lambda : largest.lambda) {
    // An undamped motion must not grow by the error of the iteration.
    if (std::abs(lambda.real()) <= 1e-8 * std::abs(lambda)) lambda.real(0);
    modes.spectrum.lambda.push_back(lambda);
  }
  modes.range->rest = std::abs(largest.lambda.back());
  return true;
}

LimitInRange limit_in_range(const Amplification& amplification, const MechanicalPart& part,
                            const ModeSet& modes, double radius) {
  LimitInRange limit{.h_max = infinity};
  std::vector<MechanicalMode> inside;
  const auto take = [&](const std::vector<Complex>& lambda) {
    limit = {.h_max = infinity};
    std::vector<Eigenmode> found;
    for (const Complex each : lambda)
      if (each.imag() >= 0) found.emplace_back(each);
    const std::vector<double> exits = exits_of(amplification, found, radius);
    for (std::size_t i = 0; i < found.size(); ++i) {
      if (found[i].lambda.imag() > 0) inside.push_back(MechanicalMode::of(found[i].lambda));
      found[i].radius = radius;
      limit.modes.push_back({mode_of(found[i].lambda), exits[i], found[i]});
      if (exits[i] >= limit.h_max) continue;
      limit.h_max = exits[i];
      limit.mode = limit.modes.back().mode;
    }
  };
  take(modes.spectrum.lambda);
  ModeRange& range = *modes.range;
  WorstInRange worst_in(amplification, range, radius);
  double rest = range.rest;
  std::size_t searched = 0;
  bool has_least_damping = false;
  for (;;) {
    const RangeLimit worst = worst_in(rest);
    if (worst.h_max >= limit.h_max * (1 - 1e-9)) return limit;
    const bool oscillates = worst.mode.kappa > 0;
    // More eigenvalues help where the worst mode is among those that they leave out, down to 0.9 of the
    // largest. The next one alone costs less than a tangent.
    const double modulus = oscillates ? std::sqrt(worst.mode.kappa) : worst.mode.gamma;
    const bool is_fast = modulus >= 0.9 * range.rest || std::isinf(rest);
    const auto find_more = [&] {
      const DampedEigenvalues* more = is_fast ? range.more(searched++) : nullptr;
      if (more != nullptr && more->rest < rest) {
        rest = more->rest;
        take(more->lambda);
      }
      return more != nullptr;
    };
    if (searched == 0 && find_more()) continue;
    if (oscillates && worst_in.cut(worst.mode, inside)) continue;
    if (!has_least_damping) {
      has_least_damping = true;
      if (const double rho = range.least_damping(part); rho > 0) {
        worst_in.cut_by_damping(rho);
        continue;
      }
    }
    if (find_more()) continue;
    limit.unstable_from = std::exchange(limit.h_max, worst.h_max);
    limit.mode = mode_of(worst.mode);
    return limit;
  }
}

}  // namespace hmax
