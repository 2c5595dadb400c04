/// The mesh of an input file of FEBio: Nodes, Elements of types tet4 and tet10, NodeSets, and what conditions
/// hold.
#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <span>

#include "problems/mesh/files/mesh_readers.hpp"
#include "problems/mesh/files/scenes/febio_file.hpp"

namespace hmax {

namespace {

using Index = TetMesh::Index;

constexpr std::string_view of_surface = "@surface:";

class FebioMeshReader {
 public:
  explicit FebioMeshReader(const XmlFile& file) : file_(file), root_(file.parts().front()) {}

  MeshFile read() {
    if (root_.tag.attribute("version") != "4.0")
      file_.fail(root_, "the file has format " + in_quotes(root_.tag.attribute("version")) +
                            ", and 4.0 is read; export it again");
    each("node", "Nodes", [&](const XmlPart& node) {
      const std::vector<double> x = file_.numbers(node);
      if (x.size() != 3)
        file_.fail(node, "a node has " + std::to_string(x.size()) + " coordinates; correct it");
      builder_.add_point(number(node), x[0], x[1], x[2]);
    });
    builder_.number_points(file_.at(root_));
    each("Elements", "Mesh", [&](const XmlPart& elements) {
      if (const std::string_view type = elements.tag.attribute("type"); type != "tet4" && type != "tet10")
        file_.fail(elements, "the elements are of type " + in_quotes(type) +
                                 ", and only tet4 and tet10 are read; mesh the body with tetrahedra");
      builder_.name_group(3, ++region_, std::string(elements.name()), file_.at(elements));
      read_elements(elements);
    });
    each("NodeSet", "Mesh", [&](const XmlPart& set) { read_set(set); });
    for (const XmlPart& part : file_.parts())
      if (const std::string_view set = part.tag.attribute("node_set"); set.starts_with(of_surface))
        set_surface(part, set.substr(of_surface.size()));
    hold();
    std::int64_t group = 0;
    for (const auto& [name, points] : sets_) {
      builder_.name_group(0, ++group, name, file_.at(root_));
      for (const Index point : points) builder_.add_to_group(group, std::array{point});
    }
    MeshFile mesh = builder_.finish(file_.at(root_), "FEBio");
    mesh.material = file_.place_of_first([](const XmlPart& part) { return part.type == "material"; });
    return mesh;
  }

 private:
  template <class Read>
  void each(std::string_view type, std::string_view parent, Read read) {
    for (const XmlPart& part : file_.parts())
      if (part.type == type && file_.parent(part) && file_.parent(part)->type == parent) read(part);
  }

  std::int64_t number(const XmlPart& part) const {
    return file_.values(part, part.tag.attribute("id")).integer("an id");
  }

  Index point(std::int64_t number, const XmlPart& part) const {
    return builder_.numbered_point(number, file_.at(part), part.place, "line");
  }

  /// The points that a part names.
  std::vector<Index> points(const XmlPart& part) const {
    std::string list = part.text;
    std::ranges::replace(list, ',', ' ');
    std::vector<Index> found;
    for (MeshText rest = file_.values(part, list); !rest.at_end();)
      found.push_back(point(rest.integer("the number of a node"), part));
    return found;
  }

  void read_elements(const XmlPart& elements) {
    const std::size_t count = elements.tag.attribute("type") == "tet10" ? 10 : 4;
    for (const XmlPart* part : file_.all(elements, "elem")) {
      const XmlPart& element = *part;
      const std::vector<Index> corners = points(element);
      if (corners.size() != count)
        file_.fail(element, "an element has " + std::to_string(corners.size()) + " nodes; correct it");
      builder_.add_tetrahedron({corners[0], corners[1], corners[2], corners[3]}, number(element),
                               element.place, region_, file_.at(element));
      if (count == 10) builder_.add_middles(std::span(corners).last<6>(), middles_of_vtk);
    }
  }

  /// A list of numbers, or a part with an id for each.
  void read_set(const XmlPart& set) {
    std::vector<Index>& members = sets_[std::string(set.name())];
    members = points(set);
    for (const XmlPart* part : file_.within(set)) members.push_back(point(number(*part), *part));
  }

  /// The points of a Surface as the set that conditions and loads call by "@surface:NAME".
  void set_surface(const XmlPart& user, std::string_view name) {
    const auto surface = std::ranges::find_if(
        file_.parts(), [&](const XmlPart& part) { return part.type == "Surface" && part.name() == name; });
    if (surface == file_.parts().end())
      file_.fail(user, "there is no Surface " + in_quotes(name) + "; define it, or correct the name");
    std::set<Index> members;
    for (const XmlPart* facet : file_.within(*surface)) {
      const std::vector<Index> corners = points(*facet);
      members.insert(corners.begin(), corners.end());
    }
    sets_[std::string(of_surface) + std::string(name)].assign(members.begin(), members.end());
  }

  /// Conditions that are not understood may have no set, and hold nothing here.
  void hold() {
    std::vector<unsigned> held(builder_.point_count(), 0);
    each("bc", "Boundary", [&](const XmlPart& condition) {
      unsigned bits = condition.tag.attribute("type") == "zero displacement" ? 0 : 8;
      for (const XmlPart* part : bits == 8 ? std::vector<const XmlPart*>() : file_.within(condition)) {
        const auto direction = std::string_view("x_dof y_dof z_dof ").find(std::string(part->type) + " ");
        const std::vector<double> on = file_.numbers(*part);
        if (direction == std::string_view::npos || on.size() != 1 || (on[0] != 0 && on[0] != 1))
          file_.fail(*part, in_quotes(part->type) + " of a condition is not understood; remove it");
        if (on[0] == 1) bits |= 1U << (direction / 6);
      }
      if (bits == 8 && !condition.has("node_set")) return;
      const auto set = sets_.find(std::string(condition.tag.attribute("node_set")));
      if (set == sets_.end())
        file_.fail(condition, "there is no NodeSet " + in_quotes(condition.tag.attribute("node_set")) +
                                  "; define it, or correct the name");
      for (const Index point : set->second) held[static_cast<std::size_t>(point)] |= bits;
    });
    for (std::size_t i = 0; i < held.size(); ++i) {
      if ((held[i] & 7) == 7) sets_[std::string(febio_held)].push_back(static_cast<Index>(i));
      if (held[i] != 0 && held[i] != 7)
        sets_[std::string(febio_otherwise_held)].push_back(static_cast<Index>(i));
    }
  }

  const XmlFile& file_;
  const XmlPart& root_;
  MeshBuilder builder_;
  std::int64_t region_ = 0;
  std::map<std::string, std::vector<Index>> sets_;
};

}  // namespace

MeshFile febio_mesh(const XmlFile& file) { return FebioMeshReader(file).read(); }

MeshFile read_febio(const std::string& name, std::string_view text) {
  return febio_mesh(XmlFile(name, text, febio_root));
}

}  // namespace hmax
