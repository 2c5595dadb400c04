/// The mesh of a scene of SOFA, with the points that it fixes.
#include <algorithm>
#include <array>
#include <filesystem>

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
    require_same_points();
    for (const XmlPart& part : file_.parts()) {
      if (part.node != state_.node) continue;
      if (part.type == "FixedConstraint" || part.type == "FixedProjectiveConstraint") fix(part);
      if (part.has("youngModulus")) set_regions(part);
    }
    if (fixed_.corners.empty()) return std::move(mesh_);
    std::ranges::sort(fixed_.corners);
    const auto doubled = std::ranges::unique(fixed_.corners);
    fixed_.corners.erase(doubled.begin(), doubled.end());
    const auto behind =
        std::ranges::find_if(mesh_.groups, [](const MeshGroup& group) { return group.dimension > 0; });
    if (behind != mesh_.groups.begin()) fixed_.number = std::prev(behind)->number + 1;
    mesh_.groups.insert(behind, std::move(fixed_));
    return std::move(mesh_);
  }

 private:
  /// The part that a link like "@../box.indices" names.
  const XmlPart& linked(const XmlPart& part, std::string_view attribute) const {
    std::string_view name = part.tag.attribute(attribute);
    name.remove_prefix(std::min(name.find_last_of("@/") + 1, name.size()));
    name = name.substr(0, name.find('.'));
    const auto found = std::ranges::find(file_.parts(), name, &XmlPart::name);
    if (name.empty() || found == file_.parts().end())
      file_.fail(part, std::string(attribute) + " of " + std::string(part.type) + " is " +
                           in_quotes(part.tag.attribute(attribute)) +
                           ", and no component has this name; correct it");
    return *found;
  }

  const XmlPart& find_topology() const {
    for (const XmlPart& part : file_.parts())
      if (part.node == state_.node &&
          (part.type == "TetrahedronSetTopologyContainer" || part.type == "MeshTopology"))
        return part;
    file_.fail(state_, "there is no TetrahedronSetTopologyContainer beside the MechanicalObject; " + remedy_);
  }

  /// The loader of a mesh file, also one that the topology itself is; null of one with its own numbers.
  const XmlPart* loader_of(const XmlPart& topology) const {
    if (topology.has("filename")) return &topology;
    for (const char* attribute : {"src", "tetrahedra"})
      if (is_link(topology.tag.attribute(attribute))) return &linked(topology, attribute);
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
    if (!std::filesystem::exists(path))
      file_.fail(loader, "there is no file " + in_quotes(path.string()) +
                             "; SOFA also looks into its own folders, so copy it there");
    return read_mesh_file(path);
  }

  MeshFile inline_mesh(const XmlPart& topology) const {
    if (!topology.has("tetrahedra"))
      file_.fail(topology, std::string(topology.type) + " has no tetrahedra; " + remedy_);
    MeshBuilder builder;
    const XmlPart& points =
        topology.has("position") && !is_link(topology.tag.attribute("position")) ? topology : state_;
    const std::vector<double> x = file_.numbers(points, "position");
    if (x.empty() || x.size() % 3 != 0)
      file_.fail(points, "position has " + std::to_string(x.size()) +
                             " numbers, which are not three of each point; correct it");
    for (std::size_t i = 0; i < x.size(); i += 3) builder.add_point(x[i], x[i + 1], x[i + 2]);
    MeshText corners = file_.values(topology, topology.tag.attribute("tetrahedra"));
    for (std::int64_t t = 0; !corners.at_end(); ++t) {
      std::array<Index, 4> four{};
      for (Index& corner : four)
        corner = builder.counted_point(corners.integer("a corner"), file_.at(topology), t);
      builder.add_tetrahedron(four, t, topology.place, 0, file_.at(topology));
    }
    return builder.finish(file_.at(topology), "SOFA");
  }

  /// Points of its own win over those of the topology, and strains are relative to them.
  void require_same_points() const {
    if (!state_.has("position") || is_link(state_.tag.attribute("position"))) return;
    const std::vector<double> own = file_.numbers(state_, "position");
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

  void fix(const XmlPart& part) {
    if (is_link(part.tag.attribute("indices"))) return fix_box(linked(part, "indices"));
    MeshText indices = file_.values(part, part.tag.attribute("indices"));
    while (!indices.at_end()) {
      const std::int64_t index = indices.integer("an index");
      if (index < 0 || index >= mesh_.mesh.point_count())
        file_.fail(part, std::string(part.type) + " fixes point " + std::to_string(index) +
                             ", but there are " + std::to_string(mesh_.mesh.point_count()) +
                             ", counted from 0; correct it");
      fixed_.corners.push_back(static_cast<Index>(index));
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
          fixed_.corners.push_back(i);
    }
  }

  const XmlFile& file_;
  const XmlPart& state_;
  const std::string remedy_ = "grids are not read, so write the tetrahedra out or load them from a file";
  MeshFile mesh_;
  MeshGroup fixed_{.dimension = 0, .number = 1, .name = std::string(fixed_points_of_sofa)};
};

}  // namespace

const XmlPart& sofa_state(const XmlFile& file) {
  const auto found = std::ranges::find(file.parts(), "MechanicalObject", &XmlPart::type);
  if (found == file.parts().end())
    file.fail(file.parts().front(), "the scene has no MechanicalObject and so no body; add one");
  return *found;
}

std::vector<double> sorted_moduli(std::vector<double> values) {
  std::ranges::sort(values);
  const auto doubled = std::ranges::unique(values);
  values.erase(doubled.begin(), doubled.end());
  return values;
}

MeshFile sofa_mesh(const XmlFile& file) { return SofaMeshReader(file).read(); }

MeshFile read_sofa(const std::string& name, std::string_view text) {
  return sofa_mesh(XmlFile(name, text, sofa_root));
}

}  // namespace hmax
