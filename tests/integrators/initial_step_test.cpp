#include "integrators/initial_step.hpp"

#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "integrators/explicit/adaptive.hpp"
#include "integrators/explicit/explicit_rk.hpp"
#include "integrators/explicit/stabilized_rk.hpp"
#include "integrators/explicit/tableaux.hpp"
#include "integrators/implicit/dirk.hpp"
#include "integrators/implicit/dirk_tableaux.hpp"
#include "integrators/implicit/radau.hpp"
#include "integrators/implicit/rosenbrock.hpp"
#include "integrators/implicit/rosenbrock_tableaux.hpp"
#include "integrators/integrate.hpp"
#include "integrators/multistep/adams_pece.hpp"
#include "tests/integrators/forced.hpp"

namespace hmax {
namespace {

using forced::Forced;
using forced::Switched;
using Vector = Eigen::VectorXd;
using Matrix = Eigen::MatrixXd;

constexpr Tolerances<double> tolerances{.rtol = 1e-5, .atol = 1e-7};

/// Runs by every method of the house that chooses its steps: run(name, stepper, control).
template <class Run>
void with_each(const Run& run) {
  const auto steered = [&](const char* name, auto stepper) {
    run(name, stepper, Adaptive<double, DeadbandController>(tolerances, stepper.error_order));
    run(name, stepper, Adaptive<double, MatlabController, MatlabNorm>(tolerances, stepper.error_order));
  };
  steered("bogacki_shampine_32", Rk<tableaux::BogackiShampine32, Vector>{});
  steered("dormand_prince_54", Rk<tableaux::DormandPrince54, Vector>{});
  steered("dop_853", Rk<tableaux::Dop853, Vector>{});
  steered("rkc_2", StabilizedRk<Rkc2, Vector>{});
  steered("implicit_euler", Dirk<tableaux::ImplicitEuler, Vector, Matrix>{});
  steered("trapezoidal", Dirk<tableaux::Trapezoidal, Vector, Matrix>{});
  steered("tr_bdf2", Dirk<tableaux::TrBdf2, Vector, Matrix>{});
  steered("sdirk_4", Dirk<tableaux::Sdirk4, Vector, Matrix>{});
  steered("radau_iia_5", RadauIIA5<Vector, Matrix>{});
  steered("rosenbrock_23", Rosenbrock<tableaux::Rosenbrock23, Vector, Matrix>{});
  steered("rodas_4", Rosenbrock<tableaux::Rodas4, Vector, Matrix>{});
  run("adams_pece", AdamsPece<Vector>{}, ShampineGordonControl<double>(tolerances));
}

TEST(InitialStep, SeesForcesThatBeginAtZeroInEveryUnitOfTime) {
  for (const double unit : {1e-9, 1e-3, 1.0, 1e3, 1e9})
    for (const forced::Forcing& forcing : forced::forcings())
      with_each([&](const std::string& name, const auto& stepper, const auto& control) {
        Vector y = Vector::Zero(1);
        const auto end = integrate(stepper, Forced{forcing.g, unit}, Span<double>{0, 10 * unit}, y, control,
                                   ObserveNothing{}, 2'000'000);
        EXPECT_EQ(end.outcome, Outcome::reached_end) << name << " " << forcing.name << " " << unit;
        // Motions are of the size one; the least that is left of one is 0.006.
        EXPECT_NEAR(y[0], forcing.end, 3e-3 * std::abs(forcing.end) + 1e-4)
            << name << " " << forcing.name << " " << unit;
      });
}

TEST(InitialStep, TakesTheLongestStepWhereNothingEverActs) {
  const RmsNorm<double> norm{1e-6, 1e-9};
  const Forced still{[](double) { return 0.0; }};
  EXPECT_EQ(hairer_initial_step(still, 0.0, Vector(Vector::Zero(1)), 5, norm, 10.0, 1.0), 1);
  EXPECT_EQ(matlab_initial_step(still, 0.0, Vector(Vector::Zero(1)), 5, 1e-6, 1e-9, 10.0, 1.0), 1);
}

TEST(InitialStep, EndsBeforeAForceBegins) {
  const RmsNorm<double> norm{1e-6, 1e-9};
  const Forced late{[](double s) { return s < 0.4 ? 0.0 : 1.0; }};
  for (const double direction : {1.0, -1.0}) {
    const Forced mirrored{[](double s) { return s > -0.4 ? 0.0 : 1.0; }};
    const double h = hairer_initial_step(direction > 0 ? late : mirrored, 0.0, Vector(Vector::Zero(1)), 5,
                                         norm, direction * 10, 1.0);
    EXPECT_GT(h, 0.1);
    EXPECT_LT(h, 0.4);
  }
}

TEST(LongestStep, IsATenthOfTheSpanUnlessItIsGiven) {
  EXPECT_EQ(longest_step(std::numeric_limits<double>::infinity(), -20.0), 2);
  EXPECT_EQ(longest_step(7.0, 20.0), 7);
  // y' = 0: every error is zero.
  const Forced still{[](double) { return 0.0; }};
  const auto steps = [&](double h_first, double h_max) {
    Vector y = Vector::Zero(1);
    const auto control =
        adaptive<tableaux::DormandPrince54>({.rtol = 1e-6, .atol = 1e-9, .h_first = h_first, .h_max = h_max});
    return integrate(Rk<tableaux::DormandPrince54, Vector>{}, still, Span<double>{0, 20}, y, control)
        .stats.steps;
  };
  constexpr double none = std::numeric_limits<double>::infinity();
  EXPECT_EQ(steps(0, none), 10);
  EXPECT_EQ(steps(0, 0.5), 40);
  EXPECT_EQ(steps(20, 20), 1);
}

TEST(Breakpoints, AreLandedOnByEveryMethodAndReadOnBothSides) {
  for (const double height : {1.0, 1e6})
    for (const bool at_once : {true, false})
      with_each([&](const std::string& name, const auto& stepper, const auto& control) {
        const Switched system{.height = height, .at_once = at_once};
        Vector y = Vector::Zero(1);
        std::vector<double> ends;
        const auto note = [&](const auto& view) { ends.push_back(view.t1()); };
        const auto end = integrate(stepper, system, Span<double>{0, 10}, y, control, note, 1'000'000);
        EXPECT_EQ(end.outcome, Outcome::reached_end) << name;
        EXPECT_EQ(end.stats.steps, static_cast<std::int64_t>(ends.size())) << name;
        // The largest y is nearly one.
        EXPECT_NEAR(y[0] / height, system.end() / height, 5e-4) << name << " " << height << at_once;
        for (const double t : {3.0, 7.0})
          EXPECT_TRUE(std::ranges::any_of(ends, [&](double e) { return std::abs(e - t) < 1e-14 * t * 10; }))
              << name << " " << t;
        // Up to the jump nothing acts: no step is rejected for the sake of it.
        EXPECT_LT(std::ranges::count_if(ends, [](double e) { return e <= 3; }), 25) << name;
      });
}

TEST(Breakpoints, AreLandedOnBackwards) {
  const Switched system{};
  Vector y = Vector::Constant(1, system.end());
  const auto end = integrate(Rk<tableaux::DormandPrince54, Vector>{}, system, Span<double>{10, 0}, y,
                             adaptive<tableaux::DormandPrince54>({.rtol = 1e-9, .atol = 1e-12}));
  EXPECT_EQ(end.outcome, Outcome::reached_end);
  EXPECT_NEAR(y[0], 0, 1e-6);
}

TEST(Breakpoints, AreNotLandedOnByFixedSteps) {
  Vector y = Vector::Zero(1);
  std::vector<double> ends;
  const auto note = [&](const auto& view) { ends.push_back(view.t1()); };
  integrate(Rk<tableaux::Rk4, Vector>{}, Switched{}, Span<double>{0, 10}, y, FixedStep<double>(2), note);
  EXPECT_EQ(ends, (std::vector<double>{2, 4, 6, 8, 10}));
}

TEST(Breakpoints, ThatAreNotKnownAreNamedByTheRunThatFailsThere) {
  const Switched unknown{.height = 1e12, .knows = false};
  Vector y = Vector::Zero(1);
  const auto end = integrate(Rk<tableaux::DormandPrince54, Vector>{}, unknown, Span<double>{0, 10}, y,
                             adaptive<tableaux::DormandPrince54>({.rtol = 1e-14, .atol = 1e-14}));
  EXPECT_EQ(end.outcome, Outcome::step_too_small);
  EXPECT_NEAR(end.t, 3, 1e-12);
  EXPECT_EQ(end.note, jump_note);
}

TEST(Breakpoints, LimitTheAttemptsOfAllPiecesTogether) {
  Vector y = Vector::Zero(1);
  const auto end =
      integrate(Rk<tableaux::DormandPrince54, Vector>{}, Switched{}, Span<double>{0, 10}, y,
                adaptive<tableaux::DormandPrince54>({.rtol = 1e-6, .atol = 1e-9}), ObserveNothing{}, 12);
  EXPECT_EQ(end.outcome, Outcome::too_many_steps);
  EXPECT_EQ(end.stats.steps + end.stats.rejected, 12);
}

}  // namespace
}  // namespace hmax
