/// `hmax reproduce stability`: the step limits of every method on every model of the liver study, predicted
/// and observed, in one folder.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "results/json.hpp"
#include "studies/limit_study.hpp"

namespace hmax {

/// The outcome in numbers.
struct LimitSummary {
  std::size_t rows = 0, integrated = 0, with_number = 0, unbounded = 0, disagreeing = 0;
  double worst_gap = 0;  ///< largest |gap| of the rows with a number on both sides
  std::string worst;     ///< which row that is
};
HMAX_RECORD(LimitSummary, rows, integrated, with_number, unbounded, disagreeing, worst_gap, worst);
LimitSummary summary_of(const std::vector<LimitCase>& cases, const std::vector<StudyRow>& rows);

/// Before the minutes of the study. @throws InputError  when these files are there and are others
void check_limit_files(const std::filesystem::path& folder);

/// Writes limits.csv and nonlinear.csv with the columns of `hmax export --of limits`, the figure
/// hmax_predicted_vs_observed and a report (README.md, index.html) into `folder`, with a link to rows.html
/// there.
/// @param machine  one line: where it was done
/// @returns the index.html
/// @throws InputError when the folder cannot be written
std::filesystem::path reproduce_stability(const std::vector<LimitCase>& cases,
                                          const std::vector<StudyRow>& rows,
                                          const std::vector<StudyRow>& nonlinear, const std::string& machine,
                                          const std::filesystem::path& folder);

}  // namespace hmax
