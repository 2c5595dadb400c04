/// What `hmax stability predict` says of models whose Jacobian changes where it is not looked for at first.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <vector>

#include <Eigen/Core>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/cli/program.hpp"

namespace hmax {
namespace {

using AnyJson = nlohmann::json;

/// The row of a method on x' = v, v' = acceleration.
AnyJson row_of(const std::string& acceleration, double t_end, const std::string& initial,
               const std::string& options = "--methods rk4") {
  const Shell shell;
  std::ofstream(shell / "own.toml") << fmt::format(
      "[problem]\nt_end = {}\n[equations]\nx = \"v\"\nv = \"{}\"\n[initial]\n{}\n", t_end, acceleration,
      initial);
  return shell.json("stability predict --problem own.toml " + options).at("rows").at(0);
}

double least_of(const AnyJson& row) {
  return row.contains("along") ? row.at("along").at("h_min").get<double>() : 0;
}

// |R(h lambda)| = 1 with R = 1 + z + z^2/2 + z^3/6 + z^4/24 and lambda^2 + c lambda + k = 0, by bisection.
TEST(PredictAlongMotions, FindsTheSmallestLimitWithoutBeingAsked) {
  EXPECT_NEAR(least_of(row_of("-9.81 + (x < 0 ? -1e6*x - 10*v : 0)", 2, "x = 1\nv = 0")), 0.002838771, 1e-8);
  EXPECT_NEAR(least_of(row_of("-(t < 1 ? 1 : 10000)*x - 0.02*v", 2, "x = 1\nv = 0")), 0.0282863951, 1e-7);
  EXPECT_NEAR(least_of(row_of("-1000*(1 + 0.9*sin(t))*x - 0.1*v", 20, "x = 1\nv = 0")), 0.0649441457, 2e-5);
  // Stiff for a thousandth of the motion, between two of the 400 instants.
  EXPECT_NEAR(least_of(row_of("-(t > 1.0012 && t < 1.0032 ? 1e6 : 1)*x", 2, "x = 1\nv = 0")),
              std::sqrt(8 / 1e6), 1e-7);
  EXPECT_NEAR(least_of(row_of("-x - x*x*x/1e12", 10, "x = 1e8\nv = 0")), std::sqrt(8 / (1 + 3e4)), 1e-7);
}

TEST(PredictAlongMotions, LooksAlongThePendulumAndNotAlongALinearModel) {
  EXPECT_TRUE(row_of("-9.81*sin(x) - 0.1*v", 10, "x = -0.5\nv = 0").contains("along"));
  const Shell shell;
  EXPECT_FALSE(shell.json("stability predict --problem liver_linear --methods rk4")
                   .at("rows")
                   .at(0)
                   .contains("along"));
  // y0 and y0 + 1 have one Jacobian: x^2 is 1/4 at both.
  const auto least = [&](const char* y0) {
    const AnyJson row =
        shell
            .json(
                fmt::format("stability predict --problem liver_cubic --set k3=800 --y0 {} --methods rk4", y0))
            .at("rows")
            .at(0);
    return row.at("along").at("h_min").get<double>();
  };
  EXPECT_NEAR(least("-0.5,0"), least("0.5,0"), 1e-9);
  EXPECT_NEAR(least("-0.5,0"), 0.1419, 5e-5);
}

TEST(PredictOfMatrices, TakesNegativeStiffnessWithinTheirDigitsForARigidMotion) {
  const Shell shell;
  std::ofstream(shell / "K.mtx")
      << "%%MatrixMarket matrix coordinate real symmetric\n3 3 5\n1 1 0.33333333\n2 1 -0.33333333\n"
         "2 2 0.66666665\n3 2 -0.33333333\n3 3 0.33333333\n";
  std::ofstream(shell / "M.mtx") << "%%MatrixMarket matrix array real general\n3 1\n1\n1\n1\n";
  const Told told =
      shell.hmax("stability predict --matrices stiffness=K.mtx,mass=M.mtx --methods rk4 --verify --json");
  EXPECT_EQ(told.exit_code, 0) << told.err;
  const AnyJson row = told.json().at("rows").at(0);
  EXPECT_NEAR(row.at("h_max").get<double>(), 2.8284271, 1e-6);
  EXPECT_EQ(row.at("agrees"), true) << row;
  EXPECT_FALSE(row.contains("growth"));
  EXPECT_FALSE(says(told.err, "negative stiffness"));
}

TEST(PredictOfBodies, CentralDifferenceHasALimitAlongTheMotionWithMassDamping) {
  // Damping alpha M is diagonal: nothing is taken apart, and Newmark's form of the same method has the same
  // limit.
  const Told told = Shell{}.hmax(
      "stability predict --mesh cube:n=4 --methods central_difference,explicit_newmark --alpha 5 --along motion --t-end 0.02 --json");
  const AnyJson rows = told.json().at("rows");
  const double central = least_of(rows.at(0)), newmark = least_of(rows.at(1));
  EXPECT_GT(central, 0);
  EXPECT_NEAR(central, newmark, 1e-6 * newmark);
}

/// The smallest h whose first step of central differences, x0 + h v0 + h^2 a0 / 2, is farther from the motion
/// of 1.45 x'' + 10 x' + 0.7 x + 0.8 x^3 = 0 from (0.5, 1) than three times its size, by steps of RK4.
double first_step_too_far() {
  const auto slope = [](const Eigen::Vector2d& y) {
    return Eigen::Vector2d(y[1], -(10 * y[1] + 0.7 * y[0] + 0.8 * y[0] * y[0] * y[0]) / 1.45);
  };
  const Eigen::Vector2d start(0.5, 1);
  constexpr double dt = 1e-4;
  double size = 0;
  std::vector<double> x{start[0]};
  for (Eigen::Vector2d y = start; x.size() < 30'000; x.push_back(y[0])) {
    const Eigen::Vector2d k1 = slope(y), k2 = slope(y + dt / 2 * k1), k3 = slope(y + dt / 2 * k2),
                          k4 = slope(y + dt * k3);
    y += dt / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
    size = std::max(size, std::abs(y[0]));
  }
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double h = dt * static_cast<double>(i);
    if (std::abs(start[0] + h * start[1] + h * h / 2 * slope(start)[1] - x[i]) > 3 * size) return h;
  }
  return 0;
}

// A limit along a motion is necessary, not safe: c = 10 moves the frozen modes apart, and runs of central
// differences fail at two thirds of it.
TEST(StabilityPredict, TellsTheSafeStepFromTheNecessaryOneWithoutBeingAsked) {
  const Shell shell;
  const std::string line = "stability predict --problem liver_cubic --set c=10 --methods central_difference";
  const AnyJson row = shell.json(line).at("rows").at(0), safe = row.at("safe");
  EXPECT_NEAR(row.at("along").at("h_min").get<double>(), 1.889, 1e-3);
  EXPECT_EQ(safe.at("how"), "runs");
  EXPECT_EQ(safe.at("fails_beyond"), true);
  const double h = safe.at("h");
  EXPECT_NEAR(h, first_step_too_far(), 2e-3 * h);
  const auto ends = [&](double step) {
    return shell
        .hmax(fmt::format("run --problem liver_cubic --set c=10 --method central_difference --h {} --json",
                          step))
        .json()
        .at("outcome");
  };
  EXPECT_EQ(ends(h), "reached_end");
  EXPECT_EQ(ends(1.2), "diverged");
  EXPECT_TRUE(
      says(shell.hmax(line).out, "leaves the motion below what is necessary: central_difference beyond "));
  EXPECT_TRUE(
      says(shell.hmax(line + " --along none").out, "the model is not linear: h_max holds for small motions"));
  // No run tells of methods that choose their steps.
  const AnyJson adaptive = shell.json("stability predict --problem liver_cubic --methods adams_pece");
  EXPECT_TRUE(adaptive.at("rows").at(0).at("safe").at("h").is_null());
  EXPECT_TRUE(adaptive.at("rows").at(0).at("safe").at("how").is_null());
}

TEST(StabilityPredict, ExcusesRunsOfImplicitExplicitStepsThatAForceDrivesAway) {
  const AnyJson row = Shell()
                          .json("stability predict --problem liver_forced --methods imex_ark_324 --verify")
                          .at("rows")
                          .at(0);
  EXPECT_LT(row.at("observed"), row.at("h_max"));
  EXPECT_TRUE(row.at("gap").is_null());
  EXPECT_TRUE(says(row.at("status").get<std::string>(), "moves the model away"));
  EXPECT_LT(row.at("safe").at("h").get<double>(), 4.6);
}

}  // namespace
}  // namespace hmax
