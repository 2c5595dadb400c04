/// Sections of `hmax reproduce tissue` on the statements of the thesis: strain, volume, stages, eigenvalues,
/// statics.
#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "analysis/amplification/limits.hpp"
#include "catalogue/methods/catalogue.hpp"
#include "catalogue/models/equilibria/body_balance.hpp"
#include "cli/reproduce/reproduce_tissue_parts.hpp"
#include "cli/shared/region_shape.hpp"
#include "limits/linearised_problem.hpp"
#include "plots/curves.hpp"
#include "plots/draw.hpp"
#include "plots/stability.hpp"
#include "studies/local_model.hpp"
#include "studies/organ_rates.hpp"
#include "studies/organ_study.hpp"
#include "studies/particle_limits.hpp"

namespace hmax {

ReportSection turned_body(const std::filesystem::path& folder) {
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
  const Figure figure{
      .title = "A body that is turned as a whole: small strain takes the turn for a deformation",
      .panels = {panel},
      .footer = "phantom, free, nu = 0.3; turned about an axis through its middle",
      .panel_height = 300};
  return {
      .title = "Rotation: small strain and Green's strain",
      .text = fmt::format(
          "Turned by 90 degrees the model of small strain has {:.3g} E V of elastic energy, as if it were "
          "squeezed; the others have at most {:.1g} E V, which is rounding.",
          linear, others),
      .figures = {draw(figure, folder, "turned_body")},
      .printed =
          "\"No large strain, no rotation\" of the linear model (slide 16); \"rotational invariance\" of Green's "
          "strain (slide 66)."};
}

ReportSection kept_volume() {
  constexpr double displacement = 0.005;  // [m]
  std::string table =
      "| model | nu | largest displacement [mm] | volume lost [%] | largest change of a tetrahedron [%] |\n"
      "| --- | ---: | ---: | ---: | ---: |\n";
  const std::vector<PressedVolume> rows = pressed_volumes("phantom", displacement);
  for (const PressedVolume& row : rows)
    table += fmt::format("| {} | {:g} | {:.3g} | {:.3g} | {:.3g} |\n", markdown_text(row.model), row.nu,
                         1000 * row.displacement, 100 * row.lost, 100 * row.spread);
  return {
      .title = "Dilatation: what a pressed body loses of its volume",
      .text = fmt::format(
          "The phantom, pressed by {:g} mm, in equilibrium.\n\n{}\nFinite elements lose {:.2g} times less "
          "with nu = 0.49 than with nu = 0.3; springs have one value, {:.2g} % here.",
          1000 * displacement, table, rows[1].lost / rows[3].lost, 100 * rows[0].lost),
      .printed =
          "\"Dilatation may be controlled\" with finite elements (slide 11), springs are \"unrealistic to model "
          "volume\" (slide 12)."};
}

ReportSection order_and_stages() {
  std::string table =
      "| method | stages | order | limit for h omega, no damping | limit for h lambda, decay |\n"
      "| --- | ---: | ---: | ---: | ---: |\n";
  for (const char* id :
       {"explicit_euler", "rk2_heun", "rk2_midpoint", "rk3_kutta", "rk4", "dormand_prince_54", "dop_853"}) {
    const auto known = std::ranges::find(methods(), id, &Method::id);
    if (known == methods().end()) continue;
    const StabilityLimits limits = stability_limits(*known->amplification);
    table += fmt::format("| {} | {} | {} | {:.4g} | {:.4g} |\n", markdown_text(known->id), known->stages,
                         known->order, limits.imaginary, limits.real);
  }
  return {
      .title = "Explicit methods: order against stages",
      .text =
          table +
          "\nUp to order 4 a method of s stages can have order s, beyond that it needs more: 6 for order 5 and 11 for "
          "order 8 at least [hairer1993solving]. Stages that serve an error estimate count here.",
      .printed =
          "Order of consistency against stages of Runge-Kutta methods (slide 20); numbers are not printed."};
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

ReportSection regions_and_eigenvalues(const std::filesystem::path& folder, const TissueOptions& options) {
  constexpr double h = 1.0 / 280;
  const PlaneWindow window{-4, 1, -3.5, 3.5};
  const PlaneFrame frame = equal_frame({window.re_from, window.re_to}, {window.im_from, window.im_to}, 1);
  std::vector<RegionShape> shapes;
  std::vector<Method> chosen;
  for (const char* id : {"explicit_euler", "rk2_heun", "rk4"}) {
    chosen.push_back(find_method(id));
    shapes.push_back(shape_of(id, region_boundary(stable_at(*chosen.back().amplification), window)));
  }
  Panel panel = regions_panel(shapes, frame);
  ParticleBody body{.mesh = options.mesh(), .damper_time = 0.002};
  std::string table =
      "| mass of a particle [g] | explicit_euler | rk2_heun | rk4 |\n| ---: | ---: | ---: | ---: |\n";
  int k = 3;
  for (const double mass : {0.005, 0.02, 0.1}) {
    body.particle_mass = mass;
    panel.curves.push_back(eigenvalues_of(body, h, k++));
    const std::vector<double> rates = stable_step_rates(chosen, body);
    table += fmt::format("| {:g} |", 1000 * mass);
    for (const double rate : rates)
      table += fmt::format(" {} |", std::isfinite(rate) ? fmt::format("{:.0f}", rate) : "–");
    table += "\n";
  }
  const Figure figure{.title = "A larger mass draws the eigenvalues towards zero, and into the regions",
                      .panels = {panel},
                      .footer = fmt::format(
                          "springs on the {}, E = {:g} Pa, dampers along them, {:g} s times their stiffness; "
                          "h = 1/280 s; points outside of the frame are not shown",
                          body.mesh, body.young, body.damper_time),
                      .panel_height = frame.height};
  return {
      .title = "Stability regions with the eigenvalues of the body at several masses",
      .text = fmt::format(
          "Every mode has two points h lambda. A step is stable where all lie in the region of its method. "
          "Smallest stable number of steps a second:\n\n{}",
          table),
      .figures = {draw(figure, folder, "regions_and_eigenvalues")},
      .printed =
          "Eigenvalues in the plane (slides 21 and 59); \"280 steps per second, mass 5 grams\" (58); explicit "
          "integration is \"not stable\" but for a \"large mass\" (60)."};
}

ReportSection inner_systems(const StaticModel& model, double relaxation) {
  const std::vector<InnerTolerance> rows = inner_tolerances(model, relaxation);
  std::string table =
      "| method | tolerance of SOR | outcome | iterations | sweeps in all | CPU time [ms] |\n"
      "| --- | ---: | --- | ---: | ---: | ---: |\n";
  for (const InnerTolerance& row : rows)
    table += fmt::format("| {} | {:g} | {} | {} | {} | {:.3g} |\n", markdown_text(name_of(row.method)),
                         row.tolerance, row.converged ? "converged" : "not converged", row.iterations,
                         row.sweeps, 1000 * row.seconds);
  const auto gain = [&](StaticMethod method) {
    double loose = 0, tight = 0;
    for (const InnerTolerance& row : rows) {
      if (row.method == method && row.tolerance == 0.1) loose = row.seconds;
      if (row.method == method && row.tolerance == 1e-4) tight = row.seconds;
    }
    return tight / loose;
  };
  return {
      .title = "How far to solve the linear systems of Newton's methods",
      .text = fmt::format(
          "{}\nFrom a tolerance of 0.1 to one of 1e-4 the modified method takes {:.2g} times as long, "
          "Newton's {:.2g} times.",
          table, gain(StaticMethod::modified_newton), gain(StaticMethod::newton)),
      .printed =
          "Modified method: an accurate solution \"does not allow faster solution\" (slide 63). Newton's method: "
          "\"global time gain when solving linear system accurately\" (64)."};
}

ReportSection pre_inversion(const StaticModel& model) {
  const LinearSolutions found = linear_solutions(model);
  return {
      .title = "The linear model: pre-inverted and prefactored",
      .text = fmt::format(
          "{} degrees of freedom. A displacement field takes {:.3g} ms with the inverse of K and {:.3g} ms "
          "with its factors; the inverse takes {:.3g} ms to make and {:.3g} MB, the factors {:.3g} ms.",
          found.dofs, 1000 * found.multiply, 1000 * found.solve, 1000 * found.invert,
          1e-6 * found.inverse_bytes, 1000 * found.factor),
      .printed = "\"Pre-inversion (if enough space)\" (slide 16)."};
}

ReportSection pseudo_dynamics(const StaticModel& model) {
  constexpr int frames = 60;
  std::string table =
      "| iterations a frame | largest error of a frame [%] | frame [ms] |\n| ---: | ---: | ---: |\n";
  for (const FrameBudget& budget : frame_budgets(model, frames))
    table += fmt::format("| {} | {} | {:.3g} |\n", budget.iterations,
                         std::isnan(budget.error) ? "diverged" : fmt::format("{:.2g}", 100 * budget.error),
                         1000 * budget.seconds);
  return {
      .title = "Pseudo-dynamic: a few iterations a frame",
      .text = fmt::format(
          "The load is brought on within a second of {} frames; each frame begins where the one before "
          "ended. The error is that of the displacements against the equilibrium of the frame.\n\n{}",
          frames, table),
      .printed =
          "\"60 NR iterations/sec on SGI Octane 175 MHz\" with 1157 tetrahedra (slide 66): one iteration a frame at "
          "60 Hz."};
}

ReportSection rates(const TissueOptions& options) {
  constexpr const char* material = "male_normal";
  const std::vector<std::string> meshes =
      options.quick ? std::vector<std::string>{"phantom"} : std::vector<std::string>{"phantom", "liver"};
  std::string table =
      "| mesh | model | tetrahedra | edges | outcome | error [%] | step [ms] | 99 % [ms] | steps a second |\n"
      "| --- | --- | ---: | ---: | --- | ---: | ---: | ---: | ---: |\n";
  const std::vector<ConstantJacobian> rows = constant_jacobians(meshes, material);
  for (const ConstantJacobian& row : rows)
    table += fmt::format("| {} | {} | {} | {} | {} | {:.2g} | {:.3g} | {:.3g} | {:.0f} |\n", row.mesh,
                         markdown_text(row.model), row.tetrahedra, row.springs,
                         row.reached_end ? "stable" : "not stable", 100 * row.error, 1000 * row.p50,
                         1000 * row.p99, 1 / row.p50);
  const bool stable = std::ranges::all_of(rows, &ConstantJacobian::reached_end);
  return {
      .title = "Linearly implicit Euler with a constant Jacobian at 100 Hz",
      .text = fmt::format(
          "Bodies that are pressed, held and left, one step of 10 ms a frame, factors of the start kept. {} "
          "The error is the largest distance of a point from the converged motion, relative to the "
          "largest displacement.\n\n{}\nNewton's method makes {:.0f} iterations a second on the {}.",
          stable ? "All reach the end." : "Not all reach the end.", table,
          newton_rate(meshes.back(), material), meshes.back()),
      .printed =
          "The thigh at 100 Hz with a constant Jacobian (slides 34, 35); 1151 tetrahedra and 3399 springs at 150 Hz "
          "on an SGI Onyx2 (60); 60 iterations of Newton's method a second on an SGI Octane (66).",
      .differs =
          "The machine, twenty-five years younger. The step is stable and heavily damped: the error is that of a "
          "first-order method at 10 ms."};
}

ReportSection force_feedback(const std::filesystem::path& folder) {
  constexpr double from = 0.3, to = 0.45;  // [s]
  const HapticContact contact;
  const std::vector<HapticForce> forces = haptic_forces(true_thigh(4, 4), contact);
  Panel panel{.x = {.label = "t [s]"}, .y = {.label = "force on the hand [N]"}};
  std::string table =
      "| what the hand feels | error, root mean square [%] | largest error [%] | largest change in 1 ms [N] |\n"
      "| --- | ---: | ---: | ---: |\n";
  int k = 0;
  for (const HapticForce& each : forces) {
    table += fmt::format("| {} | {:.2g} | {:.2g} | {:.3g} |\n", each.name, 100 * each.rms, 100 * each.largest,
                         each.jump);
    Curve curve{.label = each.name, .style = family_style(k++, false)};
    for (std::size_t i = 0; i < each.t.size(); ++i)
      if (each.t[i] >= from && each.t[i] <= to) {
        curve.x.push_back(each.t[i]);
        curve.y.push_back(each.force[i]);
      }
    panel.curves.push_back(std::move(curve));
  }
  const HapticForce &held = forces.at(2), &local = forces.at(4);
  const Figure figure{
      .title = "A local model smooths what the hand feels between two frames",
      .panels = {panel},
      .footer = fmt::format(
          "thigh of 16 points, pressed by {:g} mm and shaken by {:g} mm at {:g} Hz; contact {:g} N/m",
          1000 * contact.depth, 1000 * contact.shake, contact.frequency, contact.stiffness),
      .panel_height = 320};
  return {
      .title = "Force feedback at 1 kHz with tissue at 100 Hz",
      .text = fmt::format(
          "A probe presses a point of the thigh through a penalty spring. Tissue by linearly implicit Euler; "
          "between its frames the force is held, or follows from the tissue that is held, or from a local "
          "model: the tissue gives way by the compliance of its own step.\n\n{}\nThe local model leaves "
          "{:.2g} times the error of the held force and {:.2g} times its largest change. What is left is "
          "mostly that of the steps of 10 ms.",
          table, local.rms / held.rms, local.jump / held.jump),
      .figures = {draw(figure, folder, "force_feedback")},
      .printed =
          "Force over time with and without a local model (slides 43 to 45); numbers are not printed."};
}

}  // namespace hmax
