/// The extension module hmax._core, which the Python sources of the package call.
#include <pybind11/pybind11.h>

#include "python/bindings/groups.hpp"
#include "results/errors.hpp"

PYBIND11_MODULE(_core, module) {
  namespace py = pybind11;
  module.doc() = "What the package hmax calls; use that.";
  module.attr("__version__") = HMAX_VERSION;
  // The other errors of input are std::invalid_argument, which pybind11 makes a ValueError.
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      std::rethrow_exception(thrown);
    } catch (const hmax::InputError& error) {
      PyErr_SetString(PyExc_ValueError, error.what());
    }
  });
  hmax::python::add_methods(module);
  hmax::python::add_limits(module);
  hmax::python::add_runs(module);
  hmax::python::add_probe(module);
  hmax::python::add_models(module);
}
