#include "bench/distributed/distributed_runs.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>

#include <fmt/format.h>

#include "analysis/amplification/amplification.hpp"
#include "bench/limits/mode_start.hpp"
#include "bench/limits/verification.hpp"
#include "integrators/spectral_radius.hpp"

namespace hmax {
namespace {

using Eigen::VectorXd;
using View = Eigen::Map<const VectorXd>;

/// Another process has left the run.
struct RunLeft {};

/// What all processes share in the runs of one row.
struct Shared {
  DistributedModel& model;
  const std::function<bool()>& interrupted;

  /// @throws RunLeft, RunsInterrupted  on all processes where one of them does not go on
  void go_on() const {
    const Going all = model.together(interrupted() ? Going::interrupted : Going::on);
    if (all == Going::interrupted) throw RunsInterrupted{};
    if (all == Going::ended) throw RunLeft{};
  }
};

/// The rows of this process of M q'' + (alpha M + beta K) q' + K q = 0 as a system with masses of one:
///   q'' = -M^-1 K (q + beta q') - alpha q'.
/// A right-hand side is one product with M^-1 K, in which all processes take part.
class DistributedSystem {
 public:
  using State = VectorXd;
  using Dofs = VectorXd;
  using DofMatrix = Eigen::SparseMatrix<double>;
  static constexpr bool autonomous = true;

  /// @param fastest  |lambda| of the fastest mode [1/s]
  DistributedSystem(Shared shared, double fastest) : shared_(shared), fastest_(fastest) {}

  [[nodiscard]] Eigen::Index dofs() const { return static_cast<Eigen::Index>(shared_.model.rows()); }
  [[nodiscard]] Eigen::Index dim() const { return 2 * dofs(); }
  [[nodiscard]] Dofs mass() const { return Dofs::Ones(dofs()); }
  void rhs(double t, const State& y, State& dydt) const {
    Dofs a(dofs());
    force(t, y.head(dofs()), y.tail(dofs()), a);
    dydt << y.tail(dofs()), a;
  }
  void force(double /*t*/, const Dofs& q, const Dofs& v, Dofs& f) const {
    shared_.go_on();
    const StructureEnds& ends = shared_.model.ends();
    const Dofs x = ends.beta == 0 ? q : Dofs(q + ends.beta * v);
    f.resize(dofs());
    shared_.model.reduced_stiffness_times(x.data(), f.data());
    f = -f - ends.alpha * v;
  }
  /// No matrix is in one place: of K nothing, of C what damps each unknown alone, which is all that explicit steps take.
  void stiffness(double /*t*/, const Dofs&, const Dofs&, DofMatrix& K) const { K.resize(dofs(), dofs()); }
  void damping(double /*t*/, const Dofs&, const Dofs&, DofMatrix& C) const {
    C.resize(dofs(), dofs());
    C.setIdentity();
    C *= shared_.model.ends().alpha;
  }
  /// What prediction tells methods that choose their stages by it.
  [[nodiscard]] double spectral_radius(double /*t*/, const State&) const {
    return SpectralRadius<State>::margin * fastest_;
  }

 private:
  Shared shared_;
  double fastest_;
};

/// Runs of the rows of this process. One that ends early here ends everywhere, and the other way round: each run has
/// one last word with all others.
ShowSteps steps_of(const Method& method, const ModeStart& start, Shared shared, double fastest) {
  Problem problem;
  problem.id = "rows";
  problem.y0 = start.displacement;
  problem.t_end = 1;
  problem.system = AnySystem(DistributedSystem(shared, fastest));
  return [runner = method.bind(problem), shared](double h, std::int64_t steps, const auto& show) {
    RunSpec spec;
    spec.t_end = h * static_cast<double>(steps);
    spec.h = h;
    spec.max_steps = steps + 2;
    try {
      const RunRecord record = runner.run(spec, [&](double, const Eigen::Ref<const VectorXd>& y) {
        shared.go_on();
        show(y);
      });
      const bool ended = record.outcome == Outcome::reached_end;
      const Going all = shared.model.together(ended ? Going::on : Going::ended);
      // Others have left by it.
      if (all == Going::interrupted) throw RunsInterrupted{};
      return all == Going::on;
    } catch (const RunLeft&) {
      return false;
    }
  };
}

/// Products of rows of all processes with a state.
template <std::size_t count>
std::array<double, count> summed(DistributedModel& model, std::array<double, count> of_rows) {
  model.add_up(of_rows);
  return of_rows;
}

VectorXd product(DistributedModel& model, void (DistributedModel::*times)(const double*, double*), const VectorXd& x) {
  VectorXd out(x.size());
  (model.*times)(x.data(), out.data());
  return out;
}

/// (v^T M v + q^T K q)^1/2, which no undamped motion changes.
double energy_norm(DistributedModel& model, const Eigen::Ref<const VectorXd>& y) {
  const Eigen::Index n = y.size() / 2;
  const VectorXd q = y.head(n), v = y.tail(n);
  const auto [twice] = summed<1>(model, {q.dot(product(model, &DistributedModel::stiffness_times, q)) +
                                         v.dot(product(model, &DistributedModel::mass_times, v))});
  return std::isfinite(twice) ? std::sqrt(std::max(twice, 0.0)) : std::numeric_limits<double>::infinity();
}

/// From the mode of the fastest shape with this eigenvalue, and velocities of a hundredth of its energy norm in
/// everything else; as start_from_mode() of a large structure.
ModeStart start_from_fastest(DistributedModel& model, Complex lambda) {
  const auto n = static_cast<Eigen::Index>(model.rows());
  const VectorXd u = View(model.fastest_shape().data(), n), noise = View(model.noise().data(), n);
  const VectorXd Mu = product(model, &DistributedModel::mass_times, u),
                 Ku = product(model, &DistributedModel::stiffness_times, u);
  ModeStart start{.rest = VectorXd::Zero(2 * n), .displacement = VectorXd::Zero(2 * n),
                  .distance = [&model](const Eigen::Ref<const VectorXd>& y) { return energy_norm(model, y); }};
  VectorXd& y = start.displacement;
  y.tail(n) = noise;
  const double of_noise = energy_norm(model, y);
  y << u, lambda.real() * u;
  y.tail(n) += 0.01 * energy_norm(model, y) / of_noise * noise;
  y /= std::sqrt(summed<1>(model, {y.squaredNorm()})[0]);
  // The left eigenvector, u^T ((lambda M + C) q + M v), C = alpha M + beta K.
  const StructureEnds& ends = model.ends();
  start.amplitude = [&model, lambda, Mu, Cu = VectorXd(ends.alpha * Mu + ends.beta * Ku),
                     n](const Eigen::Ref<const VectorXd>& state) {
    const auto [q, v, damped] =
        summed<3>(model, {Mu.dot(state.head(n)), Mu.dot(state.tail(n)), Cu.dot(state.head(n))});
    return std::abs(lambda * q + damped + v);
  };
  const auto of_mode = [&model, Mu, n](const Eigen::Ref<const VectorXd>& state) {
    return summed<2>(model, {Mu.dot(state.head(n)), Mu.dot(state.tail(n))});
  };
  start.motion = [of_mode](double h) {
    return [of_mode, h](const Eigen::Ref<const VectorXd>& state) {
      const auto [q, v] = of_mode(state);
      return Eigen::Vector2d(q / h, v);
    };
  };
  start.beside = [&model, of_mode, u, n](const Eigen::Ref<const VectorXd>& state) {
    const auto [q, v] = of_mode(state);
    VectorXd left = state;
    left.head(n) -= q * u;
    left.tail(n) -= v * u;
    return energy_norm(model, left);
  };
  start.mode_alone = start.large = true;
  return start;
}

/// Why the runs of a row would not begin in the mode that limits it; empty where they do.
std::string why_not_from_fastest(const Prediction& row, const Linearised& near, const DistributedModel& model,
                                 int processes_without_rows) {
  if (model.ends().general_damping)
    return "not verified: damping couples the modes, and --engine petsc steps models with none, or alpha and beta; leave out "
           "--engine";
  if (processes_without_rows > 0) return "not verified: some processes have no row; take fewer of them";
  if (!row.limiting) return {};
  const double kappa = oscillation_of(near, row.limiting->lambda).kappa;
  if (kappa >= model.ends().kappa_max * (1 - 1e-9)) return {};
  return fmt::format(
      "not verified: a mode of {:.6g} rad/s limits the step, and --engine petsc has the shape of the fastest alone; leave "
      "out --engine",
      std::sqrt(std::max(kappa, 0.0)));
}

}  // namespace

std::string why_not_stepped(const Method& method) {
  if (!method.bind) return fmt::format("{} is a formula that nothing in hmax steps with", method.id);
  if (!method.fixed_step) return fmt::format("{} takes no steps of a fixed size", method.id);
  if (method.is_foreign())
    return fmt::format("{} is of {}, which knows nothing of rows on other processes", method.id, method.engine);
  if (!method.is_explicit || method.needs_jacobian)
    return fmt::format("{} solves equations in every step, and --engine petsc steps explicit methods alone", method.id);
  return {};
}

void verify(Prediction& row, const Method& method, const Linearised& near, DistributedModel& model,
            const std::function<bool()>& interrupted) {
  if (!has_claim(row, method)) return;
  double fastest = 0;
  for (const ModeMargin& margin : row.modes) fastest = std::max(fastest, std::abs(margin.mode.lambda));
  if (fastest == 0) return;  // nothing moves
  const auto [without_rows] = summed<1>(model, {model.rows() == 0 ? 1.0 : 0.0});
  if (std::string why = why_not_stepped(method); !why.empty()) {
    row.note = fmt::format("not verified: {}; leave out --engine", why);
    return;
  }
  if (std::string why = why_not_from_fastest(row, near, model, static_cast<int>(without_rows)); !why.empty()) {
    row.note = std::move(why);
    return;
  }
  const Complex lambda = row.limiting ? row.limiting->lambda : row.modes.back().mode.lambda;
  const ModeStart start = start_from_fastest(model, lambda);
  const ShowSteps run = steps_of(method, start, {model, interrupted}, fastest);
  FarSteps far = short_far_steps(fastest);
  far.note = fmt::format("verified at a step of {:.3g} s alone: --engine petsc takes no longer ones", far.h.back());
  verify_from(start, run, row, method, near, far);
}

}  // namespace hmax
