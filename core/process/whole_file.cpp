#include "core/process/whole_file.hpp"

#include <fstream>
#include <system_error>

#include <fmt/format.h>

#include "core/own_files.hpp"
#include "core/text/utf8.hpp"

namespace hmax {

namespace fs = std::filesystem;

std::string read_whole(const fs::path& file, std::string_view what) {
  std::error_code error;
  if (!fs::exists(file, error))
    throw std::invalid_argument(fmt::format("there is no file '{}'; correct the name", file.string()));
  if (!fs::is_regular_file(file, error))
    throw std::invalid_argument(fmt::format("'{}' is not a file; name {}", file.string(), what));
  note_input(file);
  std::ifstream in(file, std::ios::binary);
  std::string text;
  const auto size = fs::file_size(file, error);
  if (in && !error) {
    within_memory(file, [&] { text.resize(static_cast<std::size_t>(size)); });
    in.read(text.data(), static_cast<std::streamsize>(size));
    text.resize(static_cast<std::size_t>(in.gcount()));
  }
  if (error || in.bad() || !in.is_open())
    throw std::invalid_argument(
        fmt::format("the file '{}' cannot be read; check its permissions", file.string()));
  text.erase(0, text.size() - without_byte_order_mark(text).size());
  return text;
}

void refuse_too_large(const fs::path& file) {
  std::error_code error;
  const auto size = fs::file_size(file, error);
  throw std::invalid_argument(fmt::format(
      "'{}'{} needs more memory than there is; raise the limit (ulimit -v), end other programs or take "
      "a smaller file",
      file.string(), error ? "" : fmt::format(" of {:.3g} GB", static_cast<double>(size) / 1e9)));
}

}  // namespace hmax
