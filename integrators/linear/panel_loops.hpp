/// The loops of panel_kernels.hpp for any register.
///
/// Each instruction set includes this in a source of its own with a type `Lanes` of an unnamed namespace, so
/// that no code compiled for one set can be linked in the place of another. For the same reason nothing of
/// the standard library is used here. `Lanes` has
///   Scalar, V, width      numbers, a register of them and how many it holds, which divides 8
///   columns, vectors      of the tiles that are kept in registers; columns is a multiple of width, divides 8
///   load(p), store(p, v)  from and to aligned memory
#pragma once

#include "integrators/linear/panel_kernels.hpp"

namespace hmax::panel_loops {

/// Signed, as lengths and differences of addresses are.
using Index = std::ptrdiff_t;

/// So many columns are subtracted from a tile before it is written back, and so many rows of them serve all
/// tiles beside one another: both stay in the caches. A block of A of this shape has 256 KiB in doubles, the
/// factors of one tile at most 8 KiB.
inline constexpr Index depth = PanelShape::block, rows_at_once = PanelShape::rows_at_once;

/// A number as a type, so that loops over it are unrolled.
template <int N>
struct Count {
  static constexpr int value = N;
};

/// f(Count<n>) for an n from 1 to N known at run time; a larger one counts as N, of which the caller takes
/// one group after another.
template <int N, class F>
inline void with_count(Index n, const F& f) {
  if constexpr (N > 1) {
    if (n < N) return with_count<N - 1>(n, f);
  }
  f(Count<N>{});
}

/// factors(q, c) = d_q S(c, q) for k columns of S, each NC side by side.
/// @param S  its first row that counts, columns lds apart;  @param d  (k);  @param factors  (NC, k)
template <class Lanes, int NC, class Scalar>
inline void scale(const Scalar* S, Index lds, const Scalar* d, Index k, Scalar* factors) {
  for (Index q = 0; q < k; ++q)
    for (int c = 0; c < NC; ++c) factors[q * NC + c] = d[q] * S[q * lds + c];
}

/// What finishes NC columns of L below their diagonal block: 1 / d_p, and d_p L(c, p) for p < c < NC. The
/// reciprocals make one division a column of what would be one a number.
template <int NC, class Scalar>
struct DiagonalBlock {
  Scalar inverse[NC], factor[NC][NC];
};

/// No diagonal block: the tile is left unfinished.
struct Nothing {};

/// A tile of NV registers of rows and NC columns, in registers: C <- C - A factors, or -A factors where it
/// overwrites. With a diagonal block it is finished, L = C (D L_T^T)^-1 column by column.
/// @param C  first number of the tile, columns ldc apart;  @param A  k columns, lda apart
/// @param factors  shape (NC, k), those of one column of A side by side
template <class Lanes, int NC, int NV, bool overwrites, class Block, class Scalar>
inline void tile(Scalar* C, Index ldc, const Scalar* A, Index lda, const Scalar* factors, Index k,
                 const Block& block) {
  using V = typename Lanes::V;
  constexpr Index W = Lanes::width;
  // C, or zero
  V sum[NC][NV];
#pragma GCC unroll 8
  for (int c = 0; c < NC; ++c)
#pragma GCC unroll 4
    for (int v = 0; v < NV; ++v) {
      if constexpr (overwrites)
        sum[c][v] = V{};
      else
        sum[c][v] = Lanes::load(C + c * ldc + v * W);
    }
  // Columns of A outside, so that each number of A is loaded once and the sums never leave the registers.
  // Every sum takes its terms in the order of q, whatever the width: so bits are the same.
  for (Index q = 0; q < k; ++q, A += lda, factors += NC) {
    V column[NV];
#pragma GCC unroll 4
    for (int v = 0; v < NV; ++v) column[v] = Lanes::load(A + v * W);
#pragma GCC unroll 8
    for (int c = 0; c < NC; ++c)
#pragma GCC unroll 4
      for (int v = 0; v < NV; ++v) sum[c][v] -= column[v] * factors[c];
  }
  // c_p /= d_p, then c_c -= c_p d_p L(c, p) for the columns c > p.
  if constexpr (requires { block.inverse; }) {
#pragma GCC unroll 8
    for (int p = 0; p < NC; ++p)
#pragma GCC unroll 4
      for (int v = 0; v < NV; ++v) {
        sum[p][v] *= block.inverse[p];
#pragma GCC unroll 8
        for (int c = p + 1; c < NC; ++c) sum[c][v] -= sum[p][v] * block.factor[c][p];
      }
  }
#pragma GCC unroll 8
  for (int c = 0; c < NC; ++c)
#pragma GCC unroll 4
    for (int v = 0; v < NV; ++v) Lanes::store(C + c * ldc + v * W, sum[c][v]);
}

/// The same for all rows from `from` to `to`, multiples of the width; what is left of them by single
/// registers. Rows are counted in C and A alike, from the addresses given.
/// @param k  columns of A;  @param block  DiagonalBlock, or Nothing
template <class Lanes, int NC, bool overwrites, class Block, class Scalar>
inline void tiles(Index from, Index to, Scalar* C, Index ldc, const Scalar* A, Index lda,
                  const Scalar* factors, Index k, const Block& block) {
  constexpr int NV = Lanes::vectors;
  Index r = from;
  for (; r + NV * Lanes::width <= to; r += NV * Lanes::width)
    tile<Lanes, NC, NV, overwrites>(C + r, ldc, A + r, lda, factors, k, block);
  for (; r < to; r += Lanes::width) tile<Lanes, NC, 1, overwrites>(C + r, ldc, A + r, lda, factors, k, block);
}

/// C <- C - A diag(d) S^T, or without C where it is overwritten, shape (rows, columns) with k columns of A.
/// Blocks of depth columns and rows_at_once rows stay in the caches.
/// @param rows   a multiple of 8, with padding;  @param S  shape (columns, k), columns lds apart
/// @param lower  what stands above the diagonal is of no use
template <class Lanes, class Scalar>
inline void subtract_product(Scalar* C, Index ldc, Index rows, Index columns, const Scalar* A, Index lda,
                             const Scalar* S, Index lds, const Scalar* d, Index k, bool lower,
                             bool overwrites) {
  // d_q S(c, q) of one block of columns
  Scalar factors[depth * Lanes::columns];
  // After the first block of columns C is no longer overwritten.
  for (Index q = 0; q < k; q += depth, overwrites = false) {
    // Columns q, ..., q + deep - 1 of A and S.
    const Index deep = k - q < depth ? k - q : depth;
    // Rows outside of columns: the block of A is read for every tile of columns, the factors are made again
    // for each block of rows, which costs one multiplication for 256 in the tiles.
    for (Index top = 0; top < rows; top += rows_at_once) {
      const Index bottom = rows - top < rows_at_once ? rows : top + rows_at_once;
      for (Index c = 0; c < columns; c += Lanes::columns) {
        // The rest stands above the diagonal.
        if (lower && c >= bottom) break;
        with_count<Lanes::columns>(columns - c, [&]<int NC>(Count<NC>) {
          scale<Lanes, NC>(S + q * lds + c, lds, d + q, deep, factors);
          // c is a multiple of the width: the tile begins at the diagonal.
          const Index from = lower && c > top ? c : top;
          if (overwrites)
            tiles<Lanes, NC, true>(from, bottom, C + c * ldc, ldc, A + q * lda, lda, factors, deep,
                                   Nothing{});
          else
            tiles<Lanes, NC, false>(from, bottom, C + c * ldc, ldc, A + q * lda, lda, factors, deep,
                                    Nothing{});
        });
      }
    }
  }
}

/// L D L^T of the NC columns of a diagonal block, in place:
///   d_p = T(p, p),   L(r, p) = T(r, p) / d_p,   T(r, c) -= L(r, p) d_p L(c, p).
/// A pivot of zero is divided by all the same: infinity or NaN spreads, and who asked for the factors looks
/// at d.
/// @param T  the first number of the block, columns ldt apart;  @param d  shape (NC), written
template <class Lanes, int NC, class Scalar>
inline void factor_diagonal(Scalar* T, Index ldt, Scalar* d, DiagonalBlock<NC, Scalar>& block) {
  for (int p = 0; p < NC; ++p) {
    d[p] = T[p * ldt + p];
    block.inverse[p] = Scalar(1) / d[p];
    for (int r = p + 1; r < NC; ++r) {
      T[p * ldt + r] *= block.inverse[p];
      block.factor[r][p] = d[p] * T[p * ldt + r];
    }
    for (int c = p + 1; c < NC; ++c)
      for (int r = c; r < NC; ++r) T[c * ldt + r] -= T[p * ldt + r] * block.factor[c][p];
  }
}

/// The same block once it is factored, for the rows below it.
template <int NC, class Scalar>
inline void read_diagonal(const Scalar* T, Index ldt, const Scalar* d, DiagonalBlock<NC, Scalar>& block) {
  for (int p = 0; p < NC; ++p) {
    block.inverse[p] = Scalar(1) / d[p];
    for (int r = p + 1; r < NC; ++r) block.factor[r][p] = d[p] * T[p * ldt + r];
  }
}

/// PanelKernels::diagonal, a few columns at a time: they take what the columns before them subtract, and are
/// factored.
template <class Lanes>
void diagonal(typename Lanes::Scalar* T, Index w, Index s, typename Lanes::Scalar* d) {
  using Scalar = typename Lanes::Scalar;
  constexpr Index NB = Lanes::columns;
  const Index ldt = PanelShape::padded(w), n = PanelShape::block_at(s, w), rows = PanelShape::padded(n);
  Scalar* const own = T + s * ldt + s;
  subtract_product<Lanes>(own, ldt, rows, n, T + s, ldt, T + s, ldt, d, s, true, false);
  Scalar factors[depth * Lanes::columns];
  for (Index j = 0; j < n; j += NB)
    with_count<Lanes::columns>(n - j, [&]<int NC>(Count<NC>) {
      DiagonalBlock<NC, Scalar> block{};
      Scalar* const C = own + j * ldt;
      scale<Lanes, NC>(own + j, ldt, d + s, j, factors);
      // (NB rows also where the last group has fewer columns: the others are padding)
      tiles<Lanes, NC, false>(j, j + NB, C, ldt, own, ldt, factors, j, Nothing{});
      factor_diagonal<Lanes, NC>(C + j, ldt, d + s + j, block);
      tiles<Lanes, NC, false>(j + NB, rows, C, ldt, own, ldt, factors, j, block);
    });
}

/// PanelKernels::below, for blocks of rows that stay in the caches.
template <class Lanes>
void below(const typename Lanes::Scalar* T, Index w, Index s, const typename Lanes::Scalar* d,
           typename Lanes::Scalar* C, Index ldc, Index rows) {
  using Scalar = typename Lanes::Scalar;
  constexpr Index NB = Lanes::columns;
  const Index ldt = PanelShape::padded(w), n = PanelShape::block_at(s, w);
  const Scalar* const own = T + s * ldt + s;
  Scalar factors[depth * Lanes::columns];
  for (Index top = 0; top < rows; top += rows_at_once) {
    const Index count = rows - top < rows_at_once ? rows - top : rows_at_once;
    Scalar *const first = C + top, *const here = first + s * ldc;
    subtract_product<Lanes>(here, ldc, count, n, first, ldc, T + s, ldt, d, s, false, false);
    for (Index j = 0; j < n; j += NB)
      with_count<Lanes::columns>(n - j, [&]<int NC>(Count<NC>) {
        DiagonalBlock<NC, Scalar> block{};
        read_diagonal<NC>(own + j * ldt + j, ldt, d + s + j, block);
        scale<Lanes, NC>(own + j, ldt, d + s, j, factors);
        tiles<Lanes, NC, false>(0, count, here + j * ldc, ldc, here, ldc, factors, j, block);
      });
  }
}

/// PanelKernels::update: U needs no zeros first.
template <class Lanes>
void update(const typename Lanes::Scalar* B, Index w, Index h, const typename Lanes::Scalar* d,
            typename Lanes::Scalar* U, Index from, Index to) {
  const Index ld = PanelShape::padded(h);
  subtract_product<Lanes>(U + from * ld + from, ld, ld - from, to - from, B + from, ld, B + from, ld, d, w,
                          true, true);
}

/// y <- y - A x for NC columns and the rows from `from` to `to`, multiples of the width; x has shape (NC).
template <class Lanes, int NC, class Scalar>
inline void subtract_columns(Index from, Index to, const Scalar* A, Index lda, const Scalar* x, Scalar* y) {
  using V = typename Lanes::V;
#pragma GCC unroll 2
  for (Index r = from; r < to; r += Lanes::width) {
    V sum = Lanes::load(y + r);
#pragma GCC unroll 8
    for (int c = 0; c < NC; ++c) sum -= Lanes::load(A + c * lda + r) * x[c];
    Lanes::store(y + r, sum);
  }
}

/// PanelKernels::forward: eight columns at a time, T^-1 by substitution, then what they subtract below.
/// Rows below eight begin at an aligned address; the last group may have fewer, with none below.
template <class Lanes>
void forward(const typename Lanes::Scalar* T, const typename Lanes::Scalar* B, Index w, Index h,
             typename Lanes::Scalar* x, typename Lanes::Scalar* part) {
  using Scalar = typename Lanes::Scalar;
  const Index ldt = PanelShape::padded(w), ldb = PanelShape::padded(h);
  for (Index r = 0; r < ldb; ++r) part[r] = Scalar(0);
  for (Index j = 0; j < w; j += 8) {
    const Scalar* const own = T + j * ldt;
    with_count<8>(w - j, [&]<int NC>(Count<NC>) {
      for (int c = 0; c < NC; ++c)
        for (int r = c + 1; r < NC; ++r) x[j + r] -= own[c * ldt + j + r] * x[j + c];
      Scalar given[NC];
      // A copy: x is written while its eight newest numbers are read.
      for (int c = 0; c < NC; ++c) given[c] = x[j + c];
      subtract_columns<Lanes, NC>(j + 8, ldt, own, ldt, given, x);
      subtract_columns<Lanes, NC>(0, ldb, B + j * ldb, ldb, given, part);
    });
  }
}

/// sums(c) += eight partial sums of A_c . x, of rows r, r + 8, ... from `from` to `to`, multiples of 8. Rows
/// of padding add nothing, since x is zero there.
template <class Lanes, int NC, class Scalar>
inline void add_dots(Index from, Index to, const Scalar* A, Index lda, const Scalar* x,
                     typename Lanes::V (&sums)[NC][8 / Lanes::width]) {
  for (Index r = from; r < to; r += 8)
#pragma GCC unroll 8
    for (int v = 0; v < 8 / Lanes::width; ++v) {
      const typename Lanes::V with = Lanes::load(x + r + v * Lanes::width);
#pragma GCC unroll 8
      for (int c = 0; c < NC; ++c) sums[c][v] += Lanes::load(A + c * lda + r + v * Lanes::width) * with;
    }
}

/// PanelKernels::backward: x_c -= B_c . part + sum_r T(r, c) x_r, eight columns at a time from the last.
template <class Lanes>
void backward(const typename Lanes::Scalar* T, const typename Lanes::Scalar* B, Index w, Index h,
              typename Lanes::Scalar* x, const typename Lanes::Scalar* part) {
  using Scalar = typename Lanes::Scalar;
  using V = typename Lanes::V;
  constexpr int NS = Lanes::width >= 4 ? Lanes::width : 2;  // columns whose sums stay in registers
  const Index ldt = PanelShape::padded(w), ldb = PanelShape::padded(h);
  for (Index j = (w - 1) / 8 * 8; j >= 0; j -= 8) {
    const Index end = w - j < 8 ? w : j + 8;
    for (Index first = j; first < end; first += NS)
      with_count<NS>(end - first, [&]<int NC>(Count<NC>) {
        V sums[NC][8 / Lanes::width];
        for (int c = 0; c < NC; ++c)
          for (int v = 0; v < 8 / Lanes::width; ++v) sums[c][v] = V{};
        add_dots<Lanes, NC>(0, ldb, B + first * ldb, ldb, part, sums);
        add_dots<Lanes, NC>(j + 8, ldt, T + first * ldt, ldt, x, sums);
        // The same order of summation for every width of the registers: of eight numbers four, two, one.
        for (int c = 0; c < NC; ++c) {
          alignas(64) Scalar s[8];
          for (int v = 0; v < 8 / Lanes::width; ++v) Lanes::store(s + v * Lanes::width, sums[c][v]);
          x[first + c] -= ((s[0] + s[4]) + (s[2] + s[6])) + ((s[1] + s[5]) + (s[3] + s[7]));
        }
      });
    // Inside of the eight columns: L^T by substitution, upwards from the last of them.
    for (Index c = end - 1; c >= j; --c)
      for (Index r = c + 1; r < end; ++r) x[c] -= T[c * ldt + r] * x[r];
  }
}

/// The table of the loops above for one instruction set.
/// @param name  a literal: it is kept
template <class Lanes>
constexpr PanelKernels<typename Lanes::Scalar> kernels_of(const char* name) {
  return {name, diagonal<Lanes>, below<Lanes>, update<Lanes>, forward<Lanes>, backward<Lanes>};
}

}  // namespace hmax::panel_loops
