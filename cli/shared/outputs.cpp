#include "cli/shared/outputs.hpp"

#include <array>
#include <filesystem>

#include <fmt/format.h>

#include "cli/shared/console.hpp"
#include "core/errors.hpp"
#include "core/own_files.hpp"
#include "core/parallel_for.hpp"
#include "plots/figure.hpp"

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

}  // namespace hmax
