#include "bench/body_balance.hpp"

#include <algorithm>
#include <random>

#include <Eigen/SparseCholesky>
#include <gtest/gtest.h>

#include "analysis/dynamic_relaxation.hpp"
#include "bench/tissue_problem.hpp"
#include "problems/tissue/body.hpp"
#include "problems/tissue/mesh_generators.hpp"
#include "problems/tissue/mesh_names.hpp"

namespace hmax {
namespace {

using Eigen::VectorXd;

double no_clock() { return 0; }

/// What makes a solution one, by another engine than the one that found it: no force is left but rounding,
/// the tangent has a Cholesky factor, and no element is inverted.
void expect_stable_equilibrium(const Problem& problem, const StaticSolution& found) {
  const TissueBody& body = *problem.body;
  const VectorXd zero = VectorXd::Zero(body.dofs());
  VectorXd f = zero, load = zero;
  body.force(0, found.q, zero, f);
  body.force(0, zero, zero, load);
  EXPECT_LT(f.norm(), 1e-9 * load.norm());
  TissueBody::DofMatrix K;
  body.stiffness(0, found.q, zero, K);
  EXPECT_EQ(Eigen::SimplicialLLT<TissueBody::DofMatrix>(K).info(), Eigen::Success);
  EXPECT_GT(body.least_volume(0, found.q).first, 0);
}

/// A ball whose points are moved by 12 % of its shortest edge and numbered anew.
TetMesh jittered_ball() {
  TetMesh mesh = mesh_by_name("ball:n=3");
  double shortest = 1;
  for (const auto& t : mesh.tetrahedra.colwise())
    for (int a = 1; a < 4; ++a)
      for (int b = 0; b < a; ++b)
        shortest = std::min(shortest, (mesh.points.col(t[a]) - mesh.points.col(t[b])).norm());
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> by(-0.12 * shortest, 0.12 * shortest);
  for (double& x : mesh.points.reshaped()) x += by(random);
  std::vector<TetMesh::Index> number(static_cast<std::size_t>(mesh.point_count()));
  for (std::size_t i = 0; i < number.size(); ++i) number[i] = static_cast<TetMesh::Index>(i);
  std::ranges::shuffle(number, random);
  Eigen::Matrix3Xd points = mesh.points;
  for (std::size_t i = 0; i < number.size(); ++i)
    points.col(number[i]) = mesh.points.col(static_cast<Eigen::Index>(i));
  mesh.points = points;
  for (TetMesh::Index& i : mesh.tetrahedra.reshaped()) i = number[static_cast<std::size_t>(i)];
  return mesh;
}

/// It stands on its lowest tenth.
Problem standing(TissueModel model, double g) {
  const TetMesh mesh = jittered_ball();
  const double low = mesh.points.row(2).minCoeff(), high = mesh.points.row(2).maxCoeff();
  TissueSettings settings;
  settings.model = model;
  settings.gravity = {0, 0, -g};
  settings.supports = {{.points = points_in_box(mesh, {-1, -1, low}, {1, 1, low + 0.1 * (high - low)})}};
  Problem problem;
  problem.body = std::make_shared<const TissueBody>(mesh, settings);
  for (std::int64_t t = 1; t <= mesh.tetrahedron_count(); ++t) problem.tetrahedron_numbers.push_back(t);
  return problem;
}

TEST(BodyBalance, OfABeamThatBucklesIsBentAndStable) {
  for (const char* id : {"fem_neo_hookean/press@beam", "fem_corotational/press@beam"}) {
    const Problem problem = make_problem(id);
    const StaticSolution found = found_balance(static_model(problem, 1), {}, no_clock);
    EXPECT_EQ(outcome_of(problem, found), "converged") << id << found.note;
    EXPECT_EQ(found.load_share, 1);
    EXPECT_LT(found.iterations, 100);  // it does not creep away from the straight shape
    expect_stable_equilibrium(problem, found);
    EXPECT_GT(largest_displacement(found.q), 0.1);
  }
}

TEST(BodyBalance, OfAJitteredMeshIsStable) {
  for (const TissueModel model : {TissueModel::mass_spring, TissueModel::fem_green,
                                  TissueModel::fem_corotational, TissueModel::fem_neo_hookean}) {
    const Problem problem = standing(model, 3);
    const StaticSolution found = found_balance(static_model(problem, 1), {}, no_clock);
    ASSERT_EQ(outcome_of(problem, found), "converged") << id_of(model) << found.note;
    expect_stable_equilibrium(problem, found);
    // Another way to it, which knows neither tangents nor line searches.
    VectorXd q = VectorXd::Zero(problem.body->dofs());
    ASSERT_TRUE(relax_dynamically(static_model(problem, 1), q, 1e-9, 50'000)) << id_of(model);
    EXPECT_LT((q - found.q).norm(), 1e-6 * q.norm()) << id_of(model);
  }
}

TEST(BodyBalance, IsLookedForUpToTheShareOfTheLoadThatTheBodyBears) {
  const Problem problem = standing(TissueModel::fem_green, 30);
  const StaticSolution ended = found_balance(static_model(problem, 1), {}, no_clock);
  EXPECT_EQ(outcome_of(problem, ended), "collapsed");
  ASSERT_GT(ended.load_share, 0.05);
  ASSERT_LT(ended.load_share, 0.9);
  const double bears = 30 * ended.load_share;
  const Problem below = standing(TissueModel::fem_green, bears),
                above = standing(TissueModel::fem_green, 1.05 * bears);
  const StaticSolution last = found_balance(static_model(below, 1), {}, no_clock);
  EXPECT_EQ(outcome_of(below, last), "converged");
  expect_stable_equilibrium(below, last);
  EXPECT_LT((last.q - ended.equilibrium).norm(), 1e-6 * last.q.norm());
  EXPECT_NE(outcome_of(above, found_balance(static_model(above, 1), {}, no_clock)), "converged");
}

TEST(BodyBalance, OfAModelThatResistsInversionIsToldWithItsInvertedElements) {
  const Problem problem = standing(TissueModel::fem_neo_hookean, 40);
  const StaticSolution found = found_balance(static_model(problem, 1), {}, no_clock);
  EXPECT_EQ(outcome_of(problem, found), "inverted");
  EXPECT_LE(found.history.back().residual, 1e-9);
  EXPECT_GT(found.load_share, 0.05);
  EXPECT_LT(found.load_share, 1);
  const std::string status = status_of(problem, found);
  EXPECT_NE(status.find("is inverted"), std::string::npos) << status;
  EXPECT_NE(status.find("% of the load"), std::string::npos) << status;
}

TEST(BodyBalance, OfSmallStrainsConvergesWhateverBecomesOfTheElements) {
  const Problem problem = standing(TissueModel::fem_cauchy, 200);
  const StaticSolution found = found_balance(static_model(problem, 1), {}, no_clock);
  ASSERT_LT(problem.body->least_volume(0, found.q).first, 0);
  EXPECT_EQ(outcome_of(problem, found), "converged");
  EXPECT_NE(status_of(problem, found).find("small strains"), std::string::npos);
}

}  // namespace
}  // namespace hmax
