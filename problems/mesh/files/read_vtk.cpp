/// VTK legacy files [schroeder2006visualization]: version 5.1 with offsets and connectivity, older ones with
/// the number of points before the points of each cell.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "core/numbers.hpp"
#include "problems/mesh/files/vtk_cells.hpp"

namespace hmax {

namespace {

constexpr std::int64_t second_order_tetrahedron = 24;

/// A type of cells: what it is here, and how many points it has, unless that differs from cell to cell.
struct VtkType {
  std::int64_t type;
  CellKind kind;
  std::optional<std::int64_t> points{};
};

VtkType vtk_type(std::int64_t type) {
  using enum CellKind;
  constexpr std::array<VtkType, 25> known{
      {{0, flat, 0},         {1, point, 1},  {2, flat},         {3, line, 2},  {4, flat},
       {5, triangle, 3},     {6, flat},      {7, flat},         {8, flat, 4},  {9, flat, 4},
       {10, tetrahedron, 4}, {21, line, 3},  {22, triangle, 6}, {23, flat, 8}, {24, tetrahedron, 10},
       {28, flat, 9},        {30, flat, 6},  {34, triangle, 7}, {35, flat, 4}, {36, flat},
       {68, flat},           {69, triangle}, {70, flat},        {75, flat},    {76, flat}}};
  if (const auto* const found = std::ranges::find(known, type, &VtkType::type); found != known.end())
    return *found;
  if (type == 71 || type == 78) return {type, high_order};
  return {type, type > 0 && type < 100 ? other_volume : unknown};
}

/// Numbers one after the other as a legacy file names their types: words, or raw with the highest byte first.
class LegacyValues {
 public:
  LegacyValues(MeshText& text, bool binary) : text_(text), binary_(binary) {}

  /// Begins an array after its head line. @throws std::invalid_argument unless `count` values have room
  void begin(std::string_view type, std::size_t count, const char* what) {
    type_ = lower(type);
    require_known(type);
    text_.require_room(count, what, binary_ ? size_of() : 2);
    empty_ = count == 0;
  }
  /// Ends an array all of whose values were read.
  void end() {
    if (binary_ && !empty_) text_.require_line_break();
  }
  /// Goes beyond an array that nobody needs, whatever its values are.
  void skip(std::string_view type, std::size_t components, std::size_t tuples) {
    // Of bits there are eight in a byte.
    if (components != 0 && tuples / 8 > text_.left() / components)
      text_.require_room(text_.left() + 1, "values", 1);
    const std::size_t count = components * tuples;
    type_ = lower(type);
    if (type_ == "string") {
      for (std::size_t i = 0; i < count; ++i) skip_string();
    } else if (binary_ && type_ == "bit") {
      text_.bytes((count + 7) / 8, "the values of an array");
      empty_ = count == 0;
      end();
    } else if (binary_) {
      begin(type, count, "values");
      text_.bytes(count * size_of(), "the values of an array");
      end();
    } else {
      if (type_ != "bit") require_known(type);
      text_.require_room(count, "values", 2);
      for (std::size_t i = 0; i < count; ++i)
        if (const std::string_view word = text_.word("a value"); begins_section(word))
          text_.fail("an array ends with " + in_quotes(word) + " after " + std::to_string(i) + " of " +
                     std::to_string(count) + " values; the file is damaged, so copy or export it again");
    }
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
    if (!is_real()) return whole(what);
    const double value = real(what);
    if (value != std::floor(value) || std::abs(value) > 9e18)
      text_.fail(std::string(what) + " should be a whole number and is " + to_text(value) +
                 "; correct it or export the mesh again");
    return static_cast<std::int64_t>(value);
  }

  /// A region, which may be written as a real number.
  std::int64_t label(const char* what) { return binary_ ? integer(what) : text_.label(what); }

 private:
  void require_known(std::string_view type) const {
    if (size_of() == 0)
      text_.fail("the type of numbers " + in_quotes(type) +
                 " is not read; save the mesh with double and int");
  }
  /// True for the words with which data begin.
  static bool begins_section(std::string_view word) {
    constexpr std::array<std::string_view, 7> heads{"CELL_DATA", "POINT_DATA", "SCALARS",     "VECTORS",
                                                    "FIELD",     "METADATA",   "LOOKUP_TABLE"};
    return std::ranges::any_of(heads, [&](std::string_view head) { return same_keyword(head, word); });
  }
  /// A string is a line, or its length and bytes: the two highest bits tell how long that length is.
  void skip_string() {
    if (!binary_) {
      if (text_.left() == 0) text_.word("a string");
      text_.line();
      return;
    }
    const auto first = static_cast<unsigned char>(text_.bytes(1, "the length of a string").front());
    const std::size_t more = first >> 6 == 3 ? 0 : first >> 6 == 2 ? 1 : first >> 6 == 1 ? 3 : 7;
    std::size_t length = first & 63;
    for (const char byte : text_.bytes(more, "the length of a string"))
      length = length << 8 | static_cast<unsigned char>(byte);
    text_.bytes(length, "a string");
  }
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
        type_ == "vtktypeuint64" || type_ == "vtkidtype")
      return type_ == "vtkidtype" ? 4 : 8;
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
  bool binary_, empty_ = true;
  std::string type_;
};

/// Ends the line of a head, behind which values begin.
void end_head(MeshText& text) {
  text.end_line("the head of an array");
  text.line();
}

/// METADATA goes on to the next empty line.
void skip_paragraph(MeshText& text) {
  text.line();
  while (text.left() > 0 && !text.line().empty()) {
  }
}

std::vector<std::int64_t> read_integers(MeshText& text, LegacyValues& values, std::string_view type,
                                        std::size_t count, const char* what) {
  end_head(text);
  values.begin(type, count, what);
  std::vector<std::int64_t> list(count);
  for (std::int64_t& value : list) value = values.integer(what);
  values.end();
  return list;
}

/// Reads what follows CELLS: both ways to write it.
void read_cells(MeshText& text, LegacyValues& values, VtkCells& cells, std::vector<std::int64_t>& places) {
  const std::size_t first = text.count("cells", 2), second = text.count("numbers of cells", 2);
  end_head(text);
  if (same_keyword(text.peek(), "OFFSETS")) {
    text.word("");
    const std::string type(text.word("the type of offsets"));
    cells.offsets = read_integers(text, values, type, first, "offsets");
    if (!same_keyword(text.word("CONNECTIVITY"), "CONNECTIVITY"))
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
  values.end();
  if (first + cells.connectivity.size() != second)
    text.fail("the cells are " + std::to_string(first + cells.connectivity.size()) + " numbers instead of " +
              std::to_string(second) + "; export the mesh again");
}

std::vector<std::int64_t> read_values(LegacyValues& values, std::string_view type, std::size_t count) {
  values.begin(type, count, "regions");
  std::vector<std::int64_t> list(count);
  for (std::int64_t& value : list) value = values.label("a region");
  values.end();
  return list;
}

/// Reads the data behind the cells to the end of the file, for the regions among them.
class LegacyData {
 public:
  LegacyData(MeshText& text, LegacyValues& values, std::size_t cells)
      : text_(text), values_(values), cells_(cells) {}

  /// One for each cell, or none.
  std::vector<std::int64_t> regions() {
    while (!text_.at_end()) read_section(upper(text_.word("a section")));
    if (awaited_)
      text_.fail(
          "the values of points or cells are missing; the file is cut off, so copy or export it again");
    return std::move(regions_);
  }

  /// Goes beyond a field of the whole file, which may stand before the points.
  void skip_field() { read_field(); }

 private:
  /// Arrays of one head line `SECTION NAME TYPE` and the components of each value.
  struct Section {
    std::string_view name;
    std::size_t components;
  };
  static constexpr std::array<Section, 7> sections{{{"VECTORS", 3},
                                                    {"NORMALS", 3},
                                                    {"TENSORS", 9},
                                                    {"TENSORS6", 6},
                                                    {"GLOBAL_IDS", 1},
                                                    {"PEDIGREE_IDS", 1},
                                                    {"EDGE_FLAGS", 1}}};

  void read_section(const std::string& section) {
    const auto* const plain = std::ranges::find(sections, section, &Section::name);
    if (section == "CELL_DATA" || section == "POINT_DATA") {
      begin_data(section == "CELL_DATA");
    } else if (section == "SCALARS") {
      const std::string name(text_.word("a name")), type(text_.word("a type"));
      MeshText head(text_.name(), text_.line());
      const std::size_t components = head.at_end() ? 1 : head.count("components", 1);
      if (!same_keyword(text_.word("LOOKUP_TABLE"), "LOOKUP_TABLE"))
        text_.fail("LOOKUP_TABLE should be behind SCALARS; export the mesh again");
      text_.word("the name of a table");
      end_head(text_);
      take(name, type, components, count_);
    } else if (plain != sections.end()) {
      const std::string name(text_.word("a name")), type(text_.word("a type"));
      end_head(text_);
      take(name, type, plain->components, count_);
    } else if (section == "TEXTURE_COORDINATES") {
      const std::string name(text_.word("a name"));
      const std::size_t components = text_.count("components", 1);
      const std::string type(text_.word("a type"));
      end_head(text_);
      take(name, type, components, count_);
    } else if (section == "COLOR_SCALARS" || section == "LOOKUP_TABLE") {
      text_.word("a name");
      const std::size_t number = text_.count("colours", 1);
      end_head(text_);
      // Bytes where values are raw, else real numbers.
      if (section == "LOOKUP_TABLE")
        values_.skip("unsigned_char", 4, number);
      else
        take("", "unsigned_char", number, count_);
    } else if (section == "FIELD") {
      read_field();
    } else if (section == "METADATA") {
      skip_paragraph(text_);
    } else {
      text_.fail("a section such as CELL_DATA should be here and not " + in_quotes(section) +
                 "; a count before is wrong or the file is damaged, so export the mesh again");
    }
  }

  void begin_data(bool of_cells) {
    of_cells_ = of_cells;
    count_ = text_.count("values", 1);
    end_head(text_);
    awaited_ = in_data_ = true;
    // Nobody needs the data of points.
    if (of_cells && count_ != cells_)
      text_.fail("there are " + std::to_string(count_) + " values for " + std::to_string(cells_) +
                 " cells; export the mesh again");
  }

  void read_field() {
    text_.word("a name");
    const std::size_t arrays = text_.count("arrays", 4);
    awaited_ = false;
    for (std::size_t array = 0; array < arrays; ++array) {
      // Values of an array may have a paragraph of their own.
      while (same_keyword(text_.peek(), "METADATA")) skip_paragraph(text_);
      const std::string name(text_.word("a name"));
      const std::size_t components = text_.count("components", 1), tuples = text_.count("tuples", 1);
      const std::string type(text_.word("a type"));
      end_head(text_);
      take(name, type, components, tuples);
    }
  }

  /// Fields of points and cells have a value for each; those of the whole file as many as they like.
  void take(std::string_view name, std::string_view type, std::size_t components, std::size_t tuples) {
    awaited_ = false;
    if (in_data_ && tuples != count_)
      text_.fail("the array " + in_quotes(name) + " has " + std::to_string(tuples) + " values for " +
                 std::to_string(count_) + (of_cells_ ? " cells" : " points") + "; export the mesh again");
    if (regions_.empty() && of_cells_ && components == 1 && tuples == cells_ && names_vtk_regions(name))
      regions_ = read_values(values_, type, tuples);
    else
      values_.skip(type, components, tuples);
  }

  MeshText& text_;
  LegacyValues& values_;
  std::size_t cells_, count_ = 0;
  bool in_data_ = false, of_cells_ = false, awaited_ = false;
  std::vector<std::int64_t> regions_;
};

}  // namespace

bool names_vtk_regions(std::string_view name) {
  // Label is that of FreeFem.
  constexpr std::array<std::string_view, 11> names{
      "region",        "regions",     "Region",      "gmsh:physical", "medit:ref", "Label",
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
    const auto number = cells.first_cell + static_cast<std::int64_t>(cell);
    text.about(places.size() == 1 ? places[0] : places[cell]);
    const std::int64_t begin = cells.offsets[cell], end = cells.offsets[cell + 1];
    if (begin < 0 || end < begin || end > static_cast<std::int64_t>(cells.connectivity.size()))
      text.fail("cell " + std::to_string(cell) +
                " lies outside of the list of points of cells; export the mesh again");
    const auto [type, kind, fixed] = vtk_type(cells.types[cell]);
    require_readable(kind, type, number, text);
    if (end - begin != fixed.value_or(end - begin))
      text.fail("cell " + std::to_string(cell) + " is " +
                (kind == CellKind::tetrahedron ? "a tetrahedron" : "of type " + std::to_string(type)) +
                " with " + std::to_string(end - begin) + " points instead of " + std::to_string(*fixed) +
                "; export the mesh again");
    if (kind == CellKind::triangle) builder.add_triangles(1);
    const std::int64_t region = regions.empty() ? 0 : regions[cell];
    const bool tetrahedron = kind == CellKind::tetrahedron;
    const std::size_t used = corner_count(kind);
    if (end - begin < static_cast<std::int64_t>(used))
      text.fail("cell " + std::to_string(cell) + " has only " + std::to_string(end - begin) +
                " points; export the mesh again");
    std::array<TetMesh::Index, 4> corners{};
    std::array<TetMesh::Index, 6> middles{};
    for (std::size_t i = 0; i < static_cast<std::size_t>(end - begin); ++i) {
      const std::int64_t its = cells.connectivity[static_cast<std::size_t>(begin) + i];
      const bool possible = its >= 0 && its <= std::numeric_limits<TetMesh::Index>::max();
      const TetMesh::Index point = builder.counted_point(possible ? cells.first_point + its : its, text,
                                                         number, tetrahedron ? "tetrahedron" : "cell");
      if (i < used)
        corners[i] = point;
      else if (i - used < middles.size())
        middles[i - used] = point;
    }
    if (tetrahedron)
      builder.add_tetrahedron(corners, number, places.size() == 1 ? places[0] : places[cell], region, text);
    else if (used > 0)
      builder.add_to_group(region, std::span(corners).first(used));
    if (type == second_order_tetrahedron) builder.add_middles(middles, middles_of_vtk);
  }
}

MeshFile read_vtk(const std::string& name, std::string_view bytes) {
  MeshText text(name, bytes);
  if (!text.peek().starts_with("#") || lower(text.line()).find("vtk datafile") == std::string::npos)
    text.fail(
        "a VTK file begins with '# vtk DataFile Version'; export the mesh again or correct the extension");
  text.line();  // the title
  const std::string encoding(text.word("ASCII or BINARY"));
  const bool binary = same_keyword(encoding, "BINARY");
  if (!binary && !same_keyword(encoding, "ASCII"))
    text.fail("ASCII or BINARY should be here and not " + in_quotes(encoding) + "; export the mesh again");
  if (const auto word = text.word("DATASET"); !same_keyword(word, "DATASET"))
    text.fail("DATASET should be here and not " + in_quotes(word) + "; export the mesh again");
  if (const auto dataset = text.word("the kind of data"); !same_keyword(dataset, "UNSTRUCTURED_GRID"))
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
    if (same_keyword(word, "POINTS") && !has_points) {
      const std::size_t count = text.count("points", 3);
      const std::string type(text.word("the type of numbers"));
      end_head(text);
      values.begin(type, 3 * count, "coordinates");
      builder.reserve_points(count);
      for (std::size_t i = 0; i < count; ++i) {
        const double x = values.real("the x coordinate"), y = values.real("the y coordinate");
        builder.add_point(x, y, values.real("the z coordinate"));
      }
      values.end();
      has_points = true;
    } else if (same_keyword(word, "CELLS") && !has_cells) {
      read_cells(text, values, cells, places);
      has_cells = true;
    } else if (same_keyword(word, "CELL_TYPES") && has_points && has_cells) {
      const std::size_t count = text.count("types of cells", 1);
      if (count == 0) text.fail("the file has no cells; export the volume elements too");
      cells.types = read_integers(text, values, "int", count, "types of cells");
    } else if (same_keyword(word, "METADATA")) {
      skip_paragraph(text);
    } else if (same_keyword(word, "FIELD")) {
      LegacyData(text, values, 0).skip_field();
    } else {
      text.fail("POINTS, CELLS and CELL_TYPES should be here, in this order, and not " + in_quotes(word) +
                "; export the mesh again");
    }
  }
  const std::vector<std::int64_t> regions = LegacyData(text, values, cells.types.size()).regions();
  if (!binary) text.require_end();
  add_vtk_cells(builder, cells, places, regions, text);
  return builder.finish(text, binary ? "VTK legacy, binary" : "VTK legacy");
}

}  // namespace hmax
