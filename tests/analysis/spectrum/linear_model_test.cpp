#include "analysis/spectrum/linear_model.hpp"

#include <cmath>
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "catalogue/models/problems.hpp"
#include "core/errors.hpp"
#include "problems/oscillator/oscillator.hpp"
#include "problems/test_set/arenstorf.hpp"
#include "problems/test_set/brusselator.hpp"
#include "problems/test_set/spring_chain.hpp"
#include "tests/says.hpp"

namespace hmax {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::VectorXd;

/// The linear model of a problem of the catalogue, whatever type binds it.
LinearModel linear_model_of(const Problem& problem, double t, const VectorXd& y, JacobianFrom from) {
  return std::visit(
      [&]<class S>(const S& system) { return linearise(system, t, typename S::State(y), from); },
      problem.system);
}

/// Every component away from zero and from the others, where a slope cannot hide.
VectorXd lively(const VectorXd& y0) {
  VectorXd y = y0;
  const double size = std::max(1e-3, y0.cwiseAbs().maxCoeff());
  for (Eigen::Index i = 0; i < y.size(); ++i)
    y[i] += 0.05 * size * (1 + std::sin(1.7 * static_cast<double>(i)));
  return y;
}

TEST(LinearModel, AnalyticJacobianAgreesWithDifferencesForEveryProblem) {
  for (const std::string& id : problem_ids()) {
    const Problem problem = make_problem(id);
    for (const VectorXd& y : {problem.y0, lively(problem.y0)}) {
      const auto analytic = linear_model_of(problem, 0.3, y, JacobianFrom::analytic_if_any);
      const auto differences = linear_model_of(problem, 0.3, y, JacobianFrom::differences);
      EXPECT_EQ(analytic.origin, JacobianOrigin::analytic) << id;
      EXPECT_NE(differences.origin, JacobianOrigin::analytic) << id;
      const MatrixXd J = dense(analytic.J());
      // The moon is 0.006 away from the start of arenstorf: (d / r)^2 is 1e-6.
      const double relative = id == "arenstorf" ? 4e-6 : 2e-7;
      EXPECT_LT((dense(differences.J()) - J).cwiseAbs().maxCoeff(), relative * J.cwiseAbs().maxCoeff()) << id;
    }
  }
}

TEST(LinearModel, SparseDifferencesTakeGroupsOfColumns) {
  const SpringChain<double> chain({.n = 30, .k3 = 50});
  const auto model = linearise(chain, 0, chain.y0(), JacobianFrom::differences);
  EXPECT_EQ(model.origin, JacobianOrigin::grouped_differences);
  EXPECT_EQ(name_of(model.origin), "central differences by groups of columns");
  EXPECT_TRUE(is_sparse(model.J()));
  EXPECT_TRUE(is_sparse(model.mechanical->K));
  const auto erased = linearise(AnySystem(chain), 0, chain.y0(), JacobianFrom::differences);
  EXPECT_EQ(erased.origin, JacobianOrigin::grouped_differences);
  EXPECT_EQ(dense(erased.J()), dense(model.J()));
}

TEST(LinearModel, ADenseSystemIsDifferencedColumnByColumn) {
  const Oscillator liver;
  const auto model = linearise(liver, 0, Vector2d(0.5, 1), JacobianFrom::differences);
  EXPECT_EQ(model.origin, JacobianOrigin::differences);
  EXPECT_FALSE(is_sparse(model.J()));
}

TEST(LinearModel, DifferencesKeepTheirDigitsAtRestUnderAForce) {
  // At an equilibrium the force is balanced, or large beside zero: what is added to a state of zeros decides.
  const Oscillator liver({.P = 10});
  for (const Vector2d& y : {Vector2d(0, 0), Vector2d(2.2, 0), Vector2d(0, 1e-9)}) {
    const MatrixXd J = dense(linearise(liver, 0, y).J());
    EXPECT_LT((dense(linearise(liver, 0, y, JacobianFrom::differences).J()) - J).norm(), 1e-5 * J.norm())
        << y;
  }
}

TEST(LinearModel, TheOscillatorIsTheSameThroughItsOwnTypeAndErased) {
  const Oscillator liver;
  const Vector2d y(0.5, 1);
  const auto own = linearise(liver, 0.3, y), erased = linearise(AnySystem(liver), 0.3, VectorXd(y));
  EXPECT_EQ(dense(own.J()), dense(erased.J()));
  ASSERT_TRUE(own.mechanical && erased.mechanical);
  EXPECT_EQ(own.mechanical->mass.lumped(), erased.mechanical->mass.lumped());
  EXPECT_EQ(dense(own.mechanical->K), dense(erased.mechanical->K));
  EXPECT_EQ(dense(own.mechanical->C), dense(erased.mechanical->C));
  EXPECT_NEAR(dense(own.mechanical->K)(0, 0), 0.7 + 3 * 0.8 * 0.25, 1e-15);
  ASSERT_TRUE(own.J_stiff && erased.J_stiff);
  EXPECT_EQ(dense(own.J_stiff()), dense(erased.J_stiff()));
  EXPECT_NEAR(dense(own.J_stiff())(1, 0), -0.7 / 1.45, 1e-15);
}

TEST(LinearModel, WhatIsNeitherMechanicalNorSplitHasNeitherPart) {
  const Problem lorenz = make_problem("lorenz");
  const auto model = linear_model_of(lorenz, 0, lorenz.y0, JacobianFrom::analytic_if_any);
  EXPECT_FALSE(model.mechanical);
  EXPECT_FALSE(model.J_stiff);
}

TEST(LinearModel, StiffnessAndDampingAreTheBlocksOfTheJacobian) {
  for (const char* id : {"spring_chain", "kepler", "pleiades", "arenstorf", "liver_forced"}) {
    const Problem problem = make_problem(id);
    const VectorXd y = lively(problem.y0);
    for (const auto from : {JacobianFrom::analytic_if_any, JacobianFrom::differences}) {
      const auto model = linear_model_of(problem, 0, y, from);
      ASSERT_TRUE(model.mechanical) << id;
      const auto& part = *model.mechanical;
      const Eigen::Index n = part.mass.size();
      const MatrixXd J = dense(model.J()), inverse = part.mass.diagonal().cwiseInverse().asDiagonal();
      EXPECT_LT((J.topRightCorner(n, n) - MatrixXd::Identity(n, n)).norm(), 1e-7) << id;
      EXPECT_LT((J.bottomLeftCorner(n, n) + inverse * dense(part.K)).norm(), 1e-13 * J.norm()) << id;
      EXPECT_LT((J.bottomRightCorner(n, n) + inverse * dense(part.C)).norm(), 1e-13 * J.norm()) << id;
    }
  }
}

TEST(LinearModel, TheKindOfDampingIsSeen) {
  const auto kind = [](const SpringChainParameters& p, JacobianFrom from) {
    const SpringChain<double> chain(p);
    return linearise(chain, 0, chain.y0(), from).mechanical->damping;
  };
  for (const auto from : {JacobianFrom::analytic_if_any, JacobianFrom::differences}) {
    EXPECT_EQ(kind({.c = 0}, from), Damping::none);
    EXPECT_EQ(kind({.c = 0.05}, from), Damping::proportional);
    // A cubic spring under load is stiffer, its damper is not.
    const SpringChain<double> cubic({.k3 = 1e5});
    SpringChain<double>::State y = cubic.y0();
    y[0] = 0.1;
    EXPECT_EQ(linearise(cubic, 0, y, from).mechanical->damping, Damping::general);
  }
}

TEST(LinearModel, DampingWithinTheKernelOfTheStiffnessIsProportional) {
  // Two equal free masses on one spring, damped by a drag on both: the product K C is all cancellation.
  const MatrixXd K = (MatrixXd(2, 2) << 1e6, -1e6, -1e6, 1e6).finished();
  const MatrixXd C = (MatrixXd(2, 2) << 0.1, 0.1, 0.1, 0.1).finished();
  const auto part = mechanical_part(Vector2d(0.3, 0.3), K, C);
  EXPECT_EQ(part.damping, Damping::proportional);
  EXPECT_TRUE(part.decouples());
  EXPECT_FALSE(mechanical_part(Vector2d(0.3, 0.31), K, C).decouples());
}

TEST(LinearModel, GyroscopicForcesAreNoDampingOfSingleModes) {
  const Arenstorf<double> orbit;
  const auto part = linearise(orbit, 0, orbit.y0()).mechanical.value();
  EXPECT_FALSE(part.symmetric);
  EXPECT_EQ(part.damping, Damping::general);
  EXPECT_FALSE(part.decouples());
}

/// x' = sqrt(x), whose slope at zero is infinite, and two more verbs that can go wrong.
struct SquareRoot {
  using State = Vector2d;
  using Jacobian = Eigen::Matrix2d;
  Eigen::Index dim() const { return 2; }
  void rhs(double, const State& y, State& f) const { f << -y[0], std::sqrt(y[1]); }
  void jacobian(double, const State& y, Jacobian& J) const { J << -1, 0, 0, 0.5 / std::sqrt(y[1]); }
};

TEST(LinearModel, AnEntryThatIsNotFiniteIsNamed) {
  const std::string text = error_of<InputError>([] { linearise(SquareRoot{}, 0.25, Vector2d(1, 0)); });
  for (const char* part : {"inf", "row 2, column 2", "t = 0.25", "choose a state"})
    EXPECT_TRUE(says(text, part));
  EXPECT_TRUE(says(error_of<InputError>([] { linearise(SquareRoot{}, 0, Vector2d(1, -1)); }), "nan"));
  EXPECT_TRUE(
      says(error_of<InputError>([] { linearise(SquareRoot{}, 0, Vector2d(1, NAN)); }), "component 2"));
  EXPECT_TRUE(
      says(error_of<InputError>([] { linearise(SquareRoot{}, NAN, Vector2d(1, 1)); }), "finite time"));
}

TEST(LinearModel, AMassThatIsNotPositiveIsNamed) {
  const MatrixXd K = MatrixXd::Identity(3, 3);
  for (const double bad : {0.0, -1.0, std::numeric_limits<double>::infinity(), std::nan("")}) {
    const std::string text = error_of<InputError>([&] { mechanical_part(Eigen::Vector3d(1, bad, 1), K, K); });
    EXPECT_TRUE(says(text, "degree of freedom 2"));
    EXPECT_TRUE(says(text, "positive"));
  }
  MatrixXd broken = K;
  broken(2, 0) = NAN;
  for (const bool stiffness : {true, false}) {
    const std::string text = error_of<InputError>(
        [&] { mechanical_part(Eigen::Vector3d::Ones(), stiffness ? broken : K, stiffness ? K : broken); });
    EXPECT_TRUE(says(text, stiffness ? "stiffness" : "damping"));
    EXPECT_TRUE(says(text, "row 3, column 1"));
  }
}

/// y' = b + A y + c y^3 componentwise, without a Jacobian.
struct AffineWithCubes {
  using State = Eigen::VectorXd;
  Eigen::VectorXd b;
  Eigen::MatrixXd A;
  double c = 0;
  [[nodiscard]] Eigen::Index dim() const { return b.size(); }
  void rhs(double, const State& y, State& dydt) const {
    dydt = b + A * y + c * y.cwiseProduct(y).cwiseProduct(y);
  }
};

TEST(LinearModel, DifferencesBesideLargeConstantsAndZerosAreThoseOfWhatActs) {
  // Carriers in silicon, rates of a pump, an input of 1e10: at zero an increment of 1e-10 changes nothing of
  // f.
  Eigen::MatrixXd pump(3, 3);
  pump << -50, 0, 1e-3, 20, -3e3, 0, 0, 5, -4e4;
  for (const double size : {1e-12, 1.0, 1e10, 1e26})
    for (const double start : {0.0, 1.0}) {
      SCOPED_TRACE(size);
      const AffineWithCubes system{size * Eigen::Vector3d(1, 0.3, -2), pump};
      const LinearModel model =
          linearise(system, 0, Eigen::VectorXd(start * size * Eigen::Vector3d(1, 0, 2)));
      const Eigen::MatrixXd J = dense(model.J());
      for (Eigen::Index i = 0; i < 3; ++i)
        for (Eigen::Index j = 0; j < 3; ++j)
          EXPECT_NEAR(J(i, j), pump(i, j),
                      1e-6 * std::min(pump.row(i).cwiseAbs().maxCoeff(), pump.col(j).cwiseAbs().maxCoeff()))
              << i << j << " from " << start;
    }
}

TEST(LinearModel, DifferencesOfSmallNumbersStayBelowTheirCurvature) {
  // y of 1e-12: f = -y - 1e24 y^3 bends within 1e-12, and a guess of 1e-4 for the size of zero is far beyond.
  const AffineWithCubes system{Eigen::VectorXd::Zero(1), -Eigen::MatrixXd::Identity(1, 1), -1e24};
  EXPECT_NEAR(dense(linearise(system, 0, Eigen::VectorXd(Eigen::VectorXd::Zero(1))).J())(0, 0), -1, 1e-6);
  const Eigen::VectorXd y = Eigen::VectorXd::Constant(1, 1e-12);
  EXPECT_NEAR(dense(linearise(system, 0, y).J())(0, 0), -4, 1e-5);
}

/// The same with a declared pattern, so that columns are taken in groups.
struct PatternedCubes : AffineWithCubes {
  void sparsity(Eigen::SparseMatrix<double>& pattern) const {
    pattern.resize(b.size(), b.size());
    pattern.setIdentity();
  }
};

TEST(LinearModel, GroupedDifferencesOfSmallNumbersStayBelowTheirCurvature) {
  const PatternedCubes system{{Eigen::VectorXd::Zero(2), -Eigen::MatrixXd::Identity(2, 2), -1e24}};
  const Eigen::MatrixXd J = dense(linearise(system, 0, Eigen::VectorXd(Eigen::Vector2d(1e-12, 0))).J());
  EXPECT_NEAR(J(0, 0), -4, 1e-5);
  EXPECT_NEAR(J(1, 1), -1, 1e-5);
}

TEST(LinearModel, ARowThatDependsOnNothingIsNotSearchedFarFromTheState) {
  struct Bounded {
    using State = Eigen::VectorXd;
    [[nodiscard]] static Eigen::Index dim() { return 2; }
    static void rhs(double, const State& u, State& dudt) {
      if (std::abs(u[1]) > 1) throw std::domain_error("outside");
      dudt[0] = 3;
      dudt[1] = std::sqrt(1 - u[1] * u[1]);
    }
  };
  for (const double at : {0.0, 1e-6, 0.5, 0.9}) {
    Eigen::MatrixXd J;
    ASSERT_NO_THROW(J = dense(linearise(Bounded{}, 0, Eigen::VectorXd(Eigen::Vector2d(0, at))).J())) << at;
    EXPECT_EQ(J.row(0).cwiseAbs().maxCoeff(), 0);
    EXPECT_NEAR(J(1, 1), -at / std::sqrt(1 - at * at), 1e-8);
  }
}

}  // namespace
}  // namespace hmax
