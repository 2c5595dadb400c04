/// Which differences between two sets of measured rows are outside the noise.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "results/row.hpp"

namespace hmax {

/// slower and faster say what B is against A; changed: the same key gave another outcome, cost in steps or
/// error.
enum class TimingVerdict { same, faster, slower, changed };

std::string_view to_string(TimingVerdict verdict);

/// One key that both sides have.
struct RowComparison {
  RowKey key;
  TimingVerdict verdict = TimingVerdict::same;
  double median_a = 0, median_b = 0;  ///< time of one run by the clock of its device [s]; NaN without samples
  double ratio = 0;                   ///< median_b / median_a as measured; NaN without samples
  double relative_ratio = 0;          ///< ratio / the common one of its device: what is judged
  double p = 1;            ///< of the rank test on the samples, common ratio removed; NaN without samples
  double noise_floor = 0;  ///< relative_ratio within [1 / (1 + noise_floor), 1 + noise_floor] is noise
  std::vector<std::string> changes;  ///< "steps: 1000 -> 1001"
};

struct Comparison {
  std::vector<RowComparison> rows;           ///< in the order of A
  std::vector<RowKey> only_in_a, only_in_b;  ///< in their own order
  /// Of B to A, median over the rows of the processor or, where it has none, of the first device; 1 when rows
  /// are too few to tell.
  double common_ratio = 1;
  double scatter = 0;                ///< robust relative spread of the same rows around common_ratio
  std::vector<std::string> remarks;  ///< sentences for the reader: the common ratio, the noise, caveats

  std::size_t count(TimingVerdict verdict) const;
};

/// Compares B with A, row by row.
///
/// Two sessions of one program on one machine differ in three ways that are no property of the program: the
/// whole session is slower (frequency, neighbours), a stretch of it is (a few rows, or a few repetitions of
/// many rows), and each sample has its own noise. A rank test sees only the last: samples of a slow stretch
/// lie apart as clearly as those of a slower program, and its p-value is tiny. So a row is called faster or
/// slower only when all of these hold:
///
///  1. The samples lie apart: two-sided Mann-Whitney U test [mann1947test] on A and on B divided by the
///  common ratio
///     (the median of the ratios over all rows, reported by itself), with the false discovery rate over all
///     rows held at 5 % [benjamini1995controlling].
///  2. The medians differ by more than the noise floor, the largest of
///       - 7 %, what a slow stretch of a shared machine costs,
///       - 3 times the scatter of all rows around the common ratio, 1.4826 * median |log ratio - log common
///       ratio|: rows
///         that move about together in an A/A comparison raise the bar for each of them,
///       - 3 standard errors of this row's two medians, 1.2533 * (q3 - q1) / 1.349 / sqrt(n) each.
///  3. The fastest samples differ in the same direction by at least half of that: a slow stretch that spared
///  one
///     repetition leaves the minimum where it was, a slower program moves it.
///
/// Rows of each device are judged among themselves, and those of the processor too: their times are by
/// different clocks.
///
/// The scatter assumes that fewer than half of the rows changed by much. With fewer than 8 timed rows in
/// common neither it nor the common ratio can be told from changes: none is removed and a remark says so.
///
/// Steps, rejected steps, rhs and outcome are compared exactly; t_reached and the errors up to 1e-6 relative
/// and the two reference errors, since another libm moves their last digits. Rows that changed take no part
/// in 1 to 3, and neither do rows of which one was explored: only their results are compared.
Comparison compare(std::span<const Row> a, std::span<const Row> b);

/// What differs between two runs of the same key although nothing in it depends on the clock, "steps: 1000 ->
/// 1001": steps, rejected steps, rhs and outcome exactly, the rest as compare() does.
std::vector<std::string> changes_between(const Row& a, const Row& b);

/// Two-sided p-value of the Mann-Whitney U test: exact for up to 20 values a side without ties, else by the
/// normal approximation with continuity and tie corrections. 1 when a side is empty.
double mann_whitney_p(std::span<const double> a, std::span<const double> b);

}  // namespace hmax
