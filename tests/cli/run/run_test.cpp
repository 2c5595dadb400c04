#include <cmath>
#include <filesystem>

#include <fmt/format.h>

#include "results/table.hpp"
#include "tests/cli/program.hpp"

namespace hmax {
namespace {

using AnyJson = nlohmann::json;

TEST(Run, HasDivergedWhereItsStateIsNoneOfTheProblem) {
  const Told body = Shell().hmax(
      "run --mesh phantom --model fem_cauchy --load press --method symplectic_euler --h 0.01 --t-end 3 --json");
  EXPECT_EQ(body.exit_code, 1);
  EXPECT_EQ(body.json().at("outcome"), "diverged");
  EXPECT_LT(body.json().at("max_displacement").get<double>(), 2e4);
  EXPECT_LT(body.json().at("t_state"), body.json().at("t"));
  const Told reaction =
      Shell().hmax("run --problem robertson --method cvode_bdf --rtol 1e-3 --atol 1e-4 --json");
  if (reaction.exit_code != 2) {  // 2: without SUNDIALS
    EXPECT_NE(reaction.json().at("outcome"), "reached_end");
    EXPECT_GT(reaction.json().at("y").at(0).get<double>(), -1);
  }
}

TEST(Run, StepsOnAGpuWithTheSameBitsOrSaysWhyNot) {
  const Shell shell;
  const std::string body =
      "run --mesh cube:n=3 --model fem_green --method symplectic_euler --h 1e-4 --t-end 0.02";
  const Told told = shell.hmax(body + " --device gpu --json --full");
  if (told.exit_code == 0) {
    const AnyJson on_gpu = told.json(), here = shell.json(body + " --json --full");
    EXPECT_EQ(on_gpu.at("y"), here.at("y"));
    EXPECT_TRUE(on_gpu.at("cpu_seconds").is_null());
    EXPECT_GT(on_gpu.at("device_seconds"), 0);
    const AnyJson two = shell.json(body + " --device gpu --json --full --bodies 2");
    EXPECT_EQ(two.at("y"), here.at("y"));
    EXPECT_EQ(two.at("bodies"), 2);
  } else {
    expect_refused(told, "leave out --device");
    const Told check = shell.line("'" HMAX_SOURCE_DIR "/scripts/gpu-check' '" HMAX_PROGRAM "'");
    EXPECT_EQ(check.exit_code, 77);
    EXPECT_TRUE(says(check.err, "gpu-check: skipped: "));
  }
  EXPECT_EQ(shell.json(body + " --json --full --device cpu").count("device"), 0U);
  expect_refused(shell.hmax(body + " --device tpu"), "--device is 'tpu'; did you mean 'cpu' or 'gpu'?");
  expect_refused(shell.hmax(body + " --precision single"), "is for --device gpu");
  expect_refused(shell.hmax(body + " --device gpu --precision half"), "--precision");
  expect_refused(shell.hmax(body + " --bodies 2"), "is for --device gpu");
  expect_refused(shell.hmax(body + " --device gpu --bodies 0"), "--bodies");
  expect_refused(shell.hmax(body + " --device gpu --bodies 1000001"), "--bodies");
  expect_refused(shell.hmax(body + " --device gpu --jobs 2"), "--jobs");
  expect_refused(shell.hmax("run --problem liver_forced --method rk4 --h 0.1 --device gpu"),
                 "bodies on meshes");
  expect_refused(
      shell.hmax("run --mesh cube:n=3 --load tool --set tool_damping=1 --method rkc_2 --h 1e-4 --device gpu"),
      "tool");
  const Told pressures =
      shell.hmax("run --mesh cube:n=3 --model fem_nodal_pressure --method newmark --h 1e-2 --device gpu");
  expect_refused(pressures, "runs on no GPU");
  EXPECT_TRUE(says(pressures.err, "rkl_2, newton_truncated or an explicit Runge-Kutta method"))
      << pressures.err << ": neither vbd nor xpbd has them";
}

TEST(Run, NamesWhatAGpuRunsAsItIsAskedTo) {
  const Shell shell;
  const auto remedies = [&](const std::string& options) {
    const Told told = shell.hmax("run --mesh cube:n=3 --model fem_neo_hookean --device gpu " + options);
    expect_refused(told, "leave --device out, or take ");
    return told.err.substr(told.err.find("or take "));
  };
  EXPECT_TRUE(says(remedies("--method newmark --h 1e-3"), "xpbd or an explicit"));
  const std::string of_tool = remedies("--load tool --method newmark --h 1e-3");
  EXPECT_TRUE(says(of_tool, "newton_truncated or an explicit")) << of_tool << ": a tool keeps xpbd away";
  const std::string single = remedies("--method newmark --h 1e-3 --precision single");
  EXPECT_TRUE(says(single, "central_difference or an explicit"))
      << single << ": methods of iterations run in double precision";
  const std::string adaptive = remedies("--method radau_iia_5 --rtol 1e-4 --atol 1e-6");
  EXPECT_TRUE(says(adaptive, "take rkc_2, rkl_2 or an explicit Runge-Kutta method of hmax such as ode45"))
      << adaptive;
  const Told pbd =
      shell.hmax("run --mesh cube:n=3 --model fem_neo_hookean --load tool --method pbd --h 1e-3");
  expect_refused(pbd, "a tool touches the body; take another load");
  EXPECT_FALSE(says(pbd.err, "xpbd")) << "a tool keeps that away too";
}

TEST(Run, RefusesWhatNoGpuStepsBeforeItLooksForOne) {
  const Shell shell;
  for (const char* alone : {"rkc_2 --h 1e-4", "newton_truncated --h 1e-2", "ode45 --rtol 1e-4 --atol 1e-6"})
    for (const char* option : {"--bodies", "--precision"}) {
      const bool bodies = std::string_view(option) == "--bodies";
      expect_refused(
          shell.hmax(fmt::format("run --mesh cube:n=3 --device gpu --t-end 0.01 --method {} {} {}", alone,
                                 option, bodies ? "3" : "single")),
          fmt::format("leave {}", std::string_view(alone).starts_with("ode45") ? "--precision" : option));
    }
}

TEST(Run, PrintsWhenTheStateWasThatItEndsWith) {
  const Told told = Shell().hmax("run --problem liver_forced --method rk4 --h 2");
  EXPECT_TRUE(says(told.out, "diverged at t = 10 s"));
  EXPECT_TRUE(says(told.out, "before that, at t = 8 s"));
}

TEST(Run, DrawsMotionsOfWhatIsNoBody) {
  const Shell shell;
  const Told told = shell.hmax("run --problem liver_forced --method rk4 --h 0.1 --picture motion.svg --json");
  ASSERT_EQ(told.exit_code, 0) << told.err;
  if (!told.json().at("picture").is_null()) {
    const std::string svg = read_text(shell / "motion.svg");
    for (const char* words : {"orbit", "x [m]", "v [m/s]", "rk4, h = 0.1 s"}) EXPECT_TRUE(says(svg, words));
  } else {
    EXPECT_TRUE(says(told.err, "gnuplot is not installed"));
  }
  expect_refused(
      shell.hmax(
          "run --problem liver_forced --method rk4 --h 0.1 --picture motion.svg --colour displacement"),
      "is for pictures of bodies");
  expect_refused(shell.hmax("run --problem liver_forced --method rk4 --h 0.1 --picture motion.pdf"),
                 "end in .svg");
}

/// A time that ends at 0 or begins above it has no logarithm that shows the beginning.
TEST(Run, DrawsMotionsInTheTimeOfTheUser) {
  const Shell shell;
  const auto svg_of = [&](const std::string& text, const std::string& options) {
    write_text(shell / "own.toml", text);
    const Told told = shell.hmax("run --problem own.toml --picture own.svg --json " + options);
    if (told.json().at("picture").is_null()) {
      EXPECT_TRUE(says(told.err, "gnuplot is not installed"));
      return std::string();
    }
    return read_text(shell / "own.svg");
  };
  const std::string fast =
      svg_of("[problem]\nt0 = -1\nt_end = 0\n[equations]\nx = \"-1e6*(x - cos(t))\"\n[initial]\nx = 2\n",
             "--method radau_iia_5 --rtol 1e-9 --atol 1e-9");
  const std::string blows_up = svg_of(
      "[problem]\nt0 = 5\nt_end = 8\n[equations]\nx = \"x^2\"\n[initial]\nx = 1\n", "--method rk4 --h 0.01");
  if (fast.empty()) return;
  EXPECT_TRUE(says(fast, ">-0.5<")) << "the axis has no negative times";
  EXPECT_TRUE(says(blows_up, "diverged at t = 6"));
}

TEST(Run, DrawsAMotionOfMoreStepsThanCanBeKept) {
  const Shell shell;
  const AnyJson told = shell.json(
      "run --problem liver_forced --method explicit_euler --h 4e-7 --t-end 4.4 --picture long.svg");
  EXPECT_GT(told.at("stats").at("steps"), 1e7);
  if (told.at("picture").is_null()) return;  // no gnuplot
  EXPECT_LT(std::filesystem::file_size(shell / "long.svg"), 1'000'000U);
}

TEST(Run, DrawsOrbitsOverThePositionWhateverAFileListsFirst) {
  const Shell shell;
  write_text(shell / "own.toml",
             "[problem]\nt_end = 6\n[equations]\nv = \"-4*x\"\nx = \"v\"\n[initial]\nv = 0\nx = 1\n");
  const Told told = shell.hmax("run --problem own.toml --method rk4 --h 0.01 --picture own.svg --json");
  if (told.json().at("picture").is_null()) return;  // no gnuplot
  const std::string svg = read_text(shell / "own.svg");
  const std::size_t orbit = svg.find(">orbit<");
  ASSERT_NE(orbit, svg.npos);
  // The vertical axis is labelled first.
  EXPECT_LT(svg.find(">v<", orbit), svg.find(">x<", orbit));
}

/// Each jump takes a few hundred of a million steps; the velocity reaches 1300 in it.
TEST(Run, DrawsShortPeaksOfLongMotions) {
  const Shell shell;
  const AnyJson told =
      shell.json("run --problem van_der_pol --method ode45 --rtol 1e-6 --atol 1e-6 --picture jumps.svg");
  EXPECT_GT(told.at("stats").at("steps"), 1e6);
  if (told.at("picture").is_null()) return;  // no gnuplot
  EXPECT_TRUE(says(read_text(shell / "jumps.svg"), ">-1000<")) << "the axis ends before the peak";
}

TEST(Run, KeepsRobertsonsConcentrationsAtLooseTolerances) {
  for (const char* method : {"radau_iia_5", "sdirk_4", "tr_bdf2"})
    for (const char* rtol : {"1e-2", "1e-3", "1e-4", "1e-6"})
      for (const char* atol : {"1e-4", "1e-6", "1e-8"}) {
        const AnyJson told = Shell().json(
            fmt::format("run --problem robertson --method {} --rtol {} --atol {}", method, rtol, atol));
        EXPECT_NEAR(told.at("y").at(2).get<double>(), 1, 1e-4);
      }
}

TEST(Run, HasTheKeysOfTheContract) {
  const Told told = Shell().hmax("run --problem liver_linear --method rk4 --h 0.5 --json");
  const AnyJson run = told.json();
  expect_keys(run, {"problem", "method", "outcome", "t", "y", "stats", "cpu_seconds"});
  expect_keys(run.at("stats"),
              {"steps", "rejected", "rhs", "jacobian", "factorisations", "newton", "linear_iterations"});
  EXPECT_EQ(run.at("outcome"), "reached_end");
  EXPECT_EQ(run.at("t"), 100);
  EXPECT_EQ(run.at("stats").at("steps"), 200);
  EXPECT_EQ(run.at("stats").at("rhs"), 800);
  EXPECT_EQ(told.err, "");
}

TEST(Run, SettingsChangeTheProblem) {
  const Shell shell;
  const AnyJson run = shell.json(
      "run --problem liver_benchmark --material female_fat:heavy --set c=6 --set P=0 "
      "--y0 -1,2 --method ode45 --rtol 1.0D-3 --atol 1e-6");
  EXPECT_EQ(run.at("method"), "dormand_prince_54");
  EXPECT_EQ(run.at("material"), "female_fat:heavy");
  EXPECT_EQ(run.at("parameters").at("c"), 6);
  EXPECT_EQ(run.at("parameters").at("P"), 0);
  EXPECT_EQ(run.at("y0"), AnyJson({-1, 2}));
  EXPECT_EQ(run.at("control"), "deadband");
  // The settings reach the integration: started elsewhere, damped more or unforced the liver ends elsewhere.
  const auto end = [&](const std::string& options) {
    return shell.json("run --problem liver_forced --method rk4 --h 0.01 --t-end 5 " + options)
        .at("y")[0]
        .get<double>();
  };
  for (const char* options : {"--set c=6", "--set P=0", "--set m=2", "--y0 -1,2"})
    EXPECT_GT(std::abs(end(options) - end("")), 0.01) << options;
  const auto steps = [&](const std::string& control) {
    return shell
        .json("run --problem liver_forced --method ode45 --rtol 1e-3 --atol 1e-6 --control " + control)
        .at("stats")
        .at("steps")
        .get<int>();
  };
  EXPECT_NE(steps("matlab"), steps("i"));
}

TEST(Run, OneThatDoesNotReachItsEndExitsWithOneAndSaysWhere) {
  const Shell shell;
  const Told diverged = shell.hmax("run --problem liver_forced --set c=50 --method rk4 --h 2 --json");
  EXPECT_EQ(diverged.exit_code, 1);
  EXPECT_EQ(diverged.json().at("outcome"), "diverged");
  EXPECT_LT(diverged.json().at("t"), 100);
  EXPECT_EQ(
      shell.hmax("run --problem liver_forced --method ode45 --rtol 1e-6 --atol 1e-6 --max-steps 9").exit_code,
      1);
}

TEST(Run, InterruptedOnesExitWith130) {
  const Told told = Shell().line("timeout --preserve-status -s INT 0.3 '" HMAX_PROGRAM
                                 "' run --problem liver_forced --method rk4 --h 1e-6 --t-end 1000");
  EXPECT_EQ(told.exit_code, 130);
  EXPECT_EQ(told.out, "");
}

TEST(Run, WritesTheMotionWithUnits) {
  const Shell shell;
  shell.text(
      "run --problem liver_forced --method ode45 --rtol 1e-9 --atol 1e-9 --t-end 10 --output motion.csv "
      "--every 0.25");
  const Table motion = read_csv(shell / "motion.csv");
  EXPECT_EQ(motion.columns, (std::vector<std::string>{"t [s]", "x [m]", "v [m/s]"}));
  ASSERT_EQ(motion.values[0].size(), 41U);
  EXPECT_EQ(motion.values[0][1], 0.25);
  EXPECT_EQ(motion.values[1].front(), 0.5);
  EXPECT_NEAR(motion.values[1].back(), -0.33690941329, 1e-7);
  // Without --every each step is a point.
  shell.hmax("run --problem liver_forced --method rk4 --h 0.5 --t-end 10 --output steps.csv");
  EXPECT_EQ(read_csv(shell / "steps.csv").values[0].size(), 21U);
}

TEST(Run, TakesATableauAndASystemOfTheUser) {
  const Shell shell;
  write_text(shell / "ralston.toml", "a = [[], [\"2/3\"]]\nb = [0.25, 0.75]\n");
  write_text(shell / "decay.toml",
             "[problem]\nt_end = 1\n[equations]\nx = \"-k*x\"\n[parameters]\nk = 2\n[initial]\nx = 1\n");
  const AnyJson told = shell.json("run --problem decay.toml --set k=1 --tableau ralston.toml --h 0.001");
  EXPECT_EQ(told.at("order"), 2);
  EXPECT_NEAR(told.at("y")[0].get<double>(), 0.36787944117144233, 1e-6);
  const Told people = shell.hmax("run --problem decay.toml --tableau ralston.toml --h 0.001");
  EXPECT_TRUE(says(people.out, "its order is 2"));
}

TEST(Run, RefusesStepsTolerancesAndTimesThatAreNone) {
  const Shell shell;
  const auto refused = [&](const std::string& options, const std::string& named) {
    expect_refused(shell.hmax("run --problem liver_forced --method rk4 " + options), named);
  };
  refused("--h -1", "the step is -1");
  refused("--h 0", "the step is 0");
  refused("--h nan", "the step is nan");
  refused("--h inf", "the step is inf");
  refused("--h 1e308", "longer than the whole run");
  refused("--h 1e-300", "--max-steps");
  refused("--h 1,5", "1.5 and not 1,5");
  refused("--h 1e400", "--h is '1e400'");
  refused("--h ten", "--h is 'ten'");
  refused("--h", "hmax run --help");
  refused("--h 0.1 --t-end -5", "before the start");
  refused("--h 0.1 --t-end nan", "--t-end is nan but must be a finite number of seconds");
  refused("--h 0.1 --max-steps 0", "--max-steps");
  refused("", "--rtol");
  refused("--rtol 1e-3", "--atol is missing");
  refused("--rtol 1e-3 --atol 1e-3", "no error estimate");
  refused("--h 0.1 --rtol 1e-3", "both given");
  refused("--h 0.1 --control pi", "--control");
  refused("--h 0.1 --jacobian exact", "rk4 uses no Jacobian");
  expect_refused(shell.hmax("run --problem liver_forced --method ode45 --rtol -1 --atol 1e-3"), "--rtol");
  expect_refused(shell.hmax("run --problem liver_forced --method ode45 --rtol 1e-3 --atol nan"), "--atol");
  expect_refused(shell.hmax("run --problem liver_forced --method ode45 --rtol 1e-30 --atol 1e-300"),
                 "rounding");
}

TEST(Run, RefusesUnknownNamesWithTheNearestOne) {
  const Shell shell;
  expect_refused(shell.hmax("run --mesh cube:n=2 --method newton_truncated --h 0.1 --jacobian frozen"),
                 "newton_truncated:frozen=1 keeps that of the start");
  expect_refused(shell.hmax("run --problem liver_forcd --method rk4 --h 0.1"),
                 "did you mean 'liver_forced'?");
  expect_refused(shell.hmax("run --problem liver_forced --method rk5 --h 0.1"), "did you mean 'rk4'?");
  const std::string start = "run --problem liver_forced --method ode45 ";
  expect_refused(shell.hmax(start + "--h 0.1 --set mass=3"), "known are m, c, k1, k3, P, w");
  expect_refused(shell.hmax(start + "--h 0.1 --set m"), "--set is 'm'");
  expect_refused(shell.hmax(start + "--h 0.1 --set m=0"), "mass must be positive");
  expect_refused(shell.hmax(start + "--h 0.1 --set m=one"), "--set m is 'one'");
  expect_refused(shell.hmax(start + "--h 0.1 --material male_slm"), "did you mean 'male_slim'?");
  expect_refused(shell.hmax(start + "--h 0.1 --y0 1"), "--y0 has 1 numbers");
  expect_refused(shell.hmax(start + "--h 0.1 --y0 1,,2"), "a part is empty");
  expect_refused(shell.hmax(start + "--rtol 1e-3 --atol 1e-3 --control matlb"), "did you mean 'matlab'?");
  expect_refused(shell.hmax(start + "--step 0.1"), "unknown option '--step'");
  expect_refused(shell.hmax("run --method rk4 --h 0.1"), "--problem");
  expect_refused(shell.hmax("run --problem liver_forced --h 0.1"), "--method");
}

TEST(Run, RefusesFilesOfTheUserThatMakeNoSense) {
  const Shell shell;
  write_text(shell / "inconsistent.toml", "a = [[], [1]]\nb = [0.5, 0.25]\n");
  write_text(shell / "rows.toml", "a = [[], [1]]\nb = [0.5, 0.5]\nc = [0, 0.5]\n");
  write_text(shell / "key.toml", "a = [[]]\nb = [1]\nb_hatt = [1]\n");
  write_text(shell / "zero.toml", "[equations]\nx = \"1/x\"\n[initial]\nx = 0\n");
  write_text(shell / "garbage.toml", "[equations\n");
  const std::string run = "run --problem liver_forced --h 0.1 --tableau ";
  expect_refused(shell.hmax(run + "inconsistent.toml"), "not consistent");
  expect_refused(shell.hmax(run + "rows.toml"), "row 2 of a");
  expect_refused(shell.hmax(run + "key.toml"), "b_hat");
  expect_refused(shell.hmax(run + "absent.toml"), "absent.toml");
  expect_refused(shell.hmax(run + "rows.toml --method rk4"), "both given");
  expect_refused(shell.hmax("run --problem zero.toml --method rk4 --h 0.1"), "not finite at the start");
  expect_refused(shell.hmax("run --problem garbage.toml --method rk4 --h 0.1"), "garbage.toml");
  expect_refused(shell.hmax("run --problem absent.toml --method rk4 --h 0.1"), "absent.toml");
}

TEST(Run, RefusesAnOutputThatCannotBeWritten) {
  const Shell shell;
  write_text(shell / "file", "");
  const std::string run = "run --problem liver_forced --method rk4 --h 0.1 ";
  expect_refused(shell.hmax(run + "--output file/motion.csv"), "file/motion.csv");
  expect_refused(shell.hmax(run + "--output ."), "it is a folder");
  expect_refused(shell.hmax(run + "--output /dev/full"), "/dev/full");
  expect_refused(shell.hmax(run + "--every 1"), "--output");
  expect_refused(shell.hmax(run + "--output m.csv --every 0"), "--every");
  expect_refused(shell.hmax(run + "--output m.csv --every 1e-9"), "points");
  EXPECT_FALSE(std::filesystem::exists(shell / "m.csv"));
}

TEST(Run, ListsTheParametersThatActAndSaysWhichDoNot) {
  const Shell shell;
  const auto first_line = [](const Told& told) { return told.out.substr(0, told.out.find('\n')); };
  const Told linear = shell.hmax("run --problem liver_linear --method rk4 --h 0.5");
  EXPECT_EQ(first_line(linear), "liver_linear with m=1.45 c=0.3 k1=5.3");
  EXPECT_EQ(linear.err, "");
  const Told driven = shell.hmax("run --problem liver_linear --method rk4 --h 0.5 --set w=2");
  EXPECT_TRUE(says(driven.err, "w of --set changes nothing"));
  const std::string springs = "run --mesh phantom --model mass_spring --method rk4 --h 0.001 --t-end 0.01 ";
  const Told plain = shell.hmax(springs);
  EXPECT_FALSE(says(first_line(plain), "nu=")) << plain.out;
  EXPECT_EQ(plain.err, "");
  expect_refused(shell.hmax(springs + "--set nu=0.3"), "nu does not act on mass_spring");
  const Told material = shell.hmax(springs + "--material male_slim");
  EXPECT_EQ(material.exit_code, 0);
  EXPECT_TRUE(says(material.err, "springs have 1/4 whatever the material says"));
}

TEST(Run, SaysWhenItsLimitOfNewtonIterationsIsTheCause) {
  const Shell shell;
  const std::string body =
      "run --mesh phantom --load press --h 0.01 --t-end 0.05 --newton-iterations 1 --method ";
  for (const char* method : {"newmark", "implicit_euler", "radau_iia_5"}) {
    const Told told = shell.hmax(body + method);
    EXPECT_EQ(told.exit_code, 1) << method;
    EXPECT_TRUE(says(told.out, "within 1 iteration; raise --newton-iterations"));
    EXPECT_FALSE(says(told.out, "smaller step"));
  }
  const Told adaptive = shell.hmax(
      "run --problem van_der_pol --method radau_iia_5 --rtol 1e-6 --atol 1e-6 --newton-iterations 1 --max-steps 1e5");
  EXPECT_EQ(adaptive.exit_code, 1);
  EXPECT_TRUE(says(adaptive.out, "--newton-iterations"));
}

TEST(Run, NamesTheElementThatInvertsWhereARunFails) {
  const Shell shell;
  for (const char* run :
       {"run --mesh ball:n=2 --set g=40 --t-end 2 --method sdirk_4 --h 0.02",
        "run --mesh cube:n=2 --load pull --set force=50 --t-end 2 --method symplectic_euler --h 0.005"}) {
    const Told told = shell.hmax(run);
    ASSERT_EQ(told.exit_code, 1) << told.out;
    EXPECT_TRUE(says(told.out, " is inverted at t = "));
    EXPECT_TRUE(
        says(told.out, "`hmax static` shows whether the load causes this, otherwise take a smaller step"));
  }
  // Without a body there is no element to name.
  const Told oscillator = shell.hmax("run --problem liver_linear --method rk4 --h 5 --t-end 1e5");
  ASSERT_EQ(oscillator.exit_code, 1);
  EXPECT_TRUE(says(oscillator.out, "; take a smaller step"));
}

TEST(Run, NamesAnOldJacobianAsAPossibleCause) {
  const Shell shell;
  const std::string run =
      "run --mesh cube:n=2 --load press --set force=8 --t-end 5 --method rosenbrock_23 --h 0.01 --jacobian ";
  const Told frozen = shell.hmax(run + "frozen");
  ASSERT_EQ(frozen.exit_code, 1) << frozen.out;
  EXPECT_TRUE(says(
      frozen.out, "or --jacobian exact, which tells whether the Jacobian of --jacobian frozen is the cause"));
  // It is: the advice leads to the end.
  EXPECT_EQ(shell.hmax(run + "exact").exit_code, 0);
}

TEST(Run, CountsNewtonIterationsOfTheMethodsWhoseLimitItTakes) {
  const Shell shell;
  for (const char* method : {"explicit_newmark", "newmark", "rk4", "rodas_4", "symplectic_euler"}) {
    const std::string run =
        std::string("run --problem liver_forced --h 0.1 --t-end 1 --json --method ") + method;
    const bool counts = shell.hmax(run).json().at("stats").at("newton") > 0;
    EXPECT_EQ(shell.hmax(run + " --newton-iterations 20").exit_code, counts ? 0 : 2) << method;
  }
}

TEST(Run, SeesABreathingBody) {
  double displacement[2]{};
  int i = 0;
  for (const char* method : {"ode113", "radau_iia_5"}) {
    displacement[i++] =
        Shell()
            .json(std::string(
                      "run --mesh phantom --load breathing --rtol 1e-4 --atol 1e-8 --t-end 4 --method ") +
                  method)
            .at("max_displacement");
  }
  EXPECT_NEAR(displacement[0], 0.5607e-3, 3e-6);
  EXPECT_NEAR(displacement[1], 0.5607e-3, 3e-6);
}

TEST(Run, TakesTheFirstAndTheLongestStep) {
  const Shell shell;
  const auto run = [&](const std::string& options) {
    return shell.hmax("run --problem liver_forced --method ode45 --t-end 10 --json " + options);
  };
  const Told told = run("--rtol 1e-3 --atol 1e-3 --h0 0.001 --h-max 0.01");
  ASSERT_EQ(told.exit_code, 0) << told.err;
  EXPECT_GE(told.json().at("stats").at("steps"), 1000);
  EXPECT_EQ(told.json().at("h0"), 0.001);
  EXPECT_EQ(told.json().at("h_max"), 0.01);
  expect_refused(run("--h 0.1 --h0 0.01"), "are for adaptive runs");
  expect_refused(run("--rtol 1e-3 --atol 1e-3 --h0 0.2 --h-max 0.1"), "above --h-max 0.1");
  expect_refused(run("--rtol 1e-3 --atol 1e-3 --h0 0"), "--h0 is 0 but must be");
  expect_refused(run("--rtol 1e-3 --atol 1e-3 --h-max -1"), "--h-max is -1 but must be");
  expect_refused(run("--rtol 1e-3 --atol 1e-3 --h0 11"), "--h0 is 11, above the length of the run, 10");
}

/// Steps of 0.05 s in which a hanging beam doubles its length: three stages that lie far apart share one
/// Jacobian.
TEST(Run, RadauSolvesStepsInWhichTheBodyDeformsFar) {
  const AnyJson told = Shell().json(
      "run --mesh beam:n=4 --model fem_neo_hookean --load gravity --set E=20000 --method radau_iia_5 --h 0.05 --t-end "
      "0.4");
  EXPECT_EQ(told.at("outcome"), "reached_end");
  EXPECT_LT(told.at("stats").at("newton_error"), 1e-9);
}

}  // namespace
}  // namespace hmax
