#include "studies/thigh/thigh_identification.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

namespace hmax {
namespace {

constexpr std::array every_way{UnknownSkin::none, UnknownSkin::by_direction, UnknownSkin::every_spring};

TEST(ThighMeasurements, HaveTenToTwelveForcesOfEachProbeAtEachPoint) {
  const auto data = measured(true_thigh(), {});
  EXPECT_EQ(data.size(), 128U);
  std::size_t least = 100, most = 0;
  for (const ForceSeries& series : data) {
    ASSERT_EQ(series.depth.size(), series.force.size());
    least = std::min(least, series.force.size());
    most = std::max(most, series.force.size());
    EXPECT_NEAR(series.depth.front(), 0.002, 1e-15);
  }
  EXPECT_EQ(least, 10U);
  EXPECT_EQ(most, 12U);
}

TEST(ThighMeasurements, HaveTheNoiseThatIsAskedForAndAreThoseOfTheirSeed) {
  const Thigh truth = true_thigh();
  const auto data = measured(truth, {.noise = 0.02, .seed = 7});
  const Eigen::VectorXd noise =
      (forces_of(data).cwiseQuotient(forces_of(truth, data)).array() - 1).matrix() / 0.02;
  const auto n = static_cast<double>(noise.size());
  EXPECT_NEAR(noise.mean(), 0, 4 / std::sqrt(n));
  EXPECT_NEAR(noise.squaredNorm() / n, 1, 4 * std::sqrt(2 / n));
  // Normal: 31.7 % are beyond one deviation, 4.6 % beyond two.
  EXPECT_NEAR(static_cast<double>((noise.array().abs() > 1).count()) / n, 0.317, 0.05);
  EXPECT_NEAR(static_cast<double>((noise.array().abs() > 2).count()) / n, 0.0455, 0.022);
  EXPECT_EQ(forces_of(measured(truth, {.noise = 0.02, .seed = 7})), forces_of(data));
  EXPECT_NE(forces_of(measured(truth, {.noise = 0.02, .seed = 8})).head(640), forces_of(data).head(640));
}

TEST(ThighResiduals, HaveTheJacobianOfDifferences) {
  const Thigh truth = true_thigh(3, 3);
  const auto data = measured(truth, {});
  const Thigh at = scattered(truth, 1.5, 1.2, 3);
  for (const UnknownSkin skin : every_way)
    for (const Misfit misfit : {Misfit::logarithmic, Misfit::relative}) {
      const FitOptions options{skin, misfit};
      Eigen::MatrixXd J;
      residuals(at, data, options, &J);
      const Eigen::VectorXd values = unknowns(at, skin);
      ASSERT_EQ(J.cols(), values.size());
      for (Eigen::Index j = 0; j < values.size(); ++j) {
        constexpr double d = 1e-5;
        Eigen::VectorXd more = values, less = values;
        more[j] *= std::exp(d);
        less[j] *= std::exp(-d);
        const Eigen::VectorXd difference = (residuals(with_unknowns(at, more, skin), data, options) -
                                            residuals(with_unknowns(at, less, skin), data, options)) /
                                           (2 * d);
        EXPECT_LT((J.col(j) - difference).norm(), 1e-7 * (1 + J.norm())) << j;
      }
    }
}

TEST(ThighIdentification, RecoversTheTruthWithoutNoise) {
  const Thigh truth = true_thigh(4, 4);
  const auto data = measured(truth, {.noise = 0});
  for (const auto& [skin, factor] : {std::pair{UnknownSkin::none, 1.0}, {UnknownSkin::by_direction, 3.0}}) {
    const ThighFit fit = identify(uniform_guess(truth, factor), data, {skin});
    EXPECT_TRUE(fit.converged);
    EXPECT_LT(fit.residual, 1e-6);
    EXPECT_LT(compare(fit, truth, skin).largest_error, 1e-4);
  }
}

TEST(ThighIdentification, FindsMostParametersWithinFivePerCentWithNoise) {
  const Thigh truth = true_thigh(4, 4);
  const auto data = measured(truth, {});
  const ThighFit fit = identify(uniform_guess(truth), data, {UnknownSkin::none});
  EXPECT_TRUE(fit.converged);
  EXPECT_NEAR(fit.residual, 0.02, 0.002);
  EXPECT_GT(compare(fit, truth, UnknownSkin::none).within, 0.8);
  EXPECT_LT(overall_error(forces_of(fit.thigh, data), forces_of(data)), 0.05);
  // Of the forces without noise much less.
  const auto exact = measured(truth, {.noise = 0});
  EXPECT_LT(overall_error(forces_of(fit.thigh, exact), forces_of(exact)), 0.015);
}

TEST(ThighIdentification, HasIntervalsThatHoldTheTruthNineteenTimesOfTwenty) {
  const Thigh truth = true_thigh(3, 3);
  double covered = 0, covered_with_skin = 0;
  constexpr int repetitions = 40;
  for (std::uint64_t seed = 1; seed <= repetitions; ++seed) {
    const auto data = measured(truth, {.noise = 0.02, .seed = seed});
    covered += compare(identify(truth, data, {UnknownSkin::none}), truth, UnknownSkin::none).covered;
    covered_with_skin += compare(identify(truth, data), truth, UnknownSkin::by_direction).covered;
  }
  // 40 x 18 intervals: 0.8 % is one deviation of the share where they are independent.
  EXPECT_NEAR(covered / repetitions, 0.95, 0.025);
  EXPECT_NEAR(covered_with_skin / repetitions, 0.95, 0.04);
}

TEST(ThighIdentification, FitsForcesWithWrongParametersWhereTheSkinIsWrong) {
  const Thigh truth = true_thigh(4, 4);
  const auto data = measured(truth, {});
  const ThighFit fit = identify(uniform_guess(truth, 0.5), data, {UnknownSkin::none});
  EXPECT_LT(overall_error(forces_of(fit.thigh, data), forces_of(data)), 0.05);
  EXPECT_LT(compare(fit, truth, UnknownSkin::none).within, 0.6);
}

TEST(ThighIdentification, FindsItsWayFromAFarGuessByLogarithms) {
  const Thigh truth = true_thigh(4, 4);
  const auto data = measured(truth, {.noise = 0});
  for (const std::uint64_t seed : {1, 2, 3}) {
    const Thigh far = scattered(uniform_guess(truth, 3), 10, 4, seed);
    EXPECT_GT((far.a.cwiseQuotient(truth.a)).cwiseMax(truth.a.cwiseQuotient(far.a)).maxCoeff(), 4);
    EXPECT_LT(compare(identify(far, data), truth, UnknownSkin::by_direction).largest_error, 1e-4) << seed;
  }
}

TEST(ThighIdentification, KeepsTheSkinThatItIsNotAskedFor) {
  const Thigh truth = true_thigh(3, 3);
  const auto data = measured(truth, {.noise = 0});
  const ThighFit fit = identify(uniform_guess(truth, 2), data, {UnknownSkin::none});
  for (std::size_t s = 0; s < truth.skin.size(); ++s)
    EXPECT_EQ(fit.thigh.skin[s].stiffness, 2 * truth.skin[s].stiffness);
}

TEST(ThighIdentification, RefusesBadInput) {
  const Thigh truth = true_thigh(2, 2);
  auto data = measured(truth, {});
  EXPECT_THROW(identify(truth, std::span(data).first(0)), std::invalid_argument);
  EXPECT_THROW(with_unknowns(truth, Eigen::VectorXd::Ones(3), UnknownSkin::none), std::invalid_argument);
  data[1].force[2] = 0;
  EXPECT_THROW(identify(truth, data, {UnknownSkin::none}), std::invalid_argument);
  data[1].force[2] = std::nan("");
  EXPECT_THROW(identify(truth, data, {UnknownSkin::none}), std::invalid_argument);
  data[1].force.pop_back();
  EXPECT_THROW(identify(truth, data, {UnknownSkin::none}), std::invalid_argument);
}

}  // namespace
}  // namespace hmax
