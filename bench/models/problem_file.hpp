/// Users' own systems: `--problem my.toml`.
#pragma once

#include <filesystem>

#include "bench/input/toml_file.hpp"
#include "problems/formula_system.hpp"

namespace hmax {

/// Reads a first-order system given as formulas:
///
///   [problem]                      # optional
///   name = "pendulum"              # default: the name of the file without .toml
///   t_end = 20                     # default: 100 [s]
///   [equations]                    # one derivative for each state, in this order
///   angle = "rate"
///   rate = "-g/l*sin(angle) - c*rate"
///   [parameters]
///   g = 9.81
///   l = 1
///   c = 0.1
///   [initial]                      # the value of each state at t = 0
///   angle = 1
///   rate = 0
///
/// @throws InputError naming file, line and key, and the remedy; the formulas themselves are parsed by
/// FormulaSystem
FormulaDefinition read_problem(const std::filesystem::path& path);

/// The same for a document at hand.
FormulaDefinition problem_from(const TomlDocument& document);

}  // namespace hmax
