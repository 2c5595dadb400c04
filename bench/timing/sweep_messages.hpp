/// What the ranks of a sweep send each other, as CBOR [bormann2020cbor].
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "bench/timing/sweep.hpp"
#include "results/fingerprint.hpp"

namespace hmax {

/// To rank 0: a rank begins.
struct RankReady {
  std::string sweep;  ///< digest of the plan
  Fingerprint machine;
};
/// To rank 0: the rows of a hand, in its order; their keys are not sent.
struct RankRows {
  std::vector<Row> rows;
  std::vector<double> seconds;  ///< elapsed, one entry for each task
};
/// To rank 0: a rank goes on no more.
struct RankFailed {
  std::string what;
  bool is_input = false;  ///< an InputError
};
/// To rank 0: the rank was interrupted, and waits for its end.
struct RankInterrupted {};
/// From rank 0: what to measure; nothing ends the rank, which answers RankEnded.
struct Hand {
  struct Task {
    std::size_t block = 0;  ///< index into SweepPlan::blocks
    std::vector<std::size_t> methods;
  };
  std::vector<Task> tasks;
};
/// To rank 0: the last message of a rank.
struct RankEnded {};

using SweepMessage = std::variant<RankReady, RankRows, RankFailed, RankInterrupted, Hand, RankEnded>;

std::string to_bytes(const SweepMessage& message);
/// Inverse of to_bytes().
/// @throws std::exception  for other bytes
SweepMessage sweep_message(std::string_view bytes);

}  // namespace hmax
