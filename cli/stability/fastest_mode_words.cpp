#include "cli/stability/fastest_mode_words.hpp"

#include <cmath>

#include <fmt/format.h>

#include "catalogue/models/equilibria/body_balance.hpp"
#include "cli/shared/console.hpp"
#include "core/size_limits.hpp"
#include "limits/modes/fastest_mode.hpp"
#include "problems/tissue/body.hpp"

namespace hmax {

namespace {

using Json = nlohmann::ordered_json;

bool tries_gains(const Problem& problem) { return problem.body->dofs() <= most_tried_gains; }

/// "2.8 % larger", or "no larger" where less than 0.01 % comes of it.
std::string growth_in_words(double factor) {
  const double percent = 100 * (factor - 1), size = std::abs(percent);
  if (size < 0.01) return "no larger";
  return fmt::format("{} % {}", size < 10 ? short_number(size, 2) : fmt::format("{:.0f}", size),
                     percent > 0 ? "larger" : "smaller");
}

}  // namespace

Json fastest_mode_json(const Problem& problem, const Linearised& near) {
  const FastestMode mode = fastest_mode_of(*problem.body, near, tries_gains(problem));
  const NamedElement owner = named_element(problem, mode.owner.element);
  const auto bound = [&](double kappa) {
    return Json{{"kappa", kappa}, {"pessimism", std::sqrt(kappa / mode.kappa)}};
  };
  return {{"kappa", mode.kappa},
          {"omega", std::sqrt(mode.kappa)},
          {"residual", mode.residual},
          {"bounds",
           {{"element", bound(mode.bounds.element)},
            {"nodal", bound(mode.bounds.nodal)},
            {"gershgorin", bound(mode.bounds.gershgorin)}}},
          {"element", owner.number},
          {"element_kind", owner.kind},
          {"points", owner.points},
          {"centre", {mode.centre.x(), mode.centre.y(), mode.centre.z()}},
          {"energy_share", mode.owner.share},
          {"elements_with_nine_tenths", mode.owner.elements},
          {"moving_points", mode.owner.moving_points},
          {"gain", tries_gains(problem)
                       ? Json{{"without_element", mode.without},
                              {"double_mass", mode.with_mass},
                              {"added_mass", mode.added_mass},
                              {"smoothed", mode.smoothed},
                              {"moved_point",
                               mode.moved_point ? Json(point_number(problem, *mode.moved_point)) : Json()}}
                       : Json()}};
}

std::string fastest_mode_in_words(const Problem& problem, const Linearised& near) {
  const FastestMode mode = fastest_mode_of(*problem.body, near, tries_gains(problem));
  const auto pessimism = [&](double kappa) { return short_number(std::sqrt(kappa / mode.kappa), 4); };
  const std::string fastest = fmt::format(
      "fastest mode at rest {} rad/s: {} has {} % of its energy, {} points move; bounds are larger by {} "
      "(elements), {} (points), {} (Gershgorin)\n",
      short_number(std::sqrt(mode.kappa)), in_words(named_element(problem, mode.owner.element)),
      short_number(100 * mode.owner.share, 3), short_number(mode.owner.moving_points, 3),
      pessimism(mode.bounds.element), pessimism(mode.bounds.nodal), pessimism(mode.bounds.gershgorin));
  if (!tries_gains(problem)) return fastest;
  return fmt::format(
      "{}the undamped h_max would be {} without that element, {} with twice its mass ({} % of the body), {} with {}\n",
      fastest, growth_in_words(mode.without), growth_in_words(mode.with_mass),
      short_number(100 * mode.added_mass, 3), growth_in_words(mode.smoothed),
      mode.moved_point
          ? fmt::format("point {} moved towards its neighbours", point_number(problem, *mode.moved_point))
          : "its points moved");
}

}  // namespace hmax
