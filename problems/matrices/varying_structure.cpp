#include "problems/matrices/varying_structure.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "problems/matrix_entries.hpp"

namespace hmax {
namespace {

using Eigen::Index;
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

VaryingMatrices::VaryingMatrices(MatrixSeries K, MatrixSeries C) {
  pattern_.resize(K.at.front().rows(), K.at.front().cols());
  pattern_.setIdentity();
  pattern_ *= 0.0;
  for (const MatrixSeries* series : {&K, &C})
    for (const Sparse& A : series->at) pattern_ = Sparse(pattern_ + zeros_of(A));
  pattern_.makeCompressed();
  const std::vector<double> none;
  std::ranges::set_union(K.varies() ? K.t : none, C.varies() ? C.t : none, std::back_inserter(times_));
  K_ = on_pattern(std::move(K));
  C_ = on_pattern(std::move(C));
}

VaryingMatrices::Numbers VaryingMatrices::on_pattern(MatrixSeries series) const {
  Numbers numbers{.t = std::move(series.t), .values = {}};
  for (Sparse& A : series.at) {
    const Sparse spread = pattern_ + A;
    numbers.values.emplace_back(spread.coeffs());
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

void VaryingMatrices::subtract(const Part& K, const Part& C, double beta, const ConstVector& q, const ConstVector& v,
                               Eigen::Ref<VectorXd> f) const {
  const int* const begin = pattern_.outerIndexPtr();
  const int* const row = pattern_.innerIndexPtr();
  for (Index j = 0; j < pattern_.cols(); ++j) {
    const double x = q[j] + beta * v[j], w = v[j];
    if (C.first)
      for (Index k = begin[j]; k < begin[j + 1]; ++k) f[row[k]] -= K(k) * x + C(k) * w;
    else if (K.first)
      for (Index k = begin[j]; k < begin[j + 1]; ++k) f[row[k]] -= K(k) * x;
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

void VaryingMatrices::combine(double t, double k, double c, double m, const VectorXd& mass, Sparse& A) const {
  if (A.rows() != pattern_.rows() || A.nonZeros() != pattern_.nonZeros()) A = pattern_;
  const Part K = value_of(K_, t), C = value_of(C_, t);
  const int* const begin = pattern_.outerIndexPtr();
  const int* const row = pattern_.innerIndexPtr();
  for (Index j = 0; j < pattern_.cols(); ++j)
    for (Index i = begin[j]; i < begin[j + 1]; ++i)
      A.valuePtr()[i] = k * K(i) + c * C(i) + (row[i] == j ? m * mass[j] : 0);
}

VaryingStructure::VaryingStructure(std::shared_ptr<const VaryingMatrices> matrices, VectorXd mass, double alpha,
                                   double beta)
    : matrices_(std::move(matrices)), mass_(std::move(mass)), alpha_(alpha), beta_(beta) {}

void VaryingStructure::rhs(double t, const State& y, State& dydt) const {
  const Index n = dofs();
  dydt.head(n) = y.tail(n);
  dydt.tail(n) = -alpha_ * mass_.cwiseProduct(y.tail(n));
  matrices_->subtract_forces(t, beta_, y.head(n), y.tail(n), dydt.tail(n));
  dydt.tail(n).array() /= mass_.array();
}

void VaryingStructure::time_derivative(double t, const State& y, State& dfdt) const {
  const Index n = dofs();
  dfdt.setZero();
  matrices_->subtract_force_rates(t, beta_, y.head(n), y.tail(n), dfdt.tail(n));
  dfdt.tail(n).array() /= mass_.array();
}

// (0, I; -M^-1 K, -M^-1 C).
void VaryingStructure::jacobian(double t, const State& /*y*/, Jacobian& J) const {
  const Index n = dofs();
  Sparse K, C;
  matrices_->combine(t, 1, 0, 0, mass_, K);
  matrices_->combine(t, beta_, 1, alpha_, mass_, C);
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(static_cast<std::size_t>(n + K.nonZeros() + C.nonZeros()));
  const auto add = [&](Index i, Index j, double value) {
    entries.emplace_back(static_cast<int>(i), static_cast<int>(j), value);
  };
  for (Index i = 0; i < n; ++i) add(i, n + i, 1);
  each_entry(K, [&](Index i, Index j, double value) { add(n + i, j, -value / mass_[i]); });
  each_entry(C, [&](Index i, Index j, double value) { add(n + i, n + j, -value / mass_[i]); });
  J.resize(2 * n, 2 * n);
  J.setFromTriplets(entries.begin(), entries.end());
}

void VaryingStructure::force(double t, const Dofs& q, const Dofs& v, Dofs& f) const {
  f = -alpha_ * mass_.cwiseProduct(v);
  matrices_->subtract_forces(t, beta_, q, v, f);
}

void VaryingStructure::stiffness(double t, const Dofs&, const Dofs&, DofMatrix& K) const {
  matrices_->combine(t, 1, 0, 0, mass_, K);
}

void VaryingStructure::damping(double t, const Dofs&, const Dofs&, DofMatrix& C) const {
  matrices_->combine(t, beta_, 1, alpha_, mass_, C);
}

}  // namespace hmax
