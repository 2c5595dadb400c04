#include "catalogue/models/equilibria/inversion.hpp"

#include <fmt/format.h>

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

}  // namespace hmax
