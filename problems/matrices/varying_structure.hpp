/// M q'' + C(t) q' + K(t) q = 0 of matrices that are given at several times.
#pragma once

#include <memory>
#include <vector>

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "core/mass_matrix.hpp"

namespace hmax {

/// A matrix at several times, rising; one time: it does not change.
struct MatrixSeries {
  std::vector<double> t;                        ///< [s]
  std::vector<Eigen::SparseMatrix<double>> at;  ///< one for each time, of one shape

  [[nodiscard]] bool varies() const { return t.size() > 1; }
};

/// K(t) and C(t), linear between the given times, and before and after all of them the nearest. Their numbers
/// and those of M stand on one pattern, which also holds the diagonal.
class VaryingMatrices {
 public:
  /// @param C  empty without damping
  /// @param M  of all times, of the shape of K
  VaryingMatrices(MatrixSeries K, MatrixSeries C, const Eigen::SparseMatrix<double>& M);

  /// The times of both, rising [s].
  [[nodiscard]] const std::vector<double>& times() const { return times_; }
  [[nodiscard]] Eigen::Index size() const { return pattern_.rows(); }
  [[nodiscard]] bool damped() const { return !C_.t.empty(); }
  /// f -= K(t) (q + beta v) + C(t) v.
  void subtract_forces(double t, double beta, const Eigen::Ref<const Eigen::VectorXd>& q,
                       const Eigen::Ref<const Eigen::VectorXd>& v, Eigen::Ref<Eigen::VectorXd> f) const;
  /// The same with dK/dt and dC/dt, at a given time those behind it.
  void subtract_force_rates(double t, double beta, const Eigen::Ref<const Eigen::VectorXd>& q,
                            const Eigen::Ref<const Eigen::VectorXd>& v, Eigen::Ref<Eigen::VectorXd> f) const;
  /// A = k K(t) + c C(t) + m M, on the one pattern.
  void combine(double t, double k, double c, double m, Eigen::SparseMatrix<double>& A) const;

 private:
  struct Numbers {
    std::vector<double> t;
    std::vector<Eigen::VectorXd> values;  ///< on the pattern
  };
  /// a A[i] + b A[i + 1], or of one time a A[0] alone.
  struct Part {
    const double *first = nullptr, *second = nullptr;
    double a = 0, b = 0;
    [[nodiscard]] double operator()(Eigen::Index k) const { return first ? a * first[k] + b * second[k] : 0; }
  };
  static Part value_of(const Numbers& numbers, double t);
  static Part rate_of(const Numbers& numbers, double t);
  void subtract(const Part& K, const Part& C, double beta, const Eigen::Ref<const Eigen::VectorXd>& q,
                const Eigen::Ref<const Eigen::VectorXd>& v, Eigen::Ref<Eigen::VectorXd> f) const;
  [[nodiscard]] Eigen::VectorXd on_pattern(const Eigen::SparseMatrix<double>& A) const;
  [[nodiscard]] Numbers on_pattern(MatrixSeries series) const;

  Eigen::SparseMatrix<double> pattern_;
  Numbers K_, C_;
  Eigen::VectorXd M_;  ///< on the pattern
  std::vector<double> times_;
};

/// The structure of such matrices with Rayleigh damping alpha M + beta K(t), y = (q, v), shape (2 n). Copies
/// share the matrices.
class VaryingStructure {
 public:
  using State = Eigen::VectorXd;
  using Dofs = Eigen::VectorXd;
  using DofMatrix = Eigen::SparseMatrix<double>;
  using Jacobian = Eigen::SparseMatrix<double>;

  /// @param mass   the M of the matrices, shape (n, n) [kg]
  /// @param alpha  [1/s]
  /// @param beta   [s]
  VaryingStructure(std::shared_ptr<const VaryingMatrices> matrices, MassMatrix<double> mass, double alpha,
                   double beta);

  [[nodiscard]] Eigen::Index dofs() const { return mass_.size(); }
  [[nodiscard]] Eigen::Index dim() const { return 2 * dofs(); }
  void rhs(double t, const State& y, State& dydt) const;
  /// @throws std::invalid_argument  as first_order_matrix
  void jacobian(double t, const State& y, Jacobian& J) const;
  void time_derivative(double t, const State& y, State& dfdt) const;
  /// The given times in (t0, t1), where the rates of the matrices jump [s], rising.
  [[nodiscard]] std::vector<double> breakpoints(double t0, double t1) const;
  /// @throws std::invalid_argument  where M couples unknowns
  [[nodiscard]] Dofs mass() const { return mass_.lumped(); }
  [[nodiscard]] const MassMatrix<double>& mass_matrix() const { return mass_; }
  void force(double t, const Dofs& q, const Dofs& v, Dofs& f) const;
  void stiffness(double t, const Dofs& q, const Dofs& v, DofMatrix& K) const;
  void damping(double t, const Dofs& q, const Dofs& v, DofMatrix& C) const;

 private:
  /// f = M^-1 f.
  void divide_by_mass(Eigen::Ref<Eigen::VectorXd> f) const;

  std::shared_ptr<const VaryingMatrices> matrices_;
  MassMatrix<double> mass_;
  double alpha_, beta_;
};

}  // namespace hmax
