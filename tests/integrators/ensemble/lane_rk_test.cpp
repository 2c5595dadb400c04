#include "integrators/ensemble/lane_rk.hpp"

#include <cmath>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "integrators/explicit/tableaux.hpp"
#include "problems/oscillator/oscillator.hpp"

namespace hmax {
namespace {

using Eigen::Vector2d;

/// Two steps of every lane, the second from where the first was accepted, against the stepper of single runs:
/// the same bits. A constant force and lanes of very different sizes.
template <class Method, std::size_t N>
void expect_same_bits() {
  const Oscillator system({.m = 1.45, .c = 0.2, .k1 = -1, .k3 = 0.8, .P = 0.3, .w = 0});
  const RmsNorm<double> norm{1e-8, 1e-10};
  auto lanes = std::make_unique<LaneRk<Method, Oscillator, N>>();
  std::vector<Rk<Method, Vector2d>> single(N);
  std::vector<Vector2d> y(N);
  const auto h_of = [](std::size_t lane) { return 0.01 * static_cast<double>(lane % 7 + 1); };
  for (std::size_t lane = 0; lane < N; ++lane) {
    const double x = static_cast<double>(lane);
    y[lane] = Vector2d(std::sin(x) * std::exp(x / 4 - 3), std::cos(3 * x));
    single[lane].init(system, 0.0, y[lane]);
    lanes->start(system, lane, y[lane]);
    lanes->set_step(lane, h_of(lane));
  }
  for (int step = 0; step < 2; ++step) {
    lanes->attempt(system, norm);
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
  expect_same_bits<tableaux::Dop853, 1>();
  expect_same_bits<tableaux::Dop853, 5>();
  expect_same_bits<tableaux::Dop853, 32>();
  expect_same_bits<tableaux::DormandPrince54, 16>();
  expect_same_bits<tableaux::BogackiShampine32, 8>();
}

/// A lane of infinities leaves its neighbours alone, and one that rests has no error.
TEST(LaneRk, LanesDoNotMeet) {
  const Oscillator system({.m = 1, .c = 0.2, .k1 = 1, .k3 = 1, .P = 0, .w = 0});
  const RmsNorm<double> norm{1e-8, 1e-10};
  LaneRk<tableaux::Dop853, Oscillator, 8> calm, torn;
  for (std::size_t lane = 0; lane < 8; ++lane) {
    calm.start(system, lane, {0.5, 0.1});
    torn.start(system, lane, lane == 3 ? Vector2d(1e200, -1e300) : Vector2d(0.5, 0.1));
    calm.set_step(lane, lane == 5 ? 0 : 0.1);
    torn.set_step(lane, lane == 5 ? 0 : 0.1);
  }
  calm.attempt(system, norm);
  torn.attempt(system, norm);
  for (std::size_t lane = 0; lane < 8; ++lane) {
    if (lane == 3) continue;
    EXPECT_EQ(calm.candidate(lane), torn.candidate(lane));
    EXPECT_EQ(calm.error_squared(lane), torn.error_squared(lane));
  }
  EXPECT_FALSE(torn.error_squared(3) <= 1);
  EXPECT_EQ(calm.candidate(5), Vector2d(0.5, 0.1));
  EXPECT_EQ(calm.error_squared(5), 0);
}

}  // namespace
}  // namespace hmax
