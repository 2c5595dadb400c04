#include "problems/formula_system.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>
#include <set>
#include <stdexcept>
#include <type_traits>

#include "core/size_limits.hpp"
#include "core/text/sentences.hpp"
#include "problems/digits.hpp"
#include "problems/formula_graph.hpp"
#include "problems/formula_parser.hpp"
#include "problems/formula_program.hpp"
#include "problems/formula_switches.hpp"

namespace hmax {
namespace {

using Order = std::vector<Eigen::Index>;
using Slopes = std::vector<std::vector<FormulaSlope>>;

[[noreturn]] void refuse(const std::string& sentence) { throw std::invalid_argument(sentence); }

bool is_identifier(std::string_view name) {
  const auto is_letter = [](unsigned char c) { return std::isalpha(c) != 0 || c == '_'; };
  return !name.empty() && is_letter(static_cast<unsigned char>(name[0])) &&
         std::ranges::all_of(name, [&](unsigned char c) { return is_letter(c) || std::isdigit(c) != 0; });
}

/// A formula as a message shows it: at most 60 characters around a position, control characters as '?'.
std::string shown(const std::string& formula, std::size_t position) {
  const std::size_t first = formula.size() > 60 && position > 30 ? position - 30 : 0;
  const std::string text = in_one_line(formula.substr(first, 60));
  return (first > 0 ? "\"..." : "\"") + text + (first + 60 < formula.size() ? "...\"" : "\"");
}

/// "equation x' = \"2 * v\", column 3: ", the opening of every complaint about a formula.
std::string where(const std::pair<std::string, std::string>& equation, std::size_t position) {
  position = std::min(position, equation.second.size());
  return "equation " + equation.first + "' = " + shown(equation.second, position) + ", column " +
         std::to_string(position + 1) + ": ";
}

/// Refuses names that are no identifiers or not free.
void check_names(const FormulaDefinition& definition) {
  std::set<std::string> taken;
  const auto check = [&](const std::string& kind, const std::string& name) {
    const std::string what = kind + " " + quoted(name);
    if (!is_identifier(name) || name.size() > 100)
      refuse("the " + what + " is no name; use at most 100 letters, digits and _, a letter first");
    if (name == "t") refuse("the " + what + " has the name of the time; choose another name");
    if (name == "pi" || name == "e")
      refuse("the " + what + " has the name of a constant; choose another name");
    if (std::ranges::binary_search(formula_functions(), name))
      refuse("the " + what + " has the name of a function; choose another name");
    if (!taken.insert(name).second)
      refuse("the " + what + " is defined twice; choose another name for one of them");
  };
  for (const auto& [name, formula] : definition.equations) check("state", name);
  for (const auto& [name, value] : definition.parameters) check("parameter", name);
}

void check_numbers(const FormulaDefinition& d) {
  if (d.equations.empty()) refuse("the system has no equations; give at least one, for instance x = \"-x\"");
  if (d.y0.size() != d.equations.size())
    refuse("the system has " + std::to_string(d.equations.size()) + " equations but " +
           std::to_string(d.y0.size()) + " initial values; give one for each state");
  if (!std::isfinite(d.t0) || !std::isfinite(d.t_end))
    refuse("the time span of the system is not finite; give finite numbers for its start and t_end");
  if (d.t_end == d.t0)
    refuse("t_end is " + shortest_digits(d.t_end) +
           ", the time of the start; give a later one, or an earlier one to "
           "go backwards");
  for (std::size_t i = 0; i < d.y0.size(); ++i)
    if (!std::isfinite(d.y0[i]))
      refuse("the initial value of " + quoted(d.equations[i].first) + " is not finite; give a finite number");
  for (const auto& [name, value] : d.parameters)
    if (!std::isfinite(value))
      refuse("the parameter " + quoted(name) + " is not finite; give a finite number");
}

/// The formulas of a definition in a graph, one root for each component of y, and their derivatives.
struct Formulas {
  FormulaGraph graph;
  std::vector<FormulaNodeId> roots;
  Slopes slopes;
  std::vector<FormulaNodeId> time_slopes;

  /// @param order  component i of y is state order[i] of the definition
  Formulas(const FormulaDefinition& definition, const Order& order) {
    FormulaNames names;
    for (std::size_t i = 0; i < order.size(); ++i) {
      const auto state = static_cast<std::size_t>(order[i]);
      names[definition.equations[state].first] = graph.state(static_cast<int>(i));
    }
    for (const auto& [name, value] : definition.parameters) names[name] = graph.constant(value);
    names["t"] = graph.time();
    names["pi"] = graph.constant(std::numbers::pi);
    names["e"] = graph.constant(std::numbers::e);
    for (const Eigen::Index state : order) {
      const auto& equation = definition.equations[static_cast<std::size_t>(state)];
      try {
        roots.push_back(parse_formula(equation.second, names, graph));
      } catch (const FormulaError& error) {
        refuse(where(equation, error.position()) + error.what());
      }
    }
    slopes = state_slopes(graph, roots);
    time_slopes = hmax::time_slopes(graph, roots);
  }

  [[nodiscard]] int states() const { return static_cast<int>(roots.size()); }

  /// The state that component i is the derivative of and nothing else: f_i = y_j for every t and y.
  [[nodiscard]] std::optional<Eigen::Index> copied_by(std::size_t i) const {
    const FormulaNode& root = graph[roots[i]];
    if (root.op == FormulaOp::state) return root.a;
    const FormulaDependence& of = graph.dependence(roots[i]);
    if (of.on_time || of.switches_with_state || slopes[i].size() != 1 ||
        !graph.is_constant(slopes[i][0].node, 1))
      return std::nullopt;
    // f_i = y_j + c
    double at_zero = 0;
    const std::vector<double> zero(roots.size(), 0.0);
    FormulaProgram(graph, {roots[i]}, states()).run(0, zero.data(), &at_zero);
    return at_zero == 0 ? std::optional<Eigen::Index>(slopes[i][0].state) : std::nullopt;
  }
};

/// Positions, each beside its velocity, that cover all states once: q_i' = v_i. A state that is no derivative
/// of another can only be a position; in a cycle of derivatives the first state of the user is one.
/// @return  the order (q, v), empty where there is none
Order packed_order(const std::vector<std::optional<Eigen::Index>>& derivative_is) {
  const std::size_t n = derivative_is.size();
  if (n == 0 || n % 2 != 0) return {};
  // Of the states left over: how many of them have this one as their derivative, and those that none has.
  std::vector<int> derivative_of(n, 0);
  std::set<std::size_t> left, underived;
  for (const std::optional<Eigen::Index>& of : derivative_is)
    if (of) ++derivative_of[static_cast<std::size_t>(*of)];
  for (std::size_t i = 0; i < n; ++i) {
    left.insert(left.end(), i);
    if (derivative_of[i] == 0) underived.insert(underived.end(), i);
  }
  const auto take = [&](std::size_t state) {
    left.erase(state);
    underived.erase(state);
    if (!derivative_is[state]) return;
    const auto of = static_cast<std::size_t>(*derivative_is[state]);
    if (--derivative_of[of] == 0 && left.contains(of)) underived.insert(of);
  };
  Order q, v;
  while (!left.empty()) {
    const std::size_t position = *(underived.empty() ? left : underived).begin();
    const auto velocity = derivative_is[position];
    if (!velocity || static_cast<std::size_t>(*velocity) == position ||
        !left.contains(static_cast<std::size_t>(*velocity)))
      return {};
    q.push_back(static_cast<Eigen::Index>(position));
    v.push_back(*velocity);
    take(position);
    take(static_cast<std::size_t>(*velocity));
  }
  // Positions in the order of the user.
  std::vector<std::size_t> by_user(q.size());
  std::iota(by_user.begin(), by_user.end(), 0U);
  std::ranges::sort(by_user, {}, [&](std::size_t k) { return q[k]; });
  Order order;
  for (const std::size_t k : by_user) order.push_back(q[k]);
  for (const std::size_t k : by_user) order.push_back(v[k]);
  return order;
}

[[noreturn]] void refuse_velocity(const std::pair<std::string, std::string>& equation,
                                  const std::string& velocity) {
  const auto& [name, formula] = equation;
  refuse("equation " + name + "' = " + shown(formula, 0) + ": this is not the velocity " + quoted(velocity) +
         "; write " + name + " = \"" + velocity + "\", or leave out positions and velocities");
}

/// The order that the user names.
Order named_order(const FormulaDefinition& d, const std::vector<std::optional<Eigen::Index>>& derivative_is) {
  if (d.positions.size() != d.velocities.size())
    refuse("there are " + std::to_string(d.positions.size()) + " positions but " +
           std::to_string(d.velocities.size()) + " velocities; name the velocity of each position");
  std::vector<std::string> states;
  for (const auto& [name, formula] : d.equations) states.push_back(name);
  Order order;
  for (const auto* names : {&d.positions, &d.velocities})
    for (const std::string& name : *names) {
      const auto at = std::ranges::find(states, name);
      if (at == states.end())
        refuse("positions and velocities name " + quoted(name) + ", which has no equation; " +
               nearest_name(name, states));
      const Eigen::Index state = at - states.begin();
      if (std::ranges::find(order, state) != order.end())
        refuse("positions and velocities name " + quoted(name) + " twice; name each state once");
      order.push_back(state);
    }
  if (order.size() != states.size())
    refuse("positions and velocities name " + std::to_string(order.size()) + " of " +
           std::to_string(states.size()) + " states; name each state once");
  for (std::size_t k = 0; k < d.positions.size(); ++k) {
    const auto q = static_cast<std::size_t>(order[k]);
    if (derivative_is[q] != order[d.positions.size() + k]) refuse_velocity(d.equations[q], d.velocities[k]);
  }
  return order;
}

Order order_of(const FormulaDefinition& definition, const Formulas& formulas) {
  std::vector<std::optional<Eigen::Index>> derivative_is;
  for (std::size_t i = 0; i < formulas.roots.size(); ++i) derivative_is.push_back(formulas.copied_by(i));
  if (definition.positions.empty() && definition.velocities.empty()) return packed_order(derivative_is);
  return named_order(definition, derivative_is);
}

Order as_written(std::size_t n) {
  Order order(n);
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  return order;
}

Linearity linearity_of(const Formulas& formulas) {
  Linearity found = Linearity::linear;
  for (std::size_t i = 0; i < formulas.roots.size(); ++i) {
    if (formulas.graph.dependence(formulas.roots[i]).switches_with_state) return Linearity::nonlinear;
    for (const FormulaSlope& slope : formulas.slopes[i]) {
      const FormulaDependence& of = formulas.graph.dependence(slope.node);
      if (of.on_state) return Linearity::nonlinear;
      if (of.on_time) found = Linearity::time_varying;
    }
  }
  return found;
}

/// The rules of differentiation make 0 times infinity of y sqrt(y) at 0: a slope of which they say nothing,
/// as of one that is infinite.
double slope_or_infinite(double slope) {
  return std::isnan(slope) ? std::numeric_limits<double>::infinity() : slope;
}

}  // namespace

struct FormulaSystem::Compiled {
  Order order;
  Eigen::Index dofs = 0;
  FormulaProgram rhs, force, jacobian, time_derivative;
  SparseMatrix slopes;        ///< the pattern of the Jacobian; entries that change are 0
  std::vector<int> changing;  ///< where the others stand in it, in the order of the values of `jacobian`
  bool autonomous = false;
  Linearity linearity = Linearity::unknown;
  FormulaSwitches switches;

  explicit Compiled(const FormulaDefinition& definition) : order(as_written(definition.equations.size())) {
    Formulas formulas(definition, order);
    check_start(definition, formulas);
    if (const Order packed = order_of(definition, formulas); !packed.empty()) {
      dofs = static_cast<Eigen::Index>(packed.size() / 2);
      if (packed != order) formulas = Formulas(definition, packed);
      order = packed;
    }
    compile(formulas);
  }

  static void check_start(const FormulaDefinition& definition, const Formulas& formulas) {
    std::vector<double> start(formulas.roots.size());
    FormulaProgram(formulas.graph, formulas.roots, formulas.states())
        .run(definition.t0, definition.y0.data(), start.data());
    for (std::size_t i = 0; i < start.size(); ++i)
      if (!std::isfinite(start[i]))
        refuse(
            "equation " + definition.equations[i].first + "' = " + shown(definition.equations[i].second, 0) +
            ": the derivative is not finite at the start, t0 and y0; change the initial state, a parameter "
            "or the formula");
  }

  void compile(Formulas& formulas) {
    const int n = formulas.states();
    const auto& [graph, roots, derivatives, time_slopes] = formulas;
    rhs = FormulaProgram(graph, roots, n);
    if (dofs > 0) force = FormulaProgram(graph, {roots.begin() + dofs, roots.end()}, n);
    std::vector<FormulaNodeId> entries;
    std::vector<std::pair<int, int>> places;
    std::vector<Eigen::Triplet<double>> constants;
    for (int i = 0; i < n; ++i)
      for (const FormulaSlope& slope : derivatives[static_cast<std::size_t>(i)]) {
        const auto j = static_cast<int>(slope.state);
        const bool constant = graph.is_constant(slope.node);
        constants.emplace_back(i, j, constant ? graph[slope.node].value : 0);
        if (constant) continue;
        places.emplace_back(i, j);
        entries.push_back(slope.node);
      }
    slopes.resize(n, n);
    slopes.setFromTriplets(constants.begin(), constants.end());
    for (const auto& [i, j] : places)
      changing.push_back(static_cast<int>(&slopes.coeffRef(i, j) - slopes.valuePtr()));
    jacobian = FormulaProgram(graph, entries, n);
    time_derivative = FormulaProgram(graph, time_slopes, n);
    autonomous = std::ranges::none_of(
        roots, [&](FormulaNodeId root) { return formulas.graph.dependence(root).on_time; });
    linearity = linearity_of(formulas);
    switches = FormulaSwitches(formulas.graph, roots, n);
  }

  /// The values of the entries of `slopes` at (t, y), until the next call on this thread.
  const std::vector<double>& slope_values(double t, const double* y) const {
    thread_local std::vector<double> values, changed;
    values.assign(slopes.valuePtr(), slopes.valuePtr() + slopes.nonZeros());
    if (changing.empty()) return values;
    changed.resize(changing.size());
    jacobian.run(t, y, changed.data());
    for (std::size_t k = 0; k < changing.size(); ++k)
      values[static_cast<std::size_t>(changing[k])] = slope_or_infinite(changed[k]);
    return values;
  }

  /// Calls set(i, j, value) for each entry of columns first .. first + count - 1, column by column.
  template <class Set>
  void each_slope(double t, const double* y, Eigen::Index first, Eigen::Index count, const Set& set) const {
    const std::vector<double>& values = slope_values(t, y);
    for (Eigen::Index j = first; j < first + count; ++j)
      for (int p = slopes.outerIndexPtr()[j]; p < slopes.outerIndexPtr()[j + 1]; ++p)
        set(slopes.innerIndexPtr()[p], j, values[static_cast<std::size_t>(p)]);
  }

  void write(double t, const State& y, Eigen::MatrixXd& J) const {
    J.setZero(slopes.rows(), slopes.cols());
    each_slope(t, y.data(), 0, slopes.cols(),
               [&](Eigen::Index i, Eigen::Index j, double value) { J(i, j) = value; });
  }
  void write(double t, const State& y, SparseMatrix& J) const {
    J = slopes;
    std::ranges::copy(slope_values(t, y.data()), J.valuePtr());
  }

  /// -J in the rows of the velocities, columns from `first` on, shape (dofs, dofs).
  template <class Matrix>
  void write_block(double t, const Dofs& q, const Dofs& v, Eigen::Index first, Matrix& out) const {
    State y(2 * dofs);
    y << q, v;
    out.resize(dofs, dofs);
    out.setZero();
    Eigen::Index begun = 0;
    each_slope(t, y.data(), first, dofs, [&](Eigen::Index i, Eigen::Index j, double value) {
      if (i < dofs) return;
      // 0 - x, for -0 is nothing to show.
      if constexpr (std::is_same_v<Matrix, SparseMatrix>) {
        for (; begun <= j - first; ++begun) out.startVec(begun);
        out.insertBack(i - dofs, j - first) = 0 - value;
      } else {
        out(i - dofs, j - first) = 0 - value;
      }
    });
    if constexpr (std::is_same_v<Matrix, SparseMatrix>) out.finalize();
  }
};

FormulaSystem::FormulaSystem(FormulaDefinition definition) : definition_(std::move(definition)) {
  check_numbers(definition_);
  check_names(definition_);
  compiled_ = std::make_shared<const Compiled>(definition_);
}

void FormulaSystem::rhs(double t, const State& y, State& dydt) const {
  compiled_->rhs.run(t, y.data(), dydt.data());
}

std::shared_ptr<const FormulaProgram> FormulaSystem::formulas() const { return {compiled_, &compiled_->rhs}; }

bool FormulaSystem::is_sparse() const {
  const double entries = static_cast<double>(dim()) * static_cast<double>(dim());
  return dim() > small_enough_for_dense && static_cast<double>(compiled_->slopes.nonZeros()) <= entries / 20;
}

void FormulaSystem::jacobian(double t, const State& y, Eigen::MatrixXd& J) const {
  compiled_->write(t, y, J);
}
void FormulaSystem::jacobian(double t, const State& y, SparseMatrix& J) const { compiled_->write(t, y, J); }

void FormulaSystem::time_derivative(double t, const State& y, State& dfdt) const {
  dfdt.resize(dim());
  compiled_->time_derivative.run(t, y.data(), dfdt.data());
  for (double& slope : dfdt) slope = slope_or_infinite(slope);
}

bool FormulaSystem::is_autonomous() const { return compiled_->autonomous; }
Linearity FormulaSystem::linearity() const { return compiled_->linearity; }
std::vector<double> FormulaSystem::breakpoints(double t0, double t1) const {
  return compiled_->switches.between(t0, t1);
}

Eigen::Index FormulaSystem::dofs() const { return compiled_->dofs; }
const std::vector<Eigen::Index>& FormulaSystem::order() const { return compiled_->order; }

void FormulaSystem::force(double t, const Dofs& q, const Dofs& v, Dofs& f) const {
  thread_local State y;
  y.resize(2 * q.size());
  y << q, v;
  f.resize(q.size());
  compiled_->force.run(t, y.data(), f.data());
}

void FormulaSystem::stiffness(double t, const Dofs& q, const Dofs& v, Eigen::MatrixXd& K) const {
  compiled_->write_block(t, q, v, 0, K);
}
void FormulaSystem::stiffness(double t, const Dofs& q, const Dofs& v, SparseMatrix& K) const {
  compiled_->write_block(t, q, v, 0, K);
}

void FormulaSystem::damping(double t, const Dofs& q, const Dofs& v, Eigen::MatrixXd& C) const {
  compiled_->write_block(t, q, v, compiled_->dofs, C);
}
void FormulaSystem::damping(double t, const Dofs& q, const Dofs& v, SparseMatrix& C) const {
  compiled_->write_block(t, q, v, compiled_->dofs, C);
}

void FormulaSystem::set(std::string_view parameter, double value) {
  if (!std::isfinite(value))
    refuse("the parameter " + quoted(parameter) + " is not finite; give a finite number");
  std::vector<std::string> known;
  FormulaDefinition changed = definition_;
  for (auto& [name, held] : changed.parameters) {
    if (name == parameter) {
      held = value;
      // Parameters are constants of the programs.
      *this = FormulaSystem(std::move(changed));
      return;
    }
    known.push_back(name);
  }
  refuse("the system has no parameter " + quoted(parameter) + "; " + nearest_name(parameter, known));
}

FormulaSystem::State FormulaSystem::y0() const {
  State y(dim());
  for (Eigen::Index i = 0; i < dim(); ++i)
    y[i] = definition_.y0[static_cast<std::size_t>(order()[static_cast<std::size_t>(i)])];
  return y;
}

}  // namespace hmax
