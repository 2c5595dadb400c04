#include "problems/matrices/multipliers.hpp"

#include <random>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "tests/problems/matrices/matrix_folder.hpp"

namespace hmax {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

using Multipliers = MatrixFolder;

/// [K B^T; B 0].
MatrixXd saddle(const MatrixXd& K, const MatrixXd& B) {
  const Index n = K.rows(), m = B.rows();
  MatrixXd whole = MatrixXd::Zero(n + m, n + m);
  whole.topLeftCorner(n, n) = K;
  whole.bottomLeftCorner(m, n) = B;
  whole.topRightCorner(n, m) = B.transpose();
  return whole;
}

/// Masses of unknowns, none of m multipliers behind them.
MatrixXd with_multipliers(const VectorXd& mass, Index m) {
  VectorXd all = VectorXd::Zero(mass.size() + m);
  all.head(mass.size()) = mass;
  return all.asDiagonal();
}

/// Eigenvalues of the motions with B q = 0, from a basis of them: nothing of the code under test.
VectorXd expected_stiffnesses(const MatrixXd& K, const VectorXd& mass, const MatrixXd& B) {
  Eigen::FullPivLU<MatrixXd> factors(B);
  factors.setThreshold(1e-9);
  const MatrixXd N = factors.kernel();
  return Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd>(N.transpose() * K * N,
                                                            N.transpose() * MatrixXd(mass.asDiagonal()) * N)
      .eigenvalues();
}

void expect_near(const VectorXd& found, const VectorXd& expected) {
  ASSERT_EQ(found.size(), expected.size());
  EXPECT_LE((found - expected).cwiseAbs().maxCoeff(), 1e-12 * expected.cwiseAbs().maxCoeff());
}

TEST_F(Multipliers, HoldAndTieUnknowns) {
  const MatrixXd K = chain(6);
  const VectorXd mass = VectorXd::LinSpaced(6, 1, 2);
  MatrixXd B = MatrixXd::Zero(2, 6);
  B(0, 0) = 3;                // q1 = 0
  B(1, 2) = 1, B(1, 4) = -1;  // q3 = q5
  const MatrixModel model = read_matrix_model(files(saddle(K, B), with_multipliers(mass, 2)));
  EXPECT_EQ(model.facts.multipliers, 2);
  EXPECT_EQ(model.facts.massless, 0);
  EXPECT_EQ(model.size(), 4);
  EXPECT_FALSE(model.facts.coupled_mass);
  expect_near(stiffnesses(system_of(model, 0, 0)), expected_stiffnesses(K, mass, B));
}

TEST_F(Multipliers, OfGeneralConstraintsHaveTheModesOfTheNullSpace) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> number(-1, 1);
  for (int trial = 0; trial < 20; ++trial) {
    const Index n = 9, m = 1 + trial % 5;
    const VectorXd mass = VectorXd::LinSpaced(n, 1, 3);
    MatrixXd B = MatrixXd::Zero(m, n);
    for (Index i = 0; i < m; ++i)
      for (Index k = 0; k < 3; ++k) B(i, static_cast<Index>(random() % n)) = number(random);
    const MatrixModel model = read_matrix_model(files(saddle(chain(n), B), with_multipliers(mass, m)));
    expect_near(stiffnesses(system_of(model, 0, 0)), expected_stiffnesses(chain(n), mass, B));
    EXPECT_TRUE(model.facts.symmetric_K);
  }
}

TEST_F(Multipliers, ThatRepeatConstraintsAreLeftOutByName) {
  MatrixXd B = MatrixXd::Zero(3, 5);
  B(0, 0) = 1, B(0, 1) = -1;
  B(1, 1) = 1, B(1, 2) = -1;
  B(2, 0) = 0.3, B(2, 2) = -0.3;  // the sum of the two before
  const VectorXd mass = VectorXd::Ones(5);
  const MatrixModel model = read_matrix_model(files(saddle(chain(5), B), with_multipliers(mass, 3)));
  EXPECT_EQ(model.facts.redundant, std::vector<Index>{7});
  expect_near(stiffnesses(system_of(model, 0, 0)), expected_stiffnesses(chain(5), mass, B));
}

TEST_F(Multipliers, TakeUnknownsWithoutMassFirstAndLeaveTheOthersToCondensation) {
  VectorXd mass = VectorXd::Ones(6);
  mass[2] = mass[4] = 0;
  MatrixXd B = MatrixXd::Zero(1, 6);
  B(0, 1) = 1, B(0, 2) = -2, B(0, 5) = 1;
  const MatrixModel model = read_matrix_model(files(saddle(chain(6), B), with_multipliers(mass, 1)));
  EXPECT_EQ(model.unknowns, (std::vector<Index>{0, 1, 3, 5}));
  EXPECT_EQ(model.facts.massless, 1);
  EXPECT_FALSE(model.facts.coupled_mass);
  // Without mass in the limit of a small one: the other modes are far away.
  mass[2] = mass[4] = 1e-9;
  const VectorXd expected = expected_stiffnesses(chain(6), mass, B).head(4);
  EXPECT_LE((stiffnesses(system_of(model, 0, 0)) - expected).cwiseAbs().maxCoeff(), 1e-7);
}

TEST_F(Multipliers, KeepDampingAndProjectIt) {
  const VectorXd mass = VectorXd::Ones(4);
  MatrixXd B = MatrixXd::Zero(1, 4);
  B(0, 0) = 1, B(0, 3) = -1;
  MatrixFiles given = files(saddle(chain(4), B), with_multipliers(mass, 1));
  MatrixXd C = MatrixXd::Zero(5, 5);
  C(0, 0) = 1, C(3, 3) = 2;
  given.damping = write("C.mtx", C);
  const MatrixModel model = read_matrix_model(given);
  // The tied unknowns share both dashpots.
  EXPECT_EQ(MatrixXd(model.C).diagonal().maxCoeff(), 3);
  C(4, 4) = 1;
  given.damping = write("C.mtx", C);
  expect_refusal(given, "damping acts on unknown 5, which has no mass");
}

TEST_F(Multipliers, AreRefusedWhereTheyHoldEverythingOrDoNotActBack) {
  const MatrixXd one = MatrixXd::Identity(2, 2);
  expect_refusal(files(saddle(chain(2), one), with_multipliers(VectorXd::Ones(2), 2)), "hold every unknown");
  MatrixXd K = saddle(chain(3), MatrixXd::Ones(1, 3));
  K(0, 3) = 2;
  expect_refusal(files(K, with_multipliers(VectorXd::Ones(3), 1)), "is not the transpose of its row");
}

TEST_F(Multipliers, OfThousandsOfTiesAreFast) {
  // Two chains tied point by point: one chain of twice the stiffness and mass.
  const Index n = 20000;
  std::vector<Eigen::Triplet<double>> K, M;
  const auto at = [](Index i) { return static_cast<int>(i); };
  for (const Index part : {Index(0), n})
    for (Index i = 0; i < n; ++i) {
      K.emplace_back(at(part + i), at(part + i), 2.0);
      M.emplace_back(at(part + i), at(part + i), 1.0);
      if (i > 0)
        K.emplace_back(at(part + i), at(part + i - 1), -1.0),
            K.emplace_back(at(part + i - 1), at(part + i), -1.0);
    }
  for (Index i = 0; i < n; ++i)
    for (const auto& [j, value] : {std::pair(i, 1.0), {n + i, -1.0}})
      K.emplace_back(at(2 * n + i), at(j), value), K.emplace_back(at(j), at(2 * n + i), value);
  Eigen::SparseMatrix<double> stiffness(3 * n, 3 * n), mass(3 * n, 3 * n);
  stiffness.setFromTriplets(K.begin(), K.end());
  mass.setFromTriplets(M.begin(), M.end());
  const MatrixModel model =
      read_matrix_model({.stiffness = write("K.mtx", matrix_market_text(stiffness, "ties")),
                         .mass = write("M.mtx", matrix_market_text(mass, "ties"))});
  EXPECT_EQ(model.size(), n);
  EXPECT_EQ(model.mass, VectorXd::Constant(n, 2.0));
  EXPECT_EQ(model.K.coeff(5, 5), 4);
  EXPECT_EQ(model.K.coeff(5, 6), -2);
}

TEST_F(Multipliers, ThatTieThousandsOfUnknownsAtOnceAreRefused) {
  // One constraint of n unknowns would make n^2 entries of the stiffness.
  const int n = 8000;
  std::vector<Eigen::Triplet<double>> K, M;
  for (int i = 0; i < n; ++i) {
    K.emplace_back(i, i, 1.0), K.emplace_back(i, n, 1.0), K.emplace_back(n, i, 1.0);
    M.emplace_back(i, i, 1.0);
  }
  Eigen::SparseMatrix<double> stiffness(n + 1, n + 1), mass(n + 1, n + 1);
  stiffness.setFromTriplets(K.begin(), K.end());
  mass.setFromTriplets(M.begin(), M.end());
  expect_refusal({.stiffness = write("K.mtx", matrix_market_text(stiffness, "one")),
                  .mass = write("M.mtx", matrix_market_text(mass, "one"))},
                 "the Lagrange multipliers couple too many unknowns to be eliminated");
}

}  // namespace
}  // namespace hmax
