#include "studies/motion_identification.hpp"

#include <gtest/gtest.h>

namespace hmax {
namespace {

TEST(IdentifiedMotions, FindTheBodyThatWasMeasuredAndNotItsSprings) {
  for (const std::uint64_t seed : {1U, 2U}) {
    const IdentifiedMotion found = identified_motion("phantom", seed);
    ASSERT_EQ(found.fits.size(), 2U);
    const FittedMotion &right = found.fits[0], &springs = found.fits[1];
    EXPECT_NEAR(right.young / found.young, 1, 0.01);
    EXPECT_NEAR(right.alpha / found.alpha, 1, 0.03);
    EXPECT_GT(springs.misfit, 3 * right.misfit);
    EXPECT_LT(right.runs, 100);
  }
}

}  // namespace
}  // namespace hmax
