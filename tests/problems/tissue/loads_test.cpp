#include "problems/tissue/loads.hpp"

#include <limits>
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

TEST(Loads, RiseAndFallToExactlyNothing) {
  const TimeProfile profile{.kind = TimeProfile::Kind::ramp, .start = 0.1, .rise = 0.2, .fall = 0.5};
  EXPECT_EQ(profile.value(0.1), 0);
  EXPECT_NEAR(profile.value(0.2), 0.5, 1e-15);
  EXPECT_EQ(profile.value(0.4), 1);
  EXPECT_NEAR(profile.value(0.6), 0.5, 1e-15);
  EXPECT_EQ(profile.value(0.8), 0);
  for (const double t : {0.15, 0.25, 0.4, 0.55, 0.65, 0.8})
    EXPECT_NEAR(profile.rate(t), (profile.value(t + 1e-6) - profile.value(t - 1e-6)) / 2e-6, 1e-8) << t;
  EXPECT_EQ(profile.steady_from(), 0.5 + 0.2);
  Times times;
  profile.add_breakpoints(times);
  EXPECT_EQ(times, (Times{0.1, 0.1 + 0.2, 0.5, 0.5 + 0.2}));
  TissueSettings settings;
  settings.forces.push_back({.points = {5}, .force = {0, 0, 1}, .profile = profile});
  const TissueSettings after = after_ramps(settings);
  EXPECT_TRUE(after.forces.front().force.isZero(0));
  EXPECT_EQ(after.forces.front().profile.kind, TimeProfile::Kind::steady);
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

// s times the area of the supported surface, whatever the mesh; a face beside it takes no part.
TEST(ElasticSupports, OnAFoundationHaveTheAreaOfTheirSurfaceOnAnyMesh) {
  for (const int n : {1, 2, 5}) {
    const TetMesh mesh = box_mesh({0.2, 0.1, 0.3}, {n, n + 1, 2 * n});
    const double inf = std::numeric_limits<double>::infinity();
    const ElasticSupport floor =
        on_foundation(mesh, points_in_box(mesh, {-inf, -inf, -inf}, {inf, inf, 1e-9}), 5000);
    double sum = 0;
    for (const double k : floor.stiffness) sum += k;
    EXPECT_NEAR(sum, 5000 * 0.2 * 0.1, 1e-10) << n;
    EXPECT_EQ(floor.points.size(), static_cast<std::size_t>((n + 1) * (n + 2))) << n;
  }
  // Two points of a face have no area.
  EXPECT_TRUE(on_foundation(box_mesh({1, 1, 1}, {1, 1, 1}), {0, 1}, 1).points.empty());
}

TEST(ElasticSupports, WithWrongNumbersAreRefused) {
  const auto body = [](ElasticSupport support) {
    TissueSettings settings;
    settings.elastic_supports = {std::move(support)};
    return TissueBody(box_mesh({1, 1, 1}, {1, 1, 1}), settings);
  };
  EXPECT_THROW(body({.points = {0, 1}, .stiffness = {1}}), std::invalid_argument);
  EXPECT_THROW(body({.points = {0}, .stiffness = {-1}}), std::invalid_argument);
  EXPECT_THROW(body({.points = {99}, .stiffness = {1}}), std::invalid_argument);
}

}  // namespace
}  // namespace hmax
