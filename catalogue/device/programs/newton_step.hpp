/// Newton iterations of a body, each of a few conjugate gradients, as TruncatedNewton has them: the
/// programs of devices.
///
/// Vectors of degrees of freedom are in the order of the body, x, y, z of one free point after the other;
/// displacements and velocities are stored as those of BodyStep. Whether conjugate gradients have ended is
/// decided on the device: programs after that do nothing, so that steps are one list of programs.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "catalogue/device/programs/body_step.hpp"
#include "catalogue/device/programs/stiffness_step.hpp"
#include "core/instructions/device_code.hpp"
#include "core/instructions/piece_sums.hpp"

namespace hmax {

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
  double *inertial, *residual, *z, *p[2], *Ap, *dq;  ///< shape (dofs)
  double *rr, *rz, *pAp;                             ///< products, of each piece
  GradientState* states;                             ///< of conjugate gradients
  std::int64_t* iterations;                          ///< how many there were
  bool operator==(const NewtonArrays&) const = default;
};

/// Where degree of freedom n of the body stands among displacements and among velocities.
struct DofPlace {
  std::int64_t at, dof;
  HMAX_DEVICE DofPlace(const NewtonArrays& arrays, const BodyStep<double>& step, std::int64_t n)
      : at(n % 3 * step.body.points + arrays.matrix.place[n / 3]),
        dof(n % 3 * step.body.free + arrays.matrix.place[n / 3]) {}
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

HMAX_DEVICE inline std::int64_t count_of(const DofProgram& program) { return program.newton.matrix.dofs(); }
/// Those of points that are not free come after those of the body.
HMAX_DEVICE inline std::int64_t count_of(const NewtonBegin& begin) {
  return begin.step.body.motions > 0 ? 3 * static_cast<std::int64_t>(begin.step.body.points)
                                     : begin.newton.matrix.dofs();
}
HMAX_DEVICE inline void run_thread(std::true_type, const NewtonBegin& begin, std::int64_t n) {
  if (n >= begin.newton.matrix.dofs()) {
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

/// A program of pieces of the degrees of freedom, a block of threads for each.
struct PieceProgram {
  static constexpr std::int32_t threads = piece_size;
  NewtonArrays newton;
  std::int32_t iteration;  ///< of conjugate gradients
  bool operator==(const PieceProgram&) const = default;
};
inline std::int64_t blocks_of(const PieceProgram& program) { return program.newton.matrix.pieces(); }
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
  const std::int32_t here = numbers_of_piece(newton.matrix, number);
  const double h = newton.h;
  block.each(here, [&](std::int32_t k) {
    const std::int32_t n = number * piece_size + k;
    const DofPlace place(newton, begin.step, n);
    const double mass = begin.step.body.mass[newton.matrix.place[n / 3]];
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
  const std::int32_t k = product.iteration, pieces = newton.matrix.pieces(),
                     here = numbers_of_piece(newton.matrix, number);
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
  const std::int32_t here = numbers_of_piece(newton.matrix, number);
  double* const shared = static_cast<double*>(shared_memory);
  GradientState& state = newton.states[update.iteration];
  if (state.ended != 0) return;
  const double curvature = sum_of_pieces(block, newton.matrix.pieces(), newton.pAp, shared);
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

}  // namespace hmax
