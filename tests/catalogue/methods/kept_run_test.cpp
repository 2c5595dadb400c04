#include <algorithm>
#include <bit>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "catalogue/methods/catalogue.hpp"
#include "catalogue/methods/kept_sink.hpp"
#include "catalogue/models/problems.hpp"
#include "tests/integrators/forced.hpp"

namespace hmax {
namespace {

/// Thrown by a keeper that stops its run.
struct Stopped {};

/// Points of a run, as bits.
using Points = std::vector<std::pair<double, std::vector<std::uint64_t>>>;

std::vector<std::uint64_t> bits_of(const Eigen::Ref<const Eigen::VectorXd>& y) {
  std::vector<std::uint64_t> bits;
  for (const double value : y) bits.push_back(std::bit_cast<std::uint64_t>(value));
  return bits;
}

/// Keeps a run in memory and stops it after so many accepted steps of this process.
struct Memory : RunKeeper {
  explicit Memory(Points& shown) : points(shown) {}
  Points& points;
  std::optional<std::string> state;
  Points saved;
  std::int64_t steps_left = 0;  ///< 0: it is never stopped

  std::optional<std::string> resume() override {
    if (state) points = saved;
    return state;
  }
  bool is_due(double) override { return steps_left > 0 && --steps_left == 0; }
  void save(std::string bytes) override {
    state = std::move(bytes);
    saved = points;
    throw Stopped{};
  }
};

struct KeptRecord {
  RunRecord record;
  Points points;
  int stops = 0;
};

/// A run that is stopped after each of these numbers of steps in turn, and resumed by a runner that knows
/// nothing of it.
KeptRecord run_with_stops(const Method& method, const Problem& problem, const RunSpec& spec,
                          const std::vector<std::int64_t>& stops) {
  KeptRecord run;
  Memory memory(run.points);
  const Sink show = [&](double t, const auto& y) { run.points.emplace_back(t, bits_of(y)); };
  for (std::size_t i = 0;; ++i) {
    run.points.clear();
    memory.steps_left = i < stops.size() ? stops[i] : 0;
    try {
      run.record = method.bind(problem).run(spec, KeptSink(show, memory));
      return run;
    } catch (const Stopped&) {
      ++run.stops;
    }
  }
}

void expect_same(const KeptRecord& resumed, const RunRecord& record, const Points& points,
                 const std::string& what) {
  EXPECT_EQ(resumed.record.outcome, record.outcome) << what;
  EXPECT_EQ(std::bit_cast<std::uint64_t>(resumed.record.t), std::bit_cast<std::uint64_t>(record.t)) << what;
  EXPECT_EQ(bits_of(resumed.record.y), bits_of(record.y)) << what;
  const Stats &a = resumed.record.stats, &b = record.stats;
  EXPECT_TRUE(a == b) << what << ": steps " << a.steps << " " << b.steps << ", rejected " << a.rejected << " "
                      << b.rejected << ", rhs " << a.rhs << " " << b.rhs << ", jacobian " << a.jacobian << " "
                      << b.jacobian << ", factorisations " << a.factorisations << " " << b.factorisations
                      << ", newton " << a.newton << " " << b.newton << ", linear " << a.linear_iterations
                      << " " << b.linear_iterations << ", error " << a.newton_error << " " << b.newton_error;
  EXPECT_TRUE(resumed.points == points) << what;
}

/// The run with each set of stops, and the same run that nobody keeps.
void expect_resumable(const Method& method, const Problem& problem, const RunSpec& spec,
                      const std::string& what) {
  Points points;
  const RunRecord record = method.bind(problem).run(
      kept_spec(spec), [&](double t, const auto& y) { points.emplace_back(t, bits_of(y)); });
  EXPECT_GT(record.stats.steps, 8) << what;
  const std::int64_t middle = std::max<std::int64_t>(record.stats.steps / 2, 1);
  for (const std::vector<std::int64_t>& stops : {std::vector<std::int64_t>{},
                                                 {1},
                                                 {2, 1, 1, 3},
                                                 {middle, 1},
                                                 {std::max<std::int64_t>(record.stats.steps - 1, 1)}}) {
    const KeptRecord resumed = run_with_stops(method, problem, spec, stops);
    EXPECT_EQ(resumed.stops, static_cast<int>(stops.size())) << what;
    expect_same(resumed, record, points, what);
    if (testing::Test::HasFailure()) return;
  }
}

/// Fixed steps and every controller, each step shown and samples between steps.
std::vector<std::pair<std::string, RunSpec>> specs_of(const Method& method, double t_end, double h,
                                                      double tolerance) {
  std::vector<std::pair<std::string, RunSpec>> specs;
  RunSpec spec{.t_end = t_end, .h = h, .max_steps = 100'000};
  if (method.fixed_step) specs.emplace_back("fixed", spec);
  if (method.fixed_step && method.needs_jacobian) {
    spec.jacobian.every = 3;
    specs.emplace_back("fixed, Jacobian every:3", spec);
    spec.jacobian.every = JacobianUpdate::frozen;
    specs.emplace_back("fixed, frozen Jacobian", spec);
    spec.jacobian = {};
  }
  if (!method.adaptive()) return specs;
  spec.adaptive = true;
  spec.rtol = spec.atol = tolerance;
  if (method.error_order >= 5) spec.t_end *= 4;  // whose steps are long
  for (const Controllers control :
       {Controllers::i, Controllers::pi, Controllers::deadband, Controllers::matlab}) {
    spec.control = control;
    specs.emplace_back("control " + std::string(to_string(control)), spec);
    if (method.own_control) break;
  }
  return specs;
}

void expect_resumable_in_all_modes(const Method& method, const Problem& problem, double t_end, double h,
                                   double tolerance) {
  for (auto& [mode, spec] : specs_of(method, t_end, h, tolerance))
    for (const double every : {0.0, 0.37 * h}) {
      spec.every = every;
      expect_resumable(method, problem, spec,
                       method.id + ", " + problem.id + ", " + mode + (every > 0 ? ", samples" : ""));
      if (testing::Test::HasFailure()) return;
    }
}

bool can_be_kept(const Method& method) { return !method.is_foreign(); }

class EveryMethodKept : public testing::TestWithParam<std::string> {};

TEST_P(EveryMethodKept, GoesOnWithTheSameBitsOnTheOscillator) {
  const Method method = find_method(GetParam());
  const Problem problem = make_problem("liver_forced");
  if (!suits(method, problem)) GTEST_SKIP() << "does not suit " << problem.id;
  expect_resumable_in_all_modes(method, problem, 3, 0.07, 1e-10);
}

TEST_P(EveryMethodKept, GoesOnWithTheSameBitsOnStiffProblems) {
  const Method method = find_method(GetParam());
  const Problem stiff = make_problem("van_der_pol", {.parameters = {{"mu", 20}}});
  if (suits(method, stiff)) expect_resumable_in_all_modes(method, stiff, 2, 0.011, 1e-7);
  const Problem split = make_problem("brusselator");
  if (suits(method, split)) expect_resumable_in_all_modes(method, split, 0.15, 0.005, 1e-9);
}

TEST_P(EveryMethodKept, GoesOnWithTheSameBitsOnAMesh) {
  const Method method = find_method(GetParam());
  const Problem problem = make_problem("fem_green@cube:n=2");
  if (!suits(method, problem)) GTEST_SKIP() << "does not suit " << problem.id;
  if (is_too_slow(method, problem.y0.size())) GTEST_SKIP() << "factors dense matrices";
  expect_resumable_in_all_modes(method, problem, 0.008, 0.0004, 1e-9);
  if (!method.needs_jacobian || !method.fixed_step) return;
  RunSpec gradients{.t_end = 0.008, .h = 0.0004};
  gradients.linear_solve.by = LinearSolve::By::conjugate_gradients;
  expect_resumable(method, problem, gradients, method.id + ", conjugate gradients");
}

std::vector<std::string> kept_methods() {
  std::vector<std::string> ids;
  for (const Method& method : methods())
    if (can_be_kept(method)) ids.push_back(method.id);
  ids.push_back("newton_truncated:frozen=1");
  return ids;
}

INSTANTIATE_TEST_SUITE_P(Catalogue, EveryMethodKept, testing::ValuesIn(kept_methods()),
                         [](const auto& method) {
                           std::string name = method.param;
                           std::ranges::replace_if(
                               name, [](char c) { return !std::isalnum(static_cast<unsigned char>(c)); },
                               '_');
                           return name;
                         });

TEST(KeptRun, RefusesMethodsWhoseStateIsHidden) {
  const Problem problem = make_problem("liver_forced");
  for (const Method& method : methods()) {
    if (can_be_kept(method)) continue;
    Points points;
    Memory memory(points);
    RunSpec spec{.t_end = 1, .adaptive = !method.fixed_step, .h = 0.1, .rtol = 1e-3, .atol = 1e-3};
    if (!suits(method, problem)) continue;
    EXPECT_THROW(method.bind(problem).run(spec, KeptSink({}, memory)), StateNotSaved) << method.id;
  }
}

TEST(KeptRun, EndsAtTheLimitOfStepsOfTheWholeRun) {
  const Method method = find_method("rk4");
  const Problem problem = make_problem("liver_forced");
  const RunSpec spec{.t_end = 10, .h = 0.1, .max_steps = 20};
  const KeptRecord resumed = run_with_stops(method, problem, spec, {7, 8});
  EXPECT_EQ(resumed.record.outcome, Outcome::too_many_steps);
  EXPECT_EQ(resumed.record.stats.steps, 20);
}

TEST(KeptRun, RefusesAStateOfAnotherRun) {
  const Problem problem = make_problem("liver_forced");
  Points points;
  Memory memory(points);
  const RunSpec spec{.t_end = 10, .h = 0.1};
  memory.steps_left = 5;
  EXPECT_THROW(find_method("rk4").bind(problem).run(spec, KeptSink({}, memory)), Stopped);
  const std::string whole = *memory.state;
  for (std::size_t length = 0; length < whole.size(); ++length) {
    memory.state = whole.substr(0, length);
    EXPECT_THROW(find_method("rk4").bind(problem).run(spec, KeptSink({}, memory)), BadState) << length;
  }
  memory.state = whole + "x";
  EXPECT_THROW(find_method("rk4").bind(problem).run(spec, KeptSink({}, memory)), BadState);
  memory.state = whole;
  EXPECT_THROW(find_method("adams_bashforth_3").bind(problem).run(spec, KeptSink({}, memory)), BadState);
}

// Methods begin anew at breakpoints, where nothing is saved; a resumed run meets the rest of them.
TEST(KeptRun, GoesOnOverJumpsThatTheModelNames) {
  Problem problem{.id = "switched",
                  .states = {"y"},
                  .y0 = Eigen::VectorXd::Zero(1),
                  .system = AnySystem(forced::Switched{})};
  const RunSpec spec{.t_end = 10, .adaptive = true, .rtol = 1e-6, .atol = 1e-9};
  for (const char* id : {"radau_iia_5", "dormand_prince_54", "adams_pece", "sdirk_4", "rodas_4"}) {
    const Method method = find_method(id);
    Points points;
    const RunRecord record =
        method.bind(problem).run(spec, [&](double t, const auto& y) { points.emplace_back(t, bits_of(y)); });
    for (const std::int64_t stop : {record.stats.steps / 4, record.stats.steps / 2, record.stats.steps - 4}) {
      const KeptRecord resumed = run_with_stops(method, problem, spec, {stop, 1});
      EXPECT_GE(resumed.stops, 1) << id << " " << stop;
      expect_same(resumed, record, points, std::string(id) + " over jumps");
    }
  }
}

}  // namespace
}  // namespace hmax
