#include "results/compare.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <numeric>

#include <fmt/format.h>

#include "core/numbers.hpp"

namespace hmax {

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t enough_rows = 8;         ///< for a common ratio and a scatter
constexpr std::size_t enough_repetitions = 9;  ///< for a rank test among many rows
constexpr double false_discovery_rate = 0.05;  ///< share of false ones among the rows called faster or slower
constexpr double minimum_effect = 0.07;        ///< a relative difference below this is never called one

double median(const std::vector<double>& values) { return summarise(values).median; }

bool are_times(const std::vector<double>& samples) {
  return !samples.empty() &&
         std::all_of(samples.begin(), samples.end(), [](double x) { return x > 0 && std::isfinite(x); });
}

bool timed(const Row& row) { return are_times(comparable_times(row)); }

/// Relative standard error of the median of normal samples, their spread read off the quartiles:
///   se = 1.2533 sigma / sqrt(n),   sigma = (q3 - q1) / 1.349
double standard_error_of_median(const std::vector<double>& samples) {
  const TimingSummary s = summarise(samples);
  return 1.2533 * (s.q3 - s.q1) / 1.349 / std::sqrt(static_cast<double>(samples.size())) / s.median;
}

/// Which hypotheses are rejected when at most that share of the rejections may be false
/// [benjamini1995controlling]: those with p <= p_(k), k the largest rank with p_(k) <= share k / m.
double rejection_threshold(std::vector<double> p) {
  std::sort(p.begin(), p.end());
  const auto m = static_cast<double>(p.size());
  for (std::size_t k = p.size(); k > 0; --k) {
    if (p[k - 1] <= false_discovery_rate * static_cast<double>(k) / m) return p[k - 1];
  }
  return -1;
}

struct Pair {
  const Row *a, *b;
  RowComparison* result;
};

/// What the pairs of one device have in common.
struct Common {
  double ratio = 1, scatter = 0;  ///< as in Comparison
};

/// Fills ratios, p and noise floor of every pair, then judges.
Common judge(const std::vector<Pair>& pairs) {
  std::vector<double> logs;
  for (const Pair& pair : pairs) logs.push_back(std::log(pair.result->ratio));
  const bool enough = pairs.size() >= enough_rows;
  Common common;
  if (enough) {
    const double middle = median(logs);
    std::vector<double> distances;
    for (const double log : logs) distances.push_back(std::abs(log - middle));
    common = {std::exp(middle), std::expm1(1.4826 * median(distances))};
  }

  std::vector<double> p_values;
  for (const Pair& pair : pairs) {
    RowComparison& row = *pair.result;
    const std::vector<double>& a = times_of(*pair.a);
    std::vector<double> b = times_of(*pair.b);
    const double error = std::hypot(standard_error_of_median(a), standard_error_of_median(b));
    for (double& sample : b) sample /= common.ratio;
    row.relative_ratio = row.ratio / common.ratio;
    row.p = mann_whitney_p(a, b);
    row.noise_floor = std::max({minimum_effect, 3 * common.scatter, 3 * error});
    p_values.push_back(row.p);
  }
  const double threshold = rejection_threshold(p_values);
  for (const Pair& pair : pairs) {
    RowComparison& row = *pair.result;
    const auto fastest = [](const Row& r) { return std::ranges::min(times_of(r)); };
    const double floor = std::log1p(row.noise_floor);
    const double effect = std::log(row.relative_ratio);
    const double effect_of_fastest = std::log(fastest(*pair.b) / fastest(*pair.a) / common.ratio);
    const double sign = effect > 0 ? 1 : -1;
    if (row.p <= threshold && sign * effect > floor && sign * effect_of_fastest > floor / 2) {
      row.verdict = effect > 0 ? TimingVerdict::slower : TimingVerdict::faster;
    }
  }
  return common;
}

/// @param pairs  of one device, at least one
void add_remarks(const std::vector<Pair>& pairs, const Common& common, std::vector<std::string>& remarks) {
  const RowKey& key = pairs.front().a->key;
  const std::string where = key.device.empty() ? "" : " on " + key.device;
  if (pairs.size() < enough_rows) {
    remarks.push_back(fmt::format(
        "Only {} rows{} can be compared in time, fewer than {}: a difference of the whole session "
        "cannot be told from a difference of the rows, and none is removed.",
        pairs.size(), where, enough_rows));
  } else {
    remarks.push_back(fmt::format(
        "B takes {:.3f} times the {} of A{}, in the median over {} rows; this common ratio (machine, "
        "session, or a change that touches every row alike) is removed before rows are judged.",
        common.ratio, name_of_time(key), where, pairs.size()));
    remarks.push_back(fmt::format(
        "Around it the rows scatter by {:.1f} %; differences below {:.1f} % count as noise, for noisier rows "
        "more.",
        100 * common.scatter, 100 * std::max(minimum_effect, 3 * common.scatter)));
  }
  const auto few = std::ranges::count_if(pairs, [](const Pair& pair) {
    return std::min(times_of(*pair.a).size(), times_of(*pair.b).size()) < enough_repetitions;
  });
  if (few > 0) {
    remarks.push_back(
        fmt::format("{} of the rows{} have fewer than {} repetitions: their differences can be missed.", few,
                    where, enough_repetitions));
  }
  const auto elsewhere = std::ranges::count_if(pairs, [](const Pair& pair) {
    return pair.a->clock_mhz != pair.b->clock_mhz || pair.a->driver != pair.b->driver;
  });
  if (elsewhere > 0)
    remarks.push_back(
        fmt::format("{} of the rows{} have another clock or driver in B than in A.", elsewhere, where));
}

/// Judges the rows of each device, which have times by its own clock.
void compare_times(const std::vector<Pair>& comparable, Comparison& comparison) {
  std::map<std::string, std::vector<Pair>> by_device;  // the processor, without a name, is the first
  for (const Pair& pair : comparable) by_device[pair.a->key.device].push_back(pair);
  for (const auto& [device, pairs] : by_device) {
    const Common common = judge(pairs);
    add_remarks(pairs, common, comparison.remarks);
    if (device != by_device.begin()->first) continue;
    comparison.common_ratio = common.ratio;
    comparison.scatter = common.scatter;
  }
  if (by_device.empty())
    comparison.remarks.push_back("No row has times on both sides and the same work: no time is compared.");
}

/// P(U <= u) without ties. The number of arrangements with each U are the coefficients of the Gaussian
/// binomial
///   prod_{i=1..n} (1 - q^(m+i)) / (1 - q^i)
/// and all are integers below 2^53 for n, m <= 20.
double exact_lower_tail(std::size_t n, std::size_t m, double u) {
  std::vector<double> ways(n * m + 1, 0.0);
  ways[0] = 1;
  for (std::size_t i = 1; i <= n; ++i) {
    for (std::size_t k = ways.size(); k-- > m + i;) ways[k] -= ways[k - m - i];
    for (std::size_t k = i; k < ways.size(); ++k) ways[k] += ways[k - i];
  }
  const double total = std::accumulate(ways.begin(), ways.end(), 0.0);
  const auto last = ways.begin() + static_cast<std::ptrdiff_t>(u) + 1;
  return std::accumulate(ways.begin(), last, 0.0) / total;
}

}  // namespace

std::string_view to_string(TimingVerdict verdict) {
  constexpr std::string_view names[] = {"same", "faster", "slower", "changed"};
  return names[static_cast<std::size_t>(verdict)];
}

std::size_t Comparison::count(TimingVerdict verdict) const {
  return static_cast<std::size_t>(std::count_if(
      rows.begin(), rows.end(), [&](const RowComparison& row) { return row.verdict == verdict; }));
}

double mann_whitney_p(std::span<const double> a, std::span<const double> b) {
  if (a.empty() || b.empty()) return 1;
  const auto n = static_cast<double>(a.size()), m = static_cast<double>(b.size());

  // U = number of pairs in which a is larger, a tie counting one half.
  double u = 0;
  for (const double x : a) {
    for (const double y : b) u += x > y ? 1 : x == y ? 0.5 : 0;
  }
  const double smaller = std::min(u, n * m - u);

  std::vector<double> all(a.begin(), a.end());
  all.insert(all.end(), b.begin(), b.end());
  std::sort(all.begin(), all.end());
  double ties = 0;  // sum of t^3 - t over groups of t equal values
  for (std::size_t i = 0; i < all.size();) {
    std::size_t j = i;
    while (j < all.size() && all[j] == all[i]) ++j;
    const auto t = static_cast<double>(j - i);
    ties += t * t * t - t;
    i = j;
  }
  if (ties == 0 && a.size() <= 20 && b.size() <= 20) {
    return std::min(1.0, 2 * exact_lower_tail(a.size(), b.size(), smaller));
  }
  // sigma^2 = n m / 12 ((N + 1) - ties / (N (N - 1))),   N = n + m
  const double total = n + m;
  const double sigma = std::sqrt(n * m / 12 * (total + 1 - ties / (total * (total - 1))));
  if (!(sigma > 0)) return 1;
  const double z = std::max(0.0, n * m / 2 - smaller - 0.5) / sigma;
  return std::erfc(z / std::sqrt(2.0));
}

std::vector<std::string> changes_between(const Row& a, const Row& b) {
  std::vector<std::string> changes;
  const auto add = [&](std::string_view name, const std::string& before, const std::string& after) {
    changes.push_back(fmt::format("{}: {} -> {}", name, before, after));
  };
  if (a.outcome != b.outcome) add("outcome", a.outcome, b.outcome);
  const auto exact = [&](const char* name, std::int64_t before, std::int64_t after) {
    if (before != after) add(name, std::to_string(before), std::to_string(after));
  };
  exact("steps", a.steps, b.steps);
  exact("rejected", a.rejected, b.rejected);
  exact("rhs", a.rhs, b.rhs);
  const auto nearly = [&](const char* name, double before, double after, double slack) {
    if (std::isnan(before) && std::isnan(after)) return;
    if (before == after) return;
    const double allowed = 1e-6 * std::max(std::abs(before), std::abs(after)) + slack;
    if (!std::isfinite(allowed) || !(std::abs(before - after) <= allowed))
      add(name, to_text(before), to_text(after));
  };
  double slack = 0;
  for (const double error : {a.reference_error, b.reference_error}) slack += std::isfinite(error) ? error : 0;
  nearly("t_reached", a.t_reached, b.t_reached, 0);
  nearly("error_end", a.error_end, b.error_end, slack);
  nearly("error_global", a.error_global, b.error_global, slack);
  // Rows of an earlier hmax have none.
  if (!std::isnan(a.error_l2) && !std::isnan(b.error_l2)) nearly("error_l2", a.error_l2, b.error_l2, slack);
  const bool has_a = are_times(times_of(a)), has_b = are_times(times_of(b));
  if (has_a != has_b)
    add(name_of_time(a.key), has_a ? "measured" : "missing", has_b ? "measured" : "missing");
  return changes;
}

Comparison compare(std::span<const Row> a, std::span<const Row> b) {
  std::map<RowKey, const Row*> in_a, in_b;
  for (const Row& row : a) in_a.emplace(row.key, &row);
  for (const Row& row : b) in_b.emplace(row.key, &row);

  Comparison comparison;
  for (const Row& row : b) {
    if (!in_a.contains(row.key)) comparison.only_in_b.push_back(row.key);
  }
  std::vector<Pair> all;
  for (const Row& row : a) {
    const auto other = in_b.find(row.key);
    if (other == in_b.end()) {
      comparison.only_in_a.push_back(row.key);
    } else {
      all.push_back({&row, other->second, nullptr});
    }
  }
  comparison.rows.resize(all.size());
  std::vector<Pair> comparable;
  std::size_t explored = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    Pair& pair = all[i];
    RowComparison& row = comparison.rows[i];
    pair.result = &row;
    row.key = pair.a->key;
    row.median_a = timed(*pair.a) ? median(times_of(*pair.a)) : nan;
    row.median_b = timed(*pair.b) ? median(times_of(*pair.b)) : nan;
    row.ratio = row.median_b / row.median_a;
    row.relative_ratio = row.p = row.noise_floor = nan;
    row.changes = changes_between(*pair.a, *pair.b);
    if (pair.a->explored || pair.b->explored) ++explored;
    if (!row.changes.empty()) {
      row.verdict = TimingVerdict::changed;
    } else if (std::isfinite(row.ratio)) {
      comparable.push_back(pair);
    }
  }
  compare_times(comparable, comparison);
  if (explored > 0)
    comparison.remarks.push_back(fmt::format(
        "{} of the rows were explored on one side at least: their times are not compared.", explored));
  return comparison;
}

}  // namespace hmax
