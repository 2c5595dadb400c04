#include "cli/advice/advice_words.hpp"

#include <gtest/gtest.h>

#include "catalogue/methods/catalogue.hpp"
#include "catalogue/models/problems.hpp"

namespace hmax {
namespace {

/// An answer that recommends a method, with a limit.
Advice advice_of(Candidate candidate) {
  Advice advice;
  AdviceRow& row = advice.rows.emplace_back();
  row.candidate = std::move(candidate);
  row.h = 0.01;
  row.steps_per_frame = 1;
  row.h_max = 0.02;
  row.verdict = AdviceVerdict::recommended;
  return advice;
}

/// What an answer says under a name; empty where it has none.
std::string fact(const Problem& problem, const Advice& advice, const std::string& name) {
  const AdviceQuestion question{.rate = 100, .budget = {}, .methods = {}, .motion = {}};
  for (const auto& [of, words] : words_of(problem, question, advice, false).facts)
    if (of == name) return words;
  return {};
}

Problem cube(const std::string& load) {
  return make_problem("fem_green/" + load + "@cube:n=1", {.material = {}, .parameters = {}, .y0 = {}});
}

TEST(AdviceWords, SayWhichJacobianIsFrozen) {
  const Method method = find_method("linearly_implicit_euler");
  const Advice frozen = advice_of({method, {.every = JacobianUpdate::frozen}, {}}),
               exact = advice_of({method, {}, {}});
  EXPECT_EQ(
      fact(cube("gravity"), frozen, "Jacobian"),
      "of the start of the motion, the equilibrium under gravity; that of `run` and `stability predict --jacobian "
      "frozen` is of their initial state, by default the body without loads");
  EXPECT_EQ(
      fact(make_problem("liver_forced"), frozen, "Jacobian"),
      "of the start of the motion; that of `run` and `stability predict --jacobian frozen` is of their initial "
      "state");
  EXPECT_EQ(fact(cube("gravity"), exact, "Jacobian"), "");
}

TEST(AdviceWords, WarnWherePublishedSpreadsOfAMaterialCrossTheStep) {
  const Problem problem = make_problem("liver_forced");
  Advice advice = advice_of({find_method("rk4"), {}, {}});
  // h = 10 ms beside h_max = 20 ms, of which 0.45 are 9 ms and 0.55 are 11 ms. Of a frame of 10 ms two steps
  // are the fewest that are at most 0.95 * 9 ms.
  advice.bands = {{.quantity = "mass", .spread = 0.077, .low = 0.9},
                  {.quantity = "stiffness", .spread = 0.29, .low = 0.45}};
  EXPECT_EQ(
      fact(problem, advice, "caution"),
      "where the stiffness is 29 % off, h_max falls to 9 ms; h = 5 ms, 2 steps per frame, is below that");
  advice.bands.back().low = 0.55;
  EXPECT_EQ(fact(problem, advice, "caution"), "");
}

TEST(AdviceWords, SayOfALimitEachThingOnce) {
  const Problem problem = make_problem("liver_forced");
  Advice advice = advice_of({find_method("rk4"), {}, {}});
  AdviceRow& row = advice.rows.front();
  row.status = "h_max is that of the start; along the motion no limit is known";
  row.h_max_of_start = true;
  EXPECT_EQ(fact(problem, advice, "stability"),
            "h_max 20 ms predicted, that of the start: along the motion none is known; not observed");
  row.h_max_of_start = false;
  row.unobserved = "runs at 1.25 of the predicted limit still hold";
  row.status = "of something else; " + row.unobserved;
  EXPECT_EQ(
      fact(problem, advice, "stability"),
      "h_max 20 ms predicted, the smallest along the motion; runs at 1.25 of the predicted limit still hold");
}

}  // namespace
}  // namespace hmax
