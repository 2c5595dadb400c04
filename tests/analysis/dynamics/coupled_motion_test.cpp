/// Methods of positions and velocities on models whose modes they couple.
#include "analysis/dynamics/coupled_motion.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "analysis/amplification/structural_amplification.hpp"
#include "analysis/spectrum/spectrum.hpp"
#include "analysis/step_limits/stable_step.hpp"
#include "core/numbers.hpp"

namespace hmax {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

struct Named {
  std::string name;
  Amplification amplification;
};

std::vector<Named> structural_methods() {
  return {{"symplectic_euler", symplectic_euler_amplification()},
          {"velocity_verlet", kick_drift_kick_amplification(KickDamping::half_step)},
          {"stormer_verlet", kick_drift_kick_amplification(KickDamping::predicted)},
          {"central_difference", kick_drift_kick_amplification(KickDamping::lumped)},
          {"explicit_newmark", generalized_alpha_amplification(newmark_parameters(0, 0.5L))},
          {"newmark 1/10", generalized_alpha_amplification(newmark_parameters(0.1L, 0.5L))},
          {"newmark 1/10, 0.6", generalized_alpha_amplification(newmark_parameters(0.1L, 0.6L))},
          {"newmark 1/10, 0.45", generalized_alpha_amplification(newmark_parameters(0.1L, 0.45L))},
          {"newmark", generalized_alpha_amplification(newmark_parameters(0.25L, 0.5L))},
          {"hht", generalized_alpha_amplification(hht_parameters(-0.1L))},
          {"generalized_alpha", generalized_alpha_amplification(generalized_alpha_parameters(0.8L))}};
}

/// A square matrix of numbers in [-1, 1].
MatrixXd random_matrix(Eigen::Index n, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  return MatrixXd::NullaryExpr(n, n, [&] { return uniform(random); });
}

/// A K = A^T A and C with eigenvectors of its own, of masses 1 ... n.
MechanicalPart random_part(Eigen::Index n, unsigned seed, double damping) {
  const MatrixXd A = random_matrix(n, seed), B = random_matrix(n, seed + 1000);
  return mechanical_part(VectorXd::LinSpaced(n, 1, static_cast<double>(n)),
                         MatrixXd(10 * A.transpose() * A + MatrixXd::Identity(n, n)),
                         MatrixXd(damping * B.transpose() * B));
}

TEST(CoupledMotion, OfAModelThatDecouplesHasTheRootsAndTheLimitOfItsModes) {
  MechanicalPart part = random_part(5, 1, 0);
  const MatrixXd K = dense(part.K), M = part.mass.diagonal().asDiagonal();
  part = mechanical_part(part.mass, K, MatrixXd(0.02 * M + 0.01 * K));
  ASSERT_TRUE(part.decouples());
  const std::vector<MechanicalMode> modes = mechanical_modes(part).modes;
  for (const auto& [name, amplification] : structural_methods()) {
    if (name == "central_difference") continue;  // couples them by itself
    EXPECT_FALSE(couples_modes(*amplification.motion, part)) << name;
    const CoupledMotion whole(*amplification.motion, part);
    for (const double h : {0.03, 0.3, 3.0}) {
      double radius = 0;
      for (const MechanicalMode& mode : modes)
        radius = std::max(radius, amplification.of_oscillation(mode).spectral_radius(h));
      EXPECT_NEAR(whole.spectral_radius(h), radius, 1e-9 * radius) << name << " " << h;
    }
    const double expected = largest_stable_step(amplification, modes).h_max;
    const auto limit = whole.first_exit(amplification);
    ASSERT_TRUE(limit) << name;
    if (std::isinf(expected)) {
      EXPECT_EQ(limit->h_max, infinity) << name;
    } else {
      EXPECT_NEAR(limit->h_max, expected, 1e-9 * expected) << name;
    }
  }
}

TEST(CoupledMotion, OfCentralDifferencesWithADiagonalDamperIsTheClassicalMethod) {
  // (M + h/2 C) q_n+1 = (2 M - h^2 K) q_n - (M - h/2 C) q_n-1 leaves at omega h = 2 whatever the damping.
  MechanicalPart part = random_part(4, 3, 0);
  part = mechanical_part(part.mass, part.K, MatrixXd(VectorXd::LinSpaced(4, 0.1, 3).asDiagonal()));
  ASSERT_EQ(part.damping, Damping::general);
  const Amplification amplification = kick_drift_kick_amplification(KickDamping::lumped);
  EXPECT_TRUE(couples_modes(*amplification.motion, part));
  const auto limit = CoupledMotion(*amplification.motion, part).first_exit(amplification);
  ASSERT_TRUE(limit);
  MechanicalPart undamped = mechanical_part(part.mass, part.K, MatrixXd(MatrixXd::Zero(4, 4)));
  EXPECT_NEAR(limit->h_max, 2 / std::sqrt(mechanical_modes(undamped).modes.back().kappa), 1e-9);
}

// Without stiffness no multiple of the damping is as large as it.
TEST(CoupledMotion, OfCentralDifferencesHasALimitWithoutStiffness) {
  const MatrixXd C = MatrixXd{{2, -1}, {-1, 2}};
  const MechanicalPart part = mechanical_part(VectorXd::Ones(2), MatrixXd(MatrixXd::Zero(2, 2)), C);
  const Amplification amplification = kick_drift_kick_amplification(KickDamping::lumped);
  const CoupledMotion whole(*amplification.motion, part);
  const auto limit = whole.first_exit(amplification);
  ASSERT_TRUE(limit);
  EXPECT_LE(whole.spectral_radius(limit->h_max * (1 - 1e-6)), 1 + 1e-9);
  EXPECT_GT(whole.spectral_radius(limit->h_max * (1 + 1e-6)), 1);
}

TEST(CoupledMotion, OfExplicitNewmarkHasTheLimitOfNoDampingWhateverTheDamping) {
  const Amplification amplification = generalized_alpha_amplification(newmark_parameters(0, 0.5L));
  for (const double damping : {0.01, 0.3, 4.0}) {
    const MechanicalPart part = random_part(4, 5, damping),
                         undamped = mechanical_part(part.mass, part.K, MatrixXd(MatrixXd::Zero(4, 4)));
    ASSERT_EQ(part.damping, Damping::general);
    const double expected = 2 / std::sqrt(mechanical_modes(undamped).modes.back().kappa);
    const auto limit = CoupledMotion(*amplification.motion, part).first_exit(amplification);
    ASSERT_TRUE(limit && limit->proved) << damping;
    EXPECT_NEAR(limit->h_max, expected, 1e-9 * expected) << damping;
    const auto large = proved_first_exit(*amplification.motion, part, amplification);
    ASSERT_TRUE(large) << damping;
    EXPECT_NEAR(large->h_max, expected, 1e-9 * expected) << damping;
  }
}

TEST(CoupledMotion, LeavesTheUnitCircleWhereItSays) {
  int at_once = 0, unbounded = 0, proved = 0;
  for (unsigned seed = 1; seed <= 12; ++seed)
    for (const double damping : {0.01, 0.3, 4.0})
      for (const auto& [name, amplification] : structural_methods()) {
        const MechanicalPart part = random_part(3 + seed % 4, seed, damping);
        ASSERT_EQ(part.damping, Damping::general);
        const CoupledMotion whole(*amplification.motion, part);
        const auto limit = whole.first_exit(amplification);
        ASSERT_TRUE(limit) << name;
        proved += limit->proved ? 1 : 0;
        const std::string where = name + " " + std::to_string(seed) + " " + std::to_string(damping);
        if (std::isinf(limit->h_max)) {
          ++unbounded;
          for (const double h : {1e-2, 1.0, 1e2, 1e4}) EXPECT_LE(whole.spectral_radius(h), 1 + 1e-7) << where;
          continue;
        }
        ++at_once;
        EXPECT_GT(limit->h_max, 0) << where;
        EXPECT_GT(whole.spectral_radius(limit->h_max * (1 + 1e-5)), 1) << where;
        for (const double share : {0.05, 0.3, 0.6, 0.9, 0.99, 1 - 1e-7})
          EXPECT_LE(whole.spectral_radius(limit->h_max * share), 1 + 1e-10) << where << " " << share;
      }
  EXPECT_EQ(at_once, 12 * 3 * 8);
  EXPECT_EQ(unbounded, 12 * 3 * 3);
  EXPECT_GE(proved, 12 * 3 * 8);
}

TEST(CoupledMotion, NeedNotBeSymmetric) {
  // A follower force: the model flutters where stiffness turns too much; short of that the methods have
  // limits.
  const MatrixXd K = (MatrixXd(2, 2) << 4, 0.9, -0.9, 9).finished(),
                 C = (MatrixXd(2, 2) << 0.3, 0.1, -0.2, 0.5).finished();
  const MechanicalPart part = mechanical_part(VectorXd::Ones(2), K, C);
  ASSERT_FALSE(part.symmetric);
  for (const auto& [name, amplification] : structural_methods()) {
    const CoupledMotion whole(*amplification.motion, part);
    const auto limit = whole.first_exit(amplification);
    ASSERT_TRUE(limit) << name;
    EXPECT_FALSE(limit->proved);
    if (std::isinf(limit->h_max)) {
      EXPECT_LE(whole.spectral_radius(1e3), 1 + 1e-9) << name;
      continue;
    }
    EXPECT_GT(whole.spectral_radius(limit->h_max * (1 + 1e-5)), 1) << name;
    EXPECT_LE(whole.spectral_radius(limit->h_max * (1 - 1e-7)), 1 + 1e-10) << name;
  }
}

TEST(CoupledMotion, OfGyroscopicForcesIsAmplifiedByEveryStepOfExplicitMethods) {
  // q1'' + g q2' + k1 q1 = 0, q2'' - g q1' + k2 q2 = 0.
  const MatrixXd K = Eigen::Vector2d(200, 100).asDiagonal(), gyroscopic{{0, 1.5}, {-1.5, 0}};
  const auto part = [&](double c, double g = 1) {
    return mechanical_part(Eigen::VectorXd::Ones(2), K,
                           MatrixXd(g * gyroscopic + c * MatrixXd::Identity(2, 2)));
  };
  const Amplification euler = symplectic_euler_amplification();
  const CoupledMotion undamped(*euler.motion, part(0));
  // Growth of h^2: half the step has a quarter of it.
  EXPECT_NEAR((undamped.spectral_radius(1e-3) - 1) / (undamped.spectral_radius(5e-4) - 1), 4, 0.05);
  EXPECT_GT(undamped.spectral_radius(1e-3), 1 + 1e-7);
  EXPECT_EQ(undamped.first_exit(euler).value().h_max, 0);
  // Weak ones, whose growth is rounding at small steps.
  for (const double g : {0.1, 1e-2, 1e-3})
    EXPECT_EQ(CoupledMotion(*euler.motion, part(0, g)).first_exit(euler).value().h_max, 0) << g;
  // Damping that outweighs the growth up to some step leaves a limit.
  const CoupledMotion damped(*euler.motion, part(0.01));
  const double h = damped.first_exit(euler).value().h_max;
  EXPECT_GT(h, 0);
  EXPECT_LE(damped.spectral_radius(0.99 * h), 1);
  EXPECT_GT(damped.spectral_radius(1.01 * h), 1);
}

TEST(CoupledMotion, OfABodyThatDriftsIsStable) {
  // Two bodies on a spring, and a damper on one of them that its motion against the other does not share.
  const MatrixXd K = (MatrixXd(2, 2) << 5, -5, -5, 5).finished(),
                 C = (MatrixXd(2, 2) << 0.2, -0.2, -0.2, 0.2).finished();
  const MechanicalPart part = mechanical_part(Eigen::Vector2d(1, 3), K, C);
  const Amplification lumped = kick_drift_kick_amplification(KickDamping::lumped);
  ASSERT_TRUE(couples_modes(*lumped.motion, part));
  const auto limit = CoupledMotion(*lumped.motion, part).first_exit(lumped);
  ASSERT_TRUE(limit);
  EXPECT_GT(limit->h_max, 0.3);
  EXPECT_LT(limit->h_max, 2 / std::sqrt(5 * 4.0 / 3));
}

/// A chain between walls, or of free ends, whose stiffness damps it: C = beta K.
MechanicalPart damped_chain(Eigen::Index n, double beta, bool is_free = false) {
  Eigen::SparseMatrix<double> K(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    K.coeffRef(i, i) = 200;
    if (i > 0) K.coeffRef(i, i - 1) = K.coeffRef(i - 1, i) = -100;
  }
  if (is_free) K.coeffRef(0, 0) = K.coeffRef(n - 1, n - 1) = 100;
  return mechanical_part(VectorXd::Constant(n, 0.5), K, Eigen::SparseMatrix<double>(beta * K));
}

TEST(CoupledMotion, OfCentralDifferencesWithFastDampingIsProved) {
  const Amplification lumped = kick_drift_kick_amplification(KickDamping::lumped);
  for (const double beta : {0.01, 0.1, 1.0, 10.0}) {
    const CoupledMotion whole(*lumped.motion, damped_chain(12, beta));
    const auto limit = whole.first_exit(lumped);
    ASSERT_TRUE(limit);
    EXPECT_TRUE(limit->proved) << beta;
    for (int i = 1; i < 200; ++i)
      EXPECT_LE(whole.spectral_radius(limit->h_max * i / 200), 1 + 1e-9) << beta << " " << i;
    EXPECT_GT(whole.spectral_radius(1.001 * limit->h_max), 1 + 1e-6) << beta;
  }
}

TEST(CoupledMotion, OfCentralDifferencesIsProvedForAFreeBodyToo) {
  // Nothing resists or damps its rigid motion: C and rho C - K are definite but for rounding.
  const Amplification lumped = kick_drift_kick_amplification(KickDamping::lumped);
  for (const double beta : {0.01, 0.1}) {
    const CoupledMotion whole(*lumped.motion, damped_chain(12, beta, true));
    const auto limit = whole.first_exit(lumped);
    ASSERT_TRUE(limit);
    EXPECT_TRUE(limit->proved) << beta;
    EXPECT_LE(whole.spectral_radius(0.999 * limit->h_max), 1 + 1e-6) << beta;
    EXPECT_GT(whole.spectral_radius(1.001 * limit->h_max), 1 + 1e-6) << beta;
  }
}

TEST(CoupledMotion, OfCentralDifferencesIsNotProvedWhereAShapeEscapesItsDampers) {
  // Dampers between neighbours do not see them move together, which what is lumped stops all the same.
  const Eigen::Index n = 6;
  MatrixXd K = 100 * MatrixXd::Identity(n, n), C = 4 * MatrixXd::Identity(n, n);
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j < n; ++j)
      if (i != j) C(i, j) = -0.79;
  const Amplification lumped = kick_drift_kick_amplification(KickDamping::lumped);
  const CoupledMotion whole(*lumped.motion, mechanical_part(VectorXd::Ones(n), K, C));
  const auto limit = whole.first_exit(lumped);
  ASSERT_TRUE(limit);
  EXPECT_FALSE(limit->proved);
  EXPECT_LE(whole.spectral_radius(0.999 * limit->h_max), 1 + 1e-9);
  EXPECT_GT(whole.spectral_radius(1.001 * limit->h_max), 1 + 1e-9);
}

TEST(CoupledMotion, OfLargeSystemsIsRefusedWhereOnlyStridesWouldDo) {
  const Eigen::Index n = 600;
  const Amplification lumped = kick_drift_kick_amplification(KickDamping::lumped),
                      verlet = kick_drift_kick_amplification(KickDamping::predicted);
  MatrixXd K = 2 * MatrixXd::Identity(n, n);
  K.diagonal(1).setConstant(-1);
  K.diagonal(-1).setConstant(-1);
  // Dampers between neighbours alone, which do not see all of them move together.
  MatrixXd C = 0.01 * K;
  C(0, 0) = C(n - 1, n - 1) = 0.01;
  const MechanicalPart part = mechanical_part(VectorXd::Ones(n), K, C);
  EXPECT_FALSE(CoupledMotion(*lumped.motion, part).first_exit(lumped));
  const auto limit = CoupledMotion(*verlet.motion, part).first_exit(verlet);
  ASSERT_TRUE(limit);
  EXPECT_TRUE(limit->proved);
}

TEST(CoupledMotion, OfCentralDifferencesIsProvedAsFarAsItsConditionHolds) {
  // K = C = (1 + a) I - a J, J of ones: eigenvalues 1 + a, and 1 - (n - 1) a of all bodies together. It
  // leaves at zeta = -1, where 4 - 4 a h - (1 + a) h^2 = 0; I + h/2 C + h^2/2 (C - diag C) is definite where
  // 1 + h/2 (1 - (n - 1) a) > h^2/2 (n - 1) a.
  constexpr Eigen::Index n = 6;
  const auto exit = [](double a) { return 2 * (std::sqrt(a * a + a + 1) - a) / (1 + a); };
  const auto is_proved = [&](double a) {
    const double h = exit(a);
    return 1 + h / 2 * (1 - (n - 1) * a) > h * h / 2 * (n - 1) * a;
  };
  double low = 0.1, high = 0.2;
  ASSERT_TRUE(is_proved(low) && !is_proved(high));
  while (high - low > 1e-9) (is_proved((low + high) / 2) ? low : high) = (low + high) / 2;
  const Amplification lumped = kick_drift_kick_amplification(KickDamping::lumped);
  for (const double share : {0.99, 1.01}) {
    const double a = share * low;
    const MatrixXd C = (1 + a) * MatrixXd::Identity(n, n) - a * MatrixXd::Ones(n, n);
    const auto limit =
        CoupledMotion(*lumped.motion, mechanical_part(VectorXd::Ones(n), C, C)).first_exit(lumped);
    ASSERT_TRUE(limit);
    EXPECT_EQ(limit->proved, share < 1) << share;
    // Beyond it all bodies together leave before that.
    EXPECT_NEAR(limit->h_max / exit(a), 1, share < 1 ? 1e-9 : 0.01) << share;
    EXPECT_EQ(limit->h_max<exit(a) * (1 - 1e-6), share> 1) << share;
  }
}

}  // namespace
}  // namespace hmax
