/// Newton iterations of a body, each of a few conjugate gradients, as TruncatedNewton has them, and bounds of
/// its stiffness: the programs of devices.
///
/// Vectors of degrees of freedom are in the order of the body, x, y, z of one free point after the other;
/// displacements and velocities are stored as those of BodyStep. Whether conjugate gradients have ended is
/// decided on the device: programs after that do nothing, so that steps are one list of programs.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>

#include "catalogue/device/body_step.hpp"
#include "catalogue/device/contact_blocks.hpp"
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
  const StiffFibre* fibres;
  TermLists fibre_terms;  ///< of each block, as `terms`
  const StiffSpring* springs;
  TermLists spring_terms;  ///< of each block
  const StiffTriangle* triangles;
  TermLists triangle_terms;  ///< likewise: 9 times the triangle + 3 a + b of its corners
  const StiffDamper* dampers;
  TermLists damper_terms;  ///< likewise
  ContactBlocks contacts;  ///< of tools
  const double* damping;   ///< C of damping by stiffness, shape (blocks, 9); else null
  double alpha;            ///< [1/s]
  double* values;          ///< A, shape (blocks, 9)
  double* diagonal;        ///< shape (dofs)
  bool operator==(const BodyMatrix&) const = default;
};

/// What is known when iteration k begins its product.
struct GradientState {
  double rz, least;    ///< r.z; the norm of a residual that is one of rounding
  std::int32_t ended;  ///< before this iteration
  std::int32_t flat;   ///< in it: its direction has no curvature
};

/// What the programs of an iteration share.
struct NewtonArrays {
  BodyMatrix matrix;
  double h;
  const std::int32_t* place;  ///< of each free point of the body: its number in BodyArrays
  double *inertial, *residual, *z, *p[2], *Ap, *dq;  ///< shape (dofs)
  double *rr, *rz, *pAp;                             ///< products, of each piece
  GradientState* states;                             ///< of conjugate gradients
  std::int64_t* iterations;                          ///< how many there were
  bool operator==(const NewtonArrays&) const = default;

  [[nodiscard]] HMAX_DEVICE std::int32_t dofs() const { return 3 * matrix.points; }
  [[nodiscard]] HMAX_DEVICE std::int32_t pieces() const { return (dofs() + piece_size - 1) / piece_size; }
};

/// Where degree of freedom n of the body stands among displacements and among velocities.
struct DofPlace {
  std::int64_t at, dof;
  HMAX_DEVICE DofPlace(const NewtonArrays& arrays, const BodyStep<double>& step, std::int64_t n)
      : at(n % 3 * step.body.points + arrays.place[n / 3]),
        dof(n % 3 * step.body.free + arrays.place[n / 3]) {}
};

/// A program for each degree of freedom, and the body that it moves: from step.q to step.q_next, where the
/// iterate is kept, with its velocities in step.v_next.
struct DofProgram {
  static constexpr std::int32_t threads = piece_size;
  NewtonArrays newton;
  BodyStep<double> step;
  bool operator==(const DofProgram&) const = default;
};

/// The first guess: q + h v, and where supports stand.
struct NewtonBegin : DofProgram {
  std::int32_t evaluation;  ///< of BodyStep
  bool operator==(const NewtonBegin&) const = default;
};
/// The end of an iteration: dq is added.
struct NewtonEnd : DofProgram {
  bool operator==(const NewtonEnd&) const = default;
};

HMAX_DEVICE inline std::int64_t count_of(const DofProgram& program) { return program.newton.dofs(); }
/// Those of points that are not free come after those of the body.
HMAX_DEVICE inline std::int64_t count_of(const NewtonBegin& begin) {
  return begin.step.body.motions > 0 ? 3 * static_cast<std::int64_t>(begin.step.body.points)
                                     : begin.newton.dofs();
}
HMAX_DEVICE inline void run_thread(std::true_type, const NewtonBegin& begin, std::int64_t n) {
  if (n >= begin.newton.dofs()) {
    const BodyStep<double>& step = begin.step;
    const auto point = static_cast<std::int32_t>(n / 3), i = static_cast<std::int32_t>(n % 3);
    step.q_next[static_cast<std::int64_t>(i) * step.body.points + point] =
        held_motion(step.body, loads_of(step, begin.evaluation), point, i);
    return;
  }
  const DofPlace place(begin.newton, begin.step, n);
  const double h = begin.newton.h, q = begin.step.q[place.at], moved = q + h * begin.step.v[place.dof];
  begin.newton.inertial[n] = moved;
  begin.step.q_next[place.at] = moved;
  begin.step.v_next[place.dof] = (moved - q) / h;
}
HMAX_DEVICE inline void run_thread(std::true_type, const NewtonEnd& end, std::int64_t n) {
  const DofPlace place(end.newton, end.step, n);
  const double q = end.step.q_next[place.at] + end.newton.dq[n];
  const double v = (q - end.step.q[place.at]) / end.newton.h;
  watch(end.step, q, v);
  end.step.q_next[place.at] = q;
  end.step.v_next[place.dof] = v;
}

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
HMAX_DEVICE inline void tet_block(LawConstant<TetLaw::neo_hookean>, const StiffTet& tet, const double (*U)[3],
                                  std::int32_t a, std::int32_t b, double (*entries)[3]) {
  kernel_loops::NeoHookeanParts<OneElement<double>, 2> own;
  double g[4][3], H[3][3];
  for (int k = 0; k < 9; ++k) g[k / 3 + 1][k % 3] = tet.gradients[k];
  for (int i = 0; i < 3; ++i) g[0][i] = -(g[1][i] + g[2][i] + g[3][i]);
  for (int i = 0; i < 3; ++i) own.g[0][i] = at_corner(g, a, i), own.g[1][i] = at_corner(g, b, i);
  kernel_loops::displacement_gradient<OneElement<double>>(U, g + 1, H);
  kernel_loops::neo_hookean_parts_of(H, tet.half_lambda, tet.mu, own);
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
  for (int a = 0; a < 3; ++a)
    for (int i = 0; i < 3; ++i) {
      const double* const u = stiffness.q + static_cast<std::int64_t>(i) * stiffness.points;
      U[a][i] = u[tet.corner[a + 1]] - u[tet.corner[0]];
    }
  tet_block(kind, tet, U, term / 4 % 4, term % 4, entries);
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
  for (int m = 0; m < 9; ++m) matrix.sum[9 * n + m] = sum[m];
}

/// All blocks of the matrix.
struct MatrixBlocks {
  static constexpr std::int32_t threads = 128;
  NewtonArrays newton;
  BodyStep<double> step;    ///< of the iterate, step.q_next
  std::int32_t evaluation;  ///< of BodyStep
  bool operator==(const MatrixBlocks&) const = default;
};
HMAX_DEVICE inline std::int64_t count_of(const MatrixBlocks& program) { return program.newton.matrix.blocks; }

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
  const BodyMatrix& matrix = program.newton.matrix;
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
  const BodyMatrix& matrix = program.newton.matrix;
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
  const BodyMatrix& matrix = program.newton.matrix;
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
  const BodyMatrix& matrix = program.newton.matrix;
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
  const BodyMatrix& matrix = program.newton.matrix;
  const double h = program.newton.h;
  const std::int32_t point = matrix.row[block];
  const bool is_diagonal = matrix.column[block] == point;
  double K[3][3] = {};
  if (matrix.sum) take_tetrahedra(matrix, block, is_diagonal, K);
  if (more && matrix.fibres) add_fibres(program, block, K);
  if (matrix.springs) add_springs<more>(program, block, is_diagonal, K);
  const double mass = program.step.body.mass[program.newton.place[point]];
  double C[3][3];
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c)
      C[r][c] = matrix.damping          ? matrix.damping[9 * block + (3 * r + c)]
                : is_diagonal && r == c ? matrix.alpha * mass
                                        : 0.0;
  if (more && matrix.triangles) add_triangles(program, block, K);
  const double* const anchor = program.step.body.anchor;
  for (int r = 0; anchor && is_diagonal && r < 3; ++r)
    K[r][r] = K[r][r] + anchor[program.newton.place[point]];
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

/// A program of pieces of the degrees of freedom, a block of threads for each.
struct PieceProgram {
  static constexpr std::int32_t threads = piece_size;
  NewtonArrays newton;
  std::int32_t iteration;  ///< of conjugate gradients
  bool operator==(const PieceProgram&) const = default;
};
inline std::int64_t blocks_of(const PieceProgram& program) { return program.newton.pieces(); }
/// A piece of numbers, and partial sums.
inline std::size_t shared_bytes_of(const PieceProgram&) { return 2 * sizeof(double) * piece_size; }

/// The residual at the iterate of `step`, whose force is step.a, and dq = 0.
struct GradientBegin : PieceProgram {
  BodyStep<double> step;
  bool operator==(const GradientBegin&) const = default;
};
/// p = z + (r.z / r.z of the iteration before) p and A p.
struct GradientProduct : PieceProgram {
  bool operator==(const GradientProduct&) const = default;
};
/// dq += (r.z / p.Ap) p, the residual after it, and z.
struct GradientUpdate : PieceProgram {
  bool operator==(const GradientUpdate&) const = default;
};

/// to[number] = the product of two vectors over piece `number`. @param shared  shape (2 piece_size)
template <class Block>
HMAX_DEVICE inline void multiply_piece(const Block& block, std::int32_t number, std::int32_t here,
                                       const double* a, const double* b, double* shared, double* to) {
  const std::int64_t first = static_cast<std::int64_t>(number) * piece_size;
  block.barrier();
  block.each(here, [&](std::int32_t n) { shared[n] = a[first + n] * b[first + n]; });
  block.barrier();
  add_up<lanes_of_a_piece>(block, here, shared, shared + piece_size);
  block.each(1, [&](std::int32_t) { to[number] = shared[piece_size]; });
}

/// The sum of the products of all pieces, for all threads of a block.
template <class Block>
HMAX_DEVICE inline double sum_of_pieces(const Block& block, std::int32_t pieces, const double* products,
                                        double* shared) {
  add_up<piece_size>(block, pieces, products, shared);
  const double sum = shared[0];
  block.barrier();
  return sum;
}

/// How many degrees of freedom a piece has.
HMAX_DEVICE inline std::int32_t numbers_of_piece(const NewtonArrays& newton, std::int32_t number) {
  const std::int32_t left = newton.dofs() - number * piece_size;
  return left < piece_size ? left : piece_size;
}

/// z of the residual, and the products r.r and r.z of a piece.
template <class Block>
HMAX_DEVICE inline void end_residual(const Block& block, const NewtonArrays& newton, std::int32_t number,
                                     std::int32_t here, double* shared) {
  multiply_piece(block, number, here, newton.residual, newton.residual, shared, newton.rr);
  multiply_piece(block, number, here, newton.residual, newton.z, shared, newton.rz);
}

template <class Block>
HMAX_DEVICE void run_block(std::true_type, const Block& block, const GradientBegin& begin,
                           std::int32_t number, void* shared) {
  const NewtonArrays& newton = begin.newton;
  const std::int32_t here = numbers_of_piece(newton, number);
  const double h = newton.h;
  block.each(here, [&](std::int32_t k) {
    const std::int32_t n = number * piece_size + k;
    const DofPlace place(newton, begin.step, n);
    const double mass = begin.step.body.mass[newton.place[n / 3]];
    const double r =
        begin.step.a[place.dof] - mass / (h * h) * (begin.step.q_next[place.at] - newton.inertial[n]);
    newton.residual[n] = r;
    newton.z[n] = r / newton.matrix.diagonal[n];
    newton.dq[n] = 0;
  });
  end_residual(block, newton, number, here, static_cast<double*>(shared));
}

/// Row n of A times z + beta p, p left out in the first iteration, column by column as Eigen adds them up.
HMAX_DEVICE inline double row_product(const NewtonArrays& newton, std::int32_t n, const double* p,
                                      double beta) {
  const BodyMatrix& matrix = newton.matrix;
  double sum = 0;
  for (std::int32_t k = matrix.first[n / 3]; k < matrix.first[n / 3 + 1]; ++k)
    for (int c = 0; c < 3; ++c) {
      const std::int32_t m = 3 * matrix.column[k] + c;
      const double x = p ? newton.z[m] + beta * p[m] : newton.z[m];
      sum = sum + matrix.values[std::int64_t{9} * k + (3 * (n % 3) + c)] * x;
    }
  return sum;
}

template <class Block>
HMAX_DEVICE void run_block(std::true_type, const Block& block, const GradientProduct& product,
                           std::int32_t number, void* shared_memory) {
  const NewtonArrays& newton = product.newton;
  const std::int32_t k = product.iteration, pieces = newton.pieces(), here = numbers_of_piece(newton, number);
  double* const shared = static_cast<double*>(shared_memory);
  GradientState* const states = newton.states;
  const auto decide = [&](const GradientState& state) {
    if (number == 0) block.each(1, [&](std::int32_t) { states[k] = state; });
  };
  if (k > 0 && (states[k - 1].ended != 0 || states[k - 1].flat != 0)) return decide({0, 0, 1, 0});
  const double norm = std::sqrt(sum_of_pieces(block, pieces, newton.rr, shared)),
               least = k == 0 ? 1e-14 * norm : states[k - 1].least;
  if (!(norm > least)) return decide({0, 0, 1, 0});
  const double rz = sum_of_pieces(block, pieces, newton.rz, shared);
  decide({rz, least, 0, 0});
  const double beta = k == 0 ? 0 : rz / states[k - 1].rz;
  const double* const before = k == 0 ? nullptr : newton.p[(k + 1) % 2];
  double* const p = newton.p[k % 2];
  block.each(here, [&](std::int32_t m) {
    const std::int32_t n = number * piece_size + m;
    p[n] = before ? newton.z[n] + beta * before[n] : newton.z[n];
    newton.Ap[n] = row_product(newton, n, before, beta);
  });
  multiply_piece(block, number, here, p, newton.Ap, shared, newton.pAp);
}

template <class Block>
HMAX_DEVICE void run_block(std::true_type, const Block& block, const GradientUpdate& update,
                           std::int32_t number, void* shared_memory) {
  const NewtonArrays& newton = update.newton;
  const std::int32_t here = numbers_of_piece(newton, number);
  double* const shared = static_cast<double*>(shared_memory);
  GradientState& state = newton.states[update.iteration];
  if (state.ended != 0) return;
  const double curvature = sum_of_pieces(block, newton.pieces(), newton.pAp, shared);
  const bool is_flat = !(curvature > 0);
  if (number == 0)
    block.each(1, [&](std::int32_t) {
      if (is_flat)
        state.flat = 1;
      else
        ++*newton.iterations;
    });
  if (is_flat) return;
  const double step = state.rz / curvature;
  const double* const p = newton.p[update.iteration % 2];
  block.each(here, [&](std::int32_t k) {
    const std::int32_t n = number * piece_size + k;
    newton.dq[n] = newton.dq[n] + step * p[n];
    const double r = newton.residual[n] - step * newton.Ap[n];
    newton.residual[n] = r;
    newton.z[n] = r / newton.matrix.diagonal[n];
  });
  end_residual(block, newton, number, here, shared);
}

/// The largest sums of absolute values of M^(-1/2) A M^(-1/2) over a column and a row of a piece of the
/// degrees of freedom, a block of threads for each: of TissueBody::bound_of().
struct BoundPieces {
  static constexpr std::int32_t threads = piece_size;
  NewtonArrays newton;
  const double* mass;              ///< as of BodyArrays
  const std::int32_t* transposed;  ///< of each block of the matrix
  double* largest;                 ///< shape (pieces, 2)
  bool operator==(const BoundPieces&) const = default;
};
inline std::int64_t blocks_of(const BoundPieces& bound) { return bound.newton.pieces(); }
inline std::size_t shared_bytes_of(const BoundPieces&) { return 2 * sizeof(double) * piece_size; }

/// The sums over column and row n, each from first to last as the processor adds them up.
HMAX_DEVICE inline void sums_of_scaled(const BoundPieces& bound, std::int32_t n, double& column,
                                       double& row) {
  const BodyMatrix& matrix = bound.newton.matrix;
  const auto mass = [&](std::int32_t point) { return bound.mass[bound.newton.place[point]]; };
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
  const std::int32_t here = numbers_of_piece(bound.newton, number);
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
