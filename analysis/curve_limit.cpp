#include "analysis/curve_limit.hpp"

#include <algorithm>
#include <cmath>

namespace hmax {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using Sparse = Eigen::SparseMatrix<double>;

Sparse mass_scaled(const AnyMatrix& matrix, const VectorXd& inverse_root) {
  const Sparse A =
      is_sparse(matrix) ? std::get<Sparse>(matrix) : Sparse(std::get<Eigen::MatrixXd>(matrix).sparseView());
  return inverse_root.asDiagonal() * A * inverse_root.asDiagonal();
}

/// Values between two ends, the ends included.
std::vector<double> places(double low, double high, int samples) {
  std::vector<double> all{low, high};
  const double least = std::max(low, 1e-9 * high);
  for (int i = 1; i < samples; ++i) {
    const double share = static_cast<double>(i) / samples;
    all.push_back(low + share * (high - low));
    if (least > 0) all.push_back(least * std::pow(high / least, share));
  }
  std::ranges::sort(all);
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

}  // namespace

std::optional<std::array<double, 2>> rayleigh_coefficients(const MechanicalPart& part) {
  if (!part.symmetric) return std::nullopt;
  const auto n = static_cast<double>(part.mass.size());
  const VectorXd inverse_root = part.mass.cwiseSqrt().cwiseInverse();
  const Sparse k = mass_scaled(part.K, inverse_root), c = mass_scaled(part.C, inverse_root);
  const double trace_k = k.diagonal().sum(), trace_c = c.diagonal().sum();
  // The deviations from the mean of the diagonal, k - trace(k) / n, without the identity in them.
  const double square = k.squaredNorm() - trace_k * trace_k / n,
               product = k.cwiseProduct(c).sum() - trace_k * trace_c / n;
  const double beta = square > 1e-14 * k.squaredNorm() ? product / square : 0;
  const double alpha = (trace_c - beta * trace_k) / n;
  Sparse identity(k.rows(), k.cols());
  identity.setIdentity();
  const Sparse rest = c - beta * k - alpha * identity;
  if (rest.norm() > 1e-11 * c.norm()) return std::nullopt;
  return std::array<double, 2>{std::abs(alpha) <= 1e-13 * c.norm() ? 0 : alpha, beta};
}

CurveLimit smallest_exit(const DampingCurve& curve, const ExitsOf& exits, int samples) {
  double low = curve.kappa_min, high = curve.kappa_max;
  CurveLimit limit{.h_max = std::numeric_limits<double>::infinity(), .kappa = high};
  constexpr int rounds = 6;
  for (int round = 0; round < rounds; ++round) {
    const std::vector<double> kappas = places(low, high, samples);
    std::vector<MechanicalMode> modes;
    for (const double kappa : kappas) modes.push_back(curve.at(kappa));
    // The ends stay in every round: what some methods make of a mode depends on the fastest.
    modes.push_back(curve.at(curve.kappa_min));
    modes.push_back(curve.at(curve.kappa_max));
    const std::vector<double> h = exits(modes);
    std::size_t least = 0;
    for (std::size_t i = 1; i < kappas.size(); ++i)
      if (h[i] <= h[least]) least = i;
    if (!(h[least] < limit.h_max) && round > 0) break;
    limit.h_max = h[least];
    limit.kappa = kappas[least];
    low = kappas[least > 0 ? least - 1 : 0];
    high = kappas[std::min(least + 1, kappas.size() - 1)];
    // An end is what it is.
    if (!std::isfinite(limit.h_max) || limit.h_max == 0) break;
  }
  limit.between = limit.kappa > curve.kappa_min * (1 + 1e-9) && limit.kappa < curve.kappa_max * (1 - 1e-9);
  return limit;
}

}  // namespace hmax
