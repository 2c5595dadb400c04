/// The loops over tetrahedra and springs that decide how fast a body is, for each instruction set.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "problems/tissue/forces/kernels/tet_law.hpp"

namespace hmax {

/// Eight tetrahedra side by side, so that one operation serves them all. Corners are in ascending order;
/// unused lanes repeat a tetrahedron with no stiffness.
struct alignas(64) TetBlock {
  static constexpr std::size_t lanes = 8;
  std::int32_t rows[4][lanes];  ///< where those of the corners begin: 4 times the points
  double gradients[9][lanes];   ///< Bm [1/m], row after row
  double half_lambda[lanes];    ///< V lambda / 2 [J]
  double mu[lanes];             ///< V mu [J]
};

/// Where the stiffness of eight tetrahedra goes: for each pair of corners a < b, in the order 01 02 03 12 13
/// 23, the number of its block (b, a) in an array of blocks, see PairBlocks.
struct TetSlots {
  std::int32_t block[6][TetBlock::lanes];
};

/// Eight points and the springs that begin at them, in sliced ELLPACK form: the k-th springs of all eight are
/// block begin + k. Unused lanes repeat a spring with no stiffness.
struct SpringSlice {
  static constexpr std::size_t lanes = 8;
  std::int32_t rows[lanes];  ///< of the points, as of tetrahedra
  std::int32_t begin, end;   ///< of its blocks
};

/// One spring of each of eight points, with phi = s + b s^3.
struct alignas(64) SpringBlock {
  double per_length[SpringSlice::lanes];  ///< 1 / L [1/m]
  double tension[SpringSlice::lanes];     ///< k L [N]
};

/// Where the rows of the points begin at which the springs of a block end.
struct SpringEnds {
  std::int32_t rows[SpringSlice::lanes];
};

/// The loops, compiled for one instruction set. Displacements u, positions x and forces f are rows of four
/// doubles, aligned to 32 bytes. Sums are taken one after the other in an order that the blocks fix, and
/// nothing is contracted to fused multiply-add. Lane by lane every set computes the same, and blocks of the
/// stiffness are summed pair of corners by pair of corners: forces and stiffness have the same bits with
/// every set.
struct TissueKernels {
  const char* name;
  std::size_t width;  ///< doubles in a register

  /// f += elastic forces of elements, for each law. With H = (u1 - u0, u2 - u0, u3 - u0) Bm = du/dX and the
  /// first Piola-Kirchhoff stress P(H),
  ///   (f1, f2, f3) = -V P Bm^T,   f0 = -(f1 + f2 + f3).
  /// No strain is the difference of larger numbers: rounding is relative to the forces, and grows in a sliver
  /// with the longest edge over the height. 210, 140, 265 and, where the rotation takes three steps, 640
  /// operations, 104 bytes a tetrahedron.
  void (*force[tet_laws])(const TetBlock* blocks, std::size_t count, const double* u, double* f);
  /// pairs += the stiffness of St. Venant-Kirchhoff elements: a block (b, a) has its three columns in rows of
  /// four. With the gradients g_1, g_2, g_3 of the shape functions, the rows of Bm, g_0 = -(g_1 + g_2 + g_3),
  /// h_a = F g_a, K_ab = g_a.g_b and B = F F^T, the block of corners a, b is
  ///   V (lambda h_a h_b^T + mu h_b h_a^T) + V mu K_ab B + (c K_ab + V mu h_a.h_b) I,
  ///   c = V lambda / 2 (tr(B) - 3) - V mu.
  void (*green_stiffness)(const TetBlock* blocks, const TetSlots* slots, std::size_t count, const double* u,
                          double* pairs);
  /// f += forces of springs with the cubic coefficient b. The forces at the points of a slice are summed
  /// before they are added: a spring reads and writes one row. 31 operations, 20 bytes a spring.
  void (*spring_force)(const SpringSlice* slices, std::size_t count, const SpringBlock* blocks,
                       const SpringEnds* ends, double b, const double* x, double* f);
};

/// Those of instruction_sets(), in its order.
std::span<const TissueKernels* const> available_tissue_kernels();

/// Those in use.
inline const TissueKernels& tissue_kernels() { return *available_tissue_kernels().front(); }

}  // namespace hmax
