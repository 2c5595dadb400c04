/// Tissue models against closed forms of elasticity.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
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
using Cholesky = Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>;

const std::vector<TissueModel> finite_elements = [] {
  std::vector<TissueModel> models;
  std::ranges::remove_copy_if(tissue_models(), std::back_inserter(models), &TissueModel::is_of_springs);
  return models;
}();

/// The lowest angular frequency [rad/s] whose mode is not orthogonal to `start`, by inverse iteration.
double lowest_frequency(const TissueBody& body, const VectorXd& start) {
  Eigen::SparseMatrix<double> K;
  const VectorXd rest = VectorXd::Zero(body.dofs());
  body.stiffness(0, rest, rest, K);
  const Cholesky factor(K);
  VectorXd shape = start;
  double square = 0;
  for (int i = 0; i < 200; ++i) {
    shape = factor.solve(body.mass().cwiseProduct(shape)).eval();
    shape /= std::sqrt(shape.dot(body.mass().cwiseProduct(shape)));
    const double next = shape.dot(K * shape);
    if (std::abs(next - square) < 1e-12 * next) break;
    square = next;
  }
  return std::sqrt(square);
}

/// Displacements along one axis by a function of the position.
template <class Shape>
VectorXd displaced(const TissueBody& body, int axis, const Shape& shape) {
  VectorXd q = VectorXd::Zero(body.dofs());
  for (std::size_t i = 0; i < body.free_points().size(); ++i)
    q[3 * static_cast<Eigen::Index>(i) + axis] =
        shape(Vector3d(body.mesh().points.col(body.free_points()[i])));
  return q;
}

TEST(ElasticSolids, AHomogeneousStrainMeetsNoForceInsideAndHasTheEnergyOfItsDensity) {
  // The patch test, for large strains too: every element has the same F, so that inner points are at rest.
  Eigen::Matrix3d F;
  F << 1.1, 0.05, -0.02, 0.03, 0.93, 0.04, -0.06, 0.02, 1.05;
  for (const TissueModel& model : finite_elements) {
    TetMesh mesh = uneven_box_for(model);
    mesh.regions.clear();
    const MeshSurface surface = surface_of(mesh);
    TissueSettings settings;
    settings.model = model;
    const TissueBody body(mesh, settings);
    const VectorXd q = (F * mesh.points - mesh.points).reshaped();
    const VectorXd f = force(body, 0, q, VectorXd::Zero(body.dofs()));
    for (Eigen::Index i = 0; i < mesh.point_count(); ++i) {
      if (std::binary_search(surface.points.begin(), surface.points.end(), i)) continue;
      EXPECT_LT(f.segment<3>(3 * i).norm(), 1e-12 * f.norm()) << model.id;
    }
    const VectorXd density = body.energy_densities(0, q);
    EXPECT_LT(density.maxCoeff() - density.minCoeff(), 1e-11 * density.maxCoeff()) << model.id;
    const VectorXd at_points = body.point_energy_densities(0, q);
    ASSERT_EQ(at_points.size(), mesh.point_count());
    EXPECT_LT((at_points.array() - density[0]).abs().maxCoeff(), 1e-11 * density[0]) << model.id;
    double volume = body.point_mass().sum() / settings.materials[0].density;
    EXPECT_NEAR(body.energy(0, q), volume * density[0], 1e-11 * volume * density[0]) << model.id;
  }
}

TEST(ElasticSolids, APulledBarStretchesEvenlyWhateverItsMesh) {
  // Without lateral contraction a clamped end does not disturb the bar: u = F x / (E A).
  const TetMesh mesh = box_mesh({0.1, 0.03, 0.02}, {5, 2, 3});
  TissueSettings settings;
  settings.materials = {{5000, 0, 1000}};
  settings.model = tissue_model("fem_cauchy");
  settings.supports = {{points_in_box(mesh, {0, 0, 0}, {0, 1, 1})}};
  const auto end = points_in_box(mesh, {0.1, 0, 0}, {0.1, 1, 1});
  settings.forces = {{end, {0.3, 0, 0}, area_shares(mesh, end)}};
  const TissueBody body(mesh, settings);
  const VectorXd exact =
      displaced(body, 0, [](const Vector3d& x) { return 0.3 * x[0] / (5000 * 0.03 * 0.02); });
  EXPECT_LT((equilibrium(body) - exact).norm(), 1e-11 * exact.norm());
}

TEST(ElasticSolids, APulledBarOfGreensStrainObeysItsCubic) {
  // St. Venant-Kirchhoff, nu = 0, stretch a: the force on the rest area is E A a (a^2 - 1) / 2.
  const TetMesh mesh = box_mesh({0.1, 0.03, 0.02}, {4, 2, 2});
  TissueSettings settings;
  settings.materials = {{5000, 0, 1000}};
  settings.supports = {{points_in_box(mesh, {0, 0, 0}, {0, 1, 1})}};
  const auto end = points_in_box(mesh, {0.1, 0, 0}, {0.1, 1, 1});
  const double a = 1.3;
  settings.forces = {{end, {5000 * 6e-4 * a * (a * a - 1) / 2, 0, 0}, area_shares(mesh, end)}};
  const TissueBody body(mesh, settings);
  const VectorXd exact = displaced(body, 0, [&](const Vector3d& x) { return (a - 1) * x[0]; });
  EXPECT_LT((equilibrium(body) - exact).norm(), 1e-10 * exact.norm());
}

TEST(ElasticSolids, AHangingBarConvergesWithOrderTwo) {
  // E u'' + rho g = 0, u(0) = 0, u'(L) = 0: u = rho g (L x - x^2 / 2) / E, and the energy is -(rho g)^2 A L^3
  // / (6 E).
  std::vector<double> error;
  for (const int n : {8, 16, 32}) {
    const TetMesh mesh = box_mesh({0.1, 0.02, 0.02}, {n, 2, 2});
    TissueSettings settings;
    settings.materials = {{5000, 0, 1000}};
    settings.model = tissue_model("fem_cauchy");
    settings.gravity = {9.81, 0, 0};
    settings.supports = {{points_in_box(mesh, {0, 0, 0}, {0, 1, 1})}};
    const TissueBody body(mesh, settings);
    const double exact = -std::pow(9810, 2) * 4e-4 * 1e-3 / (6 * 5000);
    error.push_back(std::abs(body.energy(0, equilibrium(body)) / exact - 1));
  }
  EXPECT_LT(error.back(), 0.01);
  EXPECT_NEAR(std::log2(error[0] / error[1]), 2, 0.1);
  EXPECT_NEAR(std::log2(error[1] / error[2]), 2, 0.1);
}

TEST(ElasticSolids, ALongitudinalFrequencyConvergesWithOrderTwoOrFour) {
  // A bar without lateral contraction, clamped at one end: omega = pi / (2 L) sqrt(E / rho). With ten nodes
  // the error is of order four, also with lumped mass.
  const double exact = std::numbers::pi / 0.2 * std::sqrt(5000. / 1000);
  for (const TissueModel& model : finite_elements) {
    std::vector<double> error;
    for (const int n : {4, 8, 16}) {
      const TetMesh mesh = mesh_for(model, box_mesh({0.1, 0.1, 0.1}, {n, 1, 1}));
      TissueSettings settings;
      settings.materials = {{5000, 0, 1000}};
      settings.model = model;
      settings.supports = {{points_in_box(mesh, {0, 0, 0}, {0, 1, 1})}};
      const TissueBody body(mesh, settings);
      // The frequency of this very shape: Rayleigh's quotient of the mode, which the mesh carries exactly.
      const VectorXd shape =
          displaced(body, 0, [](const Vector3d& x) { return std::sin(std::numbers::pi * x[0] / 0.2); });
      const VectorXd rest = VectorXd::Zero(body.dofs());
      const double square =
          shape.dot(stiffness(body, 0, rest, rest) * shape) / shape.dot(body.mass().cwiseProduct(shape));
      error.push_back(std::abs(std::sqrt(square) / exact - 1));
    }
    EXPECT_LT(error.back(), 1e-3) << model.id;
    const double order = model.has_ten_nodes ? 4 : 2;
    EXPECT_NEAR(std::log2(error[0] / error[1]), order, 0.1) << model.id;
    EXPECT_NEAR(std::log2(error[1] / error[2]), order, 0.1) << model.id;
  }
}

struct Beam {
  double length = 0.2, width = 0.02, young = 1e5, density = 1000;
  [[nodiscard]] TissueBody body(int n, bool loaded) const {
    const TetMesh mesh = box_mesh({length, width, width}, {8 * n, 2 * n, 2 * n});
    TissueSettings settings;
    settings.materials = {{young, 0, density}};
    settings.model = tissue_model("fem_cauchy");
    settings.supports = {{points_in_box(mesh, {0, 0, 0}, {0, 1, 1})}};
    const auto end = points_in_box(mesh, {length, 0, 0}, {length, 1, 1});
    if (loaded) settings.forces = {{end, {0, 0, 0.001}, area_shares(mesh, end)}};
    return TissueBody(mesh, settings);
  }
  [[nodiscard]] double area() const { return width * width; }
  [[nodiscard]] double inertia() const { return std::pow(width, 4) / 12; }
};

/// What values at three meshes, each twice as fine as the last, tend to, and the order at which they do.
struct Limit {
  double value, order;
  explicit Limit(const std::array<double, 3>& v)
      : value(v[2] + (v[2] - v[1]) * (v[2] - v[1]) / ((v[1] - v[0]) - (v[2] - v[1]))),
        order(std::log2((v[1] - v[0]) / (v[2] - v[1]))) {}
};

TEST(ElasticSolids, TheDeflectionOfABeamConvergesToTimoshenkosWithOrderTwo) {
  // w = P L^3 / (3 E I) + P L / (kappa G A), kappa = 10 (1 + nu) / (12 + 11 nu), nu = 0 (Cowper's shear
  // coefficient).
  const Beam beam;
  const double P = 0.001, G = beam.young / 2, kappa = 10. / 12;
  const double exact = P * std::pow(beam.length, 3) / (3 * beam.young * beam.inertia()) +
                       P * beam.length / (kappa * G * beam.area());
  // Coarse tetrahedra are too stiff by a multiple; the error of P / w is of order two from the first mesh on.
  std::array<double, 3> resistance;
  for (int i = 0; i < 3; ++i) {
    const TissueBody body = beam.body(1 << i, true);
    resistance[static_cast<std::size_t>(i)] = P / equilibrium(body).tail<1>()[0];
  }
  const Limit limit(resistance);
  EXPECT_NEAR(limit.order, 2, 0.1);
  EXPECT_NEAR(limit.value * exact / P, 1, 0.01);
}

TEST(ElasticSolids, TheBendingFrequencyOfABeamConvergesToTheClosedFormWithOrderTwo) {
  // (beta L)^2 sqrt(E I / (rho A L^4)), beta L = 1.8751; at L = 10 widths shear and rotation take about 1.5
  // %.
  const Beam beam;
  const double exact =
      std::pow(1.875104068711961, 2) *
      std::sqrt(beam.young * beam.inertia() / (beam.density * beam.area() * std::pow(beam.length, 4)));
  std::array<double, 3> square;
  for (int i = 0; i < 3; ++i) {
    const TissueBody body = beam.body(1 << i, false);
    square[static_cast<std::size_t>(i)] = std::pow(
        lowest_frequency(body, displaced(body, 2, [](const Vector3d& x) { return x[0] * x[0]; })), 2);
  }
  const Limit limit(square);
  EXPECT_NEAR(limit.order, 2, 0.1);
  EXPECT_NEAR(std::sqrt(limit.value) / exact, 0.985, 0.01);
}

TEST(ElasticSolids, NeoHookeanElementsStayFiniteAndPushBackWhenFlatOrInverted) {
  TetMesh mesh;
  mesh.points.resize(3, 4);
  mesh.points << 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1;
  mesh.points *= 0.01;
  mesh.tetrahedra.resize(4, 1);
  mesh.tetrahedra << 0, 1, 2, 3;
  TissueSettings settings;
  settings.model = tissue_model("fem_neo_hookean");
  settings.supports = {{{0, 1, 2}}};
  const TissueBody body(mesh, settings);
  const VectorXd still = VectorXd::Zero(3);
  double before = 0;
  for (const double height : {0.009, 0.005, 0.001, 0.0, -0.001, -0.01, -0.1}) {
    const VectorXd q = Vector3d(0, 0, height - 0.01);
    const VectorXd f = force(body, 0, q, still);
    EXPECT_TRUE(f.allFinite() && stiffness(body, 0, q, still).allFinite()) << height;
    EXPECT_GT(f[2], 0) << height;
    EXPECT_GT(body.energy(0, q), before) << height;
    before = body.energy(0, q);
  }
  // Green's strain gives way instead: past 1 / sqrt(3) of its height it resists less and less, and not at all
  // flat.
  settings.model = tissue_model("fem_green");
  EXPECT_NEAR(force(TissueBody(mesh, settings), 0, Vector3d(0, 0, -0.01), still)[2], 0, 1e-12);
}

TEST(ElasticSolids, SpringsOnTheEdgesHaveTheEnergyOfASolidUnderDilation) {
  // E V e^2 / (2 (1 - 2 nu)) * 3 at nu = 1/4: 3 E V e^2, whatever the mesh.
  TetMesh mesh = uneven_box();
  mesh.regions.clear();
  TissueSettings settings;
  settings.model = tissue_model("mass_spring");
  const TissueBody body(mesh, settings);
  const double strain = 0.01, volume = body.point_mass().sum() / settings.materials[0].density;
  EXPECT_NEAR(body.energy(0, (strain * mesh.points).reshaped()),
              3 * settings.materials[0].young * volume * strain * strain, 1e-10);
}

TEST(ElasticSolids, ASkinOfTrianglesHasTheStiffnessOfItsThickness) {
  // A closed box stretched along x by a small strain, all else held: each of its sides parallel to x has the
  // energy Y h A e^2 / (2 (1 - nu^2)) of plane stress.
  const TetMesh mesh = box_mesh({0.1, 0.1, 0.1}, {2, 2, 2});
  TissueSettings settings;
  const TissueBody bare(mesh, settings);
  settings.skin = {SkinSettings::Kind::membrane, 5e6, 0.4, 1e-4};
  const TissueBody body(mesh, settings);
  const double strain = 1e-6;
  const VectorXd q = displaced(body, 0, [&](const Vector3d& x) { return strain * x[0]; });
  const double skin = body.energy(0, q) - bare.energy(0, q);
  EXPECT_NEAR(skin / (4 * 0.01 * 5e6 * 1e-4 * strain * strain / (2 * (1 - 0.16))), 1, 1e-5);
}

TEST(ElasticSolids, TwoSkinsOnOneAnotherAreOneWithTheSumOfTheirStiffnesses) {
  // Layers on the same triangles stretch alike: what counts is E1 h1 + E2 h2. Epidermis on dermis, and one
  // skin as thick as both.
  const TetMesh mesh = uneven_box();
  const EdgeTable edges = edge_table(mesh);
  std::vector<TetMesh::Index> free(static_cast<std::size_t>(mesh.point_count()));
  for (std::size_t i = 0; i < free.size(); ++i) free[i] = static_cast<TetMesh::Index>(i);
  const BlockPattern pattern(free, edges.edges);
  const MeshSurface surface = surface_of(mesh);
  const auto skin = [&](double young, double thickness) {
    return Membrane(mesh.points, surface.triangles, young, 0.45, thickness, pattern);
  };
  const Membrane epidermis = skin(1.5e6, 1e-4), dermis = skin(344e3, 1.55e-3),
                 one = skin((1.5e6 * 1e-4 + 344e3 * 1.55e-3) / 1.65e-3, 1.65e-3);
  NodeRows x = node_rows(mesh.points), f(x.size()), whole(x.size());
  const VectorXd by = random_vector(3 * mesh.point_count(), 0.01, 3);
  for (std::size_t i = 0; i < x.size(); ++i)
    as_vector(x[i]) += by.segment<3>(3 * static_cast<Eigen::Index>(i));
  epidermis.add_force(x, f);
  dermis.add_force(x, f);
  one.add_force(x, whole);
  for (std::size_t i = 0; i < x.size(); ++i)
    EXPECT_LT((as_vector(f[i]) - as_vector(whole[i])).norm(), 1e-12 * (1 + as_vector(whole[i]).norm()));
  EXPECT_NEAR(epidermis.energy(x) + dermis.energy(x), one.energy(x), 1e-12 * one.energy(x));
  for (std::size_t t = 0; t < one.size(); ++t)
    EXPECT_LT((epidermis.stiffness(x, t) + dermis.stiffness(x, t) - one.stiffness(x, t)).norm(),
              1e-12 * one.stiffness(x, t).norm());
}

TEST(TableSpring, StoresTheAreaUnderItsLines) {
  const TableSpring spring({-0.2, -0.05, 0.06, 0.3}, {-0.15, -0.05, 0.06, 0.5});
  // A triangle of slope 1 on both sides of rest, and the trapezia behind it.
  EXPECT_NEAR(spring.integral(0.06), 0.06 * 0.06 / 2, 1e-16);
  EXPECT_NEAR(spring.integral(0.3), 0.06 * 0.06 / 2 + 0.24 * (0.06 + 0.5) / 2, 1e-15);
  EXPECT_NEAR(spring.integral(-0.2), 0.05 * 0.05 / 2 + 0.15 * (0.05 + 0.15) / 2, 1e-15);
}

}  // namespace
}  // namespace hmax
