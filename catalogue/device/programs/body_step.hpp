/// One explicit step of bodies in patches of points: the one source of devices and of the processor.
///
/// A patch owns some free points. A block of threads computes all tetrahedra, fibres and springs at them, in
/// memory that its threads share, and adds up the forces at each point in the order in which the processor
/// does: no atomics, no second order, the same bits. Those at the rim are computed by several patches.
#pragma once

#include <cstdint>
#include <type_traits>

#include "catalogue/device/patches/patch_arrays.hpp"
#include "catalogue/device/patches/patch_forces.hpp"
#include "core/instructions/device_code.hpp"
#include "core/instructions/piece_sums.hpp"
#include "integrators/error_norm.hpp"
#include "integrators/explicit/stabilized_stages.hpp"

namespace hmax {

/// A velocity beyond it is told [m/s].
template <class Real>
inline constexpr Real immense = sizeof(Real) == sizeof(double) ? static_cast<Real>(1e100)
                                                               : static_cast<Real>(1e30);

/// What becomes of the accelerations.
enum class Move : std::int32_t {
  start,             ///< they are kept for the first kick
  symplectic_euler,  ///< v += h a, q += h v
  kick_drift,        ///< v += h/2 a twice, q += h v: the end of a step and the beginning of the next
  kick,              ///< v += h/2 a: the end of a step; they are kept
  force,             ///< they are not made: the forces are kept in their place
  stage,             ///< the slope (v, a) is kept, and (q, v) becomes the sum of StageSum
  recurrence,        ///< (q, v) becomes what StageRecurrence makes of it; in double precision
  slope              ///< the slope is kept, and nothing is made of it
};

/// The argument of the next stage of a Runge-Kutta step, y + w_0 k_0 + w_1 k_1 ..., or the end of the step,
/// y + (w_0 k_0 + w_1 k_1 ...), as ExplicitRk adds them up.
template <class Real>
struct StageSum {
  static constexpr std::int32_t most = 13;
  std::int32_t stage;  ///< whose slope is found
  std::int32_t terms;  ///< at least 1
  bool is_end;
  std::int32_t slope[most];  ///< whose stages' k_j, none later than `stage`
  Real weight[most];         ///< h a_ij or h b_j, none 0
  const Real *q, *v;         ///< y, the beginning of the step, as of BodyStep
  Real* slopes;              ///< shape (stages, 2, bodies, 3, free): v and a of each
  bool operator==(const StageSum&) const = default;
};

/// A later stage of a stabilised method: Y_j of (q, v) = Y_{j-1} and its slope, of Y_{j-2}, and of y and its
/// slope, which are those of StageSum and the first of its slopes.
template <class Real>
struct StageRecurrence {
  StabilizedStage<Real> stage;  ///< of the length of the step
  const Real *q, *v;            ///< Y_{j-2}, as of BodyStep; Y_j may take its place
  bool operator==(const StageRecurrence&) const = default;
};

/// One step of some bodies that differ in their states alone, from the displacements `q` to `q_next`, shape
/// (bodies, 3, points), and from `v` to `v_next`, (bodies, 3, free); a is as v. Of Runge-Kutta methods it is
/// one stage.
template <class Real>
struct BodyStep {
  static constexpr std::int32_t threads = 256;
  BodyArrays<Real> body;
  std::int32_t bodies;
  Move move;
  Real h, half;  ///< the step and its half
  Real *q, *q_next, *v, *v_next, *a;
  Real* half_v;        ///< velocities of half steps, of kicks whose forces meet predicted ones; else null
  const Real* lumped;  ///< D / m [1/s] of central differences, as v, see KickDriftKick; else null
  std::int32_t*
      left;  ///< becomes 1 where a displacement is beyond `watch`, a velocity immense, or neither a number
  /// Of each evaluation the forces of the loads [N], shape (loads, 3), displacements [m] and velocities [m/s]
  /// of supports, shape (motions, 2, 3), places and velocities of tools, likewise, and rates [1/s]; of steady
  /// ones those of one evaluation.
  const Real* loads;
  std::int32_t next_loads;        ///< numbers from one evaluation to the next; 0: loads are steady
  const std::int64_t* evaluated;  ///< how many evaluations `loads` has before those of a Device::run()
  std::int32_t evaluation;        ///< which one after them this is
  StageSum<Real> sum;
  StageRecurrence<Real> recurrence;
  bool operator==(const BodyStep&) const = default;
};

/// Loads and supports at an evaluation after those of BodyStep::evaluated.
template <class Real>
HMAX_DEVICE inline const Real* loads_of(const BodyStep<Real>& step, std::int64_t evaluation) {
  return step.loads + (*step.evaluated + evaluation) * step.next_loads;
}

/// Where the displacement of a degree of freedom stands, all bodies counted.
template <class Real>
HMAX_DEVICE inline std::int64_t place_of(const BodyStep<Real>& step, std::int64_t dof) {
  return dof / step.body.free * step.body.points + dof % step.body.free;
}

/// Tells whether a new displacement or velocity is too large, or no number.
template <class Real>
HMAX_DEVICE inline void watch(const BodyStep<Real>& step, Real q, Real v) {
  const Real distance = q < 0 ? -q : q, speed = v < 0 ? -v : v;
  if (!(distance <= step.body.watch && speed <= immense<Real>)) *step.left = 1;
}

/// Component k of the motion of a point that is not free: 0 to 2 of its displacement, 3 to 5 of its velocity.
/// @param loads  of the evaluation
template <class Real>
HMAX_DEVICE inline Real held_motion(const BodyArrays<Real>& body, const Real* loads, std::int32_t point,
                                    std::int32_t k) {
  const std::int32_t motion = body.motions > 0 ? body.moved_by[point - body.free] : -1;
  return motion < 0 ? static_cast<Real>(0) : loads[body.first_motion + 6 * motion + k];
}

/// Component i of the displacement of a point of body `number`.
/// @param loads  of the evaluation
template <class Real>
HMAX_DEVICE inline Real displacement_of(const BodyStep<Real>& step, std::int32_t number, const Real* loads,
                                        std::int32_t point, std::int32_t i) {
  return point < step.body.free
             ? step.q[(3 * static_cast<std::int64_t>(number) + i) * step.body.points + point]
             : held_motion(step.body, loads, point, i);
}

/// Component i of the velocity of a point.
/// @param v      of the free points of its body
/// @param loads  of the evaluation
template <class Real>
HMAX_DEVICE inline Real velocity_of(const BodyArrays<Real>& body, const Real* v, const Real* loads,
                                    std::int32_t point, std::int32_t i) {
  return point < body.free ? v[static_cast<std::int64_t>(i) * body.free + point]
                           : held_motion(body, loads, point, 3 + i);
}

/// What tetrahedron `tet` of body `number` adds to the averages at its corners.
/// @param loads  of the evaluation
template <class Real>
HMAX_DEVICE inline void share_volume(const BodyStep<Real>& step, std::int32_t tet, std::int32_t number,
                                     const Real* loads) {
  const BodyArrays<Real>& body = step.body;
  const SharedPressures<Real>& own = body.pressures;
  const BodyTetrahedron corners = own.tet[tet];
  Real U[3][3], g[3][3], H[3][3];
  for (int i = 0; i < 3; ++i) {
    const Real u0 = displacement_of(step, number, loads, corners.point[0], i);
    for (int a = 0; a < 3; ++a) U[a][i] = displacement_of(step, number, loads, corners.point[a + 1], i) - u0;
  }
  rows_of_gradients(body, corners.place, g);
  kernel_loops::displacement_gradient<OneElement<Real>, Real>(U, g, H);
  own.shares[static_cast<std::int64_t>(number) * own.tets + tet] =
      own.volume[corners.place] / 4 * kernel_loops::volume_change<OneElement<Real>, Real>(H);
}

/// The sum at free point p in the order of the processor.
/// @param s  its first slot
/// @param f  of one component
template <class Real>
HMAX_DEVICE inline Real sum_of(const BodyArrays<Real>& body, std::int32_t p, std::int32_t s, const Real* f) {
  const PointSlots here = body.slots[p];
  Real sum = 0;
  for (std::int32_t n = p == 0 ? 0 : body.slots[p - 1].groups; n < here.groups; ++n) {
    const SlotGroup group = body.groups[n];
    Real own = 0;
    for (; s < group.begin; ++s) sum = sum + f[s];
    for (; s < group.end; ++s) own = own + f[s];
    sum = sum + own;
  }
  for (; s < here.end; ++s) sum = sum + f[s];
  return sum;
}

/// What all velocities damp degree of freedom i of free point p with, in the order of the processor [N].
/// @param v  of the body
template <class Real>
HMAX_DEVICE inline Real damping_of(const BodyStep<Real>& step, std::int32_t i, std::int32_t p,
                                   const Real* v) {
  const BodyArrays<Real>& body = step.body;
  Real sum = 0;
  for (std::int32_t n = p == 0 ? 0 : body.damp_end[p - 1]; n < body.damp_end[p]; ++n)
    sum = sum + v[body.damped_by[n]] * body.damping[static_cast<std::int64_t>(i) * body.damps + n];
  return sum;
}

/// The numbers of one array of slopes, which are as velocities.
template <class Real>
HMAX_DEVICE inline std::int64_t slope_size(const BodyStep<Real>& step) {
  return 3 * static_cast<std::int64_t>(step.body.free) * step.bodies;
}

/// w_0 k_0 + (w_1 k_1 ...), from left to right, or the same added to y.
/// @param k     slopes of a degree of freedom, one every `next` numbers
template <class Real>
HMAX_DEVICE inline Real add_slopes(const StageSum<Real>& sum, const Real* y, const Real* k,
                                   std::int64_t next) {
  Real all = sum.weight[0] * k[sum.slope[0] * next];
  if (y) all = *y + all;
  for (std::int32_t n = 1; n < sum.terms; ++n) all = all + sum.weight[n] * k[sum.slope[n] * next];
  return all;
}

/// What y, the displacement or velocity of a degree of freedom at the beginning of a step, becomes.
template <class Real>
HMAX_DEVICE inline Real stage_sum(const StageSum<Real>& sum, Real y, const Real* k, std::int64_t next) {
  return sum.is_end ? y + add_slopes<Real>(sum, nullptr, k, next) : add_slopes(sum, &y, k, next);
}

/// Puts what follows from the slopes into q and v.
template <class Real>
HMAX_DEVICE inline void sum_slopes(const BodyStep<Real>& step, std::int64_t at, std::int64_t dof, Real& q,
                                   Real& v) {
  const StageSum<Real>& sum = step.sum;
  const std::int64_t size = slope_size(step);
  const Real* const k = sum.slopes + dof;
  q = stage_sum(sum, sum.q[at], k, 2 * size);
  v = stage_sum(sum, sum.v[dof], k + size, 2 * size);
}

/// Keeps the slope (v, a).
template <class Real>
HMAX_DEVICE inline void keep_slope(const BodyStep<Real>& step, std::int64_t dof, Real v, Real a) {
  const std::int64_t size = slope_size(step);
  Real* const k = step.sum.slopes + dof;
  k[2 * step.sum.stage * size] = v;
  k[(2 * step.sum.stage + 1) * size] = a;
}

/// Puts the next stage of a stabilised method into q and v, which are those of the stage before.
template <class Real>
HMAX_DEVICE inline void next_stage(const BodyStep<Real>& step, std::int64_t at, std::int64_t dof, Real a,
                                   Real& q, Real& v) {
  const StageRecurrence<Real>& own = step.recurrence;
  const Real* const first = step.sum.slopes + dof;
  q = own.stage.of(q, own.q[at], step.sum.q[at], v, first[0]);
  v = own.stage.of(v, own.v[dof], step.sum.v[dof], a, first[slope_size(step)]);
}

/// The end of a step of kicks, and of kick_drift the beginning of the next, as KickDriftKick has them.
template <class Real>
HMAX_DEVICE inline void end_kick(const BodyStep<Real>& step, std::int64_t dof, Real a, Real& q, Real& v) {
  if (step.lumped) {
    const Real damping = step.half * step.lumped[dof];
    a = (a + damping * step.a[dof]) * (1 / (1 + damping));
  }
  if (step.half_v) v = step.half_v[dof];
  v = v + step.half * a;
  if (step.move == Move::kick || step.lumped) step.a[dof] = a;
  if (step.move == Move::kick) return;
  v = v + step.half * a;
  q = q + step.h * v;
  if (!step.half_v) return;
  step.half_v[dof] = v;
  v = v + step.half * a;
}

/// The new q and v of component i of free point p, of body `number`.
/// @param loads  of the evaluation
template <class Real>
HMAX_DEVICE inline void move_point(const BodyStep<Real>& step, const Real* loads, Real force, std::int32_t i,
                                   std::int32_t p, std::int32_t number) {
  const std::int64_t first = 3 * static_cast<std::int64_t>(number) * step.body.free,
                     dof = first + static_cast<std::int64_t>(i) * step.body.free + p,
                     at = (3 * static_cast<std::int64_t>(number) + i) * step.body.points + p;
  Real q = step.q[at], v = step.v[dof];
  Real all = (force + step.body.weight[dof - first]) - step.body.drag[p] * v;
  if (step.body.anchor && step.body.anchor[p] != 0) all = all - step.body.anchor[p] * q;
  if (step.body.damps > 0) all = all - damping_of(step, i, p, step.v + first);
  const SupportDrag<Real>& dragging = step.body.support_drag;
  for (std::int32_t n = 0; n < dragging.rates; ++n)
    if (const Real rate = loads[dragging.first + n]; rate != 0)
      all = all - rate * dragging.drag[(3 * static_cast<std::int64_t>(n) + i) * step.body.free + p];
  if (step.move == Move::force) {
    step.a[dof] = all;
    return;
  }
  const Real a = all / step.body.mass[p];
  if (step.move == Move::stage || step.move == Move::slope) keep_slope(step, dof, v, a);
  if (step.move == Move::slope) return;
  if (step.move == Move::start) step.a[dof] = a;
  if (step.move == Move::symplectic_euler) v = v + step.h * a, q = q + step.h * v;
  if (step.move == Move::kick_drift || step.move == Move::kick) end_kick(step, dof, a, q, v);
  if (step.move == Move::stage) sum_slopes(step, at, dof, q, v);
  if constexpr (std::is_same_v<Real, double>)
    if (step.move == Move::recurrence) next_stage(step, at, dof, a, q, v);
  watch(step, q, v);
  step.q_next[at] = q;
  step.v_next[dof] = v;
}

/// Springs, dampers, triangles and tools of a patch, each at its slots.
/// @param loads    of the evaluation
/// @param of_body  of_body(p) is the number of point p of the patch in the body
/// @param x        positions
template <class Kind, class Block, class Real, class OfBody>
HMAX_DEVICE inline void position_forces(Kind, const Block& block, const BodyStep<Real>& step,
                                        std::int32_t patch, std::int32_t number, const Real* loads,
                                        const OfBody& of_body, std::int32_t points, std::int32_t slots,
                                        const Real* x, Real* f) {
  const BodyArrays<Real>& body = step.body;
  const std::int32_t* const of_set = body.set_begin + static_cast<std::int64_t>(patch) * body.sets;
  for (std::int32_t set = 0; set < body.sets; ++set) {
    const auto each_spring = [&](const auto& law) {
      block.each(of_set[set + 1] - of_set[set],
                 [&](std::int32_t n) { spring_forces(body, of_set[set] + n, law, points, slots, x, f); });
    };
    if constexpr (Kind::has_more)
      if (body.laws[set].kind != SetLaw<Real>::Kind::cubic) {
        each_spring(body.laws[set]);
        continue;
      }
    each_spring(body.laws[set].b);
  }
  if constexpr (Kind::has_more) {
    const PatchBegin from = body.begin[patch], to = body.begin[patch + 1];
    const Real* const v = step.v + 3 * static_cast<std::int64_t>(number) * body.free;
    const auto velocity = [&](std::int32_t p, std::int32_t i) {
      return velocity_of(body, v, loads, of_body(p), i);
    };
    block.each(to.damper - from.damper,
               [&](std::int32_t n) { damper_forces(body, from.damper + n, points, slots, x, velocity, f); });
    block.each(to.triangle - from.triangle,
               [&](std::int32_t n) { triangle_forces(body, from.triangle + n, points, slots, x, f); });
    if constexpr (Kind::has_tools)
      block.each(to.contact - from.contact, [&](std::int32_t n) {
        contact_forces(body, from.contact + n, loads, points, slots, x, velocity, f);
      });
  }
}

/// The step of one patch of body `number`.
/// @tparam Kind   BodyKind of the body
/// @tparam Block  see device_program.hpp
/// @param later   evaluations of loads between BodyStep::evaluation and this one
/// @param shared  shared_numbers() of them
template <class Kind, class Block, class Real>
HMAX_DEVICE void body_step(Kind kind, const Block& block, const BodyStep<Real>& step, std::int32_t patch,
                           std::int32_t number, std::int64_t later, Real* shared) {
  const BodyArrays<Real>& body = step.body;
  const PatchBegin from = body.begin[patch], to = body.begin[patch + 1];
  const std::int32_t own = to.own - from.own, points = own + to.rim - from.rim,
                     slots = body.slots[to.own - 1].end;
  Real* const u = shared;
  Real* const f = shared + 3 * points;
  const auto of_body = [&](std::int32_t p) { return p < own ? from.own + p : body.rim[from.rim + p - own]; };
  const Real* const loads = loads_of(step, step.evaluation + later);
  Real* const pressures = f + 3 * slots;
  block.each(points, [&](std::int32_t p) {
    const std::int32_t point = of_body(p);
    for (int i = 0; i < 3; ++i) u[i * points + p] = displacement_of(step, number, loads, point, i);
  });
  block.each(to.push - from.push, [&](std::int32_t n) {
    const std::int32_t push = from.push + n;
    for (int i = 0; i < 3; ++i)
      f[i * slots + body.push_slot[push]] = body.push_share[push] * loads[3 * body.push_load[push] + i];
  });
  if constexpr (Kind::elements == PatchElements::of_pressures) {
    const SharedPressures<Real>& own_pressures = body.pressures;
    const Real* const shares = own_pressures.shares + static_cast<std::int64_t>(number) * own_pressures.tets;
    block.each(to.average - from.average, [&](std::int32_t n) {
      pressures[n] = shared_pressure(own_pressures, own_pressures.average[from.average + n], shares);
    });
  }
  block.barrier();
  block.each(to.tet - from.tet, [&](std::int32_t n) {
    if constexpr (Kind::elements == PatchElements::of_ten_nodes)
      ten_node_forces(body, from.tet + n, points, slots, u, f);
    else
      tetrahedron_forces<Kind>(body, from.tet + n, points, slots, u, pressures, f);
  });
  if constexpr (Kind::has_more)
    block.each(to.fibre - from.fibre,
               [&](std::int32_t n) { fibre_forces(body, from.fibre + n, points, slots, u, f); });
  const std::int32_t* const of_set = body.set_begin + static_cast<std::int64_t>(patch) * body.sets;
  if (of_set[body.sets] > of_set[0] ||
      (Kind::has_more &&
       (to.damper > from.damper || to.triangle > from.triangle || to.contact > from.contact))) {
    block.barrier();
    block.each(points, [&](std::int32_t p) {
      const std::int32_t point = of_body(p);
      for (int i = 0; i < 3; ++i)
        u[i * points + p] = body.rest[static_cast<std::int64_t>(i) * body.points + point] + u[i * points + p];
    });
    block.barrier();
    position_forces(kind, block, step, patch, number, loads, of_body, points, slots, u, f);
  }
  block.barrier();
  block.each(3 * own, [&](std::int32_t n) {
    const std::int32_t i = n / own, p = from.own + n % own;
    const std::int32_t first = p == from.own ? 0 : body.slots[p - 1].end;
    move_point(step, loads, sum_of(body, p, first, f + i * slots), i, p, number);
  });
}

/// Steps of bodies that are one patch each: a block takes all of them, one after the other.
template <class Real>
struct BodySteps {
  static constexpr std::int32_t threads = 256;
  const BodyStep<Real>* steps;  ///< in the memory of the device
  std::int32_t count;
  std::int64_t times;  ///< over and over again
  std::int32_t bodies, shared;
  TetLaw law;
  PatchParts parts;
  PatchElements elements;
};
template <class Kind, class Block, class Real>
HMAX_DEVICE void body_steps(Kind kind, const Block& block, const BodySteps<Real>& all, std::int32_t number,
                            Real* shared) {
  for (std::int64_t done = 0; done < all.times; ++done)
    for (std::int32_t n = 0; n < all.count; ++n) {
      const BodyStep<Real>& step = all.steps[n];
      if constexpr (Kind::elements == PatchElements::of_pressures) {
        const Real* const loads = loads_of(step, step.evaluation + done * all.count);
        block.each(step.body.pressures.tets,
                   [&](std::int32_t tet) { share_volume(step, tet, number, loads); });
        block.barrier();
      }
      body_step(kind, block, step, 0, number, done * all.count, shared);
      block.barrier();
    }
}

/// The volumes that BodyStep reads of PatchElements::of_pressures, where its body is not one of BodySteps.
template <class Real>
struct VolumeShares {
  static constexpr std::int32_t threads = 256;
  BodyStep<Real> step;
  std::int32_t evaluation;  ///< of BodyStep
  bool operator==(const VolumeShares&) const = default;
};
template <class Real>
HMAX_DEVICE std::int64_t count_of(const VolumeShares<Real>& shares) {
  return static_cast<std::int64_t>(shares.step.body.pressures.tets) * shares.step.bodies;
}
/// Of one tetrahedron of one body.
template <class Real>
HMAX_DEVICE inline void run_thread(std::true_type, const VolumeShares<Real>& shares, std::int64_t n) {
  const std::int32_t tets = shares.step.body.pressures.tets;
  share_volume(shares.step, static_cast<std::int32_t>(n % tets), static_cast<std::int32_t>(n / tets),
               loads_of(shares.step, shares.evaluation));
}

/// The first kick and drift of a run of steps, from accelerations that are known.
template <class Real>
struct FirstKick {
  static constexpr std::int32_t threads = 256;
  BodyStep<Real> step;
  bool operator==(const FirstKick&) const = default;
};
template <class Real>
HMAX_DEVICE std::int64_t count_of(const FirstKick<Real>& first) {
  return 3 * static_cast<std::int64_t>(first.step.body.free) * first.step.bodies;
}
/// Of one degree of freedom.
template <class Real>
HMAX_DEVICE inline void run_thread(std::true_type, const FirstKick<Real>& first, std::int64_t dof) {
  const BodyStep<Real>& step = first.step;
  const std::int64_t at = place_of(step, dof);
  const Real v = step.v[dof] + step.half * step.a[dof], q = step.q[at] + step.h * v;
  watch(step, q, v);
  step.q_next[at] = q;
  if (step.half_v) step.half_v[dof] = v;
  step.v[dof] = step.half_v ? v + step.half * step.a[dof] : v;
}

/// The argument of the second stage where the slope of the first is known.
template <class Real>
struct KnownStage {
  static constexpr std::int32_t threads = 256;
  BodyStep<Real> step;  ///< as of stage 0
  std::int32_t stage;   ///< whose slope it is; it becomes that of stage 0
  bool operator==(const KnownStage&) const = default;
};
template <class Real>
HMAX_DEVICE std::int64_t count_of(const KnownStage<Real>& known) {
  return slope_size(known.step);
}
/// Of one degree of freedom.
template <class Real>
HMAX_DEVICE inline void run_thread(std::true_type, const KnownStage<Real>& known, std::int64_t dof) {
  const BodyStep<Real>& step = known.step;
  const std::int64_t at = place_of(step, dof), size = slope_size(step);
  const Real* const k = step.sum.slopes + 2 * known.stage * size + dof;
  keep_slope(step, dof, k[0], k[size]);
  sum_slopes(step, at, dof, step.q_next[at], step.v_next[dof]);
}

/// The error of an attempt from (step.sum.q, step.sum.v) to (step.q_next, step.v_next), step.sum of its
/// slopes: what squared_by_pieces() has of each piece, a block of threads. Numbers are in the order of the
/// body, those of q before those of v, x, y, z of one free point after the other.
struct ErrorPieces {
  static constexpr std::int32_t threads = piece_size;
  BodyStep<double> step;
  const std::int32_t* place = nullptr;  ///< of each free point of the body: its number in BodyArrays
  AnyNorm<double> norm{};
  double* pieces = nullptr;
  bool is_of_ends = false;  ///< stabilized_error() of the first two slopes, else the sum of slopes

  [[nodiscard]] HMAX_DEVICE std::int64_t numbers() const {
    return 6 * static_cast<std::int64_t>(step.body.free);
  }
};
inline std::int64_t blocks_of(const ErrorPieces& errors) {
  return (errors.numbers() + piece_size - 1) / piece_size;
}
inline std::size_t shared_bytes_of(const ErrorPieces&) { return sizeof(double) * piece_size; }

template <class Norm, class Block>
HMAX_DEVICE void run_block(std::type_identity<Norm>, const Block& block, const ErrorPieces& errors,
                           std::int32_t number, void* shared) {
  const BodyStep<double>& step = errors.step;
  const Norm norm{errors.norm.rtol, errors.norm.atol};
  const std::int64_t first = static_cast<std::int64_t>(number) * piece_size, left = errors.numbers() - first,
                     dofs = errors.numbers() / 2, size = slope_size(step);
  const std::int32_t here = left < piece_size ? static_cast<std::int32_t>(left) : piece_size;
  double* const squares = static_cast<double*>(shared);
  block.each(here, [&](std::int32_t n) {
    const bool is_q = first + n < dofs;
    const std::int64_t i = is_q ? first + n : first + n - dofs, row = i % 3, point = errors.place[i / 3],
                       at = row * step.body.points + point, dof = row * step.body.free + point;
    const double* const k = step.sum.slopes + (is_q ? dof : size + dof);
    const double y = is_q ? step.sum.q[at] : step.sum.v[dof],
                 y_new = is_q ? step.q_next[at] : step.v_next[dof];
    const double e = errors.is_of_ends ? stabilized_error(step.h, y, y_new, k[0], k[2 * size])
                                       : add_slopes<double>(step.sum, nullptr, k, 2 * size);
    squares[n] = norm.square(i, y, y_new, e);
  });
  block.barrier();
  block.each(1, [&](std::int32_t) {
    double all = 0;
    for (std::int32_t n = 0; n < here; ++n) norm.take(squares[n], all);
    errors.pieces[number] = all;
  });
}

}  // namespace hmax
