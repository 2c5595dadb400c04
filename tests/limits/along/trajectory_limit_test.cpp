#include "limits/along/trajectory_limit.hpp"

#include <cmath>
#include <functional>
#include <numbers>

#include <gtest/gtest.h>

#include "analysis/spectrum/extreme_eigenvalues.hpp"
#include "catalogue/methods/catalogue.hpp"
#include "catalogue/models/model.hpp"
#include "catalogue/models/problems.hpp"
#include "core/errors.hpp"
#include "limits/predict.hpp"
#include "problems/tissue/body.hpp"
#include "tests/says.hpp"

namespace hmax {
namespace {

/// x'' = F as a system of first order.
struct Pushed {
  using State = Eigen::Vector2d;
  static constexpr bool autonomous = true;
  double F;
  static constexpr Eigen::Index dim() { return 2; }
  void rhs(double, const State& y, State& dydt) const { dydt << y[1], F; }
};

/// J = diag(-1e10, -1), from t = 0.5 on diag(-1e10, 5).
struct FastAndSlow {
  using State = Eigen::Vector2d;
  static constexpr bool autonomous = false;
  static constexpr Eigen::Index dim() { return 2; }
  void rhs(double t, const State& y, State& dydt) const { dydt << -1e10 * y[0], (t < 0.5 ? -1 : 5) * y[1]; }
};

Problem oscillator(double c, double k1, double k3, std::vector<double> y0) {
  return make_problem("liver_cubic",
                      {.parameters = {{"m", 1}, {"c", c}, {"k1", k1}, {"k3", k3}}, .y0 = std::move(y0)});
}

TEST(LimitAlongAMotion, OfALinearModelIsThatAtRestEverywhere) {
  const Problem problem = oscillator(0.4, 2, 0, {1, 0});
  for (const char* name : {"rk4", "adams_bashforth_3", "symplectic_euler"}) {
    const Method method = find_method(name);
    const auto along = limit_along(method, problem, 10);
    ASSERT_TRUE(along) << name;
    const double at_rest = predict(method, linearised(problem)).h_max.value();
    for (const double h : along->h_max) EXPECT_NEAR(h, at_rest, 1e-9 * at_rest) << name;
  }
}

TEST(LimitAlongAMotion, LooksAlongAWholePeriodOfTheLoad) {
  const auto breathing = [](double period) {
    return end_of_motion(make_problem("fem_green/breathing@cube:n=1", {.parameters = {{"period", period}}}));
  };
  EXPECT_DOUBLE_EQ(breathing(4), 4);
  EXPECT_DOUBLE_EQ(breathing(10), 10);
  EXPECT_DOUBLE_EQ(breathing(0.1), 1);
  EXPECT_DOUBLE_EQ(breathing(1e6), 1) << "what takes too long is said instead";
  const auto forced = [](double w) {
    return end_of_motion(make_problem("liver_forced", {.parameters = {{"w", w}}}));
  };
  EXPECT_DOUBLE_EQ(forced(0.5), 100);
  EXPECT_NEAR(forced(0.05), 40 * std::numbers::pi, 1e-9);
  EXPECT_FALSE(period_of_load(make_problem("liver_cubic")));
  EXPECT_FALSE(period_of_load(make_problem("fem_green/tool@cube:n=1")));
}

TEST(LimitAlongAMotion, OfAHardeningSpringIsLeastWhereItTurns) {
  // Undamped from rest at x = A: the tangent stiffness is largest at the turning points, k1 + 3 k3 A^2.
  const double A = 1.5, k1 = 0.5, k3 = 0.8;
  const auto along = limit_along(find_method("central_difference"), oscillator(0, k1, k3, {A, 0}), 20, 2000);
  ASSERT_TRUE(along);
  EXPECT_NEAR(along->least, 2 / std::sqrt(k1 + 3 * k3 * A * A), 1e-5);
  EXPECT_NEAR(std::abs(along->y_least[0]), A, 1e-3);
}

TEST(LimitAlongAMotion, SaysWhereTheTangentItselfGrows) {
  const auto along = limit_along(find_method("rk4"), oscillator(-0.2, 1, 0, {0.1, 0}), 5);
  ASSERT_TRUE(along);
  EXPECT_EQ(along->growing, 1);
  EXPECT_TRUE(std::isnan(along->least));
}

TEST(LimitAlongAMotion, IsNothingWithoutAnAmplificationOrForAProblemThatDoesNotSuit) {
  EXPECT_FALSE(limit_along(find_method("adams_pece"), oscillator(1, 1, 0, {1, 0}), 5));
  EXPECT_FALSE(limit_along(find_method("newmark"), make_problem("van_der_pol"), 5));
}

Problem cube(const std::string& id, Parameters parameters) {
  return make_problem(id + "@cube:n=4", {.parameters = std::move(parameters)});
}

TEST(LoadPath, HasTheEquilibriumOfEachShareOfTheLoad) {
  const Problem problem = cube("fem_green/press", {{"force", 1}});
  const Path path = load_path(problem, 4);
  ASSERT_EQ(path.at, (std::vector<double>{0, 0.25, 0.5, 0.75, 1}));
  EXPECT_TRUE(path.note.empty());
  EXPECT_EQ(path.y.front().norm(), 0);
  const Eigen::Index n = problem.body->dofs();
  for (std::size_t i = 1; i < path.at.size(); ++i) {
    // The forces of the whole load are what is missing of it.
    const Problem part = cube("fem_green/press", {{"force", path.at[i]}});
    Eigen::VectorXd f = Eigen::VectorXd::Zero(n);
    part.body->force(0, path.y[i].head(n), Eigen::VectorXd::Zero(n), f);
    EXPECT_LT(f.norm(), 1e-8) << path.at[i];
    EXPECT_GT(path.y[i].norm(), path.y[i - 1].norm());
  }
}

TEST(LoadPath, EndsWhereThereIsNoEquilibrium) {
  const Path path = load_path(cube("fem_green/press", {{"force", 500}}), 5);
  EXPECT_LT(path.at.back(), 1);
  EXPECT_NE(path.note.find("no equilibrium"), std::string::npos);
}

TEST(MotionPath, EndsWhereAnElementIsTurnedInsideOut) {
  const Problem problem = cube("fem_green/press", {{"force", 500}});
  const Path path = motion_path(problem, 0.5, 50);
  EXPECT_LT(path.at.back(), 0.5);
  EXPECT_NE(path.note.find("inverted"), std::string::npos);
  const Eigen::Index n = problem.body->dofs();
  for (const Eigen::VectorXd& y : path.y) EXPECT_GT(problem.body->least_volume(0, y.head(n)).first, 0);
}

TEST(LoadPath, IsOfBodiesAndOfLoadsThatStandStill) {
  const auto refusal = [](const Problem& problem) {
    return error_of<InputError>([&] { load_path(problem); });
  };
  EXPECT_TRUE(says(refusal(make_problem("liver_linear")), "no body"));
  EXPECT_TRUE(says(refusal(cube("fem_green/tool", {})), "changes with time"));
}

TEST(LimitUnderALoad, OfALinearBodyIsThatAtRestEverywhere) {
  const Problem problem = cube("fem_cauchy/pull", {{"force", 1}, {"alpha", 3}});
  const std::vector<Method> methods{find_method("rk4"), find_method("symplectic_euler")};
  const auto limits = limits_along(methods, problem, load_path(problem, 3));
  for (std::size_t i = 0; i < methods.size(); ++i) {
    const double at_rest = predict(methods[i], linearised(problem)).h_max.value();
    for (const double h : limits[i]->h_max) EXPECT_NEAR(h, at_rest, 1e-6 * at_rest) << methods[i].id;
  }
}

TEST(LimitUnderALoad, OfABodyOfManyPointsIsThatOfAllItsModes) {
  // Large enough for the ends of the spectrum alone, small enough for the dense one beside it.
  for (const char* model : {"fem_green/press", "fem_neo_hookean/press", "mass_spring/press"}) {
    const Problem problem = cube(model, {{"force", 2}, {"alpha", 2}});
    ASSERT_GT(problem.body->dofs(), small_enough_for_dense);
    const std::vector<Method> methods{find_method("rk4"), find_method("symplectic_euler")};
    const Path path = load_path(problem, 2);
    const auto limits = limits_along(methods, problem, path);
    for (std::size_t i = 0; i < methods.size(); ++i) {
      EXPECT_EQ(limits[i]->t, path.at);
      EXPECT_EQ(limits[i]->growing, 0);
      for (std::size_t k = 0; k < path.at.size(); ++k) {
        const double all = predict(methods[i], linearised(problem, 0, path.y[k])).h_max.value();
        EXPECT_NEAR(limits[i]->h_max[k], all, 1e-6 * all) << model << " " << methods[i].id << " " << k;
      }
    }
    // The load moves the limit by more than that.
    EXPECT_GT(std::abs(limits[0]->h_max.back() / limits[0]->h_max.front() - 1), 1e-4) << model;
  }
}

TEST(LimitUnderALoad, SeesThatABodyBuckles) {
  // Pressed flat by 30 %, a solid of Green's strain has a tangent that is negative in some direction.
  const Problem problem = cube("fem_green", {});
  const TissueBody& body = *problem.body;
  Eigen::VectorXd flat = problem.y0;
  for (std::size_t i = 0; i < body.free_points().size(); ++i)
    flat[3 * static_cast<Eigen::Index>(i) + 2] = -0.3 * body.mesh().points(2, body.free_points()[i]);
  ASSERT_LT(linearised(problem, 0, flat).modes.spectrum.mechanical.front().kappa, 0);
  const std::vector<Method> methods{find_method("rk4")};
  const auto limits = limits_along(methods, problem, {.at = {0, 1}, .y = {problem.y0, flat}});
  EXPECT_EQ(limits[0]->growing, 0.5);
  EXPECT_EQ(limits[0]->grows_from, 1);
  // The limit of the other modes is told all the same: sqrt(8) / omega, without damping.
  const double fastest = std::sqrt(linearised(problem, 0, flat).modes.spectrum.mechanical.back().kappa);
  EXPECT_NEAR(limits[0]->h_max[1], std::sqrt(8) / fastest, 1e-9 / fastest);
  EXPECT_EQ(limits[0]->least, std::min(limits[0]->h_max[0], limits[0]->h_max[1]));
}

/// Between tangents that are a multiple of the damping and those that do not commute with it.
TEST(LimitUnderALoad, IsKnownHoweverCloseToRest) {
  const Problem problem = cube("fem_green", {{"beta", 0.01}});
  ASSERT_GT(problem.body->dofs(), small_enough_for_dense);
  const Eigen::Index n = problem.body->dofs();
  Path path;
  for (double share = 1e-3; share > 1e-15; share /= 4) {
    path.at.push_back(static_cast<double>(path.at.size()));
    path.y.push_back(problem.y0);
    path.y.back().head(n) = 1e-3 * share * Eigen::VectorXd::LinSpaced(n, -1, 1).array().sin().matrix();
  }
  const std::vector<Method> methods{find_method("rk4"), find_method("symplectic_euler")};
  const auto limits = limits_along(methods, problem, path);
  for (std::size_t i = 0; i < methods.size(); ++i) {
    const double at_rest = predict(methods[i], linearised(problem)).h_max.value();
    for (const double h : limits[i]->h_max) EXPECT_NEAR(h, at_rest, 1e-3 * at_rest) << methods[i].id;
  }
}

TEST(LimitUnderALoad, IsBelowThatOfAllEigenvaluesWhereDampingCouplesManyModes) {
  const Problem problem = cube("mass_spring/press", {{"damper", 0.01}});
  const std::vector<Method> methods{find_method("rk4")};
  const Path path = load_path(problem, 1);
  const auto limit = limits_along(methods, problem, path).front();
  ASSERT_TRUE(limit);
  for (std::size_t i = 0; i < path.at.size(); ++i) {
    Linearised whole{.point = operating_point(problem, 0, path.y[i])};
    whole.modes.spectrum = spectrum_of(whole.point.model);
    const Prediction dense = predict(methods.front(), whole);
    ASSERT_TRUE(dense.h_max);
    EXPECT_GT(limit->h_max[i], 0);
    EXPECT_LE(limit->h_max[i], *dense.h_max * (1 + 1e-6)) << path.at[i];
  }
}

TEST(LimitAlongAMotion, OfABodyFallsAndRisesAboutThatAtRest) {
  const Problem problem = cube("fem_green/pull", {{"force", 5}});
  const auto along = limit_along(find_method("symplectic_euler"), problem, 0.3, 20);
  ASSERT_TRUE(along);
  EXPECT_EQ(along->t.size(), 21U);
  EXPECT_LT(along->least, along->h_max.front());
  EXPECT_GT(along->t_least, 0);
  const double there =
      predict(find_method("symplectic_euler"), linearised(problem, along->t_least, along->y_least))
          .h_max.value();
  EXPECT_NEAR(along->least, there, 1e-6 * there);
}

TEST(LimitFromAStart, OfALinearModelIsThatOfItsSpectrum) {
  const Problem problem = oscillator(0.6, 2, 0, {1, 0});
  for (const char* name : {"explicit_euler", "rk4", "central_difference"}) {
    const Method method = find_method(name);
    const double predicted = predict(method, linearised(problem)).h_max.value();
    const auto observed = limit_from_start(method, problem, 4000, predicted, size_of_motion(problem, 4000));
    ASSERT_TRUE(observed) << name;
    EXPECT_NEAR(observed->h / predicted, 1, 2e-3) << name;
  }
}

TEST(SizeOfAMotion, IsThatOfPositionsAndOfVelocitiesApart) {
  // x = cos(w t)
  const double w = 50;
  const MotionSize size = size_of_motion(oscillator(0, w * w, 0, {1, 0}), 2);
  EXPECT_NEAR(size.positions, 1, 1e-6);
  EXPECT_NEAR(size.velocities, w, 2e-3 * w);
  const MotionSize first_order = size_of_motion(make_problem("van_der_pol"), 2);
  EXPECT_GT(first_order.positions, 1);
  EXPECT_EQ(first_order.velocities, 0);
}

TEST(MotionTolerances, FollowTheSizeOfTheMotion) {
  // z'' = -z - z^3 turns round at z = 1 where z(0) = 0 and z'(0)^2 = 1.5: omega = 2 there. In x = s z, t = T
  // tau.
  for (const double s : {1e-12, 1.0, 1e12})
    for (const double T : {1e-12, 1.0, 1e12}) {
      const Problem problem = oscillator(0, 1 / (T * T), 1 / (T * T * s * s), {0, std::sqrt(1.5) * s / T});
      const auto along = limit_along(find_method("rk4"), problem, 20 * T);
      ASSERT_TRUE(along);
      EXPECT_NEAR(along->least / T, std::sqrt(8.0) / 2, 1e-3) << s << ' ' << T;
      EXPECT_NEAR(along->tolerances.atol, 1e-12 * s, 1e-14 * s);
      EXPECT_NEAR(along->tolerances.atol_velocities, 1e-12 * std::sqrt(1.5) * s / T, 1e-14 * s / T);
    }
}

TEST(MotionTolerances, OfAMotionFromRestAreThoseOfWhatItBecomes) {
  // m x'' = F from rest, m = 1: x = F t^2 / 2, v = F t.
  const double F = 1e-9, t_end = 1e3;
  Problem problem = oscillator(0, 1e-12, 0, {0, 0});
  problem.system = AnySystem(Pushed{F});
  const MotionTolerances tolerances = motion_tolerances(problem, t_end);
  EXPECT_NEAR(tolerances.atol / 1e-12, F * t_end * t_end / 2, 0.01 * F * t_end * t_end);
}

TEST(LimitsAlong, SeeASlowModeChangeBesideAFastOne) {
  Problem problem{
      .id = "fast_and_slow", .y0 = Eigen::Vector2d(1, 1), .t_end = 1, .system = AnySystem(FastAndSlow{})};
  const std::vector<Method> methods{find_method("rk4")};
  const Path path{.at = {0, 1}, .y = {problem.y0, problem.y0}};
  EXPECT_EQ(limits_along(methods, problem, path).front()->growing, 0.5);
}

TEST(LimitFromAStart, AsksPositionsAndVelocitiesToStayNear) {
  // At 50 rad/s a displacement of three times its size is nothing beside the velocity.
  const Problem problem = oscillator(0, 2500, 0, {1, 0});
  const Method method = find_method("symplectic_euler");
  const MotionSize size = size_of_motion(problem, 10);
  EXPECT_TRUE(limit_from_start(method, problem, 10, 0.04, size));
  EXPECT_FALSE(limit_from_start(method, problem, 10, 0.04, {.positions = 0.3, .velocities = 1e9}));
  EXPECT_FALSE(limit_from_start(method, problem, 10, 0.04, {.positions = 1e9, .velocities = 15}));
}

// Every run stays at an equilibrium, whatever its step.
TEST(LimitFromAStart, IsNotToldByAMotionThatStaysWhereItIs) {
  for (const double x : {0.0, 1.0}) {
    const Problem resting = make_problem({.name = "resting",
                                          .equations = {{"x", "v"}, {"v", "-100*(x - at)^3 - 100*(x - at)"}},
                                          .parameters = {{"at", x}},
                                          .y0 = {x, 0}},
                                         "resting.toml");
    EXPECT_FALSE(limit_from_start(find_method("rk4"), resting, 10, 0.04, size_of_motion(resting, 10))) << x;
  }
}

TEST(LimitsAlong, EndWhenWhoWatchesThrows) {
  const Problem problem = oscillator(0.6, 2, 0, {1, 0});
  const std::vector<Method> methods{find_method("rk4")};
  const Path path = motion_path(problem, 20);
  const MotionSize size = size_of_motion(problem, 20);
  struct Enough {};
  int looks = 0;
  const Watcher watcher = [&looks] {
    if (++looks == 3) throw Enough{};
  };
  const std::vector<std::function<void()>> tasks{
      [&] { motion_path(problem, 20, 400, watcher); }, [&] { limits_along(methods, problem, path, watcher); },
      [&] { limit_from_start(methods.front(), problem, 20, 0.2, size, thorough_search, watcher); },
      [&] {
        load_path(cube("fem_cauchy/press", {{"force", 1}}), 40, watcher);
      }};
  for (const auto& task : tasks) {
    looks = 0;
    EXPECT_THROW(task(), Enough);
    EXPECT_EQ(looks, 3);
  }
}

TEST(LimitFromAStart, OfAMethodStableAtEveryStepIsUnbounded) {
  const Problem problem = oscillator(0.6, 2, 0, {1, 0});
  const auto observed =
      limit_from_start(find_method("implicit_euler"), problem, 200, 1, size_of_motion(problem, 200));
  ASSERT_TRUE(observed);
  EXPECT_TRUE(std::isinf(observed->h));
}

}  // namespace
}  // namespace hmax
