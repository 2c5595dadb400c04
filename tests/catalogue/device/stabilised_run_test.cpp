/// Runs of stabilised methods by the programs of devices: the bits of the processor.
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "catalogue/device/body_on_device.hpp"
#include "catalogue/device/host_device.hpp"
#include "tests/catalogue/device/device_runs.hpp"
#include "tests/catalogue/device/gpu.hpp"

namespace hmax {
namespace {

using namespace device_tests;

/// Fixed steps: of several models, damping and loads, of two stages and of many.
TEST_P(EveryDevice, StepsStabilisedMethodsWithTheBitsOfTheProcessor) {
  const auto skin = SkinSettings::Kind::springs;
  const auto each = [&](const Problem& problem, const RunSpec& spec, std::int64_t least_stages = 2) {
    for (const char* method : {"rkc_2", "rkl_2"}) {
      const RunRecord run = expect_same(device(), problem, method, spec, 3);
      EXPECT_EQ(run.outcome, Outcome::reached_end) << problem.id << ", " << method;
      EXPECT_GE(run.stats.rhs, least_stages * run.stats.steps) << problem.id << ", " << method;
    }
  };
  for (const Problem& body :
       {uneven_body(2.5), uneven_body(0, "mass_spring"), uneven_body(2.5, "fem_green", skin),
        uneven_body(2.5, "fem_cauchy"), uneven_body(0, "fem_cauchy", skin),
        uneven_body(2.5, "fem_neo_hookean"), uneven_body(2.5, "fem_corotational"), pressed_body(pressed[0]),
        driven_body(), driven_body(uneven_body(2.5, "fem_quadratic")), fibrous_body(uneven_body(2.5)),
        fibrous_body(uneven_body(2.5, "fem_cauchy")),
        fibrous_body(driven_body(uneven_body(0, "fem_neo_hookean")), true),
        fibrous_body(driven_body(uneven_body(2.5, "fem_nodal_pressure")))})
    each(body, {.t_end = 0.01001, .h = 1e-4});  // its last step is a sliver
  for (const auto& [mesh, parameters] : std::vector<std::pair<const char*, Parameters>>{
           {"fem_green@liver", {{"g", 9.81}, {"beta", 0.01}}},
           {"fem_green@cube:n=5", {{"g", 9.81}, {"alpha", 1}, {"beta", 0.1}}},
           {"mass_spring@beam", {{"g", 9.81}, {"beta", 0.1}}},
           {"fem_neo_hookean@ball", {{"g", 9.81}, {"alpha", 1}, {"beta", 0.1}}},
           {"fem_corotational@beam", {{"g", 9.81}, {"alpha", 1}, {"beta", 0.1}}},
           {"fem_cauchy@cube:n=2", {{"g", 9.81}, {"alpha", 1}, {"beta", 0.1}}},
           {"fem_cauchy@phantom", {{"g", 9.81}, {"alpha", 1}, {"beta", 0.1}}},
           {"fem_nodal_pressure@liver", {{"g", 9.81}, {"beta", 0.01}}},
           {"fem_quadratic@cube:n=2", {{"g", 9.81}, {"alpha", 1}, {"beta", 0.1}}}})
    each(make_problem(mesh, {.parameters = parameters}), {.t_end = 0.0503, .h = 5e-3}, 7);
  each(fibrous.on("@liver", {{"g", 9.81}, {"beta", 0.01}}), {.t_end = 0.0503, .h = 5e-3}, 7);
  const RunRecord stiffer =
      expect_same(device(), make_problem("fem_green@cube:n=3", {.parameters = {{"g", 200}, {"beta", 1e-3}}}),
                  "rkc_2", {.t_end = 0.06, .h = 0.002});
  EXPECT_NE((stiffer.stats.rhs - 1) % stiffer.stats.steps, 0) << "all steps have the same number of stages";
}

/// The bound that they choose their stages by, which their longest step tells to the last bits.
TEST_P(EveryDevice, BoundsTheSpectralRadiusWithTheBitsOfTheProcessor) {
  const auto expect_it = [&](const Problem& problem) {
    const Eigen::VectorXd y = problem.y0 + 1e-3 * Eigen::VectorXd::LinSpaced(problem.y0.size(), -1, 1);
    BodyOnDevice<double> there(device(), *problem.body, *device_method(find_method("rkc_2")));
    there.set({&y, 1});
    there.find_radius(there.step().q, 0);
    EXPECT_EQ(there.longest_step(), longest_stabilized_step<Rkc2>(problem.body->spectral_radius(0, y)));
  };
  for (const char* model : {"fem_green", "fem_cauchy", "fem_neo_hookean", "fem_corotational",
                            "fem_nodal_pressure", "fem_quadratic", "mass_spring"}) {
    for (const double beta : {0.0, 0.01})
      expect_it(make_problem(std::string(model) + "@liver", {.parameters = {{"beta", beta}}}));
    if (model != std::string("mass_spring")) {
      expect_it(uneven_body(0, model, SkinSettings::Kind::springs));
      expect_it(fibrous_body(uneven_body(0, model), true));
      expect_it(fibrous_body(uneven_body(0, model, SkinSettings::Kind::springs)));
    }
    expect_it(uneven_body(0, model, SkinSettings::Kind::membrane));
    expect_it(make_problem(std::string(model) + "@cube:n=3", {.parameters = {{"support_stiffness", 1e4}}}));
  }
}

/// Chosen steps: of several models, loads, tolerances and controllers.
TEST_P(EveryDevice, ChoosesStabilisedStepsWithTheBitsOfTheProcessor) {
  std::int64_t rejected = 0;
  const auto each = [&](const Problem& problem, const RunSpec& spec) {
    for (const char* method : {"rkc_2", "rkl_2"}) {
      const RunRecord run = expect_same_chosen(device(), problem, method, spec);
      EXPECT_EQ(run.outcome, Outcome::reached_end) << problem.id << ", " << method;
      rejected += run.stats.rejected;
    }
  };
  for (const double rtol : {1e-1, 1e-3, 1e-5}) {
    const RunSpec spec{.t_end = 0.02, .rtol = rtol, .atol = 1e-3 * rtol};
    for (const char* model : {"fem_green", "fem_cauchy", "fem_neo_hookean", "fem_corotational",
                              "fem_nodal_pressure", "fem_quadratic", "mass_spring"})
      each(uneven_body(2.5, model), spec);
    each(driven_body(), spec);
  }
  each(make_problem("fem_green@liver", {.parameters = {{"g", 9.81}, {"beta", 0.1}}}),
       {.t_end = 0.1, .rtol = 1e-3, .atol = 1e-6, .h_first = 0.1});
  for (const Controllers control :
       {Controllers::i, Controllers::pi, Controllers::deadband, Controllers::matlab})
    each(driven_body(), {.t_end = 0.05, .rtol = 1e-4, .atol = 1e-7, .control = control});
  EXPECT_GT(rejected, 20);
  // Steps as long as the most stages are stable with.
  each(make_problem("fem_green@cube:n=1", {.parameters = {{"g", 9.81}, {"beta", 1}}}),
       {.t_end = 1e4, .rtol = 1, .atol = 1});
}

TEST(HostDevice, FollowsTheSpectralRadiusUntilBothDiverge) {
  HostDevice device;
  for (const char* model : {"fem_green@beam", "fem_neo_hookean@beam", "fem_cauchy@beam"})
    for (const double h : {0.02, 0.1}) {
      const RunRecord run = expect_same(device, make_problem(model, {.parameters = {{"g", 9.81}}}), "rkc_2",
                                        {.t_end = 400, .h = h});
      EXPECT_EQ(run.outcome, Outcome::diverged) << model << ", " << h;
    }
}

}  // namespace
}  // namespace hmax
