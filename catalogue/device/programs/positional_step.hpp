/// Substeps of methods that move points one after the other or meet compliant constraints, PositionalEuler:
/// the programs of devices. Those of CompliantConstraints are here, those of points in point_step.hpp.
///
/// Constraints of one colour have no point in common: their threads run in any order, or at once.
/// Displacements and velocities are stored as those of BodyStep; the iterate stands in step.q_next.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "catalogue/device/programs/body_step.hpp"
#include "catalogue/device/programs/newton_step.hpp"
#include "core/instructions/device_code.hpp"
#include "integrators/positional/meet_constraint.hpp"
#include "problems/tissue/positional/element_constraints.hpp"

namespace hmax {

/// Loads at the points that they push.
struct PushArrays {
  TermLists at_point;  ///< of each free point of BodyArrays: its places in the two arrays below
  const std::int32_t* load;
  const double *share, *force;  ///< force [N] of each load, shape (loads, 3)
  bool operator==(const PushArrays&) const = default;
};

/// f and component i of the loads on point p, in the order of the processor.
/// @param step  of its loads only the factors of each, shape (evaluations, loads)
HMAX_DEVICE inline double add_loads(const PushArrays& pushes, const BodyStep<double>& step,
                                    std::int32_t evaluation, std::int32_t p, int i, double f) {
  const double* const factor = step.loads + (*step.evaluated + evaluation) * step.next_loads;
  for (std::int32_t k = pushes.at_point.first[p]; k < pushes.at_point.first[p + 1]; ++k) {
    const std::int32_t push = pushes.at_point.of[k], which = pushes.load[push];
    f = f + factor[which] * pushes.share[push] * pushes.force[3 * which + i];
  }
  return f;
}

/// Where the body would be without elastic forces: a thread for each degree of freedom.
struct SubstepBegin {
  static constexpr std::int32_t threads = 256;
  PushArrays pushes;
  BodyStep<double> step;
  double h, drag;           ///< of a substep; 1 + alpha h
  double* weight;           ///< w_i [1/kg] of constraints, shape (free); null where nobody asks for them
  std::int32_t evaluation;  ///< of BodyStep
  bool operator==(const SubstepBegin&) const = default;
};
HMAX_DEVICE inline std::int64_t count_of(const SubstepBegin& begin) {
  return 3 * static_cast<std::int64_t>(begin.step.body.free);
}
HMAX_DEVICE inline void run_thread(std::true_type, const SubstepBegin& begin, std::int64_t n) {
  const BodyStep<double>& step = begin.step;
  const auto i = static_cast<std::int32_t>(n / step.body.free),
             p = static_cast<std::int32_t>(n % step.body.free);
  const double load = add_loads(begin.pushes, step, begin.evaluation, p, i, step.body.weight[n]);
  const double h = begin.h, mass = step.body.mass[p];
  const std::int64_t at = static_cast<std::int64_t>(i) * step.body.points + p;
  step.q_next[at] = step.q[at] + (h * step.v[n] + h * h * load / mass) / begin.drag;
  if (begin.weight && i == 0) begin.weight[p] = 1 / (mass * begin.drag);
}

/// The constraint of a spring, its ends points of BodyArrays.
struct DeviceSpring {
  double rest[3], length, compliance;  ///< from the first to the second [m]
  std::int32_t point[2];
};

/// The two constraints of a tetrahedron, likewise.
struct DeviceTetrahedron {
  double gradients[9], excess;  ///< Bm [1/m], row after row; a - 1
  double compliance[2];         ///< deviatoric, volumetric
  std::int32_t point[4];
};

/// What the programs of a substep share. Numbers of constraints are those of TissueConstraints, springs
/// first.
struct ConstraintArrays {
  std::int32_t springs;  ///< how many
  const DeviceSpring* spring;
  const DeviceTetrahedron* tetrahedron;
  TermLists colours;  ///< the constraints of each colour
  double* lambda;     ///< shape (constraints)
  double* weight;     ///< of SubstepBegin
  MeetingRule rule;
  bool operator==(const ConstraintArrays&) const = default;
};

/// Meets the constraints of some colours. One colour takes as many blocks as it needs; of more of them, over
/// and over again, each has to fit into one.
struct MeetColours {
  static constexpr std::int32_t threads = 256;
  ConstraintArrays arrays;
  const double* start;  ///< displacements at the start of the substep, shape (3, points)
  double* q;
  std::int32_t points, free;
  std::int32_t first, end;  ///< colours
  std::int32_t count;       ///< constraints of the first colour
  std::int32_t times;
  bool is_first, resets;  ///< multipliers are 0 before the first iteration here, before each
  bool operator==(const MeetColours&) const = default;
};
inline std::int64_t blocks_of(const MeetColours& meet) {
  return (meet.count + MeetColours::threads - 1) / MeetColours::threads;
}
inline std::size_t shared_bytes_of(const MeetColours&) { return 0; }

/// The points of a constraint, for meet_constraint().
template <int count>
struct DevicePoints {
  const MeetColours& meet;
  const std::int32_t (&point)[count];
  const double (&slopes)[count][3];
  [[nodiscard]] HMAX_DEVICE std::int64_t place(int i, int axis) const {
    return static_cast<std::int64_t>(axis) * meet.points + point[i];
  }
  [[nodiscard]] HMAX_DEVICE bool moves(int i) const { return point[i] < meet.free; }
  [[nodiscard]] HMAX_DEVICE const double* gradient(int i) const { return slopes[i]; }
  [[nodiscard]] HMAX_DEVICE double weight(int i) const { return meet.arrays.weight[point[i]]; }
  [[nodiscard]] HMAX_DEVICE double& q(int i, int axis) const { return meet.q[place(i, axis)]; }
  [[nodiscard]] HMAX_DEVICE double start(int i, int axis) const { return meet.start[place(i, axis)]; }
};

HMAX_DEVICE inline void meet_spring(const MeetColours& meet, const DeviceSpring& spring, double& lambda) {
  double d[3], slopes[2][3];
  const DevicePoints<2> points{meet, spring.point, slopes};
  for (int i = 0; i < 3; ++i) d[i] = spring.rest[i] + points.q(1, i) - points.q(0, i);
  const double value = spring_constraint(d, spring.length, slopes);
  meet_constraint(meet.arrays.rule, value, spring.compliance, points, 2, lambda);
}

HMAX_DEVICE inline void meet_tetrahedron(const MeetColours& meet, const DeviceTetrahedron& tetrahedron,
                                         bool volumetric, double& lambda) {
  double U[3][3], g[3][3], slopes[4][3], value = 0;
  const DevicePoints<4> points{meet, tetrahedron.point, slopes};
  for (int a = 0; a < 3; ++a)
    for (int i = 0; i < 3; ++i) {
      U[a][i] = points.q(a + 1, i) - points.q(0, i);
      g[a][i] = tetrahedron.gradients[3 * a + i];
    }
  tetrahedron_constraint<double>(U, g, volumetric, tetrahedron.excess, value, slopes);
  meet_constraint(meet.arrays.rule, value, tetrahedron.compliance[volumetric ? 1 : 0], points, 4, lambda);
}

template <class Block>
HMAX_DEVICE void run_block(std::true_type, const Block& block, const MeetColours& meet, std::int32_t number,
                           void*) {
  const ConstraintArrays& arrays = meet.arrays;
  for (std::int32_t time = 0; time < meet.times; ++time)
    for (std::int32_t colour = meet.first; colour < meet.end; ++colour) {
      const std::int32_t first = arrays.colours.first[colour] + number * MeetColours::threads,
                         left = arrays.colours.first[colour + 1] - first;
      block.each(left < MeetColours::threads ? left : MeetColours::threads, [&](std::int32_t n) {
        const std::int32_t constraint = arrays.colours.of[first + n],
                           of_tetrahedra = constraint - arrays.springs;
        double lambda = meet.resets || (meet.is_first && time == 0) ? 0 : arrays.lambda[constraint];
        if (of_tetrahedra < 0)
          meet_spring(meet, arrays.spring[constraint], lambda);
        else
          meet_tetrahedron(meet, arrays.tetrahedron[of_tetrahedra / 2], of_tetrahedra % 2 == 1, lambda);
        arrays.lambda[constraint] = lambda;
      });
      block.barrier();
    }
}

/// The velocities of a substep: a thread for each degree of freedom.
struct SubstepEnd {
  static constexpr std::int32_t threads = 256;
  BodyStep<double> step;
  double h;
  bool operator==(const SubstepEnd&) const = default;
};
HMAX_DEVICE inline std::int64_t count_of(const SubstepEnd& end) {
  return 3 * static_cast<std::int64_t>(end.step.body.free);
}
HMAX_DEVICE inline void run_thread(std::true_type, const SubstepEnd& end, std::int64_t n) {
  const BodyStep<double>& step = end.step;
  const std::int64_t at = place_of(step, n);
  const double q = step.q_next[at], v = (q - step.q[at]) / end.h;
  watch(step, q, v);
  step.v_next[n] = v;
}

}  // namespace hmax
