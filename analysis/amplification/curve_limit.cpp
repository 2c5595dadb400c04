#include "analysis/amplification/curve_limit.hpp"

#include <algorithm>
#include <cmath>

#include "analysis/spectrum/lanczos.hpp"

namespace hmax {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
/// Values between two ends, the ends included.
/// Arithmetic spacing resolves the stiff end, geometric spacing the soft one, down to 1e-9 of `high`.
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

// Least squares for c x = alpha s x + beta k x of one x in general position, then the residual for that x
// and two more. Costs three products with K and C.
std::optional<std::array<double, 2>> rayleigh_coefficients(const MechanicalPart& part) {
  if (!part.symmetric) return std::nullopt;
  const Index n = part.mass.size();
  // k, c and s are K, C and M with D^-1/2 on both sides, D = diag(M): of lumped masses s x = x.
  const VectorXd inverse_root = part.mass.diagonal().cwiseSqrt().cwiseInverse();
  const auto scaled = [&](const AnyMatrix& A, const VectorXd& x) {
    VectorXd y(n);
    std::visit([&](const auto& held) { y.noalias() = held * inverse_root.cwiseProduct(x); }, A);
    return VectorXd(y.cwiseProduct(inverse_root));
  };
  // (s x, k x) (alpha, beta) = c x of one vector in general position; another one says whether that holds.
  constexpr Index probes = 3;
  const VectorXd numbers = start_vector(probes * n);
  double alpha = 0, beta = 0;
  for (Index probe = 0; probe < probes; ++probe) {
    const VectorXd x = numbers.segment(probe * n, n), kx = scaled(part.K, x), cx = scaled(part.C, x);
    const VectorXd sx =
        part.mass.is_diagonal()
            ? x
            : VectorXd(part.mass.times(VectorXd(inverse_root.cwiseProduct(x))).cwiseProduct(inverse_root));
    if (probe == 0) {
      // The part of k x across s x determines beta, the part along s x then alpha.
      const double mean = sx.dot(kx) / sx.squaredNorm();
      const VectorXd across = kx - mean * sx;
      beta = across.norm() > 1e-14 * kx.norm() ? across.dot(cx) / across.squaredNorm() : 0;
      alpha = sx.dot(cx) / sx.squaredNorm() - beta * mean;
      // An alpha of rounding is none: at kappa = 0 it would make damping of nothing.
      if (std::abs(alpha) * sx.norm() <= 1e-13 * cx.norm()) alpha = 0;
    }
    if ((cx - beta * kx - alpha * sx).norm() > 1e-11 * cx.norm()) return std::nullopt;
  }
  return std::array<double, 2>{alpha, beta};
}

// Refinement: all exits of a grid of kappa, then a grid between the neighbours of the smallest, six rounds
// in all.
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
      // Of equal exits the largest kappa, which names the stiffest of the modes.
      if (h[i] <= h[least]) least = i;
    // A round that finds nothing smaller ends the search.
    if (!(h[least] < limit.h_max) && round > 0) break;
    limit.h_max = h[least];
    limit.kappa = kappas[least];
    // The next round lies between the two neighbours of the smallest: each narrows the interval at least by
    // about half the number of samples.
    low = kappas[least > 0 ? least - 1 : 0];
    high = kappas[std::min(least + 1, kappas.size() - 1)];
    // An end is what it is.
    if (!std::isfinite(limit.h_max) || limit.h_max == 0) break;
  }
  limit.between = limit.kappa > curve.kappa_min * (1 + 1e-9) && limit.kappa < curve.kappa_max * (1 - 1e-9);
  return limit;
}

}  // namespace hmax
