/// Explicit Runge-Kutta methods of users: `--tableau my.toml`.
#pragma once

#include <filesystem>

#include "catalogue/input/toml_file.hpp"
#include "integrators/explicit/runtime_tableau.hpp"

namespace hmax {

/// Reads a tableau of at most 40 stages:
///
///   name = "heun_euler"            # optional: the name of the file without it
///   a = [[], [1]]                  # row i holds at most i - 1 entries, or zeros from the diagonal on
///   b = ["1/2", 0.5]               # integers, decimals, or in quotes fractions and decimals of any length
///   b_hat = [1, 0]                 # optional: the embedded method that makes the error estimate
///   c = [0, 1]                     # optional: must agree with the sums of the rows of a
///
/// Both orders are computed from the order conditions up to order 10. Row sums are accepted to 1e-12.
/// @throws InputError naming file, line, the row or entry at fault, and the remedy
RuntimeTableau read_tableau(const std::filesystem::path& path);

/// The same for a document at hand.
RuntimeTableau tableau_from(const TomlDocument& document);

}  // namespace hmax
