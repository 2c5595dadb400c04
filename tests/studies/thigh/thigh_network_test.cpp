#include "studies/thigh/thigh_network.hpp"

#include <stdexcept>

#include <gtest/gtest.h>

namespace hmax {
namespace {

const Training little{.hidden = 16, .epochs = 4000};

TEST(ThighNetwork, HasTheGradientOfDifferences) {
  const Thigh thigh = true_thigh(2, 3);
  const auto data = measured(thigh, {});
  ThighNetwork network = train(thigh, data, {.hidden = 3, .epochs = 5});
  Eigen::VectorXd gradient;
  training_error(network, thigh, data, &gradient);
  Eigen::Index k = 0;
  const auto compare_all = [&](auto&& values) {
    for (double& value : values) {
      constexpr double d = 1e-6;
      value += d;
      const double more = training_error(network, thigh, data);
      value -= 2 * d;
      const double less = training_error(network, thigh, data);
      value += d;
      EXPECT_NEAR(gradient[k], (more - less) / (2 * d), 1e-6 * (1 + gradient.norm())) << k;
      ++k;
    }
  };
  compare_all(network.W.reshaped());
  compare_all(network.c);
  compare_all(network.V.reshaped());
  EXPECT_EQ(k, gradient.size());
}

TEST(ThighNetwork, LearnsTheForcesOfBothProbes) {
  const Thigh truth = true_thigh(3, 3);
  const auto data = measured(truth, {});
  const ThighNetwork network = train(truth, data, little);
  EXPECT_LT(overall_error(forces_of(network, truth, data), forces_of(data)), 0.05);
  EXPECT_LT(training_error(network, truth, data), 1e-3);
}

TEST(ThighNetwork, HasNoForceWhereNobodyTouchesAndOneForEachPoint) {
  const Thigh truth = true_thigh(3, 3);
  const auto data = measured(truth, {});
  const ThighNetwork network = train(truth, data, {.hidden = 4, .epochs = 20});
  EXPECT_EQ(network.forces(Eigen::VectorXd::Zero(9)).norm(), 0);
  // The force on a probe is the sum of those on the points that it presses.
  const ForceSeries& series = data.at(13);
  const auto pressed = pressed_points(truth, series.point, series.probe);
  ASSERT_EQ(pressed.size(), 3U);
  Eigen::VectorXd u = Eigen::VectorXd::Zero(9);
  for (const Eigen::Index p : pressed) u[p] = series.depth[4];
  const Eigen::VectorXd forces = network.forces(u);
  double sum = 0;
  for (const Eigen::Index p : pressed) sum += forces[p];
  EXPECT_NEAR(forces_of(network, truth, {&series, 1})[4], sum, 1e-12 * forces.norm());
}

TEST(ThighNetwork, IsThatOfItsSeed) {
  const Thigh truth = true_thigh(2, 2);
  const auto data = measured(truth, {});
  const Training training{.hidden = 4, .epochs = 10, .seed = 3};
  EXPECT_EQ(train(truth, data, training).W, train(truth, data, training).W);
  EXPECT_NE(train(truth, data, training).W, train(truth, data, {.hidden = 4, .epochs = 10, .seed = 4}).W);
}

TEST(ThighNetwork, RefusesBadInput) {
  const Thigh truth = true_thigh(2, 2);
  const auto data = measured(truth, {});
  EXPECT_THROW(train(truth, data, {.hidden = 0}), std::invalid_argument);
  EXPECT_THROW(train(truth, data, {.epochs = 0}), std::invalid_argument);
  EXPECT_THROW(train(truth, {}, {}), std::invalid_argument);
}

}  // namespace
}  // namespace hmax
