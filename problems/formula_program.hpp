/// Values of formulas: the operations of a graph in one list, for numbers on the stack.
#pragma once

#include <cstdint>
#include <vector>

#include "problems/formula_graph.hpp"

namespace hmax {

/// Computes the values of some nodes at (t, y). Const calls share nothing, so that threads may share a
/// program.
class FormulaProgram {
 public:
  FormulaProgram() = default;
  /// @param states  length of y
  FormulaProgram(const FormulaGraph& graph, const std::vector<FormulaNodeId>& roots, int states);

  /// @param y       shape (states)
  /// @param values  one for each root
  void run(double t, const double* y, double* values) const;

  [[nodiscard]] std::size_t steps() const { return steps_.size(); }

 private:
  /// Registers hold t, y, the constants, and what each step computes, in this order.
  struct Step {
    FormulaOp op;
    std::uint32_t a, b, c;
  };

  void run_in(double* registers, double t, const double* y, double* values) const;

  std::size_t states_ = 0;
  std::vector<double> constants_;
  std::vector<Step> steps_;
  std::vector<std::uint32_t> results_;
};

}  // namespace hmax
