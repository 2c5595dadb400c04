/// Energy of averaged pressures, summed from determinants.
#include "problems/tissue/forces/nodal_pressure.hpp"

#include <map>
#include <utility>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "problems/tissue/forces/elasticity.hpp"
#include "tests/problems/tissue/bodies.hpp"

namespace hmax {
namespace {

using namespace tissue_tests;
using Eigen::Matrix3d;
using Eigen::VectorXd;

Matrix3d edges_of_tetrahedron(const Eigen::Matrix3Xd& points,
                              const Eigen::Vector<TetMesh::Index, 4>& corners) {
  Matrix3d edges;
  for (int a = 0; a < 3; ++a) edges.col(a) = points.col(corners[a + 1]) - points.col(corners[0]);
  return edges;
}

TEST(NodalPressure, HasTheEnergyOfMeanVolumesAroundPointsOfEachRegion) {
  const TetMesh mesh = uneven_box();
  const std::vector<TissueMaterial> materials = two_materials();
  TissueSettings settings;
  settings.model = tissue_model("fem_nodal_pressure");
  settings.materials = materials;
  const TissueBody body(mesh, settings);
  const VectorXd q = random_vector(body.dofs(), 0.004, 11);
  const Eigen::Matrix3Xd x = body.positions(0, q);

  double sum = 0;
  std::map<std::pair<int, int>, std::pair<double, double>> volumes;  // of a point and a region: now, at rest
  for (Eigen::Index t = 0; t < mesh.tetrahedron_count(); ++t) {
    const Eigen::Vector<TetMesh::Index, 4> corners = mesh.tetrahedra.col(t);
    const Matrix3d rest = edges_of_tetrahedron(mesh.points, corners), now = edges_of_tetrahedron(x, corners);
    const TissueMaterial& material = materials[static_cast<std::size_t>(mesh.region(t))];
    const Matrix3d H = now * rest.inverse() - Matrix3d::Identity();
    sum += rest.determinant() / 6 *
           StableNeoHookean(H, {.lambda = 0, .mu = lame(material.young, material.poisson).mu}).energy();
    for (const auto corner : corners) {
      auto& [of_now, of_rest] = volumes[{corner, mesh.region(t)}];
      of_now += now.determinant() / 24;
      of_rest += rest.determinant() / 24;
    }
  }
  for (const auto& [where, volume] : volumes) {
    const TissueMaterial& material = materials[static_cast<std::size_t>(where.second)];
    const double J = volume.first / volume.second;
    sum += volume.second * lame(material.young, material.poisson).lambda / 2 * (J - 1) * (J - 1);
  }
  EXPECT_NEAR(body.energy(0, q) / sum, 1, 1e-12);
}

}  // namespace
}  // namespace hmax
