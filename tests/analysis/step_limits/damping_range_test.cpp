/// Limits of structures whose damping couples their modes, without dense matrices; dense ones are the oracle.
#include "analysis/step_limits/damping_range.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <memory>

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include "analysis/amplification/structural_amplification.hpp"
#include "analysis/dynamics/coupled_motion.hpp"
#include "analysis/spectrum/damped_eigenvalues.hpp"
#include "analysis/spectrum/lanczos.hpp"
#include "tests/core/jobs.hpp"

namespace hmax {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Sparse = Eigen::SparseMatrix<double>;

/// A chain of springs between a wall and a free end, of stiffnesses about one.
Sparse chain(Index n, double spread, Index seed) {
  const VectorXd noise = start_vector(n * seed).tail(n);
  std::vector<Eigen::Triplet<double>> entries;
  for (Index i = 0; i < n; ++i) {
    const double k = 1000 * (1 + spread * noise[i]);
    entries.emplace_back(i, i, k);
    if (i == 0) continue;
    entries.emplace_back(i - 1, i - 1, k);
    entries.emplace_back(i, i - 1, -k);
    entries.emplace_back(i - 1, i, -k);
  }
  Sparse K(n, n);
  K.setFromTriplets(entries.begin(), entries.end());
  return K;
}

/// Damped by the stiffness of a state that it has left: alpha M + beta K0, but a stiffness K.
MechanicalPart deformed(Index n, double alpha, double beta) {
  const VectorXd mass = VectorXd::LinSpaced(n, 1, 2);
  const Sparse M(mass.asDiagonal().toDenseMatrix().sparseView());
  return mechanical_part(mass, chain(n, 0.8, 2), Sparse(alpha * M + beta * chain(n, 0.8, 3)));
}

std::vector<Complex> all_of(const MechanicalPart& part) {
  const Index n = part.mass.size();
  MatrixXd A = MatrixXd::Zero(2 * n, 2 * n);
  A.topRightCorner(n, n).setIdentity();
  A.bottomLeftCorner(n, n) = -(part.mass.diagonal().cwiseInverse().asDiagonal() * dense(part.K));
  A.bottomRightCorner(n, n) = -(part.mass.diagonal().cwiseInverse().asDiagonal() * dense(part.C));
  const Eigen::VectorXcd values = Eigen::EigenSolver<MatrixXd>(A, false).eigenvalues();
  std::vector<Complex> lambda(values.begin(), values.end());
  std::ranges::sort(lambda, std::ranges::greater{}, [](Complex l) { return std::abs(l); });
  return lambda;
}

// From weakly damped to creeping fast modes.
constexpr double betas[]{0.001, 0.02, 0.3};

DampedSearch search_of(const MechanicalPart& part) {
  const auto matrices = std::make_shared<const ScaledMatrices>(part);
  return {matrices, matrices->largest_k(1e-3), matrices->largest_c(1e-3)};
}

/// Whether each of `some` is one of `all`.
bool are_among(const std::vector<Complex>& some, const std::vector<Complex>& all) {
  return std::ranges::all_of(some, [&](Complex each) {
    return std::ranges::any_of(all, [&](Complex l) { return std::abs(l - each) <= 1e-7 * std::abs(each); });
  });
}

TEST(DampedEigenvalues, OfLargestModulusAreThoseOfADenseSolver) {
  for (const double beta : betas) {
    const MechanicalPart part = deformed(120, 0.1, beta);
    ASSERT_EQ(part.damping, Damping::general);
    const std::vector<Complex> all = all_of(part);
    const auto matrices = std::make_shared<const ScaledMatrices>(part);
    const DampedEigenvalues many =
        many_damped_eigenvalues(*matrices, matrices->largest_k(1e-3), matrices->largest_c(1e-3));
    EXPECT_GE(many.lambda.size(), 2U) << beta;
    for (const DampedEigenvalues& found :
         {search_of(part).first(1, 1000), search_of(part).first(20, 1000), many}) {
      ASSERT_FALSE(found.lambda.empty()) << beta;
      EXPECT_TRUE(are_among(found.lambda, all)) << beta;
      const Eigen::MatrixXcd K = dense(part.K).cast<Complex>(), C = dense(part.C).cast<Complex>();
      ASSERT_EQ(found.shapes.size(), found.lambda.size());
      for (std::size_t i = 0; i < found.lambda.size(); ++i) {
        const Complex lambda = found.lambda[i];
        const Eigen::VectorXcd u = found.shapes[i], Mu = part.mass.times(u);
        EXPECT_NEAR(std::real(u.dot(Mu)), 1, 1e-10);
        EXPECT_LT((lambda * lambda * Mu + lambda * (C * u) + K * u).norm(), 1e-6 * std::norm(lambda)) << beta;
      }
      std::vector<Complex> larger;
      for (const Complex each : all)
        if (std::abs(each) > found.rest * (1 + 1e-6)) larger.push_back(each);
      EXPECT_TRUE(are_among(larger, found.lambda)) << beta;
    }
  }
}

TEST(DampedEigenvalues, OfASpaceThatIsAllThereIs) {
  const MechanicalPart part = deformed(8, 0.1, 0.001);
  const std::vector<Complex> all = all_of(part);
  const DampedEigenvalues found = search_of(part).first(1, 1000);
  ASSERT_EQ(found.lambda.size(), 2U);
  EXPECT_NEAR(found.rest, std::abs(all.front()), 1e-9 * found.rest);
}

// One damper on one of many unknowns: no vector in general position has much of its shape.
TEST(DampedEigenvalues, OfOneDamperAreFoundFromItsShape) {
  const Index n = 20'000;
  Sparse C(n, n);
  C.insert(n / 3, n / 3) = 300;
  const MechanicalPart part = mechanical_part(VectorXd::LinSpaced(n, 1, 2), chain(n, 0.8, 2), C);
  const DampedEigenvalues found = search_of(part).first(1, 1000);
  ASSERT_EQ(found.lambda.size(), 1U);
  EXPECT_EQ(found.lambda[0].imag(), 0);
  // Of lambda^2 + c lambda + k of the unknown alone, the faster; its neighbours change it little.
  const double c = 300 / part.mass.diagonal()[n / 3],
               k = std::get<Sparse>(part.K).coeff(n / 3, n / 3) / part.mass.diagonal()[n / 3];
  EXPECT_NEAR(found.rest, c / 2 + std::sqrt(c * c / 4 - k), 0.05 * c);
  EXPECT_GT(found.rest, 1.5 * std::sqrt(ScaledMatrices(part).largest_k().bound));
}

TEST(DampedEigenvalues, AreNoneWhereProductsEnd) {
  const DampedEigenvalues found = search_of(deformed(120, 0.1, 0.001)).first(1, 3);
  EXPECT_TRUE(found.lambda.empty());
  EXPECT_TRUE(std::isinf(found.rest));
}

std::optional<double> growing_of(const MechanicalPart& part) {
  const ScaledMatrices scaled(part);
  const double most_c = scaled.largest_c().bound, most_k = scaled.largest_k().bound;
  return growing_eigenvalue(scaled.largest_of_sum(most_c, most_k), most_k);
}

TEST(DampedEigenvalues, OfABodyThatBucklesGrowAsADenseSolverSays) {
  MechanicalPart part = deformed(60, 0.1, 0.02);
  EXPECT_FALSE(growing_of(part));
  Sparse K = std::get<Sparse>(part.K);
  for (Index i = 0; i < K.rows(); ++i) K.coeffRef(i, i) -= 20;
  part = mechanical_part(part.mass, K, part.C);
  double largest = 0;
  for (const Complex lambda : all_of(part)) largest = std::max(largest, lambda.real());
  ASSERT_GT(largest, 0);
  EXPECT_NEAR(growing_of(part).value_or(0), largest, 1e-6 * largest);
}

/// The range within all tangents.
DampingRange range_of(const MechanicalPart& part) {
  const auto matrices = std::make_shared<const ScaledMatrices>(part);
  RangeTangents tangents(matrices, matrices->largest_c().bound, matrices->largest_k().bound);
  DampingRange range = tangents.box();
  for (std::size_t i = 0; i < tangents.size(); ++i) tangents.cut(range, i);
  return range;
}

// With lambda = re + i im, conjugates beside it: gamma = -2 re, kappa = re^2 + im^2.
TEST(DampingRange, HoldsEveryOscillatingMode) {
  for (const double beta : betas) {
    const MechanicalPart part = deformed(120, 0.1, beta);
    DampingRange range = range_of(part);
    const double rho = least_damping_per_stiffness(part);
    const MatrixXd K = dense(part.K), C = dense(part.C);
    const double least =
        Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd>(C, K, Eigen::EigenvaluesOnly).eigenvalues()[0];
    EXPECT_NEAR(rho, least, 2e-3 * least);
    EXPECT_LE(rho, least);
    range.cut(-1, rho, 0);
    ASSERT_GE(range.corners.size(), 3U);
    int oscillating = 0;
    for (const Complex lambda : all_of(part)) {
      if (lambda.imag() <= 1e-6 * std::abs(lambda)) continue;
      ++oscillating;
      const MechanicalMode mode = MechanicalMode::of(lambda);
      // On one side of all edges.
      int left = 0, right = 0;
      for (std::size_t i = 0; i < range.corners.size(); ++i) {
        const MechanicalMode &a = range.corners[i], &b = range.corners[(i + 1) % range.corners.size()];
        const double across =
            (b.gamma - a.gamma) * (mode.kappa - a.kappa) - (b.kappa - a.kappa) * (mode.gamma - a.gamma);
        if (across != 0) ++(across > 0 ? left : right);
      }
      EXPECT_TRUE(left == 0 || right == 0) << beta << " " << lambda;
    }
    EXPECT_GT(oscillating, 0);
  }
}

TEST(DampingRange, HasNoLeastDampingWhereAnUnknownHasNone) {
  Sparse C(40, 40);
  for (Index i = 0; i < 20; ++i) C.insert(i, i) = 3;
  EXPECT_EQ(least_damping_per_stiffness(mechanical_part(VectorXd::Ones(40), chain(40, 0.8, 2), C)), 0);
}

TEST(DampingRange, IsTheSameForAnyNumberOfThreads) {
  const MechanicalPart part = deformed(60, 0.1, betas[0]);
  const auto corners_by = [&](std::size_t threads) {
    const Jobs those(threads);
    std::vector<double> corners;
    for (const MechanicalMode& corner : range_of(part).corners) {
      corners.push_back(corner.kappa);
      corners.push_back(corner.gamma);
    }
    return corners;
  };
  EXPECT_EQ(corners_by(1), corners_by(4));
}

TEST(DampingRange, TellsWhichTangentsMayCutAModeOff) {
  const MechanicalPart part = deformed(60, 0.1, betas[0]);
  const auto matrices = std::make_shared<const ScaledMatrices>(part);
  RangeTangents tangents(matrices, matrices->largest_c().bound, matrices->largest_k().bound);
  const std::vector<Complex> all = all_of(part);
  std::vector<MechanicalMode> inside;
  for (const Complex lambda : all)
    if (lambda.imag() > 0) inside.push_back(MechanicalMode::of(lambda));
  int beyond = 0;
  for (std::size_t i = 0; i < tangents.size(); ++i) {
    EXPECT_LE(tangents.beyond(i, inside.front(), inside), 0) << i;
    // The stiffest corner without damping, which no mode is near.
    const MechanicalMode corner = tangents.box().corners[3];
    ASSERT_EQ(corner.gamma, 0);
    DampingRange range = tangents.box();
    tangents.cut(range, i);
    const bool is_cut = std::ranges::none_of(range.corners, [&](const MechanicalMode& at) {
      return std::abs(at.kappa - corner.kappa) <= 1e-9 * corner.kappa && at.gamma == 0;
    });
    if (!is_cut) continue;
    EXPECT_GT(tangents.beyond(i, corner, inside), 0) << i;
    ++beyond;
  }
  EXPECT_GT(beyond, 0);
}

// The exit of explicit Euler, gamma / kappa: the least of a triangle is at a corner.
TEST(DampingRange, HasItsLeastExitOnItsEdge) {
  const DampingRange triangle{.corners = {{100, 1}, {400, 8}, {100, 9}}};
  const RangeLimit limit = smallest_exit(triangle, [](std::span<const MechanicalMode> modes) {
    std::vector<double> exits;
    for (const MechanicalMode& mode : modes) exits.push_back(mode.gamma / mode.kappa);
    return exits;
  });
  EXPECT_DOUBLE_EQ(limit.h_max, 0.01);
  EXPECT_DOUBLE_EQ(limit.mode.gamma, 1);
}

TEST(CoupledMotion, HasTheProvedLimitOfDenseMatricesWithoutThem) {
  for (const double beta : betas) {
    const MechanicalPart part = deformed(60, 0.1, beta);
    for (const Amplification& single :
         {symplectic_euler_amplification(), kick_drift_kick_amplification(KickDamping::predicted),
          generalized_alpha_amplification(newmark_parameters(0.25L, 0.5L))}) {
      const auto by_dense = CoupledMotion(*single.motion, part).first_exit(single);
      const auto by_products = proved_first_exit(*single.motion, part, single);
      ASSERT_TRUE(by_dense && by_dense->proved && by_products) << beta;
      if (std::isinf(by_dense->h_max)) {
        EXPECT_EQ(by_products->h_max, by_dense->h_max);
        continue;
      }
      EXPECT_NEAR(by_products->h_max, by_dense->h_max, 1e-8 * by_dense->h_max) << beta;
      EXPECT_NEAR(by_products->shape.kappa, by_dense->shape.kappa, 1e-4 * by_dense->shape.kappa) << beta;
    }
  }
}

}  // namespace
}  // namespace hmax
