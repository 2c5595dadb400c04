#include "integrators/ensemble/lane_rk.hpp"

#include <cmath>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "integrators/explicit/tableaux.hpp"
#include "problems/oscillator/oscillator_lanes.hpp"

namespace hmax {
namespace {

using Eigen::Vector2d;

/// Calls f(y, dydt) in every stage of every lane.
template <class Lanes>
void attempt(Lanes& lanes, const Oscillator& system, const RmsNorm<double>& norm) {
  lanes.attempt([&](auto, std::size_t, const Vector2d& y, Vector2d& dydt) { system.rhs(0, y, dydt); });
  lanes.weigh(norm);
}

template <class Lanes>
void start(Lanes& lanes, const Oscillator& system, std::size_t lane, const Vector2d& y) {
  Vector2d slope;
  system.rhs(0, y, slope);
  lanes.start(lane, y, slope);
}

/// Two steps of every lane, the second from where the first was accepted, against the stepper of single runs:
/// the same bits. A constant force and lanes of very different sizes.
template <class Method, std::size_t N>
void expect_same_bits() {
  const Oscillator system({.m = 1.45, .c = 0.2, .k1 = -1, .k3 = 0.8, .P = 0.3, .w = 0});
  const RmsNorm<double> norm{1e-8, 1e-10};
  auto lanes = std::make_unique<LaneRk<Method, Vector2d, N>>();
  std::vector<Rk<Method, Vector2d>> single(N);
  std::vector<Vector2d> y(N);
  const auto h_of = [](std::size_t lane) { return 0.01 * static_cast<double>(lane % 7 + 1); };
  for (std::size_t lane = 0; lane < N; ++lane) {
    const double x = static_cast<double>(lane);
    y[lane] = Vector2d(std::sin(x) * std::exp(x / 4 - 3), std::cos(3 * x));
    single[lane].init(system, 0.0, y[lane]);
    start(*lanes, system, lane, y[lane]);
    lanes->set_step(lane, 0, h_of(lane));
  }
  for (int step = 0; step < 2; ++step) {
    attempt(*lanes, system, norm);
    for (std::size_t lane = 0; lane < N; ++lane) {
      Vector2d next;
      const double h = h_of(lane);
      single[lane].attempt(system, 0.0, y[lane], h, next);
      EXPECT_EQ(lanes->candidate(lane), next) << lane;
      EXPECT_EQ(lanes->error_squared(lane), single[lane].error_squared(h, y[lane], next, norm)) << lane;
      if (lane % 3 == 1) continue;  // rejected: the next attempt starts from the same state
      single[lane].accept(next);
      lanes->accept(lane);
      y[lane] = next;
    }
  }
}

TEST(LaneRk, HasTheBitsOfSingleSteps) {
  expect_same_bits<tableaux::Dop853, 8>();
  expect_same_bits<tableaux::Dop853, 32>();
  expect_same_bits<tableaux::DormandPrince54, 16>();
  expect_same_bits<tableaux::BogackiShampine32, 8>();
  expect_same_bits<tableaux::Fehlberg78, 8>();  // its last stage is not the first of the next step
}

/// A lane of infinities leaves its neighbours alone, and one that rests has no error.
TEST(LaneRk, LanesDoNotMeet) {
  const Oscillator system({.m = 1, .c = 0.2, .k1 = 1, .k3 = 1, .P = 0, .w = 0});
  const RmsNorm<double> norm{1e-8, 1e-10};
  LaneRk<tableaux::Dop853, Vector2d, 8> calm, torn;
  for (std::size_t lane = 0; lane < 8; ++lane) {
    start(calm, system, lane, {0.5, 0.1});
    start(torn, system, lane, lane == 3 ? Vector2d(1e200, -1e300) : Vector2d(0.5, 0.1));
    calm.set_step(lane, 0, lane == 5 ? 0 : 0.1);
    torn.set_step(lane, 0, lane == 5 ? 0 : 0.1);
  }
  attempt(calm, system, norm);
  attempt(torn, system, norm);
  for (std::size_t lane = 0; lane < 8; ++lane) {
    if (lane == 3) continue;
    EXPECT_EQ(calm.candidate(lane), torn.candidate(lane));
    EXPECT_EQ(calm.error_squared(lane), torn.error_squared(lane));
  }
  EXPECT_FALSE(torn.error_squared(3) <= 1);
  EXPECT_EQ(calm.candidate(5), Vector2d(0.5, 0.1));
  EXPECT_EQ(calm.error_squared(5), 0);
}

/// Where fewer lanes are used the others stay; a lane that is moved goes on from the same state.
TEST(LaneRk, UsesAsManyLanesAsThereAreRuns) {
  const Oscillator system({.m = 1, .c = 0.2, .k1 = 1, .k3 = 1, .P = 0, .w = 0});
  const RmsNorm<double> norm{1e-8, 1e-10};
  LaneRk<tableaux::Dop853, Vector2d, 24> lanes;
  for (std::size_t lane = 0; lane < 24; ++lane) {
    start(lanes, system, lane, {0.5, 0.1 * static_cast<double>(lane)});
    lanes.set_step(lane, 0, 0.1);
  }
  lanes.use(9);
  EXPECT_EQ(lanes.used(), 16U);
  attempt(lanes, system, norm);
  EXPECT_NE(lanes.candidate(15), Vector2d::Zero());
  EXPECT_EQ(lanes.candidate(16), Vector2d::Zero());
  const Vector2d moved = lanes.candidate(15);
  lanes.move(15, 2);
  attempt(lanes, system, norm);
  EXPECT_EQ(lanes.candidate(2), moved);
}

/// The right-hand side and the force of each lane, against the oscillator itself.
TEST(OscillatorLanes, HaveTheBitsOfOscillators) {
  OscillatorLanes<8> lanes;
  for (const double P : {0.5, -7.0, 0.0})
    for (std::size_t lane = 0; lane < 8; ++lane) {
      const double u = 0.3 + static_cast<double>(lane);
      const Oscillator system({.m = 1.45 * u, .c = 0.7 / u, .k1 = u - 3, .k3 = 0.8 * u, .P = P, .w = u / 7});
      lanes.set(lane, system);
      const double t = 0.37 * u, force = lanes.force(lane, std::cos(lanes.angle(lane, t)));
      EXPECT_EQ(force, system.at(t));
      EXPECT_EQ(std::signbit(force), std::signbit(system.at(t)));
      Vector2d found, expected;
      const Vector2d y(0.2 * u, -1.3);
      lanes.rhs_at(lane, force, y, found);
      system.rhs(t, y, expected);
      EXPECT_EQ(found, expected);
    }
}

}  // namespace
}  // namespace hmax
