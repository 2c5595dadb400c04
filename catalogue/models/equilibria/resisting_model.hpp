/// The mesh model that helps where elements are crushed or inverted.
#pragma once

#include <optional>

#include "catalogue/methods/method.hpp"
#include "problems/tissue/tissue_model.hpp"

namespace hmax {

/// The first mesh model whose elements resist being crushed as well as inversion; null where `model` does.
const TissueModel* resisting_model(const TissueModel& model);
/// The same body with that model, under the same name; nothing where there is none, and of springs.
std::optional<Problem> with_resisting_model(const Problem& problem);

}  // namespace hmax
