/// What steps show of a material: against formulas, against runs, and against themselves.
#include "limits/fidelity/fidelity.hpp"

#include <cmath>
#include <complex>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "catalogue/methods/catalogue.hpp"
#include "catalogue/models/problems.hpp"
#include "core/errors.hpp"
#include "limits/fidelity/settled_state.hpp"

namespace hmax {
namespace {

using Eigen::VectorXd;

Problem body(const std::string& id, std::vector<std::pair<std::string, double>> parameters = {}) {
  return make_problem(id, {.material = {}, .parameters = std::move(parameters), .y0 = {}});
}

TEST(SettledState, IsTheFixedPointOfTheMap) {
  // q' = q + a (1 - q) per number with rates from fast to a thousandth.
  const VectorXd rate = VectorXd::LinSpaced(40, 0.001, 0.9);
  const auto step = [&](const VectorXd& y) {
    VectorXd next = VectorXd::Zero(80);
    next.head(40) = y.head(40) + rate.cwiseProduct(VectorXd::Ones(40) - y.head(40));
    return next;
  };
  const SettledState found = settled_state(step, VectorXd::Constant(40, 3));
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
      EXPECT_LT(row.gap, 0.02) << id << ' ' << name << ": " << row.status;
      EXPECT_NEAR(row.observed->modes.front().omega_shown, row.modes.front().omega_shown,
                  0.02 * row.modes.front().omega_shown)
          << id << ' ' << name;
    }
  }
}

TEST(Fidelity, ModulusToEnterShowsTheOneWanted) {
  const Method method = find_method("vbd:iterations=3");
  const auto model_of = [](double E) { return fidelity_model(body("fem_cauchy/press@phantom", {{"E", E}})); };
  const double wanted = 5000;
  const Fidelity row = fidelity(method, model_of(4000), {.h = 1.0 / 60, .wanted = wanted});
  ASSERT_FALSE(std::isnan(row.modulus_to_enter)) << row.status;
  EXPECT_GT(row.modulus_to_enter, wanted);
  const Fidelity entered = fidelity(method, model_of(row.modulus_to_enter), {.h = 1.0 / 60});
  EXPECT_NEAR(entered.stiffness_shown * row.modulus_to_enter, wanted, 1e-3 * wanted);
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

TEST(Fidelity, RefusesWhatShowsNoStiffness) {
  const auto refusal = [](const auto& call) {
    try {
      call();
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("taken");
  };
  EXPECT_NE(refusal([] { fidelity_model(make_problem("liver_linear")); }).find("is no body"),
            std::string::npos);
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
