#include "problems/tissue/loads.hpp"

#include <memory>

#include <gtest/gtest.h>

#include "problems/tissue/body.hpp"
#include "tests/problems/tissue/bodies.hpp"

namespace hmax {
namespace {

using Times = std::vector<double>;

TEST(Loads, OfABodyNameTheTimesWhereTheyBeginAndCeaseToMove) {
  TissueSettings settings;
  settings.materials = tissue_tests::two_materials();
  settings.supports.push_back({.points = {0, 1}});
  // A force that comes in [0.1, 0.3] and goes in [0.3, 0.6], and a measured travel over [0.05, 0.5].
  PressingForce force{.points = {5}, .force = {0, 0, 1}};
  force.profile = {.kind = TimeProfile::Kind::ramp, .start = 0.1, .rise = 0.2};
  settings.forces.push_back(force);
  force.force = -force.force;
  force.profile = {.kind = TimeProfile::Kind::ramp, .start = 0.3, .rise = 0.3};
  settings.forces.push_back(force);
  const auto curve = std::make_shared<const SampledCurve>(Times{0.05, 0.2, 0.5}, Times{0, 1, 0});
  settings.supports.push_back({.points = {2},
                               .travel = {0, 0, 1e-3},
                               .profile = {.kind = TimeProfile::Kind::samples, .curve = curve}});
  const TissueBody body(tissue_tests::uneven_box(), settings);
  const double end = 0.3 + 0.3, middle = 0.1 + 0.2;
  Times expected{0.05, 0.1, 0.3, 0.5, end};
  if (middle != 0.3) expected.insert(expected.begin() + 3, middle);
  EXPECT_EQ(body.breakpoints(0, 1), expected);
  EXPECT_EQ(body.breakpoints(0.05, 0.2), (Times{0.1}));
}

TEST(Loads, ThatNeverChangeOrAlwaysDoHaveNoBreakpoints) {
  TissueSettings settings;
  settings.materials = tissue_tests::two_materials();
  settings.supports.push_back({.points = {0, 1}});
  settings.supports.push_back(
      {.points = {2}, .travel = {0, 0, 1e-3}, .profile = {.kind = TimeProfile::Kind::sine, .omega = 3}});
  settings.forces.push_back({.points = {5}, .force = {0, 0, 1}});
  EXPECT_TRUE(TissueBody(tissue_tests::uneven_box(), settings).breakpoints(0, 100).empty());
}

}  // namespace
}  // namespace hmax
