#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "bench/timing/sweep.hpp"
#include "catalogue/device/device_run.hpp"
#include "catalogue/device/host_device.hpp"
#include "core/errors.hpp"
#include "results/compare.hpp"
#include "results/merge/merge_stores.hpp"
#include "tests/results/scratch.hpp"
#include "tests/says.hpp"

namespace hmax {
namespace {

SweepSpec cube() {
  SweepSpec spec;
  spec.problems = {{"fem_green/press@cube:n=2", {}}};
  spec.methods = {"symplectic_euler", "rk4"};
  spec.h = {0.02, 2e-3, 1e-3};  // the first is not stable
  spec.sampled = false;
  spec.t_end = 0.2;
  spec.min_sample_s = 2e-5;
  return spec;
}

/// The same on a device: its programs on the processor, with facts of its own, and a clock of which a second
/// goes by from one look to the next.
SweepSpec cube_on_device(const std::string& name = "made up",
                         const std::string& driver = "driver 1, run time 2") {
  SweepSpec spec = cube();
  spec.place = [name, driver, device = std::make_shared<HostDevice>()](
                   const std::vector<Problem>&, std::vector<Method>& methods, std::vector<LeftOut>&) {
    DeviceFacts facts = device->facts();
    facts.name = name;
    facts.clock_mhz = 1500;
    facts.driver = driver;
    for (Method& method : methods) {
      method = on_device(std::move(method), device);
      method.device = std::make_shared<const DeviceFacts>(facts);
      method.bind = [bind = method.bind](const Problem& problem) {
        Runner runner = bind(problem);
        runner.seconds = [now = 0.0]() mutable { return ++now; };
        return runner;
      };
    }
  };
  return spec;
}

/// @param file  a store that is made
std::vector<Row> measured(const SweepSpec& spec, const std::filesystem::path& file) {
  const SweepPlan plan = plan_sweep(spec);
  Store store = open_sweep_store(plan, file, false);
  EXPECT_EQ(run_sweep(plan, store).measured, plan.rows());
  return store.rows();
}

TEST(DeviceSweep, HasTheErrorsOfTheProcessorAndTimesOfItsOwn) {
  const Scratch scratch;
  const std::vector<Row> here = measured(cube(), scratch / "here.sqlite"),
                         there = measured(cube_on_device(), scratch / "there.sqlite");
  ASSERT_EQ(here.size(), 6U);
  ASSERT_EQ(there.size(), 6U);
  for (std::size_t i = 0; i < 6; ++i) {
    const Row &a = here[i], &b = there[i];
    SCOPED_TRACE(a.key.method + " " + std::to_string(a.key.h));
    EXPECT_NE(a.key, b.key);
    RowKey of_processor = b.key;
    of_processor.device = of_processor.precision = "";
    EXPECT_EQ(of_processor, a.key);
    EXPECT_EQ(b.key.device, "made up");
    EXPECT_EQ(b.key.precision, "double");
    EXPECT_EQ(b.clock_mhz, 1500);
    EXPECT_EQ(b.driver, "driver 1, run time 2");
    EXPECT_EQ(a.key.device + a.key.precision + a.driver, "");
    EXPECT_EQ(a.clock_mhz, 0);

    EXPECT_EQ(a.outcome, a.key.h > 0.01 ? "diverged" : "reached_end");
    EXPECT_EQ(b.outcome, a.outcome);
    EXPECT_EQ(b.steps, a.steps);
    EXPECT_EQ(b.rhs, a.rhs);
    EXPECT_EQ(b.t_reached, a.t_reached);
    EXPECT_EQ(b.subnormals, a.subnormals);
    EXPECT_EQ(b.reference, a.reference);
    if (a.outcome == "reached_end") {
      EXPECT_GT(a.error_global, 0);
      EXPECT_EQ(b.error_end, a.error_end);
      EXPECT_EQ(b.error_global, a.error_global);
      EXPECT_EQ(b.error_l2, a.error_l2);
    }
    EXPECT_EQ(a.cpu_s.size(), 9U);
    EXPECT_TRUE(a.device_s.empty());
    EXPECT_TRUE(b.cpu_s.empty());
    EXPECT_EQ(b.device_s, std::vector<double>(9, 1));
  }
}

TEST(DeviceSweep, IsTimedByTheClockOfItsDevice) {
  const Scratch scratch;
  const auto device = std::make_shared<HostDevice>();
  SweepSpec spec = cube();
  spec.place = [device](const std::vector<Problem>&, std::vector<Method>& methods, std::vector<LeftOut>&) {
    for (Method& method : methods) method = on_device(std::move(method), device);
  };
  for (const Row& row : measured(spec, scratch / "a.sqlite")) {
    ASSERT_EQ(row.device_s.size(), 9U);
    for (const double seconds : row.device_s) {
      EXPECT_GT(seconds, 0);
      EXPECT_LT(seconds, 1);
    }
  }
  EXPECT_EQ(device->seconds(), 0) << "nobody has read the time of its last steps";
}

TEST(DeviceSweep, IsNotTakenUpOnAnotherDevice) {
  const Scratch scratch;
  const std::filesystem::path file = scratch / "a.sqlite";
  measured(cube_on_device(), file);
  const auto resumed = [&](const SweepSpec& spec) {
    return error_of<InputError>([&] { open_sweep_store(plan_sweep(spec), file, true); });
  };
  EXPECT_TRUE(says(resumed(cube()), "device was \"made up\" and is \"cpu\""));
  EXPECT_TRUE(says(resumed(cube_on_device("other")), "device was \"made up\" and is \"other\""));
  EXPECT_TRUE(says(resumed(cube_on_device("made up", "driver 2")),
                   "driver was \"driver 1, run time 2\" and is \"driver 2\""));
  const SweepPlan plan = plan_sweep(cube_on_device());
  Store store = open_sweep_store(plan, file, true);
  EXPECT_EQ(run_sweep(plan, store).measured, 0);
}

TEST(DeviceSweep, IsMergedAndComparedBesideTheProcessor) {
  const Scratch scratch;
  const std::vector<Row> here = measured(cube(), scratch / "here.sqlite"),
                         there = measured(cube_on_device(), scratch / "there.sqlite");
  Store both = Store::open_or_create(scratch / "both.sqlite");
  Merger merger(both);
  merger.add(scratch / "here.sqlite");
  merger.add(scratch / "there.sqlite");
  EXPECT_EQ(merger.summary().added, 12);
  EXPECT_EQ(merger.summary().doubled, 0);
  const Comparison nothing = compare(here, there);
  EXPECT_TRUE(nothing.rows.empty());
  EXPECT_EQ(nothing.only_in_a.size(), 6U);
  EXPECT_EQ(nothing.only_in_b.size(), 6U);
  EXPECT_EQ(compare(both.rows(), there).rows.size(), 6U);
}

TEST(DeviceSweep, HasTheMethodsThatItsDeviceRuns) {
  SweepSpec spec = cube_on_device();
  spec.methods.insert(spec.methods.begin(), "newmark");
  spec.place = [place = spec.place](const std::vector<Problem>& problems, std::vector<Method>& methods,
                                    std::vector<LeftOut>& left_out) {
    std::vector<Method> run(methods.begin() + 1, methods.end());
    place(problems, run, left_out);
    std::ranges::copy(run, methods.begin() + 1);
    left_out.push_back({methods.front().id, "runs on no GPU"});
  };
  const SweepPlan plan = plan_sweep(spec);
  ASSERT_EQ(plan.methods.size(), 2U);
  EXPECT_EQ(plan.methods[0].id, "symplectic_euler");
  ASSERT_EQ(plan.left_out.size(), 1U);
  EXPECT_EQ(plan.left_out[0].id, "newmark");
}

}  // namespace
}  // namespace hmax
