#include "cli/bodies/body_scene.hpp"

#include <cmath>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "analysis/spectrum/extreme_eigenvalues.hpp"
#include "catalogue/models/equilibria/body_balance.hpp"
#include "cli/bodies/body_picture.hpp"
#include "core/errors.hpp"
#include "limits/modes/fastest_mode.hpp"
#include "problems/tissue/body.hpp"
#include "results/table.hpp"

namespace hmax {

namespace {

/// A shape of the free points on all points of the mesh.
std::vector<SpacePoint> on_all_points(const TissueBody& body, const Eigen::VectorXd& shape) {
  std::vector<SpacePoint> all(static_cast<std::size_t>(body.mesh().point_count()), SpacePoint{});
  for (std::size_t i = 0; i < body.free_points().size(); ++i) {
    const Eigen::Vector3d u = shape.segment<3>(3 * static_cast<Eigen::Index>(i));
    all[static_cast<std::size_t>(body.free_points()[i])] = {u.x(), u.y(), u.z()};
  }
  return all;
}

double hertz(double kappa) { return std::sqrt(kappa) / (2 * std::numbers::pi); }

SceneMode fastest_mode(const Problem& problem, const Linearised& near) {
  const TissueBody& body = *problem.body;
  const FastestMode mode = fastest_mode_of(body, near, false);
  const NamedElement owner = named_element(problem, mode.owner.element);
  return {.words = "fastest mode at rest, which limits explicit steps",
          .frequency = hertz(mode.kappa),
          .shape = on_all_points(body, mode.shape),
          .owner = {mode.points.begin(), mode.points.end()},
          .owner_words = fmt::format("{} has {} % of its energy", in_words(owner),
                                     short_number(100 * mode.owner.share, 3))};
}

/// Nothing where it takes long, and of a body that moves as one.
std::optional<SceneMode> slowest_mode(const Problem& problem, const Linearised& near) {
  const auto& part = near.point.model.mechanical;
  if (!part || !part->symmetric || problem.body->dofs() > most_cheaply_factored) return std::nullopt;
  const ExtremeStiffnesses slowest = smallest_stiffnesses(*part, 1);
  if (!slowest.converged || slowest.kappa.empty() || !(hertz(slowest.kappa.front()) >= 1e-3))
    return std::nullopt;
  return SceneMode{.words = "slowest mode at the start of the motion",
                   .frequency = hertz(slowest.kappa.front()),
                   .shape = on_all_points(*problem.body, slowest.shapes.col(0))};
}

SceneMotion scene_motion(const TissueBody& body, const ReferenceMotion& reference) {
  SceneMotion motion{.t = reference.t};
  const bool of_springs = body.settings().model.is_of_springs();
  for (std::size_t i = 0; i < reference.t.size(); ++i) {
    const double t = reference.t[i];
    const Eigen::VectorXd q = reference.y[i].head(body.dofs());
    motion.displacements.push_back(space_points(body.positions(t, q) - body.mesh().points));
    if (of_springs) continue;
    const Eigen::VectorXd density = body.point_energy_densities(t, q);
    motion.energy_density.emplace_back(density.begin(), density.end());
  }
  return motion;
}

}  // namespace

std::string body_scene_text(const AnalysedModel& model) {
  const Problem& problem = model.motion.problem;
  const TissueBody& body = *problem.body;
  BodyScene scene{
      .title = title_of(problem.id),
      .caption = fmt::format(
          "The test load: {}. Displacements are from the body without loads, those of the answer from the start of the motion.",
          model.motion.words),
      .points = space_points(body.mesh().points),
      .triangles = surface_triangles(body.mesh()),
      .held = held_points(body),
      .held_as = how_held(body),
      .motion = scene_motion(body, model.reference)};
  scene.modes.push_back(fastest_mode(problem, model.near));
  if (auto slowest = slowest_mode(problem, model.near)) scene.modes.push_back(*std::move(slowest));
  try {
    return scene_text(scene);
  } catch (const InputError&) {
    return {};
  }
}

}  // namespace hmax
