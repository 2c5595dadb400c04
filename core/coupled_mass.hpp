/// A mass matrix that couples unknowns, as that of finite elements does before it is lumped.
#pragma once

#include <memory>
#include <vector>

#include <Eigen/Core>
#include <Eigen/SparseCore>

namespace hmax {

/// A symmetric positive definite M, shape (n, n), and a root R of it, M = R^T R. In the coordinates u = R q
/// the masses are one, and R^-T K R^-1 is symmetric where K is.
///
/// Where a Cholesky factor P M P^T = L L^T takes little work, R = L^T P. Else M = D^1/2 S D^1/2 with D =
/// diag(M) and R = S^1/2 D^1/2: the eigenvalues of S lie between a and b, of linear tetrahedra between 1/2
/// and 5/2 whatever the mesh [wathen1987realistic], so that Chebyshev polynomials in S are 1/S and S^-1/2 to
/// rounding with some forty products. Either way every operation is linear, and its bits do not depend on
/// threads.
class CoupledMass {
 public:
  using Sparse = Eigen::SparseMatrix<double>;
  using Vector = Eigen::VectorXd;
  enum class Root { fitting, factor, polynomial };

  /// @param M     both triangles, shape (n, n) [kg]
  /// @param root  `fitting` chooses by the work; the others are for tests
  /// @throws std::invalid_argument  unless M is square, finite, symmetric and positive definite, and for one
  /// that is so close to singular that none of the roots is accurate
  explicit CoupledMass(const Sparse& M, Root root = Root::fitting);
  ~CoupledMass();
  CoupledMass(const CoupledMass&) = delete;
  CoupledMass& operator=(const CoupledMass&) = delete;

  [[nodiscard]] Eigen::Index size() const { return M_.rows(); }
  /// M without zeros, compressed.
  [[nodiscard]] const Sparse& matrix() const { return M_; }
  [[nodiscard]] const Vector& diagonal() const { return diagonal_; }
  /// No eigenvalue of S, that is of D^-1 M, is smaller, as far as a Lanczos iteration can say: so no
  /// eigenvalue of M^-1 K exceeds one of D^-1 K by more than the inverse.
  [[nodiscard]] double least_share() const { return low_; }
  [[nodiscard]] bool has_factor() const { return factor_ != nullptr; }

  /// x = M x, M^-1 x, R^-1 x and R^-T x in place, shape (n).
  void multiply(Vector& x) const;
  void solve(Vector& x) const;
  void root_solve(Vector& x) const;
  void transposed_root_solve(Vector& x) const;

 private:
  struct Factor;
  /// S by rows, one number for three unknowns where the three coordinates of a node have the same masses.
  struct Product {
    int width = 1;
    std::vector<int> first, column;
    std::vector<double> value;
  };
  void scale();
  void bound_spectrum();
  bool make_factor(double most_work);
  void make_polynomials();
  /// x = p(S) x for the Chebyshev series of p.
  void apply(const std::vector<double>& series, Vector& x) const;
  /// Whether M M^-1 x = x and R^T R = M to rounding, for a vector in general position.
  [[nodiscard]] bool is_accurate() const;

  Sparse M_;
  Vector diagonal_, root_, inverse_root_;  ///< D, D^1/2, D^-1/2, shape (n)
  Product S_;
  double low_ = 0, high_ = 0;                  ///< a and b
  std::vector<double> inverse_, square_root_;  ///< Chebyshev series of 1/s and s^-1/2 between a and b
  std::unique_ptr<const Factor> factor_;
};

}  // namespace hmax
