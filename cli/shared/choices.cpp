#include "cli/shared/choices.hpp"

#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "catalogue/methods/catalogue.hpp"
#include "catalogue/methods/tableau_file.hpp"
#include "catalogue/models/matrix_problem.hpp"
#include "catalogue/models/mesh_choice.hpp"
#include "catalogue/models/problems.hpp"
#include "catalogue/models/tissue_choice.hpp"
#include "catalogue/models/tissue_problem.hpp"
#include "catalogue/plugin/plugin_model.hpp"
#include "catalogue/scenes/scene.hpp"
#include "cli/shared/options.hpp"
#include "core/errors.hpp"
#include "core/numbers.hpp"
#include "core/text/split.hpp"
#include "problems/formula_parser.hpp"
#include "results/json.hpp"

namespace hmax {
namespace {

/// @throws InputError  where --set names what `option` is short for
void refuse_twice(const std::vector<std::string>& set, std::string_view name, std::string_view option) {
  for (const std::string& assignment : set)
    if (parse_assignment("--set", assignment).first == name)
      throw InputError(fmt::format("{} and --set {} say the same; give one of them", option, assignment));
}

}  // namespace

void add_support(CLI::App& command, std::vector<std::string>& sets, std::string_view otherwise) {
  add_repeated(
      command, "--support", sets,
      fmt::format(
          "Points of a mesh that are fixed, {}: the NAME of a group or region of the file, "
          "surface:30, points:1,5,9, @FILE of such numbers, one side of a plane like z<0.01 [m], or a box "
          "XMIN,XMAX,YMIN,YMAX,ZMIN,ZMAX [m]; "
          "may be repeated",
          otherwise),
      "SET");
}

void MeshOptions::add_to(CLI::App& command) {
  const HelpGroup group(command, model_group);
  add_text(command, "--mesh", mesh,
           "Tissue on a mesh: a name of `hmax mesh`, like liver or ball:n=8, or a mesh file", "NAME");
  add_text(
      command, "--scene", scene,
      "Body, load and step of another program's scene, with --unit: CalculiX/Abaqus .inp, SOFA .scn, FEBio .feb, MuJoCo .xml",
      "FILE");
  add_text(command, "--ignore", ignored,
           "Parts of --scene that are left out where hmax does not understand them, like CLOAD,BOUNDARY",
           "PART,...");
  add_text(
      command, "--unit", unit,
      "Unit of a mesh file: m, cm, mm or a number of metres; of a scene length, mass and time: m,kg,s or mm,t,s",
      "UNIT");
  add_text(command, "--model", model,
           fmt::format("Model of the body: {}; {} by default", fmt::join(tissue_model_ids(), ", "),
                       tissue_models().front().id),
           "ID");
  add_text(command, "--load", load,
           fmt::format("Load on the body: {}; {} by default", fmt::join(tissue_loads(), ", "),
                       tissue_loads().front()),
           "ID");
  add_text(command, "--gravity", gravity,
           "Gravity on a mesh [m/s2], like 0,-9.81,0; short for --set gx, gy, gz", "X,Y,Z");
  add_support(command, supports);
  add_text(command, "--tool-at", tool_at,
           "Start of the tip of --load tool [m]; short for --set tool_x, tool_y, tool_z", "X,Y,Z");
  add_text(command, "--tool-direction", tool_direction,
           "Direction of --load tool, like 0,-1,0; short for --set tool_dx, tool_dy, tool_dz", "X,Y,Z");
}

std::string MeshOptions::problem_id() const {
  if (!mesh.empty() && !scene.empty())
    throw InputError("--mesh and --scene are both given; choose one of them");
  if (!ignored.empty() && scene.empty())
    throw InputError("--ignore leaves out parts of a scene; name one with --scene, or remove it");
  if (!mesh.empty()) return tissue_id(model, mesh, load);
  if (!scene.empty()) return tissue_id(model.empty() ? read().model : model, scene, load);
  for (const auto& [option, value] : {std::pair("--model", &model), {"--load", &load}})
    if (!value->empty()) throw InputError(fmt::format("{} belongs to a mesh; name one with --mesh", option));
  return {};
}

const Scene& MeshOptions::read() const {
  if (!read_) read_ = read_scene(scene, unit, ignored);
  return *read_;
}

void MeshOptions::remark_scene(Console& console, bool takes_linear) const {
  if (scene.empty()) return;
  for (const std::string& note : read().notes) console.remark(note);
  if (const std::string& most = read().gradients; !most.empty())
    console.remark(fmt::format(
        "this scene solves its equations by up to {} conjugate gradients, and hmax to rounding{}", most,
        takes_linear ? fmt::format("; --linear cg:TOLERANCE,{} does as the scene", most) : ""));
}

std::optional<double> MeshOptions::metres() const {
  if (!scene.empty()) return read().settings.unit;
  return unit.empty() ? std::nullopt : std::optional(unit_in_metres(unit));
}

std::vector<std::pair<std::string, double>> MeshOptions::of_scene(const std::vector<std::string>& set,
                                                                  std::string_view material) const {
  if (scene.empty()) return {};
  std::vector<std::pair<std::string, double>> parameters = read().settings.parameters;
  const auto replace = [&](const std::string& name) { leave_out(read(), parameters, name); };
  for (const std::string& assignment : set) replace(parse_assignment("--set", assignment).first);
  for (const std::string_view part : split(material, ",")) {
    const std::size_t equals = part.rfind('=');
    const bool is_of_region = equals != std::string_view::npos;
    if (trimmed(part).empty()) continue;
    for (const char* name : {"E", "nu", "rho"})
      replace(is_of_region ? fmt::format("{}:{}", name, trimmed(part.substr(0, equals))) : name);
    if (!is_of_region) replace("mass");
  }
  // Another load replaces that of the scene.
  if (!load.empty() && load != tissue_loads().front()) {
    replace("g");
    for (const std::string_view name : gravity_names) replace(std::string(name));
    for (const std::string_view name : nodal_force_names) replace(std::string(name));
  }
  if (!supports.empty()) replace(std::string(support_name));
  require_in_range(read(), parameters);
  return parameters;
}

std::vector<std::pair<std::string, double>> MeshOptions::parameters(const std::vector<std::string>& set,
                                                                    std::string_view material) const {
  std::vector<std::pair<std::string, double>> parameters = of_scene(set, material);
  const auto take = [&](const char* option, const std::string& text,
                        const std::array<std::string_view, 3>& names) {
    if (text.empty()) return;
    for (const std::string_view name : names) refuse_twice(set, name, option);
    const std::vector<double> vector = parse_numbers(option, text);
    if (vector.size() != names.size())
      throw InputError(fmt::format("{} has {} numbers but is a vector of three; write it like 0,-1,0", option,
                                   vector.size()));
    for (std::size_t i = 0; i < names.size(); ++i) parameters.emplace_back(names[i], vector[i]);
  };
  take("--gravity", gravity, gravity_names);
  take("--tool-at", tool_at, tool_place_names);
  take("--tool-direction", tool_direction, tool_direction_names);
  for (const std::string& support : supports)
    parameters.emplace_back(fmt::format("{}:{}", support_name, support), 1);
  return parameters;
}

void MatrixOptions::add_to(CLI::App& command) {
  const HelpGroup group(command, model_group);
  add_text(
      command, "--matrices", matrices,
      "Linear model of your own matrices: stiffness=K.mtx,mass=M.mtx[,damping=C.mtx][,initial=q.mtx], or "
      "jacobian=J.mtx; Matrix Market, PETSc binary or CalculiX .sti and .mas; mass=lumped:M.mtx sums rows, "
      "storage=triangle mirrors files, drop=constraints leaves constraint rows out, stiffness=series:K.txt names "
      "matrices at several times",
      "KEY=FILE,...");
  add_number(command, "--alpha", alpha,
             "Rayleigh damping alpha M of matrices or a body [1/s]; short for --set alpha");
  add_number(command, "--beta", beta,
             "Rayleigh damping beta K of matrices or a body [s]; short for --set beta");
}

std::string MatrixOptions::problem_id() const {
  return matrices.empty() ? std::string() : matrices_id(matrices);
}

std::vector<std::pair<std::string, double>> MatrixOptions::parameters(
    const std::vector<std::string>& set) const {
  std::vector<std::pair<std::string, double>> parameters;
  for (const auto& [name, value] : {std::pair("alpha", &alpha), {"beta", &beta}}) {
    if (!*value) continue;
    refuse_twice(set, name, fmt::format("--{}", name));
    parameters.emplace_back(name, **value);
  }
  return parameters;
}

void add_timeout(CLI::App& command, std::optional<double>& seconds) {
  add_number(command, "--timeout,--patience", seconds,
             "Timeout of one call of the plugin [s]; 10 by default");
}

void add_settings(CLI::App& command, std::vector<std::string>& set, std::string& y0) {
  const HelpGroup group(command, model_group);
  add_repeated(command, "--set", set, "Change a parameter, like c=6; may be repeated", "NAME=VALUE");
  add_text(command, "--y0", y0, "Initial state, one number for each component, like 0.5,1", "NUMBERS");
}

void ProblemChoice::add_to(CLI::App& command) {
  add_name_to(command);
  body.add_to(command);
  add_rest_to(command);
}

void ProblemChoice::add_without_meshes_to(CLI::App& command) {
  takes_meshes = false;
  add_name_to(command);
  add_rest_to(command);
}

void ProblemChoice::add_name_to(CLI::App& command) {
  const HelpGroup group(command, model_group);
  add_text(command, "--problem", problem, "An id of `hmax list problems`, or a file of formulas FILE.toml",
           "ID");
  add_footer(command, "Formulas: " + formula_language());
}

void ProblemChoice::add_rest_to(CLI::App& command) {
  own.add_to(command);
  const HelpGroup group(command, model_group);
  add_text(
      command, "--plugin", plugin,
      "Model of your own behind the C interface hmax/plugin.h, `hmax probe --example FOLDER` writes one; or a unit of FMI 2.0 "
      "(unit.fmu)",
      "FILE.so[:NAME[:ARGUMENT]]");
  add_timeout(command, timeout);
  add_settings(command, set, y0);
  add_text(
      command, "--material", material,
      "An id of `hmax list materials`, with ':light' or ':heavy' after it; of a mesh also of regions, like "
      "tissue:liver,tumour=tissue:fibroadenoma",
      "ID");
}

std::string ProblemChoice::id() const {
  const std::string on_mesh = body.problem_id();
  std::vector<std::string_view> given;
  if (!problem.empty()) given.emplace_back("--problem");
  if (!body.mesh.empty()) given.emplace_back("--mesh");
  if (!body.scene.empty()) given.emplace_back("--scene");
  if (!own.matrices.empty()) given.emplace_back("--matrices");
  if (!plugin.empty()) given.emplace_back("--plugin");
  if (given.empty())
    throw InputError(fmt::format(
        "no problem is given; name one with --problem, `hmax list problems` shows all of them, {}matrices "
        "with --matrices, or a plugin with --plugin",
        takes_meshes ? "a mesh with --mesh, a scene with --scene, " : ""));
  if (given.size() > 1)
    throw InputError(fmt::format("{} and {} are both given; choose one of them", given[0], given[1]));
  if (!own.matrices.empty()) return own.problem_id();
  if (!plugin.empty()) return plugin_id(plugin);
  return problem.empty() ? on_mesh : problem;
}

ProblemSettings ProblemChoice::settings() const {
  const std::string named = problem.empty() ? "the model" : problem;
  const bool has_mesh = body.is_given() || problem_kind(problem) == ProblemKind::body;
  if (!body.unit.empty() && !has_mesh)
    throw InputError(fmt::format(
        "--unit is of a mesh file, and {} has no mesh; leave it out, or name a file with --mesh", named));
  ProblemSettings settings{.material = material, .unit = body.metres()};
  settings.parameters = body.parameters(set, material);
  if (!settings.parameters.empty() && !has_mesh)
    throw InputError(fmt::format(
        "--gravity, --support, --tool-at and --tool-direction are of a mesh, and {} has none; leave them out",
        named));
  for (auto& parameter : parse_assignments("--set", set)) settings.parameters.push_back(std::move(parameter));
  for (auto& parameter : own.parameters(set)) settings.parameters.push_back(std::move(parameter));
  if (timeout && plugin.empty()) throw InputError("--timeout applies to --plugin only; remove it");
  if (timeout) settings.parameters.emplace_back(patience_parameter, *timeout);
  if (!y0.empty()) settings.y0 = parse_numbers("--y0", y0);
  return settings;
}

void ProblemChoice::refuse_varied(std::string_view name, std::string_view option) const {
  std::vector<std::pair<std::string, double>> given = own.parameters(set);
  for (const std::string& assignment : set) given.push_back(parse_assignment("--set", assignment));
  for (const auto& [each, value] : given)
    if (each == name)
      throw InputError(fmt::format("{} varies {}, and {} is given for it; leave one of them out", option,
                                   name, to_text(value)));
}

void ProblemChoice::remark_idle(Console& console, const Problem& made, bool takes_linear) const {
  body.remark_scene(console, takes_linear);
  for (const std::string& assignment : set) {
    const auto [name, value] = parse_assignment("--set", assignment);
    // A term that is switched off is what was asked for.
    if (value != 0 && std::ranges::find(made.idle, name) != made.idle.end())
      console.remark(fmt::format("{} of --set changes nothing of {} as the other parameters are: {}", name,
                                 made.id, describe_acting(made)));
  }
}

void MethodChoice::add_to(CLI::App& command) {
  add_text(command, "--method", method, "An id or alias of `hmax list methods`", "ID");
  add_text(command, "--tableau", tableau, "A file with an explicit tableau of your own", "FILE");
}

Method MethodChoice::make() const {
  if (!method.empty() && !tableau.empty())
    throw InputError("--method and --tableau are both given; choose one of them");
  if (!tableau.empty()) return make_method(read_tableau(tableau));
  if (method.empty())
    throw InputError("no method is given; name one with --method, `hmax list methods` shows all of them");
  return find_method(method);
}

void warn_of_left_out(Console& console, const std::vector<LeftOut>& left_out) {
  for (const std::string& line : in_words(left_out)) console.remark("left out: " + line);
}

std::string in_words(const Tolerances<double>& tolerances) {
  return fmt::format("rtol {}, atol {}", to_text(tolerances.rtol), to_text(tolerances.atol));
}

Json to_json(const Tolerances<double>& tolerances) { return {HMAX_KEYS(tolerances, rtol, atol)}; }

void add_control(CLI::App& command, std::string& control) {
  add_text(command, "--control", control,
           fmt::format("Step size control: {}; {} by default", fmt::join(controller_names, ", "),
                       to_string(RunSpec{}.control)),
           "NAME");
}

}  // namespace hmax
