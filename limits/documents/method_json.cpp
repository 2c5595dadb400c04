#include "limits/documents/method_json.hpp"

#include "limits/documents/number_json.hpp"

namespace hmax {

nlohmann::ordered_json method_json(const Method& method) {
  return {{"id", method.id},
          {"aliases", method.aliases},
          {"family", method.family},
          {"order", method.order},
          {"error_order", method.error_order},
          {"stages", method.stages},
          {"explicit", method.is_explicit},
          {"adaptive", method.adaptive()},
          {"fixed_step", method.fixed_step},
          {"needs_jacobian", method.needs_jacobian},
          {"needs_second_order", method.needs_second_order},
          {"needs_split", method.needs_split},
          {"linearly_implicit", method.linearly_implicit},
          {"first_same_as_last", method.first_same_as_last},
          {"steps_back", method.steps_back},
          {"parameters", parameters_json(method.parameters)},
          {"a_stable", method.a_stable},
          {"l_stable", method.l_stable},
          {"engine", method.engine},
          {"source", method.source},
          {"note", method.note}};
}

}  // namespace hmax
