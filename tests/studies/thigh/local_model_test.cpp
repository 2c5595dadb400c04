#include "studies/thigh/local_model.hpp"

#include <stdexcept>

#include <gtest/gtest.h>

namespace hmax {
namespace {

TEST(LocalModel, IsCloserAndSmootherThanAHeldForce) {
  const std::vector<HapticForce> forces = haptic_forces(true_thigh(3, 3), {});
  ASSERT_EQ(forces.size(), 5U);
  const HapticForce &reference = forces[0], &fast = forces[1], &held = forces[2], &tissue_held = forces[3],
                    &local = forces[4];
  EXPECT_EQ(reference.rms, 0);
  EXPECT_LT(fast.rms, 0.02);
  EXPECT_LT(local.rms, held.rms);
  EXPECT_LT(local.rms, tissue_held.rms);
  EXPECT_LT(local.jump, 0.5 * held.jump);
  // At the beginning of a frame all three have the force of the tissue.
  for (const HapticForce* each : {&tissue_held, &local})
    for (std::size_t i = 0; i < each->force.size(); i += 10)
      EXPECT_NEAR(each->force[i], held.force[i], 1e-12);
}

TEST(LocalModel, IsTheContactAloneWhereTheTissueDoesNotGiveWay) {
  // k s << 1: the tissue does not give way, and the force is that of the contact.
  HapticContact soft;
  soft.stiffness = 1e-3;
  const std::vector<HapticForce> forces = haptic_forces(true_thigh(3, 3), soft);
  for (std::size_t i = 0; i < forces[0].force.size(); ++i)
    EXPECT_NEAR(forces[4].force[i], soft.stiffness * soft.position(forces[4].t[i]),
                1e-3 * soft.stiffness * soft.depth);
}

TEST(LocalModel, RefusesAPointThatIsNotThere) {
  HapticContact contact;
  contact.point = 9;
  EXPECT_THROW(haptic_forces(true_thigh(3, 3), contact), std::invalid_argument);
}

}  // namespace
}  // namespace hmax
