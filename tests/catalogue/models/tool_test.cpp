/// A tool presses as deep as it says, and limits of steps contain its contact.
#include <random>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "catalogue/methods/catalogue.hpp"
#include "catalogue/models/equilibria/body_balance.hpp"
#include "catalogue/models/problems.hpp"
#include "catalogue/models/tissue_choice.hpp"
#include "core/errors.hpp"
#include "limits/predict.hpp"
#include "limits/verification.hpp"
#include "problems/tissue/body.hpp"
#include "tests/says.hpp"

namespace hmax {
namespace {

Problem pressed(const std::string& mesh, std::vector<std::pair<std::string, double>> parameters = {}) {
  return make_problem("fem_green/tool@" + mesh, {.parameters = std::move(parameters)});
}

/// The indentation over the depth, in static equilibrium, where the tool does not slide off.
double share_reached(const Problem& problem) {
  const StaticSolution equilibrium = found_equilibrium(problem, 1, {}, [] { return 0.0; });
  EXPECT_TRUE(equilibrium.converged) << problem.id << ": " << equilibrium.note;
  const auto reach = problem.body->tool_reaches(problem.body->steady_from(), equilibrium.q).front();
  EXPECT_GE(reach.displacement, 0.5 * reach.depth) << problem.id;
  return reach.indentation / reach.depth;
}

TEST(Tool, PressesAsDeepAsItSays) {
  for (const char* mesh : {"liver", "ball", "beam", "cube:n=4", "phantom"}) {
    const double share = share_reached(pressed(mesh));
    EXPECT_GE(share, 0.9) << mesh;
  }
}

TEST(Tool, StartsWhereItTouchesTheBody) {
  for (const char* mesh :
       {"liver", "ball", "beam", "cube:n=4", "phantom", "beam:n=12,width=0.2,height=0.004"}) {
    const Problem problem = pressed(mesh);
    const TissueBody& body = *problem.body;
    EXPECT_EQ(body.tool_reaches(0, problem.y0).front().penetration, 0) << mesh;
    EXPECT_EQ(body.energy(0, problem.y0.head(body.dofs())), 0) << mesh;
  }
  EXPECT_THROW(pressed("liver", {{"tool_x", 0}, {"tool_y", 0}, {"tool_z", 0}}), InputError);
  EXPECT_THROW(pressed("liver", {{"depth", -0.01}}), InputError);
}

TEST(Tool, ThatBeginsInsideTheBodyIsRefused) {
  // Points are 5 cm apart: a tool of a millimetre meets none of them.
  const auto refusal = [](double x, double y, double z) -> std::string {
    return error_of<InputError>([&] {
      pressed("cube:n=2,edge=0.1", {{"tool_x", x},
                                    {"tool_y", y},
                                    {"tool_z", z},
                                    {"tool_radius", 0.001},
                                    {"tool_dx", 0},
                                    {"tool_dy", 0},
                                    {"tool_dz", -1},
                                    {"depth", 0.04}});
    });
  };
  const TetMesh cube = pressed("cube:n=2,edge=0.1").body->mesh();
  const Eigen::Vector3d low = cube.points.rowwise().minCoeff();
  const auto at = [&](double x, double y, double z) { return refusal(low(0) + x, low(1) + y, low(2) + z); };
  EXPECT_TRUE(says(at(0.03, 0.02, 0.035), "starts inside the body")) << "wholly inside";
  EXPECT_TRUE(says(at(0.03, 0.02, 0.0995), "starts inside the body")) << "through a triangle";
  EXPECT_EQ(at(0.03, 0.02, 0.1), "");
  EXPECT_EQ(at(0.05, 0.05, 0.1), "") << "on a point but for rounding";
  EXPECT_TRUE(says(at(0.05, 0.05, 0.09999), "starts inside the body")) << "on a point";
  EXPECT_EQ(at(0.03, 0.02, 0.11), "");
}

TEST(Tool, TooLargeToTellDepthsFromRoundingIsRefused) {
  // Diagonals of 0.173 m: 1700 m are told, and what is 1e6 m large met nothing.
  EXPECT_GE(share_reached(pressed("cube:n=4,edge=0.1", {{"depth", 0.005}, {"tool_radius", 1700}})), 0.9);
  for (const double radius : {1800.0, 1e5, 1e20})
    EXPECT_TRUE(says(error_of<InputError>([&] {
                       pressed("cube:n=4,edge=0.1", {{"depth", 0.005}, {"tool_radius", radius}});
                     }),
                     "spheres of more than 1.73e+03 m"))
        << radius;
}

TEST(Tool, DeeperThanItsDiameterIsFollowedToItsEquilibrium) {
  const Problem problem =
      make_problem("fem_neo_hookean/tool@beam", {.parameters = {{"depth", 0.021}, {"tool_radius", 0.01}}});
  const Linearised near = linearised(problem);
  ASSERT_EQ(near.point.kind, StateKind::equilibrium) << near.point.status;
  EXPECT_GT(problem.body->tool_reaches(near.point.model.t, near.point.model.y).front().indentation, 0.015);
}

TEST(Tool, PressesAsDeepAsItSaysWhateverTheMeshAndTheDepth) {
  const Problem smooth = pressed("ball:n=6");
  LoadedMesh jittered{.name = "ball:n=6", .mesh = smooth.body->mesh(), .origin = smooth.body->origin()};
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> by(-0.001, 0.001);
  for (double& x : jittered.mesh.points.reshaped()) x += by(random);
  for (const double depth : {0.002, 0.005}) {
    const TissueId id("fem_green/tool@ball:n=6");
    const TissueParameters parameters = tissue_parameters(id, {.parameters = {{"depth", depth}}});
    Problem problem = smooth;
    problem.body = std::make_shared<const TissueBody>(
        jittered.mesh, tissue_settings(id, parameters, jittered), jittered.origin);
    EXPECT_GE(share_reached(problem), 0.9) << depth;
  }
}

TEST(Tool, MovesABodyFromRestWithImplicitStructuralMethods) {
  // The first motion is smaller than the rounding of positions in space.
  for (const char* model : {"mass_spring", "fem_corotational", "fem_green"})
    for (const char* name : {"newmark", "hht_alpha", "generalized_alpha"})
      for (const double h : {0.01, 0.001}) {
        const Problem problem = make_problem(fmt::format("{}/tool@phantom", model));
        const RunRecord record = find_method(name).bind(problem).run({.t_end = 0.05, .h = h}, {});
        EXPECT_EQ(record.outcome, Outcome::reached_end)
            << model << ' ' << name << ' ' << h << ' ' << record.note;
      }
}

TEST(Tool, IsInTheLimitsOfStepsAtTheEquilibriumUnderIt) {
  const Method method = find_method("symplectic_euler");
  const Problem usual = pressed("phantom");
  const double stiffness = usual.body->settings().tools.front().stiffness;
  double last = 1;
  // Beyond some seventy times rounding decides whether Newton's method finds the equilibrium.
  for (const double factor : {1.0, 50.0}) {
    const Problem problem = pressed("phantom", {{"tool_stiffness", factor * stiffness}});
    const Linearised near = linearised(problem);
    ASSERT_EQ(near.point.kind, StateKind::equilibrium) << factor << ": " << near.point.status;
    EXPECT_EQ(near.point.missing, "");
    Prediction row = predict(method, near);
    ASSERT_EQ(row.bound, Bound::stability) << row.note;
    verify(row, method, problem, near);
    EXPECT_TRUE(row.observed && row.observed->confirms()) << row.note;
    EXPECT_LT(*row.h_max, last);
    last = *row.h_max;
  }
  const Linearised rest = linearised(usual, AskedState::rest);
  EXPECT_NE(rest.point.missing, "");
}

}  // namespace
}  // namespace hmax
