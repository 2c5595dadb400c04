/// hmax probe on scenes of MuJoCo, where its module was built.
#include <cmath>
#include <filesystem>

#include <gtest/gtest.h>

#include "core/ranks/module.hpp"
#include "tests/cli/program.hpp"
#include "tests/results/scratch.hpp"

namespace hmax {
namespace {

/// A mass of 1 kg on a slide joint, and what else the scene has.
std::string sliding(const std::string& option, const std::string& joint, const std::string& rest = "") {
  return "<mujoco><option " + option +
         "/><worldbody><body><joint name=\"rail\" type=\"slide\" axis=\"1 0 0\" " + joint +
         "/><geom name=\"car\" size=\"0.1\" mass=\"1\"/></body></worldbody>" + rest + "</mujoco>";
}

class ProbeScene : public testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(module_file("hmax_mujoco.so")))
      GTEST_SKIP() << "this build has no module for MuJoCo: libmujoco-dev was missing";
  }
  [[nodiscard]] Told probe(const std::string& scene, const std::string& rest = "") const {
    write_text(shell_ / "model.xml", scene);
    return shell_.hmax("probe model.xml " + rest);
  }
  [[nodiscard]] nlohmann::json found(const std::string& scene, const std::string& rest = "") const {
    const Told told = probe(scene, rest + " --json");
    EXPECT_EQ(told.exit_code, 0) << told.err;
    return told.json();
  }
  Shell shell_;
};

TEST_F(ProbeScene, TheSpringThatATimestepIsTooLongForIsNamed) {
  // Semi-implicit Euler: omega h = 2.
  const std::string scene = sliding("timestep=\"0.005\"", "stiffness=\"250000\"");
  const nlohmann::json all = found(scene);
  EXPECT_EQ(all["model"], "model.xml");
  EXPECT_TRUE(says(all["engine"].get<std::string>(), ", Euler"));
  EXPECT_NEAR(all["h_max"].get<double>(), 0.004, 1e-6);
  EXPECT_NEAR(all["observed"].get<double>(), 0.004, 1e-5);
  EXPECT_EQ(all["timestep"], 0.005);
  EXPECT_EQ(all["stable"], false);
  EXPECT_EQ(all["substeps"], 2);
  EXPECT_EQ(all["settles"], false);
  EXPECT_EQ(all["owner"]["kind"], "joint");
  EXPECT_EQ(all["owner"]["name"], "rail");
  EXPECT_NEAR(all["owner"]["share"].get<double>(), 1, 1e-3);
  EXPECT_NEAR(all["owner"]["stiffness"]["largest"].get<double>(), 160000, 200);
  EXPECT_TRUE(all["owner"]["damping"]["largest"].is_null());
  const Told told = probe(scene);
  EXPECT_TRUE(says(told.out, "model.xml in MuJoCo")) << told.out;
  EXPECT_TRUE(
      says(told.out, "timestep  0.005 s is above the limit 0.004 s; 2 substeps of 0.0025 s are stable"))
      << told.out;
  EXPECT_TRUE(says(told.out, "owner     joint rail has 100 % of the limit")) << told.out;
  EXPECT_TRUE(says(told.out, "largest   stiffness of joint rail at 0.005 s: 159900, 0.64 times its own"))
      << told.out;
}

/// The limit is 0.004 s, and what is found below it by up to 1e-4.
TEST_F(ProbeScene, ALimitIsToldInDigitsThatTellItFromTheTimestep) {
  const std::string scene = sliding("timestep=\"0.004\"", "stiffness=\"250000\"");
  const Told told = probe(scene);
  EXPECT_TRUE(says(told.out, "timestep  0.004 s is above the limit 0.00")) << told.out;
  EXPECT_FALSE(says(told.out, "the limit 0.004 s")) << told.out;
}

/// All that steps of h0 tell is that there are none; what is not smooth is not known.
TEST_F(ProbeScene, StepsThatCannotBeDoneAreNotCalledRough) {
  const nlohmann::json all = found(sliding("timestep=\"0.01\"", "stiffness=\"1e30\""));
  EXPECT_TRUE(all["h_max"].is_null());
  const std::string status = all["status"].get<std::string>();
  EXPECT_TRUE(says(status, "steps of h0 cannot be done; take a smaller h0")) << status;
  EXPECT_FALSE(says(status, "not smooth")) << status;
}

TEST_F(ProbeScene, TheCaseOfAnEndingDoesNotMatter) {
  write_text(shell_ / "SLIDE.XML", sliding("timestep=\"0.005\"", "stiffness=\"250000\""));
  const Told told = shell_.hmax("probe SLIDE.XML --json");
  EXPECT_EQ(told.exit_code, 0) << told.err;
  EXPECT_NEAR(told.json()["h_max"].get<double>(), 0.004, 1e-6);
  write_text(shell_ / "BAR.INP", "");
  expect_refused(shell_.hmax("probe BAR.INP"), "`hmax stability predict --scene FILE` takes it");
}

TEST_F(ProbeScene, EachIntegratorHasItsOwnLimit) {
  // RK4: omega h = 2 sqrt(2).
  const nlohmann::json rk4 = found(sliding("timestep=\"0.001\" integrator=\"RK4\"", "stiffness=\"250000\""));
  EXPECT_NEAR(rk4["h_max"].get<double>(), 2 * std::sqrt(2.0) / 500, 1e-5);
  EXPECT_EQ(rk4["stable"], true);
  EXPECT_EQ(rk4["substeps"], 1);
  // A velocity servo: explicit in Euler, (kv / m) h = 2, and none in implicit.
  const std::string servo = "<actuator><velocity name=\"drive\" joint=\"rail\" kv=\"1000\"/></actuator>";
  const nlohmann::json euler = found(sliding("timestep=\"0.001\" integrator=\"Euler\"", "", servo));
  EXPECT_NEAR(euler["h_max"].get<double>(), 0.002, 1e-6);
  EXPECT_EQ(euler["owner"]["kind"], "actuator");
  EXPECT_EQ(euler["owner"]["name"], "drive");
  EXPECT_NEAR(euler["owner"]["share"].get<double>(), 1, 1e-3);
  EXPECT_NEAR(euler["owner"]["damping"]["largest"].get<double>(), 2000, 3);
  EXPECT_EQ(euler["owner"]["stiffness"]["value"].dump(), "0.0");
  const nlohmann::json implicit = found(sliding("timestep=\"0.001\" integrator=\"implicit\"", "", servo));
  EXPECT_EQ(implicit["h_max"], "unbounded");
  EXPECT_EQ(implicit["stable"], true);
  EXPECT_TRUE(implicit["owner"].is_null());
}

TEST_F(ProbeScene, ServosTendonsContactsAndConstraintsOwnLimits) {
  const std::string quiet = "timestep=\"0.001\" gravity=\"0 0 0\"";
  const nlohmann::json servo =
      found(sliding(quiet, "", "<actuator><position name=\"hold\" joint=\"rail\" kp=\"10000\"/></actuator>"));
  EXPECT_NEAR(servo["h_max"].get<double>(), 0.02, 1e-5);
  EXPECT_EQ(servo["owner"]["name"], "hold");
  EXPECT_NEAR(servo["owner"]["stiffness"]["largest"].get<double>(), 4e6, 5e3);
  const nlohmann::json tendon = found(sliding(
      quiet, "",
      "<tendon><fixed name=\"cord\" stiffness=\"10000\"><joint joint=\"rail\" coef=\"1\"/></fixed></tendon>"));
  EXPECT_NEAR(tendon["h_max"].get<double>(), 0.02, 1e-5);
  EXPECT_EQ(tendon["owner"]["kind"], "tendon");
  EXPECT_EQ(tendon["owner"]["name"], "cord");
  // Without a name it has its number and what it belongs to, and the joint beside it no share.
  const nlohmann::json nameless = found(
      sliding(quiet, "stiffness=\"1\"",
              "<tendon><fixed stiffness=\"10000\"><joint joint=\"rail\" coef=\"1\"/></fixed></tendon>"));
  EXPECT_EQ(nameless["owner"]["name"], "0 (fixed to joint rail)");
  const nlohmann::json weld = found(sliding(
      quiet, "", "<equality><joint name=\"lock\" joint1=\"rail\" solref=\"-10000 -10\"/></equality>"));
  EXPECT_EQ(weld["owner"]["kind"], "equality");
  EXPECT_EQ(weld["owner"]["name"], "lock");
  EXPECT_NEAR(weld["owner"]["share"].get<double>(), 1, 1e-2);
  EXPECT_EQ(weld["owner"]["stiffness"]["value"], 10000);
}

TEST_F(ProbeScene, AScenesTimestepThatIsTooLongToSettleIsNoObstacle) {
  const std::string scene =
      "<mujoco><option timestep=\"0.01\"/><worldbody><body><joint name=\"a\" axis=\"0 1 0\"/>"
      "<geom type=\"capsule\" size=\"0.02\" fromto=\"0 0 0 0.3 0 0\" mass=\"0.5\"/></body></worldbody>"
      "<actuator><position name=\"hold\" joint=\"a\" kp=\"2000\"/></actuator></mujoco>";
  const nlohmann::json all = found(scene);
  EXPECT_EQ(all["state"], "equilibrium");
  EXPECT_EQ(all["stable"], false);
  EXPECT_LT(std::abs(all["gap"].get<double>()), 5e-3);
  EXPECT_TRUE(says(probe(scene).out, "brought to rest by shorter steps than its own"));
}

TEST_F(ProbeScene, KeyframesBeginElsewhere) {
  // A pendulum whose stiffness is that of gravity: at rest below, and upside down unstable.
  const std::string scene =
      "<mujoco><option timestep=\"0.01\"/><worldbody><body><joint name=\"a\" axis=\"0 1 0\"/>"
      "<geom type=\"capsule\" size=\"0.02\" fromto=\"0 0 0 0 0 -0.3\" mass=\"0.5\"/></body></worldbody>"
      "<keyframe><key name=\"below\" qpos=\"0\"/><key name=\"above\" qpos=\"3.14159265358979\"/></keyframe></mujoco>";
  const nlohmann::json below = found(scene, "--keyframe below");
  EXPECT_EQ(below["owner"]["kind"], "gravity");
  EXPECT_NEAR(below["owner"]["share"].get<double>(), 1, 1e-3);
  EXPECT_EQ(found(scene, "--keyframe 0")["h_max"], below["h_max"]);
  const nlohmann::json along = found(scene, "--keyframe above --motion 1 --h1 0.05 --h0 0.005 --no-runs");
  EXPECT_EQ(along["state"], "motion");
  expect_refused(probe(scene, "--keyframe aside"), "there is no keyframe 'aside'; the file has below, above");
  expect_refused(probe(scene, "--keyframe 2"), "there is no keyframe '2'");
  expect_refused(probe(sliding("", ""), "--keyframe home"), "there is no keyframe 'home'; the file has none");
}

TEST_F(ProbeScene, RefusesWhatIsNoScene) {
  expect_refused(shell_.hmax("probe none.xml"), "there is no file 'none.xml'");
  expect_refused(probe(""), "model.xml: ");
  expect_refused(probe("no scene at all"), "model.xml: ");
  expect_refused(probe("<fmiModelDescription fmiVersion=\"2.0\"/>"), "model.xml: ");
  expect_refused(probe("<mujoco><worldbody><body><joint stifness=\"1\"/></body></worldbody></mujoco>"),
                 "stifness");
  expect_refused(probe("<mujoco/>"), "nothing in the scene moves");
  expect_refused(probe("<mujoco><worldbody><geom size=\"1\"/></worldbody></mujoco>"),
                 "nothing in the scene moves");
  expect_refused(probe(sliding("timestep=\"0\"", "")), "the timestep is not positive");
  write_text(shell_ / "notes.txt", "notes");
  expect_refused(shell_.hmax("probe notes.txt"), "'notes.txt' is no scene");
  expect_refused(shell_.hmax("probe ."), "'.' is no scene");
  const std::string scene = sliding("", "stiffness=\"100\"");
  expect_refused(probe(scene, "--h0 0.1 --h1 0.01"), "the smaller one first");
  expect_refused(probe(scene, "--plugin a.so"), "a scene and --plugin are given");
  expect_refused(probe(scene, "--stiffness k"), "--stiffness is asked of a --plugin");
  expect_refused(shell_.hmax("stability predict --plugin model.xml --methods rk4"),
                 "'mujoco' of MuJoCo is a stepper and no model");
  expect_refused(shell_.hmax("probe --plugin model.xml --keyframe a --h0 1 --h1 2"),
                 "--keyframe is one of a scene");
}

TEST_F(ProbeScene, WhatEndsTheEngineIsAnError) {
  // An error of MuJoCo ends its process, and writes a file.
  const std::string few =
      "<mujoco><size nstack=\"1\"/><worldbody><body><joint/><geom size=\"0.1\"/></body></worldbody></mujoco>";
  expect_refused(probe(few), "model.xml: Error: engine error: Stack overflow");
  EXPECT_FALSE(std::filesystem::exists(shell_ / "MUJOCO_LOG.TXT"));
  // A pendulum that swings for a hundred thousand steps.
  const std::string swings =
      "<mujoco><option timestep=\"0.00001\"/><worldbody><body><joint axis=\"0 1 0\"/>"
      "<geom size=\"0.1\" pos=\"1 0 0\"/></body></worldbody></mujoco>";
  expect_refused(probe(swings, "--timeout 0.01"), "MuJoCo did not return within 0.01 s in create()");
}

TEST_F(ProbeScene, ATimestepBeyondH1IsNotJudged) {
  const auto stable = [&](const std::string& rest) {
    return found(sliding("timestep=\"0.005\"", "stiffness=\"250000\""), rest)["stable"];
  };
  EXPECT_TRUE(stable("--h1 0.003").is_null());
  EXPECT_EQ(stable("--h1 0.006"), false);
}

TEST(ProbeWithoutModule, SaysWhatToInstall) {
  const Shell shell;
  ASSERT_EQ(shell.line("mkdir -p tree/bin && cp '" HMAX_PROGRAM "' tree/bin/hmax").exit_code, 0);
  write_text(shell / "model.xml", "<mujoco/>");
  expect_refused(shell.line("tree/bin/hmax probe model.xml"), "libmujoco-dev");
}

}  // namespace
}  // namespace hmax
