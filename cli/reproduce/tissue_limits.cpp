/// The sections of `hmax reproduce tissue` on the steps that bodies bear.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "catalogue/methods/catalogue.hpp"
#include "cli/reproduce/tissue_page.hpp"
#include "limits/along/trajectory_limit.hpp"
#include "results/json.hpp"
#include "studies/particle_limits.hpp"

namespace hmax {

namespace {

// What the thesis printed of its explicit integration, and the study's liver:male_normal.
constexpr double printed_rate = 280;    // [1/s]
constexpr double printed_mass = 0.005;  // of a particle [kg]
constexpr double study_young = 5300;    // [Pa]
constexpr double study_damper = 6;      // [N s/m]

constexpr std::array particle_methods{"explicit_euler", "rk4", "symplectic_euler"};

/// One panel: a curve for each method over one of the numbers of a body.
struct RatePanel {
  std::string title, note;
  ParticleBody body;
  double ParticleBody::*over;
  std::string label;
  double unit;       ///< of the axis
  Range range;       ///< in that unit
  Range overturned;  ///< where the hanging body is turned inside out, in that unit
  int points;
};

Panel drawn(const RatePanel& wanted, std::span<const Method> methods, const Range& rates) {
  Panel panel{.title = wanted.title,
              .x = {.label = wanted.label, .logarithmic = true, .range = wanted.range},
              .y = {.label = "steps a second, at least [1/s]", .logarithmic = true, .range = rates},
              .notes = {wanted.note}};
  int k = 0;
  for (const Method& method : methods)
    panel.curves.push_back({.label = method.id, .style = family_style(k++)});
  ParticleBody body = wanted.body;
  for (const double at : logarithmic_places(wanted.range.low, wanted.range.high, wanted.points)) {
    body.*wanted.over = wanted.unit * at;
    const std::vector<double> found = stable_step_rates(methods, body);
    for (std::size_t i = 0; i < methods.size(); ++i) {
      panel.curves[i].x.push_back(at);
      panel.curves[i].y.push_back(found[i]);
    }
  }
  panel.curves.push_back({.label = fmt::format("{:g} steps/s", printed_rate),
                          .x = {wanted.range.low, wanted.range.high},
                          .y = {printed_rate, printed_rate},
                          .style = {.colour = 6, .dash = 3, .width = 1.2}});
  if (wanted.over == &ParticleBody::particle_mass)
    panel.marks.push_back(
        {printed_mass / wanted.unit,
         printed_rate,
         {.colour = 6, .marker = 13, .size = 1.1},
         fmt::format("{:g} steps/s at {:g} g, as printed", printed_rate, 1000 * printed_mass)});
  panel.fills.push_back({.label = "gravity inverts elements",
                         .loops = {{{wanted.overturned.low, rates.low},
                                    {wanted.overturned.high, rates.low},
                                    {wanted.overturned.high, rates.high},
                                    {wanted.overturned.low, rates.high}}},
                         .colour = 7,
                         .shade = 0.2});
  return panel;
}

std::string whole_words() { return fmt::format("one damper of {:g} N s/m on the body", study_damper); }
std::string springs_words() { return fmt::format("dampers of k / ({:g}/s) along the springs", printed_rate); }

/// The body of the figures without damping, with a damper on the whole, and with dampers along its springs.
struct DampedBodies {
  ParticleBody bare, whole, springs;

  explicit DampedBodies(const std::string& mesh)
      : bare{.mesh = mesh, .particle_mass = printed_mass, .young = study_young}, whole(bare), springs(bare) {
    whole.damper = study_damper;
    springs.damper_time = 1 / printed_rate;
  }
};

/// Limits of the three bodies: rows of the text, and of the document.
void add_limits(TissuePage& tissue, const DampedBodies& bodies, std::span<const Method> methods) {
  constexpr double low = 100, high = 1e6;  // E of the search [Pa]
  Json values{
      {"mesh", bodies.bare.mesh}, {"young", study_young}, {"spring", mean_spring_stiffness(bodies.bare)},
      {"rate", printed_rate},     {"mass", printed_mass}, {"heaviest", tissue.document["heaviest_particle"]}};
  std::map<std::pair<std::string, std::string>, std::pair<double, double>> found;  // rate, stiffest
  for (const auto& [damping, body] : {std::pair<std::string, const ParticleBody&>{"none", bodies.bare},
                                      {whole_words(), bodies.whole},
                                      {springs_words(), bodies.springs}}) {
    const std::vector<double> rates = stable_step_rates(methods, body);
    for (std::size_t i = 0; i < methods.size(); ++i) {
      double stiffest = stiffest_stable(methods[i], body, printed_rate, low, high);
      if (stiffest <= low) stiffest = 0;
      found[{damping, methods[i].id}] = {rates[i], stiffest};
      tissue.document["particles"].push_back(
          {{"damping", damping}, {"method", methods[i].id}, {"h_max", 1 / rates[i]}, {"stiffest", stiffest}});
      values["limits"].push_back({{"damping", damping},
                                  {"method", methods[i].id},
                                  {"unstable", std::isinf(rates[i])},
                                  {"needed", rates[i]},
                                  {"any", stiffest > 0},
                                  {"stiffest", stiffest}});
    }
  }
  values["rk4"] = found[{"none", "rk4"}].second;
  values["symplectic"] = found[{"none", "symplectic_euler"}].second;
  values["whole"] = found[{whole_words(), "explicit_euler"}].first;
  values["damped"] = found[{springs_words(), "explicit_euler"}].second;
  const double bare = found[{"none", "explicit_euler"}].first, damped = values["damped"];
  tissue.judge("rate_of_280", judged(bare <= printed_rate, damped > study_young),
               {{"damped", damped}, {"rk4", values["rk4"]}, {"symplectic", values["symplectic"]}});
  tissue.page.values["particles"] = values;
}

/// Steps a second over the mass of a particle and over the stiffness, for both kinds of damping.
Figure rates_figure(const DampedBodies& bodies, std::span<const Method> methods, double heaviest_particle,
                    const TissueOptions& options) {
  const double softest = study_young * printed_mass / heaviest_particle;
  Figure figure{.title = "Heavier particles allow larger steps, except with explicit Euler", .columns = 2};
  figure.footer =
      bodies.bare.mesh + " of springs, 10 % fixed, at rest; E and dampers are our choice; " + options.machine;
  const std::string at_young = fmt::format("E = {:g} kPa", study_young / 1000),
                    at_mass = fmt::format("particles of {:g} g", 1000 * printed_mass);
  for (const auto& [title, body] : {std::pair<std::string, const ParticleBody&>{whole_words(), bodies.whole},
                                    {springs_words(), bodies.springs}}) {
    const Range rates = body.damper > 0 ? Range{5, 2e6} : Range{5, 2e4};
    const Range masses{0.5, 500}, youngs{0.1, 100};  // [g], [kPa]
    figure.panels.push_back(drawn({.title = title,
                                   .note = at_young,
                                   .body = body,
                                   .over = &ParticleBody::particle_mass,
                                   .label = "mass of a particle [g]",
                                   .unit = 1e-3,
                                   .range = masses,
                                   .overturned = {1000 * heaviest_particle, masses.high},
                                   .points = options.quick ? 5 : 25},
                                  methods, rates));
    figure.panels.push_back(drawn({.title = title,
                                   .note = at_mass,
                                   .body = body,
                                   .over = &ParticleBody::young,
                                   .label = "E [kPa]",
                                   .unit = 1000,
                                   .range = youngs,
                                   .overturned = {youngs.low, softest / 1000},
                                   .points = options.quick ? 5 : 25},
                                  methods, rates));
  }
  return figure;
}

}  // namespace

void particle_limits(TissuePage& tissue) {
  std::vector<Method> methods;
  for (const char* id : particle_methods) methods.push_back(find_method(id));
  const DampedBodies bodies(tissue.options.mesh());
  const double heaviest = heaviest_hanging(bodies.bare);
  tissue.document["heaviest_particle"] = heaviest;
  add_limits(tissue, bodies, methods);
  tissue.page.draw(rates_figure(bodies, methods, heaviest, tissue.options), "particles");
}

namespace {

constexpr std::array path_models{"fem_green", "fem_neo_hookean", "mass_spring"};
constexpr std::array path_methods{"rk4", "symplectic_euler"};
constexpr double path_force = 1;  // [N]

/// Limits relative to that at rest: a curve for each stretch of the path without growth.
void add_relative(Panel& panel, const TrajectoryLimit& limit, const std::string& label, const Style& style) {
  Curve curve{.label = label, .style = style};
  for (std::size_t i = 0; i < limit.t.size(); ++i) {
    if (std::isfinite(limit.h_max[i])) {
      curve.x.push_back(limit.t[i]);
      curve.y.push_back(limit.h_max[i] / limit.h_max.front());
    } else if (!curve.x.empty()) {
      panel.curves.push_back(curve);
      curve.x.clear();
      curve.y.clear();
    }
  }
  if (!curve.x.empty()) panel.curves.push_back(std::move(curve));
}

/// The words for a load in tables and titles.
std::string load_in_words(std::string_view load) {
  return load == "gravity" ? "hanging in its weight" : fmt::format("pressed with {:g} N", path_force);
}

/// What is common to the paths of one model under one load.
struct LoadedModel {
  std::string_view load, model;
  Problem problem;
  int colour;
};

/// The limits of a model in equilibrium while its load grows, or in motion: curves, a row of the table, and
/// entries of the document.
Json add_path(TissuePage& tissue, Panel& panel, const LoadedModel& loaded, bool of_load,
              std::span<const Method> methods) {
  const bool quick = tissue.options.quick;
  const Path path = of_load ? load_path(loaded.problem, quick ? 4 : 20)
                            : motion_path(loaded.problem, quick ? 0.2 : 1, quick ? 8 : 100);
  const auto limits = limits_along(methods, loaded.problem, path);
  const char* const along = of_load ? "load" : "motion";
  Json shown = Json::array();
  for (std::size_t i = 0; i < methods.size(); ++i) {
    const TrajectoryLimit& limit = limits[i].value();
    if (i == 0) add_relative(panel, limit, std::string(loaded.model), family_style(loaded.colour));
    shown.push_back({{"at_rest", limit.h_max.front()}, {"least", limit.least}});
    tissue.document["paths"].push_back({{"load", loaded.load},
                                        {"path", along},
                                        {"model", loaded.model},
                                        {"method", methods[i].id},
                                        {"h_rest", limit.h_max.front()},
                                        {"h_min", limit.least},
                                        {"growing_share", limit.growing}});
  }
  return {
      {"load", load_in_words(loaded.load)}, {"along", along},   {"model", loaded.model}, {"limits", shown},
      {"growing", limits.front()->growing}, {"note", path.note}};
}

}  // namespace

void path_limits(TissuePage& tissue) {
  std::vector<Method> methods;
  for (const char* id : path_methods) methods.push_back(find_method(id));
  Figure figure{.title = "What loads do to the largest stable step of RK4", .columns = 2};
  figure.footer = tissue.options.machine;
  Json values = Json::object({{"methods", path_methods}, {"ended", Json::array()}});
  for (const std::string_view load : {"gravity", "press"}) {
    Panel share{.title = load_in_words(load) + ", in equilibrium",
                .x = {.label = "share of the load [1]"},
                .y = {.label = "h_max beside that at rest [1]"}};
    Panel motion{.title = load_in_words(load) + ", all at once",
                 .x = {.label = "time [s]"},
                 .y = {.label = "h_max beside that at rest [1]"}};
    int colour = 0;
    std::vector<std::pair<std::string, double>> parameters;
    if (load == "press") parameters.emplace_back("force", path_force);
    for (const std::string_view model : path_models) {
      const LoadedModel loaded{load, model, study_tissue(model, tissue.options.mesh(), load, parameters),
                               colour++};
      values["made_of"] = made_of(loaded.problem);
      for (const bool of_load : {true, false}) {
        Json row = add_path(tissue, of_load ? share : motion, loaded, of_load, methods);
        const std::string why = row["note"];
        row.erase("note");
        if (!why.empty())
          values["ended"].push_back(
              {{"load", row["load"]}, {"along", row["along"]}, {"model", model}, {"why", why}});
        values["bodies"].push_back(std::move(row));
      }
    }
    figure.panels.push_back(std::move(share));
    figure.panels.push_back(std::move(motion));
  }
  tissue.page.values["paths"] = values;
  tissue.page.draw(figure, "limits_under_loads");
}

}  // namespace hmax
