/// Users' own systems: `--problem my.toml`.
#pragma once

#include <filesystem>

#include "catalogue/input/toml_file.hpp"
#include "problems/formula_system.hpp"

namespace hmax {

/// Reads a system given as formulas, whose language is that of problems/formula_parser.hpp:
///
///   [problem]                      # optional
///   name = "pendulum"              # default: the name of the file without .toml
///   t0 = 0                         # when runs begin; default: 0 [s]
///   t_end = 20                     # default: t0 + 100 [s]
///   positions = ["angle"]          # both lists only where x' = v of the equations does not tell them
///   velocities = ["rate"]
///   [equations]                    # one derivative for each state, in this order
///   angle = "rate"
///   rate = "-g/l*sin(angle) - c*rate"
///   [parameters]
///   g = 9.81
///   l = 1
///   c = 0.1
///   [initial]                      # the value of each state at t0
///   angle = 1
///   rate = 0
///
/// @throws InputError naming file, line and key, and the remedy; the formulas themselves are parsed by
/// FormulaSystem
FormulaDefinition read_problem(const std::filesystem::path& path);

/// The same for a document at hand.
FormulaDefinition problem_from(const TomlDocument& document);

}  // namespace hmax
