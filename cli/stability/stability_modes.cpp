/// hmax stability modes
#include <cmath>
#include <filesystem>
#include <numbers>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "analysis/spectrum/extreme_eigenvalues.hpp"
#include "bench/limits/fastest_mode.hpp"
#include "bench/limits/predict.hpp"
#include "bench/models/body_balance.hpp"
#include "cli/shared/choices.hpp"
#include "cli/shared/outputs.hpp"
#include "cli/stability/operating_point.hpp"
#include "cli/stability/stability.hpp"
#include "problems/mesh/files/mesh_import.hpp"
#include "problems/mesh/files/mesh_writers.hpp"
#include "problems/tissue/body.hpp"
#include "results/errors.hpp"
#include "results/table.hpp"

namespace hmax {

namespace {

using Json = nlohmann::ordered_json;

struct ModesOptions {
  ProblemChoice problem;
  std::string count = "6", output;
  bool fastest = false;
  OperatingPointChoice at;
};

/// A shape on all points of the mesh, its longest displacement a tenth of the body, shape (3, points).
Eigen::MatrixXd on_points(const TissueBody& body, const Eigen::VectorXd& shape) {
  const TetMesh& mesh = body.mesh();
  Eigen::MatrixXd field = Eigen::MatrixXd::Zero(3, mesh.point_count());
  for (std::size_t i = 0; i < body.free_points().size(); ++i)
    field.col(body.free_points()[i]) = shape.segment<3>(3 * static_cast<Eigen::Index>(i));
  const double size = (mesh.points.rowwise().maxCoeff() - mesh.points.rowwise().minCoeff()).norm();
  return field * (0.1 * size / field.colwise().norm().maxCoeff());
}

/// The largest K_ii / m_i [1/s^2].
double stiffest_point(const MechanicalPart& part) {
  const Eigen::VectorXd diagonal = std::get<Eigen::SparseMatrix<double>>(part.K).diagonal();
  return diagonal.cwiseQuotient(part.mass).cwiseAbs().maxCoeff();
}

void modes(const ModesOptions& options, Console& console) {
  const Problem problem = options.problem.make();
  if (!problem.body)
    throw InputError(fmt::format("{} is no body on a mesh, so its modes have no shapes; name one with --mesh",
                                 problem.id));
  if (!options.output.empty()) {
    if (std::filesystem::path(options.output).extension() != ".vtu")
      throw InputError(
          fmt::format("shapes are written as .vtu and not as '{}'; change the extension", options.output));
    check_writable(options.output);
  }
  const TissueBody& body = *problem.body;
  const auto count = static_cast<Eigen::Index>(
      std::min<std::int64_t>(parse_count("--count", options.count, 1), body.dofs()));
  const OperatingPoint at = options.at.of(problem);
  announce_equilibrium(console, problem, at);
  const Linearised near = [&] {
    Progress progress(console, "modes");
    LinearisationProgress shown(progress);
    return without_spectrum(problem, at, shown.watcher());
  }();
  const MechanicalPart& part = *near.model.mechanical;
  if (!part.symmetric)
    throw InputError("the stiffness of this body is not symmetric here, so it has no modes of free motion");
  const ExtremeStiffnesses found =
      options.fastest ? largest_stiffnesses(part, count) : smallest_stiffnesses(part, count);
  if (!found.converged)
    throw InputError(
        fmt::format("the modes of {} degrees of freedom did not converge; ask for fewer", body.dofs()));

  const ElementSum elements = elements_of(body);
  // Modes that strain nothing but for rounding have no frequency, and no element has a share of them.
  const double rigid = 1e-10 * stiffest_point(part);
  Eigen::VectorXd mass(body.dofs() / 3);
  for (Eigen::Index i = 0; i < mass.size(); ++i) mass[i] = body.mass()[3 * i];
  Json list = Json::array();
  TextTable table(
      {"mode", "frequency [Hz]", "omega [rad/s]", "zeta", "moving points", "element with most energy"});
  MeshFields fields;
  for (std::size_t i = 0; i < found.kappa.size(); ++i) {
    const Eigen::VectorXd u = found.shapes.col(static_cast<Eigen::Index>(i));
    const bool strains = std::abs(found.kappa[i]) > rigid;
    const double omega = strains ? std::sqrt(std::max(found.kappa[i], 0.0)) : 0;
    const double gamma = u.dot(Eigen::VectorXd(std::get<Eigen::SparseMatrix<double>>(part.C) * u));
    const double zeta = omega > 0 ? gamma / (2 * omega) : 0;
    const ModeOwner owner = owner_of(elements, mass, u);
    const NamedElement element = named_element(problem, owner.element);
    list.push_back({{"kappa", found.kappa[i]},
                    {"omega", omega},
                    {"frequency", omega / (2 * std::numbers::pi)},
                    {"zeta", zeta},
                    {"moving_points", owner.moving_points},
                    {"element", strains ? Json(element.number) : Json()},
                    {"element_kind", strains ? Json(element.kind) : Json()},
                    {"element_share", strains ? Json(owner.share) : Json()},
                    {"status", strains ? "" : "the body moves as one, which strains no element"}});
    table.add({std::to_string(i + 1), short_number(omega / (2 * std::numbers::pi)), short_number(omega),
               short_number(zeta, 4), short_number(owner.moving_points, 3),
               strains ? fmt::format("{} {} with {} %", element.kind, element.number,
                                     short_number(100 * owner.share, 3))
                       : "none: it moves as one"});
    fields.points.push_back(
        {fmt::format("mode_{}", i + 1), problem.body->origin()->on_points(on_points(body, u))});
  }
  if (!options.output.empty()) write_file(options.output, vtu_text(problem.body->origin()->file, fields));
  const std::string status =
      near.status + (near.status.empty() || near.missing.empty() ? "" : "; ") + near.missing;
  if (console.json)
    return console.print_json({{"problem", problem.id},
                               {"material", problem.material.empty() ? Json() : Json(problem.material)},
                               {"dofs", body.dofs()},
                               {"state_kind", near.state_kind},
                               {"status", status.empty() ? Json() : Json(status)},
                               {"end", options.fastest ? "fastest" : "slowest"},
                               {"modes", list},
                               {"output", options.output.empty() ? Json() : Json(options.output)}});
  console.print(fmt::format("{}{}: {} degrees of freedom\n\n{}", problem.id,
                            problem.material.empty() ? "" : ", " + problem.material, body.dofs(),
                            table.text(console)));
  if (!near.status.empty()) console.print("\n" + near.state + "\n");
  if (!near.missing.empty()) console.print("\n" + near.missing + "\n");
  console.print(
      "\nTetrahedra have the numbers of their file, or count from 1. Moving points: 1 over the sum of squares of "
      "the\npoints' shares of kinetic energy.\n");
}

}  // namespace

void add_stability_modes(CLI::App& stability, Console& console) {
  CLI::App& command =
      add_command(stability, console, "modes",
                  "The slowest or the fastest modes of a body on a mesh, and their shapes for ParaView",
                  {"hmax stability modes --mesh liver --material liver:male_normal --output modes.vtu",
                   "hmax stability modes --mesh phantom --model mass_spring --fastest --count 3 --json"});
  const auto options = std::make_shared<ModesOptions>();
  options->problem.add_to(command);
  options->at.add_to(command);
  command.add_option("--count", options->count, "How many; 6 by default")->type_name("NUMBER");
  command.add_flag("--fastest", options->fastest, "From the fast end, which limits steps");
  command
      .add_option("--output", options->output,
                  "Write the shapes as fields of three components, each a tenth of the body at most")
      ->type_name("FILE.vtu");
  add_force(command);
  command.callback([options, &console] { modes(*options, console); });
}

}  // namespace hmax
