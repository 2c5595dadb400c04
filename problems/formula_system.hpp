/// A user's own system, its right-hand sides given as formulas in text.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "problems/formula_program.hpp"
#include "problems/linearity.hpp"

namespace hmax {

/// y_i' = equations[i].second, in the order in which the user wrote them.
struct FormulaDefinition {
  std::string name;
  std::vector<std::pair<std::string, std::string>> equations{};  ///< state name, formula of its derivative
  std::vector<std::pair<std::string, double>> parameters{};      ///< name, value
  std::vector<double> y0{};                                      ///< one number for each equation
  double t0 = 0;
  double t_end = 100;  ///< before t0: backwards in time
  /// The positions and the velocity of each; both empty: as the equations x' = v say.
  std::vector<std::string> positions{}, velocities{};
};

/// The system of a definition. Formulas may use the state names, `t`, the parameters, `pi`, `e`, and the
/// operators and functions of formula_language() (formula_parser.hpp). The derivatives are exact: the
/// formulas are differentiated.
///
/// Where every state is a position q with q' = v or its velocity v, the system is q'' = F(t, q, v) with
/// masses of 1, and the components of y are all positions, then all velocities: order() says which state of
/// the user each is. Otherwise dofs() is 0 and y has the order of the user.
///
/// Copies share what they compute with; const calls may come from several threads.
class FormulaSystem {
 public:
  using State = Eigen::VectorXd;
  using Jacobian = Eigen::MatrixXd;
  using Dofs = Eigen::VectorXd;
  using DofMatrix = Eigen::MatrixXd;
  using SparseMatrix = Eigen::SparseMatrix<double>;

  /// Parses the formulas and evaluates them once at (t0, y0).
  /// @throws std::invalid_argument  one sentence that names the equation, the column and the remedy: no
  /// equations; as
  ///         many initial values as equations are needed; numbers that are not finite; t_end equal to t0; a
  ///         name that is no identifier, occurs twice or is already that of t, a constant or a function; an
  ///         unknown name, a syntax error, an assignment or several values in a formula; a derivative that is
  ///         not finite at the start; positions and velocities that are not those of the equations
  explicit FormulaSystem(FormulaDefinition definition);

  Eigen::Index dim() const { return static_cast<Eigen::Index>(definition_.equations.size()); }

  /// @param y     shape (dim)
  /// @param dydt  shape (dim), already sized; not finite where a formula is not (1/0, sqrt(-1))
  void rhs(double t, const State& y, State& dydt) const;
  /// J_ij = d f_i / d y_j, shape (dim, dim). At a kink that of the side that the formula takes. A sparse one
  /// has the same pattern at every state.
  void jacobian(double t, const State& y, Eigen::MatrixXd& J) const;
  void jacobian(double t, const State& y, SparseMatrix& J) const;
  /// Whether a sparse Jacobian serves better: a large system with at most a twentieth of the entries.
  bool is_sparse() const;
  /// df/dt, shape (dim), from the right at kinks.
  void time_derivative(double t, const State& y, State& dfdt) const;
  bool is_autonomous() const;
  /// What rhs() runs.
  std::shared_ptr<const FormulaProgram> formulas() const;

  /// From the formulas with the parameters as they are: a term whose factor is zero does not count.
  Linearity linearity() const;
  /// Times in (t0, t1) where a condition on time alone changes, in increasing order (formula_switches.hpp).
  std::vector<double> breakpoints(double t0, double t1) const;

  /// n / 2 of a system of positions and velocities, else 0.
  Eigen::Index dofs() const;
  /// 1 for each degree of freedom, shape (dofs).
  Dofs mass() const { return Dofs::Ones(dofs()); }
  /// v', shape (dofs).
  void force(double t, const Dofs& q, const Dofs& v, Dofs& f) const;
  /// -dv'/dq and -dv'/dv, shape (dofs, dofs).
  void stiffness(double t, const Dofs& q, const Dofs& v, Eigen::MatrixXd& K) const;
  void stiffness(double t, const Dofs& q, const Dofs& v, SparseMatrix& K) const;
  void damping(double t, const Dofs& q, const Dofs& v, Eigen::MatrixXd& C) const;
  void damping(double t, const Dofs& q, const Dofs& v, SparseMatrix& C) const;

  /// order()[i] is the index in the definition of component i of y.
  const std::vector<Eigen::Index>& order() const;

  /// Gives a parameter another value.
  /// @throws std::invalid_argument  for an unknown parameter or a value that is not finite
  void set(std::string_view parameter, double value);

  /// With the parameters as they are set now.
  const FormulaDefinition& definition() const { return definition_; }

  /// The initial state, in the order of y.
  State y0() const;

 private:
  struct Compiled;  // programs and facts, which copies share

  FormulaDefinition definition_;
  std::shared_ptr<const Compiled> compiled_;
};

}  // namespace hmax
