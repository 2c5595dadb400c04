/// L U of dense matrices that are too large for plain loops.
#pragma once

#include <memory>

#include <Eigen/Core>

namespace hmax {

/// P A = L U of a dense A, shape (n, n), with partial pivoting, by Eigen's routines, which work on blocks.
/// Compiled in blocked_lu.cpp for real and complex numbers of double.
template <class Scalar>
class BlockedLu {
 public:
  using Matrix = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>;
  using Vector = Eigen::Vector<Scalar, Eigen::Dynamic>;

  BlockedLu();
  BlockedLu(BlockedLu&& other) noexcept;
  BlockedLu& operator=(BlockedLu&& other) noexcept;
  ~BlockedLu();

  /// Makes room for n unknowns, so that factor() allocates nothing.
  void resize(Eigen::Index n);

  /// @returns false when A is singular or not finite; solve() must not be called then
  bool factor(const Eigen::Ref<const Matrix>& A);

  /// x = A^-1 x, shape (n).
  void solve(Eigen::Ref<Vector> x);

 private:
  struct Factors;
  std::unique_ptr<Factors> factors_;
};

}  // namespace hmax
