/// What steps show of a material: against formulas, against runs, and against themselves.
#include "limits/fidelity/fidelity.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "catalogue/methods/catalogue.hpp"
#include "catalogue/methods/choice/chosen_methods.hpp"
#include "catalogue/models/problems.hpp"
#include "core/errors.hpp"
#include "limits/fidelity/run_to_rest.hpp"
#include "limits/fidelity/settled_state.hpp"
#include "limits/linearised_problem.hpp"

namespace hmax {
namespace {

using Eigen::VectorXd;

Problem body(const std::string& id, std::vector<std::pair<std::string, double>> parameters = {}) {
  return make_problem(id, {.parameters = std::move(parameters)});
}

TEST(SettledState, IsTheFixedPointOfTheMap) {
  // q' = q + a (1 - q) per number with rates from fast to a thousandth.
  const VectorXd rate = VectorXd::LinSpaced(40, 0.001, 0.9);
  const auto step = [&](const VectorXd& y) {
    VectorXd next = VectorXd::Zero(80);
    next.head(40) = y.head(40) + rate.cwiseProduct(VectorXd::Ones(40) - y.head(40));
    return next;
  };
  const SettledState found = settled_state(step, VectorXd::Constant(40, 3), 0.001);
  EXPECT_TRUE(found.settled);
  EXPECT_LT((found.q - VectorXd::Ones(40)).norm(), 1e-6);
  EXPECT_LT(found.steps, 200);  // without acceleration some 20,000
}

TEST(SettledState, SaysThatNothingSettles) {
  const auto turns = [](const VectorXd& y) {
    VectorXd next = VectorXd::Zero(4);
    next.head(2) << -1.1 * y[1] + 0.3, 1.2 * y[0] * y[0] + 0.5;
    return next;
  };
  EXPECT_FALSE(settled_state(turns, VectorXd::Constant(2, 30)).settled);
}

/// x'' = 1 - omega^2 x of each number by symplectic Euler, h = 1.
VectorFunction oscillators(const VectorXd& omega) {
  return [omega](const VectorXd& y) {
    const Eigen::Index n = omega.size();
    VectorXd next = y;
    next.tail(n) += VectorXd::Ones(n) - omega.cwiseAbs2().cwiseProduct(y.head(n));
    next.head(n) += next.tail(n);
    return next;
  };
}

TEST(RunToRest, EndsWhereAFreeRunOscillates) {
  const VectorXd omega = VectorXd::LinSpaced(10, 0.05, 0.5);
  const RunToRest run = run_to_rest(oscillators(omega), VectorXd::Ones(10), 0.0025);
  ASSERT_EQ(run.q.size(), 10);
  EXPECT_LT(run.steps, 500);
  const VectorXd exact = omega.cwiseAbs2().cwiseInverse();
  EXPECT_LT((run.q - exact).norm(), 1e-3 * exact.norm());
}

TEST(RunToRest, SaysWhereItDoesNot) {
  // Beyond omega h = 2 the steps grow; and here is no rest at all.
  EXPECT_EQ(run_to_rest(oscillators(VectorXd::Constant(3, 2.5)), VectorXd::Ones(3), 1).q.size(), 0);
  const auto turns = [](const VectorXd& y) {
    VectorXd next(4);
    next << 1 - y[1], y[0], 1, 1;
    return next;
  };
  const RunToRest run = run_to_rest(turns, VectorXd::Ones(2), 1);
  EXPECT_EQ(run.q.size(), 0);
  EXPECT_EQ(run.steps, 1000);
}

TEST(MomentumMade, IsNoneWhereForcesComeInPairs) {
  const FidelityModel model = fidelity_model(body("fem_neo_hookean/press@cube:n=2"));
  const auto made = [&](const char* method, double h = 0.01) {
    return momentum_made(find_method(method), model.problem, model.equilibrium, h);
  };
  // Forces and torques of a solid add up to nothing where they are evaluated, and so do those of a
  // constraint: but it moves on while others are met.
  for (const char* method : {"implicit_euler", "symplectic_euler"}) {
    EXPECT_LT(made(method).linear, 1e-9) << method;
    EXPECT_LT(made(method).angular, 1e-7) << method;
  }
  EXPECT_LT(made("xpbd:iterations=2").linear, 1e-9);
  // Forces that are found point by point do not, nor do torques where one matrix stands for all directions.
  const MomentumMade of_points = made("vbd:iterations=2"),
                     of_directions = made("projective_dynamics:iterations=2");
  EXPECT_GT(of_points.linear, 1e-3);
  EXPECT_GT(of_points.angular, 1e-3);
  EXPECT_LT(made("vbd:iterations=2000").linear, 1e-7);
  EXPECT_LT(of_directions.linear, 1e-9);
  EXPECT_GT(of_directions.angular, 1e-6);
  EXPECT_LT(made("projective_dynamics:iterations=2000").angular, 1e-7);
}

TEST(Fidelity, OfImplicitEulerIsThatOfItsFormula) {
  const FidelityModel model = fidelity_model(body("fem_cauchy/press@cube:n=2"));
  ASSERT_EQ(model.modes.size(), 3u);
  const double h = 0.01;
  const Fidelity row = fidelity(find_method("implicit_euler"), model, {.h = h, .ceiling = true});
  EXPECT_NEAR(row.stiffness_shown, 1, 1e-7);
  EXPECT_NEAR(row.volume_kept, 1, 1e-9);
  EXPECT_TRUE(std::isinf(row.stiffness_ceiling));
  for (const ShownMode& mode : row.modes) {
    // Of y' = i omega y a step makes 1 / (1 - i omega h).
    const std::complex<double> rate = -std::log(1.0 - std::complex<double>(0, mode.omega * h)) / h;
    EXPECT_NEAR(mode.omega_shown, std::abs(rate), 1e-4 * mode.omega);
    EXPECT_NEAR(mode.zeta_shown, -rate.real() / std::abs(rate), 1e-4);
    EXPECT_GT(mode.likeness, 0.999);
  }
}

TEST(Fidelity, IsWhatRunsShow) {
  const std::vector<std::pair<std::string, std::vector<std::string>>> settings{
      {"mass_spring/press@phantom",
       {"vbd:iterations=3", "vbd:iterations=5,rho=0.5", "xpbd:iterations=4,reset=1"}},
      {"fem_neo_hookean/gravity@cube:n=2", {"vbd", "xpbd:iterations=3", "xpbd:iterations=1,substeps=4"}}};
  for (const auto& [id, methods] : settings) {
    const FidelityModel model = fidelity_model(body(id));
    for (const std::string& name : methods) {
      const Fidelity row = fidelity(find_method(name), model, {.h = 0.01, .verify = true});
      ASSERT_TRUE(row.observed) << id << ' ' << name << ": " << row.status;
      EXPECT_NEAR(row.observed->stiffness_shown, row.stiffness_shown, 0.02 * row.stiffness_shown)
          << id << ' ' << name;
      EXPECT_LT(row.gap, 1e-3) << id << ' ' << name << ": " << row.status;
      EXPECT_NEAR(row.observed->modes.front().omega_shown, row.modes.front().omega_shown,
                  0.02 * row.modes.front().omega_shown)
          << id << ' ' << name;
    }
  }
}

/// f . q of a row: where its steps settle.
double sag_of(const Fidelity& row, const FidelityModel& model) {
  return model.load.dot(model.equilibrium) / row.stiffness_shown;
}

TEST(Fidelity, RunsBeginInTheMotionsThatStepsHave) {
  // From the shapes of the model the slower modes of these steps show mixtures, 1 % off.
  const Fidelity row =
      fidelity(find_method("vbd:iterations=5"), fidelity_model(body("fem_neo_hookean/press@phantom")),
               {.h = 1.0 / 60, .verify = true});
  ASSERT_EQ(row.modes.size(), 3u);
  EXPECT_LT(row.modes[1].likeness, 0.85);
  EXPECT_LT(row.gap, 1e-4) << row.status;
}

TEST(Fidelity, SettlesWhereARunDoesWhereNothingStaysNearTheEquilibrium) {
  const FidelityModel model = fidelity_model(body("fem_corotational/gravity@cube:n=2", {{"E", 2000}}));
  const Fidelity row =
      fidelity(find_method("vbd:iterations=1"), model, {.h = 1.0 / 60, .verify = true, .wanted = 2000});
  EXPECT_NE(
      row.status.find(
          "steps do not stay near the equilibrium of the model; this state was reached by a run from rest"),
      std::string::npos)
      << row.status;
  EXPECT_LT(row.stiffness_shown, 0.2);
  EXPECT_GT(row.settled_error, 5);
  // With the modulus to enter it settles near the equilibrium.
  const FidelityModel entered =
      fidelity_model(body("fem_corotational/gravity@cube:n=2", {{"E", row.modulus_to_enter}}));
  const double seen = sag_of(fidelity(find_method("vbd:iterations=1"), entered, {.h = 1.0 / 60}), entered);
  EXPECT_NEAR(seen, model.load.dot(model.equilibrium), 1e-3 * seen);
  EXPECT_NEAR(row.observed->stiffness_shown, row.stiffness_shown, 1e-4 * row.stiffness_shown);
  EXPECT_FALSE(row.contradiction);
}

TEST(Fidelity, ModulusToEnterSagsAsTheModelDoesWithTheOneWanted) {
  const Method method = find_method("vbd:iterations=3");
  const double wanted = 5000;
  const std::vector<std::pair<std::string, std::vector<std::pair<std::string, double>>>> bodies{
      {"fem_cauchy/press@phantom", {}}, {"fem_neo_hookean/gravity@cube:n=2", {{"support_stiffness", 5e5}}}};
  for (const auto& [id, parameters] : bodies) {
    const auto model_of = [&, id = id, parameters = parameters](double E) {
      auto all = parameters;
      all.emplace_back("E", E);
      return fidelity_model(body(id, all));
    };
    const Fidelity row = fidelity(method, model_of(4000), {.h = 1.0 / 200, .wanted = wanted});
    ASSERT_FALSE(std::isnan(row.modulus_to_enter)) << id << ": " << row.status;
    EXPECT_GT(row.modulus_to_enter, wanted) << id;
    const FidelityModel entered = model_of(row.modulus_to_enter), exact = model_of(wanted);
    const double seen = sag_of(fidelity(method, entered, {.h = 1.0 / 200}), entered);
    EXPECT_NEAR(seen, exact.load.dot(exact.equilibrium), 1e-3 * seen) << id;
  }
}

TEST(Fidelity, ModulusToEnterOfSoftBodiesIsFoundWhereFarOnesDoNotSettle) {
  const auto soft = [](double E) {
    return fidelity_model(body("fem_neo_hookean/gravity@beam:n=2", {{"E", E}}));
  };
  // Exact steps show what is entered, also where much softer and much stiffer bodies are too far to be found.
  const FidelityQuestion question{.h = 1.0 / 60, .wanted = 500};
  EXPECT_NEAR(fidelity(find_method("newmark"), soft(500), question).modulus_to_enter, 500, 0.1);
  // 96.4 % of 500 Pa are shown.
  const double entered =
      fidelity(find_method("vbd:iterations=1,substeps=3"), soft(500), question).modulus_to_enter;
  EXPECT_GT(entered, 505);
  EXPECT_LT(entered, 540);
}

TEST(Fidelity, OfAMethodThatMovesAnUnloadedBodyIsThatOfTheLoad) {
  // Two constraints of a tetrahedron push against each other at rest, and few iterations leave a rest.
  const Method method = find_method("xpbd:iterations=5");
  const auto shown = [&](double force) {
    return fidelity(method, fidelity_model(body("fem_neo_hookean/press@cube:n=2", {{"force", force}})),
                    {.h = 0.01});
  };
  const Fidelity strong = shown(0.05), weak = shown(0.01);
  EXPECT_NEAR(weak.stiffness_shown, strong.stiffness_shown, 0.05 * strong.stiffness_shown);
  EXPECT_GT(weak.rest_moves, 0);
  EXPECT_NE(weak.status.find("without load it moves"), std::string::npos) << weak.status;
  EXPECT_EQ(fidelity(find_method("vbd"), fidelity_model(body("fem_neo_hookean/press@cube:n=2")), {.h = 0.01})
                .rest_moves,
            0);
}

TEST(Fidelity, JoinsBothDecaysOfAnOverdampedMode) {
  const FidelityModel model = fidelity_model(body("fem_cauchy/press@cube:n=1", {{"alpha", 200}}));
  const Fidelity row = fidelity(find_method("implicit_euler"), model, {.h = 1e-3, .verify = true});
  const ShownMode& mode = row.modes.front();
  ASSERT_GT(mode.zeta, 2);
  EXPECT_NEAR(mode.omega_shown, mode.omega, 0.05 * mode.omega);
  EXPECT_NEAR(mode.zeta_shown, mode.zeta, 0.05 * mode.zeta);
}

TEST(Fidelity, OfAnOverdampedModeHasBothDecaysOnce) {
  // They are found on the plane of the mode, and in the spectrum of the steps again.
  const auto expect_decays = [](const std::vector<ShownMode>& modes, double h) {
    ASSERT_EQ(modes.size(), 3U);
    for (const ShownMode& mode : modes) {
      ASSERT_GT(mode.zeta, 1);
      // Of y' = -a y a step makes 1 / (1 + a h).
      const double root = std::sqrt(mode.zeta * mode.zeta - 1),
                   slow = std::log(1 + mode.omega * (mode.zeta - root) * h) / h,
                   fast = std::log(1 + mode.omega * (mode.zeta + root) * h) / h,
                   omega = std::sqrt(slow * fast);
      EXPECT_NEAR(mode.omega_shown, omega, 1e-4 * omega);
      EXPECT_NEAR(mode.zeta_shown, (slow + fast) / (2 * omega), 1e-4);
    }
  };
  const Method method = find_method("implicit_euler");
  const Fidelity row = fidelity(method, fidelity_model(body("fem_cauchy/gravity@phantom", {{"beta", 0.2}})),
                                {.h = 1.0 / 60, .verify = true});
  expect_decays(row.modes, row.h);
  EXPECT_LT(row.gap, 0.01);
  const ShownDamping damping =
      shown_damping(method, settled_model(body("fem_cauchy/gravity@phantom", {{"beta", 0.12}})), 0.0333);
  expect_decays(damping.modes, damping.h);
}

TEST(Fidelity, KnowsSlowModesOfStepsThatDampNothing) {
  // All eigenvalues have the modulus 1, and none of the slow ones stands out.
  const FidelityModel model = fidelity_model(body("fem_cauchy/press@phantom"));
  const double h = 2e-3;
  const Fidelity row = fidelity(find_method("symplectic_euler"), model, {.h = h});
  ASSERT_EQ(row.modes.size(), 3u);
  for (const ShownMode& mode : row.modes) {
    // 2 - 2 cos(omega_shown h) = (omega h)^2 [hairer2006geometric, I.1].
    EXPECT_NEAR(mode.omega_shown, std::acos(1 - std::pow(mode.omega * h, 2) / 2) / h, 1e-5 * mode.omega);
    EXPECT_NEAR(mode.zeta_shown, 0, 1e-5);
  }
}

TEST(Fidelity, KnowsModesWhoseDampingIsThatOfTheMaterial) {
  const double beta = 0.004, h = 2e-3;
  const FidelityModel model = fidelity_model(body("fem_cauchy/press@cube:n=2", {{"beta", beta}}));
  const Fidelity row = fidelity(find_method("implicit_euler"), model, {.h = h});
  ASSERT_EQ(row.modes.size(), 3u);
  for (const ShownMode& mode : row.modes) {
    EXPECT_NEAR(mode.zeta, beta * mode.omega / 2, 1e-9);
    const std::complex<double> lambda =
        mode.omega * std::complex<double>(-mode.zeta, std::sqrt(1 - mode.zeta * mode.zeta));
    const std::complex<double> rate = -std::log(1.0 - lambda * h) / h;
    EXPECT_NEAR(mode.omega_shown, std::abs(rate), 1e-4 * mode.omega);
    EXPECT_NEAR(mode.zeta_shown, -rate.real() / std::abs(rate), 1e-4);
  }
}

TEST(Fidelity, SeesGrowthWhereNoModeIsKnown) {
  FidelityModel model = fidelity_model(body("mass_spring/press@cube:n=2", {{"damper", 0.01}}));
  model.modes.clear();  // as of large bodies
  model.shapes.resize(model.load.size(), 0);
  const Fidelity row = fidelity(find_method("symplectic_euler"), model, {.h = 0.25});
  EXPECT_TRUE(std::isnan(row.stiffness_shown));
  EXPECT_NE(row.status.find("its steps grow"), std::string::npos) << row.status;
}

TEST(Fidelity, SeesNoGrowthOfStableStepsWhereFastAndSlowModesLieFarApart) {
  // rk4 is stable up to 3.2 ms here; residuals of its far from normal steps are small beside false values.
  const FidelityModel model =
      fidelity_model(make_problem("fem_neo_hookean/press@liver", {.material = "liver:male_normal"}));
  const Fidelity row = fidelity(find_method("rk4"), model, {.h = 1e-3});
  EXPECT_NEAR(row.stiffness_shown, 1, 1e-4) << row.status;
  EXPECT_EQ(row.status, "");
}

TEST(Fidelity, ShowsNoMoreThanItsCeiling) {
  const Method method = find_method("vbd:iterations=3");
  const auto shown = [&](double E) {
    return E * fidelity(method, fidelity_model(body("fem_cauchy/press@phantom", {{"E", E}})), {.h = 1.0 / 60})
                   .stiffness_shown;
  };
  const Fidelity row = fidelity(method, fidelity_model(body("fem_cauchy/press@phantom")),
                                {.h = 1.0 / 60, .ceiling = true, .wanted = 1e7});
  EXPECT_NEAR(shown(1e9), row.stiffness_ceiling, 0.01 * row.stiffness_ceiling);
  EXPECT_LT(shown(1e6), row.stiffness_ceiling);
  EXPECT_TRUE(std::isnan(row.modulus_to_enter));
  EXPECT_NE(row.status.find("it shows at most"), std::string::npos) << row.status;
}

TEST(Fidelity, SaysWhatItCannotTell) {
  const FidelityModel model = fidelity_model(body("fem_cauchy/press@phantom"));
  const Fidelity unstable = fidelity(find_method("symplectic_euler"), model, {.h = 0.05});
  EXPECT_TRUE(std::isnan(unstable.stiffness_shown));
  EXPECT_NE(unstable.status.find("its steps grow"), std::string::npos) << unstable.status;
  const Fidelity truncated = fidelity(find_method("newton_truncated:cg=2"), model, {.h = 0.05});
  EXPECT_NE(truncated.status.find("not linear in the state"), std::string::npos) << truncated.status;
  EXPECT_TRUE(std::isnan(truncated.modes.front().omega_shown));
}

TEST(ShownDamping, OfImplicitEulerIsItsFormulaAtRestAndUnderALoad) {
  const double h = 0.01;
  for (const double g : {0.0, 9.81}) {
    const FidelityModel model = settled_model(body("fem_cauchy/gravity@cube:n=2", {{"g", g}}));
    EXPECT_EQ(model.equilibrium.isZero(0), g == 0);
    const ShownDamping row = shown_damping(find_method("implicit_euler"), model, h);
    EXPECT_EQ(row.status, "") << g;
    EXPECT_TRUE(std::isnan(row.growth)) << g;
    ASSERT_EQ(row.modes.size(), 3U) << g;
    for (const ShownMode& mode : row.modes) {
      // Of y' = i omega y a step makes 1 / (1 - i omega h).
      const std::complex<double> rate = -std::log(1.0 - std::complex<double>(0, mode.omega * h)) / h;
      EXPECT_NEAR(mode.omega_shown, std::abs(rate), 1e-4 * mode.omega) << g;
      EXPECT_NEAR(mode.zeta_shown, -rate.real() / std::abs(rate), 1e-4) << g;
    }
  }
}

/// BDF 2: (3/2 - z) r^2 - 2 r + 1/2 = 0 with r = (2 + sqrt(1 + 2 z)) / (3 - 2 z), z = i omega h.
TEST(ShownDamping, OfMethodsThatRememberEarlierStepsIsThatOfTheirFormula) {
  const FidelityModel model = settled_model(body("fem_cauchy/press@cube:n=2"));
  const double h = 0.01;
  const ShownDamping row =
      shown_damping(chosen_methods_and_formulas({"bdf_2"}, {model.problem}).methods.front(), model, h);
  ASSERT_EQ(row.modes.size(), 3U);
  for (const ShownMode& mode : row.modes) {
    const std::complex<double> z(0, mode.omega * h), r = (2.0 + std::sqrt(1.0 + 2.0 * z)) / (3.0 - 2.0 * z);
    EXPECT_NEAR(mode.omega_shown, std::abs(std::log(r)) / h, 1e-8 * mode.omega);
    EXPECT_NEAR(mode.zeta_shown, -std::log(r).real() / std::abs(std::log(r)), 1e-8);
  }
  EXPECT_TRUE(std::isnan(row.growth));
  // BDF 3 is not A-stable: a slow mode grows by |r| of its root.
  const ShownDamping third =
      shown_damping(chosen_methods_and_formulas({"bdf_3"}, {model.problem}).methods.front(), model, 0.1);
  const ShownMode& slow = third.modes.front();
  EXPECT_GE(third.growth, std::exp(-slow.zeta_shown * slow.omega_shown * 0.1) - 1e-9);
  EXPECT_GT(third.growth, 1);
  // Adams-Bashforth methods of order 2 have no stable step of an undamped mode.
  EXPECT_GT(shown_damping(find_method("adams_bashforth_2"), model, h).growth, 1);
}

TEST(ShownDamping, SaysWhatGrowsBeyondTheLimit) {
  const FidelityModel model = settled_model(body("fem_cauchy/press@cube:n=2"));
  double fastest = 0;
  for (const MechanicalMode& mode : linearised(model.problem).modes.spectrum.mechanical)
    fastest = std::max(fastest, std::sqrt(mode.kappa));
  // Symplectic Euler: z^2 - (2 - (omega h)^2) z + 1 = 0, of omega h = 2.2 with a root below -1.
  const ShownDamping row = shown_damping(find_method("symplectic_euler"), model, 2.2 / fastest);
  const double half = 1 - 2.2 * 2.2 / 2;
  EXPECT_NEAR(row.growth, std::sqrt(half * half - 1) - half, 1e-4);
  EXPECT_EQ(row.status.find("a motion that changes sign in every step grows"), 0U) << row.status;
}

TEST(Fidelity, RefusesWhatShowsNoStiffness) {
  const auto refusal = [](const auto& call) {
    try {
      call();
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("taken");
  };
  EXPECT_NE(refusal([] {
              fidelity_model(body("fem_green/gravity@cube:n=2", {{"g", 0}}));
            }).find("nothing loads the body"),
            std::string::npos);
  EXPECT_NE(refusal([] { fidelity_model(body("fem_green/breathing@cube:n=2")); }).find("never settles"),
            std::string::npos);
  EXPECT_NE(refusal([] { fidelity_model(body("fem_green/tool@cube:n=2")); }).find("where a tool meets it"),
            std::string::npos);
  const FidelityModel model = fidelity_model(body("fem_green/press@cube:n=2"));
  EXPECT_NE(refusal([&] { fidelity(find_method("xpbd"), model, {.h = 0.01}); }).find("fem_neo_hookean"),
            std::string::npos);
  EXPECT_NE(refusal([&] { fidelity(find_method("cvode_bdf"), model, {.h = 0.01}); }).find("cvode_bdf"),
            std::string::npos);
}

}  // namespace
}  // namespace hmax
