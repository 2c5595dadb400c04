#include "cli/advice/advice_words.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "catalogue/methods/catalogue.hpp"
#include "catalogue/models/problems.hpp"
#include "tests/says.hpp"

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
  const AdviceQuestion question{.rate = 100};
  for (const auto& [of, words] : words_of(problem, question, advice, false).facts)
    if (of == name) return words;
  return {};
}

Problem cube(const std::string& load) { return make_problem("fem_green/" + load + "@cube:n=1", {}); }

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

TEST(AdviceWords, CautionWhereTheSearchEndedEarly) {
  const Problem problem = make_problem("liver_forced");
  Advice advice = advice_of({find_method("rk4"), {}, {}});
  EXPECT_EQ(fact(problem, advice, "caution"), "");
  advice.out_of_time = true;
  advice.stage = AdviceStage::proving;
  advice.rows.emplace_back().verdict = AdviceVerdict::predicted;
  EXPECT_EQ(
      fact(problem, advice, "caution"),
      "time limit reached: the best rows are timed, but not verified by long runs; 1 of 2 rows were not run");
}

TEST(AdviceWords, TellOfNoMoreThanAPredictionWhereNothingWasRun) {
  const Problem problem = make_problem("liver_forced");
  const AdviceQuestion question{.rate = 100};
  Advice advice = advice_of({find_method("rk4"), {}, {}});
  advice.rows.front().verdict = AdviceVerdict::predicted;
  advice.rows.front().expected_frame = 2e-3;
  advice.out_of_time = true;
  advice.stage = AdviceStage::searching;
  const AdviceText text = words_of(problem, question, advice, false);
  EXPECT_EQ(text.answer,
            "time limit reached: no method that was run to its end meets this; 1 of 1 rows were not run");
  EXPECT_EQ(text.help,
            "Predicted, not run: rk4 with h = 10 ms, 1 step per frame, at least 2 of 10 ms per frame. Take a "
            "longer --within");
  EXPECT_EQ(text.motion, "no motion was run");
  EXPECT_EQ(text.table.at(1).at(6), ">= 2");
  // Steps that take longer than a frame may are not what a longer run would find.
  advice.rows.insert(advice.rows.begin(), advice.rows.front());
  advice.rows.front().expected_frame = 11e-3;
  EXPECT_EQ(words_of(problem, question, advice, false).help, text.help);
  advice.rows.pop_back();
  EXPECT_EQ(words_of(problem, question, advice, false).help, "");
}

TEST(AdviceWords, SetWhatIsShownOfTheMaterialBesideTheFastestThatShowsAnother) {
  Advice advice = advice_of({find_method("newmark"), {}, {}});
  advice.rows.front().stiffness_shown = 1;
  const auto add = [&](const char* method, double frame, double shown) {
    AdviceRow& row = advice.rows.emplace_back();
    row.candidate.method = find_method(method);
    row.frame.p50 = frame;
    row.stiffness_shown = shown;
    row.verdict = AdviceVerdict::inaccurate;
  };
  add("rk4", 1e-3, 1);
  EXPECT_EQ(fact(cube("press"), advice, "material"), "");
  EXPECT_EQ(words_of(cube("press"), {}, advice, false).table.front().size(), 10U);
  add("xpbd", 3e-3, 1.5);
  add("vbd", 2e-3, 0.42);
  EXPECT_EQ(fact(cube("press"), advice, "material"),
            "shows 100 % of the stiffness; vbd, 2 ms per frame, shows 42 %");
  const auto table = words_of(cube("press"), {}, advice, false).table;
  EXPECT_EQ(table.front().at(6), "stiffness");
  EXPECT_EQ(table.back().at(6), "42 %");
  advice.rows.resize(1);
  advice.rows.front().stiffness_shown = 0.9;
  EXPECT_EQ(fact(cube("press"), advice, "material"), "shows 90 % of the stiffness");
}

TEST(AdviceWords, SayWhyTheBestIsTheBest) {
  const Problem problem = make_problem("liver_forced");
  Advice advice = advice_of({find_method("rk4"), {}, {}});
  advice.rows.front().frame.p50 = 2e-3;
  EXPECT_EQ(fact(problem, advice, "chosen as"), "");  // nothing else was asked about
  const auto add = [&](const char* method, AdviceVerdict verdict, double frame, double error) {
    AdviceRow& row = advice.rows.emplace_back();
    row.candidate = {find_method(method), {}, {}};
    row.verdict = verdict;
    row.frame.p50 = frame;
    row.error = error;
  };
  add("explicit_euler", AdviceVerdict::unstable, 1e-4, 1e9);
  EXPECT_EQ(fact(problem, advice, "chosen as"), "the only row that suits");
  add("newmark", AdviceVerdict::suitable, 8e-3, 1e-3);
  add("hht_alpha", AdviceVerdict::suitable, 3e-3, 1e-3);
  add("implicit_euler", AdviceVerdict::inaccurate, 1e-3, 0.23);
  add("imex_euler", AdviceVerdict::inaccurate, 5e-4, 0.4);
  add("trapezoidal", AdviceVerdict::inaccurate, 3e-3, 0.02);  // dearer: no reason
  EXPECT_EQ(
      fact(problem, advice, "chosen as"),
      "the least CPU time of 3 rows that suit; hht_alpha takes 1.5 times as much; implicit_euler takes 0.5 times "
      "as much, and is off by 23 %");
  add("sdirk_4", AdviceVerdict::predicted, AdviceRow::none, AdviceRow::none);
  EXPECT_TRUE(
      says(fact(problem, advice, "chosen as"), "of 3 rows that suit, of those that were run; hht_alpha"));
}

TEST(AdviceWords, NameTheModelThatInvertsNoElement) {
  const Problem problem = cube("press");
  Advice advice = advice_of({find_method("symplectic_euler"), {}, {}});
  advice.gravity_share = 0.25;
  advice.other_model = {.id = "fem_neo_hookean", .scale = 0.061};
  const AdviceQuestion question{.rate = 100};
  const AdviceText text = words_of(problem, question, advice, false);
  EXPECT_TRUE(std::ranges::any_of(text.facts, [](const auto& each) {
    return each.second ==
           "--model fem_neo_hookean moves by 61 mm under all of gravity and all of the load, and inverts no element";
  }));
  // One that does no better is not named.
  advice.other_model->gravity_share = 0.25;
  for (const auto& [name, words] : words_of(problem, question, advice, false).facts)
    EXPECT_FALSE(says(words, "fem_neo_hookean"));
}

}  // namespace
}  // namespace hmax
