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

/// Sections of volumes that are no tetrahedra, with what some programs call them.
constexpr std::array<std::string_view, 4> other_volumes{"Hexahedra", "Hexaedra", "Prisms", "Pyramids"};

/// Sections of numbers without a count before them.
constexpr std::array<std::string_view, 3> uncounted{"AngleOfCornerBound", "BoundingBox", "Time"};

/// True for what begins a section, and not for a value that is no number, such as nan: sections that are
/// read, in letters of any case, and all others as the format writes them.
bool is_head(std::string_view word) {
  const auto is = [&](std::string_view name) { return same_keyword(word, name); };
  if (is("End") || is("Vertices") || std::ranges::any_of(other_volumes, is) ||
      std::ranges::any_of(sections, is, &MeditSection::name))
    return true;
  return word.size() > 3 && word.front() >= 'A' && word.front() <= 'Z' &&
         !same_keyword(word.substr(0, 3), "inf");
}

/// Goes beyond a section that nobody needs. Its rows must be as many as it says: otherwise it has swallowed
/// the rows of a section whose head is lost.
void skip_section(MeshText& text, const std::string& section) {
  const bool counted =
      std::ranges::none_of(uncounted, [&](std::string_view name) { return same_keyword(name, section); });
  const std::size_t rows = counted ? text.count("entries", 1) : 0;
  std::size_t numbers = 0;
  for (; !text.at_end() && !is_head(text.peek()); ++numbers) text.word("");
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
    std::array<TetMesh::Index, 6> middles{};
    for (std::size_t k = 0; k < section.points; ++k) {
      const TetMesh::Index vertex = builder.counted_point(text.integer("a corner of an element"), text,
                                                          number, tetrahedra ? "tetrahedron" : "element");
      if (k < corner_count(section.kind))
        corners[k] = vertex;
      else
        middles[k - corner_count(section.kind)] = vertex;
    }
    const std::int64_t reference = text.label("the reference of an element");
    if (tetrahedra)
      builder.add_tetrahedron(corners, number, place, reference, text);
    else
      builder.add_to_group(reference, std::span(corners).first(corner_count(section.kind)));
    if (tetrahedra && section.points > 4) builder.add_middles(middles, middles_of_vtk);
  }
}

}  // namespace

MeshFile read_medit(const std::string& name, std::string_view bytes) {
  MeshText text(name, bytes, '#');
  if (!lower(text.peek()).starts_with("meshversion"))
    text.fail("a Medit file begins with MeshVersionFormatted and not with " + in_quotes(text.peek()) +
              "; export the mesh again as ASCII (.mesh) or correct the extension");
  text.word("");
  text.number("the version of the format");
  MeshBuilder builder(1);
  bool has_vertices = false, ended = false;
  std::vector<std::pair<MeshText, const MeditSection*>> early;  // sections of elements before the vertices
  while (!ended && !text.at_end()) {
    const std::string section(text.word("a section"));
    if (!is_letter(section.front()))
      text.fail("a section such as Tetrahedra should be here and not " + in_quotes(section) +
                "; the count before is wrong, so export the mesh again");
    if (same_keyword(section, "End")) {
      ended = true;
    } else if (same_keyword(section, "Dimension")) {
      if (const std::int64_t dimension = text.integer("the dimension"); dimension != 3)
        text.fail("the dimension is " + std::to_string(dimension) + "; a body needs 3");
    } else if (same_keyword(section, "Vertices")) {
      if (has_vertices) text.fail("there are two sections Vertices; export the mesh again");
      has_vertices = true;
      const std::size_t count = text.count("vertices", 8);
      builder.reserve_points(count);
      for (std::size_t i = 0; i < count; ++i) {
        const double x = text.number("the x coordinate"), y = text.number("the y coordinate");
        builder.add_point(x, y, text.number("the z coordinate"));
        const std::array vertex{static_cast<TetMesh::Index>(i)};
        builder.add_to_group(text.label("the reference of a vertex"), vertex);
      }
    } else if (const auto* const known = std::ranges::find_if(
                   sections, [&](const MeditSection& each) { return same_keyword(each.name, section); });
               known != sections.end()) {
      if (has_vertices) {
        read_elements(text, builder, *known);
      } else {
        early.emplace_back(text, known);
        skip_section(text, section);
      }
    } else if (std::ranges::any_of(other_volumes,
                                   [&](std::string_view other) { return same_keyword(other, section); })) {
      if (text.count("volumes", 2) > 0)
        text.fail("the file holds " + section + "; mesh the body with tetrahedra only");
    } else {
      skip_section(text, section);
    }
  }
  // Not all programs write End: what is there must then be whole, down to its last word.
  if (!ended) text.require_end();
  if (!text.at_end())
    text.fail("the file goes on with " + in_quotes(text.peek()) + " behind End; export the mesh again");
  for (auto& [elements, section] : early) read_elements(elements, builder, *section);
  return builder.finish(text, "Medit");
}

}  // namespace hmax
