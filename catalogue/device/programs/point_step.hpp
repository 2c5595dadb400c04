/// Iterations that move the points of a body one after the other, as VertexBlockDescent has them: the
/// programs of devices.
///
/// Points of one colour do not act on each other: their threads run in any order, or at once. What tetrahedra
/// do to a point is a sum of four parts, as the lanes of the processor have it, a thread for each.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "catalogue/device/programs/positional_step.hpp"
#include "core/instructions/device_code.hpp"
#include "integrators/positional/move_point.hpp"
#include "problems/tissue/positional/pieces_at_point.hpp"

namespace hmax {

/// The beginning of an iteration: a thread for each degree of freedom. It extrapolates the iteration before
/// it, keeps the iterate and finds its velocities.
struct PointIteration {
  static constexpr std::int32_t threads = 256;
  BodyStep<double> step;
  double h;              ///< of a substep
  double weight;         ///< w of Chebyshev
  const double* before;  ///< the iterate that the iteration before it began with, shape (dofs); else null
  double* kept;          ///< null where nobody extrapolates
  double* velocity;      ///< shape (3, free)
  bool operator==(const PointIteration&) const = default;
};
HMAX_DEVICE inline std::int64_t count_of(const PointIteration& iteration) {
  return 3 * static_cast<std::int64_t>(iteration.step.body.free);
}
HMAX_DEVICE inline void run_thread(std::true_type, const PointIteration& iteration, std::int64_t n) {
  const BodyStep<double>& step = iteration.step;
  const std::int64_t at = place_of(step, n);
  double q = step.q_next[at];
  if (iteration.before) {
    const double before = iteration.before[n];
    step.q_next[at] = q = iteration.weight * (q - before) + before;
  }
  if (iteration.kept) iteration.kept[n] = q;
  iteration.velocity[n] = (q - step.q[at]) / iteration.h;
}

/// Moves the points of some colours once. One colour takes as many blocks as it needs; of more of them each
/// has to fit into one.
struct MovePoints {
  static constexpr std::int32_t parts = 4, points = 64, threads = parts * points;  ///< of a block
  TermLists colours;  ///< the points of each colour
  const PointTetrahedron*
      tetrahedron;  ///< their corners are points of BodyArrays; null: the body is of springs
  const PointSpring* spring;
  TermLists pieces;  ///< of each point: 4 times the tetrahedron + its corner, or 2 times the spring + its end
  PushArrays pushes;
  BodyStep<double> step;
  double h;                 ///< of a substep
  double* velocity;         ///< of the iterate, shape (3, free)
  std::int32_t first, end;  ///< colours
  std::int32_t count;       ///< points of the first colour
  std::int32_t evaluation;  ///< of BodyStep
  bool operator==(const MovePoints&) const = default;
};
inline std::int64_t blocks_of(const MovePoints& move) {
  return (move.count + MovePoints::points - 1) / MovePoints::points;
}
/// The parts of sums, shape (9, threads).
inline std::size_t shared_bytes_of(const MovePoints& move) {
  return move.tetrahedron ? 9 * sizeof(double) * MovePoints::threads : 0;
}

/// Displacement i of the iterate.
HMAX_DEVICE inline double& iterate_at(const BodyStep<double>& step, int i, std::int32_t point) {
  return step.q_next[static_cast<std::int64_t>(i) * step.body.points + point];
}

/// What every fourth tetrahedron at point p does to it. @param to  nine numbers, one every `threads`
template <TetLaw law>
HMAX_DEVICE inline void add_part(const MovePoints& move, std::int32_t p, std::int32_t part, double* to) {
  AlongSlope<double> sum{}, felt;
  double own[3];
  for (int i = 0; i < 3; ++i) own[i] = iterate_at(move.step, i, p);
  for (std::int32_t k = move.pieces.first[p] + part; k < move.pieces.first[p + 1]; k += MovePoints::parts) {
    const std::int32_t piece = move.pieces.of[k], corner = piece % 4;
    const PointTetrahedron& tet = move.tetrahedron[piece / 4];
    double U[3][3], slopes[3][3], g[3];
    for (int other = 0; other < 3; ++other) {
      const std::int32_t c = (corner + other + 1) % 4;
      for (int i = 0; i < 3; ++i) {
        U[other][i] = iterate_at(move.step, i, tet.point[c]) - own[i];
        slopes[other][i] = tet.slopes[c][i];
      }
    }
    for (int i = 0; i < 3; ++i) g[i] = tet.slopes[corner][i];
    tetrahedron_at_point<law, double>(U, slopes, g, tet.lambda, tet.mu, felt);
    for (int i = 0; i < 3; ++i) sum.stress[i] = sum.stress[i] + felt.stress[i];
    for (int m = 0; m < 6; ++m) sum.block[m] = sum.block[m] + felt.block[m];
  }
  for (int i = 0; i < 3; ++i) to[std::ptrdiff_t{i} * MovePoints::threads] = sum.stress[i];
  for (int m = 0; m < 6; ++m) to[std::ptrdiff_t{3 + m} * MovePoints::threads] = sum.block[m];
}

/// f and K of the tetrahedra at a point. @param parts  what add_part() has written
HMAX_DEVICE inline void add_parts(const double* parts, double* f, double* K) {
  const auto sum = [&](int m) {
    const double* const part = parts + std::ptrdiff_t{m} * MovePoints::threads;
    return (part[0] + part[1]) + (part[2] + part[3]);
  };
  for (int i = 0; i < 3; ++i) f[i] = f[i] - sum(i);
  for (int j = 0; j < 3; ++j)
    for (int i = j; i < 3; ++i) K[3 * j + i] = sum(3 + kernel_loops::symmetric(i, j));
}

/// Likewise of the springs at point p, all of one set.
HMAX_DEVICE inline void add_springs(const MovePoints& move, std::int32_t p, double* f, double* K) {
  move.step.body.laws[0].visit([&](const auto& law) {
    for (std::int32_t k = move.pieces.first[p]; k < move.pieces.first[p + 1]; ++k) {
      const PointSpring& spring = move.spring[move.pieces.of[k] / 2];
      double d[3];
      for (int i = 0; i < 3; ++i)
        d[i] = spring.rest[i] + iterate_at(move.step, i, spring.point[1]) -
               iterate_at(move.step, i, spring.point[0]);
      add_spring_at_point(law, spring, move.pieces.of[k] % 2 == 0, d, f, K);
    }
  });
}

/// f -= C v, and what of C belongs to point p alone.
HMAX_DEVICE inline void damp_point(const MovePoints& move, std::int32_t p, double* f, double* C) {
  const BodyArrays<double>& body = move.step.body;
  if (body.damps == 0)
    for (int i = 0; i < 3; ++i) {
      f[i] = f[i] - body.drag[p] * move.velocity[static_cast<std::int64_t>(i) * body.free + p];
      C[std::ptrdiff_t{4} * i] = body.drag[p];
    }
  else
    for (std::int32_t n = p == 0 ? 0 : body.damp_end[p - 1]; n < body.damp_end[p]; ++n)
      for (int i = 0; i < 3; ++i) {
        const std::int32_t by = body.damped_by[n];
        const double c = body.damping[static_cast<std::int64_t>(i) * body.damps + n];
        f[i] = f[i] - c * move.velocity[by];
        for (int r = 0; r < 3; ++r)  // no index that is not known when this is compiled
          if (by == r * body.free + p) C[3 * i + r] = c;
      }
}

/// Moves point p. @param parts  of its tetrahedra; not read of springs
HMAX_DEVICE inline void move_point(const MovePoints& move, std::int32_t p, const double* parts) {
  const BodyStep<double>& step = move.step;
  const double h = move.h;
  double f[3], K[9] = {}, C[9] = {}, away[3], by[3];
  const auto dof = [&](int i) { return static_cast<std::int64_t>(i) * step.body.free + p; };
  for (int i = 0; i < 3; ++i) f[i] = step.body.weight[dof(i)];
  if (move.tetrahedron)
    add_parts(parts, f, K);
  else
    add_springs(move, p, f, K);
  for (int i = 0; i < 3; ++i) f[i] = add_loads(move.pushes, step, move.evaluation, p, i, f[i]);
  damp_point(move, p, f, C);
  for (int i = 0; i < 3; ++i) {
    const double start = step.q[static_cast<std::int64_t>(i) * step.body.points + p];
    away[i] = iterate_at(step, i, p) - (start + h * step.v[dof(i)]);
  }
  move_of_point(step.body.mass[p], h, f, K, C, away, by);
  for (int i = 0; i < 3; ++i) {
    double& q = iterate_at(step, i, p);
    q = q + by[i];
    move.velocity[dof(i)] = move.velocity[dof(i)] + by[i] / h;
  }
}

/// @tparam Kind  the law of tetrahedra, or std::true_type of springs
template <class Kind, class Block>
HMAX_DEVICE void run_block(Kind, const Block& block, const MovePoints& move, std::int32_t number,
                           void* shared) {
  double* const parts = static_cast<double*>(shared);
  for (std::int32_t colour = move.first; colour < move.end; ++colour) {
    const std::int32_t first = move.colours.first[colour] + number * MovePoints::points,
                       left = move.colours.first[colour + 1] - first,
                       here = left < MovePoints::points ? left : MovePoints::points;
    const std::int32_t* const own = move.colours.of + first;
    if constexpr (!std::is_same_v<Kind, std::true_type>) {
      block.each(here * MovePoints::parts, [&](std::int32_t n) {
        add_part<Kind::value>(move, own[n / MovePoints::parts], n % MovePoints::parts, parts + n);
      });
      block.barrier();
    }
    block.each(here, [&](std::int32_t n) {
      move_point(move, own[n], parts + std::ptrdiff_t{n} * MovePoints::parts);
    });
    block.barrier();
  }
}

}  // namespace hmax
