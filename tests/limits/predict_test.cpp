/// The predicted largest step of every method, held against runs of its code; and planted mistakes, which the
/// runs must notice.
#include "limits/predict.hpp"

#include <algorithm>
#include <cmath>
#include <ostream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "analysis/amplification/amplification.hpp"
#include "catalogue/methods/catalogue.hpp"
#include "catalogue/models/problems.hpp"
#include "core/errors.hpp"
#include "core/numbers.hpp"
#include "integrators/explicit/tableaux.hpp"
#include "limits/verification.hpp"
#include "tests/limits/planted_tableau.hpp"
#include "tests/says.hpp"

namespace hmax {

void PrintTo(Bound bound, std::ostream* out) { *out << name_of(bound); }

namespace {

/// What prediction and run may differ by.
constexpr double tolerance = 1e-3;

Prediction verified(const Method& method, const Problem& problem, const Linearised& near) {
  Prediction row = predict(method, near);
  verify(row, method, problem, near);
  return row;
}

/// Every finite limit is observed within a part in a thousand, every "unbounded" holds far beyond all time
/// scales. @returns the number of rows that runs have judged
int expect_observed(const std::vector<Method>& methods, const Problem& problem) {
  const Linearised near = linearised(problem);
  int judged = 0;
  for (const Method& method : methods) {
    const Prediction row = verified(method, problem, near);
    const std::string where = problem.id + " " + problem.material + " " + method.id + ": " + row.note;
    EXPECT_NE(row.bound, Bound::unknown) << where;
    EXPECT_NE(row.bound, Bound::model) << where;
    EXPECT_EQ(row.h_max.has_value(), method.fixed_step) << where;
    if (!row.observed) continue;
    ++judged;
    EXPECT_TRUE(row.observed->agrees)
        << where << " observed " << row.observed->h_max << " s, predicted " << *row.h_max << " s";
    if (std::isfinite(*row.h_max)) {
      EXPECT_EQ(row.bound, Bound::stability) << where;
      EXPECT_LE(std::abs(row.observed->gap), tolerance) << where;
    } else {
      EXPECT_EQ(row.observed->h_max, infinity) << where;
    }
  }
  return judged;
}

TEST(Prediction, IsWhatEveryMethodDoesOnTheBenchmarkLivers) {
  for (const char* material : {"male_slim:light", "female_fat:heavy", "male_normal:heavy"}) {
    const Problem problem = make_problem("liver_benchmark", {.material = material});
    const std::vector<Method> all = choose_methods({"all"}, {problem});
    EXPECT_EQ(expect_observed(all, problem), std::ranges::count_if(all, &Method::fixed_step)) << material;
  }
}

TEST(Prediction, IsWhatMethodsDoWithoutDamping) {
  const Problem problem = make_problem("liver_linear", {.parameters = {{"c", 0}}});
  const Linearised near = linearised(problem);
  int unstable = 0, bounded = 0;
  for (const Method& method : choose_methods({"explicit_runge_kutta", "adams", "structural"}, {problem})) {
    if (!method.fixed_step) continue;
    Prediction row = predict(method, near);
    // A part in a thousand beyond their limits these amplify by less than 3e-8 a step, which no run of
    // reasonable length shows.
    if (method.id == "tsitouras_54" || method.id == "abm_pece_5") {
      ASSERT_EQ(row.bound, Bound::stability);
      const Growth growth = method.amplification->of_eigenmode(Eigenmode(row.limiting->lambda));
      EXPECT_LT(growth.spectral_radius(1.001 * *row.h_max) - 1, 3e-8) << method.id;
      EXPECT_GT(growth.spectral_radius(1.5 * *row.h_max) - 1, 3e-8) << method.id;
      continue;
    }
    verify(row, method, problem, near);
    // What every step amplifies has no limit that a run could show.
    if (row.bound == Bound::every_step) {
      EXPECT_EQ(*row.h_max, 0) << method.id;
      EXPECT_FALSE(row.observed) << method.id;
      EXPECT_NE(row.note.find("every step"), std::string::npos);
      ++unstable;
      continue;
    }
    ASSERT_TRUE(row.observed) << method.id;
    EXPECT_TRUE(row.observed->agrees) << method.id << " " << *row.h_max << " " << row.observed->h_max;
    if (std::isfinite(*row.h_max)) {
      EXPECT_LE(std::abs(row.observed->gap), tolerance) << method.id;
    }
    ++bounded;
  }
  // Explicit Euler and the three rules of two stages; Bashforth 1, 2, 5, 6; the pairs of orders 3 and 4.
  EXPECT_EQ(unstable, 12);
  EXPECT_EQ(bounded, 25);
}

TEST(Prediction, IsWhatMethodsDoOnAChainOfManyModes) {
  const Problem problem = make_problem("spring_chain", {.parameters = {{"n", 4}}});
  const std::vector<Method> methods = choose_methods(
      {"explicit_runge_kutta", "stabilised", "structural", "adams_bashforth_3", "abm_pece_4", "abm_pec_2"},
      {problem});
  EXPECT_EQ(expect_observed(methods, problem), static_cast<int>(methods.size()));

  const Problem undamped = make_problem("spring_chain", {.parameters = {{"n", 4}, {"c", 0}}});
  EXPECT_EQ(
      expect_observed(choose_methods({"structural", "rk4", "abm_pece_2", "implicit_midpoint"}, {undamped}),
                      undamped),
      11);
}

/// M q'' + C q' + K q = 0 of any matrices.
struct Structure {
  using State = Eigen::VectorXd;
  using Dofs = Eigen::VectorXd;
  using DofMatrix = Eigen::MatrixXd;
  using Jacobian = Eigen::MatrixXd;
  static constexpr bool autonomous = true;
  Eigen::VectorXd m;
  Eigen::MatrixXd K, C;
  [[nodiscard]] Eigen::Index dim() const { return 2 * m.size(); }
  [[nodiscard]] Eigen::Index dofs() const { return m.size(); }
  void rhs(double, const State& y, State& dydt) const {
    const Eigen::Index n = m.size();
    dydt.head(n) = y.tail(n);
    dydt.tail(n) = -(K * y.head(n) + C * y.tail(n)).cwiseQuotient(m);
  }
  void jacobian(double, const State&, Jacobian& J) const {
    const Eigen::Index n = m.size();
    J.setZero(2 * n, 2 * n);
    J.topRightCorner(n, n).setIdentity();
    J.bottomLeftCorner(n, n) = -(m.cwiseInverse().asDiagonal() * K);
    J.bottomRightCorner(n, n) = -(m.cwiseInverse().asDiagonal() * C);
  }
  [[nodiscard]] Dofs mass() const { return m; }
  void force(double, const Dofs& q, const Dofs& v, Dofs& f) const { f = -K * q - C * v; }
  void stiffness(double, const Dofs&, const Dofs&, DofMatrix& stiffness) const { stiffness = K; }
  void damping(double, const Dofs&, const Dofs&, DofMatrix& damping) const { damping = C; }
};

Problem problem_of(const Structure& structure) {
  const Eigen::Index dim = structure.dim();
  return {.id = "structure",
          .states = std::vector<std::string>(static_cast<std::size_t>(dim), "y"),
          .y0 = Eigen::VectorXd::Zero(dim),
          .t_end = 1,
          .system = AnySystem(structure)};
}

TEST(Prediction, IsWhatMethodsOfPositionsAndVelocitiesDoWhereDampingCouplesTheModes) {
  std::vector<Method> methods;
  for (const char* name : {"symplectic_euler", "velocity_verlet", "stormer_verlet", "central_difference",
                           "explicit_newmark", "newmark", "hht_alpha", "generalized_alpha",
                           "newmark:beta=0.1", "newmark:beta=0.1,gamma=0.6", "newmark:beta=0.1,gamma=0.45"})
    methods.push_back(find_method(name));
  std::srand(7);
  for (const auto& [n, size] : {std::pair<Eigen::Index, double>{3, 0.1}, {4, 1.5}, {5, 0.3}}) {
    // A chain between walls, and dampers across it.
    Structure chain{.m = Eigen::VectorXd::LinSpaced(n, 1, 2),
                    .K = 20 * Eigen::MatrixXd::Identity(n, n),
                    .C = Eigen::MatrixXd::Zero(n, n)};
    chain.K.diagonal(1).setConstant(-10);
    chain.K.diagonal(-1).setConstant(-10);
    const Eigen::MatrixXd A = Eigen::MatrixXd::Random(n, n);
    chain.C = size * A * A.transpose();
    const Problem problem = problem_of(chain);
    const Linearised near = linearised(problem);
    ASSERT_EQ(near.point.model.mechanical->damping, Damping::general);
    EXPECT_EQ(expect_observed(methods, problem), static_cast<int>(methods.size()));
    const Prediction row = predict(methods.front(), near);
    EXPECT_TRUE(row.coupled);
    EXPECT_NE(row.state.find("taken together"), std::string::npos) << row.state;
    ASSERT_TRUE(row.limiting);
    EXPECT_LT(row.limiting->lambda.real(), 0);
  }
}

TEST(Prediction, OfStepsInPartsIsThatOfAPartTimesTheirNumberAsRunsShow) {
  const Eigen::Index n = 3;
  Structure chain{
      .m = Eigen::VectorXd::Ones(n), .K = 20 * Eigen::MatrixXd::Identity(n, n), .C = Eigen::MatrixXd(n, n)};
  chain.C << 0.3, 0.1, 0, 0.1, 0.2, 0, 0, 0, 0.4;
  const Problem problem = problem_of(chain);
  const Linearised near = linearised(problem);
  for (const char* name : {"symplectic_euler", "stormer_verlet", "rk4", "newmark"}) {
    const Method method = find_method(std::string(name) + ":substeps=3");
    const Prediction whole = verified(find_method(name), problem, near),
                     row = verified(method, problem, near);
    EXPECT_EQ(row.bound, whole.bound) << name;
    EXPECT_DOUBLE_EQ(*row.h_max, 3 * *whole.h_max) << name;
    ASSERT_TRUE(row.observed && row.observed->confirms()) << name << row.note;
    if (std::isinf(*row.h_max)) continue;
    EXPECT_DOUBLE_EQ(row.observed->h_max, 3 * whole.observed->h_max) << name;
    const auto left_of_a_push = [&](double share) {
      Problem pushed = problem;
      pushed.y0 = Eigen::VectorXd::Constant(2 * n, 1e-3);
      const double h = share * *row.h_max;
      return method.bind(pushed).run({.t_end = 3000 * h, .h = h}, {}).y.norm();
    };
    EXPECT_LT(left_of_a_push(0.99), 1e-3) << name;
    EXPECT_FALSE(left_of_a_push(1.01) < 1) << name;
  }
}

// m 1.45, c 8, k 6.7: zeta 1.28. Three forms of Verlet's method, three limits.
TEST(Prediction, OfAnOverdampedLiverHasItsFrequencyBothRatesAndALimitForEachForm) {
  const Problem problem = make_problem("liver_benchmark", {.material = "male_fat"});
  const double m = 1.45, c = 8, k = 6.7, omega = std::sqrt(k / m), zeta = c / (2 * std::sqrt(k * m));
  const double spread = std::sqrt(c * c - 4 * k * m);
  const Linearised near = linearised(problem);
  for (const auto& [method, omega_h] : {std::pair{"velocity_verlet", 2 * (std::sqrt(1 + zeta * zeta) - zeta)},
                                        {"stormer_verlet", 2 * (std::sqrt(1 + 4 * zeta * zeta) - 2 * zeta)},
                                        {"explicit_newmark", 2.0},
                                        {"explicit_euler", 4 * m * omega / (c + spread)}}) {
    const Prediction row = verified(find_method(method), problem, near);
    EXPECT_NEAR(row.h_max.value() * omega, omega_h, 1e-12) << method;
    EXPECT_TRUE(row.observed->agrees) << method;
    ASSERT_TRUE(row.limiting && row.limiting->rates) << method;
    EXPECT_NEAR(row.limiting->lambda.real(), -(c + spread) / (2 * m), 1e-12) << method;
    EXPECT_NEAR(row.limiting->omega.value(), omega, 1e-12) << method;
    EXPECT_NEAR(row.limiting->zeta.value(), zeta, 1e-12) << method;
    EXPECT_NEAR((*row.limiting->rates)[0], (c + spread) / (2 * m), 1e-12) << method;
    EXPECT_NEAR((*row.limiting->rates)[1], (c - spread) / (2 * m), 1e-12) << method;
  }
  // Of one equation of first order nothing but its rate is known.
  const Problem decay = make_problem("dahlquist");
  const Prediction row = predict(find_method("explicit_euler"), linearised(decay));
  ASSERT_TRUE(row.limiting);
  EXPECT_FALSE(row.limiting->omega || row.limiting->zeta || row.limiting->rates);
}

TEST(Prediction, NamesTheModeThatSetsTheStepWhichNeedNotBeTheLargestOfTheSpectrum) {
  const Problem problem = make_problem("spring_chain", {.parameters = {{"n", 6}}});
  const Linearised near = linearised(problem);
  const Prediction row = predict(find_method("explicit_euler"), near);
  ASSERT_TRUE(row.h_max && row.limiting);
  double smallest = infinity, fastest = 0;
  for (const ModeMargin& margin : row.modes) {
    // h < -2 Re(lambda) / |lambda|^2
    EXPECT_NEAR(margin.h_max * std::norm(margin.mode.lambda), -2 * margin.mode.lambda.real(),
                1e-9 * std::abs(margin.mode.lambda));
    smallest = std::min(smallest, margin.h_max);
    fastest = std::max(fastest, margin.mode.omega.value());
  }
  EXPECT_EQ(*row.h_max, smallest);
  // With damping in proportion to stiffness -2 Re / |lambda|^2 = c / k is the same for all modes: whichever
  // is named, its margin is the limit.
  EXPECT_NEAR(*row.h_max, 0.05 / 100, 1e-12);
  EXPECT_LE(row.limiting->omega, fastest);
}

// ---- planted mistakes

/// Whether a run of `code` contradicts the prediction of `claimed`.
bool contradicts(const Method& code, const Method& claimed, const Problem& problem, const Linearised& near) {
  Prediction row = predict(claimed, near);
  // What a verification knows beside the prediction is what is claimed, too.
  Method run = code;
  run.amplification = claimed.amplification;
  verify(row, run, problem, near);
  return !row.observed->agrees || std::abs(row.observed->gap) > tolerance;
}

template <class Known>
struct PlantedMistake : testing::Test {};
using Judged = testing::Types<tableaux::Rk4, tableaux::BogackiShampine32, tableaux::DormandPrince54,
                              tableaux::Fehlberg78>;
struct JudgedName {
  template <class Known>
  static std::string GetName(int) {
    return std::string(Known::id);
  }
};
TYPED_TEST_SUITE(PlantedMistake, Judged, JudgedName);

TYPED_TEST(PlantedMistake, InAnyCoefficientThatTheStepReadsIsNoticedByRunning) {
  // One model swings, the other creeps: what leaves the limit of one where it is moves that of the other.
  std::vector<Problem> problems;
  std::vector<Linearised> near;
  for (const double c : {1.5, 8.0}) {
    problems.push_back(make_problem("liver_linear", {.parameters = {{"c", c}}}));
    near.push_back(linearised(problems.back()));
  }
  const auto noticed_by_running = [&](const Method& code, const Method& claimed) {
    return contradicts(code, claimed, problems[0], near[0]) ||
           contradicts(code, claimed, problems[1], near[1]);
  };
  const Method claimed = find_method(TypeParam::id);
  const RuntimeTableau right = at_run_time<TypeParam>();
  const std::size_t s = right.stages();
  const std::vector<bool> used = stages_used(right);
  // The tableau that is carried along as data steps as the one the compiler knows.
  EXPECT_FALSE(noticed_by_running(planted_method(right), claimed));

  int noticed = 0, slight = 0, unread = 0;
  const auto plant = [&](long double& (*at)(RuntimeTableau&, std::size_t), std::size_t index, bool is_read,
                         const std::string& name) {
    if (RuntimeTableau copy = right; at(copy, index) == 0) return;
    const auto seen = [&](long double factor) {
      RuntimeTableau wrong = right;
      at(wrong, index) *= factor;
      return noticed_by_running(planted_method(wrong), claimed);
    };
    // Some coefficients of long tableaux hardly move the limit: twentieths of them move it by less than the
    // thousandth that a verification tells, halves do not.
    const bool at_once = seen(1.05L);
    EXPECT_EQ(at_once || seen(1.5L), is_read) << name;
    (!is_read ? unread : at_once ? noticed : slight) += 1;
  };
  for (std::size_t i = 0; i < s; ++i) {
    plant([](RuntimeTableau& t, std::size_t k) -> long double& { return t.b[k]; }, i, true,
          "b " + std::to_string(i + 1));
    // A stage that only the error estimate reads changes nothing of the step.
    for (std::size_t j = 0; j < i; ++j)
      plant([](RuntimeTableau& t, std::size_t k) -> long double& { return t.a[k]; }, i* s + j, used[i],
            "a " + std::to_string(i + 1) + " " + std::to_string(j + 1));
  }
  EXPECT_GE(noticed, 5);
  // Of the 54 that Fehlberg's step reads.
  EXPECT_LE(slight, TypeParam::tableau.stages > 10 ? 5 : 0);
  // What only the error estimate reads, or the first stage of the next step.
  EXPECT_EQ(unread > 0, std::ranges::count(used, false) > 0);
}

TEST(Prediction, OfANeighbourIsContradictedByTheCode) {
  const Problem damped = make_problem("liver_linear", {.parameters = {{"c", 1.5}}});
  const Problem undamped = make_problem("liver_linear", {.parameters = {{"c", 0}}});
  const Linearised near_damped = linearised(damped), near_undamped = linearised(undamped);
  for (const auto& [code, claimed] : {std::pair{"adams_bashforth_3", "adams_bashforth_2"},
                                      {"adams_bashforth_3", "adams_bashforth_4"},
                                      {"abm_pece_3", "abm_pec_3"},
                                      {"abm_pece_4", "abm_pece_3"},
                                      {"rk4", "rk3_kutta"},
                                      {"velocity_verlet", "stormer_verlet"},
                                      {"velocity_verlet", "explicit_newmark"},
                                      {"stormer_verlet", "central_difference"},
                                      {"stormer_verlet", "symplectic_euler"}})
    EXPECT_TRUE(contradicts(find_method(code), find_method(claimed), damped, near_damped))
        << code << " as " << claimed;
  const Method sixth = find_method("newmark:beta=0.16666666666666666");
  EXPECT_FALSE(contradicts(sixth, sixth, undamped, near_undamped));
  // 0.1665 has a limit that is lower by 0.09995 %, which no run at 0.999 of this one tells.
  for (const char* beta : {"0.16", "0.1664", "0.17"}) {
    const Method code = find_method(std::string("newmark:beta=") + beta);
    EXPECT_TRUE(contradicts(code, sixth, undamped, near_undamped)) << beta;
  }
  // "Unbounded" is as easily refuted.
  EXPECT_TRUE(contradicts(find_method("newmark:beta=0.24"), find_method("newmark"), undamped, near_undamped));
  EXPECT_TRUE(contradicts(find_method("rk4"), find_method("implicit_euler"), damped, near_damped));
}

// ---- what is no limit of a step

TEST(Prediction, SaysWhatElseLimitsTheStep) {
  const auto bound = [](const char* method, const Problem& problem) {
    return predict(find_method(method), linearised(problem));
  };
  const auto cubic = [](double c) { return make_problem("liver_cubic", {.parameters = {{"c", c}}}); };
  // The model grows by itself: no step is to blame.
  const Prediction grows = bound("rk4", cubic(-0.2));
  EXPECT_EQ(grows.bound, Bound::model);
  EXPECT_FALSE(grows.h_max);
  ASSERT_TRUE(grows.limiting);
  EXPECT_GT(grows.limiting->lambda.real(), 0);
  EXPECT_LT(grows.limiting->zeta.value(), 0);
  EXPECT_NE(grows.note.find("positive real part"), std::string::npos);

  EXPECT_EQ(bound("rk2_heun", cubic(0)).bound, Bound::every_step);
  EXPECT_EQ(bound("rk2_heun", cubic(2)).bound, Bound::stability);
  // Nonlinear equations have to be solved; linear ones are.
  EXPECT_EQ(bound("implicit_euler", cubic(2)).bound, Bound::newton);
  EXPECT_EQ(bound("newmark", cubic(2)).bound, Bound::newton);
  EXPECT_EQ(bound("rosenbrock_23", cubic(2)).bound, Bound::accuracy);
  const Problem linear = make_problem("liver_linear");
  EXPECT_EQ(bound("implicit_euler", linear).bound, Bound::accuracy);
  EXPECT_EQ(*bound("implicit_euler", linear).h_max, infinity);

  EXPECT_EQ(bound("adams_pece", linear).bound, Bound::error_control);
  EXPECT_FALSE(bound("adams_pece", linear).h_max);
  const Prediction unknown = bound("symplectic_euler", make_problem("van_der_pol"));
  EXPECT_EQ(unknown.bound, Bound::unknown);
  EXPECT_NE(unknown.note.find("positions and velocities"), std::string::npos);
}

TEST(Prediction, AsksThePointForCostlyFactsOnlyWhereTheMethodNeedsThem) {
  Linearised near = linearised(make_problem("liver_linear"));
  ASSERT_TRUE(near.point.radius_bound);
  const double bound = near.point.radius_bound();
  EXPECT_EQ(predict(find_method("rkc_2"), near).modes.front().told.radius, bound);
  int radii = 0, models = 0;
  LinearModel elsewhere = near.point.model;
  near.point.radius_bound = [&] {
    ++radii;
    return 2 * bound;
  };
  near.point.model_at = [&](const Eigen::VectorXd&) {
    ++models;
    return elsewhere;
  };
  const auto row_of = [&](const char* id) { return predict(find_method(id), near.point, near.modes); };
  EXPECT_EQ(row_of("rk4").bound, Bound::stability);
  EXPECT_EQ(radii + models, 0);
  EXPECT_EQ(row_of("rkc_2").modes.front().told.radius, 2 * bound);
  EXPECT_EQ(radii, 1);
  EXPECT_EQ(models, 0);
  EXPECT_EQ(row_of("implicit_euler").bound, Bound::accuracy);
  EXPECT_EQ(models, 0) << "an oscillator says that it is linear";
  near.point.linearity = Linearity::unknown;
  EXPECT_EQ(row_of("implicit_euler").bound, Bound::accuracy);
  const int same = std::exchange(models, 0);
  EXPECT_GE(same, 2) << "in both directions";
  elsewhere = linearised(make_problem("liver_linear", {.parameters = {{"k1", 80}}})).point.model;
  EXPECT_EQ(row_of("implicit_euler").bound, Bound::newton);
  EXPECT_EQ(models, 1) << "the first one that differs is enough";
  EXPECT_EQ(radii, 1);
}

TEST(Prediction, OfACubicSpringAtRestIsThatOfItsTangent) {
  const Problem problem = make_problem("liver_cubic", {.parameters = {{"c", 2}}});
  const Linearised near = linearised(problem);
  EXPECT_TRUE(near.point.at_equilibrium);
  EXPECT_NE(near.point.state.find("equilibrium (0, 0)"), std::string::npos) << near.point.state;
  for (const char* method : {"explicit_euler", "rk4", "adams_bashforth_3", "stormer_verlet"}) {
    const Prediction row = verified(find_method(method), problem, near);
    ASSERT_TRUE(row.observed) << method;
    EXPECT_TRUE(row.observed->agrees) << method;
    EXPECT_LE(std::abs(row.observed->gap), tolerance) << method;
  }
  // Away from rest the tangent is stiffer and the step smaller.
  const Linearised away = linearised(problem, 0, Eigen::Vector2d(1, 0));
  EXPECT_LT(*predict(find_method("rk4"), away).h_max, *predict(find_method("rk4"), near).h_max);
}

TEST(Prediction, OfADrivenProblemLooksAtTheFreeMotion) {
  const Problem problem = make_problem("liver_forced");
  const Linearised near = linearised(problem);
  for (const char* method : {"explicit_euler", "rk4", "abm_pece_2", "symplectic_euler"}) {
    const Prediction row = verified(find_method(method), problem, near);
    ASSERT_TRUE(row.observed) << method;
    EXPECT_TRUE(row.h_max && std::isfinite(*row.h_max)) << method;
    // It does not stay where it was linearised, and the row says so.
    EXPECT_TRUE(row.observed->agrees || row.note.find("force") != std::string::npos) << method;
    // The force of a linear model moves it, and changes nothing.
    const Problem linear = make_problem("liver_benchmark");
    const Prediction same = verified(find_method(method), linear, linearised(linear));
    ASSERT_TRUE(same.observed) << method;
    EXPECT_TRUE(same.observed->agrees) << method;
    EXPECT_LE(std::abs(same.observed->gap), 1e-3) << method;
  }
}

// ---- models of which nothing can be said

/// y' = f(y) in two numbers, with the Jacobian it says it has.
struct Slope {
  using State = Eigen::Vector2d;
  using Jacobian = Eigen::Matrix2d;
  static constexpr bool autonomous = true;
  double a, b;
  [[nodiscard]] static Eigen::Index dim() { return 2; }
  void rhs(double, const State& y, State& dydt) const { dydt = State(-y[0], -2 * y[1]); }
  void jacobian(double, const State&, Jacobian& J) const { J << a, 0, 0, b; }
};

/// x'' = -x with a mass that is told to be something else.
struct Weight {
  using State = Eigen::Vector2d;
  using Dofs = Eigen::Matrix<double, 1, 1>;
  using DofMatrix = Eigen::Matrix<double, 1, 1>;
  static constexpr bool autonomous = true;
  double m;
  [[nodiscard]] static Eigen::Index dim() { return 2; }
  [[nodiscard]] static Eigen::Index dofs() { return 1; }
  void rhs(double, const State& y, State& dydt) const { dydt = State(y[1], -y[0]); }
  [[nodiscard]] Dofs mass() const { return Dofs(m); }
  void force(double, const Dofs& q, const Dofs&, Dofs& f) const { f = -q; }
  void stiffness(double, const Dofs&, const Dofs&, DofMatrix& K) const { K(0, 0) = 1; }
  void damping(double, const Dofs&, const Dofs&, DofMatrix& C) const { C(0, 0) = 0; }
};

/// x' = 1 + x^2, which rests nowhere.
struct Runaway {
  using State = Eigen::Vector2d;
  static constexpr bool autonomous = true;
  [[nodiscard]] static Eigen::Index dim() { return 2; }
  void rhs(double, const State& y, State& dydt) const { dydt = State(1 + y[0] * y[0], -y[1]); }
};

/// y' is no number, although the Jacobian is there.
struct NoRate {
  using State = Eigen::Vector2d;
  using Jacobian = Eigen::Matrix2d;
  [[nodiscard]] static Eigen::Index dim() { return 2; }
  void rhs(double, const State& y, State& dydt) const { dydt = State(std::nan(""), -y[1]); }
  void jacobian(double, const State&, Jacobian& J) const { J = -Jacobian::Identity(); }
};

Problem problem_of(AnySystem system) {
  return {.id = "own",
          .states = {"x", "v"},
          .y0 = Eigen::Vector2d(0.5, 1),
          .t_end = 1,
          .system = std::move(system)};
}

std::string refusal(const AnySystem& system) {
  return error_of<InputError>([&] { linearised(problem_of(system)); });
}

TEST(Linearised, RefusesAJacobianThatIsNoNumberAndAMassThatIsNone) {
  EXPECT_EQ(refusal(AnySystem(Slope{-1, -2})), "");
  EXPECT_TRUE(says(refusal(AnySystem(Slope{-1, std::nan("")})), "row 2, column 2"));
  EXPECT_TRUE(says(refusal(AnySystem(Slope{infinity, -2})), "row 1, column 1"));
  for (const double mass : {0.0, -1.0, std::nan("")})
    EXPECT_TRUE(says(refusal(AnySystem(Weight{mass})), "every mass must be positive and finite"));
  EXPECT_EQ(refusal(AnySystem(Weight{2})), "");
}

TEST(Linearised, RefusesRatesThatAreNoNumbers) {
  EXPECT_TRUE(says(refusal(AnySystem(NoRate{})), "the rates of own in its initial state are not finite"));
}

TEST(Verification, EndsWhereTheWatcherThrows) {
  const Problem problem = problem_of(AnySystem(Slope{-1, -2}));
  const Linearised near = linearised(problem);
  const Method rk4 = find_method("rk4");
  Prediction row = predict(rk4, near);
  int steps = 0;
  const auto watch = [&] {
    if (++steps == 20) throw std::runtime_error("enough");
  };
  EXPECT_THROW(verify(row, rk4, problem, near, watch), std::runtime_error);
  EXPECT_EQ(steps, 20);
  EXPECT_FALSE(row.observed);
}

TEST(Linearised, SaysThatThereIsNoPlaceOfRestAndTakesTheStart) {
  const Linearised near = linearised(problem_of(AnySystem(Runaway{})));
  EXPECT_FALSE(near.point.at_equilibrium);
  EXPECT_EQ(near.point.state.rfind("initial state (0.5, 1)", 0), 0U) << near.point.state;
  EXPECT_NE(near.point.state.find("equilibrium"), std::string::npos) << near.point.state;
}

TEST(Linearised, IsTheRestThatConservationLeadsToWhichTheRunThenShows) {
  // Robertson's reaction ends in the third substance, where 1e4 y3 sets the step of explicit methods.
  const Problem problem = make_problem("robertson");
  const Linearised near = linearised(problem);
  EXPECT_NE(near.point.state.find("reachable"), std::string::npos) << near.point.state;
  const Prediction row = predict(find_method("explicit_euler"), near);
  ASSERT_TRUE(row.h_max);
  EXPECT_NEAR(*row.h_max, 2 / (1e4 + 0.04), 1e-8);
  const Prediction seen = verified(find_method("explicit_euler"), problem, near);
  ASSERT_TRUE(seen.observed);
  EXPECT_TRUE(seen.observed->confirms());
  EXPECT_LE(std::abs(seen.observed->gap), tolerance);
}

TEST(Linearised, WithoutAJacobianTakesDifferencesAndSaysSo) {
  const Linearised near = linearised(problem_of(AnySystem(Runaway{})));
  EXPECT_NE(near.point.state.find("difference"), std::string::npos) << near.point.state;
}

}  // namespace
}  // namespace hmax
