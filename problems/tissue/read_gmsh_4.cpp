/// Gmsh .msh 4.1 [geuzaine2009gmsh].
#include <map>

#include "problems/tissue/gmsh_fields.hpp"
#include "problems/tissue/mesh_readers.hpp"

namespace hmax {

namespace {

/// The physical groups of each entity, by its dimension and tag.
using EntityGroups = std::map<std::pair<std::int64_t, std::int64_t>, std::vector<std::int64_t>>;

EntityGroups read_entities(GmshFields& fields) {
  EntityGroups groups;
  std::array<std::size_t, 4> counts{};
  for (std::size_t& count : counts) count = fields.count("entities", 2, 8);
  for (int dimension = 0; dimension < 4; ++dimension)
    for (std::size_t i = 0; i < counts[static_cast<std::size_t>(dimension)]; ++i) {
      const std::int64_t tag = fields.integer("the tag of an entity");
      // A point has a place, the others a box and a boundary.
      for (int k = 0; k < (dimension == 0 ? 3 : 6); ++k) fields.real("the extent of an entity");
      const std::size_t physical = fields.count("physical groups", 1, 8);
      for (std::size_t k = 0; k < physical; ++k) {
        const std::int64_t group = fields.integer("a physical group");
        groups[{dimension, tag}].push_back(group);
      }
      if (dimension == 0) continue;
      const std::size_t boundary = fields.count("parts of a boundary", 1, 8);
      for (std::size_t k = 0; k < boundary; ++k) fields.integer("a part of a boundary");
    }
  return groups;
}

void read_nodes(GmshFields& fields, MeshBuilder& builder) {
  const std::size_t blocks = fields.count("blocks of nodes", 4, 8);
  const std::size_t total = fields.count("nodes", 4, 8);
  builder.reserve_points(total);
  for (const char* what : {"the smallest node", "the largest node"}) fields.large(what);
  std::vector<std::int64_t> numbers;
  for (std::size_t block = 0; block < blocks; ++block) {
    const std::int64_t dimension = fields.integer("the dimension of an entity");
    fields.integer("the tag of an entity");
    const std::int64_t parametric = fields.integer("whether nodes have parameters");
    if (dimension < 0 || dimension > 3 || (parametric != 0 && parametric != 1))
      fields.text.fail("a block of nodes has a wrong head; export the mesh again");
    const std::size_t count = fields.count("nodes of a block", 4, 8);
    numbers.clear();
    for (std::size_t i = 0; i < count; ++i) numbers.push_back(fields.large("the number of a node"));
    for (const std::int64_t number : numbers) {
      const double x = fields.real("the x coordinate"), y = fields.real("the y coordinate");
      builder.add_point(number, x, y, fields.real("the z coordinate"));
      for (std::int64_t k = 0; k < parametric * dimension; ++k) fields.real("a parameter of a node");
    }
  }
  if (builder.point_count() != total)
    fields.text.fail("the blocks hold " + std::to_string(builder.point_count()) + " nodes instead of " +
                     std::to_string(total) + "; export the mesh again");
  builder.number_points(fields.text);
}

void read_elements(GmshFields& fields, const EntityGroups& entities, MeshBuilder& builder) {
  const std::size_t blocks = fields.count("blocks of elements", 4, 8);
  fields.count("elements", 2, 8);
  for (const char* what : {"the smallest element", "the largest element"}) fields.large(what);
  for (std::size_t block = 0; block < blocks; ++block) {
    const std::int64_t dimension = fields.integer("the dimension of an entity");
    const std::int64_t tag = fields.integer("the tag of an entity");
    const std::int64_t type = fields.integer("the type of elements");
    const GmshType known = gmsh_type(type);
    const std::size_t count = fields.count("elements of a block", known.nodes + 1, 8);
    if (known.kind == CellKind::tetrahedron) builder.reserve_tetrahedra(count);
    const auto entity = entities.find({dimension, tag});
    const std::span<const std::int64_t> groups =
        entity == entities.end() ? std::span<const std::int64_t>() : entity->second;
    for (std::size_t i = 0; i < count; ++i) {
      const std::int64_t place = fields.text.place();
      const std::int64_t number = fields.large("the number of an element");
      require_readable(known.kind, type, number, fields.text);
      add_gmsh_element(builder, known, number, place, groups, fields.text,
                       [&] { return fields.large("a node of an element"); });
    }
  }
}

}  // namespace

MeshFile read_gmsh_4(MeshText& text, bool binary, bool swapped) {
  MeshBuilder builder;
  GmshFields fields{text, binary, swapped};
  EntityGroups groups;
  while (!text.at_end()) {
    const std::string section(text.word("a section"));
    if (!section.starts_with("$"))
      text.fail("a section such as $Nodes should be here and not " + in_quotes(section) +
                "; export the mesh again");
    text.line();
    if (section == "$PhysicalNames") read_physical_names(text, builder);
    if (section == "$Entities") groups = read_entities(fields);
    if (section == "$Nodes") read_nodes(fields, builder);
    if (section == "$Elements") read_elements(fields, groups, builder);
    const std::string closing = "$End" + section.substr(1);
    const bool read = section == "$PhysicalNames" || section == "$Entities" || section == "$Nodes" ||
                      section == "$Elements";
    if (read && text.peek() != closing)
      text.fail(closing + " should be here and not " + in_quotes(text.peek()) +
                "; a count in the section is wrong or the file is cut off, so export it again");
    text.skip_behind(closing);
  }
  return builder.finish(text, binary ? "Gmsh 4.1, binary" : "Gmsh 4.1");
}

}  // namespace hmax
