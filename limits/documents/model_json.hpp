/// Facts of models for programs and for words: the keys of `models` in `hmax stability predict --json`.
#pragma once

#include <optional>
#include <string>

#include <nlohmann/json.hpp>

#include "catalogue/methods/method.hpp"
#include "catalogue/models/body_summary.hpp"
#include "catalogue/models/equilibria/support_advice.hpp"
#include "limits/point/operating_point.hpp"

namespace hmax {

/// `{E, nu, rho, fibre_E, regions, mass, size, points, fixed, held_by_springs, gravity, most_compression_pa,
/// weight_compression_pa, unusual}`; null of what is no body.
nlohmann::ordered_json body_json(const Problem& problem);
nlohmann::ordered_json body_json(const BodySummary& body);

/// `{axis, sag, axis_now, sag_now}`; null where no other end is suggested.
nlohmann::ordered_json suggested_support_json(const std::optional<SuggestedSupport>& suggested);

/// `{files, unknowns, rows, mass_sum, ..}`; null of what has no matrices.
nlohmann::ordered_json matrices_json(const Problem& problem);

/// The fastest mode of a body at rest: its element, the ratios by which bounds of it make steps too small,
/// and what changes would gain.
nlohmann::ordered_json fastest_mode_json(const Problem& problem, const Linearised& near);

/// Which facts of a model are looked for; each with those before it.
enum class ModelFacts {
  state,         ///< those that cost nothing
  fastest_mode,  ///< of a body
  all,           ///< eigenvalues, non-normality, what its files hold
};

/// A model near a state.
nlohmann::ordered_json model_json(const Problem& problem, const Linearised& near, ModelFacts facts);

/// Whether limits along a path stand in the rows of a model, and not only the reason why there are none.
/// @param model  of model_json() with `along` of the query
bool has_limits_along(const nlohmann::ordered_json& model);

/// Why the state is not the one that was asked for, and what of the load is not in the limits there.
/// @param model  as above
std::string status_of_state(const nlohmann::ordered_json& model, const Problem& problem);

}  // namespace hmax
