/// The largest stable step and the modes of matrices.
#include <cmath>
#include <pybind11/complex.h>
#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include <fmt/format.h>

#include "analysis/spectrum/extreme_eigenvalues.hpp"
#include "core/errors.hpp"
#include "limits/largest_stable_step.hpp"
#include "problems/matrices/linear_first_order.hpp"
#include "python/bindings/calls.hpp"
#include "python/bindings/groups.hpp"

namespace hmax::python {

namespace {

using Sparse = Eigen::SparseMatrix<double>;
using Eigen::Index;
using Eigen::VectorXd;

/// As the class Limit of the package has it; what is missing is None.
py::dict to_dict(const StepAnswer& answer) {
  const auto number = [](const std::optional<double>& value) -> py::object {
    return value ? py::object(py::float_(*value)) : py::none();
  };
  const std::optional<Mode>& mode = answer.limiting;
  py::dict limit;
  limit["h_max"] = answer.h_max;
  limit["bound"] = std::string(name_of(answer.bound));
  limit["omega"] = number(mode ? mode->omega : std::nullopt);
  limit["zeta"] = number(mode ? mode->zeta : std::nullopt);
  limit["mode"] = mode ? py::cast(mode->lambda + std::complex<double>(0, 0)) : py::none();  // no -0
  limit["status"] = answer.status;
  limit["method"] = answer.method;
  limit["observed"] = number(answer.observed);
  return limit;
}

py::dict limit_of_structure(const std::string& method, StructureMatrix K, StructureMatrix M,
                            std::optional<StructureMatrix> C, bool verify) {
  return to_dict(in_background([=, K = std::move(K), M = std::move(M),
                                C = std::move(C)](const Stop&) mutable {
    return hmax::detail::step_of_structure(
        method, hmax::detail::structure_system(std::move(K), std::move(M), std::move(C)), {.verify = verify});
  }));
}

/// @throws std::invalid_argument  for a matrix that is not square or not finite
void check_jacobian(const Sparse& J) {
  if (J.rows() != J.cols() || J.rows() == 0)
    throw std::invalid_argument(fmt::format(
        "J has the shape {} x {} but must be square, a row and a column for each state", J.rows(), J.cols()));
  for (Index j = 0; j < J.cols(); ++j)
    for (Sparse::InnerIterator entry(J, j); entry; ++entry)
      if (!std::isfinite(entry.value()))
        throw std::invalid_argument(
            fmt::format("J has {} at row {}, column {} (counted from 1); every entry must be finite",
                        entry.value(), entry.row() + 1, j + 1));
}

py::dict limit_of_jacobian(const std::string& method, const Sparse& J, bool verify) {
  check_jacobian(J);
  return to_dict(in_background([=](const Stop&) {
    // Zero is an equilibrium.
    return largest_stable_step(method, AnySystem(LinearFirstOrder(J)), VectorXd::Zero(J.rows()),
                               {.find_equilibrium = true, .verify = verify});
  }));
}

struct Modes {
  VectorXd kappa, omega, zeta;  ///< shape (count) [1/s^2], [rad/s], [1]
  Eigen::MatrixXd shapes;       ///< shape (n, count), shapes^T M shapes = I
};

Modes modes_of(const AnySystem& structure, Index count, bool fastest) {
  const LinearModel model = linearise(structure, 0, VectorXd::Zero(structure.dim()));
  const MechanicalPart& part = *model.mechanical;
  if (!part.symmetric)
    throw InputError(
        "K and C are not both symmetric, so there are no modes of free motion; largest_stable_step takes such "
        "matrices");
  const ExtremeStiffnesses found =
      fastest ? largest_stiffnesses(part, count) : smallest_stiffnesses(part, count);
  if (!found.converged)
    throw InputError(
        fmt::format("the modes of {} unknowns did not converge; ask for fewer", structure.dofs()));
  Modes modes{VectorXd(count), VectorXd(count), VectorXd::Zero(count), found.shapes};
  for (Index i = 0; i < count; ++i) {
    const VectorXd u = found.shapes.col(i);
    const VectorXd Cu = std::visit([&](const auto& matrix) -> VectorXd { return matrix * u; }, part.C);
    modes.kappa[i] = found.kappa[static_cast<std::size_t>(i)];
    modes.omega[i] = std::sqrt(std::max(modes.kappa[i], 0.0));
    if (modes.omega[i] > 0) modes.zeta[i] = u.dot(Cu) / (2 * modes.omega[i]);
  }
  return modes;
}

py::tuple modes(StructureMatrix K, StructureMatrix M, std::optional<StructureMatrix> C, Index count,
                bool fastest) {
  Modes found = in_background([=, K = std::move(K), M = std::move(M), C = std::move(C)](const Stop&) mutable {
    const AnySystem structure = hmax::detail::structure_system(std::move(K), std::move(M), std::move(C));
    return modes_of(structure, std::min(count, structure.dofs()), fastest);
  });
  return py::make_tuple(std::move(found.omega), std::move(found.zeta), std::move(found.shapes),
                        std::move(found.kappa));
}

}  // namespace

void add_limits(py::module_& module) {
  module.def("limit_of_structure", &limit_of_structure);
  module.def("limit_of_jacobian", &limit_of_jacobian);
  module.def("modes", &modes);
}

}  // namespace hmax::python
