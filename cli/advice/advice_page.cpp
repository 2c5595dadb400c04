#include "cli/advice/advice_page.hpp"

#include <cmath>
#include <ctime>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/chrono.h>
#include <fmt/format.h>

#include "analysis/spectrum/extreme_eigenvalues.hpp"
#include "catalogue/models/equilibria/body_balance.hpp"
#include "cli/bodies/body_picture.hpp"
#include "core/errors.hpp"
#include "limits/modes/fastest_mode.hpp"
#include "plots/figure.hpp"
#include "plots/pages/markdown_text.hpp"
#include "plots/pages/store_report.hpp"
#include "problems/tissue/body.hpp"
#include "results/build_info.hpp"
#include "results/json.hpp"
#include "results/table.hpp"

namespace hmax {

namespace {

std::string answer_section(const AdviceText& text) {
  std::string markdown = fmt::format("## Answer\n\n**{}**\n\n", markdown_text(text.answer));
  if (!text.help.empty()) markdown += markdown_text(text.help) + "\n\n";
  return markdown + markdown_facts(text.facts) + markdown_list(text.remedies);
}

/// The methods that do not suit, where there are some, and the model.
std::string sections_after(const AdviceText& text, const AdviceKey& question) {
  std::string markdown;
  std::vector<std::string> reasons = text.reasons;
  if (!text.left_out.empty()) reasons.push_back(text.left_out);
  if (!reasons.empty()) markdown += "## Methods that do not suit\n\n" + markdown_list(reasons);
  if (!text.notes.empty()) markdown += "## Missing numbers\n\n" + markdown_list(text.notes);
  return markdown + "## Model\n\n" +
         markdown_facts({{"model", question.problem},
                         HMAX_KEYS(question, material, parameters),
                         {"motion", text.motion}});
}

std::vector<AdviceRecord> with_key(std::vector<AdviceRecord> rows, const AdviceKey& key) {
  for (AdviceRecord& row : rows) {
    row.key = key;
    row.session = 1;
  }
  return rows;
}

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
  if (!part || !part->symmetric || factors_take_seconds(problem)) return std::nullopt;
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

void write_advice_page(const std::filesystem::path& file, const AdviceText& text, const AdviceKey& question,
                       const std::vector<AdviceRecord>& rows, const std::string& scene) {
  const std::string now = fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr)));
  ReportedStore answer{.name = "this answer",
                       .advice = with_key(rows, question),
                       .sessions = {{.id = 1, .started = now, .fingerprint = fingerprint()}}};
  if (!scene.empty()) answer.scenes.push_back({.key = question, .scene = scene, .session = 1});
  const AnswerSections sections{
      .title =
          fmt::format("{}{}{} at {} Hz: integrator and step size", title_of(question.problem),
                      question.material.empty() ? "" : ", ", question.material, short_number(question.rate)),
      .introduction = (text.body.empty() ? "" : text.body + ". ") +
                      "Which integrator, and how large a step? " + text.question,
      .before = answer_section(text),
      .after = sections_after(text, question),
      .table = markdown_rows(text.table)};
  write_file(file, answer_report(answer, sections, build_info().version).html);
}

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
