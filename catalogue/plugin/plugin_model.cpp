#include "catalogue/plugin/plugin_model.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <mutex>

#include <fmt/format.h>

#include "core/input_error.hpp"

namespace hmax {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// The process, shared by the copies of a system.
class Link {
 public:
  Link(PluginName plugin, PluginSettings settings) : process_(std::move(plugin), std::move(settings)) {}

  void ask(PluginAsk what, double t, std::span<const double> in, std::span<double> out) const {
    const std::lock_guard lock(one_at_a_time_);
    process_.ask({.ask = what, .h = t}, in, out);
  }
  [[nodiscard]] const PluginProcess& process() const { return process_; }
  [[nodiscard]] const PluginFacts& facts() const { return process_.facts(); }
  [[nodiscard]] const PluginName& plugin() const { return process_.plugin(); }

 private:
  mutable std::mutex one_at_a_time_;
  mutable PluginProcess process_;
};

template <class Numbers>
auto span_of(Numbers& numbers) {
  return std::span(numbers.data(), static_cast<std::size_t>(numbers.size()));
}

/// (q, v) as one array.
VectorXd packed(const VectorXd& q, const VectorXd& v) {
  VectorXd y(q.size() + v.size());
  y << q, v;
  return y;
}

/// y' = rhs(t, y) alone.
class Rates {
 public:
  using State = VectorXd;
  explicit Rates(std::shared_ptr<const Link> link) : link_(std::move(link)) {}

  [[nodiscard]] Eigen::Index dim() const { return link_->facts().dim; }
  void rhs(double t, const State& y, State& dydt) const {
    link_->ask(PluginAsk::rhs, t, span_of(y), span_of(dydt));
  }

 protected:
  std::shared_ptr<const Link> link_;
};

/// The same with a Jacobian of the plugin.
class FirstOrder : public Rates {
 public:
  using Jacobian = MatrixXd;
  using Rates::Rates;

  void jacobian(double t, const State& y, Jacobian& J) const {
    J.resize(dim(), dim());
    link_->ask(PluginAsk::jacobian, t, span_of(y), span_of(J));
  }
};

/// M q'' = force(t, q, v).
class SecondOrder {
 public:
  using State = VectorXd;
  using Jacobian = MatrixXd;
  using Dofs = VectorXd;
  using DofMatrix = MatrixXd;
  explicit SecondOrder(std::shared_ptr<const Link> link) : link_(std::move(link)) {}

  [[nodiscard]] Eigen::Index dim() const { return link_->facts().dim; }
  [[nodiscard]] Eigen::Index dofs() const { return dim() / 2; }
  [[nodiscard]] Dofs mass() const { return link_->facts().mass; }
  void force(double t, const Dofs& q, const Dofs& v, Dofs& f) const {
    const VectorXd y = packed(q, v);
    f.resize(dofs());
    link_->ask(PluginAsk::force, t, span_of(y), span_of(f));
  }
  void stiffness(double t, const Dofs& q, const Dofs& v, DofMatrix& K) const {
    matrix(PluginAsk::stiffness, t, q, v, K);
  }
  void damping(double t, const Dofs& q, const Dofs& v, DofMatrix& C) const {
    matrix(PluginAsk::damping, t, q, v, C);
  }
  void rhs(double t, const State& y, State& dydt) const {
    if (link_->facts().greeting.has_rhs != 0) return link_->ask(PluginAsk::rhs, t, span_of(y), span_of(dydt));
    VectorXd f(dofs());
    link_->ask(PluginAsk::force, t, span_of(y), span_of(f));
    dydt.head(dofs()) = y.tail(dofs());
    dydt.tail(dofs()) = f.cwiseQuotient(link_->facts().mass);
  }
  void jacobian(double t, const State& y, Jacobian& J) const {
    const Eigen::Index m = dofs();
    const VectorXd q = y.head(m), v = y.tail(m);
    MatrixXd K, C;
    stiffness(t, q, v, K);
    damping(t, q, v, C);
    J = MatrixXd::Zero(2 * m, 2 * m);
    J.topRightCorner(m, m).setIdentity();
    const VectorXd inverse = link_->facts().mass.cwiseInverse();
    J.bottomLeftCorner(m, m) = -(inverse.asDiagonal() * K);
    J.bottomRightCorner(m, m) = -(inverse.asDiagonal() * C);
  }

 private:
  void matrix(PluginAsk what, double t, const Dofs& q, const Dofs& v, DofMatrix& out) const {
    out.resize(dofs(), dofs());
    const VectorXd y = packed(q, v);
    link_->ask(what, t, span_of(y), span_of(out));
  }

  std::shared_ptr<const Link> link_;
};

/// States of which matrices are compared with differences, which takes one of them.
constexpr Eigen::Index most_compared = 2000;

/// A matrix that the plugin gives beside differences of what it is the derivative of, along one direction.
/// @param A   the matrix, shape (n, n), minus it for K and C
/// @param f   of x, shape (n)
/// @throws InputError  where they are apart by more than a percent
template <class Function>
void compare(std::string_view matrix, std::string_view of, const MatrixXd& A, const Function& f,
             const VectorXd& x, double scale) {
  VectorXd direction(x.size());
  for (Eigen::Index i = 0; i < x.size(); ++i) direction[i] = std::cos(static_cast<double>(i * i + i));
  const double step = 1e-4 * scale;
  const VectorXd ahead = f(x + step * direction), behind = f(x - step * direction);
  const VectorXd told = A * direction, seen = (ahead - behind) / (2 * step);
  const double rounding = 1e-13 * std::max(ahead.cwiseAbs().maxCoeff(), behind.cwiseAbs().maxCoeff()) / step;
  Eigen::Index worst = 0;
  const double apart = (told - seen).cwiseAbs().maxCoeff(&worst);
  if (apart > 0.01 * std::max(told.cwiseAbs().maxCoeff(), seen.cwiseAbs().maxCoeff()) + rounding)
    throw input_error(
        "{}() of the plugin is not the derivative of its {}() in the initial state: along one direction number {} changes by "
        "{:.4g}, by differences {:.4g}; correct it, or leave it out, then hmax takes differences",
        matrix, of, worst + 1, told[worst], seen[worst]);
}

/// Calls f twice with y0, and twice near it: at rest noise that is proportional to something is zero.
/// @throws InputError  where the second call returns other numbers: derivatives of such a function say
/// nothing
void check_repeatable(const Problem& problem) {
  const auto& system = std::get<AnySystem>(problem.system);
  const auto rhs = [&](const VectorXd& y) {
    VectorXd dydt(y.size());
    system.rhs(0, y, dydt);
    return dydt;
  };
  const double nearby = 1e-4 * std::max(1e-3, problem.y0.cwiseAbs().maxCoeff());
  for (const VectorXd& y : {problem.y0, VectorXd(problem.y0.array() + nearby)}) {
    const VectorXd first = rhs(y), second = rhs(y);
    if (!first.allFinite() || !second.allFinite()) continue;
    Eigen::Index worst = 0;
    const double apart = (first - second).cwiseAbs().maxCoeff(&worst);
    // Threads that add in another order change the last digits.
    if (apart > 1e-9 * first.cwiseAbs().maxCoeff())
      throw input_error(
          "{} is not deterministic: two calls at t = 0 with one state give {:.10g} and {:.10g} for the derivative of {}; "
          "let the plugin compute it from t and the state alone, without random numbers or a memory of earlier calls",
          problem.id, first[worst], second[worst], problem.states[static_cast<std::size_t>(worst)]);
  }
}

/// @throws InputError  where a matrix of the plugin is wrong at its start: every limit would be
void check_matrices(const SecondOrder& model, const PluginFacts& facts) {
  const Eigen::Index m = model.dofs();
  const VectorXd q = facts.y0.head(m), v = facts.y0.tail(m);
  const double scale = std::max(1e-3, facts.y0.cwiseAbs().maxCoeff());
  MatrixXd A;
  const auto force = [&](const VectorXd& at, const VectorXd& moving) {
    VectorXd f(m);
    model.force(0, at, moving, f);
    return f;
  };
  if (facts.greeting.has_stiffness != 0) {
    model.stiffness(0, q, v, A);
    compare(
        "stiffness", "force", -A, [&](const VectorXd& x) { return force(x, v); }, q, scale);
  }
  if (facts.greeting.has_damping != 0) {
    model.damping(0, q, v, A);
    compare(
        "damping", "force", -A, [&](const VectorXd& x) { return force(q, x); }, v, scale);
  }
}
void check_matrices(const FirstOrder& model, const PluginFacts& facts) {
  if (facts.greeting.has_jacobian == 0) return;
  MatrixXd J;
  model.jacobian(0, facts.y0, J);
  compare(
      "jacobian", "rhs", J,
      [&](const VectorXd& x) {
        VectorXd dydt(x.size());
        model.rhs(0, x, dydt);
        return dydt;
      },
      facts.y0, std::max(1e-3, facts.y0.cwiseAbs().maxCoeff()));
}

}  // namespace

Problem plugin_problem(PluginName plugin, PluginSettings settings) {
  const std::string digest = plugin_digest(plugin);
  plugin.is_model = true;
  const auto link = std::make_shared<const Link>(std::move(plugin), std::move(settings));
  const PluginFacts& facts = link->facts();
  const std::string& subject = link->plugin().subject;
  if (facts.greeting.is_stepper != 0)
    throw input_error("'{}' of {} is a stepper and no model; use `hmax probe` for it", facts.name, subject);
  if (!facts.y0.allFinite()) throw input_error("the initial state of {} is not finite", subject);
  if (!(facts.greeting.t_end > 0 && std::isfinite(facts.greeting.t_end)))
    throw input_error("the end time that start() of {} gives is not positive", subject);
  const bool mechanical = facts.greeting.has_force != 0;
  // Its matrices are dense: half a gigabyte each.
  if (constexpr Eigen::Index most = 8000; (mechanical ? facts.dim / 2 : facts.dim) > most)
    throw input_error(
        "the model of {} has {} unknowns, but its matrices are dense, which serves up to {}; "
        "write its matrices to files and use --matrices",
        subject, mechanical ? facts.dim / 2 : facts.dim, most);
  if (mechanical && !(facts.mass.allFinite() && facts.mass.minCoeff() > 0))
    throw input_error("mass() of {} has numbers that are not positive; leave massless positions out",
                      subject);
  std::vector<std::string> states;
  for (const ScenePart& state : facts.parts) states.push_back(state.name);
  for (Eigen::Index i = std::ssize(states); i < facts.dim; ++i)
    states.push_back(mechanical ? fmt::format("{}{}", i < facts.dim / 2 ? 'q' : 'v', i % (facts.dim / 2) + 1)
                                : fmt::format("y{}", i + 1));
  Problem problem{.id = fmt::format("{}#{}", facts.name, digest),
                  .note = facts.note,
                  .states = states,
                  .y0 = facts.y0,
                  .t_end = facts.greeting.t_end,
                  .system = mechanical                         ? AnySystem(SecondOrder(link))
                            : facts.greeting.has_jacobian != 0 ? AnySystem(FirstOrder(link))
                                                               : AnySystem(Rates(link)),
                  .is_plugin = true};
  check_repeatable(problem);
  if (facts.dim <= most_compared)
    mechanical ? check_matrices(SecondOrder(link), facts) : check_matrices(FirstOrder(link), facts);
  return problem;
}

std::string plugin_id(std::string_view text) { return std::string(plugin_prefix) + std::string(text); }

Problem make_plugin_problem(std::string_view id, const ProblemSettings& settings) {
  if (!settings.material.empty()) throw InputError("a plugin has no materials; leave --material out");
  PluginSettings process;
  for (const auto& [name, value] : settings.parameters) {
    if (name != patience_parameter)
      throw input_error("a plugin has no parameter '{}'; give it an argument instead, FILE.so:NAME:ARGUMENT",
                        name);
    process.patience = value;
  }
  Problem problem = plugin_problem(parse_plugin(id.substr(plugin_prefix.size())), process);
  if (!settings.y0.empty() && static_cast<Eigen::Index>(settings.y0.size()) != problem.y0.size())
    throw input_error("the initial state has {} numbers, but the model of the plugin {}", settings.y0.size(),
                      problem.y0.size());
  if (!settings.y0.empty())
    problem.y0 = Eigen::Map<const Eigen::VectorXd>(settings.y0.data(), problem.y0.size());
  return problem;
}

}  // namespace hmax
