#include "core/heap.hpp"

#include <vector>

#include <gtest/gtest.h>

#include "core/peak_memory.hpp"

namespace hmax {
namespace {

constexpr std::size_t numbers = 8 << 20;  // 64 MiB

/// Of a vector that is freed again.
std::int64_t peak_with_a_vector() {
  const std::vector<double> vector(numbers, 1.0);
  return peak_memory().value_or(0);
}

TEST(Heap, WhatIsFreedStaysAndIsGivenBackBeforeMemoryIsMeasured) {
  if (!peak_memory()) GTEST_SKIP() << "no peak of the memory on this system";
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "AddressSanitizer keeps what is freed, to find uses of it";
#endif
  keep_freed_memory();
  reset_peak_memory();
  const std::int64_t before = peak_memory().value();
  constexpr std::int64_t size = numbers * sizeof(double), little = size / 8;
  for (int time = 0; time < 3; ++time) {
    EXPECT_NEAR(static_cast<double>(peak_with_a_vector() - before), size, little);
    reset_peak_memory();
    EXPECT_NEAR(static_cast<double>(peak_memory().value()), static_cast<double>(before), little);
  }
}

}  // namespace
}  // namespace hmax
