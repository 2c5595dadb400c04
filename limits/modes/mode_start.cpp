#include "limits/modes/mode_start.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <variant>

#include "analysis/spectrum/extreme_eigenvalues.hpp"
#include "analysis/spectrum/lanczos.hpp"
#include "integrators/linear/sparse_solver.hpp"
#include "limits/modes/mode_range.hpp"

namespace hmax {
namespace {

using Eigen::VectorXcd;
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
  const Eigenvectors vectors = eigenvectors_of(near.point.model);
  const auto at =
      std::ranges::min_element(vectors.lambda, {}, [&](Complex l) { return std::abs(l - wanted); });
  ModeStart start{.rest = rest,
                  .displacement = vectors.right.col(at - vectors.lambda.begin()).real(),
                  .distance = distance_from(rest, vectors, fastest),
                  .defective = vectors.defective};
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const double size = start.displacement.cwiseAbs().maxCoeff();
  for (double& x : start.displacement) x += 0.01 * size * uniform(random);
  return start;
}

StructureProducts products_of(const MechanicalPart& part) {
  const auto K = std::make_shared<const AnyMatrix>(part.K);
  return {.mass_times = [mass = std::make_shared<const MassMatrix<double>>(part.mass)](
                            const VectorXd& x) -> VectorXd { return mass->times(x); },
          .stiffness_times =
              [K](const VectorXd& x) {
                return std::visit([&](const auto& held) -> VectorXd { return held * x; }, *K);
              }};
}

/// From a displacement and a velocity, and a hundredth of everything else.
ModeStart start_of(const MechanicalPart& part, const StructureProducts& products, const VectorXd& rest,
                   const VectorXd& q, const VectorXd& v) {
  ModeStart start = energy_start(products, rest, q, v, part.mass.root_solve(start_vector(q.size())));
  start.large = part.mass.size() > most_cheaply_factored;
  return start;
}

/// A mode of a structure: (lambda^2 M + lambda C + K) u = 0.
struct StructureMode {
  Complex lambda;
  VectorXcd shape;         ///< u, shape (n)
  bool defective = false;  ///< lambda is double, with this shape alone
};

/// By inverse iteration beside an eigenvalue that is known: the factors of one matrix of n rows.
VectorXcd shape_near(const MechanicalPart& part, Complex lambda) {
  // The eigenvalue itself would leave nothing to divide by.
  const Complex beside = lambda * (1 + 1e-9);
  Eigen::SparseMatrix<Complex> Q =
      std::get<Sparse>(part.K).cast<Complex>() + beside * std::get<Sparse>(part.C).cast<Complex>();
  Q += Eigen::SparseMatrix<Complex>(beside * beside * part.mass.matrix().cast<Complex>());
  Q.makeCompressed();
  SparseSolver<Complex> solver;
  VectorXcd u = start_vector(part.mass.size()).cast<Complex>();
  if (!solver.factor(Q)) return u;
  for (int k = 0; k < 3; ++k) {
    solver.solve(u);
    u.normalize();
  }
  return u;
}

StructureMode structure_mode(const Linearised& near, Complex wanted) {
  const MechanicalPart& part = *near.point.model.mechanical;
  if (!part.decouples()) {
    const auto known = near.modes.range ? near.modes.range->shape_of(wanted) : std::nullopt;
    return {wanted, known ? *known : shape_near(part, wanted)};
  }
  const MechanicalMode mode = oscillation_of(near, wanted);
  const auto lambda = eigenvalues_of(mode);
  const Complex own = std::abs(lambda[0] - wanted) <= std::abs(lambda[1] - wanted) ? lambda[0] : lambda[1];
  return {own, shape_of_mode(near, mode).cast<Complex>(),
          std::abs(lambda[0] - lambda[1]) <= 1 / defective_condition * std::abs(lambda[0])};
}

ModeStart structure_start(const Linearised& near, const VectorXd& rest, Complex wanted) {
  const MechanicalPart& part = *near.point.model.mechanical;
  const StructureMode mode = structure_mode(near, wanted);
  const StructureProducts products = products_of(part);
  ModeStart start = start_of(part, products, rest, mode.shape.real(), (mode.lambda * mode.shape).real());
  start.defective = mode.defective;
  if (part.decouples()) follow(start, products, mode.shape.real());
  if (start.defective) return start;
  const VectorXcd of_velocity = part.mass.times(mode.shape);
  const VectorXcd of_position = mode.lambda * of_velocity + std::get<Sparse>(part.C) * mode.shape;
  start.amplitude = amplitude_from(rest, of_position, of_velocity, products);
  return start;
}

}  // namespace

MechanicalMode oscillation_of(const Linearised& near, Complex lambda) {
  const auto distance = [&](const MechanicalMode& mode) {
    const auto pair = eigenvalues_of(mode);
    return std::min(std::abs(pair[0] - lambda), std::abs(pair[1] - lambda));
  };
  const auto& modes = near.modes.spectrum.mechanical;
  const MechanicalMode listed = *std::ranges::min_element(modes, {}, distance);
  if (!near.modes.curve || distance(listed) <= 1e-9 * std::abs(lambda)) return listed;
  // Of lambda^2 + (alpha + beta kappa) lambda + kappa = 0.
  const Complex kappa =
      -(lambda * lambda + near.modes.curve->alpha * lambda) / (1.0 + near.modes.curve->beta * lambda);
  return near.modes.curve->at(kappa.real());
}

VectorXd shape_of_mode(const Linearised& near, const MechanicalMode& mode) {
  const MechanicalPart& part = *near.point.model.mechanical;
  double largest = 0;
  for (const MechanicalMode& each : near.modes.spectrum.mechanical) largest = std::max(largest, each.kappa);
  const bool is_fastest = mode.kappa >= largest * (1 - 1e-12);
  if (is_fastest && near.modes.fastest_shape.size() > 0) return near.modes.fastest_shape;
  const ExtremeStiffnesses found =
      is_fastest ? largest_stiffnesses(part) : stiffnesses_near(part, mode.kappa);
  return found.shapes.col(0);
}

ModeStart start_from_shape(const MechanicalPart& part, const VectorXd& rest, const VectorXd& shape,
                           double h) {
  const StructureProducts products = products_of(part);
  ModeStart start = start_of(part, products, rest, shape, 2 / h * shape);
  follow(start, products, shape / std::sqrt(shape.dot(part.mass.times(shape))));
  start.disturbance = 1e-3;
  return start;
}

ModeStart start_from_mode(const Linearised& near, const VectorXd& rest, Complex wanted, double fastest) {
  const auto& part = near.point.model.mechanical;
  const bool structure = part && part->symmetric && is_sparse(part->K) && is_sparse(part->C) &&
                         part->mass.size() > most_dense_start;
  return structure ? structure_start(near, rest, wanted) : dense_start(near, rest, wanted, fastest);
}

}  // namespace hmax
