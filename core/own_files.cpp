#include "core/own_files.hpp"

#include <algorithm>
#include <fstream>
#include <mutex>
#include <system_error>
#include <vector>

namespace hmax {

namespace {

namespace fs = std::filesystem;

/// Behind this many bytes no mark is looked for.
constexpr std::size_t head_size = 2048;

/// The rule and the inputs of this process; guarded by `mutex`.
struct Rules {
  std::mutex mutex;
  Replacing replacing = Replacing::any;
  std::vector<fs::path> inputs;
};

/// One for the process, made at the first use.
Rules& rules() {
  static Rules all;
  return all;
}

/// The first head_size bytes, fewer of a shorter file, none of one that cannot be opened.
std::string head_of(const fs::path& file) {
  std::string head(head_size, '\0');
  std::ifstream in(file, std::ios::binary);
  in.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(in.gcount()));
  return head;
}

/// Whether the file is an SQLite database, by the text that every one begins with.
bool is_store(const fs::path& file) { return head_of(file).starts_with("SQLite format 3"); }

}  // namespace

void allow_replacing(Replacing which) {
  const std::scoped_lock lock(rules().mutex);
  rules().replacing = which;
}

void note_input(const fs::path& file) {
  const std::scoped_lock lock(rules().mutex);
  std::error_code error;
  // A later change of the current folder must not make another file of it.
  const fs::path whole = fs::absolute(file, error);
  rules().inputs.push_back(error ? file : whole);
}

bool is_own_file(const fs::path& file, std::string_view opening) {
  std::error_code error;
  if (fs::file_size(file, error) == 0 && !error) return true;
  const std::string head = head_of(file);
  return head.find(own_mark) != std::string::npos || (!opening.empty() && head.starts_with(opening));
}

std::string why_not_replaced(const fs::path& file, bool own) {
  const std::scoped_lock lock(rules().mutex);
  std::error_code error;
  if (rules().replacing == Replacing::any || !fs::is_regular_file(file, error)) return {};
  const std::string name = "'" + file.string() + "'";
  if (is_store(file)) return name + " is a store of measurements and would be lost; give another name";
  // By device and inode, not by name: another path, a link or a hard link to an input is that input.
  const auto same = [&](const fs::path& input) { return fs::equivalent(input, file, error); };
  if (std::ranges::any_of(rules().inputs, same))
    return name + " is read by this command and would be lost; give another name";
  if (own || rules().replacing == Replacing::forced) return {};
  return name + " is there and was not written by hmax; give another name, or --force";
}

}  // namespace hmax
