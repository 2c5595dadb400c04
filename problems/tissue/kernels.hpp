/// The loops over tetrahedra and springs that decide how fast a body is, for each instruction set.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace hmax {

/// Eight tetrahedra side by side, so that one operation serves them all. Corners are in ascending order;
/// unused lanes repeat a tetrahedron with no stiffness.
struct alignas(64) TetBlock {
  static constexpr std::size_t lanes = 8;
  std::int32_t points[4][lanes];
  double gram[6][lanes];      ///< Bm Bm^T [1/m^2], entries 00 11 22 01 02 12
  double half_lambda[lanes];  ///< V lambda / 2 [J]
  double mu[lanes];           ///< V mu [J]
};

/// Where the stiffness of eight tetrahedra goes: for each pair of corners a < b, in the order 01 02 03 12 13
/// 23, the number of its block (b, a) in an array of blocks, see PairBlocks.
struct TetSlots {
  std::int32_t block[6][TetBlock::lanes];
};

/// Eight springs with phi = s + b s^3.
struct alignas(64) SpringBlock {
  static constexpr std::size_t lanes = 8;
  std::int32_t points[2][lanes];
  double per_length[lanes];  ///< 1 / L [1/m]
  double tension[lanes];     ///< k L [N]
};

/// The loops, compiled for one instruction set. Positions x and forces f are rows of four doubles, aligned to
/// 32 bytes. Sums are taken one after the other in an order that the blocks fix, and nothing is contracted to
/// fused multiply-add: forces have the same bits with every set. The order in which blocks of the stiffness
/// are summed follows the width of the registers, so that its last bits are those of one set.
struct TissueKernels {
  const char* name;
  std::size_t width;  ///< doubles in a register

  /// f += elastic forces of St. Venant-Kirchhoff elements, from G = Ds^T Ds and K = Bm Bm^T alone: with
  /// N = G K - I,
  ///   (f1, f2, f3) = -Ds (V lambda / 2 tr(N) K + V mu K N),   f0 = -(f1 + f2 + f3)
  /// 198 operations, 80 bytes a tetrahedron.
  void (*green_force)(const TetBlock* blocks, std::size_t count, const double* x, double* f);
  /// pairs += their stiffness: a block (b, a) has its three columns in rows of four. With H = Ds K = (h1, h2,
  /// h3) and B = H Ds^T = F F^T, the block of corners a, b = 1, 2, 3 is
  ///   V (lambda h_a h_b^T + mu h_b h_a^T) + V mu K_ab B + (c K_ab + V mu h_a.h_b) I,
  ///   c = V lambda / 2 (tr(B) - 3) - V mu,
  /// and that of a corner and the first is minus the sum of its others.
  void (*green_stiffness)(const TetBlock* blocks, const TetSlots* slots, std::size_t count, const double* x,
                          double* pairs);
  /// f += forces of springs with the cubic coefficient b.
  void (*spring_force)(const SpringBlock* blocks, std::size_t count, double b, const double* x, double* f);
};

/// What this processor can run, the fastest first.
std::span<const TissueKernels* const> available_tissue_kernels();

/// The fastest of them.
inline const TissueKernels& tissue_kernels() { return *available_tissue_kernels().front(); }

}  // namespace hmax
