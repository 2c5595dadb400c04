#include "core/part_file.hpp"

#include <array>
#include <atomic>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <fcntl.h>
#include <string>
#include <sys/random.h>
#include <system_error>
#include <unistd.h>

#include <climits>

namespace hmax {

namespace {

/// The name for a handler, which may follow no pointer into the heap.
std::array<char, PATH_MAX> current_name;
std::atomic<bool> is_current{false};

/// Keeps the absolute name for remove_part_file(); a name too long for the buffer is not kept, so that
/// only a signal would leave its part behind.
void remember(const std::string& name) {
  if (name.size() >= current_name.size()) return;
  std::memcpy(current_name.data(), name.c_str(), name.size() + 1);
  is_current = true;
}

/// Throws what errno says of the last system call.
[[noreturn]] void fail() { throw std::system_error(errno, std::generic_category()); }

constexpr std::string_view letters = "abcdefghijklmnopqrstuvwxyz234567", last = ".part";
constexpr std::size_t letter_count = 12;

/// Twelve letters of five random bits each, 2^60 names, from the random numbers of the kernel.
std::string random_ending() {
  std::uint64_t bits = 0;
  if (getrandom(&bits, sizeof bits, 0) != sizeof bits) fail();
  std::string ending = ".";
  for (std::size_t i = 0; i < letter_count; ++i, bits >>= 5) ending += letters[bits & 31U];
  return ending.append(last);
}

/// Whether `name` is that of a part of the file `whole`, see random_ending().
bool is_part_of(std::string_view name, std::string_view whole) {
  if (name.size() != whole.size() + 1 + letter_count + last.size() || !name.starts_with(whole) ||
      name[whole.size()] != '.' || !name.ends_with(last))
    return false;
  const std::string_view random = name.substr(whole.size() + 1, letter_count);
  return random.find_first_not_of(letters) == std::string_view::npos;
}

}  // namespace

void remove_part_file() noexcept {
  // unlink() and a lock-free atomic are async-signal-safe; strings and allocation are not. The exchange
  // makes sure that only one of handler and destructor removes it.
  if (is_current.exchange(false)) unlink(current_name.data());
}

void remove_left_parts(const std::filesystem::path& file) {
  const std::filesystem::path folder = std::filesystem::absolute(file).parent_path();
  const std::string whole = file.filename().string();
  std::error_code ignored;  // what cannot be listed or removed stays
  for (std::filesystem::directory_iterator at(folder, ignored), end; !ignored && at != end;
       at.increment(ignored))
    if (is_part_of(at->path().filename().string(), whole)) {
      std::error_code stays;
      std::filesystem::remove(at->path(), stays);
    }
}

PartFile::PartFile(const std::filesystem::path& file) : file_(file), part_(file) {
  part_ += random_ending();
  // Before open(): a signal in between removes a file that is not there, which does no harm.
  remember(std::filesystem::absolute(part_).string());
  descriptor_ = open(part_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (descriptor_ >= 0) return;
  is_current = false;
  fail();
}

PartFile::~PartFile() {
  if (descriptor_ >= 0) close(descriptor_);
  if (is_current.exchange(false)) unlink(part_.c_str());
}

void PartFile::write(std::string_view text) {
  while (!text.empty()) {
    const ssize_t written = ::write(descriptor_, text.data(), text.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail();
    text.remove_prefix(static_cast<std::size_t>(written));
  }
}

void PartFile::sync() {
  if (fsync(descriptor_) != 0) fail();
}

void PartFile::replace() {
  const int closed = close(descriptor_);
  descriptor_ = -1;
  // Replaces an existing file in one operation.
  if (closed != 0 || rename(part_.c_str(), file_.c_str()) != 0) fail();
  is_current = false;
}

}  // namespace hmax
