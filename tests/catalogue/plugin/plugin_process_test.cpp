#include "catalogue/plugin/plugin_process.hpp"

#include <chrono>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <pthread.h>
#include <string>
#include <sys/time.h>
#include <sys/wait.h>
#include <thread>

#include <gtest/gtest.h>

#include "analysis/spectrum/linear_model.hpp"
#include "catalogue/methods/catalogue.hpp"
#include "catalogue/models/problems.hpp"
#include "catalogue/plugin/plugin_model.hpp"
#include "catalogue/plugin/plugin_stepper.hpp"
#include "core/errors.hpp"
#include "limits/predict.hpp"
#include "tests/results/scratch.hpp"
#include "tests/says.hpp"

namespace hmax {
namespace {

PluginName tested(const std::string& entry) { return parse_plugin(std::string(TESTED_PLUGIN) + ":" + entry); }

std::string error_of_step(const std::string& entry, double h, double patience = 10) {
  return error_of<InputError>([&] { PluginStepper(tested(entry), {.patience = patience}).step(h, 1); });
}

void expect_no_child() { EXPECT_EQ(waitpid(-1, nullptr, WNOHANG), -1); }

TEST(Plugin, StepsRestoresAndSetsStates) {
  PluginStepper chain(tested("chain:3"));
  EXPECT_EQ(chain.name(), "chain:3");
  EXPECT_EQ(chain.note(), "masses on springs");
  ASSERT_EQ(chain.dim(), 6);
  chain.save(0);
  const Eigen::VectorXd y = Eigen::VectorXd::Unit(6, 0);
  const Eigen::VectorXd next = chain.after(0, y, 0.001, 1);
  EXPECT_DOUBLE_EQ(next[3], -20);
  EXPECT_DOUBLE_EQ(next[0], 1 - 0.02);
  EXPECT_EQ(chain.state(), next);
  chain.restore(0);
  EXPECT_EQ(chain.state(), Eigen::VectorXd::Zero(6));
  chain.set_state(y);
  ASSERT_TRUE(chain.step(0.001, 1));
  EXPECT_EQ(chain.state(), next);
}

TEST(Plugin, HasPartsAndAStepSizeOfItsOwn) {
  PluginStepper engine(tested("parted:100,2,50,1,25,0"));
  EXPECT_EQ(engine.own_step(), 0.1);
  EXPECT_EQ(engine.note(), "");
  const std::vector<ScenePart> parts = engine.parts();
  ASSERT_EQ(parts.size(), 3);
  EXPECT_EQ(parts[0].kind, "spring");
  EXPECT_EQ(parts[0].name, "first");
  EXPECT_EQ(parts[0].stiffness, 100);
  EXPECT_EQ(parts[0].damping, 2);
  EXPECT_EQ(parts[1].name, "second one ");
  EXPECT_EQ(parts[2].name, "");
  EXPECT_EQ(parts[2].stiffness, 25);
  engine.save(0);
  engine.scale_part(1, 3, 2);
  const Eigen::VectorXd y = Eigen::VectorXd::Unit(6, 2) + Eigen::VectorXd::Unit(6, 3);
  EXPECT_DOUBLE_EQ(engine.after(0, y, 0.01, 1)[3], 1 - 0.01 * (150 + 2));
  // Tables of earlier versions end before them.
  PluginStepper earlier(parse_plugin(std::string(TESTED_PLUGIN_EARLIER) + ":parted:100,2"));
  EXPECT_FALSE(earlier.own_step());
  EXPECT_TRUE(earlier.parts().empty());
  EXPECT_TRUE(says(error_of<InputError>([] { PluginStepper(tested("rigid:100,2")); }),
                   "both of parts and scale_part"));
}

TEST(Plugin, CrashesAreErrorsThatNameTheStep) {
  EXPECT_EQ(
      error_of_step("crash:segv", 0.5),
      "the plugin crashed in step(0.5) with signal 11 (Segmentation fault); run it in a debugger, or try other step "
      "sizes");
  EXPECT_EQ(error_of_step("crash:segv", 0.001), "");
  EXPECT_TRUE(says(error_of_step("crash:abort", 0.02), "in step(0.02) with signal 6"));
  EXPECT_EQ(error_of_step("crash:exit", 0.02),
            "the plugin ended the process in step(0.02) with exit code 7; a plugin returns a code instead");
  EXPECT_EQ(error_of_step("crash:throw", 0.02), "step of the plugin threw an exception: no scene");
  EXPECT_EQ(error_of_step("crash:code", 0.02), "step(0.02) of the plugin failed: the contact solver gave up");
  EXPECT_TRUE(says(error_of_step("start:crash", 0.1), "crashed in create() with signal 11"));
  expect_no_child();
}

TEST(Plugin, HangsEndAfterTheTimeThatTheyAreGiven) {
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_EQ(error_of_step("crash:hang", 0.02, 0.2),
            "the plugin did not return within 0.2 s in step(0.02); --timeout gives it longer");
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(20));
  expect_no_child();
}

TEST(Plugin, IsEndedBeforeItTakesTheProcessesOfTheMachine) {
  const auto steps = [](int in_a_call) {
    PluginStepper engine(tested("unruly:forks"));
    for (int i = 0; i < 200; i += in_a_call) engine.step(0.001, in_a_call);
  };
  for (const int in_a_call : {1, 200})
    EXPECT_EQ(error_of<InputError>([&] { steps(in_a_call); }),
              "the plugin has more than 500 processes; start fewer, and wait for those that have ended");
  expect_no_child();
}

TEST(Plugin, LeavesNoChildWhereThereIsNoThreadForItsOutput) {
  pthread_attr_t usual, endless;
  ASSERT_EQ(pthread_getattr_default_np(&usual), 0);
  pthread_attr_init(&endless);
  ASSERT_EQ(pthread_attr_setstacksize(&endless, std::size_t{1} << 46U), 0);
  ASSERT_EQ(pthread_setattr_default_np(&endless), 0);
  const std::string error = error_of_step("chain:3", 0.001);
  pthread_setattr_default_np(&usual);
  EXPECT_TRUE(says(error, "the system has no thread for the output of the plugin"));
  expect_no_child();
  sigset_t blocked;
  pthread_sigmask(SIG_SETMASK, nullptr, &blocked);
  EXPECT_FALSE(sigismember(&blocked, SIGINT));
}

TEST(Plugin, LongSeriesOfShortStepsAreNoHang) {
  PluginStepper chain(tested("chain:2000"), {.patience = 0.3});
  EXPECT_TRUE(chain.step(1e-4, 100000));
}

TEST(Plugin, WhoWatchesMayLeave) {
  struct Left {};
  PluginStepper engine(tested("crash:hang"), {.watch = [] { throw Left{}; }});
  EXPECT_THROW(engine.step(0.1, 1), Left);
  expect_no_child();
  EXPECT_EQ(error_of<InputError>([&] { engine.step(0.001, 1); }),
            "the plugin has ended; start the command again");
}

TEST(Plugin, AStepThatCannotBeDoneIsDivergence) {
  PluginStepper engine(tested("crash"));
  engine.save(0);
  EXPECT_FALSE(engine.step(0.1, 3));
  EXPECT_TRUE(engine.after(0, engine.state(), 0.1, 1).array().isNaN().all());
  EXPECT_TRUE(engine.step(0.001, 3));
}

TEST(Plugin, WhatCannotBeLoadedSaysWhy) {
  const auto error = [](const std::string& text) {
    return error_of<InputError>([&] { PluginStepper engine(parse_plugin(text)); });
  };
  EXPECT_EQ(error("no.so"), "there is no file 'no.so'; give the path of the shared library");
  EXPECT_EQ(error("/tmp:a"), "'/tmp' is no file; give the path of the shared library");
  EXPECT_TRUE(says(error(HMAX_SOURCE_DIR "/README.md"), "the plugin cannot be loaded: "));
  EXPECT_TRUE(says(error(TESTED_PLUGIN_NAMELESS), "has no function hmax_plugin_get; see hmax/plugin.h"));
  EXPECT_EQ(
      error(TESTED_PLUGIN_VERSION),
      "the plugin has version 99 of hmax/plugin.h and hmax has 3; compile it with the header of this hmax");
  const std::string file = TESTED_PLUGIN;
  EXPECT_EQ(error(file + ":chains").substr(0, 56),
            "the plugin has no entry 'chains'; it has chain, float_ch");
  EXPECT_EQ(error(file + ":neither"), "an entry of the plugin must have either a model or a stepper");
  EXPECT_EQ(error(file + ":start:empty"), "dimension() of the plugin is 0; it must be 1 to 10000000");
  EXPECT_EQ(error(file + ":start:refuse"), "create of the plugin threw an exception: refused");
  EXPECT_EQ(error(EXAMPLE_MODEL),
            "'pendulum' of the plugin is a model and has no step of its own; name a stepper");
  expect_no_child();
}

TEST(Plugin, AFolderMayHaveAColonInItsName) {
  const Scratch scratch;
  std::filesystem::create_directory(scratch / "build:2");
  const std::string file = scratch / "build:2/model.so";
  write_text(file, "");
  const PluginName plugin = parse_plugin(file + ":pendulum:a:b");
  EXPECT_EQ(plugin.file, file);
  EXPECT_EQ(plugin.name, "pendulum");
  EXPECT_EQ(plugin.argument, "a:b");
}

TEST(Plugin, AModelIsAProblem) {
  const Problem problem = plugin_problem(parse_plugin(std::string(EXAMPLE_MODEL) + ":pendulum:500"));
  EXPECT_EQ(problem.id.substr(0, 9), "pendulum#");
  EXPECT_EQ(problem.t_end, 2);
  ASSERT_TRUE(is_second_order(problem));
  const auto& system = std::get<AnySystem>(problem.system);
  const Eigen::VectorXd rest = Eigen::VectorXd::Zero(8);
  Eigen::VectorXd dydt(8);
  system.rhs(0, rest, dydt);
  EXPECT_LT(dydt.cwiseAbs().maxCoeff(), 1e-12);  // the displacements are those from rest
  system.rhs(0, problem.y0, dydt);
  EXPECT_GT(dydt.cwiseAbs().maxCoeff(), 0.1);  // and it starts beside it
  AnySystem::Jacobian J;
  system.jacobian(0, problem.y0, J);
  JacobianOrigin origin{};
  const Eigen::MatrixXd differences = dense(detail::jacobian_by_differences(system, 0, problem.y0, origin));
  EXPECT_LT((dense(J) - differences).cwiseAbs().maxCoeff(), 1e-3);  // of 10000
  AnySystem::DofMatrix K;
  system.stiffness(0, rest.head(4), rest.tail(4), K);
  const Eigen::MatrixXd& stiffness = std::get<Eigen::MatrixXd>(K);
  EXPECT_NEAR(stiffness(1, 1), 1000, 1e-9);
  EXPECT_NEAR(stiffness(1, 3), -500, 1e-9);
  EXPECT_EQ(stiffness, stiffness.transpose());
  EXPECT_EQ(error_of<InputError>([] { plugin_problem(tested("chain")); }),
            "'chain' of the plugin is a stepper and no model; use `hmax probe` for it");
}

TEST(Plugin, OneOfAnEarlierVersionWorksAndIsNotAskedForMore) {
  const auto pattern = [](const char* file) {
    return PluginStepper(parse_plugin(std::string(file) + ":coupled:4")).pattern();
  };
  EXPECT_EQ(pattern(TESTED_PLUGIN_EARLIER).size(), 0);
  EXPECT_EQ(pattern(TESTED_PLUGIN).rows(), 8);
}

TEST(Plugin, CouplingsAreThoseOfGroupsWithinReach) {
  const Eigen::MatrixXd near = Eigen::MatrixXd(PluginStepper(tested("reaching:6:1")).pattern()),
                        far = Eigen::MatrixXd(PluginStepper(tested("reaching:6:2")).pattern());
  for (int i = 0; i < 12; ++i)
    for (int j = 0; j < 12; ++j) {
      EXPECT_EQ(near(i, j) != 0, std::abs(i % 6 - j % 6) <= 1) << i << " " << j;
      EXPECT_EQ(far(i, j) != 0, std::abs(i % 6 - j % 6) <= 2) << i << " " << j;
    }
}

TEST(Plugin, ModelsOfOtherFilesOrArgumentsHaveOtherIds) {
  const auto id = [](const std::string& text) { return plugin_problem(parse_plugin(text)).id; };
  const std::string file = TESTED_PLUGIN, name = ":faulty";
  EXPECT_EQ(id(file + name), id(file + name));
  EXPECT_NE(id(file + name), id(file + name + ":nan:1000"));
  EXPECT_NE(id(file + name), id(TESTED_PLUGIN_EARLIER + name));
}

/// What `calls` right-hand sides of a model say that goes wrong as `argument` tells it.
std::string error_of_rhs(const std::string& argument, double patience, int calls = 10) {
  return error_of<InputError>([&] {
    const Problem problem = make_problem(plugin_id(std::string(TESTED_PLUGIN) + ":faulty:" + argument),
                                         {.parameters = {{std::string(patience_parameter), patience}}});
    Eigen::VectorXd dydt(1);
    for (int i = 0; i < calls; ++i) {
      std::get<AnySystem>(problem.system).rhs(0, problem.y0, dydt);
      ASSERT_EQ(dydt[0], -10);
    }
  });
}

TEST(Plugin, AModelThatHangsEndsAfterTheTimeThatItIsGiven) {
  EXPECT_EQ(error_of_rhs("hang:3", 0.2),
            "the plugin did not return within 0.2 s in rhs(); --timeout gives it longer");
  EXPECT_EQ(error_of_rhs("slow:3", 0.2), "");
  EXPECT_EQ(error_of_rhs("", -1), "--timeout -1 is not positive; give seconds");
  expect_no_child();
}

TEST(Plugin, AModelThatEndsItsProcessIsAnErrorThatNamesTheCall) {
  for (const std::string at : {"0", "3", "5000"}) {
    EXPECT_TRUE(says(error_of_rhs("segv:" + at, 10, 6000), "the plugin crashed in rhs() with signal 11"));
    EXPECT_TRUE(says(error_of_rhs("kill:" + at, 10, 6000), "the plugin crashed in rhs() with signal 9"));
    EXPECT_EQ(error_of_rhs("exit:" + at, 10, 6000),
              "the plugin ended the process in rhs() with exit code 7; a plugin returns a code instead");
  }
  expect_no_child();
}

TEST(Plugin, AModelThatIsNotDeterministicIsRefused) {
  EXPECT_TRUE(
      says(error_of_rhs("noise:0", 10), "is not deterministic: two calls at t = 0 with one state give -10."));
  expect_no_child();
}

TEST(Plugin, AModelThatDestroysWhatItSharesWithHmaxIsAnError) {
  for (const std::string with : {"zeros", "ones"})
    EXPECT_EQ(error_of_rhs(with + ":3", 10),
              "the plugin destroyed the memory of its process; check the bounds of its arrays");
  // While hmax reads: numbers may be wrong, but nothing is read out of bounds, and it ends.
  const std::string ending = error_of<InputError>([] {
    const Problem problem = plugin_problem(tested("faulty:threads:3"), {.patience = 1});
    Eigen::VectorXd dydt(1);
    while (true) std::get<AnySystem>(problem.system).rhs(0, problem.y0, dydt);
  });
  EXPECT_TRUE(says(ending, "the plugin"));
  expect_no_child();
}

TEST(Plugin, EveryCallForADifferenceHasItsOwnTime) {
  const Problem problem = plugin_problem(tested("faulty:slower:0"), {.patience = 1});
  const auto& system = std::get<AnySystem>(problem.system);
  EXPECT_FALSE(system.has_jacobian());
  Eigen::VectorXd above(1), below(1);  // calls of 0.6 s
  system.rhs(0, problem.y0.array() + 1e-6, above);
  system.rhs(0, problem.y0.array() - 1e-6, below);
  EXPECT_NEAR((above[0] - below[0]) / 2e-6, -10, 1e-6);
}

TEST(Plugin, AStiffnessThatIsNotOfTheForceIsRefused) {
  EXPECT_EQ(plugin_problem(tested("stiff_pendulums")).y0.size(), 6);
  const std::string error =
      error_of<InputError>([] { (void)plugin_problem(tested("stiff_pendulums:negative")); });
  EXPECT_TRUE(says(error, "stiffness() of the plugin is not the derivative of its force()"));
}

TEST(Plugin, DifferencesAreThoseOfTheFormulaInArraysThatAreAligned) {
  const Problem problem = plugin_problem(tested("pendulums"));
  const auto& system = std::get<AnySystem>(problem.system);
  const Eigen::VectorXd q = problem.y0.head(3), v = problem.y0.tail(3);
  AnySystem::DofMatrix K, C;
  system.stiffness(0, q, v, K);
  system.damping(0, q, v, C);
  // Central differences at increments of 6e-6 of each number, and of a thousandth of the largest at least, to
  // the last bit.
  const auto by_differences = [](const Eigen::VectorXd& x, const auto& f) {
    Eigen::MatrixXd J = Eigen::MatrixXd::Zero(3, 3);
    const double least = 1e-3 * x.cwiseAbs().maxCoeff();
    for (int i = 0; i < 3; ++i) {
      const double d = 6e-6 * std::max(std::abs(x[i]), least);
      J(i, i) = -((f(i, x[i] + d) - f(i, x[i] - d)) / (2 * d));
    }
    return J;
  };
  EXPECT_EQ(std::get<Eigen::MatrixXd>(K),
            by_differences(q, [&](int i, double x) { return -std::sin(x) - 0.1 * v[i] * std::abs(v[i]); }));
  EXPECT_EQ(std::get<Eigen::MatrixXd>(C),
            by_differences(v, [&](int i, double x) { return -std::sin(q[i]) - 0.1 * x * std::abs(x); }));
}

TEST(Plugin, AChildThatSleepsIsWoken) {
  const Problem problem = plugin_problem(tested("faulty"));
  Eigen::VectorXd dydt(1);
  for (int i = 0; i < 20; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
    std::get<AnySystem>(problem.system).rhs(0, problem.y0, dydt);
    ASSERT_EQ(dydt[0], -10);
  }
}

TEST(Plugin, SignalsThatInterruptAWaitChangeNothing) {
  const struct sigaction before = [] {
    struct sigaction counting = {}, old = {};
    counting.sa_handler = [](int) {};
    sigaction(SIGALRM, &counting, &old);
    return old;
  }();
  const itimerval often{.it_interval = {.tv_sec = 0, .tv_usec = 500},
                        .it_value = {.tv_sec = 0, .tv_usec = 500}},
      never{};
  setitimer(ITIMER_REAL, &often, nullptr);
  EXPECT_EQ(error_of_rhs("slow:0", 10), "");
  setitimer(ITIMER_REAL, &never, nullptr);
  sigaction(SIGALRM, &before, nullptr);
}

TEST(Plugin, AModelHasStepLimits) {
  const Problem problem = plugin_problem(parse_plugin(EXAMPLE_MODEL));
  const Prediction row = predict(find_method("symplectic_euler"), linearised(problem));
  ASSERT_TRUE(row.h_max) << row.note;
  // The faster of two stretching modes, k / m (3 + sqrt(5)) / 2.
  EXPECT_NEAR(*row.h_max, 2 / std::sqrt(1e4 * (3 + std::sqrt(5)) / 2), 2e-5);
}

}  // namespace
}  // namespace hmax
