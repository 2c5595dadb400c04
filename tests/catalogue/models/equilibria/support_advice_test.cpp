#include "catalogue/models/equilibria/support_advice.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "catalogue/models/equilibria/body_balance.hpp"
#include "catalogue/models/equilibria/resisting_model.hpp"
#include "catalogue/models/problems.hpp"
#include "catalogue/models/tissue_problem.hpp"
#include "core/numbers.hpp"
#include "problems/tissue/body.hpp"
#include "tests/says.hpp"

namespace hmax {
namespace {

Problem block(const std::string& id, Parameters parameters) {
  return make_problem(id, {.parameters = std::move(parameters)});
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

// Of a matrix without an inverse, which rounding may give one.
TEST(LinearSag, IsNothingOfABodyThatTurns) {
  for (const char* points : {"support:points:1", "support:points:1,2"}) {
    const Problem free = block("fem_cauchy@cube:n=2", {{points, 1}});
    EXPECT_FALSE(linear_sag(*free.body)) << points;
    EXPECT_EQ(remedy_without_equilibrium(free), "") << points;
  }
  // The second tetrahedron turns about the edge that it shares with the first, which is held.
  TetMesh hinged;
  hinged.points.resize(3, 6);
  hinged.points << 0, 1, 0, 0.3, 0.2, 0.7, 0, 0, 1, 0.2, -1, -0.8, 0, 0, 0, 1, 0.1, -0.9;
  hinged.tetrahedra.resize(4, 2);
  hinged.tetrahedra << 0, 0, 1, 5, 2, 1, 3, 4;
  TissueSettings settings{.gravity = {0, 0, -9.81}};
  settings.supports = {{.points = {0, 1, 2, 3}}};
  EXPECT_FALSE(linear_sag(TissueBody(hinged, settings)));
  settings.supports = {{.points = {0, 1, 2, 3, 4}}};
  EXPECT_TRUE(linear_sag(TissueBody(hinged, settings)));
}

TEST(RemedyWithoutEquilibrium, NamesTheEndThatHoldsABodyWhichItsSupportDoesNot) {
  // A long beam of soft tissue, held at one end of its length: it hangs down by more than its length. Held
  // from below it stands.
  const Problem problem = block("fem_green@beam:n=2", {{"E", 2000}});
  const std::string remedy = remedy_without_equilibrium(problem);
  EXPECT_TRUE(says(remedy, "the support is the cause"));
  EXPECT_TRUE(says(remedy, "--set axis="));
  EXPECT_FALSE(says(remedy, "stiffer material"));
}

TEST(StatusWithoutEquilibrium, NamesTheSupportWhereItIsTheCause) {
  const Problem problem = block("fem_green@beam:n=2", {{"E", 2000}});
  const StaticSolution solution = found_equilibrium(problem, 1, {.tolerance = 1e-9}, [] { return 0.0; });
  ASSERT_FALSE(solution.converged);
  const std::string status = status_without_equilibrium(problem, solution);
  EXPECT_TRUE(says(status, "the support is the cause"));
  EXPECT_FALSE(says(status, "a smaller load"));
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
  EXPECT_TRUE(says(status, fmt::format("; fem_neo_hookean has an equilibrium, at {}, and inverts no element",
                                       millimetres(largest_displacement(held.q)))));
  // What was tried is not named once more as what may help.
  EXPECT_FALSE(says(status, "which resists being crushed"));
  // It resists already.
  EXPECT_FALSE(with_resisting_model(neo));
  // A search that finds nothing else proves nothing.
  const Problem more = block("fem_green/press@cube:n=2", {{"E", 800}, {"force", 5}, {"support", 0.2}});
  EXPECT_TRUE(says(status_without_equilibrium(more, searched(more)),
                   "; with fem_neo_hookean the only equilibrium found has inverted elements, at "));
  EXPECT_TRUE(says(remedy_without_equilibrium(block("fem_green@beam:n=2", {{"E", 1000}})),
                   "and no equilibrium was found there either"));
}

TEST(RemedyWithoutEquilibrium, OfSpringsIsNoEndThatIsFixed) {
  const Problem soft = block("fem_green@cube:n=2", {{"E", 1e9}, {"support_stiffness", 1e-9}, {"axis", -3}});
  const std::string remedy = remedy_without_equilibrium(soft);
  EXPECT_FALSE(says(remedy, "axis"));
  EXPECT_TRUE(says(remedy, "stiffer springs"));
}

TEST(RemedyWithoutEquilibrium, IsALoadOrAMaterialWhereNoSupportHelps) {
  const std::string remedy = remedy_without_equilibrium(block("fem_green@cube:n=2", {{"E", 1}}));
  EXPECT_TRUE(says(remedy, "a smaller load or a stiffer material"));
  EXPECT_TRUE(says(remedy_without_equilibrium(block("fem_green/press@cube:n=2", {{"force", 500}})),
                   "a smaller load"));
}

// Each end is made as a body of its own: the oracle of the comparison.
TEST(SuggestedSupport, IsTheEndWithTheLeastSagWhereNoneIsChosen) {
  const Parameters soft{{"E", 20000}};
  const auto suggested = suggested_support(block("fem_green@beam:n=2", soft));
  ASSERT_TRUE(suggested);
  const auto with = [&](int axis) {
    return *linear_sag(
        *block("fem_green@beam:n=2", {{"E", 20000}, {"axis", static_cast<double>(axis)}}).body);
  };
  EXPECT_EQ(suggested->axis_now, 1);
  EXPECT_NEAR(suggested->sag_now, with(1), 1e-9 * with(1));
  for (const int axis : {1, -1, 2, -2, 3, -3}) EXPECT_GE(with(axis), (1 - 1e-9) * suggested->sag) << axis;
  EXPECT_NEAR(suggested->sag, with(suggested->axis), 1e-9 * suggested->sag);
  EXPECT_LT(suggested->sag, 0.5 * suggested->sag_now);
  EXPECT_TRUE(says(in_words(*suggested), fmt::format("--set axis={}", suggested->axis)));
  // What the user chose, other loads, and an end that is good.
  EXPECT_FALSE(suggested_support(block("fem_green@beam:n=2", {{"E", 20000}, {"axis", 1}})));
  EXPECT_FALSE(suggested_support(block("fem_green@beam:n=2", {{"E", 20000}, {"support:x<0.01", 1}})));
  EXPECT_FALSE(suggested_support(block("fem_green@beam:n=2", {{"E", 20000}, {"xmax", 0.01}})));
  EXPECT_FALSE(suggested_support(block("fem_green@beam:n=2", {{"E", 20000}, {"support", 0}})));
  EXPECT_FALSE(suggested_support(block("fem_green/press@beam:n=2", soft)));
  EXPECT_FALSE(suggested_support(block("fem_green@cube:n=2", {})));
  // The share of an end is no end.
  EXPECT_TRUE(suggested_support(block("fem_green@beam:n=2", {{"E", 20000}, {"support", 0.05}})));
}

// Conjugate gradients above 6000 unknowns, a factor below.
TEST(SuggestedSupport, OfLargerBodiesIsThatOfAFactor) {
  const Problem problem = block("fem_cauchy@beam:n=8", {});
  ASSERT_GT(problem.body->dofs(), 6000);
  const auto suggested = suggested_support(problem);
  ASSERT_TRUE(suggested);
  const auto solved = found_equilibrium(problem, 1, {.method = StaticMethod::linear}, [] { return 0.0; });
  EXPECT_NEAR(suggested->sag_now, largest_displacement(solved.q), 0.01 * suggested->sag_now);
}

}  // namespace
}  // namespace hmax
