/// The studies that `hmax reproduce` does again: each measured or computed, drawn and written into a folder.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "bench/timing/sweep.hpp"
#include "cli/reproduce/tissue_page.hpp"
#include "cli/shared/commands.hpp"
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

/// The liver oscillator study. Rows that the stores of the folder hold are not measured again.
/// @param shard  only these rows are measured, and no page is written
ReproducedPart reproduce_oscillator_part(const std::filesystem::path& folder, Console& console,
                                         std::optional<Shard> shard = {});

/// The step limits of every method on every model of that study; those that the store of the folder holds are
/// looked up.
/// @param shard  only these rows are computed, and no page is written
ReproducedPart reproduce_limits(const std::filesystem::path& folder, Console& console,
                                std::optional<Shard> shard = {});

/// Springs and finite elements of the thesis.
ReproducedPart reproduce_tissue_part(const std::filesystem::path& folder, TissueOptions options,
                                     Console& console);

/// Methods of simulators at 60, 100 and 1000 frames a second: error, time of a frame, stiffness shown.
/// @param quick  the phantom at one rate
ReproducedPart reproduce_real_time(const std::filesystem::path& folder, bool quick, Console& console);

/// Public reports of runs that failed, judged from their numbers.
/// @param files  reports of a user in place of those of hmax
ReproducedPart reproduce_docket(const std::filesystem::path& folder, const std::vector<std::string>& files,
                                Console& console);

/// `hmax reproduce slice`: any slice of the synthetic thigh as PNG.
void add_slice(CLI::App& reproduce, Console& console);

}  // namespace hmax
