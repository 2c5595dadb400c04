/// An absolute tolerance for each component, and the tolerances that are taken where none are given.
#include "integrators/tolerances.hpp"

#include <cmath>
#include <limits>
#include <stdexcept>

#include "integrators/explicit/adaptive.hpp"
#include "integrators/implicit/rosenbrock.hpp"
#include "integrators/implicit/rosenbrock_tableaux.hpp"
#include "integrators/multistep/adams_pece.hpp"
#include "tests/integrators/implicit_methods.hpp"
#include "tests/says.hpp"

namespace hmax {
namespace {

using Plane = Eigen::Vector2d;
using Vector = Eigen::VectorXd;
using Method = tableaux::DormandPrince54;
using Explicit = Rk<Method, Plane>;
using ComponentAdams = ShampineGordonControl<double, Vector>;

/// x'' = cos 3t - sin x - x' / 10 with x in a unit `unit` times smaller: y = (unit x, x').
struct InUnits {
  using State = Plane;
  double unit = 1;
  static Eigen::Index dim() { return 2; }
  void rhs(double t, const Plane& y, Plane& dydt) const {
    dydt << unit * y[1], std::cos(3 * t) - std::sin(y[0] / unit) - y[1] / 10;
  }
  [[nodiscard]] Plane start() const { return {0.7 * unit, -0.4}; }
};

struct Steered {
  RunEnd<double> end;
  Plane y;
};
template <class StepperT, class Control>
Steered run(const StepperT& stepper, const Control& control, double unit = 1) {
  const InUnits system{unit};
  Steered run{{}, system.start()};
  run.end = integrate(stepper, system, Span<double>{0, 10}, run.y, control);
  EXPECT_EQ(run.end.outcome, Outcome::reached_end);
  return run;
}

void expect_same(const Steered& one, const Steered& other) {
  EXPECT_EQ(one.y, other.y);
  EXPECT_EQ(one.end.stats, other.end.stats);
}

const Vector equal = Vector::Constant(2, 1e-7);

TEST(ComponentTolerances, OfOneSizeAreTheScalar) {
  expect_same(run(Explicit{}, adaptive<Method>({1e-5, 1e-7})),
              run(Explicit{}, adaptive<Method>({1e-5, equal})));
  expect_same(run(AdamsPece<Plane>{}, ShampineGordonControl<double>({1e-5, 1e-7})),
              run(AdamsPece<Plane>{}, ComponentAdams({1e-5, equal})));
}

template <class MethodT>
struct ImplicitTolerances : testing::Test {};
TYPED_TEST_SUITE(ImplicitTolerances, EveryAdaptiveImplicitMethod, MethodId);
TYPED_TEST(ImplicitTolerances, OfEachComponentAreTheScalarWhereTheyAreEqual) {
  using StepperT = typename TypeParam::template Stepper<Plane>;
  expect_same(run(StepperT{}, Adaptive<double, PiController>({1e-4, 1e-7}, TypeParam::error_order)),
              run(StepperT{},
                  Adaptive<double, PiController, ComponentRmsNorm>({1e-4, equal}, TypeParam::error_order)));
}

TEST(ComponentTolerances, AreInTheUnitsOfTheirComponent) {
  // A power of two as unit changes no digit of a number: neither may it change a step.
  const double unit = std::ldexp(1.0, 20);
  const auto expect_same_in_units = [&](const Steered& in_m, const Steered& in_other) {
    EXPECT_EQ(in_m.y, Plane(in_other.y[0] / unit, in_other.y[1]));
    EXPECT_EQ(in_m.end.stats, in_other.end.stats);
  };
  const Plane scaled(1e-7 * unit, 1e-7);
  expect_same_in_units(run(Explicit{}, adaptive<Method>({1e-5, 1e-7})),
                       run(Explicit{}, adaptive<Method>({1e-5, scaled}), unit));
  const Steered scalar = run(Explicit{}, adaptive<Method>({1e-5, 1e-7}), unit);
  EXPECT_NE(scalar.end.stats.steps, run(Explicit{}, adaptive<Method>({1e-5, 1e-7})).end.stats.steps);
}

TEST(ComponentTolerances, ALooseComponentSavesSteps) {
  const auto saves = [](auto stepper, auto control, auto loose) {
    EXPECT_LT(run(stepper, loose).end.stats.steps,
              0.8 * static_cast<double>(run(stepper, control).end.stats.steps));
  };
  const Plane loose(1e-2, 1e-2), first(1e-8, 1e-2);
  saves(Explicit{}, adaptive<Method>({1e-9, first}), adaptive<Method>({1e-9, loose}));
  using Control = Adaptive<double, PiController, ComponentRmsNorm>;
  saves(RadauIIA5<Plane>{}, Control({1e-9, first}, 4), Control({1e-9, loose}, 4));
  saves(Rosenbrock<tableaux::Rodas4, Plane>{}, Control({1e-9, first}, 4), Control({1e-9, loose}, 4));
  saves(AdamsPece<Plane>{}, ComponentAdams({1e-9, first}), ComponentAdams({1e-9, loose}));
}

TEST(ComponentTolerances, WeighTheCorrectionsOfNewtonsMethod) {
  NewtonNorm<Plane> norm(1.0);
  norm.init(2);
  norm.set_tolerances(0.0, Vector(Plane(1e-3, 1e-6)));
  norm.prepare(InUnits{}, Plane(1, 1));
  EXPECT_NEAR(norm.squared(InUnits{}, Plane(1e-3, 0), Plane(1, 1)), 0.5, 1e-12);
  EXPECT_NEAR(norm.squared(InUnits{}, Plane(0, 1e-6), Plane(1, 1)), 0.5, 1e-12);
  EXPECT_TRUE(norm.resolves(Plane(1, 1e-5)));
  EXPECT_FALSE(norm.resolves(Plane(1e-4, 1)));
}

TEST(ComponentTolerances, RefusesWhatIsNotOnePositiveNumberForEach) {
  constexpr double inf = std::numeric_limits<double>::infinity(),
                   nan = std::numeric_limits<double>::quiet_NaN();
  const auto refused = [](const Vector& atol) {
    Plane y(1, 2);
    EXPECT_THROW(integrate(Explicit{}, InUnits{}, Span<double>{0, 1}, y, adaptive<Method>({1e-6, atol})),
                 std::invalid_argument);
    EXPECT_THROW(
        integrate(AdamsPece<Plane>{}, InUnits{}, Span<double>{0, 1}, y, ComponentAdams({1e-6, atol})),
        std::invalid_argument);
    EXPECT_EQ(y, Plane(1, 2));
  };
  for (const double wrong : {0.0, -1e-6, inf, nan}) refused(Plane(1e-6, wrong));
  refused(Eigen::Vector3d::Constant(1e-6));
  refused(Vector::Constant(1, 1e-6));
  refused(Vector());
  EXPECT_EQ(error_of<std::invalid_argument>([&] { check_atol(Vector(Eigen::Vector3d::Ones()), 2); }),
            "the absolute tolerance has 3 components, but the state has 2; give one for each");
}

TEST(DefaultTolerances, AreThoseOfTheDocumentation) {
  EXPECT_EQ(Tolerances<double>{}.rtol, 1e-6);
  EXPECT_EQ(Tolerances<double>{}.atol, 1e-9);
  expect_same(run(Explicit{}, adaptive<Method>()), run(Explicit{}, adaptive<Method>({1e-6, 1e-9})));
}

TEST(DefaultTolerances, AreInProportionToTheStart) {
  EXPECT_EQ(default_tolerances(Plane(0, -200)).rtol, 1e-6);
  EXPECT_EQ(default_tolerances(Plane(0, -200)).atol, 1e-9 * 200);
  EXPECT_EQ(default_tolerances(Eigen::Vector2cd(std::complex(3.0, 4.0), 0.0)).atol, 1e-9 * 5);
  EXPECT_EQ(default_tolerances(Plane(0, 0)).atol, 1e-9) << "a start at zero has no size";
  expect_same(run(Explicit{}, adaptive<Method>(default_tolerances(InUnits{}.start()))),
              run(Explicit{}, adaptive<Method>({1e-6, 1e-9 * 0.7})));
}

TEST(DefaultTolerances, OfBlocksKeepTheirUnitsApart) {
  const Eigen::Vector4d y0(0.01, 0, 0, -3);
  const auto tolerances = default_tolerances(y0, {2, 2});
  EXPECT_EQ(tolerances.rtol, 1e-6);
  EXPECT_EQ(tolerances.atol, Eigen::Vector4d(1e-9 * 0.01, 1e-9 * 0.01, 1e-9 * 3, 1e-9 * 3));
  EXPECT_EQ(default_tolerances(Eigen::Vector4d(0.01, 0, 0, 0), {2, 2}).atol, Vector::Constant(4, 1e-9 * 0.01))
      << "velocities that start at zero have no size of their own";
  EXPECT_EQ(default_tolerances(Eigen::Vector4d(0, 0, 0, 0), {2, 2}).atol, Vector::Constant(4, 1e-9));
  EXPECT_THROW(default_tolerances(y0, {2, 3}), std::invalid_argument);
  EXPECT_THROW(default_tolerances(y0, {5, -1}), std::invalid_argument);
}

}  // namespace
}  // namespace hmax
