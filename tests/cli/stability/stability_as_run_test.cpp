/// Limits of methods as simulators run them.
#include <cmath>

#include <gtest/gtest.h>

#include "tests/cli/program.hpp"

namespace hmax {
namespace {

using AnyJson = nlohmann::json;

const std::string pressed =
    "stability predict --mesh phantom --load press --set force=2 --set alpha=4 --methods ";

TEST(StabilityAsRun, PredictsWhatRunsWithAFrozenJacobianShow) {
  const AnyJson rows = Shell().json(pressed + "rosenbrock_23,rodas_4 --jacobian frozen --verify").at("rows");
  ASSERT_EQ(rows.size(), 2U);
  for (const AnyJson& row : rows) {
    EXPECT_EQ(row.at("options"), AnyJson({{"jacobian", "frozen"}, {"linear", "direct"}})) << row.dump();
    EXPECT_EQ(row.at("bound"), "stability");
    EXPECT_TRUE(row.at("agrees").get<bool>()) << row.dump();
    EXPECT_LE(std::abs(row.at("gap").get<double>()), 1e-2) << row.dump();
    EXPECT_TRUE(says(row.at("status").get<std::string>(), "initial state, not of this state"));
  }
  EXPECT_EQ(rows[0].at("method"), "rosenbrock_23");
  // At rest the Jacobian of the start is the exact one.
  const AnyJson resting =
      Shell()
          .json(
              "stability predict --mesh phantom --set g=0 --methods rosenbrock_23,rk4 --jacobian "
              "frozen --verify")
          .at("rows");
  EXPECT_EQ(resting[0].at("h_max"), "unbounded");
  EXPECT_EQ(resting[0].at("observed"), "unbounded");
  EXPECT_TRUE(resting[1].at("options").is_null());
  EXPECT_TRUE(resting[1].at("h_max").is_number());
}

TEST(StabilityAsRun, SeesSlowGrowthOfUndampedBodies) {
  const AnyJson rows =
      Shell()
          .json("stability predict --mesh phantom --methods rodas_4,rodas_5p --jacobian frozen --verify")
          .at("rows");
  for (const AnyJson& row : rows) {
    EXPECT_TRUE(row.at("agrees").get<bool>()) << row.dump();
    EXPECT_LE(std::abs(row.at("gap").get<double>()), 1e-2) << row.dump();
  }
}

TEST(StabilityAsRun, RunsWithTheOptionsThatWereAskedFor) {
  const AnyJson row =
      Shell()
          .json(pressed + "linearly_implicit_euler --jacobian every:3 --linear cg:1e-3,20 --verify")
          .at("rows")[0];
  EXPECT_EQ(row.at("options"), AnyJson({{"jacobian", "every:3"}, {"linear", "cg:0.001,20"}}));
  EXPECT_EQ(row.at("h_max"), "unbounded");
  EXPECT_EQ(row.at("observed"), "unbounded");
  EXPECT_TRUE(says(row.at("status").get<std::string>(), "homogeneous"));
}

TEST(StabilityAsRun, HasLimitsOfImplicitExplicitMethodsOnLoadedBodies) {
  const AnyJson rows = Shell().json(pressed + "imex_euler,imex_ark_324 --verify").at("rows");
  for (const AnyJson& row : rows) {
    EXPECT_NE(row.at("bound"), "unknown") << row.dump();
    EXPECT_TRUE(row.at("agrees").get<bool>()) << row.dump();
    EXPECT_FALSE(row.contains("options"));
  }
}

TEST(StabilityAsRun, KeepsRowsOfOtherOptionsApartInAStore) {
  const Shell shell;
  const auto looked_up = [&](const std::string& options) {
    return shell.json(pressed + "linearly_implicit_euler --out s.sqlite" + options).at("looked_up");
  };
  EXPECT_EQ(looked_up(""), 0);
  EXPECT_EQ(looked_up(" --jacobian frozen"), 0);
  EXPECT_EQ(looked_up(" --jacobian frozen"), 1);
  EXPECT_EQ(looked_up(" --jacobian exact"), 0);
  EXPECT_EQ(looked_up(""), 1);
}

TEST(StabilityAsRun, RefusesOptionsThatChangeNothing) {
  for (const auto& [options, said] : {std::pair{"rk4 --jacobian frozen", "linearly implicit"},
                                      {"rosenbrock_23 --jacobian old", "old"},
                                      {"rosenbrock_23 --linear cg:2", "cg:TOLERANCE"},
                                      {"rosenbrock_23 --jacobian frozen --along motion", "--along"}}) {
    const Told told = Shell().hmax(pressed + options);
    EXPECT_EQ(told.exit_code, 2) << options;
    EXPECT_TRUE(says(told.err, said));
  }
}

}  // namespace
}  // namespace hmax
