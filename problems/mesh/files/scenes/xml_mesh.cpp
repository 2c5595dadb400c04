/// Meshes whose points and tetrahedra are lists of numbers in attributes.
#include <array>
#include <cstdint>

#include "problems/mesh/files/mesh_file.hpp"
#include "problems/mesh/files/mesh_readers.hpp"
#include "problems/mesh/files/scenes/xml_file.hpp"

namespace hmax {

MeshFile listed_mesh(const XmlFile& file, const XmlList& points, const XmlList& corners,
                     const std::string& format) {
  const std::vector<double> x = file.numbers(points.part, points.attribute);
  if (x.empty() || x.size() % 3 != 0)
    file.fail(points.part, std::string(points.attribute) + " has " + std::to_string(x.size()) +
                               " numbers, which are not three of each point; correct it");
  MeshBuilder builder;
  for (std::size_t i = 0; i < x.size(); i += 3) builder.add_point(x[i], x[i + 1], x[i + 2]);
  const MeshText at = file.at(corners.part);
  MeshText numbers = file.values(corners.part, corners.part.tag.attribute(corners.attribute));
  for (std::int64_t t = 0; !numbers.at_end(); ++t) {
    std::array<TetMesh::Index, 4> four{};
    for (TetMesh::Index& corner : four) corner = builder.counted_point(numbers.integer("a corner"), at, t);
    builder.add_tetrahedron(four, t, corners.part.place, 0, at);
  }
  return builder.finish(at, format);
}

}  // namespace hmax
