/// Runs of springs that are neither linear nor cubic by the programs of devices: the bits of the processor.
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tests/catalogue/device/device_runs.hpp"
#include "tests/catalogue/device/gpu.hpp"

namespace hmax {
namespace {

using namespace device_tests;

Problem of_law(const Problem& body, const SpringLaw& law) {
  TissueSettings settings = body.body->settings();
  settings.springs.law = law;
  Problem problem = body_of(body.body->mesh(), settings);
  problem.y0 = body.y0;
  return problem;
}

/// Stiffer and softer the longer; a table that springs leave on both sides, and one of a single line.
std::vector<SpringLaw> laws() {
  return {ExponentialSpring{60}, ExponentialSpring{-40},
          TableSpring({-0.02, -0.006, 0.003, 0.01, 0.02}, {-0.05, -0.01, 0.005, 0.03, 0.1}),
          TableSpring({-0.5, 0.5}, {-0.75, 0.75})};
}

/// Where some springs are stretched, others are pressed.
Problem shaken(Problem problem) {
  problem.y0 = tissue_tests::random_vector(problem.y0.size(), 0.002, 5);
  return problem;
}

const auto skin_of_springs = SkinSettings::Kind::springs, skin_of_triangles = SkinSettings::Kind::membrane;

TEST_P(EveryDevice, StepsSpringsOfAnyLawWithTheBitsOfTheProcessor) {
  for (const SpringLaw& law : laws())
    for (const char* method : {"symplectic_euler", "velocity_verlet", "central_difference", "rk4", "ode45"}) {
      for (const Problem& body : {shaken(uneven_body(0, "mass_spring")), damped_body(2.5, 0),
                                  damped_body(0, 1e-4), moving_body(1e-4, "mass_spring", skin_of_springs),
                                  shaken(uneven_body(2.5, "mass_spring", skin_of_triangles))})
        expect_same(device(), of_law(body, law), method, {.t_end = 0.0203, .h = 3e-4});
      for (const Eigen::Vector3d& F : pressed)
        expect_same(device(), of_law(pressed_body(F, "mass_spring"), law), method,
                    {.t_end = 1e-3, .h = 1e-5});
    }
  for (const SpringLaw& law : laws())
    expect_same_chosen(device(), of_law(damped_body(2.5, 0), law), "ode45",
                       {.t_end = 0.02, .rtol = 1e-5, .atol = 1e-8});
}

/// Those that need the stiffness, and points that are moved one after the other.
TEST_P(EveryDevice, SolvesSpringsOfAnyLawWithTheBitsOfTheProcessor) {
  const RunSpec spec{.t_end = 0.1001, .h = 0.01};  // its last step is a sliver
  for (const SpringLaw& law : laws()) {
    for (const char* method : {"newton_truncated", "newton_truncated:iterations=3,substeps=2,cg=4",
                               "newton_truncated:iterations=2,cg=6,frozen=1"})
      for (const Problem& body : {shaken(uneven_body(0, "mass_spring")), damped_body(2.5, 1e-4),
                                  moving_body(1e-3, "mass_spring", skin_of_springs),
                                  shaken(uneven_body(2.5, "mass_spring", skin_of_triangles))})
        expect_same(device(), of_law(body, law), method, spec, 3);
    for (const char* method : {"rkc_2", "rkl_2"})
      for (const auto skin : {skin_of_springs, skin_of_triangles})
        expect_same(device(), of_law(shaken(uneven_body(2.5, "mass_spring", skin)), law), method,
                    {.t_end = 0.01001, .h = 1e-4}, 3);
    expect_same(device(), of_law(shaken(driven_body(uneven_body(2.5, "mass_spring"))), law),
                "vbd:iterations=3,substeps=2,rho=0.5", spec, 3);
  }
}

/// As the command has them, in many patches.
TEST_P(EveryDevice, StepsSpringsOfAnyLawOnMeshesWithTheBitsOfTheProcessor) {
  for (const auto& [mesh, parameters] : std::vector<std::pair<const char*, Parameters>>{
           {"mass_spring@liver", {{"g", 9.81}, {"exponential", 30}}},
           {"mass_spring@liver", {{"g", 9.81}, {"phi:-0.01", -0.02}, {"phi:0.001", 0.001}, {"phi:0.1", 1}}}})
    for (const char* method : {"symplectic_euler", "rk4", "newton_truncated", "rkc_2", "vbd"})
      expect_same(device(), make_problem(mesh, {.parameters = parameters}), method,
                  {.t_end = 0.0051, .h = 1e-4});
}

}  // namespace
}  // namespace hmax
