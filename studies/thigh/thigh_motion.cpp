#include "studies/thigh/thigh_motion.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <utility>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <fmt/format.h>

#include "bench/timing/timing.hpp"
#include "catalogue/methods/catalogue.hpp"
#include "limits/predict.hpp"
#include "results/json.hpp"

namespace hmax {

namespace {

constexpr double sample = 0.01;  // [s]

void require_positive(double value, const char* name) {
  if (!(value > 0) || !std::isfinite(value))
    throw std::invalid_argument(
        fmt::format("{} of the moving thigh is {}; it must be positive", name, value));
}

/// The moving thigh as a system of second order.
class ThighMotion {
 public:
  using State = Eigen::VectorXd;
  using Dofs = Eigen::VectorXd;
  using DofMatrix = Eigen::SparseMatrix<double>;
  using Jacobian = Eigen::SparseMatrix<double>;

  ThighMotion(Thigh thigh, ThighDrive drive)
      : thigh_(std::move(thigh)), drive_(std::move(drive)), damping_(drive_.damping * drive_.mass) {}

  [[nodiscard]] Eigen::Index dofs() const { return thigh_.points(); }
  [[nodiscard]] Eigen::Index dim() const { return 2 * dofs(); }
  [[nodiscard]] Dofs mass() const { return Dofs::Constant(dofs(), drive_.mass); }
  void force(double t, const Dofs& q, const Dofs& v, Dofs& f) const {
    f.resize(dofs());
    write_force(t, q, v, f);
  }
  void stiffness(double, const Dofs& q, const Dofs&, DofMatrix& K) const {
    K = thigh_.stiffness(q);
    K.diagonal() += drive_.springs;
  }
  void damping(double, const Dofs&, const Dofs&, DofMatrix& C) const {
    C.resize(dofs(), dofs());
    C.setIdentity();
    C *= damping_;
  }
  void rhs(double t, const State& y, State& dydt) const {
    const Eigen::Index n = dofs();
    dydt.head(n) = y.tail(n);
    write_force(t, y.head(n), y.tail(n), dydt.tail(n));
    dydt.tail(n) /= drive_.mass;
  }
  void jacobian(double t, const State& y, Jacobian& J) const {
    const Eigen::Index n = dofs();
    DofMatrix K;
    stiffness(t, y.head(n), y.tail(n), K);
    std::vector<Eigen::Triplet<double, Eigen::Index>> entries;
    for (Eigen::Index j = 0; j < n; ++j) {
      for (DofMatrix::InnerIterator entry(K, j); entry; ++entry)
        entries.emplace_back(n + entry.row(), j, -entry.value() / drive_.mass);
      entries.emplace_back(j, n + j, 1);
      entries.emplace_back(n + j, n + j, -damping_ / drive_.mass);
    }
    J.resize(2 * n, 2 * n);
    J.setFromTriplets(entries.begin(), entries.end());
  }

 private:
  using Values = Eigen::Ref<const Dofs>;
  void write_force(double t, const Values& q, const Values& v, Eigen::Ref<Dofs> f) const {
    f = drive_.share(t) * drive_.force - damping_ * v;
    f -= drive_.springs.cwiseProduct(q);
    thigh_.subtract_forces(q, f);
  }

  Thigh thigh_;
  ThighDrive drive_;
  double damping_;  // of a point [N s/m]
};

Eigen::VectorXd pressed_shape(const Thigh& thigh, const ThighLoad& load) {
  return press(thigh, pressed_points(thigh, load.point, load.probe), {&load.depth, 1}).front().u;
}

double limit_at(const Method& method, const Problem& problem, const Eigen::VectorXd& u) {
  Eigen::VectorXd y = Eigen::VectorXd::Zero(2 * u.size());
  y.head(u.size()) = u;
  return predict(method, linearised(problem, 0, y)).h_max.value_or(std::numeric_limits<double>::quiet_NaN());
}

ThighRun sampled(const Problem& problem, const std::string& id, const RunSpec& spec, Eigen::Index point) {
  const Runner runner = find_method(id).bind(problem);
  ThighRun run{
      .method = id, .h = spec.h, .constant = spec.jacobian.every == JacobianUpdate::frozen, .t{}, .u{}};
  const RunRecord record = runner.run(spec, [&](double t, const Eigen::Ref<const Eigen::VectorXd>& y) {
    run.t.push_back(t);
    run.u.push_back(y[point]);
  });
  run.reached_end = record.outcome == Outcome::reached_end;
  if (!run.reached_end) {
    run.real_time = std::numeric_limits<double>::quiet_NaN();
    return run;
  }
  const std::array<std::function<void(std::int64_t)>, 1> task{
      [&](std::int64_t runs) { runner.repeat(spec, runs); }};
  const auto timing = time_interleaved(task, {.repetitions = 5, .min_sample_s = 2e-3}).front();
  run.real_time = spec.t_end / timing.least();
  return run;
}

double error_beside(const ThighRun& run, const ThighRun& reference) {
  if (!run.reached_end || run.u.size() != reference.u.size()) return std::numeric_limits<double>::quiet_NaN();
  double largest = 0, difference = 0;
  for (std::size_t k = 0; k < run.u.size(); ++k) {
    largest = std::max(largest, std::abs(reference.u[k]));
    difference = std::max(difference, std::abs(run.u[k] - reference.u[k]));
  }
  return difference / largest;
}

}  // namespace

Problem driven_thigh(const Thigh& thigh, ThighDrive drive, double t_end) {
  Parameters parameters{HMAX_KEYS(drive, mass, damping)};
  return {.id = "thigh",
          .note = "points of skin on springs, pressed by a probe",
          .parameters = std::move(parameters),
          .y0 = Eigen::VectorXd::Zero(2 * thigh.points()),
          .t_end = t_end,
          .system = AnySystem(ThighMotion(thigh, std::move(drive)))};
}

Problem moving_thigh(const Thigh& thigh, const ThighLoad& load) {
  require_positive(load.mass, "the mass");
  require_positive(load.damping, "the damping");
  require_positive(load.depth, "the depth");
  require_positive(load.rise, "the rise");
  Eigen::VectorXd force = Eigen::VectorXd::Zero(thigh.points());
  const Eigen::VectorXd r = thigh.forces(pressed_shape(thigh, load));
  for (const Eigen::Index p : pressed_points(thigh, load.point, load.probe)) force[p] = r[p];
  // g rises within one rise, stays for two, falls within one.
  const auto share = [rise = load.rise](double t) {
    const double x = std::clamp(std::min(t, 4 * rise - t) / rise, 0.0, 1.0);
    return 0.5 * (1 - std::cos(std::numbers::pi * x));
  };
  return driven_thigh(thigh,
                      {.mass = load.mass,
                       .damping = load.damping,
                       .force = std::move(force),
                       .share = share,
                       .springs = Eigen::VectorXd::Zero(thigh.points())},
                      6 * load.rise);
}

std::vector<ThighLimit> thigh_limits(const std::vector<std::string>& methods, const Thigh& thigh,
                                     const ThighLoad& load) {
  const Problem problem = moving_thigh(thigh, load);
  const Eigen::VectorXd u = pressed_shape(thigh, load);
  std::vector<ThighLimit> limits;
  for (const std::string& id : methods) {
    const Method method = find_method(id);
    limits.push_back({id, limit_at(method, problem, 0 * u), limit_at(method, problem, u)});
  }
  return limits;
}

double stable_mass(const std::string& method, const Thigh& thigh, ThighLoad load, double h) {
  const Method found = find_method(method);
  const Eigen::VectorXd u = pressed_shape(thigh, load);
  const auto stable = [&](double mass) {
    load.mass = mass;
    return limit_at(found, moving_thigh(thigh, load), u) >= h;
  };
  double low = load.mass, high = 1e6 * load.mass;
  if (stable(low)) return low;
  if (!stable(high)) return std::numeric_limits<double>::infinity();
  while (high > 1.01 * low) {
    const double middle = std::sqrt(low * high);
    (stable(middle) ? high : low) = middle;
  }
  return high;
}

double deepest_under(const Thigh& thigh, double force) {
  // r is convex and increasing: Newton's method from above converges without a line search.
  Eigen::VectorXd u = ((1 + force / thigh.a.array()).log() / thigh.b.array()).matrix();
  u.setConstant(u.maxCoeff());
  for (int i = 0; i < 100; ++i) {
    const Eigen::MatrixXd K(thigh.stiffness(u));
    const Eigen::VectorXd step = K.llt().solve(thigh.forces(u) - Eigen::VectorXd::Constant(u.size(), force));
    u -= step;
    if (step.cwiseAbs().maxCoeff() < 1e-12) break;
  }
  return u.maxCoeff();
}

double share_left(const Thigh& thigh, const ThighLoad& load) {
  const Problem problem = moving_thigh(thigh, load);
  double most = 0, last = 0;
  find_method("dop_853").bind(problem).run(
      {.t_end = problem.t_end, .adaptive = true, .rtol = 1e-8, .atol = 1e-11},
      [&](double, const Eigen::Ref<const Eigen::VectorXd>& y) {
        last = std::abs(y[load.point]);
        most = std::max(most, last);
      });
  return last / most;
}

double slowest_period(const Thigh& thigh, double mass) {
  const Eigen::MatrixXd K(thigh.stiffness(Eigen::VectorXd::Zero(thigh.points())));
  const double least =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(K, Eigen::EigenvaluesOnly).eigenvalues()[0];
  return 2 * std::numbers::pi * std::sqrt(mass / least);
}

Eigen::VectorXd constant_jacobian_depths(const Thigh& thigh, const ThighLoad& load, double h, double most) {
  const Eigen::Index n = thigh.points();
  Eigen::MatrixXd bound = 2 * h * h * Eigen::MatrixXd(thigh.stiffness(Eigen::VectorXd::Zero(n)));
  bound.diagonal().array() += load.mass * (4 + 2 * h * load.damping);
  ThighLoad at = load;
  const auto stable = [&](double depth) {
    at.depth = depth;
    const Eigen::MatrixXd rest = bound - h * h * Eigen::MatrixXd(thigh.stiffness(pressed_shape(thigh, at)));
    return rest.llt().info() == Eigen::Success;
  };
  Eigen::VectorXd depths(n);
  for (at.point = 0; at.point < n; ++at.point) {
    double low = 0, high = most;
    if (stable(most)) {
      depths[at.point] = std::numeric_limits<double>::infinity();
      continue;
    }
    while (high - low > 1e-3 * most) {
      const double middle = 0.5 * (low + high);
      (stable(middle) ? low : high) = middle;
    }
    depths[at.point] = low;
  }
  return depths;
}

std::vector<ThighRun> thigh_runs(const Thigh& thigh, const ThighLoad& load) {
  const Problem problem = moving_thigh(thigh, load);
  const double t_end = problem.t_end;
  std::vector<ThighRun> runs;
  runs.push_back(sampled(problem, "dop_853",
                         {.t_end = t_end, .adaptive = true, .rtol = 1e-9, .atol = 1e-12, .every = sample},
                         load.point));
  const auto with = [&](const char* method, double h, JacobianUpdate jacobian) {
    runs.push_back(sampled(problem, method, {.t_end = t_end, .h = h, .jacobian = jacobian, .every = sample},
                           load.point));
  };
  with("linearly_implicit_euler", 0.01, {.every = 1});
  with("linearly_implicit_euler", 0.01, {.every = JacobianUpdate::frozen});
  with("explicit_euler", 0.01, {});
  with("symplectic_euler", 0.001, {});
  for (ThighRun& run : runs) run.error = error_beside(run, runs.front());
  return runs;
}

}  // namespace hmax
