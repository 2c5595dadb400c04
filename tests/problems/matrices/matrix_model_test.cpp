#include "problems/matrices/matrix_model.hpp"

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include "tests/problems/matrices/matrix_folder.hpp"

namespace hmax {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

using Matrices = MatrixFolder;

TEST_F(Matrices, MakeTheStructureWithRayleighDamping) {
  const MatrixModel model = read_matrix_model(files(chain(3), 2 * MatrixXd::Identity(3, 3)));
  EXPECT_EQ(model.facts.mass, 6);
  EXPECT_TRUE(model.facts.symmetric_K && !model.facts.coupled_mass && !model.facts.damped);
  const AnySystem system = system_of(model, 0.5, 0.25);
  const VectorXd q = VectorXd::LinSpaced(3, 1, 2), v = VectorXd::LinSpaced(3, -1, 3);
  VectorXd f(3);
  system.force(0, q, v, f);
  EXPECT_NEAR((f + chain(3) * q + (0.5 * 2 * MatrixXd::Identity(3, 3) + 0.25 * chain(3)) * v).norm(), 0,
              1e-14);
}

TEST_F(Matrices, MassesAreAColumnADiagonalOrTheSumsOfRows) {
  const MatrixXd coupled{{2, 1, 0}, {1, 4, 1}, {0, 1, 2}};
  MatrixFiles given = files(chain(3), coupled);
  given.lumped = true;
  EXPECT_EQ(read_matrix_model(given).mass, Eigen::Vector3d(3, 6, 3));
  given.lumped = false;
  given.mass = write("m.mtx", "%%MatrixMarket matrix array real general\n3 1\n3\n6\n3\n");
  EXPECT_EQ(read_matrix_model(given).mass, Eigen::Vector3d(3, 6, 3));
}

TEST_F(Matrices, ACoupledMassHasTheModesOfThePencilAndTheStartOfTheUser) {
  const MatrixXd M{{2, 1, 0}, {1, 4, 1}, {0, 1, 2}};
  const MatrixModel model = read_matrix_model(files(chain(3), M));
  EXPECT_TRUE(model.facts.coupled_mass);
  const VectorXd expected = Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd>(chain(3), M).eigenvalues();
  EXPECT_NEAR((stiffnesses(system_of(model, 0, 0)) - expected).norm(), 0, 1e-13);
  const VectorXd q = VectorXd::LinSpaced(3, 1, 2);
  EXPECT_EQ(start_from(model, q, "q").head(3), q);
  // Rayleigh damping takes the whole of M.
  AnySystem::DofMatrix C;
  system_of(model, 0.5, 0).damping(0, q, q, C);
  EXPECT_EQ(MatrixXd(std::get<1>(C)), MatrixXd(0.5 * M));
  expect_refusal(files(chain(3), MatrixXd{{2, 3, 0}, {3, 2, 0}, {0, 0, 1}}),
                 "M.mtx: the mass matrix M is not positive definite");
}

TEST_F(Matrices, UnknownsWithoutMassAreCondensed) {
  // Two springs of 2 N/m in a row with a massless point between: one of 1 N/m.
  MatrixXd K = MatrixXd::Zero(3, 3);
  K << 5, -2, 0, -2, 4, -2, 0, -2, 5;
  const MatrixModel model = read_matrix_model(files(K, MatrixXd(Eigen::Vector3d(1, 0, 1).asDiagonal())));
  EXPECT_EQ(model.facts.massless, 1);
  EXPECT_EQ(model.unknowns, (std::vector<Eigen::Index>{0, 2}));
  EXPECT_NEAR((MatrixXd(model.K) - MatrixXd{{4, -1}, {-1, 4}}).norm(), 0, 1e-14);
  K.row(1).setZero();
  K.col(1).setZero();
  expect_refusal(files(K, MatrixXd(Eigen::Vector3d(1, 0, 1).asDiagonal())),
                 "is singular, for instance at unknown 2");
}

TEST_F(Matrices, UnknownsWithoutMassThatNothingHoldsAreRefusedInEveryUnit) {
  // Three massless points on springs among themselves alone, whose factors are singular but for rounding, and
  // a force of the first body on one of them.
  MatrixXd K = MatrixXd::Zero(4, 4);
  K << 1, -0.1, 0, 0, -0.1, 0.3, -0.1, -0.2, 0, -0.1, 0.8, -0.7, 0, -0.2, -0.7, 0.9;
  const MatrixXd M = Eigen::Vector4d(1, 0, 0, 0).asDiagonal();
  for (const double unit : {1e-9, 1e-6, 1.0, 1e6})
    expect_refusal(files(unit * K, M), "is singular, for instance at unknown");
}

TEST_F(Matrices, ConstraintRowsAreFoundAndLeftOutWhenTold) {
  MatrixXd K = chain(5);
  K(0, 0) += 1e10;                         // a penalty
  K.row(4).setZero(), K.col(4).setZero();  // a row of the unit matrix
  K(4, 4) = 1;
  MatrixFiles given = files(K, MatrixXd::Identity(5, 5));
  MatrixModel model = read_matrix_model(given);
  EXPECT_EQ(model.facts.constraints.penalties, std::vector<Eigen::Index>{0});
  EXPECT_EQ(model.facts.constraints.decoupled, std::vector<Eigen::Index>{4});
  EXPECT_NEAR(model.facts.constraints.fastest, 1e5, 1);
  EXPECT_LE(model.facts.constraints.others, 2.0);
  EXPECT_TRUE(model.facts.constraints.own_the_fastest());
  EXPECT_EQ(model.size(), 5);
  given.drop_constraints = true;
  model = read_matrix_model(given);
  EXPECT_EQ(model.unknowns, (std::vector<Eigen::Index>{1, 2, 3}));
  EXPECT_EQ(MatrixXd(model.K), chain(3));
}

TEST_F(Matrices, AStiffPartOrALightUnknownIsNoConstraint) {
  // One spring among others is a million times as stiff: its rows are coupled to each other.
  MatrixXd K = chain(4);
  K(1, 1) += 1e6, K(2, 2) += 1e6, K(1, 2) -= 1e6, K(2, 1) -= 1e6;
  EXPECT_TRUE(read_matrix_model(files(K, MatrixXd::Identity(4, 4))).facts.constraints.none());
  VectorXd masses = VectorXd::Ones(4);
  masses[2] = 1e-12;
  EXPECT_TRUE(read_matrix_model(files(chain(4), MatrixXd(masses.asDiagonal()))).facts.constraints.none());
  EXPECT_TRUE(
      read_matrix_model(files(MatrixXd::Identity(4, 4), MatrixXd::Identity(4, 4))).facts.constraints.none());
}

TEST_F(Matrices, OneTriangleIsMirroredOnlyWhenTold) {
  MatrixFiles given = files(chain(3), MatrixXd::Identity(3, 3));
  given.stiffness =
      write("half.mtx",
            "%%MatrixMarket matrix coordinate real general\n3 3 5\n1 1 2\n2 1 -1\n2 2 2\n3 2 -1\n3 3 2\n");
  expect_refusal(given, "add storage=triangle to --matrices");
  given.one_triangle = true;
  EXPECT_EQ(MatrixXd(read_matrix_model(given).K), chain(3));
}

TEST_F(Matrices, TheStartIsQOrQAndV) {
  MatrixFiles given = files(chain(2), MatrixXd::Identity(2, 2));
  given.initial = write("q.mtx", "%%MatrixMarket matrix array real general\n2 1\n1\n2\n");
  EXPECT_EQ(read_matrix_model(given).start, Eigen::Vector4d(1, 2, 0, 0));
  given.initial = write("q.mtx", "%%MatrixMarket matrix array real general\n2 2\n1\n2\n3\n4\n");
  EXPECT_EQ(read_matrix_model(given).start, Eigen::Vector4d(1, 2, 3, 4));
  given.initial = write("q.mtx", "%%MatrixMarket matrix array real general\n4 1\n1\n2\n3\n4\n");
  EXPECT_EQ(read_matrix_model(given).start, Eigen::Vector4d(1, 2, 3, 4));
  given.initial = write("q.mtx", "%%MatrixMarket matrix array real general\n3 1\n1\n2\n3\n");
  expect_refusal(given, "the initial state has the shape 3 x 1 but must have 2 rows");
}

TEST_F(Matrices, OfCalculixHaveTheShapeOfTheLargestIndexAndTheNamesOfItsUnknowns) {
  const MatrixFiles given{.stiffness = write("job.sti", "1 1 2\n1 2 -1\n2 2 2\n"),
                          .mass = write("job.mas", "1 1 1\n2 2 0.5\n")};
  write("job.dof", "4.1\n4.2\n");
  const MatrixModel model = read_matrix_model(given);
  EXPECT_EQ(MatrixXd(model.K), chain(2));
  EXPECT_EQ(model.name_of(1), "unknown 2 (4.2)");
  write("job.dof",
        "\xEF\xBB\xBF"
        "4.1\n4.2\n");
  EXPECT_EQ(read_matrix_model(given).name_of(0), "unknown 1 (4.1)");
}

TEST_F(Matrices, OfCalculixHaveEachEntryOnce) {
  const std::string mass = write("job.mas", "1 1 1\n2 2 0.5\n");
  expect_refusal({.stiffness = write("job.sti", "1 1 2\n1 2 -1\n2 2 2\n1 2 -1\n"), .mass = mass},
                 "row 1, column 2 has two entries, and CalculiX writes each one once");
  expect_refusal({.stiffness = write("job.sti", "1 1 2\n1 2 -1\n2 2 2\n"),
                  .mass = write("job.mas", "1 1 1\n2 2 0.5\n1 1 1\n2 2 0.5\n")},
                 "row 1, column 1 has two entries");
}

TEST_F(Matrices, OfCalculixAreOfOneModel) {
  const MatrixFiles given{.stiffness = write("job.sti", "1 1 2\n1 2 -1\n2 2 2\n"),
                          .mass = write("other.mas", "1 1 1\n2 2 0.5\n5 5 1\n")};
  expect_refusal(given, "other.mas: the mass has rows up to 5, and the stiffness");
}

TEST_F(Matrices, LookSwappedOnlyWhereTheMassIsAStiffness) {
  const MatrixXd K = chain(6), lumped = 0.5 * MatrixXd::Identity(6, 6),
                 consistent = 0.5 * (6 * lumped - chain(6)) + lumped;
  const auto looks = [&](const MatrixXd& stiffness, const MatrixXd& mass) {
    return read_matrix_model(files(stiffness, mass)).facts.look_swapped;
  };
  EXPECT_TRUE(looks(lumped, K));
  EXPECT_TRUE(looks(consistent, K));
  for (const MatrixXd& mass : {lumped, consistent, MatrixXd(K + lumped)}) EXPECT_FALSE(looks(K, mass));
  EXPECT_FALSE(looks(lumped, consistent));
  EXPECT_FALSE(looks(lumped, K + lumped));  // a mass with negative entries
}

TEST_F(Matrices, AreRefusedWithFileAndRemedy) {
  const MatrixXd one = MatrixXd::Identity(3, 3);
  expect_refusal(files(chain(3), MatrixXd::Identity(2, 2)), "has the shape 2 x 2 but must have 3 x 3");
  expect_refusal(files(MatrixXd::Ones(2, 3), one), "must be square");
  expect_refusal(files(chain(3), MatrixXd(Eigen::Vector3d(1, -1, 1).asDiagonal())),
                 "the mass of unknown 2 is -1");
  MatrixXd M = one;
  M(0, 1) = 0.5, M(1, 2) = 0.1, M(2, 1) = 0.1;
  expect_refusal(files(chain(3), M), "the mass matrix is not symmetric at row");
  MatrixXd indefinite = one;
  indefinite(0, 1) = indefinite(1, 0) = 5;
  expect_refusal(files(chain(3), indefinite), "not positive definite");
  M = one;
  M(1, 1) = 0, M(0, 1) = M(1, 0) = 0.5;
  expect_refusal(files(chain(3), M), "unknown 2 has no mass on the diagonal and is coupled to others");
  MatrixFiles huge = files(chain(3), one);
  huge.stiffness =
      write("huge.mtx", "%%MatrixMarket matrix coordinate real general\n2000000000 2000000000 1\n1 1 1\n");
  huge.mass = write("huge_mass.mtx",
                    "%%MatrixMarket matrix coordinate real general\n2000000000 2000000000 1\n1 1 1\n");
  expect_refusal(huge, "some unknowns have neither stiffness nor mass");
  expect_refusal({.jacobian = huge.stiffness}, "check the number of rows");
  MatrixFiles damped = files(chain(3), MatrixXd(Eigen::Vector3d(1, 0, 1).asDiagonal()));
  damped.damping = write("C.mtx", MatrixXd(Eigen::Vector3d(0, 1, 0).asDiagonal()));
  expect_refusal(damped, "damping acts on unknown 2, which has no mass");
}

TEST_F(Matrices, MassBeyondTheDenseBoundIsDividedBy) {
  const Eigen::Index n = 1501;
  MatrixXd M = MatrixXd::Identity(n, n);
  M(0, 1) = M(1, 0) = 0.1;
  const AnySystem system = system_of(read_matrix_model(files(chain(n), M)), 0, 0);
  const VectorXd q = VectorXd::LinSpaced(n, -1, 1).array().square();
  VectorXd y = VectorXd::Zero(2 * n), dydt(2 * n);
  y.head(n) = q;
  system.rhs(0, y, dydt);
  EXPECT_LT((M * dydt.tail(n) + chain(n) * q).norm(), 1e-12);
}

TEST_F(Matrices, OfFirstOrderMakeTheirSystem) {
  const MatrixXd J{{-1, 2}, {0, -3}};
  const MatrixModel model = read_matrix_model({.jacobian = write("J.mtx", J)});
  const AnySystem system = system_of(model, 0, 0);
  VectorXd rates(2);
  system.rhs(0, Eigen::Vector2d(1, 1), rates);
  EXPECT_EQ(rates, Eigen::Vector2d(1, -3));
  EXPECT_EQ(system.dofs(), 0);
}

}  // namespace
}  // namespace hmax
