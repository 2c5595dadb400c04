#include "bench/mode_curve.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/SparseCore>
#include <fmt/format.h>

#include "analysis/amplification.hpp"
#include "analysis/block_product.hpp"
#include "analysis/extreme_eigenvalues.hpp"
#include "analysis/lanczos.hpp"

namespace hmax {
namespace {

/// A mode is named by the upper eigenvalue, or by the faster of two real ones.
Complex name_of_mode(const MechanicalMode& mode) {
  const auto pair = eigenvalues_of(mode);
  return pair[0].imag() != 0 ? pair[0] : pair[1];
}

/// The least eigenvalue of K u = kappa M u.
double least_stiffness(const MechanicalPart& part, double kappa_max) {
  const Eigen::SparseMatrix<double> K =
      is_sparse(part.K) ? std::get<Eigen::SparseMatrix<double>>(part.K)
                        : Eigen::SparseMatrix<double>(std::get<Eigen::MatrixXd>(part.K).sparseView());
  const SymmetricProduct product(K, part.mass.cwiseSqrt().cwiseInverse());
  const LanczosPair pair = largest_eigenpair(
      [&](const Eigen::VectorXd& x, Eigen::VectorXd& y) {
        product(x, y);
        y = kappa_max * x - y;
      },
      part.mass.size(), {.tolerance = 1e-8, .with_vector = false});
  return kappa_max - pair.value;
}

}  // namespace

bool set_curve(Linearised& near, Eigen::Index small) {
  if (!near.model.mechanical || near.model.mechanical->mass.size() <= small) return false;
  const MechanicalPart& part = *near.model.mechanical;
  const auto rayleigh = rayleigh_coefficients(part);
  if (!rayleigh) return false;
  const ExtremeStiffnesses largest = largest_stiffnesses(part);
  DampingCurve curve{.alpha = (*rayleigh)[0], .beta = (*rayleigh)[1], .kappa_max = largest.kappa.at(0)};
  // Where a factor is too large all from zero on are served.
  if (const ExtremeStiffnesses least = smallest_stiffnesses(part); least.converged) {
    // Those nearest to zero; a body that buckles has others.
    curve.kappa_min = std::abs(least.kappa.at(0)) <= 1e-12 * curve.kappa_max ? 0 : least.kappa.at(0);
    // Known to be below zero by that much, whatever the iteration for the least of them says.
    if (least.negative > 0)
      curve.kappa_min = std::min(least_stiffness(part, curve.kappa_max), -1e-8 * curve.kappa_max);
  }
  for (const double kappa : {curve.kappa_min, curve.kappa_max}) {
    near.spectrum.mechanical.push_back(curve.at(kappa));
    for (const Complex lambda : eigenvalues_of(curve.at(kappa))) near.spectrum.lambda.push_back(lambda);
  }
  near.curve = curve;
  return true;
}

LimitOnCurve limit_on_curve(const Amplification& amplification, const Linearised& near, double radius) {
  const ExitsOf exits = [&](std::span<const MechanicalMode> modes) {
    if (amplification.of_oscillation) return largest_stable_step(amplification, modes).of_modes;
    std::vector<Eigenmode> told;
    for (const MechanicalMode& mode : modes)
      for (const Complex lambda : eigenvalues_of(mode)) told.emplace_back(lambda).radius = radius;
    const StepLimit limit = largest_stable_step(amplification, told);
    std::vector<double> least;
    for (std::size_t i = 0; i < modes.size(); ++i)
      least.push_back(std::min(limit.of_modes[2 * i], limit.of_modes[2 * i + 1]));
    return least;
  };
  const DampingCurve& curve = *near.curve;
  const CurveLimit least = smallest_exit(curve, exits);
  LimitOnCurve limit{
      .h_max = least.h_max, .lambda = name_of_mode(curve.at(least.kappa)), .modes = {}, .note = {}};
  std::vector<MechanicalMode> shown{curve.at(curve.kappa_min), curve.at(curve.kappa_max)};
  if (least.between) shown.push_back(curve.at(least.kappa));
  const std::vector<double> margins = exits(shown);
  for (std::size_t i = 0; i < shown.size(); ++i) {
    const Complex lambda = name_of_mode(shown[i]);
    limit.modes.push_back({mode_of(lambda), margins[i], Eigenmode(lambda)});
    limit.modes.back().told.radius = radius;
  }
  if (!least.between || !std::isfinite(least.h_max)) return limit;
  limit.note =
      "no mode has a smaller limit; it is that of a frequency between the slowest and the fastest mode";
  const ExtremeStiffnesses nearest = stiffnesses_near(*near.model.mechanical, least.kappa);
  if (nearest.converged) {
    const MechanicalMode mode = curve.at(nearest.kappa.front());
    limit.note += fmt::format(", and the mode nearest to that, at {:.6g} rad/s, has {:.6g} s",
                              std::sqrt(mode.kappa), exits({&mode, 1}).front());
  }
  return limit;
}

}  // namespace hmax
