/// Limits from maps of one step, beside what is known of oscillators.
#include "analysis/step_limits/step_map_limit.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "analysis/step_limits/frozen_jacobian.hpp"
#include "core/numbers.hpp"
#include "limits/steps/linearly_implicit.hpp"

namespace hmax {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// The map of a matrix that depends on h.
template <class Matrix>
StepMapAt maps_of(const Matrix& matrix_at) {
  return [=](double h) -> StepMap {
    return [S = MatrixXd(matrix_at(h))](const VectorXd& y, int steps) -> VectorXd {
      VectorXd x = y;
      for (int i = 0; i < steps; ++i) x = S * x;
      return x;
    };
  };
}

/// Springs of omega^2 = 1, 4, 9 ..; x and v one after the other.
constexpr int springs = 15;
MatrixXd chain(double stiffening) {
  MatrixXd A = MatrixXd::Zero(2 * springs, 2 * springs);
  for (int i = 0; i < springs; ++i) {
    A(i, springs + i) = 1;
    A(springs + i, i) = -stiffening * (i + 1) * (i + 1);
  }
  return A;
}

/// Both ways to the spectral radius: by the matrix, and by Arnoldi iteration.
constexpr Eigen::Index by_matrix = 400, by_arnoldi = 0;

StepMapSettings between(double least, double most, Eigen::Index dense_to = by_arnoldi) {
  StepMapSettings settings;
  settings.dense_to = dense_to;
  settings.least = least;
  settings.most = most;
  settings.inner = [](const VectorXd& y) -> VectorXd {  // energy
    VectorXd weighted = y;
    for (int i = 0; i < springs; ++i) weighted[i] *= (i + 1) * (i + 1);
    return weighted;
  };
  return settings;
}

TEST(StepMapLimit, OfSymplecticEulerIsTwoOverTheFastestFrequency) {
  const auto symplectic = [](double h) {
    MatrixXd kick = MatrixXd::Identity(2 * springs, 2 * springs), drift = kick;
    const MatrixXd A = chain(1);
    kick.bottomLeftCorner(springs, springs) = h * A.bottomLeftCorner(springs, springs);
    drift.topRightCorner(springs, springs) = h * MatrixXd::Identity(springs, springs);
    return MatrixXd(drift * kick);
  };
  for (const Eigen::Index dense_to : {by_matrix, by_arnoldi}) {
    const StepMapLimit limit =
        first_growing_step(maps_of(symplectic), 2 * springs, between(0.01, 10, dense_to));
    EXPECT_NEAR(limit.h_max, 2.0 / springs, 1e-3 * limit.h_max) << dense_to;
    // It is the fastest spring that grows.
    Eigen::Index largest = 0;
    limit.motion.tail(springs).cwiseAbs().maxCoeff(&largest);
    EXPECT_EQ(largest, springs - 1) << dense_to;
  }
}

TEST(StepMapLimit, OfRungeKutta4IsTheEndOfItsImaginaryAxis) {
  const auto rk4 = [](double h) {
    const MatrixXd Z = h * chain(1), I = MatrixXd::Identity(2 * springs, 2 * springs);
    return MatrixXd(I + Z * (I + Z / 2 * (I + Z / 3 * (I + Z / 4))));
  };
  const StepMapLimit limit = first_growing_step(maps_of(rk4), 2 * springs, between(0.01, 10));
  EXPECT_NEAR(limit.h_max, 2.828427124746 / springs, 1e-3 * limit.h_max);
}

// One of a hundred undamped motions grows by 0.001 a step: Ritz values of a few products lie within the
// others.
TEST(StepGrowth, IsSeenThoughItIsSlowAndOthersNeitherGrowNorDecay) {
  constexpr int pairs = 100;
  const StepMap rotations = [](const VectorXd& y, int steps) -> VectorXd {
    VectorXd x(2 * pairs);
    for (int i = 0; i < pairs; ++i) {
      const double angle = steps * 0.03 * (i + 0.5), factor = i == 70 ? std::exp(0.001 * steps) : 1;
      x[2 * i] = factor * (std::cos(angle) * y[2 * i] - std::sin(angle) * y[2 * i + 1]);
      x[2 * i + 1] = factor * (std::sin(angle) * y[2 * i] + std::cos(angle) * y[2 * i + 1]);
    }
    return x;
  };
  StepMapSettings settings;
  settings.weak_growth = 5e-4;
  settings.long_power = 128;
  for (const Eigen::Index dense_to : {by_matrix, by_arnoldi}) {
    settings.dense_to = dense_to;
    const StepGrowth growth = growth_of_steps(rotations, VectorXd::LinSpaced(2 * pairs, 1, 2), settings);
    EXPECT_TRUE(growth.grows) << dense_to;
    EXPECT_NEAR(growth.rate, 0.001, 1e-6) << dense_to;
  }
}

// Springs with the Jacobian of weaker ones, k / k0 the same for all: the fastest sets the limit.
TEST(StepMapLimit, OfFrozenJacobiansIsThatOfOneSpring) {
  for (const auto id : linearly_implicit_ids())
    for (const double ratio : {1.5, 2.5, 4.0}) {
      const LinearlyImplicitMethod method = *linearly_implicit_method(id);
      const double expected = frozen_spring_exit(method, ratio) / springs;
      const auto step = [&](double h) { return step_matrix(method, h * chain(ratio), h * chain(1)); };
      const StepMapLimit limit = first_growing_step(maps_of(step), 2 * springs, between(0.02, 1000));
      if (std::isinf(expected)) {
        EXPECT_EQ(limit.h_max, infinity) << id << " " << ratio;
      } else if (expected > 0) {
        EXPECT_NEAR(limit.h_max, expected, 5e-3 * expected) << id << " " << ratio;
      }
    }
}

TEST(StepMapLimit, OfAStepThatAlwaysGrowsIsZero) {
  const auto explicit_euler = [](double h) {
    return MatrixXd(MatrixXd::Identity(2 * springs, 2 * springs) + h * chain(1));
  };
  EXPECT_EQ(first_growing_step(maps_of(explicit_euler), 2 * springs, between(0.1, 10)).h_max, 0);
}

TEST(StepMapLimit, OfAJumpOfTheGrowthIsWhereItJumps) {
  // As fast on all steps beyond it: a line through two of them crosses nothing.
  const auto jump = [](double h) {
    return MatrixXd((h < 0.3 ? 0.5 : 2.0) * MatrixXd::Identity(2 * springs, 2 * springs));
  };
  for (const Eigen::Index dense_to : {by_matrix, by_arnoldi})
    EXPECT_NEAR(first_growing_step(maps_of(jump), 2 * springs, between(0.1, 10, dense_to)).h_max, 0.3, 1e-3)
        << dense_to;
}

TEST(StepMapLimit, OfAHomogeneousMapIsWhereItsOrbitsGrow) {
  // A step by the sign of a component: homogeneous, not linear. Both halves grow from h = 1 on.
  const StepMapAt maps = [](double h) -> StepMap {
    return [h](const VectorXd& y, int steps) -> VectorXd {
      VectorXd x = y;
      for (int i = 0; i < steps; ++i) x = h * (x[0] > 0 ? VectorXd(-x) : VectorXd(x.reverse()));
      return x;
    };
  };
  StepMapSettings settings = between(0.1, 10);
  settings.linear = false;
  settings.inner = {};
  EXPECT_NEAR(first_growing_step(maps, 6, settings).h_max, 1, 1e-3);
}

}  // namespace
}  // namespace hmax
