/// The largest stable step as one call, held against closed forms and against the prediction for bodies.
#include "limits/largest_stable_step.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "catalogue/methods/catalogue.hpp"
#include "catalogue/models/problems.hpp"
#include "core/errors.hpp"
#include "core/numbers.hpp"
#include "integrators/control.hpp"
#include "integrators/explicit/explicit_rk.hpp"
#include "integrators/integrate.hpp"
#include "limits/linearised_problem.hpp"
#include "limits/predict.hpp"
#include "problems/tissue/body.hpp"

namespace hmax {
namespace {

using Sparse = Eigen::SparseMatrix<double>;

/// The stability polynomial of RK4 at its first zero of |R| - 1 on the negative axis.
constexpr double real_exit_of_rk4 = 2.785293563405282;

Eigen::MatrixXd one(double value) { return Eigen::MatrixXd::Constant(1, 1, value); }

TEST(LargestStableStep, OfAnUndampedOscillatorIsTheBoundOnTheImaginaryAxis) {
  // m = 0.01 kg, k = 100 N/m: 100 rad/s.
  const Eigen::VectorXd M = Eigen::VectorXd::Constant(1, 0.01);
  const StepAnswer rk4 = largest_stable_step("rk4", one(100), M);
  EXPECT_EQ(rk4.method, "rk4");
  EXPECT_EQ(rk4.bound, Bound::stability);
  EXPECT_NEAR(rk4.h_max, 2 * std::numbers::sqrt2 / 100, 1e-12);
  ASSERT_TRUE(rk4.limiting);
  EXPECT_NEAR(rk4.limiting->omega.value(), 100, 1e-10);
  EXPECT_NEAR(rk4.limiting->zeta.value(), 0, 1e-12);
  EXPECT_EQ(rk4.state_kind, "equilibrium");
  EXPECT_EQ(rk4.status, "");
  EXPECT_NEAR(largest_stable_step("rk3_kutta", one(100), M).h_max, std::sqrt(3) / 100, 1e-12);
  EXPECT_NEAR(largest_stable_step("symplectic_euler", one(100), M).h_max, 0.02, 1e-12);
  EXPECT_NEAR(largest_stable_step(std::string("velocity_verlet"), one(100), M).h_max, 0.02, 1e-12);
}

TEST(LargestStableStep, OfADampedOscillatorFollowsItsClosedForm) {
  const Eigen::VectorXd M = Eigen::VectorXd::Constant(1, 2);
  const double omega = 10, zeta = 0.3;
  // Explicit Euler: |1 + h lambda| = 1 at h = 2 zeta / omega.
  EXPECT_NEAR(largest_stable_step("explicit_euler", one(2 * omega * omega), M, one(4 * zeta * omega)).h_max,
              2 * zeta / omega, 1e-12);
  // Overdamped, lambda = -1 and -40: RK4 is limited by the faster.
  const StepAnswer slow = largest_stable_step("rk4", one(80), M, one(82));
  EXPECT_NEAR(slow.h_max, real_exit_of_rk4 / 40, 1e-12);
  ASSERT_TRUE(slow.limiting && slow.limiting->rates);
  EXPECT_NEAR((*slow.limiting->rates)[0], 40, 1e-12);
}

TEST(LargestStableStep, SaysWhereThereIsNoNumber) {
  const Eigen::VectorXd M = Eigen::VectorXd::Constant(1, 1);
  const StepAnswer newmark = largest_stable_step("newmark", one(4), M);
  EXPECT_EQ(newmark.bound, Bound::accuracy);
  EXPECT_EQ(newmark.h_max, infinity);
  const StepAnswer euler = largest_stable_step("explicit_euler", one(4), M);
  EXPECT_EQ(euler.bound, Bound::every_step);
  EXPECT_EQ(euler.h_max, 0);
  const StepAnswer buckled = largest_stable_step("rk4", one(-4), M);
  EXPECT_EQ(buckled.bound, Bound::model);
  EXPECT_TRUE(std::isnan(buckled.h_max));
  EXPECT_NE(buckled.status.find("grows as exp(2 t)"), std::string::npos) << buckled.status;
  EXPECT_EQ(largest_stable_step("adams_pece", one(4), M).bound, Bound::error_control);
  for (const StepAnswer& answer : {newmark, euler, buckled}) {
    EXPECT_TRUE(describe(answer).starts_with(answer.method + ": ")) << describe(answer);
    EXPECT_EQ(describe(answer).find("nan"), std::string::npos) << describe(answer);
  }
}

/// The stiffness of n masses between walls; omega_max = 2 sqrt(k / m) cos(pi / (2 (n + 1))).
Sparse chain(int n, double k) {
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < n; ++i) {
    entries.emplace_back(i, i, 2 * k);
    if (i + 1 < n) {
      entries.emplace_back(i, i + 1, -k);
      entries.emplace_back(i + 1, i, -k);
    }
  }
  Sparse K(n, n);
  K.setFromTriplets(entries.begin(), entries.end());
  return K;
}

TEST(LargestStableStep, OfAChainOfSpringsIsThatOfItsFastestMode) {
  for (const int n : {3, 200}) {
    const double omega = 2 * std::sqrt(100 / 0.01) * std::cos(std::numbers::pi / (2 * (n + 1)));
    const StepAnswer answer = largest_stable_step("rk4", chain(n, 100), Eigen::VectorXd::Constant(n, 0.01));
    EXPECT_NEAR(answer.h_max * omega, 2 * std::numbers::sqrt2, 1e-10) << n;
    EXPECT_NEAR(answer.limiting.value().omega.value() / omega, 1, 1e-10) << n;
  }
}

/// n^3 masses in a box, each joined to its six neighbours: the sum of three chains.
Sparse grid(int n, double k) {
  const Sparse along = chain(n, k);
  std::vector<Eigen::Triplet<double>> entries;
  for (int column = 0; column < n; ++column)
    for (Sparse::InnerIterator entry(along, column); entry; ++entry)
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j)
          for (const auto& [step, base] :
               {std::pair{1, n * (i + n * j)}, {n, i + n * n * j}, {n * n, i + n * j}})
            entries.emplace_back(base + step * static_cast<int>(entry.row()), base + step * column,
                                 entry.value());
  Sparse K(n * n * n, n * n * n);
  K.setFromTriplets(entries.begin(), entries.end());
  return K;
}

TEST(LargestStableStep, OfMoreUnknownsThanDenseMethodsTakeIsFoundByIteration) {
  const int n = 13;
  const Sparse K = grid(n, 100);
  ASSERT_GT(K.rows(), most_dense_modes);
  const Eigen::VectorXd M = Eigen::VectorXd::Constant(K.rows(), 0.01);
  const double omega = 2 * std::sqrt(3 * 100 / 0.01) * std::cos(std::numbers::pi / (2 * (n + 1)));
  const StepAnswer answer = largest_stable_step("rk4", K, M);
  EXPECT_NEAR(answer.h_max * omega, 2 * std::numbers::sqrt2, 1e-8);
  // With C = beta K explicit Euler has |1 + h lambda| = 1 at h = beta for the fast modes.
  EXPECT_NEAR(largest_stable_step("explicit_euler", K, M, Sparse(1e-4 * K)).h_max, 1e-4, 1e-12);
  EXPECT_EQ(largest_stable_step("newmark", K, M).bound, Bound::accuracy);
}

TEST(LargestStableStep, IsTheSameForEveryTypeOfMatrix) {
  const int n = 5;
  const Sparse K = chain(n, 100), C = 1e-4 * K;
  const Eigen::VectorXd M = Eigen::VectorXd::LinSpaced(n, 0.01, 0.02);
  const double h = largest_stable_step("rk4", K, M, C).h_max;
  ASSERT_TRUE(std::isfinite(h));
  const Eigen::SparseMatrix<double, Eigen::RowMajor> K_rows = K;
  const Eigen::MatrixXd K_dense = K, C_dense = C;
  const Eigen::Matrix<double, 5, 5, Eigen::RowMajor> K_fixed = K_dense;
  const Sparse M_sparse = Eigen::MatrixXd(M.asDiagonal()).sparseView();
  for (const double other :
       {largest_stable_step("rk4", K_rows, M, C).h_max, largest_stable_step("rk4", K_dense, M, C).h_max,
        largest_stable_step("rk4", K_fixed, M.transpose(), C_dense).h_max,
        largest_stable_step("rk4", K, M.asDiagonal(), C).h_max,
        largest_stable_step("rk4", K, M_sparse, C).h_max,
        largest_stable_step("rk4", 2 * K_dense, Eigen::MatrixXd((2 * M).asDiagonal()), 2 * C).h_max})
    EXPECT_NEAR(other / h, 1, 1e-12);
}

TEST(LargestStableStep, OfAConsistentMassMatrixHasItsEigenvalues) {
  // A bar of n elements held at both ends: K = k tridiag(-1, 2, -1), M = m / 6 tridiag(1, 4, 1), and
  // kappa_j = 6 k / m (2 - 2 c) / (4 + 2 c), c = cos(j pi / (n + 1)).
  const int n = 6;
  const Sparse K = chain(n, 100);
  Eigen::MatrixXd M = 0.02 / 6 * 4 * Eigen::MatrixXd::Identity(n, n);
  M.diagonal(1).setConstant(0.02 / 6);
  M.diagonal(-1).setConstant(0.02 / 6);
  const double c = std::cos(n * std::numbers::pi / (n + 1));
  const double omega = std::sqrt(6 * 100 / 0.02 * (2 - 2 * c) / (4 + 2 * c));
  EXPECT_NEAR(largest_stable_step("rk4", K, M).h_max * omega, 2 * std::numbers::sqrt2, 1e-12);
  const Sparse M_sparse = M.sparseView();
  EXPECT_NEAR(largest_stable_step("symplectic_euler", K, M_sparse).h_max * omega, 2, 1e-12);
}

TEST(LargestStableStep, OfTheMatricesOfABodyIsThatOfTheBody) {
  for (const double beta : {0.0, 1e-4}) {
    const Problem problem = make_problem("fem_green@phantom", {.parameters = {{"beta", beta}, {"g", 0}}});
    ASSERT_TRUE(problem.body);
    const Linearised near = linearised(problem, AskedState::rest);
    const MechanicalPart& part = near.point.model.mechanical.value();
    const Sparse K = std::get<Sparse>(part.K), C = std::get<Sparse>(part.C);
    for (const char* name : {"rk4", "explicit_euler", "symplectic_euler", "central_difference"}) {
      const Prediction row = predict(find_method(name), near);
      const StepAnswer answer = largest_stable_step(name, K, part.mass.diagonal(), C);
      EXPECT_EQ(answer.bound, row.bound) << name;
      if (row.h_max) {
        EXPECT_NEAR(answer.h_max, *row.h_max, 1e-10 * *row.h_max) << name;
      }
    }
  }
}

/// A pendulum of 1 m: a struct without Jacobian.
struct Pendulum {
  using State = Eigen::Vector2d;
  static constexpr Eigen::Index dim() { return 2; }
  void rhs(double /*t*/, const State& y, State& dydt) const { dydt << y[1], -9.81 * std::sin(y[0]); }
};

TEST(LargestStableStep, OfAStructIsThatOfItsJacobianAtTheState) {
  const StepAnswer hanging = largest_stable_step("rk4", Pendulum{}, Eigen::Vector2d(0, 0));
  EXPECT_NEAR(hanging.h_max, 2 * std::numbers::sqrt2 / std::sqrt(9.81), 1e-8);
  EXPECT_EQ(hanging.state_kind, "motion");
  const StepAnswer tilted = largest_stable_step("rk4", Pendulum{}, Eigen::Vector2d(1, 0));
  EXPECT_NEAR(tilted.h_max, 2 * std::numbers::sqrt2 / std::sqrt(9.81 * std::cos(1)), 1e-8);
  // Near the bottom the equilibrium is the bottom.
  const StepAnswer found =
      largest_stable_step("rk4", Pendulum{}, Eigen::Vector2d(0.3, 0), {.find_equilibrium = true});
  EXPECT_NEAR(found.h_max, hanging.h_max, 1e-8);
  EXPECT_EQ(found.state_kind, "equilibrium");
}

TEST(LargestStableStep, IsConfirmedByRuns) {
  const StepAnswer of_matrices =
      largest_stable_step("rk4", chain(4, 100), Eigen::VectorXd::Constant(4, 0.01), {.verify = true});
  ASSERT_TRUE(of_matrices.observed) << of_matrices.status;
  EXPECT_NEAR(*of_matrices.observed / of_matrices.h_max, 1, 1e-3);
  EXPECT_EQ(of_matrices.status, "");
  const StepAnswer of_struct = largest_stable_step("rk4", Pendulum{}, Eigen::Vector2d(0, 0),
                                                   {.find_equilibrium = true, .verify = true});
  ASSERT_TRUE(of_struct.observed) << of_struct.status;
  EXPECT_NEAR(*of_struct.observed / of_struct.h_max, 1, 1e-3);
}

/// Ralston's rule of order 3, whose polynomial is that of every rule of three stages and order 3.
struct Ralston3 {
  static constexpr std::string_view id = "my_ralston_3";
  static constexpr ButcherTableau<3> tableau{.a = {{{}, {1 / 2.0L}, {0, 3 / 4.0L}}},
                                             .b = {2 / 9.0L, 1 / 3.0L, 4 / 9.0L},
                                             .b_err = {},
                                             .c = {0, 1 / 2.0L, 3 / 4.0L}};
};

TEST(LargestStableStep, IsThatOfAMethodOfOnesOwn) {
  const Eigen::VectorXd M = Eigen::VectorXd::Constant(1, 1);
  EXPECT_NEAR(largest_stable_step(Ralston3{}, one(100), M).h_max, std::sqrt(3) / 10, 1e-12);
  EXPECT_NEAR(largest_stable_step(runtime_tableau<Ralston3>(), one(100), M).h_max, std::sqrt(3) / 10, 1e-12);
  EXPECT_EQ(largest_stable_step(tableaux::Rk4{}, one(100), M).method, "rk4");
}

/// A second row whose entries do not sum to its c.
struct Unsummed {
  static constexpr std::string_view id = "unsummed";
  static constexpr ButcherTableau<2> tableau{
      .a = {{{}, {1 / 2.0L}}}, .b = {1 / 2.0L, 1 / 2.0L}, .b_err = {}, .c = {0, 1.0L}};
};

/// What the call complains of.
template <class Call>
std::string complaint(const Call& call) {
  try {
    call();
  } catch (const std::invalid_argument& error) {
    return error.what();
  } catch (const InputError& error) {
    return error.what();
  }
  return "nothing";
}

TEST(LargestStableStep, RefusesWrongInputInOneSentence) {
  const Eigen::MatrixXd K = Eigen::MatrixXd(chain(3, 1));
  const Eigen::VectorXd M = Eigen::VectorXd::Ones(3);
  Eigen::MatrixXd hole = K, lower = K, uneven = Eigen::MatrixXd::Identity(3, 3);
  hole(1, 2) = std::numeric_limits<double>::quiet_NaN();
  lower.triangularView<Eigen::StrictlyUpper>().setZero();
  uneven(0, 1) = 0.5;
  const Eigen::MatrixXd indefinite = K - 3 * Eigen::MatrixXd::Identity(3, 3);
  const auto of = [](const auto&... matrices) {
    return complaint([&] { largest_stable_step("rk4", matrices...); });
  };
  const std::vector<std::pair<std::string, std::string>> cases{
      {of(Eigen::MatrixXd(K.topRows(2)), M), "K has the shape 2 x 3 but must be square"},
      {of(K, Eigen::VectorXd(M.head(2))), "there are 2 masses, but K has 3 rows"},
      {of(K, Eigen::VectorXd(M - 2 * Eigen::VectorXd::Unit(3, 1))), "degree of freedom 2 is -1"},
      {of(hole, M), "K has nan at row 2, column 3"},
      {of(lower, M), "store both triangles"},
      {of(K, M, Eigen::MatrixXd(K.topLeftCorner(2, 2))), "C has the shape 2 x 2 but must have 3 x 3"},
      {of(K, uneven), "M has entries on one side of its diagonal only"},
      {of(K, indefinite), "M is not positive definite"},
      {of(Eigen::MatrixXd(0, 0), Eigen::VectorXd(0)), "K has no rows"},
      {complaint([&] { largest_stable_step("rk5", K, M); }), "rk4"},
      {complaint([&] { largest_stable_step("rk4", linear_structure(K, M), M); }),
       "the state has 3 numbers, but the system has 6"},
      {complaint([&] { largest_stable_step("rk4", Pendulum{}, Eigen::Vector2d(0, NAN)); }), "finite"},
      {complaint([&] { largest_stable_step("rk4", Pendulum{}, Eigen::Vector2d(0, 0), {.verify = true}); }),
       "find_equilibrium"}};
  for (const auto& [said, part] : cases) EXPECT_NE(said.find(part), std::string::npos) << said;
}

TEST(LargestStableStep, OfAModelThatGrowsNamesTheFastestGrowth) {
  // C = -c K: lambda = (c kappa + sqrt(c^2 kappa^2 - 4 kappa)) / 2 of the largest kappa; all modes, and both
  // ends alone.
  for (const int n : {3, 30, 3000}) {
    const Sparse K = chain(n, 100), C = -0.01 * K;
    const double root = 2 * std::sqrt(100.0) * std::cos(std::numbers::pi / (2 * (n + 1))),
                 kappa = root * root;
    const StepAnswer answer = largest_stable_step("rk4", K, Eigen::VectorXd::Ones(n), C);
    EXPECT_EQ(answer.bound, Bound::model) << n;
    const std::string growth =
        fmt::format("grows as exp({:.4g} t)", 0.005 * kappa);  // kappa < 400: oscillations
    EXPECT_NE(answer.status.find(growth), std::string::npos) << growth << " is not in: " << answer.status;
  }
}

/// A free bar on a soft ground, damped along itself: as a whole it moves without damping, beside creep that
/// is 1e5 times as fast, whose rounding is no growth.
TEST(LargestStableStep, OfAnUndampedModeBesideStiffDampingIsNoGrowth) {
  constexpr int n = 30;
  Eigen::MatrixXd bar = Eigen::MatrixXd::Zero(n, n), M = bar;
  for (int i = 0; i + 1 < n; ++i) {
    bar.block<2, 2>(i, i) += 1e4 * Eigen::Matrix2d{{1, -1}, {-1, 1}};
    M.block<2, 2>(i, i) += Eigen::Matrix2d{{2, 1}, {1, 2}} / 6;
  }
  for (const double ground : {4.0, 40.0, 400.0})
    for (const double beta : {0.01, 0.1, 1.0}) {
      const Eigen::MatrixXd K = bar + ground * M, C = beta * bar;
      const StepAnswer rk4 = largest_stable_step("rk4", K, M, C),
                       newmark = largest_stable_step("newmark", K, M, C);
      EXPECT_GT(rk4.h_max, 0) << ground << ' ' << beta << ' ' << rk4.status;
      EXPECT_EQ(newmark.h_max, infinity) << ground << ' ' << beta << ' ' << newmark.status;
    }
}

TEST(LargestStableStep, RefusesUnsymmetricMatricesOfALargeCoupledMass) {
  Sparse K = chain(1600, 1);
  K.coeffRef(0, 1) = -2;
  EXPECT_THROW((void)largest_stable_step("rk4", K, chain(1600, 1)), InputError);
}

TEST(LargestStableStep, TakesDenseMassesThatCoupleAtAnySize) {
  const Eigen::MatrixXd A = chain(1600, 1);  // M^-1 K = I
  EXPECT_NEAR(largest_stable_step("rk4", A, A).h_max, std::sqrt(8.0), 1e-6);
}

TEST(LargestStableStep, TakesSparseMassesThatCoupleAtAnySize) {
  const StepAnswer answer = largest_stable_step("rk4", chain(2000, 1), chain(2000, 1));  // M^-1 K = I
  EXPECT_NEAR(answer.h_max, std::sqrt(8.0), 1e-6);
}

TEST(LargestStableStep, ThrowsWhatItsPageSays) {
  const Eigen::MatrixXd K = Eigen::MatrixXd(chain(3, 1));
  const Eigen::VectorXd M = Eigen::VectorXd::Ones(3);
  const Eigen::MatrixXd hole = K * std::numeric_limits<double>::infinity();
  EXPECT_THROW(largest_stable_step("rk4", Eigen::MatrixXd(K.topRows(2)), M), std::invalid_argument);
  EXPECT_THROW(largest_stable_step("rk4", hole, M), std::invalid_argument);
  EXPECT_THROW(largest_stable_step("rk4", K, Eigen::VectorXd(-M)), std::invalid_argument);
  EXPECT_THROW(largest_stable_step("rk4", linear_structure(K, M), M), std::invalid_argument);
  EXPECT_THROW(runtime_tableau<Unsummed>(), std::invalid_argument);
  EXPECT_THROW(largest_stable_step("rk5", K, M), InputError);
  EXPECT_THROW(largest_stable_step("rk4", Pendulum{}, Eigen::Vector2d(NAN, 0)), InputError);
  EXPECT_THROW(largest_stable_step("rk4", Eigen::MatrixXd(1e290 * K), M), InputError);
}

/// x' = 1 + x^2, which rests nowhere.
struct Restless {
  using State = Eigen::Matrix<double, 1, 1>;
  static constexpr Eigen::Index dim() { return 1; }
  void rhs(double /*t*/, const State& y, State& dydt) const { dydt[0] = 1 + y[0] * y[0]; }
};

TEST(LargestStableStep, IsNotVerifiedWhereThereIsNoEquilibrium) {
  const StepAnswer answer = largest_stable_step("rk4", Restless{}, Eigen::Matrix<double, 1, 1>(-1.0),
                                                {.find_equilibrium = true, .verify = true});
  EXPECT_EQ(answer.state_kind, "initial");
  EXPECT_FALSE(answer.observed);
  EXPECT_NE(answer.status.find("not verified"), std::string::npos) << answer.status;
  EXPECT_EQ(answer.status.find("does not show"), std::string::npos) << answer.status;
}

}  // namespace
}  // namespace hmax
