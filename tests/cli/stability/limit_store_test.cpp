#include <algorithm>

#include <fmt/format.h>

#include "tests/cli/program.hpp"

namespace hmax {
namespace {

using AnyJson = nlohmann::json;

TEST(LimitStore, LooksUpWhatWasComputedBefore) {
  const Shell shell;
  const std::string command =
      "stability predict --problem liver_benchmark --materials male_slim,female_fat --out livers --methods rk4,newmark";
  const AnyJson first = shell.json(command);
  EXPECT_EQ(first.at("looked_up"), 0);
  EXPECT_EQ(first.at("store"), "results/runs/livers.sqlite");
  const AnyJson second = shell.json(command);
  EXPECT_EQ(second.at("looked_up"), 4);
  EXPECT_EQ(second.at("rows"), first.at("rows"));
  EXPECT_EQ(second.at("models"), first.at("models"));
  const Told
      words = shell.hmax(command),
      without = shell.hmax(
          "stability predict --problem liver_benchmark --materials male_slim,female_fat --methods rk4,newmark");
  EXPECT_EQ(words.out, without.out + "4 limits in results/runs/livers.sqlite: 0 computed, 4 looked up\n");

  // Only what is missing is computed: another method, and runs that nobody asked for before.
  const AnyJson more = shell.json(command + ",rk2_heun");
  EXPECT_EQ(more.at("looked_up"), 4);
  EXPECT_EQ(more.at("rows").size(), 6U);
  const AnyJson verified = shell.json(command + " --verify");
  EXPECT_EQ(verified.at("looked_up"), 0);
  EXPECT_TRUE(verified.at("rows")[0].at("agrees").get<bool>());
  EXPECT_EQ(shell.json(command + " --verify").at("looked_up"), 4);
  EXPECT_EQ(shell.json("export livers --of limits").size(), 6U);
}

TEST(LimitStore, ComputesAgainWhereTheModelOrTheQuestionIsAnother) {
  const Shell shell;
  const auto write_spring = [&](const char* force) {
    write_text(shell / "spring.toml",
               fmt::format("[equations]\nx = \"v\"\nv = \"{}\"\n[initial]\nx = 1\nv = 0\n", force));
  };
  const auto looked_up = [&](const std::string& options) {
    return shell.json("stability predict --methods rk4 --out s.sqlite " + options).at("looked_up").get<int>();
  };
  const std::string body = "--mesh cube:n=2 --model fem_green --load gravity";
  EXPECT_EQ(looked_up(body), 0);
  EXPECT_EQ(looked_up(body), 1);
  EXPECT_EQ(looked_up(body + " --at rest"), 0);
  EXPECT_EQ(looked_up(body + " --along load"), 0);
  EXPECT_EQ(looked_up(body + " --along load"), 1);
  EXPECT_EQ(looked_up(body + " --set E=4000"), 0);

  write_spring("-100*x");
  EXPECT_EQ(looked_up("--problem spring.toml"), 0);
  EXPECT_EQ(looked_up("--problem spring.toml"), 1);
  write_spring("-101*x");
  EXPECT_EQ(looked_up("--problem spring.toml"), 0);
}

TEST(LimitStore, IsExportedAndCompared) {
  const Shell shell;
  const std::string predict =
      "stability predict --problem liver_forced --along none --methods rk4,newmark --out ";
  ASSERT_EQ(shell.hmax(predict + "a").exit_code, 0);
  ASSERT_EQ(shell.hmax(predict + "b").exit_code, 0);
  const Told same = shell.hmax("compare a b");
  EXPECT_EQ(same.exit_code, 0) << same.err;
  EXPECT_TRUE(says(same.out, "2 limits in both: 2 the same, 0 changed\n"));
  // Stores that share no limit are not the same.
  ASSERT_EQ(
      shell.hmax("stability predict --problem liver_forced --along none --methods bdf_2 --out c").exit_code,
      0);
  const Told others = shell.hmax("compare a c");
  EXPECT_EQ(others.exit_code, 1) << others.out;
  EXPECT_TRUE(says(others.out, "limits only in A: 2, only in B: 1\n"));
  const std::string csv = shell.text("export a --of limits");
  EXPECT_EQ(csv.rfind("problem,material,parameters,y0,model,asked,path,t_end,method,bound,", 0), 0U) << csv;
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 3);
  expect_refused(shell.hmax("export a --of limits --format gbench"), "csv or jsonl");
  expect_refused(shell.hmax("export a --of tables"), "known are runs, limits");
  const Told runs = shell.hmax("export a");
  EXPECT_EQ(runs.exit_code, 0);
  EXPECT_TRUE(says(runs.err, "holds no runs; --of limits"));
  expect_refused(shell.hmax("stability predict --problem liver_forced --methods rk4 --out a/b"),
                 "--out is 'a/b'");
}

}  // namespace
}  // namespace hmax
