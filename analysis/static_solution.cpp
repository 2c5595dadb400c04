#include "analysis/static_solution.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "integrators/sparse_solver.hpp"
#include "results/errors.hpp"
#include "results/numbers.hpp"

namespace hmax {
namespace {

using Eigen::VectorXd;
using Matrix = StaticModel::Matrix;

/// d = K^-1 r by sweeps of successive over-relaxation over the rows of the symmetric K, from d = 0:
///   d_i <- d_i + omega (r_i - sum_j K_ij d_j) / K_ii.
/// @returns the number of sweeps; negative when it was not enough
int relax(const Matrix& K, const VectorXd& r, VectorXd& d, double omega, double tolerance, int most) {
  d.setZero(r.size());
  const double goal = tolerance * r.norm();
  VectorXd left(r.size());
  for (int sweep = 1; sweep <= most; ++sweep) {
    for (Eigen::Index i = 0; i < K.cols(); ++i) {
      double rest = r[i], diagonal = 0;
      for (Matrix::InnerIterator entry(K, i); entry; ++entry) {
        if (entry.row() == i) diagonal = entry.value();
        rest -= entry.value() * d[entry.row()];
      }
      d[i] += omega * rest / diagonal;
    }
    // The residual costs as much as a sweep.
    if (sweep % 8 != 0 && sweep != most) continue;
    left.noalias() = r - K * d;
    const double size = left.norm();
    if (!std::isfinite(size)) return -sweep;
    if (size <= goal) return sweep;
  }
  return -most;
}

/// Solves K d = r by the chosen solver, whatever K is kept for.
class Inner {
 public:
  explicit Inner(const StaticSettings& settings) : settings_(settings) {
    set_tolerance(settings.inner_tolerance.value_or(1e-4));
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

  /// Whether K is known to have negative eigenvalues; what iterates cannot tell.
  [[nodiscard]] bool is_indefinite() const {
    return settings_.inner != InnerSolver::sor && solver_.negative_eigenvalues().value_or(0) > 0;
  }

  /// @returns false when the solver gave up
  bool solve(const VectorXd& r, VectorXd& d) {
    if (settings_.inner == InnerSolver::sor) {
      const int sweeps = relax(K_, r, d, settings_.relaxation, tolerance_, settings_.inner_iterations);
      iterations_ += std::abs(sweeps);
      return sweeps > 0;
    }
    d = r;
    solver_.solve(d);
    if (settings_.inner == InnerSolver::conjugate_gradients) iterations_ += solver_.iterations();
    return d.allFinite();
  }

  [[nodiscard]] std::int64_t iterations() const { return iterations_; }

 private:
  const StaticSettings& settings_;
  SparseSolver<double> solver_;
  Matrix K_;
  double tolerance_ = 0;
  std::int64_t iterations_ = 0;
};

/// The iteration towards F(q) = (1 - share) F(0), that is towards equilibrium under a share of the load.
class Iteration {
 public:
  Iteration(const StaticModel& model, const StaticSettings& settings, const Clock& clock)
      : model_(model), settings_(settings), clock_(clock), inner_(settings), start_(clock()) {
    q_.setZero(model.dofs);
    trial_ = d_ = residual_ = load_ = q_;
    model.force(q_, load_);
    scale_ = load_.norm();
  }

  [[nodiscard]] bool has_load() const { return scale_ > 0; }
  [[nodiscard]] const VectorXd& q() const { return q_; }
  [[nodiscard]] double residual() const { return size_; }
  [[nodiscard]] int solved() const { return solved_; }
  [[nodiscard]] const std::string& note() const { return note_; }
  [[nodiscard]] bool barred() const { return barred_; }
  [[nodiscard]] StaticIterate iterate(int step) const {
    return {step, size_, clock_() - start_, inner_.iterations()};
  }

  /// Takes up another share of the load.
  void set_share(double share) {
    share_ = share;
    forcing_ = size_before_ = 0;
    size_ = residual_at(q_);
  }

  /// One step along the solution of a linear system.
  /// @returns false when no step could be made; note() then says why
  bool advance() {
    const bool searches = settings_.line_search && settings_.method != StaticMethod::linear;
    const bool has_energy = searches && model_.energy;
    residual_at(q_);
    if (!(has_energy ? set_descent() : set_direction())) return false;
    ++solved_;
    const double slope = residual_.dot(d_);
    // A step downhill cannot fail to lower the energy but by rounding, which the residual sees through.
    constexpr double share_of_slope = 1e-4, shortest = 1e-4, shortest_when_barred = 1e-12;
    double length = 1, next = 0;
    std::optional<double> energy;  // here, where the residual has not been enough
    bool barred = false;           // on the way
    const auto falls = [&] {
      if (model_.admissible && !model_.admissible(trial_)) {
        barred = true;
        return false;
      }
      if (next < size_ || !has_energy) return next < size_;
      if (!energy) energy = energy_at(q_);
      return energy_at(trial_) <= *energy - share_of_slope * length * slope;
    };
    const auto walk = [&] {
      trial_ = q_ + length * d_;
      next = residual_at(trial_);
    };
    walk();
    bool fallen = !searches || falls();
    while (!fallen && length > (barred ? shortest_when_barred : shortest)) {
      length /= 2;
      walk();
      fallen = falls();
    }
    // Whoever creeps along the border of what is admissible does not come away from it.
    constexpr double creeping = 1e-3;
    constexpr int most_creeping = 3;
    creeping_ = barred && length < creeping ? creeping_ + 1 : 0;
    barred_ = barred && (!fallen || creeping_ == most_creeping);
    if (barred_) return give_up("all ways down the energy lead to elements turned inside out");
    if (!std::isfinite(next)) return give_up("the forces are no longer finite; take more load steps");
    if (!fallen && size_ > settings_.tolerance)
      return give_up("no step along the last direction makes the residual smaller; take more load steps");
    q_ = trial_;
    size_ = next;
    return true;
  }

 private:
  /// d_ = K^-1 residual_.
  bool set_direction() {
    const bool constant = settings_.method != StaticMethod::newton;
    if (!constant || !taken_) {
      model_.stiffness(constant ? VectorXd::Zero(model_.dofs) : q_, K_);
      if (!inner_.take(K_))
        return give_up(taken_ ? "the stiffness matrix has become singular; take more load steps" : not_held);
    }
    if (!constant && !settings_.inner_tolerance) inner_.set_tolerance(next_forcing());
    size_before_ = size_;
    if (!inner_.solve(residual_, d_))
      return give_up(
          fmt::format("{} did not solve a linear system in {} iterations; take direct, or more "
                      "iterations",
                      name_of(settings_.inner), settings_.inner_iterations));
    // Of a matrix that only rounding keeps regular.
    if (!taken_ && !((residual_ - K_ * d_).norm() < 0.5 * residual_.norm())) return give_up(not_held);
    taken_ = true;
    return true;
  }

  /// d_ = (K + tau I)^-1 residual_, downhill, with tau = 0 where that will do.
  bool set_descent() {
    const auto is_descent = [&] { return !inner_.is_indefinite() && residual_.dot(d_) > 0; };
    const bool solved = set_direction();
    if (solved && is_descent()) return true;
    if (!taken_ || settings_.method != StaticMethod::newton) return solved;
    constexpr double least = 1e-4, growth = 4;
    constexpr int most = 20;  // to a million times K
    const double size = K_.diagonal().cwiseAbs().mean();
    double tau = std::max(least * size, shift_ / (growth * growth));
    for (int k = 0; k < most; ++k, tau *= growth) {
      shifted_ = K_;
      shifted_.diagonal().array() += tau;
      if (inner_.take(shifted_) && inner_.solve(residual_, d_) && is_descent()) {
        shift_ = tau;
        note_.clear();
        return true;
      }
    }
    return solved;
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
    const double before = share * forcing_ * forcing_, ratio = size_ / size_before_;
    forcing_ = size_before_ > 0 ? share * ratio * ratio : largest;
    if (before > worth_keeping) forcing_ = std::max(forcing_, before);
    forcing_ = std::min(std::max(forcing_, settings_.tolerance / (2 * size_)), largest);
    return forcing_;
  }
  static constexpr auto not_held = "the stiffness matrix is singular: the supports do not hold the body";
  bool give_up(std::string why) {
    note_ = std::move(why);
    return false;
  }

  const StaticModel& model_;
  const StaticSettings& settings_;
  const Clock& clock_;
  Inner inner_;
  Matrix K_, shifted_;
  VectorXd q_, trial_, d_, residual_, load_;
  double scale_ = 0, share_ = 1, size_ = 0, start_;
  double size_before_ = 0, forcing_ = 0;  // of the last iterate, 0: none
  double shift_ = 0;                      // the last one that was needed
  int solved_ = 0, creeping_ = 0;
  bool taken_ = false, barred_ = false;
  std::string note_;
};

void require(bool holds, std::string_view what, double value, std::string_view range) {
  if (!holds) throw InputError(fmt::format("{} is {} but must be {}", what, to_text(value), range));
}

void check(const StaticSettings& s) {
  require(s.tolerance > 0 && s.tolerance < 1, "the tolerance", s.tolerance, "above 0 and below 1");
  require(s.iterations > 0, "the number of iterations", s.iterations, "at least 1");
  require(s.load_steps > 0 && s.load_steps <= 1'000'000, "the number of load steps", s.load_steps,
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

StaticSolution solve_static(const StaticModel& model, const StaticSettings& settings, const Clock& clock) {
  check(settings);
  StaticSolution solution;
  Iteration iteration(model, settings, clock);
  solution.q = iteration.q();
  if (!iteration.has_load()) {
    solution.converged = true;
    solution.history.push_back({1, 0, 0, 0});
    return solution;
  }
  const auto record = [&](int step) {
    solution.history.push_back(iteration.iterate(step));
    if (settings.seen) settings.seen(solution.history.back());
  };
  const bool linear = settings.method == StaticMethod::linear;
  const int steps = linear ? 1 : settings.load_steps;
  for (int step = 1; step <= steps; ++step) {
    iteration.set_share(static_cast<double>(step) / steps);
    record(step);
    int k = 0;
    // A linear solution is what one system gives, and its residual says what the model leaves out.
    const int most = linear ? 1 : settings.iterations;
    while (k < most && iteration.residual() > settings.tolerance && iteration.advance()) {
      ++k;
      record(step);
    }
    solution.converged = linear ? k == 1 : iteration.residual() <= settings.tolerance;
    if (!solution.converged) {
      solution.note = !iteration.note().empty()
                          ? iteration.note()
                          : fmt::format(
                                "the residual is still {:.3g} after {} iterations of load step {}; "
                                "take more iterations or more load steps",
                                iteration.residual(), k, step);
      solution.barred = iteration.barred();
      break;
    }
  }
  solution.q = iteration.q();
  solution.iterations = iteration.solved();
  return solution;
}

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
    for (int k = 0; k < thorough.iterations && exact.residual() > 1e-12 && exact.advance(); ++k) {
    }
    const double size = exact.q().norm();
    all.push_back({share, shown.residual(), size > 0 ? (shown.q() - exact.q()).norm() / size : 0, seconds});
    if (!std::isfinite(shown.residual())) break;
  }
  return all;
}

}  // namespace hmax
