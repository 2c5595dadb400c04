#include "analysis/statics/static_solution.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <fmt/format.h>

#include "core/errors.hpp"
#include "core/numbers.hpp"
#include "core/size_limits.hpp"
#include "integrators/linear/sparse_solver.hpp"

namespace hmax {
namespace {

using Eigen::VectorXd;
using Matrix = StaticModel::Matrix;

/// Where Newton's method does not ask for another one.
constexpr double default_inner_tolerance = 1e-4;

/// What sweeps have come to.
struct Relaxed {
  int sweeps;   ///< that were made
  double left;  ///< |r - K d| / |r|
};

/// d = K^-1 r by sweeps of successive over-relaxation over the rows of the symmetric K, from d = 0:
///   d_i <- d_i + omega (r_i - sum_j K_ij d_j) / K_ii,
/// until |r - K d| <= tolerance |r|, or for `most` sweeps.
Relaxed relax(const Matrix& K, const VectorXd& r, VectorXd& d, double omega, double tolerance, int most) {
  d.setZero(r.size());
  const double size = r.norm();
  VectorXd left(r.size());
  Relaxed reached{0, 1};
  for (int sweep = 1; sweep <= most; ++sweep) {
    // Column i of the symmetric K is its row i. New d_j are used at once (Gauss and Seidel for omega = 1).
    for (Eigen::Index i = 0; i < K.cols(); ++i) {
      double rest = r[i], diagonal = 0;
      for (Matrix::InnerIterator entry(K, i); entry; ++entry) {
        if (entry.row() == i) diagonal = entry.value();
        rest -= entry.value() * d[entry.row()];
      }
      // rest = r_i - sum_j K_ij d_j, with j = i included.
      d[i] += omega * rest / diagonal;
    }
    // The residual costs as much as a sweep.
    if (sweep % 8 != 0 && sweep != most) continue;
    left.noalias() = r - K * d;
    reached = {sweep, left.norm() / size};
    if (!std::isfinite(reached.left) || reached.left <= tolerance) break;
  }
  return reached;
}

/// Solves K d = r by the chosen solver, whatever K is kept for.
/// take() a matrix, then solve() with it.
class Inner {
 public:
  explicit Inner(const StaticSettings& settings) : settings_(settings) {
    set_tolerance(settings.inner_tolerance.value_or(default_inner_tolerance));
  }

  /// Of sor and conjugate gradients.
  void set_tolerance(double tolerance) {
    tolerance_ = tolerance;
    const bool iterates = settings_.inner == InnerSolver::conjugate_gradients;
    solver_.set({.by = iterates ? LinearSolve::By::conjugate_gradients : LinearSolve::By::direct,
                 .tolerance = tolerance});
  }

  /// @returns false when K is singular
  bool take(const Matrix& K) {
    if (settings_.inner != InnerSolver::sor) return solver_.factor(K);
    K_ = K;
    return K.diagonal().cwiseAbs().minCoeff() > 0;
  }

  /// Whether K has negative eigenvalues, or is so near to singular that its factors do not tell. What
  /// iterates finds out where it solves no more.
  [[nodiscard]] bool is_indefinite() const {
    const int unknown = settings_.inner == InnerSolver::direct ? 1 : 0;
    return settings_.inner != InnerSolver::sor && solver_.negative_eigenvalues().value_or(unknown) > 0;
  }

  /// @returns false when the solver gave up
  bool solve(const VectorXd& r, VectorXd& d) {
    if (settings_.inner == InnerSolver::sor) {
      const Relaxed reached = relax(K_, r, d, settings_.relaxation, tolerance_, settings_.inner_iterations);
      iterations_ += reached.sweeps;
      left_ = reached.left;
      // The steps of Newton's methods may be inexact; one linear solution may not.
      // Half of the residual gone is worth a step of Newton's method.
      constexpr double worth_a_step = 0.5;
      return left_ <= (settings_.method == StaticMethod::linear ? tolerance_ : worth_a_step);
    }
    d = r;
    iterations_ += solver_.solve(d);
    return d.allFinite();
  }

  /// Of sor and conjugate gradients, all systems together.
  [[nodiscard]] std::int64_t iterations() const { return iterations_; }
  /// Of the last system that sor was given, |r - K d| / |r|.
  [[nodiscard]] double left() const { return left_; }

  /// A solver that factors, which where it can is the one that has looked at the pattern already: what was
  /// taken is gone then.
  SparseSolver<double>& factors() {
    if (settings_.inner == InnerSolver::direct) return solver_;
    if (!factors_) {
      factors_.emplace();
      factors_->set({.by = LinearSolve::By::direct});
    }
    return *factors_;
  }

 private:
  const StaticSettings& settings_;
  SparseSolver<double> solver_;
  std::optional<SparseSolver<double>> factors_;
  Matrix K_;
  double tolerance_ = 0, left_ = 1;
  std::int64_t iterations_ = 0;
};

/// The iteration towards F(q) = (1 - share) F(0), that is towards equilibrium under a share of the load.
/// The residual is R(q) = F(q) - (1 - share) F(0), its size |R| / |F(0)|.
class Iteration {
 public:
  Iteration(const StaticModel& model, const StaticSettings& settings, const Clock& clock)
      : model_(model), settings_(settings), clock_(clock), inner_(settings), start_(clock()) {
    q_.setZero(model.dofs);
    trial_ = d_ = residual_ = load_ = q_;
    // F(0): at rest the body itself exerts no force, so this is the load.
    model.force(q_, load_);
    // |F(0)|, the whole load, by which residuals are measured [N].
    scale_ = load_.norm();
  }

  /// False also of forces that only rounding makes.
  [[nodiscard]] bool has_load() const { return scale_ > model_.rounding; }
  /// |F(0)| [N].
  [[nodiscard]] double load() const { return scale_; }
  [[nodiscard]] const VectorXd& q() const { return q_; }
  /// |R| / |F(0)| of the present iterate.
  [[nodiscard]] double residual() const { return size_; }
  /// |R - K d| / |F(0)| of the first linear system.
  [[nodiscard]] double left() const { return left_; }
  /// Linear systems solved so far.
  [[nodiscard]] int solved() const { return solved_; }
  [[nodiscard]] const std::string& note() const { return note_; }
  [[nodiscard]] const std::string& remedy() const { return remedy_; }
  /// Whether the last search ended at the border of what is admissible.
  [[nodiscard]] bool barred() const { return barred_; }
  /// Whether the last search ended beside a saddle of the energy, where no step was worth taking.
  [[nodiscard]] bool is_beside_saddle() const { return indefinite_ && note_ == no_step; }
  /// Whether the stiffness at rest was found to be singular.
  [[nodiscard]] bool singular() const { return note_ == not_held; }
  [[nodiscard]] StaticIterate iterate(int step, int steps) const {
    return {step, steps, size_, clock_() - start_, inner_.iterations(), solved_};
  }

  /// Takes up another share of the load.
  void set_share(double share) {
    share_ = share;
    forcing_ = size_before_ = shift_ = 0;
    creeping_ = 0;
    size_ = residual_at(q_);
  }

  /// Steps until the residual is at most `tolerance`, or rounding that gets no better.
  /// @param most  steps; counted in k
  /// @param seen  called after each
  /// @returns whether the residual is so small
  bool approach(double tolerance, int most, int& k, const std::function<void()>& seen) {
    double before = std::numeric_limits<double>::infinity();
    // At rounding it goes on only while a step at least halves the residual.
    while (k < most && size_ > tolerance && !(is_rounding() && size_ > before / 2)) {
      before = size_;
      if (!advance()) break;
      ++k;
      seen();
    }
    return size_ <= tolerance || is_rounding();
  }

  /// One step along the solution of a linear system.
  /// @returns false when no step could be made; note() then says why
  bool advance() {
    // A line search needs a nonlinear model; descent needs its energy.
    const bool searches = settings_.line_search && settings_.method != StaticMethod::linear;
    const bool has_energy = searches && model_.energy;
    residual_at(q_);
    if (!(has_energy ? set_descent() : set_direction())) return false;
    ++solved_;
    return walk(searches, has_energy);
  }

  /// Leaves an equilibrium that is a saddle of the energy, along the direction in which K is most negative.
  /// @param knows  the last K that Newton's method has seen tells, which costs nothing
  /// @returns false where the equilibrium is stable, or nothing is known of it
  bool leave_saddle(bool knows) {
    if (!settings_.leave_saddles || !settings_.line_search || !model_.energy ||
        settings_.method == StaticMethod::linear)
      return false;
    if (model_.dofs > most_factored_often || (knows && !indefinite_)) return false;
    model_.stiffness(q_, shifted_);
    SparseSolver<double>& solver = inner_.factors();
    stale_ = true;
    double tau = 0;
    const auto is_definite = [&] { return solver.factor(shifted_) && solver.negative_eigenvalues() == 0; };
    stable_ = is_definite();
    if (*stable_) return false;
    // K + tau I with tau doubled until all pivots are positive: the least eigenvalue lies within tau below
    // zero.
    const double size = shifted_.diagonal().cwiseAbs().mean();
    for (double next = 1e-6 * size; !is_definite(); next *= 2) {
      if (next > 1e3 * size) return false;
      shifted_.diagonal().array() += next - tau;
      tau = next;
    }
    // Inverse iteration from a start that is along no symmetry of the body.
    VectorXd z = VectorXd::LinSpaced(model_.dofs, 1, static_cast<double>(model_.dofs)).array().sin();
    for (int k = 0; k < 30; ++k) {
      solver.solve(z);
      z.normalize();
    }
    // z^T K z = z^T (K + tau I) z - tau, |z| = 1: negative curvature along z.
    const VectorXd image = shifted_ * z;
    if (!(z.dot(image) - tau < 0)) return false;
    const double energy = energy_at(q_);
    // From a tenth of |q| down, both ways, until the energy falls.
    for (double length = 0.1 * q_.norm(); length > 1e-6 * q_.norm(); length /= 4)
      for (const double way : {length, -length}) {
        trial_ = q_ + way * z;
        if ((!model_.admissible || model_.admissible(trial_)) && energy_at(trial_) < energy) {
          q_ = trial_;
          size_ = residual_at(q_);
          stable_.reset();
          note_.clear();
          remedy_.clear();
          return true;
        }
      }
    return false;
  }

  /// Whether K is positive definite here; nothing of more unknowns than are factored for it.
  std::optional<bool> is_stable() {
    if (!stable_ && model_.dofs <= most_factored_often) {
      model_.stiffness(q_, shifted_);
      stale_ = true;
      stable_ = inner_.factors().factor(shifted_) && inner_.factors().negative_eigenvalues() == 0;
    }
    return stable_;
  }

 private:
  /// Goes along d_ as far as the energy or the residual falls.
  /// Accepts q + a d, a = 1, 1/2, 1/4, ..., when the residual is smaller or Armijo's condition holds,
  ///   E(q + a d) <= E(q) - 1e-4 a R.d   [nocedal2006numerical, section 3.1].
  /// Along a direction of K + tau I the residual does not count where saddles are to be left.
  bool walk(bool searches, bool has_energy) {
    // -dE/da at a = 0, since R = -grad E.
    const double slope = residual_.dot(d_);
    constexpr double share_of_slope = 1e-4, shortest = 1e-4, shortest_when_barred = 1e-12, rounding = 1e-13;
    // The residual alone would be led into saddles.
    const bool residual_counts = !has_energy || !was_shifted_ || !settings_.leave_saddles;
    double length = 1, next = 0;
    std::optional<double> energy;  // here, where the residual has not been enough
    bool barred = false;           // by the last trial
    const auto falls = [&] {
      trial_ = q_ + length * d_;
      next = residual_at(trial_);
      barred = model_.admissible && !model_.admissible(trial_);
      if (barred) return false;
      if (residual_counts && next < size_) return true;
      if (!has_energy) return false;
      if (!energy) energy = energy_at(q_);
      // The energy to be gained is below its rounding: the residual decides.
      if (length * slope <= rounding * std::abs(*energy)) return next < size_;
      return energy_at(trial_) <= *energy - share_of_slope * length * slope;
    };
    bool was_barred = false, fallen = falls() || !searches;
    while (!fallen && length > (barred ? shortest_when_barred : shortest)) {
      was_barred = was_barred || barred;
      length /= 2;
      fallen = falls();
    }
    // Whoever creeps along the border of what is admissible does not come away from it.
    // Three steps in a row shorter than a thousandth, each cut short by the border.
    constexpr double creeping = 1e-3;
    constexpr int most_creeping = 3;
    creeping_ = searches && was_barred && length < creeping ? creeping_ + 1 : 0;
    barred_ = searches && ((barred && !fallen) || creeping_ == most_creeping);
    if (barred_) return give_up("the steps of the search lead to elements turned inside out", more_steps);
    if (!std::isfinite(next)) return give_up("the forces are no longer finite", more_steps);
    if (!fallen && size_ > settings_.tolerance) return give_up(no_step, more_steps);
    q_ = trial_;
    size_ = next;
    return true;
  }

  /// Whether what is left of the residual is rounding.
  [[nodiscard]] bool is_rounding() const { return size_ * scale_ <= model_.rounding; }

  /// d_ = K^-1 residual_.
  /// K at q for Newton's method, at rest for the others, where it is taken once.
  /// @return  false when K is singular or the solver gave up
  bool set_direction() {
    const bool constant = settings_.method != StaticMethod::newton;
    if (!constant || !taken_ || stale_) {
      stale_ = false;
      model_.stiffness(constant ? VectorXd::Zero(model_.dofs) : q_, K_);
      if (!inner_.take(K_))
        return taken_ ? give_up("the stiffness matrix has become singular", more_steps) : give_up(not_held);
    }
    if (!constant && !settings_.inner_tolerance) inner_.set_tolerance(next_forcing());
    // |R| before the step, for the next forcing term.
    size_before_ = size_;
    if (!inner_.solve(residual_, d_))
      return settings_.inner == InnerSolver::sor
                 ? give_up(
                       fmt::format(
                           "{} sweeps of sor with a relaxation of {} have left {:.2g} of a linear system",
                           settings_.inner_iterations, to_text(settings_.relaxation), inner_.left()),
                       "direct, which also tells whether the supports hold the body, or another relaxation")
                 : give_up(fmt::format("{} did not solve a linear system", name_of(settings_.inner)),
                           "direct");
    if (!taken_) {
      left_ = (residual_ - K_ * d_).norm() / scale_;
      // Of a matrix that only rounding keeps regular.
      if (!(left_ < 0.5 * size_)) return give_up(not_held);
    }
    taken_ = true;
    return true;
  }

  /// d_ = (K + tau I)^-1 residual_, downhill, with tau = 0 where that will do.
  /// tau begins at 1e-4 of the mean diagonal, then at a sixteenth of the last one that was needed, and is
  /// made four times larger until it will do [nocedal2006numerical, section 3.4]. Far above the least
  /// eigenvalue steps creep, and towards saddles: no smaller tau follows where these may be kept.
  bool set_descent() {
    const auto is_descent = [&] { return residual_.dot(d_) > 0 && !inner_.is_indefinite(); };
    was_shifted_ = indefinite_ = false;
    const bool solved = set_direction();
    indefinite_ = solved && inner_.is_indefinite();
    if (solved && is_descent()) return true;
    if (!taken_ || settings_.method != StaticMethod::newton) return solved;
    was_shifted_ = true;
    constexpr double first = 1e-4, most = 1e8, growth = 4;
    const double least = settings_.leave_saddles && shift_ > 0 ? 1e-10 : first;
    // The mean diagonal is the scale of tau.
    const double size = K_.diagonal().cwiseAbs().mean();
    for (double tau = std::max(least * size, shift_ / (growth * growth)); tau < most * size; tau *= growth) {
      shifted_ = K_;
      shifted_.diagonal().array() += tau;
      if (inner_.take(shifted_) && inner_.solve(residual_, d_) && is_descent()) {
        shift_ = tau;
        note_.clear();
        remedy_.clear();
        return true;
      }
    }
    return give_up("no direction leads down the energy", more_steps);
  }

  /// E(q) + (1 - share) F(0).q, whose downward slope is the residual.
  double energy_at(const VectorXd& q) { return model_.energy(q) + (1 - share_) * load_.dot(q); }
  /// |F(q) - (1 - share) F(0)| / |F(0)|, with the vector in residual_.
  double residual_at(const VectorXd& q) {
    model_.force(q, residual_);
    residual_ -= (1 - share_) * load_;
    return residual_.norm() / scale_;
  }
  /// How much of the residual the linear system may leave, so that an inexact Newton method converges almost
  /// as fast as an exact one: 0.9 (|F_k| / |F_(k-1)|)^2, not much less than the last one, and no less than
  /// the last iteration needs.
  /// @source [eisenstat1996choosing] (2.6) and 2.2
  double next_forcing() {
    constexpr double largest = 0.1, share = 0.9, worth_keeping = 0.1;
    // The safeguard of the source: eta does not fall much faster than the last one squared allows.
    const double before = share * forcing_ * forcing_, ratio = size_ / size_before_;
    forcing_ = size_before_ > 0 ? share * ratio * ratio : largest;
    if (before > worth_keeping) forcing_ = std::max(forcing_, before);
    forcing_ = std::min(std::max(forcing_, settings_.tolerance / (2 * size_)), largest);
    return forcing_;
  }
  static constexpr auto not_held = "the stiffness matrix is singular: the supports do not hold the body";
  static constexpr auto no_step = "no step along the last direction makes the residual smaller";
  static constexpr auto more_steps = "more load steps";
  /// Keeps the reason for note() and remedy(). @returns false
  bool give_up(std::string why, std::string remedy = "") {
    note_ = std::move(why);
    remedy_ = std::move(remedy);
    return false;
  }

  const StaticModel& model_;
  const StaticSettings& settings_;
  const Clock& clock_;
  Inner inner_;
  Matrix K_, shifted_;  ///< K and K + tau I [N/m]
  // The iterate, the trial of a line search, the direction, R(q) and F(0), shape (dofs) each.
  VectorXd q_, trial_, d_, residual_, load_;
  // |F(0)| [N]; the share of the load; |R| / |F(0)|; when the clock was started.
  double scale_ = 0, share_ = 1, size_ = 0, start_;
  double left_ = 0;
  double size_before_ = 0, forcing_ = 0;  ///< of the last iterate, 0: none
  double shift_ = 0;                      ///< the last one that was needed
  int solved_ = 0, creeping_ = 0;
  bool taken_ = false, stale_ = false, barred_ = false;
  bool indefinite_ = false, was_shifted_ = false;  ///< the last K; the last direction is that of K + tau I
  std::optional<bool> stable_;                     ///< whether K is positive definite at the last equilibrium
  std::string note_, remedy_;
};

/// @throws InputError  "WHAT is VALUE but must be RANGE"
void require(bool holds, std::string_view what, double value, std::string_view range) {
  if (!holds) throw InputError(fmt::format("{} is {} but must be {}", what, to_text(value), range));
}

/// @throws InputError  for the first setting out of range; NaN is out of every range
void check(const StaticSettings& s) {
  require(s.tolerance > 0 && s.tolerance < 1, "the tolerance", s.tolerance, "above 0 and below 1");
  require(s.iterations > 0, "the number of iterations", s.iterations, "at least 1");
  const int load_steps = s.load_steps.value_or(1);
  require(load_steps > 0 && load_steps <= 1'000'000, "the number of load steps", load_steps,
          "at least 1 and at most a million");
  if (s.inner_tolerance)
    require(*s.inner_tolerance > 0 && *s.inner_tolerance < 1, "the inner tolerance", *s.inner_tolerance,
            "above 0 and below 1");
  require(s.inner_iterations > 0, "the number of inner iterations", s.inner_iterations, "at least 1");
  require(s.relaxation > 0 && s.relaxation < 2, "the relaxation", s.relaxation, "above 0 and below 2");
}

}  // namespace

std::string_view name_of(StaticMethod method) {
  switch (method) {
    case StaticMethod::linear:
      return "linear";
    case StaticMethod::newton:
      return "newton";
    case StaticMethod::modified_newton:
      break;
  }
  return "modified_newton";
}

std::string_view name_of(InnerSolver solver) {
  switch (solver) {
    case InnerSolver::direct:
      return "direct";
    case InnerSolver::sor:
      return "sor";
    case InnerSolver::conjugate_gradients:
      break;
  }
  return "cg";
}

namespace {

constexpr int most_saddles = 10;  // that a load step leaves

/// An equilibrium that is a saddle of the energy is no place where a body stays.
void tell_stability(std::optional<bool> stable, const StaticSettings& settings, StaticSolution& solution) {
  solution.stable = stable;
  if (stable.value_or(true)) return;
  solution.note += fmt::format(
      "{}this equilibrium is a saddle: it is not stable, its stiffness is negative along some "
      "displacement",
      solution.note.empty() ? "" : "; ");
  const bool searched = settings.line_search && settings.leave_saddles;
  solution.remedy = searched ? "a smaller load or a stiffer material" : "a line search, which leaves saddles";
}

/// Of a solution whose residual is above the tolerance.
void tell_residual(const Iteration& iteration, const StaticSettings& settings, StaticSolution& solution) {
  if (settings.method != StaticMethod::linear) {
    solution.note =
        fmt::format("the residual of {:.2g} is rounding of the forces; the tolerance asks for less",
                    iteration.residual());
  } else if (iteration.residual() > iteration.left() + settings.tolerance) {
    solution.note = fmt::format(
        "the linear system is solved; beside it the forces, which are not linear, leave {:.3g} of the load",
        iteration.residual());
  } else {
    solution.note = fmt::format("the linear system is solved to {:.3g} of the load", iteration.left());
    solution.remedy = fmt::format("a smaller tolerance of {}", name_of(settings.inner));
  }
}

/// Of a load that is nothing, or within the rounding of the forces.
StaticSolution at_rest(const Iteration& iteration, const StaticModel& model) {
  StaticSolution solution;
  solution.converged = true;
  solution.q = iteration.q();
  solution.history.push_back({1, 1, 0, 0, 0});
  if (iteration.load() > 0)
    solution.note = fmt::format("the load of {:.2g} N is within the rounding of the forces, {:.2g} N",
                                iteration.load(), model.rounding);
  return solution;
}

}  // namespace

// Load steps from outside to inside: share of the load, Newton iteration to the tolerance, departure from
// saddles and iteration again.
StaticSolution solve_static(const StaticModel& model, const StaticSettings& settings, const Clock& clock) {
  check(settings);
  StaticSolution solution;
  Iteration iteration(model, settings, clock);
  solution.q = iteration.q();
  if (!iteration.has_load()) return at_rest(iteration, model);
  const bool linear = settings.method == StaticMethod::linear;
  const int steps = linear ? 1 : settings.load_steps.value_or(1);
  const auto record = [&](int step) {
    solution.history.push_back(iteration.iterate(step, steps));
    if (settings.seen) settings.seen(solution.history.back());
  };
  for (int step = 1; step <= steps; ++step) {
    // Each load step starts from the solution of the one before.
    iteration.set_share(static_cast<double>(step) / steps);
    record(step);
    int k = 0, left = 0;
    // A linear solution is what one system gives, and its residual says what the model leaves out.
    const int most = linear ? 1 : settings.iterations;
    for (bool goes_on = true; goes_on;) {
      const bool balanced = iteration.approach(settings.tolerance, most, k, [&] { record(step); });
      solution.converged = linear ? k == 1 : balanced;
      goes_on = (solution.converged || iteration.is_beside_saddle()) && !linear && left++ < most_saddles &&
                iteration.leave_saddle(step < steps);
      if (goes_on) record(step);
    }
    solution.note = iteration.note();
    solution.remedy = iteration.remedy();
    if (solution.converged) {
      solution.note.clear();
      solution.remedy.clear();
      if (iteration.residual() > settings.tolerance) tell_residual(iteration, settings, solution);
      if (!linear && step == steps) tell_stability(iteration.is_stable(), settings, solution);
    } else {
      if (solution.note.empty()) {
        solution.note = fmt::format("the residual is still {:.3g} after {} iterations of load step {}",
                                    iteration.residual(), k, step);
        solution.remedy = "more iterations or more load steps";
      }
      solution.barred = iteration.barred();
      solution.singular = iteration.singular();
      break;
    }
  }
  solution.q = iteration.q();
  solution.iterations = iteration.solved();
  return solution;
}

// Eleven candidates on the system of the first Newton step, K(0) d = F(0).
double best_relaxation(const StaticModel& model, const StaticSettings& settings) {
  Matrix K;
  VectorXd d, load;
  model.stiffness(VectorXd::Zero(model.dofs), K);
  model.force(VectorXd::Zero(model.dofs), load);
  double best = settings.relaxation;
  Relaxed least{settings.inner_iterations, 1};
  for (const double omega : {1.0, 1.1, 1.2, 1.3, 1.4, 1.5, 1.6, 1.7, 1.8, 1.9, 1.95}) {
    const Relaxed reached =
        relax(K, load, d, omega, settings.inner_tolerance.value_or(default_inner_tolerance), least.sweeps);
    // Of equally many sweeps the one that leaves less; later candidates get no more sweeps than the best
    // so far.
    if (reached.sweeps < least.sweeps || (reached.sweeps == least.sweeps && reached.left < least.left)) {
      least = reached;
      best = omega;
    }
  }
  return best;
}

// Two iterations side by side: `shown` with a fixed number of steps a frame, `exact` to 1e-12 for the
// error.
std::vector<StaticFrame> pseudo_dynamic(const StaticModel& model, const StaticSettings& settings, int frames,
                                        int iterations, const Clock& clock) {
  check(settings);
  require(frames > 0, "the number of frames", frames, "at least 1");
  require(iterations > 0, "the number of iterations of a frame", iterations, "at least 1");
  std::vector<StaticFrame> all;
  // Line searches take an unknown time, which a frame does not have.
  StaticSettings as_it_comes = settings;
  as_it_comes.line_search = false;
  StaticSettings thorough = settings;
  thorough.method = StaticMethod::newton;
  thorough.inner = InnerSolver::direct;
  Iteration shown(model, as_it_comes, clock), exact(model, thorough, clock);
  if (!shown.has_load()) return all;
  for (int frame = 1; frame <= frames; ++frame) {
    const double share = static_cast<double>(frame) / frames, start = clock();
    shown.set_share(share);
    for (int k = 0; k < iterations && shown.advance(); ++k) {
    }
    const double seconds = clock() - start;
    exact.set_share(share);
    int k = 0;
    const bool known =
        exact.approach(1e-12, thorough.iterations, k, [] {}) || exact.residual() <= thorough.tolerance;
    const double size = exact.q().norm();
    // |q - q*| / |q*|
    const double error = size > 0 ? (shown.q() - exact.q()).norm() / size : 0;
    all.push_back(
        {share, shown.residual(), known ? error : std::numeric_limits<double>::quiet_NaN(), seconds});
    if (!std::isfinite(shown.residual())) break;
  }
  return all;
}

}  // namespace hmax
