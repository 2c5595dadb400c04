/// `hmax reproduce oscillators`: every oscillator figure and table of the liver study in one folder.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "results/row.hpp"

namespace hmax {

/// What is measured before anything is drawn.
struct StudyRows {
  std::vector<Row> published_model;  ///< liver_forced, all methods, nine steps, both readings
  std::vector<Row> self_exciting;    ///< the same model with c = -2, as the study's text says, to t = 10
  std::string machine;               ///< one line: where it was measured
};

/// Draws figures 1 to 8 and table 2 into `folder` and writes a report (README.md, index.html) that shows
/// each beside what the study printed and what differs, with a link to rows.html there.
/// @param progress  told the name of each section before it is made
/// @returns the index.html
/// @throws InputError when the folder cannot be written
std::filesystem::path reproduce_oscillators(const StudyRows& rows, const std::filesystem::path& folder,
                                            const std::function<void(const std::string&)>& progress);

}  // namespace hmax
