#include "core/process/heap.hpp"

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <unistd.h>
#include <vector>

#include <gtest/gtest.h>

#include "core/process/peak_memory.hpp"

namespace hmax {
namespace {

constexpr std::int64_t size = 64 << 20, little = size / 8;

/// Resident memory [bytes].
std::int64_t memory() {
  std::int64_t whole = 0, resident = 0;
  std::ifstream("/proc/self/statm") >> whole >> resident;
  return resident * sysconf(_SC_PAGESIZE);
}

/// Uses so much memory and frees it.
void use() { const std::vector<char> vector(size, 1); }

/// What the heap has beyond a block at its end.
std::int64_t room() {
  void* const volatile last = std::malloc(size);
  const std::int64_t left = static_cast<char*>(sbrk(0)) - static_cast<char*>(last);
  std::free(last);
  return left;
}

class Heap : public testing::Test {
 protected:
  void SetUp() override {
    if (!peak_memory()) GTEST_SKIP() << "no peak of the memory on this system";
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    GTEST_SKIP() << "AddressSanitizer keeps what is freed, to find uses of it";
#endif
    keep_freed_memory();
    reset_peak_memory();
  }
};

TEST_F(Heap, KeepsWhatIsFreedUntilItIsReturned) {
  for (int time = 0; time < 3; ++time) {
    const std::int64_t before = memory();
    use();
    EXPECT_NEAR(static_cast<double>(memory() - before), size, little);
    EXPECT_NEAR(static_cast<double>(peak_memory().value() - before), size, little);
    reset_peak_memory();
    EXPECT_NEAR(static_cast<double>(memory() - before), 0, little);
    EXPECT_NEAR(static_cast<double>(peak_memory().value() - before), 0, little);
  }
}

TEST_F(Heap, GrowsInOneStrideAlsoWhereItHasAHole) {
  auto* hole = new std::vector<char>(size, 1);
  const std::vector<char> beyond(1 << 20, 1);
  delete hole;
  return_freed_memory();
  EXPECT_GT(room(), 8 * size);
}

TEST_F(Heap, ReturnsLargeBlocksAtOnce) {
  for (const std::size_t bytes : {least_own_pages / 2, 2 * least_own_pages}) {
    reset_peak_memory();  // nothing is left to be returned
    const std::int64_t before = memory();
    void* const block = allocate_block(bytes);
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(block) % 64, 0U);
    std::memset(block, 1, bytes);
    EXPECT_NEAR(static_cast<double>(memory() - before), static_cast<double>(bytes), little);
    free_block(block, bytes);
    const double left = bytes < least_own_pages ? static_cast<double>(bytes) : 0;
    EXPECT_NEAR(static_cast<double>(memory() - before), left, little);
  }
}

}  // namespace
}  // namespace hmax
