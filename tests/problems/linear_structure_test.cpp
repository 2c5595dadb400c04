/// Structures of the user's own matrices: their equation, and their Jacobian.
#include "problems/linear_structure.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "integrators/explicit/explicit_rk.hpp"
#include "integrators/explicit/tableaux.hpp"
#include "integrators/integrate.hpp"
#include "integrators/system.hpp"

namespace hmax {
namespace {

using Sparse = Eigen::SparseMatrix<double>;
static_assert(SecondOrderSystem<LinearStructure<Eigen::MatrixXd>>);
static_assert(SecondOrderSystem<LinearStructure<Sparse>> && DifferentiableSystem<LinearStructure<Sparse>>);

const Eigen::Matrix2d K{{3, -1}, {-2, 2}}, C{{0.5, 0.1}, {0.2, 0.4}};
const Eigen::Vector2d M(0.5, 2);

TEST(LinearStructure, HasTheRatesOfItsEquationDenseAndSparse) {
  const Eigen::Vector4d y(1, -2, 0.5, 3);
  const Eigen::Vector2d a = -(K * y.head(2) + C * y.tail(2)).cwiseQuotient(M);
  const Sparse K_sparse = K.sparseView(), C_sparse = C.sparseView();
  for (const AnySystem& system : {linear_structure(K, M, C), linear_structure(K_sparse, M, C_sparse)}) {
    Eigen::VectorXd rates(4), f(2);
    system.rhs(0, y, rates);
    EXPECT_EQ(rates.head(2), y.tail(2));
    EXPECT_NEAR((rates.tail(2) - a).norm(), 0, 1e-13);
    system.force(0, y.head(2), y.tail(2), f);
    EXPECT_NEAR((f - M.cwiseProduct(a)).norm(), 0, 1e-13);
    AnySystem::Jacobian J;
    system.jacobian(0, y, J);
    const Eigen::MatrixXd full = J.index() == 0 ? std::get<0>(J) : Eigen::MatrixXd(std::get<1>(J));
    EXPECT_NEAR((full * y - rates).norm(), 0, 1e-13);
    EXPECT_TRUE(system.is_autonomous());
  }
  EXPECT_FALSE(linear_structure(K, M, C).has_sparse_matrices());
  EXPECT_TRUE(linear_structure(K_sparse, M, C_sparse).has_sparse_matrices());
}

TEST(LinearStructure, IsSteppedByMethods) {
  // One oscillator of 10 rad/s from 1 m: cos(10 t).
  const AnySystem system =
      linear_structure(Eigen::MatrixXd::Constant(1, 1, 50), Eigen::VectorXd::Constant(1, 0.5));
  Eigen::VectorXd y(2);
  y << 1, 0;
  integrate(Rk<tableaux::Dop853, Eigen::VectorXd>{}, system, Span<double>{0, 1}, y, FixedStep(0.01));
  EXPECT_NEAR(y[0], std::cos(10.0), 1e-11);
}

TEST(LinearStructure, OfACoupledMassKeepsItsStatesAndIsSparse) {
  const Eigen::Matrix2d mass{{2, 1}, {1, 3}};
  const AnySystem system = linear_structure(K, mass, C);
  EXPECT_TRUE(system.has_sparse_matrices());
  EXPECT_EQ(Eigen::Matrix2d(system.mass_matrix().matrix()), mass);
  const Eigen::Vector4d y(1, -2, 0.5, 3);
  Eigen::VectorXd rates(4);
  system.rhs(0, y, rates);
  EXPECT_NEAR((mass * rates.tail(2) + K * y.head(2) + C * y.tail(2)).norm(), 0, 1e-13);
  EXPECT_THROW((void)linear_structure(K, Eigen::Matrix2d{{2, 1}, {0.5, 3}}), std::invalid_argument);
  EXPECT_THROW((void)linear_structure(K, Eigen::Matrix2d{{1, 2}, {2, 1}}), std::invalid_argument);
}

TEST(LinearStructure, RefusesAMassMatrixThatIsNotSquare) {
  const Eigen::Matrix3d stiffness = Eigen::Matrix3d::Identity();
  const Eigen::MatrixXd mass = Eigen::MatrixXd::Identity(3, 5);
  EXPECT_THROW((void)linear_structure(stiffness, mass), std::invalid_argument);
}

}  // namespace
}  // namespace hmax
