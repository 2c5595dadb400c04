/// The catalogue of methods, and their stability.
#include "catalogue/methods/choice/formulas.hpp"
#include "limits/documents/method_json.hpp"
#include "python/bindings/calls.hpp"
#include "python/bindings/groups.hpp"

namespace hmax::python {

namespace {

using Json = nlohmann::ordered_json;

Json rows_of_methods() {
  Json rows = Json::array();
  for (const Method& method : methods()) rows.push_back(method_json(method));
  return rows;
}

Json limits_of(const std::string& name) {
  const Formula formula = find_formula(name);
  return limits_json(formula, stability_limits(*formula.amplification));
}

Json region_of(const std::string& name, int cells) {
  const Formula formula = find_formula(name);
  const PlaneWindow window = window_of(*formula.amplification);
  return region_json(formula.id, window, region_boundary(stable_at(*formula.amplification), window, cells));
}

}  // namespace

void add_methods(py::module_& module) {
  module.def("methods",
             [] { return to_python(in_background([](const Stop&) { return rows_of_methods(); })); });
  module.def("limits", [](std::string method) {
    return to_python(in_background([method = std::move(method)](const Stop&) { return limits_of(method); }));
  });
  module.def("region", [](std::string method, int cells) {
    return to_python(
        in_background([method = std::move(method), cells](const Stop&) { return region_of(method, cells); }));
  });
}

}  // namespace hmax::python
