#include "analysis/dynamics/poincare.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <stdexcept>

#include "core/parallel_for.hpp"

namespace hmax {

using Eigen::VectorXd;

namespace {

// 15 degrees of freedom for Student's distribution.
constexpr int batches = 16;

/// A mean, and at least the half width of its interval of 95 %.
struct Mean {
  double value, error;
};

/// The mean of a series whose neighbours depend on one another, see largest_lyapunov.
/// Standard error of the mean of 16 batch means times Student's 2.131, against the drift between the
/// halves and the other bounds.
/// @param series  at least 16 numbers
Mean mean_of(const std::vector<double>& series) {
  constexpr double unresolved = 3e-3;  // see largest_lyapunov
  constexpr double student = 2.131;    // 95 % at 15 degrees of freedom
  const auto length = series.size() / batches;
  // The remainder of the division is dropped at the beginning.
  const auto first = series.end() - static_cast<std::ptrdiff_t>(batches * length);
  std::array<double, batches> means;
  for (std::size_t k = 0; k < batches; ++k) {
    const auto begin = first + static_cast<std::ptrdiff_t>(k * length);
    means[k] = std::accumulate(begin, begin + static_cast<std::ptrdiff_t>(length), 0.0) / double(length);
  }
  const double early = std::accumulate(means.begin(), means.begin() + batches / 2, 0.0) * 2 / batches;
  const double late = std::accumulate(means.begin() + batches / 2, means.end(), 0.0) * 2 / batches;
  const double mean = (early + late) / 2;
  double square = 0;
  for (const double value : means) square += (value - mean) * (value - mean);
  const double n = batches * double(length);
  // s / sqrt(16), s^2 = sum (m_k - m)^2 / 15.
  return {mean, std::max({student * std::sqrt(square / (batches * (batches - 1))), std::abs(late - early),
                          2 * std::log(n) / n, unresolved})};
}

}  // namespace

// The start itself is the first look where skip = 0.
std::vector<VectorXd> looks(const VectorFunction& map, VectorXd y, int skip, int count) {
  if (skip < 0 || count < 0) throw std::invalid_argument("the looks at a motion cannot be fewer than none");
  std::vector<VectorXd> seen;
  for (int i = 0; i < skip + count && y.allFinite(); ++i) {
    if (i >= skip) seen.push_back(y);
    y = map(y);
  }
  return seen;
}

// All pairs of looks p apart must agree, so the whole stretch is periodic, not only its end.
std::optional<int> period_of(const std::vector<VectorXd>& looks, double tolerance) {
  if (looks.empty()) return std::nullopt;
  VectorXd size = VectorXd::Zero(looks[0].size());
  for (const VectorXd& y : looks) size = size.cwiseMax(y.cwiseAbs());
  const double allowed = tolerance * size.maxCoeff() + 1e-12;  // what dies out has come to rest
  // max over i of |y_(i+p) - y_i| in the max norm.
  const auto repeats = [&](std::size_t p, double within) {
    for (std::size_t i = 0; i + p < looks.size(); ++i)
      if (!((looks[i + p] - looks[i]).cwiseAbs().maxCoeff() <= within)) return false;
    return true;
  };
  for (std::size_t p = 1; 4 * p <= looks.size(); ++p) {
    // The least p first, so multiples of a period are never reported.
    if (!repeats(p, allowed)) continue;
    constexpr double hardly = 100;
    for (std::size_t q = 1; q < p; ++q)
      if (p % q == 0 && repeats(q, hardly * allowed)) return std::nullopt;
    return static_cast<int>(p);
  }
  return std::nullopt;
}

// A finite separation of 1e-6 stands for the tangent vector: terms of second order change the growth by the
// order of 1e-6.
Exponent largest_lyapunov(const VectorFunction& map, VectorXd y, const VectorXd& scale,
                          const ExponentLimits& limits) {
  constexpr double separation = 1e-6, infinity = std::numeric_limits<double>::infinity();
  constexpr int turning = 20;  // until the separation points where neighbours part fastest
  // Any direction but an invariant one.
  VectorXd apart = VectorXd::LinSpaced(y.size(), 1, 1.7).cwiseProduct(scale);
  apart *= separation / apart.cwiseQuotient(scale).norm();
  std::vector<double> grown;
  for (int next = std::max(limits.least, batches), i = -turning;; ++i) {
    const VectorXd there = map(y);
    // The separation after one application, |apart| = separation before.
    apart = map(y + apart) - there;
    const double growth = apart.cwiseQuotient(scale).norm() / separation;
    const int count = std::max(i + 1, 0);
    y = there;
    if (!std::isfinite(growth)) return {std::nan(""), std::nan(""), count, y};
    // Both orbits met: the separation is lost to rounding.
    if (growth == 0) return {-infinity, 0, count, y};
    apart /= growth;
    if (i >= 0) grown.push_back(std::log(growth));
    if (count < next) continue;
    const auto [value, error] = mean_of(grown);
    if (count >= limits.most || error <= std::max(limits.relative * std::abs(value), limits.absolute))
      return {value, error, count, y};
    // The error is looked at again after a quarter more.
    next = std::min(limits.most, count + count / 4);
  }
}

std::string_view name_of(Settling settling) {
  switch (settling) {
    case Settling::periodic:
      return "periodic";
    case Settling::chaotic:
      return "chaotic";
    case Settling::unsettled:
      return "not_settled";
    case Settling::diverges:
      break;
  }
  return "diverges";
}

Settled settle(const VectorFunction& map, std::vector<VectorXd> seen, int count,
               const ExponentLimits& limits) {
  constexpr int block = 256, patience = 3000;
  Settled motion{.settling = Settling::diverges, .looks = std::move(seen)};
  // Whether the last looks repeat, or there are none any more.
  const auto ended = [&](const std::vector<VectorXd>& last, int expected) {
    if (static_cast<int>(last.size()) < expected) {
      motion.looks = last;
      return true;
    }
    motion.period = period_of(last);
    if (!motion.period) return false;
    motion.settling = Settling::periodic;
    motion.looks.assign(last.end() - std::min(std::max(count, *motion.period), expected), last.end());
    return true;
  };
  if (ended(motion.looks, count) || motion.looks.empty()) return motion;
  VectorXd size = VectorXd::Constant(motion.looks[0].size(), 1e-12);
  for (const VectorXd& y : motion.looks) size = size.cwiseMax(y.cwiseAbs());
  // Components that hardly move are measured by the largest.
  size = size.cwiseMax(1e-3 * size.maxCoeff());
  while (motion.followed < patience) {
    // The next 256 looks behind those that are known.
    const auto last = looks(map, map(motion.looks.back()), 0, block);
    motion.followed += block;
    if (ended(last, block)) return motion;
    motion.looks.assign(last.end() - std::min(count, block), last.end());
  }
  motion.exponent = largest_lyapunov(map, motion.looks.back(), size, limits);
  motion.followed += motion.exponent->count + block;
  if (ended(looks(map, motion.exponent->end, 0, block), block)) return motion;
  motion.settling = motion.exponent->positive() ? Settling::chaotic : Settling::unsettled;
  return motion;
}

// The exponent is computed to 30 % of itself: only its sign is used.
std::vector<BifurcationColumn> bifurcation(const std::function<VectorFunction(double)>& map_at,
                                           const std::vector<double>& values, const VectorXd& y0, int skip,
                                           int count, bool follow, const std::function<bool(double)>& going) {
  const ExponentLimits sign_alone{.relative = 0.3};
  const auto motion_at = [&](double value, const VectorXd& start) {
    const VectorFunction map = map_at(value);
    return settle(map, looks(map, start, skip, count), count, sign_alone);
  };
  const auto share = [&](std::size_t done) {
    return static_cast<double>(done) / static_cast<double>(values.size());
  };
  std::vector<BifurcationColumn> columns;
  if (follow) {
    VectorXd start = y0;
    for (const double value : values) {
      if (going && !going(share(columns.size()))) break;
      Settled motion = motion_at(value, start);
      if (motion.settling != Settling::diverges && !motion.looks.empty()) start = motion.looks.back();
      columns.push_back({value, std::move(motion)});
    }
    return columns;
  }
  std::vector<std::optional<Settled>> motions(values.size());
  std::atomic<bool> ended = going && !going(0);
  parallel_for(
      values.size(), [&](std::size_t i, std::size_t) { motions[i] = motion_at(values[i], y0); },
      [&](std::size_t done) { ended = ended || (going && !going(share(done))); },
      [&] { return ended.load(); });
  for (std::size_t i = 0; i < values.size() && motions[i]; ++i)
    columns.push_back({values[i], std::move(*motions[i])});
  return columns;
}

}  // namespace hmax
