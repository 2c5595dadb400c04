/// Runs by the programs of devices: the bits of the processor, on the processor in every build and on a card
/// where there is one.
#include "catalogue/device/device_run.hpp"

#include <algorithm>
#include <cstdint>
#include <memory>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "catalogue/device/body_on_device.hpp"
#include "catalogue/device/host_device.hpp"
#include "catalogue/device/patches/body_patches.hpp"
#include "catalogue/device/programs/point_step.hpp"
#include "core/errors.hpp"
#include "integrators/explicit/tableaux.hpp"
#include "problems/tissue/positional_body.hpp"
#include "tests/catalogue/device/device_runs.hpp"
#include "tests/catalogue/device/gpu.hpp"

namespace hmax {
namespace {

using namespace device_tests;

TEST_P(EveryDevice, StepsBodiesWithTheBitsOfTheProcessor) {
  const RunSpec spec{.t_end = 0.0202, .h = 1e-4};  // its last step is a sliver of rounding
  for (const char* mesh : {"liver", "beam", "ball", "phantom", "cube:n=6"})
    expect_same(device(), make_problem(std::string("fem_green@") + mesh, {.parameters = {{"g", 9.81}}}),
                "symplectic_euler", spec);
  expect_same(device(), make_problem("fem_green/press@liver", {.parameters = {{"alpha", 3}}}),
              "velocity_verlet", {.t_end = 0.01234, .h = 1e-4});
  for (const char* method : {"symplectic_euler", "velocity_verlet"})
    for (const Problem& body :
         {uneven_body(2.5), uneven_body(2.5, "mass_spring"),
          uneven_body(2.5, "mass_spring", SkinSettings::Kind::springs),
          uneven_body(2.5, "fem_green", SkinSettings::Kind::springs), uneven_body(2.5, "fem_cauchy"),
          uneven_body(2.5, "fem_neo_hookean"), uneven_body(2.5, "fem_corotational"),
          uneven_body(2.5, "fem_corotational", SkinSettings::Kind::springs)})
      expect_same(device(), body, method, {.t_end = 0.0203, .h = 3e-4});
  for (const auto& [mesh, parameters] : std::vector<std::pair<const char*, Parameters>>{
           {"mass_spring@liver", {{"g", 9.81}}},
           {"mass_spring@cube:n=5", {{"g", 9.81}, {"alpha", 2}}},
           {"fem_green@liver", {{"g", 9.81}, {"alpha", 1}, {"beta", 1e-4}}},
           {"mass_spring@beam", {{"g", 9.81}, {"beta", 2e-5}}},
           {"mass_spring@ball", {{"g", 9.81}}},
           {"mass_spring@phantom", {{"g", 9.81}, {"cubic", 50}, {"skin", 300}}},
           {"mass_spring@liver", {{"g", 9.81}, {"damper", 1e-4}, {"beta", 2e-5}}},
           {"mass_spring@cube:n=6", {{"g", 9.81}, {"damper", 1e-4}, {"skin", 300}, {"alpha", 1}}},
           {"fem_cauchy@phantom", {{"g", 9.81}, {"beta", 1e-4}}},
           {"fem_corotational@phantom", {{"g", 9.81}, {"beta", 1e-4}}},
           {"fem_corotational@liver", {{"g", 9.81}, {"alpha", 1}}},
           {"fem_neo_hookean@liver", {{"g", 9.81}, {"alpha", 1}}}})
    for (const char* method : {"symplectic_euler", "velocity_verlet", "stormer_verlet", "central_difference"})
      expect_same(device(), make_problem(mesh, {.parameters = parameters}), method, spec);
  for (const char* method : {"stormer_verlet", "central_difference"})
    for (const double alpha : {0.0, 2.5})
      expect_same(device(), uneven_body(alpha), method, {.t_end = 0.0203, .h = 3e-4});
  for (const Eigen::Vector3d& F : pressed)
    for (const char* method : {"symplectic_euler", "rk4"})
      expect_same(device(), pressed_body(F), method, {.t_end = 0.00103, .h = 1e-5});
}

/// Skins, dampers, supports that move, springs that hold.
TEST_P(EveryDevice, StepsTheirPartsWithTheBitsOfTheProcessor) {
  const RunSpec spec{.t_end = 0.0202, .h = 1e-4};
  for (const char* id : {"fem_green@liver", "fem_green@beam", "fem_corotational@ball", "fem_cauchy@phantom",
                         "fem_neo_hookean@cube:n=6"})
    expect_same(device(), make_problem(id, {.parameters = {{"g", 9.81}, {"skin", 30}}}), "symplectic_euler",
                spec);
  for (const char* id :
       {"fem_green/breathing@liver", "fem_neo_hookean/breathing@beam", "mass_spring/breathing@ball",
        "fem_cauchy/breathing@phantom", "fem_corotational/breathing@cube:n=6"})
    for (const double beta : {0.0, 1e-5})
      expect_same(device(), make_problem(id, {.parameters = {{"period", 0.05}, {"beta", beta}}}),
                  "velocity_verlet", spec);
  for (const char* id : {"fem_green@liver", "mass_spring@beam"})
    expect_same(device(), make_problem(id, {.parameters = {{"g", 9.81}, {"support_stiffness", 1e5}}}),
                "central_difference", spec);
  for (const char* method : {"symplectic_euler", "velocity_verlet", "stormer_verlet", "central_difference",
                             "rk4", "dormand_prince_54"})
    for (const Problem& body :
         {damped_body(0, 0), damped_body(2.5, 0), damped_body(2.5, 1e-4), moving_body(0), moving_body(1e-4),
          moving_body(1e-4, "mass_spring", SkinSettings::Kind::springs),
          moving_body(0, "fem_cauchy", SkinSettings::Kind::membrane),
          uneven_body(0, "mass_spring", SkinSettings::Kind::membrane),
          uneven_body(2.5, "fem_neo_hookean", SkinSettings::Kind::membrane)})
      expect_same(device(), body, method, {.t_end = 0.0203, .h = 3e-4});
}

/// Shared pressures of a body that is held at many points, some tetrahedra at all of theirs, of a material
/// that becomes thicker as it is pulled.
Problem held_body() {
  const Problem body = uneven_body(2.5, "fem_nodal_pressure");
  TissueSettings settings = body.body->settings();
  settings.materials[0].poisson = -0.2;
  settings.supports = {{points_in_box(body.body->mesh(), {-1, -1, -1}, {0.06, 1, 1})}};
  return body_of(body.body->mesh(), settings);
}

/// Elements whose forces are not those of tetrahedra alone: fibres in them, shared pressures, ten nodes.
TEST_P(EveryDevice, StepsOtherElementsWithTheBitsOfTheProcessor) {
  const RunSpec spec{.t_end = 0.0042, .h = 1e-4}, uneven{.t_end = 0.0203, .h = 3e-4};
  for (const Parts& parts : {fibrous, of_pressures, of_ten_nodes}) {
    for (const char* mesh : {"@liver", "@beam", "@ball", "@phantom", "@cube:n=6"})
      expect_same(device(), parts.on(mesh), "symplectic_euler", spec);
    expect_same(device(), parts.on("/press@liver", {{"alpha", 3}}), "velocity_verlet",
                {.t_end = 0.00434, .h = 1e-4});
    for (const char* method :
         {"symplectic_euler", "velocity_verlet", "stormer_verlet", "central_difference", "rk4"})
      expect_same(device(), parts.on("@beam", {{"g", 9.81}, {"alpha", 1}, {"beta", 1e-4}}), method, spec);
  }
  for (const Eigen::Vector3d& F : pressed)
    for (const char* method : {"symplectic_euler", "rk4"})
      expect_same(device(), pressed_body(F, fibrous_body(uneven_body(2.5, "fem_corotational"))), method,
                  {.t_end = 0.00103, .h = 1e-5});
  // Fibres of no length have no direction.
  const Parts along_x{"fem_corotational", {{"fibre_E", 2e4}, {"fibre_x", 1}}};
  expect_same(device(), pressed_body({0, 1, 1}, along_x.on("@cube:n=2")), "rk4",
              {.t_end = 0.00103, .h = 1e-5});
  constexpr auto skin = SkinSettings::Kind::springs;
  for (const Problem& body :
       {fibrous_body(uneven_body(2.5), true), fibrous_body(uneven_body(2.5, "fem_green", skin)),
        fibrous_body(uneven_body(2.5, "fem_cauchy")), fibrous_body(uneven_body(2.5, "fem_corotational")),
        fibrous_body(uneven_body(2.5, "fem_neo_hookean")), fibrous_body(driven_body(), true),
        uneven_body(2.5, "fem_nodal_pressure"), uneven_body(0, "fem_nodal_pressure", skin), held_body(),
        fibrous_body(driven_body(uneven_body(2.5, "fem_nodal_pressure"))), uneven_body(2.5, "fem_quadratic"),
        uneven_body(0, "fem_quadratic", skin), fibrous_body(driven_body(uneven_body(2.5, "fem_quadratic")))})
    for (const char* method :
         {"symplectic_euler", "velocity_verlet", "stormer_verlet", "central_difference", "rk4", "ode45"})
      expect_same(device(), body, method, uneven);
}

TEST_P(EveryDevice, StepsUnderDrivenLoadsWithTheBitsOfTheProcessor) {
  for (const char* method : {"symplectic_euler", "velocity_verlet", "stormer_verlet", "central_difference",
                             "rk4", "rk2_heun", "dormand_prince_54", "bogacki_shampine_32"})
    for (const Problem& body : {driven_body(), moving_body(1e-4)})
      expect_same(device(), body, method, {.t_end = 0.0603, .h = 3e-4}, 1000);  // long enough for graphs
  for (const char* method : {"symplectic_euler", "central_difference", "rk4"}) {
    expect_same(device(), make_problem("fem_nodal_pressure/breathing@liver"), method,
                {.t_end = 0.0603, .h = 3e-4}, 1000);
    for (const Problem& body : {moving_body(1e-4, "fem_nodal_pressure", SkinSettings::Kind::membrane),
                                fibrous_body(moving_body(0, "fem_quadratic", SkinSettings::Kind::membrane))})
      expect_same(device(), body, method, {.t_end = 0.0203, .h = 3e-4});
  }
}

/// Every explicit Runge-Kutta method of the house.
TEST_P(EveryDevice, StepsStagesWithTheBitsOfTheProcessor) {
  const auto each = [&](const Problem& problem, const RunSpec& spec) {
    [&]<class... T>(std::type_identity<std::tuple<T...>>) {
      (expect_same(device(), problem, std::string(T::id), spec), ...);
    }(std::type_identity<tableaux::All>{});
  };
  each(uneven_body(2.5, "fem_green", SkinSettings::Kind::springs), {.t_end = 0.0203, .h = 3e-4});
  each(make_problem("mass_spring@cube:n=2", {.parameters = {{"g", 9.81}, {"beta", 2e-5}}}),
       {.t_end = 0.0102, .h = 1e-4});
  for (const char* method : {"rk4", "explicit_euler", "dormand_prince_54"})
    expect_same(device(),
                make_problem("fem_green@liver", {.parameters = {{"g", 9.81}, {"alpha", 1}, {"beta", 1e-4}}}),
                method, {.t_end = 0.0051, .h = 1e-4});
  expect_same(device(), make_problem("fem_green/press@liver"), "rk4", {.t_end = 0.00512, .h = 1e-4});
}

/// Runs of one body in the same memory, the second from the end of the first.
void expect_same_from_two_starts(Device& device, Problem body, const char* id) {
  const Method method = find_method(id),
               there = on_device(method, std::shared_ptr<Device>(&device, [](Device*) {}));
  const RunSpec spec{.t_end = 0.03, .h = 0.01};
  for (int start = 0; start < 2; ++start) {
    const RunRecord expected = method.bind(body).run(spec, {}), found = there.bind(body).run(spec, {});
    EXPECT_EQ(unequal(found.y, expected.y), 0U) << id << ", start " << start;
    body.y0 = expected.y;
  }
}

/// Truncated Newton: of several counts, models, damping and loads.
TEST_P(EveryDevice, StepsTruncatedNewtonWithTheBitsOfTheProcessor) {
  const RunSpec spec{.t_end = 0.1001, .h = 0.01};  // its last step is a sliver
  constexpr const char* few = "newton_truncated";
  constexpr const char* many = "newton_truncated:iterations=3,substeps=2,cg=4";
  const auto skin = SkinSettings::Kind::springs;
  for (const char* method : {few, many})
    for (const Problem& body : {uneven_body(2.5),
                                uneven_body(0, "mass_spring"),
                                uneven_body(2.5, "mass_spring", skin),
                                uneven_body(2.5, "fem_green", skin),
                                uneven_body(2.5, "fem_cauchy"),
                                uneven_body(0, "fem_cauchy", skin),
                                uneven_body(2.5, "fem_neo_hookean"),
                                uneven_body(0, "fem_neo_hookean", skin),
                                uneven_body(2.5, "fem_corotational"),
                                uneven_body(0, "fem_quadratic", skin),
                                driven_body(uneven_body(2.5, "fem_quadratic")),
                                pressed_body(pressed[0], "fem_quadratic"),
                                moving_body(1e-3, "fem_quadratic", SkinSettings::Kind::membrane),
                                pressed_body(pressed[0]),
                                driven_body(),
                                damped_body(0, 0),
                                damped_body(2.5, 1e-4),
                                moving_body(0),
                                moving_body(1e-3, "mass_spring", skin),
                                moving_body(0, "fem_green", SkinSettings::Kind::membrane),
                                uneven_body(2.5, "mass_spring", SkinSettings::Kind::membrane),
                                uneven_body(2.5, "fem_cauchy", SkinSettings::Kind::membrane)})
      expect_same(device(), body, method, spec, 3);
  for (const auto& [mesh, parameters] : std::vector<std::pair<const char*, Parameters>>{
           {"fem_green@liver", {{"g", 9.81}}},
           {"fem_green@cube:n=5", {{"g", 9.81}, {"alpha", 1}, {"beta", 1e-3}}},
           {"mass_spring@beam", {{"g", 9.81}, {"beta", 1e-3}}},
           {"fem_neo_hookean@beam", {{"g", 9.81}, {"alpha", 1}, {"beta", 1e-3}}},
           {"fem_corotational@beam", {{"g", 9.81}, {"alpha", 1}, {"beta", 1e-3}}},
           {"fem_cauchy@phantom", {{"g", 9.81}, {"alpha", 1}, {"beta", 1e-3}}},
           {"fem_quadratic@cube:n=2", {{"g", 9.81}, {"alpha", 1}, {"beta", 1e-3}}}})
    expect_same(device(), make_problem(mesh, {.parameters = parameters}), few, spec, 3);
  for (const double h : {1e-3, 0.01})
    expect_same(device(), of_ten_nodes.on("@cube:n=3"), "newton_truncated:iterations=1,cg=20",
                {.t_end = 8 * h, .h = h}, 3);
  // Frozen, the matrix is that of the processor, of all bodies that have patches.
  constexpr const char* frozen = "newton_truncated:iterations=2,substeps=2,cg=6,frozen=1";
  for (const Problem& body :
       {uneven_body(2.5), uneven_body(2.5, "mass_spring", skin), uneven_body(0, "fem_cauchy", skin),
        uneven_body(2.5, "fem_neo_hookean"), uneven_body(2.5, "fem_nodal_pressure"),
        uneven_body(2.5, "fem_quadratic"), fibrous_body(driven_body()), damped_body(2.5, 1e-4),
        moving_body(1e-3, "mass_spring", skin), moving_body(0, "fem_green", SkinSettings::Kind::membrane)})
    expect_same(device(), body, frozen, spec, 3);
  for (const char* id : {"fem_green@liver", "fem_nodal_pressure@liver", "fem_quadratic@cube:n=2"})
    expect_same(device(), make_problem(id, {.parameters = {{"g", 9.81}, {"beta", 1e-3}}}), frozen, spec, 3);
  expect_same_from_two_starts(device(), uneven_body(2.5), frozen);
  // Conjugate gradients that end at the rounding of the residual.
  const RunRecord solved = expect_same(device(), uneven_body(2.5), "newton_truncated:iterations=2,cg=300",
                                       {.t_end = 0.05, .h = 0.01}, 3);
  EXPECT_LT(solved.stats.linear_iterations, 300 * solved.stats.newton);
  EXPECT_GT(solved.stats.linear_iterations, 10 * solved.stats.newton);
}

/// Linearly implicit Euler at 100 and 1000 Hz, of bodies whose stiffness is not that of tetrahedra alone.
TEST_P(EveryDevice, StepsLinearlyImplicitEulerWithTheBitsOfTheProcessor) {
  constexpr const char* one = "newton_truncated:iterations=1,cg=20";
  constexpr auto skin = SkinSettings::Kind::springs, membrane = SkinSettings::Kind::membrane;
  const std::vector<Problem> bodies{
      fibrous_body(uneven_body(2.5)),
      fibrous_body(uneven_body(0, "fem_cauchy", skin), true),
      fibrous_body(uneven_body(2.5, "fem_corotational")),
      fibrous_body(uneven_body(2.5, "fem_neo_hookean"), true),
      fibrous_body(driven_body()),
      fibrous_body(uneven_body(2.5, "fem_quadratic"), true),
      fibrous_body(moving_body(1e-3, "fem_green", membrane)),
      held_body(),
      uneven_body(0, "fem_nodal_pressure", skin),
      fibrous_body(driven_body(uneven_body(2.5, "fem_nodal_pressure")), true),
      moving_body(1e-3, "fem_nodal_pressure", membrane),
      pressed_body(pressed[0], "fem_nodal_pressure"),
      pressed_body(pressed[0], fibrous_body(uneven_body(0, "fem_corotational")))};
  for (const double h : {0.01, 0.001}) {
    const RunSpec spec{.t_end = 10.01 * h, .h = h};
    for (const Problem& body : bodies) expect_same(device(), body, one, spec, 3);
    for (const Parts& parts : {fibrous, of_pressures})
      for (const char* mesh : {"@liver", "@phantom"})
        expect_same(device(), parts.on(mesh, {{"g", 9.81}, {"beta", 1e-3}}), one, spec, 3);
  }
  for (const Problem& body : bodies)
    expect_same(device(), body, "newton_truncated:iterations=3,substeps=2,cg=4", {.t_end = 0.03, .h = 0.01},
                3);
}

/// Chosen steps: of every method that estimates its error, tolerances and controllers; the liver has
/// several pieces of 256 numbers.
TEST_P(EveryDevice, ChoosesStepsWithTheBitsOfTheProcessor) {
  std::int64_t rejected = 0;
  const auto each = [&](const Problem& problem, const char* id, const RunSpec& spec) {
    const RunRecord run = expect_same_chosen(device(), problem, id, spec);
    EXPECT_EQ(run.outcome, Outcome::reached_end) << id;
    rejected += run.stats.rejected;
  };
  const Problem uneven = uneven_body(2.5, "fem_green", SkinSettings::Kind::springs);
  [&]<class... T>(std::type_identity<std::tuple<T...>>) {
    const auto if_it_estimates = [&]<class Method>(std::type_identity<Method>) {
      if (Method::error_order > 0)
        each(uneven, Method::id.data(),
             {.t_end = 0.02, .rtol = 1e-4, .atol = 1e-7, .h_first = 0.01, .h_max = 0.1});
    };
    (if_it_estimates(std::type_identity<T>{}), ...);
  }(std::type_identity<tableaux::All>{});
  for (const char* method : {"ode45", "dop_853", "bogacki_shampine_32", "fehlberg_78"})
    for (const double rtol : {1e-2, 1e-5, 1e-8}) {
      const RunSpec spec{.t_end = 0.02, .rtol = rtol, .atol = 1e-3 * rtol};
      for (const char* model : {"fem_cauchy", "fem_neo_hookean", "mass_spring"})
        each(uneven_body(2.5, model), method, spec);
      each(driven_body(), method, spec);
      each(moving_body(1e-5, "mass_spring", SkinSettings::Kind::membrane), method, spec);
      each(fibrous_body(driven_body()), method, spec);
      each(uneven_body(2.5, "fem_nodal_pressure"), method, spec);
      each(of_pressures.on("@liver"), method, spec);
      each(uneven_body(2.5, "fem_quadratic"), method, spec);
      each(make_problem("fem_green@liver", {.parameters = {{"g", 9.81}, {"alpha", 1}, {"beta", 1e-5}}}),
           method, spec);
      each(make_problem("mass_spring@cube:n=2", {.parameters = {{"g", 9.81}}}), method, spec);
    }
  for (const Controllers control :
       {Controllers::i, Controllers::pi, Controllers::deadband, Controllers::matlab})
    each(driven_body(), "ode45", {.t_end = 0.05, .rtol = 1e-5, .atol = 1e-8, .control = control});
  each(driven_body(), "dop_853", {.t_end = 0.05, .rtol = 1e-5, .atol = 1e-8, .h_first = 1e-3, .h_max = 2e-3});
  EXPECT_GT(rejected, 20);
}

/// Runs that do not reach their end.
TEST_P(EveryDevice, ChoosesEndsWithTheBitsOfTheProcessor) {
  const Problem beam = make_problem("fem_green@beam", {.parameters = {{"g", 9.81}}});
  const auto expect_end = [&](const Problem& problem, Outcome outcome, const RunSpec& spec) {
    for (const char* method : {"ode45", "dop_853", "rkc_2"})
      EXPECT_EQ(expect_same_chosen(device(), problem, method, spec).outcome, outcome) << method;
  };
  // Tolerances that accept everything.
  expect_end(beam, Outcome::diverged,
             {.t_end = 40, .rtol = 1e100, .atol = 1e100, .h_first = 0.02, .h_max = 0.02});
  expect_end(beam, Outcome::too_many_steps, {.t_end = 1, .rtol = 1e-6, .atol = 1e-9, .max_steps = 30});
  expect_end(driven_body(), Outcome::too_many_steps,
             {.t_end = 1, .rtol = 1e-6, .atol = 1e-9, .max_steps = 30});
  Problem broken = beam;
  broken.y0[7] = 1e200;
  expect_end(broken, Outcome::diverged, {.t_end = 1, .rtol = 1e-6, .atol = 1e-9});
}

Problem of_model(const Problem& body, const char* model, const SpringLaw& law, double beta) {
  TissueSettings settings = body.body->settings();
  settings.model = tissue_model(model);
  settings.springs.law = law;
  settings.beta = beta;
  return body_of(body.body->mesh(), settings);
}

/// Compliant constraints: of several counts, both kinds of elements, damping and loads.
TEST_P(EveryDevice, MeetsConstraintsWithTheBitsOfTheProcessor) {
  const RunSpec spec{.t_end = 0.1001, .h = 0.01};  // its last step is a sliver
  for (const char* method :
       {"xpbd:iterations=1", "xpbd:iterations=4,substeps=3", "xpbd:iterations=3,substeps=2,reset=1"})
    for (const Problem& body : {uneven_body(0), uneven_body(2.5), driven_body()})
      for (const char* model : {"mass_spring", "fem_neo_hookean"})
        for (const double beta : {0.0, 1e-3})
          expect_same(device(), of_model(body, model, LinearSpring{}, beta), method, spec, 3);
  for (const char* method : {"pbd", "pbd:iterations=3,substeps=2,stiffness=0.7"})
    expect_same(device(), of_model(driven_body(), "mass_spring", LinearSpring{}, 0), method, spec, 3);
  // Colours of more constraints than a block has threads.
  const Parameters heavy{{"g", 9.81}, {"alpha", 1}, {"beta", 1e-3}};
  for (const char* id : {"mass_spring@cube:n=8", "fem_neo_hookean@cube:n=8", "fem_neo_hookean@liver"})
    expect_same(device(), make_problem(id, {.parameters = heavy}), "xpbd:substeps=3",
                {.t_end = 0.02, .h = 0.01}, 3);
}

/// Vertex block descent: of several counts, with and without extrapolation, all laws, damping and loads.
TEST_P(EveryDevice, MovesPointsWithTheBitsOfTheProcessor) {
  const RunSpec spec{.t_end = 0.1001, .h = 0.01};  // its last step is a sliver
  for (const char* method : {"vbd:iterations=1", "vbd:iterations=2,substeps=3,rho=0.5",
                             "vbd:iterations=5,substeps=2,rho=0.9", "vbd:iterations=4"})
    for (const Problem& body : {uneven_body(0), driven_body()})
      for (const char* model :
           {"mass_spring", "fem_green", "fem_cauchy", "fem_corotational", "fem_neo_hookean"})
        for (const double beta : {0.0, 1e-3})
          expect_same(device(), of_model(body, model, CubicSpring{4}, beta), method, spec, 3);
  // Where the matrix of a point is not positive definite.
  for (const Eigen::Vector3d& F : pressed)
    for (const char* model : {"fem_green", "fem_corotational", "fem_neo_hookean", "mass_spring"})
      expect_same(device(), pressed_body(F, model), "vbd:iterations=3,substeps=2", spec, 3);
  const Parameters heavy{{"g", 9.81}, {"alpha", 1}, {"beta", 1e-3}};
  for (const char* id : {"mass_spring@liver", "fem_neo_hookean@ball", "fem_green@phantom", "fem_cauchy@beam",
                         "fem_corotational@liver"})
    expect_same(device(), make_problem(id, {.parameters = heavy}), "vbd:substeps=2",
                {.t_end = 0.02, .h = 0.01}, 3);
  // Colours of more points than a block has, also after one that fits.
  for (const char* id : {"mass_spring@cube:n=9", "fem_green@cube:n=9", "fem_cauchy@cube:n=7"}) {
    const Problem large = make_problem(id, {.parameters = heavy});
    constexpr auto most = static_cast<std::size_t>(MovePoints::points);
    const Colours colours = PositionalBody::pieces_of(*large.body).colours;
    EXPECT_GT(colours[1].size(), most);
    if (id == std::string("fem_cauchy@cube:n=7")) {
      EXPECT_LE(colours[0].size(), most);
    }
    expect_same(device(), large, "vbd:iterations=2,rho=0.3", {.t_end = 0.02, .h = 0.01}, 3);
  }
}

TEST_P(EveryDevice, DivergesWhereTheProcessorDoes) {
  for (const char* method : {"symplectic_euler", "velocity_verlet", "stormer_verlet", "central_difference",
                             "rk4", "explicit_euler", "ode45"}) {
    const Problem problem = make_problem("fem_green@beam", {.parameters = {{"g", 9.81}, {"alpha", 0.1}}});
    const RunSpec spec{.t_end = 40, .h = 0.02};
    ASSERT_EQ(find_method(method).bind(problem).run(spec, {}).outcome, Outcome::diverged);
    expect_same(device(), problem, method, spec);
    for (const Problem& body : {moving_body(1e-4), damped_body(2.5, 0),
                                uneven_body(0, "fem_green", SkinSettings::Kind::membrane)}) {
      ASSERT_EQ(find_method(method).bind(body).run({.t_end = 40, .h = 0.02}, {}).outcome, Outcome::diverged);
      expect_same(device(), body, method, {.t_end = 40, .h = 0.02});
    }
  }
  for (const Parts& parts : {Parts{"fem_neo_hookean"}, fibrous, of_pressures, of_ten_nodes}) {
    const RunRecord run =
        expect_same(device(), parts.on("@beam"), "symplectic_euler", {.t_end = 40, .h = 0.02});
    EXPECT_EQ(run.outcome, Outcome::diverged) << parts.model;
  }
  const RunRecord flat =
      expect_same(device(), make_problem("fem_neo_hookean@cube:n=3", {.parameters = {{"g", 300}}}),
                  "newton_truncated:iterations=2,cg=8", {.t_end = 40, .h = 0.3});
  EXPECT_EQ(flat.outcome, Outcome::diverged);
  const RunRecord stiffer =
      expect_same(device(), make_problem("fem_neo_hookean@cube:n=3", {.parameters = {{"g", 1e6}}}),
                  "xpbd:iterations=3,substeps=2", {.t_end = 40, .h = 0.01});
  EXPECT_EQ(stiffer.outcome, Outcome::diverged);
  for (const char* id : {"mass_spring@cube:n=3", "fem_cauchy@cube:n=3"}) {
    const RunRecord extrapolated = expect_same(device(), make_problem(id, {.parameters = {{"g", 9.81}}}),
                                               "vbd:iterations=20,rho=0.999", {.t_end = 5, .h = 0.05});
    EXPECT_EQ(extrapolated.outcome, Outcome::diverged);
    EXPECT_GT(extrapolated.stats.steps, 1);
  }
  EXPECT_LT(flat.stats.linear_iterations, 8 * flat.stats.newton) << "there was curvature everywhere";
}

TEST_P(EveryDevice, StepsBodiesAtATimeAsEachAlone) {
  const Problem damped = make_problem("fem_green@cube:n=3", {.parameters = {{"g", 9.81}, {"beta", 1e-5}}});
  for (const char* method :
       {"symplectic_euler", "velocity_verlet", "stormer_verlet", "central_difference", "rk4", "ode45"})
    for (const Problem& body :
         {driven_body(), damped, moving_body(1e-5, "mass_spring"), fibrous_body(driven_body()),
          driven_body(uneven_body(2.5, "fem_nodal_pressure")),
          driven_body(uneven_body(2.5, "fem_quadratic"))})
      expect_same_at_a_time(device(), body, method, 5);
  const Problem large = make_problem("fem_green@cube:n=10", {.parameters = {{"g", 9.81}}});  // some patches
  EXPECT_GT(large.body->free_points().size(), 1024U);
  for (const char* method : {"velocity_verlet", "rk4"})
    for (const Problem& body : {large, of_pressures.on("@cube:n=10")})
      expect_same_at_a_time(device(), body, method, 2);
  expect_same_at_a_time<float>(device(), driven_body(), "rk4", 3);
}

TEST(HostDevice, CountsTheWorkOfAllBodies) {
  const Problem body = make_problem("fem_green@cube:n=2");
  HostDevice device;
  const auto run = [&](const char* method, std::int32_t bodies) {
    return run_on_device(device, body, find_method(method), {.t_end = 1e-3, .h = 1e-4},
                         Precision::double_precision, bodies);
  };
  for (const char* method : {"symplectic_euler", "rk4"}) {
    const DeviceRun one = run(method, 1), three = run(method, 3), five = run(method, 5);
    EXPECT_EQ(three.flops, 3 * one.flops);
    EXPECT_DOUBLE_EQ(five.bytes - three.bytes, three.bytes - one.bytes) << "elements are read once";
    EXPECT_LT(three.bytes, 3 * one.bytes);
    EXPECT_EQ(unequal(three.record.y, one.record.y), 0U);
  }
  EXPECT_THROW(run("newton_truncated", 2), InputError);
  EXPECT_THROW(run("rkc_2", 2), InputError);
  const auto flops = [&](const char* id, const char* method) {
    const DeviceRun done = run_on_device(device, make_problem(id, {.parameters = {{"beta", 0.1}}}),
                                         find_method(method), {.t_end = 0.021, .h = 2e-3});
    return std::pair(done.flops, static_cast<double>(done.record.stats.rhs - 1) / 11);
  };
  const auto [constant, stages] = flops("fem_cauchy@cube:n=2", "rkc_2");
  EXPECT_GT(stages, 5);
  EXPECT_DOUBLE_EQ(constant, stages * flops("fem_cauchy@cube:n=2", "symplectic_euler").first);
  const auto [changing, more] = flops("fem_green@cube:n=2", "rkc_2");
  EXPECT_GT(changing, more * flops("fem_green@cube:n=2", "symplectic_euler").first) << "the radius is found";
  const Problem solid = make_problem("fem_neo_hookean@cube:n=2");
  const auto meet = [&](const char* method) {
    return run_on_device(device, solid, find_method(method), {.t_end = 0.02, .h = 0.01});
  };
  const DeviceRun once = meet("xpbd:iterations=1"), thrice = meet("xpbd:iterations=1,substeps=3");
  EXPECT_DOUBLE_EQ(thrice.flops, 3 * once.flops);
  EXPECT_DOUBLE_EQ(thrice.bytes, 3 * once.bytes);
  EXPECT_LT(thrice.flops, meet("xpbd:iterations=3").flops * 3);
  const DeviceRun moved = meet("vbd:iterations=1"), moved_thrice = meet("vbd:iterations=1,substeps=3");
  EXPECT_DOUBLE_EQ(moved_thrice.flops, 3 * moved.flops);
  EXPECT_DOUBLE_EQ(moved_thrice.bytes, 3 * moved.bytes);
  EXPECT_LT(meet("vbd:iterations=3").flops, moved_thrice.flops);
}

TEST(HostDevice, ErrsInSinglePrecisionByItsRounding) {
  const auto expect_between = [&](const Parts& parts, const char* method, const RunSpec& spec, double least,
                                  double most) {
    const char* const id = parts.model;
    const double error = error_of_single(parts.on("@liver", {{"g", 9.81}, {"alpha", 1}}), method, spec);
    EXPECT_LT(error, most) << id << ", " << method;
    EXPECT_GT(error, least) << id << ", " << method;
  };
  for (const Parts& parts : {Parts{"fem_green"}, Parts{"fem_cauchy"}, Parts{"fem_neo_hookean"},
                             Parts{"fem_corotational"}, Parts{"mass_spring"}, fibrous, of_pressures})
    for (const char* method : {"symplectic_euler", "central_difference", "rk4"})
      expect_between(parts, method, {.t_end = 0.2, .h = 2e-4}, 1e-8, 1e-5);
  expect_between(of_ten_nodes, "symplectic_euler", {.t_end = 0.05, .h = 2e-4}, 1e-8, 1e-5);
  const Problem moving = moving_body(1e-4, "mass_spring", SkinSettings::Kind::membrane);
  const double error = error_of_single(moving, "central_difference", {.t_end = 0.05, .h = 1e-4});
  EXPECT_LT(error, 1e-5);
  EXPECT_GT(error, 1e-8);
  // Of many short steps each rounds a displacement that it hardly changes.
  expect_between({"fem_green"}, "symplectic_euler", {.t_end = 0.02, .h = 1e-6}, 1e-6, 1e-4);
}

TEST(BodyPatches, OwnEachFreePointOnceWithAllItsTetrahedra) {
  const Problem problem = uneven_body(1);
  const BodyPatches patches = body_patches(*problem.body, 7);
  EXPECT_GT(patches.begin.size(), 4U);
  std::vector<std::int32_t> order = patches.order;
  std::ranges::sort(order);
  for (std::size_t p = 0; p < order.size(); ++p) EXPECT_EQ(order[p], static_cast<std::int32_t>(p));
  std::size_t corners = 0, expected = 0;
  for (const PatchCorners& each : patches.corners)
    for (const std::uint16_t slot : each.slot) corners += slot != PatchCorners::nowhere;
  std::vector<bool> free(static_cast<std::size_t>(problem.body->mesh().point_count()), false);
  for (const TetMesh::Index p : problem.body->free_points()) free[static_cast<std::size_t>(p)] = true;
  for (const TetMesh::Index p : problem.body->mesh().tetrahedra.reshaped())
    expected += free[static_cast<std::size_t>(p)];
  EXPECT_EQ(corners, expected);
}

TEST(BodyPatches, PlaceTheVolumesOfTetrahedraInNoPatch) {
  const Problem problem = held_body();
  const BodyPatches patches = body_patches(*problem.body);
  const std::size_t places = patches.mu.size(),
                    in_patches = static_cast<std::size_t>(patches.begin.back().tet);
  EXPECT_LT(in_patches, places) << "there are some";
  EXPECT_EQ(patches.volume.size(), places);
  EXPECT_EQ(patches.averages.size(), places);
  std::vector<bool> has_place(places, false);
  for (const BodyTetrahedron& each : patches.tetrahedra) {
    ASSERT_GE(each.place, 0);
    ASSERT_LT(each.place, static_cast<std::int32_t>(places));
    EXPECT_FALSE(has_place[static_cast<std::size_t>(each.place)]);
    has_place[static_cast<std::size_t>(each.place)] = true;
  }
  EXPECT_EQ(patches.tetrahedra.size(), static_cast<std::size_t>(problem.body->mesh().tetrahedron_count()));
}

TEST(BodyPatches, BecomeSmallerUntilTheyFit) {
  const Problem problem = make_problem("fem_green@liver");
  EXPECT_LE(body_patches(*problem.body, 128, 1000).shared, 1000U);
  EXPECT_THROW(static_cast<void>(body_patches(*problem.body, 128, 20)), InputError);
}

TEST_F(Gpu, GivesInSinglePrecisionTheBitsOfItsProgramsOnTheProcessor) {
  HostDevice host;
  const RunSpec spec{.t_end = 0.0203, .h = 3e-4};
  std::vector<Problem> bodies{moving_body(1e-4, "mass_spring", SkinSettings::Kind::membrane)};
  for (const char* model : {"fem_green", "fem_cauchy", "fem_neo_hookean", "fem_corotational", "mass_spring",
                            "fem_nodal_pressure", "fem_quadratic"})
    bodies.push_back(uneven_body(2.5, model));
  for (const Problem& problem : bodies)
    for (const char* method : {"symplectic_euler", "central_difference", "rk4"}) {
      const auto on = [&](Device& where) {
        return run_on_device(where, problem, find_method(method), spec, Precision::single_precision).record.y;
      };
      EXPECT_EQ(unequal(on(*device), on(host)), 0U) << problem.body->settings().model.id << ", " << method;
    }
}

INSTANTIATE_TEST_SUITE_P(Host, EveryDevice, testing::Values(Where::forwards, Where::backwards),
                         [](const auto& where) {
                           return where.param == Where::forwards ? "forwards" : "backwards";
                         });
INSTANTIATE_TEST_SUITE_P(Gpu, EveryDevice, testing::Values(Where::gpu), [](const auto&) { return "card"; });

}  // namespace
}  // namespace hmax
