#include "catalogue/models/mesh_choice.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <stdexcept>

#include <fmt/format.h>

#include "catalogue/input/suggest.hpp"
#include "core/input_error.hpp"
#include "core/numbers.hpp"
#include "problems/mesh/coincident_points.hpp"
#include "problems/mesh/files/mesh_defects.hpp"

namespace hmax {

namespace {

/// Tetrahedra from which on meshes by name are renumbered. Smaller bodies stay in the caches in any order.
constexpr Eigen::Index least_named_renumbered = 5000;

bool has_name(const std::string& name) {
  return std::ranges::find(named_meshes(), name, &NamedMesh::name) != named_meshes().end();
}

/// Of a mesh by name what stands behind its colon without being NAME=NUMBER.
void refuse_parameter(const std::string& mesh, const std::string& text) {
  const auto known = std::ranges::find(named_meshes(), mesh, &NamedMesh::name);
  std::string like;
  for (const auto& [name, value] : known->parameters)
    like += fmt::format("{}{}={}", like.empty() ? "" : ",", name, to_text(value));
  if (text.empty()) throw input_error("nothing stands behind the colon of '{}:'; leave the colon out", mesh);
  throw input_error("behind the mesh {} '{}' is no parameter; write them in small letters like {}:{}", mesh,
                    text, mesh, like.empty() ? "refine=1" : like);
}

MeshFile from_file(const MeshRequest& request) {
  for (const auto& [name, value] : request.parameters)
    if (!is_modifier(name))
      throw input_error("a mesh from a file has no parameter '{}'; it takes refine, mend and merge only",
                        name);
  std::error_code ignored;
  if (!std::filesystem::exists(request.name, ignored) &&
      request.name.find_first_of("./") == std::string::npos) {
    if (const auto colon = request.name.find(':'); has_name(request.name.substr(0, colon)))
      refuse_parameter(request.name.substr(0, colon), request.name.substr(colon + 1));
    std::vector<std::string> names;
    for (const NamedMesh& mesh : named_meshes()) names.push_back(mesh.name);
    throw input_error("there is no mesh or file '{}'; {}", request.name, suggestion(request.name, names));
  }
  return read_mesh_file(request.name);
}

}  // namespace

OpenedMesh open_mesh(const std::string& text, CoincidentPoints coincident, ElementNodes nodes) {
  return told_to_user([&] {
    if (text.empty()) throw InputError("no mesh is given; name one, like liver or ball:n=6, or a file");
    const MeshRequest request = parse_mesh_request(text);
    const bool named = has_name(request.name);
    OpenedMesh opened{.file = named ? counted_from_one(unmodified_mesh(request), text) : from_file(request),
                      .from_file = !named};
    if (nodes == ElementNodes::four) opened.file.middles.resize(6, 0);
    const MeshModifiers modifiers = modifiers_of(request);
    const bool merges = !named && coincident == CoincidentPoints::merged;
    if (const double tolerance = modifiers.merge.value_or(merges ? 0 : merge_off); tolerance >= 0)
      merge_points(opened.file, tolerance);
    if (modifiers.any() || nodes == ElementNodes::ten) {
      require_valid(opened.file);
      opened.mending = modify(opened.file, modifiers);
    }
    if (nodes == ElementNodes::ten) opened.file = with_ten_nodes(opened.file);
    return opened;
  });
}

std::vector<std::string> remarks_on_mesh(const MeshFile& file) {
  std::vector<std::string> remarks = file.remarks;
  if (!file.merged.empty())
    remarks.push_back(
        fmt::format("merged {} coincident points of {}; :merge=off behind the mesh keeps them apart",
                    file.merged.size(), file.name));
  if (const auto apart = coincidences(file.mesh, near_coincidence); !apart.empty()) {
    const auto number = [&](TetMesh::Index i) { return file.point_numbers[static_cast<std::size_t>(i)]; };
    remarks.push_back(fmt::format(
        "{} has {} within {} of an edge from another point, not merged: point {} beside point {}{}; "
        ":merge={} behind the mesh merges them",
        file.name, apart.size() == 1 ? "1 point" : fmt::format("{} points", apart.size()),
        to_text(near_coincidence), number(apart.front().point), number(apart.front().first),
        apart.size() == 1 ? "" : ", ...", to_text(near_coincidence)));
  }
  return remarks;
}

std::string coarser_mesh(const std::string& text) {
  return told_to_user([&]() -> std::string {
    MeshRequest request = parse_mesh_request(text);
    const int refinements = modifiers_of(request).refine;
    std::erase_if(request.parameters, [](const auto& parameter) { return parameter.first == "refine"; });
    if (refinements > 1) request.parameters.emplace_back("refine", refinements - 1);
    if (refinements == 0) {
      const NamedMesh* named = find_named_mesh(request.name);
      if (!named || named->parameters.empty() || named->parameters.front().first != "n") return {};
      const auto n = std::ranges::find(request.parameters, "n", &std::pair<std::string, double>::first);
      const double half =
          std::floor((n == request.parameters.end() ? named->parameters.front().second : n->second) / 2);
      if (half < 1) return {};
      if (n == request.parameters.end())
        request.parameters.emplace_back("n", half);
      else
        n->second = half;
    }
    std::string coarser = request.name;
    for (const auto& [name, value] : request.parameters)
      coarser += fmt::format(":{}={}", name, to_text(value));
    return coarser;
  });
}

std::string mended_mesh(const std::string& text, int count) {
  return told_to_user([&] {
    const MeshRequest request = parse_mesh_request(text);
    return modifiers_of(request).mend > 0 ? std::string() : fmt::format("{}:mend={}", text, count);
  });
}

double unit_in_metres(std::string_view text) {
  if (text == "m") return 1;
  if (text == "cm") return 0.01;
  if (text == "mm") return 0.001;
  const auto metres = to_number(text);
  constexpr double least = 1e-12, most = 1e12;
  if (!metres || !(*metres >= least && *metres <= most))
    throw input_error(
        "'{}' is no unit of length; write m, cm, mm, or metres as a number from {} to {} like 0.0254", text,
        to_text(least), to_text(most));
  return *metres;
}

namespace {

/// @param least_renumbered  tetrahedra of a mesh by name
LoadedMesh load(const std::string& text, std::optional<double> unit, ElementNodes nodes,
                Eigen::Index least_renumbered) {
  OpenedMesh opened = open_mesh(text, CoincidentPoints::merged, nodes);
  if (!opened.from_file && unit.value_or(1) != 1)
    throw input_error("the mesh {} is in metres; leave the unit out", text);
  if (opened.from_file && !unit)
    throw input_error(
        "{} does not say its unit, and a body of {} could be anything; state it with --unit m, cm, mm or "
        "METRES",
        text, box_in_words(opened.file.mesh));
  return told_to_user([&] {
    const bool keeps_order = !opened.from_file && opened.file.mesh.element_count() < least_renumbered;
    MeshImport import = keeps_order ? import_as_it_is(std::move(opened.file))
                                    : import_mesh(std::move(opened.file), unit.value_or(1));
    return LoadedMesh{.name = text,
                      .mesh = std::move(import.mesh),
                      .origin = std::make_shared<const MeshOrigin>(std::move(import.origin))};
  });
}

}  // namespace

LoadedMesh load_mesh(const std::string& text, std::optional<double> unit, ElementNodes nodes) {
  return load(text, unit, nodes, least_named_renumbered);
}

LoadedMesh load_mesh_to_renumber(const std::string& text, std::optional<double> unit, ElementNodes nodes) {
  return load(text, unit, nodes, std::numeric_limits<Eigen::Index>::max());
}

std::string box_in_words(const TetMesh& mesh, double unit) {
  if (mesh.point_count() == 0) return "nothing";
  const Eigen::Vector3d size = unit * (mesh.points.rowwise().maxCoeff() - mesh.points.rowwise().minCoeff());
  return fmt::format("{:.4g} x {:.4g} x {:.4g}", size(0), size(1), size(2));
}

}  // namespace hmax
