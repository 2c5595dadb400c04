#include "core/checkpoint_file.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <fcntl.h>
#include <fstream>
#include <iterator>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>
#include <utility>

#include "core/part_file.hpp"
#include "core/text/digest.hpp"

namespace hmax {

namespace {

constexpr std::string_view header = "hmax checkpoint 1\n";  // the number is the version of this layout
constexpr std::size_t digest_size = 16;

/// Appends the length of `text` in 8 bytes, and the text.
void put_text(std::string& out, std::string_view text) {
  const std::uint64_t size = text.size();
  out.append(reinterpret_cast<const char*>(&size), sizeof size);
  out.append(text);
}

/// Reads what put_text() wrote and shortens `in`; takes no memory for a length before its bytes are there.
std::string take_text(std::string_view& in) {
  std::uint64_t size = 0;
  if (in.size() < sizeof size) throw std::runtime_error("a length is missing");
  std::memcpy(&size, in.data(), sizeof size);
  in.remove_prefix(sizeof size);
  if (in.size() < size) throw std::runtime_error("a text is missing");
  std::string text(in.substr(0, size));
  in.remove_prefix(size);
  return text;
}

std::string digest_of(std::string_view bytes) {
  Digest digest;
  digest.add(bytes);
  return digest.text();
}

std::string sentence(const std::filesystem::path& file, std::string_view what) {
  return "checkpoint " + file.string() + " " + std::string(what);
}
[[noreturn]] void refuse(const std::filesystem::path& file, std::string_view why) {
  throw std::runtime_error(sentence(file, why));
}

}  // namespace

std::string damaged_checkpoint(const std::filesystem::path& file) {
  return sentence(file, "is damaged or truncated; remove it to start from the beginning");
}

void write_checkpoint(const std::filesystem::path& file, const Checkpoint& checkpoint) {
  std::string bytes(header);
  put_text(bytes, checkpoint.state);
  for (const RunFact& fact : checkpoint.facts) {
    put_text(bytes, fact.name);
    put_text(bytes, fact.value);
  }
  PartFile part(file);
  part.write(bytes);
  part.write(digest_of(bytes));
  part.sync();
  part.replace();
}

Checkpoint read_checkpoint(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  // Of another file no more is read than its beginning.
  std::string bytes(checkpoint_opening.size(), ' ');
  in.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  const bool is_checkpoint = bytes == checkpoint_opening;
  if (is_checkpoint) bytes.append(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
  if (!in.is_open() || in.bad()) refuse(file, "cannot be read");
  if (!is_checkpoint) refuse(file, "is not a checkpoint of hmax; give another name");
  if (bytes.size() < header.size() + digest_size) throw std::runtime_error(damaged_checkpoint(file));
  std::string_view body = std::string_view(bytes).substr(0, bytes.size() - digest_size);
  // The digest first: a damaged digit of the version is damage.
  if (digest_of(body) != bytes.substr(body.size())) throw std::runtime_error(damaged_checkpoint(file));
  if (!body.starts_with(header))
    refuse(file, "was written by another version of hmax; remove it to start from the beginning");
  body.remove_prefix(header.size());
  try {
    Checkpoint checkpoint{{}, take_text(body)};
    while (!body.empty()) {
      std::string name = take_text(body);
      checkpoint.facts.push_back({std::move(name), take_text(body)});
    }
    return checkpoint;
  } catch (const std::runtime_error&) {
    throw std::runtime_error(damaged_checkpoint(file));
  }
}

CheckpointLock::CheckpointLock(const std::filesystem::path& file)
    : lock_(std::filesystem::absolute(behind_links(file))) {
  lock_ += ".lock";
  for (;;) {
    descriptor_ = open(lock_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666);
    if (descriptor_ < 0) return;
    const bool is_locked = flock(descriptor_, LOCK_EX | LOCK_NB) == 0;
    const bool is_taken = !is_locked && errno == EWOULDBLOCK;
    // Its owner may have removed the file between the two calls: a lock on it would keep nobody out.
    struct stat ours {
    }, there{};
    const bool is_there = fstat(descriptor_, &ours) == 0 && stat(lock_.c_str(), &there) == 0 &&
                          ours.st_ino == there.st_ino && ours.st_dev == there.st_dev;
    if (is_locked && is_there) return;
    close(std::exchange(descriptor_, -1));
    if (is_taken) refuse(file, "is in use by another run; wait until that ends, or name another file");
    if (!is_locked) return;
  }
}

CheckpointLock::~CheckpointLock() {
  if (descriptor_ < 0) return;
  struct stat ours {};
  if (fstat(descriptor_, &ours) == 0 && ours.st_size == 0)
    unlink(lock_.c_str());  // before the lock goes: whoever opens it then makes another file
  close(descriptor_);
}

std::optional<std::string> first_difference(const std::vector<RunFact>& checkpoint,
                                            const std::vector<RunFact>& run) {
  const auto [theirs, ours] = std::mismatch(checkpoint.begin(), checkpoint.end(), run.begin(), run.end());
  const bool has_theirs = theirs != checkpoint.end(), has_ours = ours != run.end();
  if (!has_theirs && !has_ours) return std::nullopt;
  if (has_theirs && has_ours && theirs->name == ours->name)
    return ours->name + " is " + theirs->value + " in the checkpoint and " + ours->value + " in this run";
  if (has_ours && std::none_of(checkpoint.begin(), checkpoint.end(),
                               [&name = ours->name](const RunFact& fact) { return fact.name == name; }))
    return ours->name + " is " + ours->value + " in this run and not given in the checkpoint";
  if (has_theirs)
    return theirs->name + " is " + theirs->value + " in the checkpoint and not given in this run";
  return ours->name + " stands twice in this run";
}

}  // namespace hmax
