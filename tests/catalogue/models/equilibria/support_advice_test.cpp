#include "catalogue/models/equilibria/support_advice.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "catalogue/models/equilibria/body_balance.hpp"
#include "catalogue/models/equilibria/resisting_model.hpp"
#include "catalogue/models/problems.hpp"
#include "catalogue/models/tissue_problem.hpp"
#include "core/numbers.hpp"
#include "problems/tissue/body.hpp"

namespace hmax {
namespace {

Problem block(const std::string& id, Parameters parameters) {
  return make_problem(id, {.material = {}, .parameters = std::move(parameters), .y0 = {}});
}

TEST(LinearSag, OfACubeThatHangsIsThatOfARod) {
  // Held at the top, nu = 0: u = rho g L^2 / (2 E), here of the points below the held slab.
  const double E = 1e4, rho = 1000, g = 9.81;
  const auto sag = linear_sag(
      *block("fem_cauchy@cube:n=8", {{"E", E}, {"nu", 0}, {"rho", rho}, {"axis", -3}, {"support", 0.01}})
           .body);
  ASSERT_TRUE(sag);
  const Problem problem = block("fem_cauchy@cube:n=8", {});
  const auto& points = problem.body->mesh().points;
  const double L = points.row(2).maxCoeff() - points.row(2).minCoeff();
  EXPECT_NEAR(*sag, rho * g * L * L / (2 * E), 0.05 * rho * g * L * L / (2 * E));
}

TEST(RemedyWithoutEquilibrium, NamesTheEndThatHoldsABodyWhichItsSupportDoesNot) {
  // A long beam of soft tissue, held at one end of its length: it hangs down by more than its length. Held
  // from below it stands.
  const Problem problem = block("fem_green@beam:n=2", {{"E", 2000}});
  const std::string remedy = remedy_without_equilibrium(problem);
  EXPECT_NE(remedy.find("the support is the cause"), std::string::npos) << remedy;
  EXPECT_NE(remedy.find("--set axis="), std::string::npos) << remedy;
  EXPECT_EQ(remedy.find("stiffer material"), std::string::npos) << remedy;
}

TEST(StatusWithoutEquilibrium, NamesTheSupportWhereItIsTheCause) {
  const Problem problem = block("fem_green@beam:n=2", {{"E", 2000}});
  const StaticSolution solution = found_equilibrium(problem, 1, {.tolerance = 1e-9}, [] { return 0.0; });
  ASSERT_FALSE(solution.converged);
  const std::string status = status_without_equilibrium(problem, solution);
  EXPECT_NE(status.find("the support is the cause"), std::string::npos) << status;
  EXPECT_EQ(status.find("a smaller load"), std::string::npos) << status;
}

// The same search with the other model is the oracle.
TEST(StatusWithoutEquilibrium, SaysWhatAModelDoesThatResistsInversion) {
  const Problem green = block("fem_green/press@cube:n=3", {{"E", 800}, {"force", 1}, {"support", 0.2}}),
                neo = block("fem_neo_hookean/press@cube:n=3", {{"E", 800}, {"force", 1}, {"support", 0.2}});
  const auto searched = [](const Problem& problem) {
    return found_equilibrium(problem, 1, {.tolerance = 1e-9}, [] { return 0.0; });
  };
  const StaticSolution crushed = searched(green), held = searched(neo);
  ASSERT_TRUE(crushed.barred);
  ASSERT_TRUE(held.converged);
  const std::string status = status_without_equilibrium(green, crushed);
  EXPECT_NE(status.find(fmt::format("; fem_neo_hookean has an equilibrium, at {}, and inverts no element",
                                    millimetres(largest_displacement(held.q)))),
            std::string::npos)
      << status;
  // It resists already.
  EXPECT_FALSE(with_resisting_model(neo));
}

TEST(RemedyWithoutEquilibrium, IsALoadOrAMaterialWhereNoSupportHelps) {
  const std::string remedy = remedy_without_equilibrium(block("fem_green@cube:n=2", {{"E", 1}}));
  EXPECT_NE(remedy.find("a smaller load or a stiffer material"), std::string::npos) << remedy;
  EXPECT_NE(
      remedy_without_equilibrium(block("fem_green/press@cube:n=2", {{"force", 500}})).find("a smaller load"),
      std::string::npos);
}

}  // namespace
}  // namespace hmax
