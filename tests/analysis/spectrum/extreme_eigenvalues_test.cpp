#include "analysis/spectrum/extreme_eigenvalues.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "analysis/spectrum/spectrum.hpp"
#include "core/errors.hpp"
#include "problems/test_set/brusselator.hpp"
#include "problems/test_set/spring_chain.hpp"
#include "tests/analysis/spectrum/chain_model.hpp"

namespace hmax {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::VectorXd;
using Sparse = Eigen::SparseMatrix<double>;
constexpr Index krylov = 0;

/// k / m 4 sin^2(j pi / (2 (n + 1))).
double kappa_of(const SpringChainParameters& p, double j) {
  const double s = std::sin(std::numbers::pi * j / (2 * (p.n + 1)));
  return p.k / p.m * 4 * s * s;
}

TEST(ExtremeEigenvalues, OfTheSpringChainAreThoseOfItsClosedForm) {
  for (const double n : {60.0, 500.0, 5000.0}) {
    const SpringChainParameters p{.n = n};
    const auto part = chain_model(p).mechanical.value();
    const auto largest = largest_stiffnesses(part, 3, krylov),
               smallest = smallest_stiffnesses(part, 3, krylov);
    ASSERT_TRUE(largest.converged && smallest.converged) << n;
    ASSERT_EQ(largest.kappa.size(), 3U);
    ASSERT_EQ(smallest.kappa.size(), 3U);
    for (const std::size_t i : {0U, 1U, 2U}) {
      const double high = kappa_of(p, n - static_cast<double>(i)),
                   low = kappa_of(p, 1 + static_cast<double>(i));
      EXPECT_NEAR(largest.kappa[i], high, 1e-12 * high) << n;
      EXPECT_NEAR(smallest.kappa[i], low, 1e-9 * low) << n;
    }
    // The shapes are modes: K u = kappa M u, u^T M u = 1.
    const auto& K = std::get<Sparse>(part.K);
    for (const auto* found : {&largest, &smallest})
      for (Index i = 0; i < 3; ++i) {
        const VectorXd u = found->shapes.col(i), Mu = part.mass.times(u);
        EXPECT_NEAR(u.dot(Mu), 1, 1e-10);
        EXPECT_LT((K * u - found->kappa[static_cast<std::size_t>(i)] * Mu).norm(), 1e-8 * p.k * u.norm());
      }
  }
}

// The band of a long chain, kappa(theta) = 4 + 2 cos(theta) - 2 cos(2 theta), ends at 6.25 where cos(theta) =
// 1/4: some modes lie within 1e-6 of it, and Gershgorin's bound 8 is far from all.
TEST(ExtremeEigenvalues, OfADenseEndOfABandAreNearIt) {
  constexpr Index n = 5000;
  std::vector<Eigen::Triplet<double>> entries;
  for (Index i = 0; i < n; ++i)
    for (const auto& [away, value] : {std::pair(0, 4.0), {-1, 1.0}, {1, 1.0}, {-2, -1.0}, {2, -1.0}})
      if (i + away >= 0 && i + away < n) entries.emplace_back(i, i + away, value);
  Sparse K(n, n);
  K.setFromTriplets(entries.begin(), entries.end());
  const auto part = mechanical_part(VectorXd::Ones(n), K, Sparse(n, n));
  for (const bool with_shapes : {false, true}) {
    const auto largest = largest_stiffnesses(part, 1, krylov, with_shapes);
    ASSERT_EQ(largest.kappa.size(), 1U);
    EXPECT_NEAR(largest.kappa[0], 6.25, 1e-5);
    EXPECT_EQ(largest.shapes.cols(), with_shapes ? 1 : 0);
  }
}

TEST(ExtremeEigenvalues, OfAJacobianAgreeWithAllOfThem) {
  const Brusselator<double> reaction({.n = 150});
  for (const LinearModel& model : {linearise(reaction, 0, reaction.y0()), chain_model({.n = 150, .c = 0.2}),
                                   chain_model({.n = 100, .c = 0}), chain_model({.n = 40, .c = 5})}) {
    auto all = spectrum_of(model).lambda;
    std::ranges::sort(all, std::ranges::greater{}, [](const Complex& l) { return std::abs(l); });
    const auto J = std::get<Sparse>(model.J());
    for (const Index count : {1, 2, 5}) {
      const auto largest = largest_eigenvalues(J, count, krylov);
      EXPECT_TRUE(largest.converged);
      ASSERT_GE(static_cast<Index>(largest.lambda.size()), count);
      for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
        EXPECT_NEAR(std::abs(largest.lambda[i]), std::abs(all[i]), 1e-8 * std::abs(all[0])) << i;
        const Eigen::VectorXcd v = largest.vectors.col(static_cast<Index>(i));
        EXPECT_NEAR(v.norm(), 1, 1e-14);
        EXPECT_LT((J * v - largest.lambda[i] * v).norm(), 1e-8 * std::abs(all[0]));
      }
    }
  }
}

TEST(ExtremeEigenvalues, ConjugatesAreNotCutApart) {
  const auto model = chain_model({.n = 60, .c = 0.01});
  for (const Index dense_to : {Index(0), Index(1000)}) {
    const auto largest = largest_eigenvalues(std::get<Sparse>(model.J()), 1, dense_to).lambda;
    ASSERT_EQ(largest.size(), 2U);
    EXPECT_LT(std::abs(largest[1] - std::conj(largest[0])), 1e-9 * std::abs(largest[0]));
    EXPECT_EQ(largest_eigenvalues(std::get<Sparse>(model.J()), 2, dense_to).lambda.size(), 2U);
  }
}

TEST(ExtremeEigenvalues, AreTheSameInEveryRun) {
  const auto model = chain_model({.n = 120});
  const auto J = std::get<Sparse>(model.J());
  EXPECT_EQ(largest_eigenvalues(J, 4).lambda, largest_eigenvalues(J, 4).lambda);
  EXPECT_EQ(largest_stiffnesses(*model.mechanical, 2, krylov).kappa,
            largest_stiffnesses(*model.mechanical, 2, krylov).kappa);
}

TEST(ExtremeEigenvalues, WithoutShapesAreTheSame) {
  const auto model = chain_model({.n = 120});
  const auto with = largest_stiffnesses(*model.mechanical, 1, krylov),
             without = largest_stiffnesses(*model.mechanical, 1, krylov, false);
  EXPECT_NEAR(without.kappa.at(0), with.kappa.at(0), 1e-10 * with.kappa.at(0));
}

TEST(ExtremeEigenvalues, AFreeBodyHasAModeWithoutStiffness) {
  for (const Index n : {Index(50), Index(400)}) {
    // A chain without walls: rows sum to zero.
    Sparse K(n, n);
    for (Index i = 0; i + 1 < n; ++i) {
      K.coeffRef(i, i) += 100;
      K.coeffRef(i + 1, i + 1) += 100;
      K.coeffRef(i, i + 1) = K.coeffRef(i + 1, i) = -100;
    }
    const auto part = mechanical_part(VectorXd::LinSpaced(n, 0.01, 0.02), K, Sparse(n, n));
    const auto smallest = smallest_stiffnesses(part, 2, krylov);
    EXPECT_TRUE(smallest.converged);
    EXPECT_NEAR(smallest.kappa[0], 0, 1e-14 * 4e4);
    EXPECT_GT(smallest.kappa[1], 1e-3);
    // Every mass moves alike.
    const VectorXd u = smallest.shapes.col(0);
    EXPECT_LT((u.array() - u.mean()).matrix().norm(), 1e-6 * u.norm());
  }
}

TEST(ExtremeEigenvalues, OfAnIndefiniteStiffnessTheNegativeOnesAreCounted) {
  for (const Index n : {Index(50), Index(400)}) {
    // A free chain has kappa_j = 4 k / m sin^2(j pi / 2 n); all of them moved down by one amount.
    const double k = 100, m = 0.01;
    const auto kappa = [&](Index j) {
      const double sine = std::sin(static_cast<double>(j) * std::numbers::pi / static_cast<double>(2 * n));
      return 4 * k / m * sine * sine;
    };
    for (const Index below : {Index(0), Index(1), Index(7)}) {
      const double down = below == 0 ? -1e4 : (kappa(below - 1) + kappa(below)) / 2;
      Sparse K(n, n);
      for (Index i = 0; i + 1 < n; ++i) {
        K.coeffRef(i, i) += k;
        K.coeffRef(i + 1, i + 1) += k;
        K.coeffRef(i, i + 1) = K.coeffRef(i + 1, i) = -k;
      }
      for (Index i = 0; i < n; ++i) K.coeffRef(i, i) -= down * m;
      const auto part = mechanical_part(VectorXd::Constant(n, m), K, Sparse(n, n));
      EXPECT_EQ(smallest_stiffnesses(part, 2, krylov).negative, below) << n;
    }
  }
}

TEST(ExtremeEigenvalues, SmallSystemsAndAllOfThemAreServedByDenseMethods) {
  const SpringChainParameters p{.n = 4};
  const auto part = chain_model(p).mechanical.value();
  const auto all = largest_stiffnesses(part, 4, krylov);
  ASSERT_EQ(all.kappa.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i)
    EXPECT_NEAR(all.kappa[i], kappa_of(p, 4 - static_cast<double>(i)), 1e-13 * all.kappa[0]);
}

TEST(ExtremeEigenvalues, CountsThatMakeNoSenseAreRefused) {
  const auto model = chain_model({.n = 4});
  for (const Index count : {Index(0), Index(-1), Index(5)})
    EXPECT_THROW((void)largest_stiffnesses(*model.mechanical, count), InputError);
  EXPECT_THROW((void)largest_eigenvalues(std::get<Sparse>(model.J()), 9), InputError);
}

}  // namespace
}  // namespace hmax
