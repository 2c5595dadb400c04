/// Files that are written: which may be replaced, and in which form, by the ending of their name.
#pragma once

#include <cstddef>
#include <filesystem>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>

#include "bench/timing/sweep.hpp"
#include "cli/shared/console.hpp"
#include "cli/shared/options.hpp"
#include "plots/figure.hpp"

namespace hmax {

/// The flag --force of a command that writes files: it may then replace those that hmax did not write.
void add_force(CLI::App& command);

/// The option --jobs of a command that works on all cores: how many threads, with the same results.
CLI::Option* add_jobs(CLI::App& command);
/// The same of a command whose times are those of one thread unless this option is given.
CLI::Option* add_jobs_of_timed(CLI::App& command);
/// The threads that --jobs asks for; none where it is not given.
std::optional<std::size_t> given_jobs(const CLI::Option* jobs);

/// The option --style of a command that draws figures: for a page or for a slide.
void add_figure_style(CLI::App& command);

/// @throws InputError  for --style slide where nothing is drawn
/// @param option  that asks for a figure, and is not given: "--output FOLDER"
void refuse_style_without_figure(std::string_view option);

/// Checks the folder of a figure before anything is computed: --output FOLDER, empty where nothing is drawn.
/// @throws InputError  as check_figure_files() of plots/draw.hpp and refuse_style_without_figure()
void check_figure(const std::string& folder, const std::string& name);

/// Draws a figure into a folder by draw(), or says on standard error why it is not drawn.
/// @returns its SVG; empty where it is not drawn
std::string drawn_svg(const Figure& figure, const std::string& folder, const std::string& name,
                      Console& console);

struct FileForm {
  std::string_view ending;  ///< ".csv"
  std::string_view holds;   ///< what is written so, for the error
};

/// The ending of the form in which a file is written: that of its name, or the first where the name has none,
/// as those of pipes and devices.
/// @throws InputError  naming the forms, when the name ends in another way
std::string_view form_of(const std::string& file, std::initializer_list<FileForm> forms);

/// @param example  a name that a page can have
/// @throws InputError  when a page cannot have the name of --output, before anything is computed
void check_page_name(const std::filesystem::path& file, std::string_view example);

/// The file of --out: a path that ends in .sqlite, or a plain name under results/runs/.
/// @throws InputError  for anything else
std::filesystem::path store_path(const std::string& out);

/// --shard I/N of commands that measure into a store.
void add_shard(CLI::App& command, std::string& shard);

/// "3/8"; nothing where the option is not given.
/// @throws InputError  for another form, and shards that do not exist
std::optional<Shard> shard_from(const std::string& text);

/// Runs a sweep with a line of progress; its warnings are remarks.
/// @param kept  the file of the store, where it stays
/// @throws Interrupted  after Ctrl-C
SweepSummary run_shown_sweep(const SweepPlan& plan, Store& store, const std::string& kept, Progress& progress,
                             Console& console);

/// Draws a figure as one SVG file by gnuplot, or says on standard error why it is not drawn.
/// @param name  as of draw(): letters, digits, '_', '-'
/// @param what  "picture", "figure"
/// @returns whether it is drawn
bool write_svg(const std::string& file, const Figure& figure, const std::string& name, std::string_view what,
               Console& console);

}  // namespace hmax
