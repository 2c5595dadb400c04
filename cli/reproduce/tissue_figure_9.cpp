/// The section of `hmax reproduce tissue` on figure 9 of the liver study: a liver over stiffness and damping.
#include <array>
#include <set>

#include <fmt/format.h>

#include "catalogue/methods/catalogue.hpp"
#include "catalogue/models/equilibria/body_balance.hpp"
#include "cli/bodies/body_picture.hpp"
#include "cli/reproduce/tissue_page.hpp"
#include "core/errors.hpp"
#include "problems/tissue/body.hpp"
#include "problems/tissue/sofa_scene.hpp"
#include "results/table.hpp"

namespace hmax {

namespace {

constexpr double frame_step = 0.005, shown_time = 1;  // [s]
constexpr double drawn_force = 0.3;                   // [N]

/// A liver of the table's stiffness k [kPa] and damping c [N s/m], as c over its mass.
struct Shown {
  double k, c;
};
// One row of stiffnesses with the damping between, one of dampings with the stiffness between.
constexpr std::array<Shown, 6> shown_livers{{{4.3, 6}, {5.3, 6}, {6.7, 6}, {5.3, 4.5}, {5.3, 6}, {5.3, 8}}};

/// The farthest that the body goes when the force begins to act.
BodyView farthest(const Problem& problem) {
  const TissueBody& body = *problem.body;
  double most = -1, at = 0;
  Eigen::VectorXd q = Eigen::VectorXd::Zero(body.dofs());
  const RunRecord record = find_method("linearly_implicit_euler")
                               .bind(problem)
                               .run({.t_end = shown_time, .h = frame_step},
                                    [&](double t, const Eigen::Ref<const Eigen::VectorXd>& y) {
                                      const double displacement = largest_displacement(y.head(body.dofs()));
                                      if (displacement <= most) return;
                                      most = displacement;
                                      at = t;
                                      q = y.head(body.dofs());
                                    });
  if (record.outcome != Outcome::reached_end)
    throw InputError(fmt::format("{} ended at t = {:g} s; this is a defect", problem.id, record.t));
  BodyView view = body_view(body, at, q, BodyValue::displacement);
  view.notes = {fmt::format("{:.3g} mm at t = {:.3g} s", 1000 * most, at)};
  return view;
}

}  // namespace

void figure_9(TissuePage& tissue) {
  std::set<std::string> scenes;
  for (const char* model : {"mass_spring", "fem_green"}) {
    BodyPicture bodies{
        .title = model == std::string_view("mass_spring")
                     ? "Springs: the farthest that the body goes when a force begins to press"
                     : "Finite elements: the farthest that the body goes when a force begins to press",
        .columns = 3};
    for (const Shown& each : shown_livers) {
      const Problem problem =
          study_tissue(model, tissue.options.mesh(), "press",
                       {{"E", 1000 * each.k}, {"alpha", each.c / 1.45}, {"force", drawn_force}});
      bodies.views.push_back(farthest(problem));
      bodies.views.back().title = fmt::format("k = {:g} kPa, c = {:g} N s/m", each.k, each.c);
      bodies.caption = made_of(problem) +
                       fmt::format(
                           " {:g} N press. Rayleigh damping alpha = c / (1.45 kg); linearly_implicit_euler, "
                           "h = {:g} s. E and alpha as above each picture.",
                           drawn_force, frame_step);
      const std::string name = fmt::format("figure_9_{}_k{:g}_c{:g}.scn", model, each.k, each.c);
      write_file(tissue.page.folder / name, sofa_text(*problem.body, {frame_step}));
      if (!scenes.insert(name).second) continue;
      tissue.page.link(name, name);
      tissue.page.values["scenes"].push_back(name);
    }
    bodies.colours = colours_of(BodyValue::displacement, bodies.views);
    tissue.draw(bodies, fmt::format("figure_9_{}", model));
  }
}

}  // namespace hmax
