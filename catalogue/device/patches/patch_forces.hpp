/// The forces of the parts of a body at the points of a patch, each at its slot: of one tetrahedron, spring,
/// triangle and so on, by the functions that the processor has too.
#pragma once

#include <cstdint>

#include "catalogue/device/patches/patch_arrays.hpp"
#include "core/instructions/device_code.hpp"
#include "problems/tissue/forces/kernels/element_pull.hpp"
#include "problems/tissue/forces/kernels/one_element.hpp"
#include "problems/tissue/forces/kernels/tool_contact.hpp"

namespace hmax {

/// U = (u1 - u0, u2 - u0, u3 - u0) of four of these points, column a at U[a].
template <class Place, class Real>
HMAX_DEVICE inline void edges(const Place* point, std::int32_t points, const Real* u, Real (*U)[3]) {
  for (int a = 0; a < 3; ++a)
    for (int i = 0; i < 3; ++i) U[a][i] = u[i * points + point[a + 1]] - u[i * points + point[0]];
}

/// Bm, row a at g[a].
template <class Real>
HMAX_DEVICE inline void rows_of_gradients(const BodyArrays<Real>& body, std::int32_t tet, Real (*g)[3]) {
  for (int k = 0; k < 9; ++k)
    g[k / 3][k % 3] = body.gradients[static_cast<std::int64_t>(k) * body.tets + tet];
}

/// The pressure lambda (J_a - 1) of an average, from the shares of its body.
template <class Real>
HMAX_DEVICE inline Real shared_pressure(const SharedPressures<Real>& own, std::int32_t average,
                                        const Real* shares) {
  Real sum = 0;
  for (std::int32_t n = average == 0 ? 0 : own.ends[average - 1]; n < own.ends[average]; ++n)
    sum = sum + shares[own.among[n]];
  return own.lambda[average] * (sum / own.around[average]);
}

/// -pull at the corners 1 to 3 and their sum at corner 0, each at its slot.
/// @param pressures  of the averages of the patch
template <class Kind, class Real>
HMAX_DEVICE inline void tetrahedron_forces(const BodyArrays<Real>& body, std::int32_t tet,
                                           std::int32_t points, std::int32_t slots, const Real* u,
                                           const Real* pressures, Real* f) {
  using Lanes = OneElement<Real>;
  const PatchCorners corners = body.corners[tet];
  Real U[3][3], g[3][3], pull[3][3];
  edges(corners.point, points, u, U);
  rows_of_gradients(body, tet, g);
  if constexpr (Kind::elements == PatchElements::of_pressures) {
    const PatchAverages at = body.pressures.corners[tet];
    Real H[3][3], P[3][3], sum = 0;
    for (const std::uint16_t average : at.of) sum = sum + pressures[average];
    kernel_loops::displacement_gradient<Lanes, Real>(U, g, H);
    kernel_loops::neo_hookean_stress<Lanes, Real>(H, body.half_lambda[tet], body.mu[tet], P,
                                                  body.pressures.volume[tet] * (sum / 4));
    kernel_loops::corner_pull<Lanes, Real>(P, g, pull);
  } else {
    kernel_loops::tet_pull<Lanes, Kind::law>(U, g, body.half_lambda + tet, body.mu + tet, pull);
  }
  for (int i = 0; i < 3; ++i) {
    if (corners.slot[0] != PatchCorners::nowhere)
      f[i * slots + corners.slot[0]] = (pull[0][i] + pull[1][i]) + pull[2][i];
    for (int a = 0; a < 3; ++a)
      if (corners.slot[a + 1] != PatchCorners::nowhere) f[i * slots + corners.slot[a + 1]] = -pull[a][i];
  }
}

/// The rule of an element of ten nodes, for ten_node_pull(): 30 gradients of each point of the rule, then
/// volumes.
template <class Real>
struct TenNodeRule {
  const BodyArrays<Real>& body;
  std::int64_t element;
  [[nodiscard]] HMAX_DEVICE Real number(std::int64_t k) const {
    return body.gradients[k * body.tets + element];
  }
  [[nodiscard]] HMAX_DEVICE Real gradient(int g, int a, int j) const { return number(30 * g + 3 * a + j); }
  [[nodiscard]] HMAX_DEVICE Real volume(int g) const { return number(120 + g); }
  [[nodiscard]] HMAX_DEVICE Real half_lambda() const { return body.half_lambda[element]; }
  [[nodiscard]] HMAX_DEVICE Real mu() const { return body.mu[element]; }
};

/// -pull at the ten points, each at its slot.
template <class Real>
HMAX_DEVICE inline void ten_node_forces(const BodyArrays<Real>& body, std::int32_t element,
                                        std::int32_t points, std::int32_t slots, const Real* u, Real* f) {
  const PatchTenNodes own = body.ten_nodes[element];
  Real U[10][3];
  for (int a = 0; a < 10; ++a)
    for (int i = 0; i < 3; ++i) U[a][i] = u[i * points + own.point[a]] - u[i * points + own.point[0]];
  kernel_loops::ten_node_pull<OneElement<Real>, Real>(U, TenNodeRule<Real>{body, element},
                                                      [&](int a, const Real* pull) {
                                                        if (own.slot[a] != PatchCorners::nowhere)
                                                          for (int i = 0; i < 3; ++i)
                                                            f[i * slots + own.slot[a]] = -pull[i];
                                                      });
}

/// Those of fibres: slopes g_a.a [1/m] of the corners, a, E_f [Pa] and V [m^3].
template <class Real>
HMAX_DEVICE inline void fibre_forces(const BodyArrays<Real>& body, std::int32_t fibre, std::int32_t points,
                                     std::int32_t slots, const Real* u, Real* f) {
  const PatchCorners corners = body.fibre_corners[fibre];
  const bool small_strain = body.fibres_of_small_strain;
  Real U[3][3], own[9];
  edges(corners.point, points, u, U);
  for (int k = 0; k < 9; ++k) own[k] = body.fibre[static_cast<std::int64_t>(k) * body.fibres + fibre];
  const auto now = kernel_loops::stretch_of_fibre<OneElement<Real>>(U, own + 1, own + 4, small_strain);
  const Real stress = kernel_loops::fibre_tension(now, own[7], small_strain);
  for (int a = 0; a < 4; ++a)
    if (corners.slot[a] != PatchCorners::nowhere)
      for (int i = 0; i < 3; ++i)
        f[i * slots + corners.slot[a]] = stress == 0 ? 0 : -(own[8] * stress * own[a] * now.along[i]);
}

/// The pull at the near end of a spring and -pull at the far one, each at its slot.
/// @param b  of phi = s + b s^3
/// @param x  positions
template <class Real>
HMAX_DEVICE inline void spring_forces(const BodyArrays<Real>& body, std::int32_t spring, Real b,
                                      std::int32_t points, std::int32_t slots, const Real* x, Real* f) {
  const PatchSpring ends = body.ends[spring];
  const Real* const L = body.per_length + spring;
  const Real* const tension = body.tension + spring;
  Real d[3];
  ends.span(points, x, d);
  const Real pull = b == 0 ? kernel_loops::spring_pull<OneElement<Real>, false>(L, tension, b, d)
                           : kernel_loops::spring_pull<OneElement<Real>, true>(L, tension, b, d);
  for (int i = 0; i < 3; ++i) d[i] = d[i] * pull;
  ends.pull_together(slots, d, f);
}

/// The same of a set of another law, as SpringSet::add_force() has it.
template <class Real>
HMAX_DEVICE inline void spring_forces(const BodyArrays<Real>& body, std::int32_t spring,
                                      const SetLaw<Real>& law, std::int32_t points, std::int32_t slots,
                                      const Real* x, Real* f) {
  const PatchSpring ends = body.ends[spring];
  Real d[3], pull[3];
  ends.span(points, x, d);
  const Real length = kernel_loops::direction<OneElement<Real>>(d, pull);
  law.visit([&](const auto& own) {
    const Real tension =
        kernel_loops::spring_tension(own, body.tension[spring], body.per_length[spring], length);
    for (int i = 0; i < 3; ++i) pull[i] = tension * pull[i];
  });
  ends.pull_together(slots, pull, f);
}

/// Those of a damper.
/// @param x         positions
/// @param velocity  velocity(p, i) of component i of point p of the patch
template <class Real, class Velocity>
HMAX_DEVICE inline void damper_forces(const BodyArrays<Real>& body, std::int32_t damper, std::int32_t points,
                                      std::int32_t slots, const Real* x, const Velocity& velocity, Real* f) {
  const PatchSpring ends = body.damped[damper];
  Real d[3], w[3], pull[3];
  ends.span(points, x, d);
  for (int i = 0; i < 3; ++i) w[i] = velocity(ends.point[1], i) - velocity(ends.point[0], i);
  kernel_loops::damper_pull<OneElement<Real>>(body.damper[damper], d, w, pull);
  ends.pull_together(slots, pull, f);
}

/// -pull at the corners 1 and 2 and their sum at corner 0, each at its slot.
/// @param x  positions
template <class Real>
HMAX_DEVICE inline void triangle_forces(const BodyArrays<Real>& body, std::int32_t triangle,
                                        std::int32_t points, std::int32_t slots, const Real* x, Real* f) {
  const PatchTriangle corners = body.skin[triangle];
  Real D[2][3], g[4], pull[2][3];
  for (int k = 0; k < 4; ++k)
    g[k] = body.skin_gradients[static_cast<std::int64_t>(k) * body.triangles + triangle];
  for (int a = 0; a < 2; ++a)
    for (int i = 0; i < 3; ++i)
      D[a][i] = x[i * points + corners.point[a + 1]] - x[i * points + corners.point[0]];
  kernel_loops::triangle_pull<OneElement<Real>>(D, g, body.skin_volume[triangle], body.skin_modulus,
                                                body.skin_poisson, pull);
  for (int i = 0; i < 3; ++i) {
    if (corners.slot[0] != PatchCorners::nowhere) f[i * slots + corners.slot[0]] = pull[0][i] + pull[1][i];
    for (int a = 0; a < 2; ++a)
      if (corners.slot[a + 1] != PatchCorners::nowhere) f[i * slots + corners.slot[a + 1]] = -pull[a][i];
  }
}

/// Where a tool is. @param loads  of the evaluation
template <class Real>
HMAX_DEVICE inline SpherePose<Real> pose_of(const BodyArrays<Real>& body, const Real* loads,
                                            std::int32_t tool) {
  const Real* const from = loads + body.tools.first + 6 * tool;
  return {{from[0], from[1], from[2]}, {from[3], from[4], from[5]}};
}

/// Those of a tool on a triangle; 0 where they do not touch, which changes no sum that began at 0: such a sum
/// is never -0.
/// @param loads        of the evaluation
/// @param x, velocity  as of damper_forces()
template <class Real, class Velocity>
HMAX_DEVICE inline void contact_forces(const BodyArrays<Real>& body, std::int32_t contact, const Real* loads,
                                       std::int32_t points, std::int32_t slots, const Real* x,
                                       const Velocity& velocity, Real* f) {
  const PatchContact<Real> own = body.tools.contact[contact];
  const PatchTriangle& corners = own.triangle;
  Real force[3][3];
  const bool is_touched = kernel_loops::contact_force(
      body.tools.laws[own.tool], pose_of(body, loads, own.tool), own.samples,
      [&](int a, int i) { return x[i * points + corners.point[a]]; },
      [&](int a, int i) { return velocity(corners.point[a], i); }, force);
  for (int a = 0; a < 3; ++a)
    if (corners.slot[a] != PatchCorners::nowhere)
      for (int i = 0; i < 3; ++i) f[i * slots + corners.slot[a]] = is_touched ? force[a][i] : 0;
}

}  // namespace hmax
