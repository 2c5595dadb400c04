/// The subcommands of `hmax`, one source file each, which parses and prints; reproduce_* also compose
/// reports.
///
/// add_NAME() adds the subcommand to the application. Its callback runs after parsing; it reports bad input
/// by throwing InputError and a check that failed by console.exit_code.
#pragma once

#include <array>
#include <string_view>

#include "cli/shared/console.hpp"
#include "cli/shared/options.hpp"

namespace hmax {

/// What `hmax list` shows.
inline constexpr std::array<std::string_view, 4> list_topics{"methods", "problems", "models", "materials"};

void add_advise(CLI::App& app, Console& console);
void add_list(CLI::App& app, Console& console);
void add_run(CLI::App& app, Console& console);
void add_static(CLI::App& app, Console& console);
void add_fidelity(CLI::App& app, Console& console);
void add_order(CLI::App& app, Console& console);
void add_sweep(CLI::App& app, Console& console);
void add_precision(CLI::App& app, Console& console);
void add_check(CLI::App& app, Console& console);
void add_probe(CLI::App& app, Console& console);
void add_phase(CLI::App& app, Console& console);
void add_stability(CLI::App& app, Console& console);
void add_mesh(CLI::App& app, Console& console);
void add_reproduce(CLI::App& app, Console& console);
void add_export(CLI::App& app, Console& console);
void add_compare(CLI::App& app, Console& console);
void add_merge(CLI::App& app, Console& console);
void add_report(CLI::App& app, Console& console);
void add_doctor(CLI::App& app, Console& console);  // and info
void add_completion(CLI::App& app, Console& console);

}  // namespace hmax
