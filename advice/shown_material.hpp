/// What the steps of rows show of the material of a body: beside each row, and in its status.
#pragma once

#include <optional>
#include <span>

#include "advice/advice.hpp"
#include "limits/fidelity/fidelity.hpp"

namespace hmax {

/// A row shows another material than its model where its stiffness is off by more than this share.
inline constexpr double unlike_stiffness = 0.05;
bool shows_other_material(const AdviceRow& row);

/// The body of a question in its equilibrium under the shares of the loads that its motion has. Nothing of
/// other problems, of motions of the user, and where fidelity_model() knows none.
std::optional<FidelityModel> material_model(const Problem& problem, const AdviceQuestion& question,
                                            const Advice& advice, const Watcher& watcher);

/// Fills the stiffness shown of rows that are stable at their steps: 1 of those whose steps stay in the
/// equilibrium of the model; of the others what fidelity() finds, with the damping and frequencies of their
/// slow modes. Where they show another material their status says so, with the most that they can show, and
/// what as many substeps of one iteration do.
/// @param most  elapsed time [s]; rows that are not reached say so
void tell_material(std::span<AdviceRow> rows, const FidelityModel& model, double most,
                   const Watcher& watcher);

}  // namespace hmax
