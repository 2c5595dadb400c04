#include "analysis/inner_solver.hpp"

#include <cmath>

namespace hmax {
namespace {

using Eigen::VectorXd;
using Matrix = StaticModel::Matrix;

/// d = K^-1 r by sweeps of successive over-relaxation over the rows of the symmetric K, from d = 0:
///   d_i <- d_i + omega (r_i - sum_j K_ij d_j) / K_ii.
/// @returns the number of sweeps; negative when it was not enough
int relax(const Matrix& K, const VectorXd& r, VectorXd& d, double omega, double tolerance, int most) {
  d.setZero(r.size());
  const double goal = tolerance * r.norm();
  VectorXd left(r.size());
  for (int sweep = 1; sweep <= most; ++sweep) {
    for (Eigen::Index i = 0; i < K.cols(); ++i) {
      double rest = r[i], diagonal = 0;
      for (Matrix::InnerIterator entry(K, i); entry; ++entry) {
        if (entry.row() == i) diagonal = entry.value();
        rest -= entry.value() * d[entry.row()];
      }
      d[i] += omega * rest / diagonal;
    }
    // The residual costs as much as a sweep.
    if (sweep % 8 != 0 && sweep != most) continue;
    left.noalias() = r - K * d;
    const double size = left.norm();
    if (!std::isfinite(size)) return -sweep;
    if (size <= goal) return sweep;
  }
  return -most;
}

}  // namespace

Inner::Inner(const StaticSettings& settings) : settings_(settings) {
  set_tolerance(settings.inner_tolerance.value_or(1e-4));
}

void Inner::set_tolerance(double tolerance) {
  tolerance_ = tolerance;
  const bool iterates = settings_.inner == InnerSolver::conjugate_gradients;
  solver_.set({.by = iterates ? LinearSolve::By::conjugate_gradients : LinearSolve::By::direct,
               .tolerance = tolerance});
}

bool Inner::take(const Matrix& K) {
  if (settings_.inner != InnerSolver::sor) return solver_.factor(K);
  K_ = K;
  return K.diagonal().cwiseAbs().minCoeff() > 0;
}

bool Inner::is_indefinite() const {
  const int unknown = settings_.inner == InnerSolver::direct ? 1 : 0;
  return settings_.inner != InnerSolver::sor && solver_.negative_eigenvalues().value_or(unknown) > 0;
}

bool Inner::solve(const VectorXd& r, VectorXd& d) {
  if (settings_.inner == InnerSolver::sor) {
    const int sweeps = relax(K_, r, d, settings_.relaxation, tolerance_, settings_.inner_iterations);
    iterations_ += std::abs(sweeps);
    return sweeps > 0;
  }
  d = r;
  solver_.solve(d);
  if (settings_.inner == InnerSolver::conjugate_gradients) iterations_ += solver_.iterations();
  return d.allFinite();
}

SparseSolver<double>& Inner::factors() {
  if (settings_.inner == InnerSolver::direct) return solver_;
  if (!factors_) {
    factors_.emplace();
    factors_->set({.by = LinearSolve::By::direct});
  }
  return *factors_;
}

}  // namespace hmax
