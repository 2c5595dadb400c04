/// y' = J y with a matrix of a user.
#pragma once

#include <memory>

#include <Eigen/Core>
#include <Eigen/SparseCore>

namespace hmax {

/// A linear system of first order. Copies share the matrix.
class LinearFirstOrder {
 public:
  using State = Eigen::VectorXd;
  using Jacobian = Eigen::SparseMatrix<double>;
  static constexpr bool autonomous = true;

  /// @param J  shape (n, n) [1/s]
  explicit LinearFirstOrder(const Jacobian& J) : J_(std::make_shared<const Jacobian>(J)) {}

  [[nodiscard]] Eigen::Index dim() const { return J_->rows(); }
  void rhs(double /*t*/, const State& y, State& dydt) const { dydt.noalias() = *J_ * y; }
  void jacobian(double, const State&, Jacobian& J) const { J = *J_; }

 private:
  std::shared_ptr<const Jacobian> J_;
};

}  // namespace hmax
