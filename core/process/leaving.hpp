/// Leaving the middle of a long step, between two of its iterations, where a person asks for it.
#pragma once

#include <atomic>
#include <cstdlib>

namespace hmax {

namespace detail {
inline const std::atomic<bool> never{false};
inline std::atomic<const std::atomic<bool>*> leaving_flag{&never};
inline std::atomic<void (*)()> throwing{nullptr};
/// Loops know that what they keep in registers stays there.
[[noreturn, gnu::cold, gnu::noinline]] inline void leave() {
  throwing.load()();
  std::abort();
}
}  // namespace detail

/// While it lives, leave_when_asked() throws as soon as the flag is set, in every thread; it outlives the
/// work. One within another holds for its own time.
class LeavesIterations {
 public:
  /// @param flag      outlives this
  /// @param throwing  throws
  LeavesIterations(const std::atomic<bool>& flag, void (*throwing)())
      : throwing_(detail::throwing.exchange(throwing)), flag_(detail::leaving_flag.exchange(&flag)) {}
  ~LeavesIterations() {
    detail::leaving_flag = flag_;
    detail::throwing = throwing_;
  }
  LeavesIterations(const LeavesIterations&) = delete;
  LeavesIterations& operator=(const LeavesIterations&) = delete;

 private:
  void (*throwing_)();
  const std::atomic<bool>* flag_;
};

/// Called once by each iteration whose number a user may choose, and before equations are solved that are
/// many: two loads, which cost a hundredth of a Newton iteration of an oscillator, so that those do not call
/// it.
inline void leave_when_asked() {
  if (detail::leaving_flag.load(std::memory_order_acquire)->load(std::memory_order_relaxed)) [[unlikely]]
    detail::leave();
}

}  // namespace hmax
