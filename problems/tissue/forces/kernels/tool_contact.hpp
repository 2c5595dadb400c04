/// The contact of a sphere with one triangle of a surface, forces and their derivatives: one source for
/// processors and devices.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/instructions/device_code.hpp"
#include "problems/tissue/forces/kernels/one_element.hpp"
#include "problems/tissue/forces/kernels/small_matrices.hpp"

namespace hmax {

/// Where a sphere is, and how fast it moves, at one moment [m], [m/s].
template <class Real>
struct SpherePose {
  Real centre[3], velocity[3];
};

/// How a point that is inside of it meets a sphere.
template <class Real>
struct SphereTouch {
  Real normal[3];        ///< from the centre to the point
  Real distance, depth;  ///< |x - centre|, d [m]
  Real velocity[3];      ///< w of the point as seen from the sphere [m/s]
  Real along, rush;      ///< n.w, 1 + chi d' = 1 - chi n.w
};

/// p = k d^(3/2) (1 + chi d') >= 0 along the normal, as SphereTool has it.
template <class Real>
struct SphereLaw {
  Real radius;     ///< [m]
  Real stiffness;  ///< k [Pa/m^1.5]
  Real damping;    ///< chi [s/m]

  /// Whether the box around a triangle meets that around the sphere, as few do.
  /// @param x  x(a, i): component i of corner a
  template <class Corner>
  [[nodiscard]] HMAX_DEVICE bool is_near(const SpherePose<Real>& pose, const Corner& x) const {
    for (int i = 0; i < 3; ++i) {
      const Real a = x(0, i), b = x(1, i), c = x(2, i);
      if (!(std::min(std::min(a, b), c) <= pose.centre[i] + radius &&
            std::max(std::max(a, b), c) >= pose.centre[i] - radius))
        return false;
    }
    return true;
  }

  /// How a point at x meets it.
  /// @param velocity  component i of its velocity, which is not asked for without damping
  /// @returns false, and leaves `touch` undefined, where the point is outside or the pressure would pull
  template <class Velocity>
  HMAX_DEVICE bool touches(const SpherePose<Real>& pose, const Real* x, const Velocity& velocity,
                           SphereTouch<Real>& touch) const {
    Real* const n = touch.normal;
    for (int i = 0; i < 3; ++i) n[i] = x[i] - pose.centre[i];
    touch.distance = std::sqrt(dot(n, n));
    touch.depth = radius - touch.distance;
    if (!(touch.depth > 0 && touch.distance > 0)) return false;
    for (int i = 0; i < 3; ++i) {
      n[i] = n[i] / touch.distance;
      touch.velocity[i] = damping != 0 ? velocity(i) - pose.velocity[i] : 0;
    }
    touch.along = dot(n, touch.velocity);
    touch.rush = 1 - damping * touch.along;
    return touch.rush > 0;
  }

  /// p [Pa]
  [[nodiscard]] HMAX_DEVICE Real pressure(const SphereTouch<Real>& touch) const {
    return push(touch) * touch.rush;
  }

  /// -dp/dx [Pa/m] of p along the normal, row after row.
  HMAX_DEVICE void stiffness_of(const SphereTouch<Real>& touch, Real (*D)[3]) const {
    const Real* const n = touch.normal;
    const Real all = push(touch), across = all * touch.rush / touch.distance,
               slope = Real{1.5} * stiffness * std::sqrt(touch.depth) * touch.rush,
               turn = all * damping / touch.distance;
    // d falls by n.dx, d' = -n.w by (w - n (n.w)).dx / distance.
    for (int c = 0; c < 3; ++c) {
      const Real change = slope * n[c] + turn * (touch.velocity[c] - touch.along * n[c]);
      for (int r = 0; r < 3; ++r)
        D[r][c] = n[r] * change - across * (static_cast<Real>(r == c) - n[r] * n[c]);
    }
  }

  /// -dp/dv [Pa s/m], likewise: d' falls by n.dv.
  HMAX_DEVICE void damping_of(const SphereTouch<Real>& touch, Real (*D)[3]) const {
    const Real all = push(touch) * damping;
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) D[r][c] = all * (touch.normal[r] * touch.normal[c]);
  }

  /// 2/5 k d^(5/2) [J/m^2]
  [[nodiscard]] HMAX_DEVICE Real energy(const SphereTouch<Real>& touch) const {
    return Real{0.4} * touch.depth * push(touch);
  }

 private:
  HMAX_DEVICE static Real dot(const Real* a, const Real* b) {
    return kernel_loops::dot<OneElement<Real>>(a, b);
  }
  /// k d^(3/2)
  [[nodiscard]] HMAX_DEVICE Real push(const SphereTouch<Real>& touch) const {
    return stiffness * (touch.depth * std::sqrt(touch.depth));
  }
};

/// The trapezoidal rule on a triangle: samples stand at the barycentric coordinates (i, j, k) / n,
/// i + j + k = n.
template <class Real>
struct SampledTriangle {
  std::int32_t divisions;  ///< n
  Real share;  ///< area at rest / (3 n^2) [m^2]: what each of the n^2 small triangles gives each of its
               ///< corners

  /// Calls visit(b, w) with the coordinates of every sample and its share of the area.
  template <class Visit>
  HMAX_DEVICE void visit(const Visit& visit) const {
    const std::int32_t n = divisions;
    const auto whole = static_cast<Real>(n);
    for (std::int32_t i = 0; i <= n; ++i)
      for (std::int32_t j = 0; i + j <= n; ++j) {
        const std::int32_t k = n - i - j;
        const Real b[3] = {static_cast<Real>(i) / whole, static_cast<Real>(j) / whole,
                           static_cast<Real>(k) / whole};
        // A sample is a corner of one small triangle, of three on a side, of six inside.
        const int sides = (i == 0) + (j == 0) + (k == 0);
        visit(b, static_cast<Real>(sides == 0 ? 6 : sides == 1 ? 3 : 1) * share);
      }
  }
};

namespace kernel_loops {

/// Calls visit(b, w, touch) with the samples of a triangle that touch a sphere.
/// @param x, v  x(a, i): component i of the position of corner a; of its velocity, which is not asked for
///              without damping
template <class Real, class Position, class Velocity, class Visit>
HMAX_DEVICE inline void visit_touches(const SphereLaw<Real>& law, const SpherePose<Real>& pose,
                                      const SampledTriangle<Real>& triangle, const Position& x,
                                      const Velocity& v, const Visit& visit) {
  if (!law.is_near(pose, x)) return;
  triangle.visit([&](const Real* b, Real share) {
    const auto at_sample = [&](const auto& of, int i) {
      return b[0] * of(0, i) + b[1] * of(1, i) + b[2] * of(2, i);
    };
    const Real place[3] = {at_sample(x, 0), at_sample(x, 1), at_sample(x, 2)};
    SphereTouch<Real> touch;
    if (law.touches(
            pose, place, [&](int i) { return at_sample(v, i); }, touch))
      visit(b, share, touch);
  });
}

/// f_a = sum of w b_a p, likewise [N]. @returns false, and leaves f undefined, where nothing touches
template <class Real, class Position, class Velocity>
HMAX_DEVICE inline bool contact_force(const SphereLaw<Real>& law, const SpherePose<Real>& pose,
                                      const SampledTriangle<Real>& triangle, const Position& x,
                                      const Velocity& v, Real (*f)[3]) {
  bool is_touched = false;
  visit_touches(law, pose, triangle, x, v, [&](const Real* b, Real share, const SphereTouch<Real>& touch) {
    if (!is_touched)
      for (int k = 0; k < 9; ++k) f[k / 3][k % 3] = 0;
    is_touched = true;
    const Real push = share * law.pressure(touch);
    for (int i = 0; i < 3; ++i) {
      const Real along = push * touch.normal[i];
      for (int a = 0; a < 3; ++a) f[a][i] = f[a][i] + b[a] * along;
    }
  });
  return is_touched;
}

/// What a sample adds to the block of two corners: of K or C, -sum of w b_a b_b dp.
/// @param bb  b_a b_b
/// @param D   stiffness_of() or damping_of()
template <class Real>
HMAX_DEVICE inline void add_sample(Real share, Real bb, const Real (*D)[3], Real (*sum)[3]) {
  const Real weight = share * bb;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) sum[r][c] = sum[r][c] + weight * D[r][c];
}

}  // namespace kernel_loops
}  // namespace hmax
