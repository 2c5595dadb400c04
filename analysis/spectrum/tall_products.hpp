/// Products with matrices of many rows and few columns, the bases of iterations.
#pragma once

#include <Eigen/Core>

namespace hmax {

/// The first `columns` columns of V, shape (n, m): V^T x of x with shape (n), and V s of s with shape
/// (columns). Rows are shared among the cores in stretches whose sums are added in their order: the same bits
/// for any number of threads.
Eigen::VectorXd transposed_times(const Eigen::MatrixXd& V, Eigen::Index columns, const Eigen::VectorXd& x);
Eigen::VectorXd times(const Eigen::MatrixXd& V, Eigen::Index columns, const Eigen::VectorXd& s);

}  // namespace hmax
