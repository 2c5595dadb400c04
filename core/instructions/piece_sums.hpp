/// Sums of many numbers in an order that the threads of a device can take as well: in pieces.
#pragma once

#include <cstdint>

#include "core/instructions/device_code.hpp"

namespace hmax {

/// Numbers of a piece, and the partial sums that it is added up in.
inline constexpr std::int32_t piece_size = 256, lanes_of_a_piece = 16;

/// s[0] = the sum of s[0] .. s[2 half - 1], the upper half added to the lower one until one number is left.
/// @param block  see device_program.hpp of catalogue/device
template <std::int32_t half, class Block, class Real>
HMAX_DEVICE inline void add_halves(const Block& block, Real* s) {
  block.each(half, [&](std::int32_t n) { s[n] = s[n] + s[n + half]; });
  block.barrier();
  if constexpr (half > 1) add_halves<half / 2>(block, s);
}

/// s[0] = x[0] + x[1] + ... + x[count - 1]: s[n] adds up x[n], x[n + lanes], ..., then halves.
/// @param s  shape (lanes)
template <std::int32_t lanes, class Block, class Real>
HMAX_DEVICE inline void add_up(const Block& block, std::int32_t count, const Real* x, Real* s) {
  block.each(lanes, [&](std::int32_t n) {
    Real sum = 0;
    for (std::int32_t m = n; m < count; m += lanes) sum = sum + x[m];
    s[n] = sum;
  });
  block.barrier();
  add_halves<lanes / 2>(block, s);
}

/// A block of one thread.
struct LoneThread {
  template <class F>
  HMAX_DEVICE void each(std::int32_t count, const F& f) const {
    for (std::int32_t n = 0; n < count; ++n) f(n);
  }
  HMAX_DEVICE void barrier() const {}
};

/// x.y, shape (count), on one thread: of each piece the sum by add_up() of its lanes, and of these sums that
/// of `piece_size` lanes.
inline double dot_by_pieces(std::int64_t count, const double* x, const double* y) {
  double sums[piece_size] = {};
  for (std::int64_t first = 0, n = 0; first < count; first += piece_size, ++n) {
    double s[lanes_of_a_piece] = {};
    std::int64_t m = first;
    for (const std::int64_t end = first + piece_size < count ? first + piece_size
                                                             : count - lanes_of_a_piece + 1;
         m < end; m += lanes_of_a_piece)
      for (std::int32_t lane = 0; lane < lanes_of_a_piece; ++lane) s[lane] += x[m + lane] * y[m + lane];
    for (std::int32_t lane = 0; m < count && m < first + piece_size; ++m, ++lane) s[lane] += x[m] * y[m];
    add_halves<lanes_of_a_piece / 2>(LoneThread{}, s);
    sums[n % piece_size] += s[0];
  }
  if (count > piece_size) add_halves<piece_size / 2>(LoneThread{}, sums);
  return sums[0];
}

}  // namespace hmax
