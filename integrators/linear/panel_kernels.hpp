/// The dense arithmetic of sparse factorisations, for each instruction set.
#pragma once

#include <cstddef>
#include <span>

namespace hmax {

/// Panels are stored by columns, whose length is padded to a multiple of `lanes` with zeros, and begin at
/// addresses that are multiples of 64. A panel of w columns is a triangle T, shape (padded w, w), unit lower
/// with its diagonal not used, above B, shape (padded h, w).
struct PanelShape {
  static constexpr std::ptrdiff_t lanes = 8;  ///< doubles of the widest register
  /// Columns that are eliminated as one block, and rows that are worked on at once; multiples of `lanes`, so
  /// that blocks begin at aligned addresses.
  static constexpr std::ptrdiff_t block = 128, rows_at_once = 256;
  /// The next multiple of `lanes`; n itself where it is one.
  static constexpr std::ptrdiff_t padded(std::ptrdiff_t n) { return (n + lanes - 1) / lanes * lanes; }
  /// The columns of the block that begins at column s of w.
  static constexpr std::ptrdiff_t block_at(std::ptrdiff_t s, std::ptrdiff_t w) {
    return w - s < block ? w - s : block;
  }
};

/// The loops over panels. Every number is computed by the same operations in the same order, whatever the
/// width of the registers: results have the same bits with every set.
template <class Scalar>
struct PanelKernels {
  using Index = std::ptrdiff_t;
  const char* name;  ///< of the instruction set
  /// L D L^T of the block of columns of T that begins at s, between its own rows: T(s.., s..) less what the
  /// columns before s subtract becomes L, of which the lower triangle is read, and d. A pivot that is zero or
  /// not finite shows in d.
  void (*diagonal)(Scalar* T, Index w, Index s, Scalar* d);
  /// The same columns of rows below that block, which may be rows of T or of B: C becomes L.
  /// @param C  shape (rows, w), columns ldc apart; `rows` is a multiple of 8
  void (*below)(const Scalar* T, Index w, Index s, const Scalar* d, Scalar* C, Index ldc, Index rows);
  /// Columns from `from`, a multiple of 8, to `to` of U <- -B diag(d) B^T, lower triangle, shape (padded h,
  /// h); what stands above it is of no use.
  void (*update)(const Scalar* B, Index w, Index h, const Scalar* d, Scalar* U, Index from, Index to);
  /// x <- T^-1 x, shape (padded w), and part <- -B x, shape (padded h).
  void (*forward)(const Scalar* T, const Scalar* B, Index w, Index h, Scalar* x, Scalar* part);
  /// x <- T^-T (x - B^T part).
  void (*backward)(const Scalar* T, const Scalar* B, Index w, Index h, Scalar* x, const Scalar* part);
};

/// Those for doubles of instruction_sets(), in its order: the set in use first.
std::span<const PanelKernels<double>* const> available_panel_kernels();

}  // namespace hmax
