#include "catalogue/models/equilibria/resisting_model.hpp"

#include <algorithm>
#include <utility>

#include "catalogue/models/tissue_problem.hpp"
#include "problems/tissue/body.hpp"

namespace hmax {

const TissueModel* resisting_model(const TissueModel& model) {
  const auto other = std::ranges::find(tissue_models(), true, &TissueModel::resists_crushing);
  return model.resists_crushing || other == tissue_models().end() ? nullptr : &*other;
}

std::optional<Problem> with_resisting_model(const Problem& problem) {
  TissueSettings settings = settings_of(problem);
  const TissueModel* other = resisting_model(settings.model);
  if (!other || settings.model.is_of_springs()) return std::nullopt;
  settings.model = *other;
  return with_settings(problem, std::move(settings));
}

}  // namespace hmax
