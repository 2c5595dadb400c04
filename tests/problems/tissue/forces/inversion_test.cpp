/// Bodies that come back from flat, mirrored and random states, as those of every model that says so do.
#include <cmath>

#include <gtest/gtest.h>

#include "tests/problems/tissue/bodies.hpp"

namespace hmax {
namespace {

using namespace tissue_tests;
using Eigen::Matrix3Xd;
using Eigen::VectorXd;

/// The body after a damped motion of 4 s from these positions, shape (3, points), disturbed by 1 um.
VectorXd settled(const TissueBody& body, const Matrix3Xd& start, double h = 5e-4) {
  VectorXd q = (start - body.mesh().points).reshaped() + random_vector(body.dofs(), 1e-6, 5);
  VectorXd v = VectorXd::Zero(body.dofs()), f = v;
  const double damping = 8;
  for (int n = 0; n < std::lround(4 / h); ++n) {
    body.force(0, q, v, f);
    v += h * (f.cwiseQuotient(body.mass()) - damping * v);
    q += h * v;
  }
  return q;
}

TEST(Inversion, EveryModelThatResistsItComesBackToItsShape) {
  const TetMesh mesh = cube_mesh(0.1, 2);
  Matrix3Xd flat = mesh.points, mirrored = flat, random = flat;
  flat.row(2).setZero();
  mirrored.row(2) *= -1;
  random = (random_vector(random.size(), 0.05, 3).array() + 0.05).matrix().reshaped(3, random.cols());
  int tried = 0;
  for (const TissueModel& model : tissue_models()) {
    if (!model.resists_inversion) continue;
    ++tried;
    for (const double nu : {0.3, 0.45})
      for (const Matrix3Xd& start : {flat, mirrored, random}) {
        const TissueBody body(mesh, {.model = model, .materials = {{5000, nu, 1000}}});
        const VectorXd q = settled(body, start);
        const double before = body.energy(0, (start - mesh.points).reshaped());
        EXPECT_LT(body.energy(0, q), 1e-6 * before) << model.id << ", nu " << nu;
        EXPECT_NEAR(body.least_volume(0, q).first, 1, 1e-2) << model.id << ", nu " << nu;
      }
  }
  EXPECT_GE(tried, 3);
}

TEST(Inversion, CubesOfTenNodesComeBackFromFlatAndMirroredStates) {
  // Not from all random ones: what is inverted between the four points of the rule may stay so.
  const TissueModel& model = tissue_model("fem_quadratic");
  EXPECT_FALSE(model.resists_inversion);
  const TetMesh mesh = ten_node_mesh(cube_mesh(0.1, 2));
  Matrix3Xd flat = mesh.points, mirrored = flat;
  flat.row(2).setZero();
  mirrored.row(2) *= -1;
  for (const Matrix3Xd& start : {flat, mirrored}) {
    const TissueBody body(mesh, {.model = model, .materials = {{5000, 0.45, 1000}}});
    const VectorXd q = settled(body, start, 2e-4);
    EXPECT_LT(body.energy(0, q), 1e-6 * body.energy(0, (start - mesh.points).reshaped()));
    EXPECT_NEAR(body.least_volume(0, q).first, 1, 1e-2);
  }
}

TEST(Inversion, CorotationalStressesFollowAPathThroughFlatAndInvertedStates) {
  // No jump where the third stretch passes 0, up to where it cancels the second: there energy has a ridge.
  const Lame material = lame(5000, 0.45);
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, -1).normalized()).toRotationMatrix();
  Eigen::Matrix3d before, along;
  along << 0.3, -0.2, 0.5, 0.1, 0.4, -0.6, 0.2, 0.7, -0.1;
  for (int i = 0; i <= 180; ++i) {
    const Eigen::Vector3d stretches(1.1, 0.9, 1 - 0.01 * i);
    const Eigen::Matrix3d F = turn * stretches.asDiagonal();
    const Corotational law(F - Eigen::Matrix3d::Identity(), material);
    // W = mu sum (s - 1)^2 + lambda/2 (sum (s - 1))^2 of stretches with their signs.
    const Eigen::Vector3d strain = stretches.array() - 1;
    const double energy =
        material.mu * strain.squaredNorm() + material.lambda / 2 * strain.sum() * strain.sum();
    EXPECT_NEAR(law.energy(), energy, 1e-11 * (1 + energy)) << i;
    const Eigen::Matrix3d stress = law.stress();
    ASSERT_TRUE(stress.allFinite() && law.differential(F).allFinite()) << i;
    if (i > 0) {
      EXPECT_LT((stress - before).norm(), 0.01 * (2 * material.mu + 3 * material.lambda)) << i;
    }
    const auto stress_at = [&](double d) {
      return Corotational(F + d * along - Eigen::Matrix3d::Identity(), material).stress();
    };
    const Eigen::Matrix3d by_difference = (stress_at(1e-5) - stress_at(-1e-5)) / 2e-5;
    EXPECT_LT((law.differential(along) - by_difference).norm(), 1e-6 * by_difference.norm()) << i;
    // Forces restore: shortening it further takes work.
    if (i > 20) {
      EXPECT_LT((stress.transpose() * turn)(2, 2), 0) << i;
    }
    before = stress;
  }
  // On the ridge the rotation is one of many; nothing is infinite.
  const Eigen::Matrix3d ridge = Eigen::Vector3d(1, 1, -1).asDiagonal();
  const Corotational law(ridge - Eigen::Matrix3d::Identity(), material);
  EXPECT_TRUE(law.stress().allFinite());
  EXPECT_TRUE(law.differential(ridge).allFinite());
}

}  // namespace
}  // namespace hmax
