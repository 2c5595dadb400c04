#include "analysis/poincare.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace hmax {

using Eigen::VectorXd;

std::vector<VectorXd> looks(const VectorFunction& map, VectorXd y, int skip, int count) {
  if (skip < 0 || count < 0) throw std::invalid_argument("the looks at a motion cannot be fewer than none");
  std::vector<VectorXd> seen;
  for (int i = 0; i < skip + count && y.allFinite(); ++i) {
    if (i >= skip) seen.push_back(y);
    y = map(y);
  }
  return seen;
}

std::optional<int> period_of(const std::vector<VectorXd>& looks, double tolerance) {
  if (looks.empty()) return std::nullopt;
  VectorXd size = VectorXd::Zero(looks[0].size());
  for (const VectorXd& y : looks) size = size.cwiseMax(y.cwiseAbs());
  const double allowed = tolerance * size.maxCoeff() + 1e-12;  // what dies out has come to rest
  for (std::size_t p = 1; 4 * p <= looks.size(); ++p) {
    bool repeats = true;
    for (std::size_t i = 0; i + p < looks.size() && repeats; ++i)
      repeats = (looks[i + p] - looks[i]).cwiseAbs().maxCoeff() <= allowed;
    if (repeats) return static_cast<int>(p);
  }
  return std::nullopt;
}

double largest_lyapunov(const VectorFunction& map, VectorXd y, const VectorXd& scale, int count) {
  constexpr double separation = 1e-6;
  // Any direction but an invariant one.
  VectorXd apart = VectorXd::LinSpaced(y.size(), 1, 1.7).cwiseProduct(scale);
  apart *= separation / apart.cwiseQuotient(scale).norm();
  double sum = 0;
  for (int i = 0; i < count; ++i) {
    const VectorXd there = map(y);
    apart = map(y + apart) - there;
    const double grown = apart.cwiseQuotient(scale).norm() / separation;
    if (!std::isfinite(grown)) return std::numeric_limits<double>::quiet_NaN();
    if (grown == 0) return -std::numeric_limits<double>::infinity();
    sum += std::log(grown);
    apart /= grown;
    y = there;
  }
  return sum / count;
}

std::vector<BifurcationColumn> bifurcation(const std::function<VectorFunction(double)>& map_at,
                                           const std::vector<double>& values, const VectorXd& y0, int skip,
                                           int count, bool follow, const std::function<bool(double)>& going) {
  std::vector<BifurcationColumn> columns;
  VectorXd start = y0;
  for (const double value : values) {
    const double done = static_cast<double>(columns.size()) / static_cast<double>(values.size());
    if (going && !going(done)) break;
    auto seen = looks(map_at(value), start, skip, count);
    const bool whole = static_cast<int>(seen.size()) == count;
    if (follow && whole && !seen.empty()) start = seen.back();
    const auto period = whole ? period_of(seen) : std::nullopt;
    columns.push_back({value, std::move(seen), period});
  }
  return columns;
}

}  // namespace hmax
