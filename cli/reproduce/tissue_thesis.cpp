/// Sections of `hmax reproduce tissue` on the statements of the thesis: strain, volume, stages, eigenvalues,
/// statics.
#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "analysis/amplification/limits.hpp"
#include "catalogue/methods/catalogue.hpp"
#include "cli/reproduce/tissue_page.hpp"
#include "cli/stability/stability_pictures.hpp"
#include "plots/curves.hpp"
#include "plots/stability.hpp"
#include "results/json.hpp"
#include "studies/organ_rates.hpp"
#include "studies/organ_study.hpp"
#include "studies/particle_limits.hpp"
#include "studies/thigh/local_model.hpp"

namespace hmax {

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
  tissue.judge("no_rotation", judged(linear > 0.01), {{"linear", linear}});
  tissue.judge("rotation_is_free", judged(others < 1e-10), {{"others", others}});
}

void kept_volume(TissuePage& tissue) {
  constexpr double displacement = 0.005;  // [m]
  const std::vector<PressedVolume> rows = pressed_volumes("phantom", displacement);
  tissue.page.values["volume"] = {{"pressed", displacement},
                                  {"bodies", rows},
                                  {"gain", rows[1].lost / rows[3].lost},
                                  {"springs", rows[0].lost}};
  tissue.judge("dilatation", judged(rows[1].lost > rows[2].lost && rows[2].lost > rows[3].lost),
               {{"least", rows[3].lost}, {"most", rows[1].lost}});
  // Tissue keeps its volume: what a model loses of it is not real.
  const double more = rows[0].lost / rows[3].lost;
  tissue.judge("springs_are_unrealistic", judged(more > 1.5), {{"more", more}});
  tissue.judge("springs_are_more_realistic", judged(more < 1), {{"more", more}, {"springs", rows[0].lost}});
}

namespace {

/// Orders of explicit Runge-Kutta methods over their stages, beside the least number of stages.
/// @param methods  stages and order of each
void order_figure(TissuePage& tissue, const std::vector<std::array<int, 2>>& methods) {
  // The least number of stages of an explicit method of order 1 to 8 [hairer1993solving, II.5].
  constexpr std::array least{1, 2, 3, 4, 6, 7, 9, 11};
  Curve bound{.label = "least possible", .style = {.colour = 7, .dash = 1, .width = 1.4}};
  for (std::size_t p = 0; p < least.size(); ++p) {
    bound.x.push_back(least[p]);
    bound.y.push_back(static_cast<double>(p + 1));
  }
  Curve ours{.label = "methods of hmax", .style = {.colour = 0, .marker = 7}, .line = false};
  for (const auto& [stages, order] : methods) {
    ours.x.push_back(stages);
    ours.y.push_back(order);
  }
  Panel panel{.x = {.label = "stages [1]"}, .y = {.label = "order [1]", .range = Range{0.5, 8.5}}};
  panel.curves = {bound, ours};
  tissue.page.draw({.title = "Beyond order 4 an order costs more than a stage",
                    .panels = {panel},
                    .footer = "explicit Runge-Kutta methods; stages of an error estimate count",
                    .panel_height = 280},
                   "order_and_stages");
}

}  // namespace

void order_and_stages(TissuePage& tissue) {
  std::vector<std::array<int, 2>> all;
  for (const Method& method : choose_methods({"explicit_runge_kutta"}, {}))
    all.push_back({method.stages, method.order});
  order_figure(tissue, all);
  for (const char* id :
       {"explicit_euler", "rk2_heun", "rk2_midpoint", "rk3_kutta", "rk4", "dormand_prince_54", "dop_853"}) {
    const Method& method = find_method(id);
    const StabilityLimits limits = stability_limits(*method.amplification);
    tissue.page.values["stages"].push_back(
        {{"method", method.id}, HMAX_KEYS(method, stages, order), HMAX_KEYS(limits, imaginary, real)});
  }
}

namespace {

/// h lambda of every mode.
Curve eigenvalues_of(const ParticleBody& body, double h) {
  Curve curve{.label = "eigenvalues", .style = {.colour = 6}, .line = false};
  curve.style.marker = 7;
  curve.style.size = 0.5;
  for (const auto z : scaled_eigenvalues(body, h)) {
    curve.x.push_back(z.real());
    curve.y.push_back(z.imag());
  }
  return curve;
}

/// |1 + h lambda| < 1 for every eigenvalue is h < -2 Re lambda / |lambda|^2, beside the limit that is
/// predicted.
void euler_by_eigenvalues(TissuePage& tissue, const ParticleBody& body, double rate) {
  double h = INFINITY;
  for (const auto lambda : scaled_eigenvalues(body, 1))
    h = std::min(h, -2 * lambda.real() / std::norm(lambda));
  tissue.judge("one_plus_z", judged(std::abs(h * rate - 1) < 1e-6), {{"h", h}, {"predicted", 1 / rate}});
}

}  // namespace

void regions_and_eigenvalues(TissuePage& tissue) {
  constexpr double h = 1.0 / 280;
  constexpr std::array masses{0.001, 0.005, 0.02};  // of a particle [kg]
  const PlaneWindow window{-4, 1, -3.5, 3.5};
  const PlaneFrame frame = equal_frame({window.re_from, window.re_to}, {window.im_from, window.im_to},
                                       static_cast<int>(masses.size()));
  std::vector<RegionShape> shapes;
  std::vector<Method> chosen;
  Json ids = Json::array(), rows = Json::array();
  for (const char* id : {"explicit_euler", "rk2_heun", "rk4"}) {
    ids.push_back(id);
    chosen.push_back(find_method(id));
    shapes.push_back(shape_of(id, region_boundary(stable_at(*chosen.back().amplification), window)));
  }
  Figure figure{.panel_height = frame.height};
  figure.columns = static_cast<int>(masses.size());
  ParticleBody body{.mesh = tissue.options.mesh(), .damper_time = 0.002};
  std::vector<std::vector<double>> rates;  // of each mass, of each method
  for (const double mass : masses) {
    body.particle_mass = mass;
    Panel panel = regions_panel(shapes, frame);
    panel.title = fmt::format("particles of {:g} g", 1000 * mass);
    panel.notes = {};
    panel.curves.push_back(eigenvalues_of(body, h));
    figure.panels.push_back(std::move(panel));
    rates.push_back(stable_step_rates(chosen, body));
    rows.push_back({{"mass", mass}, {"rates", rates.back()}});
  }
  // Which verdicts at h a larger mass changes.
  std::vector<std::string> entered, outside;
  for (std::size_t k = 0; k < chosen.size(); ++k) {
    if (rates.back()[k] * h > 1 + 1e-9) outside.push_back(chosen[k].id);
    if (rates.front()[k] * h > 1 + 1e-9 && rates.back()[k] * h <= 1 + 1e-9) entered.push_back(chosen[k].id);
  }
  figure.title = "A larger mass draws the eigenvalues towards zero" +
                 (entered.empty() ? std::string(", and changes no verdict at this step")
                                  : fmt::format(", and into the regions of {}", fmt::join(entered, " and ")));
  figure.footer = fmt::format(
      "springs on the {}, E = {:g} Pa, dampers along them, {:g} s times their stiffness; h = 1/280 s; points "
      "outside of the frame are not shown",
      body.mesh, body.young, body.damper_time);
  tissue.page.values["regions"] = {
      {"methods", ids}, {"masses", rows}, {"entered", entered}, {"outside", outside}};
  tissue.page.draw(figure, "regions_and_eigenvalues");
  const double heavier = std::sqrt(masses.back() / masses.front());
  tissue.judge("step_is_limited", judged(rates.front()[2] > 1.1 * rates.back()[2]),
               {{"lighter", rates.front()[2] / rates.back()[2]}, {"root", heavier}});
  tissue.judge("mass_or_small_steps", judged(outside.empty(), !entered.empty()),
               {{"entered", entered}, {"euler", rates.back()[0]}});
  euler_by_eigenvalues(tissue, body, rates.back()[0]);
}

void inner_systems(TissuePage& tissue, const StaticModel& model) {
  const std::vector<InnerTolerance> rows = inner_tolerances(model, best_relaxation(model, {}));
  Json ways = Json::array();
  for (const InnerTolerance& row : rows)
    ways.push_back(
        {{"method", name_of(row.method)}, HMAX_KEYS(row, tolerance, converged, iterations, sweeps, seconds)});
  const auto row_of = [&](StaticMethod method, double tolerance) {
    return *std::ranges::find_if(
        rows, [&](const InnerTolerance& row) { return row.method == method && row.tolerance == tolerance; });
  };
  constexpr double rough = 0.5, loose = 0.1, tight = 1e-4;
  const auto slower = [&](StaticMethod method) {
    return row_of(method, tight).seconds / row_of(method, loose).seconds;
  };
  const double modified = slower(StaticMethod::modified_newton), newton = slower(StaticMethod::newton);
  const AccurateSolution cost = accurate_solution(rows);
  double shortest = INFINITY;
  for (const InnerTolerance& row : rows)
    if (row.method == StaticMethod::newton) shortest = std::min(shortest, row.seconds);
  const double best = shortest / row_of(StaticMethod::newton, rough).seconds;
  const std::vector<LoadedIterations> loads =
      loaded_iterations(tissue.options.mesh(), study_material, {0.05, 0.1, 0.2, 0.4});
  tissue.page.values["inner_systems"] = {{"ways", ways},
                                         {"modified", modified},
                                         {"newton", newton},
                                         HMAX_KEYS(cost, iteration, needed),
                                         {"cheap", cost.iteration < cost.needed},
                                         {"loads", loads}};
  const int exact = row_of(StaticMethod::newton, tight).iterations,
            inexact = row_of(StaticMethod::modified_newton, tight).iterations;
  tissue.judge("newton_converges_faster", judged(exact < inexact),
               {{"newton", exact}, {"modified", inexact}});
  tissue.judge("accuracy_is_no_gain", judged(modified >= 1), {{"slower", modified}});
  tissue.judge("accuracy_is_a_gain", judged(newton < 1, best < 0.95),
               {{"slower", newton}, {"best", best}, HMAX_KEYS(cost, iteration, needed)});
  const auto more = [](const LoadedIterations& at) { return double(at.modified) / at.newton; };
  tissue.judge("strong_nonlinearity", judged(more(loads.back()) > more(loads.front())),
               {{"weak", loads.front()}, {"strong", loads.back()}});
}

void pre_inversion(TissuePage& tissue, const StaticModel& model) {
  const LinearSolutions found = linear_solutions(model);
  tissue.page.values["pre_inversion"] = found;
  tissue.judge("pre_inverted", judged(found.multiply < found.solve),
               {{"ratio", found.solve / found.multiply}, {"bytes", found.inverse_bytes}});
}

void pseudo_dynamics(TissuePage& tissue, const StaticModel& model) {
  constexpr int frames = 60;
  tissue.page.values["pseudo_dynamics"] = {{"frames", frames}, {"budgets", frame_budgets(model, frames)}};
}

void constant_jacobian(TissuePage& tissue) {
  std::vector<std::string> meshes{"phantom"};
  if (!tissue.options.quick) meshes.emplace_back("liver");
  const std::vector<ConstantJacobian> rows = constant_jacobians(meshes, study_material);
  const ConstantJacobian& springs = rows.back();
  const double rate = newton_rate(meshes.back(), study_material);
  tissue.page.values["constant_jacobian"] = {
      {"stable", std::ranges::all_of(rows, &ConstantJacobian::reached_end)},
      {"bodies", rows},
      {"newton_rate", rate},
      {"mesh", meshes.back()}};
  tissue.judge("springs_at_150_hz", judged(springs.reached_end && springs.rate > 150),
               {HMAX_KEYS(springs, springs, rate, mesh)});
  tissue.judge("sixty_iterations", judged(rate > 60), {{"rate", rate}});
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
  tissue.judge("local_model_helps", judged(local.jump < held.jump && local.rms < held.rms),
               {{"error", local.rms / held.rms}, {"change", local.jump / held.jump}});
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
