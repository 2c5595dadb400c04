/// The stiffness and damping of a body and bounds of them: the programs of devices.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "catalogue/device/programs/body_step.hpp"
#include "catalogue/device/programs/contact_blocks.hpp"
#include "core/instructions/device_code.hpp"
#include "core/instructions/piece_sums.hpp"
#include "problems/tissue/forces/kernels/element_stiffness.hpp"
#include "problems/tissue/forces/kernels/spring_law.hpp"

namespace hmax {

/// A tetrahedron whose stiffness changes.
struct StiffTet {
  double gradients[9], half_lambda, mu;  ///< Bm [1/m], row after row; V lambda / 2, V mu [J]
  std::int32_t corner[4];                ///< points of BodyArrays
};

/// A tetrahedron of ten nodes, likewise: its rule as ten_node_gradient() takes it.
struct StiffTenNodes {
  double gradients[4][10][3], volumes[4];  ///< G [1/m], V [m^3]
  double moduli[2];                        ///< lambda / 2, mu [Pa]
  std::int32_t point[10];
  [[nodiscard]] HMAX_DEVICE double gradient(int g, int a, int j) const { return gradients[g][a][j]; }
  [[nodiscard]] HMAX_DEVICE double volume(int g) const { return volumes[g]; }
  [[nodiscard]] HMAX_DEVICE double half_lambda() const { return moduli[0]; }
  [[nodiscard]] HMAX_DEVICE double mu() const { return moduli[1]; }
};

/// A spring, likewise: k [N/m], L [m].
struct StiffSpring {
  double stiffness, length;
  std::int32_t end[2], set;
};

/// A damper between points of BodyArrays: c [N s/m].
struct StiffDamper {
  double damper;
  std::int32_t end[2];
};

/// Fibres in a tetrahedron, likewise: g_a.a [1/m] of its corners, a, E_f [Pa], V [m^3].
struct StiffFibre {
  double slopes[4], direction[3], young, volume;
  std::int32_t corner[4];
};

/// A triangle of a skin, likewise: Bm [1/m], row after row, V [m^3].
struct StiffTriangle {
  double gradients[4], volume;
  std::int32_t corner[3];
};

/// What a tetrahedron shares with those around its corners: V [m^3], and the averages that it belongs to.
struct StiffShares {
  double volume;
  std::int32_t average[4];
};

/// Pressures that tetrahedra share at their points, as NodalPressure has them.
struct StiffPressures {
  std::int32_t averages, gradients;  ///< how many there are
  const StiffShares* tets;           ///< shape (tets); null: none
  TermLists at_point;  ///< the averages around each free point, ascending: those of the gradients
  TermLists terms;     ///< of each gradient: 4 times the tetrahedron + its corner, in order
  double* gradient;    ///< (lambda/V_a)^(1/2) G_a [(N/m)^(1/2)], shape (gradients, 3)
  double* pressure;    ///< lambda (J_a - 1) [Pa], shape (averages)
  bool operator==(const StiffPressures&) const = default;
};

/// A = K + C / h + M / h^2 in blocks of 3 x 3, row after row of blocks, entries of a block row after row. Its
/// pattern is symmetric.
struct BodyMatrix {
  std::int32_t points, blocks, sums;
  const std::int32_t *first, *row, *column;  ///< of rows, shape (points + 1), of blocks, shape (blocks)
  TetLaw law;
  const StiffTet* tets;
  const StiffTenNodes* ten_nodes;  ///< in the place of tets, or null
  /// What tetrahedra add: of Green's strain to the blocks below the diagonal, then to those of a free and a
  /// supported point, columns one after the other; of other laws to each block, rows one after the other.
  /// Null where there are none; of small strain they are constant.
  double* sum;  ///< shape (sums, 9)
  /// Of each sum: 16 times the tetrahedron + 4 a + b of its corners, or 100 and 10 of ten nodes, in the order
  /// of the processor.
  TermLists terms;
  const std::int32_t* sum_of;  ///< of each block of Green's strain: its sum, or ~sum of the transposed one
  const std::int32_t* rim;     ///< where the sums of a point with supported ones begin, shape (points + 1)
  StiffPressures pressures;
  const StiffFibre* fibres;
  TermLists fibre_terms;  ///< of each block, as `terms`
  const StiffSpring* springs;
  TermLists spring_terms;  ///< of each block
  const StiffTriangle* triangles;
  TermLists triangle_terms;  ///< likewise: 9 times the triangle + 3 a + b of its corners
  const StiffDamper* dampers;
  TermLists damper_terms;     ///< likewise
  ContactBlocks contacts;     ///< of tools
  const double* damping;      ///< C of damping by stiffness, shape (blocks, 9); else null
  double alpha;               ///< [1/s]
  double* values;             ///< A, shape (blocks, 9)
  double* diagonal;           ///< shape (dofs)
  const std::int32_t* place;  ///< of each free point of the body: its number in BodyArrays
  bool operator==(const BodyMatrix&) const = default;

  [[nodiscard]] HMAX_DEVICE std::int32_t dofs() const { return 3 * points; }
  [[nodiscard]] HMAX_DEVICE std::int32_t pieces() const { return (dofs() + piece_size - 1) / piece_size; }
};

/// What tetrahedra add.
struct TetStiffness {
  static constexpr std::int32_t threads = 128;
  BodyMatrix matrix;
  const double* q;      ///< displacements, shape (3, body points)
  std::int32_t points;  ///< of BodyArrays
  bool operator==(const TetStiffness&) const = default;
};
HMAX_DEVICE inline std::int64_t count_of(const TetStiffness& stiffness) { return stiffness.matrix.sums; }

/// Component i at corner a, which is not known when this is compiled: without an array in memory.
HMAX_DEVICE inline double at_corner(const double (&of)[4][3], std::int32_t a, int i) {
  return a == 0 ? of[0][i] : a == 1 ? of[1][i] : a == 2 ? of[2][i] : of[3][i];
}

/// The block (b, a) of corners a < b of Green's strain, column j at entries[j].
HMAX_DEVICE inline void tet_block(LawConstant<TetLaw::green>, const StiffTet& tet, const double (*U)[3],
                                  std::int32_t a, std::int32_t b, double (*entries)[3]) {
  kernel_loops::StiffnessParts<OneElement<double>> all, own;
  for (int k = 0; k < 9; ++k) all.g[k / 3 + 1][k % 3] = tet.gradients[k];
  kernel_loops::stiffness_parts<OneElement<double>, double>(U, tet.half_lambda, tet.mu, all);
  for (int i = 0; i < 3; ++i) {
    own.g[0][i] = at_corner(all.g, a, i), own.g[1][i] = at_corner(all.g, b, i);
    own.h[0][i] = at_corner(all.h, a, i), own.h[1][i] = at_corner(all.h, b, i);
    own.mh[0][i] = tet.mu * own.h[0][i];
    own.lh[1][i] = (tet.half_lambda + tet.half_lambda) * own.h[1][i];
  }
  for (int k = 0; k < 6; ++k) own.B[k] = all.B[k];
  own.c = all.c;
  kernel_loops::pair_stiffness(own, 0, 1, entries);
}

/// The block (a, b) of the neo-Hookean solid, row i at entries[i].
/// @param pressure  as of neo_hookean_parts_of()
template <class... Pressure>
HMAX_DEVICE inline void tet_block(LawConstant<TetLaw::neo_hookean>, const StiffTet& tet, const double (*U)[3],
                                  std::int32_t a, std::int32_t b, double (*entries)[3],
                                  Pressure... pressure) {
  kernel_loops::NeoHookeanParts<OneElement<double>, 2> own;
  double g[4][3], H[3][3];
  for (int k = 0; k < 9; ++k) g[k / 3 + 1][k % 3] = tet.gradients[k];
  kernel_loops::first_gradient(g);
  for (int i = 0; i < 3; ++i) own.g[0][i] = at_corner(g, a, i), own.g[1][i] = at_corner(g, b, i);
  kernel_loops::displacement_gradient<OneElement<double>>(U, g + 1, H);
  kernel_loops::neo_hookean_parts_of(H, tet.half_lambda, tet.mu, own, pressure...);
  kernel_loops::neo_hookean_stiffness(own, 0, 1, entries);
}

/// The block (a, b) of the corotational solid, row i at entries[i].
HMAX_DEVICE inline void tet_block(LawConstant<TetLaw::corotational>, const StiffTet& tet,
                                  const double (*U)[3], std::int32_t a, std::int32_t b,
                                  double (*entries)[3]) {
  kernel_loops::CorotationalParts<OneElement<double>> parts;
  for (int k = 0; k < 9; ++k) parts.g[k / 3 + 1][k % 3] = tet.gradients[k];
  kernel_loops::corotational_parts<OneElement<double>, double, double>(U, tet.half_lambda, tet.mu, parts);
  double own[2][2][3];
  for (int i = 0; i < 3; ++i) {
    own[0][0][i] = at_corner(parts.g, a, i), own[0][1][i] = at_corner(parts.g, b, i);
    own[1][0][i] = at_corner(parts.Rg, a, i), own[1][1][i] = at_corner(parts.Rg, b, i);
  }
  for (int c = 0; c < 2; ++c)
    for (int i = 0; i < 3; ++i) parts.g[c][i] = own[0][c][i], parts.Rg[c][i] = own[1][c][i];
  kernel_loops::corotational_stiffness(parts, 0, 1, entries);
}

/// What term `term` of a list adds to its sum, shape (3, 3).
template <TetLaw law>
HMAX_DEVICE inline void term_block(LawConstant<law> kind, const TetStiffness& stiffness, std::int32_t term,
                                   double (*entries)[3]) {
  const StiffTet& tet = stiffness.matrix.tets[term / 16];
  double U[3][3];
  edges(tet.corner, stiffness.points, stiffness.q, U);
  tet_block(kind, tet, U, term / 4 % 4, term % 4, entries);
}

/// The same of those that share their pressures.
using OfPressures = std::integral_constant<PatchElements, PatchElements::of_pressures>;
HMAX_DEVICE inline void term_block(OfPressures, const TetStiffness& stiffness, std::int32_t term,
                                   double (*entries)[3]) {
  const StiffPressures& shared = stiffness.matrix.pressures;
  const StiffTet& tet = stiffness.matrix.tets[term / 16];
  const StiffShares& own = shared.tets[term / 16];
  double U[3][3], sum = 0;
  edges(tet.corner, stiffness.points, stiffness.q, U);
  for (const std::int32_t average : own.average) sum = sum + shared.pressure[average];
  tet_block(LawConstant<TetLaw::neo_hookean>{}, tet, U, term / 4 % 4, term % 4, entries,
            own.volume * (sum / 4));
}

/// Adds what the averages around both points of a block have of it.
HMAX_DEVICE inline void add_averages(const BodyMatrix& matrix, std::int64_t block, double* sum) {
  const TermLists& at_point = matrix.pressures.at_point;
  const std::int32_t row = matrix.row[block], column = matrix.column[block];
  std::int32_t i = at_point.first[row], j = at_point.first[column];
  while (i < at_point.first[row + 1] && j < at_point.first[column + 1]) {
    const std::int32_t of_i = at_point.of[i], of_j = at_point.of[j];
    if (of_i == of_j) {
      const double* const G = matrix.pressures.gradient;
      for (int m = 0; m < 9; ++m)
        sum[m] = sum[m] + G[std::int64_t{3} * i + m / 3] * G[std::int64_t{3} * j + m % 3];
    }
    i += of_i <= of_j ? 1 : 0;
    j += of_j <= of_i ? 1 : 0;
  }
}

/// The same of elements of ten nodes.
using OfTenNodes = std::integral_constant<PatchElements, PatchElements::of_ten_nodes>;
HMAX_DEVICE inline void term_block(OfTenNodes, const TetStiffness& stiffness, std::int32_t term,
                                   double (*entries)[3]) {
  const StiffTenNodes& element = stiffness.matrix.ten_nodes[term / 100];
  const int own[2] = {term / 10 % 10, term % 10};
  double U[10][3];
  for (int a = 0; a < 10; ++a)
    for (int i = 0; i < 3; ++i) {
      const double* const u = stiffness.q + static_cast<std::int64_t>(i) * stiffness.points;
      U[a][i] = u[element.point[a]] - u[element.point[0]];
    }
  const auto parts_at = [&](int g) {
    kernel_loops::NeoHookeanParts<OneElement<double>, 2> parts;
    for (int c = 0; c < 2; ++c)
      for (int j = 0; j < 3; ++j) parts.g[c][j] = element.gradient(g, own[c], j);
    kernel_loops::ten_node_parts(U, element, g, parts);
    return parts;
  };
  kernel_loops::ten_node_stiffness(parts_at, 0, 1, entries);
}

/// One sum.
template <class Kind>
HMAX_DEVICE void run_thread(Kind kind, const TetStiffness& stiffness, std::int64_t n) {
  const BodyMatrix& matrix = stiffness.matrix;
  double sum[9] = {};
  for (std::int32_t k = matrix.terms.first[n]; k < matrix.terms.first[n + 1]; ++k) {
    double entries[3][3];
    term_block(kind, stiffness, matrix.terms.of[k], entries);
    for (int m = 0; m < 9; ++m) sum[m] = sum[m] + entries[m / 3][m % 3];
  }
  if constexpr (std::is_same_v<Kind, OfPressures>) add_averages(matrix, n, sum);
  for (int m = 0; m < 9; ++m) matrix.sum[9 * n + m] = sum[m];
}

/// The pressures of all averages, and how their volumes change with the free points around them.
struct PressureGradients {
  static constexpr std::int32_t threads = 128;
  TetStiffness of;
  SharedPressures<double> shared;  ///< with the shares of VolumeShares at the same displacements
  bool operator==(const PressureGradients&) const = default;
};
/// Those of the averages come after the gradients.
HMAX_DEVICE inline std::int64_t count_of(const PressureGradients& program) {
  return std::int64_t{program.of.matrix.pressures.gradients} + program.of.matrix.pressures.averages;
}
HMAX_DEVICE inline void run_thread(std::true_type, const PressureGradients& program, std::int64_t n) {
  const BodyMatrix& matrix = program.of.matrix;
  const StiffPressures& own = matrix.pressures;
  if (n >= own.gradients) {
    const auto average = static_cast<std::int32_t>(n - own.gradients);
    own.pressure[average] = shared_pressure(program.shared, average, program.shared.shares);
    return;
  }
  double G[3] = {};
  for (std::int32_t k = own.terms.first[n]; k < own.terms.first[n + 1]; ++k) {
    const std::int32_t number = own.terms.of[k] / 4;
    const StiffTet& tet = matrix.tets[number];
    kernel_loops::NeoHookeanParts<OneElement<double>, 1> parts;
    double U[3][3], g[4][3], H[3][3];
    for (int m = 0; m < 9; ++m) g[m / 3 + 1][m % 3] = tet.gradients[m];
    kernel_loops::first_gradient(g);
    for (int i = 0; i < 3; ++i) parts.g[0][i] = at_corner(g, own.terms.of[k] % 4, i);
    edges(tet.corner, program.of.points, program.of.q, U);
    kernel_loops::displacement_gradient<OneElement<double>>(U, g + 1, H);
    kernel_loops::neo_hookean_parts_of(H, tet.half_lambda, tet.mu, parts);
    for (int i = 0; i < 3; ++i) G[i] = G[i] + own.tets[number].volume / 4 * parts.Cg[0][i];
  }
  const std::int32_t average = own.at_point.of[n];
  const double scale = std::sqrt(program.shared.lambda[average] / program.shared.around[average]);
  for (int i = 0; i < 3; ++i) own.gradient[3 * n + i] = G[i] * scale;
}

/// All blocks of the matrix.
struct MatrixBlocks {
  static constexpr std::int32_t threads = 128;
  BodyMatrix matrix;
  double h;
  BodyStep<double> step;    ///< of the iterate, step.q_next
  std::int32_t evaluation;  ///< of BodyStep
  bool operator==(const MatrixBlocks&) const = default;
};
HMAX_DEVICE inline std::int64_t count_of(const MatrixBlocks& program) { return program.matrix.blocks; }

/// Entry (r, c) of the sum of a pair of points, or of the transposed one.
HMAX_DEVICE inline double of_pair(const BodyMatrix& matrix, std::int32_t pair, bool transposed, int r,
                                  int c) {
  return matrix.sum[std::int64_t{9} * pair + (transposed ? 3 * r + c : 3 * c + r)];
}

/// What pairs of points leave for a block on the diagonal: forces between points add up to zero. As
/// BlockPattern::write().
HMAX_DEVICE inline void diagonal_of_pairs(const BodyMatrix& matrix, std::int32_t point, double (*K)[3]) {
  double sum[3][3] = {};
  const auto subtract = [&](std::int32_t pair, bool transposed) {
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) sum[r][c] = sum[r][c] - of_pair(matrix, pair, transposed, r, c);
  };
  for (std::int32_t pair = matrix.rim[point]; pair < matrix.rim[point + 1]; ++pair) subtract(pair, false);
  // Those of its column, the transposed ones of its row.
  for (std::int32_t n = matrix.first[point]; n < matrix.first[point + 1]; ++n)
    if (const std::int32_t pair = matrix.sum_of[n]; matrix.column[n] != point)
      subtract(pair < 0 ? ~pair : pair, pair >= 0);
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) K[r][c] = (sum[r][c] + sum[c][r]) / 2;
}

/// What tetrahedra have of a block.
HMAX_DEVICE inline void take_tetrahedra(const BodyMatrix& matrix, std::int64_t block, bool is_diagonal,
                                        double (*K)[3]) {
  const bool of_pairs = matrix.law == TetLaw::green;
  if (of_pairs && is_diagonal) return diagonal_of_pairs(matrix, matrix.row[block], K);
  const std::int32_t pair = of_pairs ? matrix.sum_of[block] : 0;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c)
      K[r][c] = of_pairs ? of_pair(matrix, pair < 0 ? ~pair : pair, pair < 0, r, c)
                         : matrix.sum[9 * block + (3 * r + c)];
}

/// The position of point b less that of point a.
HMAX_DEVICE inline void span_of(const MatrixBlocks& program, std::int32_t a, std::int32_t b, double* d) {
  const BodyArrays<double>& body = program.step.body;
  for (int i = 0; i < 3; ++i) {
    const auto x = [&](std::int32_t point) {
      const std::int64_t at = static_cast<std::int64_t>(i) * body.points + point;
      return body.rest[at] + program.step.q_next[at];
    };
    d[i] = x(b) - x(a);
  }
}

/// Adds the fibres of a block.
HMAX_DEVICE inline void add_fibres(const MatrixBlocks& program, std::int64_t block, double (*K)[3]) {
  const BodyMatrix& matrix = program.matrix;
  const BodyArrays<double>& body = program.step.body;
  const bool small_strain = body.fibres_of_small_strain;
  for (std::int32_t n = matrix.fibre_terms.first[block]; n < matrix.fibre_terms.first[block + 1]; ++n) {
    const std::int32_t term = matrix.fibre_terms.of[n];
    const StiffFibre& fibre = matrix.fibres[term / 16];
    double U[3][3], B[3][3];
    edges(fibre.corner, body.points, program.step.q_next, U);
    const auto now = kernel_loops::stretch_of_fibre<OneElement<double>>(U, fibre.slopes + 1, fibre.direction,
                                                                        small_strain);
    if (!kernel_loops::is_taut(now, small_strain)) continue;
    kernel_loops::fibre_stiffness(now, fibre.young, fibre.volume, small_strain, B);
    const double slopes = fibre.slopes[term / 4 % 4] * fibre.slopes[term % 4];
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) K[r][c] = K[r][c] + slopes * B[r][c];
  }
}

/// Adds the springs of a block. @tparam more  as of BodyKind
template <bool more>
HMAX_DEVICE inline void add_springs(const MatrixBlocks& program, std::int64_t block, bool is_diagonal,
                                    double (*K)[3]) {
  const BodyMatrix& matrix = program.matrix;
  for (std::int32_t n = matrix.spring_terms.first[block]; n < matrix.spring_terms.first[block + 1]; ++n) {
    const StiffSpring& spring = matrix.springs[matrix.spring_terms.of[n]];
    double d[3], e[3], B[3][3];
    span_of(program, spring.end[0], spring.end[1], d);
    const double length = kernel_loops::direction<OneElement<double>>(d, e);
    const auto find = [&](const auto& law) {
      kernel_loops::spring_stiffness(law, spring.stiffness, spring.length, length, e, B);
    };
    const SetLaw<double>& law = program.step.body.laws[spring.set];
    if constexpr (more)
      law.visit(find);
    else
      find(CubicSpring{law.b});
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) K[r][c] = is_diagonal ? K[r][c] + B[r][c] : K[r][c] - B[r][c];
  }
}

/// Block (a, b) of a triangle of a skin: what is pulled at corner a changes with corner b.
HMAX_DEVICE inline void triangle_block(const MatrixBlocks& program, const StiffTriangle& triangle, int a,
                                       int b, double (*B)[3]) {
  const BodyArrays<double>& body = program.step.body;
  double D[2][3], F[2][3], S[3], pull[2][3];
  span_of(program, triangle.corner[0], triangle.corner[1], D[0]);
  span_of(program, triangle.corner[0], triangle.corner[2], D[1]);
  kernel_loops::triangle_gradient(D, triangle.gradients, F);
  kernel_loops::membrane_stress<OneElement<double>>(body.skin_modulus, body.skin_poisson, F, S);
  const auto column = [&](int of, int c, double* to) {
    kernel_loops::triangle_stiffness(F, S, triangle.gradients, triangle.volume, body.skin_modulus,
                                     body.skin_poisson, of, c, pull);
    for (int r = 0; r < 3; ++r)
      to[r] = a == 0 ? -(pull[0][r] + pull[1][r]) : a == 1 ? pull[0][r] : pull[1][r];
  };
  for (int c = 0; c < 3; ++c) {
    double first[3], second[3];
    column(b == 2 ? 2 : 1, c, first);
    if (b == 0) column(2, c, second);
    for (int r = 0; r < 3; ++r) B[r][c] = b == 0 ? -(first[r] + second[r]) : first[r];
  }
}

/// Adds the triangles of a block.
HMAX_DEVICE inline void add_triangles(const MatrixBlocks& program, std::int64_t block, double (*K)[3]) {
  const BodyMatrix& matrix = program.matrix;
  for (std::int32_t n = matrix.triangle_terms.first[block]; n < matrix.triangle_terms.first[block + 1]; ++n) {
    const std::int32_t term = matrix.triangle_terms.of[n];
    double B[3][3];
    triangle_block(program, matrix.triangles[term / 9], term / 3 % 3, term % 3, B);
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) K[r][c] = K[r][c] + B[r][c];
  }
}

/// Adds what the dampers of a block have of K and of C.
HMAX_DEVICE inline void add_dampers(const MatrixBlocks& program, std::int64_t block, bool is_diagonal,
                                    double (*K)[3], double (*C)[3]) {
  const BodyMatrix& matrix = program.matrix;
  const BodyStep<double>& step = program.step;
  const double* const loads = loads_of(step, program.evaluation);
  for (std::int32_t n = matrix.damper_terms.first[block]; n < matrix.damper_terms.first[block + 1]; ++n) {
    const StiffDamper& damper = matrix.dampers[matrix.damper_terms.of[n]];
    double d[3], e[3], w[3], B[3][3];
    span_of(program, damper.end[0], damper.end[1], d);
    for (int i = 0; i < 3; ++i) {
      const auto v = [&](std::int32_t point) { return velocity_of(step.body, step.v_next, loads, point, i); };
      w[i] = v(damper.end[1]) - v(damper.end[0]);
    }
    const double length = kernel_loops::direction<OneElement<double>>(d, e);
    kernel_loops::damper_stiffness<OneElement<double>>(damper.damper, length, e, w, B);
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) {
        const double along = damper.damper * e[r] * e[c];
        K[r][c] = is_diagonal ? K[r][c] + B[r][c] : K[r][c] - B[r][c];
        C[r][c] = is_diagonal ? C[r][c] + along : C[r][c] - along;
      }
  }
}

template <PatchParts parts>
HMAX_DEVICE inline void run_thread(PartsConstant<parts>, const MatrixBlocks& program, std::int64_t block) {
  constexpr bool more = parts != PatchParts::few;
  const BodyMatrix& matrix = program.matrix;
  const double h = program.h;
  const std::int32_t point = matrix.row[block];
  const bool is_diagonal = matrix.column[block] == point;
  double K[3][3] = {};
  if (matrix.sum) take_tetrahedra(matrix, block, is_diagonal, K);
  if (more && matrix.fibres) add_fibres(program, block, K);
  if (matrix.springs) add_springs<more>(program, block, is_diagonal, K);
  const double mass = program.step.body.mass[program.matrix.place[point]];
  double C[3][3];
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c)
      C[r][c] = matrix.damping          ? matrix.damping[9 * block + (3 * r + c)]
                : is_diagonal && r == c ? matrix.alpha * mass
                                        : 0.0;
  if (more && matrix.triangles) add_triangles(program, block, K);
  const double* const anchor = program.step.body.anchor;
  for (int r = 0; anchor && is_diagonal && r < 3; ++r)
    K[r][r] = K[r][r] + anchor[program.matrix.place[point]];
  if (more && matrix.dampers) add_dampers(program, block, is_diagonal, K, C);
  if constexpr (parts == PatchParts::tools)
    add_contacts(matrix.contacts, program.step, loads_of(program.step, program.evaluation), block, K, C);
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) {
      const bool on_diagonal = is_diagonal && r == c;
      double a = K[r][c] + C[r][c] / h;
      if (on_diagonal) matrix.diagonal[3 * point + r] = a = a + mass / (h * h);
      matrix.values[9 * block + (3 * r + c)] = a;
    }
}

/// How many degrees of freedom a piece has.
HMAX_DEVICE inline std::int32_t numbers_of_piece(const BodyMatrix& matrix, std::int32_t number) {
  const std::int32_t left = matrix.dofs() - number * piece_size;
  return left < piece_size ? left : piece_size;
}

/// The largest sums of absolute values of M^(-1/2) A M^(-1/2) over a column and a row of a piece of the
/// degrees of freedom, a block of threads for each: of TissueBody::bound_of().
struct BoundPieces {
  static constexpr std::int32_t threads = piece_size;
  BodyMatrix matrix;
  const double* mass;              ///< as of BodyArrays
  const std::int32_t* transposed;  ///< of each block of the matrix
  double* largest;                 ///< shape (pieces, 2)
  bool operator==(const BoundPieces&) const = default;
};
inline std::int64_t blocks_of(const BoundPieces& bound) { return bound.matrix.pieces(); }
inline std::size_t shared_bytes_of(const BoundPieces&) { return 2 * sizeof(double) * piece_size; }

/// The sums over column and row n, each from first to last as the processor adds them up.
HMAX_DEVICE inline void sums_of_scaled(const BoundPieces& bound, std::int32_t n, double& column,
                                       double& row) {
  const BodyMatrix& matrix = bound.matrix;
  const auto mass = [&](std::int32_t point) { return bound.mass[bound.matrix.place[point]]; };
  column = row = 0;
  for (std::int32_t k = matrix.first[n / 3]; k < matrix.first[n / 3 + 1]; ++k) {
    const double scale = std::sqrt(mass(n / 3) * mass(matrix.column[k]));
    for (std::int32_t c = 0; c < 3; ++c) {
      column =
          column + std::abs(matrix.values[std::int64_t{9} * bound.transposed[k] + (3 * c + n % 3)]) / scale;
      row = row + std::abs(matrix.values[std::int64_t{9} * k + (3 * (n % 3) + c)]) / scale;
    }
  }
}

template <class Block>
HMAX_DEVICE void run_block(std::true_type, const Block& block, const BoundPieces& bound, std::int32_t number,
                           void* shared) {
  const std::int32_t here = numbers_of_piece(bound.matrix, number);
  double* const sums = static_cast<double*>(shared);
  block.each(here, [&](std::int32_t k) {
    sums_of_scaled(bound, number * piece_size + k, sums[k], sums[piece_size + k]);
  });
  block.barrier();
  block.each(2, [&](std::int32_t which) {
    const double* const own = sums + std::ptrdiff_t{which} * piece_size;
    double largest = own[0];
    for (std::int32_t k = 1; k < here; ++k) largest = own[k] > largest ? own[k] : largest;
    bound.largest[2 * number + which] = largest;
  });
}

}  // namespace hmax
