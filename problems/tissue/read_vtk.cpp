/// VTK legacy files [schroeder2006visualization]: version 5.1 with offsets and connectivity, older ones with
/// the number of points before the points of each cell.
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "problems/tissue/vtk_cells.hpp"

namespace hmax {

namespace {

constexpr std::int64_t second_order_tetrahedron = 24;

CellKind vtk_kind(std::int64_t type) {
  if (type == 10 || type == second_order_tetrahedron) return CellKind::tetrahedron;
  if (type == 5 || type == 22 || type == 34 || type == 69) return CellKind::triangle;
  if (type == 3 || type == 21) return CellKind::line;
  if (type == 1) return CellKind::point;
  if (type == 71 || type == 78) return CellKind::high_order;
  constexpr std::array<std::int64_t, 16> flat{0, 2, 4, 6, 7, 8, 9, 23, 28, 30, 35, 36, 68, 70, 75, 76};
  if (std::ranges::find(flat, type) != flat.end()) return CellKind::flat;
  return type > 0 && type < 100 ? CellKind::other_volume : CellKind::unknown;
}

/// Numbers one after the other as a legacy file names their types: words, or raw with the highest byte first.
class LegacyValues {
 public:
  LegacyValues(MeshText& text, bool binary) : text_(text), binary_(binary) {}

  /// Begins an array after its head line. @throws std::invalid_argument unless `count` values have room
  void begin(std::string_view type, std::size_t count, const char* what) {
    type_ = type;
    if (size_of() == 0)
      text_.fail("the type of numbers " + in_quotes(type) +
                 " is not read; save the mesh with double and int");
    text_.require_room(count, what, binary_ ? size_of() : 2);
  }
  /// Goes beyond an array that nobody needs.
  void skip(std::string_view type, std::size_t components, std::size_t tuples) {
    if (components != 0 && tuples > text_.left() / components)
      text_.require_room(text_.left() + 1, "values", 1);
    begin(type, components * tuples, "values");
    if (binary_) text_.bytes(components * tuples * size_of(), "the values of an array");
    for (std::size_t i = 0; !binary_ && i < components * tuples; ++i) text_.word("a value");
  }
  double real(const char* what) {
    if (!binary_) return text_.number(what);
    const double value = raw(what);
    if (!std::isfinite(value))
      text_.fail(std::string(what) + " is not finite; correct it or export the mesh again");
    return value;
  }
  std::int64_t integer(const char* what) {
    if (!binary_) return text_.integer(what);
    return is_real() ? static_cast<std::int64_t>(std::clamp(real(what), -9e18, 9e18)) : whole(what);
  }

 private:
  [[nodiscard]] bool is_real() const { return type_ == "float" || type_ == "double"; }
  [[nodiscard]] std::size_t size_of() const {
    if (type_ == "char" || type_ == "unsigned_char" || type_ == "vtktypeint8" || type_ == "vtktypeuint8")
      return 1;
    if (type_ == "short" || type_ == "unsigned_short" || type_ == "vtktypeint16" || type_ == "vtktypeuint16")
      return 2;
    if (type_ == "int" || type_ == "unsigned_int" || type_ == "float" || type_ == "vtktypeint32" ||
        type_ == "vtktypeuint32")
      return 4;
    if (type_ == "long" || type_ == "unsigned_long" || type_ == "double" || type_ == "vtktypeint64" ||
        type_ == "vtktypeuint64" || type_ == "vtkIdType")
      return type_ == "vtkIdType" ? 4 : 8;
    return 0;
  }
  double raw(const char* what) {
    if (type_ == "float") return text_.raw<float>(what, little);
    if (type_ == "double") return text_.raw<double>(what, little);
    return static_cast<double>(whole(what));
  }
  std::int64_t whole(const char* what) {
    const bool without_sign =
        type_.find("unsigned") != std::string::npos || type_.find("uint") != std::string::npos;
    switch (size_of()) {
      case 1:
        return without_sign ? std::int64_t{text_.raw<std::uint8_t>(what, little)}
                            : std::int64_t{text_.raw<std::int8_t>(what, little)};
      case 2:
        return without_sign ? std::int64_t{text_.raw<std::uint16_t>(what, little)}
                            : std::int64_t{text_.raw<std::int16_t>(what, little)};
      case 4:
        return without_sign ? std::int64_t{text_.raw<std::uint32_t>(what, little)}
                            : std::int64_t{text_.raw<std::int32_t>(what, little)};
      default:
        return text_.raw<std::int64_t>(what, little);
    }
  }

  static constexpr bool little = std::endian::native == std::endian::little;
  MeshText& text_;
  bool binary_;
  std::string type_;
};

/// METADATA goes on to the next empty line.
void skip_paragraph(MeshText& text) {
  text.line();
  while (text.left() > 0 && !text.line().empty()) {
  }
}

std::vector<std::int64_t> read_integers(MeshText& text, LegacyValues& values, std::string_view type,
                                        std::size_t count, const char* what) {
  text.line();
  values.begin(type, count, what);
  std::vector<std::int64_t> list(count);
  for (std::int64_t& value : list) value = values.integer(what);
  return list;
}

/// Reads what follows CELLS: both ways to write it.
void read_cells(MeshText& text, LegacyValues& values, VtkCells& cells, std::vector<std::int64_t>& places) {
  const std::size_t first = text.count("cells", 2), second = text.count("numbers of cells", 2);
  text.line();
  if (text.peek().starts_with("OFFSETS")) {
    text.word("");
    const std::string type(text.word("the type of offsets"));
    cells.offsets = read_integers(text, values, type, first, "offsets");
    if (text.word("CONNECTIVITY") != "CONNECTIVITY")
      text.fail("CONNECTIVITY should be here; export the mesh again");
    places.assign(1, text.place());
    const std::string other(text.word("the type of the connectivity"));
    cells.connectivity = read_integers(text, values, other, second, "points of cells");
    return;
  }
  values.begin("int", second, "numbers of cells");
  cells.offsets.push_back(0);
  for (std::size_t cell = 0; cell < first; ++cell) {
    places.push_back(text.place());
    const std::int64_t count = values.integer("the number of points of a cell");
    const std::size_t used = cells.connectivity.size() + cell + 1;
    if (count < 0 || used > second || static_cast<std::size_t>(count) > second - used)
      text.fail("cell " + std::to_string(cell) + " has " + std::to_string(count) +
                " points, more than the head of CELLS announces; export the mesh again");
    for (std::int64_t i = 0; i < count; ++i)
      cells.connectivity.push_back(values.integer("a point of a cell"));
    cells.offsets.push_back(static_cast<std::int64_t>(cells.connectivity.size()));
  }
}

std::vector<std::int64_t> read_values(LegacyValues& values, std::string_view type, std::size_t count) {
  values.begin(type, count, "regions");
  std::vector<std::int64_t> list(count);
  for (std::int64_t& value : list) value = values.integer("a region");
  return list;
}

/// Looks through the data behind the cells for regions; an unknown section ends the search.
std::vector<std::int64_t> read_regions(MeshText& text, LegacyValues& values, std::size_t cells) {
  std::size_t count = 0;
  bool of_cells = false;
  while (!text.at_end()) {
    const std::string section(text.word("a section"));
    if (section == "CELL_DATA" || section == "POINT_DATA") {
      of_cells = section == "CELL_DATA";
      count = text.count("values", 1);
    } else if (section == "SCALARS" || section == "VECTORS" || section == "NORMALS") {
      const std::string name(text.word("a name")), type(text.word("a type"));
      MeshText head(text.name(), text.line());
      std::size_t components = section == "SCALARS" ? 1 : 3;
      if (!head.at_end()) components = head.count("components", 1);
      if (section == "SCALARS") text.line();  // LOOKUP_TABLE default
      if (of_cells && components == 1 && count == cells && names_vtk_regions(name))
        return read_values(values, type, count);
      values.skip(type, components, count);
    } else if (section == "FIELD") {
      text.word("a name");
      const std::size_t arrays = text.count("arrays", 4);
      for (std::size_t array = 0; array < arrays; ++array) {
        const std::string name(text.word("a name"));
        const std::size_t components = text.count("components", 1), tuples = text.count("tuples", 1);
        const std::string type(text.word("a type"));
        text.line();
        if (of_cells && components == 1 && tuples == cells && names_vtk_regions(name))
          return read_values(values, type, tuples);
        values.skip(type, components, tuples);
      }
    } else if (section == "METADATA") {
      skip_paragraph(text);
    } else {
      return {};
    }
  }
  return {};
}

}  // namespace

bool names_vtk_regions(std::string_view name) {
  constexpr std::array<std::string_view, 10> names{
      "region",        "regions",     "Region",      "gmsh:physical", "medit:ref",
      "CellEntityIds", "MaterialIds", "MaterialIDs", "cell_markers",  "tetgen:ref"};
  return std::ranges::find(names, name) != names.end();
}

void add_vtk_cells(MeshBuilder& builder, const VtkCells& cells, std::span<const std::int64_t> places,
                   std::span<const std::int64_t> regions, MeshText& text) {
  const std::size_t count = cells.types.size();
  if (cells.offsets.size() != count + 1)
    text.fail("there are " + std::to_string(count) + " types for " +
              std::to_string(cells.offsets.empty() ? 0 : cells.offsets.size() - 1) +
              " cells; export the mesh again");
  builder.reserve_tetrahedra(count);
  for (std::size_t cell = 0; cell < count; ++cell) {
    const auto number = static_cast<std::int64_t>(cell);
    text.about(places.size() == 1 ? places[0] : places[cell]);
    const std::int64_t begin = cells.offsets[cell], end = cells.offsets[cell + 1];
    if (begin < 0 || end < begin || end > static_cast<std::int64_t>(cells.connectivity.size()))
      text.fail("cell " + std::to_string(cell) +
                " lies outside of the list of points of cells; export the mesh again");
    const CellKind kind = vtk_kind(cells.types[cell]);
    require_readable(kind, cells.types[cell], number, text);
    if (kind == CellKind::triangle) builder.add_triangles(1);
    const std::int64_t region = regions.empty() ? 0 : regions[cell];
    const bool tetrahedron = kind == CellKind::tetrahedron;
    if (!tetrahedron && region == 0) continue;
    const bool second_order = cells.types[cell] == second_order_tetrahedron;
    if (tetrahedron && end - begin != (second_order ? 10 : 4))
      text.fail("cell " + std::to_string(cell) + " is a tetrahedron with " + std::to_string(end - begin) +
                " points; export the mesh again");
    const std::size_t used = corner_count(kind);
    if (end - begin < static_cast<std::int64_t>(used))
      text.fail("cell " + std::to_string(cell) + " has only " + std::to_string(end - begin) +
                " points; export the mesh again");
    std::array<TetMesh::Index, 4> corners{};
    for (std::size_t i = 0; i < used; ++i)
      corners[i] = builder.counted_point(cells.connectivity[static_cast<std::size_t>(begin) + i], text,
                                         number, tetrahedron ? "tetrahedron" : "cell");
    if (second_order) builder.add_second_order();
    if (tetrahedron)
      builder.add_tetrahedron(corners, number, places.size() == 1 ? places[0] : places[cell], region, text);
    else if (used > 0)
      builder.add_to_group(region, std::span(corners).first(used));
  }
}

MeshFile read_vtk(const std::string& name, std::string_view bytes) {
  MeshText text(name, bytes);
  if (!text.peek().starts_with("#") || text.line().find("vtk DataFile") == std::string_view::npos)
    text.fail(
        "a VTK file begins with '# vtk DataFile Version'; export the mesh again or correct the extension");
  text.line();  // the title
  const std::string encoding(text.word("ASCII or BINARY"));
  if (encoding != "ASCII" && encoding != "BINARY")
    text.fail("ASCII or BINARY should be here and not " + in_quotes(encoding) + "; export the mesh again");
  const bool binary = encoding == "BINARY";
  text.word("DATASET");
  if (const auto dataset = text.word("the kind of data"); dataset != "UNSTRUCTURED_GRID")
    text.fail("the file holds " + in_quotes(dataset) +
              " and no UNSTRUCTURED_GRID; save an unstructured grid");
  if (binary) text.go_raw();

  MeshBuilder builder;
  LegacyValues values(text, binary);
  VtkCells cells;
  std::vector<std::int64_t> places;
  bool has_points = false, has_cells = false;
  while (cells.types.empty()) {
    const std::string word(text.word("POINTS, CELLS and CELL_TYPES"));
    if (word == "POINTS" && !has_points) {
      const std::size_t count = text.count("points", 3);
      const std::string type(text.word("the type of numbers"));
      text.line();
      values.begin(type, 3 * count, "coordinates");
      builder.reserve_points(count);
      for (std::size_t i = 0; i < count; ++i) {
        const double x = values.real("the x coordinate"), y = values.real("the y coordinate");
        builder.add_point(x, y, values.real("the z coordinate"));
      }
      has_points = true;
    } else if (word == "CELLS" && !has_cells) {
      read_cells(text, values, cells, places);
      has_cells = true;
    } else if (word == "CELL_TYPES" && has_points && has_cells) {
      const std::size_t count = text.count("types of cells", 1);
      if (count == 0) text.fail("the file has no cells; export the volume elements too");
      cells.types = read_integers(text, values, "int", count, "types of cells");
    } else if (word == "METADATA") {
      skip_paragraph(text);
    } else {
      text.fail("POINTS, CELLS and CELL_TYPES should be here, in this order, and not " + in_quotes(word) +
                "; export the mesh again");
    }
  }
  const std::vector<std::int64_t> regions = read_regions(text, values, cells.types.size());
  add_vtk_cells(builder, cells, places, regions, text);
  return builder.finish(text, binary ? "VTK legacy, binary" : "VTK legacy");
}

}  // namespace hmax
