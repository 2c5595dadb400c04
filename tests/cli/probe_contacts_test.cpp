/// hmax probe on scenes of MuJoCo with contacts, muscles, limits and falling bodies, against formulas and
/// the engine's own runs.
#include <cmath>
#include <filesystem>

#include <gtest/gtest.h>

#include "core/ranks/module.hpp"
#include "tests/cli/program.hpp"
#include "tests/results/scratch.hpp"

namespace hmax {
namespace {

const std::string plane = "<geom type=\"plane\" size=\"9 9 0.1\"/>";

std::string world(const std::string& option, const std::string& bodies, const std::string& rest = "") {
  return "<mujoco><option timestep=\"0.002\" " + option + "/><worldbody>" + bodies + "</worldbody>" + rest +
         "</mujoco>";
}

std::string free_body(const std::string& pos, const std::string& geom) {
  return "<body pos=\"" + pos + "\"><freejoint/><geom mass=\"1\" " + geom + "/></body>";
}

const std::string box = "type=\"box\" size=\"0.1 0.1 0.1\"", ball = "size=\"0.1\"";

/// A forearm that hangs.
std::string forearm(const std::string& joint, const std::string& rest = "") {
  return "<body name=\"forearm\" pos=\"0 0 1\"><joint axis=\"0 1 0\" damping=\"0.05\" " + joint +
         "/><geom type=\"capsule\" fromto=\"0 0 0 0 0 -.3\" size=\".02\" mass=\"1\"/>" + rest + "</body>";
}

class ProbeContacts : public testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(module_file("hmax_mujoco.so")))
      GTEST_SKIP() << "this build has no module for MuJoCo: libmujoco-dev was missing";
  }
  [[nodiscard]] nlohmann::json found(const std::string& scene, const std::string& rest = "") const {
    write_text(shell_ / "model.xml", scene);
    const Told told = shell_.hmax("probe model.xml --json " + rest);
    EXPECT_EQ(told.exit_code, 0) << told.out << told.err;
    return told.json();
  }
  /// What is true of bodies that rest on contacts, whose time constants grow with the step.
  static void expect_rest_at_all_steps(const nlohmann::json& all) {
    EXPECT_EQ(all["state"], "equilibrium") << all["status"];
    EXPECT_EQ(all["h_max"], "unbounded") << all["status"];
    EXPECT_EQ(all["observed"], "unbounded") << all["status"];
    EXPECT_EQ(all["contradiction"], false);
    EXPECT_EQ(all["stable"], true);
  }
  static std::string text(const nlohmann::json& value) {
    return value.is_null() ? "" : value.get<std::string>();
  }
  Shell shell_;
};

TEST_F(ProbeContacts, BoxesAndBallsRestOnAPlane) {
  expect_rest_at_all_steps(
      found(world("", plane + free_body("-0.2 0 0.1", box) + free_body("0.2 0 0.1", box))));
  expect_rest_at_all_steps(
      found(world("", plane + free_body("0 0 0.1", ball) + free_body("0.5 0 0.1", ball))));
}

TEST_F(ProbeContacts, WhatFallsLandsAndWhatRollsStops) {
  expect_rest_at_all_steps(found(world("", plane + free_body("0 0 1", box))));
  const nlohmann::json rolls =
      found(world("", plane + "<geom size=\"0.2\" pos=\"0 0 0.1\"/>" + free_body("0.05 0 1", ball)));
  expect_rest_at_all_steps(rolls);
  EXPECT_TRUE(says(text(rolls["engine"]), "brought to rest by damping")) << rolls["engine"];
  // Beside an arm that swings for ever.
  const nlohmann::json swings = found(
      world("", plane + free_body("0 0 1", ball) +
                    "<body pos=\"2 0 1\"><joint name=\"swing\" axis=\"0 1 0\" stiffness=\"500\"/>"
                    "<geom type=\"capsule\" fromto=\"0 0 0 0.3 0 0\" size=\"0.02\" mass=\"0.2\"/></body>"));
  EXPECT_EQ(swings["state"], "equilibrium");
  EXPECT_EQ(swings["owner"]["name"], "swing");
  EXPECT_LT(std::abs(swings["gap"].get<double>()), 5e-3);
  // Nothing to land on.
  const nlohmann::json thrown = found(world("", free_body("0 0 1", ball)));
  EXPECT_EQ(thrown["state"], "initial");
  EXPECT_TRUE(says(text(thrown["engine"]), "does not come to rest: judged where it begins"));
}

TEST_F(ProbeContacts, AMuscleAtRestHasTheLimitOfItsTwoSides) {
  const nlohmann::json all = found(
      world("", "<site name=\"a\" pos=\"0.05 0 1\"/>" + forearm("", "<site name=\"b\" pos=\"0.02 0 -.1\"/>"),
            "<tendon><spatial name=\"t\"><site site=\"a\"/><site site=\"b\"/></spatial></tendon><actuator>"
            "<muscle tendon=\"t\" force=\"200\" ctrllimited=\"true\" ctrlrange=\"0 1\"/></actuator>"));
  EXPECT_EQ(all["smoothness"], "kink");
  // Activations of 0.01 s * 0.5 up and 0.04 s / 0.5 down: (h / 0.005 - 1) (h / 0.08 - 1) = 1.
  EXPECT_NEAR(all["h_max"].get<double>(), 0.085, 2e-4);
  EXPECT_LT(std::abs(all["gap"].get<double>()), 5e-3);
  EXPECT_EQ(all["stable"], true);
  EXPECT_TRUE(says(text(all["status"]), "(actuator filter 0 (on tendon t))")) << all["status"];
}

TEST_F(ProbeContacts, LimitsAndContactsThatJustTouchAreKinks) {
  const nlohmann::json limit =
      found(world("gravity=\"0 0 0\"", forearm("stiffness=\"2\" limited=\"true\" range=\"0 90\"")));
  EXPECT_EQ(limit["smoothness"], "kink");
  EXPECT_EQ(limit["h_max"], limit["observed"]);
  EXPECT_TRUE(says(text(limit["status"]), "(joint limit 0 (hinge joint of body forearm))"))
      << limit["status"];
  const nlohmann::json contact =
      found(world("gravity=\"0 0 0\"",
                  "<geom type=\"plane\" size=\"1 1 0.1\" solref=\"-20000 -20\"/><body pos=\"0 0 0.1\">"
                  "<joint type=\"slide\" axis=\"0 0 1\" stiffness=\"100\" damping=\"1\"/>"
                  "<geom size=\"0.1\" mass=\"1\" solref=\"-20000 -20\"/></body>"));
  EXPECT_EQ(contact["smoothness"], "kink");
  EXPECT_LT(std::abs(contact["gap"].get<double>()), 0.01) << contact["status"];
  // MuJoCo alone, in strides of 5 %, grows first at 0.0118 s.
  EXPECT_NEAR(contact["h_max"].get<double>(), 0.0118, 0.0012);
  EXPECT_TRUE(says(text(contact["status"]), "(contact 0 (plane of the world))")) << contact["status"];
}

TEST_F(ProbeContacts, RunsJudgeWhereContactsComeAndGo) {
  const nlohmann::json all =
      found(world("", plane + free_body("0 0 0.1", box) + free_body("0 0 0.3", box)), "--h0 2e-3 --h1 2e-3");
  EXPECT_EQ(all["smoothness"], "jump") << all["status"];
  EXPECT_TRUE(all["h_max"].is_null());
  EXPECT_EQ(all["observed"], "unbounded");
  EXPECT_EQ(all["stable"], true);
}

TEST_F(ProbeContacts, WhatRoundingLeavesIsAnEquilibrium) {
  const std::string loop =
      "<mujoco><option timestep=\"0.001\" integrator=\"RK4\" iterations=\"200\" tolerance=\"1e-14\"/><default>"
      "<joint axis=\"0 1 0\" damping=\"0.05\"/><geom type=\"capsule\" size=\"0.015\" mass=\"0.3\" contype=\"0\" "
      "conaffinity=\"0\"/></default><worldbody><body pos=\"0 0 1\"><joint/><geom fromto=\"0 0 0 0 0 -0.3\"/>"
      "<body pos=\"0 0 -0.3\"><joint/><geom fromto=\"0 0 0 0.4 0 0\"/><body name=\"coupler\" pos=\"0.4 0 0\">"
      "<joint/><geom fromto=\"0 0 0 0 0 0.3\"/></body></body></body></worldbody><equality><connect "
      "body1=\"coupler\" anchor=\"0 0 0.3\" solref=\"-20000 -40\" solimp=\"0.9 0.9 0.01\"/></equality></mujoco>";
  for (const char* h0 : {"1e-3", "1e-4"}) {
    const nlohmann::json all = found(loop, std::string("--no-runs --h0 ") + h0);
    EXPECT_EQ(all["state"], "equilibrium") << h0 << all["status"];
    EXPECT_NEAR(all["h_max"].get<double>(), 0.020037, 2e-6);
    EXPECT_EQ(all["owner"]["name"], "0 (connect of body coupler and the world)");
  }
}

TEST_F(ProbeContacts, PartsWithoutANameAreCalledByWhatTheyBelongTo) {
  const nlohmann::json joint = found(world("", forearm("stiffness=\"50\"")), "--no-runs");
  EXPECT_EQ(joint["owner"]["name"], "0 (hinge joint of body forearm)");
  const nlohmann::json gravity = found(world("", forearm("")), "--no-runs --h1 1");
  EXPECT_EQ(gravity["owner"]["kind"], "gravity");
  EXPECT_EQ(gravity["owner"]["name"], "of the scene");
}

}  // namespace
}  // namespace hmax
