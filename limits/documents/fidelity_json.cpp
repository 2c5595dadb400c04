#include "limits/documents/fidelity_json.hpp"

#include "limits/documents/number_json.hpp"

namespace hmax {

namespace {
using Json = nlohmann::ordered_json;
}  // namespace

Json number_or_null(const std::optional<double>& value) { return value ? Json(*value) : Json(); }

Json modes_json(const std::vector<ShownMode>& modes) {
  Json list = Json::array();
  for (const ShownMode& mode : modes)
    list.push_back({{"omega", mode.omega},
                    {"omega_shown", number_or_word(mode.omega_shown)},
                    {"zeta", mode.zeta},
                    {"zeta_shown", number_or_word(mode.zeta_shown)},
                    {"likeness", mode.likeness}});
  return list;
}

Json to_json(const Fidelity& row) {
  return {
      {"method", row.method.id},
      {"options", parameters_json(row.method.parameters)},
      {"iterations", number_or_null(row.method.parameter("iterations"))},
      {"substeps", number_or_null(row.method.parameter("substeps"))},
      {"h", row.h},
      {"stiffness_shown", number_or_word(row.stiffness_shown)},
      {"stiffness_ceiling", number_or_word(row.stiffness_ceiling)},
      {"modulus_to_enter", number_or_word(row.modulus_to_enter)},
      {"settled_error", number_or_word(row.settled_error)},
      {"rest_moves", row.rest_moves},
      {"volume_kept", number_or_word(row.volume_kept)},
      {"momentum_made",
       {{"linear", number_or_word(row.momentum.linear)}, {"angular", number_or_word(row.momentum.angular)}}},
      {"modes", modes_json(row.modes)},
      {"observed", row.observed ? Json{{"stiffness_shown", number_or_word(row.observed->stiffness_shown)},
                                       {"modes", modes_json(row.observed->modes)}}
                                : Json()},
      {"gap", number_or_word(row.gap)},
      {"contradiction", row.contradiction},
      {"steps", row.steps},
      {"status", row.status}};
}

Json to_json(const ShownDamping& row) {
  return {{"method", row.method.id},
          {"options", parameters_json(row.method.parameters)},
          {"h", row.h},
          {"modes", modes_json(row.modes)},
          {"growth", number_or_word(row.growth)},
          {"status", row.status}};
}

Json fidelity_json(const Problem& problem, double rate, const std::vector<Fidelity>& rows) {
  Json list = Json::array();
  for (const Fidelity& row : rows) list.push_back(to_json(row));
  return {{"model", problem.id}, {"rate", rate}, {"rows", list}};
}

}  // namespace hmax
