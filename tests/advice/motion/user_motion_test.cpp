#include "advice/motion/user_motion.hpp"

#include <fstream>

#include <gtest/gtest.h>

#include "advice/advise.hpp"
#include "catalogue/methods/catalogue.hpp"
#include "catalogue/models/problems.hpp"
#include "core/errors.hpp"
#include "problems/tissue/body.hpp"
#include "tests/results/scratch.hpp"
#include "tests/says.hpp"

namespace hmax {
namespace {

std::filesystem::path written(const Scratch& scratch, const std::string& text) {
  const std::filesystem::path file = scratch / "motion.csv";
  std::ofstream(file) << text;
  return file;
}

Problem pressed_cube(const std::string& load) { return make_problem("fem_green/" + load + "@cube:n=2", {}); }

TEST(UserMotion, PressesWithForcesOverTime) {
  const Scratch scratch;
  const UserMotion user = read_user_motion(written(scratch, "t,fx,fz\n0,0,0\n0.1,0.02,-0.01\n0.3,0,0\n"));
  EXPECT_EQ(user.kind, UserMotion::Kind::forces);
  EXPECT_EQ(user.t_end, 0.3);
  const ProbingMotion motion = probing_motion(pressed_cube("gravity"), user);
  const TissueBody& body = *motion.problem.body;
  EXPECT_GT(motion.problem.y0.norm(), 0);  // it rests under gravity
  const Eigen::VectorXd q = motion.problem.y0.head(body.dofs()), zero = Eigen::VectorXd::Zero(body.dofs());
  const auto pushed = [&](double t) {
    Eigen::VectorXd f(body.dofs());
    body.force(t, q, zero, f);
    const Eigen::Vector3d sum = Eigen::Map<const Eigen::Matrix3Xd>(f.data(), 3, f.size() / 3).rowwise().sum();
    return sum;
  };
  EXPECT_LT(pushed(0).norm(), 1e-9);
  EXPECT_LT((pushed(0.1) - Eigen::Vector3d(0.02, 0, -0.01)).norm(), 1e-9);
  EXPECT_LT(pushed(5).norm(), 1e-9);
}

TEST(UserMotion, MovesPoints) {
  const Scratch scratch;
  UserMotion user =
      read_user_motion(written(scratch, "t [s],x [m],y [m]\n0,0,0\n0.1,0.002,0.001\n0.4,0.002,0\n"));
  EXPECT_EQ(user.kind, UserMotion::Kind::displacements);
  EXPECT_THROW(probing_motion(pressed_cube("press"), user), InputError);  // of no point
  user.points = {26};
  const ProbingMotion motion = probing_motion(pressed_cube("press"), user);
  const TissueBody& body = *motion.problem.body;
  const Eigen::VectorXd rest = Eigen::VectorXd::Zero(body.dofs());
  const Eigen::Vector3d moved = body.positions(0.1, rest).col(26) - body.mesh().points.col(26);
  EXPECT_LT((moved - Eigen::Vector3d(0.002, 0.001, 0)).norm(), 1e-15);
}

TEST(UserMotion, IsWhatStepsAreJudgedBy) {
  const Scratch scratch;
  AdviceQuestion asked;
  asked.rate = 100;
  asked.frames = 20;
  asked.proof = 1;
  asked.motion = read_user_motion(written(scratch, "t,fz\n0,0\n0.1,-0.02\n0.2,0\n"));
  const Problem problem = pressed_cube("press");
  asked.methods = choose_methods({"symplectic_euler", "newmark"}, {problem});
  const Advice advice = advise(problem, asked);
  EXPECT_NE(advice.recommended(), nullptr);
  EXPECT_TRUE(says(advice.motion, "motion.csv"));
  EXPECT_EQ(advice.t_end, 0.2);
}

// Beside gravity a body stays at its equilibrium but for rounding, which no steps resolve.
TEST(UserMotion, IsRefusedWhereNothingMoves) {
  const Scratch scratch;
  const UserMotion still = read_user_motion(written(scratch, "t,fz\n0,0\n0.2,0\n"));
  for (const char* load : {"press", "gravity"}) {
    const ProbingMotion motion = probing_motion(pressed_cube(load), still);
    EXPECT_TRUE(says(error_of<InputError>([&] { reference_motion(motion, 0.01, 0.01); }), "initial state"))
        << load;
  }
}

TEST(UserMotion, RefusesWhatIsNone) {
  const Scratch scratch;
  const auto refused = [&](const std::string& text, const std::string& why) {
    EXPECT_TRUE(says(error_of<InputError>([&] { read_user_motion(written(scratch, text)); }), why));
  };
  refused("fx\n0\n1\n", "no column t");
  refused("t,a\n0,0\n1,1\n", "neither fx");
  refused("t,fx\n0,0\n", "two lines");
  refused("t,fx\n1,0\n2,0\n", "begin at t = 0");
  refused("t,fx\n0,0\n0,1\n", "increasing times");
  refused("t,fx\n0,0\n1,nan\n", "not finite");
  const UserMotion user = read_user_motion(written(scratch, "t,fx\n0,0\n1,1\n"));
  EXPECT_THROW(probing_motion(make_problem("liver_forced"), user), InputError);
}

}  // namespace
}  // namespace hmax
