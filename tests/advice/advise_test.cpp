#include "advice/advise.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <memory>
#include <numbers>
#include <numeric>
#include <utility>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "advice/step_search.hpp"
#include "catalogue/device/device_run.hpp"
#include "catalogue/device/host_device.hpp"
#include "catalogue/methods/catalogue.hpp"
#include "catalogue/models/problems.hpp"
#include "catalogue/models/tissue_problem.hpp"
#include "core/errors.hpp"
#include "limits/linearised_problem.hpp"
#include "limits/predict.hpp"
#include "problems/tissue/body.hpp"
#include "tests/advice/cube.hpp"
#include "tests/results/scratch.hpp"
#include "tests/says.hpp"

namespace hmax {
namespace {

TEST(TimeToMeet, TakesAsManyMoreStepsAsTheOrderSays) {
  AdviceRow row;
  row.frame.p50 = 2e-3;
  row.error = 0.16;
  row.candidate.method.order = 4;
  // The error falls as h^p: sixteen times less takes twice the steps at order 4, four times at order 2.
  EXPECT_NEAR(time_to_meet(row, 0.01), 2 * 2e-3, 1e-15);
  row.candidate.method.order = 2;
  EXPECT_NEAR(time_to_meet(row, 0.01), 4 * 2e-3, 1e-15);
  // No fewer steps than were run; methods whose order nobody knows count as of the first.
  EXPECT_EQ(time_to_meet(row, 0.2), 2e-3);
  row.candidate.method.order = 0;
  EXPECT_NEAR(time_to_meet(row, 0.01), 16 * 2e-3, 1e-15);
  // A step that leaves the motion by many times its size may follow it when halved: vertex block descent
  // does.
  row.error = 49;
  EXPECT_EQ(time_to_meet(row, 0.01), 2 * 2e-3);
}

/// The same question to the processor and to a device, here programs of devices on the processor.
TEST(Advise, OnADeviceHasTheMotionsOfTheProcessor) {
  const Problem problem = cube("press");
  AdviceQuestion question{.rate = 100, .budget = 10, .frames = 60, .material = false, .proof = 0.1};
  for (const char* id : {"symplectic_euler", "rk4", "newton_truncated", "vbd"})
    question.methods.push_back(find_method(id));
  const Advice here = advise(problem, question);
  question.device = std::make_shared<HostDevice>();
  for (Method& method : question.methods) method = on_device(std::move(method), question.device);
  const Advice there = advise(problem, question);
  EXPECT_EQ(there.reference_error, here.reference_error);
  ASSERT_EQ(there.rows.size(), here.rows.size());
  for (const AdviceRow& row : there.rows) {
    const auto same = std::ranges::find(here.rows, row.candidate.words(),
                                        [](const AdviceRow& each) { return each.candidate.words(); });
    ASSERT_NE(same, here.rows.end());
    EXPECT_TRUE(row.candidate.method.device);
    EXPECT_TRUE(is_suitable(row)) << row.status;
    EXPECT_EQ(row.h, same->h);
    EXPECT_TRUE(row.h_max == same->h_max || (std::isnan(row.h_max) && std::isnan(same->h_max)));
    EXPECT_EQ(row.error, same->error);
    EXPECT_EQ(row.frames, same->frames);
    EXPECT_GT(row.frame.p50, 0);
    const bool solves = row.candidate.method.id.starts_with("newton_truncated");
    EXPECT_EQ(!std::isnan(row.linear_per_frame), solves) << row.candidate.words();
    EXPECT_TRUE(!solves || row.linear_per_frame == same->linear_per_frame);
  }
}

TEST(Candidates, AreMethodsWithTheirChoices) {
  const Problem body = cube("press"), oscillator = make_problem("liver_forced");
  const auto count = [](const char* id, const Problem& problem) {
    return candidates({find_method(id)}, problem).size();
  };
  EXPECT_EQ(count("rk4", body), 1U);
  EXPECT_EQ(count("linearly_implicit_euler", body), 4U);
  EXPECT_EQ(count("linearly_implicit_euler", oscillator), 3U);
  EXPECT_EQ(count("adams_pece", oscillator), 0U);  // chooses its steps itself
  EXPECT_EQ(count("newmark", make_problem("lorenz")), 0U);
}

// beta K at rest is no proportional damping of the body that sags; undamped modes do not know it.
TEST(Advise, TellsSlowModesWithNonProportionalDamping) {
  const auto slow = [](double beta) {
    const Problem problem = cube("press", {{"beta", beta}});
    return advise(problem, question(100, {"linearly_implicit_euler"}, problem));
  };
  const Advice damped = slow(0.01), undamped = slow(0);
  ASSERT_EQ(damped.modes.size(), 3U);
  ASSERT_EQ(undamped.modes.size(), 3U);
  for (std::size_t k = 0; k < 3; ++k)
    EXPECT_NEAR(damped.modes[k], undamped.modes[k], 1e-6 * undamped.modes[k]);
  for (const double added : damped.rows.at(0).damping_added) EXPECT_GT(added, 0);
}

TEST(Advise, RecommendsAStepThatHoldsWhenItIsRun) {
  const Problem problem = cube("press");
  const AdviceQuestion asked =
      question(100, {"symplectic_euler", "rk4", "linearly_implicit_euler", "newmark"}, problem);
  const Advice advice = advise(problem, asked);
  ASSERT_EQ(advice.rows.size(), 7U);
  const AdviceRow* best = advice.recommended();
  ASSERT_NE(best, nullptr);
  EXPECT_LE(best->error, asked.tolerance);
  EXPECT_GE(best->frames, 50U);
  EXPECT_EQ(best->h, asked.frame() / static_cast<double>(best->steps_per_frame));
  const ProbingMotion motion = probing_motion(problem);
  const ReferenceMotion reference = reference_motion(motion, asked.frame(), asked.tolerance);
  EXPECT_LE(run_motion(best->candidate, motion, reference, asked.frame(), best->steps_per_frame).error,
            asked.tolerance);
  for (const AdviceRow& row : advice.rows) {
    EXPECT_EQ(row.damping_added.size(), advice.modes.size());
    if (!std::isfinite(row.h_max)) continue;
    EXPECT_LT(row.h, row.h_max) << row.candidate.words();
    EXPECT_NEAR(row.h_max_observed / row.h_max, 1, 0.1) << row.candidate.words();
    EXPECT_FALSE(holds(row.candidate, motion, reference, 1.15 * row.h_max)) << row.candidate.words();
  }
}

TEST(Advise, ProvesTheBestRowOnItsMotionAndOnAnother) {
  const Problem problem = cube("press");
  const AdviceQuestion asked = question(100, {"symplectic_euler", "newmark"}, problem);
  const Advice advice = advise(problem, asked);
  ASSERT_NE(advice.recommended(), nullptr);
  ASSERT_EQ(advice.proof.size(), 2U);
  for (const ProofRun& run : advice.proof) {
    EXPECT_TRUE(run.holds()) << run.motion;
    EXPECT_GE(run.frames, 500U);
    EXPECT_NEAR(run.seconds, static_cast<double>(run.frames) * 0.01, 1e-9);
  }
  EXPECT_NE(advice.proof[0].motion, advice.proof[1].motion);
}

TEST(Advise, TellsItsProgressAndForgetsAnEarlierAnswer) {
  const Problem problem = cube("press");
  const AdviceQuestion asked = question(100, {"symplectic_euler", "newmark"}, problem);
  std::size_t calls = 0;
  double last = 0;
  Advice advice;
  advice.rows.resize(3);  // of an earlier question
  advise(problem, asked, advice, [&](double share, const std::string&) {
    ++calls;
    EXPECT_GE(share, last);
    last = share;
  });
  EXPECT_GT(calls, 10U);
  EXPECT_EQ(advice.stage, AdviceStage::done);
  EXPECT_EQ(advice.rows.size(), 2U);
  EXPECT_NE(advice.recommended(), nullptr);
}

TEST(Proof, FailsBeyondTheLimit) {
  const Problem problem = cube("press", {{"E", 1e5}});
  const AdviceQuestion asked = question(100, {"symplectic_euler"}, problem);
  const Advice advice = advise(problem, asked);
  ASSERT_NE(advice.recommended(), nullptr);
  const AdviceRow& row = *advice.recommended();
  const ProbingMotion motion = probing_motion(problem);
  const ReferenceMotion reference = reference_motion(motion, asked.frame(), asked.tolerance);
  // A frame that one step fills, 5 % beyond the limit.
  const ProofPlan plan{.frame = 1.05 * row.h_max, .budget = 1, .seconds = 2, .slowest = 0};
  for (const ProofRun& run : prove(row.candidate, 1, motion, reference, plan))
    EXPECT_FALSE(run.holds()) << run.motion;
}

/// Fibres that buckle make steps below the limit unstable, in long runs alone.
TEST(Proof, TakesShorterStepsWhereLongRunsAreNotStable) {
  const Problem problem =
      make_problem("fem_green@beam:n=1", {.parameters = {{"E", 5e4}, {"fibre_E", 2e5}, {"fibre_x", 1}}});
  const AdviceQuestion asked = question(100, {"symplectic_euler"}, problem);
  const Advice advice = advise(problem, asked);
  ASSERT_NE(advice.recommended(), nullptr);
  const AdviceRow& row = *advice.recommended();
  EXPECT_GT(row.steps_per_frame, first_steps(row.h_max, asked.frame()));
  EXPECT_TRUE(says(row.status, "is not stable on"));
  ASSERT_FALSE(advice.proof.empty());
  for (const ProofRun& run : advice.proof) EXPECT_TRUE(run.holds()) << run.why;
}

/// The same body with its points in another order, turned, mirrored and made in another unit.
Problem moved(const Problem& problem, const Eigen::Matrix3d& turn) {
  const TissueBody& body = *problem.body;
  TetMesh mesh = body.mesh();
  const Eigen::Index n = mesh.point_count();
  const auto place = [&](Eigen::Index i) { return (5 * i + 3) % n; };
  for (Eigen::Index i = 0; i < n; ++i) mesh.points.col(place(i)) = turn * body.mesh().points.col(i);
  for (Eigen::Index t = 0; t < mesh.tetrahedron_count(); ++t) {
    for (Eigen::Index a = 0; a < 4; ++a)
      mesh.tetrahedra(a, t) = static_cast<TetMesh::Index>(place(body.mesh().tetrahedra(a, t)));
    if (turn.determinant() < 0) std::swap(mesh.tetrahedra(0, t), mesh.tetrahedra(1, t));
  }
  TissueSettings settings = body.settings();
  settings.gravity = turn * settings.gravity;
  for (Support& support : settings.supports)
    for (TetMesh::Index& i : support.points) i = static_cast<TetMesh::Index>(place(i));
  for (PressingForce& force : settings.forces) {
    for (TetMesh::Index& i : force.points) i = static_cast<TetMesh::Index>(place(i));
    force.force = turn * force.force;
  }
  return with_body(problem, std::make_shared<const TissueBody>(mesh, settings, body.origin()));
}

TEST(Advise, IsTheSameForABodyRenumberedTurnedAndMirrored) {
  const Problem problem = cube("press", {{"E", 1e5}});
  ASSERT_EQ(problem.body->mesh().point_count() % 5, 2);  // 27 points: the new order is one
  const AdviceQuestion asked = question(100, {"symplectic_euler", "rk4", "newmark"}, problem);
  const Advice before = advise(problem, asked);
  const Eigen::Matrix3d turn =
                            Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix(),
                        mirror = Eigen::Vector3d(-1, 1, 1).asDiagonal();
  for (const Eigen::Matrix3d& change : {turn, Eigen::Matrix3d(turn * mirror)}) {
    const Advice after = advise(moved(problem, change), asked);
    for (const AdviceRow& row : before.rows) {
      const auto same = std::ranges::find(after.rows, row.candidate.method.id,
                                          [](const AdviceRow& each) { return each.candidate.method.id; });
      ASSERT_NE(same, after.rows.end());
      EXPECT_EQ(same->steps_per_frame, row.steps_per_frame) << row.candidate.words();
      EXPECT_EQ(same->bound, row.bound) << row.candidate.words();
      EXPECT_NEAR(same->error, row.error, 1e-3 * row.error) << row.candidate.words();
      if (std::isfinite(row.h_max)) {
        EXPECT_NEAR(same->h_max, row.h_max, 1e-6 * row.h_max) << row.candidate.words();
      }
    }
  }
}

TEST(LimitBands, AreRootsForAnUndampedBody) {
  const auto make = [](const std::vector<std::pair<std::string, double>>& values) {
    return cube("press", values);
  };
  const Problem problem = make({});
  const Eigen::VectorXd rest = Eigen::VectorXd::Zero(problem.y0.size());
  const auto bands = limit_bands(find_method("central_difference"), problem, rest, make);
  ASSERT_EQ(bands.size(), 2U);
  EXPECT_EQ(bands[0].quantity, "stiffness");
  EXPECT_NEAR(bands[0].exponent, -0.5, 1e-6);
  EXPECT_NEAR(bands[0].low, std::sqrt(1 / 1.29), 1e-6);
  EXPECT_NEAR(bands[0].high, std::sqrt(1 / 0.71), 1e-6);
  EXPECT_EQ(bands[1].quantity, "mass");
  EXPECT_NEAR(bands[1].exponent, 0.5, 1e-6);
}

TEST(LimitBands, KnowDamping) {
  const auto make = [](std::vector<std::pair<std::string, double>> values) {
    if (values.empty() || values.front().first != "beta") values.emplace_back("beta", 0.01);
    return cube("press", values);
  };
  const Problem problem = make({});
  const Eigen::VectorXd rest = Eigen::VectorXd::Zero(problem.y0.size());
  const auto bands = limit_bands(find_method("rk4"), problem, rest, make);
  ASSERT_EQ(bands.size(), 3U);
  EXPECT_EQ(bands[2].quantity, "damping");
  EXPECT_LT(bands[2].exponent, 0);
}

// A rate of decay that is called k, and a share that is called m.
TEST(LimitBands, AreNoneOfFormulas) {
  const Scratch scratch;
  const std::filesystem::path file = scratch / "decay.toml";
  std::ofstream(file) << "[problem]\nt_end = 1\n[equations]\nx = \"-k*m*x\"\n"
                         "[parameters]\nk = 3\nm = 0.5\n[initial]\nx = 1\n";
  const auto make = [&](const std::vector<std::pair<std::string, double>>& values) {
    return make_problem(file.string(), {.parameters = values});
  };
  const Problem problem = make({});
  EXPECT_TRUE(limit_bands(find_method("rk4"), problem, problem.y0, make).empty());
}

// The limit with as much more stiffness, relative to that without, is the step relative to its own limit:
// where springs, and where dampers and beta K set the limit.
TEST(StiffeningMargin, IsWhereTheLimitFallsToTheStep) {
  struct Case {
    const char *problem, *method, *stiffness;
    double rate;
    std::vector<std::pair<std::string, double>> damping = {};
  };
  for (const Case& of :
       {Case{"liver_linear", "explicit_euler", "k1", 100}, Case{"liver_linear", "rk4", "k1", 1},
        Case{"liver_linear", "rk4", "k1", 100, {{"c", 2}}},
        Case{"fem_green/press@cube:n=2", "rk4", "E", 1000, {{"beta", 0.02}}},
        Case{"fem_green/press@cube:n=2", "explicit_euler", "E", 1000, {{"beta", 0.02}}}}) {
    const auto make = [&](std::vector<std::pair<std::string, double>> values) {
      values.insert(values.end(), of.damping.begin(), of.damping.end());
      return make_problem(of.problem, {.parameters = std::move(values)});
    };
    const Problem problem = make({});
    AdviceQuestion asked = question(of.rate, {of.method}, problem);
    asked.tolerance = 0.05;
    const Advice advice = advise(problem, asked, {}, make);
    ASSERT_NE(advice.recommended(), nullptr) << of.problem << ": " << advice.rows.front().status;
    const AdviceRow& row = advice.rows.front();
    const auto given =
        std::ranges::find(problem.parameters, of.stiffness, &std::pair<std::string, double>::first);
    ASSERT_NE(given, problem.parameters.end());
    const auto limit = [&](double factor) {
      const Problem stiffer = make({{of.stiffness, factor * given->second}});
      return predict(find_method(of.method), linearised(stiffer, 0, problem.y0)).h_max.value();
    };
    ASSERT_TRUE(std::isfinite(row.stiffening)) << of.problem;
    EXPECT_NEAR(limit(row.stiffening) / limit(1), row.h / row.h_max, 0.02 * row.h / row.h_max)
        << of.problem << ", " << of.method;
  }
}

TEST(StiffeningMargin, IsNoneOfConcentrations) {
  const Problem problem = make_problem("hires");
  for (const AdviceRow& row : advise(problem, question(1, {"rk4", "implicit_euler"}, problem)).rows)
    EXPECT_TRUE(std::isnan(row.stiffening)) << row.candidate.words();
}

TEST(Advise, NamesWhatBindsTheStep) {
  // So stiff that symplectic Euler takes several steps a frame.
  const Problem problem = cube("press", {{"E", 1e5}});
  const Advice advice = advise(problem, question(100, {"symplectic_euler"}, problem));
  ASSERT_EQ(advice.rows.size(), 1U);
  const AdviceRow& row = advice.rows.front();
  EXPECT_GT(row.steps_per_frame, 1);
  EXPECT_EQ(row.bound, AdviceBound::stability);
  EXPECT_NEAR(row.stiffening, std::pow(row.h_max / row.h, 2), 1e-9);
  EXPECT_LT(row.h, 0.96 * row.h_max);
}

TEST(Advise, FindsNothingWhereNothingIsFastEnough) {
  const Problem problem = cube("press");
  AdviceQuestion asked = question(100, {"symplectic_euler", "newmark"}, problem);
  asked.budget = 1e-8;
  const Advice advice = advise(problem, asked);
  EXPECT_EQ(advice.recommended(), nullptr);
  for (const AdviceRow& row : advice.rows) EXPECT_EQ(row.verdict, AdviceVerdict::too_slow);
}

TEST(Advise, HasFramesToTimeAtLowRates) {
  const Problem problem = cube("press");
  const Advice advice = advise(problem, question(2, {"newmark"}, problem));
  EXPECT_GT(advice.rows.front().frame.p50, 0);
  const Problem short_one = make_problem("liver_forced");
  EXPECT_THROW(advise(short_one, question(1e-3, {"rk4"}, short_one)), InputError);
}

TEST(Advise, SpendsABudgetOnTheError) {
  const Problem problem = cube("press");
  AdviceQuestion asked = question(100, {"newmark"}, problem);
  const double error = advise(problem, asked).rows.front().error;
  asked.budget = 1;  // far more than any frame takes
  asked.least_error = true;
  const AdviceRow row = advise(problem, asked).rows.front();
  EXPECT_LT(row.error, 0.1 * error);
  // Down to what the reference itself is known to.
  EXPECT_EQ(row.bound, AdviceBound::accuracy);
  EXPECT_GE(row.steps_per_frame, 2 * row.least_steps);
}

// A method of first order spent all of the time of the answer on steps of microseconds, and no other was run.
TEST(Advise, RunsEachMethodBeforeOneSpendsTheBudget) {
  Problem problem = make_problem("liver_linear");
  problem.t_end = 5;
  AdviceQuestion asked = question(100, {"linearly_implicit_euler", "rk4"}, problem);
  asked.budget = 1e-4;
  asked.least_error = true;
  std::vector<std::string> stages;
  (void)advise(problem, asked, [&](double, const std::string& what) {
    if (stages.empty() || stages.back() != what) stages.push_back(what);
  });
  const auto begins = [](const char* words) {
    return [=](const std::string& stage) { return stage.starts_with(words); };
  };
  const auto spent = std::ranges::find_if(stages, begins("shorter steps of "));
  ASSERT_NE(spent, stages.end());
  EXPECT_EQ(std::count_if(stages.begin(), spent, begins("steps of ")), 4);
  EXPECT_TRUE(std::none_of(spent, stages.end(), begins("steps of ")));
}

TEST(Advise, TellsHowFarAFrozenJacobianReaches) {
  const Problem problem = cube("press");
  const Advice advice = advise(problem, question(100, {"linearly_implicit_euler"}, problem));
  const auto frozen = std::ranges::find_if(advice.rows, [](const AdviceRow& row) {
    return row.candidate.jacobian.every == JacobianUpdate::frozen;
  });
  ASSERT_NE(frozen, advice.rows.end());
  // Every step up to twice the stiffness (docs/reference/facts.md), and a short one of a damped body far
  // beyond.
  EXPECT_GT(frozen->stiffening * advice.stiffened, 2);
}

// The margins of frozen Jacobians of a damped body took the time of the rows that were not run yet.
TEST(Advise, RunsEachMethodBeforeItTellsMargins) {
  const Problem problem = cube("press");
  struct Ended {};
  Advice advice;
  const AdviceWatcher watcher = [](double, const std::string& what) {
    if (what.starts_with("how much stiffer")) throw Ended{};
  };
  EXPECT_THROW(
      advise(problem, question(100, {"linearly_implicit_euler", "newmark"}, problem), advice, watcher, {}),
      Ended);
  ASSERT_NE(advice.recommended(), nullptr);
  for (const AdviceRow& row : advice.rows) {
    EXPECT_NE(row.verdict, AdviceVerdict::predicted) << row.candidate.words();
    EXPECT_TRUE(std::isnan(row.stiffening)) << row.candidate.words();
  }
}

TEST(Advise, PredictsLimitsThatNoModeTells) {
  // Under load the stiff part and the rest of a body have no common modes. Of each method alone, since limits
  // of rows beyond the four best, which are the machine's, stay pending.
  const Problem problem = cube("press");
  for (const char* method : {"imex_euler", "linearly_implicit_euler"}) {
    AdviceQuestion asked = question(100, {method}, problem);
    asked.budget = 10;  // no row is too slow on any machine
    const Advice advice = advise(problem, asked);
    ASSERT_FALSE(advice.rows.empty()) << method;
    EXPECT_FALSE(advice.rows.front().limit_pending) << method;
    for (const AdviceRow& row : advice.rows) {
      if (row.limit_pending) continue;
      EXPECT_LE(row.h, row.h_max) << row.candidate.words() << row.status;
    }
  }
}

TEST(LoadMargin, IsOpenWhereNothingStiffens) {
  const auto make = [](const std::string& load) {
    return make_problem("fem_cauchy/" + load + "@cube:n=2", {});
  };
  const Problem problem = make("press");
  const Advice advice = advise(problem, question(100, {"symplectic_euler"}, problem));
  ASSERT_NE(advice.recommended(), nullptr);
  EXPECT_EQ(advice.load_margin.holds, 8);
  EXPECT_TRUE(std::isinf(advice.load_margin.fails));
  EXPECT_NEAR(advice.load_margin.displacement, 8 * advice.scale, 0.1 * 8 * advice.scale);
}

TEST(LoadMargin, EndsWhereASpringThatStiffensIsTooFastForTheStep) {
  const Problem problem = make_problem("liver_cubic", {.parameters = {{"c", 0}}, .y0 = {1, 0}});
  const Candidate candidate{find_method("symplectic_euler"), {}, {}};
  const ProbingMotion motion = probing_motion(problem);
  const ReferenceMotion reference = reference_motion(motion, 0.1, 0.01);
  // The stiffness is k1 + 3 k3 x^2, at most that of x = 1: the step is half of its limit.
  const double m = 1.45, k1 = 0.7, k3 = 0.8;
  const double h = 1 / std::sqrt((k1 + 3 * k3) / m);
  ASSERT_TRUE(holds(candidate, motion, reference, h));
  const LoadMargin margin = load_margin(candidate, h, motion, reference, {});
  EXPECT_GT(margin.holds, 1);
  EXPECT_LT(margin.fails, 8);
  EXPECT_LT(margin.fails / margin.holds, 1.5);
  EXPECT_EQ(margin.of_model, false);
  EXPECT_TRUE(holds(candidate, larger_motion(motion, margin.holds, {}), reference, h));
  EXPECT_FALSE(holds(candidate, larger_motion(motion, margin.fails, {}), reference, h));
}

// The springs of the liver are pushed by P; what begins at rest and has no P has nothing to be made larger.
TEST(LoadMargin, NamesWhatItMakesLarger) {
  const Candidate candidate{find_method("rk4"), {}, {}};
  const auto named = [&](const char* id, std::vector<double> y0, double P) {
    const auto make = [&](const std::vector<std::pair<std::string, double>>& values) {
      return make_problem(id, {.parameters = values, .y0 = y0});
    };
    ProbingMotion motion = probing_motion(P > 0 ? make({{"P", P}}) : make({}));
    motion.t_end = 1;
    const LoadMargin margin = load_margin(candidate, 0.01, motion, reference_motion(motion, 0.1, 0.01), make);
    EXPECT_EQ(std::isnan(margin.holds), margin.loads.empty()) << margin.loads;
    return margin.loads;
  };
  EXPECT_EQ(named("liver_forced", {0.1, 0}, 1), "force and initial state");
  EXPECT_EQ(named("liver_forced", {0, 0}, 1), "force");
  EXPECT_EQ(named("liver_linear", {0.1, 0}, 0), "initial state");
  const Scratch scratch;
  const std::filesystem::path file = scratch / "filled.toml";
  std::ofstream(file) << "[problem]\nt_end = 1\n[equations]\nx = \"1 - x\"\n[initial]\nx = 0\n";
  EXPECT_EQ(named(file.string().c_str(), {}, 0), "");
}

TEST(LoadMargin, MovesWhatMovesABody) {
  const Problem pressed = cube("press"), touched = cube("tool");
  const ProbingMotion larger = larger_motion(probing_motion(pressed), 3, {});
  EXPECT_EQ(larger.problem.body->settings().forces.front().force,
            3 * probing_motion(pressed).problem.body->settings().forces.front().force);
  // A tool that went further would touch elsewhere.
  EXPECT_TRUE(std::isnan(
      load_margin({find_method("symplectic_euler"), {}, {}}, 1e-4, {.problem = touched, .t_end = 1}, {}, {})
          .holds));
}

TEST(Remedies, NameTheBudgetAndTheRateThatWouldSuffice) {
  const auto make = [](const std::vector<std::pair<std::string, double>>& values) {
    return cube("press", values);
  };
  const Problem problem = make({});
  AdviceQuestion asked = question(100, {"symplectic_euler", "newmark"}, problem);
  asked.budget = 1e-8;
  Advice failed = advise(problem, asked);
  find_remedies(problem, asked, failed, {.with = make});
  const std::vector<Remedy>& found = failed.remedies;
  ASSERT_FALSE(found.empty());
  EXPECT_EQ(found.front().change, "budget_ms");
  EXPECT_EQ(found.front().from, 1e-5);
  // What suffices lies between the budget that does not and a whole frame.
  EXPECT_GT(found.front().to, found.front().from);
  EXPECT_LT(found.front().to, 1e3 * asked.frame());
  EXPECT_GT(found.front().h, 0);
  EXPECT_FALSE(found.front().method.empty());
}

TEST(Remedies, MendElementsWhereThatMakesTheFastestModeSlower) {
  // So stiff that a stable step is less than 1/100000 of a frame.
  const Problem problem = cube("press", {{"E", 5.5e13}});
  AdviceQuestion asked = question(100, {"symplectic_euler"}, problem);
  asked.proof = 1;
  Advice failed = advise(problem, asked);
  ASSERT_EQ(failed.recommended(), nullptr);
  std::vector<int> counts;
  const Remaking make{.with = [](const auto&) -> Problem { throw InputError("no other parameters"); },
                      .mended =
                          [&](int count) {
                            counts.push_back(count);
                            return cube("press", {{"E", count < 16 ? 5.5e13 : 5500}});
                          }};
  find_remedies(problem, asked, failed, make);
  ASSERT_EQ(failed.remedies.size(), 1U);
  EXPECT_EQ(failed.remedies[0].change, "mend");
  EXPECT_EQ(failed.remedies[0].to, 16);
  EXPECT_EQ(failed.remedies[0].cost, "moves 0 of 27 points by at most 0 mm");
  EXPECT_EQ(counts, (std::vector<int>{1, 4, 16}));
}

TEST(Remedies, ThatWereFoundStayWhenTheSearchIsInterrupted) {
  struct Enough {};
  const auto make = [](const std::vector<std::pair<std::string, double>>& values) {
    return cube("press", values);
  };
  const Problem problem = make({});
  AdviceQuestion asked = question(100, {"symplectic_euler", "newmark"}, problem);
  asked.budget = 1e-8;
  Advice failed = advise(problem, asked);
  const AdviceWatcher stop = [&](double, const std::string&) {
    if (!failed.remedies.empty()) throw Enough{};
  };
  EXPECT_THROW(find_remedies(problem, asked, failed, {.with = make}, stop), Enough);
  ASSERT_EQ(failed.remedies.size(), 1U);
  EXPECT_EQ(failed.remedies.front().change, "budget_ms");
  EXPECT_GT(failed.remedies.front().h, 0);
}

TEST(Remedies, AreNoneOfAModelThatCannotBeMade) {
  const Problem problem = cube("press");
  AdviceQuestion asked = question(100, {"newmark"}, problem);
  asked.budget = 1e-8;
  Advice failed = advise(problem, asked);
  const auto refuse = [](const auto&) -> Problem { throw InputError("no such parameter"); };
  find_remedies(problem, asked, failed, {.with = refuse});
  for (const Remedy& remedy : failed.remedies)
    EXPECT_TRUE(remedy.change == "budget_ms" || remedy.change == "rate") << remedy.change;
}

// Which of the two takes less time is the machine's.
TEST(Advise, KnowsOscillators) {
  const Problem problem = make_problem("liver_forced");
  const Advice advice = advise(problem, question(50, {"rk4", "implicit_euler"}, problem));
  ASSERT_NE(advice.recommended(), nullptr);
  ASSERT_EQ(advice.rows.size(), 2U);
  for (const AdviceRow& row : advice.rows) {
    const bool is_rk4 = row.candidate.method.id == "rk4";
    EXPECT_TRUE(is_suitable(row)) << row.candidate.words();
    EXPECT_EQ(row.steps_per_frame, 1) << row.candidate.words();
    EXPECT_EQ(row.bound, AdviceBound::rate) << row.candidate.words();
    EXPECT_EQ(std::isfinite(row.h_max), is_rk4) << row.candidate.words();
    EXPECT_NEAR(row.error, is_rk4 ? 0 : 0.0056, 1e-4) << row.candidate.words();
  }
}

/// Between two instants of the reference the forced liver is stiffer than at either.
TEST(Advise, LooksForLimitsOfSmallProblemsAllAlongTheMotion) {
  const Problem problem = make_problem("liver_forced");
  const Advice advice = advise(problem, question(100, {"rk4", "rk2_heun"}, problem));
  ASSERT_EQ(advice.rows.size(), 2U);
  for (const AdviceRow& row : advice.rows) {
    const auto along = limit_along(row.candidate.method, problem, problem.t_end);
    EXPECT_NEAR(row.h_max, along->least, 1e-6 * along->least) << row.candidate.method.id;
    EXPECT_LT(row.h_max, 0.8 * predict(row.candidate.method, advice.model->near).h_max.value())
        << row.candidate.method.id;
  }
}

TEST(Deadlines, MayBeMissedByOneFrameInAThousand) {
  EXPECT_FALSE(is_late(0, 10));
  EXPECT_FALSE(is_late(1, 10));  // the machine's
  EXPECT_TRUE(is_late(2, 1999));
  EXPECT_FALSE(is_late(2, 2000));
}

TEST(FrameTimes, AreOrderStatistics) {
  std::vector<double> frames;
  for (int i = 1; i <= 200; ++i) frames.push_back(i);
  const FrameTimes times = frame_times(frames);
  EXPECT_EQ(times.p50, 100);
  EXPECT_EQ(times.p99, 198);
  EXPECT_EQ(times.max, 200);
  ASSERT_EQ(times.tail.size(), frame_shares.size() - 1) << "a thousandth of 200 frames is no frame";
  EXPECT_EQ(times.tail[3], 100);
  EXPECT_EQ(times.tail.back(), 199);
  EXPECT_TRUE(frame_times({}).tail.empty());
  EXPECT_TRUE(std::isnan(frame_times({}).p50));
}

}  // namespace
}  // namespace hmax
