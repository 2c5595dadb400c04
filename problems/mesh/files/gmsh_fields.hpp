/// The fields of Gmsh files, alike in ASCII and binary; for the sources of the readers only.
#pragma once

#include <algorithm>
#include <cstdlib>

#include "problems/mesh/files/mesh_file.hpp"
#include "problems/mesh/files/mesh_readers.hpp"

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
  /// Goes beyond a real number that nobody needs.
  void skip_real(const char* what) {
    if (binary)
      text.bytes(sizeof(double), what);
    else
      text.word(what);
  }
  /// Rows are lines where numbers are words.
  void begin_row() {
    if (!binary) text.begin_line();
  }
  void end_row(const char* what) {
    if (!binary) text.end_line(what);
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

/// The head of a section, alone on its line.
inline std::string gmsh_section(MeshText& text) {
  text.begin_line();
  std::string section(text.word("a section"));
  if (!section.starts_with("$"))
    text.fail("a section such as $Nodes should be here and not " + in_quotes(section) +
              "; export the mesh again");
  text.end_line("the head of a section");
  text.line();
  return section;
}

/// How many of something follow, alone on a line of words.
inline std::size_t gmsh_count(MeshText& text, const char* what, std::size_t bytes) {
  text.begin_line();
  const std::size_t count = text.count(what, bytes);
  text.end_line("a count");
  text.line();
  return count;
}

/// Expects the word that closes a section, alone on its line.
inline void require_closing(MeshText& text, std::string_view opening, std::string_view end = "$End") {
  const std::string closing = std::string(end) + std::string(opening.substr(1));
  if (text.peek() != closing)
    text.fail(closing + " should be here and not " + in_quotes(text.peek()) +
              "; a count in the section is wrong or the file is cut off, so export it again");
  text.word("");
  text.end_line("the end of a section");
}

/// Ends a section of numbers, which are raw in a binary file.
inline void close_numbers(GmshFields& fields, std::string_view opening) {
  if (fields.binary) fields.text.require_line_break();
  require_closing(fields.text, opening);
}

/// Reads what follows $PhysicalNames. Names are words in binary files too.
inline void read_physical_names(MeshText& text, MeshBuilder& builder) {
  const std::size_t count = gmsh_count(text, "physical names", 6);
  for (std::size_t i = 0; i < count; ++i) {
    text.begin_line();
    const std::int64_t dimension = text.integer("the dimension of a physical group");
    const std::int64_t number = text.integer("the number of a physical group");
    builder.name_group(dimension, number, text.quoted("the name of a physical group"), text);
    text.end_line("a physical group");
  }
}

inline constexpr MiddleOrder middles_of_gmsh{{{0, 1}, {1, 2}, {0, 2}, {0, 3}, {2, 3}, {1, 3}}};

/// Adds a tetrahedron, or what belongs to a physical group. @param node  reads the next node
template <class Node>
void add_gmsh_element(MeshBuilder& builder, const GmshType& type, std::int64_t number, std::int64_t place,
                      std::span<const std::int64_t> groups, const MeshText& text, Node node) {
  const bool tetrahedron = type.kind == CellKind::tetrahedron;
  const std::size_t count = corner_count(type.kind);
  std::array<TetMesh::Index, 4> corners{};
  std::array<TetMesh::Index, 6> middles{};
  for (std::size_t i = 0; i < type.nodes; ++i) {
    const TetMesh::Index point =
        builder.numbered_point(node(), text, number, tetrahedron ? "tetrahedron" : "element");
    if (i < count)
      corners[i] = point;
    else if (i - count < middles.size())
      middles[i - count] = point;
  }
  if (type.kind == CellKind::triangle) builder.add_triangles(1);
  if (tetrahedron) {
    builder.add_tetrahedron(corners, number, place, groups.empty() ? 0 : groups.front(), text);
    for (std::size_t i = 1; i < groups.size(); ++i) builder.note_second_region(groups[0], groups[i]);
    if (type.nodes > count) builder.add_middles(middles, middles_of_gmsh);
    return;
  }
  // The sign of a group of Gmsh is that of its orientation.
  if (count > 0)
    for (const std::int64_t group : groups)
      builder.add_to_group(std::abs(group), std::span(corners).first(count));
}

}  // namespace hmax
