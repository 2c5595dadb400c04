#include "results/compare.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <span>
#include <string>

#include <gtest/gtest.h>

#include "tests/says.hpp"

namespace hmax {
namespace {

constexpr int rows_per_session = 200, repetitions = 9;

Row plain(int number) {
  Row r;
  r.key.problem = "liver_forced";
  r.key.method = "method_" + std::to_string(number);
  r.key.mode = "fixed";
  r.key.h = 0.1;
  r.outcome = "reached_end";
  r.t_reached = 100;
  r.steps = 1000 + number;
  r.rhs = 4 * r.steps;
  r.error_end = r.error_global = 1e-6;
  r.reference_error = 1e-14;
  return r;
}

/// One session: `slowdown(row, repetition)` multiplies a true time of 1 ms; every sample has relative noise
/// of its own.
std::vector<Row> session(std::mt19937& random, double noise,
                         const std::function<double(int, int)>& slowdown) {
  std::normal_distribution<double> normal;
  std::vector<Row> rows;
  for (int i = 0; i < rows_per_session; ++i) {
    rows.push_back(plain(i));
    for (int k = 0; k < repetitions; ++k) {
      rows.back().cpu_s.push_back(1e-3 * slowdown(i, k) * std::exp(noise * normal(random)));
    }
  }
  return rows;
}

double flagged_share(const Comparison& c) {
  return static_cast<double>(c.count(TimingVerdict::faster) + c.count(TimingVerdict::slower)) /
         static_cast<double>(c.rows.size());
}

/// A/A: both sessions are drawn by the same `world`; the share flagged is averaged and its largest value
/// kept.
struct Flagged {
  double mean = 0, largest = 0;
};
Flagged a_against_a(const std::function<std::vector<Row>(std::mt19937&)>& world) {
  constexpr int trials = 60;
  Flagged flagged;
  for (int seed = 0; seed < trials; ++seed) {
    std::mt19937 random(static_cast<unsigned>(seed));
    const auto a = world(random), b = world(random);
    const double share = flagged_share(compare(a, b));
    flagged.mean += share / trials;
    flagged.largest = std::max(flagged.largest, share);
  }
  return flagged;
}

/// Rows of a session as those of a device.
std::vector<Row> on_a_card(std::vector<Row> rows) {
  for (Row& row : rows) {
    row.key.device = "card";
    row.device_s.swap(row.cpu_s);
    row.driver = "driver 1";
  }
  return rows;
}

TEST(Compare, AgainstItselfUnderPlainNoiseFlagsNothingMuch) {
  for (const double noise : {0.005, 0.02, 0.1}) {
    const Flagged flagged = a_against_a([&](std::mt19937& random) {
      const double whole = std::exp(std::normal_distribution<double>(0, 0.08)(random));
      return session(random, noise, [&](int, int) { return whole; });
    });
    EXPECT_LE(flagged.mean, 0.005) << noise;
    EXPECT_LE(flagged.largest, 0.05) << noise;
  }
}

TEST(Compare, AgainstItselfWithSlowStretchesFlagsAtMostFivePercent) {
  // Stretches of 20 rows, each slower by |N(0, spread)| throughout: in every one the samples of a row lie
  // clearly apart from those of the other session.
  const auto stretches = [](double spread) {
    return a_against_a([=](std::mt19937& random) {
      std::normal_distribution<double> drift(0, spread);
      std::vector<double> factor;
      for (int block = 0; block < rows_per_session / 20; ++block)
        factor.push_back(1 + std::abs(drift(random)));
      return session(random, 0.01, [&](int row, int) { return factor[static_cast<std::size_t>(row / 20)]; });
    });
  };
  EXPECT_LE(stretches(0.03).mean, 0.005);
  EXPECT_LE(stretches(0.05).mean, 0.03);

  // One stretch of a third of the rows, slower by 6 %.
  const Flagged one = a_against_a([](std::mt19937& random) {
    const int start = static_cast<int>(random() % 130);
    return session(random, 0.01, [=](int row, int) { return row >= start && row < start + 66 ? 1.06 : 1.0; });
  });
  EXPECT_LE(one.largest, 0.05);

  // A neighbour takes 40 % during most repetitions of one row in seven.
  const Flagged bursts = a_against_a([](std::mt19937& random) {
    const auto which = random() % 7;
    return session(random, 0.01, [=](int row, int k) {
      return static_cast<unsigned>(row) % 7 == which && k > 0 ? 1.4 : 1.0;
    });
  });
  EXPECT_LE(bursts.largest, 0.05);
}

TEST(Compare, DoesNotFlagSlowStretchesThatTheRankTestTellsApart) {
  // The gate can fail: the rank test alone calls most of a slow stretch slower.
  std::mt19937 random(1);
  const auto a = session(random, 0.01, [](int, int) { return 1.0; });
  const auto b = session(random, 0.01, [](int row, int) { return row < 66 ? 1.06 : 1.0; });
  const Comparison found = compare(a, b);
  const auto apart =
      std::ranges::count_if(found.rows, [](const RowComparison& row) { return row.p < 0.001; });
  EXPECT_GT(static_cast<double>(apart), 0.2 * rows_per_session);
  EXPECT_EQ(flagged_share(found), 0);
}

TEST(Compare, FindsPlantedChangesOfTenToTwentyPercentUnderTwoPercentNoise) {
  int found = 0, planted = 0, wrong = 0;
  for (unsigned seed = 0; seed < 30; ++seed) {
    std::mt19937 random(seed);
    const auto a = session(random, 0.02, [](int, int) { return 1.0; });
    // Rows 0-9: 10 % to 19 % slower; rows 10-14: 15 % faster; everything 5 % slower by the session.
    const auto b = session(random, 0.02, [](int row, int) {
      return 1.05 * (row < 10 ? 1.10 + 0.01 * row : row < 15 ? 0.85 : 1.0);
    });
    const Comparison c = compare(a, b);
    for (std::size_t i = 0; i < c.rows.size(); ++i) {
      const TimingVerdict expected = i < 10   ? TimingVerdict::slower
                                     : i < 15 ? TimingVerdict::faster
                                              : TimingVerdict::same;
      planted += i < 15;
      found += i < 15 && c.rows[i].verdict == expected;
      wrong += i >= 15 && c.rows[i].verdict != expected;
    }
    EXPECT_NEAR(c.common_ratio, 1.05, 0.005);
  }
  EXPECT_GE(found, 0.97 * planted);
  EXPECT_LE(wrong, 2);
}

TEST(Compare, ASlowdownOfTheWholeSessionIsReportedByItself) {
  std::mt19937 random(3);
  const auto a = session(random, 0.01, [](int, int) { return 1.0; });
  const auto b = session(random, 0.01, [](int, int) { return 1.3; });
  const Comparison c = compare(a, b);
  EXPECT_NEAR(c.common_ratio, 1.3, 0.01);
  EXPECT_EQ(c.count(TimingVerdict::same), c.rows.size());
  EXPECT_NEAR(c.rows[0].ratio, 1.3, 0.05);
  EXPECT_NEAR(c.rows[0].relative_ratio, 1.0, 0.05);
  EXPECT_TRUE(c.remarks.at(0).starts_with("B takes 1.")) << c.remarks[0];
}

TEST(Compare, WithFewRowsNoCommonRatioIsRemoved) {
  std::mt19937 random(3);
  auto a = session(random, 0.01, [](int, int) { return 1.0; });
  auto b = session(random, 0.01, [](int, int) { return 1.3; });
  a.resize(2);
  b.resize(2);
  const Comparison c = compare(a, b);
  EXPECT_EQ(c.common_ratio, 1.0);
  EXPECT_EQ(c.count(TimingVerdict::slower), 2u);
  EXPECT_TRUE(says(c.remarks.at(0), "Only 2 rows"));
}

TEST(Compare, EightRowsAreEnoughForACommonRatio) {
  std::mt19937 random(4);
  auto a = session(random, 0.01, [](int, int) { return 1.0; });
  auto b = session(random, 0.01, [](int, int) { return 1.3; });
  for (const std::size_t rows : {7U, 8U, 9U}) {
    const Comparison c = compare(std::span(a).first(rows), std::span(b).first(rows));
    EXPECT_NEAR(c.common_ratio, rows < 8 ? 1 : 1.3, 0.02) << rows;
    EXPECT_EQ(c.remarks.at(0).find("Only 7 rows") == 0, rows < 8) << c.remarks[0];
    EXPECT_EQ(c.remarks.at(0).find("B takes 1.") == 0, rows >= 8) << c.remarks[0];
    EXPECT_EQ(c.remarks.size(), rows < 8 ? 1U : 2U) << rows;
  }
}

TEST(Compare, SaysHowManyRowsHaveFewRepetitions) {
  std::mt19937 random(5);
  auto a = session(random, 0.01, [](int, int) { return 1.0; });
  auto b = session(random, 0.01, [](int, int) { return 1.0; });
  EXPECT_EQ(compare(a, b).remarks.size(), 2U);  // nine of all
  a[3].cpu_s.pop_back();
  b[5].cpu_s.pop_back();
  EXPECT_EQ(compare(a, b).remarks.back(),
            "2 of the rows have fewer than 9 repetitions: their differences can be missed.");
  EXPECT_EQ(compare(on_a_card(a), on_a_card(b)).remarks.back(),
            "2 of the rows on card have fewer than 9 repetitions: their differences can be missed.");
}

TEST(Compare, AnotherResultIsAChangeWhateverTheTimes) {
  const auto verdict = [](const std::function<void(Row&)>& change) {
    Row a = plain(1), b = plain(1);
    a.cpu_s = b.cpu_s = {1e-3, 1.1e-3};
    change(b);
    const Comparison c = compare(std::vector{a}, std::vector{b});
    EXPECT_EQ(c.rows.at(0).changes.empty(), c.rows[0].verdict != TimingVerdict::changed);
    return c.rows[0].verdict;
  };
  EXPECT_EQ(verdict([](Row&) {}), TimingVerdict::same);
  EXPECT_EQ(verdict([](Row& r) { r.steps += 1; }), TimingVerdict::changed);
  EXPECT_EQ(verdict([](Row& r) { r.rejected += 1; }), TimingVerdict::changed);
  EXPECT_EQ(verdict([](Row& r) { r.rhs += 1; }), TimingVerdict::changed);
  EXPECT_EQ(verdict([](Row& r) { r.outcome = "diverged"; }), TimingVerdict::changed);
  EXPECT_EQ(verdict([](Row& r) { r.t_reached = 99; }), TimingVerdict::changed);
  EXPECT_EQ(verdict([](Row& r) { r.error_end *= 1.001; }), TimingVerdict::changed);
  EXPECT_EQ(verdict([](Row& r) { r.error_end *= 1 + 1e-9; }), TimingVerdict::same);
  EXPECT_EQ(verdict([](Row& r) { r.error_global = NAN; }), TimingVerdict::changed);
  EXPECT_EQ(verdict([](Row& r) { r.error_global = INFINITY; }), TimingVerdict::changed);
  EXPECT_EQ(verdict([](Row& r) { r.cpu_s.clear(); }), TimingVerdict::changed);
}

TEST(Compare, RowsOfOneSideAreListed) {
  const std::vector<Row> a{plain(1), plain(2)}, b{plain(2), plain(3)};
  const Comparison c = compare(a, b);
  ASSERT_EQ(c.rows.size(), 1u);
  EXPECT_EQ(c.rows[0].verdict, TimingVerdict::same);
  EXPECT_TRUE(std::isnan(c.rows[0].ratio));
  EXPECT_EQ(c.only_in_a, std::vector{plain(1).key});
  EXPECT_EQ(c.only_in_b, std::vector{plain(3).key});
  EXPECT_EQ(compare(std::vector<Row>{}, std::vector<Row>{}).rows.size(), 0u);
}

/// Samples of sizes n and m without ties whose U (pairs with a larger) is u.
double p_with_u(int n, int m, int u) {
  // b = 1..m; a_i above `above` of the b's, at a distance of its own.
  std::vector<double> a, b;
  for (int j = 1; j <= m; ++j) b.push_back(j);
  for (int i = 0; i < n; ++i) {
    const int above = std::min(m, u);
    u -= above;
    a.push_back(above + 0.5 + 0.001 * i);
  }
  return mann_whitney_p(a, b);
}

TEST(MannWhitney, AgreesWithThePrintedTablesOfCriticalValues) {
  // Largest U that is significant at 5 %, two-sided, in any table of the test.
  const int table[][3] = {{4, 4, 0},    {5, 5, 2}, {8, 8, 13},   {9, 9, 17},
                          {10, 10, 23}, {5, 9, 7}, {20, 20, 127}};
  for (const auto& [n, m, critical] : table) {
    EXPECT_LE(p_with_u(n, m, critical), 0.05) << n << " " << m;
    EXPECT_GT(p_with_u(n, m, critical + 1), 0.05) << n << " " << m;
    EXPECT_EQ(p_with_u(n, m, critical), p_with_u(n, m, n * m - critical));
  }
  EXPECT_DOUBLE_EQ(p_with_u(3, 3, 0), 2.0 / 20);
  EXPECT_DOUBLE_EQ(p_with_u(9, 9, 0), 2.0 / 48620);
  EXPECT_EQ(p_with_u(9, 9, 40), 1.0);
}

TEST(MannWhitney, CorrectsForTiesByHand) {
  // U = 3, sigma^2 = 16/12 (9 - 48/56) = 10.857, z = (8 - 3 - 0.5) / 3.295 = 1.3657
  const std::vector<double> a{1, 2, 2, 3}, b{2, 3, 3, 4};
  EXPECT_NEAR(mann_whitney_p(a, b), 0.1720, 0.0002);
  EXPECT_EQ(mann_whitney_p(a, a), 1.0);
  EXPECT_EQ(mann_whitney_p(std::vector<double>{1, 1}, std::vector<double>{1, 1}), 1.0);
  EXPECT_EQ(mann_whitney_p({}, a), 1.0);
}

TEST(MannWhitney, LargeSamplesAreWithinAPercentOfTheExactTail) {
  // 21 against 20 values take the normal path; the exact tail there is close to that of the table's
  // neighbours.
  EXPECT_GT(p_with_u(21, 20, 140), 0.05);
  EXPECT_LT(p_with_u(21, 20, 128), 0.05);
}

TEST(Compare, TakesResultsOfExploredRowsButNotTheirTimes) {
  std::mt19937 random(1);
  const std::vector<Row> a = session(random, 0.01, [](int, int) { return 1.0; });
  std::vector<Row> b = session(random, 0.01, [](int i, int) { return i == 0 ? 5.0 : 1.0; });
  ASSERT_EQ(compare(a, b).rows[0].verdict, TimingVerdict::slower);
  b[0].explored = b[1].explored = true;
  b[1].steps += 1;
  const Comparison found = compare(a, b);
  EXPECT_EQ(found.rows[0].verdict, TimingVerdict::same);
  EXPECT_TRUE(found.rows[0].changes.empty());
  EXPECT_TRUE(std::isnan(found.rows[0].ratio));
  EXPECT_EQ(found.rows[1].verdict, TimingVerdict::changed);
  EXPECT_TRUE(says(found.remarks.back(), "2 of the rows were explored"));
}

TEST(Compare, JudgesTheRowsOfADeviceAmongThemselves) {
  std::mt19937 random(1);
  const auto here = [&](double slowdown) {
    return session(random, 0.01, [&](int, int) { return slowdown; });
  };
  const auto joined = [](std::vector<Row> rows, const std::vector<Row>& more) {
    rows.insert(rows.end(), more.begin(), more.end());
    return rows;
  };
  // A driver that makes all runs on the card twice as fast changes none of them alone.
  const std::vector<Row> a = joined(here(1), on_a_card(here(1)));
  std::vector<Row> b = joined(here(1), on_a_card(here(0.5)));
  b.back().driver = "driver 2";
  const Comparison found = compare(a, b);
  EXPECT_EQ(found.rows.size(), 2U * rows_per_session);
  EXPECT_EQ(found.count(TimingVerdict::same), found.rows.size());
  EXPECT_NEAR(found.common_ratio, 1, 0.05);
  EXPECT_NEAR(found.rows.back().ratio, 0.5, 0.05);
  EXPECT_NEAR(found.rows.back().relative_ratio, 1, 0.05);
  EXPECT_TRUE(says(found.remarks[0], "times the CPU time of A, in the median"));
  EXPECT_TRUE(says(found.remarks[2], "times the device time of A on card, in the median"));
  EXPECT_TRUE(says(found.remarks.back(), "1 of the rows on card have another clock or driver"));
  EXPECT_NEAR(compare(on_a_card(here(1)), on_a_card(here(0.5))).common_ratio, 0.5, 0.05);
}

TEST(Compare, NeverComparesADeviceWithTheProcessor) {
  std::mt19937 random(1);
  const std::vector<Row> a = session(random, 0.01, [](int, int) { return 1.0; });
  const Comparison found = compare(a, on_a_card(a));
  EXPECT_TRUE(found.rows.empty());
  EXPECT_EQ(found.only_in_a.size(), a.size());
  EXPECT_EQ(found.only_in_b.size(), a.size());
  EXPECT_TRUE(says(found.remarks.at(0), "no time is compared"));
}

}  // namespace
}  // namespace hmax
