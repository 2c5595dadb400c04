#include "problems/mesh/files/mesh_names.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "problems/digits.hpp"
#include "problems/mesh/coincident_points.hpp"
#include "problems/mesh/files/mesh_defects.hpp"
#include "problems/mesh/mesh_generators.hpp"
#include "problems/mesh/refine.hpp"

namespace hmax {

namespace {

using Parameters = std::vector<std::pair<std::string, double>>;

const double* find(const Parameters& parameters, std::string_view name) {
  const auto found = std::ranges::find(parameters, name, &std::pair<std::string, double>::first);
  return found == parameters.end() ? nullptr : &found->second;
}

void refuse(std::string_view parameter, const std::string& mesh, double value, const std::string& allowed) {
  throw std::invalid_argument("the parameter " + std::string(parameter) + " of the mesh " + mesh + " is " +
                              shortest_digits(value) + "; give a whole number from " + allowed);
}

bool is_key(std::string_view text) {
  return !text.empty() &&
         std::ranges::all_of(text, [](char c) { return (c >= 'a' && c <= 'z') || c == '_'; });
}

/// "n=6"
std::pair<std::string, double> parameter_of(std::string_view text) {
  const std::size_t equals = std::min(text.find('='), text.size());
  const std::string_view digits = text.substr(std::min(equals + 1, text.size()));
  if (text == "merge=off") return {"merge", merge_off};
  double value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc{} || end != digits.data() + digits.size() || !std::isfinite(value))
    throw std::invalid_argument("the parameter '" + std::string(text) +
                                "' of a mesh has no number; write it like ball:n=6,radius=0.04");
  return {std::string(text.substr(0, equals)), value};
}

/// The largest n up to which `share` n^3 tetrahedra are allowed.
int most_cells(int share) {
  int n = static_cast<int>(std::cbrt(static_cast<double>(most_tetrahedra) / share));
  while (share * std::pow(n + 1, 3) <= static_cast<double>(most_tetrahedra)) ++n;
  return n;
}

/// A mesh that is computed: `share` n^3 tetrahedra, made from n and the other parameters in their order.
struct Generator {
  NamedMesh mesh;
  int share;
  TetMesh (*make)(int n, const Parameters& values);
};

const std::vector<Generator>& generators() {
  static const std::vector<Generator> all{
      {{.name = "beam",
        .parameters = {{"n", 4}, {"length", 0.2}, {"width", 0.05}, {"height", 0.05}},
        .description = "4 n cells along x, n x n across",
        .held_axis = 1},
       24,
       [](int n, const Parameters& p) { return beam_mesh(p[1].second, p[2].second, p[3].second, n); }},
      {{.name = "cube", .parameters = {{"n", 4}, {"edge", 0.1}}, .description = "n cells along each edge"},
       6,
       [](int n, const Parameters& p) { return cube_mesh(p[1].second, n); }},
      {{.name = "ball",
        .parameters = {{"n", 4}, {"radius", 0.05}},
        .description = "n shells around the origin"},
       20,
       [](int n, const Parameters& p) { return ball_mesh(p[1].second, n); }}};
  return all;
}

/// What is known of the files of problems/meshes beside their text. A liver hangs from the diaphragm.
const std::vector<NamedMesh>& known_files() {
  static const std::vector<NamedMesh> all{
      {.name = "liver", .description = "a liver of 1.5 kg with the counts of the study", .held_axis = -3},
      {.name = "phantom", .description = "a cube of gel with the counts of the study"}};
  return all;
}

TetMesh generated(const Generator& generator, const Parameters& values) {
  const double n = values.front().second;
  const int most = most_cells(generator.share);
  if (n != std::floor(n) || n < 1 || n > most)
    refuse("n", generator.mesh.name, n, "1 to " + std::to_string(most));
  return generator.make(static_cast<int>(n), values);
}

}  // namespace

const std::vector<NamedMesh>& named_meshes() {
  static const std::vector<NamedMesh> meshes = [] {
    std::vector<NamedMesh> all;
    for (const EmbeddedText& file : mesh_texts()) {
      const auto known = std::ranges::find(known_files(), file.name, &NamedMesh::name);
      all.push_back(known != known_files().end() ? *known : NamedMesh{.name = std::string(file.name)});
    }
    for (const Generator& generator : generators()) all.push_back(generator.mesh);
    return all;
  }();
  return meshes;
}

const NamedMesh* find_named_mesh(std::string_view name) {
  const auto known = std::ranges::find(named_meshes(), name, &NamedMesh::name);
  return known == named_meshes().end() ? nullptr : &*known;
}

MeshRequest parse_mesh_request(std::string_view text) {
  MeshRequest request;
  while (true) {
    const std::size_t colon = text.rfind(':');
    if (colon == std::string_view::npos) break;
    std::string_view list = text.substr(colon + 1);
    const std::size_t equals = list.find('=');
    // A path may hold colons too.
    if (equals == std::string_view::npos || !is_key(list.substr(0, equals)) ||
        list.find('/') != std::string_view::npos)
      break;
    Parameters parameters;
    while (!list.empty()) {
      const std::string_view one = list.substr(0, list.find(','));
      list.remove_prefix(std::min(one.size() + 1, list.size()));
      parameters.push_back(parameter_of(one));
    }
    request.parameters.insert(request.parameters.begin(), parameters.begin(), parameters.end());
    text = text.substr(0, colon);
  }
  for (const auto& parameter : request.parameters)
    if (std::ranges::count(request.parameters, parameter.first, &std::pair<std::string, double>::first) > 1)
      throw std::invalid_argument("the parameter " + parameter.first +
                                  " of a mesh is given twice; leave one of them out");
  request.name = text;
  return request;
}

bool is_modifier(std::string_view parameter) {
  return parameter == "refine" || parameter == "mend" || parameter == "merge";
}

MeshModifiers modifiers_of(const MeshRequest& request) {
  const auto count = [&](std::string_view modifier, double most) {
    const double* number = find(request.parameters, modifier);
    if (!number) return 0.0;
    if (*number != std::floor(*number) || *number < 0) refuse(modifier, request.name, *number, "0 on");
    return std::min(*number, most);
  };
  // More than any mesh can be refined, which is told where its tetrahedra are counted.
  const auto refine = static_cast<int>(count("refine", 1000));
  constexpr auto all = std::numeric_limits<TetMesh::Index>::max();
  MeshModifiers modifiers{.refine = refine, .mend = static_cast<TetMesh::Index>(count("mend", all))};
  if (const double* merge = find(request.parameters, "merge")) {
    if (!(*merge == merge_off || (*merge >= 0 && *merge < largest_coincidence)))
      throw std::invalid_argument("the parameter merge of the mesh " + request.name + " is " +
                                  shortest_digits(*merge) +
                                  "; give a share of the shortest edge from 0 to below " +
                                  shortest_digits(largest_coincidence) + ", or off");
    modifiers.merge = *merge;
  }
  return modifiers;
}

std::optional<Mending> modify(MeshFile& file, const MeshModifiers& modifiers) {
  if (modifiers.refine > 0) file = refined(file, modifiers.refine);
  if (modifiers.mend == 0) return std::nullopt;
  return mend(file, modifiers.mend);
}

TetMesh unmodified_mesh(const MeshRequest& request) {
  const NamedMesh* const known = find_named_mesh(request.name);
  if (!known) {
    std::string names;
    for (const NamedMesh& mesh : named_meshes()) names += (names.empty() ? "" : ", ") + mesh.name;
    throw std::invalid_argument("there is no mesh '" + request.name + "'; known are " + names);
  }
  Parameters values = known->parameters;
  for (const auto& [name, value] : request.parameters) {
    if (is_modifier(name)) continue;
    const auto place = std::ranges::find(values, name, &std::pair<std::string, double>::first);
    if (place == values.end()) {
      std::string message = "the mesh " + request.name;
      message += " has no parameter '" + name + "'; it takes refine, mend, merge";
      for (const auto& each : known->parameters) message += ", " + each.first;
      throw std::invalid_argument(message);
    }
    place->second = value;
  }
  const auto made =
      std::ranges::find(generators(), request.name, [](const Generator& g) { return g.mesh.name; });
  if (made != generators().end()) return generated(*made, values);
  const auto text = std::ranges::find(mesh_texts(), request.name, &EmbeddedText::name);
  MeshFile file = read_mesh(request.name + ".msh", text->text);
  require_valid(file);
  number_regions(file.mesh);
  return file.mesh;
}

TetMesh mesh_by_name(const MeshRequest& request) {
  MeshFile file = counted_from_one(unmodified_mesh(request));
  modify(file, modifiers_of(request));
  return std::move(file.mesh);
}

}  // namespace hmax
