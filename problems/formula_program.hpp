/// Values of formulas: the operations of a graph in one list, for numbers on the stack.
#pragma once

#include <cstdint>
#include <vector>

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

  [[nodiscard]] std::size_t steps() const { return steps_.size(); }

 private:
  friend class FormulaCompiler;

  /// Registers hold t, y, the constants, and the values of the nodes, in this order.
  /// Most are operations, registers[to] = op(a, b, c). The other codes follow the last of FormulaOp.
  struct Step {
    std::uint8_t code;
    std::uint32_t to, a, b, c;
  };
  static constexpr std::uint8_t jump_unless = 253,  ///< goes on at step `c` where a is 0
      jump = 254,                                   ///< goes on at step `c`
      copy = 255;                                   ///< registers[to] = registers[a]

  void run_in(double* registers, double t, const double* y, double* values) const;

  std::size_t states_ = 0, registers_ = 0;
  std::vector<double> constants_;
  std::vector<Step> steps_;
  std::vector<std::uint32_t> results_;
};

}  // namespace hmax
