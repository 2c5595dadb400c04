/// The groups of calls of the module, one source file each.
#pragma once

#include <pybind11/pybind11.h>

namespace hmax::python {

void add_methods(pybind11::module_& module);  ///< the catalogue, and the stability of methods
void add_limits(pybind11::module_& module);   ///< limits and modes of matrices
void add_runs(pybind11::module_& module);     ///< integration
void add_probe(pybind11::module_& module);    ///< limits of a step of one's own
void add_models(pybind11::module_& module);   ///< meshes, bodies, advice

}  // namespace hmax::python
