#include "limits/by_steps/step_map.hpp"

#include <limits>
#include <memory>

#include <Eigen/Cholesky>
#include <fmt/format.h>

#include "integrators/linear/sparse_solver.hpp"
#include "limits/by_steps/old_jacobian.hpp"

namespace hmax {
namespace {

using Eigen::VectorXd;
using Sparse = Eigen::SparseMatrix<double>;

bool is_positive_definite(const Sparse& K) {
  if (K.rows() > most_factored_often) return false;
  SparseSolver<double> solver;
  solver.set({.by = LinearSolve::By::direct});
  return solver.factor(K) && solver.is_symmetric() && solver.negative_eigenvalues() == 0;
}
bool is_positive_definite(const Eigen::MatrixXd& K) { return K.llt().info() == Eigen::Success; }

}  // namespace

std::string name_with(const Method& method, const StepChoices& options) {
  return fmt::format("{}, Jacobian {}, {}", method.id, to_string(options.jacobian),
                     to_string(options.linear));
}

std::string id_in(const std::string& name) { return name.substr(0, name.find(", ")); }

bool takes_step_options(const Method& method) {
  return method.linearly_implicit && !method.is_foreign() && method.fixed_step && method.bind;
}

StepMapAt step_maps(const Method& method, const LinearModel& model, const LinearModel& jacobian,
                    const LinearSolve& linear) {
  const auto problem = std::make_shared<Problem>();
  problem->id = "linear model";
  problem->t_end = 1;
  problem->system = with_jacobian_of(jacobian, linear_part(model), true,
                                     method.needs_split ? linear_stiff_part(model) : nullptr);
  return [method, problem, linear](double h) -> StepMap {
    return [=](const VectorXd& y, int steps) -> VectorXd {
      VectorXd lost = VectorXd::Constant(y.size(), std::numeric_limits<double>::quiet_NaN());
      if (!y.allFinite()) return lost;
      // Engines that solve to a tolerance take numbers of about one.
      const double size = y.cwiseAbs().maxCoeff();
      if (size == 0) return y;
      Problem started = *problem;
      started.y0 = y / size;
      // The Jacobian is the same at each step: its factor is kept.
      RunSpec spec{.t_end = steps * h, .h = h, .jacobian = {JacobianUpdate::frozen}};
      spec.linear_solve = linear;
      const RunRecord record = method.bind(started).run(spec, {});
      return record.outcome == Outcome::reached_end ? VectorXd(size * record.y) : lost;
    };
  };
}

LinearOperator energy_product(const LinearModel& model) {
  if (!model.mechanical || !model.mechanical->symmetric) return {};
  const auto part = std::make_shared<const MechanicalPart>(*model.mechanical);
  if (!std::visit([](const auto& K) { return is_positive_definite(K); }, part->K)) return {};
  return [part](const VectorXd& y) {
    const Eigen::Index n = part->mass.size();
    VectorXd weighted(2 * n);
    std::visit([&](const auto& K) { weighted.head(n).noalias() = K * y.head(n); }, part->K);
    weighted.tail(n) = part->mass.times(VectorXd(y.tail(n)));
    return weighted;
  };
}

}  // namespace hmax
