/// The fields of Gmsh files, alike in ASCII and binary; for the sources of the readers only.
#pragma once

#include <algorithm>

#include "problems/tissue/mesh_readers.hpp"

namespace hmax {

/// Numbers one after the other, in words or raw.
struct GmshFields {
  MeshText& text;
  bool binary, swapped;

  std::int64_t integer(const char* what) {
    return binary ? text.raw<std::int32_t>(what, swapped) : text.integer(what);
  }
  /// What Gmsh 4 writes with eight bytes.
  std::int64_t large(const char* what) {
    return binary ? text.raw<std::int64_t>(what, swapped) : text.integer(what);
  }
  double real(const char* what) {
    if (!binary) return text.number(what);
    const double value = text.raw<double>(what, swapped);
    if (!(value - value == 0))
      text.fail(std::string(what) + " is not finite; correct it or export the mesh again");
    return value;
  }
  /// How many of something follow, each of `numbers` numbers of `bytes` bytes.
  std::size_t count(const char* what, std::size_t numbers, std::size_t bytes) {
    const std::int64_t value = bytes == 8 ? large(what) : integer(what);
    if (value < 0)
      text.fail("the file announces " + std::to_string(value) + " " + what + "; export the mesh again");
    text.require_room(static_cast<std::size_t>(value), what,
                      std::max<std::size_t>(1, numbers * (binary ? bytes : 2)));
    return static_cast<std::size_t>(value);
  }
};

struct GmshType {
  CellKind kind;
  std::size_t nodes;
};

GmshType gmsh_type(std::int64_t type);

/// Adds the element if it is a tetrahedron. @param node  reads the next of its nodes
template <class Node>
void add_gmsh_element(MeshBuilder& builder, const GmshType& type, std::int64_t number, std::int64_t place,
                      std::int64_t region, const MeshText& text, Node node) {
  if (type.kind != CellKind::tetrahedron) {
    for (std::size_t i = 0; i < type.nodes; ++i) node();
    if (type.kind == CellKind::triangle) builder.add_triangles(1);
    return;
  }
  std::array<TetMesh::Index, 4> corners{};
  for (TetMesh::Index& corner : corners) corner = builder.numbered_point(node(), text, number);
  builder.add_tetrahedron(corners, number, place, region, text);
}

}  // namespace hmax
