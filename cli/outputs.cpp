#include "cli/outputs.hpp"

#include <filesystem>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "core/own_files.hpp"
#include "results/errors.hpp"

namespace hmax {

void add_force(CLI::App& command) {
  command.add_flag_callback(
      "--force", [] { allow_replacing(Replacing::forced); }, "Replace a file that hmax did not write");
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

}  // namespace hmax
