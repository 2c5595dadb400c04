/// Independent pieces of work, shared by all cores.
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <optional>
#include <type_traits>
#include <utility>
#include <vector>

namespace hmax {

/// How many threads parallel_for() uses: the cores that this process may run on, unless set_jobs() has said
/// otherwise.
std::size_t jobs();

/// From now on. A program says so once, at its start or by an option. @param count  at least 1
void set_jobs(std::size_t count);

/// How many threads parallel_for() uses when the calling thread calls it: jobs(), or fewer under ThreadLimit;
/// 1 inside a piece.
std::size_t threads();

/// work(i, worker) for i = 0 .. count - 1, begun in this order, none after interrupted() has become true;
/// worker < jobs(), so that each may have what others must not share, such as users' formulas. What a piece
/// computes must not depend on the worker: results are the same for any number of threads. What a piece
/// throws is thrown when all have ended, of several that of the earliest piece. Where the system allows no
/// further thread, or has no memory for its stack, those that are there do the work, at least the calling
/// one. Inside a piece, and under OneThread, all pieces are done by the calling thread.
/// Threads last from call to call, asleep between them; signals that end the program go to others. A piece
/// may fork only to run another program. Threads take the next index from one counter, so that pieces of
/// unequal cost share the cores evenly. Once a piece has thrown no further ones begin; those under way end.
/// With count = 0 nothing is called.
/// @param progress  called by the calling thread with the number of pieces that are done
void parallel_for(std::size_t count, const std::function<void(std::size_t i, std::size_t worker)>& work,
                  const std::function<void(std::size_t)>& progress, const std::function<bool()>& interrupted);

/// The same without progress and interruption.
inline void parallel_for(std::size_t count,
                         const std::function<void(std::size_t i, std::size_t worker)>& work) {
  parallel_for(
      count, work, [](std::size_t) {}, [] { return false; });
}

/// {make(0), ..., make(count - 1)}, computed as by parallel_for().
template <class Make>
auto parallel_map(std::size_t count, const Make& make) {
  using Value = std::invoke_result_t<const Make&, std::size_t>;
  std::vector<std::optional<Value>> made(count);
  parallel_for(count, [&](std::size_t i, std::size_t) { made[i].emplace(make(i)); });
  std::vector<Value> values;
  values.reserve(count);
  for (std::optional<Value>& value : made) values.push_back(std::move(*value));
  return values;
}

/// work(begin, end) for stretches that make up the rows 0 .. rows - 1 of a matrix product: one stretch unless
/// threads have some 50 us of work each. What a row becomes must not depend on where its stretch begins.
/// @param entries  of the matrix, numbers or blocks
template <class Work>
void parallel_rows(std::size_t rows, std::size_t entries, const Work& work) {
  constexpr std::size_t least_entries = 50'000;
  if (entries < 2 * least_entries) return work(std::size_t{0}, rows);
  const std::size_t parts = std::min(threads(), entries / least_entries);
  parallel_for(parts,
               [&](std::size_t part, std::size_t) { work(rows * part / parts, rows * (part + 1) / parts); });
}

/// As long as this lives, parallel_for() uses no more threads than this when the calling thread calls it.
class ThreadLimit {
 public:
  /// @param count  at least 1, the calling thread
  explicit ThreadLimit(std::size_t count);
  ~ThreadLimit();
  ThreadLimit(const ThreadLimit&) = delete;
  ThreadLimit& operator=(const ThreadLimit&) = delete;

 private:
  std::size_t before_;
};

/// The calling thread alone: for what is timed.
class OneThread : ThreadLimit {
 public:
  OneThread() : ThreadLimit(1) {}
};

}  // namespace hmax
