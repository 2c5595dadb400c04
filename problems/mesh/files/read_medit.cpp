/// Medit .mesh [frey2001medit], which also GHS3D writes.
#include <algorithm>

#include "problems/mesh/files/mesh_file.hpp"
#include "problems/mesh/files/mesh_readers.hpp"

namespace hmax {

namespace {

bool is_letter(char c) { return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z'); }

/// A section of elements and how many points each of them has; of second order where they are more than the
/// corners.
struct MeditSection {
  std::string_view name;
  CellKind kind;
  std::size_t points;
};
constexpr std::array<MeditSection, 6> sections{{{"Tetrahedra", CellKind::tetrahedron, 4},
                                                {"TetrahedraP2", CellKind::tetrahedron, 10},
                                                {"Triangles", CellKind::triangle, 3},
                                                {"TrianglesP2", CellKind::triangle, 6},
                                                {"Edges", CellKind::line, 2},
                                                {"EdgesP2", CellKind::line, 3}}};

/// Sections of numbers without a count before them.
constexpr std::array<std::string_view, 3> uncounted{"AngleOfCornerBound", "BoundingBox", "Time"};

/// Goes beyond a section that nobody needs. Its rows must be as many as it says: otherwise it has swallowed
/// the rows of a section whose head is lost.
void skip_section(MeshText& text, const std::string& section) {
  const bool counted = std::ranges::find(uncounted, section) == uncounted.end();
  const std::size_t rows = counted ? text.count("entries", 1) : 0;
  std::size_t numbers = 0;
  for (; !text.at_end() && !is_letter(text.peek().front()); ++numbers) text.word("");
  if (counted && (rows == 0 ? numbers > 0 : numbers == 0 || numbers % rows != 0))
    text.fail("the section " + in_quotes(section) + " announces " + std::to_string(rows) +
              " entries and holds " + std::to_string(numbers) +
              " numbers; the file is damaged, so copy or export it again");
}

void read_elements(MeshText& text, MeshBuilder& builder, const MeditSection& section) {
  const bool tetrahedra = section.kind == CellKind::tetrahedron;
  const std::size_t count = text.count(tetrahedra ? "tetrahedra" : "elements", 2 * section.points + 2);
  if (tetrahedra) builder.reserve_tetrahedra(count);
  if (section.kind == CellKind::triangle) builder.add_triangles(count);
  for (std::size_t i = 0; i < count; ++i) {
    const auto number = static_cast<std::int64_t>(tetrahedra ? builder.tetrahedron_count() : i) + 1;
    const std::int64_t place = text.place();
    std::array<TetMesh::Index, 4> corners{};
    for (std::size_t k = 0; k < section.points; ++k) {
      const TetMesh::Index vertex = builder.counted_point(text.integer("a corner of an element"), text,
                                                          number, tetrahedra ? "tetrahedron" : "element");
      if (k < corner_count(section.kind)) corners[k] = vertex;
    }
    const std::int64_t reference = text.integer("the reference of an element");
    if (tetrahedra)
      builder.add_tetrahedron(corners, number, place, reference, text);
    else
      builder.add_to_group(reference, std::span(corners).first(corner_count(section.kind)));
    if (tetrahedra && section.points > 4) builder.add_second_order();
  }
}

}  // namespace

MeshFile read_medit(const std::string& name, std::string_view bytes) {
  MeshText text(name, bytes, '#');
  if (!text.peek().starts_with("MeshVersion"))
    text.fail("a Medit file begins with MeshVersionFormatted and not with " + in_quotes(text.peek()) +
              "; export the mesh again as ASCII (.mesh) or correct the extension");
  text.word("");
  text.integer("the version of the format");
  MeshBuilder builder(1);
  bool has_vertices = false, ended = false;
  while (!ended && !text.at_end()) {
    const std::string section(text.word("a section"));
    if (!is_letter(section.front()))
      text.fail("a section such as Tetrahedra should be here and not " + in_quotes(section) +
                "; the count before is wrong, so export the mesh again");
    if (section == "End") {
      ended = true;
    } else if (section == "Dimension") {
      if (const std::int64_t dimension = text.integer("the dimension"); dimension != 3)
        text.fail("the dimension is " + std::to_string(dimension) + "; a body needs 3");
    } else if (section == "Vertices") {
      if (has_vertices) text.fail("there are two sections Vertices; export the mesh again");
      has_vertices = true;
      const std::size_t count = text.count("vertices", 8);
      builder.reserve_points(count);
      for (std::size_t i = 0; i < count; ++i) {
        const double x = text.number("the x coordinate"), y = text.number("the y coordinate");
        builder.add_point(x, y, text.number("the z coordinate"));
        const std::array vertex{static_cast<TetMesh::Index>(i)};
        builder.add_to_group(text.integer("the reference of a vertex"), vertex);
      }
    } else if (const auto known = std::ranges::find(sections, section, &MeditSection::name);
               known != sections.end()) {
      read_elements(text, builder, *known);
    } else if (section == "Hexahedra" || section == "Prisms" || section == "Pyramids" ||
               section == "Hexaedra") {
      if (text.count("volumes", 2) > 0)
        text.fail("the file holds " + section + "; mesh the body with tetrahedra only");
    } else {
      skip_section(text, section);
    }
  }
  if (!ended) text.fail("End is missing; the file is cut off, so copy or export it again");
  if (!text.at_end())
    text.fail("the file goes on with " + in_quotes(text.peek()) + " behind End; export the mesh again");
  return builder.finish(text, "Medit");
}

}  // namespace hmax
