/// hmax with one more method, family, problem and mesh model, those of the patches beside this file.
#include <filesystem>
#include <string>
#include <vector>

#include "tests/cli/program.hpp"

namespace hmax {
namespace {

using Json = nlohmann::json;

Json listed(const std::string& what, const std::string& id) {
  for (const Json& entry : Shell{}.hmax("list --json " + what).json())
    if (entry.at("id") == id) return entry;
  ADD_FAILURE() << "hmax list " << what << " does not name " << id;
  return {};
}

/// h_max of each method, in their order, 0 where no step is unstable; runs on both sides of each confirm it.
std::vector<double> verified_limits(const std::string& model, const std::string& methods) {
  const Told told = Shell{}.hmax("stability predict " + model + " --methods " + methods + " --verify --json");
  EXPECT_EQ(told.exit_code, 0) << told.err;
  std::vector<double> limits;
  const Json document = told.json();
  for (const Json& row : document.at("rows")) {
    EXPECT_EQ(row.at("agrees"), true) << row;
    limits.push_back(row.at("h_max").is_number() ? row.at("h_max").get<double>() : 0);
  }
  return limits;
}

void expect_run(const std::string& arguments) {
  const Told told = Shell{}.hmax("run --json " + arguments);
  ASSERT_EQ(told.exit_code, 0) << told.err;
  EXPECT_EQ(told.json().at("outcome"), "reached_end") << arguments;
}

/// The files that a patch changes or adds.
int files_of(const std::string& name) {
  const std::string patch =
      read_text(std::filesystem::path(HMAX_SOURCE_DIR) / "tests/additions" / (name + ".patch"));
  int files = 0;
  for (std::size_t at = patch.find("\n+++ b/"); at != std::string::npos; at = patch.find("\n+++ b/", at + 1))
    ++files;
  return files;
}

TEST(Patches, TouchFewFiles) {
  EXPECT_EQ(files_of("method"), 2);
  EXPECT_EQ(files_of("family"), 6);
  EXPECT_EQ(files_of("problem"), 4);
  EXPECT_EQ(files_of("mesh_model"), 3);
}

TEST(Listed, IsEveryAddition) {
  EXPECT_EQ(listed("methods", "sdirk_2").at("family"), "diagonally_implicit");
  EXPECT_EQ(listed("methods", "extrapolated_euler_3").at("family"), "extrapolated");
  EXPECT_EQ(listed("problems", "pendulum").at("dimension"), 2);
  EXPECT_FALSE(listed("models", "fem_green_volume").at("is_of_springs"));
}

TEST(MeshModel, HasTheLimitsOfEveryLawAtRestAndRuns) {
  const std::string at_rest = "--mesh cube:n=2 --set g=0 --set beta=0.001 --model ";
  const std::vector<double> known = verified_limits(at_rest + "fem_green", "symplectic_euler,rk4"),
                            added = verified_limits(at_rest + "fem_green_volume", "symplectic_euler,rk4");
  ASSERT_EQ(added.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) EXPECT_NEAR(added[i] / known[i], 1, 1e-8);
  expect_run("--mesh cube:n=2 --model fem_green_volume --load press --method newmark --h 0.01 --t-end 0.1");
  EXPECT_EQ(Shell{}.hmax("static --mesh cube:n=2 --model fem_green_volume --load press").exit_code, 0);
}

TEST(Family, HasTheLimitsOfItsStabilityFunctionAndRuns) {
  // R = 1 + z + z^2 / 2 and that + z^3 / 6, as of every Runge-Kutta method of 2 or 3 stages and that order.
  const std::vector<double> limits = verified_limits(
      "--problem liver_linear", "rk2_heun,extrapolated_euler_2,rk3_kutta,extrapolated_euler_3");
  ASSERT_EQ(limits.size(), 4U);
  EXPECT_NEAR(limits[1] / limits[0], 1, 1e-6);
  EXPECT_NEAR(limits[3] / limits[2], 1, 1e-6);
  expect_run("--problem liver_forced --method extrapolated_euler_4 --h 0.01");
  EXPECT_EQ(Shell{}.hmax("order --problem liver_cubic --method extrapolated_euler_3").exit_code, 0);
}

TEST(Method, HasItsOrderAndIsPredicted) {
  EXPECT_EQ(Shell{}.hmax("order --problem liver_cubic --method sdirk_2").exit_code, 0);
  // A-stable.
  EXPECT_EQ(verified_limits("--problem liver_linear", "sdirk_2"), std::vector<double>{0});
  expect_run("--problem liver_forced --method sdirk_2 --h 0.1");
}

TEST(Problem, IsPredictedAndRuns) {
  // Small motions about rest: omega^2 = g / l, explicit Euler of the damping d has h_max = d / omega^2.
  const std::vector<double> limits = verified_limits("--problem pendulum --along none", "explicit_euler");
  ASSERT_EQ(limits.size(), 1U);
  EXPECT_NEAR(limits[0], 0.1 / 9.81, 1e-6);
  expect_run("--problem pendulum --method ode45 --rtol 1e-6 --atol 1e-9");
}

}  // namespace
}  // namespace hmax
