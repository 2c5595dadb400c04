/// What rows of an answer show of a material, against runs to rest.
#include "advice/shown_material.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "advice/time_limit.hpp"
#include "core/numbers.hpp"
#include "problems/tissue/body.hpp"
#include "tests/advice/cube.hpp"
#include "tests/says.hpp"

namespace hmax {
namespace {

/// A body whose motions are over within seconds.
Problem damped_body() {
  return make_problem("fem_neo_hookean/press@phantom", {.parameters = {{"alpha", 5}}});
}

/// f . q at the end of a run from the body without load: f the load, at rest after ten seconds.
double sag_of_run(const Problem& problem, const std::string& method, double h) {
  const Eigen::Index n = problem.body->dofs();
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(n);
  Eigen::VectorXd f(n);
  problem.body->force(0, zero, zero, f);
  const RunRecord run = find_method(method).bind(problem).run({.t_end = 10, .h = h}, {});
  EXPECT_EQ(run.outcome, Outcome::reached_end) << method;
  return f.dot(run.y.head(n));
}

/// Stiffness shown as plain stepping shows it.
double stiffness_of_run(const Problem& problem, const std::string& method, double h) {
  return sag_of_run(problem, "symplectic_euler", 5e-4) / sag_of_run(problem, method, h);
}

/// A row that is stable at h.
AdviceRow row_of(const std::string& method, double h) {
  AdviceRow row;
  row.candidate.method = find_method(method);
  row.h = h;
  row.damping_added = row.frequency_shift = std::vector<double>(3, AdviceRow::none);
  row.verdict = AdviceVerdict::inaccurate;
  return row;
}

/// The row after it was told.
AdviceRow told(const Problem& problem, const std::string& method, double h = 0.05) {
  const auto model = material_model(problem, {}, {}, {});
  AdviceRow row = row_of(method, h);
  tell_material({&row, 1}, model.value(), infinity, {});
  return row;
}

TEST(ShownMaterial, OfEveryRowIsThatOfARunToRest) {
  const Problem problem = damped_body();
  AdviceQuestion asked = question(
      60, {"vbd:iterations=2", "vbd:iterations=100", "newton_truncated", "symplectic_euler"}, problem);
  asked.tolerance = 0.3;
  asked.budget = 10;  // no row is too slow on any machine
  const Advice advice = advise(problem, asked);
  ASSERT_EQ(advice.rows.size(), 4U);
  for (const AdviceRow& row : advice.rows) {
    EXPECT_NEAR(row.stiffness_shown, stiffness_of_run(problem, row.candidate.method.id, row.h), 1e-6)
        << row.candidate.words();
    const bool converges = row.candidate.method.parameter("iterations") != 2;
    if (converges) {
      EXPECT_NEAR(row.stiffness_shown, 1, 1e-6) << row.candidate.words();
    }
    EXPECT_EQ(says(row.status, "your stiffness"), row.stiffness_shown < 0.95) << row.candidate.words();
  }
}

TEST(ShownMaterial, IsSaidWhereItIsLessThanThatOfTheModel) {
  const Problem problem = damped_body();
  const double h = 0.05;
  const AdviceRow few = told(problem, "vbd:iterations=3");
  EXPECT_LT(few.stiffness_shown, 0.95);
  EXPECT_TRUE(says(few.status, fmt::format("stable, but {} of your stiffness; at most {} kPa at this setting",
                                           short_number(few.stiffness_shown, 2),
                                           short_number(few.stiffness_ceiling / 1e3, 2))));
  EXPECT_TRUE(says(
      few.status, fmt::format("; 3 substeps of one iteration cost the same and show {}",
                              short_number(stiffness_of_run(problem, "vbd:iterations=1,substeps=3", h), 2))));
  // A body a hundred thousand times as stiff sags as one of the modulus that is the most to be shown, but for
  // what a hundred-thousandth leaves.
  const double E = young_of(problem), factor = 1e5;
  const double sag = sag_of_run(with_stiffness(problem, factor), "vbd:iterations=3", h);
  EXPECT_NEAR(few.stiffness_ceiling, E * sag_of_run(problem, "symplectic_euler", 5e-4) / sag, 0.05 * E);
  const AdviceRow many = told(problem, "vbd:iterations=500");
  EXPECT_GT(many.stiffness_shown, 0.95);
  EXPECT_EQ(many.status, "");
  EXPECT_TRUE(std::isnan(many.stiffness_ceiling));
}

TEST(ShownMaterial, HasTheDampingThatAFormulaHas) {
  // Implicit Euler, nearly: of y'' + 2 zeta omega y' + omega^2 y = 0 a step makes the roots of
  // (1 + 2 zeta omega h + omega^2 h^2) z^2 - 2 (1 + zeta omega h) z + 1.
  const Problem problem = damped_body();
  const double h = 0.01;
  const AdviceRow row = told(problem, "vbd:iterations=500", h);
  const auto model = material_model(problem, {}, {}, {});
  ASSERT_EQ(model->modes.size(), 3U);
  for (std::size_t k = 0; k < 3; ++k) {
    const double w = model->modes[k].omega * h, c = model->modes[k].zeta * w;
    const double a = 1 + 2 * c + w * w, b = 1 + c;
    const std::complex<double> rate = std::log((b + std::sqrt(std::complex<double>(b * b - a, 0))) / a) / h;
    EXPECT_NEAR(row.damping_added[k], -rate.real() / std::abs(rate) - model->modes[k].zeta, 1e-3);
    EXPECT_NEAR(row.frequency_shift[k], std::abs(rate) / model->modes[k].omega - 1, 1e-3);
  }
}

TEST(ShownMaterial, IsOfBodiesThatSettleAlone) {
  const auto knows = [](const Problem& problem) { return material_model(problem, {}, {}, {}).has_value(); };
  EXPECT_TRUE(knows(cube("press")));
  EXPECT_FALSE(knows(cube("breathing")));
  EXPECT_FALSE(knows(make_problem("liver_forced")));
  // Of a third of the load it is that of a third of the load.
  const auto whole = material_model(cube("press"), {}, {}, {});
  Advice advice;
  advice.load_share = 1.0 / 3;
  const auto third = material_model(cube("press"), {}, advice, {});
  EXPECT_LT((third->load - whole->load / 3).norm(), 1e-12 * whole->load.norm());
}

TEST(ShownMaterial, SaysWhatWasNotReached) {
  const Problem problem = damped_body();
  const auto model = material_model(problem, {}, {}, {});
  std::vector<AdviceRow> rows{row_of("vbd:iterations=2", 0.01), row_of("vbd:iterations=3", 0.01)};
  int steps = 0;
  tell_material(rows, *model, infinity, [&] {
    if (++steps > 4) throw OutOfTime{};
  });
  for (const AdviceRow& row : rows) {
    EXPECT_TRUE(std::isnan(row.stiffness_shown));
    EXPECT_EQ(row.status, "what it shows of the stiffness was not sought in time");
  }
}

TEST(SimulatorMethods, HoldThoseOfAFixedNumberOfIterationsOnBodies) {
  const auto fixed = [](const Problem& problem) {
    return std::ranges::count_if(
        candidates(choose_methods(simulator_methods(), {problem}), problem),
        [](const Candidate& each) { return each.method.parameter("iterations").has_value(); });
  };
  EXPECT_EQ(fixed(damped_body()), 6);
  EXPECT_EQ(fixed(make_problem("liver_forced")), 0);
}

}  // namespace
}  // namespace hmax
