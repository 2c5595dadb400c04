#include "analysis/statics/static_solution.hpp"

#include <gtest/gtest.h>

#include "core/errors.hpp"
#include "tests/integrators/motion.hpp"
#include "tests/says.hpp"

namespace hmax {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using Sparse = Eigen::SparseMatrix<double>;

double no_clock() { return 0; }

/// A chain of springs under a force at every mass.
StaticModel pulled_chain(Index n, double k3, double force, double tie = 0) {
  const Chain<VectorXd, Sparse> chain{n, 5, k3, 0, 0};
  const VectorXd zero = VectorXd::Zero(n);
  return {.dofs = n,
          .force =
              [=](const VectorXd& q, VectorXd& f) {
                f.resize(n);
                chain.force(0, q, zero, f);
                f.array() += force;
                f[0] -= tie * q[0];
              },
          .stiffness =
              [=](const VectorXd& q, Sparse& K) {
                chain.stiffness(0, q, zero, K);
                K.coeffRef(0, 0) += tie;
              }};
}

/// Spring i carries the load of the masses beyond it: k e + k3 e^3 = (n - i) F.
VectorXd expected(Index n, double k3, double force) {
  VectorXd q(n);
  double sum = 0;
  for (Index i = 0; i < n; ++i) {
    const double load = force * static_cast<double>(n - i);
    double e = load / 5;
    for (int k = 0; k < 100; ++k) e -= (5 * e + k3 * e * e * e - load) / (5 + 3 * k3 * e * e);
    q[i] = sum += e;
  }
  return q;
}

TEST(StaticSolution, IsFoundByEveryMethodAndSolver) {
  const StaticModel model = pulled_chain(12, 0.2, 0.1);
  const VectorXd q = expected(12, 0.2, 0.1);
  for (const StaticMethod method : {StaticMethod::newton, StaticMethod::modified_newton})
    for (const InnerSolver inner : {InnerSolver::direct, InnerSolver::sor, InnerSolver::conjugate_gradients})
      for (const int steps : {1, 3}) {
        const StaticSolution found = solve_static(
            model, {.method = method, .inner = inner, .iterations = 500, .load_steps = steps}, no_clock);
        EXPECT_TRUE(found.converged) << name_of(method) << ' ' << name_of(inner) << found.note;
        EXPECT_LT((found.q - q).norm(), 1e-7 * q.norm()) << name_of(method) << ' ' << name_of(inner);
        EXPECT_EQ(found.history.size(), static_cast<std::size_t>(found.iterations + steps));
      }
}

TEST(StaticSolution, ConvergesQuadraticallyOnlyWithTheTangentOfEveryIterate) {
  const StaticModel model = pulled_chain(6, 1, 1);
  const StaticSolution newton = solve_static(model, {}, no_clock);
  const StaticSolution modified =
      solve_static(model, {.method = StaticMethod::modified_newton, .iterations = 1000}, no_clock);
  ASSERT_TRUE(newton.converged && modified.converged);
  EXPECT_LT(newton.iterations, 15);
  EXPECT_GT(modified.iterations, 2 * newton.iterations);
  const auto& last = newton.history;
  EXPECT_LT(last[last.size() - 1].residual, 100 * std::pow(last[last.size() - 2].residual, 2) + 1e-14);
}

TEST(StaticSolution, SolvesLinearSystemsOnlyAsWellAsNewtonsMethodNeeds) {
  const StaticModel model = pulled_chain(60, 0.2, 0.1);
  StaticSettings settings{.inner = InnerSolver::sor, .inner_iterations = 100'000};
  const StaticSolution loose = solve_static(model, settings, no_clock);
  settings.inner_tolerance = 1e-8;
  const StaticSolution tight = solve_static(model, settings, no_clock);
  ASSERT_TRUE(loose.converged && tight.converged);
  EXPECT_LE(loose.iterations, tight.iterations + 3);
  EXPECT_LT(2 * loose.history.back().inner, tight.history.back().inner);
}

TEST(StaticSolution, OfALinearModelIsOneSystem) {
  const StaticSolution found =
      solve_static(pulled_chain(9, 0, 2), {.method = StaticMethod::linear}, no_clock);
  EXPECT_TRUE(found.converged);
  EXPECT_EQ(found.iterations, 1);
  EXPECT_LT((found.q - expected(9, 0, 2)).norm(), 1e-12 * found.q.norm());
  EXPECT_LT(found.history.back().residual, 1e-12);
  // What a linear solution leaves out of a nonlinear model shows in its residual.
  const StaticSolution beside =
      solve_static(pulled_chain(9, 1, 2), {.method = StaticMethod::linear}, no_clock);
  EXPECT_GT(beside.history.back().residual, 1);
  EXPECT_TRUE(says(beside.note, "not linear"));
  // What sweeps leave of the system is no force.
  const StaticSolution swept = solve_static(
      pulled_chain(9, 0, 2), {.method = StaticMethod::linear, .inner = InnerSolver::sor}, no_clock);
  EXPECT_GT(swept.history.back().residual, 1e-9);
  EXPECT_FALSE(says(swept.note, "not linear"));
  EXPECT_TRUE(says(swept.note, "the linear system is solved to"));
  EXPECT_TRUE(says(swept.remedy, "tolerance of sor"));
}

TEST(StaticSolution, SaysWhyThereIsNone) {
  // Springs that soften bear no more than (2/3) k sqrt(k / (3 |k3|)).
  const StaticSolution torn = solve_static(pulled_chain(3, -1, 3), {}, no_clock);
  EXPECT_FALSE(torn.converged);
  EXPECT_FALSE(torn.note.empty());
  EXPECT_TRUE(torn.q.allFinite());
  // The first spring holds the whole chain; without it nothing does.
  const StaticSolution adrift = solve_static(pulled_chain(3, 0, 1, -5), {}, no_clock);
  EXPECT_FALSE(adrift.converged);
  EXPECT_TRUE(says(adrift.note, "supports"));
  const StaticSolution tired =
      solve_static(pulled_chain(400, 0, 1), {.inner = InnerSolver::sor, .inner_iterations = 5}, no_clock);
  EXPECT_FALSE(tired.converged);
  EXPECT_TRUE(says(tired.note, "sor"));
}

/// A shallow arch under a load at its top, E = (q^2 - 2 q)^2 / 4 - P q: it bears P = 2 / (3 sqrt(3)), and
/// under more snaps through to the other side.
StaticModel shallow_arch(double load) {
  return {.dofs = 1,
          .force = [=](const VectorXd& q,
                       VectorXd& f) { f = load - ((q.array() - 2) * q.array() * (q.array() - 1)); },
          .stiffness =
              [](const VectorXd& q, Sparse& K) {
                K.resize(1, 1);
                K.coeffRef(0, 0) = 3 * q[0] * q[0] - 6 * q[0] + 2;
                K.makeCompressed();
              },
          .energy = [=](const VectorXd& q) { return std::pow(q[0] * q[0] - 2 * q[0], 2) / 4 - load * q[0]; }};
}

TEST(StaticSolution, SnapsThroughWhereTheEnergyLeads) {
  StaticModel arch = shallow_arch(0.4);
  for (const InnerSolver inner : {InnerSolver::direct, InnerSolver::sor, InnerSolver::conjugate_gradients})
    for (const int steps : {1, 7}) {
      const StaticSolution found = solve_static(arch, {.inner = inner, .load_steps = steps}, no_clock);
      ASSERT_TRUE(found.converged) << name_of(inner) << ' ' << found.note;
      EXPECT_TRUE(found.note.empty()) << found.note;
      EXPECT_NEAR((found.q[0] - 2) * found.q[0] * (found.q[0] - 1), 0.4, 1e-8);
      EXPECT_GT(found.q[0], 2);
    }
  // The residual alone has a valley where the arch gives way.
  arch.energy = nullptr;
  EXPECT_FALSE(solve_static(arch, {}, no_clock).converged);
  // What it still bears it bears on this side.
  EXPECT_LT(solve_static(shallow_arch(0.3), {.load_steps = 5}, no_clock).q[0], 1);
}

/// A column pressed along x that gives way to either side y, E = x^2 / 2 + (1 - x) y^2 / 2 + y^4 / 4 - P x.
/// Beyond P = 1 the straight equilibrium (P, 0) is a saddle, and the stable ones are x = 2 P - 1, y^2 = x
/// - 1.
StaticModel column(double P) {
  return {.dofs = 2,
          .force =
              [=](const VectorXd& q, VectorXd& f) {
                const double x = q[0], y = q[1];
                f.resize(2);
                f << P - x + y * y / 2, -(1 - x) * y - y * y * y;
              },
          .stiffness =
              [](const VectorXd& q, Sparse& K) {
                const double x = q[0], y = q[1];
                Eigen::Matrix2d dense;
                dense << 1, -y, -y, 1 - x + 3 * y * y;
                K.resize(2, 2);
                for (int i = 0; i < 2; ++i)
                  for (int j = 0; j < 2; ++j) K.coeffRef(i, j) = dense(i, j);
                K.makeCompressed();
              },
          .energy =
              [=](const VectorXd& q) {
                const double x = q[0], y = q[1];
                return x * x / 2 + (1 - x) * y * y / 2 + y * y * y * y / 4 - P * x;
              }};
}

TEST(StaticSolution, LeavesAnEquilibriumThatIsNotStable) {
  for (const InnerSolver inner : {InnerSolver::direct, InnerSolver::conjugate_gradients})
    for (const double P : {1.2, 2.0, 5.0})
      for (const int steps : {1, 4}) {
        const StaticSolution found = solve_static(column(P), {.inner = inner, .load_steps = steps}, no_clock);
        ASSERT_TRUE(found.converged) << name_of(inner) << ' ' << P << ' ' << found.note;
        EXPECT_NEAR(found.q[0], 2 * P - 1, 1e-7) << name_of(inner) << ' ' << P << ' ' << steps;
        EXPECT_NEAR(std::abs(found.q[1]), std::sqrt(2 * P - 2), 1e-7) << name_of(inner) << ' ' << P;
      }
  EXPECT_NEAR(solve_static(column(0.9), {}, no_clock).q[0], 0.9, 1e-9);
  // With the stiffness at rest too, which is taken up again after the look at that of the equilibrium.
  const StaticSolution modified = solve_static(
      column(1.2), {.method = StaticMethod::modified_newton, .iterations = 1000, .load_steps = 3}, no_clock);
  ASSERT_TRUE(modified.converged) << modified.note;
  EXPECT_NEAR(modified.q[0], 1.4, 1e-7);
  // Without a search Newton's method takes the straight one, and so does a search that may end in saddles.
  EXPECT_NEAR(solve_static(column(2), {.leave_saddles = false}, no_clock).q[0], 2, 1e-7);
  EXPECT_NEAR(solve_static(column(2), {.line_search = false}, no_clock).q[0], 2, 1e-7);
}

/// At (P, 0) the stiffness is diag(1, 1 - P).
TEST(StaticSolution, SaysWhetherItsEquilibriumIsStable) {
  for (const auto method : {StaticMethod::newton, StaticMethod::modified_newton})
    for (const auto& [searches, leaves] : {std::pair{false, true}, {true, false}}) {
      StaticSettings settings{.method = method, .line_search = searches, .leave_saddles = leaves};
      const StaticSolution saddle = solve_static(column(1.5), settings, no_clock);
      ASSERT_TRUE(saddle.converged);
      EXPECT_NEAR(saddle.q[0], 1.5, 1e-7);
      EXPECT_EQ(saddle.stable, false);
      EXPECT_TRUE(says(saddle.note, "is a saddle"));
      EXPECT_TRUE(says(saddle.remedy, "line search"));
      const StaticSolution below = solve_static(column(0.9), settings, no_clock);
      EXPECT_EQ(below.stable, true);
      EXPECT_EQ(below.note, "");
    }
  EXPECT_EQ(solve_static(column(1.5), {}, no_clock).stable, true);
  EXPECT_EQ(solve_static(column(1.5), {.load_steps = 4}, no_clock).stable, true);
  StaticModel without_energy = column(1.5);
  without_energy.energy = nullptr;
  EXPECT_EQ(solve_static(without_energy, {}, no_clock).stable, false);
  EXPECT_EQ(solve_static(column(1.5), {.method = StaticMethod::linear}, no_clock).stable, std::nullopt);
}

TEST(StaticSolution, EndsWhereRoundingDoes) {
  // Forces that are known to 1e-6 of the load.
  StaticModel noisy = pulled_chain(6, 1, 1);
  const auto exact = noisy.force;
  noisy.force = [=](const VectorXd& q, VectorXd& f) {
    exact(q, f);
    f[3] += 1e-6 * std::sin(1e9 * q[3]);
  };
  EXPECT_FALSE(solve_static(noisy, {.tolerance = 1e-10}, no_clock).converged);
  noisy.rounding = 2e-6;
  const StaticSolution found = solve_static(noisy, {.tolerance = 1e-10}, no_clock);
  EXPECT_TRUE(found.converged);
  EXPECT_TRUE(says(found.note, "rounding"));
  EXPECT_LT(found.iterations, 20);
  EXPECT_LT((found.q - expected(6, 1, 1)).norm(), 1e-5 * found.q.norm());
}

TEST(StaticSolution, StopsWhereItMayNotGoOn) {
  StaticModel arch = shallow_arch(0.4);
  arch.admissible = [](const VectorXd& q) { return q[0] < 1.5; };
  const StaticSolution found = solve_static(arch, {}, no_clock);
  EXPECT_FALSE(found.converged);
  EXPECT_TRUE(found.barred);
  EXPECT_LT(found.q[0], 1.5);
  EXPECT_GT(found.q[0], 1.4);
}

TEST(StaticSolution, WithoutALoadIsRest) {
  const StaticSolution found = solve_static(pulled_chain(4, 1, 0), {}, no_clock);
  EXPECT_TRUE(found.converged);
  EXPECT_EQ(found.q, VectorXd::Zero(4));
}

TEST(StaticSolution, RefusesSettingsOutOfRange) {
  const StaticModel model = pulled_chain(4, 1, 1);
  EXPECT_THROW(solve_static(model, {.tolerance = 0}, no_clock), InputError);
  EXPECT_THROW(solve_static(model, {.load_steps = 0}, no_clock), InputError);
  EXPECT_THROW(solve_static(model, {.relaxation = 2}, no_clock), InputError);
  EXPECT_THROW(pseudo_dynamic(model, {}, 0, 1, no_clock), InputError);
}

TEST(PseudoDynamic, HasNoErrorWhereThereIsNoEquilibrium) {
  const auto frames = pseudo_dynamic(pulled_chain(3, -1, 3), {}, 10, 1, no_clock);
  ASSERT_FALSE(frames.empty());
  EXPECT_FALSE(std::isnan(frames.front().error));
  EXPECT_TRUE(std::isnan(frames.back().error));
}

TEST(PseudoDynamic, FollowsTheLoadTheBetterTheMoreIterationsAFrameHas) {
  const StaticModel model = pulled_chain(8, 1, 0.5);
  const auto worst = [&](int iterations) {
    double most = 0;
    for (const StaticFrame& frame :
         pseudo_dynamic(model, {.method = StaticMethod::modified_newton}, 20, iterations, no_clock))
      most = std::max(most, frame.error);
    return most;
  };
  const auto frames = pseudo_dynamic(model, {}, 20, 2, no_clock);
  ASSERT_EQ(frames.size(), 20u);
  EXPECT_EQ(frames.back().load, 1);
  EXPECT_GT(worst(1), 2 * worst(3));
}

}  // namespace
}  // namespace hmax
