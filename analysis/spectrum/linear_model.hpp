/// What a system is near a state: its Jacobian and, where it is mechanical, its mass, damping and stiffness.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "core/mass_matrix.hpp"
#include "integrators/implicit/jacobian.hpp"
#include "integrators/system.hpp"

namespace hmax {

/// A square matrix, dense or sparse as the system has it.
using AnyMatrix = std::variant<Eigen::MatrixXd, Eigen::SparseMatrix<double>>;

/// Whose Jacobian is wanted: that of the code where there is one, or differences in any case.
enum class JacobianFrom { analytic_if_any, differences };

/// Whose Jacobian it is. Differences are central, good to about 8 digits of the largest entries; grouped ones
/// took columns without a common row together [curtis1974estimation].
enum class JacobianOrigin { analytic, differences, grouped_differences };

/// "analytic", "central differences", "central differences by groups of columns".
std::string_view name_of(JacobianOrigin origin);

/// How damping acts on the undamped modes: not at all; on each alone (K M^-1 C = C M^-1 K, of which
/// Rayleigh's alpha M + beta K is a case [caughey1965classical]); or so that it couples them.
enum class Damping { none, proportional, general };

/// "none", "proportional", "general".
std::string_view name_of(Damping damping);

/// M q'' + C q' + K q = 0, the motion near a state of a mechanical system of n degrees of freedom.
/// With y = (q, v) its Jacobian is (0, I; -M^-1 K, -M^-1 C), shape (2 n, 2 n).
struct MechanicalPart {
  MassMatrix<double> mass;  ///< M, shape (n, n) [kg], positive definite; a vector of n where it is diagonal
  AnyMatrix K;              ///< -dF/dq, shape (n, n) [N/m]
  AnyMatrix C;              ///< -dF/dv, shape (n, n) [N s/m]
  Damping damping = Damping::none;
  bool symmetric = true;  ///< K and C are, to what they are known to: no follower, no gyroscopic forces

  /// Whether the motion is that of n independent oscillators q'' + gamma q' + kappa q = 0.
  [[nodiscard]] bool decouples() const { return symmetric && damping != Damping::general; }
};

/// y' = f(t, y) near a state: (y + d)' = f(t, y) + J d, with t frozen.
/// Stability of the state and its frequencies follow from the eigenvalues of J.
struct LinearModel {
  double t = 0;       ///< [s]
  Eigen::VectorXd y;  ///< the state, shape (n)
  /// J(i, j) = d f_i / d y_j, shape (n, n). Of sparse mechanical systems it is assembled by each call: it
  /// takes twice the memory of K and C together, and most limits need only those.
  std::function<AnyMatrix()> J{};
  JacobianOrigin origin = JacobianOrigin::analytic;
  std::optional<MechanicalPart> mechanical{};  ///< of second-order systems, where y = (q, v)
  std::function<AnyMatrix()> J_stiff{};  ///< of the stiff part of split systems, shape (n, n); else empty
};

/// |A - B| / |A| of the Jacobians of two models of one system, in the norm of Frobenius.
/// Where both are mechanical it is computed from M, K and C without forming the Jacobians. A and B belong
/// to states of one system.
double relative_distance(const LinearModel& A, const LinearModel& B);

/// R^-T A R^-1 with M = R^T R, of lumped masses M^-1/2 A M^-1/2: similar to M^-1 A, and symmetric where A is.
/// @return  shape (n, n)
/// @cost    8 n^2 bytes
Eigen::MatrixXd mass_scaled(const MassMatrix<double>& M, const AnyMatrix& A);

/// The matrix as a dense one; a copy.
/// @cost  8 n^2 bytes
Eigen::MatrixXd dense(const AnyMatrix& matrix);
inline Eigen::Index rows(const AnyMatrix& matrix) {
  return std::visit([](const auto& held) { return held.rows(); }, matrix);
}
inline bool is_sparse(const AnyMatrix& matrix) { return matrix.index() == 1; }
/// |A - B| / |A| of two matrices of one shape, in the norm of Frobenius.
double relative_distance(const AnyMatrix& A, const AnyMatrix& B);

/// Classifies damping and symmetry of the matrices.
/// Symmetric: K = K^T, C = C^T. Proportional: K M^-1 C = C M^-1 K; then one basis makes both diagonal
/// [caughey1965classical]. Both are tested on three vectors.
/// @param relative  what counts as rounding beside the sizes of the terms: 1e-10 where matrices are analytic
/// @throws InputError  when a mass is not positive and finite, or an entry of K or C is not finite
MechanicalPart mechanical_part(MassMatrix<double> mass, AnyMatrix K, AnyMatrix C, double relative = 1e-10);
/// The same of matrices that are in the part already.
void classify(MechanicalPart& part, double relative = 1e-10);

namespace detail {
/// @throws InputError  that names the first entry of `matrix` that is not finite
void require_finite(const AnyMatrix& matrix, std::string_view what, double t);
/// @throws InputError  that names the time or the first component of y that is not finite
void require_finite_state(double t, const Eigen::VectorXd& y);

/// K and C of J = (0, I; -M^-1 K, -M^-1 C), shape (2 n, 2 n).
/// The lower blocks times -M, dense or sparse as J is.
std::pair<AnyMatrix, AnyMatrix> stiffness_and_damping_of(const AnyMatrix& J, const MassMatrix<double>& mass);

/// Takes what `from` holds: Eigen 3.4 has no moves of sparse matrices, and copies of those of meshes are
/// long.
AnyMatrix taken(AnyMatrix& from);

/// Brings whatever a system uses, variants included, into an AnyMatrix of double.
template <class Matrix>
AnyMatrix any_matrix(Matrix matrix) {
  if constexpr (std::is_same_v<Matrix, AnyMatrix>)
    return taken(matrix);
  else if constexpr (is_variant<Matrix>)
    return std::visit([](auto& held) { return any_matrix(std::move(held)); }, matrix);
  else if constexpr (std::is_base_of_v<Eigen::SparseMatrixBase<Matrix>, Matrix>)
    return Eigen::SparseMatrix<double>(matrix.template cast<double>());
  else
    return Eigen::MatrixXd(matrix.template cast<double>());
}

/// A matrix of the system's own type, in its shape.
/// Zero, shape (n, n); a variant is left for the system to fill.
template <class Matrix>
Matrix room_for(Eigen::Index n) {
  Matrix matrix = blank_matrix<Matrix>();
  if constexpr (!is_variant<Matrix>) {
    matrix.resize(n, n);
    matrix.setZero();
  }
  return matrix;
}

/// Degrees of freedom of a second-order system, half of its states; 0 of others and of those that say so.
template <System S>
Eigen::Index dofs_of(const S& system) {
  if constexpr (SecondOrderSystem<S>)
    return system.dofs();
  else
    return 0;
}
/// Whether the right-hand side is a sum of a stiff and a nonstiff part, f = f_E + f_I.
template <System S>
bool splits(const S& system) {
  if constexpr (requires { system.has_split(); })
    return system.has_split();
  else
    return SplitSystem<S>;
}

/// Where the Jacobian of a system can be nonzero: what it declares, or the pattern of its own sparse
/// Jacobian; empty where nothing is known.
template <System S>
Eigen::SparseMatrix<double> pattern_of(const S& system, real_of<typename S::State> t,
                                       const typename S::State& y) {
  if constexpr (PatternedSystem<S>)
    if (has_sparsity(system)) {
      Eigen::SparseMatrix<real_of<typename S::State>> declared;
      system.sparsity(declared);
      return declared.template cast<double>();
    }
  if constexpr (DifferentiableSystem<S>)
    if (has_jacobian(system)) {
      jacobian_type<S> J = room_for<jacobian_type<S>>(system.dim());
      system.jacobian(t, y, J);
      const AnyMatrix own = any_matrix(J);
      if (hmax::is_sparse(own)) return std::get<1>(own);
    }
  return {};
}

/// By the code of the system, in its own arithmetic, then in double; shape (n, n).
template <System S>
AnyMatrix jacobian_of_code(const S& system, real_of<typename S::State> t, const typename S::State& y) {
  jacobian_type<S> J = room_for<jacobian_type<S>>(system.dim());
  system.jacobian(t, y, J);
  return any_matrix(std::move(J));
}

/// The increment of a central difference of a component: eps^(1/3) |y_j|, with which truncation d^2 and
/// rounding eps / d balance. A component below a thousandth of the largest is moved as one of that size. A
/// state of 0 has no size: there as one of 1e-4.
template <class Real>
Real central_increment(Real y, Real largest) {
  const Real least = largest > 0 ? Real(1e-3) * largest : Real(1e-4);
  return std::cbrt(std::numeric_limits<Real>::epsilon()) * std::max(std::abs(y), least);
}

/// One column after another by central differences,
///   J e_j = (f(t, y + d_j e_j) - f(t, y - d_j e_j)) / (2 d_j) + O(d_j^2).
template <System S>
class CentralDifferences {
 public:
  using State = typename S::State;
  using Real = real_of<State>;
  using Column = Eigen::Vector<Real, Eigen::Dynamic>;

  CentralDifferences(const S& system, Real t, const State& y)
      : system_(system), t_(t), y_(y), plus_(y), minus_(y), f_(y), f_plus_(y), f_minus_(y) {
    largest_ = y.size() > 0 ? y.cwiseAbs().maxCoeff() : Real(0);
    guess_ = std::max(Real(1e-3) * largest_, Real(1e-4));
  }

  /// d_j, see central_increment().
  [[nodiscard]] Real increment(Eigen::Index j) const { return central_increment<Real>(y_[j], largest_); }
  void move(Eigen::Index j, Real d) {
    plus_[j] = y_[j] + d;
    minus_[j] = y_[j] - d;
  }
  void evaluate() {
    system_.rhs(t_, plus_, f_plus_);
    system_.rhs(t_, minus_, f_minus_);
  }
  /// The increment as it is after rounding.
  [[nodiscard]] double slope(Eigen::Index i, Eigen::Index j) const {
    return static_cast<double>((f_plus_[i] - f_minus_[i]) / (plus_[j] - minus_[j]));
  }
  void put_back(Eigen::Index j) { plus_[j] = minus_[j] = y_[j]; }

  /// All columns, shape (n, n). Where the size of a component is a guess its increment is a thousandth while
  /// f is seen to bend within it; where rounding hides entries it is a thousand times as large.
  Eigen::MatrixXd columns() {
    const Eigen::Index n = y_.size();
    Eigen::MatrixXd J(n, n);
    Eigen::VectorXd increments(n), column(n);
    system_.rhs(t_, y_, f_);
    for (Eigen::Index j = 0; j < n; ++j) {
      const bool guessed = n <= most_resolved_columns && std::abs(y_[j]) < guess_;
      increments[j] = static_cast<double>(guessed ? central_increment<Real>(guess_, guess_) : increment(j));
      take(j, increments[j], column);
      if (guessed) straighten(j, increments[j], column);
      J.col(j) = column;
    }
    if (n > most_resolved_columns || !f_.allFinite()) return J;
    ResolvedDifferences<Eigen::VectorXd> hidden(1e-7);
    hidden.resize(n);
    hidden.resolve(
        J, f_.template cast<double>(), increments, static_cast<double>(largest_),
        [&](Eigen::Index j, double d, Eigen::VectorXd& into) { return take(j, d, into) && is_straight(); });
    return J;
  }

 private:
  /// @returns whether all of it is finite
  bool take(Eigen::Index j, double d, Eigen::VectorXd& column) {
    move(j, static_cast<Real>(d));
    evaluate();
    for (Eigen::Index i = 0; i < column.size(); ++i) column[i] = slope(i, j);
    put_back(j);
    return column.allFinite();
  }

  /// Whether the slopes on both sides of the last evaluation agree to 1 % or rounding. What bends is not what
  /// rounding hid: a wider increment has met a kink or a jump, such as the contact of a body in flight.
  [[nodiscard]] bool is_straight() const {
    for (Eigen::Index i = 0; i < f_.size(); ++i) {
      const Real above = f_plus_[i] - f_[i], below = f_[i] - f_minus_[i],
                 rounding = 16 * std::numeric_limits<Real>::epsilon() * std::abs(f_[i]);
      if (!(std::abs(above - below) <= Real(0.01) * std::max(std::abs(above), std::abs(below)) + rounding))
        return false;
    }
    return true;
  }

  /// Where the size of a component is a guess f may bend within the increment: the differences then change
  /// with it. The largest increment counts whose thousandth gives the same to three digits or rounding. At a
  /// jump none does.
  void straighten(Eigen::Index j, double& d, Eigen::VectorXd& column) {
    Eigen::VectorXd wider = column, nearer = column;
    constexpr int most = 6;
    double increment = d;
    for (int rung = 0; rung < most && take(j, increment / 1000, nearer); ++rung) {
      const double rounding = 16e3 * std::numeric_limits<double>::epsilon() / increment;
      bool same = true;
      for (Eigen::Index i = 0; i < nearer.size(); ++i) {
        const double allowed = 1e-3 * std::abs(nearer[i]) + rounding * static_cast<double>(std::abs(f_[i]));
        same = same && std::abs(nearer[i] - wider[i]) <= allowed;
      }
      if (same) {
        d = increment;
        column = wider;
        return;
      }
      wider = nearer;
      increment /= 1000;
    }
  }

  const S& system_;
  Real t_;
  const State& y_;
  State plus_, minus_, f_, f_plus_, f_minus_;
  Real largest_;  ///< |y_j|
  Real guess_;    ///< the size of smaller components where curvature is looked for: f may add them to numbers
                  ///< of 1
};

/// J by central differences, columns one by one or in groups. Steppers are content with the forward
/// differences of integrators/implicit/jacobian.hpp: a few digits serve their Newton iterations, but a limit
/// of the step is no better than its eigenvalue.
template <System S>
AnyMatrix jacobian_by_differences(const S& system, real_of<typename S::State> t, const typename S::State& y,
                                  JacobianOrigin& origin) {
  Eigen::SparseMatrix<double> pattern = pattern_of(system, t, y);
  pattern.makeCompressed();
  const bool grouped = pattern.size() > 0;
  origin = grouped ? JacobianOrigin::grouped_differences : JacobianOrigin::differences;
  CentralDifferences<S> differences(system, t, y);
  if (!grouped) return differences.columns();
  // Columns of one group have no row in common, so each difference of f belongs to one of them
  // [curtis1974estimation].
  const ColumnGroups groups(pattern);
  for (const auto& group : groups.members()) {
    for (const Eigen::Index j : group) differences.move(j, differences.increment(j));
    differences.evaluate();
    for (const Eigen::Index j : group)
      for (Eigen::SparseMatrix<double>::InnerIterator entry(pattern, j); entry; ++entry)
        entry.valueRef() = differences.slope(entry.row(), j);
    for (const Eigen::Index j : group) differences.put_back(j);
  }
  return pattern;
}

/// Fills in mass, K and C by the code of the system. The matrices are made where they stay.
template <class S>
void mechanical_of_code(const S& system, real_of<typename S::State> at, const typename S::State& y,
                        MechanicalPart& part) {
  using DofMatrix = typename S::DofMatrix;
  const Eigen::Index n = dofs_of(system);
  const typename S::Dofs q = y.head(n), v = y.tail(n);
  part.mass = mass_of(system).template cast<double>();
  // Systems that write an AnyMatrix write into the part itself; others into a matrix of their own type.
  const auto make = [&](AnyMatrix& made, const auto& write) {
    if constexpr (std::is_same_v<DofMatrix, AnyMatrix>) {
      write(made);
    } else {
      DofMatrix own = room_for<DofMatrix>(n);
      write(own);
      made = any_matrix(std::move(own));
    }
  };
  make(part.K, [&](DofMatrix& K) { system.stiffness(at, q, v, K); });
  make(part.C, [&](DofMatrix& C) { system.damping(at, q, v, C); });
  classify(part);
}
}  // namespace detail

/// The system near (t, y), with t frozen.
///   f(t, y + d) = f(t, y) + J d + O(d^2)
/// For a second-order system K and C are its own where J is, and the blocks of J where J comes from
/// differences.
/// @param t     [s]; explicit dependence on time is frozen, its derivative is no part of J
/// @param y     state, shape (n)
/// @param from  differences: even where the system has a Jacobian, to compare both
/// @throws InputError  when the state or an entry of a matrix is not finite, or a mass not positive and
/// finite
/// @cost  differences take two evaluations of f for each column, or for each group of columns
template <System S>
LinearModel linearise(const S& system, double t, const typename S::State& y,
                      JacobianFrom from = JacobianFrom::analytic_if_any) {
  static_assert(!Eigen::NumTraits<typename S::State::Scalar>::IsComplex, "a linear model is real");
  using Real = real_of<typename S::State>;
  const auto at = static_cast<Real>(t);
  LinearModel model{.t = t, .y = y.template cast<double>()};
  detail::require_finite_state(t, model.y);

  const bool analytic = from == JacobianFrom::analytic_if_any && has_jacobian(system);
  if constexpr (SecondOrderSystem<S>)
    if (detail::dofs_of(system) > 0 && analytic)
      detail::mechanical_of_code(system, at, y, model.mechanical.emplace());
  // Sparse mechanical Jacobians are assembled when asked for; all others are kept.
  const bool on_demand = model.mechanical && is_sparse(model.mechanical->K);
  const auto keep = [on_demand](const auto& make, std::string_view what, double when) {
    if (on_demand) return std::function<AnyMatrix()>(make);
    AnyMatrix J = make();
    detail::require_finite(J, what, when);
    return std::function<AnyMatrix()>([J = std::move(J)] { return J; });
  };

  if constexpr (DifferentiableSystem<S>)
    if (analytic)
      model.J = keep([system, at, y] { return detail::jacobian_of_code(system, at, y); }, "the Jacobian", t);
  // By differences J is computed once and kept; K and C are its lower blocks times -M.
  if (!analytic) {
    const AnyMatrix J = detail::jacobian_by_differences(system, at, y, model.origin);
    detail::require_finite(J, "the Jacobian", t);
    model.J = [kept = J] { return kept; };
    if constexpr (SecondOrderSystem<S>)
      if (detail::dofs_of(system) > 0) {
        auto mass = MassMatrix<double>(mass_of(system).template cast<double>());
        auto [K, C] = detail::stiffness_and_damping_of(J, mass);
        // Differences know about 8 digits of the largest entries.
        model.mechanical = mechanical_part(std::move(mass), std::move(K), std::move(C), 1e-6);
      }
  }

  if constexpr (SplitSystem<S>)
    if (detail::splits(system))
      model.J_stiff = keep(
          [system, at, y] {
            jacobian_type<S> J = detail::room_for<jacobian_type<S>>(system.dim());
            system.jacobian_stiff(at, y, J);
            return detail::any_matrix(std::move(J));
          },
          "the Jacobian of the stiff part", t);
  return model;
}

}  // namespace hmax
