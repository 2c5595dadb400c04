#include "cli/outputs.hpp"

#include <filesystem>

#include <fmt/format.h>

#include "results/errors.hpp"

namespace hmax {

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
