/// Integration of a right-hand side that is a Python function, and of matrices.
#include "python/bindings/runs.hpp"

#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include <fmt/format.h>

#include "catalogue/methods/catalogue.hpp"
#include "problems/linear_structure.hpp"
#include "python/bindings/calls.hpp"
#include "python/bindings/groups.hpp"

namespace hmax::python {

namespace {

using Eigen::Index;
using Eigen::VectorXd;
using Sparse = Eigen::SparseMatrix<double>;

/// y' = f(t, y) of a Python function. Nobody may destroy a copy without the GIL, so that copies share one
/// object.
class PythonSystem {
 public:
  using State = VectorXd;

  PythonSystem(const py::object& f, Index dim) : f_(shared(f)), dim_(dim) {}

  [[nodiscard]] Index dim() const { return dim_; }
  void rhs(double t, const State& y, State& dydt) const {
    const VectorXd values = call_back(
        [&] { return vector_from(called(*f_, t, to_array(y)), "what the right-hand side returns", dim_); });
    dydt = values;  // in place: others may hold its address
  }

 protected:
  static std::shared_ptr<py::object> shared(const py::object& object) {
    return {new py::object(object), [](py::object* held) {
              const WithGil locked;
              delete held;
            }};
  }

 private:
  std::shared_ptr<py::object> f_;
  Index dim_;
};

/// The same with its Jacobian, a function that returns a dense array or a sparse matrix by columns, as the
/// package has it.
class PythonSystemWithJacobian : public PythonSystem {
 public:
  using Jacobian = std::variant<Eigen::MatrixXd, Sparse>;

  PythonSystemWithJacobian(const py::object& f, const py::object& jacobian, Index dim)
      : PythonSystem(f, dim), jacobian_(shared(jacobian)) {}

  void jacobian(double t, const State& y, Jacobian& J) const {
    call_back([&] {
      const py::object returned = called(*jacobian_, t, to_array(y));
      J = returned.cast<Jacobian>();
      const auto [rows, columns] =
          std::visit([](const auto& held) { return std::pair(held.rows(), held.cols()); }, J);
      if (rows != dim() || columns != dim())
        throw std::invalid_argument(
            fmt::format("what the Jacobian returns has the shape {} x {} but must have {} x {}", rows,
                        columns, dim(), dim()));
    });
  }

 private:
  std::shared_ptr<py::object> jacobian_;
};

/// The points of a run.
struct Points {
  std::vector<double> t, y;

  void add(double at, const Eigen::Ref<const VectorXd>& state) {
    t.push_back(at);
    y.insert(y.end(), state.begin(), state.end());
  }
};

struct Finished {
  RunRecord record;
  Points points;
};

Problem problem_of(AnySystem system, VectorXd y0, std::string id, double t_end) {
  Problem problem{.id = std::move(id), .y0 = std::move(y0), .t_end = t_end, .system = std::move(system)};
  for (Index i = 0; i < problem.y0.size(); ++i) problem.states.push_back(fmt::format("y[{}]", i));
  return problem;
}

/// @param watch  called now and then; may throw
Finished run(const Method& method, const Problem& problem, const RunSpec& spec,
             const std::function<void()>& watch) {
  check(spec, method, problem);
  Finished finished;
  finished.record = method.bind(problem).run(spec, [&](double t, const Eigen::Ref<const VectorXd>& y) {
    watch();
    finished.points.add(t, y);
  });
  return finished;
}

/// As the class Run of the package has it.
py::dict to_dict(const Finished& finished, Index dim) {
  const RunRecord& record = finished.record;
  const auto rows = static_cast<py::ssize_t>(finished.points.t.size());
  py::dict stats, run;
  for (const auto& [name, value] : {std::pair("steps", record.stats.steps),
                                    {"rejected", record.stats.rejected},
                                    {"rhs", record.stats.rhs},
                                    {"jacobian", record.stats.jacobian},
                                    {"factorisations", record.stats.factorisations},
                                    {"newton", record.stats.newton}})
    stats[name] = value;
  run["outcome"] = std::string(to_string(record.outcome));
  run["t"] = py::array_t<double>(rows, finished.points.t.data());
  run["y"] = py::array_t<double>({rows, static_cast<py::ssize_t>(dim)}, finished.points.y.data());
  run["stats"] = stats;
  run["status"] = std::string(record.note);
  return run;
}

py::dict run_function(const std::string& name, const py::object& f, const py::object& jacobian,
                      const VectorXd& y0, double t_end, std::optional<double> h, std::optional<double> rtol,
                      std::optional<double> atol, std::optional<double> every) {
  const Method method = find_method(name);
  const Problem problem =
      problem_of(jacobian.is_none() ? AnySystem(PythonSystem(f, y0.size()))
                                    : AnySystem(PythonSystemWithJacobian(f, jacobian, y0.size())),
                 y0, "the right-hand side", t_end);
  const RunSpec spec = spec_of(t_end, h, rtol, atol, every);
  return to_dict(with_callbacks([&] { return run(method, problem, spec, [] {}); }), y0.size());
}

py::dict run_structure(const std::string& method, StructureMatrix K, StructureMatrix M,
                       std::optional<StructureMatrix> C, VectorXd y0, double t_end, std::optional<double> h,
                       std::optional<double> rtol, std::optional<double> atol, std::optional<double> every) {
  return run_problem(method,
                     structure_problem(std::move(K), std::move(M), std::move(C), std::move(y0), t_end),
                     spec_of(t_end, h, rtol, atol, every));
}

}  // namespace

RunSpec spec_of(double t_end, std::optional<double> h, std::optional<double> rtol, std::optional<double> atol,
                std::optional<double> every) {
  RunSpec spec{
      .t_end = t_end, .adaptive = !h, .h = h.value_or(0), .rtol = rtol.value_or(0), .atol = atol.value_or(0)};
  spec.every = every.value_or(0);
  return spec;
}

Problem structure_problem(StructureMatrix K, StructureMatrix M, std::optional<StructureMatrix> C, VectorXd y0,
                          double t_end) {
  AnySystem system = hmax::detail::structure_system(std::move(K), std::move(M), std::move(C));
  if (system.dim() != y0.size())
    throw std::invalid_argument(
        fmt::format("y0 has {} numbers but must have {}: the displacements, then the velocities", y0.size(),
                    system.dim()));
  return problem_of(std::move(system), std::move(y0), "the structure", t_end);
}

py::dict run_problem(const std::string& method, Problem problem, const RunSpec& spec) {
  const Index dim = problem.y0.size();
  return to_dict(in_background([=, problem = std::move(problem)](const Stop& stop) {
                   return run(find_method(method), problem, spec, [&stop] { leave_if(stop); });
                 }),
                 dim);
}

void add_runs(py::module_& module) {
  module.def("run_function", &run_function);
  module.def("run_structure", &run_structure);
}

}  // namespace hmax::python
