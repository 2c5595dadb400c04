/// What tools add to the stiffness and damping of a body, for stiffness_step.hpp.
#pragma once

#include <cstdint>

#include "catalogue/device/programs/body_step.hpp"
#include "core/instructions/device_code.hpp"
#include "problems/tissue/forces/kernels/tool_contact.hpp"

namespace hmax {

/// A triangle of the surface and a tool that may touch it.
struct StiffContact {
  std::int32_t corner[3], tool;  ///< points of BodyArrays; which tool
  SampledTriangle<double> samples;
};

/// What there is of them.
struct ContactBlocks {
  const StiffContact* contacts;
  TermLists terms;  ///< of each block of a matrix: 9 times the contact + 3 a + b of its corners, in the order
                    ///< of the processor
  bool operator==(const ContactBlocks&) const = default;
};

/// Adds what tools have of a block of K and of C at (step.q_next, step.v_next).
/// @param loads  of the evaluation
HMAX_DEVICE inline void add_contacts(const ContactBlocks& all, const BodyStep<double>& step,
                                     const double* loads, std::int64_t block, double (*K)[3],
                                     double (*C)[3]) {
  const BodyArrays<double>& body = step.body;
  for (std::int32_t n = all.terms.first[block]; n < all.terms.first[block + 1]; ++n) {
    const std::int32_t term = all.terms.of[n];
    const StiffContact& contact = all.contacts[term / 9];
    const SphereLaw<double> law = body.tools.laws[contact.tool];
    double x[3][3];
    for (int a = 0; a < 3; ++a)
      for (int i = 0; i < 3; ++i) {
        const std::int64_t at = static_cast<std::int64_t>(i) * body.points + contact.corner[a];
        x[a][i] = body.rest[at] + step.q_next[at];
      }
    const auto position = [&](int a, int i) { return x[a][i]; };
    const auto velocity = [&](int a, int i) {
      return velocity_of(body, step.v_next, loads, contact.corner[a], i);
    };
    // Without an array in memory: the corners are not known when this is compiled.
    const auto of_corner = [](const double* b, std::int32_t a) {
      return a == 0 ? b[0] : a == 1 ? b[1] : b[2];
    };
    double of_K[3][3] = {}, of_C[3][3] = {};
    kernel_loops::visit_touches(law, pose_of(body, loads, contact.tool), contact.samples, position, velocity,
                                [&](const double* b, double share, const SphereTouch<double>& touch) {
                                  const double bb = of_corner(b, term / 3 % 3) * of_corner(b, term % 3);
                                  double D[3][3];
                                  law.stiffness_of(touch, D);
                                  kernel_loops::add_sample(share, bb, D, of_K);
                                  if (law.damping == 0) return;
                                  law.damping_of(touch, D);
                                  kernel_loops::add_sample(share, bb, D, of_C);
                                });
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) K[r][c] = K[r][c] + of_K[r][c], C[r][c] = C[r][c] + of_C[r][c];
  }
}

}  // namespace hmax
