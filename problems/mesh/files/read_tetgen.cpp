/// TetGen's pair of .node and .ele [si2015tetgen]; both count from 0 or both from 1.
#include "problems/mesh/files/mesh_file.hpp"
#include "problems/mesh/files/mesh_readers.hpp"

namespace hmax {

namespace {

constexpr MiddleOrder middles_of_tetgen{{{2, 3}, {0, 3}, {0, 1}, {1, 2}, {1, 3}, {0, 2}}};

/// The numbers of a head: attributes and markers are 0 where it ends before them, and what follows is no
/// number of the mesh.
struct Counts {
  std::size_t attributes = 0, markers = 0;
};

Counts read_counts(MeshText& text, bool markers) {
  Counts counts;
  if (!text.peek().empty()) {
    counts.attributes = text.count("attributes", 1);
    if (markers) counts.markers = text.count("markers of points", 1);
  }
  text.skip_rest_of_line();
  return counts;
}

}  // namespace

MeshFile read_tetgen(const std::string& node_name, std::string_view node_text, const std::string& ele_name,
                     std::string_view ele_text) {
  MeshBuilder builder;
  MeshText nodes(node_name, node_text, '#');
  nodes.begin_line();
  const std::size_t points = nodes.count("points", 8);
  if (const std::int64_t dimension = nodes.integer("the dimension"); dimension != 3)
    nodes.fail("the points have " + std::to_string(dimension) + " coordinates; a body needs 3");
  const auto [attributes, markers] = read_counts(nodes, true);
  builder.reserve_points(points);
  ExtraColumns behind_points, behind_tetrahedra;
  for (std::size_t i = 0; i < points; ++i) {
    nodes.begin_line();
    const std::int64_t number = nodes.integer("the number of a point");
    const double x = nodes.number("the x coordinate"), y = nodes.number("the y coordinate");
    builder.add_point(number, x, y, nodes.number("the z coordinate"));
    for (std::size_t k = 0; k < attributes; ++k) nodes.word("an attribute of a point");
    for (std::size_t k = 0; k < markers; ++k) {
      const std::array point{static_cast<TetMesh::Index>(i)};
      builder.add_to_group(nodes.label("the marker of a point"), point);
    }
    behind_points.skip(nodes, "a point");
  }
  nodes.require_end();
  builder.number_points(nodes);

  MeshText elements(ele_name, ele_text, '#');
  elements.begin_line();
  const std::size_t tetrahedra = elements.count("tetrahedra", 10);
  const std::int64_t corners = elements.integer("the number of points of a tetrahedron");
  const std::size_t values = read_counts(elements, false).attributes;
  if (tetrahedra > 0 && corners != 4 && corners != 10)
    elements.fail("the tetrahedra have " + std::to_string(corners) +
                  " points instead of 4, or 10 of second order; export the mesh again");
  builder.reserve_tetrahedra(tetrahedra);
  for (std::size_t t = 0; t < tetrahedra; ++t) {
    elements.begin_line();
    const std::int64_t place = elements.place(), number = elements.integer("the number of a tetrahedron");
    std::array<TetMesh::Index, 4> points_of{};
    for (TetMesh::Index& point : points_of)
      point = builder.numbered_point(elements.integer("a point of a tetrahedron"), elements, number);
    std::array<TetMesh::Index, 6> middles{};
    if (corners > 4)
      for (TetMesh::Index& point : middles)
        point = builder.numbered_point(elements.integer("a point of a tetrahedron"), elements, number);
    const std::int64_t region = values > 0 ? elements.label("the region of a tetrahedron") : 0;
    for (std::size_t k = 1; k < values; ++k) elements.word("an attribute of a tetrahedron");
    behind_tetrahedra.skip(elements, "a tetrahedron");
    builder.add_tetrahedron(points_of, number, place, region, elements);
    if (corners > 4) builder.add_middles(middles, middles_of_tetgen);
  }
  elements.require_end();
  return builder.finish(elements, "TetGen");
}

}  // namespace hmax
