#include "limits/modes/fastest_mode.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include "catalogue/models/equilibria/body_balance.hpp"
#include "catalogue/models/problems.hpp"
#include "limits/linearised_problem.hpp"
#include "problems/mesh/mesh_generators.hpp"
#include "tests/problems/mesh/meshes.hpp"

namespace hmax {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

double fastest_by_all_of_them(const TissueBody& body) {
  const VectorXd rest = VectorXd::Zero(body.dofs()), root = body.mass().cwiseSqrt().cwiseInverse();
  TissueBody::DofMatrix K;
  body.stiffness(0, rest, rest, K);
  const MatrixXd k = root.asDiagonal() * MatrixXd(K) * root.asDiagonal();
  return Eigen::SelfAdjointEigenSolver<MatrixXd>(k, Eigen::EigenvaluesOnly).eigenvalues().maxCoeff();
}

/// A cube whose inner point has been pushed towards one of its neighbours.
TetMesh cube_with_a_misplaced_point(Index& point) {
  TetMesh mesh = cube_mesh(0.1, 2);
  point = 13;  // the middle of 3 x 3 x 3
  EXPECT_LT((mesh.points.col(point) - Eigen::Vector3d::Constant(0.05)).norm(), 1e-12);
  mesh.points.col(point) += Eigen::Vector3d(0.038, 0.004, 0.002);
  return mesh;
}

TEST(FastestMode, OfAMisplacedPointIsOwnedBesideItAndGainsFromPuttingItBack) {
  Index point = 0;
  const TetMesh mesh = cube_with_a_misplaced_point(point);
  for (const auto& model : {tissue_model("fem_cauchy"), tissue_model("mass_spring")}) {
    const TissueBody body(mesh, {.model = model});
    const FastestMode mode = fastest_mode_of(body);
    EXPECT_NEAR(mode.kappa, fastest_by_all_of_them(body), 1e-6 * mode.kappa);
    EXPECT_LE(mode.residual, 2e-6);
    EXPECT_EQ(std::ranges::count(mode.points, point), 1);
    EXPECT_GE(mode.bounds.element, mode.kappa * (1 - 1e-9));
    EXPECT_GT(mode.with_mass, 1);
    EXPECT_GT(mode.added_mass, 0);
    EXPECT_LT(mode.added_mass, 0.2);
    EXPECT_GT(mode.smoothed, 1.05);
    EXPECT_EQ(mode.moved_point, point);
  }
}

TEST(FastestMode, IsOwnedByAnElementOfTenNodesWithItsNumber) {
  const Problem problem = make_problem("fem_quadratic@cube:n=2", {});
  const TissueBody& body = *problem.body;
  const FastestMode mode = fastest_mode_of(body);
  EXPECT_NEAR(mode.kappa, fastest_by_all_of_them(body), 1e-6 * mode.kappa);
  EXPECT_GE(mode.bounds.element, mode.kappa * (1 - 1e-9));
  EXPECT_LT(mode.bounds.element, 3 * mode.kappa);
  EXPECT_EQ(mode.points.size(), 10U);
  EXPECT_EQ(mass_weights(body).size(), 48U);
  EXPECT_FALSE(mode.moved_point) << "a side would bend";
  const NamedElement named = named_element(problem, mode.owner.element);
  EXPECT_EQ(named.kind, "tetrahedron");
  EXPECT_EQ(named.number, mode.owner.element + 1);
  EXPECT_EQ(named.points.size(), 10U);
}

TEST(FastestMode, GainsAreThoseOfTheChangedBodyAndCostNothingUnlessAsked) {
  Index point = 0;
  const TissueBody body(cube_with_a_misplaced_point(point), {.model = tissue_model("fem_cauchy")});
  const FastestMode alone = fastest_mode_of(body, false);
  EXPECT_EQ(alone.with_mass, 1);
  EXPECT_FALSE(alone.moved_point);
  // Without an element the body has fewer elements and their mass.
  TetMesh fewer = body.mesh();
  const Index last = fewer.tetrahedron_count() - 1;
  fewer.tetrahedra.col(alone.owner.element) = fewer.tetrahedra.col(last).eval();
  fewer.tetrahedra.conservativeResize(Eigen::NoChange, last);
  const TissueBody without(fewer, body.settings());
  EXPECT_NEAR(fastest_mode_of(body).without, std::sqrt(alone.kappa / fastest_by_all_of_them(without)), 1e-5);
}

TEST(FastestMode, GainsOfAnElementThatAloneHoldsAPointAreThoseOfTheBodyWithoutBoth) {
  const TetMesh one = unit_tetrahedron();
  TetMesh mesh = one;
  mesh.points.conservativeResize(Eigen::NoChange, 5);
  mesh.points.col(4) << 0.3, 0.3, -0.05;
  mesh.tetrahedra.conservativeResize(Eigen::NoChange, 2);
  mesh.tetrahedra.col(1) << 0, 2, 1, 4;
  const TissueBody body(mesh, {.model = tissue_model("fem_cauchy")});
  const TissueBody without(one, body.settings());
  const FastestMode mode = fastest_mode_of(body);
  ASSERT_EQ(mode.owner.element, 1);
  EXPECT_NEAR(mode.without, std::sqrt(mode.kappa / fastest_by_all_of_them(without)), 1e-5 * mode.without);
  EXPECT_EQ(fastest_mode_of(without).without, 1) << "nothing is left";
}

/// At rest its shape is taken over; under a load the fastest mode at rest is another one, and is found anew.
TEST(FastestMode, OfALinearisedBodyIsThatOfTheBodyAtRest) {
  const Problem problem =
      make_problem("fem_green@ball:n=6", {.parameters = {{"E", 30'000}, {"beta", 0.001}}});
  const TissueBody& body = *problem.body;
  const FastestMode alone = fastest_mode_of(body, false);
  for (const AskedState at : {AskedState::rest, AskedState::equilibrium}) {
    const Linearised near = linearised(problem, at);
    EXPECT_EQ(near.modes.fastest_shape.size() > 0, at == AskedState::rest);
    const FastestMode mode = fastest_mode_of(body, near, false);
    EXPECT_NEAR(mode.kappa, alone.kappa, 1e-6 * alone.kappa);
    EXPECT_LE(mode.residual, at == AskedState::rest ? 1e-9 : 2e-6);
    EXPECT_EQ(mode.owner.element, alone.owner.element);
    EXPECT_EQ(mode.bounds.element, alone.bounds.element);
  }
}

}  // namespace
}  // namespace hmax
