/// hmax mesh: what a mesh is, and whether models can rely on it.
#include "cli/bodies/mesh.hpp"

#include <algorithm>
#include <map>
#include <memory>
#include <numbers>
#include <set>

#include <fmt/format.h>

#include "catalogue/models/mesh_choice.hpp"
#include "catalogue/models/support_sets.hpp"
#include "cli/bodies/body_picture.hpp"
#include "cli/shared/choices.hpp"
#include "cli/shared/commands.hpp"
#include "cli/shared/options.hpp"
#include "cli/shared/outputs.hpp"
#include "core/errors.hpp"
#include "core/numbers.hpp"
#include "problems/mesh/coincident_points.hpp"
#include "problems/mesh/files/mesh_defects.hpp"
#include "problems/mesh/mesh_parts.hpp"
#include "problems/mesh/mesh_quality.hpp"
#include "problems/mesh/topology.hpp"
#include "results/json.hpp"

namespace hmax {

namespace {

constexpr double degrees = 180 / std::numbers::pi;

/// What the numbers below stand for.
std::string unit_in_words(const OpenedMesh& opened, const std::optional<double>& unit) {
  if (!opened.from_file) return "metres";
  if (!unit) return "not stated in the file; taken as metres here, state another with --unit";
  return fmt::format("{} m, as stated", short_number(*unit));
}

Json vector_json(const Eigen::Vector3d& v) { return {v(0), v(1), v(2)}; }

/// Tetrahedra and volume of each region.
using Regions = std::map<TetMesh::Index, std::pair<Eigen::Index, double>>;

Regions regions_of(const TetMesh& mesh) {
  Regions regions;
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

Json mending_json(const std::optional<Mending>& mending) {
  if (!mending) return {};
  return {{"moved_points", mending->moved.size()},
          HMAX_KEYS(*mending, farthest, least_height_before, least_height_after, least_mean_height_before,
                    least_mean_height_after)};
}

std::string in_words(const Mending& mending) {
  return fmt::format(
      "{} points moved by at most {} m; least height {} m, was {}; least mean height {} m, was {}",
      mending.moved.size(), short_number(mending.farthest, 4), short_number(mending.least_height_after, 4),
      short_number(mending.least_height_before, 4), short_number(mending.least_mean_height_after, 4),
      short_number(mending.least_mean_height_before, 4));
}

Json groups_json(const MeshFile& file) {
  Json list = Json::array();
  for (const MeshGroup& group : file.groups) {
    const auto [elements, points] = size_of(group);
    list.push_back({{"kind", group_kinds[static_cast<std::size_t>(group.dimension)]},
                    {"number", group.number},
                    {"name", json_or_null(group.name)},
                    {"elements", elements},
                    {"points", points}});
  }
  return list;
}

/// What --set E:NAME and --support call by name or number.
std::string regions_in_words(const MeshFile& file, const Regions& regions, const Console& console) {
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

/// What is known of a mesh.
struct MeshReport {
  OpenedMesh opened;
  std::optional<double> unit;  ///< [m]
  MeshTopology topology;
  MeshQuality quality;
  MeshDefects defects;
  Eigen::Index coincident = 0;  ///< points
  Regions regions;

  /// Number in its file of the tetrahedron of the worst shape.
  [[nodiscard]] auto worst() const { return opened.file.numbers[static_cast<std::size_t>(quality.worst)]; }
};

MeshReport report_of(const MeshCommand& options) {
  MeshReport report;
  report.opened = open_mesh(options.mesh, CoincidentPoints::kept);
  report.unit = unit_of(report.opened, options);
  TetMesh& mesh = report.opened.file.mesh;
  mesh.points *= report.unit.value_or(1);
  if (auto& mending = report.opened.mending)
    for (double* length : {&mending->farthest, &mending->least_height_before, &mending->least_height_after,
                           &mending->least_mean_height_before, &mending->least_mean_height_after})
      *length *= report.unit.value_or(1);
  report.topology = topology_of(mesh);
  report.quality = quality_of(mesh);
  report.defects = defects_of(mesh);
  report.coincident = static_cast<Eigen::Index>(coincidences(mesh, near_coincidence).size());
  report.regions = regions_of(mesh);
  return report;
}

void write_picture(const MeshReport& report, const MeshCommand& options) {
  const MeshTopology& topology = report.topology;
  options.picture.write(
      {.title = title_of(options.mesh),
       .caption = fmt::format(
           "{} points, {} tetrahedra, {} triangles on the surface, {} cm³; mean ratio {} at "
           "worst, {} on average: 1 for the regular tetrahedron, 0 for a flat one.{}",
           topology.points, topology.tetrahedra, topology.surface_triangles,
           short_number(1e6 * report.quality.volume, 4), short_number(report.quality.min_mean_ratio, 3),
           short_number(report.quality.average_mean_ratio, 3),
           report.unit ? "" : " The unit of the file is not stated, and taken as metres."),
       .colours = mesh_quality_colours(),
       .views = {mesh_view(report.opened.file.mesh)}});
}

Json to_json(const MeshReport& report, const MeshCommand& options) {
  const auto& [opened, unit, topology, quality, defects, coincident, regions] = report;
  Json list = Json::array();
  for (const auto& [region, content] : regions)
    list.push_back({{"region", region},
                    {"name", name_json(opened.file, region)},
                    {"tetrahedra", content.first},
                    {"volume", content.second}});
  return {
      {"mesh", options.mesh},
      {"format", opened.file.format},
      {"unit", json_or_null(unit)},
      {"status", unit ? Json() : Json("the unit is not stated; lengths are in that of the file")},
      HMAX_KEYS(topology, points, edges, faces, tetrahedra, surface_points, surface_edges, surface_triangles),
      {"volume", quality.volume},
      HMAX_KEYS(topology, components, unused_points),
      {"coincident_points", coincident},
      {"merged_points", opened.file.merged.size()},
      {"inverted", defects.inverted.size()},
      {"degenerate", defects.degenerate.size()},
      {"duplicates", defects.duplicates.size()},
      {"overlaps", defects.overlaps.size()},
      {"crowded_faces", topology.crowded_faces},
      {"euler", topology.euler()},
      {"quality",
       {{"min", quality.min_mean_ratio},
        {"mean", quality.average_mean_ratio},
        {"measure", "mean_ratio"},
        {"worst", report.worst()}}},
      {"smallest_angle_degrees", quality.smallest_angle * degrees},
      {"largest_angle_degrees", quality.largest_angle * degrees},
      HMAX_KEYS(quality, shortest_edge, longest_edge),
      {"box", {vector_json(quality.lower), vector_json(quality.upper)}},
      {"smoothed", mending_json(opened.mending)},
      {"mended", mending_json(opened.mending)},  // the old name
      {"picture", options.picture.wanted() ? Json(options.picture.file) : Json()},
      {"second_order", opened.file.second_order},
      {"regions", list},
      {"groups", groups_json(opened.file)}};
}

std::string in_words(const MeshReport& report, const MeshCommand& options, const Console& console) {
  const auto& [opened, unit, topology, quality, defects, coincident, regions] = report;
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
  line("box", box_in_words(opened.file.mesh) + " m");
  line("volume", fmt::format("{} m³", short_number(quality.volume)));
  line("edges", fmt::format("{} to {} m", short_number(quality.shortest_edge, 4),
                            short_number(quality.longest_edge, 4)));
  line("mean ratio",
       fmt::format("{} at worst (tetrahedron {}), {} on average", short_number(quality.min_mean_ratio, 4),
                   report.worst(), short_number(quality.average_mean_ratio, 4)));
  line("dihedral angles", fmt::format("{} to {} degrees", short_number(quality.smallest_angle * degrees, 4),
                                      short_number(quality.largest_angle * degrees, 4)));
  line("parts", fmt::format("{}, unused points {}", topology.components, topology.unused_points));
  if (coincident > 0)
    line("coincident", fmt::format("{} points; models merge those at exactly the same place", coincident));
  if (!opened.file.merged.empty()) line("merged", fmt::format("{} points", opened.file.merged.size()));
  if (opened.mending) line("smoothed", in_words(*opened.mending));
  if (opened.file.second_order > 0) text += second_order_in_words(opened.file) + "\n";
  for (const std::string& remark : opened.file.remarks) text += remark + "\n";
  if (!opened.file.material.empty()) text += opened.file.material_left_out() + "\n";
  text += regions_in_words(opened.file, regions, console);
  if (!defects.none())
    text += console.alarming("\nModels cannot use it: `hmax mesh check` names what is wrong.") + "\n";
  return text;
}

void info(const MeshCommand& options, Console& console) {
  options.picture.check();
  const MeshReport report = report_of(options);
  if (options.picture.wanted()) write_picture(report, options);
  console.show(to_json(report, options), in_words(report, options, console));
}

/// At most some of the things that are wrong, one a line.
template <class Items, class Sentence>
void add_findings(std::string& text, const Items& items, Sentence sentence) {
  constexpr std::size_t most = 10;
  for (std::size_t i = 0; i < std::min(items.size(), most); ++i) text += sentence(items[i]) + "\n";
  if (items.size() > most) text += fmt::format("  and {} more\n", items.size() - most);
}

/// Parts of the mesh that the supports of --support do not hold; none where there is no such option.
std::vector<std::vector<TetMesh::Index>> loose_parts_of(const MeshCommand& options, MeshFile file,
                                                        double unit) {
  if (options.supports.empty()) return {};
  file.mesh.points *= unit;
  MeshImport import = import_as_it_is(std::move(file));
  const LoadedMesh loaded{.name = options.mesh,
                          .mesh = std::move(import.mesh),
                          .origin = std::make_shared<const MeshOrigin>(std::move(import.origin))};
  return loose_parts(loaded.mesh, points_of_sets(options.supports, loaded));
}

Json numbers_json(const MeshFile& file, const std::vector<TetMesh::Index>& tetrahedra) {
  Json numbers = Json::array();
  for (const TetMesh::Index t : tetrahedra) numbers.push_back(file.numbers[static_cast<std::size_t>(t)]);
  return numbers;
}

/// All parts but the largest.
Json parts_json(const MeshFile& file, const std::vector<MeshPart>& parts) {
  Json list = Json::array();
  for (std::size_t p = 1; p < parts.size(); ++p) {
    const MeshPart& part = parts[p];
    Json hinges = Json::array();
    for (const TetMesh::Index i : part.hinges)
      hinges.push_back(file.point_numbers[static_cast<std::size_t>(i)]);
    list.push_back({{"tetrahedra", numbers_json(file, part.tetrahedra)}, {"hinge_points", hinges}});
  }
  return list;
}

Json loose_json(const MeshFile& file, const std::vector<std::vector<TetMesh::Index>>& parts) {
  Json list = Json::array();
  for (const std::vector<TetMesh::Index>& part : parts) list.push_back(numbers_json(file, part));
  return list;
}

/// "tetrahedron 7", "tetrahedra 7, 9", "1200 tetrahedra (7, 9, 10, ...)"
std::string numbers_in_words(const MeshFile& file, const std::vector<TetMesh::Index>& tetrahedra) {
  constexpr std::size_t most = 5;
  std::string numbers;
  for (std::size_t i = 0; i < std::min(most, tetrahedra.size()); ++i)
    numbers += fmt::format("{}{}", i == 0 ? "" : ", ", file.numbers[static_cast<std::size_t>(tetrahedra[i])]);
  if (tetrahedra.size() > most) return fmt::format("{} tetrahedra ({}, ...)", tetrahedra.size(), numbers);
  return (tetrahedra.size() == 1 ? "tetrahedron " : "tetrahedra ") + numbers;
}

/// How a part is joined to the others.
std::string hinges_in_words(const MeshFile& file, const MeshPart& part) {
  const auto number = [&](std::size_t i) {
    return file.point_numbers[static_cast<std::size_t>(part.hinges[i])];
  };
  const char* hang = part.tetrahedra.size() == 1 ? "hangs" : "hang";
  if (part.hinges.empty()) return part.tetrahedra.size() == 1 ? "is a separate part" : "are a separate part";
  if (part.hinges.size() == 1) return fmt::format("{} on point {} only", hang, number(0));
  if (part.hinges.size() == 2) return fmt::format("{} on the edge {}-{} only", hang, number(0), number(1));
  return fmt::format("{} on {} points and no face", hang, part.hinges.size());
}

/// What is wrong with a mesh.
struct MeshFindings {
  std::vector<Coincidence>
      coincident;            ///< of the mesh as it is; all below is of the mesh with those points merged
  Eigen::Index exactly = 0;  ///< of these, points at exactly the same place
  MeshFile merged;
  MeshDefects defects;
  std::vector<Sliver> slivers;
  MeshTopology topology;
  std::vector<MeshPart> parts;
  std::vector<std::vector<TetMesh::Index>> loose;

  [[nodiscard]] bool good() const {
    const bool hinged = std::ranges::any_of(parts, [](const MeshPart& part) { return !part.hinges.empty(); });
    return coincident.empty() && defects.none() && slivers.empty() && !hinged && loose.empty();
  }
};

/// @param angle  dihedral angle below which a tetrahedron is a sliver [degrees]
MeshFindings findings_of(const OpenedMesh& opened, double angle, const MeshCommand& options) {
  MeshFindings found;
  const double near = options.near.empty() ? near_coincidence : parse_number("--near", options.near);
  if (!(near >= 0 && near < largest_coincidence))
    throw InputError(fmt::format("--near is {}; give a share of the shortest edge from 0 to below {}",
                                 options.near, to_text(largest_coincidence)));
  found.coincident = coincidences(opened.file.mesh, near);
  found.exactly = static_cast<Eigen::Index>(coincidences(opened.file.mesh, 0).size());
  found.merged = opened.file;
  merge_points(found.merged, near);
  const TetMesh& mesh = found.merged.mesh;
  found.defects = defects_of(mesh);
  found.slivers = slivers_of(mesh, angle / degrees);
  // What has no volume is named for that already.
  std::erase_if(found.slivers, [&](const Sliver& s) {
    return std::ranges::binary_search(found.defects.degenerate, static_cast<TetMesh::Index>(s.tetrahedron));
  });
  found.topology = topology_of(mesh);
  found.topology.unused_points = static_cast<Eigen::Index>(unused_points(opened.file.mesh).size());
  found.parts = parts_of(mesh);
  found.loose = loose_parts_of(options, found.merged, unit_of(opened, options).value_or(1));
  return found;
}

Json to_json(const MeshFindings& found, const MeshFile& asked, const MeshCommand& options) {
  const MeshFile& file = found.merged;
  Json coincident = Json::array();
  for (const auto& [point, first] : found.coincident)
    coincident.push_back({asked.point_numbers[static_cast<std::size_t>(point)],
                          asked.point_numbers[static_cast<std::size_t>(first)]});
  const auto number = [&](Eigen::Index t) { return file.numbers[static_cast<std::size_t>(t)]; };
  Json pairs = Json::array(), flat = Json::array(), overlaps = Json::array();
  for (const auto& [again, first] : found.defects.overlaps)
    overlaps.push_back({number(again), number(first)});
  for (const auto& [again, first] : found.defects.duplicates) pairs.push_back({number(again), number(first)});
  for (const Sliver& sliver : found.slivers)
    flat.push_back({{"tetrahedron", number(sliver.tetrahedron)},
                    {"angle_degrees", sliver.smallest_angle * degrees},
                    {"mean_ratio", sliver.mean_ratio}});
  return {{"mesh", options.mesh},
          {"good", found.good()},
          {"coincident", coincident},
          {"inverted", numbers_json(file, found.defects.inverted)},
          {"degenerate", numbers_json(file, found.defects.degenerate)},
          {"duplicates", pairs},
          {"overlaps", overlaps},
          {"crowded", numbers_json(file, found.defects.crowded)},
          {"slivers", flat},
          {"parts", parts_json(file, found.parts)},
          {"loose", loose_json(file, found.loose)},
          HMAX_KEYS(found.topology, components, unused_points)};
}

std::string coincident_in_words(const MeshFindings& found, const MeshFile& file) {
  if (found.coincident.empty()) return {};
  const auto number = [&](TetMesh::Index i) { return file.point_numbers[static_cast<std::size_t>(i)]; };
  const auto& [point, first] = found.coincident.front();
  const std::size_t count = found.coincident.size();
  std::string text = fmt::format("{} {} with another, {} of them exactly: point {} with point {}{}\n", count,
                                 count == 1 ? "point coincides" : "points coincide", found.exactly,
                                 number(point), number(first), count > 1 ? ", ..." : "");
  text +=
      found.exactly == static_cast<Eigen::Index>(count)
          ? "models merge them; `hmax mesh convert FILE OUTPUT` writes the merged mesh, which is checked below\n"
          : "models merge those at exactly the same place; `hmax mesh convert FILE OUTPUT --merge TOL` merges more; "
            "what follows is of the merged mesh\n";
  return text;
}

std::string in_words(const MeshFindings& found, const OpenedMesh& opened) {
  const MeshFile& file = found.merged;
  const auto number = [&](Eigen::Index t) { return file.numbers[static_cast<std::size_t>(t)]; };
  const auto where = [&](Eigen::Index t) {
    return opened.from_file && file.places[static_cast<std::size_t>(t)] > 0
               ? file.where(t)
               : fmt::format("tetrahedron {}", number(t));
  };
  std::string text = coincident_in_words(found, opened.file);
  const MeshDefects& defects = found.defects;
  add_findings(text, defects.inverted, [&](auto t) { return where(t) + " is inverted"; });
  add_findings(text, defects.degenerate, [&](auto t) { return where(t) + " has no volume"; });
  add_findings(text, defects.duplicates, [&](const auto& pair) {
    return fmt::format("{} has the corners of tetrahedron {}", where(pair.first), number(pair.second));
  });
  add_findings(text, defects.overlaps, [&](const auto& pair) {
    return fmt::format("{} overlaps tetrahedron {}: both lie on the same side of their common face",
                       where(pair.first), number(pair.second));
  });
  add_findings(text, defects.crowded, [&](auto t) { return where(t) + " shares a face with two others"; });
  add_findings(text, found.slivers, [&](const Sliver& sliver) {
    return fmt::format("{} is a sliver: dihedral angle {} degrees, mean ratio {}", where(sliver.tetrahedron),
                       short_number(sliver.smallest_angle * degrees, 3), short_number(sliver.mean_ratio, 3));
  });
  const MeshTopology& topology = found.topology;
  if (topology.unused_points > 0)
    text += fmt::format("{} points are {}; models leave them out\n", topology.unused_points,
                        file.second_order > 0 ? "no corner of a tetrahedron, as middles of second order are"
                                              : "in no tetrahedron");
  if (file.second_order > 0) text += second_order_in_words(file) + "\n";
  for (const std::string& remark : file.remarks) text += remark + "\n";
  if (topology.components > 1) text += fmt::format("the mesh has {} separate parts\n", topology.components);
  // The largest part is the body, from which the others hang.
  for (std::size_t p = 1; p < found.parts.size(); ++p)
    text += fmt::format("{} {}\n", numbers_in_words(file, found.parts[p].tetrahedra),
                        hinges_in_words(file, found.parts[p]));
  for (const std::vector<TetMesh::Index>& part : found.loose)
    text += fmt::format("{}: no support holds {}\n", numbers_in_words(file, part),
                        part.size() == 1 ? "it" : "them");
  if (!defects.overlaps.empty())
    text += "elements that overlap were folded over or inverted; another order of corners does not help\n";
  else if (!defects.inverted.empty())
    text += "`hmax mesh convert FILE OUTPUT --fix` turns what is inverted\n";
  return text;
}

void check_mesh(const MeshCommand& options, Console& console) {
  const OpenedMesh opened = open_mesh(options.mesh, CoincidentPoints::kept);
  const double angle = parse_number("--slivers", options.slivers);
  if (!(angle >= 0 && angle < 70))
    throw InputError(fmt::format(
        "--slivers is {}; give a dihedral angle from 0 up to 70 degrees, since no tetrahedron has all above 70.53",
        options.slivers));
  const MeshFindings found = findings_of(opened, angle, options);
  const bool good = found.good();
  if (!good) console.exit_code = Exit::failed;
  console.show(to_json(found, opened.file, options),
               in_words(found, opened) +
                   (good ? fmt::format("{}: {} tetrahedra, none is wrong or flatter than {} degrees\n",
                                       options.mesh, found.topology.tetrahedra, short_number(angle))
                         : console.alarming(fmt::format("{} is not good", options.mesh)) + "\n"));
}

}  // namespace

std::optional<double> unit_of(const OpenedMesh& opened, const MeshCommand& options) {
  if (opened.from_file) return options.metres();
  if (options.metres().value_or(1) != 1)
    throw InputError(fmt::format("the mesh {} is in metres; leave --unit out", options.mesh));
  return 1.0;
}

std::string second_order_in_words(const MeshFile& file) {
  return fmt::format(
      "{} tetrahedra of second order are read by their corners, with straight sides; --model fem_quadratic takes "
      "all their nodes",
      file.second_order);
}

void add_mesh_argument(CLI::App& command, MeshCommand& options) {
  require(add_text(
      command, "mesh,--mesh", options.mesh,
      "A file (.msh .vtk .vtu .node .ele .mesh .veg .inp .scn .feb .xml), or liver, phantom, beam, cube, ball; parameters like "
      "ball:n=6, all take :refine=K, :mend=N and :merge=TOL"));
}

void add_unit(CLI::App& command, MeshCommand& options) {
  add_text(command, "--unit", options.unit,
           "Unit of the coordinates of a file: m, cm, mm or a number of metres", "UNIT");
}

void add_mesh(CLI::App& app, Console& console) {
  CLI::App& group = add_group(app, "mesh", "Inspect, check, make and convert tetrahedral meshes");

  const auto [info_command, info_options] =
      add_command(group, console, "info", "Show the counts of a mesh, its surface, size and quality",
                  {"hmax mesh info liver", "hmax mesh info ball:n=6:refine=1 --json",
                   "hmax mesh info liver:mend=16", "hmax mesh info liver --picture results/runs/liver.svg"},
                  with_sentences<info>);
  add_mesh_argument(info_command, info_options);
  add_unit(info_command, info_options);
  info_options.picture.add_to(info_command, "Draw the surface, coloured by the worst tetrahedron nearby",
                              false);
  add_force(info_command);

  const auto [check_command, check_options] = add_command(
      group, console, "check", "Find defects and slivers of a mesh; exit 1 if there are any",
      {"hmax mesh check liver", "hmax mesh check phantom --slivers 20"}, with_sentences<check_mesh>);
  add_mesh_argument(check_command, check_options);
  add_text(check_command, "--slivers", check_options.slivers,
           "Dihedral angle below which a tetrahedron is a sliver [degrees]; 5 by default", "DEGREES");
  add_text(check_command, "--near", check_options.near,
           "Share of the shortest edge within which points coincide; 0.001 by default", "TOL");
  add_unit(check_command, check_options);
  add_support(check_command, check_options.supports, "none by default");

  add_mesh_writers(group, console);
}

}  // namespace hmax
