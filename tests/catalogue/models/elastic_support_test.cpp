/// Supports that are springs, against a rigid block on a foundation.
#include <cmath>

#include <Eigen/Dense>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "catalogue/models/body_summary.hpp"
#include "catalogue/models/equilibria/body_balance.hpp"
#include "catalogue/models/equilibria/support_advice.hpp"
#include "catalogue/models/free_parts.hpp"
#include "catalogue/models/problems.hpp"
#include "core/errors.hpp"
#include "problems/tissue/body.hpp"
#include "tests/says.hpp"

namespace hmax {
namespace {

/// A stiff cube that stands on 5e4 Pa/m.
Problem standing(const std::string& model, int n, Parameters more = {}) {
  Parameters parameters{{"E", 1e8}, {"rho", 1000}, {"support:z<1e-9", 1}, {"support_stiffness", 5e4}};
  for (const auto& [name, value] : more) {
    std::erase_if(parameters, [&](const auto& each) { return each.first == name; });
    parameters.emplace_back(name, value);
  }
  return make_problem(fmt::format("{}@cube:n={}", model, n), {.parameters = std::move(parameters)});
}

double side_of(const TissueBody& body) {
  return body.mesh().points.row(0).maxCoeff() - body.mesh().points.row(0).minCoeff();
}

TEST(ElasticSupport, OfARigidBlockSagsByItsWeightOverTheStiffnessOfItsGround) {
  for (const char* model : {"fem_green", "fem_corotational", "fem_neo_hookean", "mass_spring"})
    for (const int n : {2, 4}) {
      const Problem problem = standing(model, n);
      const double expected = 1000 * 9.81 * side_of(*problem.body) / 5e4;  // m g / (s A)
      EXPECT_NEAR(*linear_sag(*problem.body), expected, 2e-3 * expected) << model << n;
      EXPECT_TRUE(loose_dofs(*problem.body).empty());
      EXPECT_EQ(problem.body->free_points().size(),
                static_cast<std::size_t>(problem.body->mesh().point_count()));
    }
}

TEST(ElasticSupport, OfARigidBlockBouncesWithTheRootOfStiffnessOverMass) {
  const Problem problem = standing("fem_cauchy", 2);
  const TissueBody& body = *problem.body;
  const Eigen::VectorXd rest = Eigen::VectorXd::Zero(body.dofs());
  TissueBody::DofMatrix K;
  body.stiffness(0, rest, rest, K);
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> modes(
      Eigen::MatrixXd(K), Eigen::MatrixXd(body.mass().asDiagonal()));
  Eigen::VectorXd up = rest;
  for (Eigen::Index i = 2; i < up.size(); i += 3) up[i] = 1;
  up /= std::sqrt(up.dot(body.mass().cwiseProduct(up)));
  // The mode that is nearest to moving up as a whole.
  const Eigen::VectorXd share = (modes.eigenvectors().transpose() * body.mass().cwiseProduct(up)).cwiseAbs2();
  Eigen::Index bounce = 0;
  EXPECT_GT(share.maxCoeff(&bounce), 0.99);
  const double expected = 5e4 * std::pow(side_of(body), 2) / (body.mass().sum() / 3);
  EXPECT_NEAR(modes.eigenvalues()[bounce], expected, 1e-3 * expected);
}

TEST(ElasticSupport, IsShownAndMayHoldTheWholeSurface) {
  const auto surface = [](Parameters parameters) {
    return make_problem("fem_green@cube:n=3", {.parameters = std::move(parameters)});
  };
  const Problem all = surface({{"support:z<inf", 1}, {"support_stiffness", 1000}});
  EXPECT_EQ(summary_of(*all.body).on_springs, 64 - 8);
  EXPECT_TRUE(says(in_words(summary_of(*all.body)), "0 of 64 nodes fixed, 56 held by springs"));
  EXPECT_THROW(surface({{"support:z<inf", 1}}), InputError);
  EXPECT_FALSE(suggested_support(all));
}

TEST(ElasticSupport, TipsOverWhereItsGroundIsSofterThanItsWeight) {
  // Turned by a small angle a cube of side L is righted by s L^4 / 12 and tipped by its weight at L / 2:
  // it stands where s > 6 rho g.
  const double least = 6 * 1000 * 9.81;
  const auto found = [&](double share) {
    return found_equilibrium(standing("fem_green", 6, {{"support_stiffness", share * least}}), 1, {},
                             [] { return 0.0; });
  };
  EXPECT_TRUE(found(1.1).converged);
  EXPECT_FALSE(found(0.9).converged);
}

TEST(ElasticSupport, CarriesTheWeightAboveItAsFixedPointsDo) {
  // rho g L of a column that stands on the ground: the whole height.
  const Problem soft = standing("fem_green", 2);
  const BodySummary summary = summary_of(*soft.body);
  EXPECT_NEAR(summary.weight_compression, 1000 * 9.81 * side_of(*soft.body), 1e-9);
  // Points that are fixed as well count as fixed; those without stiffness are not held.
  TissueSettings settings = soft.body->settings();
  settings.elastic_supports.front().stiffness.front() = 0;
  settings.supports = {{.points = {settings.elastic_supports.front().points.back()}}};
  const BodySummary fewer = summary_of(soft.body->mesh(), settings);
  EXPECT_EQ(fewer.held, 1);
  EXPECT_EQ(fewer.on_springs, summary.on_springs - 2);
}

TEST(ElasticSupport, IsRefusedWhereItCannotAct) {
  const auto refusal = [](const std::string& id, Parameters parameters) -> std::string {
    return error_of<InputError>([&] { make_problem(id, {.parameters = std::move(parameters)}); });
  };
  EXPECT_TRUE(
      says(refusal("fem_green/breathing@cube:n=2", {{"support_stiffness", 1e4}}), "breathing moves them"));
  EXPECT_TRUE(
      says(refusal("fem_green@cube:n=2", {{"support", 0}, {"support_stiffness", 1e4}}), "nothing is held"));
  EXPECT_TRUE(says(refusal("fem_green@cube:n=2", {{"support:points:1", 1}, {"support_stiffness", 1e4}}),
                   "no triangle of the surface"));
  EXPECT_TRUE(says(refusal("fem_green@cube:n=2", {{"support_stiffness", -1}}), "must not be negative"));
}

}  // namespace
}  // namespace hmax
