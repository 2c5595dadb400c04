#include "catalogue/models/equilibria/inversion.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "catalogue/models/equilibria/body_balance.hpp"
#include "catalogue/models/tissue_problem.hpp"
#include "problems/tissue/body.hpp"

namespace hmax {

std::string in_words(const Inversion& inversion) {
  if (inversion.volume > 0)
    return fmt::format("tetrahedron {} is left {:.2g} % of its volume at t = {:.4g} s", inversion.tetrahedron,
                       100 * inversion.volume, inversion.t);
  return fmt::format("tetrahedron {} is inverted at t = {:.4g} s", inversion.tetrahedron, inversion.t);
}

std::optional<Inversion> inversion_at(const Problem& problem, double t,
                                      const Eigen::Ref<const Eigen::VectorXd>& y, double most) {
  if (!problem.body || y.size() < problem.body->dofs() || !y.allFinite()) return std::nullopt;
  const auto [volume, tetrahedron] = problem.body->least_volume(t, y.head(problem.body->dofs()));
  if (volume > most) return std::nullopt;
  return Inversion{.t = t, .tetrahedron = tetrahedron_number(problem, tetrahedron), .volume = volume};
}

const TissueModel* resisting_model(const TissueModel& model) {
  const auto other = std::ranges::find(tissue_models(), true, &TissueModel::resists_inversion);
  return model.resists_inversion || other == tissue_models().end() ? nullptr : &*other;
}

std::optional<Problem> with_resisting_model(const Problem& problem) {
  TissueSettings settings = problem.body->settings();
  const TissueModel* other = resisting_model(settings.model);
  if (!other || settings.model.is_of_springs()) return std::nullopt;
  settings.model = *other;
  return with_settings(problem, std::move(settings));
}

}  // namespace hmax
