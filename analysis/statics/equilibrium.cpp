#include "analysis/statics/equilibrium.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <random>

#include <Eigen/LU>
#include <Eigen/QR>
#include <Eigen/SparseLU>
#include <fmt/format.h>

#include "core/numbers.hpp"
#include "core/size_limits.hpp"

namespace hmax {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Sparse = Eigen::SparseMatrix<double>;

/// J d = -f for one J, below which the rows of what is conserved may stand: by sparse elimination where it
/// serves, else in the sense of least squares.
/// With W the conserved sums the rows of (J; W^T), shape (n + count, n), are scaled to a largest entry of
/// one, then the columns. A complete orthogonal decomposition with a threshold of 1e-12 gives the shortest
/// d among those of least residual.
class Corrections {
 public:
  Corrections(const AnyMatrix& J, const MatrixXd& conserved) {
    if (is_sparse(J) && conserved.cols() == 0) {
      sparse_ = std::make_unique<Eigen::SparseLU<Sparse>>();
      sparse_->compute(std::get<Sparse>(J));
      if (sparse_->info() == Eigen::Success && is_regular()) return;
      sparse_.reset();
      // Too large for a dense decomposition: usable() is false.
      if (rows(J) > most_dense_kernel) return;
    }
    MatrixXd A(rows(J) + conserved.cols(), rows(J));
    A << dense(J), conserved.transpose();
    // R: rows to a largest entry of one; then C: columns alike.
    row_ = reciprocal_sizes(A.cwiseAbs().rowwise().maxCoeff());
    A = row_.asDiagonal() * A;
    column_ = reciprocal_sizes(A.cwiseAbs().colwise().maxCoeff().transpose());
    A = A * column_.asDiagonal();
    dense_.emplace(A.rows(), A.cols());
    dense_->setThreshold(1e-12);
    dense_->compute(A);
    scaled_ = std::move(A);
  }

  /// False for a singular sparse matrix of more than most_dense_kernel rows.
  [[nodiscard]] bool usable() const { return sparse_ || dense_; }
  /// Rank below n, with the conserved sums counted as rows. False where sparse elimination served.
  [[nodiscard]] bool is_singular() const { return dense_ && dense_->rank() < dense_->cols(); }

  /// @param f  the residual, shape (n + count)
  /// @return   d, shape (n)
  [[nodiscard]] VectorXd operator()(const VectorXd& f) const {
    if (sparse_) return sparse_->solve(-f);
    const VectorXd wanted = -row_.cwiseProduct(f);
    // (R A C) (C^-1 d) = -R f with the diagonals R and C.
    return column_.cwiseProduct(VectorXd(dense_->solve(wanted)));
  }

  /// Whether J d = -f can be solved at all.
  [[nodiscard]] bool reaches(const VectorXd& f) const {
    if (!is_singular()) return true;
    const VectorXd wanted = -row_.cwiseProduct(f);
    return (scaled_ * VectorXd(dense_->solve(wanted)) - wanted).norm() <= 1e-8 * wanted.norm();
  }

 private:
  /// 1 / size; 1 for an empty row or column.
  static VectorXd reciprocal_sizes(const VectorXd& sizes) {
    return sizes.unaryExpr([](double size) { return size > 0 ? 1 / size : 1.0; });
  }
  /// Elimination of a singular matrix may end with a pivot of rounding and tell nothing.
  [[nodiscard]] bool is_regular() const {
    const VectorXd probe = VectorXd::Ones(sparse_->cols());
    const VectorXd x = sparse_->solve(probe);
    return x.allFinite() && x.cwiseAbs().maxCoeff() < 1e150;
  }

  std::unique_ptr<Eigen::SparseLU<Sparse>> sparse_;
  std::optional<Eigen::CompleteOrthogonalDecomposition<MatrixXd>> dense_;
  VectorXd row_, column_;
  MatrixXd scaled_;
};

/// Of a sparse matrix its stored entries.
bool all_finite(const AnyMatrix& J) {
  if (const auto* full = std::get_if<MatrixXd>(&J)) return full->allFinite();
  const auto& sparse = std::get<Sparse>(J);
  return Eigen::Map<const VectorXd>(sparse.valuePtr(), sparse.nonZeros()).allFinite();
}

/// Sums w^T y that no motion changes, as the columns of W, shape (n, count): those for which w^T f vanishes
/// at twice as many states around `y` as there are components, every other one farther away.
/// W spans the kernel of the matrix of rates, one state a row, by elimination with full pivoting; rank
/// decided at 1e-11.
/// @param size  of the components of y, shape (n)
/// @param far   how far the state has to be moved to change the rates, shape (n): beside large constants
/// nearer states tell
///              nothing
/// @return  no columns when there is no such sum, or when rates are finite at too few states
MatrixXd conserved_sums(const FrozenField& field, const VectorXd& y, const VectorXd& size,
                        const VectorXd& far) {
  const Index n = size.size(), wanted = 2 * n + 3;
  // A fixed seed: the same states in every run.
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> uniform(-0.3, 0.3);
  MatrixXd rates(wanted, n);
  VectorXd state(n), f(n);
  for (Index found = 0, tried = 0; found < wanted; ++tried) {
    if (tried == 4 * wanted) return {n, 0};
    // Within 30 % of the size of each component.
    const VectorXd& reach = tried % 2 == 0 ? size : far;
    for (Index i = 0; i < n; ++i) state[i] = y[i] + reach[i] * uniform(random);
    field.rhs(state, f);
    if (!f.allFinite()) continue;
    // Rows of one size: rates far away are no more than others.
    const double most = f.cwiseAbs().maxCoeff();
    rates.row(found++) = f.transpose() / (most > 0 ? most : 1);
  }
  // Rates of one size: column i tells of f_i.
  const VectorXd largest = rates.cwiseAbs().colwise().maxCoeff().transpose();
  const VectorXd reciprocal = largest.unaryExpr([](double r) { return r > 0 ? 1 / r : 1.0; });
  Eigen::FullPivLU<MatrixXd> elimination(rates * reciprocal.asDiagonal());
  elimination.setThreshold(1e-11);
  if (elimination.rank() == n) return {n, 0};
  MatrixXd kernel = elimination.kernel();
  // Rounding tells nothing of a state whose own rate is small.
  const double rounding = 1e-10 * kernel.cwiseAbs().maxCoeff();
  kernel = kernel.unaryExpr([&](double w) { return std::abs(w) <= rounding ? 0.0 : w; });
  return reciprocal.asDiagonal() * kernel;
}

/// |J| |y|: what the rates would be without cancellation, shape (n).
VectorXd row_sizes(const AnyMatrix& J, const VectorXd& y) {
  return std::visit([&](const auto& held) { return VectorXd(held.cwiseAbs() * y.cwiseAbs()); }, J);
}

/// One search from one start; y_ and f_ are the iterate and its rates.
class Search {
 public:
  Search(const FrozenField& field, const VectorXd& start)
      : field_(field), start_(start), y_(start), f_(start), conserved_(start.size(), 0) {}

  /// The iteration; ends by arrives() or ends().
  EquilibriumSearch run(int most_iterations) {
    using enum EquilibriumOutcome;
    if (!y_.allFinite() || !evaluate(y_, f_))
      return ends(not_finite, "the rates at the start of the search are not finite; start elsewhere");
    size_ = y_.cwiseAbs();
    for (; iterations_ < most_iterations; ++iterations_)
      if (std::optional<EquilibriumSearch> end = iterate()) return *std::move(end);
    return ends(no_equilibrium,
                fmt::format("no equilibrium within {} Newton steps; start elsewhere if the system has "
                            "one",
                            most_iterations));
  }

 private:
  /// One iteration of Newton's method, or a nudge off a fold. @returns the answer where the search ends here
  std::optional<EquilibriumSearch> iterate() {
    using enum EquilibriumOutcome;
    const AnyMatrix J = field_.jacobian(y_);
    if (!all_finite(J)) return ends(not_finite, "the Jacobian on the way is not finite; start elsewhere");
    // The largest terms that each rate has been a sum of, on the whole way.
    rate_size_ = rate_size_.size() ? rate_size_.cwiseMax(row_sizes(J, y_) + f_.cwiseAbs())
                                   : VectorXd(row_sizes(J, y_) + f_.cwiseAbs());
    if (f_.isZero(0) && rates_vanish()) return arrives();
    // Once, at the start: invariants hold everywhere.
    if (iterations_ == 0) look_for_conserved_sums(J);
    const Corrections correction(J, conserved_);
    if (!correction.usable())
      return ends(
          singular_jacobian,
          "the Jacobian is singular, so Newton's method does not say where to go; start elsewhere, or "
          "hold what is free to drift");
    // J d = -f has no solution: the rates at a singular state cannot be corrected from here.
    if (!correction.reaches(residual(y_, f_))) return leave_fold();
    const VectorXd d = correction(residual(y_, f_));
    if (!d.allFinite()) return ends(not_finite, "a Newton step overflows; start elsewhere");
    size_ = size_.cwiseMax(y_.cwiseAbs());
    // Lengths in units of the sizes of the components, max norm.
    const VectorXd weights = weights_for(d);
    const double length = length_of(d, weights);
    // Newton's method has nearly converged: steps are taken in full from here on.
    const bool small = length <= 1e-8, stalls = small && length > 0.9 * last_;
    // Near the solution the test of the line search would only see rounding.
    if (small) {
      step_to(y_ + d);
    } else if (!line_search(correction, d, weights)) {
      // The slope of a fold, known to rounding alone, may have sent the search too far to come back.
      if (!nudged_ && nudge()) {
        nudged_ = true;
        return std::nullopt;
      }
      return ends(no_equilibrium,
                  fmt::format("from this start the rates cannot be brought below {}; start elsewhere if the "
                              "system has an equilibrium",
                              rounded(f_.cwiseAbs().maxCoeff())));
    }
    // Stalled: corrections no longer shrink by a tenth, as at multiple roots or at rounding.
    if ((length <= 1e-13 || stalls) && rates_vanish()) {
      ++iterations_;
      return arrives();
    }
    last_ = length;
    return std::nullopt;
  }

  /// Where no correction makes all rates vanish. A fold may lie exactly here: beside it the search goes on,
  /// and a system without equilibrium says no again. @returns the answer where the search ends here
  std::optional<EquilibriumSearch> leave_fold() {
    using enum EquilibriumOutcome;
    if (iterations_ > 0 && rates_vanish()) return arrives();
    if (nudged_)
      return ends(
          no_equilibrium,
          conserved_.cols() > 0
              ? std::string("the rates cannot all vanish while the sums of the states that this system "
                            "conserves keep their value; start elsewhere")
              : fmt::format("the rates cannot all vanish near this state: whatever is moved, one of them "
                            "stays at {}; start elsewhere; a load without a spring has no equilibrium",
                            rounded(f_.cwiseAbs().maxCoeff())));
    nudged_ = true;
    if (!nudge())
      return ends(not_finite, "the rates beside a singular state are not finite; start elsewhere");
    return std::nullopt;
  }

  static std::string rounded(double value) { return fmt::format("{:.3g}", value); }

  /// @returns false when a rate is not finite
  bool evaluate(const VectorXd& y, VectorXd& f) const {
    field_.rhs(y, f);
    return f.allFinite();
  }

  /// f, and by how much the conserved sums differ from those of the start.
  VectorXd residual(const VectorXd& y, const VectorXd& f) const {
    VectorXd r(f.size() + conserved_.cols());
    r << f, conserved_.transpose() * (y - start_);
    return r;
  }

  /// A regular Jacobian allows none. Differences do not tell for sure, so that of small systems they are
  /// sought all the same.
  void look_for_conserved_sums(const AnyMatrix& J) {
    const Corrections correction(J, conserved_);
    if (rows(J) > most_searched_invariants && !correction.is_singular()) return;
    const VectorXd size = weights_for(y_).cwiseInverse();
    const VectorXd step = correction(f_);
    const VectorXd far = step.allFinite() ? VectorXd(size.cwiseMax(step.cwiseAbs())) : size;
    conserved_ = conserved_sums(field_, y_, size, far);
  }

  /// What a correction is measured against: the sizes that the components have had.
  VectorXd weights_for(const VectorXd& d) const {
    const double largest = size_.maxCoeff() > 0 ? size_.maxCoeff() : d.cwiseAbs().maxCoeff();
    return size_.cwiseMax(largest > 0 ? 1e-3 * largest : 1.0).cwiseInverse();
  }
  /// max_i |d_i| / size_i
  static double length_of(const VectorXd& d, const VectorXd& weights) {
    return d.cwiseProduct(weights).cwiseAbs().maxCoeff();
  }

  /// Stays where it is when the rates at y are not finite.
  void step_to(VectorXd y) {
    VectorXd f(y.size());
    if (!evaluate(y, f)) return;
    y_ = std::move(y);
    f_ = std::move(f);
  }

  /// The natural monotonicity test of Deuflhard: the simplified correction at y + a d must be shorter than
  /// d. Halves a from 1 down to 1e-15.
  /// @return  false when no a passes
  bool line_search(const Corrections& correction, const VectorXd& d, const VectorXd& weights) {
    const double length = length_of(d, weights);
    VectorXd f(y_.size());
    for (double a = 1; a > 1e-15; a /= 2) {
      const VectorXd y = y_ + a * d;
      if (!y.allFinite() || !evaluate(y, f)) continue;
      // |J^-1 F(y + a d)| <= (1 - a/4) |d|
      if (!(length_of(correction(residual(y, f)), weights) <= (1 - a / 4) * length)) continue;
      y_ = y;
      f_ = f;
      return true;
    }
    return false;
  }

  /// A thousandth of its size off, in a direction of no symmetry.
  bool nudge() {
    const double size = size_.maxCoeff() > 0 ? size_.maxCoeff() : 1;
    for (Index i = 0; i < y_.size(); ++i) y_[i] += 1e-3 * size * std::sin(1.0 + 2.4 * static_cast<double>(i));
    return evaluate(y_, f_);
  }

  /// Rounding beside the terms that the rates have been sums of.
  bool is_rounding(const VectorXd& f) const {
    return (f.cwiseAbs().array() <= 1e-11 * rate_size_.array()).all();
  }

  /// Whether all rates are rounding. Components that are rounding are set to zero where the rates then are:
  /// of a velocity that was never more than rounding, the rate has nothing else to be compared with.
  bool rates_vanish() {
    VectorXd y = y_, f(y_.size());
    for (Index i = 0; i < y.size(); ++i)
      if (std::abs(y[i]) <= 1e-12 * std::max(size_[i], 1e-3 * size_.maxCoeff())) y[i] = 0;
    if (evaluate(y, f) && is_rounding(f)) {
      y_ = y;
      f_ = f;
    }
    return is_rounding(f_);
  }

  [[nodiscard]] EquilibriumSearch arrives() const {
    return ends(EquilibriumOutcome::found, fmt::format("an equilibrium after {} Newton step{}", iterations_,
                                                       iterations_ == 1 ? "" : "s"));
  }

  /// The answer with the present state, the largest |f_i| and the count of steps.
  EquilibriumSearch ends(EquilibriumOutcome outcome, std::string message) const {
    return {outcome,
            y_,
            f_.size() ? f_.cwiseAbs().maxCoeff() : 0,
            iterations_,
            static_cast<int>(conserved_.cols()),
            std::move(message)};
  }

  const FrozenField& field_;
  VectorXd start_, y_, f_;
  MatrixXd conserved_;                                     ///< W, shape (n, count)
  VectorXd size_;                                          ///< the largest |y_i| on the way
  VectorXd rate_size_;                                     ///< the largest |J| |y| + |f| on the way
  double last_ = std::numeric_limits<double>::infinity();  ///< length of the last Newton step
  bool nudged_ = false;                                    ///< the search has left a fold
  int iterations_ = 0;
};

}  // namespace

std::string_view name_of(EquilibriumOutcome outcome) {
  switch (outcome) {
    case EquilibriumOutcome::found:
      return "found";
    case EquilibriumOutcome::no_equilibrium:
      return "no_equilibrium";
    case EquilibriumOutcome::not_finite:
      return "not_finite";
    case EquilibriumOutcome::singular_jacobian:
      break;
  }
  return "singular_jacobian";
}

EquilibriumSearch find_equilibrium(const FrozenField& field, const VectorXd& start, int most_iterations) {
  return Search(field, start).run(most_iterations);
}

}  // namespace hmax
