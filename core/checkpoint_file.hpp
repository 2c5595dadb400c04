/// The state of a run in a file: what run it is of, and the bytes that it needs to go on.
#pragma once

#include <cstdint>
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

/// What the bytes of a state do not hold, or not in the shape that is asked for.
struct BadState : std::runtime_error {
  using std::runtime_error::runtime_error;
};

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

  /// Appends `count` values from `values` on.
  template <class T>
  requires std::is_arithmetic_v<T>
  void put_all(const T* values, std::size_t count) {
    bytes_.append(reinterpret_cast<const char*>(values), count * sizeof(T));
  }

  /// The next value; the type must be that of its put().
  /// @throws BadState when fewer bytes are left
  template <class T>
  requires std::is_arithmetic_v<T> T take() {
    T value;
    take_all(&value, 1);
    return value;
  }
  /// The next `count` values, to where `values` has room for them.
  template <class T>
  requires std::is_arithmetic_v<T>
  void take_all(T* values, std::size_t count) {
    expect<T>(count);
    if (count > 0) std::memcpy(values, bytes_.data() + read_, count * sizeof(T));
    read_ += count * sizeof(T);
  }
  /// @throws BadState when fewer than `count` values of this type are left: asked before memory is taken for
  /// them
  template <class T>
  void expect(std::uint64_t count) const {
    if (count > left() / sizeof(T)) throw BadState("the state ends too early");
  }

  [[nodiscard]] const std::string& bytes() const { return bytes_; }
  /// Bytes that have not been taken, and whether there are none.
  [[nodiscard]] std::size_t left() const { return bytes_.size() - read_; }
  [[nodiscard]] bool at_end() const { return left() == 0; }

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

/// With which every checkpoint begins.
inline constexpr std::string_view checkpoint_opening = "hmax checkpoint ";

/// What is said of a checkpoint that is damaged.
std::string damaged_checkpoint(const std::filesystem::path& file);

/// Writes beside `file`, waits for the disk and renames: a process that is killed at any moment leaves the
/// old file or the new one.
/// @throws std::system_error when it cannot be written
void write_checkpoint(const std::filesystem::path& file, const Checkpoint& checkpoint);

/// Reads what write_checkpoint() wrote. Numbers are those of this machine's byte order.
/// @throws std::runtime_error  one sentence, when it cannot be read, is none, is of another version, or is
/// damaged or truncated
Checkpoint read_checkpoint(const std::filesystem::path& file);

/// Keeps other processes from writing the same checkpoint, as long as it lives: it owns a lock of the system
/// on FILE.lock, which ends with the process however that ends. Two computers need a file system that shares
/// locks.
class CheckpointLock {
 public:
  /// Where no lock can be had, as on file systems without any, none is taken.
  /// @throws std::runtime_error  one sentence, when another process has it
  explicit CheckpointLock(const std::filesystem::path& file);
  /// Removes FILE.lock, which is empty unless it is somebody else's.
  ~CheckpointLock();
  [[nodiscard]] bool is_held() const { return descriptor_ >= 0; }
  CheckpointLock(const CheckpointLock&) = delete;
  CheckpointLock& operator=(const CheckpointLock&) = delete;

 private:
  std::filesystem::path lock_;
  int descriptor_ = -1;
};

/// What differs first between the facts of a checkpoint and those of the run that is to go on, such as
/// "method is rk4 in the checkpoint and newmark in this run"; empty when all agree.
std::optional<std::string> first_difference(const std::vector<RunFact>& checkpoint,
                                            const std::vector<RunFact>& run);

}  // namespace hmax
