#include "problems/formula_program.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace hmax {

FormulaProgram::FormulaProgram(const FormulaGraph& graph, const std::vector<FormulaNodeId>& roots, int states)
    : states_(static_cast<std::size_t>(states)) {
  std::vector<bool> needed(graph.size(), false);
  for (const FormulaNodeId root : roots) needed[static_cast<std::size_t>(root)] = true;
  const auto operand = [](const FormulaNode& n, int k) { return k == 0 ? n.a : k == 1 ? n.b : n.c; };
  for (std::size_t i = needed.size(); i-- > 0;) {
    const FormulaNode& n = graph[static_cast<FormulaNodeId>(i)];
    for (int k = 0; needed[i] && k < operands_of(n.op); ++k)
      needed[static_cast<std::size_t>(operand(n, k))] = true;
  }
  // The constants first, so that the register of every step is known when it is written.
  std::vector<std::uint32_t> place(needed.size(), 0);
  for (std::size_t i = 0; i < needed.size(); ++i) {
    const FormulaNode& n = graph[static_cast<FormulaNodeId>(i)];
    if (!needed[i] || n.op != FormulaOp::constant) continue;
    place[i] = static_cast<std::uint32_t>(1 + states_ + constants_.size());
    constants_.push_back(n.value);
  }
  for (std::size_t i = 0; i < needed.size(); ++i) {
    const FormulaNode& n = graph[static_cast<FormulaNodeId>(i)];
    if (!needed[i] || n.op == FormulaOp::constant || n.op == FormulaOp::time) continue;
    if (n.op == FormulaOp::state) {
      place[i] = static_cast<std::uint32_t>(1 + n.a);
      continue;
    }
    const auto at = [&](FormulaNodeId id) { return place[static_cast<std::size_t>(id)]; };
    const int operands = operands_of(n.op);
    place[i] = static_cast<std::uint32_t>(1 + states_ + constants_.size() + steps_.size());
    steps_.push_back({n.op, at(n.a), operands > 1 ? at(n.b) : 0, operands > 2 ? at(n.c) : 0});
  }
  for (const FormulaNodeId root : roots) results_.push_back(place[static_cast<std::size_t>(root)]);
}

void FormulaProgram::run(double t, const double* y, double* values) const {
  const std::size_t registers = 1 + states_ + constants_.size() + steps_.size();
  constexpr std::size_t most_on_stack = 512;
  if (registers <= most_on_stack) {
    double held[most_on_stack];  // NOLINT(cppcoreguidelines-pro-type-member-init): written before it is read
    return run_in(held, t, y, values);
  }
  // One for each thread: nothing is allocated from the second call on.
  thread_local std::vector<double> held;
  if (held.size() < registers) held.resize(registers);
  run_in(held.data(), t, y, values);
}

void FormulaProgram::run_in(double* registers, double t, const double* y, double* values) const {
  registers[0] = t;
  double* next = std::copy_n(y, states_, registers + 1);
  next = std::copy(constants_.begin(), constants_.end(), next);
  for (const Step& step : steps_) {
    const double a = registers[step.a], b = registers[step.b];
    // The usual ones here; a call for each of the others is little beside them.
    switch (step.op) {
      case FormulaOp::add:
        *next++ = a + b;
        break;
      case FormulaOp::subtract:
        *next++ = a - b;
        break;
      case FormulaOp::multiply:
        *next++ = a * b;
        break;
      case FormulaOp::divide:
        *next++ = a / b;
        break;
      case FormulaOp::negate:
        *next++ = -a;
        break;
      case FormulaOp::square:
        *next++ = a * a;
        break;
      case FormulaOp::cube:
        *next++ = a * a * a;
        break;
      case FormulaOp::sin:
        *next++ = std::sin(a);
        break;
      case FormulaOp::cos:
        *next++ = std::cos(a);
        break;
      case FormulaOp::exp:
        *next++ = std::exp(a);
        break;
      default:
        *next++ = formula_value(step.op, a, b, registers[step.c]);
    }
  }
  for (const std::uint32_t result : results_) *values++ = registers[result];
}

}  // namespace hmax
