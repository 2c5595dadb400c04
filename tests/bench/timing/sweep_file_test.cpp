#include "bench/timing/sweep_file.hpp"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/errors.hpp"
#include "tests/results/scratch.hpp"
#include "tests/says.hpp"

namespace hmax {
namespace {

SweepSpec read(const std::string& text) { return spec_from(sweep_from(parse_toml(text, "s.toml"))); }

std::string refusal(const std::string& text) {
  return error_of<InputError>([&] { plan_sweep(read(text)); });
}

TEST(SweepFile, AnEmptyFileAsksForNothing) {
  for (const char* text : {"", "# a remark\n", "[sweep]\n", "[sweep]\n[set]\n"})
    EXPECT_TRUE(refusal(text).starts_with("s.toml asks for nothing")) << text;
  EXPECT_EQ(plan_sweep(spec_from({})).canonical, plan_sweep({}).canonical);
}

TEST(SweepFile, EveryKeyIsRead) {
  const SweepSpec spec = read(R"([sweep]
problems = ["liver_linear", "liver_forced"]
materials = "male_slim"
methods = ["rk4", "ode45"]
h = 0.1
readings = ["sampled"]
rtol = 1e-8
atol = 1e-9
control = "matlab"
t_end = 20
repeats = 11
max_steps = 1000
y0 = [0.1, 0]
[set]
c = 6
)");
  ASSERT_EQ(spec.problems.size(), 2u);
  EXPECT_EQ(spec.problems[1].name, "liver_forced");
  EXPECT_EQ(spec.problems[1].settings.material, "male_slim");
  EXPECT_EQ(spec.problems[1].settings.y0, (std::vector<double>{0.1, 0}));
  ASSERT_EQ(spec.problems[0].settings.parameters.size(), 1u);
  EXPECT_EQ(spec.problems[0].settings.parameters[0].second, 6);
  EXPECT_EQ(spec.methods, (std::vector<std::string>{"rk4", "ode45"}));
  EXPECT_EQ(spec.h, std::vector<double>{0.1});
  EXPECT_FALSE(spec.fixed);
  EXPECT_TRUE(spec.sampled);
  EXPECT_EQ(spec.sampled_tolerance.rtol, 1e-8);
  EXPECT_EQ(spec.sampled_tolerance.atol, 1e-9);
  EXPECT_EQ(spec.control, Controllers::matlab);
  EXPECT_EQ(spec.t_end, 20);
  EXPECT_EQ(spec.repeats, 11);
  EXPECT_EQ(spec.max_steps, 1000);
}

TEST(SweepFile, TolerancesWithoutStepsAreSwept) {
  const SweepSpec spec = read("[sweep]\nrtol = [1e-3, 1e-6]\n");
  EXPECT_TRUE(spec.h.empty());
  ASSERT_EQ(spec.tolerances.size(), 2u);
  EXPECT_EQ(spec.tolerances[1].rtol, 1e-6);
  EXPECT_EQ(spec.tolerances[1].atol, 1e-6);
  EXPECT_TRUE(says(refusal("[sweep]\nrtol = [1e-3, 1e-6]\nh = 1\n"), "only without steps"));
}

TEST(SweepFile, AllMaterialsAreTheSixOfTheTable) {
  EXPECT_EQ(read("[sweep]\nproblems = 'liver_benchmark'\nmaterials = 'all'\n").problems.size(), 6u);
}

TEST(SweepFile, FilesAreSoughtBesideIt) {
  Scratch scratch;
  write_text(scratch / "decay.toml", "[equations]\nu = \"-u\"\n[initial]\nu = 1\n");
  write_text(scratch / "s.toml", "[sweep]\nproblems = 'decay.toml'\nh = 0.5\n");
  EXPECT_EQ(plan_sweep(spec_from(read_sweep(scratch / "s.toml"))).problems.at(0).id, "decay");
}

TEST(SweepFile, FlagsGoBeforeTheFile) {
  const SweepRequest file =
      sweep_from(parse_toml("[sweep]\nh = [1, 2]\nt_end = 5\n[set]\nc = 1\n", "s.toml"));
  SweepRequest flags;
  flags.h = std::vector<double>{0.5};
  flags.parameters = {{"c", 3.0}};
  const SweepPlan plan = plan_sweep(spec_from(merged(file, flags)));
  EXPECT_EQ(plan.spec.h, std::vector<double>{0.5});
  EXPECT_EQ(plan.blocks.front().run.t_end, 5);
  EXPECT_EQ(plan.problems[0].parameters[1], (std::pair<std::string, double>{"c", 3}));
}

TEST(SweepFile, MistakesAreNamedWithTheirLine) {
  for (const auto& [text, named] : std::vector<std::pair<std::string, std::string>>{
           {"[sweep]\nmethod = 'rk4'\n",
            "s.toml:2: unknown key 'method' in [sweep]; did you mean 'methods'?"},
           {"[swep]\nh = 1\n", "did you mean 'sweep'?"},
           {"[sweep]\nh = 1\nmethods = ['rk4', 'ode54']\n", "s.toml:3: unknown method 'ode54'"},
           {"[sweep]\n\nproblems = 'liver'\n", "s.toml:3: unknown problem 'liver'"},
           {"[sweep]\nmaterials = ['fat']\n", "s.toml:2: "},
           {"[sweep]\nmaterials = ['all', 'male_fat']\n", "give it alone"},
           {"[sweep]\ncontrol = 'pid'\n", "s.toml:2: unknown control 'pid'"},
           {"[sweep]\nreadings = 'fix'\n", "s.toml:2: unknown reading 'fix'"},
           {"[sweep]\nh = '0.1'\n", "s.toml:2: h must be numbers"},
           {"[sweep]\nh = []\n", "s.toml:2: h is empty"},
           {"[sweep]\nrepeats = 9.5\n", "s.toml:2: repeats must be a whole number"},
           {"[sweep]\nt_end = true\n", "s.toml:2: t_end must be a number"},
           {"[set]\nc = '6'\n", "s.toml:2: c must be a number"},
           {"[set]\nq = 6\n", "unknown parameter 'q'"},
           {"sweep = 1\n", "sweep"},
       })
    EXPECT_TRUE(says(refusal(text), named)) << text;
}

}  // namespace
}  // namespace hmax
