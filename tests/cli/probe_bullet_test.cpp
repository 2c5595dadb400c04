/// hmax probe on robots and soft bodies of Bullet, where its module was built.
#include <cmath>
#include <filesystem>

#include <gtest/gtest.h>

#include "core/ranks/module.hpp"
#include "tests/cli/program.hpp"
#include "tests/results/scratch.hpp"

namespace hmax {
namespace {

/// Of Bullet, of all bodies [1/s].
constexpr double link_damping = 0.04, gravity = 9.81;

std::string link(const std::string& name, double mass, const std::string& at = "0 0 0",
                 const std::string& inertia = R"(ixx="1e-9" iyy="1e-9" izz="1e-9")") {
  return "<link name=\"" + name + "\"><inertial><origin xyz=\"" + at + "\"/><mass value=\"" +
         std::to_string(mass) + "\"/><inertia " + inertia + "/></inertial></link>\n";
}
std::string joint(const std::string& name, const std::string& type, const std::string& parent,
                  const std::string& child, const std::string& rest) {
  return "<joint name=\"" + name + "\" type=\"" + type + "\"><parent link=\"" + parent +
         "\"/><child link=\"" + child + "\"/>" + rest + "</joint>\n";
}
std::string robot(const std::string& parts) {
  return "<?xml version=\"1.0\"?>\n<robot name=\"r\">\n" + parts + "</robot>\n";
}
const std::string world_link = "<link name=\"world\"/>\n";

/// Two tetrahedra that share a side.
const std::string wedge =
    "# vtk DataFile Version 2.0\nwedge\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 5 double\n0 0 0 0.1 0 0 0 0.1 0 "
    "0 0 0.1 0.1 0.1 0.1\nCELLS 2 10\n4 0 1 2 3\n4 1 2 3 4\nCELL_TYPES 2\n10\n10\n";
const std::string held = "--unit m --support 'z<0.01' ";

class ProbeBullet : public testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(module_file("hmax_bullet.so")))
      GTEST_SKIP() << "this build has no module for Bullet: libbullet-dev was missing";
    write_text(shell_ / "body.vtk", wedge);
  }
  [[nodiscard]] Told probe(const std::string& text, const std::string& rest = "") const {
    write_text(shell_ / "robot.urdf", text);
    return shell_.hmax("probe robot.urdf " + rest);
  }
  [[nodiscard]] nlohmann::json found(const std::string& text, const std::string& rest = "") const {
    const Told told = probe(text, rest + " --json");
    EXPECT_EQ(told.exit_code, 0) << told.err;
    return told.json();
  }
  [[nodiscard]] nlohmann::json body(const std::string& rest) const {
    const Told told = shell_.hmax("probe body.vtk --json " + rest);
    EXPECT_EQ(told.exit_code, 0) << told.err;
    return told.json();
  }
  /// Of symplectic Euler on the same body in hmax.
  [[nodiscard]] double limit_of_hmax(const std::string& rest) const {
    const Told told = shell_.hmax(
        "stability predict --mesh body.vtk --unit m --support 'z<0.01' --model fem_corotational "
        "--methods symplectic_euler --at rest --set equal_masses=1 --set g=0 --json " +
        rest);
    EXPECT_EQ(told.exit_code, 0) << told.err;
    return told.json()["rows"][0]["h_max"].get<double>();
  }
  Shell shell_;
};

/// The largest step of v' = v - h (w^2 x + c v), x' = x + h v'.
double limit_of_oscillator(double omega2, double c) { return (std::sqrt(c * c + 4 * omega2) - c) / omega2; }

TEST_F(ProbeBullet, TheDamperThatATimestepIsTooLongForIsNamed) {
  // Explicit: d h / m = 2.
  const std::string sled = robot(world_link + link("sled", 0.5) +
                                 joint("rail", "prismatic", "world", "sled",
                                       R"(<axis xyz="1 0 0"/><dynamics damping="400" friction="3"/>)"));
  const nlohmann::json all = found(sled);
  EXPECT_TRUE(says(all["engine"].get<std::string>(), "multibody of 1 joint"));
  EXPECT_EQ(all["dim"], 2);
  const double rate = 400 / 0.5 + link_damping;
  EXPECT_NEAR(all["h_max"].get<double>(), 2 / rate, 1e-6);
  EXPECT_NEAR(all["observed"].get<double>(), 2 / rate, 1e-5);
  EXPECT_EQ(all["timestep"], 1.0 / 240);
  EXPECT_EQ(all["stable"], false);
  EXPECT_EQ(all["substeps"], 2);
  EXPECT_EQ(all["owner"]["kind"], "joint");
  EXPECT_EQ(all["owner"]["name"], "rail");
  EXPECT_NEAR(all["owner"]["share"].get<double>(), 1, 1e-3);
  EXPECT_NEAR(all["owner"]["damping"]["largest"].get<double>(), (480 - link_damping) * 0.5, 1);
  EXPECT_TRUE(says(probe(sled).out, "is above the limit 0.0025 s; 2 substeps"));
  write_text(shell_ / "SLED.URDF", sled);
  const Told loud = shell_.hmax("probe SLED.URDF --json");
  EXPECT_EQ(loud.exit_code, 0) << loud.err;
  EXPECT_EQ(loud.json()["h_max"], all["h_max"]);
}

TEST_F(ProbeBullet, PendulumsAreThoseOfTheirMassesAndMoments) {
  // About (1, 1, 0) / sqrt(2), with products of inertia and a mass that is fixed to it; the limit is long.
  const std::string axis = R"(<axis xyz="0.7071067811865476 0.7071067811865476 0"/>)",
                    moments = R"(ixx="4e-5" iyy="5e-5" izz="6e-5" ixy="1e-5" ixz="5e-6" iyz="-7e-6")",
                    place = R"(<origin xyz="0.3 0 1" rpy="0 0 0"/>)";
  const std::string pendulum =
      robot(world_link + link("bob", 0.2, "0 0 -0.01", moments) + link("tip", 0.1, "0 0 -0.01") +
            joint("pin", "continuous", "world", "bob", place + axis) +
            joint("glue", "fixed", "bob", "tip", R"(<origin xyz="0 0 -0.01"/>)"));
  const double about_axis = (4e-5 + 5e-5) / 2 + 1e-5 + 0.2 * 1e-4 + 0.1 * 4e-4 + 1e-9;
  const double omega2 = gravity * (0.2 * 0.01 + 0.1 * 0.02) / about_axis;
  const nlohmann::json all = found(pendulum);
  const double expected = limit_of_oscillator(omega2, link_damping);
  EXPECT_NEAR(all["h_max"].get<double>() / expected, 1, 1e-4);
  EXPECT_EQ(all["owner"]["kind"], "gravity");
  EXPECT_NEAR(all["owner"]["share"].get<double>(), 1, 5e-3);
  // Turned as a whole about the vertical nothing changes.
  std::string turned = pendulum;
  turned.replace(turned.find("rpy=\"0 0 0\""), 11, "rpy=\"0 0 0.7\"");
  EXPECT_NEAR(found(turned)["h_max"].get<double>() / expected, 1, 1e-4);
  // Turned upside down it falls to where it hangs.
  std::string above = pendulum;
  above.replace(above.find("rpy=\"0 0 0\""), 11, "rpy=\"0 2.5 0\"");
  const nlohmann::json fallen = found(above);
  EXPECT_EQ(fallen["state"], "equilibrium");
}

TEST_F(ProbeBullet, ABaseIsFreeUnlessItIsHeld) {
  const std::string cart =
      robot(link("chassis", 1) + link("arm", 0.5) +
            joint("slide", "prismatic", "chassis", "arm", R"(<axis xyz="0 1 0"/><dynamics damping="100"/>)"));
  const nlohmann::json loose = found(cart);
  EXPECT_TRUE(says(loose["engine"].get<std::string>(), ", free"));
  EXPECT_EQ(loose["dim"], 15);
  EXPECT_NEAR(loose["h_max"].get<double>(), 2 / (100 / 1.0 + 100 / 0.5 + link_damping), 1e-6);
  const nlohmann::json fixed = found(cart, "--support chassis");
  EXPECT_EQ(fixed["dim"], 2);
  EXPECT_NEAR(fixed["h_max"].get<double>(), 2 / (100 / 0.5 + link_damping), 1e-6);
  expect_refused(probe(cart, "--support arm"), "the base of the robot is 'chassis'");
  // What has no <inertial> weighs 1 kg.
  std::string bare = cart;
  bare.replace(bare.find("<link name=\"arm\">"), link("arm", 0.5).size() - 1, "<link name=\"arm\"/>");
  const nlohmann::json guessed = found(bare, "--support chassis");
  EXPECT_TRUE(says(guessed["engine"].get<std::string>(), "1 link without <inertial> taken as 1 kg"));
  EXPECT_NEAR(guessed["h_max"].get<double>(), 2 / (100 + link_damping), 1e-5);
}

TEST_F(ProbeBullet, ASoftBodyHasTheLimitOfItsFastestMode) {
  // Without damping symplectic Euler; the linear force is that of fem_corotational.
  const double h = limit_of_hmax("--set E=6000 --set nu=0.3");
  const nlohmann::json linear = body(held + "--model fem_corotational --set E=6000 --set nu=0.3");
  EXPECT_EQ(linear["dim"], 12);
  EXPECT_EQ(linear["state"], "equilibrium");
  EXPECT_NEAR(linear["h_max"].get<double>() / h, 1, 1e-4);
  EXPECT_NEAR(linear["observed"].get<double>() / h, 1, 1e-3);
  EXPECT_EQ(linear["owner"]["kind"], "elasticity");
  EXPECT_NEAR(linear["owner"]["share"].get<double>(), 1, 1e-3);
  const double ratio = h * 240;
  EXPECT_NEAR(linear["owner"]["stiffness"]["largest"].get<double>() / (6000 * ratio * ratio), 1, 5e-3);
  // Damping is implicit: h^2 w^2 = 4 + 2 h beta w^2.
  const double beta = 0.003;
  const nlohmann::json damped =
      body(held + "--model fem_corotational --set E=6000 --set nu=0.3 --set beta=0.003");
  EXPECT_NEAR(damped["h_max"].get<double>() / (beta + std::sqrt(beta * beta + h * h)), 1, 1e-3);
  // Weight makes it settle first.
  const nlohmann::json heavy = body(held + "--model fem_corotational --set E=6000 --set nu=0.3 --set g=9.81");
  EXPECT_EQ(heavy["state"], "equilibrium");
  EXPECT_GT(std::abs(heavy["h_max"].get<double>() / h - 1), 1e-5);
  EXPECT_NEAR(heavy["h_max"].get<double>() / h, 1, 0.02);
}

TEST_F(ProbeBullet, TheNeoHookeanForceIsSofterThanItsNumbers) {
  // Its mu and lambda are 3/4 mu and lambda - 5/8 mu at rest [smith2018stable].
  const double E = 6000, nu = 0.3, mu = E / (2 * (1 + nu)), lambda = E * nu / ((1 + nu) * (1 - 2 * nu));
  const double mu_at_rest = mu * 3 / 4, lambda_at_rest = lambda - mu * 5 / 8;
  const double young_at_rest =
      mu_at_rest * (3 * lambda_at_rest + 2 * mu_at_rest) / (lambda_at_rest + mu_at_rest);
  const double nu_at_rest = lambda_at_rest / (2 * (lambda_at_rest + mu_at_rest));
  const double expected =
      limit_of_hmax("--set E=" + std::to_string(young_at_rest) + " --set nu=" + std::to_string(nu_at_rest));
  EXPECT_NEAR(body(held + "--set E=6000 --set nu=0.3")["h_max"].get<double>() / expected, 1, 1e-4);
  // Free, and of six rigid motions.
  const nlohmann::json free = body("--unit m --set E=6000 --set nu=0.3");
  EXPECT_EQ(free["dim"], 30);
  EXPECT_TRUE(says(free["engine"].get<std::string>(), ", free"));
  // Of a unit, a modulus or a mass that is not meant this tells.
  EXPECT_TRUE(says(free["engine"].get<std::string>(), "of E 6000 Pa, nu 0.3, "));
  EXPECT_TRUE(says(body("--unit mm")["engine"].get<std::string>(), "of E 5500 Pa, nu 0.45, "));
  EXPECT_LT(std::abs(free["gap"].get<double>()), 5e-3);
}

TEST_F(ProbeBullet, ContinuousJointsHaveNoLimits) {
  const auto limit = [&](const std::string& more) {
    return found(robot(world_link + link("a", 1, "0 0 -0.1") +
                       joint("j", "continuous", "world", "a", "<dynamics damping=\"5\"/>" + more)))["h_max"];
  };
  EXPECT_TRUE(limit("").is_number());
  EXPECT_EQ(limit("<limit lower=\"0\" upper=\"0\"/>"), limit(""));
}

TEST_F(ProbeBullet, RefusesWhatItDoesNotUnderstandByItsLine) {
  const std::string good = joint("j", "continuous", "world", "a", "");
  const auto refused = [&](const std::string& parts, const std::string& why) {
    expect_refused(probe(robot(parts)), why);
  };
  refused(world_link + link("a", 1) + joint("j", "floating", "world", "a", ""),
          "robot.urdf: the robot, line 5: joint 'j' is of type 'floating'");
  refused(world_link + link("a", 1) + joint("j", "continuous", "world", "b", ""),
          "joint 'j' has no link 'b'");
  refused(world_link + link("a", 1) + good + "<spring/>\n", "line 6: <spring> in <robot> is not understood");
  refused(world_link + link("a", 1) + joint("j", "continuous", "world", "a", "<axis xyz=\"0 0 0\"/>"),
          "the axis of joint 'j' has no length");
  refused(world_link + link("a", 1) + joint("j", "continuous", "world", "a", "<axis xyz=\"0 1\"/>"),
          "axis has 2 numbers of xyz and should have 3");
  refused(world_link + link("a", 1, "0 1-2") + good, "xyz should be a number and is '1-2'");
  refused(world_link + link("a", 1) + joint("j", "continuous", "world", "a", "<dynamics damping=\"much\"/>"),
          "damping should be a number and is 'much'");
  refused(world_link + link("a", -1) + good, "line 4: link 'a' has a negative mass");
  refused(world_link + link("a", 1) + link("a", 1), "link 'a' is there twice");
  refused(world_link + link("a", 1), "link 'world' has no parent");
  refused(world_link + link("a", 1) + good + joint("k", "fixed", "a", "world", ""),
          "its links form a circle");
  refused(world_link + link("a", 1) + good + joint("k", "fixed", "world", "a", ""),
          "link 'a' has two parents");
  refused(world_link + link("a", 1) + joint("j", "fixed", "world", "a", ""), "nothing in the scene moves");
  refused("", "it has no link");
  expect_refused(probe("<robot name=\"r\">\n<link"), "robot.urdf: the robot, line 2: ");
  expect_refused(probe("<mujoco/>"), "the file is one robot with all others in it, and not 'mujoco'");
  expect_refused(probe(""), "robot.urdf: ");
}

TEST_F(ProbeBullet, RefusesOptionsOfOtherScenes) {
  const std::string sled = robot(world_link + link("a", 1) + joint("j", "prismatic", "world", "a", ""));
  expect_refused(probe(sled, "--set E=1"), "--set is one of a soft body of Bullet");
  expect_refused(probe(sled, "--keyframe home"), "--keyframe is one of a scene of MuJoCo");
  expect_refused(shell_.hmax("probe body.vtk"), "does not say its unit");
  expect_refused(shell_.hmax("probe body.vtk --unit m --model fem_green"), "choose fem_neo_hookean or");
  expect_refused(shell_.hmax("probe body.vtk --unit m --set alpha=1"), "has no damping alpha");
  expect_refused(shell_.hmax("probe body.vtk --unit m --support 'z>7'"), "z>7");
  expect_refused(shell_.hmax("probe --plugin body.vtk --h0 1 --h1 2"), "a mesh alone is no scene");
  expect_refused(shell_.hmax("probe --plugin a.so --set E=1 --h0 1 --h1 2"), "are of a scene; remove them");
  write_text(shell_ / "none.vtk", "nothing");
  expect_refused(shell_.hmax("probe none.vtk --unit m"), "none.vtk");
}

TEST_F(ProbeBullet, AHangIsAnError) {
  // A rope that swings for a minute of the engine's time.
  std::string rope = world_link + link("n0", 0.1, "0 0 -0.1"), before = "n0";
  rope += joint("j0", "continuous", "world", "n0", R"(<origin rpy="0 1 0"/><axis xyz="0 1 0"/>)");
  for (int i = 1; i < 40; ++i) {
    const std::string name = "n" + std::to_string(i);
    rope += link(name, 0.1, "0 0 -0.1") + joint("j" + std::to_string(i), "continuous", before, name,
                                                R"(<origin xyz="0 0 -0.1"/><axis xyz="0 1 0"/>)");
    before = name;
  }
  expect_refused(probe(robot(rope), "--timeout 0.05"), "Bullet did not return within 0.05 s in create()");
}

}  // namespace
}  // namespace hmax
