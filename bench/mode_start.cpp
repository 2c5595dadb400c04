#include "bench/mode_start.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "analysis/extreme_eigenvalues.hpp"
#include "analysis/lanczos.hpp"

namespace hmax {
namespace {

using Eigen::VectorXd;
using Sparse = Eigen::SparseMatrix<double>;

/// Distance from rest in the modes of the model, where it has a full set of them; otherwise in a norm like
/// energy.
Distance distance_from(const VectorXd& rest, const Eigenvectors& vectors, double omega) {
  if (!vectors.defective)
    return [rest, left = vectors.left](const Eigen::Ref<const VectorXd>& y) {
      return (left * (y - rest).cast<Complex>()).cwiseAbs().maxCoeff();
    };
  const Eigen::Index n = rest.size() / 2;
  return [rest, n, omega](const Eigen::Ref<const VectorXd>& y) {
    const VectorXd d = y - rest;
    return std::max(omega * d.head(n).norm(), d.tail(d.size() - n).norm());
  };
}

ModeStart dense_start(const Linearised& near, const VectorXd& rest, Complex wanted, double fastest) {
  const Eigenvectors vectors = eigenvectors_of(near.model);
  const auto at =
      std::ranges::min_element(vectors.lambda, {}, [&](Complex l) { return std::abs(l - wanted); });
  ModeStart start{.displacement = vectors.right.col(at - vectors.lambda.begin()).real(),
                  .distance = distance_from(rest, vectors, fastest),
                  .defective = vectors.defective};
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const double size = start.displacement.cwiseAbs().maxCoeff();
  for (double& x : start.displacement) x += 0.01 * size * uniform(random);
  return start;
}

/// (v^T M v + q^T K q)^1/2 of the distance from rest, which no undamped motion changes.
Distance energy_from(const VectorXd& rest, const MechanicalPart& part) {
  return [rest, mass = part.mass, K = std::get<Sparse>(part.K), d = VectorXd(),
          Kq = VectorXd()](const Eigen::Ref<const VectorXd>& y) mutable {
    const Eigen::Index n = mass.size();
    d = y - rest;
    Kq.noalias() = K.selfadjointView<Eigen::Lower>() * d.head(n);
    const double twice = d.head(n).dot(Kq) + d.tail(n).dot(mass.cwiseProduct(d.tail(n)));
    return std::isfinite(twice) ? std::sqrt(std::max(twice, 0.0)) : std::numeric_limits<double>::infinity();
  };
}

ModeStart structure_start(const Linearised& near, const VectorXd& rest, Complex wanted) {
  const MechanicalPart& part = *near.model.mechanical;
  const MechanicalMode mode = oscillation_of(near, wanted);
  const VectorXd shape = shape_of_mode(near, mode);
  const Eigen::Index n = shape.size();
  const auto lambda = eigenvalues_of(mode);
  const Complex own = std::abs(lambda[0] - wanted) <= std::abs(lambda[1] - wanted) ? lambda[0] : lambda[1];
  ModeStart start{.displacement = VectorXd(2 * n), .distance = energy_from(rest, part)};
  start.displacement << shape, own.real() * shape;
  // Velocities of a hundredth of its energy norm.
  const VectorXd noise = start_vector(n).cwiseQuotient(part.mass.cwiseSqrt());
  const double size = std::sqrt(std::abs(mode.kappa) + own.real() * own.real());
  start.displacement.tail(n) += 0.01 * size / std::sqrt(noise.dot(part.mass.cwiseProduct(noise))) * noise;
  start.displacement.normalize();
  start.defective = std::abs(lambda[0] - lambda[1]) <= 1 / defective_condition * std::abs(lambda[0]);
  start.mode_alone = true;
  return start;
}

}  // namespace

MechanicalMode oscillation_of(const Linearised& near, Complex lambda) {
  const auto distance = [&](const MechanicalMode& mode) {
    const auto pair = eigenvalues_of(mode);
    return std::min(std::abs(pair[0] - lambda), std::abs(pair[1] - lambda));
  };
  const auto& modes = near.spectrum.mechanical;
  const MechanicalMode listed = *std::ranges::min_element(modes, {}, distance);
  if (!near.curve || distance(listed) <= 1e-9 * std::abs(lambda)) return listed;
  // Of lambda^2 + (alpha + beta kappa) lambda + kappa = 0.
  const Complex kappa = -(lambda * lambda + near.curve->alpha * lambda) / (1.0 + near.curve->beta * lambda);
  return near.curve->at(kappa.real());
}

VectorXd shape_of_mode(const Linearised& near, const MechanicalMode& mode) {
  const MechanicalPart& part = *near.model.mechanical;
  double largest = 0;
  for (const MechanicalMode& each : near.spectrum.mechanical) largest = std::max(largest, each.kappa);
  const ExtremeStiffnesses found =
      mode.kappa >= largest * (1 - 1e-12) ? largest_stiffnesses(part) : stiffnesses_near(part, mode.kappa);
  return found.shapes.col(0);
}

ModeStart start_from_mode(const Linearised& near, const VectorXd& rest, Complex wanted, double fastest) {
  const auto& part = near.model.mechanical;
  const bool structure = part && part->decouples() && is_sparse(part->K) &&
                         part->mass.size() > most_dense_start && !near.spectrum.mechanical.empty();
  return structure ? structure_start(near, rest, wanted) : dense_start(near, rest, wanted, fastest);
}

}  // namespace hmax
