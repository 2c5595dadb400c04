#include "analysis/dynamics/poincare.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <deque>
#include <limits>
#include <list>
#include <numeric>
#include <optional>
#include <span>
#include <stdexcept>
#include <utility>

#include "core/numbers.hpp"
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
std::optional<int> period_of(const std::vector<VectorXd>& looks, double tolerance, double rest) {
  if (looks.empty()) return std::nullopt;
  VectorXd size = VectorXd::Zero(looks[0].size());
  for (const VectorXd& y : looks) size = size.cwiseMax(y.cwiseAbs());
  const double allowed = tolerance * size.maxCoeff() + rest;  // what dies out has come to rest
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

constexpr double separation = 1e-6, weak_exponent = 50;  // the latter in units of the absolute error
constexpr double some_ulps = 256 * std::numeric_limits<double>::epsilon();
constexpr int turning = 20;  // until the separation points where neighbours part fastest

/// The exponent of a motion. Whoever looks for it replaces both states by their images and calls go_on(), as
/// long as there is none.
// A finite separation of 1e-6 stands for the tangent vector: terms of second order change the growth by the
// order of 1e-6.
class ExponentSearch {
 public:
  ExponentSearch(const VectorXd& y, VectorXd scale, const ExponentLimits& limits)
      : scale_(std::move(scale)), limits_(limits), next_(std::max(limits.least, batches)) {
    states = {y, y + first_apart()};
  }

  std::array<VectorXd, 2> states;  ///< the motion, and a neighbour

  std::optional<Exponent> go_on() {
    auto& [y, beside] = states;
    // The separation after one application, that before had the size `separation`.
    VectorXd apart = beside - y;
    const double growth = apart.cwiseQuotient(scale_).norm() / separation;
    const double lost = std::max(some_ulps * y.cwiseQuotient(scale_).norm() / separation, 1e-100);
    const bool met = growth <= lost;
    if (++applications_ > turning) {
      grown_.push_back(std::log(met ? lost : growth));
      at_most_ = at_most_ || met;
    }
    const int count = std::max(applications_ - turning, 0);
    if (!std::isfinite(growth)) return Exponent{std::nan(""), std::nan(""), count, y};
    beside = y + (met ? first_apart() : apart / growth);
    return count < next_ ? std::nullopt : judged(count);
  }

 private:
  /// In any direction but an invariant one.
  [[nodiscard]] VectorXd first_apart() const {
    const VectorXd apart = VectorXd::LinSpaced(scale_.size(), 1, 1.7).cwiseProduct(scale_);
    return apart * (separation / apart.cwiseQuotient(scale_).norm());
  }

  /// The exponent if it is known well enough, else the count at which it is looked at again.
  std::optional<Exponent> judged(int count) {
    auto [value, error] = mean_of(grown_);
    if (before_) error = std::max(error, std::abs(value - *before_));
    const bool known = error <= std::max(limits_.relative * std::abs(value), limits_.absolute);
    const bool weak = std::abs(value) < weak_exponent * limits_.absolute;
    if (count >= limits_.most || (known && (!weak || before_)))
      return Exponent{value, error, count, states[0], at_most_};
    // A weak exponent is looked at again after twice as many applications, else the error after a quarter
    // more.
    before_ = known ? std::optional(value) : std::nullopt;
    next_ = std::min(limits_.most, known ? 2 * count : count + count / 4);
    return std::nullopt;
  }

  VectorXd scale_;
  ExponentLimits limits_;
  int next_, applications_ = 0;
  bool at_most_ = false;
  std::vector<double> grown_;
  std::optional<double> before_;  ///< the mean over half as many applications, of a weak exponent
};

}  // namespace

Exponent largest_lyapunov(const VectorFunction& map, const VectorXd& y, const VectorXd& scale,
                          const ExponentLimits& limits) {
  ExponentSearch search(y, scale, limits);
  for (;;) {
    for (VectorXd& state : search.states) state = map(state);
    if (const std::optional<Exponent> exponent = search.go_on()) return *exponent;
  }
}

std::string_view name_of(Settling settling) {
  constexpr std::array<std::string_view, 4> names{"periodic", "chaotic", "not_settled", "diverges"};
  return names[static_cast<std::size_t>(settling)];
}

namespace {

/// The verdict on a motion, as settle() describes it. Whoever follows the motion replaces the states by their
/// images and calls go_on(), until it has ended.
class MotionJudge {
 public:
  /// From the start of a motion.
  MotionJudge(VectorXd y0, int skip, int count, const ExponentLimits& limits, const Resolution& seen)
      : count_(count), wanted_(count), skip_(skip), limits_(limits), resolution_(seen), y_(std::move(y0)) {
    see();
  }
  /// From its first looks.
  MotionJudge(std::vector<VectorXd> looks, int count, const ExponentLimits& limits, const Resolution& seen)
      : count_(count), wanted_(count), limits_(limits), resolution_(seen), last_(std::move(looks)) {
    judge_looks();
  }

  [[nodiscard]] bool has_ended() const { return ended_; }
  /// The motion, while its exponent is computed with a neighbour.
  std::span<VectorXd> states() { return search_ ? std::span<VectorXd>(search_->states) : std::span(&y_, 1); }
  Settled& verdict() { return motion_; }

  void go_on() {
    if (search_) {
      motion_.exponent = search_->go_on();
      if (!motion_.exponent) return;
      motion_.followed += motion_.exponent->count;
      search_.reset();
      follow(motion_.exponent->end);
    }
    see();
  }

 private:
  static constexpr int block = 256, patience = 3000;

  /// Takes the state as a look; `wanted_` of them are judged.
  void see() {
    const bool finite = y_.allFinite();
    if (finite && skip_ > 0) {
      --skip_;
      return;
    }
    if (finite) last_.push_back(y_);
    if (!finite || static_cast<int>(last_.size()) >= wanted_) judge_looks();
  }

  /// Another block of looks, from y on.
  void follow(VectorXd y) {
    y_ = std::move(y);
    last_.clear();
    wanted_ = block;
    motion_.followed += block;
  }

  void judge_looks() {
    const bool whole = !last_.empty() && static_cast<int>(last_.size()) >= wanted_;
    motion_.period = whole ? period_of(last_, 1e-6, resolution_.rest) : std::nullopt;
    ended_ = !whole || motion_.period || motion_.exponent;
    if (!whole) return end(Settling::diverges, wanted_);
    if (motion_.period) return end(Settling::periodic, std::max(count_, *motion_.period));
    if (motion_.exponent) {
      motion_.settling = motion_.exponent->positive() ? Settling::chaotic : Settling::unsettled;
      return;
    }
    end(Settling::unsettled, count_);  // so far
    if (size_.size() == 0) size_ = size_of(last_);
    if (motion_.followed < patience)
      follow(last_.back());
    else
      search_.emplace(last_.back(), size_, limits_);
  }

  /// Keeps the last looks.
  void end(Settling settling, int kept) {
    motion_.settling = settling;
    motion_.looks.assign(last_.end() - std::min<std::ptrdiff_t>(kept, std::ssize(last_)), last_.end());
  }

  /// The largest of each component; those that hardly move are measured by the largest of all. A millionth of
  /// it is no less than ten errors of the map.
  [[nodiscard]] VectorXd size_of(const std::vector<VectorXd>& looks) const {
    const double least = std::max(10 / separation * resolution_.error, resolution_.rest);
    VectorXd size = VectorXd::Constant(looks[0].size(), least);
    for (const VectorXd& y : looks) size = size.cwiseMax(y.cwiseAbs());
    return size.cwiseMax(1e-3 * size.maxCoeff());
  }

  int count_, wanted_, skip_ = 0;
  ExponentLimits limits_;
  Resolution resolution_;
  VectorXd y_, size_;
  std::vector<VectorXd> last_;  ///< looks that have not been judged
  std::optional<ExponentSearch> search_;
  Settled motion_{.settling = Settling::diverges};
  bool ended_ = false;
};

}  // namespace

Settled settle(const VectorFunction& map, std::vector<VectorXd> looks, int count,
               const ExponentLimits& limits, const Resolution& seen) {
  MotionJudge judge(std::move(looks), count, limits, seen);
  while (!judge.has_ended()) {
    for (VectorXd& y : judge.states()) y = map(y);
    judge.go_on();
  }
  return std::move(judge.verdict());
}

MapEnsemble one_by_one(std::function<VectorFunction(std::size_t map)> map_at) {
  return [map_at = std::move(map_at)](const MapCalls& calls) {
    VectorFunction map;
    std::optional<std::size_t> number;
    while (const auto call = calls.next()) {
      if (number != call->map) map = map_at(call->map);
      number = call->map;
      *call->state = map(*call->state);
      calls.done(*call);
    }
  };
}

namespace {

/// The motions of all values, by several threads.
class Diagram {
 public:
  Diagram(std::size_t values, VectorXd y0, int skip, int count, bool follow,
          const std::function<bool(double)>& going, const Resolution& seen)
      : motions_(values),
        start_(std::move(y0)),
        skip_(skip),
        count_(count),
        follow_(follow),
        going_(going),
        resolution_(seen) {
    tell();
  }

  /// Begins a motion whenever no state waits, until there is none left. The exponent is computed to 30 % of
  /// itself: only its sign is used.
  /// @param tells  whether the thread is the one that asks `going`
  void work(const MapEnsemble& ensemble, bool tells) {
    std::list<Motion> open;
    std::deque<MapCall> waiting;
    std::size_t asked = 0;
    const auto wait = [&](Motion& motion) {
      for (VectorXd& y : motion.judge.states()) waiting.push_back({motion.value, &y, &motion});
      motion.images = motion.judge.states().size();
    };
    const auto next = [&]() -> std::optional<MapCall> {
      if (tells && ++asked % 1024 == 0) tell();
      if (ended_) return std::nullopt;
      if (waiting.empty()) {
        if (follow_ && !open.empty()) return std::nullopt;
        const std::size_t value = next_++;
        if (value >= motions_.size()) return std::nullopt;
        wait(open.emplace_back(
            Motion{value, MotionJudge(start_, skip_, count_, {.relative = 0.3}, resolution_)}));
      }
      const MapCall call = waiting.front();
      waiting.pop_front();
      return call;
    };
    const auto done = [&](const MapCall& call) {
      Motion& motion = *static_cast<Motion*>(call.motion);
      if (--motion.images > 0) return;
      motion.judge.go_on();
      if (!motion.judge.has_ended()) return wait(motion);
      take(motion);
      open.remove_if([&](const Motion& each) { return &each == &motion; });
      if (tells) tell();
    };
    try {
      ensemble({next, done});
    } catch (...) {
      ended_ = true;  // for all threads
      throw;
    }
  }

  /// The columns up to the first that is missing.
  std::vector<BifurcationColumn> columns(const std::vector<double>& values) && {
    std::vector<BifurcationColumn> columns;
    for (std::size_t i = 0; i < values.size() && motions_[i]; ++i)
      columns.push_back({values[i], std::move(*motions_[i])});
    return columns;
  }

 private:
  struct Motion {
    std::size_t value;
    MotionJudge judge;
    std::size_t images = 0;  ///< that it waits for
  };

  void take(Motion& motion) {
    Settled& verdict = motion.judge.verdict();
    if (follow_ && verdict.settling != Settling::diverges) start_ = verdict.looks.back();
    motions_[motion.value] = std::move(verdict);
    ++done_;
  }

  void tell() {
    if (going_ && !going_(static_cast<double>(done_) / static_cast<double>(motions_.size()))) ended_ = true;
  }

  std::vector<std::optional<Settled>> motions_;
  VectorXd start_;  ///< of the next motion
  int skip_, count_;
  bool follow_;
  const std::function<bool(double)>& going_;
  Resolution resolution_;
  std::atomic<std::size_t> next_ = 0, done_ = 0;  ///< values that are begun, and done
  std::atomic<bool> ended_ = false;
};

}  // namespace

std::vector<BifurcationColumn> bifurcation(const MapEnsemble& ensemble, const std::vector<double>& values,
                                           const VectorXd& y0, int skip, int count, bool follow,
                                           const std::function<bool(double)>& going, const Resolution& seen) {
  if (skip < 0 || count < 1)
    throw std::invalid_argument("a diagram skips no negative number of periods, and looks at one at least");
  Diagram diagram(values.size(), y0, skip, count, follow, going, seen);
  parallel_for(follow ? 1 : std::min(jobs(), values.size()),
               [&](std::size_t, std::size_t worker) { diagram.work(ensemble, worker == 0); });
  return std::move(diagram).columns(values);
}

}  // namespace hmax
