#include "bench/mesh_choice.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numeric>
#include <stdexcept>

#include <fmt/format.h>

#include "bench/suggest.hpp"
#include "problems/tissue/refine.hpp"
#include "results/errors.hpp"
#include "results/numbers.hpp"

namespace hmax {

namespace {

/// What lower floors refuse, for the user.
template <class Make>
auto told_to_user(Make make) {
  try {
    return make();
  } catch (const std::invalid_argument& error) {
    throw InputError(error.what());
  }
}

bool has_name(const std::string& name) {
  return std::ranges::find(named_meshes(), name, &NamedMesh::name) != named_meshes().end();
}

/// Elements counted from 1 in the order they are in.
void count_elements(MeshFile& file) {
  file.numbers.resize(static_cast<std::size_t>(file.mesh.tetrahedron_count()));
  std::iota(file.numbers.begin(), file.numbers.end(), 1);
  file.places.assign(file.numbers.size(), 0);
}

/// Of a mesh by name what stands behind its colon without being NAME=NUMBER.
void refuse_parameter(const std::string& mesh, const std::string& text) {
  const auto known = std::ranges::find(named_meshes(), mesh, &NamedMesh::name);
  std::string like;
  for (const auto& [name, value] : known->parameters)
    like += fmt::format("{}{}={}", like.empty() ? "" : ",", name, to_text(value));
  if (text.empty())
    throw InputError(fmt::format("nothing stands behind the colon of '{}:'; leave the colon out", mesh));
  throw InputError(
      fmt::format("behind the mesh {} '{}' is no parameter; write them in small letters like {}:{}", mesh,
                  text, mesh, like.empty() ? "refine=1" : like));
}

MeshFile from_file(const MeshRequest& request) {
  for (const auto& [name, value] : request.parameters)
    if (name != "refine")
      throw InputError(fmt::format("a mesh from a file has no parameter '{}'; it takes refine only", name));
  std::error_code ignored;
  if (!std::filesystem::exists(request.name, ignored) &&
      request.name.find_first_of("./") == std::string::npos) {
    if (const auto colon = request.name.find(':'); has_name(request.name.substr(0, colon)))
      refuse_parameter(request.name.substr(0, colon), request.name.substr(colon + 1));
    std::vector<std::string> names;
    for (const NamedMesh& mesh : named_meshes()) names.push_back(mesh.name);
    throw InputError(
        fmt::format("there is no mesh or file '{}'; {}", request.name, suggestion(request.name, names)));
  }
  MeshFile file = read_mesh_file(request.name);
  if (const int times = refinements_of(request); times > 0) {
    require_valid(file);
    file.mesh = refined(file.mesh, times);
    count_elements(file);
  }
  return file;
}

MeshFile by_name(const std::string& text, const MeshRequest& request) {
  MeshFile file{
      .name = text, .format = "by name", .mesh = mesh_by_name(request), .numbers = {}, .places = {}};
  count_elements(file);
  return file;
}

}  // namespace

OpenedMesh open_mesh(const std::string& text) {
  return told_to_user([&] {
    if (text.empty()) throw InputError("no mesh is given; name one, like liver or ball:n=6, or a file");
    const MeshRequest request = parse_mesh_request(text);
    const bool named = has_name(request.name);
    return OpenedMesh{.file = named ? by_name(text, request) : from_file(request), .from_file = !named};
  });
}

double unit_in_metres(std::string_view text) {
  if (text == "m") return 1;
  if (text == "cm") return 0.01;
  if (text == "mm") return 0.001;
  const auto metres = to_number(text);
  constexpr double least = 1e-12, most = 1e12;
  if (!metres || !(*metres >= least && *metres <= most))
    throw InputError(fmt::format(
        "'{}' is no unit of length; write m, cm, mm, or metres as a number from {} to {} like 0.0254", text,
        to_text(least), to_text(most)));
  return *metres;
}

LoadedMesh load_mesh(const std::string& text, std::optional<double> unit) {
  OpenedMesh opened = open_mesh(text);
  if (!opened.from_file) {
    if (unit) throw InputError(fmt::format("the mesh {} is in metres; leave the unit out", text));
    return {.name = text,
            .mesh = std::move(opened.file.mesh),
            .import = {},
            .numbers = std::move(opened.file.numbers),
            .regions = {0}};
  }
  if (!unit)
    throw InputError(fmt::format(
        "{} does not say its unit, and a body of {} could be anything; state it with --unit m, cm, mm or "
        "METRES",
        text, box_in_words(opened.file.mesh)));
  return told_to_user([&] {
    MeshImport import = import_mesh(opened.file, *unit);
    LoadedMesh loaded{.name = text, .mesh = std::move(import.mesh), .import = {}};
    loaded.idle_points = import.file_point_count - loaded.mesh.point_count();
    for (const TetMesh::Index place : import.file_tetrahedra)
      loaded.numbers.push_back(opened.file.numbers[static_cast<std::size_t>(place)]);
    loaded.regions = import.file_regions;
    if (refinements_of(parse_mesh_request(text)) == 0) {
      import.mesh = {};
      loaded.import = std::move(import);
    }
    return loaded;
  });
}

std::string box_in_words(const TetMesh& mesh, double unit) {
  if (mesh.point_count() == 0) return "nothing";
  const Eigen::Vector3d size = unit * (mesh.points.rowwise().maxCoeff() - mesh.points.rowwise().minCoeff());
  return fmt::format("{:.4g} x {:.4g} x {:.4g}", size(0), size(1), size(2));
}

}  // namespace hmax
