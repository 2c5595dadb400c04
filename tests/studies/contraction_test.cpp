#include "studies/contraction.hpp"

#include <gtest/gtest.h>

namespace hmax {
namespace {

/// Implicit Euler, the midpoint rule and Radau IIA are B-stable, the trapezoidal rule and one iteration of
/// Newton's method are not [hairer1996solving, IV.12].
TEST(Contractions, TellBStableMethodsFromOthers) {
  const std::vector<Contraction> all = contractions(
      {"implicit_euler", "implicit_midpoint", "radau_iia_5", "trapezoidal", "linearly_implicit_euler"});
  for (const std::size_t i : {0U, 1U, 2U}) {
    EXPECT_TRUE(all[i].nearer) << all[i].method;
    EXPECT_EQ(all[i].unsolved, 0) << all[i].method;
  }
  EXPECT_FALSE(all[3].nearer);
  EXPECT_GT(all[3].cubic, 1);
  EXPECT_FALSE(all[4].nearer);
  // From 2 with h = 100: 2 - h atan(2) / (1 + h / 5), beside the solution 0.
  EXPECT_GT(all[4].arctan, 1.63);
}

}  // namespace
}  // namespace hmax
