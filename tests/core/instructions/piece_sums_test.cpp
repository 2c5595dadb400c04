/// Products of vectors in pieces: right, and the same by the threads of blocks.
#include "core/instructions/piece_sums.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace hmax {
namespace {

std::vector<double> numbers(std::int64_t count, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> any;
  std::vector<double> all(static_cast<std::size_t>(count));
  for (double& each : all) each = any(random);
  return all;
}

/// The last thread of a block comes first.
struct Backwards {
  template <class F>
  void each(std::int32_t count, const F& f) const {
    while (count > 0) f(--count);
  }
  void barrier() const {}
};

/// As a device has it: a block for each piece, and one for their sums.
double by_blocks(const std::vector<double>& x, const std::vector<double>& y) {
  const Backwards block;
  const auto count = static_cast<std::int32_t>(x.size());
  std::vector<double> products(piece_size), lanes(piece_size), sums;
  for (std::int32_t first = 0; first < count; first += piece_size) {
    const std::int32_t here = std::min(piece_size, count - first);
    block.each(here, [&](std::int32_t n) {
      const auto at = static_cast<std::size_t>(first) + static_cast<std::size_t>(n);
      products[static_cast<std::size_t>(n)] = x[at] * y[at];
    });
    add_up<lanes_of_a_piece>(block, here, products.data(), lanes.data());
    sums.push_back(lanes[0]);
  }
  add_up<piece_size>(block, static_cast<std::int32_t>(sums.size()), sums.data(), lanes.data());
  return lanes[0];
}

TEST(PieceSums, MultiplyVectorsOfAnyLengthAsBlocksOfThreadsDo) {
  for (const std::int64_t count : {0, 1, 15, 16, 17, 255, 256, 257, 300, 511, 4096, 65536, 65537, 200'003}) {
    const std::vector<double> x = numbers(count, 1), y = numbers(count, 2);
    long double exact = 0, size = 0;
    for (std::size_t i = 0; i < x.size(); ++i)
      exact += static_cast<long double>(x[i]) * y[i], size += std::abs(static_cast<long double>(x[i]) * y[i]);
    const double found = dot_by_pieces(count, x.data(), y.data());
    EXPECT_NEAR(found, static_cast<double>(exact), 1e-14 * static_cast<double>(size)) << count;
    EXPECT_EQ(found, by_blocks(x, y)) << count;
  }
}

}  // namespace
}  // namespace hmax
