/// Bodies that meet tools: the bits of the processor.
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "catalogue/device/body_on_device.hpp"
#include "catalogue/device/device_run.hpp"
#include "catalogue/device/host_device.hpp"
#include "tests/catalogue/device/device_runs.hpp"
#include "tests/catalogue/device/gpu.hpp"

namespace hmax {
namespace {

using namespace device_tests;

/// Above the loaded end of uneven_body(), into which it dips for the first hundredth of a second.
SphereTool dipping_tool(double damping = 0) {
  return {.radius = 0.03,
          .start = {0.12, 0.05, 0.131},
          .travel = {0.002, 0.001, -0.012},
          .profile = {.kind = TimeProfile::Kind::sine, .omega = 300},
          .stiffness = 1e7,
          .damping = damping};
}
/// Beside it, on some of the same triangles.
SphereTool pushing_tool(double damping = 0) {
  return {.radius = 0.02,
          .start = {0.11, 0.045, 0.118},
          .travel = {0.003, 0, -0.004},
          .profile = {.kind = TimeProfile::Kind::ramp, .start = 0.001, .rise = 0.01},
          .stiffness = 2e7,
          .damping = damping};
}
/// On the held end of uneven_body(); it stands still, some way inside.
SphereTool standing_tool(double damping = 0) {
  return {.radius = 0.03, .start = {0.015, 0.05, 0.124}, .stiffness = 1e7, .damping = damping};
}

Problem with_tools(const Problem& body, std::vector<SphereTool> tools) {
  TissueSettings settings = body.body->settings();
  settings.tools = std::move(tools);
  Problem problem = body_of(body.body->mesh(), settings);
  problem.y0 = body.y0;
  return problem;
}

/// Tools that touch and leave, damp, are two, meet a skin, and points that are held or move.
std::vector<Problem> bodies_with_tools() {
  constexpr auto membrane = SkinSettings::Kind::membrane, springs = SkinSettings::Kind::springs;
  return {with_tools(uneven_body(2.5), {dipping_tool()}),
          with_tools(uneven_body(0), {dipping_tool(0.7)}),
          with_tools(uneven_body(0), {standing_tool(3)}),
          with_tools(uneven_body(0), {dipping_tool(), pushing_tool()}),
          with_tools(driven_body(), {pushing_tool(0.4), dipping_tool(2), standing_tool()}),
          with_tools(uneven_body(2.5, "fem_green", membrane), {dipping_tool(), pushing_tool(0.3)}),
          with_tools(uneven_body(0, "mass_spring", springs), {pushing_tool(0.5), dipping_tool()}),
          with_tools(damped_body(2.5, 1e-4), {dipping_tool(), pushing_tool(0.2)}),
          with_tools(moving_body(1e-4), {standing_tool(2), dipping_tool()}),
          with_tools(moving_body(0, "fem_cauchy", membrane), {standing_tool(1), pushing_tool(1)}),
          with_tools(uneven_body(2.5, "fem_neo_hookean"), {dipping_tool(0.5)}),
          with_tools(fibrous_body(uneven_body(2.5, "fem_corotational")), {pushing_tool()}),
          with_tools(uneven_body(2.5, "fem_quadratic"), {dipping_tool(0.5), standing_tool()})};
}

TEST_P(EveryDevice, StepsBodiesWithToolsWithTheBitsOfTheProcessor) {
  std::vector<Problem> bodies = bodies_with_tools();
  bodies.push_back(with_tools(uneven_body(2.5, "fem_nodal_pressure"), {dipping_tool(0.5), pushing_tool()}));
  for (const char* method : {"symplectic_euler", "velocity_verlet", "stormer_verlet", "central_difference",
                             "rk4", "dormand_prince_54"})
    for (const Problem& body : bodies) expect_same(device(), body, method, {.t_end = 0.0203, .h = 3e-4});
  expect_same(device(), bodies[4], "rk4", {.t_end = 0.0603, .h = 3e-4}, 1000);  // long enough for graphs
  for (const char* id : {"fem_green/tool@liver", "mass_spring/tool@phantom", "fem_neo_hookean/tool@ball"})
    expect_same(device(), make_problem(id, {.parameters = {{"tool_damping", 0.5}, {"alpha", 1}}}),
                "symplectic_euler", {.t_end = 0.0502, .h = 1e-4}, 100);
}

TEST_P(EveryDevice, ChoosesStepsWithToolsWithTheBitsOfTheProcessor) {
  for (const char* method : {"ode45", "bogacki_shampine_32"})
    for (const Problem& body : bodies_with_tools())
      expect_same_chosen(device(), body, method, {.t_end = 0.02, .rtol = 1e-4, .atol = 1e-7});
  for (const char* method : {"rkc_2", "rkl_2"})
    for (const Problem& body : {with_tools(uneven_body(2.5), {dipping_tool(), pushing_tool()}),
                                with_tools(uneven_body(2.5, "fem_cauchy"), {dipping_tool()}),
                                with_tools(uneven_body(0, "mass_spring"), {standing_tool()})}) {
      expect_same_chosen(device(), body, method, {.t_end = 0.02, .rtol = 1e-3, .atol = 1e-6});
      expect_same(device(), body, method, {.t_end = 0.0203, .h = 1e-3}, 3);
    }
}

/// The bound that stabilised methods choose their stages by, of a tool that outweighs the elements: where it
/// is at that time.
TEST_P(EveryDevice, FollowsTheSpectralRadiusWithToolsWithTheBitsOfTheProcessor) {
  SphereTool hard = dipping_tool();
  hard.stiffness = 1e10;
  for (const char* model : {"fem_cauchy", "fem_green"}) {
    const Problem problem = with_tools(uneven_body(2.5, model), {hard, pushing_tool()});
    BodyOnDevice<double> there(device(), *problem.body, *device_method(find_method("rkc_2")));
    there.set({&problem.y0, 1});
    double last = 0;
    for (const double t : {0.0, 0.003, 0.005}) {
      there.find_radius(there.step().q, t);
      const double longest = there.longest_step();
      EXPECT_EQ(longest, longest_stabilized_step<Rkc2>(problem.body->spectral_radius(t, problem.y0)))
          << model << " at " << t;
      EXPECT_NE(longest, last);
      last = longest;
    }
  }
}

TEST_P(EveryDevice, StepsTruncatedNewtonWithToolsWithTheBitsOfTheProcessor) {
  for (const char* method : {"newton_truncated", "newton_truncated:iterations=1,cg=20",
                             "newton_truncated:iterations=3,substeps=2,cg=4",
                             "newton_truncated:iterations=2,substeps=2,cg=6,frozen=1"})
    for (const Problem& body : bodies_with_tools())
      expect_same(device(), body, method, {.t_end = 0.0201, .h = 0.001}, 3);
  expect_same(device(), make_problem("fem_green/tool@liver", {.parameters = {{"tool_damping", 0.5}}}),
              "newton_truncated", {.t_end = 0.1, .h = 0.01}, 3);
  expect_same(device(), with_tools(uneven_body(0, "fem_nodal_pressure"), {dipping_tool(), standing_tool()}),
              "newton_truncated:frozen=1", {.t_end = 0.0201, .h = 0.001}, 3);
}

/// What the tools above do to the bodies: without it nothing of them would be compared.
TEST(Tools, OfTheseRunsTouchAndLeave) {
  const auto penetration = [](const Problem& problem, double t) {
    const RunRecord run = find_method("rk4").bind(problem).run({.t_end = t, .h = 1e-4}, {});
    EXPECT_EQ(run.outcome, Outcome::reached_end);
    std::vector<double> all;
    for (const ToolContact::Reach& reach : problem.body->tool_reaches(t, run.y))
      all.push_back(reach.penetration);
    return all;
  };
  const Problem both = with_tools(driven_body(), {dipping_tool(), pushing_tool(), standing_tool()});
  const std::vector<double> early = penetration(both, 0.004), late = penetration(both, 0.02);
  for (const double depth : early) EXPECT_GT(depth, 1e-4);
  EXPECT_EQ(late[0], 0);
  EXPECT_GT(late[1], 1e-4);
  EXPECT_GT(late[2], 1e-4);
}

TEST_P(EveryDevice, StepsBodiesWithToolsAtATimeAsEachAlone) {
  for (const char* method : {"symplectic_euler", "velocity_verlet", "central_difference", "rk4"})
    for (const Problem& body : {with_tools(driven_body(), {dipping_tool(0.5), pushing_tool()}),
                                with_tools(moving_body(1e-5, "mass_spring"), {standing_tool(1)})})
      expect_same_at_a_time(device(), body, method, 5);
  expect_same_at_a_time<float>(device(), with_tools(driven_body(), {dipping_tool(0.5)}), "rk4", 3);
}

TEST(HostDevice, ErrsInSinglePrecisionByItsRoundingWithTools) {
  const Problem body = with_tools(uneven_body(2.5), {dipping_tool(0.5), pushing_tool()});
  for (const char* method : {"symplectic_euler", "central_difference", "rk4"}) {
    const double error = error_of_single(body, method, {.t_end = 0.02, .h = 1e-4});
    EXPECT_LT(error, 1e-5) << method;
    EXPECT_GT(error, 1e-8) << method;
  }
}

TEST(HostDevice, CountsTheLooksAtTools) {
  HostDevice device;
  const auto run = [&](const Problem& problem, const char* method) {
    return run_on_device(device, problem, find_method(method), {.t_end = 1e-2, .h = 1e-3});
  };
  for (const char* method : {"symplectic_euler", "newton_truncated"}) {
    const DeviceRun none = run(uneven_body(1), method),
                    one = run(with_tools(uneven_body(1), {dipping_tool()}), method),
                    two = run(with_tools(uneven_body(1), {dipping_tool(), pushing_tool()}), method);
    EXPECT_GT(one.flops, none.flops);
    EXPECT_DOUBLE_EQ(two.flops - one.flops, one.flops - none.flops);
    EXPECT_DOUBLE_EQ(two.bytes - one.bytes, one.bytes - none.bytes);
  }
}

}  // namespace
}  // namespace hmax
