#include "catalogue/plugin/plugin_memory.hpp"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <ctime>
#include <linux/futex.h>
#include <new>
#include <string>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "core/input_error.hpp"

namespace hmax {
namespace {

/// Of the largest pages that Linux has.
constexpr std::size_t guard = 65536;
constexpr std::size_t mapped = guard + (sizeof(PluginPage) + guard - 1) / guard * guard + guard;

std::byte* mapping_of(PluginPage* page) { return reinterpret_cast<std::byte*>(page) - guard; }

void pause_core() {
#if defined(__x86_64__) || defined(__i386__)
  __builtin_ia32_pause();
#elif defined(__aarch64__)
  asm volatile("yield");
#endif
}

}  // namespace

// Both orders are sequential: either the sleeper sees the new number, or the writer sees the sleeper.
void SharedCount::store(std::uint32_t value) {
  value_.store(value);
  if (sleepers_.load() != 0) syscall(SYS_futex, &value_, FUTEX_WAKE, 1, nullptr, nullptr, 0);
}

void SharedCount::sleep_unless(std::uint32_t wanted, std::optional<int> milliseconds) {
  sleepers_.store(1);
  if (const std::uint32_t seen = value_.load(); seen != wanted) {
    const timespec time{.tv_sec = milliseconds.value_or(0) / 1000,
                        .tv_nsec = milliseconds.value_or(0) % 1000 * 1'000'000L};
    syscall(SYS_futex, &value_, FUTEX_WAIT, seen, milliseconds ? &time : nullptr, nullptr, 0);
  }
  sleepers_.store(0);
}

bool Spin::until(const SharedCount& count, std::uint32_t wanted) {
  using Clock = std::chrono::steady_clock;
  constexpr std::chrono::microseconds longest{50};
  constexpr int pauses = 32;  // between two looks at the clock
  if (left_out_ > 0) {
    --left_out_;
    return count.load() == wanted;
  }
  const auto begin = Clock::now();
  do {
    for (int i = 0; i < pauses; ++i) {
      if (count.load() == wanted) {
        next_ = 1;
        return true;
      }
      pause_core();
    }
  } while (Clock::now() - begin < longest);
  left_out_ = next_;
  next_ = std::min(2 * next_, 1024U);
  return false;
}

PluginMemory::PluginMemory() {
  void* memory = mmap(nullptr, mapped, PROT_NONE, MAP_SHARED | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (memory == MAP_FAILED ||
      mprotect(static_cast<std::byte*>(memory) + guard, mapped - 2 * guard, PROT_READ | PROT_WRITE) != 0) {
    const std::string reason = std::strerror(errno);
    if (memory != MAP_FAILED) munmap(memory, mapped);
    throw input_error("the system refuses {} MB of address space for the plugin: {}; raise `ulimit -v`",
                      mapped / 1'000'000, reason);
  }
  page_ = new (static_cast<std::byte*>(memory) + guard) PluginPage;
}

PluginMemory::~PluginMemory() { munmap(mapping_of(page_), mapped); }

void PluginMemory::close_to_further_children() const { madvise(mapping_of(page_), mapped, MADV_DONTFORK); }

}  // namespace hmax
