/// Tetrahedra of ten nodes against closed forms: shape, mass, bending.

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "problems/mesh/ten_node.hpp"
#include "tests/problems/mesh/meshes.hpp"
#include "tests/problems/tissue/bodies.hpp"

namespace hmax {
namespace {

using namespace tissue_tests;
using Eigen::Vector3d;
using Eigen::VectorXd;

TEST(QuadraticElements, HaveShapeFunctionsThatAreOneAtTheirPointAndZeroAtTheOthers) {
  for (std::size_t a = 0; a < 10; ++a) {
    const Eigen::Vector<double, 10> N = ten_node_values(unit_places()[a]);
    EXPECT_LT((N - Eigen::Vector<double, 10>::Unit(static_cast<Eigen::Index>(a))).norm(), 1e-15) << a;
  }
  const UnitPlace at(0.2, 0.13, 0.41);
  EXPECT_NEAR(ten_node_values(at).sum(), 1, 1e-15);
  for (int axis = 0; axis < 3; ++axis) {
    const double d = 1e-5;
    const UnitPlace step = d * UnitPlace::Unit(axis);
    const auto slope = ((ten_node_values(at + step) - ten_node_values(at - step)) / (2 * d)).eval();
    EXPECT_LT((slope - ten_node_slopes(at).col(axis)).norm(), 1e-10) << axis;
  }
}

TEST(QuadraticElements, OfCurvedSidesHaveTheVolumeOfTheClosedForm) {
  // x = X + 4 L0 L1 d of the middle of edge 01 moved by d: det = 1 + d grad(4 L0 L1), whose integral over the
  // unit tetrahedron is 1/6 - (d_y + d_z)/6.
  TetMesh mesh = ten_node_mesh(unit_tetrahedron());
  const Vector3d d(0.1, -0.2, 0.05);
  mesh.points.col(mesh.ten_node(4, 0)) += d;
  EXPECT_NEAR(element_volume(mesh, 0), (1 - d[1] - d[2]) / 6, 1e-15);
  // Its mass is that of the volume, of which no point has less than nothing.
  const TissueBody body(mesh, {.model = tissue_model("fem_quadratic"), .materials = {{5500, 0.3, 1000}}});
  EXPECT_NEAR(body.point_mass().sum(), 1000 * (1 - d[1] - d[2]) / 6, 1e-10);
  for (int a = 0; a < 10; ++a)
    EXPECT_NEAR(body.point_mass()[mesh.ten_node(a, 0)] / body.point_mass().sum(), a < 4 ? 1. / 36 : 4. / 27,
                1e-15);
}

TEST(QuadraticElements, TakeTheDiagonalOfTheConsistentMass) {
  // Integrals of N^2 over the unit tetrahedron by the closed form 6 a! b! c! d! / (a+b+c+d+3)! of powers of
  // barycentric coordinates: V/70 of L (2 L - 1), 8 V/105 of 4 L L'.
  const double corner = 4 * 6. * 24 / 5040 - 4 * 6. * 6 / 720 + 6. * 2 / 120, middle = 16 * 6. * 4 / 5040;
  EXPECT_NEAR(corner, 1. / 70, 1e-15);
  const double sum = 4 * corner + 6 * middle;
  const TetMesh mesh = ten_node_mesh(unit_tetrahedron());
  EXPECT_NEAR(mass_share(mesh, 0), corner / sum, 1e-15);
  EXPECT_NEAR(mass_share(mesh, 9), middle / sum, 1e-15);
  EXPECT_EQ(mass_share(unit_tetrahedron(), 3), 0.25);
}

/// A box whose inner corners are moved at random, with straight sides.
TetMesh uneven_inside(const Vector3d& size, const Eigen::Vector3i& cells) {
  TetMesh mesh = box_mesh(size, cells);
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> by(-0.1 * size[2] / cells[2], 0.1 * size[2] / cells[2]);
  const MeshSurface surface = surface_of(mesh);
  for (TetMesh::Index i = 0; i < mesh.point_count(); ++i)
    if (!std::ranges::binary_search(surface.points, i))
      mesh.points.col(i) += Vector3d(by(random), by(random), by(random));
  return ten_node_mesh(mesh);
}

TEST(QuadraticElements, CarryPureBendingExactly) {
  // Saint-Venant: strain k z along x and -nu k z across, stress E k z along x alone, energy E I k^2 L / 2.
  // One element thick, too.
  const double L = 0.2, b = 0.05, h = 0.04, E = 5000, nu = 0.45, k = 1e-6;
  for (const Eigen::Vector3i& cells : {Eigen::Vector3i(4, 1, 1), Eigen::Vector3i(4, 2, 2)}) {
    const TetMesh mesh = uneven_inside({L, b, h}, cells);
    const TissueBody body(mesh, {.model = tissue_model("fem_quadratic"), .materials = {{E, nu, 1000}}});
    VectorXd q(body.dofs());
    for (Eigen::Index i = 0; i < mesh.point_count(); ++i) {
      const double x = mesh.points(0, i), y = mesh.points(1, i) - b / 2, z = mesh.points(2, i) - h / 2;
      q.segment<3>(3 * i) << k * x * z, -nu * k * y * z, -k / 2 * (x * x + nu * (z * z - y * y));
    }
    const VectorXd rest = VectorXd::Zero(body.dofs());
    Eigen::SparseMatrix<double> K;
    body.stiffness(0, rest, rest, K);
    const VectorXd f = K * q;
    // Forces at the two ends alone, whose moment is E I k.
    double moment = 0;
    for (Eigen::Index i = 0; i < mesh.point_count(); ++i) {
      const double x = mesh.points(0, i);
      if (x > 1e-9 && x < L - 1e-9)
        EXPECT_LT(f.segment<3>(3 * i).norm(), 1e-12 * f.norm()) << i;
      else if (x >= L - 1e-9)
        moment += f[3 * i] * (mesh.points(2, i) - h / 2);
    }
    const double I = b * h * h * h / 12;
    EXPECT_NEAR(moment / (E * I * k), 1, 1e-11);
    EXPECT_NEAR(q.dot(f) / (E * I * k * k * L), 1, 1e-11);
    // The energy itself, to the digits that the square of so small a strain leaves.
    EXPECT_NEAR(body.energy(0, q) / (E * I * k * k * L / 2), 1, 1e-5);
  }
}

TEST(QuadraticElements, OfStraightSidesHaveTheEnergyOfTheirDensities) {
  const TetMesh mesh = ten_node_mesh(uneven_box());
  const TissueBody body(mesh, {.model = tissue_model("fem_quadratic"), .materials = two_materials()});
  const VectorXd q = random_vector(body.dofs(), 0.004, 4), density = body.energy_densities(0, q);
  ASSERT_EQ(density.size(), mesh.tetrahedron_count());
  double sum = 0;
  for (Eigen::Index t = 0; t < mesh.tetrahedron_count(); ++t)
    sum += density[t] * signed_volume(corners_of(mesh, t));
  EXPECT_NEAR(sum, body.energy(0, q), 1e-12 * sum);
}

TEST(QuadraticElements, AreMadeOfMeshesThatHaveThemAndGoodShapes) {
  TetMesh mesh = unit_tetrahedron();
  const TissueSettings settings{.model = tissue_model("fem_quadratic")};
  EXPECT_THROW(TissueBody(mesh, settings), std::invalid_argument);
  mesh = ten_node_mesh(mesh);
  EXPECT_NO_THROW(TissueBody(mesh, settings));
  EXPECT_EQ(TissueBody(mesh, {}).mesh().element_count(), 8) << "the parts are a mesh for the other models";
  mesh.points.col(mesh.ten_node(4, 0)) += Vector3d(0, 0.9, 0);
  EXPECT_THROW(TissueBody(mesh, settings), std::invalid_argument);
}

}  // namespace
}  // namespace hmax
