/// The loops of kernels.hpp for any register.
///
/// Each instruction set includes this in a source of its own with a type `Lanes` of an unnamed namespace, so
/// that no code compiled for one set can be linked in the place of another. For the same reason nothing of
/// the standard library is used here. `Lanes` has
///   width                    doubles in a register; divides 8
///   V, load(p), splat(s)     a register, from aligned memory, from one number
///   root(v)                  square root
///   Rows                     `width` rows of four numbers
///   rows(x, points)          those of points
///   minus(a, b), plus(a, b)  by entries
///   columns(rows, v)         to three registers x, y, z
///   back(x, y, z)            and from them, the fourth entry 0
///   row(rows, lane)          one row, a type Row
///   add(p, row), subtract(p, row)  to four numbers in memory, aligned
#pragma once

#include "problems/tissue/kernels.hpp"

namespace hmax::kernel_loops {

/// Entry (i, j) of a symmetric matrix stored as 00 11 22 01 02 12.
constexpr int symmetric[3][3] = {{0, 3, 4}, {3, 1, 5}, {4, 5, 2}};

/// Ds = (x1 - x0, x2 - x0, x3 - x0) of some lanes, column a at D[3 a].
template <class Lanes>
inline void edges(const TetBlock& block, std::size_t lane, const double* x, typename Lanes::V (&D)[9]) {
  const typename Lanes::Rows origin = Lanes::rows(x, block.points[0] + lane);
  for (int a = 0; a < 3; ++a)
    Lanes::columns(Lanes::minus(Lanes::rows(x, block.points[a + 1] + lane), origin), D + 3 * a);
}

/// N = G K - I with G = Ds^T Ds, similar to twice Green's strain, and its trace.
template <class Lanes, class V>
inline V gram_strain(const V (&D)[9], const V (&K)[6], V (&N)[3][3]) {
  V G[6];
  const auto dot = [&](int a, int b) {
    return D[3 * a] * D[3 * b] + D[3 * a + 1] * D[3 * b + 1] + D[3 * a + 2] * D[3 * b + 2];
  };
  G[0] = dot(0, 0), G[1] = dot(1, 1), G[2] = dot(2, 2);
  G[3] = dot(0, 1), G[4] = dot(0, 2), G[5] = dot(1, 2);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      N[i][j] = G[symmetric[i][0]] * K[symmetric[0][j]] + G[symmetric[i][1]] * K[symmetric[1][j]] +
                G[symmetric[i][2]] * K[symmetric[2][j]];
  for (int i = 0; i < 3; ++i) N[i][i] -= Lanes::splat(1);
  return N[0][0] + N[1][1] + N[2][2];
}

template <class Lanes>
void green_force(const TetBlock* blocks, std::size_t count, const double* x, double* f) {
  using V = typename Lanes::V;
  for (std::size_t n = 0; n < count; ++n)
    for (std::size_t lane = 0; lane < TetBlock::lanes; lane += Lanes::width) {
      const TetBlock& block = blocks[n];
      V D[9], K[6], N[3][3], T[6], H[9];
      edges<Lanes>(block, lane, x, D);
      for (int i = 0; i < 6; ++i) K[i] = Lanes::load(block.gram[i] + lane);
      const V mu = Lanes::load(block.mu + lane);
      const V c = Lanes::load(block.half_lambda + lane) * gram_strain<Lanes>(D, K, N);
      // T = c K + V mu K N.
      const auto product = [&](int i, int j) {
        return K[symmetric[i][0]] * N[0][j] + K[symmetric[i][1]] * N[1][j] + K[symmetric[i][2]] * N[2][j];
      };
      for (int i = 0; i < 3; ++i)
        for (int j = i; j < 3; ++j) T[symmetric[i][j]] = c * K[symmetric[i][j]] + mu * product(i, j);
      for (int a = 0; a < 3; ++a)
        for (int r = 0; r < 3; ++r)
          H[3 * a + r] =
              D[r] * T[symmetric[0][a]] + D[3 + r] * T[symmetric[1][a]] + D[6 + r] * T[symmetric[2][a]];

      const typename Lanes::Rows pull1 = Lanes::back(H[0], H[1], H[2]), pull2 = Lanes::back(H[3], H[4], H[5]),
                                 pull3 = Lanes::back(H[6], H[7], H[8]);
      const typename Lanes::Rows all = Lanes::plus(Lanes::plus(pull1, pull2), pull3);
      for (std::size_t i = 0; i < Lanes::width; ++i) {
        Lanes::subtract(f + 4 * block.points[1][lane + i], Lanes::row(pull1, i));
        Lanes::subtract(f + 4 * block.points[2][lane + i], Lanes::row(pull2, i));
        Lanes::subtract(f + 4 * block.points[3][lane + i], Lanes::row(pull3, i));
        Lanes::add(f + 4 * block.points[0][lane + i], Lanes::row(all, i));
      }
    }
}

/// Adds the blocks of one pair of corners, column j at entries + 3 j.
template <class Lanes>
inline void scatter_block(const TetSlots& slots, int pair, std::size_t lane, const typename Lanes::V* entries,
                          double* pairs) {
  const typename Lanes::Rows columns[3] = {Lanes::back(entries[0], entries[1], entries[2]),
                                           Lanes::back(entries[3], entries[4], entries[5]),
                                           Lanes::back(entries[6], entries[7], entries[8])};
  for (std::size_t i = 0; i < Lanes::width; ++i) {
    double* const to = pairs + 12 * static_cast<std::ptrdiff_t>(slots.block[pair][lane + i]);
    Lanes::add(to, Lanes::row(columns[0], i));
    Lanes::add(to + 4, Lanes::row(columns[1], i));
    Lanes::add(to + 8, Lanes::row(columns[2], i));
  }
}

template <class Lanes>
void green_stiffness(const TetBlock* blocks, const TetSlots* slots, std::size_t count, const double* x,
                     double* pairs) {
  using V = typename Lanes::V;
  for (std::size_t n = 0; n < count; ++n)
    for (std::size_t lane = 0; lane < TetBlock::lanes; lane += Lanes::width) {
      const TetBlock& block = blocks[n];
      V D[9], K[6], h[9], B[6];
      edges<Lanes>(block, lane, x, D);
      for (int i = 0; i < 6; ++i) K[i] = Lanes::load(block.gram[i] + lane);
      const V mu = Lanes::load(block.mu + lane), half = Lanes::load(block.half_lambda + lane),
              lambda = half + half;
      for (int a = 0; a < 3; ++a)
        for (int r = 0; r < 3; ++r)
          h[3 * a + r] =
              D[r] * K[symmetric[0][a]] + D[3 + r] * K[symmetric[1][a]] + D[6 + r] * K[symmetric[2][a]];
      for (int i = 0; i < 3; ++i)
        for (int j = i; j < 3; ++j)
          B[symmetric[i][j]] = h[i] * D[j] + h[3 + i] * D[3 + j] + h[6 + i] * D[6 + j];
      const V c = half * (B[0] + B[1] + B[2] - Lanes::splat(3)) - mu;
      for (int i = 0; i < 6; ++i) B[i] *= mu;
      V lh[9], mh[9], s[6];
      for (int i = 0; i < 9; ++i) lh[i] = lambda * h[i], mh[i] = mu * h[i];
      for (int a = 0; a < 3; ++a)
        for (int b = a; b < 3; ++b)
          s[symmetric[a][b]] = c * K[symmetric[a][b]] + (mh[3 * a] * h[3 * b] + mh[3 * a + 1] * h[3 * b + 1] +
                                                         mh[3 * a + 2] * h[3 * b + 2]);

      // Entry (i, j) of block (b, a): lambda h_b[i] h_a[j] + mu h_a[i] h_b[j] + mu K_ab B_ij + s_ab e_ij. The
      // block of b and the first corner is minus the sum over a, to which (a, b) is the transposed of (b, a).
      V sum[3][9];
      for (int a = 0; a < 3; ++a)
        for (int i = 0; i < 3; ++i)
          for (int j = i; j < 3; ++j) {
            V entry = (lh[3 * a + i] + mh[3 * a + i]) * h[3 * a + j] + K[a] * B[symmetric[i][j]];
            if (i == j) entry += s[a];
            sum[a][3 * i + j] = sum[a][3 * j + i] = -entry;
          }
      for (int a = 0, pair = 3; a < 3; ++a)
        for (int b = a + 1; b < 3; ++b, ++pair) {
          const V k = K[symmetric[a][b]];
          V block_ba[9];
          for (int j = 0; j < 3; ++j)
            for (int i = 0; i < 3; ++i) {
              V entry = lh[3 * b + i] * h[3 * a + j] + mh[3 * a + i] * h[3 * b + j] + k * B[symmetric[i][j]];
              if (i == j) entry += s[symmetric[a][b]];
              block_ba[3 * j + i] = entry;
              sum[b][3 * j + i] -= entry;
              sum[a][3 * i + j] -= entry;
            }
          scatter_block<Lanes>(slots[n], pair, lane, block_ba, pairs);
        }
      for (int b = 0; b < 3; ++b) scatter_block<Lanes>(slots[n], b, lane, sum[b], pairs);
    }
}

template <class Lanes>
void spring_force(const SpringBlock* blocks, std::size_t count, double b, const double* x, double* f) {
  using V = typename Lanes::V;
  const V one = Lanes::splat(1), cubic = Lanes::splat(b);
  for (std::size_t n = 0; n < count; ++n)
    for (std::size_t lane = 0; lane < SpringBlock::lanes; lane += Lanes::width) {
      const SpringBlock& block = blocks[n];
      V d[3];
      Lanes::columns(
          Lanes::minus(Lanes::rows(x, block.points[1] + lane), Lanes::rows(x, block.points[0] + lane)), d);
      // T / l = k L (s + b s^3) / l with s = l / L - 1. Points that coincide have d = 0 and meet no force.
      const V now = Lanes::root(d[0] * d[0] + d[1] * d[1] + d[2] * d[2] + Lanes::splat(1e-300));
      const V s = now * Lanes::load(block.per_length + lane) - one;
      const V pull = Lanes::load(block.tension + lane) * s * (one + cubic * (s * s)) / now;
      const typename Lanes::Rows rows = Lanes::back(pull * d[0], pull * d[1], pull * d[2]);
      for (std::size_t i = 0; i < Lanes::width; ++i) {
        Lanes::add(f + 4 * block.points[0][lane + i], Lanes::row(rows, i));
        Lanes::subtract(f + 4 * block.points[1][lane + i], Lanes::row(rows, i));
      }
    }
}

/// The table of one instruction set.
template <class Lanes>
constexpr TissueKernels kernels_of(const char* name) {
  return {name, Lanes::width, green_force<Lanes>, green_stiffness<Lanes>, spring_force<Lanes>};
}

}  // namespace hmax::kernel_loops
