/// Files of formulas as problems: their keys, the order of their states, their time.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "catalogue/methods/catalogue.hpp"
#include "catalogue/models/model.hpp"
#include "catalogue/models/problem_file.hpp"
#include "catalogue/models/problems.hpp"
#include "core/errors.hpp"
#include "limits/linearised_problem.hpp"
#include "limits/predict.hpp"
#include "tests/results/scratch.hpp"
#include "tests/says.hpp"

namespace hmax {
namespace {

/// A file for the time of one test.
class File {
 public:
  explicit File(const std::string& text) { write_text(path(), text); }
  [[nodiscard]] Problem problem(const ProblemSettings& settings = {}) const {
    return make_problem(path().string(), settings);
  }

 private:
  [[nodiscard]] std::filesystem::path path() const { return folder_ / "model.toml"; }
  Scratch folder_;
};

std::string refusal_of_problem(const std::string& problem_lines) {
  return error_of<InputError>([&] {
    problem_from(parse_toml(
        "[problem]\n" + problem_lines + "\n[equations]\nx = \"v\"\nv = \"-x\"\n[initial]\nx = 1\nv = 0\n",
        "my.toml"));
  });
}

TEST(ProblemKind, IsToldFromTheNameWhateverTheFolder) {
  const auto is = [](const char* name, ProblemKind kind) { EXPECT_EQ(problem_kind(name), kind) << name; };
  is("van_der_pol", ProblemKind::listed);
  is("no_such_model", ProblemKind::listed);
  is("fem_green@liver", ProblemKind::body);
  is("mass_spring/press@/jobs/build@2/organ.msh:refine=1", ProblemKind::body);
  is("/jobs/build@2/pendulum.toml", ProblemKind::formulas);
  is("matrices:stiffness=/jobs/build@2/K.mtx,mass=M.mtx", ProblemKind::matrices);
  is("plugin:/jobs/build@2/model.so:pendulum:of.toml", ProblemKind::plugin);
}

TEST(FormulaProblem, KeysOfTheFileAreChecked) {
  EXPECT_EQ(refusal_of_problem("t0 = 2\nt_end = 3\npositions = [\"x\"]\nvelocities = [\"v\"]"), "");
  EXPECT_TRUE(
      says(refusal_of_problem("t0 = 2\nt_end = 1"), "t_end is 1 but must lie after the start, t0 = 2"));
  EXPECT_TRUE(says(refusal_of_problem("t_end = -5"), "must lie after the start, t0 = 0"));
  EXPECT_TRUE(says(refusal_of_problem("positions = \"x\""), "positions must be a list of states in quotes"));
  EXPECT_TRUE(says(refusal_of_problem("velocities = []"), "velocities must be a list of states in quotes"));
  EXPECT_TRUE(says(refusal_of_problem("position = [\"x\"]"), "did you mean 'positions'?"));
}

TEST(FormulaProblem, AFileStartsAHundredSecondsBeforeItsEnd) {
  const auto definition =
      problem_from(parse_toml("[problem]\nt0 = -3\n[equations]\nx = \"-x\"\n[initial]\nx = 1\n", "my.toml"));
  EXPECT_EQ(definition.t0, -3);
  EXPECT_EQ(definition.t_end, 97);
}

constexpr const char* spring_damper = R"(
[equations]
s = "v"
v = "-k*s - d*v"
[parameters]
k = 0.3
d = 0.1
[initial]
s = 1
v = 0
)";

TEST(FormulaProblem, LimitsOfStructuralMethodsAreThoseOfTheOscillator) {
  const Problem problem = File(spring_damper).problem();
  const Linearised near = linearised(problem);
  // h k = -c + sqrt(c^2 + 4 k m) (symplectic_euler), m = 1.
  const double k = 0.3, c = 0.1;
  const Prediction euler = predict(find_method("symplectic_euler"), near.point, near.modes);
  ASSERT_TRUE(euler.h_max);
  EXPECT_NEAR(*euler.h_max, (std::sqrt(c * c + 4 * k) - c) / k, 1e-12);
  EXPECT_NEAR(*euler.h_max, 3.3333, 1e-4);
  EXPECT_TRUE(std::isinf(*predict(find_method("newmark"), near.point, near.modes).h_max));
}

/// Two oscillators, x'' = -4 x and y'' = -9 y + x, their velocities first and among each other.
constexpr const char* mixed = R"(
[problem]
t_end = 1
[equations]
w = "-9*y + x"
x = "v"
v = "-4*x"
y = "w"
[initial]
w = 0.5
x = 1
v = -2
y = 3
)";

TEST(FormulaProblem, UsersKeepTheOrderOfTheirStates) {
  const File file(mixed);
  const Problem problem = file.problem();
  EXPECT_EQ(problem.states, (std::vector<std::string>{"x", "y", "v", "w"}));
  EXPECT_EQ(problem.y0, Eigen::Vector4d(1, 3, -2, 0.5));
  EXPECT_EQ(problem.shown.in_order(problem.states), (std::vector<std::string>{"w", "x", "v", "y"}));
  EXPECT_EQ(problem.shown.state(problem.y0), Eigen::Vector4d(0.5, 1, -2, 3));
  EXPECT_EQ(start_in_words(problem), "0.5,1,-2,3");
  // --y0 is in the order of the file.
  const Problem other = file.problem({.y0 = {10, 20, 30, 40}});
  EXPECT_EQ(other.y0, Eigen::Vector4d(20, 40, 30, 10));
  EXPECT_EQ(problem.shown.own_state(problem.shown.state(problem.y0)), problem.y0);
  EXPECT_TRUE(says(error_of<InputError>([&] { (void)file.problem({.y0 = {1}}); }), "4 states (w, x, v, y)"));
}

TEST(FormulaProblem, StructuralMethodsRunWhateverTheOrder) {
  const Problem problem = File(mixed).problem();
  for (const char* id : {"newmark", "velocity_verlet", "central_difference", "generalized_alpha", "rk4"}) {
    SCOPED_TRACE(id);
    const Method method = find_method(id);
    ASSERT_TRUE(suits(method, problem));
    const RunRecord end = method.bind(problem).run({.t_end = 1, .h = 1e-4}, {});
    // x = cos 2t - sin 2t.
    EXPECT_NEAR(end.y[0], std::cos(2.0) - std::sin(2.0), 1e-6);
    EXPECT_NEAR(end.y[2], -2 * std::sin(2.0) - 2 * std::cos(2.0), 1e-6);
  }
}

TEST(FormulaProblem, RunsBeginAtTheirStartAndGoBackwards) {
  const File file("[problem]\nt0 = 2\nt_end = 3\n[equations]\nx = \"2*t\"\n[initial]\nx = 4\n");
  const Method rk4 = find_method("rk4");
  // x = t^2.
  const Problem forwards = file.problem();
  EXPECT_EQ(forwards.t_end, 1);
  EXPECT_NEAR(rk4.bind(forwards).run({.t_end = 1, .h = 0.1}, {}).y[0], 9, 1e-12);
  EXPECT_EQ(forwards.shown.time(1), 3);
  ProblemSettings settings;
  settings.t_end = 0.5;
  const Problem backwards = file.problem(settings);
  EXPECT_EQ(backwards.t_end, 1.5);
  EXPECT_EQ(backwards.shown.time(1.5), 0.5);
  EXPECT_EQ(backwards.shown.own_time(0.5), 1.5);
  EXPECT_NEAR(rk4.bind(backwards).run({.t_end = 1.5, .h = 0.1}, {}).y[0], 0.25, 1e-12);
  settings = {};
  settings.t0 = 10;
  EXPECT_THROW((void)file.problem({.t0 = 3}), InputError) << "t_end is the start";
  settings.t_end = 12;
  EXPECT_NEAR(rk4.bind(file.problem(settings)).run({.t_end = 2, .h = 0.1}, {}).y[0], 4 + 144 - 100, 1e-10);
  EXPECT_THROW((void)make_problem("liver_forced", settings), InputError);
}

TEST(FormulaProblem, BreakpointsCountFromTheStart) {
  const std::string text =
      "[problem]\nt0 = 1\nt_end = 4\n[equations]\nx = \"t < 3 ? 1 : t < 3.5 ? 0 : 2\"\n[initial]\nx = 4\n";
  const File file(text);
  EXPECT_EQ(std::get<AnySystem>(file.problem().system).breakpoints(0, 3), (std::vector<double>{2, 2.5}));
  ProblemSettings settings;
  settings.t0 = 4;
  settings.t_end = 1;
  EXPECT_EQ(std::get<AnySystem>(file.problem(settings).system).breakpoints(0, 3),
            (std::vector<double>{0.5, 1}));
}

TEST(FormulaProblem, LimitsOfRatesBesideLargeConstants) {
  // Carriers in silicon: n' = G - n / tau; rk4 is stable for h / tau < 2.785293563405282.
  const Problem carriers =
      File("[equations]\nn = \"G - n/tau\"\n[parameters]\nG = 1e26\ntau = 1e-6\n[initial]\nn = 0\n")
          .problem();
  EXPECT_EQ(std::get<AnySystem>(carriers.system).linearity(), Linearity::linear);
  const Linearised near = linearised(carriers);
  EXPECT_TRUE(near.point.at_equilibrium);
  EXPECT_NEAR(near.point.model.y[0], 1e20, 1e6);
  EXPECT_NEAR(*predict(find_method("rk4"), near.point, near.modes).h_max, 2.785293563405282e-6, 1e-15);
}

TEST(FormulaProblem, OfManyEquationsIsSparse) {
  // x_i'' = 100 (x_(i-1) - 2 x_i + x_(i+1)) - x_i^3 between walls: omega_max = 20 cos(pi / (2 n + 2)).
  const int n = 1500;
  std::string equations, initial;
  const auto x = [&](int i) { return i < 0 || i >= n ? std::string("0") : fmt::format("x{}", i); };
  for (int i = 0; i < n; ++i) {
    equations += fmt::format("x{0} = \"v{0}\"\n", i);
    equations += fmt::format("v{0} = \"100*({1} - 2*x{0} + {2}) - x{0}^3\"\n", i, x(i - 1), x(i + 1));
    const double slowest_mode = std::sin(std::numbers::pi * (i + 1) / (n + 1));
    initial += fmt::format("x{} = {}\nv{} = 0\n", i, 1e-6 * slowest_mode, i);
  }
  const Problem chain = File("[equations]\n" + equations + "[initial]\n" + initial).problem();
  const auto& system = std::get<AnySystem>(chain.system);
  EXPECT_EQ(system.dofs(), n);
  EXPECT_TRUE(system.has_sparse_matrices());
  AnySystem::Jacobian J;
  system.jacobian(0, chain.y0, J);
  EXPECT_EQ(std::get<Eigen::SparseMatrix<double>>(J).nonZeros(), n + 3 * n - 2);
  const Linearised near = linearised(chain);
  EXPECT_TRUE(near.point.at_equilibrium);
  const double omega = 20 * std::cos(std::numbers::pi / (2 * n + 2));
  EXPECT_NEAR(*predict(find_method("velocity_verlet"), near.point, near.modes).h_max, 2 / omega, 1e-9);
  // A step of implicit Euler divides a mode at rest by 1 + h^2 omega^2; x^3 is rounding beside it.
  const double slow = 20 * std::sin(std::numbers::pi / (2 * n + 2)), h = 100;
  const RunRecord end = find_method("implicit_euler").bind(chain).run({.t_end = h, .h = h}, {});
  const Eigen::VectorXd right = chain.y0.head(n) / (1 + h * h * slow * slow);
  EXPECT_LE((end.y.head(n) - right).cwiseAbs().maxCoeff(), 1e-12);
}

/// x'' = -x + H(t - 3), at rest before the jump: x = 1 - cos(t - 3) after it.
TEST(FormulaProblem, RunsLandOnTheJumpsOfTheFile) {
  const std::string equations = "[equations]\nx = \"v\"\nv = \"-x + (t >= 3 ? 1 : 0)\"\n";
  const File forwards("[problem]\nt0 = 2\nt_end = 8\n" + equations + "[initial]\nx = 0\nv = 0\n");
  for (const char* id : {"dormand_prince_54", "sdirk_4", "adams_pece"}) {
    std::vector<double> times;
    const RunRecord end = find_method(id)
                              .bind(forwards.problem())
                              .run({.t_end = 6, .adaptive = true, .rtol = 1e-8, .atol = 1e-12},
                                   [&](double t, const auto&) { times.push_back(t); });
    EXPECT_TRUE(std::ranges::find(times, 1.0) != times.end()) << id;
    EXPECT_NEAR(end.y[0], 1 - std::cos(5), 1e-6) << id;
    EXPECT_NEAR(end.y[1], std::sin(5), 1e-6) << id;
  }
}

}  // namespace
}  // namespace hmax
