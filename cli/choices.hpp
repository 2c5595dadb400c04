/// The options by which several subcommands choose a problem and a method.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bench/catalogue.hpp"
#include "cli/console.hpp"

namespace hmax {

/// --problem, or --mesh with --model and --load; --set --material --y0
struct ProblemChoice {
  std::string problem, mesh, model, load, unit, material, y0;
  std::vector<std::string> set;

  void add_to(CLI::App& command);
  /// @throws InputError when something is missing or unknown
  [[nodiscard]] Problem make() const;
};

/// --method or --tableau
struct MethodChoice {
  std::string method, tableau;

  void add_to(CLI::App& command);
  /// @throws InputError when both or none are given, or something is unknown
  [[nodiscard]] Method make() const;
};

/// --control, a word of controller_names
void add_control(CLI::App& command, std::string& control);

}  // namespace hmax
