#include "problems/formula_graph.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/sort_unique.hpp"

namespace hmax {

using Id = FormulaNodeId;

namespace {

double value_of_function(FormulaOp op, double a, double b) {
  using enum FormulaOp;
  using Function = double (*)(double);
  static constexpr auto functions = std::to_array<Function>(
      {std::sin, std::cos, std::tan, std::asin, std::acos, std::atan, std::sinh, std::cosh, std::tanh,
       std::asinh, std::acosh, std::atanh, std::exp, std::log, std::log2, std::log10});
  static_assert(functions.size() == static_cast<std::size_t>(log10) - static_cast<std::size_t>(sin) + 1);
  if (op == power) return std::pow(a, b);
  if (op == atan2) return std::atan2(a, b);
  if (op < sin || log10 < op) return std::numeric_limits<double>::quiet_NaN();
  return functions[static_cast<std::size_t>(op) - static_cast<std::size_t>(sin)](a);
}

}  // namespace

double formula_value(FormulaOp op, double a, double b, double c) {
  return arithmetic_value(op, a, b, c, value_of_function);
}

namespace {
/// Whether the value jumps, or has a kink, where an expression of its operands passes zero.
bool is_switch(FormulaOp op) {
  using enum FormulaOp;
  return (abs <= op && op <= rint) || (less <= op && op <= either);
}
}  // namespace

FormulaDependence FormulaGraph::dependence_of(const FormulaNode& node) const {
  if (node.op == FormulaOp::multiply && (is_constant(node.a, 0) || is_constant(node.b, 0))) return {};
  if (node.op == FormulaOp::divide && is_constant(node.a, 0)) return {};
  FormulaDependence all;
  node.each_operand([&](Id id) {
    const FormulaDependence& of = dependence(id);
    all.on_time = all.on_time || of.on_time;
    all.on_state = all.on_state || of.on_state;
    all.switches_with_state = all.switches_with_state || of.switches_with_state;
  });
  if (is_switch(node.op) && all.on_state) all.switches_with_state = true;
  if (node.op == FormulaOp::choose && dependence(node.a).on_state) all.switches_with_state = true;
  return all;
}

Id FormulaGraph::keep(const FormulaNode& node, FormulaDependence dependence) {
  const Key key{node.op, node.a, node.b, node.c, std::bit_cast<std::uint64_t>(node.value)};
  const auto [at, is_new] = known_.try_emplace(key, static_cast<Id>(nodes_.size()));
  if (is_new) {
    nodes_.push_back(node);
    dependences_.push_back(dependence);
  }
  return at->second;
}

Id FormulaGraph::constant(double value) { return keep({.op = FormulaOp::constant, .value = value}, {}); }
Id FormulaGraph::time() { return keep({.op = FormulaOp::time}, {.on_time = true}); }
Id FormulaGraph::state(int index) { return keep({.op = FormulaOp::state, .a = index}, {.on_state = true}); }

Id FormulaGraph::make(FormulaOp op, Id a, Id b, Id c) {
  const int operands = operands_of(op);
  const bool known = is_constant(a) && (operands < 2 || is_constant(b)) && (operands < 3 || is_constant(c));
  const auto value = [&](Id id) { return (*this)[id].value; };
  if (known)
    return constant(formula_value(op, value(a), operands > 1 ? value(b) : 0, operands > 2 ? value(c) : 0));
  if (op == FormulaOp::choose) {
    if (is_constant(a)) return value(a) != 0 ? b : c;
    if (b == c) return b;
  }
  if (op == FormulaOp::power && is_constant(b)) {
    // Small powers as products; a^0 is 1 for every a.
    if (value(b) == 0) return constant(1);
    if (value(b) == 1) return a;
    if (value(b) == 2) return make(FormulaOp::square, a);
    if (value(b) == 3) return make(FormulaOp::cube, a);
    if (value(b) == 4) return make(FormulaOp::fourth, a);
  }
  const FormulaNode node{.op = op, .a = a, .b = operands > 1 ? b : 0, .c = operands > 2 ? c : 0};
  return keep(node, dependence_of(node));
}

namespace {

/// Sums, products and quotients of derivatives: without terms and factors that are constants 0 and 1.
class Derivative {
  using enum FormulaOp;

 public:
  /// @param from_the_right  at kinks the derivative towards larger arguments, which is that of time
  Derivative(FormulaGraph& graph, bool from_the_right) : g_(graph), from_the_right_(from_the_right) {}

  [[nodiscard]] Id zero() { return g_.constant(0); }

  /// The derivative of a node whose operands have the derivatives da, db, dc.
  Id of(Id id, Id da, Id db, Id dc) {
    const FormulaNode n = g_[id];  // a copy: nodes are added below
    switch (n.op) {
      case negate:
        return minus(zero(), da);
      case add:
        return plus(da, db);
      case subtract:
        return minus(da, db);
      case multiply:
        return plus(times(da, n.b), times(n.a, db));
      case divide:
        return over(minus(da, times(id, db)), n.b);
      case power:
        return of_power(id, n, da, db);
      case square:
        return times(times(g_.constant(2), n.a), da);
      case cube:
        return times(times(g_.constant(3), g_.make(square, n.a)), da);
      case fourth:
        return times(times(g_.constant(4), g_.make(cube, n.a)), da);
      case choose:
        return g_.make(choose, n.a, db, dc);
      case atan2:
        return over(minus(times(da, n.b), times(n.a, db)),
                    g_.make(add, g_.make(square, n.a), g_.make(square, n.b)));
      case minimum:
        return at_tie(n, minimum, g_.make(choose, g_.make(less, n.b, n.a), db, da), da, db);
      case maximum:
        return at_tie(n, maximum, g_.make(choose, g_.make(less, n.a, n.b), db, da), da, db);
      case abs:
        return of_abs(n.a, da);
      default:
        return times(of_function(id, n), da);
    }
  }

 private:
  Id plus(Id a, Id b) { return g_.is_constant(a, 0) ? b : g_.is_constant(b, 0) ? a : g_.make(add, a, b); }
  Id minus(Id a, Id b) {
    if (g_.is_constant(b, 0)) return a;
    return g_.is_constant(a, 0) ? times(g_.constant(-1), b) : g_.make(subtract, a, b);
  }
  Id times(Id a, Id b) {
    if (g_.is_constant(a, 0) || g_.is_constant(b, 0)) return zero();
    if (g_.is_constant(a, 1)) return b;
    if (g_.is_constant(b, 1)) return a;
    return g_.is_constant(a, -1) ? g_.make(negate, b) : g_.make(multiply, a, b);
  }
  Id over(Id a, Id b) {
    if (g_.is_constant(a, 0)) return a;
    return g_.is_constant(b, 1) ? a : g_.make(divide, a, b);
  }
  Id one_over(Id a) { return g_.make(divide, g_.constant(1), a); }
  Id one_minus(Id a) { return g_.make(subtract, g_.constant(1), a); }

  /// (a^b)' = b a^(b - 1) a' + a^b ln(a) b', of which the second term is 0 at a = 0.
  Id of_power(Id id, const FormulaNode& n, Id da, Id db) {
    const Id lowered = g_.make(power, n.a, g_.make(subtract, n.b, g_.constant(1)));
    const Id first = times(times(n.b, lowered), da);
    if (g_.is_constant(db, 0)) return first;
    const Id grown = g_.make(multiply, id, g_.make(log, n.a));
    return plus(first, times(g_.make(choose, g_.make(equal, n.a, zero()), zero(), grown), db));
  }

  Id of_abs(Id a, Id da) {
    const Id falling = minus(zero(), da);
    if (!from_the_right_) return g_.make(choose, g_.make(greater_equal, a, zero()), da, falling);
    const Id there = g_.make(choose, g_.make(less, a, zero()), falling, g_.make(abs, da));
    return g_.make(choose, g_.make(greater, a, zero()), da, there);
  }

  /// Where both operands of min or max are equal, the smaller or larger derivative is that from the right.
  Id at_tie(const FormulaNode& n, FormulaOp op, Id elsewhere, Id da, Id db) {
    if (!from_the_right_) return elsewhere;
    return g_.make(choose, g_.make(equal, n.a, n.b), g_.make(op, da, db), elsewhere);
  }

  /// The derivative of a function of one argument; 0 of what is constant in pieces.
  Id of_function(Id id, const FormulaNode& n) {
    const auto squared = [&](Id of) { return g_.make(square, of); };
    switch (n.op) {
      case sin:
        return g_.make(cos, n.a);
      case cos:
        return g_.make(negate, g_.make(sin, n.a));
      case tan:
        return g_.make(add, g_.constant(1), squared(id));
      case asin:
        return one_over(g_.make(sqrt, one_minus(squared(n.a))));
      case acos:
        return g_.make(negate, one_over(g_.make(sqrt, one_minus(squared(n.a)))));
      case atan:
        return one_over(g_.make(add, g_.constant(1), squared(n.a)));
      case sinh:
        return g_.make(cosh, n.a);
      case cosh:
        return g_.make(sinh, n.a);
      case tanh:
        return one_minus(squared(id));
      case asinh:
        return one_over(g_.make(sqrt, g_.make(add, squared(n.a), g_.constant(1))));
      case acosh:
        return one_over(g_.make(sqrt, g_.make(subtract, squared(n.a), g_.constant(1))));
      case atanh:
        return one_over(one_minus(squared(n.a)));
      case exp:
        return id;
      case log:
        return one_over(n.a);
      case log2:
        return one_over(g_.make(multiply, n.a, g_.constant(std::numbers::ln2)));
      case log10:
        return one_over(g_.make(multiply, n.a, g_.constant(std::numbers::ln10)));
      case sqrt:
        return g_.make(divide, g_.constant(0.5), id);
      default:
        return zero();
    }
  }

  FormulaGraph& g_;
  bool from_the_right_;
};

/// Which nodes the roots need, themselves included.
std::vector<bool> needed_by(const FormulaGraph& graph, const std::vector<Id>& roots) {
  std::vector<bool> needed(graph.size(), false);
  for (const Id root : roots) needed[static_cast<std::size_t>(root)] = true;
  for (std::size_t i = graph.size(); i-- > 0;) {
    if (!needed[i]) continue;
    graph[static_cast<Id>(i)].each_operand(
        [&](Id operand) { needed[static_cast<std::size_t>(operand)] = true; });
  }
  return needed;
}

}  // namespace

std::vector<std::vector<FormulaSlope>> state_slopes(FormulaGraph& graph, const std::vector<Id>& roots) {
  const std::vector<bool> needed = needed_by(graph, roots);
  const Id zero = graph.constant(0);
  Derivative derivative(graph, false);
  std::vector<std::vector<FormulaSlope>> slopes(needed.size());
  const auto slope_of = [&](Id operand, int state) {
    const auto& of = slopes[static_cast<std::size_t>(operand)];
    const auto at = std::ranges::lower_bound(of, state, {}, &FormulaSlope::state);
    return at != of.end() && at->state == state ? at->node : zero;
  };
  for (std::size_t i = 0; i < needed.size(); ++i) {
    if (!needed[i]) continue;
    const auto id = static_cast<Id>(i);
    const FormulaNode n = graph[id];
    if (n.op == FormulaOp::state) slopes[i].push_back({n.a, graph.constant(1)});
    const int operands = operands_of(n.op);
    if (operands == 0) continue;
    // The states of all operands, once each.
    std::vector<int> states;
    n.each_operand([&](Id operand) {
      for (const FormulaSlope& slope : slopes[static_cast<std::size_t>(operand)])
        states.push_back(slope.state);
    });
    sort_unique(states);
    for (const int state : states) {
      const Id slope = derivative.of(id, slope_of(n.a, state), operands > 1 ? slope_of(n.b, state) : zero,
                                     operands > 2 ? slope_of(n.c, state) : zero);
      if (!graph.is_constant(slope, 0)) slopes[i].push_back({state, slope});
    }
  }
  std::vector<std::vector<FormulaSlope>> of_roots;
  for (const Id root : roots) of_roots.push_back(slopes[static_cast<std::size_t>(root)]);
  return of_roots;
}

std::vector<Id> time_slopes(FormulaGraph& graph, const std::vector<Id>& roots) {
  const std::vector<bool> needed = needed_by(graph, roots);
  const Id zero = graph.constant(0);
  Derivative derivative(graph, true);
  std::vector<Id> slopes(needed.size(), zero);
  for (std::size_t i = 0; i < needed.size(); ++i) {
    const auto id = static_cast<Id>(i);
    if (!needed[i] || !graph.dependence(id).on_time) continue;
    const FormulaNode n = graph[id];
    const auto slope_of = [&](Id operand) { return slopes[static_cast<std::size_t>(operand)]; };
    const int operands = operands_of(n.op);
    if (operands == 0) {
      slopes[i] = graph.constant(1);
      continue;
    }
    const Id da = slope_of(n.a), db = operands > 1 ? slope_of(n.b) : zero,
             dc = operands > 2 ? slope_of(n.c) : zero;
    if (da != zero || db != zero || dc != zero) slopes[i] = derivative.of(id, da, db, dc);
  }
  std::vector<Id> of_roots;
  for (const Id root : roots) of_roots.push_back(slopes[static_cast<std::size_t>(root)]);
  return of_roots;
}

}  // namespace hmax
