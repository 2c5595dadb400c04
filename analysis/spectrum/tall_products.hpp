/// Bases of iterations, matrices of many rows and few columns: products and orthonormal vectors.
#pragma once

#include <algorithm>
#include <cmath>

#include <Eigen/Core>

namespace hmax {

/// The first `columns` columns of V, shape (n, m): V^T x of x with shape (n), and V s of s with shape
/// (columns). Rows are shared among the cores in stretches whose sums are added in their order: the same bits
/// for any number of threads.
Eigen::VectorXd transposed_times(const Eigen::MatrixXd& V, Eigen::Index columns, const Eigen::VectorXd& x);
Eigen::VectorXd times(const Eigen::MatrixXd& V, Eigen::Index columns, const Eigen::VectorXd& s);

/// Makes t, shape (n), orthogonal to a space and of length 1 in the product of M: Gram and Schmidt, again
/// where so little is left that rounding shows. False where nothing but rounding is left, or t is zero or not
/// finite.
/// @param image   becomes M t, shape (n)
/// @param times_M (t, image): image = M t
/// @param remove  takes from t its part in the space
template <class TimesM, class Remove>
bool make_orthonormal(Eigen::VectorXd& t, Eigen::VectorXd& image, const TimesM& times_M,
                      const Remove& remove) {
  double left = 1;  // of it, in the norm of M
  for (int time = 0;; ++time) {
    times_M(t, image);
    const double length = std::sqrt(std::max(t.dot(image), 0.0));
    if (!(length > 0) || !std::isfinite(length)) return false;
    t /= length;
    image /= length;
    if (time > 0) {
      left *= length;
      if (left < 1e-13) return false;
      if (length > 0.1) return true;
    }
    if (time == 3) return false;
    remove(t);
  }
}

}  // namespace hmax
