/// What is known of an answer before its end.
#include "advice/first_answer.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <string>
#include <thread>

#include <gtest/gtest.h>

#include "bench/timing/timing.hpp"
#include "core/numbers.hpp"
#include "limits/linearised_problem.hpp"
#include "limits/predict.hpp"
#include "tests/advice/cube.hpp"
#include "tests/says.hpp"

namespace hmax {
namespace {

TEST(FirstAnswer, TimesStepsAndLeavesOutWhatIsHopeless) {
  const Problem problem = cube("press", {{"alpha", 1}});
  AdviceQuestion asked = question(100, {"symplectic_euler", "rk4", "explicit_euler", "rk2_heun"}, problem);
  const Linearised near = linearised(problem, 0, problem.y0);
  const std::vector<Candidate> all = candidates(asked.methods, problem);
  const std::vector<AdviceRow> rows = first_answer(problem, asked, near, all);
  ASSERT_EQ(rows.size(), 4U);
  for (const AdviceRow& row : rows) {
    const double h_max = *predict(row.candidate.method, near).h_max;
    EXPECT_EQ(row.h_max, h_max);
    EXPECT_LT(row.h, 0.95 * h_max);
    EXPECT_GT(asked.frame() / static_cast<double>(row.steps_per_frame - 1), 0.95 * h_max);
    // The steps alone, in as long a run.
    const Runner runner = row.candidate.method.bind(problem);
    double least = infinity, most = 0;
    for (int sample = 0; sample < 10; ++sample) {
      const double begun = thread_cpu_seconds();
      (void)runner.run(row.candidate.spec(row.h, asked.frame()), {});
      const double seen = thread_cpu_seconds() - begun;
      least = std::min(least, seen);
      most = std::max(most, seen);
    }
    EXPECT_GT(row.expected_frame, least / 10) << row.candidate.words();
    EXPECT_LT(row.expected_frame, most * 10) << row.candidate.words();
  }
  EXPECT_TRUE(std::ranges::is_sorted(rows, {}, &AdviceRow::expected_frame));
  asked.budget = rows[1].expected_frame / 10;
  std::size_t hopeless = 0;
  for (const AdviceRow& row : first_answer(problem, asked, near, all))
    if (row.verdict == AdviceVerdict::too_slow) ++hopeless;
  EXPECT_GE(hopeless, 3U);
}

// A load that crushes elements has no equilibrium with Green's strain, and has one with a model that resists.
TEST(OtherModel, BearsWhatAModelDoesNotThatCollapses) {
  const auto pressed = [](double force) {
    return cube("press", {{"E", 200}, {"force", force}, {"support", 0.2}, {"alpha", 10}});
  };
  AdviceQuestion asked = question(100, {"symplectic_euler"}, pressed(1));
  const Advice crushed = advise(pressed(1), asked);
  EXPECT_LT(crushed.load_share, 1);
  ASSERT_TRUE(crushed.other_model);
  EXPECT_EQ(crushed.other_model->id, "fem_neo_hookean");
  EXPECT_GT(crushed.other_model->load_share, crushed.load_share);
  EXPECT_GT(crushed.other_model->scale, 0);
  EXPECT_FALSE(crushed.other_model->inversion);
  EXPECT_FALSE(advise(pressed(1e-3), asked).other_model);
}

// Without damping steps of explicit Euler grow however short they are.
TEST(FirstAnswer, KnowsThatNoStepIsStable) {
  const Problem problem = cube("press");
  const AdviceQuestion asked = question(100, {"explicit_euler"}, problem);
  const Advice advice = advise(problem, asked);
  ASSERT_EQ(advice.rows.size(), 1U);
  EXPECT_EQ(advice.rows[0].verdict, AdviceVerdict::unstable);
  EXPECT_TRUE(std::isnan(advice.rows[0].frame.p50));
  EXPECT_EQ(advice.motion, "");
}

TEST(Advise, AnswersWithWhatItKnowsWhenItsTimeIsOver) {
  const Problem problem = cube("press");
  AdviceQuestion asked = question(100, {"symplectic_euler", "rk4", "newmark"}, problem);
  // What a watcher takes is time of the answer, too.
  const auto waiting_in = [&](std::string_view task) {
    Advice advice;
    advise(problem, asked, advice, [&](double, const std::string& what) {
      if (what.starts_with(task)) std::this_thread::sleep_for(std::chrono::duration<double>(asked.within));
    });
    EXPECT_TRUE(advice.out_of_time) << task;
    EXPECT_GE(advice.seconds, asked.within) << task;
    EXPECT_LT(advice.seconds, 2 * asked.within) << task;
    return advice;
  };
  asked.within = 2;
  const Advice predicted = waiting_in("finding the reference");
  EXPECT_EQ(predicted.recommended(), nullptr);
  for (const AdviceRow& row : predicted.rows) {
    EXPECT_EQ(row.verdict, AdviceVerdict::predicted);
    EXPECT_TRUE(says(row.status, "time"));
  }
  const Advice searched = waiting_in("steps of newmark");
  ASSERT_NE(searched.recommended(), nullptr);
  EXPECT_LT(searched.proof.size(), 2U);
  const Advice observed = waiting_in("runs beside");
  ASSERT_NE(observed.recommended(), nullptr);
  EXPECT_EQ(observed.proof.size(), 2U);
  EXPECT_EQ(observed.stage, AdviceStage::observing);
  Advice failed = predicted;
  find_remedies(problem, asked, failed, {});
  EXPECT_FALSE(failed.all_tried);
  EXPECT_TRUE(failed.remedies.empty());
}

TEST(Advise, RunsOtherMethodsWhereOneTakesMoreThanItsPartOfTheTime) {
  const Problem problem = cube("press");
  AdviceQuestion asked = question(100, {"symplectic_euler", "rk4", "newmark"}, problem);
  asked.within = 8;
  std::string slow;  // the method that is searched first
  Advice advice;
  advise(problem, asked, advice, [&](double, const std::string& what) {
    if (slow.empty() && what.starts_with("steps of")) slow = what;
    if (what == slow) std::this_thread::sleep_for(std::chrono::duration<double>(asked.within / 20));
  });
  EXPECT_TRUE(advice.out_of_time);
  ASSERT_NE(advice.recommended(), nullptr) << slow;
  for (const AdviceRow& row : advice.rows)
    EXPECT_EQ(row.verdict == AdviceVerdict::predicted, slow == "steps of " + row.candidate.words())
        << row.candidate.words();
}

// Each method takes four tenths of the time, more than it may while others wait, and again when it is its
// turn.
TEST(Advise, LeavesTimeToAMethodThatNeedsMostOfIt) {
  const Problem problem = cube("press");
  AdviceQuestion asked = question(100, {"symplectic_euler", "rk4", "newmark"}, problem);
  asked.within = 10;
  std::map<std::string, int> calls;
  Advice advice;
  advise(problem, asked, advice, [&](double, const std::string& what) {
    if (what.starts_with("steps of") && ++calls[what] <= 2)
      std::this_thread::sleep_for(std::chrono::duration<double>(0.4 * asked.within));
  });
  EXPECT_TRUE(advice.out_of_time);
  EXPECT_NE(advice.recommended(), nullptr);
}

// Ctrl-C ends a search by what its watcher throws.
TEST(Advise, KeepsTheBestAnswerSoFarWhenItIsInterrupted) {
  struct Enough {};
  const Problem problem = cube("press");
  const AdviceQuestion asked = question(100, {"symplectic_euler", "rk4", "newmark"}, problem);
  const auto interrupted_at = [&](std::string_view task) {
    Advice advice;
    const AdviceWatcher stop = [&](double, const std::string& what) {
      if (what.starts_with(task)) throw Enough{};
    };
    EXPECT_THROW(advise(problem, asked, advice, stop), Enough) << task;
    EXPECT_FALSE(advice.out_of_time) << task;
    return advice;
  };
  EXPECT_TRUE(interrupted_at("limits near").rows.empty());
  const Advice predicted = interrupted_at("finding the reference");
  EXPECT_EQ(predicted.stage, AdviceStage::searching);
  ASSERT_EQ(predicted.rows.size(), 3U);
  EXPECT_EQ(predicted.recommended(), nullptr);
  for (const AdviceRow& row : predicted.rows) {
    EXPECT_EQ(row.verdict, AdviceVerdict::predicted) << row.candidate.words();
    EXPECT_GT(row.expected_frame, 0) << row.candidate.words();
  }
  const Advice searched = interrupted_at("steps of newmark");
  EXPECT_EQ(searched.stage, AdviceStage::searching);
  ASSERT_EQ(searched.rows.size(), 3U);
  EXPECT_EQ(std::ranges::count(searched.rows, AdviceVerdict::predicted, &AdviceRow::verdict), 1);
  ASSERT_NE(searched.recommended(), nullptr);
  EXPECT_GT(searched.scale, 0);
  EXPECT_FALSE(searched.motion.empty());
  for (const auto& [task, stage] : {std::pair("timing", AdviceStage::timing),
                                    {"long runs", AdviceStage::proving},
                                    {"runs beside", AdviceStage::observing},
                                    {"how sure", AdviceStage::observing}}) {
    const Advice advice = interrupted_at(task);
    EXPECT_EQ(advice.stage, stage) << task;
    EXPECT_EQ(advice.rows.size(), 3U) << task;
    EXPECT_NE(advice.recommended(), nullptr) << task;
    EXPECT_EQ(advice.proof.empty(), stage != AdviceStage::observing) << task;
  }
}

}  // namespace
}  // namespace hmax
