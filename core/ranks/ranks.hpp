/// Processes that work on one task and send each other messages, behind an interface that knows no library.
#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace hmax {

struct Message {
  int from = 0;
  std::string bytes;
};

/// One of the processes, numbered from 0. One thread uses it.
class Ranks {
 public:
  Ranks() = default;
  Ranks(const Ranks&) = delete;
  Ranks& operator=(const Ranks&) = delete;
  virtual ~Ranks() = default;

  [[nodiscard]] virtual int rank() const = 0;
  [[nodiscard]] virtual int size() const = 0;
  /// The most ranks that share a node.
  [[nodiscard]] virtual int most_on_a_node() const = 0;
  /// Messages from one rank to another arrive in the order in which they were sent. May wait until the other
  /// one receives.
  virtual void send(int to, std::string_view bytes) = 0;
  /// A message that has arrived; does not wait.
  virtual std::optional<Message> receive() = 0;
};

/// Sleeps between looks for something that other ranks do: 20 us, and twice as long each time up to 1 ms, so
/// that who waits leaves the processor to who works.
class Pause {
 public:
  void sleep();
  /// Something came.
  void reset() { next_ = shortest; }

 private:
  static constexpr std::chrono::microseconds shortest{20}, longest{1000};
  std::chrono::microseconds next_ = shortest;
};

/// Whether this build has MPI.
bool has_mpi();

/// Opens the module with MPI; nothing of it is loaded before. Once for each process, by all that mpirun has
/// started; from then on only rank 0 prints, and the standard streams of all others go to the null device.
/// The destructor waits for all ranks.
/// @param started  processes that mpirun says it has started
/// @throws InputError  where this build has no MPI, the module cannot be opened, or another MPI's mpirun was
/// used
std::unique_ptr<Ranks> open_ranks(int started);

/// What the module offers: makes the ranks, null where the ranks of MPI are not `started`.
using MakeRanks = std::unique_ptr<Ranks> (*)(int started);
inline constexpr const char* make_ranks_symbol = "hmax_make_ranks";

}  // namespace hmax
