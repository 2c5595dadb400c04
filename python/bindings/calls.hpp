/// How Python calls hmax: locks, signals, errors, and answers as Python objects.
#pragma once

#include <atomic>
#include <cxxabi.h>
#include <functional>
#include <future>
#include <memory>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
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

/// From here on the interpreter may end while this thread runs: nobody waits for a daemon thread. CPython
/// ends such a thread where it takes the GIL, up to version 3.13 by unwinding its stack, which would destroy
/// objects of Python without the GIL. Such a thread sleeps here instead until the process ends, as CPython
/// itself has it from 3.14 on.
[[noreturn]] void sleep_until_the_process_ends();

/// call(), on a thread that sleeps from the moment on when the interpreter ends it.
template <class Call>
auto unless_ended(const Call& call) {
  try {
    return call();
  } catch (const abi::__forced_unwind&) {
    sleep_until_the_process_ends();
  }
}

/// This thread gives the GIL back for the life of the object.
class WithoutGil {
 public:
  WithoutGil();
  ~WithoutGil();
  WithoutGil(const WithoutGil&) = delete;
  WithoutGil& operator=(const WithoutGil&) = delete;

 private:
  PyThreadState* thread_;
};

/// A thread without the GIL takes it for the life of the object.
class WithGil {
 public:
  WithGil();
  ~WithGil();
  WithGil(const WithGil&) = delete;
  WithGil& operator=(const WithGil&) = delete;

 private:
  PyGILState_STATE before_;
};

/// Lets the process end while calls run: static objects must not go away under their threads. Once a module.
void leave_running_calls_at_exit();

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
  const WithoutGil released;
  return work();
}

/// The result of a call of Python from such work.
/// @throws py::error_already_set  what Python raises, and KeyboardInterrupt
template <class Call>
auto call_back(const Call& call) {
  const WithGil held;
  return unless_ended([&] {
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    return call();
  });
}

/// What function(arguments...) of Python returns, with the GIL. Nothing stands between the call and the place
/// where the thread sleeps if the interpreter ends it: the arguments stay alive.
template <class... Arguments>
py::object called(const py::object& function, Arguments&&... arguments) {
  const py::tuple packed = py::make_tuple(std::forward<Arguments>(arguments)...);
  PyObject* const returned =
      unless_ended([&] { return PyObject_Call(function.ptr(), packed.ptr(), nullptr); });
  if (returned == nullptr) throw py::error_already_set();
  return py::reinterpret_steal<py::object>(returned);
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
