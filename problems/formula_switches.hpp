/// The times at which formulas switch whatever the state: conditions, abs, sign, rint, min and max of time
/// alone.
#pragma once

#include <vector>

#include "problems/formula_graph.hpp"
#include "problems/formula_program.hpp"

namespace hmax {

/// Finds where expressions of time that decide a branch change their sign. Each is sampled, at least eight
/// times in each half period of a sine, a cosine or a tangent and in each step of rint, then bisected to
/// neighbouring numbers.
class FormulaSwitches {
 public:
  FormulaSwitches() = default;
  /// @param graph   takes nodes for the signs
  /// @param states  length of y
  FormulaSwitches(FormulaGraph& graph, const std::vector<FormulaNodeId>& roots, int states);

  [[nodiscard]] bool none() const { return indicators_.empty(); }

  /// In increasing order, inside (t0, t1). Two changes of one expression between neighbouring samples are not
  /// seen. Where 200,000 samples do not reach t1 only the times that they reach are told.
  [[nodiscard]] std::vector<double> between(double t0, double t1) const;

 private:
  [[nodiscard]] double value(const FormulaProgram& program, double t) const;
  /// The length between samples [s].
  [[nodiscard]] double sampling(double t0, double t1) const;

  std::vector<double> still_;               ///< a state, which nothing here depends on
  std::vector<FormulaProgram> indicators_;  ///< piecewise constant, inner ones first
  std::vector<FormulaProgram> rates_;       ///< half periods per second of what oscillates
};

}  // namespace hmax
