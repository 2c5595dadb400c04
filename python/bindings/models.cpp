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

/// How a problem is made, and made again with changes.
struct Recipe {
  std::string id;
  ProblemSettings settings;

  [[nodiscard]] Problem make() const { return make_problem(id, settings); }
};

/// A body on a mesh, as Python holds it.
struct Body {
  Recipe recipe;
  Problem problem;

  [[nodiscard]] const TissueBody& tissue() const { return *problem.body; }
};

std::shared_ptr<Body> make_body(const std::string& mesh, const std::string& model,
                                const std::string& material, const std::string& load,
                                const Values& parameters, const std::optional<std::array<double, 3>>& gravity,
                                const std::vector<std::string>& supports, std::optional<double> unit) {
  Recipe recipe{tissue_id(model, mesh, load), {.material = material, .parameters = parameters, .unit = unit}};
  for (std::size_t i = 0; gravity && i < gravity->size(); ++i)
    recipe.settings.parameters.emplace_back(gravity_names[i], (*gravity)[i]);
  for (const std::string& set : supports)
    recipe.settings.parameters.emplace_back(fmt::format("{}:{}", support_name, set), 1);
  return in_background([recipe = std::move(recipe)](const Stop&) {
    return std::make_shared<Body>(Body{recipe, recipe.make()});
  });
}

/// q or v of a body; zero where none is given.
VectorXd dofs_from(const Body& body, const py::object& given, std::string_view what) {
  const Index n = body.tissue().dofs();
  return given.is_none() ? VectorXd::Zero(n) : vector_from(given, what, n);
}

/// write(t, q, v, result) of a body, without the GIL.
template <class Result, class Write>
Result at_state(const Body& body, const py::object& q, const py::object& v, double t, const Write& write) {
  const VectorXd at_q = dofs_from(body, q, "q"), at_v = dofs_from(body, v, "v");
  Result result;
  const WithoutGil released;
  write(body.tissue(), t, at_q, at_v, result);
  return result;
}

Sparse stiffness(const Body& body, const py::object& q, const py::object& v, double t) {
  return at_state<Sparse>(body, q, v, t,
                          [](const TissueBody& tissue, double at, const VectorXd& x, const VectorXd& y,
                             Sparse& K) { tissue.stiffness(at, x, y, K); });
}
Sparse damping(const Body& body, const py::object& q, const py::object& v, double t) {
  return at_state<Sparse>(body, q, v, t,
                          [](const TissueBody& tissue, double at, const VectorXd& x, const VectorXd& y,
                             Sparse& C) { tissue.damping(at, x, y, C); });
}
VectorXd force(const Body& body, const py::object& q, const py::object& v, double t) {
  return at_state<VectorXd>(
      body, q, v, t,
      [](const TissueBody& tissue, double at, const VectorXd& x, const VectorXd& y, VectorXd& f) {
        f.resize(tissue.dofs());
        tissue.force(at, x, y, f);
      });
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

/// A mesh as arrays: name, points (n, 3) [m], their numbers (n), tetrahedra (m, 4), regions (m).
py::tuple read_mesh(const std::string& text, std::optional<double> unit) {
  const LoadedMesh loaded = in_background([=](const Stop&) { return load_mesh(text, unit); });
  const TetMesh& mesh = loaded.mesh;
  const Index count = mesh.tetrahedron_count();
  Eigen::VectorXi regions(count);
  for (Index i = 0; i < count; ++i) regions[i] = mesh.region(i);
  // Eigen's columns are the rows of a C array.
  const auto points = py::array_t<double>({mesh.point_count(), Index{3}}, mesh.points.data());
  const auto tetrahedra = py::array_t<TetMesh::Index>({count, Index{4}}, mesh.tetrahedra.data());
  py::array_t<std::int64_t> numbers(mesh.point_count());
  for (Index i = 0; i < mesh.point_count(); ++i) numbers.mutable_at(i) = loaded.origin->point_number(i);
  return py::make_tuple(loaded.name, points, numbers, tetrahedra, regions);
}

/// What is asked of a model.
struct Asked {
  double rate, tolerance;
  std::optional<double> budget_ms;
  bool least_error;
  std::vector<std::string> methods;
  std::size_t frames;
  double within;
};

AdviceQuestion question_of(const Problem& problem, const Asked& asked) {
  AdviceQuestion question;
  question.rate = asked.rate;
  question.tolerance = asked.tolerance;
  if (asked.budget_ms) question.budget = *asked.budget_ms / 1000;
  question.least_error = asked.least_error;
  question.frames = asked.frames;
  question.within = asked.within;
  question.methods = choose_methods(asked.methods.empty() ? simulator_methods() : asked.methods, {problem});
  return question;
}

/// What `hmax advise` computes; remedies are sought where nothing is recommended.
nlohmann::ordered_json advice_of(const Problem& problem, const AdviceQuestion& question, const Remaking& make,
                                 const Stop& stop) {
  const AdviceWatcher watcher = [&stop](double, const std::string&) { leave_if(stop); };
  Advice advice;
  advise(problem, question, advice, watcher, make.with);
  if (!advice.recommended()) find_remedies(problem, question, advice, make, watcher);
  return advice_json(problem, question, advice, false);
}

/// @param make  what makes the problem, on the thread of the search
/// @param again  how it is made again
py::object advise_on(const std::function<Problem()>& make, const std::function<Remaking()>& again,
                     const Asked& asked) {
  return to_python(in_background([=](const Stop& stop) {
    const Problem problem = make();
    return advice_of(problem, question_of(problem, asked), again(), stop);
  }));
}

py::object advise_recipe(const Recipe& recipe, const Asked& asked) {
  return advise_on([recipe] { return recipe.make(); },
                   [recipe] { return remaking(recipe.id, recipe.settings); }, asked);
}

py::object advise_named(const std::string& id, const std::string& material, const Values& parameters,
                        const std::vector<double>& y0, double rate, double tolerance,
                        std::optional<double> budget_ms, bool least_error, std::vector<std::string> methods,
                        std::size_t frames, double within) {
  return advise_recipe({id, {.material = material, .parameters = parameters, .y0 = y0}},
                       {rate, tolerance, budget_ms, least_error, std::move(methods), frames, within});
}

py::object advise_structure(StructureMatrix K, StructureMatrix M, std::optional<StructureMatrix> C,
                            VectorXd y0, double t_end, double rate, double tolerance,
                            std::optional<double> budget_ms, bool least_error,
                            std::vector<std::string> methods, std::size_t frames, double within) {
  const Problem problem = structure_problem(std::move(K), std::move(M), std::move(C), std::move(y0), t_end);
  return advise_on([made = problem] { return made; }, [] { return Remaking(); },
                   {rate, tolerance, budget_ms, least_error, std::move(methods), frames, within});
}

py::object advise_body(const Body& body, double rate, double tolerance, std::optional<double> budget_ms,
                       bool least_error, std::vector<std::string> methods, std::size_t frames,
                       double within) {
  return advise_recipe(body.recipe,
                       {rate, tolerance, budget_ms, least_error, std::move(methods), frames, within});
}

/// What is asked about the step limits of a model.
struct AskedLimits {
  std::vector<std::string> methods;
  std::string at, along;
  bool verify;
  std::optional<double> t_end;
};

/// Ends a query when its caller is interrupted.
class StoppedByCaller : public LimitWatcher {
 public:
  explicit StoppedByCaller(const Stop& stop) : stop_(stop) {}
  [[nodiscard]] bool stopped() const override { return stop_; }

 private:
  const Stop& stop_;
};

/// What `hmax stability predict --json` computes.
py::object predict_recipe(const Recipe& recipe, const AskedLimits& asked) {
  return to_python(in_background([=](const Stop& stop) {
    const std::vector<Problem> problems{recipe.make()};
    const auto [methods, left_out] = chosen_methods(asked.methods, problems);
    const bool at_rest = asked.at == "rest";
    if (at_rest && !problems[0].body)
      throw InputError(fmt::format("at is 'rest', which is of bodies on a mesh, and {} is none; leave it out",
                                   problems[0].id));
    const LimitQuestion question = with_path({.at = at_rest ? AskedState::rest : AskedState::equilibrium,
                                              .verify = asked.verify,
                                              .t_end = asked.t_end,
                                              .named = named_one_by_one(asked.methods, methods)},
                                             asked.along, problems[0]);
    StoppedByCaller watcher(stop);
    const LimitAnswer answer = query_limits(question, problems, methods, true, watcher);
    leave_if(stop);
    nlohmann::ordered_json document = answer_json(answer, problems);
    document["left_out"] = in_words(left_out);
    return document;
  }));
}

py::object predict_named(const std::string& id, const std::string& material, const Values& parameters,
                         const std::vector<double>& y0, std::vector<std::string> methods, std::string at,
                         std::string along, bool verify, std::optional<double> t_end) {
  return predict_recipe({id, {.material = material, .parameters = parameters, .y0 = y0}},
                        {std::move(methods), std::move(at), std::move(along), verify, t_end});
}

py::object predict_body(const Body& body, std::vector<std::string> methods, std::string at, std::string along,
                        bool verify, std::optional<double> t_end) {
  return predict_recipe(body.recipe, {std::move(methods), std::move(at), std::move(along), verify, t_end});
}

/// What `hmax fidelity --json` computes.
py::object fidelity_of_recipe(const Recipe& recipe, double rate, const std::vector<std::string>& names,
                              bool verify, bool ceiling, std::optional<double> enter) {
  return to_python(in_background([=](const Stop& stop) {
    const Problem problem = recipe.make();
    const FidelityQuestion question{
        .h = 1 / rate, .verify = verify, .ceiling = ceiling, .wanted = enter, .watch = [&stop] {
          leave_if(stop);
        }};
    std::vector<Method> methods;
    for (const std::string& name : names) methods.push_back(find_method(name));
    if (methods.empty()) methods = methods_of_simulators(problem);
    const FidelityModel model = fidelity_model(problem, question.watch);
    std::vector<Fidelity> rows;
    for (const Method& method : methods) rows.push_back(fidelity(method, model, question));
    return fidelity_json(problem, rate, rows);
  }));
}

py::object fidelity_of_body(const Body& body, double rate, const std::vector<std::string>& names, bool verify,
                            bool ceiling, std::optional<double> enter) {
  return fidelity_of_recipe(body.recipe, rate, names, verify, ceiling, enter);
}

py::object fidelity_named(const std::string& id, const std::string& material, const Values& parameters,
                          const std::vector<double>& y0, double rate, const std::vector<std::string>& names,
                          bool verify, bool ceiling, std::optional<double> enter) {
  return fidelity_of_recipe({id, {.material = material, .parameters = parameters, .y0 = y0}}, rate, names,
                            verify, ceiling, enter);
}

}  // namespace

void add_models(py::module_& module) {
  py::class_<Body, std::shared_ptr<Body>>(module, "Body")
      .def(py::init(&make_body))
      .def("K", &stiffness)
      .def("C", &damping)
      .def("M", &mass)
      .def("force", &force)
      .def("run", &run_body)
      .def("advise", &advise_body)
      .def("predict", &predict_body)
      .def("fidelity", &fidelity_of_body)
      .def_property_readonly("id", [](const Body& body) { return body.problem.id; })
      .def_property_readonly("dofs", [](const Body& body) { return body.tissue().dofs(); })
      .def_property_readonly("free_points", [](const Body& body) {
        const auto& points = body.tissue().free_points();
        return py::array_t<TetMesh::Index>(static_cast<py::ssize_t>(points.size()), points.data());
      });
  module.def("read_mesh", &read_mesh);
  module.def("unit_in_metres", &unit_in_metres);
  module.def("advise", &advise_named);
  module.def("advise_structure", &advise_structure);
  module.def("predict", &predict_named);
  module.def("fidelity", &fidelity_named);
}

}  // namespace hmax::python
