/// Gmsh .msh 1 and 2, and the sections that all versions share. The format is that of the Gmsh reference
/// manual [geuzaine2009gmsh].
#include <map>

#include "problems/mesh/files/gmsh_fields.hpp"
#include "problems/mesh/files/mesh_file.hpp"
#include "problems/mesh/files/mesh_readers.hpp"

namespace hmax {

namespace {

/// Where a node lies on its curve or surface, which nobody needs: dimension and tag of that, and a parameter
/// for each dimension below 3.
void skip_parameters(GmshFields& fields) {
  const std::int64_t dimension = fields.integer("the dimension of the entity of a node");
  fields.integer("the tag of the entity of a node");
  if (dimension < 0 || dimension > 3)
    fields.text.fail("the entity of a node has the dimension " + std::to_string(dimension) +
                     "; export the mesh again");
  for (std::int64_t k = 0; k < dimension && dimension < 3; ++k) fields.skip_real("a parameter of a node");
}

/// @param parametric  whether parameters stand behind each node
void read_points(MeshBuilder& builder, GmshFields& fields, std::size_t count, bool parametric) {
  builder.reserve_points(count);
  for (std::size_t i = 0; i < count; ++i) {
    fields.begin_row();
    const std::int64_t number = fields.integer("the number of a node");
    const double x = fields.real("the x coordinate"), y = fields.real("the y coordinate");
    builder.add_point(number, x, y, fields.real("the z coordinate"));
    if (parametric) skip_parameters(fields);
    fields.end_row("a node");
  }
}

MeshFile read_version_1(MeshText& text) {
  MeshBuilder builder;
  while (!text.at_end()) {
    const std::string section = gmsh_section(text);
    if (section == "$NOD") {
      const std::size_t count = gmsh_count(text, "nodes", 8);
      GmshFields fields{text, false, false};
      // Only the first row tells whether there are parameters.
      MeshText row = text;
      row.begin_line();
      const bool parametric = count > 0 && row.skip_rest_of_line() > 4;
      read_points(builder, fields, count, parametric);
      require_closing(text, section, "$END");
      builder.number_points(text);
    } else if (section == "$ELM") {
      const std::size_t count = gmsh_count(text, "elements", 12);
      for (std::size_t i = 0; i < count; ++i) {
        text.begin_line();
        const std::int64_t place = text.place(), number = text.integer("the number of an element");
        const std::int64_t type = text.integer("the type of an element");
        const std::int64_t region = text.integer("the physical region");
        text.integer("the elementary region");
        const std::size_t nodes = text.count("nodes of an element", 2);
        const GmshType known = gmsh_type(type);
        require_readable(known.kind, type, number, text);
        if (nodes != known.nodes)
          text.fail("element " + std::to_string(number) + " of type " + std::to_string(type) + " has " +
                    std::to_string(nodes) + " nodes instead of " + std::to_string(known.nodes) +
                    "; export the mesh again");
        add_gmsh_element(builder, known, number, place, std::array{region}, text,
                         [&] { return text.integer("a node of an element"); });
        text.end_line("an element");
      }
      require_closing(text, section, "$END");
    } else {
      text.skip_behind("$END" + section.substr(1));
    }
  }
  return builder.finish(text, "Gmsh 1");
}

MeshFile read_version_2(MeshText& text, bool binary, bool swapped) {
  MeshBuilder builder;
  GmshFields fields{text, binary, swapped};
  while (!text.at_end()) {
    const std::string section = gmsh_section(text);
    if (section == "$PhysicalNames") {
      read_physical_names(text, builder);
      require_closing(text, section);
    } else if (section == "$Nodes" || section == "$ParametricNodes") {
      read_points(builder, fields, gmsh_count(text, "nodes", binary ? 28 : 8), section != "$Nodes");
      close_numbers(fields, section);
      builder.number_points(text);
    } else if (section == "$Elements") {
      const std::size_t count = gmsh_count(text, "elements", binary ? 8 : 6);
      for (std::size_t done = 0; done < count;) {
        // In binary files a head stands before all elements of the same kind.
        std::int64_t number = 0, type = 0, tags = 0;
        std::size_t alike = 1;
        if (binary) {
          type = fields.integer("the type of elements");
          alike = fields.count("elements of a kind", 1, 4);
          tags = fields.integer("the number of tags");
          if (alike == 0 || alike > count - done)
            text.fail("a block has " + std::to_string(alike) + " elements where " +
                      std::to_string(count - done) + " are left; export the mesh again");
        }
        for (std::size_t i = 0; i < alike; ++i, ++done) {
          fields.begin_row();
          const std::int64_t place = text.place();
          number = fields.integer("the number of an element");
          if (!binary) {
            type = fields.integer("the type of an element");
            tags = fields.integer("the number of tags");
          }
          if (tags < 0 || tags > 1000)
            text.fail("element " + std::to_string(number) + " has " + std::to_string(tags) +
                      " tags; export the mesh again");
          std::int64_t region = 0;
          for (std::int64_t tag = 0; tag < tags; ++tag) {
            const std::int64_t value = fields.integer("a tag of an element");
            if (tag == 0) region = value;
          }
          const GmshType known = gmsh_type(type);
          require_readable(known.kind, type, number, text);
          add_gmsh_element(builder, known, number, place, std::array{region}, text,
                           [&] { return fields.integer("a node of an element"); });
          fields.end_row("an element");
        }
      }
      close_numbers(fields, section);
    } else {
      text.skip_behind("$End" + section.substr(1));
    }
  }
  return builder.finish(text, binary ? "Gmsh 2, binary" : "Gmsh 2");
}

}  // namespace

GmshType gmsh_type(std::int64_t type) {
  using enum CellKind;
  static const std::map<std::int64_t, GmshType> types{
      {1, {line, 2}},           {2, {triangle, 3}},       {3, {flat, 4}},           {4, {tetrahedron, 4}},
      {5, {other_volume, 8}},   {6, {other_volume, 6}},   {7, {other_volume, 5}},   {8, {line, 3}},
      {9, {triangle, 6}},       {10, {flat, 9}},          {11, {tetrahedron, 10}},  {12, {other_volume, 27}},
      {13, {other_volume, 18}}, {14, {other_volume, 14}}, {15, {point, 1}},         {16, {flat, 8}},
      {17, {other_volume, 20}}, {18, {other_volume, 15}}, {19, {other_volume, 13}}, {20, {triangle, 9}},
      {21, {triangle, 10}},     {22, {triangle, 12}},     {23, {triangle, 15}},     {24, {triangle, 15}},
      {25, {triangle, 21}},     {26, {line, 4}},          {27, {line, 5}},          {28, {line, 6}},
      {29, {high_order, 20}},   {30, {high_order, 35}},   {31, {high_order, 56}}};
  const auto found = types.find(type);
  return found == types.end() ? GmshType{unknown, 0} : found->second;
}

MeshFile read_gmsh(const std::string& name, std::string_view bytes) {
  MeshText text(name, bytes);
  while (text.peek() == "$Comments") text.skip_behind("$EndComments");
  const std::string_view first = text.peek();
  if (first == "$NOD" || first == "$PARA") return read_version_1(text);
  if (first != "$MeshFormat")
    text.fail("a Gmsh file begins with $MeshFormat or $NOD and not with " + in_quotes(first) +
              "; export the mesh again or correct the extension");
  const std::string section = gmsh_section(text);
  text.begin_line();
  const std::string version(text.word("the version of the format"));
  const std::int64_t kind = text.integer("the file type");
  const std::int64_t size = text.integer("the size of numbers");
  text.end_line("the format");
  text.line();
  if (kind != 0 && kind != 1)
    text.fail("the file type is " + std::to_string(kind) +
              ", which is neither 0 for ASCII nor 1 for binary; export the mesh again");
  if (size != 8)
    text.fail("numbers of " + std::to_string(size) +
              " bytes are not read; export the mesh again with 8 bytes");
  const bool binary = kind == 1;
  bool swapped = false;
  if (binary) {
    text.go_raw();
    const std::string_view one = text.bytes(4, "the number that tells the byte order");
    swapped = value_from<std::int32_t>(one.data(), false) != 1;
    if (swapped && value_from<std::int32_t>(one.data(), true) != 1)
      text.fail(
          "the number that tells the byte order is not 1; the file was damaged or written as text, so "
          "export it again");
    text.require_line_break();
  }
  require_closing(text, section);
  if (version.starts_with("4.1")) return read_gmsh_4(text, binary, swapped, "4.1");
  if (version == "4" || version.starts_with("4.0")) return read_gmsh_4(text, binary, swapped, "4.0");
  if (version == "2" || version.starts_with("2.")) return read_version_2(text, binary, swapped);
  text.fail("version " + in_quotes(version) +
            " of the Gmsh format is not read; save the mesh as 4.1 or 2.2 (in "
            "Gmsh: Mesh.MshFileVersion)");
}

}  // namespace hmax
