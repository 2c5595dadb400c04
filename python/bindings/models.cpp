/// Meshes, bodies of soft tissue, and the advice of which integrator to take.
#include <array>
#include <optional>
#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include <fmt/format.h>

#include "advice/advice_json.hpp"
#include "advice/advise.hpp"
#include "advice/remaking.hpp"
#include "catalogue/methods/catalogue.hpp"
#include "catalogue/methods/choice/chosen_methods.hpp"
#include "catalogue/models/mesh_choice.hpp"
#include "catalogue/models/problems.hpp"
#include "catalogue/models/tissue_parameters.hpp"
#include "catalogue/models/tissue_problem.hpp"
#include "core/errors.hpp"
#include "limits/documents/fidelity_json.hpp"
#include "limits/fidelity/fidelity.hpp"
#include "limits/query/query_limits.hpp"
#include "problems/tissue/body.hpp"
#include "python/bindings/calls.hpp"
#include "python/bindings/groups.hpp"
#include "python/bindings/runs.hpp"

namespace hmax::python {

namespace {

using Eigen::Index;
using Eigen::VectorXd;
using Sparse = Eigen::SparseMatrix<double>;
using Values = std::vector<std::pair<std::string, double>>;

/// What Python asks about.
struct Model {
  std::function<Problem()> make;    ///< on the thread of the search
  std::function<Remaking()> again;  ///< with changes
};

Model model_of(const std::string& id, const ProblemSettings& settings) {
  return {[=] { return make_problem(id, settings); }, [=] { return remaking(id, settings); }};
}

Model named_model(const std::string& id, const std::string& material, const Values& parameters,
                  const std::vector<double>& y0) {
  return model_of(id, {.material = material, .parameters = parameters, .y0 = y0});
}

Model model_of_matrices(StructureMatrix K, StructureMatrix M, std::optional<StructureMatrix> C, VectorXd y0,
                        double t_end) {
  return {[problem = structure_problem(std::move(K), std::move(M), std::move(C), std::move(y0), t_end)] {
            return problem;
          },
          [] { return Remaking(); }};
}

/// A body on a mesh.
struct Body : Model {
  Problem problem;

  [[nodiscard]] const TissueBody& tissue() const { return *problem.body; }
};

std::shared_ptr<Body> make_body(const std::string& mesh, const std::string& model,
                                const std::string& material, const std::string& load,
                                const Values& parameters, const std::optional<std::array<double, 3>>& gravity,
                                const std::vector<std::string>& supports, std::optional<double> unit) {
  ProblemSettings settings{.material = material, .parameters = parameters, .unit = unit};
  for (std::size_t i = 0; gravity && i < gravity->size(); ++i)
    settings.parameters.emplace_back(gravity_names[i], (*gravity)[i]);
  for (const std::string& set : supports)
    settings.parameters.emplace_back(fmt::format("{}:{}", support_name, set), 1);
  return in_background([recipe = model_of(tissue_id(model, mesh, load), settings)](const Stop&) {
    return std::make_shared<Body>(Body{recipe, recipe.make()});
  });
}

/// q or v of a body; zero where none is given.
VectorXd dofs_from(const Body& body, const py::object& given, std::string_view what) {
  const Index n = body.tissue().dofs();
  return given.is_none() ? VectorXd::Zero(n) : vector_from(given, what, n);
}

/// (tissue.*write)(t, q, v, result), without the GIL.
template <class Result>
Result at_state(const Body& body, const py::object& q, const py::object& v, double t,
                void (TissueBody::*write)(double, const VectorXd&, const VectorXd&, Result&) const,
                Result result = Result()) {
  const VectorXd at_q = dofs_from(body, q, "q"), at_v = dofs_from(body, v, "v");
  const WithoutGil released;
  (body.tissue().*write)(t, at_q, at_v, result);
  return result;
}

Sparse stiffness(const Body& body, const py::object& q, const py::object& v, double t) {
  return at_state(body, q, v, t, &TissueBody::stiffness);
}
Sparse damping(const Body& body, const py::object& q, const py::object& v, double t) {
  return at_state(body, q, v, t, &TissueBody::damping);
}
VectorXd force(const Body& body, const py::object& q, const py::object& v, double t) {
  return at_state(body, q, v, t, &TissueBody::force, VectorXd(body.tissue().dofs()));
}
Sparse mass(const Body& body) {
  Sparse M(body.tissue().dofs(), body.tissue().dofs());
  M = body.tissue().mass().asDiagonal();
  return M;
}

py::dict run_body(const Body& body, const std::string& method, VectorXd y0, double t_end,
                  std::optional<double> h, std::optional<double> rtol, std::optional<double> atol,
                  std::optional<double> every) {
  Problem problem = body.problem;
  problem.y0 = std::move(y0);
  return run_problem(method, std::move(problem), spec_of(t_end, h, rtol, atol, every));
}

/// Points, one a row, shape (n, 3): Eigen's columns are the rows of a C array.
py::array_t<double> points_of(const TetMesh& mesh) {
  return py::array_t<double>({mesh.point_count(), Index{3}}, mesh.points.data());
}

/// A mesh as arrays: name, points (n, 3) [m], their numbers (n), tetrahedra (m, 4), regions (m).
py::tuple read_mesh(const std::string& text, std::optional<double> unit) {
  const LoadedMesh loaded = in_background([=](const Stop&) { return load_mesh(text, unit); });
  const TetMesh& mesh = loaded.mesh;
  const Index count = mesh.tetrahedron_count();
  Eigen::VectorXi regions(count);
  for (Index i = 0; i < count; ++i)
    regions[i] = loaded.origin->regions.at(static_cast<std::size_t>(mesh.region(i)));
  const auto tetrahedra = py::array_t<TetMesh::Index>({count, Index{4}}, mesh.tetrahedra.data());
  py::array_t<std::int64_t> numbers(mesh.point_count());
  for (Index i = 0; i < mesh.point_count(); ++i) numbers.mutable_at(i) = loaded.origin->point_number(i);
  return py::make_tuple(loaded.name, points_of(mesh), numbers, tetrahedra, regions);
}

/// What `hmax advise` computes; remedies are sought where nothing is recommended.
py::object advice_on(const Model& model, double rate, double tolerance, std::optional<double> budget_ms,
                     bool least_error, const std::vector<std::string>& methods, std::size_t frames,
                     double within) {
  return to_python(in_background([=](const Stop& stop) {
    const Problem problem = model.make();
    AdviceQuestion question;
    question.rate = rate;
    question.tolerance = tolerance;
    if (budget_ms) question.budget = *budget_ms / 1000;
    question.least_error = least_error;
    question.frames = frames;
    question.within = within;
    question.methods = choose_methods(methods.empty() ? simulator_methods() : methods, {problem});
    const Remaking make = model.again();
    const AdviceWatcher watcher = [&stop](double, const std::string&) { leave_if(stop); };
    Advice advice;
    advise(problem, question, advice, watcher, make.with);
    if (!advice.recommended()) find_remedies(problem, question, advice, make, watcher);
    return advice_json(problem, question, advice, false);
  }));
}

/// Ends a query when its caller is interrupted.
class StoppedByCaller : public LimitWatcher {
 public:
  explicit StoppedByCaller(const Stop& stop) : stop_(stop) {}
  [[nodiscard]] bool stopped() const override { return stop_; }

 private:
  const Stop& stop_;
};

/// What `hmax stability predict --json` computes.
py::object limits_of(const Model& model, const std::vector<std::string>& names, const std::string& at,
                     const std::string& along, bool verify, std::optional<double> t_end) {
  return to_python(in_background([=](const Stop& stop) {
    const std::vector<Problem> problems{model.make()};
    const auto [methods, left_out] = chosen_methods(names, problems);
    const bool at_rest = at == "rest";
    if (at_rest && !problems[0].body)
      throw InputError(fmt::format("at is 'rest', which is of bodies on a mesh, and {} is none; leave it out",
                                   problems[0].id));
    const LimitQuestion question = with_path({.at = at_rest ? AskedState::rest : AskedState::equilibrium,
                                              .verify = verify,
                                              .t_end = t_end,
                                              .named = named_one_by_one(names, methods)},
                                             along, problems[0]);
    StoppedByCaller watcher(stop);
    const LimitAnswer answer = query_limits(question, problems, methods, true, watcher);
    leave_if(stop);
    nlohmann::ordered_json document = answer_json(answer, problems);
    document["left_out"] = in_words(left_out);
    return document;
  }));
}

/// What `hmax fidelity --json` computes.
py::object fidelity_of(const Model& model, double rate, const std::vector<std::string>& names, bool verify,
                       bool ceiling, std::optional<double> enter) {
  return to_python(in_background([=](const Stop& stop) {
    const Problem problem = model.make();
    const FidelityQuestion question{
        .h = 1 / rate, .verify = verify, .ceiling = ceiling, .wanted = enter, .watch = [&stop] {
          leave_if(stop);
        }};
    std::vector<Method> methods;
    for (const std::string& name : names) methods.push_back(find_method(name));
    if (methods.empty()) methods = methods_of_simulators(problem);
    const FidelityModel shown = fidelity_model(problem, question.watch);
    std::vector<Fidelity> rows;
    for (const Method& method : methods) rows.push_back(fidelity(method, shown, question));
    return fidelity_json(problem, rate, rows);
  }));
}

}  // namespace

void add_models(py::module_& module) {
  py::class_<Model, std::shared_ptr<Model>>(module, "Model")
      .def(py::init(&named_model))
      .def_static("of_matrices", &model_of_matrices)
      .def("advise", &advice_on)
      .def("predict", &limits_of)
      .def("fidelity", &fidelity_of);
  py::class_<Body, Model, std::shared_ptr<Body>>(module, "Body")
      .def(py::init(&make_body))
      .def("K", &stiffness)
      .def("C", &damping)
      .def("M", &mass)
      .def("force", &force)
      .def("run", &run_body)
      .def_property_readonly("id", [](const Body& body) { return body.problem.id; })
      .def_property_readonly("dofs", [](const Body& body) { return body.tissue().dofs(); })
      .def_property_readonly("points", [](const Body& body) { return points_of(body.tissue().mesh()); })
      .def_property_readonly("free_points", [](const Body& body) {
        const auto& points = body.tissue().free_points();
        return py::array_t<TetMesh::Index>(static_cast<py::ssize_t>(points.size()), points.data());
      });
  module.def("read_mesh", &read_mesh);
  module.def("unit_in_metres", &unit_in_metres);
}

}  // namespace hmax::python
