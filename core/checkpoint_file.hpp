/// The state of a run in a file: what run it is of, and the bytes that it needs to go on.
#pragma once

#include <cstring>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace hmax {

/// The bytes of a state, written and read back in the same order: numbers keep every bit.
class StateBytes {
 public:
  StateBytes() = default;
  /// @param bytes  as bytes() returned them
  explicit StateBytes(std::string bytes) : bytes_(std::move(bytes)) {}

  /// Appends `value`.
  template <class T>
  requires std::is_arithmetic_v<T>
  void put(T value) { bytes_.append(reinterpret_cast<const char*>(&value), sizeof value); }

  /// The next value; the type must be that of its put().
  /// @throws std::runtime_error when fewer bytes are left
  template <class T>
  requires std::is_arithmetic_v<T> T take() {
    if (bytes_.size() - read_ < sizeof(T)) throw std::runtime_error("the state ends too early");
    T value;
    std::memcpy(&value, bytes_.data() + read_, sizeof value);
    read_ += sizeof value;
    return value;
  }

  [[nodiscard]] const std::string& bytes() const { return bytes_; }
  /// Whether every value has been taken.
  [[nodiscard]] bool at_end() const { return read_ == bytes_.size(); }

 private:
  std::string bytes_;
  std::size_t read_ = 0;  ///< bytes taken so far
};

/// A fact that has to be the same when a run goes on: ("method", "rk4").
struct RunFact {
  std::string name, value;
  bool operator==(const RunFact&) const = default;
};

/// A run that stopped on its way.
struct Checkpoint {
  std::vector<RunFact> facts;  ///< in the order in which differences are told
  std::string state;           ///< StateBytes::bytes()
};

/// Writes beside `file`, waits for the disk and renames: a process that is killed at any moment leaves the
/// old file or the new one.
/// @throws std::system_error when it cannot be written
void write_checkpoint(const std::filesystem::path& file, const Checkpoint& checkpoint);

/// Reads what write_checkpoint() wrote. Numbers are those of this machine's byte order.
/// @throws std::runtime_error  one sentence, when it cannot be read, is none, is of another version, or is
/// damaged or truncated
Checkpoint read_checkpoint(const std::filesystem::path& file);

/// What differs first between the facts of a checkpoint and those of the run that is to go on, such as
/// "method is rk4 in the checkpoint and newmark in this run"; empty when all agree.
std::optional<std::string> first_difference(const std::vector<RunFact>& checkpoint,
                                            const std::vector<RunFact>& run);

}  // namespace hmax
