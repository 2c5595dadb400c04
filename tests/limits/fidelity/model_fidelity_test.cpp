/// What steps show of models that are no bodies, against closed forms.
#include <cmath>
#include <complex>
#include <functional>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "catalogue/methods/catalogue.hpp"
#include "catalogue/models/problems.hpp"
#include "core/errors.hpp"
#include "limits/fidelity/fidelity.hpp"
#include "tests/results/scratch.hpp"
#include "tests/says.hpp"

namespace hmax {
namespace {

using Complex = std::complex<double>;

Problem made(const std::string& id, std::vector<std::pair<std::string, double>> parameters = {},
             std::vector<double> y0 = {}) {
  return make_problem(id, {.parameters = std::move(parameters), .y0 = std::move(y0)});
}

/// The factors of a step of y' = lambda y.
Complex by_implicit_euler(Complex z) { return 1.0 / (1.0 - z); }
Complex by_trapezoidal(Complex z) { return (1.0 + z / 2.0) / (1.0 - z / 2.0); }

/// Whether a row shows of each mode what a factor makes of its eigenvalue.
void expect_modes(const Fidelity& row, const std::function<Complex(Complex)>& factor, double tolerance) {
  for (const ShownMode& mode : row.modes) {
    const Complex lambda = mode.omega * Complex(-mode.zeta, std::sqrt(1 - mode.zeta * mode.zeta)),
                  rate = std::log(factor(lambda * row.h)) / row.h;
    EXPECT_NEAR(mode.omega_shown, std::abs(rate), tolerance * mode.omega) << row.method.id;
    EXPECT_NEAR(mode.zeta_shown, -rate.real() / std::abs(rate), tolerance) << row.method.id;
  }
}

TEST(ModelFidelity, OfAnOscillatorUnderAConstantForceIsThatOfFormulas) {
  // At rest where k1 x + k3 x^3 = P = 2: x = 1, with the tangent k1 + 3 k3 x^2 = 3.5.
  const FidelityModel model = fidelity_model(
      made("liver_forced", {{"m", 1.4}, {"c", 0.7}, {"k1", 1.25}, {"k3", 0.75}, {"P", 2}, {"w", 0}}, {0, 0}));
  EXPECT_NEAR(model.load[0], 2, 1e-12);
  EXPECT_NEAR(model.equilibrium[0], 1, 1e-12);
  ASSERT_EQ(model.modes.size(), 1U);
  EXPECT_NEAR(model.modes[0].omega, std::sqrt(2.5), 1e-9);
  EXPECT_NEAR(model.modes[0].zeta, 0.7 / (2 * 1.4 * std::sqrt(2.5)), 1e-9);
  const FidelityQuestion question{.h = 0.1, .verify = true};
  for (const auto& [name, factor] :
       {std::pair{"implicit_euler", &by_implicit_euler}, std::pair{"trapezoidal", &by_trapezoidal}}) {
    const Fidelity row = fidelity(find_method(name), model, question);
    EXPECT_NEAR(row.stiffness_shown, 1, 1e-9) << row.status;
    EXPECT_NEAR(row.settled_error, 0, 1e-9);
    EXPECT_NEAR(row.observed->stiffness_shown, 1, 1e-3) << row.status;
    EXPECT_LT(row.gap, 0.01);
    EXPECT_TRUE(std::isnan(row.volume_kept));
    EXPECT_TRUE(std::isnan(row.momentum.linear));
    expect_modes(row, factor, 1e-5);
  }
}

TEST(ModelFidelity, IsMeasuredFromTheStart) {
  // Let go from 0.5: the load is the force there.
  const FidelityModel model = fidelity_model(made("liver_linear"));
  EXPECT_NEAR(model.load[0], -5.3 * 0.5, 1e-12);
  EXPECT_NEAR(model.equilibrium[0], -0.5, 1e-12);
  EXPECT_NEAR(fidelity(find_method("rk4"), model, {.h = 0.1}).stiffness_shown, 1, 1e-9);
  // Symplectic Euler: z^2 - (2 - (omega h)^2) z + 1 = 0 without damping, stable up to omega h = 2.
  const FidelityModel undamped = fidelity_model(made("liver_linear", {{"c", 0}}));
  const double omega = std::sqrt(5.3 / 1.45), h = 1 / omega;
  const Fidelity row = fidelity(find_method("symplectic_euler"), undamped, {.h = h});
  EXPECT_NEAR(row.modes[0].omega_shown, std::acos(0.5) / h, 1e-6 * omega);
  EXPECT_NEAR(row.modes[0].zeta_shown, 0, 1e-6);
  const Fidelity unstable = fidelity(find_method("symplectic_euler"), undamped, {.h = 2.1 / omega});
  EXPECT_TRUE(std::isnan(unstable.stiffness_shown));
  EXPECT_NE(unstable.status.find("its steps grow"), std::string::npos) << unstable.status;
}

TEST(ModelFidelity, ShowsModesOfWhatNothingLoads) {
  for (const Problem& problem : {made("liver_linear", {}, {0, 0}), made("spring_chain")}) {
    const FidelityModel model = fidelity_model(problem);
    EXPECT_FALSE(model.is_loaded());
    const Fidelity row = fidelity(find_method("implicit_euler"), model, {.h = 1e-3, .verify = true});
    EXPECT_TRUE(std::isnan(row.stiffness_shown));
    EXPECT_NE(row.status.find("nothing loads the model in its start"), std::string::npos) << row.status;
    ASSERT_FALSE(row.modes.empty());
    EXPECT_LT(row.gap, 1e-3);
    expect_modes(row, by_implicit_euler, 1e-5);
  }
}

TEST(ModelFidelity, VerifiesOverdampedMotionsAndThoseThatTurnBack) {
  const Fidelity slow =
      fidelity(find_method("implicit_euler"), fidelity_model(made("liver_linear", {{"c", 50}})),
               {.h = 0.1, .verify = true});
  ASSERT_GT(slow.modes[0].zeta, 9);
  EXPECT_NEAR(slow.observed->stiffness_shown, 1, 0.01) << slow.status;
  EXPECT_FALSE(slow.contradiction);
  // omega h = 1: the third step ends where it began, and turns back.
  const Fidelity turning =
      fidelity(find_method("symplectic_euler"),
               fidelity_model(made("liver_linear", {{"m", 1}, {"c", 0}, {"k1", 1}}, {1, 0})),
               {.h = 1, .verify = true});
  EXPECT_TRUE(std::isnan(turning.observed->stiffness_shown));
  EXPECT_FALSE(turning.contradiction);
}

TEST(ModelFidelity, ShowsNoOscillationWhereOneOfTwoDecaysTurnsAbout) {
  // Of Newmark's method z = (1 + a / 2) / (1 - a / 2) nearly, of explicit Euler's 1 + a: a = -13 h and -0.3
  // h.
  const FidelityModel model = fidelity_model(made("liver_linear", {{"c", 20}, {"k1", 5.3}}));
  ASSERT_GT(model.modes[0].zeta, 3);
  for (const auto& [name, h] :
       {std::pair{"newmark", 0.5}, std::pair{"explicit_euler", 0.1}, std::pair{"symplectic_euler", 0.1}}) {
    const Fidelity row = fidelity(find_method(name), model, {.h = h, .verify = true});
    EXPECT_NEAR(row.stiffness_shown, 1, 1e-9) << name << ": " << row.status;
    EXPECT_TRUE(std::isnan(row.modes[0].omega_shown)) << name << ' ' << row.modes[0].omega_shown;
    EXPECT_FALSE(row.contradiction) << name << ' ' << row.gap;
    // Of the others one decay is over before the run is looked at.
    EXPECT_TRUE(name != std::string("newmark") || std::isnan(row.observed->modes[0].omega_shown));
  }
}

/// Tridiagonal with d on the diagonal, `end` at both ends of it, and e beside it.
std::string matrix_market(int n, double d, double e, double end) {
  std::string text =
      fmt::format("%%MatrixMarket matrix coordinate real symmetric\n{0} {0} {1}\n", n, 2 * n - 1);
  for (int i = 1; i <= n; ++i) {
    text += fmt::format("{0} {0} {1}\n", i, i == 1 || i == n ? end : d);
    if (i < n) text += fmt::format("{} {} {}\n", i + 1, i, e);
  }
  return text;
}

TEST(ModelFidelity, OfMatricesIsThatOfEachMode) {
  // A bar of linear elements between two walls, with its consistent mass: c = cos(k pi / (n + 1)),
  // omega_k^2 = k0 (2 - 2 c) / (m0 (4 + 2 c)).
  const Scratch folder;
  const int n = 6;
  const double k0 = 100, m0 = 0.1 / 6, alpha = 1.5;
  write_text(folder / "K.mtx", matrix_market(n, 2 * k0, -k0, 2 * k0));
  write_text(folder / "M.mtx", matrix_market(n, 4 * m0, m0, 4 * m0));
  const FidelityModel model = fidelity_model(made(
      fmt::format("matrices:stiffness={},mass={}", (folder / "K.mtx").string(), (folder / "M.mtx").string()),
      {{"alpha", alpha}}));
  ASSERT_EQ(model.modes.size(), 3U);
  for (int k = 1; k <= 3; ++k) {
    const double c = std::cos(k * std::numbers::pi / (n + 1)),
                 omega = std::sqrt(k0 * (2 - 2 * c) / (m0 * (4 + 2 * c)));
    const ShownMode& mode = model.modes[static_cast<std::size_t>(k - 1)];
    EXPECT_NEAR(mode.omega, omega, 1e-9 * omega);
    EXPECT_NEAR(mode.zeta, alpha / (2 * omega), 1e-9);
  }
  const Fidelity row = fidelity(find_method("implicit_euler"), model, {.h = 0.01, .verify = true});
  EXPECT_NEAR(row.stiffness_shown, 1, 1e-9) << row.status;
  EXPECT_LT(row.gap, 1e-3);
  expect_modes(row, by_implicit_euler, 1e-5);
}

TEST(ModelFidelity, OfManyUnknownsKnowsTheSlowestModeOrNone) {
  // Unit masses in a row, omega^2 = k (2 - 2 cos(pi / (n + 1))) between two walls; free ones also drift.
  const Scratch folder;
  const int n = 1600;
  const double k = 1000, omega = std::sqrt(k * (2 - 2 * std::cos(std::numbers::pi / (n + 1))));
  write_text(folder / "M.mtx", matrix_market(n, 1, 0, 1));
  const auto model_of = [&](const char* name, double end) {
    write_text(folder / name, matrix_market(n, 2 * k, -k, end));
    return fidelity_model(made(
        fmt::format("matrices:stiffness={},mass={}", (folder / name).string(), (folder / "M.mtx").string())));
  };
  const FidelityModel held = model_of("held.mtx", 2 * k), free = model_of("free.mtx", k);
  EXPECT_NEAR(held.fastest, std::sqrt(4 * k), 1e-3);
  EXPECT_NEAR(free.fastest, std::sqrt(4 * k), 1e-3);
  ASSERT_EQ(held.modes.size(), 1U);
  EXPECT_NEAR(held.modes[0].omega, omega, 1e-6 * omega);
  EXPECT_TRUE(free.modes.empty());
  EXPECT_NE(free.why_no_modes.find("slow modes of a model of this size are not computed"), std::string::npos);
}

// Differences across the stop that just touches had the mode of neither side.
TEST(ModelFidelity, OfAKinkComparesNoMode) {
  const Scratch folder;
  write_text(folder / "stop.toml",
             "[equations]\nx = \"v\"\nv = \"-100*x - (x<0 ? 1e4*x : 0) - 0.2*v\"\n[initial]\nx = 0\nv = 0\n");
  const FidelityModel model = settled_model(made((folder / "stop.toml").string()));
  EXPECT_TRUE(model.modes.empty());
  EXPECT_TRUE(says(model.why_no_modes, "jump at its equilibrium"));
  EXPECT_NEAR(model.fastest, std::sqrt(10100), 1e-9);
}

TEST(ModelFidelity, OfFormulasFindsTheirMasses) {
  // Masses 2 and 5 on springs: K = (5, -2; -2, 2), omega^2 = 1.45 -+ sqrt(1.45^2 - 0.6).
  const Scratch folder;
  write_text(folder / "two.toml",
             "[equations]\nx = \"u\"\ny = \"w\"\nu = \"(1 - 3*x + 2*(y - x)) / 2\"\nw = \"-2*(y - x) / 5\"\n"
             "[initial]\nx = 0\ny = 0\nu = 0\nw = 0\n");
  const FidelityModel model = fidelity_model(made((folder / "two.toml").string()));
  EXPECT_NEAR(model.mass.diagonal()[1] / model.mass.diagonal()[0], 2.5, 1e-9);
  EXPECT_NEAR(model.equilibrium[1], 1.0 / 3, 1e-9);
  ASSERT_EQ(model.modes.size(), 2U);
  EXPECT_NEAR(model.modes[0].omega, std::sqrt(1.45 - std::sqrt(1.45 * 1.45 - 0.6)), 1e-9);
  const Fidelity row = fidelity(find_method("implicit_euler"), model, {.h = 0.2, .verify = true});
  EXPECT_NEAR(row.stiffness_shown, 1, 1e-9) << row.status;
  EXPECT_LT(row.gap, 1e-3);
  expect_modes(row, by_implicit_euler, 1e-5);
}

TEST(ModelFidelity, RefusesWhatHasNothingToShow) {
  const auto refusal = [](const Problem& problem, const FidelityQuestion& question = {.h = 0.1}) {
    try {
      fidelity(find_method("implicit_euler"), fidelity_model(problem), question);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("taken");
  };
  const auto expect = [](const std::string& words, const char* named) {
    EXPECT_NE(words.find(named), std::string::npos) << words;
  };
  expect(refusal(made("robertson")), "robertson has no positions and velocities");
  expect(refusal(made("liver_forced")), "never settles");
  expect(refusal(made("kepler")), "no static equilibrium");
  expect(refusal(made("liver_cubic", {{"k1", -1}})), "has no positive stiffness in its equilibrium");
  EXPECT_EQ(refusal(made("liver_cubic", {{"k1", -1}}, {1, 0})), "taken");  // in the well of x = sqrt(1.25)
  expect(refusal(made("liver_linear", {{"k1", 0}})), "has no positive stiffness in its equilibrium");
  expect(refusal(made("liver_linear"), {.h = 0.1, .ceiling = true}), "leave out --ceiling and --enter");
  expect(refusal(made("liver_linear"), {.h = 0.1, .wanted = 5}), "leave out --ceiling and --enter");
}

}  // namespace
}  // namespace hmax
