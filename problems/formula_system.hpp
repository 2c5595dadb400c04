/// A user's own first-order system, its right-hand sides given as formulas in text.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <Eigen/Core>

namespace hmax {

/// y_i' = equations[i].second, in the order in which the user wrote them.
struct FormulaDefinition {
  std::string name;
  std::vector<std::pair<std::string, std::string>> equations;  ///< state name, formula of its derivative
  std::vector<std::pair<std::string, double>> parameters;      ///< name, value
  std::vector<double> y0;                                      ///< one number for each equation
  double t0 = 0;
  double t_end = 100;
};

/// The system of a definition. Formulas may use the state names, `t`, the parameters, `pi`, `e`, the
/// operators
/// + - * / ^ < <= > >= == != && || ?: and the functions sin cos tan asin acos atan atan2 sinh cosh tanh asinh
/// acosh atanh exp ln log log2 log10 sqrt abs sign rint min max sum avg (log is the natural logarithm).
///
/// A copy is independent of its original. rhs writes to a workspace behind the object: two threads need two
/// copies.
class FormulaSystem {
 public:
  using State = Eigen::VectorXd;

  /// Parses the formulas and evaluates them once at (t0, y0).
  /// @throws std::invalid_argument  one sentence that names the equation, the column and the remedy: no
  /// equations; as
  ///         many initial values as equations are needed; numbers that are not finite; t_end before t0; a
  ///         name that is no identifier, occurs twice or is already that of t, a constant or a function; an
  ///         unknown name, a syntax error, an assignment or several values in a formula; a derivative that is
  ///         not finite at the start
  explicit FormulaSystem(FormulaDefinition definition);
  FormulaSystem(const FormulaSystem& other);
  FormulaSystem(FormulaSystem&&) noexcept;
  FormulaSystem& operator=(FormulaSystem other) noexcept;
  ~FormulaSystem();

  Eigen::Index dim() const { return static_cast<Eigen::Index>(definition_.equations.size()); }

  /// @param y     shape (dim)
  /// @param dydt  shape (dim), already sized; not finite where a formula is not (1/0, sqrt(-1))
  void rhs(double t, const State& y, State& dydt) const;

  /// Gives a parameter another value.
  /// @throws std::invalid_argument  for an unknown parameter or a value that is not finite
  void set(std::string_view parameter, double value);

  /// With the parameters as they are set now.
  const FormulaDefinition& definition() const { return definition_; }

  State y0() const;

 private:
  struct Evaluator;  // keeps the expression library out of this header

  FormulaDefinition definition_;
  std::unique_ptr<Evaluator> evaluator_;
};

}  // namespace hmax
