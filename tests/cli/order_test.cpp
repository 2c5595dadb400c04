#include "tests/cli/program.hpp"

namespace hmax {
namespace {

using Json = nlohmann::json;

TEST(OrderCommand, EveryMethodShowsItsOrderOnALinearANonlinearAndAForcedCase) {
  const Shell shell;
  for (const Json& method : shell.hmax("list methods --json").json())
    for (const char* problem : {"liver_linear", "liver_cubic", "liver_forced"}) {
      const Told told = shell.hmax("order --json --problem " + std::string(problem) + " --method " +
                                   method.at("id").get<std::string>());
      ASSERT_EQ(told.exit_code, 0) << told.out << told.err;
      const Json order = told.json();
      if (method.at("order") == 0) {
        EXPECT_TRUE(order.at("expected").is_null() && order.at("observed").is_null());
        EXPECT_NE(order.at("status"), "");
        continue;
      }
      EXPECT_EQ(order.at("expected"), method.at("order"));
      const bool coarse = method.at("family") == "adams" || method.at("order") >= 6;
      EXPECT_NEAR(order.at("observed").get<double>(), order.at("expected").get<double>(), coarse ? 0.2 : 0.1)
          << method.at("id") << " on " << problem;
      EXPECT_EQ(order.at("h").size(), order.at("error").size());
      EXPECT_GE(order.at("h").size(), 3U);
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
    const Told told = shell.hmax(std::string("order ") + options);
    EXPECT_EQ(told.exit_code, 0) << options << told.out << told.err;
    EXPECT_NE(told.out.find("observed order"), std::string::npos);
  }
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

}  // namespace
}  // namespace hmax
