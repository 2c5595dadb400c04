/// Values of formulas: the operations of a graph in one list, for numbers on the stack.
#pragma once

#include <cstdint>
#include <vector>

#include "problems/formula_code.hpp"
#include "problems/formula_graph.hpp"

namespace hmax {

/// Computes the values of some nodes at (t, y). Of a condition only the branch that it takes is computed.
/// Const calls share nothing, so that threads may share a program.
class FormulaProgram {
 public:
  FormulaProgram() = default;
  /// @param states  length of y
  FormulaProgram(const FormulaGraph& graph, const std::vector<FormulaNodeId>& roots, int states);

  /// @param y       shape (states)
  /// @param values  one for each root
  void run(double t, const double* y, double* values) const;

  [[nodiscard]] const std::vector<FormulaStep>& steps() const { return steps_; }
  [[nodiscard]] const std::vector<double>& constants() const { return constants_; }
  [[nodiscard]] const std::vector<std::uint32_t>& results() const { return results_; }
  /// A view of them; the program outlives it.
  [[nodiscard]] FormulaCode code() const;
  [[nodiscard]] std::size_t registers() const { return registers_; }

 private:
  friend class FormulaCompiler;

  std::size_t states_ = 0, registers_ = 0;
  std::vector<double> constants_;
  std::vector<FormulaStep> steps_;
  std::vector<std::uint32_t> results_;
};

}  // namespace hmax
