/// Methods that solve equations, on a structure: its sparse equations of half the size give what packed
/// states give.
#include <gtest/gtest.h>

#include "catalogue/methods/catalogue.hpp"
#include "tests/integrators/motion.hpp"

namespace hmax {
namespace {

using Eigen::VectorXd;

TEST(PackedStates, AreWhatTheEquationsOfAStructureGiveInEveryMethodThatSolvesThem) {
  int seen = 0;
  for (const Method& method : methods()) {
    if (method.engine != own_engine || !method.needs_jacobian || method.needs_second_order ||
        method.needs_split)
      continue;
    ++seen;
    // Few unknowns are factored, many iterated upon. The chain has no Jacobian of its own: packed states take
    // differences, which Rosenbrock methods do not correct.
    for (const Eigen::Index n : {4, 200}) {
      Problem packed, structure;
      packed.y0 = structure.y0 = VectorXd::LinSpaced(2 * n, -0.5, 0.7);
      packed.system = AnySystem(Chain<VectorXd>{n, 5, 2, 0.3, 1});
      structure.system = AnySystem(Chain<VectorXd, Eigen::SparseMatrix<double>>{n, 5, 2, 0.3, 1});
      const RunSpec three_steps{.t_end = 0.3, .h = 0.1};
      const RunRecord expected = method.bind(packed).run(three_steps, {});
      const RunRecord found = method.bind(structure).run(three_steps, {});
      ASSERT_EQ(expected.outcome, Outcome::reached_end) << method.id;
      ASSERT_EQ(found.outcome, Outcome::reached_end) << method.id;
      EXPECT_EQ(found.stats.steps, 3) << method.id;
      EXPECT_LT((found.y - expected.y).norm(),
                (method.family == "rosenbrock" ? 2e-6 : 1e-12) * expected.y.norm())
          << method.id;
    }
  }
  EXPECT_GE(seen, 10);
}

}  // namespace
}  // namespace hmax
