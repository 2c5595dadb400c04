#include "problems/matrices/varying_structure.hpp"

#include <Eigen/Dense>

#include "integrators/explicit/explicit_rk.hpp"
#include "integrators/explicit/tableaux.hpp"
#include "integrators/integrate.hpp"
#include "integrators/structural/generalized_alpha.hpp"
#include "tests/problems/matrices/matrix_folder.hpp"

namespace hmax {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

using MatricesInTime = MatrixFolder;

MatrixXd stiffness_of(const AnySystem& system, double t) {
  const VectorXd zero = VectorXd::Zero(system.dofs());
  AnySystem::DofMatrix K;
  system.stiffness(t, zero, zero, K);
  return MatrixXd(std::get<1>(K));
}
MatrixXd damping_of(const AnySystem& system, double t) {
  const VectorXd zero = VectorXd::Zero(system.dofs());
  AnySystem::DofMatrix C;
  system.damping(t, zero, zero, C);
  return MatrixXd(std::get<1>(C));
}

TEST_F(MatricesInTime, AreLinearBetweenTheirTimesAndStayBeyond) {
  // The second matrix has a place that the first has not.
  MatrixXd second = 3 * chain(4);
  second(0, 3) = second(3, 0) = -1;
  write("K0.mtx", chain(4));
  write("K1.mtx", second);
  MatrixFiles given = files(chain(4), 2 * MatrixXd::Identity(4, 4));
  given.stiffness = write("K.txt", "# tangents\n1 K0.mtx\n\n3 K1.mtx # the last one\n");
  expect_refusal(
      [&] {
        auto wrong = given;
        wrong.stiffness_series = true;
        return wrong;
      }(),
      "line 4: the line has");
  given.stiffness = write("K.txt", "# tangents\n1 K0.mtx\n\n3 K1.mtx\n");
  given.stiffness_series = true;
  const MatrixModel model = read_matrix_model(given);
  const AnySystem system = system_of(model, 0.5, 0.25);
  for (const auto& [t, share] :
       {std::pair(0.0, 0.0), {1.0, 0.0}, {1.5, 0.25}, {2.9, 0.95}, {3.0, 1.0}, {9.0, 1.0}}) {
    const MatrixXd K = (1 - share) * chain(4) + share * second;
    EXPECT_NEAR((stiffness_of(system, t) - K).norm(), 0, 1e-14) << t;
    const MatrixXd C = 0.5 * 2 * MatrixXd::Identity(4, 4) + 0.25 * K;
    EXPECT_NEAR((damping_of(system, t) - C).norm(), 0, 1e-14) << t;
    const VectorXd q = VectorXd::LinSpaced(4, 1, 2), v = VectorXd::LinSpaced(4, -1, 3);
    VectorXd f(4), y(8), rates(8);
    system.force(t, q, v, f);
    EXPECT_NEAR((f + K * q + C * v).norm(), 0, 1e-13) << t;
    y << q, v;
    system.rhs(t, y, rates);
    EXPECT_NEAR((rates.tail(4) + (K * q + C * v) / 2).norm(), 0, 1e-13) << t;
    AnySystem::Jacobian J;
    system.jacobian(t, y, J);
    EXPECT_NEAR((std::get<1>(J) * y - rates).norm(), 0, 1e-13) << t;
  }
  EXPECT_FALSE(system.is_autonomous());
  EXPECT_EQ(model.varying->times(), (std::vector<double>{1, 3}));
}

TEST_F(MatricesInTime, HaveTheTimeDerivativeOfDifferences) {
  write("K0.mtx", chain(3));
  write("K1.mtx", 2 * chain(3));
  write("C0.mtx", MatrixXd::Identity(3, 3));
  write("C1.mtx", 5 * MatrixXd::Identity(3, 3));
  MatrixFiles given = files(chain(3), MatrixXd::Identity(3, 3));
  given.stiffness = write("K.txt", "0 K0.mtx\n2 K1.mtx\n");
  given.damping = write("C.txt", "0.5 C0.mtx\n1 C1.mtx\n");
  given.stiffness_series = given.damping_series = true;
  const MatrixModel model = read_matrix_model(given);
  EXPECT_EQ(model.varying->times(), (std::vector<double>{0, 0.5, 1, 2}));
  const AnySystem system = system_of(model, 0.1, 0.2);
  const VectorXd y = VectorXd::LinSpaced(6, -1, 2);
  VectorXd before(6), after(6), rate(6);
  for (const double t : {-1.0, 0.25, 0.75, 1.5, 3.0}) {
    const double d = 1e-3;  // the right-hand side is linear in t here
    system.rhs(t - d, y, before);
    system.rhs(t + d, y, after);
    system.time_derivative(t, y, rate);
    EXPECT_NEAR((rate - (after - before) / (2 * d)).norm(), 0, 1e-11) << t;
  }
}

TEST_F(MatricesInTime, MayHaveAMassThatCouplesUnknowns) {
  // M has places that no K has.
  const Index n = 4;
  MatrixXd M = 2 * MatrixXd::Identity(n, n);
  M(0, 3) = M(3, 0) = 0.5;
  M(1, 2) = M(2, 1) = -0.25;
  write("K0.mtx", chain(n));
  write("K1.mtx", 3 * chain(n));
  MatrixFiles given = files(chain(n), M);
  given.stiffness = write("K.txt",
                          "\xEF\xBB\xBF"
                          "0 K0.mtx\n2 K1.mtx\n");
  given.stiffness_series = true;
  const double alpha = 0.1, beta = 0.2, t = 0.5;
  const AnySystem system = system_of(read_matrix_model(given), alpha, beta);
  EXPECT_EQ(MatrixXd(system.mass_matrix().matrix()), M);
  const MatrixXd K = 1.5 * chain(n), C = alpha * M + beta * K, inverse = M.inverse();
  EXPECT_NEAR((stiffness_of(system, t) - K).norm(), 0, 1e-14);
  EXPECT_NEAR((damping_of(system, t) - C).norm(), 0, 1e-14);
  const VectorXd q = VectorXd::LinSpaced(n, 1, 2), v = VectorXd::LinSpaced(n, -1, 3);
  VectorXd f(n), y(2 * n), rates(2 * n), rate_in_time(2 * n), expected(2 * n);
  system.force(t, q, v, f);
  EXPECT_NEAR((f + K * q + C * v).norm(), 0, 1e-13);
  y << q, v;
  system.rhs(t, y, rates);
  expected << v, -inverse * (K * q + C * v);
  EXPECT_NEAR((rates - expected).norm(), 0, 1e-13);
  system.time_derivative(t, y, rate_in_time);
  expected << VectorXd::Zero(n), -inverse * chain(n) * (q + beta * v);
  EXPECT_NEAR((rate_in_time - expected).norm(), 0, 1e-13);
  AnySystem::Jacobian J;
  system.jacobian(t, y, J);
  EXPECT_NEAR((std::get<1>(J) * y - rates).norm(), 0, 1e-13);
}

TEST_F(MatricesInTime, OfACoupledMassMoveAsTheirModesDo) {
  // K(t) = k(t) K(0) keeps the modes: each moves as one mass on the spring k(t) omega^2.
  const Index n = 4;
  MatrixXd M = 2 * MatrixXd::Identity(n, n);
  M(0, 1) = M(1, 0) = M(2, 3) = M(3, 2) = 0.5;
  const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> modes(chain(n), M);
  write("K0.mtx", chain(n));
  write("K1.mtx", 3 * chain(n));
  MatrixFiles given = files(chain(n), M);
  given.stiffness = write("K.txt", "0 K0.mtx\n2 K1.mtx\n");
  given.stiffness_series = true;
  const auto end_of = [](const MatrixFiles& files, const VectorXd& q, auto stepper) {
    VectorXd y = VectorXd::Zero(2 * q.size());
    y.head(q.size()) = q;
    integrate(stepper, system_of(read_matrix_model(files), 0, 0.01), Span<double>{0, 2}, y, FixedStep(0.02));
    return y;
  };
  const auto expect_alike = [&](auto stepper) {
    for (Index i = 0; i < n; ++i) {
      const MatrixXd kappa = MatrixXd::Constant(1, 1, modes.eigenvalues()[i]);
      write("k0.mtx", kappa);
      write("k1.mtx", 3 * kappa);
      MatrixFiles one{.stiffness = write("k.txt", "0 k0.mtx\n2 k1.mtx\n"),
                      .mass = write("m.mtx", MatrixXd::Ones(1, 1))};
      one.stiffness_series = true;
      const VectorXd shape = modes.eigenvectors().col(i), y = end_of(given, shape, stepper),
                     alone = end_of(one, VectorXd::Ones(1), stepper);
      EXPECT_NEAR((y.head(n) - alone[0] * shape).norm(), 0, 1e-12) << i;
      EXPECT_NEAR((y.tail(n) - alone[1] * shape).norm(), 0, 1e-12) << i;
    }
  };
  expect_alike(Rk<tableaux::Rk4, VectorXd>{});
  expect_alike(GeneralizedAlpha<VectorXd, VectorXd, AnySystem::DofMatrix>(newmark_parameters(0.25L, 0.5L)));
}

TEST_F(MatricesInTime, FrozenOnesAreThoseOfTheirTime) {
  write("K0.mtx", chain(3));
  write("K1.mtx", 3 * chain(3));
  MatrixFiles given = files(chain(3), MatrixXd::Identity(3, 3));
  given.stiffness = write("K.txt", "0 K0.mtx\n1 K1.mtx\n");
  given.stiffness_series = true;
  const AnySystem still = system_of(frozen(read_matrix_model(given), 0.5), 0, 0);
  EXPECT_TRUE(still.is_autonomous());
  EXPECT_NEAR((stiffness_of(still, 7) - 2 * chain(3)).norm(), 0, 1e-14);
}

TEST_F(MatricesInTime, AreCondensedAndFreedOfMultipliersAtEachTime) {
  MatrixXd K = MatrixXd::Zero(4, 4);
  K.topLeftCorner(3, 3) << 5, -2, 0, -2, 4, -2, 0, -2, 5;
  K(3, 0) = K(0, 3) = 1;  // holds the first unknown
  MatrixXd stiffer = 2 * K;
  stiffer(3, 0) = stiffer(0, 3) = 1;
  write("K0.mtx", K);
  write("K1.mtx", stiffer);
  MatrixFiles given = files(K, MatrixXd(Eigen::Vector4d(1, 0, 1, 0).asDiagonal()));
  given.stiffness = write("K.txt", "0 K0.mtx\n1 K1.mtx\n");
  given.stiffness_series = true;
  const AnySystem system = system_of(read_matrix_model(given), 0, 0);
  // One mass on 5 - 2 (1/4) 2 = 4 N/m.
  EXPECT_NEAR(stiffness_of(system, 0)(0, 0), 4, 1e-14);
  EXPECT_NEAR(stiffness_of(system, 1)(0, 0), 8, 1e-14);
  write("K1.mtx", 2 * K);
  expect_refusal(given, "the constraints of the Lagrange multipliers change with time");
}

TEST_F(MatricesInTime, AreRefusedWithFileLineAndRemedy) {
  write("K0.mtx", chain(3));
  write("K1.mtx", chain(4));
  MatrixFiles given = files(chain(3), MatrixXd::Identity(3, 3));
  given.stiffness_series = true;
  const auto expect = [&](const std::string& text, const std::string& part) {
    given.stiffness = write("K.txt", text);
    expect_refusal(given, part);
  };
  expect("0 K0.mtx\n", "names 1 matrix but needs two or more");
  expect("", "names 0 matrices");
  expect("1 K0.mtx\n1 K0.mtx\n", "line 2: the time is 1 s but must be later");
  expect("1 K0.mtx\nnan K0.mtx\n", "line 2: the time is 'nan' but must be a finite number");
  expect("0 K0.mtx\n1 K9.mtx\n", "there is no file");
  expect("0 K0.mtx\n1 K1.mtx\n", "K1.mtx: the matrix has the shape 4 x 4 but must have 3 x 3");
  expect("0 K0.mtx\n1\n", "line 2: the line has 1 words");
}

}  // namespace
}  // namespace hmax
