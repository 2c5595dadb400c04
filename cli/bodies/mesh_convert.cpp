/// hmax mesh make, refine and convert: meshes from one form into another.
#include <algorithm>
#include <filesystem>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "catalogue/models/problems.hpp"
#include "catalogue/models/tissue_choice.hpp"
#include "catalogue/models/tissue_problem.hpp"
#include "catalogue/scenes/scene.hpp"
#include "cli/bodies/matrix_files.hpp"
#include "cli/bodies/mesh.hpp"
#include "cli/shared/choices.hpp"
#include "cli/shared/options.hpp"
#include "cli/shared/outputs.hpp"
#include "limits/linearised_problem.hpp"
#include "problems/mesh/files/mesh_defects.hpp"
#include "problems/mesh/files/mesh_import.hpp"
#include "problems/mesh/files/mesh_writers.hpp"
#include "problems/mesh/mesh_quality.hpp"
#include "problems/mesh/topology.hpp"
#include "problems/tissue/body.hpp"
#include "problems/tissue/sofa_scene.hpp"
#include "results/json.hpp"
#include "results/table.hpp"

namespace hmax {

namespace {

namespace fs = std::filesystem;

constexpr std::array<std::string_view, 3> written{".msh", ".vtu", ".scn"};

/// What a scene lacks that most simulations need, and what adds it; empty where it lacks nothing.
std::string lacking(const TissueSettings& settings) {
  const bool held = !settings.supports.empty() || !settings.elastic_supports.empty(),
             heavy = !settings.gravity.isZero(0) || !settings.forces.empty();
  if (held && heavy) return {};
  if (held) return "the scene has no gravity; `hmax mesh convert` adds it with --gravity 0,0,-9.81";
  if (heavy) return "the scene has no supports; `hmax mesh convert` adds them with --support SET";
  return "the scene has no supports and no gravity; `hmax mesh convert` adds them with --support SET and --gravity "
         "0,0,-9.81";
}

/// A scene of a body, and what it lacks.
struct WrittenScene {
  std::string text, lacking;
};

/// Without gravity and supports unless they are asked for, gravity by a load too.
ProblemSettings settings_of(const MeshCommand& options) {
  MeshOptions acting;
  acting.gravity = options.gravity;
  acting.supports = options.supports;
  ProblemSettings settings{
      .material = options.material, .parameters = {{"support", 0}}, .unit = options.metres()};
  if (options.load.empty()) settings.parameters.emplace_back("g", 0);
  for (const auto& parameter : acting.parameters()) settings.parameters.push_back(parameter);
  for (auto& parameter : parse_assignments("--set", options.set))
    settings.parameters.push_back(std::move(parameter));
  return settings;
}

/// A scene of the body that `hmax run --mesh` would make, without gravity and supports unless they are asked
/// for.
WrittenScene scene_of(const MeshCommand& options, MeshFile file) {
  const TissueId id(
      tissue_id(options.model.empty() ? "fem_corotational" : options.model, options.mesh, options.load));
  if (element_nodes(id) == ElementNodes::ten) file = with_ten_nodes(file);
  MeshImport import = import_as_it_is(file);
  const std::vector<TetMesh::Index> idle = unused_points(file.mesh);
  if (!idle.empty()) import = import_mesh(file, 1);
  LoadedMesh loaded{.name = options.mesh,
                    .mesh = std::move(import.mesh),
                    .origin = std::make_shared<const MeshOrigin>(std::move(import.origin))};
  const TissueParameters parameters = tissue_parameters(id, settings_of(options));
  const TissueBody body(loaded.mesh, tissue_settings(id, parameters, loaded), loaded.origin);
  const SofaStep step = sofa_step(options.method.empty() ? sofa_methods().front() : options.method,
                                  options.h.value_or(SofaStep{}.h));
  return {sofa_text(body, step), lacking(body.settings())};
}

/// Writes the mesh in the form that the extension of the output names, and says so.
/// @param metres  true when the coordinates are metres
void deliver(const MeshCommand& options, const MeshFile& file, bool metres, Json extra, Console& console) {
  const TetMesh& mesh = file.mesh;
  const fs::path output = options.output;
  const std::string extension = output.extension().string();
  if (std::ranges::find(written, extension) == written.end())
    throw InputError(fmt::format(
        "meshes are written as .msh, .vtu or .scn and not as '{}'; change the extension", options.output));
  const bool scene = extension == ".scn";
  if (options.jobs && is_given(options.jobs)) throw InputError("--jobs is for --matrices; leave it out");
  const bool physics = options.h || !options.model.empty() || !options.material.empty() ||
                       !options.gravity.empty() || !options.supports.empty() || !options.set.empty() ||
                       !options.load.empty() || !options.method.empty();
  if (physics && !scene)
    throw InputError(
        "--model, --material, --load, --method, --set, --h, --gravity and --support belong to a SOFA scene; write to a "
        "file .scn");
  if (scene && !metres)
    throw InputError(
        fmt::format("{} does not say its unit, and a body of {} could be anything; state it with --unit",
                    options.mesh, box_in_words(mesh)));
  std::string text, remark;
  if (scene) {
    WrittenScene made = scene_of(options, file);
    text = std::move(made.text);
    remark = std::move(made.lacking);
  } else if (extension == ".msh") {
    text = msh_text(file);
  } else {
    MeshFields fields;
    fields.tetrahedra.push_back({"mean_ratio", Eigen::MatrixXd(1, mesh.tetrahedron_count())});
    for (Eigen::Index t = 0; t < mesh.tetrahedron_count(); ++t)
      fields.tetrahedra[0].values(0, t) = mean_ratio(corners_of(mesh, t));
    text = vtu_text(file, fields);
  }
  write_file(output, text);
  if (!remark.empty()) console.remark(remark);
  if (file.second_order > 0) console.remark(second_order_in_words(file));
  for (const std::string& sentence : file.remarks) console.remark(sentence);
  if (!file.material.empty()) console.remark(file.material_left_out());
  if (console.json) {
    Json document{HMAX_KEYS(options, mesh, output),
                  {"points", mesh.point_count()},
                  {"tetrahedra", mesh.tetrahedron_count()}};
    document.update(extra);
    return console.print_json(document);
  }
  std::string done;
  if (extra.contains("merged") && extra["merged"] != 0)
    done += fmt::format(", merged {} coincident points", extra["merged"].get<Eigen::Index>());
  if (extra.contains("fixed") && extra["fixed"] != 0)
    done += fmt::format(", {} turned", extra["fixed"].get<Eigen::Index>());
  console.print(fmt::format("{}: {} points, {} tetrahedra{}\n", options.output, mesh.point_count(),
                            mesh.tetrahedron_count(), done));
}

/// The matrices of the body that `hmax run --mesh` would make, at its static equilibrium, without gravity and
/// supports unless they are asked for.
void deliver_matrices(const MeshCommand& options, Console& console) {
  if (!options.output.empty())
    throw InputError(fmt::format("--matrices {} and the output {} are both given; remove one of them",
                                 options.matrices, options.output));
  if (options.fix || options.renumber || options.h || !options.load.empty() || !options.method.empty())
    throw InputError(
        "--fix, --renumber, --h, --load and --method do not apply to matrices; convert the mesh to a file first, and "
        "leave the others out");
  const Problem problem = make_problem(tissue_id(options.model, options.mesh, ""), settings_of(options));
  write_matrices(problem, operating_point(problem), options.matrices, console);
}

void convert(const MeshCommand& given, Console& console) {
  MeshCommand options = given;
  if (!options.merge.empty()) options.mesh += ":merge=" + options.merge;
  if (!options.matrices.empty()) return deliver_matrices(options, console);
  if (options.output.empty())
    throw InputError("no output is given; name a file .msh, .vtu or .scn, or --matrices FOLDER");
  OpenedMesh opened = open_mesh(options.mesh);
  const std::optional<double> unit = unit_of(opened, options);
  if (options.fix) require_no_overlap(opened.file);
  const Eigen::Index fixed = options.fix ? fix_orientation(opened.file.mesh) : 0;
  require_valid(opened.file);
  const std::size_t merged = opened.file.merged.size();
  if (options.renumber) opened.file = renumbered(opened.file);
  opened.file.mesh.points *= unit.value_or(1);
  deliver(options, opened.file, unit.has_value(), Json{{"fixed", fixed}, {"merged", merged}}, console);
}

void refine(const MeshCommand& options, Console& console) {
  OpenedMesh opened = open_mesh(options.mesh);
  const std::optional<double> unit = unit_of(opened, options);
  require_valid(opened.file);
  const auto times = static_cast<int>(std::min<std::int64_t>(parse_count("--times", options.times, 0), 1000));
  opened.file = refined(opened.file, times);
  opened.file.mesh.points *= unit.value_or(1);
  deliver(options, opened.file, unit.has_value(),
          Json{{"times", times}, {"merged", opened.file.merged.size()}}, console);
}

void make(const MeshCommand& options, Console& console) {
  const OpenedMesh opened = open_mesh(options.mesh);
  if (opened.from_file)
    throw InputError(
        fmt::format("'{}' is a file and not the name of a mesh to make; `hmax mesh convert` changes "
                    "files",
                    options.mesh));
  deliver(options, opened.file, true, Json::object(), console);
}

void add_output(CLI::App& command, MeshCommand& options) {
  require(add_text(command, "--output", options.output, "File to write: .msh, .vtu or .scn", "FILE"));
  add_force(command);
}

}  // namespace

void add_mesh_writers(CLI::App& group, Console& console) {
  const auto [make_command, make_options] = add_command(
      group, console, "make", "Write a named mesh to a file",
      {"hmax mesh make ball:n=6,radius=0.04 --output ball.msh", "hmax mesh make beam:n=2 --output beam.vtu"},
      with_sentences<make>);
  add_mesh_argument(make_command, make_options);
  add_output(make_command, make_options);

  const auto [refine_command, refine_options] =
      add_command(group, console, "refine", "Refine a mesh: cut each tetrahedron into eight",
                  {"hmax mesh refine liver --times 2 --output fine.vtu"}, with_sentences<refine>);
  add_mesh_argument(refine_command, refine_options);
  add_text(refine_command, "--times", refine_options.times, "Number of refinements; 1 by default", "NUMBER");
  add_unit(refine_command, refine_options);
  add_output(refine_command, refine_options);

  const auto [command, options] = add_command(
      group, console, "convert", "Convert a mesh to Gmsh, ParaView, a scene of SOFA, or matrices",
      {"hmax mesh convert phantom phantom.vtu",
       "hmax mesh convert liver liver.scn --material liver:male_normal --gravity 0,0,-9.81 --h 0.01",
       "hmax mesh convert liver pressed.scn --load press --support 'z<0.02' --method symplectic_euler --h 0.002",
       "hmax mesh convert phantom.vtu again.msh --unit m --fix --renumber",
       "hmax mesh convert liver --matrices liver --material liver:male_normal"},
      with_sentences<convert>);
  add_mesh_argument(command, options);
  add_text(command, "output", options.output, "File to write: .msh, .vtu or .scn");
  add_text(command, "--matrices", options.matrices,
           "Folder of the stiffness, mass and damping of the body, instead of a file; it is made if needed",
           "FOLDER");
  add_unit(command, options);
  add_flag(command, "--fix", options.fix, "Reorient inverted tetrahedra");
  add_text(command, "--merge", options.merge,
           "Merge points within this share of the shortest edge, or off; 0 by default", "TOL");
  add_flag(command, "--renumber", options.renumber,
           "Renumber points and tetrahedra, so that neighbours have similar numbers");
  add_text(command, "--model", options.model,
           "Model of a scene or of matrices; fem_corotational of scenes, fem_green of matrices by default",
           "ID");
  add_text(command, "--material", options.material,
           "Tissue of a scene or of matrices, like liver:male_normal", "ID");
  add_text(command, "--gravity", options.gravity, "Gravity of a scene or of matrices [m/s2]", "X,Y,Z");
  add_repeated(command, "--set", options.set,
               "Change a parameter of a scene or of matrices, like E:tumour=8000; may be repeated",
               "NAME=VALUE");
  add_support(command, options.supports, "none by default");
  add_text(command, "--load", options.load,
           fmt::format("Load of a scene: {}; none by default", fmt::join(tissue_loads(), ", ")), "ID");
  add_text(command, "--method", options.method,
           fmt::format("Method whose solver steps a scene: {}; {} by default",
                       fmt::join(sofa_methods(), ", "), sofa_methods().front()),
           "ID");
  add_number(command, "--h", options.h, "Step size of a scene [s]; 0.01 by default");
  options.jobs = add_jobs(command);
  add_force(command);
}

}  // namespace hmax
