/// hmax --scene
#include <cmath>

#include <gtest/gtest.h>

#include "tests/cli/program.hpp"

namespace hmax {
namespace {

std::string bar(const std::string& dynamic, const std::string& damping = "") {
  return "*NODE\n1,0,0,0\n2,10,0,0\n3,0,10,0\n4,0,0,10\n5,10,10,10\n"
         "*ELEMENT, TYPE=C3D4, ELSET=ALL\n1,1,2,3,4\n2,2,3,4,5\n"
         "*NSET, NSET=FIX\n1,2,3\n*MATERIAL, NAME=M\n*ELASTIC\n0.01,0.3\n*DENSITY\n1e-9\n" +
         damping + "*SOLID SECTION, ELSET=ALL, MATERIAL=M\n*BOUNDARY\nFIX,1,3\n*STEP\n" + dynamic +
         "\n*END STEP\n";
}

const std::string implicit = "EulerImplicitSolver rayleighMass=\"0\" rayleighStiffness=\"0\"";

/// A scene with another text in place of one that it has.
void change(Shell& shell, const char* file, const std::string& what, const std::string& by) {
  std::string text = read_text(shell / file);
  ASSERT_NE(text.find(what), std::string::npos) << what;
  write_text(shell / file, text.replace(text.find(what), what.size(), by));
}

TEST(StabilityOfScenes, SpeaksOfTheirIntegratorAndStep) {
  Shell shell;
  write_text(shell / "bar.inp", bar("*DYNAMIC, EXPLICIT\n0.1,1"));
  const std::string predict = "stability predict --scene bar.inp --unit mm,t,s";
  const auto document = shell.hmax(predict + " --json").json();
  const double h_max = document.at("rows").at(0).at("h_max");
  EXPECT_EQ(document["rows"][0]["method"], "symplectic_euler");
  EXPECT_EQ(document["scene"]["h"], 0.1);
  EXPECT_EQ(document["scene"]["h_max"], h_max);
  EXPECT_EQ(document["scene"]["within"], false);
  EXPECT_TRUE(says(shell.hmax(predict).out,
                   "the step of 0.1 s with *DYNAMIC, EXPLICIT (symplectic_euler) is unstable: at most"));

  // The same body by the mesh of the file.
  const auto same = shell.hmax(
      "stability predict --mesh bar.inp --unit mm --model fem_cauchy --set E=1e4 --set nu=0.3 "
      "--set rho=1000 --support fix --method symplectic_euler --json");
  EXPECT_EQ(same.exit_code, 2) << "names of files are in capitals";
  const auto again = shell.hmax(
      "stability predict --mesh bar.inp --unit mm --model fem_cauchy --set E=1e4 --set nu=0.3 "
      "--set rho=1000 --set g=0 --support FIX --method symplectic_euler --json");
  EXPECT_NEAR(again.json()["rows"][0]["h_max"], h_max, 1e-9 * h_max);

  write_text(shell / "bar.inp", bar("*DYNAMIC, EXPLICIT\n" + std::to_string(0.9 * h_max) + ",1"));
  EXPECT_TRUE(says(shell.hmax(predict).out, "is below the limit"));
  // Abaqus/Explicit takes damping at the velocities of half a step before.
  write_text(shell / "bar.inp", bar("*DYNAMIC, EXPLICIT\n0.1,1", "*DAMPING, ALPHA=0, BETA=2e-3\n"));
  const auto damped = shell.hmax(predict + " --json").json()["rows"][0];
  const double omega = 2 / h_max, zeta = 1e-3 * omega;
  EXPECT_NEAR(damped["h_max"], 2 / omega * (std::sqrt(1 + zeta * zeta) - zeta), 1e-6 * h_max);

  write_text(shell / "bar.inp", bar("*DYNAMIC\n0.1,1"));
  EXPECT_TRUE(says(shell.hmax(predict).out, "(hht_alpha:alpha=-0.05) has no limit of stability"));
  EXPECT_EQ(shell.hmax(predict + " --method rk4 --json").json().count("scene"), 0U);
  write_text(shell / "bar.inp", bar("*STATIC"));
  expect_refused(shell.hmax(predict), "has no integrator");
}

TEST(StabilityOfScenes, OfSofaHaveTheLimitOfTheBodyThatWasWritten) {
  Shell shell;
  const std::string body = " --support 'z<0.01' --material tissue:liver --model fem_corotational ";
  ASSERT_EQ(shell.hmax("mesh convert phantom gel.scn --h 0.01 --gravity 0,0,-9.81" + body).exit_code, 0);
  const std::string predict = "stability predict --scene gel.scn --unit m,kg,s";
  EXPECT_TRUE(says(shell.hmax(predict).out,
                   "the step of 0.01 s with EulerImplicitSolver (linearly_implicit_euler) has no limit of"));
  change(shell, "gel.scn", implicit, "EulerExplicitSolver");
  const auto document = shell.hmax(predict + " --json").json();
  const double h_max = document["rows"][0]["h_max"];
  EXPECT_NEAR(shell.hmax("stability predict --mesh phantom --method symplectic_euler --json" + body)
                  .json()["rows"][0]["h_max"],
              h_max, 1e-6 * h_max);
  EXPECT_EQ(document["scene"]["integrator"], "EulerExplicitSolver");
  EXPECT_EQ(document["scene"]["within"], false);
  EXPECT_TRUE(says(shell.hmax(predict).out,
                   "the step of 0.01 s with EulerExplicitSolver (symplectic_euler) is unstable: at most"));
}

TEST(StabilityOfScenes, NameLinearOnlyWhereItIsAnOption) {
  Shell shell;
  const std::string scene = " --scene gel.scn --unit m,kg,s";
  ASSERT_EQ(shell.hmax("mesh convert cube:n=2 gel.scn --h 0.01").exit_code, 0);
  const auto told = [&](const std::string& command) {
    const Told answer = shell.hmax(command + scene);
    EXPECT_EQ(answer.exit_code, 0) << answer.err;
    EXPECT_TRUE(says(answer.err, "by up to 1000 conjugate gradients")) << command;
    return says(answer.err, "--linear cg:TOLERANCE,1000 does");
  };
  EXPECT_TRUE(told("stability predict"));
  EXPECT_FALSE(told("stability predict --methods rk4"));
  EXPECT_TRUE(told("run --method linearly_implicit_euler --h 0.01 --t-end 0.02"));
  EXPECT_FALSE(told("run --method rk4 --h 1e-4 --t-end 1e-3"));
  EXPECT_FALSE(told("stability modes --count 1"));
}

/// The limit under the load itself, which moves the body.
TEST(StabilityOfScenes, OfSofaHaveTheLoadAndTheSolverThatWereWritten) {
  Shell shell;
  const std::string body =
      " --support 'z<0.01' --material tissue:liver --model fem_green --load press --set force=2 ";
  ASSERT_EQ(shell.hmax("mesh convert phantom gel.scn --h 0.001 --method rk4 --set alpha=20" + body).exit_code,
            0);
  const auto document = shell.json("stability predict --scene gel.scn --unit m,kg,s");
  EXPECT_EQ(document["scene"]["integrator"], "RungeKutta4Solver");
  EXPECT_EQ(document["scene"]["h"], 0.001);
  const double h_max = document["rows"][0]["h_max"];
  const std::string same = "stability predict --mesh phantom --method rk4 --alpha 20" + body;
  EXPECT_NEAR(shell.json(same)["rows"][0]["h_max"], h_max, 1e-6 * h_max);
  const double unloaded = shell.json(
      "stability predict --scene gel.scn --unit m,kg,s --load gravity --set g=0 --at rest")["rows"][0]
                                                                                           ["h_max"];
  EXPECT_GT(std::abs(unloaded - h_max), 1e-4 * h_max);
  expect_refused(shell.hmax("mesh convert phantom gel.scn --method hht_alpha"),
                 "no solver that steps as hht_alpha");
  expect_refused(shell.hmax("mesh convert phantom gel.scn --method rk4 --set beta=1"), "set beta=0");
  expect_refused(shell.hmax("mesh convert phantom gel.scn --load breathing --support 'z<0.01'"),
                 "moving supports");
  expect_refused(shell.hmax("mesh convert phantom gel.vtu --method rk4"), "write to a file .scn");
}

TEST(StabilityOfScenes, AreNotJudgedWhereNothingIsKnown) {
  Shell shell;
  const std::string predict = "stability predict --unit m,kg,s --scene ";
  ASSERT_EQ(shell.hmax("mesh convert ball:n=2 ball.scn --h 0.01 --gravity 0,0,-30").exit_code, 0);
  const Told sinks = shell.hmax(predict + "ball.scn");
  EXPECT_TRUE(says(sinks.out, "is not judged: the equilibrium under its load was not found"));
  EXPECT_EQ(sinks.exit_code, 1);
  const auto document = shell.hmax(predict + "ball.scn --json").json();
  EXPECT_TRUE(document["scene"]["within"].is_null());
  EXPECT_TRUE(document["scene"]["h_max"].is_null());

  ASSERT_EQ(shell.hmax("mesh convert ball:n=2 ball.scn --h 0.01 --model fem_cauchy").exit_code, 0);
  EXPECT_EQ(shell.hmax(predict + "ball.scn --json").json()["scene"]["within"], true);
  change(shell, "ball.scn", implicit, "EulerExplicitSolver symplectic=\"0\"");
  EXPECT_TRUE(says(shell.hmax(predict + "ball.scn").out,
                   "every step with EulerExplicitSolver (explicit_euler) grows, however small"));
  EXPECT_EQ(shell.hmax(predict + "ball.scn --json").json()["scene"]["within"], false);
}

TEST(StabilityOfScenes, GiveWayToWhatIsSet) {
  Shell shell;
  const std::string two = " --scene bar.inp --unit mm,t,s --method symplectic_euler ";
  const auto h_max = [&](const std::string& options) {
    const Told told = shell.hmax("stability predict --json" + options);
    EXPECT_EQ(told.exit_code, 0) << told.err;
    return told.json()["rows"][0]["h_max"].get<double>();
  };
  write_text(shell / "bar.inp", bar("*DYNAMIC, EXPLICIT\n0.1,1"));
  const auto fixed = [&](const std::string& support) {
    return shell.hmax("stability predict --json" + two + support).json()["models"][0]["body"]["fixed"];
  };
  EXPECT_EQ(fixed(""), 3);
  EXPECT_EQ(fixed("--support points:4"), 1) << "in place of those of the scene";
  const double known = h_max(two + "--set E=5500 --set nu=0.45 --set rho=1060");
  const double of_scene = h_max(two);
  EXPECT_NEAR(h_max(two + "--set E=4e4"), of_scene / 2, 1e-6 * of_scene);
  // The same body of two sections.
  change(shell, "bar.inp", "*SOLID SECTION, ELSET=ALL, MATERIAL=M",
         "*MATERIAL, NAME=N\n*ELASTIC\n0.01,0.3\n*DENSITY\n1e-9\n*ELSET, ELSET=A\n1\n*ELSET, ELSET=B\n2\n"
         "*SOLID SECTION, ELSET=A, MATERIAL=M\n*SOLID SECTION, ELSET=B, MATERIAL=N");
  EXPECT_NEAR(h_max(two), of_scene, 1e-9 * of_scene);
  EXPECT_NEAR(h_max(two + "--set E=4e4"), of_scene / 2, 1e-6 * of_scene);
  EXPECT_NEAR(h_max(two + "--set E:A=4e4 --set E:B=4e4"), of_scene / 2, 1e-6 * of_scene);
  EXPECT_NEAR(h_max(two + "--set E:1=4e4 --set E:2=4e4"), of_scene / 2, 1e-6 * of_scene);
  EXPECT_NEAR(h_max(two + "--set E=5500 --set nu=0.45 --set rho=1060"), known, 1e-9 * known);
  const auto material = shell.hmax("stability predict --json --material tissue:liver" + two).json();
  const double of_material = material["rows"][0]["h_max"];
  EXPECT_GT(std::abs(of_material - of_scene), 0.01 * of_scene);
  EXPECT_NEAR(h_max(" --material A=tissue:liver,B=tissue:liver" + two), of_material, 1e-9 * of_material);
  const std::string same =
      "stability predict --mesh bar.inp --unit mm --model fem_cauchy --set g=0 --support FIX --json "
      "--method symplectic_euler --material tissue:liver";
  EXPECT_NEAR(shell.hmax(same).json()["rows"][0]["h_max"], of_material, 1e-9 * of_material);
}

TEST(StabilityOfScenes, WarnWhereTheirMeshIsTakenWithoutTheMaterial) {
  Shell shell;
  write_text(shell / "bar.inp", "** materials\n" + bar("*DYNAMIC, EXPLICIT\n0.1,1"));
  write_text(shell / "bare.inp",
             "*NODE\n1,0,0,0\n2,1,0,0\n3,0,1,0\n4,0,0,1\n*ELEMENT,TYPE=C3D4\n1,1,2,3,4\n");
  const auto errors = [&](const std::string& more) {
    const auto done = shell.hmax(more + " --unit mm --at rest --method rk4");
    EXPECT_EQ(done.exit_code, 0) << done.err;
    return done.err;
  };
  const std::string warned = "bar.inp, line 13: this material is not in a mesh";
  EXPECT_TRUE(says(errors("stability predict --mesh bar.inp"), warned));
  EXPECT_TRUE(says(errors("stability predict --mesh bar.inp --set rho=1000"), warned));
  EXPECT_FALSE(says(errors("stability predict --mesh bar.inp --set E=1e4"), "material"));
  EXPECT_FALSE(says(errors("stability predict --mesh bar.inp --material tissue:liver"), "this material"));
  EXPECT_FALSE(says(errors("stability predict --mesh bare.inp"), "material"));
}

TEST(StabilityOfScenes, SayWhereNumbersOutOfRangeStandUnlessTheyAreReplaced) {
  Shell shell;
  write_text(shell / "bar.inp", bar("*DYNAMIC, EXPLICIT\n0.1,1"));
  change(shell, "bar.inp", "0.01,0.3", "0.01,0.5");
  const std::string predict = "stability predict --scene bar.inp --unit mm,t,s";
  expect_refused(shell.hmax(predict), "bar.inp, line 14: Poisson's ratio is 0.5");
  EXPECT_EQ(shell.hmax(predict + " --set nu=0.45").exit_code, 0);
  change(shell, "bar.inp", "0.01,0.5", "-0.01,0.3");
  expect_refused(shell.hmax(predict), "bar.inp, line 14: Young's modulus is -10000 Pa");
}

TEST(StabilityOfScenes, AreModelsOfAllCommands) {
  Shell shell;
  write_text(shell / "bar.inp", bar("*DYNAMIC, EXPLICIT\n0.1,1\n*CLOAD\n4,4,1"));
  const std::string scene = " --scene bar.inp --unit mm,t,s --ignore CLOAD";
  const Told modes = shell.hmax("stability modes --count 1" + scene);
  EXPECT_EQ(modes.exit_code, 0) << modes.err;
  EXPECT_TRUE(says(modes.err, "left out of bar.inp: CLOAD"));
  EXPECT_EQ(shell.hmax("run --method central_difference --h 1e-4 --t-end 1e-3" + scene).exit_code, 0);
  const auto pressed = shell.hmax("static --load press --set E=2e4 --json" + scene).json();
  EXPECT_EQ(pressed["problem"], "fem_cauchy/press@bar.inp");
  expect_refused(shell.hmax("stability predict --scene bar.inp --unit mm,t,s"), "bar.inp, line 24: *CLOAD");
  expect_refused(shell.hmax("stability predict --scene bar.inp --unit mm"), "--unit mm is not enough");
  expect_refused(shell.hmax("stability predict --mesh liver" + scene), "--mesh and --scene are both given");
  expect_refused(shell.hmax("stability predict --mesh liver --ignore CLOAD --method rk4"),
                 "name one with --scene");
  expect_refused(shell.hmax("stability predict --materials tissue:liver,tissue:fibroadenoma" + scene),
                 "judged for one material");
  expect_refused(shell.hmax("probe bar.inp"), "`hmax stability predict --scene FILE`");
  write_text(shell / "a.xml", "<mujoco/>");
  expect_refused(shell.hmax("stability predict --unit m,kg,s --scene a.xml"), "`hmax probe` takes all of it");
  expect_refused(shell.hmax("stability predict --scene none.inp --unit m,kg,s"), "none.inp");
}

}  // namespace
}  // namespace hmax
