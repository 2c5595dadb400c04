/// hmax mesh: what a mesh is, whether models can rely on it, and meshes from one form into another.
#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <numbers>
#include <set>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "bench/mesh_choice.hpp"
#include "cli/body_picture.hpp"
#include "cli/commands.hpp"
#include "problems/tissue/loads.hpp"
#include "problems/tissue/materials.hpp"
#include "problems/tissue/mesh_defects.hpp"
#include "problems/tissue/mesh_import.hpp"
#include "problems/tissue/mesh_quality.hpp"
#include "problems/tissue/mesh_writers.hpp"
#include "problems/tissue/sofa_scene.hpp"
#include "problems/tissue/topology.hpp"
#include "results/errors.hpp"
#include "results/numbers.hpp"
#include "results/table.hpp"

namespace hmax {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr double degrees = 180 / std::numbers::pi;
constexpr std::array<std::string_view, 3> written{".msh", ".vtu", ".scn"};

struct MeshOptions {
  std::string mesh, output, unit, times = "1", slivers = "5";
  bool fix = false, renumber = false;
  // Of SOFA's scenes.
  std::string model, material, gravity, support;
  std::optional<double> h;
  PictureChoice picture;

  [[nodiscard]] std::optional<double> metres() const {
    return unit.empty() ? std::nullopt : std::optional(unit_in_metres(unit));
  }
};

/// The unit of a mesh that was opened: stated, or that of meshes by name.
std::optional<double> unit_of(const OpenedMesh& opened, const MeshOptions& options) {
  if (opened.from_file) return options.metres();
  if (!options.unit.empty())
    throw InputError(fmt::format("the mesh {} is in metres; leave --unit out", options.mesh));
  return 1.0;
}

/// What the numbers below stand for.
std::string unit_in_words(const OpenedMesh& opened, const std::optional<double>& unit) {
  if (!opened.from_file) return "metres";
  if (!unit) return "not stated in the file; taken as metres here, state another with --unit";
  return fmt::format("{} m, as stated", short_number(*unit));
}

Json vector_json(const Eigen::Vector3d& v) { return {v(0), v(1), v(2)}; }

/// Tetrahedra and volume of each region.
std::map<TetMesh::Index, std::pair<Eigen::Index, double>> regions_of(const TetMesh& mesh) {
  std::map<TetMesh::Index, std::pair<Eigen::Index, double>> regions;
  for (Eigen::Index t = 0; t < mesh.tetrahedron_count(); ++t) {
    auto& [count, volume] = regions[mesh.region(t)];
    ++count;
    volume += signed_volume(corners_of(mesh, t));
  }
  return regions;
}

Json name_json(const MeshFile& file, TetMesh::Index region) {
  const auto named = file.names.find(region);
  return named == file.names.end() ? Json() : Json(named->second);
}

/// Elements and points of a group.
std::pair<std::size_t, std::size_t> size_of(const MeshGroup& group) {
  const std::set<TetMesh::Index> points(group.corners.begin(), group.corners.end());
  return {group.corners.size() / (static_cast<std::size_t>(group.dimension) + 1), points.size()};
}

Json groups_json(const MeshFile& file) {
  Json list = Json::array();
  for (const MeshGroup& group : file.groups) {
    const auto [elements, points] = size_of(group);
    list.push_back({{"kind", group_kinds[static_cast<std::size_t>(group.dimension)]},
                    {"number", group.number},
                    {"name", group.name.empty() ? Json() : Json(group.name)},
                    {"elements", elements},
                    {"points", points}});
  }
  return list;
}

/// What --set E:NAME and --support call by name or number.
std::string regions_in_words(const MeshFile& file,
                             const std::map<TetMesh::Index, std::pair<Eigen::Index, double>>& regions,
                             const Console& console) {
  std::string text;
  if (regions.size() > 1 || !file.names.empty()) {
    TextTable table({"region", "name", "tetrahedra", "volume [m³]"});
    for (const auto& [region, content] : regions) {
      const auto named = file.names.find(region);
      table.add({std::to_string(region), named == file.names.end() ? "-" : named->second,
                 std::to_string(content.first), short_number(content.second)});
    }
    text += "\n" + table.text(console);
  }
  if (file.groups.empty()) return text;
  TextTable table({"group", "name", "elements", "points"});
  for (const MeshGroup& group : file.groups) {
    const auto [elements, points] = size_of(group);
    table.add({fmt::format("{}:{}", group_kinds[static_cast<std::size_t>(group.dimension)], group.number),
               group.name.empty() ? "-" : group.name, std::to_string(elements), std::to_string(points)});
  }
  return text + "\n" + table.text(console);
}

std::string second_order_in_words(const MeshFile& file) {
  return fmt::format("{} tetrahedra of second order are read by their corners; their other nodes are idle",
                     file.second_order);
}

void info(const MeshOptions& options, Console& console) {
  options.picture.check();
  OpenedMesh opened = open_mesh(options.mesh);
  const std::optional<double> unit = unit_of(opened, options);
  TetMesh& mesh = opened.file.mesh;
  mesh.points *= unit.value_or(1);
  const MeshTopology topology = topology_of(mesh);
  const MeshQuality quality = quality_of(mesh);
  const MeshDefects defects = defects_of(mesh);
  const auto regions = regions_of(mesh);
  if (options.picture.wanted())
    options.picture.write(
        {.title = title_of(options.mesh),
         .caption =
             fmt::format("{} points, {} tetrahedra, {} triangles on the surface, {} cm³; mean ratio {} at "
                         "worst, {} on average: 1 for the regular tetrahedron, 0 for a flat one.{}",
                         topology.points, topology.tetrahedra, topology.surface_triangles,
                         short_number(1e6 * quality.volume, 4), short_number(quality.min_mean_ratio, 3),
                         short_number(quality.average_mean_ratio, 3),
                         unit ? "" : " The unit of the file is not stated, and taken as metres."),
         .colours = mesh_quality_colours(),
         .views = {mesh_view(mesh)}});

  if (console.json) {
    Json list = Json::array();
    for (const auto& [region, content] : regions)
      list.push_back({{"region", region},
                      {"name", name_json(opened.file, region)},
                      {"tetrahedra", content.first},
                      {"volume", content.second}});
    return console.print_json(
        Json{{"mesh", options.mesh},
             {"format", opened.file.format},
             {"unit", unit ? Json(*unit) : Json()},
             {"status", unit ? Json() : Json("the unit is not stated; lengths are in that of the file")},
             {"points", topology.points},
             {"edges", topology.edges},
             {"faces", topology.faces},
             {"tetrahedra", topology.tetrahedra},
             {"surface_points", topology.surface_points},
             {"surface_edges", topology.surface_edges},
             {"surface_triangles", topology.surface_triangles},
             {"volume", quality.volume},
             {"components", topology.components},
             {"unused_points", topology.unused_points},
             {"inverted", defects.inverted.size()},
             {"degenerate", defects.degenerate.size()},
             {"duplicates", defects.duplicates.size()},
             {"crowded_faces", topology.crowded_faces},
             {"euler", topology.euler()},
             {"quality",
              {{"min", quality.min_mean_ratio},
               {"mean", quality.average_mean_ratio},
               {"measure", "mean_ratio"},
               {"worst", opened.file.numbers[static_cast<std::size_t>(quality.worst)]}}},
             {"smallest_angle_degrees", quality.smallest_angle * degrees},
             {"largest_angle_degrees", quality.largest_angle * degrees},
             {"shortest_edge", quality.shortest_edge},
             {"longest_edge", quality.longest_edge},
             {"box", {vector_json(quality.lower), vector_json(quality.upper)}},
             {"picture", options.picture.wanted() ? Json(options.picture.file) : Json()},
             {"second_order", opened.file.second_order},
             {"regions", list},
             {"groups", groups_json(opened.file)}});
  }
  std::string text =
      fmt::format("{}, {}\nunit: {}\n\n", options.mesh, opened.file.format, unit_in_words(opened, unit));
  TextTable counts({"", "in all", "on the surface"});
  counts.add({"points", std::to_string(topology.points), std::to_string(topology.surface_points)});
  counts.add({"edges", std::to_string(topology.edges), std::to_string(topology.surface_edges)});
  counts.add({"triangles", std::to_string(topology.faces), std::to_string(topology.surface_triangles)});
  counts.add({"tetrahedra", std::to_string(topology.tetrahedra), ""});
  text += counts.text(console) + "\n";
  const auto line = [&](const char* name, const std::string& value) {
    text += fmt::format("{:<16} {}\n", name, value);
  };
  line("box", box_in_words(mesh) + " m");
  line("volume", fmt::format("{} m³", short_number(quality.volume)));
  line("edges", fmt::format("{} to {} m", short_number(quality.shortest_edge, 4),
                            short_number(quality.longest_edge, 4)));
  line("mean ratio",
       fmt::format("{} at worst (tetrahedron {}), {} on average", short_number(quality.min_mean_ratio, 4),
                   opened.file.numbers[static_cast<std::size_t>(quality.worst)],
                   short_number(quality.average_mean_ratio, 4)));
  line("dihedral angles", fmt::format("{} to {} degrees", short_number(quality.smallest_angle * degrees, 4),
                                      short_number(quality.largest_angle * degrees, 4)));
  line("parts", fmt::format("{}, unused points {}", topology.components, topology.unused_points));
  if (opened.file.second_order > 0) text += second_order_in_words(opened.file) + "\n";
  text += regions_in_words(opened.file, regions, console);
  if (!defects.none())
    text += console.alarming("\nModels cannot use it: `hmax mesh check` names what is wrong.") + "\n";
  console.print(text);
}

/// At most some of the things that are wrong, one a line.
template <class Items, class Sentence>
void add_findings(std::string& text, const Items& items, Sentence sentence) {
  constexpr std::size_t most = 10;
  for (std::size_t i = 0; i < std::min(items.size(), most); ++i) text += sentence(items[i]) + "\n";
  if (items.size() > most) text += fmt::format("  and {} more\n", items.size() - most);
}

void check(const MeshOptions& options, Console& console) {
  const OpenedMesh opened = open_mesh(options.mesh);
  const MeshFile& file = opened.file;
  const double angle = parse_number("--slivers", options.slivers);
  if (!(angle >= 0 && angle < 70))
    throw InputError(fmt::format(
        "--slivers is {}; give a dihedral angle from 0 up to 70 degrees, since no tetrahedron has all above 70.53",
        options.slivers));
  const MeshDefects defects = defects_of(file.mesh);
  std::vector<Sliver> slivers = slivers_of(file.mesh, angle / degrees);
  // What has no volume is named for that already.
  std::erase_if(slivers, [&](const Sliver& s) {
    return std::ranges::binary_search(defects.degenerate, static_cast<TetMesh::Index>(s.tetrahedron));
  });
  const MeshTopology topology = topology_of(file.mesh);
  const bool good = defects.none() && slivers.empty();
  if (!good) console.exit_code = Exit::failed;
  const auto number = [&](Eigen::Index t) { return file.numbers[static_cast<std::size_t>(t)]; };

  if (console.json) {
    const auto numbers = [&](const std::vector<TetMesh::Index>& list) {
      Json all = Json::array();
      for (const TetMesh::Index t : list) all.push_back(number(t));
      return all;
    };
    Json pairs = Json::array(), flat = Json::array();
    for (const auto& [again, first] : defects.duplicates) pairs.push_back({number(again), number(first)});
    for (const Sliver& sliver : slivers)
      flat.push_back({{"tetrahedron", number(sliver.tetrahedron)},
                      {"angle_degrees", sliver.smallest_angle * degrees},
                      {"mean_ratio", sliver.mean_ratio}});
    return console.print_json(Json{{"mesh", options.mesh},
                                   {"good", good},
                                   {"inverted", numbers(defects.inverted)},
                                   {"degenerate", numbers(defects.degenerate)},
                                   {"duplicates", pairs},
                                   {"crowded", numbers(defects.crowded)},
                                   {"slivers", flat},
                                   {"components", topology.components},
                                   {"unused_points", topology.unused_points}});
  }
  std::string text;
  const auto where = [&](Eigen::Index t) {
    return opened.from_file && file.places[static_cast<std::size_t>(t)] > 0
               ? file.where(t)
               : fmt::format("tetrahedron {}", number(t));
  };
  add_findings(text, defects.inverted, [&](auto t) { return where(t) + " is inverted"; });
  add_findings(text, defects.degenerate, [&](auto t) { return where(t) + " has no volume"; });
  add_findings(text, defects.duplicates, [&](const auto& pair) {
    return fmt::format("{} has the corners of tetrahedron {}", where(pair.first), number(pair.second));
  });
  add_findings(text, defects.crowded, [&](auto t) { return where(t) + " shares a face with two others"; });
  add_findings(text, slivers, [&](const Sliver& sliver) {
    return fmt::format("{} is a sliver: dihedral angle {} degrees, mean ratio {}", where(sliver.tetrahedron),
                       short_number(sliver.smallest_angle * degrees, 3), short_number(sliver.mean_ratio, 3));
  });
  if (topology.unused_points > 0)
    text += fmt::format("{} points are in no tetrahedron; models leave them out\n", topology.unused_points);
  if (topology.components > 1) text += fmt::format("the mesh has {} separate parts\n", topology.components);
  if (!defects.inverted.empty()) text += "`hmax mesh convert FILE OUTPUT --fix` turns what is inverted\n";
  text += good ? fmt::format("{}: {} tetrahedra, none is wrong or flatter than {} degrees\n", options.mesh,
                             topology.tetrahedra, short_number(angle))
               : console.alarming(fmt::format("{} is not good", options.mesh)) + "\n";
  console.print(text);
}

/// The points that SOFA holds still, "XMIN,XMAX,YMIN,YMAX,ZMIN,ZMAX".
std::vector<TetMesh::Index> supported_points(const MeshOptions& options, const TetMesh& mesh) {
  const std::vector<double> box = parse_numbers("--support", options.support);
  if (box.size() != 6)
    throw InputError(fmt::format(
        "--support has {} numbers but a box has six: xmin,xmax,ymin,ymax,zmin,zmax in metres", box.size()));
  const auto points = points_in_box(mesh, {box[0], box[2], box[4]}, {box[1], box[3], box[5]});
  if (points.empty()) throw InputError("no point lies in the box of --support; give a larger one, in metres");
  return points;
}

std::string scene_of(const MeshOptions& options, const TetMesh& mesh) {
  TissueSettings settings;
  settings.model = tissue_model(options.model.empty() ? "fem_corotational" : options.model);
  if (!options.material.empty()) settings = with_tissue_material(settings, options.material);
  if (!options.gravity.empty()) {
    const std::vector<double> g = parse_numbers("--gravity", options.gravity);
    if (g.size() != 3)
      throw InputError(fmt::format("--gravity has {} numbers but needs three, like 0,0,-9.81", g.size()));
    settings.gravity = {g[0], g[1], g[2]};
  }
  if (!options.support.empty()) settings.supports.push_back({.points = supported_points(options, mesh)});
  return sofa_text(mesh, settings, options.h.value_or(0.01));
}

/// Writes the mesh in the form that the extension of the output names, and says so.
/// @param metres  true when the coordinates are metres
void deliver(const MeshOptions& options, const MeshFile& file, bool metres, Json extra, Console& console) {
  const TetMesh& mesh = file.mesh;
  const fs::path output = options.output;
  const std::string extension = output.extension().string();
  if (std::ranges::find(written, extension) == written.end())
    throw InputError(fmt::format(
        "meshes are written as .msh, .vtu or .scn and not as '{}'; change the extension", options.output));
  const bool scene = extension == ".scn";
  const bool physics = options.h || !options.model.empty() || !options.material.empty() ||
                       !options.gravity.empty() || !options.support.empty();
  if (physics && !scene)
    throw InputError(
        "--model, --material, --h, --gravity and --support belong to a SOFA scene; write to a file .scn");
  if (scene && !metres)
    throw InputError(
        fmt::format("{} does not say its unit, and a body of {} could be anything; state it with --unit",
                    options.mesh, box_in_words(mesh)));
  std::string text;
  if (scene) {
    text = scene_of(options, mesh);
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
  if (file.second_order > 0) console.remark(second_order_in_words(file));
  if (console.json) {
    Json document{{"mesh", options.mesh},
                  {"output", options.output},
                  {"points", mesh.point_count()},
                  {"tetrahedra", mesh.tetrahedron_count()}};
    document.update(extra);
    return console.print_json(document);
  }
  std::string done;
  if (extra.contains("fixed") && extra["fixed"] != 0)
    done = fmt::format(", {} turned", extra["fixed"].get<Eigen::Index>());
  console.print(fmt::format("{}: {} points, {} tetrahedra{}\n", options.output, mesh.point_count(),
                            mesh.tetrahedron_count(), done));
}

void convert(const MeshOptions& options, Console& console) {
  OpenedMesh opened = open_mesh(options.mesh);
  const std::optional<double> unit = unit_of(opened, options);
  const Eigen::Index fixed = options.fix ? fix_orientation(opened.file.mesh) : 0;
  require_valid(opened.file);
  if (options.renumber) opened.file = renumbered(opened.file);
  opened.file.mesh.points *= unit.value_or(1);
  deliver(options, opened.file, unit.has_value(), Json{{"fixed", fixed}}, console);
}

void refine(const MeshOptions& options, Console& console) {
  OpenedMesh opened = open_mesh(options.mesh);
  const std::optional<double> unit = unit_of(opened, options);
  require_valid(opened.file);
  const auto times = static_cast<int>(std::min<std::int64_t>(parse_count("--times", options.times, 0), 1000));
  opened.file = refined(opened.file, times);
  opened.file.mesh.points *= unit.value_or(1);
  deliver(options, opened.file, unit.has_value(), Json{{"times", times}}, console);
}

void make(const MeshOptions& options, Console& console) {
  const OpenedMesh opened = open_mesh(options.mesh);
  if (opened.from_file)
    throw InputError(
        fmt::format("'{}' is a file and not the name of a mesh to make; `hmax mesh convert` changes "
                    "files",
                    options.mesh));
  deliver(options, opened.file, true, Json::object(), console);
}

/// Runs a subcommand; what lower floors refuse is bad input.
template <class Run>
auto with_sentences(Run run, std::shared_ptr<MeshOptions> options, Console& console) {
  return [run, options, &console] {
    try {
      run(*options, console);
    } catch (const std::invalid_argument& error) {
      throw InputError(error.what());
    }
  };
}

void add_mesh_argument(CLI::App& command, MeshOptions& options) {
  command
      .add_option(
          "mesh,--mesh", options.mesh,
          "A file (.msh .vtk .vtu .node .ele .mesh), or liver, phantom, beam, cube, ball; parameters like "
          "ball:n=6, all take :refine=K")
      ->required();
}

void add_unit(CLI::App& command, MeshOptions& options) {
  command
      .add_option("--unit", options.unit,
                  "Unit of the coordinates of a file: m, cm, mm or a number of metres")
      ->type_name("UNIT");
}

void add_output(CLI::App& command, MeshOptions& options) {
  command.add_option("--output", options.output, "File to write: .msh, .vtu or .scn")
      ->type_name("FILE")
      ->required();
}

}  // namespace

void add_mesh(CLI::App& app, Console& console) {
  CLI::App& group = *app.add_subcommand("mesh", "Look at tetrahedral meshes, check, make and convert them");
  group.require_subcommand(1);

  auto options = std::make_shared<MeshOptions>();
  CLI::App& info_command =
      add_command(group, console, "info", "Show the counts of a mesh, its surface, size and quality",
                  {"hmax mesh info liver", "hmax mesh info ball:n=6:refine=1 --json",
                   "hmax mesh info liver --picture results/runs/liver.svg"});
  add_mesh_argument(info_command, *options);
  add_unit(info_command, *options);
  options->picture.add_to(info_command, "Draw the surface, coloured by the worst tetrahedron nearby", false);
  info_command.callback(with_sentences(info, options, console));

  CLI::App& check_command =
      add_command(group, console, "check",
                  "Name what keeps models from using a mesh, and slivers; exit 1 if there is any",
                  {"hmax mesh check liver", "hmax mesh check phantom --slivers 20"});
  add_mesh_argument(check_command, *options);
  check_command
      .add_option("--slivers", options->slivers,
                  "Dihedral angle below which a tetrahedron is one; 5 by default")
      ->type_name("DEGREES");
  check_command.callback(with_sentences(check, options, console));

  CLI::App& make_command = add_command(
      group, console, "make", "Write a mesh that has a name",
      {"hmax mesh make ball:n=6,radius=0.04 --output ball.msh", "hmax mesh make beam:n=2 --output beam.vtu"});
  add_mesh_argument(make_command, *options);
  add_output(make_command, *options);
  make_command.callback(with_sentences(make, options, console));

  CLI::App& refine_command =
      add_command(group, console, "refine", "Cut each tetrahedron into eight, again and again",
                  {"hmax mesh refine liver --times 2 --output fine.vtu"});
  add_mesh_argument(refine_command, *options);
  refine_command.add_option("--times", options->times, "How often; 1 by default")->type_name("NUMBER");
  add_unit(refine_command, *options);
  add_output(refine_command, *options);
  refine_command.callback(with_sentences(refine, options, console));

  CLI::App& convert_command = add_command(
      group, console, "convert", "Write a mesh in another form: Gmsh, ParaView, or a scene of SOFA",
      {"hmax mesh convert phantom phantom.vtu",
       "hmax mesh convert liver liver.scn --material liver:male_normal --gravity 0,0,-9.81 --h 0.01",
       "hmax mesh convert phantom.vtu again.msh --unit m --fix --renumber"});
  add_mesh_argument(convert_command, *options);
  convert_command.add_option("output", options->output, "File to write: .msh, .vtu or .scn")->required();
  add_unit(convert_command, *options);
  convert_command.add_flag("--fix", options->fix, "Turn inverted tetrahedra");
  convert_command.add_flag("--renumber", options->renumber, "Number neighbours near each other");
  convert_command.add_option("--model", options->model, "Model of a scene; fem_corotational by default")
      ->type_name("ID");
  convert_command.add_option("--material", options->material, "Tissue of a scene, like liver:male_normal")
      ->type_name("ID");
  convert_command.add_option("--gravity", options->gravity, "Gravity of a scene [m/s2]")->type_name("X,Y,Z");
  convert_command.add_option("--support", options->support, "Box whose points a scene holds still [m]")
      ->type_name("XMIN,XMAX,YMIN,YMAX,ZMIN,ZMAX");
  add_number(convert_command, "--h", options->h, "Step of a scene [s]; 0.01 by default");
  convert_command.callback(with_sentences(convert, options, console));
}

}  // namespace hmax
