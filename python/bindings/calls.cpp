#include "python/bindings/calls.hpp"

#include <cstdlib>
#include <stdexcept>
#include <thread>
#include <unistd.h>

#include <fmt/format.h>

namespace hmax::python {

namespace {

/// Threads that may still run.
std::atomic<int> running = 0;

/// The static objects of the process must not go away under a thread that nobody waits for any more.
void leave_running_threads(int status, void* /*unused*/) {
  if (running > 0) _exit(status);
}

}  // namespace

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
      const py::gil_scoped_release release;
      if (is_ready()) return;
    }
    if (PyErr_CheckSignals() == 0) continue;
    stop = true;
    on_exit(leave_running_threads, nullptr);
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
