/// hmax stability modes, and hmax stability matrices: what free motion is made of, and its matrices as files
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>

#include <fmt/format.h>

#include "analysis/spectrum/extreme_eigenvalues.hpp"
#include "catalogue/models/equilibria/body_balance.hpp"
#include "catalogue/models/matrix_problem.hpp"
#include "catalogue/models/model.hpp"
#include "cli/bodies/body_words.hpp"
#include "cli/bodies/matrix_files.hpp"
#include "cli/shared/choices.hpp"
#include "cli/shared/options.hpp"
#include "cli/shared/outputs.hpp"
#include "cli/stability/operating_point.hpp"
#include "cli/stability/stability.hpp"
#include "core/errors.hpp"
#include "core/text/sentences.hpp"
#include "limits/modes/fastest_mode.hpp"
#include "problems/mesh/files/mesh_import.hpp"
#include "problems/mesh/files/mesh_writers.hpp"
#include "problems/mesh/mesh_quality.hpp"
#include "problems/tissue/body.hpp"
#include "results/json.hpp"
#include "results/table.hpp"

namespace hmax {

namespace {

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
  return field * (0.1 * diagonal_of(mesh) / field.colwise().norm().maxCoeff());
}

/// The largest K_ii / m_i [1/s^2].
double stiffest_point(const MechanicalPart& part) {
  const Eigen::VectorXd diagonal = std::get<Eigen::SparseMatrix<double>>(part.K).diagonal();
  return diagonal.cwiseQuotient(part.mass.diagonal()).cwiseAbs().maxCoeff();
}

/// Throws unless the shapes that are asked for can be written.
void check_output(const ModesOptions& options) {
  if (options.output.empty()) return;
  if (std::filesystem::path(options.output).extension() != ".vtu")
    throw InputError(
        fmt::format("shapes are written as .vtu and not as '{}'; change the extension", options.output));
  check_writable(options.output);
}

struct FreeMode {
  double kappa;  ///< [1/s^2]
  double omega;  ///< [rad/s]
  double zeta;
  Eigen::VectorXd shape;

  [[nodiscard]] double frequency() const { return omega / (2 * std::numbers::pi); }
};

/// The slowest or the fastest modes.
/// @param rigid     modes of a stiffness up to this one have no frequency [1/s^2]
/// @param unknowns  what they are called
std::vector<FreeMode> free_modes(const MechanicalPart& part, Eigen::Index count, bool fastest, double rigid,
                                 std::string_view unknowns) {
  const ExtremeStiffnesses found =
      fastest ? largest_stiffnesses(part, count) : smallest_stiffnesses(part, count);
  if (!found.converged)
    throw InputError(
        fmt::format("the modes of {} {} did not converge; ask for fewer", part.mass.size(), unknowns));
  std::vector<FreeMode> modes;
  for (std::size_t i = 0; i < found.kappa.size(); ++i) {
    const double kappa = found.kappa[i], omega = kappa > rigid ? std::sqrt(kappa) : 0;
    const Eigen::VectorXd u = found.shapes.col(static_cast<Eigen::Index>(i));
    const Eigen::VectorXd Cu = std::visit([&](const auto& C) -> Eigen::VectorXd { return C * u; }, part.C);
    modes.push_back({kappa, omega, omega > 0 ? 0.0 + u.dot(Cu) / (2 * omega) : 0, u});  // no -0
  }
  return modes;
}

/// A mode of a body and where it lives.
struct ModeReport : FreeMode {
  bool strains;  ///< false: the body moves as one, but for rounding
  ModeOwner owner;
  NamedElement element;
};

std::vector<ModeReport> reports_of(const Problem& problem, const MechanicalPart& part, Eigen::Index count,
                                   bool fastest) {
  const TissueBody& body = *problem.body;
  const ElementSum elements = elements_of(body);
  // Modes that strain nothing but for rounding have no frequency, and no element has a share of them.
  const double rigid = 1e-10 * stiffest_point(part);
  Eigen::VectorXd mass(body.dofs() / 3);
  for (Eigen::Index i = 0; i < mass.size(); ++i) mass[i] = body.mass()[3 * i];
  std::vector<ModeReport> modes;
  for (const FreeMode& mode : free_modes(part, count, fastest, rigid, "degrees of freedom")) {
    const ModeOwner owner = owner_of(elements, mass, mode.shape);
    modes.push_back({mode, std::abs(mode.kappa) > rigid, owner, named_element(problem, owner.element)});
  }
  return modes;
}

Json to_json(const ModeReport& mode) {
  return {HMAX_KEYS(mode, kappa, omega),
          {"frequency", mode.frequency()},
          {"zeta", mode.zeta},
          {"moving_points", mode.owner.moving_points},
          {"element", mode.strains ? Json(mode.element.number) : Json()},
          {"element_kind", mode.strains ? Json(mode.element.kind) : Json()},
          {"points", mode.strains ? Json(mode.element.points) : Json()},
          {"element_share", mode.strains ? Json(mode.owner.share) : Json()},
          {"status", mode.strains ? "" : "the body moves as one, which strains no element"}};
}

std::string table_of(const std::vector<ModeReport>& modes, const Console& console) {
  TextTable table(
      {"mode", "frequency [Hz]", "omega [rad/s]", "zeta", "moving points", "element with most energy"});
  for (std::size_t i = 0; i < modes.size(); ++i) {
    const ModeReport& mode = modes[i];
    table.add({std::to_string(i + 1), short_number(mode.frequency()), short_number(mode.omega),
               short_number(mode.zeta, 4), short_number(mode.owner.moving_points, 3),
               mode.strains ? fmt::format("{} with {} %", in_words(mode.element),
                                          short_number(100 * mode.owner.share, 3))
                            : "none: it moves as one"});
  }
  return table.text(console);
}

void write_shapes(const std::string& file, const TissueBody& body, const std::vector<ModeReport>& modes) {
  MeshFields fields;
  for (std::size_t i = 0; i < modes.size(); ++i)
    fields.points.push_back(
        {fmt::format("mode_{}", i + 1), body.origin()->on_points(on_points(body, modes[i].shape))});
  write_file(file, vtu_text(body.origin()->file, fields));
}

Json to_json(const ModesOptions& options, const Problem& problem, const OperatingPoint& point,
             const std::vector<ModeReport>& modes) {
  const std::string status = joined(point.status, point.missing);
  Json list = Json::array();
  for (const ModeReport& mode : modes) list.push_back(to_json(mode));
  return {{"problem", problem.id},
          {"material", json_or_null(problem.material)},
          {"dofs", problem.body->dofs()},
          {"state_kind", name_of(point.kind)},
          {"status", json_or_null(status)},
          {"end", options.fastest ? "fastest" : "slowest"},
          {"modes", list},
          {"output", json_or_null(options.output)}};
}

std::string in_words(const Problem& problem, const OperatingPoint& point,
                     const std::vector<ModeReport>& modes, const Console& console) {
  std::string text = fmt::format("{}{}: {} degrees of freedom\n\n{}", problem.id,
                                 problem.material.empty() ? "" : ", " + problem.material,
                                 problem.body->dofs(), table_of(modes, console));
  if (!point.status.empty()) text += "\n" + point.state + "\n";
  if (!point.missing.empty()) text += "\n" + point.missing + "\n";
  return text +
         "\nTetrahedra have the numbers of their file, or count from 1. Moving points: 1 over the sum of squares of "
         "the\npoints' shares of kinetic energy.\n";
}

struct MatrixMode : FreeMode {
  double moving;         ///< 1 over the sum of squares of the unknowns' shares of kinetic energy
  Eigen::Index unknown;  ///< with the largest share
  double share;
};

/// The slowest or the fastest modes of matrices of a user, and which unknowns move in them.
void print_matrix_modes(const Problem& problem, const OperatingPoint& point, Eigen::Index count, bool fastest,
                        Console& console) {
  if (!point.model.mechanical)
    throw InputError("a first-order model has no modes of free motion; give stiffness and mass");
  const MechanicalPart& part = *point.model.mechanical;
  if (!part.symmetric)
    throw InputError(
        "stiffness and damping are not both symmetric, so there are no modes of free motion; `hmax stability "
        "predict` takes such matrices");
  count = std::min(count, part.mass.size());
  std::vector<MatrixMode> modes;
  for (const FreeMode& mode : free_modes(part, count, fastest, 0, "unknowns")) {
    const Eigen::VectorXd shares = mode.shape.cwiseProduct(part.mass.times(mode.shape));
    MatrixMode& added = modes.emplace_back(MatrixMode{mode, 1 / shares.squaredNorm(), 0, 0});
    added.share = shares.maxCoeff(&added.unknown);
  }
  const MatrixModel* model = problem.matrices.get();
  const auto row_of = [&](const MatrixMode& mode) {
    return model->unknowns[static_cast<std::size_t>(mode.unknown)];
  };
  if (console.json) {
    Json list = Json::array();
    for (const MatrixMode& mode : modes)
      list.push_back({HMAX_KEYS(mode, kappa, omega),
                      {"frequency", mode.frequency()},
                      {"zeta", mode.zeta},
                      {"moving_unknowns", mode.moving},
                      {"unknown", row_of(mode) + 1},
                      {"unknown_share", mode.share}});
    return console.print_json({{"problem", problem.id},
                               {"dofs", part.mass.size()},
                               {"state_kind", name_of(point.kind)},
                               {"end", fastest ? "fastest" : "slowest"},
                               {"modes", list}});
  }
  TextTable table(
      {"mode", "frequency [Hz]", "omega [rad/s]", "zeta", "moving unknowns", "largest share of the energy"});
  for (std::size_t i = 0; i < modes.size(); ++i)
    table.add({std::to_string(i + 1), short_number(modes[i].frequency()), short_number(modes[i].omega),
               short_number(modes[i].zeta, 4), short_number(modes[i].moving, 3),
               fmt::format("{} with {} %", model->name_of(row_of(modes[i])),
                           short_number(100 * modes[i].share, 3))});
  console.print(fmt::format("{}\n{}\n\n{}", problem.id, problem.note, table.text(console)));
}

void modes(const ModesOptions& options, Console& console) {
  const Problem problem = options.problem.make();
  options.problem.remark_idle(console, problem);
  if (problem.matrices) {
    if (!options.output.empty())
      throw InputError("--output writes shapes on a mesh, and matrices have none; remove it");
    remark_unusual(console, problem);
    return print_matrix_modes(problem, operating_point(problem, options.at.of(problem)),
                              static_cast<Eigen::Index>(parse_count("--count", options.count, 1)),
                              options.fastest, console);
  }
  const TissueBody& body =
      require_body(problem, "so its modes have no shapes; name one with --mesh, or matrices with --matrices");
  check_output(options);
  const auto count = static_cast<Eigen::Index>(
      std::min<std::int64_t>(parse_count("--count", options.count, 1), body.dofs()));
  const OperatingPoint point = operating_point(problem, options.at, "modes", console);
  const MechanicalPart& part = *point.model.mechanical;
  if (!part.symmetric)
    throw InputError("the stiffness of this body is not symmetric here, so it has no modes of free motion");
  const std::vector<ModeReport> reports = reports_of(problem, part, count, options.fastest);
  if (!options.output.empty()) write_shapes(options.output, body, reports);
  console.show(to_json(options, problem, point, reports), in_words(problem, point, reports, console));
}

struct MatricesOptions {
  ProblemChoice problem;
  OperatingPointChoice at;
  std::string output;
};

void matrices(const MatricesOptions& options, Console& console) {
  if (options.output.empty()) throw InputError("no folder is given; add --output FOLDER");
  const Problem problem = options.problem.make();
  options.problem.remark_idle(console, problem);
  write_matrices(problem, operating_point(problem, options.at, "matrices", console), options.output, console);
}

}  // namespace

void add_stability_modes(CLI::App& stability, Console& console) {
  const auto [command, options] =
      add_command(stability, console, "modes",
                  "Compute the slowest or the fastest modes of a body on a mesh, or of matrices",
                  {"hmax stability modes --mesh liver --material liver:male_normal --output modes.vtu",
                   "hmax stability modes --mesh phantom --model mass_spring --fastest --count 3 --json"},
                  modes);
  options.problem.add_to(command);
  options.at.add_to(command);
  add_text(command, "--count", options.count, "Number of modes; 6 by default", "NUMBER");
  add_flag(command, "--fastest", options.fastest,
           "The fastest modes, which limit the step size, instead of the slowest");
  add_text(command, "--output", options.output,
           "Write the mode shapes for ParaView, scaled to at most a tenth of the body", "FILE.vtu");
  add_force(command);
  add_jobs(command);
}

void add_stability_matrices(CLI::App& stability, Console& console) {
  const auto [command, options] = add_command(
      stability, console, "matrices", "Write stiffness, mass and damping of a model as Matrix Market files",
      {"hmax stability matrices --mesh phantom --material liver:male_normal --at rest --output phantom",
       "hmax stability matrices --problem spring_chain --output chain --json"},
      matrices);
  options.problem.add_to(command);
  options.at.add_to(command);
  add_text(
      command, "--output", options.output,
      "Folder of stiffness.mtx, mass.mtx and damping.mtx, or of jacobian.mtx of a first-order model; it is "
      "made if needed; of a body stiffness.dof names the unknowns",
      "FOLDER");
  add_force(command);
  add_jobs(command);
}

}  // namespace hmax
