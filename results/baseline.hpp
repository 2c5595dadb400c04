/// The accuracy baseline: what every method did on every problem of the accuracy suite when somebody last
/// looked.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace hmax {

/// One run of the suite: errors and work, which do not depend on the processor.
struct AccuracyRow {
  std::string problem, method;
  std::string setting;  ///< "h=0.2", "rtol=1e-4 control=pi", "h=0.2 jacobian=frozen"
  std::string outcome{};
  double error_end = 0;      ///< max norm at the end; NaN where the end was not reached
  double error_samples = 0;  ///< largest over samples of the dense output
  std::int64_t steps = 0, rejected = 0, rhs = 0, jacobian = 0, factorisations = 0, newton = 0;

  /// "liver_forced rk4 h=0.2": what identifies a row.
  [[nodiscard]] std::string name() const;
};

/// Reads and writes the baseline as CSV, one line a row.
/// @throws InputError naming file and line when the file is missing or a line is no row
std::vector<AccuracyRow> read_baseline(const std::filesystem::path& file);
void write_baseline(const std::filesystem::path& file, const std::vector<AccuracyRow>& rows);

/// What moved of one row.
struct AccuracyChange {
  std::string row;   ///< AccuracyRow::name()
  std::string what;  ///< name of the number or "outcome"
  std::string before, now;
};

struct AccuracyComparison {
  std::int64_t compared = 0;  ///< rows that are in both
  std::vector<AccuracyChange> changed;
  std::vector<std::string> missing;  ///< rows of the baseline that were not run
  std::vector<std::string> added;    ///< rows that the baseline does not know

  [[nodiscard]] bool equal() const { return changed.empty() && missing.empty() && added.empty(); }
};

/// Outcomes and counts must be equal; errors within a millionth and 1e-13, what rounding may do to them.
AccuracyComparison compare(const std::vector<AccuracyRow>& baseline, const std::vector<AccuracyRow>& now);

}  // namespace hmax
