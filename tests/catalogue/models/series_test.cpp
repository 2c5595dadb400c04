#include "catalogue/models/series.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "catalogue/methods/catalogue.hpp"
#include "catalogue/models/problems.hpp"
#include "core/errors.hpp"
#include "problems/oscillator/liver_problems.hpp"
#include "problems/oscillator/oscillator_exact.hpp"
#include "tests/results/scratch.hpp"

namespace hmax {
namespace {

TEST(Motion, OfTheLinearLiverIsTheExactSolution) {
  const LiverProblem& liver = liver_problem("liver_linear");
  const OscillatorParameters& p = liver.parameters;
  const auto exact = exact_solution(p, liver.y0);
  ASSERT_TRUE(exact);
  const Table table = motion(make_problem("liver_linear"), find_method("dop_853"), 1e-10, 20, 0.25);
  EXPECT_EQ(table.columns, (std::vector<std::string>{"t [s]", "x [m]", "v [m/s]", "a [m/s^2]"}));
  ASSERT_EQ(table.values.size(), 4U);
  for (const auto& column : table.values) ASSERT_EQ(column.size(), 81U);
  for (std::size_t i = 0; i < 81; ++i) {
    const double t = table.values[0][i];
    EXPECT_EQ(t, 0.25 * static_cast<double>(i));
    const Eigen::Vector2d y = (*exact)(t);
    EXPECT_NEAR(table.values[1][i], y[0], 1e-8) << t;
    EXPECT_NEAR(table.values[2][i], y[1], 1e-8) << t;
    const double force = p.P * std::cos(p.w * t) - p.c * y[1] - p.k1 * y[0];
    EXPECT_NEAR(table.values[3][i], force / p.m, 1e-7) << t;
  }
}

TEST(Motion, SaysWhatItShows) {
  const Table table = motion(make_problem("liver_linear"), find_method("ode45"), 1e-6, 1, 0.5);
  const auto has = [&](const std::string& key, const std::string& value) {
    for (const auto& [k, v] : table.notes)
      if (k == key) return v == value;
    return false;
  };
  EXPECT_TRUE(has("problem", "liver_linear"));
  EXPECT_TRUE(has("y0", "0.5,1"));
  EXPECT_TRUE(has("method", "dormand_prince_54"));
  EXPECT_TRUE(has("outcome", "reached_end"));
}

TEST(Motion, OfAProblemThatIsNoOscillatorIsRefused) {
  const Scratch scratch;
  write_text(scratch / "decay.toml", "[equations]\ny = \"-y\"\n[initial]\ny = 1\n");
  const Problem decay = make_problem((scratch / "decay.toml").string());
  EXPECT_THROW(motion(decay, find_method("dop_853"), 1e-6, 1, 0.5), InputError);
}

}  // namespace
}  // namespace hmax
