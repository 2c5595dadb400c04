#include "integrators/linear/blocked_lu.hpp"

#include <Eigen/LU>

#include "core/dense_solvers.hpp"

namespace hmax {

template <class Scalar>
struct BlockedLu<Scalar>::Factors {
  explicit Factors(Eigen::Index n) : lu(n), scratch(n) {}
  Eigen::PartialPivLU<Matrix> lu;
  Vector scratch;
};

template <class Scalar>
BlockedLu<Scalar>::BlockedLu() = default;
template <class Scalar>
BlockedLu<Scalar>::BlockedLu(BlockedLu&& other) noexcept = default;
template <class Scalar>
BlockedLu<Scalar>& BlockedLu<Scalar>::operator=(BlockedLu&& other) noexcept = default;
template <class Scalar>
BlockedLu<Scalar>::~BlockedLu() = default;

template <class Scalar>
void BlockedLu<Scalar>::resize(Eigen::Index n) {
  factors_ = std::make_unique<Factors>(n);
}

template <class Scalar>
bool BlockedLu<Scalar>::factor(const Eigen::Ref<const Matrix>& A) {
  if (!factors_ || factors_->scratch.size() != A.rows()) resize(A.rows());
  // Eigen's LU reports neither NaN nor a zero pivot.
  if (!A.allFinite()) return false;
  factors_->lu.compute(A);
  const auto pivots = factors_->lu.matrixLU().diagonal().cwiseAbs();
  return pivots.allFinite() && pivots.minCoeff() > 0;
}

template <class Scalar>
void BlockedLu<Scalar>::solve(Eigen::Ref<Vector> x) {
  factors_->scratch.noalias() = factors_->lu.solve(x);
  x = factors_->scratch;
}

template class BlockedLu<double>;
template class BlockedLu<std::complex<double>>;

}  // namespace hmax
