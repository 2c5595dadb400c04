/// Applications of maps that several computations wait for at once, so that many can be made side by side.
#pragma once

#include <array>
#include <coroutine>
#include <cstddef>
#include <deque>
#include <exception>
#include <functional>
#include <optional>
#include <span>
#include <utility>

#include <Eigen/Core>

#include "analysis/dynamics/differences.hpp"

namespace hmax {

/// A map that is to be applied to a state.
struct MapCall {
  std::size_t map;               ///< its number
  Eigen::VectorXd* y;            ///< the state, which its image replaces; not finite where there is none
  std::size_t* open;             ///< of how many calls the computation waits
  std::coroutine_handle<> task;  ///< the computation, which goes on when there are none
};

/// The calls of one thread.
/// Computations are coroutines that return a MapTask: they co_await images of OneMap, and go on when done()
/// has been told of them.
class MapCalls {
 public:
  MapCalls() = default;
  /// @param begin  starts one more computation when no call waits; false when there are no more
  /// @param ended  when it says so no further calls are made
  explicit MapCalls(std::function<bool()> begin, std::function<bool()> ended)
      : begin_(std::move(begin)), ended_(std::move(ended)) {}

  /// A call to be made; nothing while all computations wait for calls that are under way, or have ended.
  std::optional<MapCall> next() {
    if (ended_ && ended_()) return std::nullopt;
    while (waiting_.empty())
      if (!begin_ || !begin_()) return std::nullopt;
    const MapCall call = waiting_.front();
    waiting_.pop_front();
    return call;
  }

  /// The state of the call has been replaced by its image.
  void done(const MapCall& call) {
    if (--*call.open == 0) call.task.resume();
  }

  /// All of them or, where there is no memory, none.
  void add(std::span<const MapCall> calls) { waiting_.insert(waiting_.end(), calls.begin(), calls.end()); }

 private:
  std::function<bool()> begin_, ended_;
  std::deque<MapCall> waiting_;
};

/// Makes the calls until next() has none and all are done. One such function is called by one thread at a
/// time.
using MapEnsemble = std::function<void(MapCalls& calls)>;

/// One call after the other, each of which makes the image of a state.
/// @param map_at  makes a map of its number; called again where another map has been applied in between
inline MapEnsemble one_by_one(std::function<VectorFunction(std::size_t map)> map_at) {
  return [map_at = std::move(map_at)](MapCalls& calls) {
    VectorFunction map;
    std::optional<std::size_t> number;
    while (const auto call = calls.next()) {
      if (number != call->map) map = map_at(call->map);
      number = call->map;
      *call->y = map(*call->y);
      calls.done(*call);
    }
  };
}

/// A map whose images a computation waits for.
class OneMap {
 public:
  /// @param number  of the map; @param calls  have to outlive it
  OneMap(MapCalls& calls, std::size_t number) : calls_(&calls), number_(number) {}

  template <std::size_t N>
  struct Images {
    MapCalls* calls;
    std::size_t number;
    std::array<Eigen::VectorXd, N> states;
    std::size_t open = N;

    [[nodiscard]] bool await_ready() const { return false; }
    void await_suspend(std::coroutine_handle<> task) {
      std::array<MapCall, N> made;
      for (std::size_t i = 0; i < N; ++i) made[i] = {number, &states[i], &open, task};
      calls->add(made);
    }
    auto await_resume() {
      if constexpr (N == 1)
        return std::move(states[0]);
      else
        return std::move(states);
    }
  };

  /// co_await map(y) is the image of y.
  Images<1> operator()(Eigen::VectorXd y) const { return {calls_, number_, {std::move(y)}}; }
  /// co_await map(a, b) are both images, which do not wait for each other.
  Images<2> operator()(Eigen::VectorXd a, Eigen::VectorXd b) const {
    return {calls_, number_, {std::move(a), std::move(b)}};
  }

 private:
  MapCalls* calls_;
  std::size_t number_;
};

/// A computation that waits for images of maps, itself or through others that it co_awaits.
/// @tparam T  its result
template <class T>
class [[nodiscard]] MapTask {
 public:
  struct promise_type {
    std::optional<T> value;
    std::exception_ptr error;
    std::coroutine_handle<> caller = std::noop_coroutine();

    /// Goes back to whoever waits for it.
    struct Return {
      [[nodiscard]] bool await_ready() const noexcept { return false; }
      std::coroutine_handle<> await_suspend(std::coroutine_handle<promise_type> task) const noexcept {
        return task.promise().caller;
      }
      void await_resume() const noexcept {}
    };

    MapTask get_return_object() { return MapTask(std::coroutine_handle<promise_type>::from_promise(*this)); }
    std::suspend_always initial_suspend() noexcept { return {}; }
    Return final_suspend() noexcept { return {}; }
    void return_value(T result) { value = std::move(result); }
    void unhandled_exception() { error = std::current_exception(); }
  };

  MapTask(MapTask&& other) noexcept : task_(std::exchange(other.task_, nullptr)) {}
  MapTask& operator=(MapTask&& other) noexcept {
    std::swap(task_, other.task_);
    return *this;
  }
  MapTask(const MapTask&) = delete;
  MapTask& operator=(const MapTask&) = delete;
  ~MapTask() {
    if (task_) task_.destroy();
  }

  /// Up to the first image that it waits for.
  void start() { task_.resume(); }
  [[nodiscard]] bool has_ended() const { return task_.done(); }
  /// Of a computation that has ended. @throws what it has thrown
  T result() {
    auto& promise = task_.promise();
    if (promise.error) std::rethrow_exception(promise.error);
    return std::move(*promise.value);
  }

  [[nodiscard]] bool await_ready() const { return false; }
  std::coroutine_handle<> await_suspend(std::coroutine_handle<> caller) {
    task_.promise().caller = caller;
    return task_;
  }
  T await_resume() { return result(); }

 private:
  explicit MapTask(std::coroutine_handle<promise_type> task) : task_(task) {}
  std::coroutine_handle<promise_type> task_;
};

}  // namespace hmax
