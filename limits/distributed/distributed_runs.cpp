#include "limits/distributed/distributed_runs.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <span>

#include <fmt/format.h>

#include "analysis/amplification/amplification.hpp"
#include "core/structure_operator.hpp"
#include "integrators/spectral_radius.hpp"
#include "limits/modes/structure_start.hpp"
#include "limits/verification.hpp"
#include "problems/linearity.hpp"

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

/// What implicit steps ask of all processes: with C = alpha M + beta K
///   I + c M^-1 C + k M^-1 K = M^-1 ((1 + c alpha) M + (k + c beta) K).
class Structure final : public StructureOperator {
 public:
  explicit Structure(Shared shared) : shared_(shared) {}

  [[nodiscard]] std::unique_ptr<Inverse> inverse(double c, double k) const override {
    shared_.go_on();
    const StructureEnds& ends = shared_.model.ends();
    return std::make_unique<Watched>(shared_.model.inverse_of_sum(1 + c * ends.alpha, k + c * ends.beta),
                                     shared_);
  }
  void stiffness_times(const double* x, double* out) const override {
    shared_.go_on();
    shared_.model.reduced_stiffness_times(x, out);
  }
  [[nodiscard]] double largest_stiffness() const override { return shared_.model.ends().kappa_max; }
  [[nodiscard]] double largest_damping() const override {
    const StructureEnds& ends = shared_.model.ends();
    return std::abs(ends.alpha) + std::abs(ends.beta) * ends.kappa_max;
  }

 private:
  class Watched final : public Inverse {
   public:
    Watched(std::unique_ptr<Inverse> of_model, Shared shared)
        : of_model_(std::move(of_model)), shared_(shared) {}
    int apply(double* x) override {
      shared_.go_on();
      return of_model_->apply(x);
    }

   private:
    std::unique_ptr<Inverse> of_model_;
    Shared shared_;
  };

  Shared shared_;
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
  static constexpr Linearity linearity() { return Linearity::linear; }

  /// @param fastest  |lambda| of the fastest mode [1/s]
  DistributedSystem(Shared shared, double fastest)
      : shared_(shared), fastest_(fastest), structure_(std::make_shared<const Structure>(shared)) {}

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
  [[nodiscard]] std::shared_ptr<const StructureOperator> structure_operator() const { return structure_; }
  [[nodiscard]] double largest_of_all(double own) const {
    shared_.go_on();
    return shared_.model.largest(own);
  }
  /// No matrix is in one place: of K nothing, of C what damps each unknown alone, which is all that explicit
  /// steps take. Implicit ones take the operators.
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
  std::shared_ptr<const Structure> structure_;
};

/// Runs of the rows of this process. One that ends early here ends everywhere, and the other way round: each
/// run has one last word with all others.
ShowSteps steps_of(const Method& method, const ModeStart& start, Shared shared, double fastest) {
  Problem problem{.id = "rows",
                  .y0 = start.displacement,
                  .t_end = 1,
                  .system = AnySystem(DistributedSystem(shared, fastest))};
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

VectorXd product(DistributedModel& model, void (DistributedModel::*times)(const double*, double*),
                 const VectorXd& x) {
  VectorXd out(x.size());
  (model.*times)(x.data(), out.data());
  return out;
}

StructureProducts products_of(DistributedModel& model) {
  return {
      .mass_times = [&model](const VectorXd& x) { return product(model, &DistributedModel::mass_times, x); },
      .stiffness_times =
          [&model](const VectorXd& x) { return product(model, &DistributedModel::stiffness_times, x); },
      .add_up = [&model](std::span<double> numbers) { model.add_up(numbers); }};
}

/// From the mode of the fastest shape with this eigenvalue, and a hundredth of everything else; as
/// start_from_mode() of a large structure.
ModeStart start_from_fastest(DistributedModel& model, Complex lambda) {
  const auto n = static_cast<Eigen::Index>(model.rows());
  const VectorXd u = View(model.fastest_shape().data(), n);
  const StructureProducts products = products_of(model);
  ModeStart start =
      energy_start(products, VectorXd::Zero(2 * n), u, lambda.real() * u, View(model.noise().data(), n));
  // C = alpha M + beta K.
  const StructureEnds& ends = model.ends();
  const VectorXd Mu = products.mass_times(u), Cu = ends.alpha * Mu + ends.beta * products.stiffness_times(u);
  const Eigen::VectorXcd of_velocity = Mu.cast<Complex>(),
                         of_position = lambda * of_velocity + Cu.cast<Complex>();
  start.amplitude = amplitude_from(start.rest, of_position, of_velocity, products);
  follow(start, products, u);
  start.large = true;
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
    return fmt::format("{} is of {}, which knows nothing of rows on other processes", method.id,
                       method.engine);
  if (method.needs_split)
    return fmt::format("{} takes a part of the model that is declared to be stiff", method.id);
  return {};
}

void verify(Prediction& row, const Method& method, const Linearised& near, DistributedModel& model,
            const std::function<bool()>& interrupted) {
  if (!has_claim(row, method)) return;
  double fastest = 0;
  for (const ModeMargin& margin : row.modes) fastest = std::max(fastest, std::abs(margin.mode.lambda));
  if (fastest == 0) return;  // nothing moves
  const auto [without_rows] = summed<1>(model, {model.rows() == 0 ? 1.0 : 0.0});
  const Method& step = method.analysed();
  if (std::string why = why_not_stepped(step); !why.empty()) {
    row.note = fmt::format("not verified: {}; leave out --engine", why);
    return;
  }
  if (std::string why = why_not_from_fastest(row, near, model, static_cast<int>(without_rows));
      !why.empty()) {
    row.note = std::move(why);
    return;
  }
  const Complex lambda = row.limiting ? row.limiting->lambda : row.modes.back().mode.lambda;
  const ModeStart start = start_from_fastest(model, lambda);
  const ShowSteps run = steps_of(step, start, {model, interrupted}, fastest);
  FarSteps far = short_far_steps(fastest);
  far.note =
      fmt::format("verified at a step of {:.3g} s alone: --engine petsc takes no longer ones", far.h.back());
  try {
    verify_from(start, run, row, method, near, far);
  } catch (const ComplexEquations& error) {
    row.note = fmt::format("not verified: {}; leave out --engine", error.what());
  }
}

}  // namespace hmax
