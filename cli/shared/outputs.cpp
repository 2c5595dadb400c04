#include "cli/shared/outputs.hpp"

#include <array>
#include <atomic>
#include <filesystem>
#include <fstream>
#include <iterator>

#include <fmt/format.h>

#include "core/errors.hpp"
#include "core/own_files.hpp"
#include "core/parallel_for.hpp"
#include "core/process/temporary_folder.hpp"
#include "plots/draw.hpp"
#include "plots/gnuplot.hpp"
#include "results/table.hpp"

namespace hmax {

void add_force(CLI::App& command) {
  const HelpGroup group(command, common_group);
  add_flag(
      command, "--force", [] { allow_replacing(Replacing::forced); },
      "Replace a file that hmax did not write");
}

namespace {

CLI::Option* add_jobs(CLI::App& command, const std::string& about) {
  return add_text(
      command, "--jobs",
      [](const std::string& count) {
        constexpr std::int64_t most = 1024;
        const std::int64_t threads = parse_count("--jobs", count, 1);
        if (threads > most)
          throw InputError(fmt::format("--jobs is {}; give a number of threads up to {}", threads, most));
        set_jobs(static_cast<std::size_t>(threads));
      },
      about, "NUMBER");
}

}  // namespace

CLI::Option* add_jobs(CLI::App& command) {
  const HelpGroup group(command, common_group);
  return add_jobs(command, "Number of threads, without influence on results; the number of cores by default");
}

CLI::Option* add_jobs_of_timed(CLI::App& command) {
  return add_jobs(command,
                  "Number of threads, without influence on results, with the elapsed time; 1 by default");
}

std::optional<std::size_t> given_jobs(const CLI::Option* option) {
  return is_given(option) ? std::optional(jobs()) : std::nullopt;
}

void add_figure_style(CLI::App& command) {
  const HelpGroup group(command, common_group);
  add_text(
      command, "--style",
      [](const std::string& name) {
        constexpr std::array<std::string_view, 2> styles{"page", "slide"};
        set_figure_style(parse_choice("--style", name, styles) == styles[1] ? FigureStyle::slide
                                                                            : FigureStyle::page);
      },
      "Text size of figures: page or slide; page by default", "NAME");
}

void refuse_style_without_figure(std::string_view option) {
  if (figure_style() != FigureStyle::page)
    throw InputError(
        fmt::format("--style is of figures, and none is drawn; add {}, or leave it out", option));
}

void check_figure(const std::string& folder, const std::string& name) {
  if (folder.empty())
    refuse_style_without_figure("--output FOLDER");
  else
    check_figure_files(folder, name);
}

std::string drawn_svg(const Figure& figure, const std::string& folder, const std::string& name,
                      Console& console) {
  const FigureFiles files = draw(figure, folder, name);
  if (files.drawn()) return files.base.string() + ".svg";
  console.remark(files.problem);
  return {};
}

std::string_view form_of(const std::string& file, std::initializer_list<FileForm> forms) {
  const std::string ending = std::filesystem::path(file).extension().string();
  if (ending.empty()) return forms.begin()->ending;
  std::string known;
  for (const FileForm& form : forms) {
    if (ending == form.ending) return form.ending;
    known += fmt::format("{}FILE{} ({})", known.empty() ? "" : " or ", form.ending, form.holds);
  }
  throw InputError(fmt::format("'{}' would not be what its name says; --output writes {}", file, known));
}

void check_page_name(const std::filesystem::path& file, std::string_view example) {
  if (file.extension() != ".html")
    throw InputError(
        fmt::format("--output is '{}', but the page is HTML; let its name end in .html, such as {}",
                    file.string(), example));
}

std::filesystem::path store_path(const std::string& out) {
  if (out.ends_with(".sqlite")) return out;
  if (out.empty() || out == "." || out == ".." || out.find('/') != std::string::npos)
    throw InputError(fmt::format(
        "--out is '{}', but must be a plain name or the path of a file that ends in .sqlite", out));
  return std::filesystem::path("results") / "runs" / (out + ".sqlite");
}

void add_shard(CLI::App& command, std::string& shard) {
  add_text(command, "--shard", shard,
           "Measure only part I of N, like 3/8, into a store of its own; `hmax merge` makes one of all",
           "I/N");
}

std::optional<Shard> shard_from(const std::string& text) {
  if (text.empty()) return std::nullopt;
  const std::size_t slash = text.find('/');
  if (slash == std::string::npos)
    throw InputError(fmt::format("--shard is '{}'; write part I of N as I/N, like 3/8", text));
  const std::int64_t index = parse_count("I of --shard I/N", text.substr(0, slash), 1);
  const std::int64_t count = parse_count("N of --shard I/N", text.substr(slash + 1), 1);
  constexpr std::int64_t most = 1'000'000;
  if (index > count || count > most)
    throw InputError(
        fmt::format("--shard {} does not exist; shards count from 1 to N, and N is at most {}", text, most));
  return Shard{.index = static_cast<int>(index), .count = static_cast<int>(count)};
}

SweepSummary run_shown_sweep(const SweepPlan& plan, Store& store, const std::string& kept, Progress& progress,
                             Console& console) {
  const std::atomic<bool>& interrupted = interrupt_flag();
  SweepSummary summary = run_sweep(
      plan, store, [&](const SweepProgress& p) { progress.update(p.fraction, p.what); },
      [&] { return interrupted.load(); });
  if (summary.interrupted) throw kept.empty() ? Interrupted{} : Interrupted::with_store(kept, store.size());
  for (const std::string& warning : summary.warnings) console.remark(warning);
  return summary;
}

namespace {

/// The SVG with the mark of files of hmax, drawn in a folder that does not stay.
/// @throws InputError  where it cannot be drawn
std::string svg_of(const Figure& figure, const std::string& name) {
  if (!gnuplot_available())
    throw InputError("gnuplot is not installed; apt-get install gnuplot-nox, then ask again");
  const TemporaryFolder folder;
  const FigureFiles made = draw(figure, folder.path(), name);
  if (!made.drawn()) throw InputError(made.problem);
  std::ifstream in(made.base.string() + ".svg", std::ios::binary);
  std::string svg{std::istreambuf_iterator<char>(in), {}};
  // Behind the line that says it is XML.
  return svg.insert(svg.find('\n') + 1, "<!-- " + std::string(own_mark) + " -->\n");
}

}  // namespace

bool write_svg(const std::string& file, const Figure& figure, const std::string& name, std::string_view what,
               Console& console) {
  std::string svg;
  try {
    svg = svg_of(figure, name);
  } catch (const InputError& error) {
    console.remark(fmt::format("the {} {} is not drawn: {}", what, file, error.what()));
    return false;
  }
  write_file(file, svg);
  return true;
}

}  // namespace hmax
