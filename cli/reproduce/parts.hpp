/// The studies that `hmax reproduce` does again: each measured or computed, drawn and written into a folder.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "cli/reproduce/tissue_page.hpp"
#include "cli/shared/commands.hpp"
#include "cli/shared/device_option.hpp"
#include "results/json.hpp"

namespace hmax {

/// What came of one of them.
struct ReproducedPart {
  std::filesystem::path report = {};  ///< its page, index.html; empty where only a shard is stored
  std::int64_t rows = 0;              ///< of numbers that it rests on
  double seconds = 0;                 ///< wall time of this call [s]
  bool failed = false;                ///< prediction and runs disagree, or something was not solved
  Json document = {};                 ///< for machines
  std::string words = {};             ///< the same for people
};

/// What is asked of one.
struct StudyOptions {
  std::string folder;                   ///< where its report goes
  std::string shard = {};               ///< "3/8": only these rows are measured, and no page is written
  std::vector<std::string> files = {};  ///< reports of a user in place of those of hmax, of the docket
  DeviceChoice device = {};             ///< of the tissue
  TissueOptions tissue = {};            ///< its `quick` is that of every study
};

/// The liver oscillator study. Rows that the stores of the folder hold are not measured again.
ReproducedPart reproduce_oscillator_part(const StudyOptions& options, Console& console);

/// The step limits of every method on every model of that study; those that the store of the folder holds are
/// looked up.
ReproducedPart reproduce_limits(const StudyOptions& options, Console& console);

/// Springs and finite elements of the thesis.
ReproducedPart reproduce_tissue_part(const StudyOptions& options, Console& console);

/// Methods of simulators at 60, 100 and 1000 frames a second: error, time of a frame, stiffness shown. Quick
/// it is the phantom at one rate.
ReproducedPart reproduce_real_time(const StudyOptions& options, Console& console);

/// Public reports of runs that failed, judged from their numbers.
ReproducedPart reproduce_docket(const StudyOptions& options, Console& console);

/// Infinity as a word and NaN as null, as every document has them.
void tell_infinity(Json& value);

/// `hmax reproduce slice`: any slice of the synthetic thigh as PNG.
void add_slice(CLI::App& reproduce, Console& console);

}  // namespace hmax
