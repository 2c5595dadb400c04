#include "problems/formula_program.hpp"

#include <cmath>
#include <map>

namespace hmax {

/// Puts nodes into an order in which those that only one branch of a condition needs lie behind a jump.
class FormulaCompiler {
 public:
  FormulaCompiler(const FormulaGraph& graph, const std::vector<FormulaNodeId>& roots, FormulaProgram& program)
      : graph_(graph), program_(program), guards_(graph.size(), unused), place_(graph.size(), 0) {
    for (const FormulaNodeId root : roots) guards_[at(root)] = always;
    for (std::size_t i = graph.size(); i-- > 0;) guard_operands(static_cast<FormulaNodeId>(i));
    place();
    members_.resize(parents_.size());
    for (std::size_t i = 0; i < graph.size(); ++i)
      if (guards_[i] != unused && operands_of(graph[static_cast<FormulaNodeId>(i)].op) > 0)
        members_[static_cast<std::size_t>(guards_[i])].push_back(static_cast<FormulaNodeId>(i));
    write(always);
    for (const FormulaNodeId root : roots) program_.results_.push_back(place_[at(root)]);
  }

 private:
  /// A guard is a branch of a condition inside the guard of that condition.
  static constexpr int unused = -1, always = 0;

  static std::size_t at(FormulaNodeId id) { return static_cast<std::size_t>(id); }

  int guard_inside(int parent) {
    parents_.push_back(parent);
    depths_.push_back(depths_[static_cast<std::size_t>(parent)] + 1);
    return static_cast<int>(parents_.size()) - 1;
  }

  /// The innermost guard around both.
  [[nodiscard]] int around(int a, int b) const {
    if (a == unused) return b;
    while (a != b)
      (depth(a) >= depth(b) ? a : b) = parents_[static_cast<std::size_t>(depth(a) >= depth(b) ? a : b)];
    return a;
  }
  [[nodiscard]] int depth(int guard) const { return depths_[static_cast<std::size_t>(guard)]; }

  /// Nodes have larger numbers than their operands, so that all users of a node have been here before it.
  void guard_operands(FormulaNodeId id) {
    const int own = guards_[at(id)];
    if (own == unused) return;
    const FormulaNode& n = graph_[id];
    for (int k = 0; k < operands_of(n.op); ++k) {
      int guard = own;
      if (n.op == FormulaOp::choose && k > 0) guard = (k == 1 ? yes_ : no_)[id] = guard_inside(own);
      int& of = guards_[at(n.operand(k))];
      of = around(of, guard);
    }
  }

  void place() {
    auto next = static_cast<std::uint32_t>(1 + program_.states_);
    for (std::size_t i = 0; i < place_.size(); ++i) {
      const FormulaNode& n = graph_[static_cast<FormulaNodeId>(i)];
      if (guards_[i] == unused || n.op != FormulaOp::constant) continue;
      place_[i] = next++;
      program_.constants_.push_back(n.value);
    }
    for (std::size_t i = 0; i < place_.size(); ++i) {
      const FormulaNode& n = graph_[static_cast<FormulaNodeId>(i)];
      if (n.op == FormulaOp::state) place_[i] = static_cast<std::uint32_t>(1 + n.a);
      if (guards_[i] != unused && operands_of(n.op) > 0) place_[i] = next++;
    }
    program_.registers_ = next;
  }

  void write(int guard) {
    for (const FormulaNodeId id : members_[static_cast<std::size_t>(guard)]) write_node(id);
  }

  void write_node(FormulaNodeId id) {
    const FormulaNode& n = graph_[id];
    const auto from = [&](int k) { return operands_of(n.op) > k ? place_[at(n.operand(k))] : 0; };
    const FormulaStep whole{static_cast<std::uint8_t>(n.op), place_[at(id)], from(0), from(1), from(2)};
    if (n.op != FormulaOp::choose || (is_empty(yes_[id]) && is_empty(no_[id]))) {
      program_.steps_.push_back(whole);
      return;
    }
    const std::size_t test = step(FormulaStep::jump_unless, whole.a);
    write(yes_[id]);
    step(FormulaStep::copy, whole.b, whole.to);
    const std::size_t jump = step(FormulaStep::jump);
    program_.steps_[test].c = here();
    write(no_[id]);
    step(FormulaStep::copy, whole.c, whole.to);
    program_.steps_[jump].c = here();
  }

  [[nodiscard]] bool is_empty(int guard) const { return members_[static_cast<std::size_t>(guard)].empty(); }
  std::size_t step(std::uint8_t code, std::uint32_t a = 0, std::uint32_t to = 0) {
    program_.steps_.push_back({code, to, a, 0, 0});
    return program_.steps_.size() - 1;
  }
  [[nodiscard]] std::uint32_t here() const { return static_cast<std::uint32_t>(program_.steps_.size()); }

  const FormulaGraph& graph_;
  FormulaProgram& program_;
  std::vector<int> guards_;                          ///< by node
  std::vector<int> parents_{always}, depths_{0};     ///< by guard
  std::map<FormulaNodeId, int> yes_, no_;            ///< the guards of the branches of a condition
  std::vector<std::vector<FormulaNodeId>> members_;  ///< by guard, in the order of the graph
  std::vector<std::uint32_t> place_;                 ///< registers of nodes
};

FormulaProgram::FormulaProgram(const FormulaGraph& graph, const std::vector<FormulaNodeId>& roots, int states)
    : states_(static_cast<std::size_t>(states)) {
  FormulaCompiler(graph, roots, *this);
}

FormulaCode FormulaProgram::code() const {
  const auto count = [](const auto& of) { return static_cast<std::uint32_t>(of.size()); };
  return {steps_.data(),
          constants_.data(),
          results_.data(),
          count(steps_),
          count(constants_),
          count(results_),
          static_cast<std::uint32_t>(states_)};
}

void FormulaProgram::run(double t, const double* y, double* values) const {
  const auto run_in = [&](double* registers) {
    run_formulas(code(), registers, t, y, values, [](FormulaOp op, double a, double b) {
      // The usual ones here; a call for each of the others is little beside them.
      if (op == FormulaOp::sin) return std::sin(a);
      if (op == FormulaOp::cos) return std::cos(a);
      if (op == FormulaOp::exp) return std::exp(a);
      return formula_value(op, a, b, 0);
    });
  };
  constexpr std::size_t most_on_stack = 512;
  if (registers_ <= most_on_stack) {
    double held[most_on_stack];  // NOLINT(cppcoreguidelines-pro-type-member-init): written before it is read
    return run_in(held);
  }
  // One for each thread: nothing is allocated from the second call on.
  thread_local std::vector<double> held;
  if (held.size() < registers_) held.resize(registers_);
  run_in(held.data());
}

}  // namespace hmax
