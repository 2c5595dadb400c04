#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>

#include <fmt/format.h>

#include "analysis/spectrum/linear_model.hpp"
#include "analysis/spectrum/spectrum.hpp"
#include "bench/timing/timing.hpp"
#include "catalogue/methods/catalogue.hpp"
#include "catalogue/models/equilibria/body_balance.hpp"
#include "catalogue/models/problems.hpp"
#include "catalogue/models/tissue_choice.hpp"
#include "catalogue/models/tissue_problem.hpp"
#include "cli/bodies/body_picture.hpp"
#include "cli/bodies/static_comparison.hpp"
#include "cli/reproduce/tissue_page.hpp"
#include "core/errors.hpp"
#include "core/numbers.hpp"
#include "problems/mesh/files/mesh_names.hpp"
#include "problems/mesh/mesh_quality.hpp"
#include "problems/tissue/body.hpp"
#include "problems/tissue/forces/kernels/kernels.hpp"
#include "problems/tissue/sofa_scene.hpp"
#include "results/json.hpp"
#include "results/table.hpp"
#include "studies/organ_rates.hpp"
#include "studies/scale_study.hpp"

namespace hmax {

Problem study_tissue(std::string_view model, std::string_view mesh, std::string_view load,
                     Parameters parameters) {
  return make_problem(tissue_id(model, mesh, load),
                      {.material = study_material, .parameters = std::move(parameters)});
}

std::string made_of(const Problem& problem) {
  const auto value = [&](std::string_view name) {
    const auto it = std::ranges::find(problem.parameters, name,
                                      [](const auto& known) { return std::string_view(known.first); });
    return it == problem.parameters.end() ? NAN : it->second;
  };
  return fmt::format(
      "{}; liver:{}: E = {:g} kPa, nu = {:g} (not of springs), {:g} kg; {:g} % at the supported end are fixed.",
      problem.note, study_material, value("E") / 1000, value("nu"), value("mass"), 100 * value("support"));
}

namespace {

constexpr double pressing = 0.5;          // on springs and elements [N]
constexpr double pressing_solvers = 0.2;  // where every solver finds the equilibrium [N]
constexpr std::array<std::string_view, 2> meshes{"phantom", "liver"};

StaticSolution equilibrium(const Problem& problem, double share = 1, int load_steps = 4) {
  return solve_static(static_model(problem, share), {.load_steps = load_steps}, thread_cpu_seconds);
}

void the_meshes(TissuePage& tissue) {
  BodyPicture bodies{.title = "The meshes of the study, by the quality of their elements",
                     .caption =
                         "Counts are those of the study, shapes are ours (problems/meshes). Mean ratio: 1 "
                         "for the regular tetrahedron, 0 for a flat one.",
                     .colours = mesh_quality_colours(),
                     .columns = 2};
  for (const std::string_view name : meshes) {
    const TetMesh mesh = mesh_by_name(name);
    const MeshQuality quality = quality_of(mesh);
    BodyView view = mesh_view(mesh);
    view.title = name;
    view.notes = {fmt::format("{} points, {} tetrahedra, {:.0f} cm³, worst mean ratio {:.2f}",
                              mesh.point_count(), mesh.tetrahedron_count(), 1e6 * quality.volume,
                              quality.min_mean_ratio)};
    bodies.views.push_back(std::move(view));
  }
  tissue.draw(bodies, "meshes");
}

/// The same force on springs and elements, as pictures of the liver.
void deflections(TissuePage& tissue) {
  BodyPicture bodies{
      .title = fmt::format("The liver under {:g} N: springs deform more than elements", pressing),
      .columns = 2};
  for (const auto& [model, key, title] :
       {std::tuple{"mass_spring", "deflection_springs", "Mass-spring"},
        {"fem_green", "deflection_elements", "Finite elements, Green's strain"}}) {
    const Problem problem = study_tissue(model, "liver", "press", {{"force", pressing}});
    const StaticSolution solution = equilibrium(problem);
    tissue.document[key] = largest_displacement(solution.q);
    BodyView view = body_view(*problem.body, 0, solution.q, BodyValue::displacement);
    view.title = title;
    view.notes = {fmt::format("largest displacement {}{}", millimetres(largest_displacement(solution.q)),
                              solution.converged ? "" : "; not converged: " + solution.note)};
    bodies.views.push_back(std::move(view));
    bodies.caption = made_of(problem) + " Static solutions by Newton's method.";
  }
  if (tissue.document["deflection_springs"] < tissue.document["deflection_elements"])
    bodies.title = fmt::format("The liver under {:g} N: elements deform more than springs", pressing);
  bodies.colours = colours_of(BodyValue::displacement, bodies.views);
  tissue.draw(bodies, "springs_and_elements");
}

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

/// Springs and finite elements over stiffness and damping: figure 9 of the liver study, with scenes of SOFA.
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

/// Displacement against force, all models, both meshes.
void load_paths(TissuePage& tissue) {
  Figure figure{.title = "Displacement of a pressed patch", .columns = 2};
  figure.footer = tissue.options.machine;
  for (const std::string_view mesh : meshes) {
    const double most = mesh == "liver" ? 2 * pressing : pressing;  // [N]
    Panel panel{
        .title = std::string(mesh), .x = {.label = "largest displacement [mm]"}, .y = {.label = "force [N]"}};
    int k = 0;
    for (const std::string_view model : tissue_model_ids()) {
      const Problem problem = study_tissue(model, mesh, "press", {{"force", most}});
      Curve curve{.label = std::string(model), .x = {0}, .y = {0}, .style = family_style(k++, true)};
      curve.style.size = 0.8;
      constexpr int points = 10;
      for (int i = 1; i <= points; ++i) {
        const double share = double(i) / points;
        const StaticSolution solution = equilibrium(problem, share, 1 + i / 2);
        if (!solution.converged) break;
        curve.x.push_back(1000 * largest_displacement(solution.q));
        curve.y.push_back(most * share);
      }
      panel.curves.push_back(std::move(curve));
    }
    figure.panels.push_back(std::move(panel));
  }
  tissue.page.draw(figure, "load_paths");
}

/// Ways to solve, beside each other.
void solvers(TissuePage& tissue) {
  const Problem problem = study_tissue("fem_green", "liver", "press", {{"force", pressing_solvers}});
  const StaticModel model = static_model(problem, 1);
  StaticSettings settings{.iterations = 400, .inner_tolerance = 1e-2};
  settings.relaxation = best_relaxation(model, settings);
  const std::vector<StaticWay> ways = all_ways(model, settings);
  Json rows = Json::array();
  int unsolved = 0;
  for (const StaticWay& way : ways) {
    const double seconds = way.seconds();
    if (!way.solution.converged) ++unsolved;
    rows.push_back({{"method", name_of(way.method)},
                    {"inner", name_of(way.inner)},
                    HMAX_KEYS(way.solution, converged, iterations),
                    {"seconds", seconds},
                    {"rate", seconds > 0 ? way.solution.iterations / seconds : NAN}});
  }
  tissue.page.values["solvers"] = {{"made_of", made_of(problem)},
                                   {"force", pressing_solvers},
                                   {"iterations", iterations_in_words(settings)},
                                   {"ways", rows}};
  tissue.document["unsolved"] = unsolved;
  tissue.page.draw(residual_figure(ways, "Newton's method needs few iterations, the modified one cheap ones",
                                   tissue.options.machine),
                   "residuals");
}

/// The first shapes in which the liver with a fixed end swings.
void modes(TissuePage& tissue) {
  const Problem problem = study_tissue("fem_green", "liver", "gravity", {});
  const TissueBody& body = *problem.body;
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(body.dofs());
  TissueBody::DofMatrix K, C;
  body.stiffness(0, zero, zero, K);
  body.damping(0, zero, zero, C);
  const MechanicalModes found = mechanical_modes(mechanical_part(body.mass(), K, C), true);
  BodyPicture bodies{.title = "The six slowest modes of the liver with a fixed end",
                     .caption = made_of(problem) + " Linearised at rest; amplitudes are arbitrary.",
                     .colours = {.quantity = "displacement, of the largest [1]", .range = Range{0, 1}},
                     .columns = 3};
  constexpr double shown = 0.03;  // the largest displacement [m]
  for (int i = 0; i < 6; ++i) {
    const Eigen::VectorXd shape = found.shapes.col(i);
    const double largest = largest_displacement(shape);
    BodyView view = body_view(body, 0, shown / largest * shape, BodyValue::displacement);
    for (double& value : view.values) value /= 1000 * shown;
    const MechanicalMode& mode = found.modes[static_cast<std::size_t>(i)];
    const double omega = std::sqrt(std::max(0.0, mode.kappa));
    view.title = fmt::format("{:.2f} Hz", omega / (2 * std::numbers::pi));
    view.notes = {fmt::format("damping ratio {:.2f}", mode.gamma / (2 * omega))};
    bodies.views.push_back(std::move(view));
  }
  tissue.draw(bodies, "modes");
}

/// A tool that moves into the liver, seen from its side.
void pressed_by_a_tool(TissuePage& tissue) {
  constexpr double h = 0.005, depth = 0.015;
  const Problem problem = study_tissue("fem_green", "liver", "tool", {{"depth", depth}});
  const Runner runner = find_method("linearly_implicit_euler").bind(problem);
  BodyPicture bodies{
      .title = "A tool is pressed into the liver: the dent beside the shape at rest",
      .caption =
          made_of(problem) +
          fmt::format(
              " linearly_implicit_euler, h = {:g} s; no gravity. Contact is a penalty on the surface.", h),
      .colours = {.quantity = "displacement [mm]"},
      .towards = {-1, 0, -0.3},
      .columns = 3};
  Json rows = Json::array();
  for (const double t : {0.2, 0.3, 0.6}) {
    const RunRecord record = runner.run({.t_end = t, .h = h}, {});
    if (record.outcome != Outcome::reached_end)
      throw InputError(fmt::format("the tool in the liver ended at t = {:g} s; this is a defect", record.t));
    const Eigen::VectorXd q = record.y.head(problem.body->dofs());
    const ToolContact::Reach reach = problem.body->tool_reaches(t, record.y).front();
    const double smallest = problem.body->least_volume(t, q).first;
    rows.push_back({{"t", t},
                    HMAX_KEYS(reach, depth, penetration),
                    {"displacement", largest_displacement(q)},
                    {"smallest", smallest}});
    BodyView view = body_view(*problem.body, t, q, BodyValue::displacement);
    view.title = fmt::format("t = {:g} s", t);
    view.notes = {
        fmt::format("tool {}, body {}", millimetres(reach.depth), millimetres(largest_displacement(q)))};
    bodies.views.push_back(std::move(view));
  }
  tissue.page.values["tool_runs"] = rows;
  tissue.draw(bodies, "tool");
}

/// CPU times of forces and steps.
void costs(TissuePage& tissue) {
  const std::vector<ModelCost> bodies = model_costs({meshes.begin(), meshes.end()}, study_material);
  const ModelCost &springs = bodies.at(bodies.size() - 2), &elements = bodies.back();  // of the liver
  const double forces = elements.force / springs.force, plain = elements.plain / springs.plain,
               steps = elements.step / springs.step;
  // "Approximately": within a factor of 1.5.
  const auto four = [](double ratio) { return ratio > 4 / 1.5 && ratio < 4 * 1.5; };
  tissue.page.values["costs"] = {{"bodies", bodies},
                                 {"force_ratio", forces},
                                 {"plain_ratio", plain},
                                 {"step_ratio", steps},
                                 {"kernels", tissue_kernels().name},
                                 {"gain_elements", elements.plain / elements.force},
                                 {"gain_springs", springs.plain / springs.force},
                                 {"kernels_explain", four(plain) && !four(forces)}};
  tissue.document["force_ratio"] = forces;
  tissue.document["plain_force_ratio"] = plain;
  tissue.document["step_ratio"] = steps;
  tissue.judge("four_times", judged(four(forces), four(plain)),
               {{"plain", plain}, {"vector", forces}, {"step", steps}});
}

struct Cost {
  const char* name;
  double ScaleRow::*seconds;
};
constexpr std::array<Cost, 6> costs_of_size{{{"implicit step, CG", &ScaleRow::implicit_step},
                                             {"import of a file", &ScaleRow::import},
                                             {"largest eigenvalue", &ScaleRow::eigenvalue},
                                             {"stiffness", &ScaleRow::stiffness},
                                             {"explicit step", &ScaleRow::explicit_step},
                                             {"forces", &ScaleRow::force}}};

/// The largest cost of a tetrahedron over the smallest.
double spread(const std::vector<ScaleRow>& rows, double ScaleRow::*seconds) {
  double low = std::numeric_limits<double>::infinity(), high = 0;
  for (const ScaleRow& row : rows) {
    const double each = row.*seconds / static_cast<double>(row.tetrahedra);
    low = std::min(low, each);
    high = std::max(high, each);
  }
  return high / low;
}

/// What steps take on a device, beside no CPU time; null without one.
Json steps_on(const std::shared_ptr<Device>& device, const std::vector<ScaleRow>& rows) {
  if (!device) return nullptr;
  Json steps = Json::array();
  for (const ScaleRow& row : rows) steps.push_back({HMAX_KEYS(row, mesh, tetrahedra, device_step)});
  const DeviceFacts facts = device->facts();
  return {{"device", facts.name},
          HMAX_KEYS(facts, clock_mhz, driver),
          {"precision", "double"},
          {"steps", std::move(steps)}};
}

/// What meshes cost as they grow.
void costs_over_size(TissuePage& tissue, const std::function<void(const std::string&)>& progress) {
  const std::vector<std::string> sizes =
      tissue.options.quick ? std::vector<std::string>{"ball:n=2", "ball:n=4"} : scale_meshes();
  const std::vector<ScaleRow> rows = scale_study(
      sizes, tissue.page.folder, [&](double, const std::string& mesh) { progress(mesh); },
      tissue.options.device);
  Panel panel{.x = {.label = "tetrahedra [1]", .logarithmic = true},
              .y = {.label = "CPU time for each tetrahedron [ns]", .logarithmic = true}};
  int k = 0;
  for (const Cost& cost : costs_of_size) {
    Curve curve{.label = cost.name, .style = family_style(k++, true)};
    for (const ScaleRow& row : rows) {
      curve.x.push_back(static_cast<double>(row.tetrahedra));
      curve.y.push_back(1e9 * row.*cost.seconds / static_cast<double>(row.tetrahedra));
    }
    panel.curves.push_back(std::move(curve));
  }
  tissue.page.draw({.title = "What a tetrahedron costs in meshes of a thousand to a million",
                    .panels = {panel},
                    .footer = "fem_green, one thread; " + tissue.options.machine,
                    .panel_height = 380},
                   "costs_over_size");
  tissue.document["sizes"] = rows;
  tissue.document["device"] = steps_on(tissue.options.device, rows);
  tissue.page.values["sizes"] = {{"meshes", rows},
                                 {"force_spread", spread(rows, &ScaleRow::force)},
                                 {"step_spread", spread(rows, &ScaleRow::explicit_step)},
                                 {"device", tissue.document["device"]}};
}

}  // namespace

void TissuePage::judge(const std::string& name, std::string_view judgement, Json found) {
  found["judgement"] = judgement;
  page.values[name] = document["statements"][name] = std::move(found);
}

void TissuePage::draw(const BodyPicture& picture, const std::string& name) {
  const std::filesystem::path base = page.folder / name, file = page.folder / (name + ".svg");
  write_picture(file, picture);
  page.show(FigureFiles{base, {file}, {}, picture.title});
}

Json reproduce_tissue(const std::filesystem::path& folder, const TissueOptions& options,
                      const std::function<void(double, const std::string&)>& progress) {
  TissuePage tissue{options, {"tissue", folder}};
  const StaticModel pressed =
      static_model(study_tissue("fem_green", options.mesh(), "press", {{"force", pressing_solvers}}), 1);
  const auto solving = [&](auto section) {
    return [&, section](TissuePage& page) { section(page, pressed); };
  };
  double share = 0;
  const auto telling = [&](auto section) {
    return [&, section](TissuePage& page) {
      section(page, [&](const std::string& what) { progress(share, what); });
    };
  };
  std::vector<std::pair<const char*, std::function<void(TissuePage&)>>> sections{
      {"meshes", the_meshes},
      {"springs and elements", deflections},
      {"figure 9", figure_9},
      {"load paths", load_paths},
      {"solvers", solvers},
      {"linear systems", solving(inner_systems)},
      {"pre-inversion", solving(pre_inversion)},
      {"pseudo-dynamic", solving(pseudo_dynamics)},
      {"rotation", turned_body},
      {"volume", kept_volume},
      {"order and stages", order_and_stages},
      {"contraction", contraction_of_methods},
      {"regions", regions_and_eigenvalues},
      {"constant Jacobian", constant_jacobian},
      {"force feedback", force_feedback},
      {"steps and masses", particle_limits},
      {"steps under loads", path_limits},
      {"costs", costs},
      {"modes", modes},
      {"tool", pressed_by_a_tool},
      {"view volume", found_by_a_view},
      {"penalties", penalties},
      {"stress and strain", stress_and_strain},
      {"body from its motion", body_from_its_motion},
      {"thigh", telling(identified_thigh)},
      {"echography", telling(echographic_image)}};
  tissue.page.values = {HMAX_KEYS(options, machine, quick), {"sizes", nullptr}};
  tissue.document["sizes"] = Json::array();
  tissue.document["device"] = nullptr;
  if (options.scale) sections.emplace_back("sizes", telling(costs_over_size));
  for (const auto& [name, make] : sections) {
    progress(share, name);
    make(tissue);
    share += 1 / static_cast<double>(sections.size());
  }
  tissue.page.values.update(counts_of(tissue.document["statements"]));
  tissue.document["report"] = tissue.page.write().string();
  return tissue.document;
}

}  // namespace hmax
