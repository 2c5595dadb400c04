#include "limits/query/query_limits.hpp"

#include <atomic>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "catalogue/device/device_run.hpp"
#include "catalogue/device/host_device.hpp"
#include "catalogue/methods/catalogue.hpp"
#include "catalogue/models/problems.hpp"
#include "core/errors.hpp"
#include "core/parallel_for.hpp"
#include "limits/along/trajectory_limit.hpp"
#include "tests/results/scratch.hpp"

namespace hmax {
namespace {

std::vector<Method> some(const std::vector<std::string>& names) {
  std::vector<Method> methods;
  for (const std::string& name : names) methods.push_back(find_method(name));
  return methods;
}

LimitAnswer ask(const LimitQuestion& question, const Problem& problem, const std::vector<Method>& methods,
                Store* store = nullptr) {
  LimitWatcher watcher;
  LimitStore kept{.store = store};
  return query_limits(question, {problem}, methods, kept, false, watcher);
}

/// Runs of several methods on one device, here programs of devices on the processor.
TEST(QueryLimits, VerifiesOnADeviceAsOnTheProcessor) {
  const Problem problem = make_problem("fem_green/gravity@cube:n=2", {.parameters = {{"alpha", 1}}});
  std::vector<Method> methods = some({"symplectic_euler", "rk4", "central_difference", "rkc_2"});
  const LimitQuestion question{.at = AskedState::equilibrium, .verify = true};
  const std::vector<LimitRow> here = ask(question, problem, methods).models.at(0).rows;
  const auto device = std::make_shared<HostDevice>();
  for (Method& method : methods) method = on_device(std::move(method), device);
  const ThreadLimit four(4);
  const std::vector<LimitRow> there = ask(question, problem, methods).models.at(0).rows;
  ASSERT_EQ(there.size(), here.size());
  for (std::size_t i = 0; i < here.size(); ++i) {
    EXPECT_TRUE(there[i].is_observed());
    EXPECT_EQ(there[i].verdict, here[i].verdict);
    EXPECT_EQ(there[i].observed, here[i].observed) << here[i].method;
  }
  EXPECT_GT(device->seconds(), 0);
}

TEST(LimitQuestion, LooksAlongTheMotionOnlyWhereOneStateDoesNotTellOfIt) {
  const Problem linear = make_problem("liver_linear"), cubic = make_problem("liver_cubic");
  EXPECT_EQ(with_path({}, "", linear).path, "");
  EXPECT_EQ(with_path({}, "", cubic).path, "motion");
  EXPECT_TRUE(with_path({}, "", cubic).path_by_default);
  EXPECT_EQ(with_path({}, "none", cubic).path, "");
  EXPECT_FALSE(with_path({}, "motion", cubic).path_by_default);
  // A body in a load that stands still is in its equilibrium; one that is breathed on is not.
  EXPECT_EQ(with_path({}, "", make_problem("fem_green/gravity@cube:n=2")).path, "");
  const Problem breathing = make_problem("fem_green/breathing@cube:n=2");
  EXPECT_EQ(with_path({}, "", breathing).path, "motion");
  EXPECT_EQ(with_path({.at = AskedState::rest}, "", breathing).path, "");
}

TEST(LimitQuestion, RunsFromTheStartOfSmallModelsAndOfMotionsThatWereAskedFor) {
  const Problem cubic = make_problem("liver_cubic"), body = make_problem("fem_green/breathing@cube:n=2");
  EXPECT_EQ(with_path({}, "", cubic).run_steps, quick_search);
  EXPECT_EQ(with_path({.verify = true}, "", cubic).run_steps, thorough_search);
  EXPECT_EQ(with_path({.verify = true}, "", body).run_steps, 0);
  EXPECT_EQ(with_path({.verify = true}, "motion", body).run_steps, thorough_search);
}

TEST(LimitQuestion, RefusesTheEndOfAMotionThatIsNotLookedAt) {
  const Problem linear = make_problem("liver_linear");
  EXPECT_THROW(with_path({.t_end = 2.0}, "", linear), InputError);
  EXPECT_THROW(with_path({.t_end = 2.0}, "none", linear), InputError);
  EXPECT_EQ(with_path({.t_end = 2.0}, "motion", linear).end_of(linear), 2);
}

/// The eigenvalues of m x'' + c x' + k x = 0 with c^2 < 4 m k: explicit_euler is stable up to c / k.
TEST(QueryLimits, AnswersInTheOrderOfTheMethods) {
  const Problem problem = make_problem("liver_linear", {.parameters = {{"m", 2}, {"c", 1}, {"k1", 8}}});
  const LimitAnswer answer = ask({}, problem, some({"rk4", "explicit_euler"}));
  ASSERT_EQ(answer.models.size(), 1U);
  const std::vector<LimitRow>& rows = answer.models[0].rows;
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[0].method, "rk4");
  EXPECT_EQ(rows[1].method, "explicit_euler");
  EXPECT_NEAR(rows[1].h_max, 1.0 / 8, 1e-12);
  EXPECT_FALSE(answer.stopped);
}

TEST(QueryLimits, LooksUpWhatAStoreHasAndKeepsNoSentences) {
  const Scratch scratch;
  Store store = Store::open_or_create(scratch / "s.sqlite");
  const Problem problem = make_problem("liver_cubic");
  const LimitQuestion question = with_path({}, "", problem);
  const LimitAnswer computed = ask(question, problem, some({"rk4", "newmark"}), &store);
  EXPECT_EQ(computed.looked_up, 0U);
  const LimitAnswer known = ask(question, problem, some({"newmark", "rk4"}), &store);
  EXPECT_EQ(known.looked_up, 2U);
  ASSERT_EQ(known.models[0].rows.size(), 2U);
  EXPECT_EQ(known.models[0].rows[0].method, "newmark");
  EXPECT_EQ(known.models[0].rows[1].h_max, computed.models[0].rows[0].h_max);
  EXPECT_EQ(known.models[0].rows[1].along_least, computed.models[0].rows[0].along_least);
  // The facts from which today's program makes its words.
  const auto facts = nlohmann::json::parse(known.models[0].point.document);
  EXPECT_EQ(facts["linearity"], "nonlinear");
  EXPECT_TRUE(facts["along"]["constant"].is_null());
  EXPECT_GT(facts["along"]["tolerances"]["rtol"], 0);
  // One more method is computed beside those that are there.
  EXPECT_EQ(ask(question, problem, some({"rk4", "explicit_euler"}), &store).looked_up, 1U);
}

TEST(QueryLimits, RefusesNoModelAndNoMethod) {
  LimitWatcher watcher;
  EXPECT_THROW(query_limits({}, {}, some({"rk4"}), false, watcher), InputError);
  EXPECT_THROW(query_limits({}, {make_problem("liver_linear")}, {}, false, watcher), InputError);
}

/// Rows of a motion that was not found answer those alone who did not ask for it.
TEST(QueryLimits, DoesNotLookUpAMotionThatWasNotFoundForThoseWhoAskForIt) {
  const Scratch scratch;
  Store store = Store::open_or_create(scratch / "s.sqlite");
  // x' = x^2 from 1 ends at t = 1.
  write_text(scratch / "blows_up.toml", "[problem]\nt_end = 3\n[equations]\nx = \"x^2\"\n[initial]\nx = 1\n");
  const Problem problem = make_problem((scratch / "blows_up.toml").string());
  const LimitQuestion by_default = with_path({}, "", problem);
  const LimitAnswer answer = ask(by_default, problem, some({"rk4"}), &store);
  const auto facts = nlohmann::json::parse(answer.models[0].point.document);
  ASSERT_TRUE(facts["along"].contains("status")) << facts;
  EXPECT_EQ(ask(by_default, problem, some({"rk4"}), &store).looked_up, 1U);
  EXPECT_THROW(ask(with_path({}, "motion", problem), problem, some({"rk4"}), &store), InputError);
}

// Who names an end asks for that motion.
TEST(QueryLimits, RefusesAnEndOfTheMotionThatIsNone) {
  const Problem problem = make_problem("liver_cubic");
  for (const double t_end : {0.0, -3.0, std::numeric_limits<double>::quiet_NaN()})
    EXPECT_THROW(ask(with_path({.t_end = t_end}, "", problem), problem, some({"rk4"})), InputError) << t_end;
}

/// Stops once `rows` rows have begun.
struct StopAfter : LimitWatcher {
  explicit StopAfter(int rows) : left(rows) {}
  void begin_row(const std::string&) override { --left; }
  [[nodiscard]] bool stopped() const override { return left <= 0; }
  std::atomic<int> left;
};

TEST(QueryLimits, KeepsWhatIsFinishedWhenItIsStopped) {
  const Scratch scratch;
  Store store = Store::open_or_create(scratch / "s.sqlite");
  const Problem problem = make_problem("liver_linear");
  const std::vector<Method> methods = some({"rk4", "explicit_euler", "rk2_heun", "newmark"});
  const OneThread alone;
  StopAfter second(2);
  LimitStore kept{.store = &store};
  const LimitAnswer part = query_limits({}, {problem}, methods, kept, false, second);
  EXPECT_TRUE(part.stopped);
  ASSERT_EQ(part.models.size(), 1U);
  EXPECT_GE(part.models[0].rows.size(), 1U);
  EXPECT_LT(part.models[0].rows.size(), methods.size());
  EXPECT_EQ(store.limits().size(), part.models[0].rows.size());
  StopAfter at_once(0);
  EXPECT_TRUE(query_limits({}, {problem}, methods, false, at_once).models.empty());
}

TEST(QueryLimits, MeansTheSameForProgramsAsForPeople) {
  const Problem problem = make_problem("fem_green/gravity@cube:n=2");
  const LimitAnswer answer = ask(with_path({}, "", problem), problem, some({"rk4"}));
  const auto document = answer_json(answer, {problem});
  ASSERT_EQ(document["rows"].size(), 1U);
  EXPECT_EQ(document["rows"][0]["h_max"], answer.models[0].rows[0].h_max);
  EXPECT_EQ(document["rows"][0]["state_kind"], "equilibrium");
  EXPECT_EQ(document["models"][0]["problem"], problem.id);
  // The fastest mode of the first body is always known; eigenvalues only where all facts are asked for.
  EXPECT_TRUE(document["models"][0].contains("fastest_mode"));
  EXPECT_FALSE(document["models"][0].contains("eigenvalues"));
}

}  // namespace
}  // namespace hmax
