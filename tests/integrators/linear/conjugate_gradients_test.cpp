#include "integrators/linear/conjugate_gradients.hpp"

#include <gtest/gtest.h>

#include "problems/mesh/files/mesh_names.hpp"
#include "problems/mesh/renumber.hpp"
#include "problems/tissue/body.hpp"

namespace hmax {
namespace {

using Eigen::VectorXd;
using Sparse = Eigen::SparseMatrix<double>;

/// M + h^2 K of a ball in the order that imported meshes have, in which an incomplete factor of a nearly
/// incompressible body without further care breaks down.
Sparse step_matrix(double poisson, double h) {
  const TetMesh named = mesh_by_name("ball:n=5");
  const TissueBody body(renumbered(named, local_order(named)),
                        {.model = tissue_model("fem_green"), .materials = {{.poisson = poisson}}});
  const VectorXd zero = VectorXd::Zero(body.dofs());
  Sparse A;
  body.stiffness(0, zero, zero, A);
  A *= h * h;
  for (Eigen::Index i = 0; i < A.cols(); ++i) A.coeffRef(i, i) += body.mass()[i];
  return A;
}

TEST(ConjugateGradients, HaveAPreconditionerThatDoesNotBreakDown) {
  for (const double poisson : {0.3, 0.495, 0.499}) {
    const Sparse A = step_matrix(poisson, 0.1);
    const VectorXd expected = VectorXd::LinSpaced(A.cols(), -1, 1), b = A * expected;
    ConjugateGradients<double> gradients;
    ASSERT_TRUE(gradients.prepare(A));
    VectorXd x(A.cols());
    const auto end = gradients.solve(b, x, 1e-8, 0);
    EXPECT_TRUE(end.solved) << poisson;
    // Without a preconditioner it takes thousands.
    EXPECT_LT(end.iterations, 500) << poisson;
    EXPECT_LT((b - A * x).norm(), 1.01e-8 * b.norm()) << poisson;
  }
}

TEST(ConjugateGradients, RefuseAMatrixWhoseDiagonalIsNotPositive) {
  Sparse A = step_matrix(0.3, 0.1);
  A.coeffRef(4, 4) = -1;
  ConjugateGradients<double> gradients;
  EXPECT_FALSE(gradients.prepare(A));
}

}  // namespace
}  // namespace hmax
