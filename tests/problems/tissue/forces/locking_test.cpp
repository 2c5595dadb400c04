/// Nearly incompressible bodies against published values: what locks, and what averaged pressures do about
/// it.
#include <cmath>
#include <vector>

#include <Eigen/Dense>
#include <Eigen/SparseCholesky>
#include <gtest/gtest.h>

#include "tests/problems/tissue/bodies.hpp"

namespace hmax {
namespace {

using namespace tissue_tests;
using Eigen::Vector3d;
using Eigen::VectorXd;
using Sparse = Eigen::SparseMatrix<double>;

/// A slab of one layer whose points move in its plane alone: plane strain.
struct PlaneStrain {
  explicit PlaneStrain(TissueBody made) : body(std::move(made)) {
    for (Eigen::Index i = 0; i < body.dofs(); ++i)
      if (i % 3 != 2) kept.push_back(i);
  }
  /// The equilibrium of displacements q, shape (dofs), in so many steps of the load.
  /// @param load  [N], shape (dofs)
  [[nodiscard]] VectorXd equilibrium(const VectorXd& load, int steps) const {
    VectorXd q = VectorXd::Zero(body.dofs()), f = q;
    const VectorXd still = q;
    const auto n = static_cast<Eigen::Index>(kept.size());
    Sparse K, pick(body.dofs(), n);
    for (Eigen::Index i = 0; i < n; ++i) pick.insert(kept[static_cast<std::size_t>(i)], i) = 1;
    for (int step = 1; step <= steps; ++step)
      for (int i = 0; i < 30; ++i) {
        body.force(0, q, still, f);
        body.stiffness(0, q, still, K);
        const Sparse inner = pick.transpose() * K * pick;
        const VectorXd missing = pick.transpose() * (f + load * step / steps);
        const VectorXd change = Eigen::SimplicialLDLT<Sparse>(inner).solve(missing);
        q += pick * change;
        if (change.norm() <= 1e-9 * q.norm()) break;
        if (i == 29) ADD_FAILURE() << "no equilibrium";
      }
    return q;
  }
  TissueBody body;
  std::vector<Eigen::Index> kept;
};

/// The forces of a constant traction on the triangles of the surface at x = `side` of a slab of one layer
/// along z: each point carries half of the length beside it, and half of the thickness.
VectorXd traction(const TissueBody& body, double side, const Vector3d& whole) {
  const MeshSurface surface = surface_of(body.mesh());
  std::vector<double> shares(static_cast<std::size_t>(body.mesh().point_count()), 0);
  double sum = 0;
  for (const auto& triangle : surface.triangles.colwise()) {
    const Eigen::Matrix3d x = body.mesh().points(Eigen::all, triangle);
    if ((x.row(0).array() - side).abs().maxCoeff() > 1e-9) continue;
    const double area = (x.col(1) - x.col(0)).cross(x.col(2) - x.col(0)).norm() / 2;
    for (const auto corner : triangle) shares[static_cast<std::size_t>(corner)] += area / 3;
    sum += area;
  }
  VectorXd load = VectorXd::Zero(body.dofs());
  for (std::size_t i = 0; i < body.free_points().size(); ++i)
    load.segment<3>(3 * static_cast<Eigen::Index>(i)) =
        shares[static_cast<std::size_t>(body.free_points()[i])] / sum * whole;
  return load;
}

/// Cook's membrane in mm, N and MPa, n x n cells: corners (0, 0), (48, 44), (48, 60), (0, 44), 1 thick, fixed
/// at x = 0, under 100 N upwards at x = 48. G = 80.1938, K = 40.0942e4: the tip (48, 60) rises by 6.9
/// [souzaneto1996design].
double cooks_membrane(std::string_view model, int n, double* of_body = nullptr) {
  TetMesh mesh = mesh_for(tissue_model(model), box_mesh({1, 1, 1}, {n, n, 1}));
  for (auto x : mesh.points.colwise())
    x = Vector3d(48 * x[0], 44 * x[0] + x[1] * (44 - 28 * x[0]), x[2]).eval();
  const double G = 80.1938, K = 40.0942e4;
  TissueSettings settings;
  settings.model = tissue_model(model);
  settings.materials = {{9 * K * G / (3 * K + G), (3 * K - 2 * G) / (2 * (3 * K + G)), 1}};
  settings.supports = {{points_in_box(mesh, {-1, -1, -1}, {1e-9, 100, 2})}};
  const PlaneStrain slab(TissueBody(mesh, settings));
  const VectorXd q = slab.equilibrium(traction(slab.body, 48, {0, 100, 0}), n / 2);
  if (of_body) *of_body = slab.body.least_volume(0, q).first;
  return slab.body.positions(0, q).row(1).maxCoeff() - 60;
}

/// How far the tip is from the published 6.9 mm, relative to that.
double cooks_error(std::string_view model, int n, double* volume = nullptr) {
  return std::abs(cooks_membrane(model, n, volume) / 6.9 - 1);
}

TEST(Locking, CooksMembraneNearsThePublishedValueWithAveragedPressures) {
  double volume = 0;
  const double coarse = cooks_error("fem_nodal_pressure", 16, &volume);
  const double fine = cooks_error("fem_nodal_pressure", 24);
  EXPECT_LT(fine, 0.08);
  EXPECT_LT(fine, coarse * 16 / 24) << "of first order at least";
  EXPECT_GT(cooks_error("fem_neo_hookean", 16), 0.67) << "locks";
  EXPECT_GT(volume, 0.95) << "elements hardly change their volumes alone";
}

TEST(Locking, CooksMembraneNearsThePublishedValueWithTenNodes) {
  const double fine = cooks_error("fem_quadratic", 8);
  EXPECT_LT(fine, 0.07);
  EXPECT_LT(fine, cooks_error("fem_quadratic", 4) / 2) << "of first order at least";
}

/// A long block of width w and height h between rigid plates that it sticks to, nearly incompressible: its
/// stiffness is that of E_a = 4/3 E (1 + S^2), S = w / (2 h) [gent1959compression].
struct PressedBlock {
  PressedBlock(std::string_view model, int n, double nu) {
    const double w = 40, h = 10, E = 1;
    const TetMesh mesh = mesh_for(tissue_model(model), box_mesh({w, h, h / n}, {4 * n, n, 1}));
    TissueSettings settings;
    settings.model = tissue_model(model);
    settings.materials = {{E, nu, 1}};
    const double press = 1e-6;
    settings.supports = {{points_in_box(mesh, {-1, -1, -1}, {100, 1e-9, 100})},
                         {points_in_box(mesh, {-1, h - 1e-9, -1}, {100, 100, 100}), {0, -press * h, 0}}};
    const PlaneStrain slab(TissueBody(mesh, settings));
    const VectorXd q = slab.equilibrium(VectorXd::Zero(slab.body.dofs()), 1);
    // Energy = E_a e^2 / 2 in the volume.
    apparent = 2 * slab.body.energy(0, q) / (press * press * w * h * h / n) / E;
    // Pressures of the inner points, averages of the volumes around them, and of their neighbours.
    const Eigen::Matrix3Xd x = slab.body.positions(0, q);
    const double K = E / (3 * (1 - 2 * nu));
    VectorXd p = VectorXd::Zero(mesh.point_count()), volume = p, around = p, count = p;
    for (Eigen::Index t = 0; t < mesh.tetrahedron_count(); ++t) {
      const auto corners = mesh.tetrahedra.col(t);
      const auto size = [&](const Eigen::Matrix3Xd& at) {
        Eigen::Matrix3d edges;
        for (int a = 0; a < 3; ++a) edges.col(a) = at.col(corners[a + 1]) - at.col(corners[0]);
        return edges.determinant() / 6;
      };
      for (const auto corner : corners) {
        p[corner] += K * (size(mesh.points) - size(x));
        volume[corner] += size(mesh.points);
      }
    }
    p = p.cwiseQuotient(volume).eval();
    const MeshEdges edges = edges_of(mesh);
    for (const auto& edge : edges.colwise())
      for (const int own : {0, 1}) {
        around[edge[own]] += p[edge[1 - own]];
        ++count[edge[own]];
      }
    double rough = 0;
    for (Eigen::Index i = 0; i < mesh.point_count(); ++i) {
      const auto at = mesh.points.col(i);
      if (at[0] < w / 4 || at[0] > 3 * w / 4 || at[1] < h / 4 || at[1] > 3 * h / 4) continue;
      largest = std::max(largest, std::abs(p[i]));
      rough = std::max(rough, std::abs(p[i] - around[i] / count[i]));
    }
    roughness = rough / largest;
  }
  double apparent = 0;   ///< E_a / E
  double largest = 0;    ///< pressure in the middle
  double roughness = 0;  ///< difference of a pressure from the mean of its neighbours, of the largest
};

TEST(Locking, APressedBlockHasThePublishedStiffnessWithAveragedPressures) {
  const double published = 4. / 3 * (1 + 2 * 2), nu = 0.4999;
  EXPECT_NEAR(PressedBlock("fem_nodal_pressure", 8, nu).apparent / published, 1, 0.05);
  const PressedBlock fine("fem_nodal_pressure", 16, nu);
  EXPECT_NEAR(fine.apparent / published, 1, 0.01);
  EXPECT_GT(PressedBlock("fem_neo_hookean", 16, nu).apparent / published, 2.5) << "locks";
  EXPECT_NEAR(PressedBlock("fem_quadratic", 4, nu).apparent / published, 1, 0.05);
  EXPECT_NEAR(PressedBlock("fem_quadratic", 8, nu).apparent / published, 1, 0.02);
  // Averages hardly see pressures that alternate from point to point: these remain, and fade as cells shrink.
  const double coarse = PressedBlock("fem_nodal_pressure", 8, nu).roughness;
  EXPECT_GT(coarse, 0.5);
  EXPECT_LT(fine.roughness, coarse / 2);
}

/// The tip of a cantilever under its weight, by linear elasticity.
struct Cantilever {
  Cantilever(std::string_view model, int n, double nu) {
    const TetMesh mesh = mesh_for(tissue_model(model), beam_mesh(0.2, 0.05, 0.05, n));
    TissueSettings settings;
    settings.model = tissue_model(model);
    settings.materials = {{5500, nu, 1060}};
    settings.gravity = {0, 0, -9.81};
    settings.supports = {{points_in_box(mesh, {-1, -1, -1}, {1e-9, 1, 1})}};
    const TissueBody body(mesh, settings);
    const VectorXd rest = VectorXd::Zero(body.dofs());
    VectorXd f = rest;
    Sparse K;
    body.force(0, rest, rest, f);
    body.stiffness(0, rest, rest, K);
    const VectorXd q = Eigen::SimplicialLDLT<Sparse>(K).solve(f);
    sag = q.reshaped(3, q.size() / 3).colwise().norm().maxCoeff();
  }
  double sag;
};

TEST(Locking, ACantileverOfAveragedPressuresSagsWithinFivePercentOfTheConvergedOne) {
  // Of nu 0.499 relative to nu 0.3: 0.865, 0.928 and 0.953 with 4, 8 and 16 cells across, which tend to
  // 0.967, as those of ten nodes do.
  const auto relative = [](std::string_view model, int n) {
    return Cantilever(model, n, 0.499).sag / Cantilever(model, n, 0.3).sag;
  };
  EXPECT_NEAR(relative("fem_nodal_pressure", 8) / 0.967, 1, 0.05);
  EXPECT_LT(relative("fem_neo_hookean", 8), 0.25);
  // With ten nodes and half the cells, as many unknowns: 0.883 and 0.939 with 2 and 4 cells across.
  EXPECT_NEAR(relative("fem_quadratic", 4) / 0.967, 1, 0.05);
}

}  // namespace
}  // namespace hmax
