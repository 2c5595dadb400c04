#include "catalogue/models/free_parts.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "catalogue/methods/catalogue.hpp"
#include "catalogue/models/equilibria/body_balance.hpp"
#include "catalogue/models/problems.hpp"
#include "limits/linearised_problem.hpp"
#include "limits/predict.hpp"
#include "limits/verification.hpp"
#include "problems/mesh/files/mesh_writers.hpp"
#include "problems/mesh/mesh_generators.hpp"
#include "tests/results/scratch.hpp"
#include "tests/says.hpp"

namespace hmax {
namespace {

/// Two cubes of 0.1 m beside each other, 48 tetrahedra each, without a common point.
TetMesh two_cubes() {
  const TetMesh cube = cube_mesh(0.1, 2);
  TetMesh both;
  both.points.resize(3, 2 * cube.points.cols());
  both.points << cube.points, cube.points.colwise() + Eigen::Vector3d(0.3, 0, 0);
  both.tetrahedra.resize(4, 2 * cube.tetrahedra.cols());
  both.tetrahedra << cube.tetrahedra, (cube.tetrahedra.array() + cube.point_count()).matrix();
  return both;
}

class FreeParts : public testing::Test {
 protected:
  FreeParts() { write_text(folder_ / "two.msh", msh_text(counted_from_one(two_cubes()))); }

  [[nodiscard]] Problem made(const std::string& model, std::vector<std::string> supports,
                             std::vector<std::pair<std::string, double>> parameters = {}) const {
    for (const std::string& set : supports) parameters.emplace_back("support:" + set, 1);
    return make_problem(model + "@" + (folder_ / "two.msh").string(),
                        {.parameters = std::move(parameters), .unit = 1.0});
  }

 private:
  Scratch folder_;
};

/// Boxes around the bottom of the first cube and around both bottoms.
constexpr const char* first_bottom = "-1,0.2,-1,1,-0.001,0.001";
constexpr const char* both = "-1,1,-1,1,-0.001,0.001";

TEST_F(FreeParts, AreNamedWithTheRemedy) {
  EXPECT_EQ(free_parts_in_words(made("fem_green", {both})), "");
  EXPECT_EQ(
      free_parts_in_words(made("fem_green", {first_bottom})),
      "the supports hold no point of the part of 48 tetrahedra (49, 50, 51, ...), which moves freely; hold more "
      "points");
  EXPECT_TRUE(says(free_parts_in_words(made("fem_green", {first_bottom, "points:28"})), "one point"));
}

TEST_F(FreeParts, MoveWithoutForceAndWithUnitMass) {
  const Problem problem = made("fem_green", {first_bottom});
  const Eigen::MatrixXd R = free_motions(*problem.body);
  ASSERT_EQ(R.cols(), 6);
  const Eigen::MatrixXd one = R.transpose() * problem.body->mass().asDiagonal() * R;
  EXPECT_LT((one - Eigen::MatrixXd::Identity(6, 6)).norm(), 1e-12);
  TissueBody::DofMatrix K;
  const Eigen::VectorXd rest = Eigen::VectorXd::Zero(problem.body->dofs());
  problem.body->stiffness(0, rest, rest, K);
  EXPECT_LT((K * R).norm(), 1e-10 * K.norm() * R.norm());
}

TEST_F(FreeParts, HaveNoEquilibriumUnderTheirWeight) {
  const Problem problem = made("fem_green", {first_bottom});
  const StaticSolution fallen = found_equilibrium(problem, 1, {}, [] { return 0.0; });
  EXPECT_FALSE(fallen.converged);
  EXPECT_TRUE(says(cause_of(problem, fallen), "49, 50, 51"));
  const Linearised near = linearised(problem, AskedState::equilibrium);
  EXPECT_FALSE(near.point.at_equilibrium);
  EXPECT_TRUE(says(near.point.status, "hold more points"));
  EXPECT_FALSE(says(near.point.status, "smaller load"));
}

TEST_F(FreeParts, AreInEquilibriumWhereNothingPushesThem) {
  // A press acts on the end of the box around all that is opposite to `axis`: of the first cube or the
  // second.
  for (const double axis : {-1.0, 1.0}) {
    const Problem problem = made("fem_green/press", {first_bottom}, {{"axis", axis}, {"force", 0.01}});
    const StaticSolution found = found_equilibrium(problem, 1, {}, [] { return 0.0; });
    EXPECT_EQ(found.converged, axis < 0) << cause_of(problem, found);
    EXPECT_EQ(found.singular, axis > 0);
    EXPECT_EQ(linearised(problem, AskedState::equilibrium).point.at_equilibrium, axis < 0);
  }
}

TEST_F(FreeParts, TakeNoPartInTheVerificationOfALimit) {
  for (const double alpha : {0.0, 1.0}) {
    const Problem problem = made("fem_green", {first_bottom}, {{"g", 0}, {"alpha", alpha}});
    const Linearised near = linearised(problem, AskedState::equilibrium);
    ASSERT_TRUE(near.point.at_equilibrium);
    for (const char* name : {"rk4", "symplectic_euler", "newmark"}) {
      const Method method = find_method(name);
      Prediction row = predict(method, near);
      verify(row, method, problem, near);
      ASSERT_TRUE(row.observed) << name << row.note;
      EXPECT_FALSE(row.observed->contradicts()) << name << " " << row.note;
      if (row.bound == Bound::stability) {
        EXPECT_LE(std::abs(row.observed->gap), 5e-3) << name;
      }
    }
  }
}

}  // namespace
}  // namespace hmax
