/// Implicit Euler by a few iterations of Newton's method, each of a few conjugate gradients.
#pragma once

#include <cmath>

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "core/instructions/piece_sums.hpp"
#include "integrators/stats.hpp"
#include "integrators/system.hpp"

namespace hmax {

/// An iteration is one of Newton's method without line search,
///   (M / h^2 + C / h + K) dq = F(t, q, (q - q_0) / h) - M (q - q_0 - h v_0) / h^2,
/// with at most `most` conjugate gradients from dq = 0, preconditioned by the diagonal. They end early where
/// the residual is that of rounding, or a direction has no curvature. It begins at q_0 + h v_0. Products of
/// vectors are sums of pieces: a device that takes these steps has the same bits. K and C are those of the
/// iterate, or, frozen, those where the run began, for all of its steps.
/// @source [baraff1998large], [nocedal2006numerical] 7.1
class TruncatedNewton {
 public:
  using Matrix = Eigen::SparseMatrix<double>;

  /// @param most    1 at least
  /// @param frozen  K and C
  explicit TruncatedNewton(int most, bool frozen = false) : most_(most), frozen_(frozen) {}

  template <SecondOrderSystem Sys>
  void init(const Sys& system) {
    for (Eigen::VectorXd* each : {&start_, &inertial_, &velocity_, &residual_, &dq_, &z_, &p_, &Ap_})
      each->setZero(system.dofs());
    h_ = 0;
    linearised_ = false;
  }

  /// Before the first substep of a step from (t, q, v).
  template <SecondOrderSystem Sys>
  void start(const Sys& system, double t, const Eigen::VectorXd& q, const Eigen::VectorXd& v) {
    if (!frozen_ || linearised_) return;
    system.stiffness(t, q, v, K_);
    system.damping(t, q, v, C_);
    linearised_ = true;
  }

  template <SecondOrderSystem Sys>
  void begin(const Sys&, double, double h, const Eigen::VectorXd& q, const Eigen::VectorXd& v,
             Eigen::VectorXd& guess) {
    start_ = q;
    inertial_ = q + h * v;
    guess = inertial_;
  }

  template <SecondOrderSystem Sys>
  void improve(const Sys& system, double t, double h, Eigen::VectorXd& q, ImplicitWork& work) {
    velocity_ = (q - start_) / h;
    system.force(t, q, velocity_, residual_);
    const Eigen::VectorXd& mass = system.mass();
    if (!frozen_) {
      system.stiffness(t, q, velocity_, A_);
      system.damping(t, q, velocity_, C_);
      complete(A_, C_, mass, h);
    } else if (h != h_) {
      A_ = K_;
      complete(A_, C_, mass, h);
      h_ = h;
    }
    residual_.array() -= mass.array() / (h * h) * (q - inertial_).array();
    work.linear_iterations += solve();
    q += dq_;
  }

  /// See saved_state.hpp.
  void visit_state(auto& visit) {
    if (frozen_) visit(linearised_, K_, C_);
  }

  /// A = K becomes K + C / h + M / h^2.
  static void complete(Matrix& A, const Matrix& C, const Eigen::VectorXd& mass, double h) {
    A += C / h;
    for (Eigen::Index i = 0; i < mass.size(); ++i) A.coeffRef(i, i) += mass[i] / (h * h);
  }

 private:
  static double dot(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
    return dot_by_pieces(a.size(), a.data(), b.data());
  }

  /// dq_ ~ A^-1 residual_, which is overwritten. @returns iterations
  int solve() {
    dq_.setZero();
    const double least = 1e-14 * std::sqrt(dot(residual_, residual_));
    double rz = 0;
    for (int k = 0; k < most_; ++k) {
      if (!(std::sqrt(dot(residual_, residual_)) > least)) return k;
      z_ = residual_.cwiseQuotient(A_.diagonal());
      const double next = dot(residual_, z_);
      if (k == 0)
        p_ = z_;
      else
        p_ = z_ + next / rz * p_;
      rz = next;
      Ap_.noalias() = A_ * p_;
      const double curvature = dot(p_, Ap_);
      if (!(curvature > 0)) return k;
      dq_ += rz / curvature * p_;
      residual_ -= rz / curvature * Ap_;
    }
    return most_;
  }

  int most_;
  bool frozen_, linearised_ = false;
  double h_ = 0;  ///< that of a frozen A_; 0: there is none
  Matrix A_, K_, C_;
  Eigen::VectorXd start_, inertial_, velocity_, residual_, dq_, z_, p_, Ap_;  ///< shape (dofs)
};

}  // namespace hmax
