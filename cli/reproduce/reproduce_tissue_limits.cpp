/// The sections of `hmax reproduce tissue` on the steps that bodies bear.
#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "catalogue/methods/catalogue.hpp"
#include "cli/reproduce/reproduce_tissue_parts.hpp"
#include "limits/along/trajectory_limit.hpp"
#include "plots/draw.hpp"
#include "studies/particle_limits.hpp"

namespace hmax {

namespace {

namespace fs = std::filesystem;

// What the thesis printed of its explicit integration, and the study's liver:male_normal.
constexpr double printed_rate = 280;    // [1/s]
constexpr double printed_mass = 0.005;  // of a particle [kg]
constexpr double study_young = 5300;    // [Pa]
constexpr double study_damper = 6;      // [N s/m]

constexpr std::array particle_methods{"explicit_euler", "rk4", "symplectic_euler"};

std::vector<double> logarithmic(double low, double high, int points) {
  std::vector<double> values;
  for (int i = 0; i < points; ++i) values.push_back(low * std::pow(high / low, double(i) / (points - 1)));
  return values;
}

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
  for (const double at : logarithmic(wanted.range.low, wanted.range.high, wanted.points)) {
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

std::string rate_in_words(double rate) {
  if (std::isinf(rate)) return "no step is stable";
  const double digit = std::pow(10, std::floor(std::log10(rate)) - 2);  // three of them
  return fmt::format("{:.0f}", std::round(rate / digit) * digit);
}
std::string stiffest_in_words(double young) {
  return young > 0 ? fmt::format("{:.3g}", young / 1000) : "none";
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

/// Limits of the three bodies as a table; each goes into the study too.
std::string limits_table(const DampedBodies& bodies, std::span<const Method> methods, TissueStudy& study) {
  std::string table = fmt::format(
      "| damping | method | steps a second at {:g} g and {:g} kPa | stiffest E at {:g} g and {:g} steps a second "
      "[kPa] |\n| --- | --- | ---: | ---: |\n",
      1000 * printed_mass, study_young / 1000, 1000 * printed_mass, printed_rate);
  for (const auto& [damping, body] : {std::pair<std::string, const ParticleBody&>{"none", bodies.bare},
                                      {whole_words(), bodies.whole},
                                      {springs_words(), bodies.springs}}) {
    const std::vector<double> rates = stable_step_rates(methods, body);
    for (std::size_t i = 0; i < methods.size(); ++i) {
      constexpr double low = 100, high = 1e6;  // [Pa]
      const double stiffest = stiffest_stable(methods[i], body, printed_rate, low, high);
      study.particles.push_back({damping, methods[i].id, rates[i], stiffest > low ? stiffest : 0});
      table += fmt::format("| {} | {} | {} | {} |\n", damping, markdown_text(methods[i].id),
                           rate_in_words(rates[i]), stiffest_in_words(study.particles.back().stiffest));
    }
  }
  return table;
}

/// Steps a second over the mass of a particle and over the stiffness, for both kinds of damping.
Figure rates_figure(const DampedBodies& bodies, std::span<const Method> methods, double heaviest_particle,
                    const TissueOptions& options) {
  const double softest = study_young * printed_mass / heaviest_particle;
  Figure figure{.title = "Heavier particles allow larger steps, except with explicit Euler", .columns = 2};
  figure.footer =
      bodies.bare.mesh + " of springs, 10 % held, at rest; E and dampers are our choice; " + options.machine;
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

/// What the table and the figure say, in words.
std::string limits_in_words(const ParticleBody& bare, const std::string& table, const TissueStudy& study) {
  const auto of = [&](std::string_view damping, std::string_view method) -> const ParticleLimit& {
    return *std::ranges::find_if(study.particles, [&](const ParticleLimit& limit) {
      return limit.damping == damping && limit.method == method;
    });
  };
  return fmt::format(
      "Every particle of the {} of springs has the same mass. E = {:g} kPa is that of the study, a mean "
      "spring of {:.3g} N/m; the study's damper acts on the whole body, or dampers along the springs are "
      "chosen so that explicit Euler is just stable at {:g} steps a second. Limits are those of the body at rest.\n\n"
      "{}\n"
      "- Undamped, the steps that a body needs in a second fall with the root of the mass. With {:g} a second "
      "and {:g} g a body of up to {} kPa is stable with RK4 and of up to {} kPa with symplectic Euler, and "
      "none with explicit Euler, which lets every undamped motion grow.\n"
      "- Explicit Euler needs h < c/k of every motion that swings, whatever the mass. One damper on the whole body "
      "leaves it with {} steps a second at {:g} kPa, at any mass; dampers along the springs of at least "
      "c = k / ({:g}/s) let it take {:g}, up to {} kPa at {:g} g. The same dampers cost symplectic Euler steps, "
      "since it takes them explicitly.\n"
      "- \"Not stable\" for a large mass can then mean two things. A step of explicit Euler that is too long "
      "for its dampers stays so however heavy the particles are. And weight: beyond {:.2g} g a particle the "
      "body that hangs in it has no equilibrium without an element turned inside out (grey), which no step "
      "mends.",
      bare.mesh, study_young / 1000, mean_spring_stiffness(bare), printed_rate, table, printed_rate,
      1000 * printed_mass, stiffest_in_words(of("none", "rk4").stiffest),
      stiffest_in_words(of("none", "symplectic_euler").stiffest),
      rate_in_words(of(whole_words(), "explicit_euler").rate), study_young / 1000, printed_rate, printed_rate,
      stiffest_in_words(of(springs_words(), "explicit_euler").stiffest), 1000 * printed_mass,
      1000 * study.heaviest_particle);
}

}  // namespace

ReportSection particle_limits(const fs::path& folder, const TissueOptions& options, TissueStudy& study) {
  std::vector<Method> methods;
  for (const char* id : particle_methods) methods.push_back(find_method(id));
  const DampedBodies bodies(options.mesh());
  study.heaviest_particle = heaviest_hanging(bodies.bare);
  const std::string table = limits_table(bodies, methods, study);
  const Figure figure = rates_figure(bodies, methods, study.heaviest_particle, options);
  return {.title = "Steps a second against the mass of a particle and the stiffness",
          .text = limits_in_words(bodies.bare, table, study),
          .figures = {draw(figure, folder, "particles")},
          .printed = fmt::format(
              "explicit integration with {:g} steps a second at {:g} g a particle; \"not stable\" "
              "with a \"large mass\". Neither stiffness nor damping is given.",
              printed_rate, 1000 * printed_mass)};
}

namespace {

constexpr std::array path_models{"fem_green", "fem_neo_hookean", "mass_spring"};
constexpr std::array path_methods{"rk4", "symplectic_euler"};
constexpr double path_force = 1;  // [N]

/// Limits relative to that at rest: a curve for each stretch of the path without growth, or points.
void add_relative(Panel& panel, const TrajectoryLimit& limit, const std::string& label, const Style& style,
                  bool line, std::size_t every) {
  Curve curve{.label = label, .style = style, .line = line};
  for (std::size_t i = 0; i < limit.t.size(); ++i) {
    if (std::isfinite(limit.h_max[i])) {
      if (i % every != 0) continue;
      curve.x.push_back(limit.t[i]);
      curve.y.push_back(limit.h_max[i] / limit.h_max.front());
    } else if (line && !curve.x.empty()) {
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

std::string path_table_head(std::span<const Method> methods) {
  std::string table = "| load | along | model |";
  for (const Method& method : methods)
    table += fmt::format(" {}: h_max at rest, least [ms] |", markdown_text(method.id));
  return table + " growing share [%] |\n| --- | --- | --- | ---: | ---: | ---: |\n";
}

/// What is common to the paths of one model under one load.
struct LoadedModel {
  std::string_view load, model;
  Problem problem;
  int colour;
};

/// The limits of a model in equilibrium while its load grows, or in motion: curves, a row of the table, and
/// entries of the study.
std::string add_path(Panel& panel, const LoadedModel& loaded, bool of_load, std::span<const Method> methods,
                     bool quick, TissueStudy& study) {
  const Path path = of_load ? load_path(loaded.problem, quick ? 4 : 20)
                            : motion_path(loaded.problem, quick ? 0.2 : 1, quick ? 8 : 100);
  const auto limits = limits_along(methods, loaded.problem, path);
  const char* const along = of_load ? "load" : "motion";
  std::string row =
      fmt::format("| {} | {} | {} |", load_in_words(loaded.load), along, markdown_text(loaded.model));
  for (std::size_t i = 0; i < methods.size(); ++i) {
    const TrajectoryLimit& limit = limits[i].value();
    Style style = family_style(loaded.colour, i > 0);
    style.size = 0.8;
    add_relative(panel, limit, fmt::format("{}, {}", loaded.model, methods[i].id), style, i == 0,
                 i == 0    ? 1
                 : of_load ? 2
                           : 5);
    study.paths.push_back({std::string(loaded.load), along, std::string(loaded.model), methods[i].id,
                           limit.h_max.front(), limit.least, limit.growing});
    row += fmt::format(" {:.4g}, {:.4g} |", 1000 * limit.h_max.front(), 1000 * limit.least);
  }
  return row + fmt::format(" {:.3g} |\n", 100 * limits.front()->growing);
}

}  // namespace

ReportSection path_limits(const fs::path& folder, const TissueOptions& options, TissueStudy& study) {
  std::vector<Method> methods;
  for (const char* id : path_methods) methods.push_back(find_method(id));
  Figure figure{.title = "What loads do to the largest stable step", .columns = 2};
  figure.footer = options.machine;
  std::string table = path_table_head(methods), about;
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
      const LoadedModel loaded{load, model, study_tissue(model, options.mesh(), load, parameters), colour++};
      about = made_of(loaded.problem);
      table += add_path(share, loaded, true, methods, options.quick, study);
      table += add_path(motion, loaded, false, methods, options.quick, study);
    }
    figure.panels.push_back(std::move(share));
    figure.panels.push_back(std::move(motion));
  }
  return {
      .title = "The largest stable step under a load and in motion",
      .text =
          about +
          fmt::format(
              " h_max is that of the tangent at each state, K(q) on the equilibria while the load grows, and on "
              "the motion of the body when the load comes at once. Where a curve is interrupted the tangent "
              "has a negative stiffness: the body buckles, and what grows is the model. The fastest mode "
              "sits in a few small elements, so a load far from them hardly moves the limit.\n\n{}",
              table),
      .figures = {draw(figure, folder, "limits_under_loads")}};
}

}  // namespace hmax
