#include "analysis/spectrum/element_bounds.hpp"

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include "problems/mesh/mesh_generators.hpp"
#include "problems/mesh/mesh_quality.hpp"
#include "problems/tissue/body.hpp"

namespace hmax {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

struct Structure {
  VectorXd mass;  // of the free points
  ElementSum elements;
  Eigen::SparseMatrix<double> K;
  double fastest = 0;
  VectorXd shape;

  explicit Structure(const TissueBody& body) {
    std::vector<Index> free(static_cast<std::size_t>(body.mesh().point_count()), -1);
    mass.resize(body.dofs() / 3);
    for (Index i = 0; i < mass.size(); ++i) {
      mass[i] = body.mass()[3 * i];
      free[static_cast<std::size_t>(body.free_points()[static_cast<std::size_t>(i)])] = i;
    }
    elements = [&body, free](const ElementVisitor& visit) {
      body.visit_rest_stiffness(
          [&](std::span<const TetMesh::Index> points, const Eigen::Ref<const MatrixXd>& element) {
            std::vector<Index> numbers;
            for (const auto point : points) numbers.push_back(free[static_cast<std::size_t>(point)]);
            visit(numbers, element);
          });
    };
    const VectorXd rest = VectorXd::Zero(body.dofs()), root = body.mass().cwiseSqrt().cwiseInverse();
    body.stiffness(0, rest, rest, K);
    const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(
        MatrixXd(root.asDiagonal() * MatrixXd(K) * root.asDiagonal()));
    fastest = solver.eigenvalues().maxCoeff();
    shape = root.cwiseProduct(solver.eigenvectors().rightCols<1>());
  }
};

TEST(ElementBounds, AreBoundsForEveryModelWithSupportsAndSkin) {
  for (const TissueModel& model :
       {tissue_model("mass_spring"), tissue_model("fem_cauchy"), tissue_model("fem_green")})
    for (const bool skin : {false, true}) {
      TissueSettings settings{.model = model};
      settings.supports = {{.points = {0, 7}}};
      if (skin) settings.skin.kind = SkinSettings::Kind::membrane;
      const TissueBody body(ball_mesh(0.1, 2), settings);
      const Structure structure(body);
      std::vector<double> volumes;
      const bool own_masses = !model.is_of_springs() && !skin;
      for (Index t = 0; own_masses && t < body.mesh().tetrahedron_count(); ++t)
        volumes.push_back(signed_volume(corners_of(body.mesh(), t)));
      for (const auto& weights : {std::vector<double>{}, volumes}) {
        const StiffnessBounds bounds =
            stiffness_bounds(structure.elements, structure.mass, weights, structure.K);
        for (const double bound : {bounds.element, bounds.nodal, bounds.gershgorin}) {
          EXPECT_GE(bound, structure.fastest * (1 - 1e-12));
          EXPECT_LT(bound, 30 * structure.fastest);
        }
        if (own_masses) {
          EXPECT_LT(bounds.element, 4 * structure.fastest);
        }
      }
    }
}

TEST(ElementBounds, OfOneElementIsExact) {
  TetMesh mesh;
  mesh.points.resize(3, 4);
  mesh.points << 0, 0.1, 0, 0, 0, 0, 0.2, 0, 0, 0, 0, 0.05;
  mesh.tetrahedra.resize(4, 1);
  mesh.tetrahedra << 0, 1, 2, 3;
  const TissueBody body(mesh, {.model = tissue_model("fem_cauchy")});
  const Structure structure(body);
  const std::vector<double> volume{1.0};
  EXPECT_NEAR(stiffness_bounds(structure.elements, structure.mass, volume, structure.K).element,
              structure.fastest, 1e-10 * structure.fastest);
  const ModeOwner owner = owner_of(structure.elements, structure.mass, structure.shape);
  EXPECT_NEAR(owner.share, 1, 1e-12);
  EXPECT_EQ(owner.elements, 1);
  EXPECT_LE(owner.moving_points, 4 + 1e-12);
}

TEST(ElementBounds, AnElementBesideAPressedPointOwnsTheFastestMode) {
  TetMesh mesh = cube_mesh(0.1, 3);
  // A point of the middle, pressed towards the opposite face of one of its elements.
  const Index flat = 60;
  const auto corners = mesh.tetrahedra.col(flat);
  const Eigen::Vector3d middle =
      (mesh.points.col(corners[1]) + mesh.points.col(corners[2]) + mesh.points.col(corners[3])) / 3;
  mesh.points.col(corners[0]) = 0.93 * middle + 0.07 * mesh.points.col(corners[0]);
  ASSERT_GT(signed_volume(corners_of(mesh, flat)), 0);
  const TissueBody body(mesh, {});
  const Structure structure(body);
  const ModeOwner owner = owner_of(structure.elements, structure.mass, structure.shape);
  // The face is flat on both sides.
  const auto has_the_point = [&](Index element) {
    return (mesh.tetrahedra.col(element).array() == corners[0]).any();
  };
  EXPECT_TRUE(has_the_point(owner.element));
  EXPECT_GT(owner.share, 0.4);
  EXPECT_LT(owner.elements, 10);
  EXPECT_LT(owner.moving_points, 6);
}

}  // namespace
}  // namespace hmax
