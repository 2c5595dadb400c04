#include "results/compare_limits.hpp"

#include <cmath>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "results/exports.hpp"
#include "tests/says.hpp"

namespace hmax {
namespace {

LimitRow a_limit(const std::string& method, double h_max) {
  LimitRow row;
  row.point = {.problem = "liver_benchmark",
               .material = "male_slim",
               .parameters = "m=1",
               .y0 = "0.5,1",
               .model = "0",
               .asked = "equilibrium"};
  row.method = method;
  row.bound = std::isinf(h_max) ? "accuracy" : "stability";
  row.h_max = h_max;
  return row;
}

TEST(CompareLimits, NamesWhatChanged) {
  std::vector<LimitRow> a{a_limit("rk4", 0.5), a_limit("newmark", INFINITY), a_limit("rk2_heun", 0.2)};
  std::vector<LimitRow> b{a_limit("rk4", 0.4), a_limit("newmark", INFINITY), a_limit("dop_853", 0.3)};
  const LimitComparison found = compare_limits(a, b);
  EXPECT_EQ(found.compared, 2U);
  ASSERT_EQ(found.changed.size(), 1U);
  EXPECT_EQ(found.changed[0].name, "liver_benchmark/male_slim/m=1/equilibrium/rk4");
  EXPECT_EQ(found.changed[0].changes, (std::vector<std::string>{"h_max: 0.5 -> 0.4"}));
  EXPECT_EQ(found.only_in_a.size(), 1U);
  EXPECT_EQ(found.only_in_b.size(), 1U);
}

TEST(CompareLimits, AllowsForLastDigitsAndForRunsThatNobodyAskedFor) {
  LimitRow a = a_limit("rk4", 0.5), b = a_limit("rk4", 0.5 * (1 + 1e-9));
  b.verdict = "confirmed";
  b.observed = 0.5001;
  EXPECT_TRUE(compare_limits(std::span(&a, 1), std::span(&b, 1)).changed.empty());
  a.verdict = "contradicted";
  a.observed = 0.6;
  EXPECT_EQ(compare_limits(std::span(&a, 1), std::span(&b, 1)).changed.at(0).changes.size(), 2U);
  b.h_max = 0.5 * (1 + 1e-5);
  EXPECT_EQ(compare_limits(std::span(&a, 1), std::span(&b, 1)).changed.at(0).changes.size(), 3U);
}

TEST(CompareLimits, TakesTheModelThatWasComputedLast) {
  std::vector<LimitRow> a{a_limit("rk4", 0.5), a_limit("rk4", 0.4)};
  a[1].point.model = "1";
  a[0].session = 2;
  a[1].session = 1;
  const LimitRow b = a_limit("rk4", 0.5);
  EXPECT_TRUE(compare_limits(a, std::span(&b, 1)).changed.empty());
}

TEST(LimitExports, HaveOneColumnForEachNumberAndWordsForInfinity) {
  const LimitRow row = a_limit("newmark", INFINITY);
  const std::string csv = rows_to_csv(std::vector{row});
  const std::string header = csv.substr(0, csv.find('\n'));
  EXPECT_EQ(header.rfind("problem,material,parameters,y0,model,asked,path,t_end,method,bound,", 0), 0U)
      << header;
  const std::string line = csv.substr(header.size() + 1);
  EXPECT_EQ(std::count(line.begin(), line.end(), ','), std::count(header.begin(), header.end(), ',') + 1)
      << "the start has a comma of its own, in quotes: " << line;
  EXPECT_TRUE(says(line, ",unbounded,"));
  const auto object = nlohmann::json::parse(rows_to_jsonl(std::vector{row}));
  EXPECT_EQ(object.at("h_max"), "unbounded");
  EXPECT_TRUE(object.at("observed").is_null());
  EXPECT_EQ(object.at("method"), "newmark");
}

}  // namespace
}  // namespace hmax
