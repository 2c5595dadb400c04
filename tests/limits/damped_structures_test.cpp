/// Limits of large structures whose damping couples their modes, seen in runs of a few steps.
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "catalogue/methods/catalogue.hpp"
#include "limits/linearised_problem.hpp"
#include "limits/predict.hpp"
#include "limits/verification.hpp"
#include "problems/linear_structure.hpp"

namespace hmax {
namespace {

using Sparse = Eigen::SparseMatrix<double>;

constexpr int chain_links = static_cast<int>(most_cheaply_factored) + 100;

/// Of a chain of springs, or dampers, with `of_spring(i)` between masses i - 1 and i.
template <class OfSpring>
Sparse chain(const OfSpring& of_spring) {
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < chain_links; ++i) {
    const double k = of_spring(i);
    entries.emplace_back(i, i, k);
    if (i == 0) continue;
    entries.emplace_back(i - 1, i - 1, k);
    entries.emplace_back(i - 1, i, -k);
    entries.emplace_back(i, i - 1, -k);
  }
  Sparse matrix(chain_links, chain_links);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

/// Stiff springs about one mass, of which those on one side are damped.
Problem damped_chain(double stiffness, double damping) {
  constexpr int middle = chain_links / 3;
  return {.id = "chain",
          .y0 = Eigen::VectorXd::Zero(2 * chain_links),
          .t_end = 1,
          .system = linear_structure(
              chain([&](int i) { return stiffness * (1 + 3 * std::exp(-std::pow((i - middle) / 5.0, 2))); }),
              Eigen::VectorXd::Ones(chain_links), chain([&](int i) { return i < middle ? damping : 0; }))};
}

TEST(DampedStructures, AreObservedInAFewSteps) {
  for (const double damping : {1.0, 20.0}) {
    const Problem problem = damped_chain(1e4, damping);
    const Linearised near = linearised(problem, 0, problem.y0);
    ASSERT_TRUE(near.modes.range);
    for (const char* name : {"rk4", "symplectic_euler"}) {
      const Method method = find_method(name);
      Prediction row = predict(method, near);
      ASSERT_TRUE(row.h_max && !row.unstable_from) << name << ' ' << row.note;
      const Prediction predicted = row;
      verify(row, method, problem, near);
      ASSERT_TRUE(row.observed) << name << ' ' << row.note;
      EXPECT_TRUE(row.observed->agrees) << name << ' ' << row.note;
      EXPECT_LE(std::abs(row.observed->gap), 3e-4) << name;
      EXPECT_LE(row.observed->steps, 24) << name;
      row = predicted;
      verify(row, method, damped_chain(1.02e4, damping), near);
      ASSERT_TRUE(row.observed) << name;
      EXPECT_TRUE(row.observed->contradicts()) << name << ' ' << row.observed->gap;
      EXPECT_LT(row.observed->gap, -3e-3) << name;
    }
  }
}

}  // namespace
}  // namespace hmax
