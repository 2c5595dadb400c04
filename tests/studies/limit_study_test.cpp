#include "studies/limit_study.hpp"

#include <algorithm>
#include <atomic>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "catalogue/methods/catalogue.hpp"
#include "results/merge/merge_stores.hpp"
#include "tests/results/scratch.hpp"

namespace hmax {
namespace {

TEST(LimitCases, HaveOneNameEach) {
  std::set<std::string> names;
  for (const LimitCase& each : limit_cases()) EXPECT_TRUE(names.insert(each.label).second) << each.label;
}

TEST(LimitStudy, IsThatOfTheMergedStoresOfItsShards) {
  std::vector<LimitCase> cases = limit_cases();
  cases.resize(2);
  const std::vector<Method> chosen =
      choose_methods({"rk4", "newmark", "implicit_euler", "rk2_heun", "central_difference"}, {});
  const Scratch scratch;
  const auto study = [&](Store* store, Shard shard) {
    return limit_study(
        cases, CaseKind::linear, chosen, store, [](double) {}, [] { return false; }, shard);
  };
  Store whole = Store::open_or_create(scratch / "whole.sqlite");
  Merger merger(whole);
  std::size_t most = 0, all = 0;
  for (int i = 1; i <= 3; ++i) {
    Store store = Store::open_or_create(scratch / (std::to_string(i) + ".sqlite"));
    const std::size_t rows = study(&store, {i, 3}).size();
    most = std::max(most, rows);
    all += rows;
    merger.add(store.file());
  }
  const auto serial = study(nullptr, {});
  EXPECT_EQ(all, serial.size());
  EXPECT_LE(3 * most, all + 2) << "shards are of one size";
  const auto merged = limit_study(
      cases, CaseKind::linear, chosen, &whole, [](double) { ADD_FAILURE() << "computed again"; },
      [] { return false; });
  ASSERT_EQ(merged.size(), serial.size());
  for (std::size_t i = 0; i < serial.size(); ++i) {
    EXPECT_EQ(merged[i].limit.method, serial[i].limit.method);
    EXPECT_EQ(merged[i].limit.h_max, serial[i].limit.h_max);
    EXPECT_EQ(merged[i].limit.observed, serial[i].limit.observed);
  }
}

TEST(LimitStudy, StopsWhenInterruptedAndKeepsWhatIsFinished) {
  std::vector<LimitCase> cases = limit_cases();
  cases.resize(1);
  const std::vector<Method> chosen = choose_methods({"explicit_runge_kutta"}, {cases.front().problem});
  std::atomic<double> share = 0;
  const Scratch scratch;
  Store store = Store::open_or_create(scratch / "store.sqlite");
  const auto rows = limit_study(
      cases, CaseKind::linear, chosen, &store, [&](double done) { share = done; }, [&] { return share > 0; });
  EXPECT_FALSE(rows.empty());
  EXPECT_LT(rows.size(), chosen.size());
  EXPECT_EQ(store.limits().size(), rows.size());
  for (const StudyRow& row : rows) EXPECT_EQ(row.limit.verdict, "confirmed");
}

}  // namespace
}  // namespace hmax
