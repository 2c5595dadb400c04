/// The loops of kernels.hpp for any register.
///
/// Each instruction set includes this in a source of its own with a type `Lanes` of an unnamed namespace, so
/// that no code compiled for one set can be linked in the place of another. For the same reason nothing of
/// the standard library is used here. `Lanes` has
///   width                    doubles in a register; divides 8
///   V, load(p), splat(s)     a register, from aligned memory, from one number
///   root(v)                  square root
///   any(mask)                whether a comparison of registers holds in a lane
///   Rows                     `width` rows of four numbers
///   rows(x, from)            those that begin at x + from[i]
///   minus(a, b), plus(a, b)  by entries
///   columns(rows, v)         to three registers x, y, z
///   back(x, y, z)            and from them, the fourth entry 0
///   row(rows, lane)          one row, a type Row
///   add(p, row), subtract(p, row)  to four numbers in memory, aligned
#pragma once

#include "problems/tissue/forces/kernels/element_pull.hpp"
#include "problems/tissue/forces/kernels/element_stiffness.hpp"
#include "problems/tissue/forces/kernels/kernels.hpp"

namespace hmax::kernel_loops {

/// Asks for a block before it is needed: they are read once, faster than the processor foresees. GCC 12 drops
/// calls of functions that only do that, unless it must inline them.
template <class Lanes>
[[gnu::always_inline]] inline void fetch_ahead(const TetBlock* blocks, std::size_t n, std::size_t count) {
  constexpr std::size_t ahead = 4, line = 64;
  if (n + ahead >= count) return;
  const char* const next = reinterpret_cast<const char*>(blocks + n + ahead);
  for (std::size_t i = 0; i < sizeof(TetBlock); i += line) __builtin_prefetch(next + i);
}

/// U = (u1 - u0, u2 - u0, u3 - u0) of some lanes, column a at U[a], and Bm, row a at g[a].
template <class Lanes, class V>
inline void load_element(const TetBlock& block, std::size_t lane, const double* u, V (*U)[3], V (*g)[3]) {
  const typename Lanes::Rows origin = Lanes::rows(u, block.rows[0] + lane);
  for (int a = 0; a < 3; ++a) {
    Lanes::columns(Lanes::minus(Lanes::rows(u, block.rows[a + 1] + lane), origin), U[a]);
    for (int j = 0; j < 3; ++j) g[a][j] = Lanes::load(block.gradients[3 * a + j] + lane);
  }
}

template <class Lanes, TetLaw law>
void force(const TetBlock* blocks, std::size_t count, const double* u, double* f) {
  using V = typename Lanes::V;
  for (std::size_t n = 0; n < count; ++n) {
    fetch_ahead<Lanes>(blocks, n, count);
    for (std::size_t lane = 0; lane < TetBlock::lanes; lane += Lanes::width) {
      const TetBlock& block = blocks[n];
      V U[3][3], g[3][3], pull[3][3];
      load_element<Lanes>(block, lane, u, U, g);
      tet_pull<Lanes, law>(U, g, block.half_lambda + lane, block.mu + lane, pull);

      const typename Lanes::Rows pull1 = Lanes::back(pull[0][0], pull[0][1], pull[0][2]),
                                 pull2 = Lanes::back(pull[1][0], pull[1][1], pull[1][2]),
                                 pull3 = Lanes::back(pull[2][0], pull[2][1], pull[2][2]);
      const typename Lanes::Rows all = Lanes::plus(Lanes::plus(pull1, pull2), pull3);
#pragma GCC unroll 8
      for (std::size_t i = 0; i < Lanes::width; ++i) {
        Lanes::subtract(f + block.rows[1][lane + i], Lanes::row(pull1, i));
        Lanes::subtract(f + block.rows[2][lane + i], Lanes::row(pull2, i));
        Lanes::subtract(f + block.rows[3][lane + i], Lanes::row(pull3, i));
        Lanes::add(f + block.rows[0][lane + i], Lanes::row(all, i));
      }
    }
  }
}

/// Adds the blocks of one pair of corners, column j at entries[j].
template <class Lanes>
inline void scatter_block(const TetSlots& slots, int pair, std::size_t lane,
                          const typename Lanes::V (*entries)[3], double* pairs) {
  const typename Lanes::Rows columns[3] = {Lanes::back(entries[0][0], entries[0][1], entries[0][2]),
                                           Lanes::back(entries[1][0], entries[1][1], entries[1][2]),
                                           Lanes::back(entries[2][0], entries[2][1], entries[2][2])};
#pragma GCC unroll 8
  for (std::size_t i = 0; i < Lanes::width; ++i) {
    double* const to = pairs + 12 * static_cast<std::ptrdiff_t>(slots.block[pair][lane + i]);
    Lanes::add(to, Lanes::row(columns[0], i));
    Lanes::add(to + 4, Lanes::row(columns[1], i));
    Lanes::add(to + 8, Lanes::row(columns[2], i));
  }
}

template <class Lanes>
void green_stiffness(const TetBlock* blocks, const TetSlots* slots, std::size_t count, const double* u,
                     double* pairs) {
  using V = typename Lanes::V;
  constexpr std::size_t lanes = TetBlock::lanes, width = Lanes::width;
  for (std::size_t n = 0; n < count; ++n) {
    fetch_ahead<Lanes>(blocks, n, count);
    StiffnessParts<Lanes> parts[lanes / width];
    for (std::size_t lane = 0; lane < lanes; lane += width) {
      V U[3][3];
      StiffnessParts<Lanes>& own = parts[lane / width];
      load_element<Lanes>(blocks[n], lane, u, U, own.g + 1);
      stiffness_parts<Lanes, V>(U, Lanes::load(blocks[n].half_lambda + lane),
                                Lanes::load(blocks[n].mu + lane), own);
    }
    // Pair after pair, so that the order of the sums is the same for every width.
    for (int a = 0, pair = 0; a < 3; ++a)
      for (int b = a + 1; b < 4; ++b, ++pair)
        for (std::size_t lane = 0; lane < lanes; lane += width) {
          V entries[3][3];
          pair_stiffness<Lanes>(parts[lane / width], a, b, entries);
          scatter_block<Lanes>(slots[n], pair, lane, entries, pairs);
        }
  }
}

template <class Lanes, bool cubic>
void spring_slices(const SpringSlice* slices, std::size_t count, const SpringBlock* blocks,
                   const SpringEnds* ends, double coefficient, const double* x, double* f) {
  using V = typename Lanes::V;
  constexpr std::size_t width = Lanes::width, parts = SpringSlice::lanes / width;
  const V b = Lanes::splat(coefficient);
  for (const SpringSlice* slice = slices; slice != slices + count; ++slice) {
    V near[parts][3], sum[parts][3];
    for (std::size_t part = 0; part < parts; ++part) {
      Lanes::columns(Lanes::rows(x, slice->rows + part * width), near[part]);
      for (int i = 0; i < 3; ++i) sum[part][i] = Lanes::splat(0);
    }
    // All lanes of a block before the next, so that the order of the sums is the same for every width.
    for (std::int32_t k = slice->begin; k < slice->end; ++k)
      for (std::size_t part = 0; part < parts; ++part) {
        V d[3];
        Lanes::columns(Lanes::rows(x, ends[k].rows + part * width), d);
        for (int i = 0; i < 3; ++i) d[i] -= near[part][i];
        const V pull = spring_pull<Lanes, cubic>(blocks[k].per_length + part * width,
                                                 blocks[k].tension + part * width, b, d);
        for (int i = 0; i < 3; ++i) d[i] *= pull, sum[part][i] += d[i];
        const typename Lanes::Rows rows = Lanes::back(d[0], d[1], d[2]);
#pragma GCC unroll 8
        for (std::size_t i = 0; i < width; ++i)
          Lanes::subtract(f + ends[k].rows[part * width + i], Lanes::row(rows, i));
      }
    for (std::size_t part = 0; part < parts; ++part) {
      const typename Lanes::Rows rows = Lanes::back(sum[part][0], sum[part][1], sum[part][2]);
#pragma GCC unroll 8
      for (std::size_t i = 0; i < width; ++i)
        Lanes::add(f + slice->rows[part * width + i], Lanes::row(rows, i));
    }
  }
}

/// The time of a spring is that from its root to its last sum, over the springs that the processor holds at
/// once: linear ones leave out what they do not need.
template <class Lanes>
void spring_force(const SpringSlice* slices, std::size_t count, const SpringBlock* blocks,
                  const SpringEnds* ends, double b, const double* x, double* f) {
  (b == 0 ? spring_slices<Lanes, false> : spring_slices<Lanes, true>)(slices, count, blocks, ends, b, x, f);
}

/// The table of one instruction set.
template <class Lanes>
constexpr TissueKernels kernels_of(const char* name) {
  return {name,
          Lanes::width,
          {force<Lanes, TetLaw::green>, force<Lanes, TetLaw::small_strain>, force<Lanes, TetLaw::neo_hookean>,
           force<Lanes, TetLaw::corotational>},
          green_stiffness<Lanes>,
          spring_force<Lanes>};
}

}  // namespace hmax::kernel_loops
