#include "analysis/amplification/curve_limit.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "analysis/spectrum/spectrum.hpp"
#include "problems/mesh/mesh_generators.hpp"
#include "problems/tissue/body.hpp"

namespace hmax {
namespace {

using Eigen::VectorXd;

MechanicalPart part_of(const TissueBody& body) {
  const VectorXd rest = VectorXd::Zero(body.dofs());
  TissueBody::DofMatrix K, C;
  body.stiffness(0, rest, rest, K);
  body.damping(0, rest, rest, C);
  return mechanical_part(body.mass(), K, C);
}

/// Explicit Euler: |1 + h lambda| <= 1 for both eigenvalues.
std::vector<double> euler_exits(std::span<const MechanicalMode> modes) {
  std::vector<double> exits;
  for (const MechanicalMode& mode : modes) {
    double exit = std::numeric_limits<double>::infinity();
    for (const auto lambda : eigenvalues_of(mode))
      if (lambda != 0.0) exit = std::min(exit, -2 * lambda.real() / std::norm(lambda));
    exits.push_back(exit);
  }
  return exits;
}

TEST(CurveLimit, RayleighCoefficientsAreFoundAgainAndNoOthers) {
  const TetMesh mesh = ball_mesh(0.1, 2);
  for (const auto& [alpha, beta] : {std::pair{0.0, 0.0}, {3.0, 0.0}, {0.0, 0.004}, {2.5, 0.001}}) {
    TissueSettings settings{.alpha = alpha, .beta = beta};
    settings.supports = {{.points = {0, 1, 2}}};
    const auto found = rayleigh_coefficients(part_of(TissueBody(mesh, settings)));
    ASSERT_TRUE(found) << alpha << ' ' << beta;
    EXPECT_NEAR((*found)[0], alpha, 1e-9 * (1 + alpha));
    EXPECT_NEAR((*found)[1], beta, 1e-11 * (1 + beta));
  }
  MechanicalPart part = part_of(TissueBody(mesh, {.alpha = 3}));
  std::get<Eigen::SparseMatrix<double>>(part.C).coeffRef(0, 0) *= 2;
  EXPECT_FALSE(rayleigh_coefficients(part));
}

/// The places that smallest_exit() asks for, round after round, without the two ends after them.
std::vector<std::vector<double>> rounds_of(const DampingCurve& curve,
                                           const std::function<double(double)>& exit) {
  std::vector<std::vector<double>> rounds;
  smallest_exit(
      curve,
      [&](std::span<const MechanicalMode> modes) {
        std::vector<double> places, exits;
        for (const MechanicalMode& mode : modes) exits.push_back(exit(mode.kappa));
        for (const MechanicalMode& mode : modes.first(modes.size() - 2)) places.push_back(mode.kappa);
        rounds.push_back(places);
        return exits;
      },
      8);
  return rounds;
}

TEST(CurveLimit, IsSoughtBetweenTheNeighboursOfTheSmallestAndNotBeyondTheCurve) {
  // Shorter at every larger kappa: the second round ends where the curve does.
  const auto falling = rounds_of({.kappa_min = 1, .kappa_max = 100}, [](double kappa) { return 1 / kappa; });
  ASSERT_EQ(falling.size(), 2U);
  EXPECT_EQ(falling[0].front(), 1);
  EXPECT_EQ(falling[0].back(), 100);
  EXPECT_EQ(falling[1].front(), falling[0][falling[0].size() - 2]);
  EXPECT_EQ(falling[1].back(), 100);
  const auto rising = rounds_of({.kappa_min = 1, .kappa_max = 100}, [](double kappa) { return kappa; });
  ASSERT_EQ(rising.size(), 2U);
  EXPECT_EQ(rising[1].front(), 1);
  EXPECT_EQ(rising[1].back(), rising[0][1]);
}

TEST(CurveLimit, OfACurveThatIsAPointWithoutStiffnessHasNoOtherPlace) {
  for (const std::vector<double>& round : rounds_of({.alpha = 3}, [](double) { return 2.0 / 3; }))
    EXPECT_EQ(round, std::vector<double>{0});
}

TEST(CurveLimit, OfABodyIsThatOfItsModesWhereAnEndLimits) {
  TissueSettings settings{.alpha = 20, .beta = 1e-4};
  settings.supports = {{.points = {0, 1, 2, 3}}};
  const MechanicalPart part = part_of(TissueBody(ball_mesh(0.1, 2), settings));
  const std::vector<MechanicalMode> modes = mechanical_modes(part).modes;
  double least = std::numeric_limits<double>::infinity();
  for (const double exit : euler_exits(modes)) least = std::min(least, exit);
  const CurveLimit limit = smallest_exit(
      {.alpha = 20, .beta = 1e-4, .kappa_min = modes.front().kappa, .kappa_max = modes.back().kappa},
      euler_exits);
  EXPECT_LE(limit.h_max, least * (1 + 1e-12));
  if (!limit.between) {
    EXPECT_NEAR(limit.h_max, least, 1e-9 * least);
  }
}

TEST(CurveLimit, BetweenTheEndsItIsTheLeastOfTheWholeCurve) {
  const DampingCurve curve{.alpha = 1, .beta = 0, .kappa_min = 0, .kappa_max = 1e8};
  for (const double where : {3.0, 4.7e3, 8.1e7}) {
    const CurveLimit limit = smallest_exit(curve, [&](std::span<const MechanicalMode> modes) {
      std::vector<double> exits;
      for (const MechanicalMode& mode : modes)
        exits.push_back(mode.kappa > 0 ? 0.5 + std::pow(std::log(mode.kappa / where), 2) : 1e9);
      return exits;
    });
    EXPECT_TRUE(limit.between) << where;
    EXPECT_NEAR(limit.h_max, 0.5, 1e-9);
    EXPECT_NEAR(limit.kappa, where, 1e-4 * where);
  }
}

TEST(CurveLimit, TheEndsAndNoLimitAtAllAreSaid) {
  const DampingCurve curve{.alpha = 2, .beta = 0, .kappa_min = 10, .kappa_max = 1e6};
  const CurveLimit fastest = smallest_exit(curve, euler_exits);
  EXPECT_FALSE(fastest.between);
  EXPECT_NEAR(fastest.h_max, 2 / 1e6, 1e-15);
  EXPECT_EQ(fastest.kappa, 1e6);
  const CurveLimit none = smallest_exit(curve, [](std::span<const MechanicalMode> modes) {
    return std::vector<double>(modes.size(), std::numeric_limits<double>::infinity());
  });
  EXPECT_TRUE(std::isinf(none.h_max));
}

}  // namespace
}  // namespace hmax
