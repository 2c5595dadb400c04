#include "analysis/spectrum/lanczos.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>

#include "core/dense_solvers.hpp"

namespace hmax {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

/// A symmetric tridiagonal matrix that grows: diagonal a_1 ... a_k, beside it b_1 ... b_k-1.
class Tridiagonal {
 public:
  std::vector<double> a, b;

  /// Whether x - T has no negative pivot, so that x is not below the largest eigenvalue.
  /// The pivots d_j = (x - a_j) - b_j-1^2 / d_j-1 of x I - T have the signs of its eigenvalues (a Sturm
  /// sequence; Sylvester's law of inertia).
  bool is_above(double x) const {
    double pivot = x - a[0];
    for (std::size_t j = 1; j < a.size(); ++j) {
      if (!(pivot > 0)) return false;
      pivot = x - a[j] - b[j - 1] * b[j - 1] / pivot;
    }
    return pivot >= 0;
  }

  /// The largest eigenvalue, from above.
  /// Brackets by strides that grow fourfold, then bisects to `relative` of the value. Costs k operations a
  /// look.
  /// @param low  a bound from below, such as the value before T grew
  /// @return  the upper end of the bracket [unit of T]
  double largest(double low, double width, double relative) const {
    // The largest eigenvalue is at least every diagonal entry.
    low = std::max(low, *std::ranges::max_element(a));
    double high = low + width;
    while (!is_above(high)) {
      low = high;
      width *= 4;
      high += width;
    }
    while (high - low > relative * std::abs(high)) {
      const double middle = low + (high - low) / 2;
      if (middle <= low || middle >= high) break;
      (is_above(middle) ? high : low) = middle;
    }
    return high;
  }

  /// The eigenvector of the largest eigenvalue, by inverse iteration at a bound x close above it. All its
  /// components are positive, as those of the start are.
  /// Solves (x I - T) s_new = s three times by the factors L D L^T, |s| = 1 after each; pivots of rounding
  /// are raised to epsilon |x|.
  /// @return  s, shape (k)
  VectorXd vector(double x) const {
    const auto k = static_cast<Index>(a.size());
    const double least = std::numeric_limits<double>::epsilon() * std::abs(x);
    VectorXd pivot(k), s = VectorXd::Ones(k);
    pivot[0] = std::max(x - a[0], least);
    for (Index j = 1; j < k; ++j)
      pivot[j] = std::max(x - a[at(j)] - b[at(j - 1)] * b[at(j - 1)] / pivot[j - 1], least);
    for (int iteration = 0; iteration < 3; ++iteration) {
      // L y = s, D z = y, L^T s = z with l_j = -b_j-1 / d_j-1.
      for (Index j = 1; j < k; ++j) s[j] += b[at(j - 1)] / pivot[j - 1] * s[j - 1];
      s = s.cwiseQuotient(pivot);
      for (Index j = k - 1; j-- > 0;) s[j] += b[at(j)] / pivot[j] * s[j + 1];
      s.normalize();
    }
    return s;
  }
};

/// One step after another:  b q_next = A q - a q - b_before q_before.
/// Only the last two vectors are kept.
class Recurrence {
 public:
  Recurrence(const SymmetricOperator& A, Index n)
      : A_(A), q_(start_vector(n).normalized()), before_(VectorXd::Zero(n)), w_(n) {}

  [[nodiscard]] const VectorXd& q() const { return q_; }

  /// Appends to T and moves on.
  void step(Tridiagonal& T) {
    A_(q_, w_);
    // a_j = q_j^T A q_j; what is left over has the norm b_j.
    const double a = w_.dot(q_);
    w_ -= a * q_ + b_ * before_;
    b_ = w_.norm();
    T.a.push_back(a);
    T.b.push_back(b_);
    before_.swap(q_);
    if (b_ > 0)
      q_ = w_ / b_;
    else
      // The Krylov space is invariant: the iteration ends.
      q_.setZero();
  }

 private:
  const SymmetricOperator& A_;
  VectorXd q_, before_, w_;
  double b_ = 0;  ///< |w| of the last step
};

/// sum_j s_j q_j, with the q_j that were kept, or with those of the same steps once more.
/// Repeating the steps gives the same q_j bit for bit: start and order of sums are the same.
VectorXd combined(const VectorXd& s, const std::vector<VectorXd>& kept, const SymmetricOperator& A, Index n) {
  VectorXd u = VectorXd::Zero(n);
  if (!kept.empty()) {
    for (Index j = 0; j < s.size(); ++j) u += s[j] * kept[at(j)];
    return u;
  }
  Recurrence again(A, n);
  Tridiagonal same;
  for (Index j = 0; j < s.size(); ++j) {
    u += s[j] * again.q();
    if (j + 1 < s.size()) again.step(same);
  }
  return u;
}

/// Lanczos iteration that stays orthogonal to all of its vectors and to those that were found before.
class FullLanczos {
 public:
  FullLanczos(const SymmetricOperator& A, Index n, Rank rank, double tolerance, Index most)
      : A_(A), n_(n), rank_(rank), tolerance_(tolerance), most_(most) {}

  MatrixXd found = {};              // columns
  std::vector<double> values = {};  ///< of the columns of `found`, in the order in which they were found
  Index products = 0;               ///< with A, in all runs

  /// The order of rank: values, or moduli.
  [[nodiscard]] bool comes_before(double a, double b) const {
    return rank_ == Rank::largest ? a > b : std::abs(a) > std::abs(b);
  }

  /// Finds at least one more, and up to `wanted`, in the order of rank among what is left. False when nothing
  /// converges.
  /// Looks for converged Ritz pairs after 2 wanted + 8 steps and again whenever a fifth more have been made;
  /// ends at most_ steps or when the space is exhausted.
  bool find_more(Index wanted) {
    const Index left = n_ - found.cols();
    if (left <= 0) return false;
    MatrixXd Q(n_, std::min<Index>(left, 32));
    // Another start every time: the parts of the last one are used up.
    VectorXd q = start_vector(n_ * (found.cols() + 1)).tail(n_), w(n_);
    orthogonalise(q, Q, 0);
    q.normalize();
    std::vector<double> a, b;
    // b_k q_k+1 = A q_k - a_k q_k - b_k-1 q_k-1, by full orthogonalisation; T has a on its diagonal and b
    // beside it.
    for (Index k = 0, next = std::min<Index>(left, 2 * wanted + 8);;) {
      if (k == Q.cols()) Q.conservativeResize(Eigen::NoChange, std::min(left, 2 * k));
      Q.col(k) = q;
      A_(q, w);
      ++products;
      a.push_back(w.dot(q));
      w -= a.back() * q;
      // Takes out the part along q_k-1 too, which the recurrence of three terms would subtract.
      orthogonalise(w, Q, k + 1);
      b.push_back(w.norm());
      ++k;
      const double size = std::abs(*std::ranges::max_element(a, {}, [](double x) { return std::abs(x); }));
      const bool invariant = k == left || b.back() <= 1e-14 * size;
      if (k >= next || invariant || k == most_) {
        if (take(Q, a, b, k, std::min(wanted, k), invariant || k == most_, invariant)) return true;
        if (invariant || k == most_) return false;
        next = std::min(left, k + std::max<Index>(4, k / 5));
      }
      q = w / b.back();
    }
  }

 private:
  /// w <- (I - Q Q^T)(I - F F^T) w, F what was found, two times: the second pass removes what rounding of the
  /// first one left. Twice is enough.
  void orthogonalise(VectorXd& w, const MatrixXd& Q, Index k) const {
    for (int time = 0; time < 2; ++time) {
      if (found.cols() > 0) w -= found * (found.transpose() * w).eval();
      if (k > 0) w -= Q.leftCols(k) * (Q.leftCols(k).transpose() * w).eval();
    }
  }

  /// Moves the leading Ritz pairs whose residual b_k |s_k| is at most tolerance |theta| into `found`.
  /// @param last  take fewer than wanted, since there will be no more steps
  /// @returns whether any was taken
  bool take(const MatrixXd& Q, const std::vector<double>& a, const std::vector<double>& b, Index k,
            Index wanted, bool last, bool invariant) {
    Eigen::SelfAdjointEigenSolver<MatrixXd> solver;
    solver.computeFromTridiagonal(Eigen::Map<const VectorXd>(a.data(), k),
                                  Eigen::Map<const VectorXd>(b.data(), std::max<Index>(k - 1, 0)));
    const VectorXd& ritz = solver.eigenvalues();
    std::vector<Index> order(at(k));
    std::iota(order.begin(), order.end(), Index(0));
    std::ranges::stable_sort(order, [&](Index i, Index j) { return comes_before(ritz[i], ritz[j]); });
    // Pairs are taken in order of rank only: the first that has not converged ends the list.
    Index ready = 0;
    while (ready < wanted) {
      const Index i = order[at(ready)];
      const double residual = invariant ? 0 : b.back() * std::abs(solver.eigenvectors()(k - 1, i));
      if (!(residual <= tolerance_ * std::abs(ritz[i]))) break;
      ++ready;
    }
    if (ready == 0 || (ready < wanted && !last)) return false;
    for (Index r = 0; r < ready; ++r) {
      const Index i = order[at(r)];
      found.conservativeResize(n_, found.cols() + 1);
      found.rightCols(1) = (Q.leftCols(k) * solver.eigenvectors().col(i)).normalized();
      values.push_back(ritz[i]);
    }
    return true;
  }

  const SymmetricOperator& A_;
  Index n_;
  Rank rank_;
  double tolerance_;
  Index most_;
};

}  // namespace

VectorXd start_vector(Index n) {
  VectorXd start(n);
  std::uint64_t state = 20;
  for (double& value : start) {
    // Knuth's multiplier for 64 bits; the upper 53 bits make a double in [0, 1).
    state = state * 6364136223846793005U + 1442695040888963407U;
    value = static_cast<double>(state >> 11U) * 0x1p-53 - 0.5;
  }
  return start;
}

// Steps of the recurrence; now and then the largest eigenvalue of T, its vector and the residual b_k s_k;
// at the end the vector from the basis, or from a second run.
LanczosPair largest_eigenpair(const SymmetricOperator& A, Index n, const LanczosSettings& settings) {
  constexpr double most_kept = 400e6 / sizeof(double);
  LanczosPair pair;
  Recurrence recurrence(A, n);
  Tridiagonal T;
  std::vector<VectorXd> kept;
  bool keeps = settings.with_vector;
  VectorXd s;  // the eigenvector of T
  double before = std::numeric_limits<double>::infinity(), theta = 0, width = 0;
  Index checked = 0, next = std::min<Index>(8, n);
  while (true) {
    if (keeps) kept.push_back(recurrence.q());
    // 400 MB are full: drop the basis, the vector will take a second run.
    if (static_cast<double>(kept.size() + 1) * static_cast<double>(n) > most_kept) {
      keeps = false;
      std::vector<VectorXd>().swap(kept);
    }
    recurrence.step(T);
    ++pair.products;
    const double b = T.b.back();
    // An invariant subspace, or no products left.
    const bool ends = b == 0 || pair.products == settings.most_products;
    if (pair.products < next && !ends) continue;
    const double relative = std::max(1e-3 * settings.tolerance, 1e-15);
    // The first bracket above the largest diagonal entry.
    if (width == 0) width = b + 1e-3 * std::abs(T.a.front());
    // The largest eigenvalue grows with T (interlacing), so the last one bounds it from below.
    theta = T.largest(theta == 0 ? -std::numeric_limits<double>::infinity() : theta * (1 - 2 * relative),
                      width, relative);
    s = T.vector(theta);
    // b_k s_k, with s_k > 0.
    pair.residual = b * s[pair.products - 1];
    // |A u - theta u| <= tolerance |theta|: an eigenvalue of A lies that near.
    pair.converged = pair.residual <= settings.tolerance * std::abs(theta);
    if (pair.converged || ends) break;
    // Residuals fall by about the same factor every step: look again when half of the way may be done.
    Index wait = std::max<Index>(4, pair.products / 4);
    if (pair.residual < before && std::isfinite(before)) {
      // ln of the factor per step; `rest` is how many steps it would take at that pace.
      const double fall = std::log(before / pair.residual) / static_cast<double>(pair.products - checked);
      const double rest = std::log(pair.residual / (settings.tolerance * std::abs(theta))) / fall;
      wait = static_cast<Index>(std::clamp(0.7 * rest, 2.0, static_cast<double>(wait)));
    }
    before = pair.residual;
    checked = pair.products;
    next = pair.products + wait;
    width = std::max(pair.residual, 4 * relative * std::abs(theta));
  }
  pair.value = theta;
  if (!settings.with_vector) return pair;
  pair.vector = combined(s, kept, A, n).normalized();
  VectorXd image(n);
  A(pair.vector, image);
  ++pair.products;
  // The quotient of Rayleigh is good to the square of the error of the vector.
  pair.value = pair.vector.dot(image);
  pair.residual = (image - pair.value * pair.vector).norm();
  pair.converged = pair.residual <= 2 * settings.tolerance * std::abs(pair.value);
  return pair;
}

// Runs until `count` pairs are found, then more runs on what is left, until one brings nothing that comes
// before the last of them.
LanczosPairs first_eigenpairs(const SymmetricOperator& A, Index n, Index count, Rank rank, double tolerance,
                              Index most_products) {
  FullLanczos search(A, n, rank, tolerance, most_products);
  LanczosPairs result;
  const auto size = [&] { return static_cast<Index>(search.values.size()); };
  while (size() < count && search.find_more(count - size())) {
  }
  result.converged = size() >= count;
  // Another copy of an eigenvalue, or one that the first vector missed, comes before the last of those found.
  while (result.converged && size() < n) {
    std::vector<double> best = search.values;
    std::ranges::sort(best, [&](double a, double b) { return search.comes_before(a, b); });
    const double last = best[at(count - 1)];
    const Index had = size();
    if (!search.find_more(1)) break;
    const double extra = search.values.back();
    if (size() == had || !search.comes_before(extra, last) ||
        std::abs(extra - last) <= tolerance * std::abs(last))
      break;
  }
  std::vector<Index> order(search.values.size());
  std::iota(order.begin(), order.end(), Index(0));
  std::ranges::stable_sort(order, [&](Index i, Index j) {
    return search.comes_before(search.values[at(i)], search.values[at(j)]);
  });
  order.resize(std::min(order.size(), at(count)));
  result.vectors.resize(n, static_cast<Index>(order.size()));
  for (const Index i : order) {
    result.vectors.col(static_cast<Index>(result.values.size())) = search.found.col(i);
    result.values.push_back(search.values[at(i)]);
  }
  result.products = search.products;
  return result;
}

}  // namespace hmax
