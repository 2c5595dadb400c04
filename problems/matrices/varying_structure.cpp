#include "problems/matrices/varying_structure.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "problems/linear_structure.hpp"

namespace hmax {
namespace {

using Eigen::VectorXd;
using Sparse = Eigen::SparseMatrix<double>;
using ConstVector = Eigen::Ref<const VectorXd>;

/// The number i of the stretch from t[i] to t[i + 1] that holds t, of at least two times.
std::size_t stretch_of(const std::vector<double>& times, double t) {
  const auto behind = std::upper_bound(times.begin() + 1, times.end() - 1, t);
  return static_cast<std::size_t>(behind - times.begin()) - 1;
}

/// Zeros wherever an entry of A stands.
Sparse zeros_of(const Sparse& A) { return 0.0 * A; }

}  // namespace

VaryingMatrices::VaryingMatrices(MatrixSeries K, MatrixSeries C, const Sparse& M) {
  pattern_.resize(K.at.front().rows(), K.at.front().cols());
  pattern_.setIdentity();
  pattern_ = Sparse(zeros_of(pattern_) + zeros_of(M));
  for (const MatrixSeries* series : {&K, &C})
    for (const Sparse& A : series->at) pattern_ = Sparse(pattern_ + zeros_of(A));
  pattern_.makeCompressed();
  const std::vector<double> none;
  std::ranges::set_union(K.varies() ? K.t : none, C.varies() ? C.t : none, std::back_inserter(times_));
  K_ = on_pattern(std::move(K));
  C_ = on_pattern(std::move(C));
  M_ = on_pattern(M);
}

VectorXd VaryingMatrices::on_pattern(const Sparse& A) const {
  const Sparse spread = pattern_ + A;
  return spread.coeffs();
}

VaryingMatrices::Numbers VaryingMatrices::on_pattern(MatrixSeries series) const {
  Numbers numbers{.t = std::move(series.t), .values = {}};
  for (Sparse& A : series.at) {
    numbers.values.push_back(on_pattern(A));
    A = Sparse();
  }
  return numbers;
}

VaryingMatrices::Part VaryingMatrices::value_of(const Numbers& numbers, double t) {
  if (numbers.t.empty()) return {};
  const double* const only = numbers.values.front().data();
  if (numbers.t.size() == 1) return {only, only, 1, 0};
  const std::size_t i = stretch_of(numbers.t, t);
  const double share = std::clamp((t - numbers.t[i]) / (numbers.t[i + 1] - numbers.t[i]), 0.0, 1.0);
  return {numbers.values[i].data(), numbers.values[i + 1].data(), 1 - share, share};
}

VaryingMatrices::Part VaryingMatrices::rate_of(const Numbers& numbers, double t) {
  if (numbers.t.size() < 2 || t < numbers.t.front() || t >= numbers.t.back()) return {};
  const std::size_t i = stretch_of(numbers.t, t);
  const double per_second = 1 / (numbers.t[i + 1] - numbers.t[i]);
  return {numbers.values[i].data(), numbers.values[i + 1].data(), -per_second, per_second};
}

void VaryingMatrices::subtract(const Part& K, const Part& C, double beta, const ConstVector& q,
                               const ConstVector& v, Eigen::Ref<VectorXd> f) const {
  const int* const begin = pattern_.outerIndexPtr();
  const int* const row = pattern_.innerIndexPtr();
  for (Eigen::Index j = 0; j < pattern_.cols(); ++j) {
    const double x = q[j] + beta * v[j], w = v[j];
    if (C.first)
      for (Eigen::Index k = begin[j]; k < begin[j + 1]; ++k) f[row[k]] -= K(k) * x + C(k) * w;
    else if (K.first)
      for (Eigen::Index k = begin[j]; k < begin[j + 1]; ++k) f[row[k]] -= K(k) * x;
  }
}

void VaryingMatrices::subtract_forces(double t, double beta, const ConstVector& q, const ConstVector& v,
                                      Eigen::Ref<VectorXd> f) const {
  subtract(value_of(K_, t), value_of(C_, t), beta, q, v, f);
}

void VaryingMatrices::subtract_force_rates(double t, double beta, const ConstVector& q, const ConstVector& v,
                                           Eigen::Ref<VectorXd> f) const {
  subtract(rate_of(K_, t), rate_of(C_, t), beta, q, v, f);
}

void VaryingMatrices::combine(double t, double k, double c, double m, Sparse& A) const {
  if (A.rows() != pattern_.rows() || A.nonZeros() != pattern_.nonZeros()) A = pattern_;
  const Part K = value_of(K_, t), C = value_of(C_, t);
  for (Eigen::Index i = 0; i < M_.size(); ++i) A.valuePtr()[i] = k * K(i) + c * C(i) + m * M_[i];
}

VaryingStructure::VaryingStructure(std::shared_ptr<const VaryingMatrices> matrices, MassMatrix<double> mass,
                                   double alpha, double beta)
    : matrices_(std::move(matrices)), mass_(std::move(mass)), alpha_(alpha), beta_(beta) {}

void VaryingStructure::divide_by_mass(Eigen::Ref<VectorXd> f) const {
  if (mass_.is_diagonal())
    f.array() /= mass_.diagonal().array();
  else
    f = mass_.solve(f);
}

void VaryingStructure::rhs(double t, const State& y, State& dydt) const {
  const Eigen::Index n = dofs();
  dydt.head(n) = y.tail(n);
  dydt.tail(n).setZero();
  matrices_->subtract_forces(t, beta_, y.head(n), y.tail(n), dydt.tail(n));
  divide_by_mass(dydt.tail(n));
  dydt.tail(n) -= alpha_ * y.tail(n);
}

std::vector<double> VaryingStructure::breakpoints(double t0, double t1) const {
  const std::vector<double>& given = matrices_->times();
  std::vector<double> inside;
  for (const double t : given)
    if (t > t0 && t < t1 && (inside.empty() || t > inside.back())) inside.push_back(t);
  return inside;
}

void VaryingStructure::time_derivative(double t, const State& y, State& dfdt) const {
  const Eigen::Index n = dofs();
  dfdt.setZero();
  matrices_->subtract_force_rates(t, beta_, y.head(n), y.tail(n), dfdt.tail(n));
  divide_by_mass(dfdt.tail(n));
}

void VaryingStructure::jacobian(double t, const State& /*y*/, Jacobian& J) const {
  Sparse K, C;
  matrices_->combine(t, 1, 0, 0, K);
  matrices_->combine(t, beta_, 1, alpha_, C);
  first_order_matrix(K, mass_, C, J);
}

void VaryingStructure::force(double t, const Dofs& q, const Dofs& v, Dofs& f) const {
  f.setZero();
  if (alpha_ != 0) f = -alpha_ * mass_.times(v);
  matrices_->subtract_forces(t, beta_, q, v, f);
}

void VaryingStructure::stiffness(double t, const Dofs&, const Dofs&, DofMatrix& K) const {
  matrices_->combine(t, 1, 0, 0, K);
}

void VaryingStructure::damping(double t, const Dofs&, const Dofs&, DofMatrix& C) const {
  matrices_->combine(t, beta_, 1, alpha_, C);
}

}  // namespace hmax
