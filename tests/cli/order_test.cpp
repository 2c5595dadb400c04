#include <cmath>

#include "tests/cli/program.hpp"

namespace hmax {
namespace {

using AnyJson = nlohmann::json;

/// On a linear problem without a force a method may do better than its order: then another problem must show
/// it. Foreign engines are peers with defects of their own (docs/reference/facts.md); two problems must show
/// what they claim.
TEST(OrderCommand, EveryMethodShowsItsOrderOnThreeProblemsAndFallsShortOfItOnNone) {
  const Shell shell;
  for (const AnyJson& method : shell.json("list methods")) {
    const std::string id = method.at("id");
    if (method.at("needs_body")) {
      // Lengths that are kept whatever the modulus are no approximation of the model.
      const bool knows_modulus = id != "pbd";
      const Told told =
          shell.hmax("order --json --mesh cube:n=1 --load press --t-end 0.05 --model " +
                     std::string(knows_modulus ? "fem_neo_hookean" : "mass_spring") + " --method " + id);
      EXPECT_EQ(told.exit_code, knows_modulus ? 0 : 1) << id << told.out << told.err;
      continue;
    }
    const double tolerance = method.at("family") == "adams" || method.at("order") >= 6 ? 0.2 : 0.1;
    const bool ours = method.at("engine") == "hmax";
    // In long double a short run shows the order as well; in the double of others its errors are too small.
    // rk4 shows the span that the command chooses by itself.
    const std::string span = ours && id != "rk4" ? " --t-end 0.5" : "";
    int shown = 0;
    for (const char* problem : {"liver_linear", "liver_cubic", "liver_forced", "kepler"}) {
      if (shown == 3 || (method.at("needs_split") && std::string(problem) == "kepler")) break;
      const Told told =
          shell.hmax("order --json --problem " + std::string(problem) + " --method " + id + span);
      ASSERT_LE(told.exit_code, 1) << id << " on " << problem << told.out << told.err;
      const AnyJson order = told.json();
      if (method.at("order") == 0) {
        EXPECT_TRUE(order.at("expected").is_null() && order.at("observed").is_null()) << id;
        EXPECT_NE(order.at("status"), "");
        ++shown;
        continue;
      }
      EXPECT_EQ(order.at("expected"), method.at("order"));
      ASSERT_FALSE(order.at("observed").is_null()) << id << " on " << problem;
      const double ahead = order.at("observed").get<double>() - method.at("order").get<double>();
      EXPECT_TRUE(ahead >= -tolerance || !ours) << id << " on " << problem << " shows " << ahead;
      EXPECT_EQ(told.exit_code == 0, std::abs(ahead) <= tolerance) << id << " on " << problem;
      shown += told.exit_code == 0;
      EXPECT_GE(order.at("h").size(), 3U);
    }
    EXPECT_GE(shown, ours ? 3 : 2) << id;
  }
}

TEST(OrderCommand, AlsoServesTheUsersFiles) {
  const Shell shell;
  write_text(shell / "ralston.toml", "a = [[], [\"2/3\"]]\nb = [0.25, 0.75]\n");
  write_text(shell / "pendulum.toml",
             "[equations]\nangle = \"rate\"\nrate = \"-9.81*sin(angle)\"\n[initial]\nangle = 1\nrate = 0\n");
  for (const char* options :
       {"--problem pendulum.toml --method rk4", "--problem pendulum.toml --tableau ralston.toml",
        "--problem liver_cubic --tableau ralston.toml"}) {
    const std::string told = shell.text(std::string("order ") + options);
    EXPECT_TRUE(says(told, "observed order"));
  }
}

/// The reference of a motion with friction errs by more than rounding, and no slope comes nearer to 4.
TEST(OrderCommand, NamesTheErrorOfTheReference) {
  const Shell shell;
  write_text(shell / "rubs.toml",
             "[equations]\nx = \"v\"\nv = \"-x - 0.3*sign(v)\"\n[initial]\nx = 2\nv = 0\n");
  write_text(shell / "drags.toml",
             "[equations]\nx = \"v\"\nv = \"-x - 0.3*v*abs(v)\"\n[initial]\nx = 2\nv = 0\n");
  const auto status = [&](const std::string& options) {
    return shell.hmax("order --json --problem " + options).json().at("status").get<std::string>();
  };
  const std::string rubs = status("rubs.toml --method rk4");
  EXPECT_FALSE(says(rubs, "rounding") || says(rubs, "still change")) << rubs;
  const std::string drags = status("drags.toml --method dop_853 --t-end 1");
  EXPECT_TRUE(says(drags, "the error of the reference")) << drags;
}

TEST(OrderCommand, FailsWhereNoSlopeCanBeSeen) {
  const Shell shell;
  // The solution stays at rest, so every error is zero.
  const Told told = shell.hmax("order --problem liver_linear --y0 0,0 --method rk4 --json");
  EXPECT_EQ(told.exit_code, 1);
  EXPECT_TRUE(told.json().at("observed").is_null());
  EXPECT_NE(told.json().at("status"), "");
  expect_refused(shell.hmax("order --problem liver_linear --method rk4 --t-end nan"), "end time");
}

TEST(OrderCommand, ExpectsTheOrderThatAMethodHasOnTheFormOfTheProblem) {
  const Shell shell;
  for (const char* problem : {"liver_linear --set c=0", "liver_cubic --set c=0", "kepler"}) {
    const AnyJson told = shell.json(std::string("order --method velocity_verlet --problem ") + problem);
    EXPECT_EQ(told.at("expected"), 2) << problem;
  }
  EXPECT_EQ(shell.json("order --method velocity_verlet --problem liver_cubic").at("expected"), 1);
  EXPECT_EQ(shell.json("order --method symplectic_euler --problem kepler").at("expected"), 1);
}

TEST(OrderCommand, SaysThatRunsDivergeInPlaceOfAnOrder) {
  // |R| of rk4 is above one from h = 2.785e-3 s on, and e^-1000 of the solution is left at t = 1 s.
  const Told told = Shell().hmax("order --problem dahlquist --set lambda=-1000 --method rk4 --json");
  EXPECT_EQ(told.exit_code, 1);
  const AnyJson order = told.json();
  EXPECT_TRUE(order.at("observed").is_null()) << told.out;
  EXPECT_TRUE(says(order.at("status").get<std::string>(), "diverge")) << told.out;
  const Told people = Shell().hmax("order --problem dahlquist --set lambda=-1000 --method rk4");
  EXPECT_EQ(people.exit_code, 1);
  EXPECT_TRUE(says(people.out, "no order: "));
}

TEST(OrderCommand, NamesOrderReductionOfStiffProblems) {
  // h |lambda| is 1e3 at h = 1e-3 s: sdirk_4 shows its stage order there [prothero1974stability].
  const AnyJson order = Shell().hmax("order --problem prothero_robinson --method sdirk_4 --json").json();
  EXPECT_EQ(order.at("reason"), "order_reduction") << order;
  EXPECT_TRUE(says(order.at("status").get<std::string>(), "order reduction")) << order;
  EXPECT_TRUE(Shell().json("order --problem liver_forced --method rk4").at("reason").is_null());
}

/// Solvers of SUNDIALS run in double alone, and their errors stop falling, or scatter, above its rounding.
TEST(OrderCommand, TakesNoErrorsAtTheFloorOfAMethodForItsOrder) {
  const auto measured = [](const std::string& arguments) {
    return Shell().hmax("order --json " + arguments).json();
  };
  if (Shell().hmax("order --problem liver_forced --method arkode_mri").exit_code == 2)
    GTEST_SKIP() << "this build has no SUNDIALS";
  for (const char* arguments : {"--problem liver_forced --method arkode_mri",
                                "--problem liver_linear --t-end 20 --method arkode_imex_ark436l2sa"}) {
    const AnyJson order = measured(arguments);
    ASSERT_FALSE(order.at("observed").is_null()) << order;
    EXPECT_NEAR(order.at("observed"), order.at("expected"), 0.1) << order;
  }
  const AnyJson early = measured("--problem liver_forced --method arkode_erk_fehlberg_13_7_8");
  EXPECT_EQ(early.at("reason"), "unsettled") << early;
  EXPECT_TRUE(says(early.at("status").get<std::string>(), "the slopes still change, from 8.388 to 8.145"))
      << early;
}

}  // namespace
}  // namespace hmax
