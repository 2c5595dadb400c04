#include "analysis/spectrum/tall_products.hpp"

#include <algorithm>
#include <optional>

#include "core/parallel_for.hpp"

namespace hmax {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index rows_at_once = 8192;

/// work(stretch, first row, rows) of each stretch of the rows of V.
template <class Work>
void by_stretches(const MatrixXd& V, Index columns, const Work& work) {
  constexpr Index least_numbers = 250'000;  // 50 us
  std::optional<OneThread> alone;
  if (V.rows() * columns < least_numbers) alone.emplace();
  const Index stretches = (V.rows() + rows_at_once - 1) / rows_at_once;
  parallel_for(static_cast<std::size_t>(stretches), [&](std::size_t i, std::size_t) {
    const auto stretch = static_cast<Index>(i);
    const Index first = stretch * rows_at_once;
    work(stretch, first, std::min(rows_at_once, V.rows() - first));
  });
}

}  // namespace

VectorXd transposed_times(const MatrixXd& V, Index columns, const VectorXd& x) {
  MatrixXd parts(columns, (V.rows() + rows_at_once - 1) / rows_at_once);
  by_stretches(V, columns, [&](Index stretch, Index first, Index rows) {
    parts.col(stretch).noalias() = V.block(first, 0, rows, columns).transpose() * x.segment(first, rows);
  });
  VectorXd sum = VectorXd::Zero(columns);
  for (Index i = 0; i < parts.cols(); ++i) sum += parts.col(i);
  return sum;
}

VectorXd times(const MatrixXd& V, Index columns, const VectorXd& s) {
  VectorXd product(V.rows());
  by_stretches(V, columns, [&](Index, Index first, Index rows) {
    product.segment(first, rows).noalias() = V.block(first, 0, rows, columns) * s;
  });
  return product;
}

}  // namespace hmax
