/// The extension module hmax._core, which the Python sources of the package call.
#include <cctype>
#include <pybind11/pybind11.h>
#include <string>

#include "core/errors.hpp"
#include "python/bindings/calls.hpp"
#include "python/bindings/groups.hpp"

namespace {

/// A sentence with arguments for options: "give t_end in seconds" for "give --t-end in seconds".
std::string with_arguments(const std::string& sentence) {
  std::string text;
  bool in_option = false;
  for (std::size_t i = 0; i < sentence.size(); ++i) {
    const char c = sentence[i];
    const bool letter = std::isalnum(static_cast<unsigned char>(c)) != 0;
    if (sentence.compare(i, 2, "--") == 0 && i + 2 < sentence.size() &&
        std::islower(static_cast<unsigned char>(sentence[i + 2]))) {
      in_option = true;
      ++i;
      continue;
    }
    in_option = in_option && (letter || c == '-');
    text += in_option && c == '-' ? '_' : c;
  }
  return text;
}

}  // namespace

PYBIND11_MODULE(_core, module) {
  namespace py = pybind11;
  module.doc() = "What the package hmax calls; use that.";
  module.attr("__version__") = HMAX_VERSION;
  // The other errors of input are std::invalid_argument, which pybind11 makes a ValueError.
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      std::rethrow_exception(std::move(thrown));
    } catch (const hmax::InputError& error) {
      PyErr_SetString(PyExc_ValueError, with_arguments(error.what()).c_str());
    }
  });
  hmax::python::leave_running_calls_at_exit();
  hmax::python::add_methods(module);
  hmax::python::add_limits(module);
  hmax::python::add_runs(module);
  hmax::python::add_probe(module);
  hmax::python::add_models(module);
}
