/// Implicit steps of a structure by its operators, beside those of the same structure by its matrices.
#include "core/structure_operator.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "integrators/implicit/dirk.hpp"
#include "integrators/implicit/dirk_tableaux.hpp"
#include "integrators/implicit/radau.hpp"
#include "integrators/implicit/rosenbrock.hpp"
#include "integrators/implicit/rosenbrock_tableaux.hpp"
#include "integrators/structural/generalized_alpha.hpp"
#include "problems/any_system.hpp"

namespace hmax {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using Sparse = Eigen::SparseMatrix<double>;

constexpr Eigen::Index bodies = 12;

MatrixXd chain_stiffness() {
  MatrixXd K = MatrixXd::Zero(bodies, bodies);
  K.diagonal().setConstant(200);
  K.diagonal(1).setConstant(-100);
  K.diagonal(-1).setConstant(-100);
  return K;
}

/// q'' = -K q - C q' with masses of one.
struct LinearChain {
  using State = VectorXd;
  using Dofs = VectorXd;
  using DofMatrix = Sparse;
  static constexpr bool autonomous = true;
  MatrixXd K = chain_stiffness(), C = 0.01 * K + 0.3 * MatrixXd::Identity(bodies, bodies);

  [[nodiscard]] static Eigen::Index dofs() { return bodies; }
  [[nodiscard]] static Eigen::Index dim() { return 2 * bodies; }
  [[nodiscard]] static Dofs mass() { return Dofs::Ones(bodies); }
  void rhs(double, const State& y, State& dydt) const {
    dydt << y.tail(bodies), -K * y.head(bodies) - C * y.tail(bodies);
  }
  void force(double, const Dofs& q, const Dofs& v, Dofs& f) const { f = -K * q - C * v; }
  void stiffness(double, const Dofs&, const Dofs&, DofMatrix& into) const { into = K.sparseView(); }
  void damping(double, const Dofs&, const Dofs&, DofMatrix& into) const { into = C.sparseView(); }
};

class ChainOperator final : public StructureOperator {
 public:
  [[nodiscard]] std::unique_ptr<Inverse> inverse(double c, double k) const override {
    return std::make_unique<Factors>(MatrixXd::Identity(bodies, bodies) + c * chain_.C + k * chain_.K);
  }
  void stiffness_times(const double* x, double* out) const override {
    Eigen::Map<VectorXd>(out, bodies) = chain_.K * Eigen::Map<const VectorXd>(x, bodies);
  }
  [[nodiscard]] double largest_stiffness() const override { return 400; }
  [[nodiscard]] double largest_damping() const override { return 4.3; }

 private:
  class Factors final : public Inverse {
   public:
    explicit Factors(const MatrixXd& A) : lu_(A) {}
    int apply(double* x) override {
      Eigen::Map<VectorXd> view(x, bodies);
      view = lu_.solve(VectorXd(view));
      return 1;
    }

   private:
    Eigen::PartialPivLU<MatrixXd> lu_;
  };
  LinearChain chain_;
};

/// The same without matrices: who asks for them gets nothing.
struct ChainByOperators : LinearChain {
  std::shared_ptr<const StructureOperator> structure = std::make_shared<const ChainOperator>();

  [[nodiscard]] std::shared_ptr<const StructureOperator> structure_operator() const { return structure; }
  void stiffness(double, const Dofs&, const Dofs&, DofMatrix& into) const { into.resize(bodies, bodies); }
  void damping(double, const Dofs&, const Dofs&, DofMatrix& into) const { into.resize(bodies, bodies); }
};

/// The state after some steps of 0.05 s, a third of the longest that explicit methods take.
template <class Stepper>
VectorXd end_of(Stepper stepper, const AnySystem& system) {
  VectorXd y(2 * bodies), y_new(2 * bodies);
  for (Eigen::Index i = 0; i < y.size(); ++i) y[i] = std::sin(1.0 + static_cast<double>(i * i));
  constexpr double h = 0.05;
  stepper.init(system, 0.0, y);
  for (int step = 0; step < 20; ++step) {
    EXPECT_EQ(stepper.attempt(system, step * h, y, h, y_new), StepStatus::ok);
    stepper.accept(y_new);
    y = y_new;
  }
  return y;
}

template <class Stepper>
void expect_alike(const Stepper& stepper) {
  const VectorXd by_matrices = end_of(stepper, AnySystem(LinearChain{})),
                 by_operators = end_of(stepper, AnySystem(ChainByOperators{}));
  EXPECT_LE((by_operators - by_matrices).norm(), 1e-11 * by_matrices.norm());
}

TEST(StructureOperator, MakesTheStepsOfTheMatrices) {
  using Equations = equations_type<AnySystem>;
  expect_alike(Dirk<tableaux::Sdirk4, VectorXd, Equations>());
  expect_alike(Rosenbrock<tableaux::Rodas4, VectorXd, Equations>());
  using Alpha = GeneralizedAlpha<VectorXd, VectorXd, structure_type<AnySystem>>;
  expect_alike(Alpha(newmark_parameters(0.25L, 0.5L)));
  expect_alike(Alpha(newmark_parameters(0, 0.5L)));
  expect_alike(Alpha(generalized_alpha_parameters(0.6L)));
}

TEST(StructureOperator, SolvesNoComplexEquations) {
  EXPECT_THROW(end_of(RadauIIA5<VectorXd, equations_type<AnySystem>>(), AnySystem(ChainByOperators{})),
               ComplexEquations);
}

/// A chain of which another process has bodies too, with a number of 8.
struct PartOfAChain : LinearChain {
  [[nodiscard]] static double largest_of_all(double own) { return std::max(own, 8.0); }
};

TEST(NewtonNorm, IsThatOfAllUnknownsWhoeverHoldsThem) {
  constexpr double eps = std::numeric_limits<double>::epsilon();
  const VectorXd y = VectorXd::Ones(2 * bodies), d = VectorXd::Constant(2 * bodies, 16 * eps);
  const AnySystem whole(LinearChain{}), part(PartOfAChain{});
  NewtonNorm<VectorXd> norm;
  norm.init(y.size());
  EXPECT_EQ(norm.largest(whole, y), 1);
  norm.prepare(whole, y);
  EXPECT_NEAR(norm.squared(whole, d, y), 16, 1e-9);  // 16 eps against 4 eps of 1
  EXPECT_EQ(norm.largest(part, y), 8);
  norm.prepare(part, y);
  // 8 elsewhere against 4 eps of 8
  EXPECT_NEAR(norm.squared(part, d, y) * std::pow(4 * eps, 2), 1, 1e-9);
}

}  // namespace
}  // namespace hmax
