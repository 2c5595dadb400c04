/// Gmsh .msh 4.1 [geuzaine2009gmsh].
#include <map>

#include "problems/mesh/files/gmsh_fields.hpp"
#include "problems/mesh/files/mesh_file.hpp"
#include "problems/mesh/files/mesh_readers.hpp"

namespace hmax {

namespace {

/// The physical groups of each entity, by its dimension and tag.
using EntityGroups = std::map<std::pair<std::int64_t, std::int64_t>, std::vector<std::int64_t>>;

EntityGroups read_entities(GmshFields& fields) {
  EntityGroups groups;
  std::array<std::size_t, 4> counts{};
  fields.begin_row();
  for (std::size_t& count : counts) count = fields.count("entities", 2, 8);
  fields.end_row("the counts of entities");
  for (int dimension = 0; dimension < 4; ++dimension)
    for (std::size_t i = 0; i < counts[static_cast<std::size_t>(dimension)]; ++i) {
      fields.begin_row();
      const std::int64_t tag = fields.integer("the tag of an entity");
      // A point has a place, the others a box and a boundary.
      for (int k = 0; k < (dimension == 0 ? 3 : 6); ++k) fields.real("the extent of an entity");
      const std::size_t physical = fields.count("physical groups", 1, 8);
      for (std::size_t k = 0; k < physical; ++k) {
        const std::int64_t group = fields.integer("a physical group");
        groups[{dimension, tag}].push_back(group);
      }
      const std::size_t boundary = dimension == 0 ? 0 : fields.count("parts of a boundary", 1, 8);
      for (std::size_t k = 0; k < boundary; ++k) fields.integer("a part of a boundary");
      fields.end_row("an entity");
    }
  return groups;
}

void read_nodes(GmshFields& fields, MeshBuilder& builder) {
  fields.begin_row();
  const std::size_t blocks = fields.count("blocks of nodes", 4, 8);
  const std::size_t total = fields.count("nodes", 4, 8);
  builder.reserve_points(total);
  for (const char* what : {"the smallest node", "the largest node"}) fields.large(what);
  fields.end_row("the counts of nodes");
  std::vector<std::int64_t> numbers;
  for (std::size_t block = 0; block < blocks; ++block) {
    fields.begin_row();
    const std::int64_t dimension = fields.integer("the dimension of an entity");
    fields.integer("the tag of an entity");
    const std::int64_t parametric = fields.integer("whether nodes have parameters");
    if (dimension < 0 || dimension > 3 || (parametric != 0 && parametric != 1))
      fields.text.fail("a block of nodes has a wrong head; export the mesh again");
    const std::size_t count = fields.count("nodes of a block", 4, 8);
    fields.end_row("the head of a block");
    numbers.clear();
    for (std::size_t i = 0; i < count; ++i) {
      fields.begin_row();
      numbers.push_back(fields.large("the number of a node"));
      fields.end_row("the number of a node");
    }
    for (const std::int64_t number : numbers) {
      fields.begin_row();
      const double x = fields.real("the x coordinate"), y = fields.real("the y coordinate");
      builder.add_point(number, x, y, fields.real("the z coordinate"));
      for (std::int64_t k = 0; k < parametric * dimension; ++k) fields.real("a parameter of a node");
      fields.end_row("a node");
    }
  }
  if (builder.point_count() != total)
    fields.text.fail("the blocks hold " + std::to_string(builder.point_count()) + " nodes instead of " +
                     std::to_string(total) + "; export the mesh again");
  builder.number_points(fields.text);
}

void read_elements(GmshFields& fields, const EntityGroups& entities, MeshBuilder& builder) {
  fields.begin_row();
  const std::size_t blocks = fields.count("blocks of elements", 4, 8);
  const std::size_t total = fields.count("elements", 2, 8);
  for (const char* what : {"the smallest element", "the largest element"}) fields.large(what);
  fields.end_row("the counts of elements");
  std::size_t elements = 0;
  for (std::size_t block = 0; block < blocks; ++block) {
    fields.begin_row();
    const std::int64_t dimension = fields.integer("the dimension of an entity");
    const std::int64_t tag = fields.integer("the tag of an entity");
    const std::int64_t type = fields.integer("the type of elements");
    const GmshType known = gmsh_type(type);
    const std::size_t count = fields.count("elements of a block", known.nodes + 1, 8);
    fields.end_row("the head of a block");
    elements += count;
    if (known.kind == CellKind::tetrahedron) builder.reserve_tetrahedra(count);
    const auto entity = entities.find({dimension, tag});
    const std::span<const std::int64_t> groups =
        entity == entities.end() ? std::span<const std::int64_t>() : entity->second;
    for (std::size_t i = 0; i < count; ++i) {
      fields.begin_row();
      const std::int64_t place = fields.text.place();
      const std::int64_t number = fields.large("the number of an element");
      require_readable(known.kind, type, number, fields.text);
      add_gmsh_element(builder, known, number, place, groups, fields.text,
                       [&] { return fields.large("a node of an element"); });
      fields.end_row("an element");
    }
  }
  if (elements != total)
    fields.text.fail("the blocks hold " + std::to_string(elements) + " elements instead of " +
                     std::to_string(total) + "; export the mesh again");
}

}  // namespace

MeshFile read_gmsh_4(MeshText& text, bool binary, bool swapped) {
  MeshBuilder builder;
  GmshFields fields{text, binary, swapped};
  EntityGroups groups;
  while (!text.at_end()) {
    const std::string section = gmsh_section(text);
    if (section == "$PhysicalNames") read_physical_names(text, builder);
    if (section == "$Entities") groups = read_entities(fields);
    if (section == "$Nodes") read_nodes(fields, builder);
    if (section == "$Elements") read_elements(fields, groups, builder);
    if (section == "$PhysicalNames" || section == "$Entities" || section == "$Nodes" ||
        section == "$Elements")
      require_closing(text, section);
    else
      text.skip_behind("$End" + section.substr(1));
  }
  return builder.finish(text, binary ? "Gmsh 4.1, binary" : "Gmsh 4.1");
}

}  // namespace hmax
