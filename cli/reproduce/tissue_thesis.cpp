/// Sections of `hmax reproduce tissue` on the statements of the thesis: strain, volume, stages, eigenvalues,
/// statics.
#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "analysis/amplification/limits.hpp"
#include "catalogue/methods/catalogue.hpp"
#include "catalogue/models/equilibria/body_balance.hpp"
#include "cli/reproduce/tissue_page.hpp"
#include "cli/shared/region_shape.hpp"
#include "limits/linearised_problem.hpp"
#include "plots/curves.hpp"
#include "plots/stability.hpp"
#include "studies/organ_rates.hpp"
#include "studies/organ_study.hpp"
#include "studies/particle_limits.hpp"
#include "studies/thigh/local_model.hpp"

namespace hmax {

using Json = nlohmann::ordered_json;

void turned_body(TissuePage& tissue) {
  const std::vector<TurnedBody> bodies = turned_bodies("phantom");
  Panel panel{.x = {.label = "angle [degree]"}, .y = {.label = "elastic energy / (E V) [1]"}};
  double linear = 0, others = 0;
  int k = 0;
  for (const TurnedBody& body : bodies) {
    panel.curves.push_back(
        {.label = body.model, .x = body.angle, .y = body.energy, .style = family_style(k++, true)});
    double& most = body.model == "fem_cauchy" ? linear : others;
    for (const double energy : body.energy) most = std::max(most, std::abs(energy));
  }
  tissue.page.draw(
      {.title = "A body that is turned as a whole: small strain takes the turn for a deformation",
       .panels = {panel},
       .footer = "phantom, free, nu = 0.3; turned about an axis through its middle",
       .panel_height = 300},
      "turned_body");
  tissue.page.values["rotation"] = {{"linear", linear}, {"others", others}};
}

void kept_volume(TissuePage& tissue) {
  constexpr double displacement = 0.005;  // [m]
  const std::vector<PressedVolume> rows = pressed_volumes("phantom", displacement);
  tissue.page.values["volume"] = {{"pressed", displacement},
                                  {"bodies", rows},
                                  {"gain", rows[1].lost / rows[3].lost},
                                  {"springs", rows[0].lost}};
}

void order_and_stages(TissuePage& tissue) {
  for (const char* id :
       {"explicit_euler", "rk2_heun", "rk2_midpoint", "rk3_kutta", "rk4", "dormand_prince_54", "dop_853"}) {
    const Method& method = find_method(id);
    const StabilityLimits limits = stability_limits(*method.amplification);
    tissue.page.values["stages"].push_back({{"method", method.id},
                                            {"stages", method.stages},
                                            {"order", method.order},
                                            {"imaginary", limits.imaginary},
                                            {"real", limits.real}});
  }
}

namespace {

/// h lambda of every mode.
Curve eigenvalues_of(const ParticleBody& body, double h, int k) {
  Curve curve{.label = fmt::format("{:g} g", 1000 * body.particle_mass), .line = false};
  curve.style = family_style(k, false);
  curve.style.marker = 5 + 2 * k;
  curve.style.size = 0.4;
  const Linearised near = linearised(particle_problem(body));
  for (const auto lambda : near.modes.spectrum.lambda) {
    curve.x.push_back(h * lambda.real());
    curve.y.push_back(h * lambda.imag());
  }
  return curve;
}

}  // namespace

void regions_and_eigenvalues(TissuePage& tissue) {
  constexpr double h = 1.0 / 280;
  const PlaneWindow window{-4, 1, -3.5, 3.5};
  const PlaneFrame frame = equal_frame({window.re_from, window.re_to}, {window.im_from, window.im_to}, 1);
  std::vector<RegionShape> shapes;
  std::vector<Method> chosen;
  Json ids = Json::array(), masses = Json::array();
  for (const char* id : {"explicit_euler", "rk2_heun", "rk4"}) {
    ids.push_back(id);
    chosen.push_back(find_method(id));
    shapes.push_back(shape_of(id, region_boundary(stable_at(*chosen.back().amplification), window)));
  }
  Panel panel = regions_panel(shapes, frame);
  ParticleBody body{.mesh = tissue.options.mesh(), .damper_time = 0.002};
  int k = 3;
  for (const double mass : {0.005, 0.02, 0.1}) {
    body.particle_mass = mass;
    panel.curves.push_back(eigenvalues_of(body, h, k++));
    std::vector<double> rates = stable_step_rates(chosen, body);
    for (double& rate : rates)
      if (std::isinf(rate)) rate = NAN;  // no step is stable
    masses.push_back({{"mass", mass}, {"rates", rates}});
  }
  tissue.page.values["regions"] = {{"methods", ids}, {"masses", masses}};
  tissue.page.draw({.title = "A larger mass draws the eigenvalues towards zero, and into the regions",
                    .panels = {panel},
                    .footer = fmt::format(
                        "springs on the {}, E = {:g} Pa, dampers along them, {:g} s times their stiffness; "
                        "h = 1/280 s; points outside of the frame are not shown",
                        body.mesh, body.young, body.damper_time),
                    .panel_height = frame.height},
                   "regions_and_eigenvalues");
}

void inner_systems(TissuePage& tissue, const StaticModel& model) {
  const std::vector<InnerTolerance> rows = inner_tolerances(model, best_relaxation(model, {}));
  Json ways = Json::array();
  for (const InnerTolerance& row : rows)
    ways.push_back({{"method", name_of(row.method)},
                    {"tolerance", row.tolerance},
                    {"converged", row.converged},
                    {"iterations", row.iterations},
                    {"sweeps", row.sweeps},
                    {"seconds", row.seconds}});
  const auto gain = [&](StaticMethod method) {
    double loose = 0, tight = 0;
    for (const InnerTolerance& row : rows) {
      if (row.method == method && row.tolerance == 0.1) loose = row.seconds;
      if (row.method == method && row.tolerance == 1e-4) tight = row.seconds;
    }
    return tight / loose;
  };
  tissue.page.values["inner_systems"] = {{"ways", ways},
                                         {"modified", gain(StaticMethod::modified_newton)},
                                         {"newton", gain(StaticMethod::newton)}};
}

void pre_inversion(TissuePage& tissue, const StaticModel& model) {
  tissue.page.values["pre_inversion"] = linear_solutions(model);
}

void pseudo_dynamics(TissuePage& tissue, const StaticModel& model) {
  constexpr int frames = 60;
  tissue.page.values["pseudo_dynamics"] = {{"frames", frames}, {"budgets", frame_budgets(model, frames)}};
}

void constant_jacobian(TissuePage& tissue) {
  constexpr const char* material = "male_normal";
  std::vector<std::string> meshes{"phantom"};
  if (!tissue.options.quick) meshes.emplace_back("liver");
  const std::vector<ConstantJacobian> rows = constant_jacobians(meshes, material);
  tissue.page.values["constant_jacobian"] = {
      {"stable", std::ranges::all_of(rows, &ConstantJacobian::reached_end)},
      {"bodies", rows},
      {"newton_rate", newton_rate(meshes.back(), material)},
      {"mesh", meshes.back()}};
}

void force_feedback(TissuePage& tissue) {
  constexpr double from = 0.3, to = 0.45;  // [s]
  const HapticContact contact;
  const std::vector<HapticForce> forces = haptic_forces(true_thigh(4, 4), contact);
  Panel panel{.x = {.label = "t [s]"}, .y = {.label = "force on the hand [N]"}};
  int k = 0;
  for (const HapticForce& each : forces) {
    Curve curve{.label = each.name, .style = family_style(k++, false)};
    for (std::size_t i = 0; i < each.t.size(); ++i)
      if (each.t[i] >= from && each.t[i] <= to) {
        curve.x.push_back(each.t[i]);
        curve.y.push_back(each.force[i]);
      }
    panel.curves.push_back(std::move(curve));
  }
  const HapticForce &held = forces.at(2), &local = forces.at(4);
  tissue.page.values["feedback"] = {
      {"forces", forces}, {"error", local.rms / held.rms}, {"change", local.jump / held.jump}};
  tissue.page.draw(
      {.title = "A local model smooths what the hand feels between two frames",
       .panels = {panel},
       .footer = fmt::format(
           "thigh of 16 points, pressed by {:g} mm and shaken by {:g} mm at {:g} Hz; contact {:g} N/m",
           1000 * contact.depth, 1000 * contact.shake, contact.frequency, contact.stiffness),
       .panel_height = 320},
      "force_feedback");
}

}  // namespace hmax
