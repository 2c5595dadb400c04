/// Forces, stiffness and static solutions of nearly flat tetrahedra against extended precision.
#include <cfloat>
#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "analysis/statics/static_solution.hpp"
#include "problems/mesh/mesh_quality.hpp"
#include "tests/problems/tissue/bodies.hpp"

namespace hmax {
namespace {

using namespace tissue_tests;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using Long = long double;
using LongMatrix = Eigen::Matrix<Long, 3, 3>;
using LongVector = Eigen::Matrix<Long, Eigen::Dynamic, 1>;

const std::array solids{tissue_model("fem_cauchy"), tissue_model("fem_green"),
                        tissue_model("fem_corotational"), tissue_model("fem_neo_hookean")};
constexpr double eps = std::numeric_limits<double>::epsilon(), degree = std::numbers::pi / 180;

class Slivers : public testing::Test {
 protected:
  void SetUp() override {
    if (LDBL_MANT_DIG <= DBL_MANT_DIG) GTEST_SKIP() << "long double has no more digits than double here";
  }
};

/// A ball whose centre was moved towards the opposite face of its first tetrahedron, until that has the
/// dihedral angle.
TetMesh ball_with_sliver(double angle) {
  TetMesh mesh = ball_mesh(0.05, 2);
  std::array<Vector3d, 3> face;
  for (Eigen::Index a = 0, k = 0; a < 4; ++a)
    if (mesh.tetrahedra(a, 0) != 0)
      face[static_cast<std::size_t>(k++)] = mesh.points.col(mesh.tetrahedra(a, 0));
  const Vector3d middle = (face[0] + face[1] + face[2]) / 3;
  // The face has equal edges, a third of its height away from the middle.
  const double away = (face[2] - (face[0] + face[1]) / 2).norm() / 3;
  mesh.points.col(0) = middle - away * std::tan(angle) * middle.normalized();
  return mesh;
}

/// One tetrahedron with the dihedral angle, away from the origin and from the axes.
TetMesh sliver(double angle) {
  TetMesh mesh;
  mesh.points.resize(3, 4);
  mesh.points << 0, 0.02, 0.01, 0.01, 0, 0, -0.01, 0.01, 0, 0, 0, 0;
  mesh.points(2, 2) = mesh.points(2, 3) = 0.01 * angle / 2;
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.7, Vector3d(1, 2, -0.5).normalized()).toRotationMatrix();
  mesh.points = (turn * mesh.points).colwise() + Vector3d(0.1, 0.2, 0.05);
  mesh.tetrahedra.resize(4, 1);
  mesh.tetrahedra << 0, 1, 2, 3;
  if (signed_volume(corners_of(mesh, 0)) < 0) mesh.tetrahedra << 1, 0, 2, 3;
  return mesh;
}

/// The first Piola-Kirchhoff stress as the books have it.
LongMatrix stress(const TissueModel& model, const LongMatrix& F, const Lame& lame) {
  const LongMatrix I = LongMatrix::Identity();
  const Long lambda = lame.lambda, mu = lame.mu;
  const auto hooke = [&](const LongMatrix& e) -> LongMatrix { return 2 * mu * e + lambda * e.trace() * I; };
  if (model == tissue_model("fem_cauchy")) return hooke((F + F.transpose()) / 2 - I);
  if (model == tissue_model("fem_green")) return F * hooke((F.transpose() * F - I) / 2);
  if (model == tissue_model("fem_corotational")) {
    LongMatrix R = F;  // Newton's iteration for the orthogonal factor of F
    for (int i = 0; i < 40; ++i) R = (R + R.inverse().transpose()).eval() / 2;
    return R * hooke(R.transpose() * F - I);
  }
  const Long m = 4 * mu / 3, l = lambda + 5 * mu / 6, J = F.determinant();
  return m * (1 - 1 / (F.squaredNorm() + 1)) * F +
         l * (J - 1 - 3 * m / (4 * l)) * J * F.inverse().transpose();
}

/// The elastic forces on the free points in extended precision.
LongVector exact_forces(const TissueBody& body, const LongVector& q) {
  const TetMesh& mesh = body.mesh();
  Eigen::Matrix<Long, 3, Eigen::Dynamic> u(3, mesh.point_count()), f(3, mesh.point_count());
  u.setZero();
  f.setZero();
  const auto& free = body.free_points();
  for (std::size_t i = 0; i < free.size(); ++i)
    u.col(free[i]) = q.segment<3>(3 * static_cast<Eigen::Index>(i));
  for (Eigen::Index t = 0; t < mesh.tetrahedron_count(); ++t) {
    const auto p = mesh.tetrahedra.col(t);
    LongMatrix Dm, Du;
    for (Eigen::Index a = 1; a < 4; ++a) {
      Dm.col(a - 1) = mesh.points.col(p[a]).cast<Long>() - mesh.points.col(p[0]).cast<Long>();
      Du.col(a - 1) = u.col(p[a]) - u.col(p[0]);
    }
    const LongMatrix Bm = Dm.inverse();
    const TissueMaterial& material = body.settings().materials[static_cast<std::size_t>(mesh.region(t))];
    const LongMatrix pull = Dm.determinant() / 6 *
                            stress(body.settings().model, LongMatrix::Identity() + Du * Bm,
                                   lame(material.young, material.poisson)) *
                            Bm.transpose();
    for (Eigen::Index a = 1; a < 4; ++a) f.col(p[a]) -= pull.col(a - 1);
    f.col(p[0]) += pull.rowwise().sum();
  }
  LongVector all(q.size());
  for (std::size_t i = 0; i < free.size(); ++i)
    all.segment<3>(3 * static_cast<Eigen::Index>(i)) = f.col(free[i]);
  return all;
}

TEST_F(Slivers, ForcesLoseNoMoreThanTheLongestEdgeOverTheHeight) {
  for (const double angle : {10.0, 1.0, 0.1, 0.01, 1e-3, 1e-4})
    for (const double strain : {1e-4, 1e-2, 0.1})
      for (const TissueModel& model : solids) {
        TissueSettings settings;
        settings.model = model;
        const TissueBody body(sliver(angle * degree), settings);
        const Eigen::Matrix3d H = random_vector(9, strain, 4).reshaped(3, 3);
        const VectorXd q = (H * body.mesh().points).reshaped();
        const LongVector exact = exact_forces(body, q.cast<Long>());
        const double error =
            static_cast<double>((force(body, 0, q, 0 * q).cast<Long>() - exact).norm() / exact.norm());
        EXPECT_LT(error, eps * (20 / (angle * degree) + 20))
            << model.id << ", " << angle << " degrees, strain " << strain;
      }
}

TEST_F(Slivers, StiffnessAtRestLosesNoDigits) {
  // K_ab = V (lambda g_a g_b^T + mu g_b g_a^T + mu g_a.g_b I) for every model.
  for (const double angle : {10.0, 0.1, 1e-4})
    for (const TissueModel& model : solids) {
      TissueSettings settings;
      settings.model = model;
      const TissueBody body(sliver(angle * degree), settings);
      const auto p = body.mesh().tetrahedra.col(0);
      LongMatrix Dm;
      for (Eigen::Index a = 1; a < 4; ++a)
        Dm.col(a - 1) = body.mesh().points.col(p[a]).cast<Long>() - body.mesh().points.col(p[0]).cast<Long>();
      Eigen::Matrix<Long, 3, 4> g;
      g.rightCols<3>() = Dm.inverse().transpose();
      g.col(0) = -g.rightCols<3>().rowwise().sum();
      const TissueMaterial& material = body.settings().materials[0];
      const Lame solid = lame(material.young, material.poisson);
      Eigen::Matrix<Long, 12, 12> exact;
      for (Eigen::Index a = 0; a < 4; ++a)
        for (Eigen::Index b = 0; b < 4; ++b)
          exact.block<3, 3>(3 * p[a], 3 * p[b]) =
              Dm.determinant() / 6 *
              (solid.lambda * g.col(a) * g.col(b).transpose() + solid.mu * g.col(b) * g.col(a).transpose() +
               solid.mu * g.col(a).dot(g.col(b)) * LongMatrix::Identity());
      const VectorXd rest = VectorXd::Zero(12);
      const Long error = (stiffness(body, 0, rest, rest).cast<Long>() - exact).cwiseAbs().maxCoeff();
      EXPECT_LT(static_cast<double>(error / exact.cwiseAbs().maxCoeff()), 1e-12) << model.id << ", " << angle;
    }
}

TEST_F(Slivers, TheGreenStiffnessIsTheDerivativeOfTheForceUpToTheLongestEdgeOverTheHeight) {
  TissueSettings settings;
  for (const double angle : {1.0, 0.01, 1e-4}) {
    const TissueBody body(sliver(angle * degree), settings);
    const VectorXd q =
        (Eigen::Matrix3d(random_vector(9, 1e-3, 4).reshaped(3, 3)) * body.mesh().points).reshaped();
    const MatrixXd K = stiffness(body, 0, q, 0 * q);
    // Of cubic polynomials, differences over +-d leave d^2 P''' / 6.
    const Long d = 1e-5L * angle * degree * 0.01L;
    for (Eigen::Index j = 0; j < 12; ++j) {
      const LongVector step = d * LongVector::Unit(12, j), at = q.cast<Long>();
      const LongVector column = (exact_forces(body, at - step) - exact_forces(body, at + step)) / (2 * d);
      EXPECT_LT(static_cast<double>((K.col(j).cast<Long>() - column).norm() / K.norm()),
                1e-9 + 20 * eps / (angle * degree))
          << angle;
    }
  }
}

/// Where elastic forces and weight are in equilibrium, from residuals in extended precision. The stiffness of
/// the body only gives the steps.
VectorXd exact_equilibrium(const TissueBody& body) {
  const LongVector weight =
      body.mass().cwiseProduct(body.settings().gravity.replicate(body.dofs() / 3, 1)).cast<Long>();
  LongVector q = LongVector::Zero(body.dofs());
  for (int k = 0; k < 60; ++k) {
    const LongVector residual = exact_forces(body, q) + weight;
    if (residual.norm() < 1e-14L * weight.norm()) return q.cast<double>();
    const VectorXd at = q.cast<double>();
    const VectorXd step = stiffness(body, 0, at, 0 * at).ldlt().solve(residual.cast<double>());
    q += step.cast<Long>();
  }
  ADD_FAILURE() << "no equilibrium in extended precision";
  return q.cast<double>();
}

TEST_F(Slivers, AStaticSolutionIsThatOfExtendedPrecision) {
  for (const double angle : {0.135, 0.09, 1.5e-4})
    for (const TissueModel& model : solids) {
      const TetMesh mesh = ball_with_sliver(angle * degree);
      const MeshQuality quality = quality_of(mesh);
      ASSERT_EQ(quality.worst, 0);
      ASSERT_GT(quality.min_mean_ratio, 0);
      ASSERT_NEAR(quality.smallest_angle / degree, angle, 1e-6 + 0.01 * angle);
      TissueSettings settings;
      settings.model = model;
      settings.materials = {{20000, 0.45, 1000}};
      settings.gravity = {2, 0, -9.81};
      settings.supports = {{points_in_box(mesh, {-1, -1, -1}, {1, 1, -0.02})}};
      const TissueBody body(mesh, settings);
      const VectorXd still = VectorXd::Zero(body.dofs());
      const StaticModel balance{
          .dofs = body.dofs(),
          .force = [&](const VectorXd& q, VectorXd& f) { body.force(0, q, still, f); },
          .stiffness = [&](const VectorXd& q, StaticModel::Matrix& K) { body.stiffness(0, q, still, K); },
          .energy = [&](const VectorXd& q) { return body.energy(0, q); },
          .admissible = [&](const VectorXd& q) { return body.least_volume(0, q).first > 0; }};
      const StaticSolution found = solve_static(balance, {.tolerance = 1e-8}, [] { return 0.0; });
      EXPECT_TRUE(found.converged) << model.id << ", " << angle << ": " << found.note;
      EXPECT_LT(found.iterations, 12);
      const VectorXd exact = exact_equilibrium(body);
      EXPECT_LT((found.q - exact).norm(), 1e-6 * exact.norm()) << model.id << ", " << angle;
    }
}

}  // namespace
}  // namespace hmax
