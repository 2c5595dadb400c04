#include "limits/documents/probe_json.hpp"

#include <cmath>
#include <complex>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "limits/documents/number_json.hpp"

namespace hmax {

namespace {

using Json = nlohmann::ordered_json;

Json complex_or_null(std::complex<double> value) {
  if (!std::isfinite(value.real()) || !std::isfinite(value.imag())) return {};
  return {{"re", value.real()}, {"im", value.imag()}};
}

}  // namespace

Json probe_json(const ProbedLimit& found) {
  Json rows = Json::array();
  for (const StepSpectrum& row : found.rows)
    rows.push_back({{"h", row.h},
                    {"spectral_radius", number_or_word(row.spectral_radius)},
                    {"grows", row.grows},
                    {"growing", row.grows ? complex_or_null(row.multiplier) : Json()},
                    {"tolerance", row.tolerance}});
  return {{"model", found.model},
          {"dim", found.dim},
          {"state", name_of(found.state)},
          {"rows", rows},
          {"h_max", number_or_word(found.h_max)},
          {"moving", found.moving},
          {"observed", number_or_word(found.observed)},
          {"gap", number_or_word(found.gap)},
          {"steps", found.steps},
          {"contradiction", found.contradiction},
          {"status", found.status.empty() ? Json() : Json(fmt::format("{}", fmt::join(found.status, "; ")))}};
}

}  // namespace hmax
