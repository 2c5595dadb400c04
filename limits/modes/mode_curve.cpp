#include "limits/modes/mode_curve.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "analysis/amplification/amplification.hpp"
#include "analysis/spectrum/davidson.hpp"
#include "analysis/spectrum/entry_rounding.hpp"
#include "analysis/spectrum/extreme_eigenvalues.hpp"
#include "analysis/spectrum/lanczos.hpp"
#include "analysis/spectrum/scaled_matrices.hpp"

namespace hmax {
namespace {

/// The least eigenvalue of K u = kappa M u: of those that iteration finds, the least, which none is above.
double least_stiffness(const MechanicalPart& part, double kappa_max, Eigen::Index most_products) {
  const MassScaledProduct product(part.K, part.mass);
  const LanczosPair pair = largest_eigenpair(
      [&](const Eigen::VectorXd& x, Eigen::VectorXd& y) {
        product.unscaled()(x, y);
        y = kappa_max * (part.mass.is_diagonal() ? x : part.mass.times(x)) - y;
      },
      part.mass, {.tolerance = 1e-8, .most_products = most_products, .with_vector = false});
  return kappa_max - pair.value;
}

/// The slow end of the curve, from a factor of K; 0 where the factor is too large.
double slow_end(const MechanicalPart& part, double kappa_max) {
  if (part.mass.size() > most_factored) return 0;
  const ExtremeStiffnesses least = smallest_stiffnesses(part);
  if (!least.converged) return 0;
  // Those nearest to zero; a body that buckles has others.
  const double nearest = std::abs(least.kappa.at(0)) <= 1e-12 * kappa_max ? 0 : least.kappa.at(0);
  if (least.negative == 0) return nearest;
  const double lowest = least_stiffness(part, kappa_max, 2000);
  // Within the rounding of few decimals, which whoever asks for the modes judges.
  if (const double rounding = entry_rounding(part.K); rounding > 0 && -lowest <= rounding * kappa_max)
    return lowest;
  // Known to be below zero by that much, whatever the iteration for the least of them says.
  return std::min(lowest, -1e-8 * kappa_max);
}

/// Whether the model is that of a body without displacement, whose stiffness has no negative eigenvalue.
bool is_undeformed(const LinearModel& model, bool is_body) {
  return is_body && model.y.head(model.mechanical->mass.size()).isZero(0);
}

}  // namespace

bool affords_slow_end(const LinearModel& model, bool is_body) {
  const Eigen::Index dofs = model.mechanical->mass.size();
  return dofs <= most_cheaply_factored ||
         (is_body && dofs <= most_factored && !is_undeformed(model, is_body));
}

std::optional<double> negative_stiffness(const LinearModel& model, double kappa_max, bool is_body) {
  constexpr Eigen::Index few_products = 100, many_products = 300;
  if (is_undeformed(model, is_body)) return {};
  const double least = least_stiffness(*model.mechanical, kappa_max, is_body ? many_products : few_products);
  if (!(least < -std::max(1e-8, entry_rounding(model.mechanical->K)) * kappa_max)) return {};
  return least;
}

double SlowEnd::of(const MechanicalPart& part, const DampingCurve& curve) {
  if (!is_bound_)
    std::call_once(once_, [&] {
      kappa_ = slow_end(part, curve.kappa_max);
      if (-kappa_ <= entry_rounding(part.K) * curve.kappa_max) kappa_ = std::max(kappa_, 0.0);
    });
  return kappa_;
}

bool set_curve(const LinearModel& model, ModeSet& modes, Eigen::Index small, bool is_body) {
  if (!model.mechanical || model.mechanical->mass.size() <= small) return false;
  const MechanicalPart& part = *model.mechanical;
  const auto rayleigh = rayleigh_coefficients(part);
  if (!rayleigh) return false;
  // Who describes the fastest mode at rest asks for its shape; under a load it is another mode.
  const bool at_rest = model.y.isZero(0);
  const ExtremeStiffnesses largest = largest_stiffnesses(part, 1, small_enough_for_dense, at_rest);
  DampingCurve curve{.alpha = (*rayleigh)[0], .beta = (*rayleigh)[1], .kappa_max = largest.kappa.at(0)};
  if (at_rest) modes.fastest_shape = largest.shapes.col(0);
  modes.slow_end = std::make_shared<SlowEnd>();
  modes.curve = curve;
  // The slow end takes a factor of K, which most limits do not need; only a body that may buckle does.
  if (affords_slow_end(model, is_body)) {
    modes.curve->kappa_min = slow_end(part, curve.kappa_max);
    modes.slow_end = nullptr;
  } else if (const auto least = negative_stiffness(model, curve.kappa_max, is_body)) {
    modes.curve->kappa_min = *least;
  }
  const auto add = [&](double kappa) {
    modes.spectrum.mechanical.push_back(modes.curve->at(kappa));
    for (const Complex lambda : eigenvalues_of(modes.curve->at(kappa)))
      modes.spectrum.lambda.push_back(lambda);
  };
  if (!modes.slow_end || modes.curve->kappa_min < 0) add(modes.curve->kappa_min);
  add(modes.curve->kappa_max);
  return true;
}

LimitOnCurve limit_on_curve(const Amplification& amplification, const MechanicalPart& part,
                            const ModeSet& modes, double radius) {
  const auto exits_of = [&](std::span<const MechanicalMode> of, Exits wanted) {
    if (amplification.of_oscillation) return largest_stable_step(amplification, of).of_modes;
    std::vector<Eigenmode> told;
    for (const MechanicalMode& mode : of)
      for (const Complex lambda : eigenvalues_of(mode)) told.emplace_back(lambda).radius = radius;
    const StepLimit limit = largest_stable_step(amplification, told, wanted);
    std::vector<double> least;
    for (std::size_t i = 0; i < of.size(); ++i)
      least.push_back(std::min(limit.of_modes[2 * i], limit.of_modes[2 * i + 1]));
    return least;
  };
  // The fastest modes come last, whose exits are the least as a rule.
  const ExitsOf exits = [&](std::span<const MechanicalMode> of) { return exits_of(of, Exits::least); };
  DampingCurve curve = *modes.curve;
  CurveLimit least = smallest_exit(curve, exits);
  const bool is_of_fastest = least.kappa == curve.kappa_max;
  if (modes.slow_end && !is_of_fastest) {
    curve.kappa_min = modes.slow_end->of(part, curve);
    least = smallest_exit(curve, exits);
  }
  LimitOnCurve limit{.h_max = least.h_max, .mode = mode_of(curve.at(least.kappa))};
  std::vector<MechanicalMode> shown;
  if (!modes.slow_end || !is_of_fastest) shown.push_back(curve.at(curve.kappa_min));
  shown.push_back(curve.at(curve.kappa_max));
  if (least.between) shown.push_back(curve.at(least.kappa));
  const std::vector<double> margins = exits_of(shown, Exits::all);
  for (std::size_t i = 0; i < shown.size(); ++i) {
    const Mode mode = mode_of(shown[i]);
    limit.modes.push_back({mode, margins[i], Eigenmode(mode.lambda)});
    limit.modes.back().told.radius = radius;
  }
  if (!least.between || !std::isfinite(least.h_max)) return limit;
  limit.note =
      "no mode has a smaller limit; it is that of a frequency between the slowest and the fastest mode";
  if (part.mass.size() > most_factored || (modes.slow_end && modes.slow_end->is_bound())) return limit;
  const ExtremeStiffnesses nearest = stiffnesses_near(part, least.kappa);
  if (nearest.converged) {
    const MechanicalMode mode = curve.at(nearest.kappa.front());
    limit.note += fmt::format(", and the mode nearest to that, at {:.6g} rad/s, has {:.6g} s",
                              std::sqrt(mode.kappa), exits({&mode, 1}).front());
  }
  return limit;
}

}  // namespace hmax
