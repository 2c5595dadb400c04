#include "core/coupled_mass.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <stdexcept>
#include <string>

#include <Eigen/SparseCholesky>

#include "core/dense_solvers.hpp"
#include "core/parallel_for.hpp"
#include "core/symmetry.hpp"

namespace hmax {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using Sparse = Eigen::SparseMatrix<double>;

/// Operations of a Cholesky factorisation that is made without asking, a fraction of a second, and of one
/// that is made where nothing else is accurate.
constexpr double little_work = 2e8, most_work = 4e10;
/// Ratio of b and a up to which polynomials are short enough.
constexpr double most_spread = 1000;

/// Numbers in (-1/2, 1/2), the same in every run.
VectorXd numbers(Index n, std::uint32_t seed) {
  VectorXd x(n);
  for (double& each : x) {
    seed = 1664525U * seed + 1013904223U;
    each = static_cast<double>(seed) / 4294967296.0 - 0.5;
  }
  return x;
}

void require_symmetric(const Sparse& M) {
  if (M.rows() != M.cols() || M.rows() == 0)
    throw std::invalid_argument("the mass matrix has " + std::to_string(M.rows()) + " rows and " +
                                std::to_string(M.cols()) + " columns; give a square one");
  if (!std::isfinite(M.sum()) || !is_symmetric(M))
    throw std::invalid_argument(
        "the mass matrix M is not symmetric; give a symmetric one, or a vector of masses");
}

[[noreturn]] void refuse_indefinite() {
  throw std::invalid_argument(
      "the mass matrix M is not positive definite; check elements without density, and elements with too few integration "
      "points");
}

/// Coefficients c_k of f = c_0 + c_1 T_1 + ... between a and b, to rounding: of an f with a singularity at
/// zero they decrease like rho^-k, rho = (sqrt(b) + sqrt(a)) / (sqrt(b) - sqrt(a)).
template <class F>
std::vector<double> chebyshev_series(double a, double b, const F& f) {
  const double rho =
      (std::sqrt(b) + std::sqrt(a)) / std::max(std::sqrt(b) - std::sqrt(a), 1e-3 * std::sqrt(b));
  const int degree = static_cast<int>(std::ceil(33 / std::log(rho))) + 2, count = 2 * degree;
  std::vector<double> series(static_cast<std::size_t>(degree) + 1, 0.0);
  for (int j = 0; j < count; ++j) {
    const double angle = std::numbers::pi * (j + 0.5) / count;
    const double value = f((a + b) / 2 + (b - a) / 2 * std::cos(angle));
    for (int k = 0; k <= degree; ++k)
      series[static_cast<std::size_t>(k)] += (k == 0 ? 1.0 : 2.0) / count * value * std::cos(k * angle);
  }
  return series;
}

/// b2 = c x + 2 T b1 - b2 with T = slope S + offset, of rows from `begin` on; `twice` is 2, of the last
/// step 1.
template <int Width, class Product>
void clenshaw_rows(const Product& S, double c, double twice, double slope, double offset, const double* x,
                   const double* b1, double* b2, std::size_t begin, std::size_t end) {
  for (std::size_t row = begin; row < end; ++row) {
    double sum[Width] = {};
    for (int k = S.first[row]; k < S.first[row + 1]; ++k) {
      const double value = S.value[static_cast<std::size_t>(k)];
      const double* const from = b1 + Width * S.column[static_cast<std::size_t>(k)];
      for (int i = 0; i < Width; ++i) sum[i] += value * from[i];
    }
    for (std::size_t i = Width * row; i < Width * (row + 1); ++i)
      b2[i] = c * x[i] + twice * (slope * sum[i - Width * row] + offset * b1[i]) - b2[i];
  }
}

/// The same of all rows.
template <class Product>
void clenshaw_step(const Product& S, double c, double twice, double slope, double offset, const VectorXd& x,
                   const VectorXd& b1, VectorXd& b2) {
  const auto compute = S.width == 3 ? clenshaw_rows<3, Product> : clenshaw_rows<1, Product>;
  parallel_rows(S.first.size() - 1, S.value.size(), [&](std::size_t begin, std::size_t end) {
    compute(S, c, twice, slope, offset, x.data(), b1.data(), b2.data(), begin, end);
  });
}

/// Whether S is the same for three coordinates in turn and couples none of them with another.
bool has_three_equal(const Sparse& S) {
  if (S.rows() % 3 != 0) return false;
  const int* const outer = S.outerIndexPtr();
  const int* const inner = S.innerIndexPtr();
  const double* const values = S.valuePtr();
  for (Index j = 0; j < S.cols(); j += 3)
    for (int c = 1; c < 3; ++c) {
      const int length = outer[j + 1] - outer[j];
      if (outer[j + c + 1] - outer[j + c] != length) return false;
      for (int k = 0; k < length; ++k)
        if (inner[outer[j] + k] % 3 != 0 || inner[outer[j + c] + k] != inner[outer[j] + k] + c ||
            std::abs(values[outer[j + c] + k] - values[outer[j] + k]) > 1e-15)
          return false;
    }
  return true;
}

}  // namespace

/// P M P^T = L L^T.
struct CoupledMass::Factor : Eigen::SimplicialLLT<Sparse> {
  /// Operations of the factorisation, known from the pattern.
  [[nodiscard]] double work() const {
    double sum = 0;
    for (Index j = 0; j < m_matrix.cols(); ++j) {
      const double count = m_matrix.outerIndexPtr()[j + 1] - m_matrix.outerIndexPtr()[j];
      sum += count * count;
    }
    return sum;
  }
};

CoupledMass::CoupledMass(const Sparse& M, Root root) : M_(M) {
  M_.makeCompressed();
  require_symmetric(M_);
  M_.prune([](Index, Index, double value) { return value != 0; });
  diagonal_ = M_.diagonal();
  if (!(diagonal_.minCoeff() > 0)) refuse_indefinite();
  scale();
  bound_spectrum();
  if (!(high_ > 0 && std::isfinite(high_))) refuse_indefinite();
  if (root != Root::polynomial && make_factor(root == Root::factor ? most_work : little_work)) {
    if (low_ <= 0) low_ = 1e-14 * high_;
    return;
  }
  if (low_ > 0 && high_ <= most_spread * low_) {
    make_polynomials();
    if (is_accurate()) return;
  }
  if (root == Root::polynomial || !make_factor(most_work))
    throw std::invalid_argument(
        "the mass matrix M is nearly singular, and a factor of it is too large; take the sums of its rows as masses, which "
        "changes the limit");
  if (low_ <= 0) low_ = 1e-14 * high_;
}

CoupledMass::~CoupledMass() = default;

// S = D^-1/2 M D^-1/2.
void CoupledMass::scale() {
  root_ = diagonal_.cwiseSqrt();
  inverse_root_ = root_.cwiseInverse();
  Sparse S = inverse_root_.asDiagonal() * M_ * inverse_root_.asDiagonal();
  S.makeCompressed();
  S_.width = has_three_equal(S) ? 3 : 1;
  S_.first.push_back(0);
  // Columns of a symmetric matrix are its rows.
  for (Index j = 0; j < S.cols(); j += S_.width) {
    for (Sparse::InnerIterator entry(S, j); entry; ++entry) {
      S_.column.push_back(static_cast<int>(entry.row()) / S_.width);
      S_.value.push_back(entry.value());
    }
    S_.first.push_back(static_cast<int>(S_.column.size()));
  }
}

// Lanczos iteration without orthogonalising anew [paige1980accuracy]: the ends converge first. The margins
// are what an end may lie beyond its Ritz value; polynomials tolerate more.
void CoupledMass::bound_spectrum() {
  const Index n = size(), most = std::min<Index>(n, 100);
  VectorXd before = VectorXd::Zero(n), q = numbers(n, 1).normalized(), w(n);
  VectorXd a(most), b(most);
  Index count = 0;
  for (double last = 0; count < most;) {
    w.setZero();
    clenshaw_step(S_, 0, 1, 1, 0, q, q, w);
    a[count] = q.dot(w);
    w -= a[count] * q + last * before;
    last = b[count] = w.norm();
    ++count;
    if (!(last > 1e-12 * std::abs(a[0]))) break;
    before.swap(q);
    q = w / last;
  }
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver;
  solver.computeFromTridiagonal(a.head(count), b.head(count - 1));
  const auto residual = [&](Index i) { return b[count - 1] * std::abs(solver.eigenvectors()(count - 1, i)); };
  const double least = solver.eigenvalues()[0], largest = solver.eigenvalues()[count - 1];
  low_ = std::min(0.97 * least, least - residual(0));
  high_ = 1.03 * largest + residual(count - 1);
}

// The work is known before it is done.
bool CoupledMass::make_factor(double most) {
  auto factor = std::make_unique<Factor>();
  factor->analyzePattern(M_);
  if (factor->work() > most) return false;
  factor->factorize(M_);
  if (factor->info() != Eigen::Success) refuse_indefinite();
  factor_ = std::move(factor);
  return true;
}

void CoupledMass::make_polynomials() {
  inverse_ = chebyshev_series(low_, high_, [](double s) { return 1 / s; });
  square_root_ = chebyshev_series(low_, high_, [](double s) { return 1 / std::sqrt(s); });
}

bool CoupledMass::is_accurate() const {
  const VectorXd f = diagonal_.cwiseProduct(numbers(size(), 7));
  VectorXd x = f, y = f;
  solve(x);
  transposed_root_solve(y);
  root_solve(y);
  const auto error = [&](const VectorXd& of) { return (M_ * of - f).norm(); };
  return error(x) <= 1e-12 * f.norm() && error(y) <= 1e-12 * f.norm();
}

// Clenshaw's recurrence: b_k = c_k x + 2 T b_k+1 - b_k+2, p x = c_0 x + T b_1 - b_2, T = (2 S - (a + b)) / (b
// - a).
void CoupledMass::apply(const std::vector<double>& series, VectorXd& x) const {
  // Kept by each thread: the forces of a step allocate nothing.
  thread_local VectorXd first, second;
  first.setZero(x.size());
  second.setZero(x.size());
  const double slope = 2 / (high_ - low_), offset = -(high_ + low_) / (high_ - low_);
  for (std::size_t k = series.size(); k-- > 0;) {
    clenshaw_step(S_, series[k], k > 0 ? 2 : 1, slope, offset, x, first, second);
    first.swap(second);
  }
  x = first;
}

// D^1/2 S D^1/2 x.
void CoupledMass::multiply(VectorXd& x) const {
  thread_local VectorXd scaled;
  scaled = root_.cwiseProduct(x);
  x.setZero();
  clenshaw_step(S_, 0, 1, 1, 0, scaled, scaled, x);
  x.array() *= root_.array();
}

void CoupledMass::solve(VectorXd& x) const {
  if (factor_) {
    x = factor_->solve(x);
    return;
  }
  x.array() *= inverse_root_.array();
  apply(inverse_, x);
  x.array() *= inverse_root_.array();
}

// P^T L^-T x, or D^-1/2 S^-1/2 x.
void CoupledMass::root_solve(VectorXd& x) const {
  if (factor_) {
    factor_->matrixU().solveInPlace(x);
    x = factor_->permutationPinv() * x;
    return;
  }
  apply(square_root_, x);
  x.array() *= inverse_root_.array();
}

// L^-1 P x, or S^-1/2 D^-1/2 x.
void CoupledMass::transposed_root_solve(VectorXd& x) const {
  if (factor_) {
    x = factor_->permutationP() * x;
    factor_->matrixL().solveInPlace(x);
    return;
  }
  x.array() *= inverse_root_.array();
  apply(square_root_, x);
}

}  // namespace hmax
