#include "core/parallel_for.hpp"

#include <algorithm>
#include <atomic>
#include <exception>
#include <limits>
#include <new>
#include <optional>
#include <sched.h>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

namespace hmax {

namespace {

std::atomic<std::size_t> chosen = 0;  // 0: nobody has chosen
thread_local std::size_t most = std::numeric_limits<std::size_t>::max();  // threads of the calling thread

/// The cores in the affinity mask of this process, which taskset, containers and batch systems narrow; the
/// count of the machine where there is no mask.
std::size_t usable_cores() {
  cpu_set_t set;
  CPU_ZERO(&set);
  if (sched_getaffinity(0, sizeof set, &set) == 0)
    return static_cast<std::size_t>(std::max(1, CPU_COUNT(&set)));
  return std::max(1U, std::thread::hardware_concurrency());
}

}  // namespace

std::size_t jobs() {
  const std::size_t count = chosen;
  return count > 0 ? count : usable_cores();
}

void set_jobs(std::size_t count) { chosen = count; }

std::size_t threads() { return most > 1 ? std::min(jobs(), most) : 1; }

ThreadLimit::ThreadLimit(std::size_t count) : before_(std::exchange(most, std::min(most, count))) {}
ThreadLimit::~ThreadLimit() { most = before_; }

/// The calling thread is worker 0 and works too; `others` are joined at the end of their block, so that
/// every piece has ended before anything is thrown.
void parallel_for(std::size_t count, const std::function<void(std::size_t i, std::size_t worker)>& work,
                  const std::function<void(std::size_t)>& progress,
                  const std::function<bool()>& interrupted) {
  const std::size_t workers = std::max<std::size_t>(1, std::min(threads(), count));
  std::atomic<std::size_t> next = 0, done = 0;
  /// The index of a piece that threw, and what; one slot for each worker, so that no lock is needed.
  struct Failure {
    std::size_t piece = 0;
    std::exception_ptr error = nullptr;
  };
  std::vector<Failure> failures(workers);
  const auto labour = [&](std::size_t who) {
    // The cores are taken. A single piece leaves them to what it calls.
    std::optional<OneThread> inside;
    if (workers > 1) inside.emplace();
    std::size_t i = 0;
    try {
      // fetch-and-add: every index goes to exactly one worker, in ascending order of their beginnings.
      for (i = next++; i < count && !interrupted(); i = next++) {
        work(i, who);
        ++done;
        if (who == 0) progress(done);
      }
    } catch (...) {
      failures[who] = {i, std::current_exception()};
      // Nobody begins another piece.
      next = count;
    }
  };
  {
    std::vector<std::jthread> others;
    others.reserve(workers - 1);
    try {
      for (std::size_t who = 1; who < workers; ++who) others.emplace_back(labour, who);
    } catch (const std::system_error&) {
      // Those that run do all of it.
    } catch (const std::bad_alloc&) {
    }
    labour(0);
  }
  // Indices are handed out in order, so the piece with the least one was begun before the others that
  // failed.
  const Failure* first = nullptr;
  for (const Failure& failure : failures)
    if (failure.error && (first == nullptr || failure.piece < first->piece)) first = &failure;
  if (first != nullptr) std::rethrow_exception(first->error);
}

}  // namespace hmax
