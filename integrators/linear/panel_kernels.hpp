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
  /// The next multiple of `lanes`; n itself where it is one.
  static constexpr std::ptrdiff_t padded(std::ptrdiff_t n) { return (n + lanes - 1) / lanes * lanes; }
};

/// The loops over panels. Every number is computed by the same operations in the same order, whatever the
/// width of the registers: results have the same bits with every set.
template <class Scalar>
struct PanelKernels {
  using Index = std::ptrdiff_t;
  const char* name;  ///< of the instruction set
  /// (T; B) <- L and d with L diag(d) L_T^T = (T; B), of whose T the lower triangle is read. A pivot that is
  /// zero or not finite shows in d.
  void (*eliminate)(Scalar* T, Scalar* B, Index w, Index h, Scalar* d);
  /// U <- -B diag(d) B^T, lower triangle, shape (padded h, h); what stands above it is of no use.
  void (*update)(const Scalar* B, Index w, Index h, const Scalar* d, Scalar* U);
  /// x <- T^-1 x, shape (padded w), and part <- -B x, shape (padded h).
  void (*forward)(const Scalar* T, const Scalar* B, Index w, Index h, Scalar* x, Scalar* part);
  /// x <- T^-T (x - B^T part).
  void (*backward)(const Scalar* T, const Scalar* B, Index w, Index h, Scalar* x, const Scalar* part);
};

/// Those for doubles of instruction_sets(), in its order: the set in use first.
std::span<const PanelKernels<double>* const> available_panel_kernels();

}  // namespace hmax
