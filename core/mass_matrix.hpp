/// The mass matrix of M q'' = F: a mass for each unknown, or one that couples them.
#pragma once

#include <memory>
#include <stdexcept>
#include <utility>

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "core/coupled_mass.hpp"

namespace hmax {

/// M, shape (n, n) [kg], and a root R of it, M = R^T R: that of each mass where M is diagonal. Copies share a
/// matrix that couples.
/// @tparam RealT  of a diagonal M; one that couples computes in double
template <class RealT>
class MassMatrix {
 public:
  using Real = RealT;
  using Diagonal = Eigen::Vector<Real, Eigen::Dynamic>;

  MassMatrix() = default;
  /// A mass for each unknown, shape (n) [kg].
  template <class Derived>
  MassMatrix(const Eigen::MatrixBase<Derived>&
                 lumped)  // NOLINT(google-explicit-constructor): most masses are lumped
      : diagonal_(lumped.template cast<Real>()) {}
  explicit MassMatrix(std::shared_ptr<const CoupledMass> coupled)
      : diagonal_(coupled->diagonal().template cast<Real>()), coupled_(std::move(coupled)) {}
  template <class Other>
  [[nodiscard]] MassMatrix<Other> cast() const {
    return coupled_ ? MassMatrix<Other>(coupled_) : MassMatrix<Other>(diagonal_);
  }

  [[nodiscard]] Eigen::Index size() const { return diagonal_.size(); }
  [[nodiscard]] bool is_diagonal() const { return coupled_ == nullptr; }
  /// The diagonal of M, whether or not there is more of it, shape (n).
  [[nodiscard]] const Diagonal& diagonal() const { return diagonal_; }
  /// The masses, shape (n). @throws std::invalid_argument  where M couples unknowns
  [[nodiscard]] const Diagonal& lumped() const {
    if (coupled_)
      throw std::invalid_argument(
          "the mass matrix couples unknowns, and this computation takes a mass for each; lump the mass matrix");
    return diagonal_;
  }
  /// Null where M is diagonal.
  [[nodiscard]] const CoupledMass* coupled() const { return coupled_.get(); }
  [[nodiscard]] Eigen::SparseMatrix<double> matrix() const {
    if (coupled_) return coupled_->matrix();
    Eigen::SparseMatrix<double> M(size(), size());
    M.reserve(Eigen::VectorXi::Ones(size()));
    for (Eigen::Index i = 0; i < size(); ++i) M.insert(i, i) = static_cast<double>(diagonal_[i]);
    M.makeCompressed();
    return M;
  }

  /// M x, M^-1 x, R x, R^-1 x and R^-T x, each column of x by itself, shape (n, m); x may be complex.
  template <class X>
  [[nodiscard]] auto times(const X& x) const {
    return by_columns(
        x, [](const auto& d, const auto& column) { return d.cwiseProduct(column).eval(); },
        [](const CoupledMass& M, Eigen::VectorXd& v) { M.multiply(v); });
  }
  template <class X>
  [[nodiscard]] auto solve(const X& x) const {
    return by_columns(
        x, [](const auto& d, const auto& column) { return column.cwiseQuotient(d).eval(); },
        [](const CoupledMass& M, Eigen::VectorXd& v) { M.solve(v); });
  }
  template <class X>
  [[nodiscard]] auto root_times(const X& x) const {
    return by_columns(
        x, [](const auto& d, const auto& column) { return d.cwiseSqrt().cwiseProduct(column).eval(); },
        [](const CoupledMass& M, Eigen::VectorXd& v) {
          M.multiply(v);
          M.transposed_root_solve(v);
        });
  }
  template <class X>
  [[nodiscard]] auto root_solve(const X& x) const {
    return by_columns(x, divide_by_root, [](const CoupledMass& M, Eigen::VectorXd& v) { M.root_solve(v); });
  }
  template <class X>
  [[nodiscard]] auto transposed_root_solve(const X& x) const {
    return by_columns(x, divide_by_root,
                      [](const CoupledMass& M, Eigen::VectorXd& v) { M.transposed_root_solve(v); });
  }

 private:
  static constexpr auto divide_by_root = [](const auto& d, const auto& column) {
    return d.cwiseSqrt().cwiseInverse().cwiseProduct(column).eval();
  };

  /// Real and imaginary parts in turn where M couples, since that is real.
  template <class X, class Lumped, class Coupled>
  auto by_columns(const X& given, const Lumped& lumped, const Coupled& coupled) const {
    using Scalar = typename X::Scalar;
    Eigen::Matrix<Scalar, Eigen::Dynamic, X::ColsAtCompileTime> result = given;
    const auto through = [&](const auto& part) {
      Eigen::VectorXd v = part.template cast<double>();
      coupled(*coupled_, v);
      return v;
    };
    for (Eigen::Index j = 0; j < result.cols(); ++j) {
      if (!coupled_) {
        result.col(j) = lumped(diagonal_.template cast<Scalar>(), result.col(j));
      } else if constexpr (Eigen::NumTraits<Scalar>::IsComplex) {
        const Eigen::VectorXd re = through(result.col(j).real()), im = through(result.col(j).imag());
        for (Eigen::Index i = 0; i < re.size(); ++i)
          result(i, j) = Scalar(static_cast<Real>(re[i]), static_cast<Real>(im[i]));
      } else {
        result.col(j) = through(result.col(j)).template cast<Scalar>();
      }
    }
    return result;
  }

  Diagonal diagonal_;
  std::shared_ptr<const CoupledMass> coupled_;
};

/// The mass matrix of a second-order system: its own, or its masses.
template <class S>
auto mass_of(const S& system) {
  using Real = typename Eigen::NumTraits<typename S::State::Scalar>::Real;
  if constexpr (requires { system.mass_matrix(); })
    return MassMatrix<Real>(system.mass_matrix().template cast<Real>());
  else
    return MassMatrix<Real>(typename S::Dofs(system.mass()));
}

}  // namespace hmax
