/// Implicit methods on meshes that no generator made, at the steps of simulators.
#include <string>

#include <gtest/gtest.h>

#include "catalogue/methods/catalogue.hpp"
#include "catalogue/models/problems.hpp"
#include "limits/steps/newton_step.hpp"
#include "limits/verification.hpp"
#include "problems/mesh/files/mesh_writers.hpp"
#include "problems/tissue/body.hpp"
#include "tests/problems/mesh/files/imported_mesh.hpp"
#include "tests/results/scratch.hpp"

namespace hmax {
namespace {

/// Pressed where it is not held, of an imported mesh.
Problem imported_problem(const std::string& model, const std::string& mesh, std::uint32_t seed) {
  const Scratch scratch;
  const std::string file = (scratch / "mesh.msh").string();
  write_text(file, msh_text(imported_mesh(mesh, seed)));
  return make_problem(model + "/press@" + file, {.parameters = {{"force", 0.1}}, .unit = 1.0});
}

class ImportedBodies : public ::testing::TestWithParam<const char*> {};

TEST_P(ImportedBodies, AreSteppedByEveryMethodThatIterates) {
  for (const std::string model : {"fem_green", "mass_spring"}) {
    const Problem problem = imported_problem(model, GetParam(), 7);
    for (const char* name : {"implicit_euler", "trapezoidal", "implicit_midpoint", "tr_bdf2", "sdirk_4",
                             "radau_iia_5", "newmark"})
      for (const double h : {5e-4, 1e-3, 1e-2}) {
        const RunRecord record = find_method(name).bind(problem).run({.t_end = 10 * h, .h = h}, {});
        const std::string where =
            model + " " + name + " " + std::to_string(h) + ": " + std::string(record.note);
        EXPECT_EQ(record.outcome, Outcome::reached_end) << where;
        EXPECT_LE(record.stats.newton_error, 1e-8) << where;
      }
  }
}
INSTANTIATE_TEST_SUITE_P(Shapes, ImportedBodies,
                         ::testing::Values("phantom", "ball:n=2", "ball:n=3", "beam", "beam:n=2", "cube:n=1",
                                           "cube:n=2", "cube:n=3", "liver", "cube:n=2:refine=1"));

TEST(ImportedBodies, ConvergeInFewIterationsWithTheForcesRounding) {
  const Problem problem = imported_problem("fem_green", "liver", 3);
  const RunRecord record = find_method("implicit_euler").bind(problem).run({.t_end = 0.05, .h = 1e-3}, {});
  EXPECT_EQ(record.outcome, Outcome::reached_end);
  EXPECT_LE(record.stats.newton, 7 * record.stats.steps);
}

TEST(ImportedBodies, TakeFewerIterationsAtALooserTolerance) {
  const Problem problem = imported_problem("fem_green", "ball:n=3", 3);
  const Runner runner = find_method("implicit_euler").bind(problem);
  const RunRecord tight = runner.run({.t_end = 0.05, .h = 1e-3}, {});
  const RunRecord loose = runner.run({.t_end = 0.05, .h = 1e-3, .newton = {.tolerance = 1e-6}}, {});
  EXPECT_LT(loose.stats.newton, tight.stats.newton);
  EXPECT_LE(loose.stats.newton_error, 1e-6);
  const Eigen::Index n = problem.body->dofs();
  EXPECT_LE((loose.y - tight.y).head(n).norm(), 1e-4 * tight.y.head(n).norm());
}

TEST(NewtonStep, IsTheLongestThatIsSolvedAndTellsItsError) {
  const Problem problem = make_problem("fem_green@cube:n=2", {});
  const Method method = find_method("implicit_euler");
  const auto step = largest_newton_step(method, problem);
  ASSERT_TRUE(step);
  const Runner runner = method.bind(problem);
  EXPECT_EQ(runner.run({.t_end = step->h, .h = step->h}, {}).outcome, Outcome::reached_end);
  if (step->is_limit) {
    EXPECT_NE(runner.run({.t_end = 1.06 * step->h, .h = 1.06 * step->h}, {}).outcome, Outcome::reached_end);
  }
  EXPECT_GT(step->error, 0);
  EXPECT_LT(step->error, 0.1) << "of a cube of 0.1 m";
}

}  // namespace
}  // namespace hmax
