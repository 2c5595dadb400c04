#include "analysis/foreign_steps/step_derivative.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "analysis/spectrum/lanczos.hpp"
#include "core/numbers.hpp"

namespace hmax {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using SparseMatrix = Eigen::SparseMatrix<double>;

/// Another direction for each k, its largest part 1.
VectorXd direction(Index n, Index k) {
  const VectorXd numbers = start_vector(n + 7 * k).tail(n);
  return numbers / numbers.cwiseAbs().maxCoeff();
}

VectorXd signs(Index n, Index k) {
  return direction(n, k).unaryExpr([](double x) { return x < 0 ? -1.0 : 1.0; });
}

}  // namespace

StepDerivative::StepDerivative(ForeignStepper& engine, const StateCoordinates& coordinates,
                               const VectorXd& scale, int slot, const VectorXd& y, double h)
    : engine_(&engine), coordinates_(&coordinates), scale_(scale), y_(y), slot_(slot), h_(h) {
  next_ = engine.after(slot, y, h, 1);
  if (is_finite()) choose_increment();
}

VectorXd StepDerivative::difference(const VectorXd& v, double increment) const {
  const auto image = [&](double sign) {
    const VectorXd x = sign * increment * v.cwiseProduct(scale_);
    return coordinates_->of(next_, engine_->after(slot_, coordinates_->at(y_, x), h_, 1));
  };
  return (image(1) - image(-1)).cwiseQuotient(2 * increment * scale_);
}

// A number that is not moved by many units of its last place is not moved by what was asked for.
double StepDerivative::least_increment() const {
  const double rounding = engine_->is_single_precision() ? std::numeric_limits<float>::epsilon()
                                                         : std::numeric_limits<double>::epsilon();
  return 30 * rounding * coordinates_->scales(y_.cwiseAbs()).cwiseQuotient(scale_).maxCoeff();
}

// From large increments, where the step may not be linear, to small ones, where rounding is all: the pair
// that agrees best.
void StepDerivative::choose_increment() {
  const double least = least_increment();
  constexpr int levels = 17, directions = 3;
  constexpr double largest = 0.5;
  std::array<double, levels> disagreement{};
  std::array<double, levels> size{};
  double shrink = std::sqrt(0.1);
  for (Index k = 0; k < directions; ++k) {
    const VectorXd v = direction(scale_.size(), k);
    VectorXd before;
    double increment = largest;
    for (std::size_t level = 0; level < levels; ++level, increment *= shrink) {
      if (level > 1 && increment < least) {
        disagreement[level] = infinity;
        continue;
      }
      const VectorXd now = difference(v, increment);
      const double change = level > 0 ? (now - before).norm() / v.norm() : infinity;
      disagreement[level] = std::max(disagreement[level], std::isfinite(change) ? change : infinity);
      size[level] = std::max(size[level], now.norm() / v.norm());
      before = now;
    }
  }
  const auto best = static_cast<std::size_t>(std::ranges::min_element(disagreement) - disagreement.begin());
  increment_ = largest * std::pow(shrink, static_cast<double>(best));
  const double rounding = engine_->is_single_precision() ? std::numeric_limits<float>::epsilon()
                                                         : std::numeric_limits<double>::epsilon();
  error_ = std::max(disagreement[best], 4 * rounding * size[best]);
}

bool StepDerivative::is_linear() const {
  const VectorXd v = direction(scale_.size(), 3), w = direction(scale_.size(), 4), both = v + w;
  const VectorXd sum = difference(v, increment_) + difference(w, increment_);
  const double off = (difference(both, increment_) - sum).norm();
  return off <= 30 * error_ * both.norm() || off <= 0.05 * (sum - both).norm();
}

double StepDerivative::error_along(const VectorXd& v) const {
  const double largest = v.cwiseAbs().maxCoeff();
  if (!(largest > 0)) return error_;
  const VectorXd w = v / largest, here = difference(w, increment_);
  double least = infinity;
  for (const double factor : {0.3, 3.0}) {
    const double off = (difference(w, factor * increment_) - here).norm() / w.norm();
    if (std::isfinite(off)) least = std::min(least, off);
  }
  return std::max(error_, least);
}

VectorXd StepDerivative::product(const VectorXd& v, double factor) const {
  const double largest = v.cwiseAbs().maxCoeff();
  if (!(largest > 0)) return VectorXd::Zero(v.size());
  return largest * difference(v / largest, factor * increment_);
}

MatrixXd StepDerivative::matrix(StepPattern& pattern, const std::function<void(double share)>& watch) const {
  MatrixXd J = matrix_at(increment_, watch);
  pattern.learn(J);
  return J;
}

std::optional<SparseMatrix> StepDerivative::grouped_matrix(StepPattern& pattern,
                                                           const std::function<void(double share)>& watch) {
  SparseMatrix J = grouped_at(increment_, pattern, watch);
  const VectorXd v = direction(scale_.size(), 5), off = (J * v - difference(v, increment_)) / v.norm();
  if (!(off.norm() <= 10 * error_)) {
    Index worst = 0;
    off.cwiseAbs().maxCoeff(&worst);
    pattern.refuse(worst);
    return std::nullopt;
  }
  error_ = std::max(error_, off.norm());
  return J;
}

MatrixXd StepDerivative::confirmed_matrix(StepPattern& pattern,
                                          const std::function<void(double share)>& watch) {
  MatrixXd J;
  if (pattern.pays())
    if (const std::optional<SparseMatrix> grouped = grouped_matrix(pattern, watch)) J = *grouped;
  if (J.size() == 0) J = matrix(pattern, watch);
  const MatrixXd other = pattern.pays() ? MatrixXd(grouped_at(3 * increment_, pattern, watch))
                                        : matrix_at(3 * increment_, watch);
  // On the diagonal what is left of 1 counts.
  const MatrixXd one = MatrixXd::Identity(J.rows(), J.cols());
  return one + ((J - other).array().abs() < 0.3 * (J - one).array().abs()).select(J - one, 0);
}

SparseMatrix StepDerivative::grouped_at(double increment, const StepPattern& pattern,
                                        const std::function<void(double share)>& watch) const {
  SparseMatrix J = pattern.entries();  // NOLINT(performance-unnecessary-copy-initialization): written below
  VectorXd v(J.cols());
  for (std::size_t k = 0; k < pattern.groups().size(); ++k) {
    v.setZero();
    for (const Index j : pattern.groups()[k]) v[j] = 1;
    const VectorXd column = difference(v, increment);
    for (const Index j : pattern.groups()[k])
      for (SparseMatrix::InnerIterator entry(J, j); entry; ++entry) entry.valueRef() = column[entry.row()];
    if (watch && k % 16 == 0) watch(static_cast<double>(k) / static_cast<double>(pattern.groups().size()));
  }
  return J;
}

MatrixXd StepDerivative::matrix_at(double increment, const std::function<void(double share)>& watch) const {
  const Index n = scale_.size();
  MatrixXd J(n, n);
  for (Index j = 0; j < n; ++j) {
    J.col(j) = difference(VectorXd::Unit(n, j), increment);
    if (watch && j % 16 == 0) watch(static_cast<double>(j) / static_cast<double>(n));
  }
  return J;
}

VectorXd scales_of(const VectorXd& y) {
  constexpr double rounding = 1e-12;  // of a state that settled at zero, in SI units
  const double largest = y.cwiseAbs().maxCoeff();
  if (!(largest > rounding)) return VectorXd::Ones(y.size());
  return y.cwiseAbs().cwiseMax(0.01 * largest);
}

VectorXd balancing_factors(const MatrixXd& J) {
  const Index n = J.rows();
  MatrixXd B = J - MatrixXd::Identity(n, n);
  B.diagonal().setZero();
  VectorXd D = VectorXd::Ones(n);
  for (int sweep = 0; sweep < 20; ++sweep)
    for (Index i = 0; i < n; ++i) {
      const double row = B.row(i).norm(), column = B.col(i).norm();
      if (!(row > 0 && column > 0)) continue;
      const double factor = std::clamp(std::sqrt(row / column), 0.01, 100.0);
      D[i] *= factor;
      B.row(i) /= factor;
      B.col(i) *= factor;
    }
  return D / D.maxCoeff();
}

VectorXd balancing_factors(const std::function<VectorXd(const VectorXd&)>& J, Index n) {
  VectorXd D = VectorXd::Ones(n);
  // D <- sqrt(D |J - I| D): one step would balance two numbers; a third leaves what only loosely hangs
  // together in place.
  for (int sweep = 0; sweep < 3; ++sweep) {
    VectorXd squares = VectorXd::Zero(n);
    for (Index k = 0; k < 4; ++k) {
      const VectorXd z = D.cwiseProduct(signs(n, Index(4) * sweep + k));
      squares += (J(z) - z).cwiseAbs2() / 4;
    }
    if (!squares.allFinite()) return VectorXd::Ones(n);
    for (Index i = 0; i < n; ++i)
      if (squares[i] > 0) D[i] = std::sqrt(D[i] * std::sqrt(squares[i]));
    D /= D.maxCoeff();
    D = D.cwiseMax(1e-6);
  }
  return D;
}

}  // namespace hmax
