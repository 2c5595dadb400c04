/// Implicit Euler by a fixed number of iterations: what it shows of a material, and what it converges to.
#include "integrators/positional/positional_euler.hpp"

#include <cmath>
#include <complex>
#include <cstring>
#include <memory>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "core/parallel_for.hpp"
#include "integrators/integrate.hpp"
#include "integrators/positional/compliant_constraints.hpp"
#include "integrators/positional/projective_dynamics.hpp"
#include "integrators/positional/truncated_newton.hpp"
#include "integrators/positional/vertex_block_descent.hpp"
#include "problems/mesh/mesh_generators.hpp"
#include "problems/mesh/refine.hpp"
#include "problems/tissue/forces/tet_elements.hpp"
#include "problems/tissue/positional_body.hpp"
#include "tests/integrators/positional/bar.hpp"

namespace hmax {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

using Vbd = PositionalEuler<VertexBlockDescent>;
using Xpbd = PositionalEuler<CompliantConstraints>;
using Newton = PositionalEuler<TruncatedNewton>;
using Projective = PositionalEuler<ProjectiveDynamics>;
static_assert(Stepper<Vbd, HangingBar> && Stepper<Xpbd, HangingBar> && Stepper<Newton, HangingBar>);
static_assert(Stepper<Vbd, PositionalBody> && Stepper<Xpbd, PositionalBody> &&
              Stepper<Projective, PositionalBody>);

template <class StepperT, class Sys>
VectorXd step(StepperT stepper, const Sys& system, const VectorXd& y, double h) {
  stepper.init(system, 0, y);
  VectorXd next = y;
  EXPECT_EQ(stepper.attempt(system, 0, y, h, next), StepStatus::ok);
  return next;
}

/// A step of the bar is affine in what moves along it: its propagator, and the state where it settles.
struct Affine {
  MatrixXd A;
  VectorXd settled;
};
template <class StepperT>
Affine affine_step(const StepperT& stepper, const HangingBar& bar, double h) {
  const Eigen::Index n = bar.dim() / 3;
  const auto along = [](const VectorXd& y) -> VectorXd { return y.reshaped(3, y.size() / 3).row(0); };
  const VectorXd b = step(stepper, bar, VectorXd::Zero(bar.dim()), h);
  Affine map{MatrixXd(n, n), {}};
  for (Eigen::Index j = 0; j < n; ++j)
    map.A.col(j) = along(step(stepper, bar, VectorXd::Unit(bar.dim(), 3 * j), h) - b);
  map.settled = (MatrixXd::Identity(n, n) - map.A).fullPivLu().solve(along(b));
  return map;
}

constexpr double frame = 0.01;

/// Stiffness shown over entered: the exact sag of the tip over the one where the steps settle.
template <class StepperT>
double stiffness_shown(const StepperT& stepper, double young) {
  const HangingBar bar(young);
  MatrixXd K;
  {
    HangingBar::DofMatrix sparse;
    bar.stiffness(0, {}, {}, sparse);
    K = sparse;
  }
  VectorXd loads;
  bar.loads(0, loads);
  const VectorXd exact = K.ldlt().solve(loads);
  return exact[bar.dofs() - 3] / affine_step(stepper, bar, frame).settled[HangingBar::n - 1];
}

Vbd vbd(int iterations, int substeps, double rho = 0) {
  return {VertexBlockDescent(rho), iterations, substeps};
}
Xpbd xpbd(int iterations, int substeps, bool reset = false) {
  return {CompliantConstraints(reset), iterations, substeps};
}
Newton newton(int iterations, int conjugate_gradients) {
  return {TruncatedNewton(conjugate_gradients), iterations, 1};
}
Xpbd pbd(int iterations, double share) { return {CompliantConstraints::stiff(share), iterations, 1}; }
Projective projective(int iterations) { return {ProjectiveDynamics(), iterations, 1}; }

TEST(PositionalEuler, ShowsTheStiffnessOfTheLaboratoryBar) {
  // Sags after 200 s of a program in one dimension that knows nothing of this one: exact over settled.
  EXPECT_NEAR(stiffness_shown(vbd(1, 1), 5000), 1 / 18.9245, 1e-3 * 0.053);
  EXPECT_NEAR(stiffness_shown(vbd(5, 1), 5000), 1 / 4.1751, 1e-3 * 0.24);
  EXPECT_NEAR(stiffness_shown(vbd(20, 1), 5000), 1 / 1.4847, 1e-3 * 0.67);
  EXPECT_NEAR(stiffness_shown(vbd(4, 5), 5000), 1 / 1.0302, 1e-3);
  EXPECT_NEAR(stiffness_shown(vbd(1, 20), 5000), 1 / 1.0448, 1e-3);
  EXPECT_NEAR(stiffness_shown(vbd(100, 1), 5000), 1 / 1.0031, 1e-3);
  EXPECT_NEAR(stiffness_shown(xpbd(1, 1), 5000), 1 / 18.0283, 1e-3 * 0.055);
  EXPECT_NEAR(stiffness_shown(xpbd(5, 1), 5000), 1 / 3.9982, 1e-3 * 0.25);
  EXPECT_NEAR(stiffness_shown(xpbd(20, 1), 5000), 1 / 1.4464, 1e-3 * 0.69);
  EXPECT_NEAR(stiffness_shown(xpbd(4, 5), 5000), 1 / 1.0276, 1e-3);
  EXPECT_NEAR(stiffness_shown(xpbd(1, 20), 5000), 1 / 1.0426, 1e-3);
  EXPECT_NEAR(stiffness_shown(xpbd(100, 1), 5000), 1 / 1.0024, 1e-3);
  // Multipliers that are reset harden with iterations.
  EXPECT_NEAR(stiffness_shown(xpbd(5, 1, true), 5000), 1 / 3.5679, 1e-3 * 0.28);
  EXPECT_NEAR(stiffness_shown(xpbd(4, 5, true), 5000), 1 / 0.4189, 1e-3 * 2.4);
  EXPECT_NEAR(stiffness_shown(xpbd(1, 20, true), 5000), 1 / 1.0426, 1e-3);
  EXPECT_NEAR(stiffness_shown(xpbd(20, 1, true), 5000), 1 / 0.8566, 1e-3 * 1.17);
  EXPECT_NEAR(stiffness_shown(xpbd(100, 1, true), 5000), 7.483, 1e-3 * 7.5);
}

TEST(PositionalEuler, ShowsNoMoreThanItsCeiling) {
  // Moduli shown where 1 kPa, 10 kPa and 1 GPa are entered, of the same program.
  EXPECT_NEAR(1e3 * stiffness_shown(vbd(10, 1), 1e3), 916.8, 0.9);
  EXPECT_NEAR(1e4 * stiffness_shown(vbd(10, 1), 1e4), 2448, 2.4);
  EXPECT_NEAR(1e9 * stiffness_shown(vbd(10, 1), 1e9), 2857, 2.9);
  EXPECT_NEAR(1e9 * stiffness_shown(vbd(1, 10), 1e9), 27890, 28);
  EXPECT_NEAR(1e9 * stiffness_shown(xpbd(10, 1), 1e9), 3011, 3);
  EXPECT_NEAR(1e9 * stiffness_shown(xpbd(1, 20), 1e9), 117400, 117);
}

TEST(PositionalEuler, StiffConstraintsShowTheSameWhateverTheModulus) {
  // The bar in one dimension by hand: points in a row, each step meets each length to a share, five times.
  const double share = 0.6, g = 9.81, h = frame;
  const int iterations = 5;
  std::vector<double> x(HangingBar::n, 0), v = x, w(HangingBar::n, 1);
  w.back() = 2;  // of half the mass
  for (int step = 0; step < 20000; ++step) {
    const std::vector<double> before = x;
    for (std::size_t i = 0; i < x.size(); ++i) x[i] += h * v[i] + h * h * g;
    for (int k = 0; k < iterations; ++k)
      for (std::size_t i = 0; i < x.size(); ++i) {
        const double stretch = i == 0 ? x[0] : x[i] - x[i - 1], sum = i == 0 ? w[0] : w[i] + w[i - 1];
        x[i] -= share * stretch * w[i] / sum;
        if (i > 0) x[i - 1] += share * stretch * w[i - 1] / sum;
      }
    for (std::size_t i = 0; i < x.size(); ++i) v[i] = (x[i] - before[i]) / h;
  }
  const double sag = affine_step(pbd(iterations, share), HangingBar(5000), h).settled[HangingBar::n - 1];
  EXPECT_NEAR(sag, x.back(), 1e-9 * x.back());
  EXPECT_NEAR(affine_step(pbd(iterations, share), HangingBar(5e8), h).settled[HangingBar::n - 1], sag,
              1e-9 * sag);
}

TEST(PositionalEuler, DampsTheFirstModeOfTheLaboratoryBar) {
  const auto first_mode = [](const auto& stepper) {
    const Eigen::VectorXcd all = affine_step(stepper, HangingBar(5000, 0), frame).A.eigenvalues();
    // The slowest decay of what oscillates.
    std::complex<double> slowest = 0;
    for (const std::complex<double>& each : all)
      if (each.imag() > 1e-9 && std::abs(each) > std::abs(slowest)) slowest = each;
    const std::complex<double> lambda = std::log(slowest) / frame;
    return std::pair(-lambda.real() / std::abs(lambda), lambda.imag());
  };
  const auto expect = [&](const auto& stepper, double zeta, double omega) {
    const auto [found_zeta, found_omega] = first_mode(stepper);
    EXPECT_NEAR(found_zeta, zeta, 0.002);
    EXPECT_NEAR(found_omega, omega, 0.02 * omega);
  };
  expect(vbd(5, 1), 0.081, 16.2);
  expect(vbd(20, 1), 0.136, 27.3);
  expect(vbd(2, 10), 0.017, 33.7);
  expect(xpbd(20, 1), 0.137, 27.3);
  expect(xpbd(1, 20), 0.008, 33.4);
  expect(xpbd(100, 1), 0.165, 33.1);
}

/// |F - M (q - q0 - h v0) / h^2| of implicit Euler at a step, relative to its second part.
template <class Sys>
double residual_of_implicit_euler(const Sys& system, const VectorXd& y, const VectorXd& next, double h) {
  const Eigen::Index n = system.dofs();
  const VectorXd q = next.head(n), v = next.tail(n);
  EXPECT_LT((v - (q - y.head(n)) / h).norm(), 1e-9 * v.norm());
  VectorXd f(n);
  system.force(h, q, v, f);
  const VectorXd inertia = system.mass().cwiseProduct(q - y.head(n) - h * y.tail(n)) / (h * h);
  return (f - inertia).norm() / inertia.norm();
}

/// Stable neo-Hookean without its logarithm: what its two constraints are the energy of.
class NeoHookeanOfConstraints {
 public:
  NeoHookeanOfConstraints(const Eigen::Matrix3d& H, const Lame& lame)
      : mu_(lame.mu), lambda_(lame.lambda + lame.mu), F_(Eigen::Matrix3d::Identity() + H) {}
  [[nodiscard]] double excess() const { return F_.determinant() - 1 - mu_ / lambda_; }
  [[nodiscard]] double energy() const {
    return mu_ / 2 * F_.squaredNorm() + lambda_ / 2 * excess() * excess();
  }
  [[nodiscard]] Eigen::Matrix3d stress() const { return mu_ * F_ + lambda_ * excess() * cofactors(F_); }
  [[nodiscard]] Eigen::Matrix3d differential(const Eigen::Matrix3d& dF) const {
    const Eigen::Matrix3d C = cofactors(F_);
    return mu_ * dF + lambda_ * (C.cwiseProduct(dF).sum() * C + excess() * cofactor_differential(F_, dF));
  }

 private:
  double mu_, lambda_;
  Eigen::Matrix3d F_;
};
std::shared_ptr<const Elements> elements_of_constraints(const TetMesh& mesh, std::span<const Lame> lame,
                                                        const BlockPattern& pattern) {
  return std::make_shared<const TetElements<NeoHookeanOfConstraints>>(mesh, lame, pattern);
}

/// A block on the floor under its weight, pressed from above.
std::shared_ptr<const TissueBody> block(const TissueModel& model, double alpha, double beta, int cells = 2) {
  TetMesh mesh = box_mesh({0.1, 0.1, 0.1}, {cells, cells, cells});
  if (model.has_ten_nodes) mesh = ten_node_mesh(mesh);
  TissueSettings settings;
  settings.model = model;
  settings.materials = {{5000, 0.4, 1060}};
  settings.gravity = {0, 0, -9.81};
  settings.alpha = alpha;
  settings.beta = beta;
  settings.supports = {{points_in_box(mesh, {-1, -1, -1}, {1, 1, 1e-6})}};
  settings.elastic_supports = {{points_in_box(mesh, {-1, -1, 0.04}, {1, 1, 0.06}), {}}};
  settings.elastic_supports.front().stiffness.assign(settings.elastic_supports.front().points.size(), 3.0);
  settings.forces = {{points_in_box(mesh, {-1, -1, 0.099}, {1, 1, 1}), {0.1, 0, -0.5}}};
  return std::make_shared<const TissueBody>(mesh, settings);
}

VectorXd moving_state(const TissueBody& body) {
  VectorXd y(body.dim());
  for (Eigen::Index i = 0; i < body.dofs(); ++i) {
    y[i] = 2e-3 * std::sin(1.7 * static_cast<double>(i));
    y[body.dofs() + i] = 0.1 * std::cos(2.3 * static_cast<double>(i));
  }
  return y;
}

TEST(PositionalEuler, ConvergesToImplicitEuler) {
  for (const auto& [alpha, beta] : {std::pair(0.0, 0.0), {4.0, 0.01}}) {
    for (const TissueModel& model : tissue_models()) {
      const auto body = block(model, alpha, beta);
      const VectorXd y = moving_state(*body);
      const PositionalBody whole(body, PositionalVerbs::forces);
      EXPECT_LT(residual_of_implicit_euler(whole, y, step(newton(20, 300), whole, y, 0.01), 0.01), 1e-8)
          << model.id;
      if (!PositionalBody::why_not(*body, PositionalVerbs::points).empty()) continue;
      const PositionalBody points(body, PositionalVerbs::points);
      EXPECT_LT(residual_of_implicit_euler(whole, y, step(vbd(800, 1), points, y, 0.01), 0.01), 1e-8)
          << model.id;
      EXPECT_LT(residual_of_implicit_euler(whole, y, step(vbd(400, 1, 0.9), points, y, 0.01), 0.01), 1e-8)
          << model.id;
    }
  }
}

TEST(PositionalEuler, ProjectionsConvergeToImplicitEuler) {
  // Sizes at which every law has an energy that does not bend away from its weights.
  for (const auto& [alpha, beta] : {std::pair(0.0, 0.0), {4.0, 0.01}})
    for (const TissueModel& model : tissue_models()) {
      const auto body = block(model, alpha, beta);
      if (!PositionalBody::why_not(*body, PositionalVerbs::weights).empty()) continue;
      const PositionalBody system(body, PositionalVerbs::weights);
      const VectorXd y = 0.1 * moving_state(*body);
      EXPECT_LT(residual_of_implicit_euler(*body, y, step(projective(1000), system, y, 0.01), 0.01), 1e-8)
          << model.id;
    }
}

TEST(PositionalEuler, ProjectionsGiveSpringsTheirLengthsAndSolveForPoints) {
  TissueSettings settings = block(tissue_model("mass_spring"), 0, 0)->settings();
  const auto body = std::make_shared<const TissueBody>(box_mesh({0.1, 0.1, 0.1}, {2, 2, 2}), settings);
  const PositionalBody system(body, PositionalVerbs::weights);
  const VectorXd y = moving_state(*body);
  const double h = 0.01;
  VectorXd x = y;  // by hand, two iterations
  const Eigen::Index n = body->dofs();
  VectorXd loads;
  system.loads(h, loads);
  const VectorXd free = y.head(n) + h * y.tail(n) + h * h * loads.cwiseQuotient(body->mass());
  x = free;
  for (int k = 0; k < 2; ++k) {
    MatrixXd A = (body->mass() / (h * h)).asDiagonal();
    VectorXd b = A * free;
    const Eigen::Matrix3Xd now = body->positions(0, x), rest = body->mesh().points;
    std::vector<Eigen::Index> place(static_cast<std::size_t>(rest.cols()), -1);
    for (std::size_t i = 0; i < body->free_points().size(); ++i)
      place[static_cast<std::size_t>(body->free_points()[i])] = 3 * static_cast<Eigen::Index>(i);
    const auto pull = [&](Eigen::Index of, Eigen::Index to, double stiffness, const Eigen::Vector3d& wanted) {
      A.block<3, 3>(of, of).diagonal().array() += stiffness;
      if (to >= 0) A.block<3, 3>(of, to).diagonal().array() -= stiffness;
      b.segment<3>(of) += stiffness * wanted;
    };
    const SpringSet& springs = body->spring_sets().front();
    for (std::size_t i = 0; i < springs.size(); ++i) {
      const auto [a, c] = springs.spring(i).points;
      // Displacements whose difference gives the spring its length in its present direction.
      const Eigen::Vector3d along = rest.col(c) - rest.col(a), d = now.col(c) - now.col(a);
      const Eigen::Vector3d wanted = along.norm() * d.normalized() - along;
      const Eigen::Index of = place[static_cast<std::size_t>(a)], to = place[static_cast<std::size_t>(c)];
      if (of >= 0) pull(of, to, springs.spring(i).stiffness, -wanted);
      if (to >= 0) pull(to, of, springs.spring(i).stiffness, wanted);
    }
    for (const ElasticSupport& support : settings.elastic_supports)
      for (std::size_t i = 0; i < support.points.size(); ++i)
        if (const Eigen::Index of = place[static_cast<std::size_t>(support.points[i])]; of >= 0)
          pull(of, -1, support.stiffness[i], Eigen::Vector3d::Zero());
    x = A.ldlt().solve(b);
  }
  EXPECT_LT((step(projective(2), system, y, h).head(n) - x).norm(), 1e-11 * x.norm());
}

TEST(PositionalEuler, ConstraintsComeNearToImplicitEulerOfTheirEnergyInShortSteps) {
  // Multipliers act along the gradients of the iterate they were found at: where gradients turn in a step it
  // converges to another state, the nearer the shorter the step.
  const auto springs = block(tissue_model("mass_spring"), 4, 0);
  TissueModel of_constraints = tissue_model("fem_neo_hookean");
  of_constraints.make_elements = elements_of_constraints;
  const auto solid = block(of_constraints, 4, 0);
  for (const auto& body : {springs, solid}) {
    const PositionalBody system(body, PositionalVerbs::constraints);
    const VectorXd y = 0.1 * moving_state(*body);
    const auto residual = [&](double h) {
      return residual_of_implicit_euler(*body, y, step(xpbd(1000, 1), system, y, h), h);
    };
    const double longer = residual(2e-3), shorter = residual(5e-4);
    EXPECT_LT(longer, 0.1) << body->settings().model.id;
    EXPECT_LT(shorter, longer / 3) << body->settings().model.id;
  }
}

TEST(PositionalEuler, DampingOfConstraintsIsThatOfImplicitEuler) {
  // Springs in a row are linear: beta of the constraints is beta of K.
  const HangingBar bar(5000, 9.81, 3, 0.02);
  VectorXd y = VectorXd::Zero(bar.dim());
  for (Eigen::Index i = 0; i < 2 * HangingBar::n; ++i) y[3 * i] = 1e-3 * std::sin(static_cast<double>(i));
  EXPECT_LT(residual_of_implicit_euler(bar, y, step(xpbd(2000, 1), bar, y, 0.01), 0.01), 1e-8);
  EXPECT_LT(residual_of_implicit_euler(bar, y, step(vbd(2000, 1), bar, y, 0.01), 0.01), 1e-8);
  EXPECT_LT(residual_of_implicit_euler(bar, y, step(newton(1, 100), bar, y, 0.01), 0.01), 1e-8);
}

/// M (q_new - q - h v) / h^2 + (C / h + K) (q_new - q - h v) = F(t, q + h v, v), K and C of state `at`.
VectorXd linearly_implicit_step(const PositionalBody& body, const VectorXd& at, const VectorXd& y, double h) {
  const Eigen::Index n = body.dofs();
  Eigen::SparseMatrix<double> K, C;
  body.stiffness(0, at.head(n), at.tail(n), K);
  body.damping(0, at.head(n), at.tail(n), C);
  const VectorXd moved = y.head(n) + h * y.tail(n);
  VectorXd force(n), next(2 * n);
  body.force(0, moved, y.tail(n), force);
  Eigen::MatrixXd A = Eigen::MatrixXd(K) + Eigen::MatrixXd(C) / h;
  A.diagonal() += body.mass() / (h * h);
  next.head(n) = moved + A.ldlt().solve(force);
  next.tail(n) = (next.head(n) - y.head(n)) / h;
  return next;
}

TEST(PositionalEuler, FrozenNewtonKeepsTheMatrixOfItsStart) {
  const auto body = block(tissue_model("fem_neo_hookean"), 4, 0.01);
  const PositionalBody whole(body, PositionalVerbs::forces);
  const VectorXd y = moving_state(*body);
  Newton stepper(TruncatedNewton(300, true), 1, 1);
  stepper.init(whole, 0, y);
  VectorXd before = y, next = y;
  for (const double h : {0.01, 0.01, 0.004}) {
    stepper.attempt(whole, 0, before, h, next);
    const VectorXd expected = linearly_implicit_step(whole, y, before, h);
    EXPECT_LT((next - expected).norm(), 1e-9 * expected.norm()) << h;
    if (before != y) {
      EXPECT_GT((next - linearly_implicit_step(whole, before, before, h)).norm(), 1e-6 * next.norm());
    }
    before = next;
  }
  // From another start, with a matrix of its own.
  stepper.init(whole, 0, before);
  stepper.attempt(whole, 0, before, 0.004, next);  // as long as the last step
  const VectorXd expected = linearly_implicit_step(whole, before, before, 0.004);
  EXPECT_LT((next - expected).norm(), 1e-9 * expected.norm());
}

TEST(PositionalEuler, SubstepsAreStepsOfAPart) {
  const auto body = block(tissue_model("fem_neo_hookean"), 2, 0.01);
  const PositionalBody points(body, PositionalVerbs::points);
  const VectorXd y = moving_state(*body);
  VectorXd parts = y;
  for (int i = 0; i < 4; ++i) parts = step(vbd(3, 1), points, parts, 0.0025);
  EXPECT_LT((step(vbd(3, 4), points, y, 0.01) - parts).norm(), 1e-12 * parts.norm());
}

TEST(PositionalEuler, ExtrapolationConvergesInFewerIterations) {
  const HangingBar bar(5e5);
  const VectorXd y = VectorXd::Zero(bar.dim());
  const auto residual = [&](double rho) {
    return residual_of_implicit_euler(bar, y, step(vbd(100, 1, rho), bar, y, 0.01), 0.01);
  };
  EXPECT_LT(residual(0.98), 0.3 * residual(0));
}

TEST(PositionalEuler, HasTheSameBitsForAnyNumberOfThreads) {
  const auto body = block(tissue_model("fem_neo_hookean"), 0, 0, 18);
  const PositionalBody points(body, PositionalVerbs::points);
  const VectorXd y = moving_state(*body);
  const std::size_t before = jobs();
  set_jobs(4);
  const VectorXd many = step(vbd(2, 1), points, y, 0.01);
  const OneThread alone;
  const VectorXd one = step(vbd(2, 1), points, y, 0.01);
  set_jobs(before);
  EXPECT_TRUE(many.allFinite());
  EXPECT_EQ(std::memcmp(many.data(), one.data(), static_cast<std::size_t>(one.size()) * sizeof(double)), 0);
}

TEST(PositionalEuler, StaysBoundedAtEveryStep) {
  const auto body = block(tissue_model("fem_neo_hookean"), 0, 0);
  const PositionalBody points(body, PositionalVerbs::points);
  for (const double h : {1e-3, 0.1, 10.0}) {
    VectorXd y = 20 * moving_state(*body);
    Vbd stepper = vbd(3, 1);
    integrate(stepper, points, Span<double>{0, 200 * h}, y, FixedStep<double>(h));
    // Where the body falls to in a step without elastic forces, at most.
    EXPECT_LT(y.head(body->dofs()).cwiseAbs().maxCoeff(), 0.5 + 1.2 * 9.81 * h * h) << h;
  }
}

TEST(PositionalEuler, ShowsStatesBetweenItsEnds) {
  const HangingBar bar(5000);
  const VectorXd y = VectorXd::LinSpaced(bar.dim(), 0, 1e-3);
  Vbd stepper = vbd(5, 1);
  stepper.init(bar, 0, y);
  VectorXd next = y, between = y;
  stepper.attempt(bar, 0, y, 0.01, next);
  EXPECT_EQ(stepper.work().newton, 5);
  stepper.interpolate(bar, 0, 0.01, y, next, 0, between);
  EXPECT_EQ(between, y);
  stepper.interpolate(bar, 0, 0.01, y, next, 1, between);
  EXPECT_EQ(between, next);
  stepper.interpolate(bar, 0, 0.01, y, next, 0.5, between);
  const Eigen::Index n = bar.dofs();
  // A cubic at its middle: the mean of both ends, and an eighth of the difference of the slopes.
  const VectorXd middle = (y.head(n) + next.head(n)) / 2 + 0.01 / 8 * (y.tail(n) - next.tail(n));
  EXPECT_LT((between.head(n) - middle).norm(), 1e-12 * middle.norm());
}

}  // namespace
}  // namespace hmax
