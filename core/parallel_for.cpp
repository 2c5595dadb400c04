#include "core/parallel_for.hpp"

#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdint>
#include <deque>
#include <exception>
#include <limits>
#include <memory>
#include <mutex>
#include <new>
#include <optional>
#include <pthread.h>
#include <sched.h>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

namespace hmax {

namespace {

std::atomic<std::size_t> chosen = 0;                                      // 0: nobody has chosen
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

/// Returns when `value` is no longer `old`. What follows within some 50 us does not put the thread to sleep,
/// from which it would take as long to wake up.
template <class T>
void await_change(const std::atomic<T>& value, T old) {
  for (int i = 0; i < 100 && value == old; ++i) std::this_thread::yield();
  value.wait(old);
}

/// Threads that wait from one call of parallel_for() to the next: a new one takes 0.1 ms to begin.
class ThreadPool {
  struct Worker;

 public:
  /// Work for several threads. Its owner waits for those that have begun.
  struct Call {
    std::function<void(std::size_t who)> labour;
    std::uint32_t ticket = 0;  ///< another one for each call
    std::vector<Worker*> workers{};
    std::atomic<std::size_t> under_way = 0;
  };

  /// Those of this process; they end with it. A fork has none of its parent's threads, so it begins with new
  /// ones.
  static ThreadPool& all() {
    static std::atomic<ThreadPool*> these;
    [[maybe_unused]] static const int told = pthread_atfork(nullptr, nullptr, [] { these = nullptr; });
    ThreadPool* known = these;
    if (known != nullptr) return *known;
    auto made = std::make_unique<ThreadPool>();
    return these.compare_exchange_strong(known, made.get()) ? *made.release() : *known;
  }

  /// Asks for call->labour(who) for who = 1, 2, ... up to `count`, or fewer where the system allows no
  /// further thread or has no memory for its stack.
  void begin(const std::shared_ptr<Call>& call, std::size_t count) {
    call->workers.reserve(count);
    const std::scoped_lock hold(lock_);
    call->ticket = last_ticket_ = std::max<std::uint32_t>(last_ticket_ + 1, 1);
    for (std::size_t who = 1; who <= count; ++who) {
      if (idle_.empty() && !start()) return;
      Worker& worker = *idle_.back();
      idle_.pop_back();
      call->workers.push_back(&worker);
      ++call->under_way;
      worker.call = call;
      worker.who = who;
      worker.asked = call->ticket;
      worker.asked.notify_one();
    }
  }

  /// Takes the call back from those that have not begun, as on a machine with other work, and waits for the
  /// others.
  void end(Call& call) {
    {
      const std::scoped_lock hold(lock_);
      for (Worker* worker : call.workers)
        if (std::uint32_t ticket = call.ticket; worker->asked.compare_exchange_strong(ticket, 0)) {
          worker->call.reset();
          idle_.push_back(worker);
          --call.under_way;
        }
    }
    for (std::size_t left = call.under_way; left > 0; left = call.under_way)
      await_change(call.under_way, left);
  }

 private:
  struct Worker {
    std::shared_ptr<Call> call;
    std::size_t who = 0;
    std::atomic<std::uint32_t> asked = 0;  ///< the ticket of `call` until the work begins
  };

  /// One more idle worker. Signals that end the program are for its own threads.
  bool start() {
    sigset_t others, before;
    sigemptyset(&others);
    for (const int ends : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGXCPU}) sigaddset(&others, ends);
    pthread_sigmask(SIG_BLOCK, &others, &before);
    const std::size_t already = workers_.size();
    try {
      idle_.reserve(already + 1);
      Worker& worker = workers_.emplace_back();
      std::thread([this, &worker] { serve(worker); }).detach();
      idle_.push_back(&worker);
    } catch (const std::system_error&) {
    } catch (const std::bad_alloc&) {
    }
    pthread_sigmask(SIG_SETMASK, &before, nullptr);
    if (idle_.empty() && workers_.size() > already) workers_.pop_back();
    return !idle_.empty();
  }

  [[noreturn]] void serve(Worker& self) {
    for (;;) {
      await_change(self.asked, std::uint32_t{0});
      if (self.asked.exchange(0) == 0) continue;
      const std::shared_ptr<Call> call = std::move(self.call);
      call->labour(self.who);
      {
        const std::scoped_lock hold(lock_);
        idle_.push_back(&self);
      }
      if (--call->under_way == 0) call->under_way.notify_one();
    }
  }

  std::mutex lock_;
  std::uint32_t last_ticket_ = 0;
  std::deque<Worker> workers_;
  std::vector<Worker*> idle_;
};

}  // namespace

std::size_t jobs() {
  const std::size_t count = chosen;
  return count > 0 ? count : usable_cores();
}

void set_jobs(std::size_t count) { chosen = count; }

std::size_t threads() { return most > 1 ? std::min(jobs(), most) : 1; }

ThreadLimit::ThreadLimit(std::size_t count) : before_(std::exchange(most, std::min(most, count))) {}
ThreadLimit::~ThreadLimit() { most = before_; }

/// The calling thread is worker 0 and works too, then waits for the others, so that every piece has ended
/// before anything is thrown.
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
  if (workers > 1) {
    const auto call = std::make_shared<ThreadPool::Call>();
    call->labour = labour;
    ThreadPool::all().begin(call, workers - 1);
    labour(0);
    ThreadPool::all().end(*call);
  } else {
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
