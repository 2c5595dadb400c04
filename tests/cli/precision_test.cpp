#include "tests/cli/program.hpp"

namespace hmax {
namespace {

TEST(PrecisionCommand, MeasuresAdaptiveMethodsOverTolerancesAndTheOthersOverSteps) {
  const Shell shell;
  const auto rows = shell.json(
      "precision --problem liver_forced --methods ode45,rk4 --rtol 1e-4,1e-8 --h 20,0.1 --t-end 20");
  ASSERT_EQ(rows.size(), 4U);
  double loose = 0, tight = 0, lost = 0;
  for (const auto& row : rows) {
    if (row.at("outcome") != "reached_end") {
      EXPECT_TRUE(row.at("error_global").is_null());
      EXPECT_EQ(row.at("h"), 20);
      ++lost;
      continue;
    }
    EXPECT_GT(row.at("cpu_median_s").get<double>(), 0);
    EXPECT_GT(row.at("rhs").get<int>(), 0);
    EXPECT_GT(row.at("error_global").get<double>(), row.at("reference_error").get<double>());
    if (row.at("method") != "dormand_prince_54") continue;
    (row.at("rtol") == 1e-4 ? loose : tight) = row.at("error_global").get<double>();
  }
  EXPECT_TRUE(says(rows[0].at("error_of").get<std::string>(), "v [m/s]"));
  EXPECT_LE(lost, 1);
  EXPECT_GT(loose, 1000 * tight);
}

TEST(PrecisionCommand, ShowsTheErrorOfTheEndOfStiffProblems) {
  const Shell shell;
  const std::string stiff = "precision --problem van_der_pol --methods rodas_4 --rtol 1e-4 --t-end 1000 ";
  const Told by_default = shell.hmax(stiff), largest = shell.hmax(stiff + "--error max");
  EXPECT_TRUE(says(by_default.out, "at the end"));
  EXPECT_TRUE(says(largest.out, "at any accepted step"));
  EXPECT_TRUE(says(shell.hmax("precision --problem liver_forced --methods rk4 --h 0.1 --t-end 5").out,
                   "at any accepted step"));
}

TEST(PrecisionCommand, ShowsTheRootMeanSquareOverTime) {
  const Shell shell;
  const std::string command = "precision --problem liver_forced --methods rk4 --h 0.1 --t-end 20 --error l2";
  EXPECT_TRUE(says(shell.hmax(command).out, "root mean square over time"));
  const auto row = shell.json(command).at(0);
  const double mean = row.at("error_l2").get<double>(), largest = row.at("error_global").get<double>();
  EXPECT_GT(mean, 0);
  EXPECT_LT(mean, 0.9 * largest);
  EXPECT_GT(mean, 0.05 * largest);
}

TEST(PrecisionCommand, RefusesAFigureBeforeItMeasures) {
  const Shell shell;
  std::filesystem::create_directories(shell / "mine");
  write_text(shell / "mine/precision.svg", "a drawing of my own");
  const Told told = shell.hmax("precision --methods rk4 --h 0.1 --t-end 5 --store kept.sqlite --output mine");
  EXPECT_EQ(told.exit_code, 2);
  EXPECT_TRUE(says(told.err, "--force"));
  EXPECT_FALSE(std::filesystem::exists(shell / "kept.sqlite"));
}

TEST(PrecisionCommand, GivesUpRunsThatTakeTooLong) {
  const Told told = Shell().hmax("precision --problem hires --methods rk4 --h 1e-3 --budget 1e-6 --json");
  EXPECT_EQ(told.json().at(0).at("outcome"), "over_budget");
  EXPECT_TRUE(told.json().at(0).at("cpu_median_s").is_null());
  EXPECT_TRUE(says(told.json().at(0).at("status").get<std::string>(), "given up"));
}

TEST(PrecisionCommand, DrawsTheFigureAndKeepsTheRowsWhereAsked) {
  const Shell shell;
  const std::string told = shell.text(
      "precision --methods bogacki_shampine_32,ode45 --rtol 1e-3,1e-5 --t-end 5 --store kept.sqlite --output "
      "figure");
  EXPECT_TRUE(std::filesystem::exists(shell / "figure/precision.gp"));
  EXPECT_TRUE(std::filesystem::exists(shell / "kept.sqlite"));
  EXPECT_TRUE(says(told, "bogacki_shampine_32"));
}

TEST(PrecisionCommand, BadInputIsRefusedInOneSentence) {
  const Shell shell;
  expect_refused(shell.hmax("precision"), "--methods");
  expect_refused(shell.hmax("precision --methods rk4 --error l1"), "--error");
  expect_refused(shell.hmax("precision --methods rk4 --budget 0"), "--budget");
  expect_refused(shell.hmax("precision --methods ode54"), "ode54");
  expect_refused(shell.hmax("precision --methods ode45 --rtol 0"), "relative tolerance");
  expect_refused(shell.hmax("precision --methods rk4 --h -1"), "step");
  expect_refused(shell.hmax("precision --methods ode45 --repeats 3"), "--repeats");
  // What no method would look at.
  expect_refused(shell.hmax("precision --methods rk4,newmark --rtol 1e-4"), "--rtol");
  expect_refused(shell.hmax("precision --methods ode45 --h 0.1"), "--h");
}

TEST(PrecisionCommand, StatesItsTolerances) {
  const Shell shell;
  const std::string command = "precision --methods ode45 --rtol 1e-4 --t-end 5";
  EXPECT_EQ(shell.json(command).at(0).at("atol"), 1e-4);
  EXPECT_EQ(shell.json(command + " --atol-over-rtol 0.5").at(0).at("atol"), 0.5e-4);
  EXPECT_TRUE(says(shell.hmax(command).out, "\natol = rtol\n"));
  EXPECT_TRUE(says(shell.hmax(command + " --atol-over-rtol 0.5").out, "\natol = 0.5 rtol\n"));
  const Told fixed = shell.hmax("precision --methods rk4 --h 0.1 --t-end 5 --json");
  EXPECT_TRUE(fixed.json().at(0).at("atol").is_null());
}

TEST(PrecisionCommand, SaysThatRowsAreKeptWhereTheyAre) {
  const Shell shell;
  const auto interrupted = [&](const std::string& rest) {
    const Told told = shell.line(
        "timeout --foreground -s INT 2 '" HMAX_PROGRAM "' precision --methods explicit_runge_kutta " + rest);
    EXPECT_EQ(told.exit_code, 124) << "`timeout` had to interrupt";
    return told.err;
  };
  EXPECT_EQ(interrupted("--repeats 9000"), "hmax: interrupted\n");
  // Of 9000 repeats no block is finished by then.
  for (const char* repeats : {"9000", "20"}) {
    const std::string store = std::string("rows") + repeats + ".sqlite";
    const std::string told = interrupted("--repeats " + std::string(repeats) + " --store " + store);
    const bool is_kept = !shell.json("export " + store + " --format jsonl").empty();
    EXPECT_EQ(told, is_kept ? "hmax: interrupted; what was finished is kept in " + store + "\n"
                            : "hmax: interrupted; nothing was finished\n");
  }
}

TEST(PrecisionCommand, NamesMethodsThatTakeNoTolerance) {
  const Told told = Shell().hmax("precision --methods rk4,ode45 --rtol 1e-4 --t-end 1");
  EXPECT_EQ(told.exit_code, 0) << told.err;
  // rk4 runs at the default steps.
  EXPECT_FALSE(says(told.err, "left out"));
}

}  // namespace
}  // namespace hmax
