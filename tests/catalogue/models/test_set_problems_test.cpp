/// The test set as the catalogue knows it.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "bench/timing/reference.hpp"
#include "catalogue/methods/catalogue.hpp"
#include "catalogue/models/problems.hpp"
#include "core/errors.hpp"
#include "tests/says.hpp"

namespace hmax {
namespace {

const std::vector<std::string> ids{"dahlquist",         "van_der_pol", "robertson", "hires",  "pleiades",
                                   "oregonator",        "kepler",      "arenstorf", "lorenz", "brusselator",
                                   "prothero_robinson", "spring_chain"};

ProblemSettings with(std::vector<std::pair<std::string, double>> parameters, std::vector<double> y0 = {}) {
  return {.parameters = std::move(parameters), .y0 = std::move(y0)};
}

double parameter(const Problem& problem, const std::string& name) {
  for (const auto& [known, value] : problem.parameters)
    if (known == name) return value;
  return std::nan("");
}

std::string refusal(const std::string& id, const ProblemSettings& settings) {
  return error_of<InputError>([&] { make_problem(id, settings); });
}

TEST(TestSetProblems, AreInTheCatalogueByTheirIds) {
  const std::vector<std::string> known = problem_ids();
  for (const std::string& id : ids) {
    EXPECT_EQ(std::ranges::count(known, id), 1) << id;
    const Problem problem = make_problem(id);
    EXPECT_EQ(problem.id, id);
    EXPECT_EQ(static_cast<std::size_t>(problem.y0.size()), problem.states.size());
    EXPECT_GT(problem.t_end, 0);
    EXPECT_EQ(problem.has_exact_solution, static_cast<bool>(problem.exact));
  }
}

TEST(TestSetProblems, TakeParametersByName) {
  EXPECT_EQ(parameter(make_problem("van_der_pol"), "mu"), 1000);
  EXPECT_EQ(parameter(make_problem("van_der_pol", with({{"mu", 5}})), "mu"), 5);
  EXPECT_EQ(make_problem("brusselator", with({{"n", 7}})).y0.size(), 14);
  EXPECT_EQ(make_problem("spring_chain", with({{"n", 3}})).states,
            (std::vector<std::string>{"q1", "q2", "q3", "v1", "v2", "v3"}));
  EXPECT_NEAR(static_cast<double>(make_problem("dahlquist", with({{"lambda", -2}})).exact(1)[0]),
              std::exp(-2.0), 1e-15);
  // The eccentricity sets the start.
  EXPECT_EQ(make_problem("kepler", with({{"e", 0.5}})).y0[0], 0.5);
}

TEST(TestSetProblems, RefuseWhatTheyDoNotKnow) {
  EXPECT_TRUE(says(refusal("van_der_pol", with({{"nu", 5}})), "did you mean 'mu'"));
  EXPECT_TRUE(says(refusal("hires", with({{"mu", 5}})), "no parameters to set"));
  EXPECT_TRUE(says(refusal("brusselator", with({{"n", 2.5}})), "whole number"));
  EXPECT_TRUE(says(refusal("kepler", with({{"e", 1}})), "[0, 1)"));
  EXPECT_TRUE(says(refusal("lorenz", with({}, {1, 2})), "3 states (x, y, z)"));
  EXPECT_TRUE(says(refusal("lorentz", with({})), "did you mean 'lorenz'"));
  EXPECT_TRUE(says(refusal("kepler", {.material = "male_slim"}), "--material"));
}

TEST(TestSetProblems, KnowTheirSolutionFromTheStartThatIsAskedFor) {
  const Problem circle = make_problem("kepler", with({}, {1, 0, 0, 1}));
  ASSERT_TRUE(circle.has_exact_solution);
  EXPECT_NEAR(static_cast<double>(circle.exact(1)[0]), std::cos(1.0), 1e-15);
  EXPECT_FALSE(make_problem("kepler", with({}, {1, 0, 0, 2})).has_exact_solution);
  EXPECT_TRUE(make_problem("spring_chain").has_exact_solution);
  EXPECT_FALSE(make_problem("spring_chain", with({{"k3", 1}})).has_exact_solution);
}

TEST(TestSetProblems, HaveReferencesThatStateTheirError) {
  for (const std::string& id : ids) {
    const Problem problem = make_problem(id);
    // The stiff ones to their end are the business of the reference's own tests.
    const double t_end = std::min(problem.t_end, 5.0);
    const Reference reference = make_reference(problem, t_end);
    EXPECT_EQ(reference.valid_until, t_end) << id;
    EXPECT_LT(reference.error_bound, 1e-12 * (1 + problem.y0.norm())) << id;
    EXPECT_GT(reference.error_bound, 0) << id;
    EXPECT_LT((reference.at(0) - problem.y0).norm(), 1e-18 * (1 + problem.y0.norm())) << id;
    ASSERT_TRUE(reference.extended_at) << id;
    EXPECT_EQ(reference.name.find("exact") != std::string::npos, problem.has_exact_solution) << id;
  }
}

TEST(TestSetProblems, ReferenceTurnsToTheStiffRuleWhenDampersMakeAChainStiff) {
  const Problem problem = make_problem("spring_chain", with({{"n", 3}, {"c", 1e7}, {"k3", 1}}));
  const Reference reference = make_reference(problem, 1);
  EXPECT_EQ(reference.valid_until, 1);
  EXPECT_TRUE(says(reference.name, "implicit Euler"));
}

TEST(TestSetProblems, RunWithMethodsOfTheCatalogue) {
  for (const char* id :
       {"kepler", "arenstorf", "lorenz", "pleiades", "brusselator", "spring_chain", "dahlquist"}) {
    const Problem problem = make_problem(id);
    const double t_end = std::min(problem.t_end, 2.0);
    const RunSpec spec{.t_end = t_end, .adaptive = true, .rtol = 1e-11, .atol = 1e-11};
    const RunRecord record = find_method("dop_853").bind(problem).run(spec, nullptr);
    ASSERT_EQ(record.outcome, Outcome::reached_end) << id;
    const Reference reference = make_reference(problem, t_end);
    EXPECT_LT((record.y - reference.at(t_end)).cwiseAbs().maxCoeff(), 1e-6) << id;
  }
}

}  // namespace
}  // namespace hmax
