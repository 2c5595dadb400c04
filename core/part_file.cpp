#include "core/part_file.hpp"

#include <array>
#include <atomic>
#include <cerrno>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <fcntl.h>
#include <optional>
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

/// The folder of `file` without links where it has those of the open descriptors of a process, else empty.
std::filesystem::path descriptors_of(const std::filesystem::path& file) {
  std::error_code unknown;
  std::filesystem::path folder =
      std::filesystem::canonical(std::filesystem::absolute(file, unknown).parent_path(), unknown);
  return folder.string().starts_with("/proc/") && folder.filename() == "fd" ? folder : "";
}

/// The number of an open descriptor of this process, N of /proc/self/fd/N.
std::optional<int> own_descriptor(const std::filesystem::path& file) {
  std::error_code unknown;
  const std::filesystem::path folder = descriptors_of(file);
  if (folder.empty() || folder != std::filesystem::canonical("/proc/self/fd", unknown)) return std::nullopt;
  const std::string name = file.filename().string();
  int number = 0;
  const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), number);
  if (error != std::errc{} || end != name.data() + name.size()) return std::nullopt;
  return number;
}

/// Continues after short writes and after signals (EINTR).
void write_all(int descriptor, std::string_view text) {
  while (!text.empty()) {
    const ssize_t written = ::write(descriptor, text.data(), text.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail();
    text.remove_prefix(static_cast<std::size_t>(written));
  }
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

std::filesystem::path behind_links(const std::filesystem::path& file) {
  constexpr int most_links = 40;  // as many as Linux follows
  std::filesystem::path at = file;
  std::error_code unknown;
  for (int i = 0; i < most_links && descriptors_of(at).empty(); ++i) {
    const std::filesystem::path next = std::filesystem::read_symlink(at, unknown);
    if (unknown) break;
    at = at.parent_path() / next;
  }
  return at;
}

bool is_written_in_place(const std::filesystem::path& file) {
  if (!descriptors_of(behind_links(file)).empty()) return true;
  std::error_code unknown;
  const std::filesystem::file_status status = std::filesystem::status(file, unknown);
  return std::filesystem::exists(status) && !std::filesystem::is_regular_file(status);
}

void check_in_place(const std::filesystem::path& file) {
  const std::optional<int> own = own_descriptor(behind_links(file));
  if (!own) return;
  const int flags = fcntl(*own, F_GETFL);
  if (flags >= 0 && (flags & O_ACCMODE) == O_RDONLY) errno = EBADF;
  if (flags < 0 || (flags & O_ACCMODE) == O_RDONLY) fail();
}

void write_in_place(const std::filesystem::path& file, std::string_view text) {
  // What the program itself writes there goes on behind it: the copy shares its position.
  const std::optional<int> own = own_descriptor(behind_links(file));
  const int descriptor = own ? dup(*own) : open(file.c_str(), O_WRONLY | O_APPEND | O_CLOEXEC);
  if (descriptor < 0) fail();
  try {
    write_all(descriptor, text);
  } catch (const std::system_error&) {
    close(descriptor);
    throw;
  }
  if (close(descriptor) != 0) fail();
}

void remove_part_file() noexcept {
  // unlink() and a lock-free atomic are async-signal-safe; strings and allocation are not. The exchange
  // makes sure that only one of handler and destructor removes it.
  if (is_current.exchange(false)) unlink(current_name.data());
}

void remove_left_parts(const std::filesystem::path& file) {
  const std::filesystem::path behind = std::filesystem::absolute(behind_links(file));
  const std::filesystem::path folder = behind.parent_path();
  const std::string whole = behind.filename().string();
  std::error_code ignored;  // what cannot be listed or removed stays
  for (std::filesystem::directory_iterator at(folder, ignored), end; !ignored && at != end;
       at.increment(ignored))
    if (is_part_of(at->path().filename().string(), whole)) {
      std::error_code stays;
      std::filesystem::remove(at->path(), stays);
    }
}

PartFile::PartFile(const std::filesystem::path& file) : file_(behind_links(file)), part_(file_) {
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

void PartFile::write(std::string_view text) { write_all(descriptor_, text); }

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
