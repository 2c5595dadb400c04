/// Gmsh .msh 4.0 and 4.1 [geuzaine2009gmsh].
#include <map>
#include <set>

#include "problems/mesh/files/gmsh_fields.hpp"
#include "problems/mesh/files/mesh_file.hpp"
#include "problems/mesh/files/mesh_readers.hpp"

namespace hmax {

namespace {

/// The physical groups of each entity, by its dimension and tag.
using EntityGroups = std::map<std::pair<std::int64_t, std::int64_t>, std::vector<std::int64_t>>;

/// Reads the sections of 4.0 and 4.1. In 4.0 numbers of nodes and elements have four bytes, points a box, the
/// tag of an entity stands before its dimension, and the number of a node beside its coordinates.
class Gmsh4Reader {
 public:
  Gmsh4Reader(GmshFields fields, std::string_view version) : fields_(fields), version_(version) {}

  MeshFile read() {
    MeshText& text = fields_.text;
    while (!text.at_end()) {
      const std::string section = gmsh_section(text);
      bool known = true;
      if (section == "$PhysicalNames")
        read_physical_names(text, builder_);
      else if (section == "$Entities")
        read_entities(false);
      else if (section == "$PartitionedEntities")
        read_partitioned_entities();
      else if (section == "$Nodes")
        read_nodes();
      else if (section == "$Elements")
        read_elements();
      else
        known = false;
      if (section == "$PhysicalNames")
        require_closing(text, section);
      else if (known)
        close_numbers(fields_, section);
      else
        text.skip_behind("$End" + section.substr(1));
    }
    return builder_.finish(text, "Gmsh " + std::string(version_) + (fields_.binary ? ", binary" : ""));
  }

 private:
  [[nodiscard]] bool old() const { return version_ == "4.0"; }

  /// The number of a node or an element.
  std::int64_t number(const char* what) { return old() ? fields_.integer(what) : fields_.large(what); }

  void read_entities(bool partitioned) {
    std::array<std::size_t, 4> counts{};
    tags_.clear();
    fields_.begin_row();
    for (std::size_t& count : counts) count = fields_.count("entities", 2, 8);
    fields_.end_row("the counts of entities");
    for (int dimension = 0; dimension < 4; ++dimension)
      for (std::size_t i = 0; i < counts[static_cast<std::size_t>(dimension)]; ++i)
        read_entity(dimension, partitioned);
  }

  void read_entity(int dimension, bool partitioned) {
    fields_.begin_row();
    const std::int64_t tag = fields_.integer("the tag of an entity");
    if (!tags_.emplace(dimension, tag).second)
      fields_.text.fail("entity " + std::to_string(tag) + " is given twice; export the mesh again");
    if (partitioned) {
      fields_.integer("the dimension of the whole entity");
      fields_.integer("the tag of the whole entity");
      const std::size_t partitions = fields_.count("partitions", 1, 8);
      for (std::size_t k = 0; k < partitions; ++k) fields_.integer("a partition");
    }
    // A point of 4.1 has a place, all others a box and a boundary.
    for (int k = 0; k < (dimension == 0 && !old() ? 3 : 6); ++k) fields_.skip_real("the extent of an entity");
    const std::size_t physical = fields_.count("physical groups", 1, 8);
    for (std::size_t k = 0; k < physical; ++k) {
      const std::int64_t group = fields_.integer("a physical group");
      groups_[{dimension, tag}].push_back(group);
    }
    const std::size_t boundary = dimension == 0 ? 0 : fields_.count("parts of a boundary", 1, 8);
    for (std::size_t k = 0; k < boundary; ++k) fields_.integer("a part of a boundary");
    fields_.end_row("an entity");
  }

  /// The parts of entities, to which the elements of a partitioned mesh belong, with the groups of the whole.
  void read_partitioned_entities() {
    fields_.begin_row();
    fields_.count("partitions", 1, 8);
    fields_.end_row("the number of partitions");
    fields_.begin_row();
    const std::size_t ghosts = fields_.count("ghost entities", 1, 8);
    fields_.end_row("the number of ghost entities");
    for (std::size_t i = 0; i < ghosts; ++i) {
      fields_.begin_row();
      fields_.integer("the tag of a ghost entity");
      fields_.integer("a partition");
      fields_.end_row("a ghost entity");
    }
    read_entities(true);
  }

  /// Dimension and tag, in the order of the version.
  std::pair<std::int64_t, std::int64_t> entity() {
    const std::int64_t first = fields_.integer("the dimension or tag of an entity");
    const std::int64_t second = fields_.integer("the tag or dimension of an entity");
    return old() ? std::pair(second, first) : std::pair(first, second);
  }

  /// The counts at the beginning of nodes and elements.
  std::pair<std::size_t, std::size_t> counts(const char* blocks, const char* all, std::size_t numbers) {
    fields_.begin_row();
    const std::size_t count = fields_.count(blocks, 4, 8), total = fields_.count(all, numbers, 8);
    if (!old())
      for (const char* what : {"the smallest number", "the largest number"}) fields_.large(what);
    fields_.end_row("the counts of a section");
    return {count, total};
  }

  void read_nodes() {
    const auto [blocks, total] = counts("blocks of nodes", "nodes", 3);
    builder_.reserve_points(total);
    for (std::size_t block = 0; block < blocks; ++block) {
      fields_.begin_row();
      const std::int64_t dimension = entity().first;
      const std::int64_t parametric = fields_.integer("whether nodes have parameters");
      if (dimension < 0 || dimension > 3 || (parametric != 0 && parametric != 1))
        fields_.text.fail("a block of nodes has a wrong head; export the mesh again");
      const std::size_t count = fields_.count("nodes of a block", 3, 8);
      fields_.end_row("the head of a block");
      read_block_of_nodes(count, parametric * dimension);
    }
    if (builder_.point_count() != total)
      fields_.text.fail("the blocks hold " + std::to_string(builder_.point_count()) + " nodes instead of " +
                        std::to_string(total) + "; export the mesh again");
    builder_.number_points(fields_.text);
  }

  void read_block_of_nodes(std::size_t count, std::int64_t parameters) {
    std::vector<std::int64_t> numbers;
    for (std::size_t i = 0; i < count && !old(); ++i) {
      fields_.begin_row();
      numbers.push_back(fields_.large("the number of a node"));
      fields_.end_row("the number of a node");
    }
    for (std::size_t i = 0; i < count; ++i) {
      fields_.begin_row();
      const std::int64_t its = old() ? fields_.integer("the number of a node") : numbers[i];
      const double x = fields_.real("the x coordinate"), y = fields_.real("the y coordinate");
      builder_.add_point(its, x, y, fields_.real("the z coordinate"));
      for (std::int64_t k = 0; k < parameters; ++k) fields_.skip_real("a parameter of a node");
      fields_.end_row("a node");
    }
  }

  void read_elements() {
    const auto [blocks, total] = counts("blocks of elements", "elements", 2);
    std::size_t elements = 0;
    for (std::size_t block = 0; block < blocks; ++block) {
      fields_.begin_row();
      const auto its = entity();
      const std::int64_t type = fields_.integer("the type of elements");
      const GmshType known = gmsh_type(type);
      const std::size_t count = fields_.count("elements of a block", (known.nodes + 1) / (old() ? 2 : 1), 8);
      fields_.end_row("the head of a block");
      elements += count;
      if (known.kind == CellKind::tetrahedron) builder_.reserve_tetrahedra(count);
      const auto found = groups_.find(its);
      const std::span<const std::int64_t> groups =
          found == groups_.end() ? std::span<const std::int64_t>() : found->second;
      for (std::size_t i = 0; i < count; ++i) {
        fields_.begin_row();
        const std::int64_t place = fields_.text.place();
        const std::int64_t element = number("the number of an element");
        require_readable(known.kind, type, element, fields_.text);
        add_gmsh_element(builder_, known, element, place, groups, fields_.text,
                         [&] { return number("a node of an element"); });
        fields_.end_row("an element");
      }
    }
    if (elements != total)
      fields_.text.fail("the blocks hold " + std::to_string(elements) + " elements instead of " +
                        std::to_string(total) + "; export the mesh again");
  }

  GmshFields fields_;
  std::string_view version_;
  MeshBuilder builder_;
  EntityGroups groups_;
  std::set<std::pair<std::int64_t, std::int64_t>> tags_;  ///< of the entities of a section, by dimension
};

}  // namespace

MeshFile read_gmsh_4(MeshText& text, bool binary, bool swapped, std::string_view version) {
  return Gmsh4Reader(GmshFields{text, binary, swapped}, version).read();
}

}  // namespace hmax
