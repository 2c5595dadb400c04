/// How Python calls hmax: locks, signals, errors, and answers as Python objects.
#pragma once

#include <atomic>
#include <functional>
#include <future>
#include <memory>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include "core/parallel_for.hpp"

namespace hmax::python {

namespace py = pybind11;

/// Set once the caller of a task has been interrupted.
using Stop = std::atomic<bool>;

/// What a task throws when it sees that it was stopped. Nobody waits for it any more.
struct Stopped {};

/// Throws Stopped once `stop` is set.
inline void leave_if(const Stop& stop) {
  if (stop) throw Stopped{};
}

namespace detail {
/// Starts `task` on a thread of its own. The end of the process waits for no thread.
void start(std::function<void()> task);
/// Waits without the GIL until `is_ready`, which waits a moment itself.
/// @throws py::error_already_set  KeyboardInterrupt, or what another handler of a signal raises; `stop` is
/// set then
void wait(const std::function<bool()>& is_ready, Stop& stop);
}  // namespace detail

/// The result of work(stop), which runs on another thread while this one waits for it and for signals. For
/// what calls no Python. Work that was interrupted and does not look at `stop` goes on by itself: it must own
/// what it reads.
/// @throws what `work` throws, and as detail::wait()
template <class Work>
auto in_background(Work work) {
  using Result = std::invoke_result_t<Work&, const Stop&>;
  const auto stop = std::make_shared<Stop>(false);
  const auto task = std::make_shared<std::packaged_task<Result()>>(
      [work = std::move(work), stop]() mutable { return work(static_cast<const Stop&>(*stop)); });
  std::future<Result> result = task->get_future();
  detail::start([task] { (*task)(); });
  detail::wait([&] { return result.wait_for(std::chrono::milliseconds(50)) == std::future_status::ready; },
               *stop);
  return result.get();
}

/// The result of work() on this thread, without the GIL. For what calls Python back: all calls come from this
/// thread.
template <class Work>
auto with_callbacks(const Work& work) {
  const OneThread alone;
  const py::gil_scoped_release release;
  return work();
}

/// The result of a call of Python from such work.
/// @throws py::error_already_set  what Python raises, and KeyboardInterrupt
template <class Call>
auto call_back(const Call& call) {
  const py::gil_scoped_acquire acquire;
  if (PyErr_CheckSignals() != 0) throw py::error_already_set();
  return call();
}

/// A document with lists and dicts for arrays and objects, None for null, and infinity for "unbounded".
py::object to_python(const nlohmann::ordered_json& document);

/// A copy, shape (n).
py::array_t<double> to_array(const Eigen::VectorXd& values);

/// The real numbers of an array of one dimension, or of a sequence.
/// @param what  that was given, for errors
/// @param size  that it must have; negative: any
/// @throws std::invalid_argument  for what is no such array, and for another size
Eigen::VectorXd vector_from(const py::handle& given, std::string_view what, Eigen::Index size = -1);

}  // namespace hmax::python
