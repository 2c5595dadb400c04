/// Projective dynamics: implicit Euler by iterations with one factored matrix for all of them.
#pragma once

#include <memory>
#include <mutex>

#include <Eigen/Core>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>

#include "integrators/positional/positional_system.hpp"
#include "integrators/stats.hpp"

namespace hmax {

/// An iteration is
///   P dq = F(t, q, (q - q_0) / h) - M (q - q_0 - h v_0) / h^2,
///   P = (1 + alpha h) M / h^2 + (1 + beta / h) W (x) I,
/// with the weights W of the body. Of springs it is what projective dynamics does in two steps: each spring
/// takes its own length where it lies, then the linear equations of springs towards those are solved. It
/// begins where the body would be without elastic forces.
/// Copies share the factors of the last P.
/// @source [bouaziz2014projective]; [liu2017quasi] for energies that are no distances from a set
class ProjectiveDynamics {
 public:
  template <WeightedSystem Sys>
  void init(const Sys& system) {
    for (Eigen::VectorXd* each : {&start_, &inertial_, &work_, &residual_}) each->setZero(system.dofs());
  }

  template <WeightedSystem Sys>
  void begin(const Sys& system, double t, double h, const Eigen::VectorXd& q, const Eigen::VectorXd& v,
             Eigen::VectorXd& guess) {
    start_ = q;
    inertial_ = q + h * v;
    without_elasticity(system, t, h, start_, v, work_, guess);
    factor_ = factors_->of(system, h);
  }

  template <WeightedSystem Sys>
  void improve(const Sys& system, double t, double h, Eigen::VectorXd& q, ImplicitWork& work) {
    work_ = (q - start_) / h;
    system.force(t, q, work_, residual_);
    residual_.array() -= system.mass().array() / (h * h) * (q - inertial_).array();
    const Eigen::Index points = q.size() / 3;
    const Eigen::MatrixX3d move = factor_->solve(Eigen::MatrixX3d(residual_.reshaped(3, points).transpose()));
    q.reshaped(3, points) += move.transpose();
    ++work.linear_iterations;
  }

 private:
  using Factor = Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>;

  /// Those of the last weights and step that were asked for: maps of one step begin anew in every step.
  class Factors {
   public:
    template <WeightedSystem Sys>
    std::shared_ptr<const Factor> of(const Sys& system, double h) {
      const std::lock_guard lock(mutex_);
      if (weights_ == system.weights() && h_ == h) return factor_;
      Eigen::SparseMatrix<double> P = (1 + system.stiffness_damping() / h) * *system.weights();
      const double inertia = (1 + system.mass_damping() * h) / (h * h);
      for (Eigen::Index i = 0; i < P.cols(); ++i) P.coeffRef(i, i) += inertia * system.mass()[3 * i];
      factor_ = std::make_shared<const Factor>(P);
      weights_ = system.weights();
      h_ = h;
      return factor_;
    }

   private:
    std::mutex mutex_;
    std::shared_ptr<const Eigen::SparseMatrix<double>> weights_;
    double h_ = 0;
    std::shared_ptr<const Factor> factor_;
  };

  std::shared_ptr<Factors> factors_ = std::make_shared<Factors>();
  std::shared_ptr<const Factor> factor_;                ///< of the step
  Eigen::VectorXd start_, inertial_, work_, residual_;  ///< shape (dofs)
};

}  // namespace hmax
