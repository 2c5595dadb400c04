#include "analysis/spectrum/tall_products.hpp"

#include <gtest/gtest.h>

#include "analysis/spectrum/lanczos.hpp"
#include "tests/core/jobs.hpp"

namespace hmax {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

TEST(TallProducts, AreThoseOfTheFirstColumnsForAnyNumberOfThreads) {
  for (const Index n : {Index{3}, Index{8192}, Index{50'001}}) {
    const MatrixXd V = start_vector(n * 15).reshaped(n, 15);
    const VectorXd x = start_vector(n), s = start_vector(12);
    const VectorXd down = transposed_times(V, 12, x), up = times(V, 12, s);
    EXPECT_LT((down - V.leftCols(12).transpose() * x).norm(), 1e-12 * static_cast<double>(n)) << n;
    EXPECT_LT((up - V.leftCols(12) * s).norm(), 1e-12 * static_cast<double>(n)) << n;
    const Jobs one(1);
    EXPECT_EQ(transposed_times(V, 12, x), down) << n;
    EXPECT_EQ(times(V, 12, s), up) << n;
  }
  EXPECT_TRUE(times(MatrixXd(5, 2), 0, VectorXd(0)).isZero(0));
}

}  // namespace
}  // namespace hmax
