/// The fields of Gmsh files, alike in ASCII and binary; for the sources of the readers only.
#pragma once

#include <algorithm>
#include <cstdlib>

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

/// Reads what follows $PhysicalNames. Names are words in binary files too.
inline void read_physical_names(MeshText& text, MeshBuilder& builder) {
  const std::size_t count = text.count("physical names", 6);
  for (std::size_t i = 0; i < count; ++i) {
    const std::int64_t dimension = text.integer("the dimension of a physical group");
    const std::int64_t number = text.integer("the number of a physical group");
    builder.name_group(dimension, number, text.quoted("the name of a physical group"), text);
  }
}

/// Adds a tetrahedron, or what belongs to a physical group. @param node  reads the next node
template <class Node>
void add_gmsh_element(MeshBuilder& builder, const GmshType& type, std::int64_t number, std::int64_t place,
                      std::span<const std::int64_t> groups, const MeshText& text, Node node) {
  const bool tetrahedron = type.kind == CellKind::tetrahedron;
  const std::size_t count =
      tetrahedron || std::ranges::any_of(groups, [](std::int64_t group) { return group != 0; })
          ? corner_count(type.kind)
          : 0;
  std::array<TetMesh::Index, 4> corners{};
  for (std::size_t i = 0; i < type.nodes; ++i) {
    const std::int64_t point = node();
    if (i < count)
      corners[i] = builder.numbered_point(point, text, number, tetrahedron ? "tetrahedron" : "element");
  }
  if (type.kind == CellKind::triangle) builder.add_triangles(1);
  if (tetrahedron) {
    if (type.nodes > count) builder.add_second_order();
    return builder.add_tetrahedron(corners, number, place, groups.empty() ? 0 : groups.front(), text);
  }
  // The sign of a group of Gmsh is that of its orientation.
  if (count > 0)
    for (const std::int64_t group : groups)
      builder.add_to_group(std::abs(group), std::span(corners).first(count));
}

}  // namespace hmax
