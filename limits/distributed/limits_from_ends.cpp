#include "limits/distributed/limits_from_ends.hpp"

#include <cmath>
#include <memory>

#include <fmt/format.h>

#include "analysis/amplification/curve_limit.hpp"
#include "core/coupled_mass.hpp"
#include "core/input_error.hpp"
#include "limits/modes/mode_curve.hpp"
#include "limits/modes/mode_range.hpp"
#include "problems/matrices/read_matrix.hpp"

namespace hmax {
namespace {

using Sparse = Eigen::SparseMatrix<double>;

double least(const StructureEnds& ends) { return ends.negative.value_or(0); }

/// Rows of a file that rank 0 reads for all.
MatrixRows rows_of(const std::string& name, bool is_mass) {
  MatrixFile file = read_matrix(name);
  if (is_mass && file.columns == 1 && file.storage == Storage::general) {
    for (MatrixEntry& entry : file.entries) entry = {entry.row(), entry.row(), entry.value()};
    file.columns = file.rows;
  }
  if (file.storage == Storage::skew)
    throw input_error("{} is skew-symmetric, and --engine petsc takes symmetric matrices; leave out --engine",
                      name);
  if (file.rows == file.columns && file.storage == Storage::general && is_one_triangle(file) &&
      !file.entries.empty())
    throw input_error(
        "{} holds one triangle of a matrix, and --engine petsc takes whole ones; write both triangles", name);
  return matrix_rows(assembled(file, file.rows, file.columns));
}

/// As set_range() of limits/modes/mode_range.hpp, with the model in the place of matrices.
void set_range(DistributedModel& model, ModeSet& modes) {
  const StructureEnds& ends = model.ends();
  modes.range = std::make_shared<ModeRange>();
  ModeRange& range = *modes.range;
  range.find = [&model](double a, double b, double tolerance) {
    const SumEnd end = model.largest_of_sum(a, b, tolerance);
    return LargestOfSum{.value = end.value,
                        .residual = end.residual,
                        .gamma = end.gamma,
                        .kappa = end.kappa,
                        .converged = end.converged};
  };
  range.most_c = ends.gamma_max;
  range.most_k = ends.kappa_max * (1 + ends.residual);
  const auto first = [&model](std::size_t most) {
    DampedEigenvalues found{.lambda = model.largest_damped(most), .rest = 0};
    found.rest = std::abs(found.lambda.back());
    return found;
  };
  range.largest = first(1);
  for (const std::size_t most : {2, 5, 12})
    range.searches.emplace_back([first, most] { return first(most); });
  range.rest = range.largest.rest;
  modes.spectrum.lambda = range.largest.lambda;
  if (ends.negative) range.growing = growing_eigenvalue(range.find, range.most_k);
  if (ends.negative && !range.growing)
    throw InputError(
        "K has a negative eigenvalue, and the motion that grows by it did not converge; leave out --engine petsc");
  if (range.growing)
    modes.spectrum.lambda.emplace_back(*range.growing);
  else
    range.tangents = std::make_unique<RangeTangents>(range.find, range.most_c, range.most_k);
}

}  // namespace

MatrixRows matrix_rows(const Eigen::SparseMatrix<double, Eigen::RowMajor>& matrix) {
  MatrixRows rows{.rows = matrix.rows(), .columns = matrix.cols()};
  rows.first.assign(matrix.outerIndexPtr(), matrix.outerIndexPtr() + matrix.rows() + 1);
  rows.column.assign(matrix.innerIndexPtr(), matrix.innerIndexPtr() + matrix.nonZeros());
  rows.value.assign(matrix.valuePtr(), matrix.valuePtr() + matrix.nonZeros());
  return rows;
}

Problem pair_with_ends(const std::string& id, const StructureEnds& ends) {
  // Both matrices have the vectors (1, 1) and (1, -1).
  const auto with_values = [](double of_sum, double of_difference) {
    Eigen::Matrix2d matrix;
    matrix << of_sum + of_difference, of_sum - of_difference, of_sum - of_difference, of_sum + of_difference;
    return Sparse((matrix / 2).sparseView());
  };
  const double mass_of_slow = ends.coupled_mass ? 2 : 1;
  MatrixModel model;
  model.K = with_values(mass_of_slow * least(ends), ends.kappa_max);
  model.mass = Eigen::Vector2d::Ones();
  if (ends.coupled_mass) {
    model.M = with_values(mass_of_slow, 1);
    model.coupled = std::make_shared<const CoupledMass>(model.M);
  }
  model.unknowns = {0, 1};
  Problem pair{.id = id,
               .parameters = {{"alpha", ends.alpha}, {"beta", ends.beta}},
               .y0 = Eigen::VectorXd::Zero(4),
               .t_end = 1,
               .system = system_of(model, ends.alpha, ends.beta)};
  return pair;
}

Linearised linearised(const Problem& pair, DistributedModel& model, StateKind kind) {
  const StructureEnds& ends = model.ends();
  Linearised near{.point = operating_point(pair, 0, pair.y0)};
  near.point.kind = kind;
  near.point.at_equilibrium = true;
  near.point.state =
      fmt::format("{}, {} states", kind == StateKind::rest ? "rest" : "the matrices", 2 * ends.unknowns);
  near.point.radius_bound = nullptr;
  if (ends.general_damping) {
    near.point.model.mechanical->damping = Damping::general;
    set_range(model, near.modes);
    return near;
  }
  // alpha + beta kappa of motions as slow as nobody knows.
  if (ends.alpha < -1e-9 * ends.beta * ends.kappa_max)
    throw input_error(
        "damping with alpha {:.6g} /s excites slow motions, and --engine petsc does not compute the slow end; leave out --engine",
        ends.alpha);
  DampingCurve curve{
      .alpha = ends.alpha, .beta = ends.beta, .kappa_min = least(ends), .kappa_max = ends.kappa_max};
  near.modes.slow_end = std::make_shared<SlowEnd>(curve.kappa_min);
  near.modes.curve = curve;
  for (const double kappa : {curve.kappa_min, curve.kappa_max}) {
    if (kappa == 0 && kappa != curve.kappa_max) continue;  // a bound is no mode
    near.modes.spectrum.mechanical.push_back(curve.at(kappa));
    for (const Complex lambda : eigenvalues_of(curve.at(kappa))) near.modes.spectrum.lambda.push_back(lambda);
  }
  return near;
}

DistributedStructure distributed_structure(const MatrixFiles& files, double alpha, double beta) {
  const auto refuse = [](bool given, const char* what) {
    if (given) throw input_error("--engine petsc does not take {}; leave out --engine", what);
  };
  refuse(!files.jacobian.empty(), "a jacobian, which is of first order");
  refuse(files.stiffness_series || files.damping_series, "series of matrices");
  refuse(files.one_triangle, "storage=triangle");
  refuse(files.drop_constraints, "drop=constraints");
  return {.stiffness = files.stiffness,
          .mass = files.mass,
          .damping = files.damping,
          .lumped = files.lumped,
          .alpha = alpha,
          .beta = beta,
          .read = rows_of};
}

}  // namespace hmax
