/// The mesh of a scene of SOFA, with the points that it fixes.
#include <algorithm>
#include <array>
#include <filesystem>
#include <map>
#include <set>
#include <utility>

#include "core/sort_unique.hpp"
#include "core/text/split.hpp"
#include "problems/mesh/files/mesh_readers.hpp"
#include "problems/mesh/files/scenes/sofa_file.hpp"

namespace hmax {

namespace {

using Index = TetMesh::Index;

bool is_link(std::string_view value) { return value.starts_with('@'); }

class SofaMeshReader {
 public:
  explicit SofaMeshReader(const XmlFile& file) : file_(file), state_(sofa_state(file)) {}

  MeshFile read() {
    if (const std::string_view kind = state_.tag.attribute("template");
        !kind.empty() && !kind.starts_with("Vec3"))
      file_.fail(state_, "the MechanicalObject is of " + in_quotes(kind) + ", and points of Vec3 are read");
    const XmlPart& topology = find_topology();
    const XmlPart* const loader = loader_of(topology);
    mesh_ = loader ? loaded(*loader) : inline_mesh(topology);
    require_not_moved(state_,
                      "translation|rotation|scale|scale3d|translation2|rotation2|dx|dy|dz|rx|ry|rz|sx|sy|sz|"
                      "restScale");
    if (loader) move_by(*loader);
    require_same_points(topology, loader);
    for (const XmlPart& part : file_.parts()) {
      if (states_.of(part) != &state_) continue;
      if (part.type == "FixedConstraint" || part.type == "FixedProjectiveConstraint") fix(part);
      if (part.has("youngModulus") && (part.node == state_.node || !topology_in(part.node)))
        set_regions(part);
    }
    mesh_.material = file_.place_of_first([](const XmlPart& part) { return part.has("youngModulus"); });
    set_regions_of_nodes();
    add_points_group(mesh_, fixed_points_of_sofa, fixed_);
    return std::move(mesh_);
  }

 private:
  const XmlPart* topology_in(std::optional<std::size_t> node) const {
    if (!node) return nullptr;
    for (const XmlPart* part : file_.within(file_.parts()[*node]))
      if (part->type == "TetrahedronSetTopologyContainer" || part->type == "MeshTopology") return part;
    return nullptr;
  }

  const XmlPart& find_topology() const {
    if (const XmlPart* const found = topology_in(state_.node)) return *found;
    file_.fail(state_, "there is no TetrahedronSetTopologyContainer beside the MechanicalObject; " + remedy_);
  }

  /// The loader of a mesh file, also one that the topology itself is; null of one with its own numbers.
  const XmlPart* loader_of(const XmlPart& topology) const {
    if (topology.has("filename")) return &topology;
    for (const char* attribute : {"src", "tetrahedra"})
      if (is_link(topology.tag.attribute(attribute))) return &sofa_linked(file_, topology, attribute);
    return nullptr;
  }

  MeshFile loaded(const XmlPart& loader) const {
    const std::string name = unescaped(loader.tag.attribute("filename"));
    if (name.empty())
      file_.fail(loader,
                 std::string(loader.type) +
                     " names no file of a mesh, so its tetrahedra are not read; load them from .msh or .vtk");
    if (lower(name).ends_with(".scn"))
      file_.fail(loader, "a scene is no mesh of another one; name a .msh or .vtk");
    const std::filesystem::path path = std::filesystem::path(file_.name()).parent_path() / name;
    std::error_code ignored;
    if (!std::filesystem::exists(path, ignored))
      file_.fail(loader, "there is no file " + in_quotes(path.string()) +
                             "; SOFA also looks into its own folders, so copy it there");
    return read_mesh_file(path);
  }

  /// As SOFA's loaders: scaled, then moved.
  void move_by(const XmlPart& loader) {
    require_not_moved(loader, "rotation|transformation");
    const auto given = [&](const char* attribute, std::size_t count, const Eigen::Vector3d& otherwise) {
      if (!loader.has(attribute)) return otherwise;
      const std::vector<double> values = file_.numbers(loader, attribute, count);
      return Eigen::Vector3d(values.front(), values[count / 2], values.back());
    };
    const Eigen::Vector3d one = Eigen::Vector3d::Ones(), zero = Eigen::Vector3d::Zero();
    const Eigen::Vector3d scale = given("scale3d", 3, one).cwiseProduct(given("scale", 1, one));
    if (!(scale.array() > 0).all()) file_.fail(loader, "a scale is not positive; correct it");
    Eigen::Matrix3Xd& points = mesh_.mesh.points;
    points = ((scale.asDiagonal() * points).colwise() + given("translation", 3, zero)).eval();
  }

  /// @param attributes  a list of those that move points in other ways, where they are not 0, or 1 of scales
  void require_not_moved(const XmlPart& part, std::string_view attributes) const {
    for (const auto& [name, value] : part.tag.attributes) {
      if (!is_listed(name, attributes)) continue;
      const double neutral = name.starts_with('s') || name == "restScale" ? 1 : 0;
      const std::vector<double> numbers = file_.numbers(part, name);
      for (std::size_t i = 0; i < numbers.size(); ++i)
        if (numbers[i] != (name == "transformation" && i % 5 == 0 ? 1 : neutral))  // the identity
          file_.fail(part, in_quotes(name) + " = " + in_quotes(value) + " of " + std::string(part.type) +
                               " is not read; move the points themselves");
    }
  }

  MeshFile inline_mesh(const XmlPart& topology) const {
    if (!topology.has("tetrahedra"))
      file_.fail(topology, std::string(topology.type) + " has no tetrahedra; " + remedy_);
    const XmlPart& points =
        topology.has("position") && !is_link(topology.tag.attribute("position")) ? topology : state_;
    return listed_mesh(file_, {points, "position"}, {topology, "tetrahedra"}, "SOFA");
  }

  /// Points of its own win over those of the topology, and strains are relative to them.
  void require_same_points(const XmlPart& topology, const XmlPart* loader) const {
    const XmlPart* at = &state_;
    for (int links = 0; is_link(at->tag.attribute("position")) && links < 8; ++links)
      at = &sofa_linked(file_, *at, "position");
    if (at == &topology || at == loader) return;
    if (is_link(at->tag.attribute("position")) || (at != &state_ && !at->has("position")))
      file_.fail(state_, "position of the MechanicalObject is that of " + in_quotes(at->type) +
                             ", which is not read; link it to the topology or to the loader");
    const std::vector<double> own = file_.numbers(*at, "position");
    if (own.empty()) return;
    const auto points = mesh_.mesh.points.reshaped();
    const double allowed = 1e-9 * points.cwiseAbs().maxCoeff();
    if (std::ssize(own) != points.size() ||
        (Eigen::Map<const Eigen::VectorXd>(own.data(), points.size()) - points).cwiseAbs().maxCoeff() >
            allowed)
      file_.fail(
          state_,
          "position of the MechanicalObject is not that of its topology, which is not read; leave it out");
  }

  /// A region of the elements of each modulus.
  void set_regions(const XmlPart& field) {
    const std::vector<double> values = file_.numbers(field, "youngModulus"), moduli = sorted_moduli(values);
    const auto count = static_cast<std::size_t>(mesh_.mesh.tetrahedron_count());
    if (moduli.size() < 2) return;
    if (values.size() != count)
      file_.fail(field, "youngModulus has " + std::to_string(values.size()) + " numbers for " +
                            std::to_string(count) + " tetrahedra; give one, or one of each");
    mesh_.mesh.regions.clear();
    for (const double value : values)
      mesh_.mesh.regions.push_back(
          static_cast<Index>(std::ranges::lower_bound(moduli, value) - moduli.begin() + 1));
    mesh_.names.clear();
  }

  /// Of nodes in that of the body, without points of their own: the tetrahedra of their topologies.
  void set_regions_of_nodes() {
    std::map<std::array<Index, 4>, std::size_t> by_corners;
    std::vector<Index> regions;
    Index count = 0;
    const XmlPart* last = nullptr;
    for (const XmlPart& field : file_.parts()) {
      if (!is_sofa_field(field.type) || field.node == state_.node || states_.of(field) != &state_) continue;
      const XmlPart* const topology = topology_in(field.node);
      if (!topology) continue;  // acts on the whole body
      if (!topology->has("tetrahedra") || is_link(topology->tag.attribute("tetrahedra")))
        file_.fail(field, "the node of this force field has no tetrahedra of its own; " + remedy_);
      if (regions.empty()) {
        regions.assign(static_cast<std::size_t>(mesh_.mesh.tetrahedron_count()), 0);
        for (std::size_t t = 0; t < regions.size(); ++t)
          by_corners[sorted_corners(mesh_.mesh.tetrahedra.col(static_cast<Index>(t)))] = t;
      }
      ++count;
      MeshText corners = file_.values(*topology, topology->tag.attribute("tetrahedra"));
      while (!corners.at_end()) {
        Eigen::Vector<Index, 4> four;
        for (Index& corner : four) corner = static_cast<Index>(corners.integer("a corner"));
        const auto found = by_corners.find(sorted_corners(four));
        if (found == by_corners.end() || std::exchange(regions[found->second], count) != 0)
          file_.fail(*topology,
                     "a tetrahedron is not one of the body, or has a force field already; correct it");
      }
      last = &field;
    }
    if (!last) return;
    if (std::ranges::find(regions, 0) != regions.end())
      file_.fail(*last, "not every tetrahedron of the body has a force field; add one");
    mesh_.mesh.regions = std::move(regions);
    mesh_.names.clear();
  }

  template <class Corners>
  static std::array<Index, 4> sorted_corners(const Corners& corners) {
    std::array<Index, 4> sorted{static_cast<Index>(corners[0]), static_cast<Index>(corners[1]),
                                static_cast<Index>(corners[2]), static_cast<Index>(corners[3])};
    std::ranges::sort(sorted);
    return sorted;
  }

  void fix(const XmlPart& part) {
    if (is_link(part.tag.attribute("indices"))) return fix_box(sofa_linked(file_, part, "indices"));
    MeshText indices = file_.values(part, part.tag.attribute("indices"));
    while (!indices.at_end()) {
      const std::int64_t index = indices.integer("an index");
      if (index < 0 || index >= mesh_.mesh.point_count())
        file_.fail(part, std::string(part.type) + " fixes point " + std::to_string(index) +
                             ", but there are " + std::to_string(mesh_.mesh.point_count()) +
                             ", counted from 0; correct it");
      fixed_.insert(static_cast<Index>(index));
    }
  }

  /// All points in boxes, their sides included.
  void fix_box(const XmlPart& roi) {
    if (roi.type != "BoxROI")
      file_.fail(roi, "points are fixed by " + in_quotes(roi.type) +
                          ", and only BoxROI is read; write their indices out");
    const std::vector<double> boxes = file_.numbers(roi, "box");
    if (boxes.empty() || boxes.size() % 6 != 0)
      file_.fail(roi, "box has " + std::to_string(boxes.size()) +
                          " numbers, which are not six of each box; correct it");
    for (std::size_t b = 0; b < boxes.size(); b += 6) {
      const Eigen::Map<const Eigen::Vector3d> one(&boxes[b]), other(&boxes[b + 3]);
      for (Index i = 0; i < mesh_.mesh.point_count(); ++i)
        if ((mesh_.mesh.points.col(i).array() >= one.cwiseMin(other).array()).all() &&
            (mesh_.mesh.points.col(i).array() <= one.cwiseMax(other).array()).all())
          fixed_.insert(i);
    }
  }

  const XmlFile& file_;
  const XmlPart& state_;
  const SofaStates states_{file_};
  const std::string remedy_ = "grids are not read, so write the tetrahedra out or load them from a file";
  MeshFile mesh_;
  std::set<Index> fixed_;
};

}  // namespace

const XmlPart& sofa_state(const XmlFile& file) {
  const auto found = std::ranges::find(file.parts(), "MechanicalObject", &XmlPart::type);
  if (found == file.parts().end())
    file.fail(file.parts().front(), "the scene has no MechanicalObject and so no body; add one");
  return *found;
}

SofaStates::SofaStates(const XmlFile& file) : in_(file.parts().size(), nullptr) {
  for (const XmlPart& part : file.parts())
    if (part.type == "MechanicalObject" && part.node && !in_[*part.node]) in_[*part.node] = &part;
  // Nodes stand behind those that they are in.
  for (std::size_t i = 0; i < in_.size(); ++i)
    if (const auto node = file.parts()[i].node; node && !in_[i]) in_[i] = in_[*node];
}

bool is_sofa_field(std::string_view type) {
  return type.ends_with("FEMForceField") || type.ends_with("CorotationalForceField");
}

namespace {

/// A component or a node with this name in a node.
const XmlPart* named_in(const XmlFile& file, const XmlPart& node, std::string_view name) {
  const std::vector<const XmlPart*> parts = file.within(node);
  const auto found = std::ranges::find(parts, name, &XmlPart::name);
  return found == parts.end() ? nullptr : *found;
}

/// @param path  without "@" and the name of a value
const XmlPart* at_path(const XmlFile& file, const XmlPart& part, std::string_view path) {
  const bool is_based = path.starts_with('/') || path.starts_with('.');
  const XmlPart* from = path.starts_with('/') ? &file.parts().front() : file.parent(part);
  for (; from; from = is_based ? nullptr : file.parent(*from)) {
    const XmlPart* at = from;
    for (const std::string_view step : split(path, "/"))
      if (at && !step.empty() && step != ".")
        at = step == ".." ? file.parent(*at) : named_in(file, *at, step);
    if (at && at != from) return at;
  }
  return nullptr;
}

}  // namespace

const XmlPart& sofa_linked(const XmlFile& file, const XmlPart& part, std::string_view attribute) {
  std::string_view path = part.tag.attribute(attribute);
  path.remove_prefix(std::min<std::size_t>(1, path.size()));
  const std::size_t last = path.rfind('/') == std::string_view::npos ? 0 : path.rfind('/') + 1;
  if (const std::size_t dot = path.find('.', last);
      dot != std::string_view::npos && path.substr(last) != "." && path.substr(last) != "..")
    path = path.substr(0, dot);
  const XmlPart* const found = at_path(file, part, path);
  if (!found)
    file.fail(part, std::string(attribute) + " of " + std::string(part.type) + " is " +
                        in_quotes(part.tag.attribute(attribute)) +
                        ", and no component has this name there; correct it");
  return *found;
}

std::vector<double> sorted_moduli(std::vector<double> values) {
  sort_unique(values);
  return values;
}

MeshFile sofa_mesh(const XmlFile& file) { return SofaMeshReader(file).read(); }

MeshFile read_sofa(const std::string& name, std::string_view text) {
  return sofa_mesh(XmlFile(name, text, sofa_root));
}

}  // namespace hmax
