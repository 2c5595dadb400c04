/// What devices do not run, and how they say so.
#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "catalogue/device/device_run.hpp"
#include "catalogue/device/host_device.hpp"
#include "core/errors.hpp"
#include "problems/tissue/forces/tet_elements.hpp"
#include "tests/catalogue/device/device_runs.hpp"

namespace hmax {
namespace {

using namespace device_tests;

TEST(DeviceRun, SaysWhatNoDeviceRuns) {
  const Problem body = make_problem("fem_green@cube:n=2");
  const auto why = [&](const Problem& problem, const char* method) {
    return unsuited_for_device(problem, find_method(method));
  };
  const auto has = [](const std::string& text, const char* part) {
    return text.find(part) != std::string::npos;
  };
  EXPECT_TRUE(has(why(make_problem("liver_forced"), "rk4"), "bodies on meshes"));
  EXPECT_EQ(why(body, "rkc_2"), "");
  EXPECT_TRUE(has(why(body, "newton_truncated:cg=3000"), "2048 conjugate gradients"));
  for (const Problem& any : {fibrous_body(uneven_body(0)), of_pressures.on("@cube:n=2"), moving_body(0)})
    for (const char* method : {"newton_truncated", "newton_truncated:frozen=1"})
      EXPECT_EQ(why(any, method), "");
  for (const char* method : {"rkc_2", "rkl_2"}) {
    EXPECT_EQ(why(fibrous_body(uneven_body(0)), method), "");
    EXPECT_EQ(why(of_pressures.on("@cube:n=2"), method), "");
    EXPECT_TRUE(has(why(damped_body(0, 0), method), "dampers"));
    EXPECT_TRUE(has(why(moving_body(0), method), "supports that move"));
    EXPECT_EQ(why(uneven_body(0, "fem_cauchy", SkinSettings::Kind::membrane), method), "");
  }
  TissueSettings others = body.body->settings();
  others.model.make_elements = [](const TetMesh& mesh, std::span<const Lame> lame,
                                  const BlockPattern& pattern) -> std::shared_ptr<const Elements> {
    return std::make_shared<const TetElements<GreenStrain>>(mesh, lame, pattern);
  };
  EXPECT_TRUE(has(why(body_of(body.body->mesh(), others), "rk4"), "other elements"));
  const Problem solid = make_problem("fem_neo_hookean@cube:n=2");
  EXPECT_EQ(why(solid, "xpbd"), "");
  EXPECT_TRUE(has(why(body, "xpbd"), "has the constraints of"));
  EXPECT_EQ(why(body, "vbd"), "");
  EXPECT_TRUE(has(why(body, "projective_dynamics"), "runs on no GPU"));
  const Parameters on_springs{{"support_stiffness", 1e5}};
  for (const char* method : {"xpbd", "vbd"})
    EXPECT_TRUE(
        has(why(make_problem("fem_neo_hookean@cube:n=2", {.parameters = on_springs}), method), "springs"));
  const Problem tool = make_problem("fem_green/tool@cube:n=2"),
                damps = make_problem("fem_green/tool@cube:n=2", {.parameters = {{"tool_damping", 1}}});
  for (const char* method : {"symplectic_euler", "newton_truncated", "newton_truncated:frozen=1", "rkc_2"})
    EXPECT_EQ(why(tool, method), "") << method;
  for (const char* method : {"rkc_2", "rkl_2"}) EXPECT_TRUE(has(why(damps, method), "a tool that damps"));
  EXPECT_EQ(why(damps, "newton_truncated"), "");
  for (const char* method : {"vbd", "xpbd"})
    EXPECT_TRUE(has(why(make_problem("fem_neo_hookean/tool@cube:n=2"), method), "tool")) << method;
}

TEST(DeviceRun, RefusesWhatMethodsDoNotDoThere) {
  const Problem body = make_problem("fem_green@cube:n=2"), solid = make_problem("fem_neo_hookean@cube:n=2");
  HostDevice device;
  for (const char* method : {"xpbd", "vbd"}) {
    EXPECT_THROW(static_cast<void>(run_on_device(device, solid, find_method(method), {.t_end = 1, .h = 0.1},
                                                 Precision::double_precision, 2)),
                 InputError);
    EXPECT_THROW(static_cast<void>(run_on_device(device, solid, find_method(method), {.t_end = 1, .h = 0.1},
                                                 Precision::single_precision)),
                 InputError);
    const Method much = find_method(std::string(method) + ":substeps=30000");
    EXPECT_THROW(static_cast<void>(on_device(much, std::make_shared<HostDevice>()).bind(solid)), InputError);
  }
  const Problem skinned = uneven_body(1, "fem_green", SkinSettings::Kind::springs);
  EXPECT_THROW(static_cast<void>(on_device(find_method("vbd"), std::make_shared<HostDevice>()).bind(skinned)),
               InputError)
      << "points do not have the forces of a skin";
  EXPECT_THROW(static_cast<void>(on_device(find_method("xpbd"), std::make_shared<HostDevice>()).bind(body)),
               InputError)
      << "Green's strain has no constraints";
  EXPECT_THROW(static_cast<void>(run_on_device(device, body, find_method("newton_truncated"),
                                               {.t_end = 1, .h = 0.1}, Precision::single_precision)),
               InputError);
  EXPECT_THROW(static_cast<void>(run_on_device(device, body, find_method("rkc_2"), {.t_end = 1, .h = 0.1},
                                               Precision::single_precision)),
               InputError);
  const RunSpec chosen{.t_end = 1e-3, .adaptive = true, .rtol = 1e-3, .atol = 1e-3};
  const auto run = [&](const char* id, const RunSpec& spec, const Sink& sink) {
    on_device(find_method(id), std::make_shared<HostDevice>()).bind(body).run(spec, sink);
  };
  EXPECT_NO_THROW(run("ode45", chosen, {}));
  EXPECT_THROW(run("ode45", chosen, [](double, const auto&) {}), InputError);
  EXPECT_THROW(run("rk4", chosen, {}), InputError);
  EXPECT_THROW(run("rk4", {.t_end = 1e-3, .h = 1e-4, .every = 1e-3}, {}), InputError);
  const auto run_many = [&](Precision precision, std::int32_t bodies) {
    static_cast<void>(run_on_device(device, body, find_method("ode45"), chosen, precision, bodies));
  };
  EXPECT_THROW(run_many(Precision::single_precision, 1), InputError);
  EXPECT_THROW(run_many(Precision::double_precision, 2), InputError);
}

}  // namespace
}  // namespace hmax
