#include "analysis/dynamics/poincare.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <variant>

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

namespace {

/// The computation alone, with the only map.
/// @param make  makes it of the map
template <class Make>
auto alone(const VectorFunction& map, const Make& make) {
  MapCalls calls;
  auto task = make(OneMap(calls, 0));
  task.start();
  one_by_one([&](std::size_t) { return VectorFunction(std::cref(map)); })(calls);
  return task.result();
}

// The start itself is the first look where skip = 0.
MapTask<std::vector<VectorXd>> look(OneMap map, VectorXd y, int skip, int count) {
  if (skip < 0 || count < 0) throw std::invalid_argument("the looks at a motion cannot be fewer than none");
  std::vector<VectorXd> seen;
  for (int i = 0; i < skip + count && y.allFinite(); ++i) {
    if (i >= skip) seen.push_back(y);
    y = co_await map(std::move(y));
  }
  co_return seen;
}

}  // namespace

std::vector<VectorXd> looks(const VectorFunction& map, VectorXd y, int skip, int count) {
  return alone(map, [&](OneMap one) { return look(one, std::move(y), skip, count); });
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

namespace {

// A finite separation of 1e-6 stands for the tangent vector: terms of second order change the growth by the
// order of 1e-6.
MapTask<Exponent> lyapunov(OneMap map, VectorXd y, VectorXd scale, ExponentLimits limits) {
  constexpr double separation = 1e-6, infinity = std::numeric_limits<double>::infinity();
  constexpr double weak_exponent = 50;  // in units of the absolute error
  constexpr int turning = 20;           // until the separation points where neighbours part fastest
  // Any direction but an invariant one.
  VectorXd apart = VectorXd::LinSpaced(y.size(), 1, 1.7).cwiseProduct(scale);
  apart *= separation / apart.cwiseQuotient(scale).norm();
  std::vector<double> grown;
  std::optional<double> before;  // the mean over half as many applications, of a weak exponent
  for (int next = std::max(limits.least, batches), i = -turning;; ++i) {
    auto [there, beside] = co_await map(y, y + apart);
    // The separation after one application, |apart| = separation before.
    apart = beside - there;
    const double growth = apart.cwiseQuotient(scale).norm() / separation;
    const int count = std::max(i + 1, 0);
    y = std::move(there);
    if (!std::isfinite(growth)) co_return Exponent{std::nan(""), std::nan(""), count, y};
    // Both orbits met: the separation is lost to rounding.
    if (growth == 0) co_return Exponent{-infinity, 0, count, y};
    apart /= growth;
    if (i >= 0) grown.push_back(std::log(growth));
    if (count < next) continue;
    auto [value, error] = mean_of(grown);
    if (before) error = std::max(error, std::abs(value - *before));
    const bool known = error <= std::max(limits.relative * std::abs(value), limits.absolute);
    const bool weak = std::abs(value) < weak_exponent * limits.absolute;
    if (count >= limits.most || (known && (!weak || before))) co_return Exponent{value, error, count, y};
    // A weak exponent is looked at again after twice as many applications, else the error after a quarter
    // more.
    before = known ? std::optional(value) : std::nullopt;
    next = std::min(limits.most, known ? 2 * count : count + count / 4);
  }
}

}  // namespace

Exponent largest_lyapunov(const VectorFunction& map, VectorXd y, const VectorXd& scale,
                          const ExponentLimits& limits) {
  return alone(map, [&](OneMap one) { return lyapunov(one, std::move(y), scale, limits); });
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

namespace {

MapTask<Settled> settled(OneMap map, std::vector<VectorXd> seen, int count, ExponentLimits limits) {
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
  if (ended(motion.looks, count) || motion.looks.empty()) co_return motion;
  VectorXd size = VectorXd::Constant(motion.looks[0].size(), 1e-12);
  for (const VectorXd& y : motion.looks) size = size.cwiseMax(y.cwiseAbs());
  // Components that hardly move are measured by the largest.
  size = size.cwiseMax(1e-3 * size.maxCoeff());
  while (motion.followed < patience) {
    // The next 256 looks behind those that are known.
    VectorXd next = co_await map(motion.looks.back());
    const auto last = co_await look(map, std::move(next), 0, block);
    motion.followed += block;
    if (ended(last, block)) co_return motion;
    motion.looks.assign(last.end() - std::min(count, block), last.end());
  }
  const Exponent exponent = co_await lyapunov(map, motion.looks.back(), size, limits);
  motion.exponent = exponent;
  motion.followed += exponent.count + block;
  const auto last = co_await look(map, exponent.end, 0, block);
  if (ended(last, block)) co_return motion;
  motion.settling = exponent.positive() ? Settling::chaotic : Settling::unsettled;
  co_return motion;
}

}  // namespace

Settled settle(const VectorFunction& map, std::vector<VectorXd> seen, int count,
               const ExponentLimits& limits) {
  return alone(map, [&](OneMap one) { return settled(one, std::move(seen), count, limits); });
}

namespace {

/// The motions of all values, by computations of several threads.
class Diagram {
 public:
  Diagram(std::size_t values, VectorXd y0, int skip, int count, const std::function<bool(double)>& going)
      : motions_(values), y0_(std::move(y0)), skip_(skip), count_(count), going_(going) {
    tell(0);
  }

  /// Takes one value after the other, each with a computation of its own.
  /// @param tells  whether the thread is the one that asks `going`
  void work(const MapEnsemble& ensemble, bool tells) {
    std::vector<MapTask<std::monostate>> tasks;
    MapCalls calls(
        [&] {
          const std::size_t value = next_++;
          if (value >= motions_.size()) return false;
          tasks.push_back(at(OneMap(calls, value), value, tells));
          tasks.back().start();
          return true;
        },
        // Motions may take many images: the thread that tells asks in between, too.
        [&, asked = std::size_t{0}]() mutable {
          if (tells && ++asked % 1024 == 0) tell(done_);
          return ended_.load();
        });
    try {
      ensemble(calls);
    } catch (...) {
      ended_ = true;
      throw;
    }
    for (auto& task : tasks)
      if (task.has_ended()) task.result();
  }

  /// Takes all values in their order in one computation.
  void follow(const MapEnsemble& ensemble) {
    MapCalls calls({}, [&] { return ended_.load(); });
    auto task = along_branch(calls);
    task.start();
    ensemble(calls);
    if (task.has_ended()) task.result();
  }

  /// The columns up to the first that is missing.
  std::vector<BifurcationColumn> columns(const std::vector<double>& values) && {
    std::vector<BifurcationColumn> columns;
    for (std::size_t i = 0; i < values.size() && motions_[i]; ++i)
      columns.push_back({values[i], std::move(*motions_[i])});
    return columns;
  }

 private:
  void tell(std::size_t done) {
    if (going_ && !going_(static_cast<double>(done) / static_cast<double>(motions_.size()))) ended_ = true;
  }

  /// The motion at one value. The exponent is computed to 30 % of itself: only its sign is used.
  MapTask<Settled> motion_from(OneMap map, VectorXd start) {
    auto first = co_await look(map, std::move(start), skip_, count_);
    Settled motion = co_await settled(map, std::move(first), count_, {.relative = 0.3});
    co_return motion;
  }

  MapTask<std::monostate> at(OneMap map, std::size_t value, bool tells) {
    try {
      motions_[value] = co_await motion_from(map, y0_);
    } catch (...) {
      ended_ = true;  // for all threads
      throw;
    }
    const std::size_t done = ++done_;
    if (tells) tell(done);
    co_return std::monostate{};
  }

  MapTask<std::monostate> along_branch(MapCalls& calls) {
    VectorXd start = y0_;
    for (std::size_t value = 0; value < motions_.size() && !ended_; ++value) {
      Settled motion = co_await motion_from(OneMap(calls, value), start);
      if (motion.settling != Settling::diverges && !motion.looks.empty()) start = motion.looks.back();
      motions_[value] = std::move(motion);
      tell(value + 1);
    }
    co_return std::monostate{};
  }

  std::vector<std::optional<Settled>> motions_;
  VectorXd y0_;
  int skip_, count_;
  const std::function<bool(double)>& going_;
  std::atomic<std::size_t> next_ = 0, done_ = 0;  ///< values that are begun, and done
  std::atomic<bool> ended_ = false;
};

}  // namespace

std::vector<BifurcationColumn> bifurcation(const std::vector<MapEnsemble>& ensembles,
                                           const std::vector<double>& values, const VectorXd& y0, int skip,
                                           int count, bool follow, const std::function<bool(double)>& going) {
  Diagram diagram(values.size(), y0, skip, count, going);
  if (follow)
    diagram.follow(ensembles.front());
  else
    parallel_for(std::min(ensembles.size(), values.size()),
                 [&](std::size_t i, std::size_t worker) { diagram.work(ensembles[i], worker == 0); });
  return std::move(diagram).columns(values);
}

std::vector<BifurcationColumn> bifurcation(const std::function<VectorFunction(double)>& map_at,
                                           const std::vector<double>& values, const VectorXd& y0, int skip,
                                           int count, bool follow, const std::function<bool(double)>& going) {
  const std::vector<MapEnsemble> ensembles(
      std::max<std::size_t>(1, jobs()), one_by_one([&](std::size_t value) { return map_at(values[value]); }));
  return bifurcation(ensembles, values, y0, skip, count, follow, going);
}

}  // namespace hmax
