#include "analysis/statics/equilibrium.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "catalogue/models/problems.hpp"
#include "problems/oscillator/oscillator.hpp"
#include "problems/test_set/arenstorf.hpp"
#include "problems/test_set/robertson.hpp"
#include "problems/test_set/spring_chain.hpp"
#include "problems/test_set/van_der_pol.hpp"
#include "tests/says.hpp"

namespace hmax {
namespace {

using Eigen::Vector2d;
using Eigen::VectorXd;

void expect_found(const EquilibriumSearch& search, const VectorXd& where, double tolerance = 1e-14) {
  EXPECT_TRUE(search.found()) << search.message;
  ASSERT_EQ(search.state.size(), where.size());
  EXPECT_LE((search.state - where).cwiseAbs().maxCoeff(), tolerance) << search.state;
}

TEST(Equilibrium, OfALinearOscillatorIsReachedInOneStep) {
  const Oscillator liver({.k3 = 0, .P = 0});
  const auto search = find_equilibrium(liver, 0, Vector2d(0.5, 1));
  expect_found(search, Vector2d(0, 0), 0);
  EXPECT_LE(search.iterations, 2);
  EXPECT_EQ(search.residual, 0);
  EXPECT_EQ(name_of(search.outcome), "found");
}

TEST(Equilibrium, OfVanDerPolIsTheOrigin) {
  for (const double mu : {0.5, 5.0, 1000.0}) {
    expect_found(find_equilibrium(VanDerPol<double>({.mu = mu}), 0, Vector2d(2, 0)), Vector2d(0, 0));
    expect_found(find_equilibrium(VanDerPol<double>({.mu = mu}), 0, Vector2d(-1.5, 3)), Vector2d(0, 0));
  }
}

TEST(Equilibrium, OfTheDoubleWellIsTheOneNearTheStart) {
  const Oscillator well({.c = 0.2, .k1 = -0.7, .k3 = 0.8, .P = 0});
  const double depth = std::sqrt(0.7 / 0.8);
  expect_found(find_equilibrium(well, 0, Vector2d(0.8, 0)), Vector2d(depth, 0));
  expect_found(find_equilibrium(well, 0, Vector2d(-1.5, 0.3)), Vector2d(-depth, 0));
  expect_found(find_equilibrium(well, 0, Vector2d(0.1, 0)), Vector2d(0, 0));
  // Between the wells and the saddle the stiffness is zero, and the first step leads far away.
  EXPECT_TRUE(find_equilibrium(well, 0, Vector2d(std::sqrt(0.7 / 2.4) + 1e-9, 0)).found());
  EXPECT_TRUE(find_equilibrium(well, 0, Vector2d(std::sqrt(0.7 / 2.4), 0)).found());
}

TEST(Equilibrium, OfADrivenOscillatorFollowsTheForceOfTheInstant) {
  const OscillatorParameters p;
  const Oscillator liver(p);
  for (const double t : {0.0, 1.0, 3.14, 10.0}) {
    const auto search = find_equilibrium(liver, t, Vector2d(0.5, 1));
    ASSERT_TRUE(search.found()) << search.message;
    const double x = search.state[0];
    EXPECT_NEAR(p.k1 * x + p.k3 * x * x * x, p.P * std::cos(p.w * t), 1e-15);
    EXPECT_EQ(search.state[1], 0);
    EXPECT_LT(search.residual, 1e-15);
  }
}

TEST(Equilibrium, ALoadWithoutASpringHasNone) {
  for (const double c : {0.0, 2.0}) {
    const auto search = find_equilibrium(Oscillator({.c = c, .k1 = 0, .k3 = 0, .w = 0}), 0, Vector2d(0.5, 1));
    EXPECT_EQ(search.outcome, EquilibriumOutcome::no_equilibrium);
    EXPECT_TRUE(says(search.message, "without a spring"));
    EXPECT_GT(search.residual, 0.1);
  }
}

TEST(Equilibrium, WithoutLoadAndSpringTheOneWhereTheDamperStopsTheBodyIsFound) {
  // m v + c x never changes.
  const OscillatorParameters p{.c = 2, .k1 = 0, .k3 = 0, .P = 0};
  const auto search = find_equilibrium(Oscillator(p), 0, Vector2d(0.5, 1));
  expect_found(search, Vector2d(0.5 + p.m / p.c, 0), 1e-12);
  EXPECT_EQ(search.conserved, 1);
}

TEST(Equilibrium, AThreefoldRootIsFoundAllTheSame) {
  const auto search = find_equilibrium(Oscillator({.c = 1, .k1 = 0, .k3 = 0.8, .P = 0}), 0, Vector2d(0.5, 1));
  expect_found(search, Vector2d(0, 0), 1e-9);
}

/// One component with the rate f and its slope.
struct Scalar {
  using State = Eigen::Matrix<double, 1, 1>;
  double (*f)(double);
  Eigen::Index dim() const { return 1; }
  void rhs(double, const State& y, State& dydt) const { dydt[0] = f(y[0]); }
};
using One = Scalar::State;

TEST(Equilibrium, RatesThatOnlyFadeHaveNone) {
  const auto fading = find_equilibrium(Scalar{[](double x) { return std::exp(-x); }}, 0, One(1));
  EXPECT_EQ(fading.outcome, EquilibriumOutcome::no_equilibrium) << fading.message;
  const auto bowl = find_equilibrium(Scalar{[](double x) { return x * x + 1; }}, 0, One(3));
  EXPECT_EQ(bowl.outcome, EquilibriumOutcome::no_equilibrium) << bowl.message;
  EXPECT_NEAR(bowl.residual, 1, 0.2);
}

TEST(Equilibrium, AStepThatIsTooLongIsCut) {
  // Newton's method on the inverse tangent diverges from |x| > 1.39 on.
  expect_found(find_equilibrium(Scalar{[](double x) { return -std::atan(x); }}, 0, One(20)), One(0));
  // Full steps from here would leave the half line where the rate exists.
  expect_found(find_equilibrium(Scalar{[](double x) { return -std::log(x); }}, 0, One(9)), One(1));
}

TEST(Equilibrium, RatesThatAreNotFiniteAreToldAsSuch) {
  const Scalar root{[](double x) { return std::sqrt(x); }};
  const auto search = find_equilibrium(root, 0, One(-1));
  EXPECT_EQ(search.outcome, EquilibriumOutcome::not_finite);
  EXPECT_FALSE(search.message.empty());
  EXPECT_EQ(find_equilibrium(root, 0, One(NAN)).outcome, EquilibriumOutcome::not_finite);
}

TEST(Equilibrium, OfALongSparseChainIsAtRest) {
  const SpringChain<double> chain({.n = 1500, .k3 = 40});
  const auto search = find_equilibrium(chain, 0, chain.y0());
  expect_found(search, VectorXd::Zero(3000), 1e-13);
  expect_found(find_equilibrium(AnySystem(chain), 0, chain.y0()), search.state, 0);
}

TEST(Equilibrium, OfARotatingFrameIsATriangularPoint) {
  const double mu = 0.012277471;
  const Arenstorf<double> orbit({.mu = mu});
  expect_found(find_equilibrium(orbit, 0, Eigen::Vector4d(0.45, 0.8, 0.1, -0.1)),
               Eigen::Vector4d(0.5 - mu, std::sqrt(3.0) / 2, 0, 0));
}

/// Robertson's reaction as users write it, without a Jacobian.
struct BareRobertson {
  using State = Eigen::Vector3d;
  static Eigen::Index dim() { return 3; }
  void rhs(double t, const State& y, State& dydt) const { Robertson<double>().rhs(t, y, dydt); }
};

TEST(Equilibrium, OfRobertsonsReactionIsTheOneOfItsLineThatConservationLeadsTo) {
  // y1 + y2 + y3 never changes; at the end everything has become the third substance.
  const Robertson<double> reaction;
  const auto search = find_equilibrium(reaction, 0, reaction.y0());
  expect_found(search, Eigen::Vector3d(0, 0, 1), 1e-6);
  EXPECT_LT(search.residual, 1e-12);
  EXPECT_EQ(search.conserved, 1);
  expect_found(find_equilibrium(reaction, 0, Eigen::Vector3d(0.5, 0.25, 1.25)), Eigen::Vector3d(0, 0, 2),
               1e-6);
  expect_found(find_equilibrium(BareRobertson{}, 0, Eigen::Vector3d(1, 0, 0)), Eigen::Vector3d(0, 0, 1),
               1e-6);
}

/// A -> B -> C -> A at unequal rates beside an uncoupled decay, in units far apart.
struct Ring {
  using State = Eigen::Vector4d;
  static Eigen::Index dim() { return 4; }
  void rhs(double, const State& y, State& dydt) const {
    dydt << 2e3 * y[2] - 1e6 * y[0], 1e6 * y[0] - 0.5 * y[1], 0.5 * y[1] - 2e3 * y[2], 1e-6 - 1e-3 * y[3];
  }
};

TEST(Equilibrium, OfARingOfReactionsSharesOutWhatWasThere) {
  const auto search = find_equilibrium(Ring{}, 0, Eigen::Vector4d(1, 2, 3, 0.5));
  // The rates 1e6 A = 0.5 B = 2e3 C are one.
  const double rate = 6 / (1e-6 + 2 + 5e-4);
  expect_found(search, Eigen::Vector4d(1e-6 * rate, 2 * rate, 5e-4 * rate, 1e-3), 1e-9);
  EXPECT_EQ(search.conserved, 1);
}

/// x becomes y at the rate 1 + x.
struct Source {
  using State = Vector2d;
  static Eigen::Index dim() { return 2; }
  void rhs(double, const State& y, State& dydt) const { dydt << 1 + y[0], -1 - y[0]; }
};

TEST(Equilibrium, MayBeOutOfReachOfWhatIsConserved) {
  // x + y stays 1.5; x = -1 leaves y = 2.5.
  expect_found(find_equilibrium(Source{}, 0, Vector2d(0.5, 1)), Vector2d(-1, 2.5));
  // Two bodies on one spring keep their momentum: they rest only without any.
  struct Pair {
    using State = Eigen::Vector4d;
    static Eigen::Index dim() { return 4; }
    void rhs(double, const State& y, State& dydt) const {
      dydt << y[2], y[3], y[1] - y[0] - 1, y[0] - y[1] + 1;
    }
  };
  EXPECT_TRUE(find_equilibrium(Pair{}, 0, Eigen::Vector4d(0, 2, -0.5, 0.5)).found());
  const auto moving = find_equilibrium(Pair{}, 0, Eigen::Vector4d(0, 2, 0.5, 0.5));
  EXPECT_EQ(moving.outcome, EquilibriumOutcome::no_equilibrium);
  EXPECT_TRUE(says(moving.message, "conserves"));
}

/// Two masses of 0.1 kg below each other on springs of 0.2 m and 1000 N/m, y = (x1, y1, x2, y2, and their
/// velocities).
struct Hanging {
  using State = VectorXd;
  [[nodiscard]] Eigen::Index dim() const { return 8; }
  static Vector2d pull(const Vector2d& d) { return -1000 * (d.norm() - 0.2) / d.norm() * d; }
  void rhs(double, const State& y, State& dydt) const {
    const Vector2d upper = pull(y.head<2>()), lower = pull(y.segment<2>(2) - y.head<2>()), weight(0, -0.981);
    dydt.head<4>() = y.tail<4>();
    dydt.segment<2>(4) = (upper - lower + weight) / 0.1 - 0.2 * y.segment<2>(4);
    dydt.tail<2>() = (lower + weight) / 0.1 - 0.2 * y.tail<2>();
  }
};

TEST(Equilibrium, WhatHangsAtRestHasNoSidewaysTermsToCompareWith) {
  VectorXd rest = VectorXd::Zero(8);
  rest[1] = -0.2 - 2 * 0.981 / 1000;
  rest[3] = rest[1] - 0.2 - 0.981 / 1000;
  const EquilibriumSearch search = find_equilibrium(Hanging{}, 0, rest);
  expect_found(search, rest);
  EXPECT_LE(search.iterations, 2);
}

TEST(Equilibrium, OfChemistryIsReportedWithItsResidual) {
  for (const char* id : {"oregonator", "hires", "lorenz", "brusselator"}) {
    const Problem problem = make_problem(id);
    const auto& system = std::get<AnySystem>(problem.system);
    const auto search = find_equilibrium(system, 0, problem.y0);
    EXPECT_TRUE(search.found()) << id << ": " << search.message;
    VectorXd f(problem.y0.size());
    system.rhs(0, search.state, f);
    EXPECT_EQ(f.cwiseAbs().maxCoeff(), search.residual) << id;
    EXPECT_LT(search.residual, 1e-9) << id;
  }
}

}  // namespace
}  // namespace hmax
