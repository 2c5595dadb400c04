/// Formulas as a graph of operations: each value is computed once, however many formulas use it.
#pragma once

#include <cstdint>
#include <map>
#include <tuple>
#include <vector>

#include "problems/formula_operations.hpp"

namespace hmax {

/// The index of a node; operands have smaller ones.
using FormulaNodeId = std::int32_t;

/// One operation. `a` of a state is its index in y.
struct FormulaNode {
  FormulaOp op = FormulaOp::constant;
  FormulaNodeId a = 0, b = 0, c = 0;
  double value = 0;  ///< of a constant

  /// @param k  less than operands_of(op)
  [[nodiscard]] FormulaNodeId operand(int k) const { return k == 0 ? a : k == 1 ? b : c; }
  void each_operand(const auto& visit) const {
    for (int k = 0; k < operands_of(op); ++k) visit(operand(k));
  }
};

/// What a value depends on. A product with the constant zero depends on nothing.
struct FormulaDependence {
  bool on_time = false, on_state = false;
  /// Whether a jump or a kink lies where an expression of the state passes a threshold: conditions, abs,
  /// sign, rint, min, max.
  bool switches_with_state = false;
};

/// The value of an operation. A condition is true where it is not 0; comparisons give 1 or 0.
double formula_value(FormulaOp op, double a, double b, double c);

/// The nodes of the formulas of a system. Operations on constants are carried out at once, equal nodes are
/// one.
class FormulaGraph {
 public:
  using Id = FormulaNodeId;

  [[nodiscard]] Id constant(double value);
  [[nodiscard]] Id time();
  /// @param index  in y
  [[nodiscard]] Id state(int index);
  /// The node of an operation with its operands; operands that it does not have are 0.
  [[nodiscard]] Id make(FormulaOp op, Id a, Id b = 0, Id c = 0);

  [[nodiscard]] std::size_t size() const { return nodes_.size(); }
  [[nodiscard]] const FormulaNode& operator[](Id id) const { return nodes_[static_cast<std::size_t>(id)]; }
  [[nodiscard]] const FormulaDependence& dependence(Id id) const {
    return dependences_[static_cast<std::size_t>(id)];
  }
  [[nodiscard]] bool is_constant(Id id) const { return (*this)[id].op == FormulaOp::constant; }
  [[nodiscard]] bool is_constant(Id id, double value) const {
    return is_constant(id) && (*this)[id].value == value;
  }

 private:
  using Key = std::tuple<FormulaOp, Id, Id, Id, std::uint64_t>;

  Id keep(const FormulaNode& node, FormulaDependence dependence);
  [[nodiscard]] FormulaDependence dependence_of(const FormulaNode& node) const;

  std::vector<FormulaNode> nodes_;
  std::vector<FormulaDependence> dependences_;
  std::map<Key, Id> known_;
};

/// d f / d y_j of one node, for each state that it depends on.
struct FormulaSlope {
  int state = 0;
  FormulaNodeId node = 0;
};

/// The exact derivatives of formulas with respect to every state, as nodes that are added to the graph.
/// Products with zero are left out, so that the derivative of a linear formula is a constant node. At a kink
/// a derivative is that of the side that the formula takes: of abs at 0 the right one.
/// @param roots  the formulas
/// @return  for each root its derivatives that are not the constant zero, in the order of the states
std::vector<std::vector<FormulaSlope>> state_slopes(FormulaGraph& graph,
                                                    const std::vector<FormulaNodeId>& roots);

/// The exact derivatives with respect to time, from the right at kinks.
/// @return  one node for each root, the constant zero where it does not depend on time
std::vector<FormulaNodeId> time_slopes(FormulaGraph& graph, const std::vector<FormulaNodeId>& roots);

}  // namespace hmax
