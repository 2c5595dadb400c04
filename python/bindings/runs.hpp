/// Runs of problems, for the calls of several groups.
#pragma once

#include <optional>
#include <pybind11/pybind11.h>
#include <string>

#include "catalogue/methods/method.hpp"
#include "problems/linear_structure.hpp"

namespace hmax::python {

/// A run to t_end with fixed steps h, or with tolerances where there is no h; `every` is the output interval
/// [s].
RunSpec spec_of(double t_end, std::optional<double> h, std::optional<double> rtol, std::optional<double> atol,
                std::optional<double> every);

/// The problem M q'' + C q' + K q = 0 from y0 = (q, v).
/// @throws std::invalid_argument  as linear_structure(), and for a start of another size
Problem structure_problem(StructureMatrix K, StructureMatrix M, std::optional<StructureMatrix> C,
                          Eigen::VectorXd y0, double t_end);

/// A run of a problem that calls no Python, as the class Run of the package has it.
/// @throws InputError  as check()
pybind11::dict run_problem(const std::string& method, Problem problem, const RunSpec& spec);

}  // namespace hmax::python
