#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>

#include <fmt/format.h>

#include "tests/cli/program.hpp"

namespace hmax {
namespace {

using AnyJson = nlohmann::json;

AnyJson stability(const std::string& options) {
  const Told told = Shell().hmax("stability " + options + " --json");
  EXPECT_EQ(told.exit_code, 0) << told.err;
  EXPECT_EQ(told.err, "");
  return told.json();
}

TEST(StabilityPredict, SaysWhatItDoesNotVerifyOnAGpu) {
  const Shell shell;
  const std::string ask = "stability predict --mesh cube:n=2 --model fem_green --device gpu ";
  expect_refused(shell.hmax(ask + "--methods rk4"), "--device gpu is for the runs of --verify");
  expect_refused(shell.hmax(ask + "--verify --methods newmark"), "newmark runs on no GPU");
}

TEST(StabilityLimits, HaveTheKeysOfTheContract) {
  const std::vector<std::string> keys{"method",        "real",     "imaginary", "imaginary_weak",
                                      "alpha_degrees", "a_stable", "l_stable",  "lobes"};
  const AnyJson euler = stability("limits --method implicit_euler");
  expect_keys(euler, keys);
  EXPECT_EQ(euler.at("real"), "unbounded");
  EXPECT_EQ(euler.at("imaginary"), "unbounded");
  EXPECT_EQ(euler.at("alpha_degrees"), 90);
  EXPECT_TRUE(euler.at("a_stable").get<bool>() && euler.at("l_stable").get<bool>());
  EXPECT_EQ(euler.at("lobes"), AnyJson::array());

  const AnyJson bdf = stability("limits --method bdf_3,bdf_4,bdf_5");
  const double published[]{86.03, 73.35, 51.84};
  for (std::size_t i = 0; i < 3; ++i) {
    expect_keys(bdf[i], keys);
    EXPECT_NEAR(bdf[i].at("alpha_degrees").get<double>(), published[i], 0.005);
    EXPECT_FALSE(bdf[i].at("a_stable").get<bool>());
  }

  // Positions and velocities: omega h, and no word on a real eigenvalue alone, but why.
  const AnyJson motion = stability("limits --method stormer_verlet,newmark:beta=0.16666666666666666");
  for (const AnyJson& row : motion) {
    expect_keys(row, keys);
    EXPECT_TRUE(row.at("real").is_null());
    EXPECT_TRUE(says(row.at("status").get<std::string>(), "omega h"));
  }
  EXPECT_NEAR(motion[0].at("imaginary").get<double>(), 2, 1e-9);
  EXPECT_NEAR(motion[1].at("imaginary").get<double>(), std::sqrt(12.0), 1e-9);
}

TEST(StabilityRegion, BesideAStiffPartIsACircleForImplicitExplicitEuler) {
  // |1 + z_slow| <= |1 - z_fast|
  const AnyJson regions = stability("region --method imex_euler --fast 0,-3,4i");
  ASSERT_EQ(regions.size(), 3U);
  const double radii[]{1, 4, std::sqrt(17.0)};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(regions[i].at("method"), "imex_euler");
    ASSERT_EQ(regions[i].at("curves").size(), 1U);
    const double area = std::numbers::pi * radii[i] * radii[i];
    EXPECT_NEAR(regions[i].at("about")[0].at("area").get<double>(), area, 2e-3 * area);
  }
  EXPECT_EQ(regions[1].at("fast"), AnyJson({-3.0, 0.0}));
  EXPECT_EQ(regions[2].at("fast"), AnyJson({0.0, 4.0}));
}

TEST(StabilityRegion, WithAnOldJacobianEndsWhereLinearlyImplicitEulerDoes) {
  // R = 1 + z / (1 - z / r) is -1 at z = -2 r / (r - 2).
  const AnyJson regions = stability("region --method linearly_implicit_euler --ratios 3,4");
  ASSERT_EQ(regions.size(), 2U);
  for (const AnyJson& region : regions) {
    const double ratio = region.at("ratio");
    double leftmost = 0;
    for (const AnyJson& point : region.at("curves")[0]) leftmost = std::min(leftmost, point[0].get<double>());
    EXPECT_NEAR(leftmost, -2 * ratio / (ratio - 2), 1e-3) << ratio;
  }
}

TEST(NumericalDamping, OfImplicitEulerAtTenMillisecondsIsAQuarterOfCriticalOnEightHertz) {
  const AnyJson shown = stability("numerical-damping --method implicit_euler --h 0.01 --frequency 8");
  expect_keys(shown, {"method", "zeta_shown", "zeta_added", "frequency_shown", "period_error"});
  // |R| = (1 + (omega h)^2)^(-1/2), arg R = atan(omega h)
  const double x = 2 * std::numbers::pi * 8 * 0.01, decay = 0.5 * std::log1p(x * x), turn = std::atan(x);
  EXPECT_NEAR(shown.at("zeta_added").get<double>(), decay / std::hypot(decay, turn), 1e-12);
  EXPECT_NEAR(shown.at("zeta_added").get<double>(), 0.235, 5e-4);
  EXPECT_NEAR(shown.at("frequency_shown").get<double>(), turn / (2 * std::numbers::pi * 0.01), 1e-9);
  EXPECT_NEAR(shown.at("frequency_shown").get<double>(), 7.4, 0.02);
}

/// Runs that end in rounding, and starts that are large beside a body of a millimetre.
TEST(StabilityPredict, VerifiesSmallBodies) {
  for (const char* body : {"cube:n=1,edge=0.02 --alpha 5 --methods adams_bashforth_3",
                           "cube:n=1,edge=0.001 --alpha 10 --beta 1e-5 --methods rk4"}) {
    const Told told = Shell().hmax(std::string("stability predict --verify --mesh ") + body);
    EXPECT_EQ(told.exit_code, 0) << told.out;
  }
}

TEST(StabilityPredict, HasTheKeysOfTheContractAndIsVerified) {
  const AnyJson document = stability(
      "predict --problem liver_benchmark --materials male_slim:light,female_fat:heavy --methods "
      "rk4,newmark,adams_pece,explicit_euler --verify");
  ASSERT_EQ(document.at("rows").size(), 8U);
  for (const AnyJson& row : document.at("rows")) {
    expect_keys(row, {"problem", "material", "method", "h_max", "bound", "limiting", "observed", "gap",
                      "steps_used"});
    EXPECT_EQ(row.at("problem"), "liver_benchmark");
    const std::string bound = row.at("bound");
    if (row.at("method") == "adams_pece") {
      EXPECT_EQ(bound, "error_control");
      EXPECT_TRUE(row.at("h_max").is_null());
      EXPECT_TRUE(row.contains("status"));
    } else if (row.at("method") == "newmark") {
      EXPECT_EQ(row.at("h_max"), "unbounded");
      EXPECT_EQ(row.at("observed"), "unbounded");
      EXPECT_EQ(bound, "accuracy");
    } else {
      EXPECT_EQ(bound, "stability");
      expect_keys(row.at("limiting"), {"re", "im", "omega", "zeta"});
      EXPECT_LE(std::abs(row.at("gap").get<double>()), 1e-3);
      EXPECT_GT(row.at("steps_used").get<int>(), 0);
    }
  }
}

TEST(StabilityPredict, TellsBothRatesAndTheNaturalFrequencyOfAnOverdampedMode) {
  const std::string problem = "predict --problem liver_linear --set m=1 --set c=10 --set k1=16 --methods ";
  const AnyJson limiting = stability(problem + "rk4").at("rows")[0].at("limiting");
  EXPECT_EQ(limiting,
            AnyJson({{"re", -8.0}, {"im", 0.0}, {"omega", 4.0}, {"zeta", 1.25}, {"rates", {8.0, 2.0}}}));
  const Told told = Shell{}.hmax("stability " + problem + "rk4");
  EXPECT_TRUE(says(told.out, "rates [1/s]"));
  EXPECT_TRUE(says(told.out, "8 and 2"));
  // One that oscillates has none.
  const AnyJson swings = stability("predict --problem liver_linear --set c=1 --methods rk4").at("rows")[0];
  EXPECT_FALSE(swings.at("limiting").contains("rates"));
  // The rate of an equation of first order is no frequency.
  const AnyJson alone = stability("predict --problem dahlquist --methods rk4").at("rows")[0].at("limiting");
  EXPECT_TRUE(alone.at("omega").is_null() && alone.at("zeta").is_null()) << alone;
  EXPECT_TRUE(alone.contains("status") && !alone.contains("rates")) << alone;
}

TEST(StabilityMap, IsOfABodyOnAMeshAsWell) {
  const Shell shell;
  const AnyJson map = shell.json(
      "stability map --mesh phantom --model mass_spring --methods symplectic_euler --x "
      "E=5000:20000:2 --y mass=0.25:1:2");
  const AnyJson h = map.is_array() ? map.at(0).at("h_max") : map.at("h_max");
  // As the root of mass over stiffness, but for the weight that bends the body a little.
  const double ratio = h.at(0).at(0).get<double>() / h.at(1).at(1).get<double>();
  EXPECT_NEAR(ratio, 1, 1e-6) << "four times the mass and the stiffness: the same limit, the same shape";
  EXPECT_GT(h.at(1).at(0).get<double>(), 1.5 * h.at(0).at(0).get<double>());
}

TEST(StabilityMap, HasTheKeysOfTheContractAndDrawsItself) {
  const Shell shell;
  const AnyJson maps = shell.json(
      "stability map --problem liver_linear --method rk4,newmark --x c=-1:10:12 --y k1=0.1:10:6 --output maps");
  ASSERT_EQ(maps.size(), 2U);
  for (const AnyJson& map : maps) {
    expect_keys(map, {"method", "x", "y", "h_max", "falling_share_x", "falling_share_y", "status", "figure"});
    EXPECT_EQ(map.at("x").at("name"), "c");
    EXPECT_EQ(map.at("x").at("values").size(), 12U);
    ASSERT_EQ(map.at("h_max").size(), 6U);
    for (const AnyJson& row : map.at("h_max")) {
      ASSERT_EQ(row.size(), 12U);
      EXPECT_TRUE(row[0].is_null());
    }
  }
  EXPECT_TRUE(maps[0].at("h_max")[0][1].is_number());
  EXPECT_EQ(maps[1].at("h_max")[0][1], "unbounded");
  EXPECT_TRUE(std::filesystem::exists(shell / "maps/map.gp"));
  const std::string script = read_text(shell / "maps/map.gp");
  EXPECT_TRUE(says(script, "'c [N s/m]'"));
  EXPECT_TRUE(says(script, "'k1 [N/m]'"));

  const AnyJson one = stability(
      "map --problem liver_linear --method rk4 --rayleigh --log-x --log-y --x "
      "alpha=0.01:10:4 --y beta=0.01:10:3");
  EXPECT_EQ(one.at("x").at("name"), "alpha");
  EXPECT_NEAR(one.at("x").at("values")[1].get<double>(), 0.1, 1e-15);
  EXPECT_FALSE(one.contains("status"));
}

TEST(StabilityFrozen, TellsTheRatiosAndTheStepsBeyondThem) {
  const AnyJson euler = stability("frozen --method linearly_implicit_euler --ratios 1.5,2.5,4 --every 10");
  expect_keys(euler, {"method", "decay", "spring", "ratios", "omega0_h", "every"});
  EXPECT_NEAR(euler.at("decay").at("most").get<double>(), 2, 1e-9);
  EXPECT_NEAR(euler.at("spring").at("most").get<double>(), 2, 1e-9);
  EXPECT_EQ(euler.at("omega0_h")[0], "unbounded");
  // h^2 = 4 m / (k - 2 k0)
  EXPECT_NEAR(euler.at("omega0_h")[1].get<double>(), std::sqrt(8.0), 1e-9);
  EXPECT_NEAR(euler.at("omega0_h")[2].get<double>(), std::sqrt(2.0), 1e-9);
  EXPECT_EQ(euler.at("every").at("steps"), 10);
  EXPECT_EQ(euler.at("every").at("omega0_h").size(), 3U);
  EXPECT_EQ(stability("frozen --method rosenbrock").size(), 4U);
}

TEST(Stability, TakesATableauOfTheUserWhereItTakesMethods) {
  const Shell shell;
  std::ofstream(shell / "mine.toml") << "name = \"mine\"\na = [[], [\"1/2\"]]\nb = [0, 1]\n";
  const auto told = [&](const std::string& options) { return shell.json("stability " + options); };
  EXPECT_NEAR(told("limits --tableau mine.toml").at("real").get<double>(), 2, 1e-9);
  EXPECT_EQ(told("limits --method rk4 --tableau mine.toml").size(), 2U);
  EXPECT_EQ(told("region --tableau mine.toml").at("curves").size(), 1U);
  EXPECT_EQ(told("numerical-damping --tableau mine.toml --h 0.01 --frequency 8").at("method"), "mine");
  const AnyJson row = told("predict --problem liver_linear --tableau mine.toml --verify").at("rows")[0];
  EXPECT_EQ(row.at("method"), "mine");
  EXPECT_TRUE(row.at("agrees").get<bool>());
  EXPECT_LT(row.at("step_defect").get<double>(), 1e-12);
  expect_refused(shell.hmax("stability limits --tableau none.toml"), "none.toml");
}

TEST(StabilityPredict, TakesFormulasThatNothingStepsUnlessTheyAreToBeVerified) {
  const Shell shell;
  const std::string formulas =
      "predict --problem liver_linear --set c=8 --methods bdf_3,adams_bashforth_7,rkc_2:stages=5";
  const AnyJson rows = stability(formulas).at("rows");
  ASSERT_EQ(rows.size(), 3U);
  EXPECT_EQ(rows[0].at("h_max"), "unbounded");
  EXPECT_GT(rows[1].at("h_max").get<double>(), 0);
  EXPECT_LT(rows[1].at("h_max").get<double>(), rows[2].at("h_max").get<double>());
  expect_refused(shell.hmax("stability " + formulas + " --verify"), "bdf_3");
}

TEST(StabilityPredict, RefusesParametersBeyondTheRangeOfNumbersAtOnce) {
  const Shell shell;
  for (const char* set : {"m=1e-160", "k1=1e300", "c=1e200"})
    expect_refused(
        shell.hmax(std::string("stability predict --problem liver_linear --methods all --set ") + set),
        "eigenvalue");
}

TEST(StabilityPredict, EndsAMotionThatWouldTakeForEver) {
  const Shell shell;
  const std::string along = "stability predict --problem liver_forced --methods rk4 --along --t-end ";
  expect_refused(shell.hmax(along + "1e9"), "--t-end");
  expect_refused(shell.hmax("stability predict --problem liver_forced --methods rk4 --along --t-end=-1"),
                 "before the start");
  // An option that would be passed over is a mistake.
  expect_refused(shell.hmax("stability predict --problem liver_linear --methods rk4 --t-end 5"), "--along");
  expect_refused(shell.hmax("stability predict --mesh phantom --methods rk4 --along load --t-end 5"),
                 "--t-end");
  expect_refused(shell.hmax("stability predict --problem liver_benchmark --methods rk4 --material male_slim "
                            "--materials all"),
                 "--materials");
}

TEST(StabilityPredict, LooksAlongTheMotionOfAnOscillatorAndOfABody) {
  const Shell shell;
  const std::string predict = "stability predict --methods rk4 --json ";
  const AnyJson small =
      shell.hmax(predict + "--problem liver_forced --along").json().at("rows").at(0).at("along");
  EXPECT_EQ(small.at("y").size(), 2U);
  // 400 regular instants, and steps between them where the limit goes beyond.
  EXPECT_GE(small.at("path").size(), 401U);
  // From rest: 1e-12 of the largest displacement and of the largest velocity on the way, which a crude run
  // tells to some percent.
  EXPECT_EQ(small.at("tolerances").at("rtol"), 1e-10);
  EXPECT_GE(small.at("tolerances").at("atol"), 0.97e-12 * std::abs(small.at("y").at(0).get<double>()));
  EXPECT_GE(small.at("tolerances").at("atol_velocities"),
            0.97e-12 * std::abs(small.at("y").at(1).get<double>()));
  // The word that is meant when none is given.
  EXPECT_EQ(shell.hmax(predict + "--problem liver_forced --along motion").json().at("rows").at(0).at("along"),
            small);
  const AnyJson body =
      shell.hmax(predict + "--mesh phantom --along --t-end 0.1").json().at("rows").at(0).at("along");
  EXPECT_EQ(body.at("path").size(), 101U);
  EXPECT_GT(body.at("max_displacement"), 0);
  EXPECT_FALSE(body.contains("y"));
}

TEST(StabilityPredict, LooksAlongTheMotionOfModelsThatAreNotLinear) {
  const Shell shell;
  const Told forced = shell.hmax("stability predict --problem liver_forced --methods rk4,ode45");
  EXPECT_TRUE(says(forced.out, "necessary [s]  at t [s]  safe [s]"));
  EXPECT_TRUE(says(forced.out, "the model is not linear"));
  const Told linear = shell.hmax("stability predict --problem liver_linear --set P=1 --methods rk4");
  EXPECT_FALSE(says(linear.out, "necessary"));
  const Told none = shell.hmax("stability predict --problem liver_forced --methods rk4 --along none --json");
  EXPECT_FALSE(none.json().at("rows").at(0).contains("along"));
  // A body at equilibrium: small motions about it only.
  const Told body = shell.hmax("stability predict --mesh phantom --methods rk4");
  EXPECT_TRUE(says(body.out, "small motions about this state"));
}

// 2.14 to 2.16 s diverge, 2.17 to 2.19 s do not: a stride of 2 % steps over that window.
TEST(StabilityPredict, FindsTheFirstStepThatFailsFromTheStart) {
  const Shell shell;
  const AnyJson row =
      shell.json("stability predict --problem liver_forced --methods ode45 --verify").at("rows").at(0);
  const double h = row.at("observed_from_start"), stride = row.at("observed_from_start_stride");
  EXPECT_LE(stride, 1e-3);
  EXPECT_NEAR(h, 2.139, 0.002);
  const auto ends = [&](double step) {
    return shell.hmax(fmt::format("run --problem liver_forced --method ode45 --h {} --json", step))
        .json()
        .at("outcome");
  };
  EXPECT_EQ(ends(h), "reached_end");
  EXPECT_EQ(ends(1.001 * h), "diverged");
}

TEST(StabilityPredict, SaysOfEveryMaterialWhereItWasLinearised) {
  const Shell shell;
  const std::string line =
      "stability predict --mesh ball:n=2 --set g=30 --methods rk4 --materials male_slim,male_fat ";
  const Told people = shell.hmax(line + "--set alpha=0");
  for (const char* words : {"male_slim, fem_green", "male_fat, fem_green"})
    EXPECT_TRUE(says(people.out, words));
  const Told livers =
      shell.hmax("stability predict --problem liver_benchmark --materials male_slim,male_fat --methods rk4");
  EXPECT_TRUE(says(livers.out, "male_fat, liver_benchmark: equilibrium (0.0746269, 0)"));
  const Told mixed =
      shell.hmax("stability predict --mesh liver --methods rk4 --materials male_slim,male_fat");
  EXPECT_TRUE(says(mixed.out, "  at "));
  EXPECT_TRUE(says(mixed.out, "equilibrium  "));
}

// Both were called wrong: what creeps or fades slowly hid the growth.
TEST(StabilityPredict, ConfirmsLimitsBeyondWhichGrowthIsSlow) {
  const AnyJson creeping =
      stability("predict --problem liver_linear --set c=6 --set k1=0 --methods velocity_verlet --verify");
  EXPECT_EQ(creeping.at("rows").at(0).at("agrees"), true);
  EXPECT_LT(std::abs(creeping.at("rows").at(0).at("gap").get<double>()), 1e-3);
  const AnyJson told =
      Shell().json("stability predict --mesh liver --methods stormer_verlet --set beta=0.001 --verify");
  EXPECT_LT(std::abs(told.at("rows").at(0).at("gap").get<double>()), 1e-3);
}

TEST(StabilityPredict, LooksAtABodyUnderAGrowingLoad) {
  const Shell shell;
  const AnyJson row =
      shell
          .hmax(
              "stability predict --mesh phantom --load press --set force=2 --methods rk4 --along load "
              "--json")
          .json()
          .at("rows")
          .at(0);
  const AnyJson along = row.at("along");
  double least = 1;
  for (const AnyJson& point : along.at("path")) least = std::min(least, point.at(1).get<double>());
  EXPECT_EQ(along.at("h_min"), least);
  // The end of the path is the equilibrium that is linearised without it.
  EXPECT_EQ(along.at("path").back().at(0), 1);
  EXPECT_NEAR(along.at("path").back().at(1), row.at("h_max"), 1e-6 * row.at("h_max").get<double>());
  EXPECT_TRUE(along.contains("share"));
  EXPECT_EQ(along.at("growing_share"), 0);
  EXPECT_FALSE(along.contains("status"));
  const AnyJson broken =
      shell
          .hmax(
              "stability predict --mesh phantom --load press --set force=9 --methods rk4 --along load --json")
          .json()
          .at("rows")
          .at(0)
          .at("along");
  EXPECT_LT(broken.at("path").back().at(0), 1);
  EXPECT_TRUE(says(broken.at("status").get<std::string>(), "no equilibrium"));
  expect_refused(shell.hmax("stability predict --problem liver_forced --methods rk4 --along load"),
                 "no body");
  expect_refused(shell.hmax("stability predict --mesh phantom --methods rk4 --along laod"), "load");
}

TEST(Stability, RefusesBadInputInOneSentence) {
  const Shell shell;
  expect_refused(shell.hmax("stability limits --method rk5"), "rk5");
  expect_refused(shell.hmax("stability limits"), "--method");
  expect_refused(shell.hmax("stability limits --method adams_pece"), "order");
  expect_refused(shell.hmax("stability limits --method cvode_bdf"), "cvode_bdf");
  expect_refused(shell.hmax("stability limits --method bdf_7"), "bdf_7");
  expect_refused(shell.hmax("stability region --method rk4 --window nonsense"), "--window");
  expect_refused(shell.hmax("stability region --method rk4 --window 1,-1,0,1"), "--window");
  expect_refused(shell.hmax("stability region --method rk4 --output /dev/null/folder.csv"),
                 "/dev/null/folder.csv");
  expect_refused(shell.hmax("stability region --method rk4 --fast=-1"), "rk4");
  expect_refused(shell.hmax("stability region --method imex_euler --fast nonsense"), "--fast");
  expect_refused(shell.hmax("stability region --method imex_euler,imex_ark_324 --fast=-1"), "one method");
  expect_refused(shell.hmax("stability region --method rosenbrock_23 --ratios 0"), "--ratios");
  expect_refused(shell.hmax("stability region --method imex_euler --ratios 2"), "imex_euler");
  expect_refused(shell.hmax("stability region --method rosenbrock_23 --ratios 2 --order-star"),
                 "--order-star");
  for (const char* h : {"0", "-0.01", "nan", "inf"})
    expect_refused(shell.hmax(std::string("stability numerical-damping --method rk4 --frequency 8 --h=") + h),
                   "--h");
  expect_refused(shell.hmax("stability numerical-damping --method rk4 --h 0.01 --frequency 8 --zeta=-1"),
                 "--zeta");
  expect_refused(shell.hmax("stability numerical-damping --method rk4 --h 0.01"), "--frequency");
  expect_refused(shell.hmax("stability predict --problem liver_benchmark --methods rk4 --materials steel"),
                 "steel");
  expect_refused(shell.hmax("stability predict --problem liver_benchmark"), "--methods");
  expect_refused(shell.hmax("stability frozen --method rk4"), "rosenbrock_23");
  expect_refused(shell.hmax("stability frozen --method rosenbrock_23 --ratios 0"), "--ratios");
  expect_refused(shell.hmax("stability frozen --method rosenbrock_23 --every 0"), "--every");
  expect_refused(shell.hmax("stability frozen"), "--method");
  const std::string map = "stability map --problem liver_linear --method rk4 ";
  expect_refused(shell.hmax(map), "--x");
  expect_refused(shell.hmax(map + "--x c=0:10 --y k1=1:2:3"), "c=0:10");
  expect_refused(shell.hmax(map + "--x q=0:10:3 --y k1=1:2:3"), "'q'");
  expect_refused(shell.hmax(map + "--x c=0:10:3 --y k1=1:2:3 --set k1=4"), "--y varies k1, and 4 is given");
  expect_refused(shell.hmax(map + "--x m=-1:1:3 --y k1=1:2:3"), "m");
  expect_refused(shell.hmax(map + "--rayleigh --x c=0:10:3 --y beta=1:2:3"), "--rayleigh");
  expect_refused(shell.hmax("stability predict --problem no_such --methods rk4"), "no_such");
}

TEST(StabilityPredict, VerifiesFormulasOfManyStatesAndSaysWhereItDoesNot) {
  const Shell shell;
  write_text(shell / "chain.toml",
             "[equations]\na = \"c\"\nb = \"d\"\nc = \"-2*a + b - 0.1*c\"\nd = \"a - 2*b - 0.1*d\"\n"
             "[initial]\na = 1\nb = 0\nc = 0\nd = 0\n");
  const AnyJson formulas =
      shell.json("stability predict --problem chain.toml --methods explicit_runge_kutta --verify");
  int limits = 0;
  for (const AnyJson& row : formulas.at("rows")) {
    if (row.at("gap").is_null()) continue;
    ++limits;
    EXPECT_LE(std::abs(row.at("gap").get<double>()), 5e-3) << row;
  }
  EXPECT_GE(limits, 10);
  // Less than a hundred degrees of freedom, and no damping.
  const AnyJson small =
      shell.json("stability predict --mesh cube:n=2 --methods rk4,adams_bashforth_3 --verify");
  for (const AnyJson& row : small.at("rows")) EXPECT_LE(std::abs(row.at("gap").get<double>()), 5e-3) << row;
  const AnyJson tool = shell.json("stability predict --mesh phantom --load tool --methods rk4 --verify");
  EXPECT_EQ(tool.at("rows").at(0).at("agrees"), true);
  const AnyJson moved =
      shell.hmax("stability predict --mesh phantom --load breathing --methods rk4 --verify --json").json();
  EXPECT_TRUE(says(moved.at("rows").at(0).at("status").get<std::string>(), "not verified"));
}

TEST(StabilityPredict, LooksAlongTheMotionOfLoadsThatChangeWithTime) {
  const Shell shell;
  const std::string line =
      "stability predict --mesh ball:n=2 --load tool --set tool_stiffness=3e11 --methods symplectic_euler --json ";
  const Told found = shell.hmax(line);
  ASSERT_EQ(found.exit_code, 0) << found.err;
  const AnyJson row = found.json().at("rows").at(0);
  const Told at_rest = shell.hmax(line + "--at rest");
  const double without_contact = at_rest.json().at("rows").at(0).at("h_max");
  EXPECT_LT(row.at("along").at("h_min").get<double>(), 0.9 * without_contact)
      << "the contact stiffens the body";
  EXPECT_FALSE(row.contains("observed_from_start"));
  const auto tells = [](const Told& told, const std::string& what) {
    EXPECT_FALSE(told.json().at("rows").at(0).contains("along"));
    EXPECT_TRUE(says(told.err, what));
    EXPECT_TRUE(says(told.json().at("rows").at(0).at("status").get<std::string>(), what));
  };
  tells(at_rest, "its contact is not in the limit");
  tells(shell.hmax(line + "--along none"), "the limits are those of one state");
  // What does not change with time is not looked at unless it is asked for.
  EXPECT_FALSE(shell.json("stability predict --mesh ball:n=2 --load press --methods rk4")
                   .at("rows")
                   .at(0)
                   .contains("along"));
}

TEST(StabilityPredict, TakesFormulasThatNothingStepsWithOnBodies) {
  EXPECT_FALSE(Shell()
                   .json("stability predict --mesh phantom --method bdf_2")
                   .at("rows")
                   .at(0)
                   .contains("newton_step"));
}

TEST(StabilityPredict, SaysWhatABodyWasTakenToBe) {
  const Shell shell;
  const std::string line = "stability predict --mesh phantom --load press --methods rk4 ";
  const Told people = shell.hmax(line);
  EXPECT_TRUE(says(people.out, "E 5500 Pa, nu 0.45, 1060 kg/m^3"));
  EXPECT_EQ(people.err, "");
  const Told kilopascals = shell.hmax(line + "--set E=5.5 --at rest --json");
  EXPECT_TRUE(says(kilopascals.err, "E is 5.5 Pa"));
  const AnyJson body = kilopascals.json().at("models").at(0).at("body");
  EXPECT_EQ(body.at("E"), 5.5);
  EXPECT_EQ(body.at("fixed"), body.at("held"));  // its old name
  EXPECT_EQ(body.at("unusual").size(), 1U);
}

// Limits at rest and along the motion are there within a second, runs from the start take one thread half a
// minute.
TEST(StabilityPredict, KeepsWhatIsFinishedWhenItIsInterruptedAlongAMotion) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "the address sanitizer is too slow for times of a test";
#endif
  // Without --foreground the signal comes twice, and the second one ends at once.
  const Told told = Shell().line(
      "timeout --foreground -s INT 12 '" HMAX_PROGRAM
      "' stability predict --problem liver_forced --methods explicit_runge_kutta,adams --along --verify "
      "--jobs 1 --t-end 20000 --json");
  EXPECT_EQ(told.exit_code, 124) << "`timeout` had to interrupt";
  EXPECT_EQ(told.err, "hmax: interrupted; the rows so far are printed\n");
  const AnyJson rows = told.json()["rows"];
  ASSERT_GT(rows.size(), 0U);
  int unfinished = 0;
  for (const AnyJson& row : rows)
    if (row["bound"] == "stability") {
      EXPECT_TRUE(row["along"]["h_min"].is_number());
      unfinished += row.contains("observed_from_start") ? 0 : 1;
    }
  EXPECT_GT(unfinished, 0);
}

TEST(StabilityPredict, SaysHowManyRowsAreKeptWhenItIsInterrupted) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "the address sanitizer is too slow for times of a test";
#endif
  const Shell shell;
  const Told told = shell.line(
      "timeout -s INT 12 '" HMAX_PROGRAM
      "' stability predict --problem liver_forced --methods explicit_runge_kutta,adams --along --verify "
      "--jobs 1 --t-end 20000 --out kept.sqlite");
  EXPECT_EQ(told.exit_code, 124) << "`timeout` had to interrupt";
  const std::size_t kept = shell.json("export kept.sqlite --of limits --format jsonl").size();
  ASSERT_EQ(kept, 0U) << "rows without what lies along the motion are not stored";
  EXPECT_FALSE(says(told.out, " limits in kept.sqlite"));
  EXPECT_TRUE(says(told.err, "hmax: interrupted; the rows so far are printed, 0 of "));
  EXPECT_TRUE(says(told.err, " are kept in kept.sqlite\n"));
}

TEST(StabilityPredict, LinearisesABodyAtEquilibriumOrAtRestAndSaysWhere) {
  const Shell shell;
  const std::string predict = "stability predict --methods rk4 --json ";
  const auto row_of = [&](const std::string& rest) {
    return shell.hmax(predict + rest).json().at("rows").at(0);
  };
  const std::string hanging = "--mesh phantom --model fem_green --set g=9.81 ";
  EXPECT_EQ(row_of(hanging).at("state_kind"), "equilibrium");
  const AnyJson at_rest = row_of(hanging + "--at rest");
  EXPECT_EQ(at_rest.at("state_kind"), "rest");
  EXPECT_FALSE(at_rest.contains("status"));
  EXPECT_EQ(at_rest.at("h_max"), row_of("--mesh phantom --model fem_green --set g=0").at("h_max"));
  const AnyJson lost = row_of("--mesh ball:n=2 --set g=30");
  EXPECT_EQ(lost.at("state_kind"), "rest");
  EXPECT_TRUE(says(lost.at("status").get<std::string>(), "tetrahedron"));
  EXPECT_EQ(shell.json("stability modes --at rest " + hanging).at("state_kind"), "rest");
  expect_refused(shell.hmax(predict + "--problem liver_linear --at rest"),
                 "liver_linear is no body on a mesh, and --at rest");
  expect_refused(shell.hmax(predict + "--mesh phantom --at motion"), "rest");
}

TEST(NumericalDamping, FollowsThePrincipalRootAndSaysWhereNyquistIsPassed) {
  const Shell shell;
  const std::string line = "stability numerical-damping --method hht_alpha --frequency 5 --zeta 0.9 --h 0.06";
  const AnyJson below = shell.json(line);
  EXPECT_NEAR(below.at("zeta_shown").get<double>(), 0.5622, 5e-5);
  EXPECT_NEAR(below.at("frequency_shown").get<double>(), 3.94, 5e-3);
  EXPECT_FALSE(below.at("aliased").get<bool>());
  const Told above = shell.hmax("stability numerical-damping --method newmark --frequency 8 --h 0.1");
  EXPECT_TRUE(says(above.out, "Nyquist frequency 1/(2 h) = 5 Hz"));
  // 1/(2 h) = 5 Hz is above 5 sqrt(1 - 0.81) = 2.18 Hz, the frequency of the damped mode.
  EXPECT_FALSE(
      says(shell.hmax("stability numerical-damping --method hht_alpha --frequency 5 --zeta 0.9 --h 0.1").out,
           "Nyquist"));
}

TEST(NumericalDamping, HasNoNegativeZero) {
  const std::string told =
      Shell().text("stability numerical-damping --methods structural,trapezoidal --frequency 8 --h 0.001");
  for (const char* zero : {" -0 ", " -0.00 %"}) EXPECT_FALSE(says(told, zero));
}

TEST(StabilityLimits, ShowEveryMethodOfAFamilyOrNameIt) {
  const Shell shell;
  const Told stabilised = shell.hmax("stability limits --methods stabilised");
  EXPECT_EQ(stabilised.exit_code, 0);
  for (const char* id : {"rkc_2:stages=10", "rkl_2:stages=10"}) EXPECT_TRUE(says(stabilised.out, id));
  EXPECT_TRUE(says(stabilised.err, "hmax: note: rkc_2 chooses its number of stages"));
  const Told all = shell.hmax("stability limits --methods all");
  for (const AnyJson& method : shell.json("list methods"))
    EXPECT_TRUE(says((all.out + all.err), method.at("id").get<std::string>())) << method.at("id");
  EXPECT_EQ(shell.json("stability region --methods stabilised").size(), 2U);
}

TEST(StabilityPredict, NamesMethodsOfAFamilyThatTheModelDoesNotSuit) {
  const Shell shell;
  expect_refused(shell.hmax("stability predict --problem hires --methods structural"),
                 "positions and velocities");
  const Told told = shell.hmax("stability predict --problem hires --methods structural,rk4");
  EXPECT_EQ(told.exit_code, 0) << told.err;
  EXPECT_TRUE(says(told.err, "newmark"));
}

}  // namespace
}  // namespace hmax
