#include "python/bindings/calls.hpp"

#include <chrono>
#include <cstdlib>
#include <stdexcept>
#include <thread>
#include <unistd.h>

#include <fmt/format.h>

namespace hmax::python {

namespace {

/// Threads that run without the GIL, or wait for it.
std::atomic<int> running = 0;

/// Set when the interpreter ends, by the thread that ends it.
std::atomic<bool> leaving = false;
std::thread::id leaver;
std::atomic<int> callbacks = 0;  // that run

/// Whether the interpreter ends while this thread works, which must not take the GIL any more.
bool is_left_behind() { return leaving && std::this_thread::get_id() != leaver; }

/// The static objects of the process must not go away under a thread that nobody waits for.
void leave_running_threads(int status, void* /*unused*/) {
  if (running > 0) _exit(status);
}

}  // namespace

void sleep_until_the_process_ends() {
  for (;;) pause();
}

WithoutGil::WithoutGil() {
  ++running;
  thread_ = PyEval_SaveThread();
}
WithoutGil::~WithoutGil() {
  if (is_left_behind()) sleep_until_the_process_ends();
  unless_ended([this] { PyEval_RestoreThread(thread_); });
  --running;
}

WithGil::WithGil() {
  if (is_left_behind()) sleep_until_the_process_ends();
  before_ = unless_ended([] { return PyGILState_Ensure(); });
  if (is_left_behind()) {  // it has waited for the GIL
    PyGILState_Release(before_);
    sleep_until_the_process_ends();
  }
  ++callbacks;
}
WithGil::~WithGil() {
  --callbacks;
  PyGILState_Release(before_);
}

void leave_running_calls_at_exit() {
  const py::cpp_function leave([] {
    leaver = std::this_thread::get_id();
    leaving = true;
    // Callbacks that return soon do so; the thread of a longer one sleeps in called().
    constexpr auto moment = std::chrono::milliseconds(1);
    const WithoutGil released;
    for (int waited = 0; callbacks > 0 && waited < 1000; ++waited) std::this_thread::sleep_for(moment);
    // Registered now, and so the first thing of the end of the process.
    on_exit(leave_running_threads, nullptr);
  });
  py::module_::import("atexit").attr("register")(leave);
}

namespace detail {

void start(std::function<void()> task) {
  ++running;
  try {
    std::thread([task = std::move(task)] {
      task();
      --running;
    }).detach();
  } catch (...) {
    --running;
    throw;
  }
}

void wait(const std::function<bool()>& is_ready, Stop& stop) {
  for (;;) {
    {
      const WithoutGil released;
      if (is_ready()) return;
    }
    if (PyErr_CheckSignals() == 0) continue;
    stop = true;
    throw py::error_already_set();
  }
}

}  // namespace detail

py::object to_python(const nlohmann::ordered_json& document) {
  if (document.is_object()) {
    py::dict object;
    for (const auto& [key, value] : document.items()) object[py::str(key)] = to_python(value);
    return object;
  }
  if (document.is_array()) {
    py::list list;
    for (const auto& value : document) list.append(to_python(value));
    return list;
  }
  if (document.is_boolean()) return py::bool_(document.get<bool>());
  if (document.is_number_integer()) return py::int_(document.get<std::int64_t>());
  if (document.is_number()) return py::float_(document.get<double>());
  if (!document.is_string()) return py::none();
  if (document == "unbounded") return py::float_(std::numeric_limits<double>::infinity());
  return py::str(document.get<std::string>());
}

py::array_t<double> to_array(const Eigen::VectorXd& values) {
  return py::array_t<double>(values.size(), values.data());
}

Eigen::VectorXd vector_from(const py::handle& given, std::string_view what, Eigen::Index size) {
  if (Py_TYPE(given.ptr()) != py::detail::npy_api::get().PyArray_Type_ &&
      called(py::module_::import("numpy.ma").attr("is_masked"), py::reinterpret_borrow<py::object>(given))
          .cast<bool>())
    throw std::invalid_argument(
        fmt::format("{} has masked entries; give every number, such as with its method filled()", what));
  const py::array array = py::array::ensure(given);
  if (!array || std::string_view("biuf").find(array.dtype().kind()) == std::string_view::npos)
    throw std::invalid_argument(fmt::format("{} holds no real numbers; give an array of floats", what));
  if (array.ndim() != 1)
    throw std::invalid_argument(fmt::format(
        "{} has {} dimensions but must have one; give one number for each unknown", what, array.ndim()));
  if (size >= 0 && array.size() != size)
    throw std::invalid_argument(fmt::format(
        "{} has {} numbers but must have {}; give one number for each unknown", what, array.size(), size));
  const auto numbers = py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(array);
  if (!numbers) throw py::error_already_set();
  return Eigen::Map<const Eigen::VectorXd>(numbers.data(), numbers.size());
}

}  // namespace hmax::python
