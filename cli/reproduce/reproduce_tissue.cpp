#include "cli/reproduce/reproduce_tissue.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

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
#include "cli/reproduce/reproduce_tissue_parts.hpp"
#include "core/errors.hpp"
#include "plots/draw.hpp"
#include "plots/pages/report.hpp"
#include "problems/mesh/files/mesh_names.hpp"
#include "problems/mesh/mesh_quality.hpp"

namespace hmax {

namespace {
constexpr const char* material = "male_normal";
}

Problem study_tissue(std::string_view model, std::string_view mesh, std::string_view load,
                     Parameters parameters) {
  return make_problem(tissue_id(model, mesh, load),
                      {.material = material, .parameters = std::move(parameters), .y0 = {}});
}

std::string made_of(const Problem& problem) {
  const auto value = [&](std::string_view name) {
    const auto it = std::ranges::find(problem.parameters, name,
                                      [](const auto& known) { return std::string_view(known.first); });
    return it == problem.parameters.end() ? NAN : it->second;
  };
  return fmt::format(
      "{}; liver:{}: E = {:g} kPa, nu = {:g} (not of springs), {:g} kg; {:g} % at the supported end are held.",
      problem.note, material, value("E") / 1000, value("nu"), value("mass"), 100 * value("support"));
}

namespace {

namespace fs = std::filesystem;

constexpr double pressing = 0.5;          // on springs and elements [N]
constexpr double pressing_solvers = 0.2;  // where every solver finds the equilibrium [N]
constexpr std::array<std::string_view, 2> meshes{"phantom", "liver"};

FigureFiles picture(const BodyPicture& picture, const fs::path& folder, const std::string& name) {
  write_picture(folder / (name + ".svg"), picture);
  return {folder / name, {folder / (name + ".svg")}, {}};
}

std::string millimetres(double metres) { return fmt::format("{:.3g} mm", 1000 * metres); }

StaticSolution equilibrium(const Problem& problem, double share = 1, int load_steps = 4) {
  return solve_static(static_model(problem, share), {.load_steps = load_steps}, thread_cpu_seconds);
}

ReportSection the_meshes(const fs::path& folder) {
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
  return {.title = "Two meshes", .figures = {picture(bodies, folder, "meshes")}};
}

/// The same force on springs and elements, as pictures of the liver.
ReportSection deflections(const fs::path& folder, TissueStudy& study) {
  BodyPicture bodies{
      .title = fmt::format("The liver under {:g} N: springs deform more than elements", pressing),
      .colours = {},
      .columns = 2};
  double* const found[]{&study.deflection_springs, &study.deflection_elements};
  int k = 0;
  for (const auto& [model, title] :
       {std::pair{"mass_spring", "Mass-spring"}, {"fem_green", "Finite elements, Green's strain"}}) {
    const Problem problem = study_tissue(model, "liver", "press", {{"force", pressing}});
    const StaticSolution solution = equilibrium(problem);
    *found[k++] = largest_displacement(solution.q);
    BodyView view = body_view(*problem.body, 0, solution.q, BodyValue::displacement);
    view.title = title;
    view.notes = {fmt::format("largest displacement {}{}", millimetres(largest_displacement(solution.q)),
                              solution.converged ? "" : "; not converged: " + solution.note)};
    bodies.views.push_back(std::move(view));
    bodies.caption = made_of(problem) + " Static solutions by Newton's method.";
  }
  if (study.deflection_springs < study.deflection_elements)
    bodies.title = fmt::format("The liver under {:g} N: elements deform more than springs", pressing);
  bodies.colours = colours_of(BodyValue::displacement, bodies.views);
  return {
      .title = "The same load on springs and on finite elements",
      .text =
          "Springs get their stiffness from Young's modulus by the volume around each edge; they have the "
          "energy of a solid with Poisson's ratio 1/4 under uniform dilation, and of none else.",
      .figures = {picture(bodies, folder, "springs_and_elements")}};
}

/// Displacement against force, all models, both meshes.
ReportSection load_paths(const fs::path& folder, const std::string& machine) {
  Figure figure{.title = "Displacement of a pressed patch", .columns = 2};
  figure.footer = machine;
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
  return {
      .title = "Force against displacement",
      .text =
          "Small strain is a straight line; Green's strain stiffens when pulled and softens when pressed. A "
          "curve ends where no equilibrium was found.",
      .figures = {draw(figure, folder, "load_paths")}};
}

/// Ways to solve, beside each other.
ReportSection solvers(const fs::path& folder, const std::string& machine, TissueStudy& study) {
  const Problem problem = study_tissue("fem_green", "liver", "press", {{"force", pressing_solvers}});
  const StaticModel model = static_model(problem, 1);
  StaticSettings settings{.iterations = 400, .inner_tolerance = 1e-2};
  settings.relaxation = best_relaxation(model, settings);
  const std::vector<StaticWay> ways = all_ways(model, settings);
  std::string table =
      "| method | linear systems by | outcome | iterations | CPU time [ms] | iterations a second |\n"
      "| --- | --- | --- | ---: | ---: | ---: |\n";
  for (const StaticWay& way : ways) {
    const double seconds = way.seconds();
    if (!way.solution.converged) ++study.unsolved;
    table += fmt::format("| {} | {} | {} | {} | {:.4g} | {:.4g} |\n", markdown_text(name_of(way.method)),
                         name_of(way.inner), way.solution.converged ? "converged" : "not converged",
                         way.solution.iterations, 1000 * seconds,
                         seconds > 0 ? way.solution.iterations / seconds : NAN);
  }
  return {
      .title = "Static solvers",
      .text =
          made_of(problem) +
          fmt::format(" {:g} N, residual below 1e-9 of the load; {}, the best for the stiffness at rest.\n\n",
                      pressing_solvers, iterations_in_words(settings)) +
          table,
      .figures = {draw(
          residual_figure(ways, "Newton's method needs few iterations, the modified one cheap ones", machine),
          folder, "residuals")},
      .printed = "60 iterations a second of Newton's method (2001)."};
}

/// The first shapes in which the held liver swings.
ReportSection modes(const fs::path& folder) {
  const Problem problem = study_tissue("fem_green", "liver", "gravity", {});
  const TissueBody& body = *problem.body;
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(body.dofs());
  TissueBody::DofMatrix K, C;
  body.stiffness(0, zero, zero, K);
  body.damping(0, zero, zero, C);
  const MechanicalModes found = mechanical_modes(mechanical_part(body.mass(), K, C), true);
  BodyPicture bodies{.title = "The six slowest modes of the held liver",
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
  return {.title = "Modes", .figures = {picture(bodies, folder, "modes")}};
}

/// A tool that moves into the liver.
ReportSection pressed_by_a_tool(const fs::path& folder) {
  constexpr double h = 0.005;
  const Problem problem = study_tissue("fem_green", "liver", "tool", {{"depth", 0.025}});
  const Runner runner = find_method("linearly_implicit_euler").bind(problem);
  BodyPicture bodies{
      .title = "A tool is pressed into the liver",
      .caption =
          made_of(problem) +
          fmt::format(
              " linearly_implicit_euler, h = {:g} s; no gravity. Contact is a penalty on the surface.", h),
      .towards = {0.45, -1, -0.25},
      .columns = 3};
  for (const double t : {0.2, 0.3, 0.6}) {
    const RunRecord record = runner.run({.t_end = t, .h = h}, {});
    if (record.outcome != Outcome::reached_end)
      throw InputError(fmt::format("the tool in the liver ended at t = {:g} s; this is a defect", record.t));
    const Eigen::VectorXd q = record.y.head(problem.body->dofs());
    BodyView view = body_view(*problem.body, t, q, BodyValue::displacement);
    view.title = fmt::format("t = {:g} s", t);
    view.notes = {fmt::format("largest displacement {}", millimetres(largest_displacement(q)))};
    bodies.views.push_back(std::move(view));
  }
  bodies.colours = colours_of(BodyValue::displacement, bodies.views);
  return {.title = "A tool", .figures = {picture(bodies, folder, "tool")}};
}

/// CPU times of forces and steps.
ReportSection costs(TissueStudy& study) {
  std::string table =
      "| mesh | model | forces [µs] | step of linearly implicit Euler [µs] |\n"
      "| --- | --- | ---: | ---: |\n";
  constexpr double h = 0.01;
  for (const std::string_view mesh : meshes) {
    std::array<double, 2> force{}, step{};
    std::array<Problem, 2> problems{study_tissue("mass_spring", mesh, "gravity", {}),
                                    study_tissue("fem_green", mesh, "gravity", {})};
    std::vector<std::function<void(std::int64_t)>> tasks;
    constexpr int steps = 20;
    for (const Problem& problem : problems) {
      tasks.push_back([body = problem.body](std::int64_t runs) {
        const Eigen::VectorXd zero = Eigen::VectorXd::Zero(body->dofs());
        Eigen::VectorXd f = zero;
        for (std::int64_t i = 0; i < runs; ++i) body->force(0, zero, zero, f);
      });
      tasks.push_back([runner = find_method("linearly_implicit_euler").bind(problem)](std::int64_t runs) {
        runner.repeat({.t_end = steps * h, .h = h}, runs);
      });
    }
    TimingOptions options;
    options.repetitions = 7;
    const std::vector<Timing> timings = time_interleaved(tasks, options);
    const auto least = [&](std::size_t k) { return *std::ranges::min_element(timings[k].samples); };
    for (std::size_t k = 0; k < 2; ++k) {
      force[k] = least(2 * k);
      step[k] = least(2 * k + 1) / steps;
      table += fmt::format("| {} | {} | {:.4g} | {:.4g} |\n", mesh, k == 0 ? "mass\\_spring" : "fem\\_green",
                           1e6 * force[k], 1e6 * step[k]);
    }
    study.force_ratio = force[1] / force[0];
    study.step_ratio = step[1] / step[0];
  }
  return {
      .title = "What finite elements cost beside springs",
      .text = table +
              fmt::format("\nOn the liver the forces of finite elements cost {:.2g} times those of springs, "
                          "a step {:.2g} times. Best of seven samples each.",
                          study.force_ratio, study.step_ratio),
      .printed = "finite elements cost 4 times as much as springs."};
}

}  // namespace

TissueStudy reproduce_tissue(const fs::path& folder, const TissueOptions& options,
                             const std::function<void(double, const std::string&)>& progress) {
  TissueStudy study;
  const std::string& machine = options.machine;
  std::vector<ReportSection> sections;
  const StaticModel pressed =
      static_model(study_tissue("fem_green", options.mesh(), "press", {{"force", pressing_solvers}}), 1);
  std::vector<std::pair<const char*, std::function<ReportSection()>>> parts{
      {"meshes", [&] { return the_meshes(folder); }},
      {"springs and elements", [&] { return deflections(folder, study); }},
      {"figure 9", [&] { return figure_9(folder, options); }},
      {"load paths", [&] { return load_paths(folder, machine); }},
      {"solvers", [&] { return solvers(folder, machine, study); }},
      {"linear systems", [&] { return inner_systems(pressed, best_relaxation(pressed, {})); }},
      {"pre-inversion", [&] { return pre_inversion(pressed); }},
      {"pseudo-dynamic", [&] { return pseudo_dynamics(pressed); }},
      {"rotation", [&] { return turned_body(folder); }},
      {"volume", [] { return kept_volume(); }},
      {"order and stages", [] { return order_and_stages(); }},
      {"regions", [&] { return regions_and_eigenvalues(folder, options); }},
      {"constant Jacobian", [&] { return rates(options); }},
      {"force feedback", [&] { return force_feedback(folder); }},
      {"steps and masses", [&] { return particle_limits(folder, options, study); }},
      {"steps under loads", [&] { return path_limits(folder, options, study); }},
      {"costs", [&] { return costs(study); }},
      {"modes", [&] { return modes(folder); }},
      {"tool", [&] { return pressed_by_a_tool(folder); }},
  };
  const auto share = [&] { return static_cast<double>(sections.size()) / static_cast<double>(parts.size()); };
  parts.emplace_back("thigh", [&] {
    return identified_thigh(folder, options, study,
                            [&](const std::string& what) { progress(share(), what); });
  });
  if (options.scale)
    parts.emplace_back("sizes", [&] {
      return costs_over_size(folder, options, study,
                             [&](double, const std::string& mesh) { progress(share(), mesh); });
    });
  for (const auto& [name, make] : parts) {
    progress(share(), name);
    sections.push_back(make());
  }
  study.report = write_report(
      "Springs and finite elements on the phantom and the liver",
      "`hmax reproduce tissue` made this page" +
          std::string(options.quick
                          ? " in the quick form: coarser meshes, fewer points and repetitions, so that its "
                            "numbers are those of the sources in part only. "
                          : ". ") +
          markdown_text(machine),
      sections, folder);
  return study;
}

}  // namespace hmax
