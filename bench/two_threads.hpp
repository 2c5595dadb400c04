/// Independent pieces of work, shared by two threads.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <exception>
#include <functional>
#include <system_error>
#include <thread>

namespace hmax {

/// work(i, worker) for i = 0 .. count - 1, begun in this order, none after interrupted() has become true;
/// worker is 0 or 1, so that each may have what two must not share, such as users' formulas. What one of them
/// throws is thrown when both have ended. Where the system allows no second thread, or has no memory for its
/// stack, the calling thread does all of it. Not for anything that is timed.
/// @param progress  called by the calling thread with the number of pieces that are done
inline void in_two_threads(std::size_t count,
                           const std::function<void(std::size_t i, std::size_t worker)>& work,
                           const std::function<void(std::size_t)>& progress,
                           const std::function<bool()>& interrupted) {
  std::atomic<std::size_t> next = 0, done = 0;
  std::array<std::exception_ptr, 2> failures;
  const auto labour = [&](std::size_t who) {
    try {
      for (std::size_t i = next++; i < count && !interrupted(); i = next++) {
        work(i, who);
        ++done;
        if (who == 0) progress(done);
      }
    } catch (...) {
      failures[who] = std::current_exception();
      next = count;
    }
  };
  {
    std::jthread second;
    try {
      second = std::jthread([&] { labour(1); });
    } catch (const std::system_error&) {
    }
    labour(0);
  }
  for (const std::exception_ptr& failure : failures)
    if (failure) std::rethrow_exception(failure);
}

}  // namespace hmax
