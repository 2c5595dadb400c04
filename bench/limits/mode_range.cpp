#include "bench/limits/mode_range.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "analysis/amplification/amplification.hpp"
#include "analysis/spectrum/damped_eigenvalues.hpp"
#include "analysis/spectrum/extreme_eigenvalues.hpp"
#include "analysis/statics/static_solution.hpp"
#include "bench/limits/mode_curve.hpp"
#include "core/size_limits.hpp"
#include "results/errors.hpp"

namespace hmax {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Whether the stiffness has a negative eigenvalue, as far as that is affordable to know.
bool may_buckle(const MechanicalPart& part) {
  if (part.mass.size() > most_factored_often) return true;
  const ExtremeStiffnesses least = smallest_stiffnesses(part);
  return !least.converged || least.negative > 0;
}

/// First exits of eigenvalues of which the method is told the same spectral radius.
std::vector<double> exits_of(const Amplification& amplification, std::vector<Eigenmode> modes,
                             double radius) {
  for (Eigenmode& mode : modes) mode.radius = radius;
  return largest_stable_step(amplification, modes).of_modes;
}

}  // namespace

const DampingRange& ModeRange::with_least_damping(const MechanicalPart& part) {
  std::call_once(once_, [&] {
    cut_ = pairs;
    if (part.mass.size() > most_cheaply_factored) return;
    const double rho = least_damping_per_stiffness(part);
    cut_.cut(-1, rho, 0);
  });
  return cut_;
}

bool set_range(const LinearModel& model, ModeSet& modes, Eigen::Index small) {
  if (!model.mechanical) return false;
  const MechanicalPart& part = *model.mechanical;
  if (part.mass.size() <= small || !part.symmetric || part.damping != Damping::general) return false;
  modes.range = std::make_shared<ModeRange>();
  if (may_buckle(part)) modes.range->growing = growing_eigenvalue(part);
  const DampedEigenvalues largest = largest_damped_eigenvalues(part);
  modes.range->rest = largest.rest;
  modes.spectrum.lambda = largest.lambda;
  if (modes.range->growing)
    modes.spectrum.lambda.emplace_back(*modes.range->growing);
  else
    modes.range->pairs = damping_range(part);
  return true;
}

bool set_largest(const LinearModel& model, ModeSet& modes) {
  if (model.y.size() <= most_dense_rows || !has_krylov()) return false;
  const AnyMatrix J = model.J();
  if (!is_sparse(J)) return false;
  constexpr Eigen::Index few_restarts = 40;  // at 100,000 unknowns seconds
  LargestEigenvalues largest = largest_eigenvalues(std::get<Eigen::SparseMatrix<double>>(J), 4, small_enough_for_dense, few_restarts);
  if (!largest.converged)
    throw InputError(
        fmt::format("the largest eigenvalues of {} states lie so close together that they did not converge, and all of "
                    "them are too many; `hmax run` with --method and --h shows whether a step holds",
                    model.y.size()));
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
  LimitInRange limit{.h_max = infinity, .mode = {}, .modes = {}, .unstable_from = {}};
  std::vector<Eigenmode> found;
  for (const Complex lambda : modes.spectrum.lambda)
    if (lambda.imag() >= 0) found.emplace_back(lambda);
  const std::vector<double> exits = exits_of(amplification, found, radius);
  for (std::size_t i = 0; i < found.size(); ++i) {
    found[i].radius = radius;
    limit.modes.push_back({mode_of(found[i].lambda), exits[i], found[i]});
    if (exits[i] >= limit.h_max) continue;
    limit.h_max = exits[i];
    limit.mode = limit.modes.back().mode;
  }
  const double known = limit.h_max;

  // What all other modes could do at worst: real eigenvalues up to the rest, and oscillations of the range.
  const auto worst_in = [&](DampingRange range) {
    double fastest = 0;
    for (const MechanicalMode& corner : range.corners) fastest = std::max(fastest, corner.gamma);
    fastest = std::min(fastest, modes.range->rest);
    range.cut(0, 1, modes.range->rest * modes.range->rest);
    RangeLimit worst = smallest_exit(range, [&](std::span<const MechanicalMode> pairs) {
      std::vector<Eigenmode> told;
      for (const MechanicalMode& pair : pairs) told.emplace_back(eigenvalues_of(pair)[0]);
      return exits_of(amplification, std::move(told), radius);
    });
    if (const double real = exits_of(amplification, {Eigenmode(-fastest)}, radius).front();
        real < worst.h_max)
      worst = {real, {.kappa = 0, .gamma = fastest}};
    return worst;
  };
  RangeLimit worst = worst_in(modes.range->pairs);
  if (worst.h_max < known) worst = worst_in(modes.range->with_least_damping(part));
  if (worst.h_max >= known * (1 - 1e-9)) return limit;
  limit.h_max = worst.h_max;
  limit.mode = mode_of(worst.mode);
  limit.unstable_from = known;
  return limit;
}

}  // namespace hmax
