/// What a body in patches of points is made of, in the memory of a device.
#pragma once

#include <cstdint>
#include <type_traits>

#include "core/instructions/device_code.hpp"
#include "problems/tissue/forces/kernels/spring_law.hpp"
#include "problems/tissue/forces/kernels/tet_law.hpp"
#include "problems/tissue/forces/kernels/tool_contact.hpp"

namespace hmax {

/// What the elements of a body are, beside their fibres.
enum class PatchElements : std::uint8_t {
  tetrahedra,    ///< of any law
  of_pressures,  ///< those of NodalPressure
  of_ten_nodes   ///< those of QuadraticElements
};

/// What a body has beside its elements and its linear and cubic springs. Parts whose forces need more
/// registers are compiled for the bodies that have them.
enum class PatchParts : std::uint8_t {
  few,   ///< none
  more,  ///< fibres, dampers, triangles or springs of other laws
  tools  ///< tools, and whatever else
};
template <PatchParts parts>
using PartsConstant = std::integral_constant<PatchParts, parts>;

/// What is known of a body when its steps are compiled.
template <TetLaw law_of, PatchElements elements_of, PatchParts parts>
struct BodyKind {
  static constexpr TetLaw law = law_of;
  static constexpr PatchElements elements = elements_of;
  static constexpr bool has_more = parts != PatchParts::few, has_tools = parts == PatchParts::tools;
};

/// Corners of a tetrahedron in a patch.
struct PatchCorners {
  static constexpr std::uint16_t nowhere = 0xffff;
  std::uint16_t point[4];  ///< among the points of the patch
  std::uint16_t slot[4];   ///< where the force at the corner goes; nowhere: another patch owns the point
};

/// The points of a tetrahedron of ten nodes in a patch, likewise.
struct PatchTenNodes {
  std::uint16_t point[10], slot[10];
};

/// The averages at the corners of a tetrahedron, among those of the patch.
struct PatchAverages {
  std::uint16_t of[4];
};

/// A tetrahedron of the whole body.
struct BodyTetrahedron {
  std::int32_t point[4];
  std::int32_t place;  ///< the first one in the arrays of patches
};

/// The ends of a spring in a patch, likewise: the near one and the far one.
struct PatchSpring {
  std::uint16_t point[2], slot[2];

  /// d = from the near to the far one. @param x  positions, shape (3, points)
  template <class Real>
  HMAX_DEVICE void span(std::int32_t points, const Real* x, Real* d) const {
    for (int i = 0; i < 3; ++i) d[i] = x[i * points + point[1]] - x[i * points + point[0]];
  }
  /// Puts what pulls the near end and its opposite at their slots. @param f  shape (3, slots)
  template <class Real>
  HMAX_DEVICE void pull_together(std::int32_t slots, const Real* pull, Real* f) const {
    for (int i = 0; i < 3; ++i) {
      if (slot[0] != PatchCorners::nowhere) f[i * slots + slot[0]] = pull[i];
      if (slot[1] != PatchCorners::nowhere) f[i * slots + slot[1]] = -pull[i];
    }
  }
};

/// A triangle of a skin in a patch, likewise.
struct PatchTriangle {
  std::uint16_t point[3], slot[3];
};

/// A triangle of the surface and a tool that may touch it, likewise.
template <class Real>
struct PatchContact {
  PatchTriangle triangle;
  std::int32_t tool;
  SampledTriangle<Real> samples;
};

/// Where the terms of a list begin: those of entry n are first[n] .. first[n + 1] - 1 of `of`.
struct TermLists {
  const std::int32_t *first, *of;
  bool operator==(const TermLists&) const = default;
};

/// Slots from `begin` to `end` whose sum is added as one: those of springs of a set that begin at a point.
struct SlotGroup {
  std::uint16_t begin, end;
};

/// Where the groups and the slots of a free point end.
struct PointSlots {
  std::int32_t groups;
  std::uint16_t end;
};

/// Where a patch begins in the arrays below; those of the patch after it are its ends.
struct PatchBegin {
  std::int32_t own, rim, tet, average, fibre, push, damper, triangle, contact;
};

/// The law of a set of springs, as SpringLaw has it.
template <class Real>
struct SetLaw {
  enum class Kind : std::int32_t { cubic, exponential, table };
  Kind kind;
  Real b;  ///< of CubicSpring and ExponentialSpring
  SpringLines<Real> lines;

  /// Calls use(law) with a law that has phi(s) and slope(s).
  template <class Use>
  HMAX_DEVICE void visit(const Use& use) const {
    if (kind == Kind::table) return use(lines);
    kind == Kind::exponential ? use(ExponentialSpring{b}) : use(CubicSpring{b});
  }
};

/// Pressures that tetrahedra share at their points, as NodalPressure has them.
template <class Real>
struct SharedPressures {
  std::int32_t tets;                 ///< of the body
  const BodyTetrahedron* tet;        ///< shape (tets)
  const Real* volume;                ///< V [m^3], shape (BodyArrays::tets)
  const PatchAverages* corners;      ///< likewise
  const std::int32_t* average;       ///< which averages a patch reads
  const std::int32_t *ends, *among;  ///< where the tetrahedra of an average end, and which they are, in order
  const Real *lambda, *around;       ///< of averages: lambda [Pa], V_a [m^3]
  Real* shares;                      ///< V/4 (J - 1) [m^3], shape (bodies, tets)
  bool operator==(const SharedPressures&) const = default;
};

/// Numbers that the threads of a block share: positions of `points`, forces of `slots`, pressures of
/// averages.
HMAX_DEVICE constexpr std::int64_t shared_numbers(std::int64_t points, std::int64_t slots,
                                                  std::int64_t averages) {
  return 3 * (points + slots) + averages;
}

/// The tools that a body meets.
template <class Real>
struct BodyTools {
  std::int32_t contacts;              ///< of all patches
  const PatchContact<Real>* contact;  ///< shape (contacts)
  const SphereLaw<Real>* laws;        ///< of each tool
  std::int32_t first;                 ///< where their poses begin among the numbers of an evaluation
  bool operator==(const BodyTools&) const = default;
};

/// Supports that drag free points as they move.
template <class Real>
struct SupportDrag {
  std::int32_t rates;  ///< how many they are
  std::int32_t first;  ///< where their rates begin among the numbers of an evaluation
  const Real* drag;    ///< what each does at a rate of 1/s [N], shape (rates, 3, free)
  bool operator==(const SupportDrag&) const = default;
};

/// A body, its arrays in the memory of a device, of numbers of one precision. Degrees of freedom are stored
/// x, y, z one array after the other; the points of a patch are neighbours, and those that stand still follow
/// the free ones.
template <class Real>
struct BodyArrays {
  std::int32_t patches, points, free, tets, fibres, springs, sets, dampers, triangles;
  const PatchBegin* begin;  ///< shape (patches + 1)
  const std::int32_t* rim;  ///< points of others that the tetrahedra of a patch have
  TetLaw law;
  PatchElements elements;
  const PatchCorners* corners;        ///< shape (tets)
  const Real* gradients;              ///< Bm [1/m], row after row, shape (9, tets)
  const Real *half_lambda, *mu;       ///< V lambda / 2, V mu [J], shape (tets)
  const PatchCorners* fibre_corners;  ///< shape (fibres)
  const Real* fibre;                  ///< numbers of fibre_forces(), shape (9, fibres)
  bool fibres_of_small_strain;
  SharedPressures<Real> pressures;
  /// Of ten nodes: `gradients` are numbers of TenNodeRule, shape (124, tets), `half_lambda` and `mu` are
  /// lambda / 2 and mu [Pa].
  const PatchTenNodes* ten_nodes;
  const PatchSpring* ends;           ///< of springs, shape (springs)
  const Real *per_length, *tension;  ///< 1 / L [1/m], of other laws L [m]; k L [N]; shape (springs)
  const std::int32_t* set_begin;     ///< where those of a patch and a set begin, shape (patches sets + 1)
  const SetLaw<Real>* laws;          ///< of each set
  bool has_other_laws;               ///< than linear and cubic ones
  const PatchSpring* damped;         ///< ends of dampers
  const Real* damper;                ///< c [N s/m] of each
  const PatchTriangle* skin;         ///< shape (triangles)
  const Real *skin_gradients, *skin_volume;  ///< Bm [1/m], row after row, shape (4, triangles); [m^3]
  Real skin_modulus, skin_poisson;           ///< Y / (1 - nu^2) [Pa], nu
  BodyTools<Real> tools;
  const Real* rest;                    ///< positions [m], shape (3, points); of springs, triangles and tools
  const PointSlots* slots;             ///< of each free point; they follow one another in a patch
  const SlotGroup* groups;             ///< of one point after the other, in the order of their slots
  const std::uint16_t* push_slot;      ///< slots of loads
  const std::int32_t* push_load;       ///< which load pushes there
  const Real* push_share;              ///< the share of it that does
  const Real *weight, *drag, *mass;    ///< m g [N], shape (3, free); alpha m [kg/s]; m [kg]
  const Real* anchor;                  ///< k [N/m] of the spring that holds each free point, or 0; null: none
  std::int32_t motions, first_motion;  ///< of supports; where they begin among the numbers of an evaluation
  const std::int32_t* moved_by;        ///< which motion each point that is not free has, or -1
  SupportDrag<Real> support_drag;
  const std::int32_t* damped_by;  ///< dofs whose velocities damp a free point by the stiffness at rest
  const Real* damping;            ///< of its three dofs [kg/s], shape (3, damps)
  const std::int32_t* damp_end;   ///< the end of these, of each free point
  std::int32_t damps;
  Real watch;           ///< a larger displacement [m] is told
  std::int32_t shared;  ///< numbers that a block needs, shared_numbers() of the largest patch
  [[nodiscard]] PatchParts parts() const {
    if (tools.contacts > 0) return PatchParts::tools;
    return fibres + dampers + triangles > 0 || has_other_laws ? PatchParts::more : PatchParts::few;
  }
  bool operator==(const BodyArrays&) const = default;
};

}  // namespace hmax
