/// Medit .mesh [frey2001medit], which also GHS3D writes.
#include "problems/tissue/mesh_readers.hpp"

namespace hmax {

namespace {

bool is_letter(char c) { return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z'); }

}  // namespace

MeshFile read_medit(const std::string& name, std::string_view bytes) {
  MeshText text(name, bytes, '#');
  if (!text.peek().starts_with("MeshVersion"))
    text.fail("a Medit file begins with MeshVersionFormatted and not with " + in_quotes(text.peek()) +
              "; export the mesh again as ASCII (.mesh) or correct the extension");
  text.word("");
  text.integer("the version of the format");
  MeshBuilder builder;
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
        text.number("the reference of a vertex");
      }
    } else if (section == "Tetrahedra") {
      const std::size_t count = text.count("tetrahedra", 10);
      builder.reserve_tetrahedra(count);
      for (std::size_t i = 0; i < count; ++i) {
        const auto number = static_cast<std::int64_t>(builder.tetrahedron_count()) + 1;
        std::array<TetMesh::Index, 4> corners{};
        const std::int64_t place = text.place();
        for (TetMesh::Index& corner : corners) {
          const std::int64_t vertex = text.integer("a corner of a tetrahedron");
          corner = builder.counted_point(vertex, 1, text, number);
        }
        builder.add_tetrahedron(corners, number, place, text.integer("the reference of a tetrahedron"), text);
      }
    } else if (section == "Hexahedra" || section == "Prisms" || section == "Pyramids" ||
               section == "Hexaedra" || section == "TetrahedraP2") {
      if (text.count("volumes", 2) > 0)
        text.fail("the file holds " + section + "; mesh the body with tetrahedra of order 1 only");
    } else {
      if (section == "Triangles") builder.add_triangles(text.count("triangles", 8));
      while (!text.at_end() && !is_letter(text.peek().front())) text.word("");
    }
  }
  if (!ended) text.fail("End is missing; the file is cut off, so copy or export it again");
  return builder.finish(text, "Medit");
}

}  // namespace hmax
