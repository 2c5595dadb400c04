#include <algorithm>
#include <cmath>
#include <complex>
#include <filesystem>
#include <numbers>

#include "tests/cli/program.hpp"

namespace hmax {
namespace {

using AnyJson = nlohmann::json;

AnyJson phase(const Shell& shell, const std::string& options) {
  return shell.json("phase --problem " + options);
}

std::vector<std::string> types_of(const AnyJson& document) {
  std::vector<std::string> types;
  for (const AnyJson& e : document.at("equilibria")) types.push_back(e.at("type"));
  return types;
}
using Types = std::vector<std::string>;

TEST(Phase, FindsTheDoubleWellAndSaysWhereItLooked) {
  const AnyJson document = phase(Shell(), "liver_cubic --set k1=-1 --set c=0.3");
  EXPECT_EQ(types_of(document), (Types{"stable_focus", "saddle", "stable_focus"}));
  EXPECT_NEAR(document.at("equilibria")[2].at("x").get<double>(), std::sqrt(1 / 0.8), 1e-14);
  EXPECT_TRUE(document.at("t").is_null());
  EXPECT_EQ(document.at("parameters").at("k1"), -1);
  EXPECT_EQ(document.at("states"), AnyJson({"x", "v"}));
  EXPECT_LT(document.at("window")[0].get<double>(), -1.1);
  EXPECT_GT(document.at("window")[1].get<double>(), 1.1);
}

TEST(Phase, SaysWhatItsSearchGuarantees) {
  const Shell shell;
  const std::string well = "liver_cubic --set k1=-1 --set c=0.3 ";
  const AnyJson all = phase(shell, well).at("search");
  EXPECT_EQ(all.at("degree"), 1);
  EXPECT_EQ(all.at("index_sum"), 1);
  EXPECT_EQ(all.at("cut_short"), false);
  EXPECT_TRUE(says(all.at("status").get<std::string>(), "missed only in groups"));
  const Told told = shell.hmax("phase --problem " + well);
  EXPECT_TRUE(says(told.out, "3 equilibria with x from"));
  // A window on whose border an equilibrium lies.
  const AnyJson edge = phase(shell, "liver_linear --window 0,1,-1,1").at("search");
  EXPECT_TRUE(edge.at("degree").is_null());
  EXPECT_TRUE(says(edge.at("status").get<std::string>(), "not defined"));
  const AnyJson map =
      phase(shell, "liver_cubic --set c=0.3 --method rk4 --h 2 --window -4,4,-4,4").at("fixed_point_search");
  EXPECT_EQ(map.at("index_sum"), map.at("degree")) << map;
}

TEST(Phase, FreezesADrivenProblemAndSaysSo) {
  const Shell shell;
  for (const double t : {0.0, 3.0}) {
    const AnyJson document = phase(shell, "liver_forced --at " + std::to_string(t));
    EXPECT_EQ(document.at("t"), t);
    ASSERT_EQ(document.at("remarks").size(), 1U);
    EXPECT_TRUE(says(document.at("remarks")[0].get<std::string>(), "driven"));
    ASSERT_EQ(document.at("equilibria").size(), 1U);
    const double x = document.at("equilibria")[0].at("x");
    EXPECT_NEAR(0.7 * x + 0.8 * x * x * x, 0.5 * std::cos(0.5 * t), 1e-14);
  }
  EXPECT_EQ(phase(shell, "liver_forced").at("t"), 0);
  expect_refused(shell.hmax("phase --problem liver_cubic --at 1"), "--at");
  expect_refused(shell.hmax("phase --problem liver_forced --at nan"), "--at");
}

TEST(Phase, ServesFirstOrderProblemsAndFormulas) {
  const Shell shell;
  EXPECT_EQ(types_of(phase(shell, "van_der_pol")), Types{"unstable_node"});
  EXPECT_EQ(types_of(phase(shell, "van_der_pol --set mu=1")), Types{"unstable_focus"});
  EXPECT_EQ(types_of(phase(shell, "van_der_pol --set mu=0")), Types{"centre"});
  // Lotka and Volterra: a saddle at (0, 0), a centre at (1, 1).
  write_text(
      shell / "prey.toml",
      "[equations]\nprey = \"prey*(1 - hunters)\"\nhunters = \"hunters*(prey - 1)\"\n[initial]\nprey = "
      "0.5\nhunters = 0.5\n");
  const AnyJson document = phase(shell, "prey.toml --window -0.5,3,-0.5,3");
  EXPECT_EQ(types_of(document), (Types{"saddle", "centre"}));
  EXPECT_EQ(document.at("states"), AnyJson({"prey", "hunters"}));
}

TEST(Phase, AnEmptyWindowIsAnAnswer) {
  const AnyJson document = phase(Shell(), "liver_cubic --window 1,2,1,2");
  EXPECT_TRUE(document.at("equilibria").empty());
  ASSERT_EQ(document.at("remarks").size(), 1U);
  EXPECT_TRUE(says(document.at("remarks")[0].get<std::string>(), "no equilibrium"));
}

TEST(Phase, DrawsItsFigure) {
  const Shell shell;
  const AnyJson document =
      phase(shell, "liver_cubic --set k1=-1 --set c=0.3 --window -2,2,-1.5,1.5 --output figure");
  EXPECT_EQ(document.at("figure"), "figure/phase.svg");
  const std::string script = read_text(shell / "figure/phase.gp"),
                    data = read_text(shell / "figure/phase.dat");
  for (const char* entry : {"nullcline", "stable focus", "saddle", "into the saddle", "from (0.5, 1)"})
    EXPECT_TRUE(says(script, entry));
  EXPECT_TRUE(says(data, "direction field"));
  EXPECT_TRUE(std::filesystem::exists(shell / "figure/phase.svg"));
}

TEST(Phase, TellsPeopleInATable) {
  const std::string told = Shell().text("phase --problem liver_cubic --set c=2");
  for (const char* text : {"stable_focus", "x [m]", "v [m/s]", "-0.68966 ± 0.084465i", "c=2"})
    EXPECT_TRUE(says(told, text));
}

TEST(Phase, RefusesWhatItCannotShow) {
  const Shell shell;
  expect_refused(shell.hmax("phase"), "no problem is given");
  expect_refused(shell.hmax("phase --problem lorenz"), "lorenz has 3 states");
  expect_refused(shell.hmax("phase --problem dahlquist"), "dahlquist has 1 state,");
  expect_refused(shell.hmax("phase --problem liver_cubic --set k2=1"), "unknown parameter 'k2'");
  expect_refused(shell.hmax("phase --problem liver_cubic --window 2,-2,0,1"), "--window goes from 2 to -2");
  expect_refused(shell.hmax("phase --problem liver_cubic --window 0,1,1,1"), "--window goes from 1 to 1");
  expect_refused(shell.hmax("phase --problem liver_cubic --window 0,1"), "four");
  expect_refused(shell.hmax("phase --problem liver_cubic --window 0,1,0,nan"), "nan");
  expect_refused(shell.hmax("phase --problem liver_cubic --window 0,1,0,inf"), "inf");
  expect_refused(shell.hmax("phase --problem liver_cubic --set m=0"), "mass must be positive");
  write_text(shell / "roots.toml", "[equations]\na = \"sqrt(a)\"\nb = \"a*b\"\n[initial]\na = 1\nb = 1\n");
  expect_refused(shell.hmax("phase --problem roots.toml --window -2,-1,0,1"), "not finite anywhere");
  // Where f is finite in a part of the window the rest is passed over.
  EXPECT_EQ(shell.hmax("phase --problem roots.toml --window -1,1,-1,1").exit_code, 0);
}

TEST(Phase, EulersRuleGoesToAndFroBeyondItsLimit) {
  const Shell shell;
  // z' = -z makes a plane of the line of y' = y (1 - y).
  write_text(shell / "logistic.toml",
             "[equations]\ny = \"y*(1-y)\"\nz = \"-z\"\n[initial]\ny = 0.5\nz = 0.5\n");
  const auto at = [&](const std::string& h) {
    return phase(shell, "logistic.toml --window -1,3,-1,1 --method explicit_euler --h " + h);
  };
  EXPECT_TRUE(at("1.9").at("period_two").empty());
  const double h = 2.2, root = std::sqrt(h * h - 4);
  const AnyJson document = at("2.2");
  ASSERT_EQ(document.at("period_two").size(), 1U);
  const AnyJson& pair = document.at("period_two")[0];
  EXPECT_NEAR(pair[0][0].get<double>(), (h + 2 - root) / (2 * h), 1e-11);
  EXPECT_NEAR(pair[1][0].get<double>(), (h + 2 + root) / (2 * h), 1e-11);
  EXPECT_EQ(document.at("period_two_types").size(), 1U);
  EXPECT_NEAR(std::abs(document.at("period_two_multipliers")[0][1][0].get<double>()),
              std::min(std::abs(5 - h * h), (1 - h) * (1 - h)), 1e-9);
}

TEST(Phase, ShowsWhatRungeAndKuttaAddToTheLiver) {
  const Shell shell;
  const AnyJson document =
      phase(shell, "liver_cubic --set c=0.3 --method rk4 --h 2 --window -4,4,-4,4 --output figure");
  EXPECT_EQ(document.at("method"), "rk4");
  EXPECT_EQ(document.at("h"), 2);
  EXPECT_EQ(document.at("fixed_points").size(), 5U);
  for (const AnyJson& point : document.at("fixed_points")) {
    EXPECT_EQ(point.at("spurious"), std::abs(point.at("x").get<double>()) > 0.1);
    EXPECT_EQ(point.at("multipliers").size(), 2U);
  }
  const std::string script = read_text(shell / "figure/map.gp");
  EXPECT_TRUE(says(script, "made by the method"));
  EXPECT_TRUE(says(script, "The method adds places of rest that the equation does not have"));
  const Told told =
      shell.hmax("phase --problem liver_cubic --set c=0.3 --method rk4 --h 2 --window -4,4,-4,4");
  EXPECT_TRUE(says(told.out, "no: spurious"));
  // An A-stable method rests where the equation rests.
  for (const char* method : {"implicit_euler", "trapezoidal"}) {
    const AnyJson implicit = phase(shell, std::string("liver_cubic --set c=0.3 --h 2 --method ") + method);
    ASSERT_EQ(implicit.at("fixed_points").size(), 1U) << method;
    EXPECT_EQ(implicit.at("fixed_points")[0].at("type"), "stable_focus");
  }
}

TEST(Phase, RefusesStepsThatAreNoMap) {
  const Shell shell;
  const std::string problem = "phase --problem liver_cubic ";
  expect_refused(shell.hmax(problem + "--method rk4 --h 0"), "the step is 0");
  expect_refused(shell.hmax(problem + "--method rk4 --h -1"), "the step is -1");
  expect_refused(shell.hmax(problem + "--method rk4"), "add --h");
  expect_refused(shell.hmax(problem + "--h 1"), "--method");
  expect_refused(shell.hmax(problem + "--method abm_pece_4 --h 1"), "remembers more than the last state");
  expect_refused(shell.hmax(problem + "--method ode113 --h 1"), "chooses its steps itself");
  expect_refused(shell.hmax(problem + "--method rk5 --h 1"), "unknown method 'rk5'");
}

const std::string ueda = "liver_forced --set m=1 --set c=0.05 --set k1=0 --set k3=1 --set w=1 ";

TEST(Phase, TellsChaosFromRepetition) {
  const Shell shell;
  const AnyJson chaos = phase(shell, ueda + "--set P=7.5 --poincare --periods 1000 --output figure");
  EXPECT_TRUE(chaos.at("period").is_null());
  EXPECT_GT(chaos.at("lyapunov").get<double>(), 0.08);
  for (const AnyJson& y : chaos.at("section")) EXPECT_LT(std::abs(y[0].get<double>()), 5);
  EXPECT_EQ(chaos.at("settling"), "chaotic");
  EXPECT_NEAR(chaos.at("drive_period").get<double>(), 2 * std::numbers::pi, 1e-14);
  EXPECT_EQ(chaos.at("figure"), "figure/poincare.svg");
  EXPECT_EQ(phase(shell, ueda + "--set P=5.75 --poincare --periods 100 --output three").at("period"), 3);
  // The way of a motion that repeats is drawn as a line, that of chaos is not.
  EXPECT_TRUE(says(read_text(shell / "three/poincare.gp"), "'motion'"));
  EXPECT_FALSE(says(read_text(shell / "figure/poincare.gp"), "'motion'"));
  EXPECT_EQ(phase(shell, "liver_forced --poincare --periods 100").at("period"), 1);
}

TEST(Phase, FindsAllMotionsOfOnePeriodAndSaysWhy) {
  const Shell shell;
  const auto found = [&](const std::string& options) {
    return phase(shell, "liver_forced --poincare --periods 300 --set m=1 " + options);
  };
  const AnyJson chaos = found("--set k3=1 --set c=0.05 --set k1=0 --set P=7.5 --set w=1");
  ASSERT_EQ(chaos.at("periodic").size(), 3U);
  EXPECT_NEAR(chaos.at("periodic")[1].at("x").get<double>(), 2.89136324, 1e-7);
  EXPECT_EQ(chaos.at("periodic")[1].at("index"), -1);
  EXPECT_EQ(chaos.at("search").at("index_sum"), 1);
  EXPECT_EQ(chaos.at("search").at("degree"), 1);
  const std::string wells = "--set k3=1 --set c=0.25 --set k1=-1 --set w=1 ";
  EXPECT_EQ(found(wells + "--set P=0.2").at("periodic").size(), 7U);
  // Around one of the wells alone.
  const AnyJson part = found(wells + "--set P=0.1 --window 0.5,1.5,-0.5,0.5");
  EXPECT_EQ(part.at("periodic").size(), 1U);
  EXPECT_EQ(part.at("search").at("window"), AnyJson({0.5, 1.5, -0.5, 0.5}));
  // Without force and damping every motion of the linear spring has its period.
  EXPECT_TRUE(found("--set c=0 --set k3=0 --set k1=1 --set P=0 --period 6.283185307179586")
                  .at("search")
                  .at("cut_short"));
}

/// Steps of order 8 that are short enough show what adaptive ones show; long ones of order 1 do not.
TEST(Phase, FollowsMotionsByStepsOfAMethod) {
  const Shell shell;
  const std::string diagram = ueda + "--bifurcation P --from 5.7 --to 5.8 --points 3 ";
  const AnyJson adaptive = phase(shell, diagram);
  const AnyJson fixed = phase(shell, diagram + "--method dop_853 --h 0.05");
  EXPECT_EQ(adaptive.at("method"), nullptr);
  EXPECT_EQ(fixed.at("tolerances"), nullptr);
  EXPECT_EQ(fixed.at("method"), "dop_853");
  EXPECT_EQ(fixed.at("h"), 0.05);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(fixed.at("columns")[i].at("period"), 3);
    EXPECT_EQ(adaptive.at("columns")[i].at("period"), 3);
  }
  EXPECT_TRUE(says(shell.hmax("phase --problem " + diagram + "--method dop_853 --h 0.05").out,
                   "motions: dop_853, steps of at most 0.05 s"));
  const AnyJson section = phase(shell, "liver_forced --poincare --periods 20 --method rk4 --h 0.1");
  EXPECT_EQ(section.at("period"), 1);
  EXPECT_EQ(section.at("method"), "rk4");
  // Undamped by the step: a liver that this size makes unstable.
  const Told unstable =
      shell.hmax("phase --problem liver_forced --poincare --method explicit_euler --h 4 --json");
  EXPECT_EQ(unstable.exit_code, 1);
  EXPECT_EQ(unstable.json().at("settling"), "diverges");
}

/// m x'' + c x' + k1 x = P cos(w t) forgets its start as exp(-c t / (2 m)), however small it moves.
TEST(Phase, AStiffLiverThatIsPushedIsNotChaotic) {
  const Shell shell;
  for (const char* stiffness : {"1e5", "1e7"}) {
    const AnyJson stiff =
        phase(shell, std::string("liver_forced --set w=3 --poincare --periods 300 --set k1=") + stiffness);
    EXPECT_EQ(stiff.at("period"), 1) << stiffness;
    EXPECT_NEAR(stiff.at("lyapunov").get<double>(), -1 / 1.45, stiff.at("lyapunov_error")) << stiffness;
    EXPECT_LT(stiff.at("tolerances").at("atol").get<double>(), 1e-15);
  }
  const AnyJson columns =
      phase(shell, "liver_forced --bifurcation k1 --from 1e4 --to 1e7 --points 4 --set w=3").at("columns");
  for (const AnyJson& column : columns) EXPECT_EQ(column.at("period"), 1) << column;
}

TEST(Phase, ASmallVibrationAboutAStaticLoadHasItsExponent) {
  const Shell shell;
  write_text(shell / "held.toml",
             "[equations]\nx = \"v\"\nv = \"0.3448 + 1e-9*cos(3*t) - 1.3793*v - 4.6207*x\"\n"
             "[initial]\nx = 0.0746\nv = 0\n");
  const AnyJson held = phase(shell, "held.toml --poincare --periods 100 --period 2.0943951023931953");
  EXPECT_NEAR(held.at("lyapunov").get<double>(), -1.3793 / 2, 0.05);
}

/// Neighbours meet within a period: the exponent is told to be below a bound, the multipliers below 1e-9.
TEST(Phase, ASlowForceGivesABoundOfTheExponent) {
  const Shell shell;
  const std::string slow = "liver_forced --set w=0.05 --poincare --periods 30 --skip 10";
  const AnyJson document = phase(shell, slow);
  EXPECT_TRUE(document.at("lyapunov").is_null());
  EXPECT_GT(document.at("lyapunov_below"), -1 / 1.45);
  EXPECT_LT(document.at("lyapunov_below"), -0.1);
  const std::string told = shell.text("phase --problem " + slow);
  EXPECT_TRUE(says(told, "largest Lyapunov exponent below -0.1"));
  EXPECT_TRUE(says(told, "below 1e-9, below 1e-9"));
}

/// Where the search gives up after 5000 steps a period the motion that is seen is listed all the same.
TEST(Phase, AMotionThatTakesManyStepsAPeriodIsListed) {
  const AnyJson document =
      phase(Shell(), "liver_forced --set P=1e6 --poincare --periods 20 --skip 20 --window 107,109,-221,-219");
  EXPECT_EQ(document.at("period"), 1);
  ASSERT_EQ(document.at("periodic").size(), 1U);
  EXPECT_NEAR(document.at("periodic")[0].at("x").get<double>(), document.at("section")[0][0], 1e-8);
  EXPECT_TRUE(says(document.at("search").at("status").get<std::string>(), "more than 5000 steps a period"));
  // Of this one only neighbours do.
  const AnyJson stiff = phase(Shell(), "liver_forced --set k1=1e6 --set w=3 --poincare --periods 20");
  EXPECT_EQ(stiff.at("periodic").size(), 1U);
}

TEST(Phase, DrawsTheBifurcationsOfADrivenLiver) {
  const Shell shell;
  const AnyJson document =
      phase(shell, ueda + "--bifurcation P --from 5.7 --to 7.5 --points 3 --output figure --follow");
  ASSERT_EQ(document.at("columns").size(), 3U);
  EXPECT_EQ(document.at("parameter"), "P");
  EXPECT_FALSE(document.at("parameters").contains("P"));
  EXPECT_EQ(document.at("columns")[0].at("period"), 3);
  EXPECT_TRUE(document.at("columns")[2].at("period").is_null());
  EXPECT_DOUBLE_EQ(document.at("columns")[1].at("value").get<double>(), 6.6);
  EXPECT_EQ(document.at("columns")[2].at("x").size(), 64U);
  EXPECT_TRUE(says(read_text(shell / "figure/bifurcation.gp"), "chaotic"));
  EXPECT_TRUE(says(read_text(shell / "figure/bifurcation.gp"), "'P [N]'"));
  EXPECT_EQ(document.at("columns")[2].at("status"), "chaotic");
  EXPECT_GT(document.at("columns")[2].at("lyapunov"), document.at("columns")[2].at("lyapunov_error"));
  // Over the damping: what is fed grows without bound.
  const AnyJson damping = phase(shell, "liver_forced --bifurcation c --from -1 --to 2 --points 2");
  EXPECT_EQ(damping.at("columns")[0].at("status"), "diverges");
  EXPECT_EQ(damping.at("columns")[1].at("period"), 1);
  // From no force on, looked at in the period of the force.
  const AnyJson force = phase(shell, "liver_forced --bifurcation P --from 0 --to 1 --points 2");
  EXPECT_EQ(force.at("columns")[0].at("period"), 1);
  EXPECT_EQ(force.at("columns")[1].at("period"), 1);
  const AnyJson dying = phase(shell, ueda + "--bifurcation P --from 0 --to 8 --points 3");
  EXPECT_EQ(dying.at("tolerances").at("atol"), 1e-11);
}

TEST(Phase, LooksAtFormulasOnceInTheirPeriod) {
  const Shell shell;
  write_text(shell / "swing.toml",
             "[equations]\na = \"b\"\nb = \"-a - 0.5*b + cos(2*t)\"\n[initial]\na = 0\nb = 0\n");
  const AnyJson document = phase(shell, "swing.toml --poincare --periods 20 --period 3.141592653589793");
  const std::complex<double> Z = 1.0 / std::complex<double>(-3, 1);
  EXPECT_NEAR(document.at("section")[3][0].get<double>(), Z.real(), 1e-9);
  // In words its one look is one row: a = -3/10, b = -2 Im Z = 1/5.
  const Told told =
      shell.hmax("phase --problem swing.toml --poincare --periods 20 --period 3.141592653589793");
  EXPECT_TRUE(says(told.out, "\n\nlook     a    b\n1     -0.3  0.2\n\n"));
  expect_refused(shell.hmax("phase --problem swing.toml --poincare"), "name it with --period");
  expect_refused(shell.hmax("phase --problem swing.toml --poincare --period 3"), "not the same 3 s later");
}

TEST(Phase, RefusesLooksThatSayNothing) {
  const Shell shell;
  expect_refused(shell.hmax("phase --problem liver_cubic --poincare"), "is not driven");
  expect_refused(shell.hmax("phase --problem liver_forced --poincare --periods 0"), "--periods");
  expect_refused(shell.hmax("phase --problem liver_forced --poincare --skip -1"), "--skip");
  expect_refused(shell.hmax("phase --problem liver_forced --poincare --period 0"), "--period is 0");
  expect_refused(shell.hmax("phase --problem liver_forced --poincare --h 1"), "--method");
  expect_refused(shell.hmax("phase --problem liver_forced --poincare --method rk4"), "--h");
  expect_refused(shell.hmax("phase --problem liver_forced --poincare --method rk4 --h 0"), "positive");
  expect_refused(
      shell.hmax("phase --problem liver_forced --bifurcation P --from 0 --to 1 --method ode113 --h 1"),
      "chooses its steps itself");
  expect_refused(shell.hmax("phase --problem liver_forced --poincare --at 1"), "--at");
  expect_refused(shell.hmax("phase --problem liver_forced --bifurcation P --window 0,1,0,1"), "--window");
  expect_refused(shell.hmax("phase --problem liver_forced --skip 3"), "--poincare");
  expect_refused(shell.hmax("phase --problem liver_forced --time-limit 9"), "--poincare");
  expect_refused(shell.hmax("phase --problem liver_forced --from 3"), "--bifurcation");
  expect_refused(shell.hmax("phase --problem liver_forced --bifurcation P --from 3"), "--to");
  expect_refused(shell.hmax("phase --problem liver_forced --bifurcation P --from 3 --to 3"), "no range");
  expect_refused(shell.hmax("phase --problem liver_forced --bifurcation P --from 0 --to 1 --set P=9"),
                 "--bifurcation varies P, and 9 is given for it");
  expect_refused(shell.hmax("phase --problem liver_forced --bifurcation Q --from 3 --to 4"), "parameter 'Q'");
  expect_refused(shell.hmax("phase --problem lorenz --poincare --period 1"), "lorenz has 3 states");
  const Told runaway = shell.hmax("phase --problem liver_forced --set c=-3 --poincare --json");
  EXPECT_EQ(runaway.exit_code, 1);
  EXPECT_TRUE(says(runaway.json().at("status").get<std::string>(), "diverges"));
}

/// x' = v, v' = `force`.
void write_oscillator(const Shell& shell, const std::string& force) {
  write_text(shell / "own.toml", "[equations]\nx = \"v\"\nv = \"" + force + "\"\n[initial]\nx = 1\nv = 0\n");
}

TEST(Phase, AStableKinkHasABasin) {
  const Shell shell;
  write_oscillator(shell, "-x - 0.5*abs(x) - v");
  const std::string basins = "own.toml --window -2,2,-2,2 --basins --cells 6";
  const AnyJson document = phase(shell, basins);
  EXPECT_EQ(types_of(document), Types{"stable_focus"});
  EXPECT_EQ(document.at("equilibria")[0].at("kink"), true);
  EXPECT_EQ(document.at("attractors")[0].at("share"), 1);
  EXPECT_EQ(document.at("undecided"), 0);
  EXPECT_TRUE(says(document.at("remarks")[0].get<std::string>(), "kink"));
  EXPECT_TRUE(says(shell.hmax("phase --problem " + basins).out, "stable_focus, kink"));
  // A saddle on the left of it.
  write_oscillator(shell, "-abs(x) - v");
  const AnyJson search = phase(shell, "own.toml --window -2,2,-2,2").at("search");
  EXPECT_EQ(search.at("index_sum"), 0);
  EXPECT_EQ(search.at("degree"), 0);
  expect_refused(shell.hmax("phase --problem " + basins), "nothing has a basin");
}

/// On the stiff side a motion that is bound for the other focus turns within a thousandth of the window.
TEST(Phase, APassingMotionIsNotHeldByAStiffKink) {
  const Shell shell;
  for (const char* wall : {"x", "x - 1e-5", "x - 3e-3"}) {  // in the equilibrium, beside it
    write_oscillator(shell, std::string("-x*(1+x)*(1+x/3) - 1e6*max(") + wall + ",0) - 0.02*v");
    const AnyJson document = phase(shell, "own.toml --window=-4,1,-3,3 --basins --cells 10");
    EXPECT_EQ(document.at("undecided"), 0);
    EXPECT_EQ(document.at("attractors").at(0).at("x"), -3);
    EXPECT_GT(document.at("attractors").at(0).at("share"), 0.8) << wall;  // 0.87 of 300 starts
  }
}

/// Between saddles at 1e-6 all comes to rest: two thirds of the window, as of one of metres.
TEST(Phase, BasinsOfMicrometresAreFound) {
  const Shell shell;
  write_oscillator(shell, "-1e6*x*(1-(x/1e-6)^2) - 10*v");
  const AnyJson small = phase(shell, "own.toml --window=-1.5e-6,1.5e-6,-1.5e-6,1.5e-6 --basins --cells 12");
  EXPECT_NEAR(small.at("attractors").at(0).at("share").get<double>(), 2.0 / 3, 1e-9);
  EXPECT_EQ(small.at("undecided"), 0);
}

/// The manifolds leave the saddle as exp(0.93 w t): at the end of 2 s they have not left it, nor in 100 s
/// where w is small.
TEST(Phase, AShortProblemHasTheManifoldsOfItsSaddles) {
  const Shell shell;
  const auto longest = [&](const std::string& w, const std::string& end = "") {
    write_text(shell / "own.toml", "[equations]\nx = \"v\"\nv = \"" + w + "^2*x*(1-x^2)-0.15*" + w +
                                       "*v\"\n[initial]\nx = 1\nv = 0\n" + end);
    phase(shell, "own.toml --window=-2,2,-" + w + "," + w + " --output ways");
    std::istringstream drawn(read_text(shell / "ways/phase.dat"));
    double reach = 0;
    bool inside = false;
    for (std::string line; std::getline(drawn, line);) {
      if (says(line, "#")) inside = says(line, "the saddle");
      double x = 0;
      if (inside && std::istringstream(line) >> x) reach = std::max(reach, std::abs(x));
    }
    return reach;
  };
  EXPECT_GT(longest("1"), 1);
  EXPECT_GT(longest("1", "[problem]\nt_end = 2\n"), 1);
  EXPECT_GT(longest("1e-8"), 1);
}

/// 5 (x > 1) - x - v jumps, and 1/x has a pole: there the degree is no sum of indices.
TEST(Phase, SaysThatAFieldThatJumpsHasNoDegree) {
  const Shell shell;
  write_oscillator(shell, "-x+(x>1?1:0)*5-v");
  const AnyJson search = phase(shell, "own.toml --window=-1,8,-2,2").at("search");
  EXPECT_TRUE(says(search.at("status").get<std::string>(), "or the field jumps or is not finite inside"))
      << search;
}

TEST(Phase, NamesNarrowWindowsAndShortensLongLists) {
  const Shell shell;
  write_oscillator(shell, "1e6 - x - v");
  EXPECT_TRUE(says(shell.hmax("phase --problem own.toml --window 999999.5,1000000.5,-1,1").out,
                   "x from 999999.5 to 1000000.5 and v from -1 to 1"));
  write_text(shell / "still.toml", "[equations]\nx = \"0*x\"\nv = \"0*v\"\n[initial]\nx = 1\nv = 0\n");
  const std::string still = shell.hmax("phase --problem still.toml --window=-1,1,-1,1").out;
  EXPECT_LT(std::ranges::count(still, '\n'), 40);
  EXPECT_TRUE(says(still, "more, all with --json"));
  EXPECT_TRUE(says(still, "unless they make a line"));
}

TEST(Phase, AKinkThatIsASaddleHasFourWaysOfItsOwn) {
  const Shell shell;
  write_oscillator(shell, "x + 3*max(x,0) - 0.3*v - x^3");
  phase(shell, "own.toml --window -3,3,-3,3 --output ways");
  std::istringstream drawn(read_text(shell / "ways/phase.dat"));
  std::vector<double> slopes;
  for (std::string line; std::getline(drawn, line);)
    if (says(line, "the saddle")) {
      double x = 0, v = 0;
      drawn >> x >> v;
      slopes.push_back(std::round(100 * v / x) / 100);
    }
  // v = s x with s^2 + 0.3 s = 1 on the left and 4 on the right.
  std::ranges::sort(slopes);
  EXPECT_EQ(slopes, (std::vector{-2.16, -1.16, 0.86, 1.86}));
}

/// Weak damping that changes its sign with the amplitude: an unstable cycle at 0.75, a stable one at 9.75 by
/// averaging, far within a thousandth of the window, or far from the origin.
TEST(Phase, CyclesWithinAThousandthOfTheWindowAreNoRest) {
  const Shell shell;
  write_oscillator(shell, "-x - 0.02*v*(1 - 12*x^2/(1 + x^2)^2)");
  const AnyJson wide = phase(shell, "own.toml --window=-1e4,1e4,-1e4,1e4 --basins --cells 6");
  EXPECT_EQ(wide.at("attractors").at(0).at("share"), 0);
  write_oscillator(shell, "-(x - 1e5) - v*(1 - 12*(2e3*(x - 1e5))^2/(1 + (2e3*(x - 1e5))^2)^2)");
  const AnyJson far = phase(shell, "own.toml --window 99995.05,100004.95,-4.95,4.95 --basins --cells 6");
  EXPECT_EQ(far.at("attractors").at(0).at("share"), 0);
  EXPECT_EQ(far.at("unbounded"), 0);
}

/// The root ends at 0, where motions go that begin below 1.
TEST(Phase, MotionsThatEndWhereTheFieldDoesHaveABound) {
  const Shell shell;
  write_text(shell / "own.toml",
             "[equations]\nx = \"(sqrt(x)-1)*(2-x)\"\nv = \"-v\"\n[initial]\nx = 1\nv = 0\n");
  const AnyJson ended = phase(shell, "own.toml --window 0.001,3,-1,1 --basins --cells 10");
  EXPECT_EQ(ended.at("unbounded"), 0);
  EXPECT_NEAR(ended.at("undecided").get<double>(), 0.3, 1e-9);
}

/// A jump of the damping is small beside the stiffness, and bends beside a kink are none of its damping.
TEST(Phase, WeakKinksOfTheDampingAreJudged) {
  const Shell shell;
  const auto rest = [&](const std::string& force, const std::string& window) {
    write_oscillator(shell, force);
    return phase(shell, "own.toml --window=" + window).at("equilibria").at(0);
  };
  const auto rate = [](const AnyJson& e) { return e.at("eigenvalues")[0][0].get<double>(); };
  const AnyJson weak = rest("-x + 3e-7*v - 4e-7*max(v,0)", "-1,1,-1,1");
  EXPECT_EQ(weak.at("type"), "unstable_focus");
  EXPECT_NEAR(rate(weak), 5e-8, 1e-9);
  EXPECT_NEAR(rate(rest("-1e12*x + 0.1*v - 0.4*max(v,0)", "-1,1,-1,1")), -0.05, 1e-3);
  EXPECT_EQ(rest("-(x-0.7) - 0.5*abs(x-0.7) + 10*(x-0.7)*v", "-1,2,-1,1").at("type"), "centre");
  const AnyJson bent = rest("-(x-0.7) - 0.5*abs(x-0.7) + 1000*(x-0.7)*v + 1e-7*v", "0.2,1.2,-1,1");
  EXPECT_EQ(bent.at("type"), "unstable_focus");
  EXPECT_NEAR(rate(bent), 5e-8, 5e-9);
}

/// Also where these are less than 1e-7 of the window apart.
TEST(Phase, StepsRestWhereTheFieldDoes) {
  const Shell shell;
  write_oscillator(shell, "-x*(x-1e-6)*(x+3) - v");
  const AnyJson map = phase(shell, "own.toml --window=-20,20,-20,20 --method rk4 --h 0.1");
  const AnyJson &rests = map.at("equilibria"), &fixed = map.at("fixed_points");
  ASSERT_EQ(rests.size(), 3U);
  ASSERT_EQ(fixed.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(fixed[i].at("x"), rests[i].at("x"));
    EXPECT_EQ(fixed[i].at("type"), rests[i].at("type"));
  }
  EXPECT_EQ(map.at("fixed_point_search").at("index_sum"), 1);
}

TEST(Phase, FixedPointsFarFromZeroAreFound) {
  const Shell shell;
  write_oscillator(shell, "1e6 - x - v");
  const AnyJson map = phase(shell, "own.toml --window 0,2e6,-1e6,1e6 --method rk4 --h 0.1");
  ASSERT_EQ(map.at("fixed_points").size(), 1U);
  EXPECT_EQ(map.at("fixed_points")[0].at("spurious"), false);
  EXPECT_NEAR(map.at("fixed_points")[0].at("x").get<double>(), 1e6, 1e-4);
  EXPECT_NEAR(map.at("equilibria")[0].at("x").get<double>(), 1e6, 1e-9);
  write_oscillator(shell, "1e6 - x - v + cos(t)");
  const AnyJson section =
      phase(shell, "own.toml --poincare --periods 20 --period 6.283185307179586 --window 0,2e6,-1e6,1e6");
  EXPECT_EQ(section.at("periodic").size(), 1U);
}

TEST(Phase, AStripThatStiffensHasOneEquilibriumInAnyWindow) {
  const Shell shell;
  write_oscillator(shell, "9.81 - (0.4*v + 40*x*exp(x/0.02)) / 0.1");
  for (const char* window : {"-0.1,0.1,-1,1", "-1,1,-1,1", "-5,5,-100,100"}) {
    const AnyJson document = phase(shell, std::string("own.toml --window ") + window);
    EXPECT_EQ(types_of(document), Types{"stable_focus"}) << window;
    EXPECT_EQ(document.at("search").at("cut_short"), false) << window;
  }
}

TEST(Phase, TheBasinsOfTheDoubleWellMirrorEachOther) {
  const Shell shell;
  const AnyJson document = phase(
      shell, "liver_cubic --set k1=-1 --set c=0.2 --basins --cells 40 --window -3,3,-3,3 --output figure");
  ASSERT_EQ(document.at("attractors").size(), 2U);
  for (const AnyJson& attractor : document.at("attractors")) {
    EXPECT_EQ(attractor.at("share"), 0.5);
    EXPECT_EQ(attractor.at("type"), "stable_focus");
  }
  EXPECT_EQ(document.at("undecided"), 0);
  EXPECT_EQ(document.at("unbounded"), 0);
  EXPECT_EQ(document.at("cells"), AnyJson({40, 30}));
  EXPECT_EQ(types_of(document).size(), 3U);
  EXPECT_TRUE(says(read_text(shell / "figure/basins.gp"), "boxxyerror"));
}

TEST(Phase, RunsMotionsOnAGpuWithTheSameBitsOrSaysWhyNot) {
  const Shell shell;
  for (
      const std::string asked :
      {"phase --problem liver_cubic --set k1=-1 --set c=0.2 --basins --cells 40 --window -3,3,-3,3 --json",
       "phase --problem liver_forced --bifurcation P --from 5 --to 8 --points 6 --json",
       "phase --problem liver_forced --bifurcation P --from 5 --to 8 --points 6 --method rk4 --h 0.1 --json"}) {
    const Told told = shell.hmax(asked + " --device gpu");
    if (told.exit_code == 0) {
      AnyJson on_gpu = told.json();
      EXPECT_GT(on_gpu.at("device_seconds"), 0);
      for (const char* key : {"device", "clock_mhz", "driver", "precision", "device_seconds"})
        on_gpu.erase(key);
      EXPECT_EQ(on_gpu, shell.json(asked));
    } else {
      expect_refused(told, "leave out --device");
    }
  }
  expect_refused(shell.hmax("phase --problem liver_cubic --device gpu"), "--bifurcation");
  expect_refused(shell.hmax("phase --problem liver_forced --poincare --device gpu"), "--poincare");
  expect_refused(shell.hmax("phase --problem liver_cubic --device tpu"), "--device");
}

TEST(Phase, BasinsHaveTheRowsThatAreAskedFor) {
  const Shell shell;
  const std::string basins = "liver_cubic --set k1=-1 --set c=0.5 --basins --window -3,3,-3,3 --cells ";
  EXPECT_EQ(phase(shell, basins + "6").at("cells"), AnyJson({6, 5}));
  EXPECT_EQ(phase(shell, basins + "4,7").at("cells"), AnyJson({4, 7}));
}

/// A linear liver comes to rest from everywhere; a softening one breaks beyond its saddles, where the energy
/// of the undamped motion says it must.
TEST(Phase, BasinsEndWhereTheMotionBreaksAway) {
  const Shell shell;
  const AnyJson linear = phase(shell, "liver_linear --basins --cells 10 --window -5,5,-5,5");
  EXPECT_EQ(linear.at("attractors")[0].at("share"), 1);
  const std::string soft = "liver_cubic --set k1=1 --set k3=-1 --set c=0.5 --basins --cells 10 --window ";
  // Within the lobe of the energy 1/4 of the saddles at (+-1, 0) nothing escapes.
  EXPECT_EQ(phase(shell, soft + "-0.4,0.4,-0.4,0.4").at("attractors")[0].at("share"), 1);
  const AnyJson wide = phase(shell, soft + "-3,3,-3,3");
  EXPECT_GT(wide.at("unbounded").get<double>(), 0.5);
  EXPECT_GT(wide.at("attractors")[0].at("share").get<double>(), 0);
}

TEST(Phase, RefusesBasinsOfNothing) {
  const Shell shell;
  expect_refused(shell.hmax("phase --problem liver_forced --basins"), "driven");
  expect_refused(shell.hmax("phase --problem van_der_pol --basins"), "nothing has a basin");
  expect_refused(shell.hmax("phase --problem liver_cubic --set c=0 --basins"),
                 "look elsewhere with --window");
  expect_refused(
      shell.hmax("phase --problem liver_cubic --set k1=-1 --basins --window=-1e60,1e60,-1e60,1e60"),
      "some may have been missed: narrow --window");
  expect_refused(shell.hmax("phase --problem liver_cubic --basins --cells 1"), "--cells");
  expect_refused(shell.hmax("phase --problem liver_cubic --basins --cells 1e6"), "--cells");
  expect_refused(shell.hmax("phase --problem liver_cubic --basins --cells 10,"), "--cells");
  expect_refused(shell.hmax("phase --problem liver_cubic --basins --cells 10,1"), "--cells");
  expect_refused(shell.hmax("phase --problem liver_cubic --basins --cells 10,20,30"), "--cells");
  expect_refused(shell.hmax("phase --problem liver_cubic --basins --cells 10,1e6"), "--cells");
  expect_refused(shell.hmax("phase --problem liver_cubic --basins --cells 4001 --output figure"), "4000");
  expect_refused(shell.hmax("phase --problem liver_cubic --cells 10"), "--basins");
  expect_refused(shell.hmax("phase --problem liver_cubic --basins --poincare"), "one of them");
}

TEST(Phase, StatesTheTolerancesOfMotions) {
  const Shell shell;
  const auto both = [](double rtol, double atol) { return AnyJson{{"rtol", rtol}, {"atol", atol}}; };
  EXPECT_EQ(phase(shell, "liver_cubic").at("tolerances"), both(1e-6, 1e-8));
  const std::string basins = "liver_cubic --set k1=-1 --set c=0.5 --basins --cells 4 --window -3,3,-3,3";
  EXPECT_EQ(phase(shell, basins).at("tolerances"), both(1e-8, 1e-10));
  const std::string poincare = "liver_forced --poincare --periods 20";
  EXPECT_EQ(phase(shell, poincare).at("tolerances"), both(1e-11, 1e-11));
  EXPECT_TRUE(says(shell.hmax("phase --problem " + basins).out, "motions: rtol 1e-08, atol 1e-10"));
  EXPECT_TRUE(says(shell.hmax("phase --problem " + poincare).out, "motions: rtol 1e-11, atol 1e-11"));
  const std::string help = shell.hmax("phase --help").out;
  for (const char* words : {"rtol 1e-06", "rtol 1e-08", "rtol 1e-11"}) EXPECT_TRUE(says(help, words));
}

/// Every view under one heading, and the options of one view under that of theirs.
TEST(Phase, HelpGroupsOptionsByView) {
  const std::string help = Shell().hmax("phase --help").out;
  std::size_t before = 0;
  for (const char* line :
       {"\nModel:", "--problem", "\nViews, one at a time", "--method", "--basins", "--poincare",
        "--bifurcation", "\nPart of the plane:", "--window",
        "\nWith --poincare and --bifurcation:", "--periods", "\nWith --bifurcation:", "--from"}) {
    const std::size_t at = help.find(line, before);
    ASSERT_NE(at, std::string::npos) << line << help;
    before = at;
  }
}

/// Of the options that choose a problem: a body on a mesh has no two states, matrices may.
TEST(Phase, OffersNoOptionThatCannotWork) {
  const Shell shell;
  const std::string help = shell.hmax("phase --help").out;
  for (const char* option :
       {"--mesh", "--unit", "--model", "--load", "--gravity", "--support", "--tool-at", "--tool-direction"})
    EXPECT_FALSE(says(help, option));
  write_text(shell / "K.mtx", "%%MatrixMarket matrix coordinate real symmetric\n1 1 1\n1 1 4\n");
  write_text(shell / "M.mtx", "%%MatrixMarket matrix coordinate real symmetric\n1 1 1\n1 1 1\n");
  const AnyJson spring = shell.json("phase --matrices stiffness=K.mtx,mass=M.mtx --alpha 0.4");
  // lambda^2 + 0.4 lambda + 4 = 0
  ASSERT_EQ(spring.at("equilibria").size(), 1U);
  EXPECT_NEAR(spring.at("equilibria")[0].at("eigenvalues")[0][0].get<double>(), -0.2, 1e-9);
  EXPECT_NEAR(std::abs(spring.at("equilibria")[0].at("eigenvalues")[0][1].get<double>()), std::sqrt(4 - 0.04),
              1e-9);
}

TEST(PhaseCommand, AWindowBeyondTheRangeOfNumbersIsRefused) {
  const Shell shell;
  for (const char* view : {"", " --poincare --periods 5 --skip 1", " --method rk4 --h 1"})
    for (const char* bounds : {"-1e308,1e308,-1e308,1e308", "-1,1,0,1e200"})
      expect_refused(shell.hmax(std::string("phase --problem liver_forced --window=") + bounds + view),
                     "give numbers within +-1e+150");
  for (const char* start : {"1e308,1e308", "-1e308,1e308", "0,1e308"}) {
    const std::string y0 = std::string(" --y0=") + start;
    expect_refused(shell.hmax("phase --problem liver_cubic" + y0), "which is beyond 1e+150");
    expect_refused(shell.hmax("phase --problem liver_forced --poincare --periods 5 --skip 1" + y0),
                   "which is beyond 1e+150");
  }
}

}  // namespace
}  // namespace hmax
