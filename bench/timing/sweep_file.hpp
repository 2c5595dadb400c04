/// Sweeps as users write them: `hmax sweep my.toml`, or the same words as flags.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "bench/timing/sweep.hpp"
#include "catalogue/input/toml_file.hpp"

namespace hmax {

/// What a step means: the readings of --readings and of the key `readings`.
inline constexpr std::array<std::string_view, 2> reading_names{"fixed", "sampled"};

/// What a user wrote; what is absent has the default of SweepSpec.
struct SweepRequest {
  std::optional<std::vector<std::string>> problems;   ///< catalogue ids or files of formulas
  std::optional<std::vector<std::string>> materials;  ///< ids, or "all": each with every problem
  std::optional<std::vector<std::string>> methods;    ///< ids or aliases
  std::optional<std::vector<std::string>> tableaux;   ///< files
  std::optional<std::vector<std::string>> readings;   ///< fixed, sampled
  std::optional<std::vector<double>> h;
  /// With h or readings one number, the tolerance of `sampled`; alone the tolerances that are swept.
  std::optional<std::vector<double>> rtol;
  std::optional<double> atol;  ///< absent: equal to rtol
  std::optional<std::string> control;
  std::optional<double> t_end;
  std::optional<std::int64_t> repeats, max_steps;
  std::optional<std::vector<double>> y0;
  std::optional<double> unit;  ///< of the problems' mesh files: metres in one of their units
  std::optional<std::string> out;
  std::vector<std::pair<std::string, double>> parameters;  ///< of every problem
};

/// Reads
///
///   [sweep]                          # every key is optional
///   problems = ["liver_benchmark"]   # a name, or several in brackets; files are sought beside this one
///   materials = "all"
///   methods = ["rk4", "ode45"]
///   tableaux = ["my.toml"]
///   h = [0.1, 0.01]                  # [s]
///   readings = ["fixed", "sampled"]
///   rtol = 1e-6
///   atol = 1e-6
///   control = "deadband"
///   t_end = 100                      # [s]
///   repeats = 9
///   max_steps = 1_000_000_000
///   y0 = [0.5, 1]
///   unit = "mm"                      # of mesh files: m, cm, mm or metres
///   out = "livers"
///   [set]                            # parameters of the problems
///   c = 6
///
/// @throws InputError naming file and line for unknown keys and names, and values of another kind
SweepRequest read_sweep(const std::filesystem::path& path);

/// The same for a document at hand.
SweepRequest sweep_from(const TomlDocument& document);

/// `flags` where they say something, `file` elsewhere; parameters of both, those of `flags` last.
SweepRequest merged(const SweepRequest& file, const SweepRequest& flags);

/// The sweep that was asked for, every default filled in.
/// @throws InputError for readings, controls and combinations that do not exist; plan_sweep() checks the rest
SweepSpec spec_from(const SweepRequest& request);

}  // namespace hmax
