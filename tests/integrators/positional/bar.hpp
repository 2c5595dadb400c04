/// A hanging bar of springs for methods that move one point, or meet one constraint, at a time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include <Eigen/Dense>

#include "integrators/positional/positional_system.hpp"

namespace hmax {

/// n springs in a row along x, the first end held; the last point has half a mass. Displacements along x
/// alone: it stretches, and does not swing.
class HangingBar {
 public:
  using State = Eigen::VectorXd;
  using Dofs = Eigen::VectorXd;
  using DofMatrix = Eigen::SparseMatrix<double>;

  /// The bar of shared numbers: 0.1 m, 1060 kg/m^3, a square centimetre, 20 springs.
  explicit HangingBar(double young, double gravity = 9.81, double alpha = 0, double beta = 0)
      : k_(young * 1e-4 / length), alpha_(alpha), beta_(beta) {
    mass_ = Dofs::Constant(3 * n, 1060 * 1e-4 * length);
    mass_.tail<3>() /= 2;
    loads_.setZero(dofs());
    for (Eigen::Index i = 0; i < n; ++i) loads_[3 * i] = gravity * mass_[3 * i];
    for (std::int32_t i = 0; i < n; ++i) points_.push_back({i});
  }

  static constexpr Eigen::Index n = 20;
  static constexpr double length = 0.1 / n;  ///< of a spring [m]

  [[nodiscard]] Eigen::Index dofs() const { return 3 * n; }
  [[nodiscard]] Eigen::Index dim() const { return 6 * n; }
  [[nodiscard]] const Dofs& mass() const { return mass_; }
  [[nodiscard]] double mass_damping() const { return alpha_; }
  [[nodiscard]] double stiffness_damping() const { return beta_; }
  void loads(double, Dofs& f) const { f = loads_; }

  /// Along x linear; across, where nothing moves, as stiff.
  void stiffness(double, const Dofs&, const Dofs&, DofMatrix& K) const {
    K.resize(dofs(), dofs());
    for (Eigen::Index i = 0; i < n; ++i)
      for (Eigen::Index axis = 0; axis < 3; ++axis) {
        K.coeffRef(3 * i + axis, 3 * i + axis) = i + 1 < n ? 2 * k_ : k_;
        if (i > 0)
          K.coeffRef(3 * i + axis, 3 * i + axis - 3) = K.coeffRef(3 * i + axis - 3, 3 * i + axis) = -k_;
      }
  }
  void damping(double t, const Dofs& q, const Dofs& v, DofMatrix& C) const {
    stiffness(t, q, v, C);
    C *= beta_;
    for (Eigen::Index i = 0; i < dofs(); ++i) C.coeffRef(i, i) += alpha_ * mass_[i];
  }
  void force(double t, const Dofs& q, const Dofs& v, Dofs& f) const {
    DofMatrix K, C;
    stiffness(t, q, v, K);
    damping(t, q, v, C);
    loads(t, f);
    f -= K * q + C * v;
  }
  void rhs(double t, const State& y, State& dydt) const {
    Dofs f(dofs());
    force(t, y.head(dofs()), y.tail(dofs()), f);
    dydt << y.tail(dofs()), f.cwiseQuotient(mass_);
  }

  // From the held end on, one after the other.
  [[nodiscard]] const Colours& point_colours() const { return points_; }
  void point_force(double, const Dofs& q, const Dofs& v, std::int32_t point, PointForce& at) const {
    const Eigen::Index x = Eigen::Index{3} * point;
    const double own = point + 1 < n ? 2 * k_ : k_, m = mass_[x];
    const auto pulled = [&](const Dofs& u) {
      Eigen::Vector3d sum = own * u.segment<3>(x);
      if (point > 0) sum -= k_ * u.segment<3>(x - 3);
      if (point + 1 < n) sum -= k_ * u.segment<3>(x + 3);
      return sum;
    };
    at.f = loads_.segment<3>(x) - pulled(q) - beta_ * pulled(v) - alpha_ * m * v.segment<3>(x);
    at.K = own * Eigen::Matrix3d::Identity();
    at.C = (beta_ * own + alpha_ * m) * Eigen::Matrix3d::Identity();
  }
  [[nodiscard]] const Colours& constraint_colours() const { return points_; }
  void constraints(const Dofs& q, std::span<const std::int32_t> numbers,
                   std::span<CompliantConstraint> at) const {
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      const std::int32_t number = numbers[i];
      const Eigen::Index x = Eigen::Index{3} * number;
      at[i].set(q[x] - (number > 0 ? q[x - 3] : 0.0), 1 / k_);
      at[i].add(number - 1, -Eigen::Vector3d::UnitX());
      at[i].add(number, Eigen::Vector3d::UnitX());
    }
  }

 private:
  double k_, alpha_, beta_;
  Dofs mass_, loads_;
  Colours points_;
};

}  // namespace hmax
