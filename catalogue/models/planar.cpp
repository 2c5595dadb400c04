#include "catalogue/models/planar.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include <fmt/format.h>

#include "analysis/dynamics/poincare.hpp"
#include "catalogue/methods/catalogue.hpp"
#include "catalogue/models/model.hpp"
#include "core/dense_solvers.hpp"
#include "core/input_error.hpp"
#include "core/numbers.hpp"
#include "problems/tissue/body.hpp"

namespace hmax {

namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;

Vector2d rhs_of(const std::variant<Oscillator, AnySystem>& system, double t, const Vector2d& y) {
  return std::visit(
      [&](const auto& typed) -> Vector2d {
        const typename std::remove_cvref_t<decltype(typed)>::State& state = y;
        auto dydt = state;
        typed.rhs(t, state, dydt);
        return dydt;
      },
      system);
}

/// f(t, .) of a system of two states, its time running forwards (sign 1) or backwards (sign -1).
struct FrozenSystem {
  using State = Vector2d;
  static constexpr bool autonomous = true;

  std::variant<Oscillator, AnySystem> system;
  double t, sign;

  static constexpr Eigen::Index dim() { return 2; }
  void rhs(double /*t*/, const State& y, State& dydt) const { dydt = sign * rhs_of(system, t, y); }
};

Problem with_system(const Problem& problem, const FrozenSystem& system) {
  Problem other = problem;
  other.system = AnySystem(system);
  other.extended = ExtendedSystem(system);
  other.exact = nullptr;
  other.has_exact_solution = false;
  return other;
}

/// A method whose steps are short enough to be drawn as a line.
const char* drawing_method(const Problem& problem) {
  return problem.stiff ? "rosenbrock_23" : "bogacki_shampine_32";
}

/// The largest A with ((k1 - m w^2 + 3/4 k3 A^2)^2 + (c w)^2) A^2 = P^2; 0 where nothing bounds it.
double largest_amplitude(const OscillatorParameters& p) {
  const double stiffness = p.k1 - p.m * p.w * p.w, hardening = 0.75 * p.k3, damping = p.c * p.w;
  if (p.P == 0 || hardening < 0) return 0;
  if (hardening == 0) {
    const double A = std::abs(p.P) / std::hypot(stiffness, damping);
    return std::isfinite(A) ? A : 0;
  }
  // s^3 + a s^2 + b s + c = 0 of s = A^2, as the eigenvalues of its companion matrix.
  const double square = hardening * hardening;
  Eigen::Matrix3d companion = Eigen::Matrix3d::Zero();
  companion.row(0) << -2 * stiffness * hardening / square,
      -(stiffness * stiffness + damping * damping) / square, p.P * p.P / square;
  companion(1, 0) = companion(2, 1) = 1;
  double largest = 0;
  for (const std::complex<double>& s : dense_eigenvalues(companion))
    if (std::abs(s.imag()) < 1e-6 * std::abs(s)) largest = std::max(largest, s.real());
  return std::sqrt(largest);
}

/// Ends a run from inside.
struct SeenEnough {};

// More steps than this show no more: a line of so many points has filled its loops.
constexpr int most_steps = 6000;

/// Calls see(t, y) at each accepted step from `start`, until it returns false or most_steps have been seen.
/// @param size  of the motion
template <class See>
void follow(Problem problem, const Vector2d& start, double t_end, double size, const See& see) {
  problem.y0 = start;
  const Tolerances<double> tolerances = tolerances_at(orbit_tolerances, size);
  const RunSpec spec{.t_end = t_end, .adaptive = true, .rtol = tolerances.rtol, .atol = tolerances.atol};
  int steps = 0;
  try {
    find_method(drawing_method(problem)).bind(problem).run(spec, [&](double t, const auto& y) {
      if (!see(t, Vector2d(y)) || ++steps > most_steps) throw SeenEnough{};
    });
  } catch (const SeenEnough&) {
  }
}

}  // namespace

void require_planar(const Problem& problem) {
  if (problem.y0.size() != 2)
    throw input_error(
        "{} has {} state{}, and a phase plane shows two; choose a problem of two states, like liver_forced, "
        "van_der_pol or a file of two formulas",
        problem.id, problem.y0.size(), problem.y0.size() == 1 ? "" : "s");
}

Problem frozen(const Problem& problem, double t) {
  if (!is_driven(problem)) return problem;
  if (const auto* oscillator = std::get_if<Oscillator>(&problem.system)) {
    OscillatorParameters parameters = oscillator->parameters();
    parameters.P *= std::cos(parameters.w * t);
    parameters.w = 0;
    Problem other = problem;
    other.system = Oscillator(parameters);
    other.extended = ExtendedSystem(BasicOscillator<long double>(parameters));
    other.has_exact_solution = false;
    return other;
  }
  return with_system(problem, FrozenSystem{problem.system, t, 1});
}

Problem reversed(const Problem& problem) { return with_system(problem, FrozenSystem{problem.system, 0, -1}); }

PlanarField planar_field(const Problem& problem, double t, const Vector2d& scale) {
  require_planar(problem);
  if (const auto* oscillator = std::get_if<Oscillator>(&problem.system)) return frozen_at(*oscillator, t);
  const AnySystem system = std::get<AnySystem>(problem.system);
  PlanarField field{[=](const Vector2d& y) { return rhs_of(system, t, y); }, {}};
  if (system.has_jacobian())
    field.jacobian = [=](const Vector2d& y) -> Matrix2d {
      AnySystem::Jacobian J;
      system.jacobian(t, y, J);
      return std::visit([](const auto& matrix) { return Matrix2d(Eigen::MatrixXd(matrix)); }, J);
    };
  else {
    field.jacobian = [rhs = field.rhs, scale](const Vector2d& y) -> Matrix2d {
      return differenced_jacobian(rhs, y, scale);
    };
    field.jacobian_error = 1e-6;
  }
  return field;
}

double drive_period(const Problem& problem, std::optional<double> named) {
  require_planar(problem);
  if (!named && !is_driven(problem))
    throw input_error(
        "{} is not driven, so there is no period to look at; choose a driven problem like "
        "liver_forced, or name a period with --period",
        problem.id);
  if (!named) {
    if (const auto* oscillator = std::get_if<Oscillator>(&problem.system))
      return 2 * std::numbers::pi / std::abs(oscillator->parameters().w);
    throw input_error("the period of the force of {} is not known; name it with --period, in seconds",
                      problem.id);
  }
  const double period = *named;
  if (!(period > 0) || !std::isfinite(period))
    throw input_error("--period is {} but must be a positive number of seconds", to_text(period));
  double size = 0, change = 0;
  for (int i = 0; i < 16; ++i) {
    const double t = i * period / 16;
    const Vector2d now = rhs_of(problem.system, t, problem.y0);
    const Vector2d later = rhs_of(problem.system, t + period, problem.y0);
    size = std::max({size, now.cwiseAbs().maxCoeff(), later.cwiseAbs().maxCoeff()});
    change = std::max(change, (later - now).cwiseAbs().maxCoeff());
  }
  if (change > 1e-9 * size)
    throw input_error("the force of {} is not the same {} s later; give --period the period of the force",
                      problem.id, to_text(period));
  return period;
}

Tolerances<double> tolerances_at(Tolerances<double> tolerances, double size) {
  constexpr double least = 1e-250;
  if (size > 0 && size < ordinary_size)
    tolerances.atol = to_number(fmt::format("{:.0e}", tolerances.atol * std::max(size, least))).value();
  return tolerances;
}

double size_of_states(const Window& window) {
  return window.lower.cwiseAbs().cwiseMax(window.upper.cwiseAbs()).minCoeff();
}

Tolerances<double> tolerances_in(const Window& window, const Tolerances<double>& tolerances) {
  return tolerances_at(tolerances, size_of_states(window));
}

VectorFunction stroboscope(const Problem& problem, double period, std::int64_t most_steps,
                           const Tolerances<double>& tolerances) {
  return std::visit([&](const auto& system) { return period_map(system, period, tolerances, most_steps); },
                    problem.system);
}

Window window_of_motions(const Problem& problem, const std::vector<Eigen::VectorXd>& looks, double period) {
  const Window still = default_window(frozen(problem, 0));
  std::vector<Vector2d> seen{still.lower, still.upper};
  for (const Eigen::VectorXd& y : looks) seen.emplace_back(y);
  if (!looks.empty()) {
    const Table way = way_of_motion(problem, looks, period);
    for (std::size_t i = 0; i < way.values[0].size(); ++i)
      seen.emplace_back(way.values[0][i], way.values[1][i]);
  }
  if (const auto* oscillator = std::get_if<Oscillator>(&problem.system)) {
    const OscillatorParameters& p = oscillator->parameters();
    const double A = largest_amplitude(p);
    seen.emplace_back(A, std::abs(p.w) * A);
    seen.emplace_back(-A, -std::abs(p.w) * A);
  }
  return window_around({}, "", "", seen, 0.15);
}

namespace {

/// Without rows.
Table plane_table(const Problem& problem) {
  const std::vector<std::string> names = states_with_units(problem);
  return {.columns = {names[0], names[1]}, .values = {{}, {}}};
}

void add_row(const Vector2d& y, Table& table) {
  for (std::size_t i = 0; i < 2; ++i) table.values[i].push_back(y(static_cast<Eigen::Index>(i)));
}

}  // namespace

Table way_of_motion(const Problem& problem, const std::vector<Eigen::VectorXd>& looks, double time) {
  Table table = plane_table(problem);
  follow(problem, looks[0], time, largest_of(looks), [&](double, const Vector2d& y) {
    add_row(y, table);
    return y.allFinite();
  });
  return table;
}

Table orbit(const Problem& problem, const Vector2d& start, double t_end, const Window& window,
            double length) {
  Table table = plane_table(problem);
  const Vector2d margin = 2 * window.size();
  Vector2d last = start;
  double gone = 0;
  follow(problem, start, t_end, size_of_states(window), [&](double, const Vector2d& y) {
    const bool near =
        ((y - window.lower + margin).array() >= 0).all() && ((window.upper + margin - y).array() >= 0).all();
    add_row(y, table);
    gone += (y - last).cwiseQuotient(window.size()).norm();
    last = y;
    return near && gone < length;
  });
  return table;
}

namespace {

/// @throws InputError  where areas in the window are no numbers
Window within_numbers(const Window& window, const Problem& problem) {
  constexpr double most = 1e150;
  const double farthest = std::max(window.lower.cwiseAbs().maxCoeff(), window.upper.cwiseAbs().maxCoeff());
  if (farthest <= most) return window;
  throw input_error(
      "the motion of {} from y0 = {}, {} goes up to {}, which is beyond {}; give smaller "
      "numbers with --y0, or --window",
      problem.id, to_text(problem.y0[0]), to_text(problem.y0[1]), rounded_text(farthest, 3), to_text(most));
}

/// The states from y0 on, as long as the motion is no runaway.
/// @param size  of the motion
std::vector<Vector2d> states_of_motion(const Problem& problem, double size) {
  std::vector<Vector2d> seen;
  Vector2d early = Vector2d::Zero();
  follow(problem, problem.y0, problem.t_end, size, [&](double t, const Vector2d& y) {
    if (!y.allFinite()) return false;
    if (t < problem.t_end / 50) early = early.cwiseMax(y.cwiseAbs());
    // A runaway grows in both components; a relaxation oscillation that jumps late grows in one.
    if (early.maxCoeff() > 0 && (y.cwiseAbs().array() > 4 * early.array()).all()) return false;
    seen.push_back(y);
    return true;
  });
  if (seen.empty()) seen.push_back(problem.y0);
  return seen;
}

}  // namespace

Window default_window(const Problem& problem) {
  require_planar(problem);
  std::vector<Vector2d> seen = states_of_motion(problem, 0);
  // Of a small motion the first run may show no more than that it is small.
  for (int i = 0; i < 3 && largest_of(seen) < ordinary_size; ++i)
    seen = states_of_motion(problem, largest_of(seen));
  const Window motion = within_numbers(window_around({}, "", "", seen), problem);
  const Window wide{motion.lower - motion.size(), motion.upper + motion.size()};
  for (const Equilibrium& e : find_equilibria(planar_field(problem, 0, wide.size()), wide))
    if (e.type != EquilibriumType::degenerate) seen.push_back(e.state);
  return window_around({}, "", "", seen, 0.15);
}

}  // namespace hmax
