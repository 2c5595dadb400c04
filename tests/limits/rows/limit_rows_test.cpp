#include "limits/rows/limit_rows.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "catalogue/methods/catalogue.hpp"
#include "catalogue/models/problems.hpp"
#include "core/numbers.hpp"
#include "limits/linearised_problem.hpp"
#include "limits/predict.hpp"
#include "limits/verification.hpp"
#include "tests/results/scratch.hpp"

namespace hmax {
namespace {

TEST(LimitRows, HoldThePredictionAndWhatRunsShowed) {
  const Problem problem = make_problem("liver_benchmark", {.material = "male_slim"});
  const Method method = find_method("rk4");
  const Linearised near = linearised(problem);
  Prediction prediction = predict(method, near);
  EXPECT_EQ(limit_row(prediction).verdict, "");
  EXPECT_EQ(limit_row(prediction, true).verdict, "not_run");
  verify(prediction, method, problem, near);
  const LimitRow row = limit_row(prediction);
  EXPECT_EQ(row.method, "rk4");
  EXPECT_EQ(row.bound, "stability");
  EXPECT_EQ(row.state_kind, "equilibrium");
  prediction.state_kind = StateKind::rest;
  EXPECT_EQ(limit_row(prediction).state_kind, "rest");
  EXPECT_EQ(row.h_max, *prediction.h_max);
  EXPECT_EQ(row.re, prediction.limiting->lambda.real());
  EXPECT_EQ(row.verdict, "confirmed");
  EXPECT_EQ(row.observed, prediction.observed->h_max);
  EXPECT_NEAR(row.gap, 0, 1e-3);
  prediction.observed->agrees = false;
  EXPECT_EQ(limit_row(prediction).verdict, "contradicted");
  prediction.observed->excused = true;
  EXPECT_EQ(limit_row(prediction).verdict, "excused");
}

TEST(LimitRows, SayFromWhereThePathGrows) {
  LimitRow row;
  add_path(row,
           {.t = {0, 1, 2},
            .h_max = {0.1, LimitRow::none, 0.2},
            .least = 0.1,
            .t_least = 0,
            .growing = 1.0 / 3,
            .grows_from = 1},
           "ends early");
  EXPECT_EQ(row.along_least, 0.1);
  EXPECT_EQ(row.along_grows_from, 1);
  EXPECT_EQ(row.path_note, "ends early");
}

TEST(LimitRows, HaveTheLeastLimitThatIsKnown) {
  LimitRow row;
  EXPECT_TRUE(std::isnan(row.known_limit()));
  row.along_least = infinity;
  EXPECT_TRUE(std::isnan(row.known_limit())) << "of small motions nothing is known";
  row.h_max = infinity;
  EXPECT_EQ(row.known_limit(), infinity);
  row.from_start = infinity;
  row.point.t_end = 1;
  EXPECT_EQ(row.known_limit(), infinity);
  row.h_max = 0.3;
  row.along_least = 0.2;
  EXPECT_EQ(row.known_limit(), 0.2);
  row.from_start = 0.1;
  EXPECT_EQ(row.known_limit(), 0.1);
  row.h_max = LimitRow::none;
  EXPECT_EQ(row.known_limit(), 0.1);
}

TEST(LimitRows, OfAnotherProgramOrQuestionAreNotLookedUp) {
  const Scratch scratch;
  Store store = Store::open_or_create(scratch / "s.sqlite");
  OperatingPointRow point;
  point.key = operating_point_key(make_problem("liver_forced", {}), AskedState::equilibrium, "", 0);
  EXPECT_EQ(point.key.asked, "equilibrium");
  EXPECT_EQ(point.key.model.size(), 16U);
  LimitRow row;
  row.method = "rk4";
  Fingerprint other = fingerprint();
  other.program = "another";
  store.begin_session(other);
  store.insert_limits(point, std::span(&row, 1));
  EXPECT_TRUE(stored_limits(store, point.key, {}).empty());
  store.begin_session(fingerprint());
  store.insert_limits(point, std::span(&row, 1));
  EXPECT_EQ(stored_limits(store, point.key, {}).size(), 1U);
  // It was asked for nothing but the prediction.
  EXPECT_TRUE(stored_limits(store, point.key, {.verified = true}).empty());
  EXPECT_TRUE(stored_limits(store, point.key, {.from_start = true}).empty());
  row.verdict = "not_run";
  row.details = "{}";
  store.insert_limits(point, std::span(&row, 1));
  EXPECT_EQ(stored_limits(store, point.key, {.verified = true}).size(), 1U);
  EXPECT_TRUE(stored_limits(store, point.key, {.details = true}).empty());
}

}  // namespace
}  // namespace hmax
