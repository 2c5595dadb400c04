/// VTK XML files of unstructured grids, .vtu: numbers as ASCII, as base64, or appended at the end, raw or as
/// base64, in plain or in compressed blocks [schroeder2006visualization]. Several pieces are one grid after
/// the other.
#include <algorithm>
#include <array>
#include <cmath>

#include "core/numbers.hpp"
#include "core/text/base64.hpp"
#include "problems/mesh/files/vtk_cells.hpp"
#include "problems/mesh/files/vtu_blocks.hpp"
#include "problems/mesh/files/xml_tags.hpp"

namespace hmax {

namespace {

/// A type of numbers as VTK names it.
struct NumberType {
  std::string_view name;
  std::size_t size;
};
constexpr std::array<NumberType, 10> number_types{{{"Int8", 1},
                                                   {"UInt8", 1},
                                                   {"Int16", 2},
                                                   {"UInt16", 2},
                                                   {"Int32", 4},
                                                   {"UInt32", 4},
                                                   {"Int64", 8},
                                                   {"UInt64", 8},
                                                   {"Float32", 4},
                                                   {"Float64", 8}}};

/// One value of a named type as `To`.
template <class To>
To converted(std::string_view type, const char* bytes, bool swapped) {
  const auto as = [&]<class From>(From) { return static_cast<To>(value_from<From>(bytes, swapped)); };
  if (type == "Int8") return as(std::int8_t{});
  if (type == "UInt8") return as(std::uint8_t{});
  if (type == "Int16") return as(std::int16_t{});
  if (type == "UInt16") return as(std::uint16_t{});
  if (type == "Int32") return as(std::int32_t{});
  if (type == "UInt32") return as(std::uint32_t{});
  if (type == "Int64") return as(std::int64_t{});
  return as(std::uint64_t{});
}

struct Piece {
  std::size_t points = 0, cells = 0;
  std::optional<XmlTag> coordinates{}, connectivity{}, offsets{}, types{}, regions{};
  std::optional<XmlTag> point_numbers{}, cell_numbers{}, ghosts{};
};

struct Grid {
  std::vector<Piece> pieces;
  std::optional<XmlTag> region_names;
  std::vector<XmlTag> groups;    ///< corners of groups, named "surface:30 NAME"
  std::vector<XmlTag> appended;  ///< all arrays that stand in the appended data, used or not
};

/// True for "surface:30 capsule", and the like for points and lines.
bool names_group(std::string_view array) {
  const auto kinds = std::span(group_kinds).first<3>();
  const std::size_t colon = std::min(array.find(':'), array.size());
  return std::ranges::find(kinds, array.substr(0, colon)) != kinds.end() &&
         array.substr(colon).find_first_of("-0123456789") == 1;
}

bool all_differ(std::vector<std::int64_t> numbers) {
  std::ranges::sort(numbers);
  return std::ranges::adjacent_find(numbers) == numbers.end();
}

class VtuReader {
 public:
  VtuReader(const std::string& name, std::string_view whole) : text_(name, whole), whole_(whole) {}

  MeshFile read() {
    const Grid grid = find_arrays();
    check_appended(grid);
    check_regions(grid);
    MeshBuilder builder;
    std::int64_t first_cell = 0;
    for (const Piece& piece : grid.pieces) {
      if (piece.points > 0 || piece.cells > 0) read_piece(piece, first_cell, builder);
      first_cell += static_cast<std::int64_t>(piece.cells);
    }
    if (grid.region_names) read_region_names(*grid.region_names, builder);
    read_groups(grid, builder);
    MeshFile file = builder.finish(text_, "VTK XML");
    take_numbers(grid, file);
    return file;
  }

 private:
  /// All pieces that have cells have regions, or none has.
  void check_regions(const Grid& grid) const {
    const Piece* without = nullptr;
    const XmlTag* regions = nullptr;
    for (const Piece& piece : grid.pieces) {
      if (piece.cells == 0) continue;
      if (piece.regions)
        regions = &*piece.regions;
      else
        without = &piece;
    }
    if (!regions || !without) return;
    at(*regions).fail("the array " + in_quotes(regions->attribute("Name")) +
                      " has the regions of this piece, and piece " +
                      std::to_string(without - grid.pieces.data() + 1) + " has none; export the mesh again");
  }

  /// Adds a piece behind those before it. @param first_cell  the number of its first cell
  void read_piece(const Piece& piece, std::int64_t first_cell, MeshBuilder& builder) const {
    VtkCells cells;
    cells.first_point = static_cast<std::int64_t>(builder.point_count());
    cells.first_cell = first_cell;
    const std::vector<double> xyz = numbers<double>(*piece.coordinates, 3 * piece.points, "coordinates");
    builder.reserve_points(piece.points);
    for (std::size_t i = 0; i < piece.points; ++i) {
      for (std::size_t k = 0; k < 3; ++k)
        if (!(xyz[3 * i + k] - xyz[3 * i + k] == 0))
          at(*piece.coordinates)
              .fail("point " + std::to_string(i) +
                    " has a coordinate that is not finite; correct it or export the mesh again");
      builder.add_point(xyz[3 * i], xyz[3 * i + 1], xyz[3 * i + 2]);
    }
    cells.types = numbers<std::int64_t>(*piece.types, piece.cells, "types of cells");
    cells.offsets = numbers<std::int64_t>(*piece.offsets, piece.cells, "offsets");
    cells.offsets.insert(cells.offsets.begin(), 0);
    const std::int64_t corners = cells.offsets.back();
    if (corners < 0) at(*piece.offsets).fail("the last offset is negative; export the mesh again");
    cells.connectivity =
        numbers<std::int64_t>(*piece.connectivity, static_cast<std::size_t>(corners), "points of cells");
    std::vector<std::int64_t> regions;
    if (piece.regions) regions = numbers<std::int64_t>(*piece.regions, piece.cells, "regions");
    if (piece.ghosts) leave_out_ghosts(piece, cells);
    MeshText place = at(*piece.connectivity);
    const std::array<std::int64_t, 1> places{place.place()};
    add_vtk_cells(builder, cells, places, regions, place);
  }

  /// Cells that stand in another piece too become empty ones.
  void leave_out_ghosts(const Piece& piece, VtkCells& cells) const {
    constexpr std::int64_t in_another_piece = 1;
    const auto ghosts = numbers<std::int64_t>(*piece.ghosts, piece.cells, "ghost cells");
    VtkCells kept{.types = cells.types, .first_point = cells.first_point, .first_cell = cells.first_cell};
    kept.offsets.push_back(0);
    for (std::size_t cell = 0; cell < piece.cells; ++cell) {
      const std::int64_t begin = cells.offsets[cell], end = cells.offsets[cell + 1];
      if (begin < 0 || end < begin || end > static_cast<std::int64_t>(cells.connectivity.size())) return;
      if ((ghosts[cell] & in_another_piece) != 0)
        kept.types[cell] = 0;
      else
        kept.connectivity.insert(kept.connectivity.end(), cells.connectivity.begin() + begin,
                                 cells.connectivity.begin() + end);
      kept.offsets.push_back(static_cast<std::int64_t>(kept.connectivity.size()));
    }
    cells = std::move(kept);
  }

  /// Strings such as "10 parenchyma", each letter a number and 0 behind the last one.
  void read_region_names(const XmlTag& tag, MeshBuilder& builder) const {
    if (tag.attribute("format") != "ascii") return;
    MeshText letters = text_.part(tag.end, std::min(whole_.find('<', tag.end), whole_.size()));
    std::string entry;
    std::size_t names = 0;
    while (!letters.at_end()) {
      const std::int64_t letter = letters.integer("a letter of a name");
      if (letter < 0 || letter > 255)
        letters.fail("a letter of a name is " + std::to_string(letter) + "; export the mesh again");
      if (letter > 0) {
        entry += static_cast<char>(letter);
        continue;
      }
      const std::size_t blank = std::min(entry.find(' '), entry.size());
      MeshText number(text_.name(), std::string_view(entry).substr(0, blank));
      const std::int64_t region = number.integer("the number of a named region");
      if (blank + 1 < entry.size()) builder.name_group(3, region, entry.substr(blank + 1), letters);
      entry.clear();
      ++names;
    }
    if (!entry.empty() || names != count_of(tag, "NumberOfTuples", 1))
      letters.fail("there are " + std::to_string(names) + " names of regions instead of " +
                   in_quotes(tag.attribute("NumberOfTuples")) + "; export the mesh again");
  }

  /// The corners of groups, in arrays such as "surface:30 capsule".
  void read_groups(const Grid& grid, MeshBuilder& builder) const {
    for (const XmlTag& tag : grid.groups) {
      const std::string array = unescaped(tag.attribute("Name"));
      const std::size_t colon = array.find(':'), blank = std::min(array.find(' ', colon), array.size());
      const auto kind = std::ranges::find(group_kinds, array.substr(0, colon)) - group_kinds.begin();
      const std::int64_t number =
          MeshText(text_.name(), std::string_view(array).substr(colon + 1, blank - colon - 1))
              .integer("the number of a group");
      if (blank < array.size()) builder.name_group(kind, number, array.substr(blank + 1), at(tag));
      const std::size_t size = static_cast<std::size_t>(kind) + 1, count = count_of(tag, "NumberOfTuples", 1);
      const auto points = numbers<std::int64_t>(tag, count, "corners of a group");
      if (count % size != 0)
        at(tag).fail("a group has " + std::to_string(count) + " corners, of which each element needs " +
                     std::to_string(size) + "; export the mesh again");
      const MeshText place = at(tag);  // counts lines, so not once for each corner
      std::array<TetMesh::Index, 3> corners{};
      for (std::size_t i = 0; i < count; i += size) {
        for (std::size_t k = 0; k < size; ++k)
          corners[k] = builder.counted_point(points[i + k], place, number, "group");
        builder.add_to_group(number, std::span(corners).first(size));
      }
    }
  }

  /// The numbers that points and cells had in the file that this one was made from.
  void take_numbers(const Grid& grid, MeshFile& file) const {
    const auto all = [&](std::optional<XmlTag> Piece::*array, std::size_t Piece::*count, const char* what) {
      std::vector<std::int64_t> values;
      for (const Piece& piece : grid.pieces) {
        if (piece.*count == 0) continue;
        if (!(piece.*array)) return std::vector<std::int64_t>{};
        const auto its = numbers<std::int64_t>(*(piece.*array), piece.*count, what);
        values.insert(values.end(), its.begin(), its.end());
      }
      return all_differ(values) ? values : std::vector<std::int64_t>{};
    };
    if (auto points = all(&Piece::point_numbers, &Piece::points, "numbers of points"); !points.empty())
      file.point_numbers = std::move(points);
    if (const auto cells = all(&Piece::cell_numbers, &Piece::cells, "numbers of cells"); !cells.empty())
      for (std::int64_t& number : file.numbers) number = cells[static_cast<std::size_t>(number)];
  }

  /// For errors about what stands behind a tag.
  [[nodiscard]] MeshText at(const XmlTag& tag) const { return text_.part(tag.begin, whole_.size()); }

  [[nodiscard]] std::size_t count_of(const XmlTag& tag, std::string_view name, std::size_t bytes) const {
    const std::string_view value = tag.attribute(name);
    if (value.empty()) at(tag).fail(std::string(name) + " is missing; export the mesh again");
    const std::size_t count = capacity() / bytes;
    const std::int64_t number = MeshText(text_.name(), value).integer("a count");
    if (number < 0 || static_cast<std::size_t>(number) > count)
      at(tag).fail(std::string(name) + " is " + in_quotes(value) +
                   ", more than the file can hold; it is cut off or "
                   "its header is wrong, so export it again");
    return static_cast<std::size_t>(number);
  }

  Grid find_arrays() {
    Grid grid;
    std::vector<XmlTag> open;  // tags whose ends have not come yet
    std::size_t from = 0;
    bool is_vtk = false;
    while (const auto tag = next_tag(text_, whole_, from)) {
      from = tag->end;
      if (tag->name.starts_with('/')) {
        close(open, *tag);
        continue;
      }
      if (is_vtk && open.empty()) at(*tag).fail("the file goes on behind </VTKFile>; export the mesh again");
      if (tag->name == "VTKFile") {
        is_vtk = true;
        read_head(*tag);
      } else if (!is_vtk) {
        at(*tag).fail("a .vtu file begins with <VTKFile> and not with " + in_quotes(tag->name) +
                      "; export the mesh again or correct the extension");
      } else if (tag->name == "Piece") {
        grid.pieces.push_back(
            {.points = count_of(*tag, "NumberOfPoints", 3), .cells = count_of(*tag, "NumberOfCells", 1)});
      } else if (tag->name == "DataArray" || tag->name == "Array") {
        if (open.empty())
          at(*tag).fail("an array stands in no grid; the file is damaged, so copy or export it again");
        take_array(grid, open.back().name, *tag);
      } else if (tag->name == "AppendedData") {
        from = find_appended(*tag);
      }
      if (!tag->empty) open.push_back(*tag);
    }
    require_whole(grid, is_vtk, open, from);
    return grid;
  }

  /// @param open  the tags that are open, the last of which ends here
  void close(std::vector<XmlTag>& open, const XmlTag& end) const {
    if (open.empty() || open.back().name != end.name.substr(1))
      at(end).fail("<" + std::string(end.name) +
                   "> ends no tag before it; the file is damaged, so copy or export it again");
    open.pop_back();
  }

  void take_array(Grid& grid, std::string_view section, const XmlTag& tag) const {
    const std::string_view name = tag.attribute("Name");
    if (tag.attribute("format") == "appended") grid.appended.push_back(tag);
    if (section == "FieldData" && name == "region_names") grid.region_names = tag;
    if (section == "FieldData" && names_group(name)) grid.groups.push_back(tag);
    if (section != "Points" && name.empty())
      at(tag).fail("an array of " + in_quotes(section) + " has no name; export the mesh again");
    if (grid.pieces.empty()) return;
    Piece& piece = grid.pieces.back();
    if (section == "Points" && !piece.coordinates) {
      if (tag.attribute("NumberOfComponents", "3") != "3")
        at(tag).fail("points have " + in_quotes(tag.attribute("NumberOfComponents")) +
                     " coordinates; a body needs 3");
      piece.coordinates = tag;
    }
    if (section == "Cells" && name == "connectivity") piece.connectivity = tag;
    if (section == "Cells" && name == "offsets") piece.offsets = tag;
    if (section == "Cells" && name == "types") piece.types = tag;
    if (section == "CellData" && names_vtk_regions(name)) piece.regions = tag;
    if (section == "CellData" && name == "GlobalElementId") piece.cell_numbers = tag;
    if (section == "CellData" && name == "vtkGhostType") piece.ghosts = tag;
    if (section == "PointData" && name == "GlobalNodeId") piece.point_numbers = tag;
  }

  /// Where the appended data lie, and where tags go on.
  std::size_t find_appended(const XmlTag& tag) {
    appended_base64_ = tag.attribute("encoding", "base64") == "base64";
    const std::size_t mark = whole_.find('_', tag.end), end = whole_.rfind("</AppendedData");
    if (mark == std::string_view::npos)
      at(tag).fail("the mark '_' of the appended data is missing; the file is cut off, so export it again");
    if (end == std::string_view::npos || end <= mark)
      at(tag).fail("</AppendedData> is missing; the file is cut off, so copy or export it again");
    appended_ = whole_.substr(mark + 1, end - mark - 1);
    return end;
  }

  /// @param open, from  the tags without an end, and where the last tag ends
  void require_whole(const Grid& grid, bool is_vtk, const std::vector<XmlTag>& open, std::size_t from) const {
    if (!is_vtk)
      text_.fail("a .vtu file begins with <VTKFile>; export the mesh again or correct the extension");
    if (!open.empty())
      at(open.back())
          .fail("</" + std::string(open.back().name) +
                "> is missing; the file is cut off, so copy or export it again");
    // Comments say nothing; what else could stand here is no tag, or it would have been found.
    if (!text_.part(behind_comments(whole_, from), whole_.size()).at_end())
      text_.fail("the file goes on behind </VTKFile>; export the mesh again");
    const Piece none;
    const std::span<const Piece> pieces =
        grid.pieces.empty() ? std::span(&none, 1) : std::span<const Piece>(grid.pieces);
    for (const Piece& piece : pieces)
      for (const auto& [array, name] : {std::pair(&piece.coordinates, "Points"),
                                        {&piece.connectivity, "connectivity"},
                                        {&piece.offsets, "offsets"},
                                        {&piece.types, "types"}})
        if (!*array && (grid.pieces.size() < 2 || piece.points > 0 || piece.cells > 0))
          text_.fail(std::string("the array ") + name +
                     " is missing; the file is cut off or holds no grid, so "
                     "export it again");
  }

  void read_head(const XmlTag& tag) {
    if (tag.attribute("type") != "UnstructuredGrid")
      at(tag).fail("the file holds " + in_quotes(tag.attribute("type")) +
                   " and no UnstructuredGrid; save an unstructured grid");
    compressor_name_ = tag.attribute("compressor");
    compressor_ = block_compressor(compressor_name_);
    const bool file_is_little = tag.attribute("byte_order", "LittleEndian") == "LittleEndian";
    swapped_ = file_is_little != (std::endian::native == std::endian::little);
    const std::string_view header = tag.attribute("header_type", "UInt32");
    if (header != "UInt32" && header != "UInt64")
      at(tag).fail("the type of headers " + in_quotes(header) +
                   " is not read; export the mesh again with UInt64");
    header_size_ = header == "UInt64" ? 8 : 4;
  }

  /// Refuses arrays in blocks that nobody can unpack. Arrays in words are read whatever the head says.
  void require_compressor(const XmlTag& tag) const {
    if (compressor_ && compressor_->decompress) return;
    const std::string_view name = compressor_name_;
    at(tag).fail("the numbers are compressed with " + in_quotes(name) +
                 (compressor_ ? ", for which this hmax needs the Debian package " +
                                    std::string(compressor_->package) + " when it is built"
                              : ", which is not read") +
                 "; save the mesh uncompressed (in ParaView: Save Data, Compressor Type None; in meshio: "
                 "compression=None)");
  }

  /// More bytes than this the arrays of the file cannot have.
  [[nodiscard]] std::size_t capacity() const { return whole_.size() * (compressor_ ? compressor_->most : 1); }

  /// The i-th number of a header.
  [[nodiscard]] std::size_t announced(std::string_view header, std::size_t i = 0) const {
    const char* number = header.data() + i * header_size_;
    if (header_size_ == 4) return value_from<std::uint32_t>(number, swapped_);
    return static_cast<std::size_t>(value_from<std::uint64_t>(number, swapped_));
  }

  [[noreturn]] void fail_cut_off(const XmlTag& tag) const {
    at(tag).fail("an array is shorter than it says; the file is cut off, so export it again");
  }

  [[nodiscard]] std::size_t offset_of(const XmlTag& tag) const {
    const std::int64_t offset = MeshText(text_.name(), tag.attribute("offset", "none")).integer("an offset");
    if (offset < 0 || static_cast<std::size_t>(offset) > appended_.size())
      at(tag).fail(
          "the offset of an array lies behind the end of the file; it is cut off, so export it again");
    return static_cast<std::size_t>(offset);
  }

  /// Every array in the appended data fills its place up to the next one, used or not: bytes that are lost
  /// anywhere move all that follow.
  void check_appended(const Grid& grid) {
    if (grid.appended.empty()) return;
    if (appended_.empty())
      at(grid.appended.front())
          .fail("the appended data are missing; the file is cut off, so export it again");
    for (const XmlTag& tag : grid.appended) places_.push_back(offset_of(tag));
    places_.push_back(appended_.size());
    std::ranges::sort(places_);
    for (const XmlTag& tag : grid.appended) {
      std::string storage;
      stored(tag, storage);
    }
  }

  /// An array as it is stored, header and values, as long as its header says.
  /// @param storage  holds what had to be decoded
  std::string_view stored(const XmlTag& tag, std::string& storage) const {
    const std::string_view format = tag.attribute("format");
    std::string_view content;
    bool base64 = true;
    if (format == "appended") {
      const std::size_t begin = offset_of(tag);
      const auto next = std::ranges::upper_bound(places_, begin);
      content = appended_.substr(begin, (next == places_.end() ? appended_.size() : *next) - begin);
      base64 = appended_base64_;
    } else if (format == "binary") {
      content = whole_.substr(tag.end, std::min(whole_.find('<', tag.end), whole_.size()) - tag.end);
    } else {
      at(tag).fail("the format " + in_quotes(format) +
                   " of an array is not read; it is ascii, binary or appended");
    }
    if (base64) {
      auto decoded = decode_base64(content);
      if (!decoded) at(tag).fail("an array is no base64; the file was damaged, so export it again");
      storage = *std::move(decoded);
      content = storage;
    }
    const std::size_t size = compressor_name_.empty() ? plain_size(tag, content) : packed_size(tag, content);
    // Behind the last array comes the line of the end tag.
    if (content.find_first_not_of(" \t\r\n", size) != std::string_view::npos)
      at(tag).fail("an array is longer than it says; the file was damaged, so export it again");
    if (format == "appended" && !base64 &&
        content.data() + content.size() == appended_.data() + appended_.size())
      require_end_of_data(tag, content.substr(0, size), content.substr(size));
    return content.substr(0, size);
  }

  /// Refuses raw data whose last array has drawn in the line break behind it, since a byte was lost before.
  /// @param values, behind  the last array, and what stands between it and the end tag
  void require_end_of_data(const XmlTag& tag, std::string_view values, std::string_view behind) const {
    const bool whole = behind.empty() ? !values.ends_with('\n') : behind.find_first_of("\r\n") == 0;
    if (!whole)
      at(tag).fail(
          "no line break is between the appended data and their end tag; bytes were lost or added, so copy or "
          "export the file again");
  }

  /// Of an array as one block: its size, and then the values.
  [[nodiscard]] std::size_t plain_size(const XmlTag& tag, std::string_view content) const {
    if (content.size() < header_size_ || announced(content) > content.size() - header_size_)
      fail_cut_off(tag);
    return header_size_ + announced(content);
  }

  [[nodiscard]] std::size_t head_size(std::size_t blocks) const {
    return (blocks == 0 ? 1 : 3 + blocks) * header_size_;
  }

  /// Of an array of blocks: their number, the size of each and of the last one where that is smaller, their
  /// compressed sizes, and then the blocks.
  [[nodiscard]] std::size_t packed_size(const XmlTag& tag, std::string_view content) const {
    if (content.size() < header_size_) fail_cut_off(tag);
    const std::size_t blocks = announced(content);
    if (blocks > content.size() / header_size_ || head_size(blocks) > content.size()) fail_cut_off(tag);
    std::size_t size = head_size(blocks);
    for (std::size_t b = 0; b < blocks; ++b) {
      if (announced(content, 3 + b) > content.size() - size) fail_cut_off(tag);
      size += announced(content, 3 + b);
    }
    return size;
  }

  /// The values of an array of exactly `size` bytes. @param storage  holds what had to be decoded
  std::string_view bytes_of(const XmlTag& tag, std::size_t size, std::string& storage) const {
    std::string_view content = stored(tag, storage);
    if (!compressor_name_.empty()) {
      require_compressor(tag);
      storage = decompressed(tag, content, size);
      content = storage;
    } else {
      content.remove_prefix(header_size_);
    }
    if (content.size() != size)
      at(tag).fail("an array has " + std::to_string(content.size()) + " bytes instead of " +
                   std::to_string(size) + "; export the mesh again");
    return content;
  }

  /// The blocks of an array. @param size  of all of them, beyond which nothing is unpacked
  [[nodiscard]] std::string decompressed(const XmlTag& tag, std::string_view content,
                                         std::size_t size) const {
    const std::size_t blocks = announced(content);
    std::string bytes;
    std::size_t begin = head_size(blocks);
    for (std::size_t b = 0; b < blocks; ++b) {
      const std::size_t last = announced(content, 2), packed = announced(content, 3 + b);
      const std::size_t plain = b + 1 == blocks && last != 0 ? last : announced(content, 1);
      // Room is made only for what the block can hold and the array can take.
      const bool fits = plain <= size - bytes.size() && plain / compressor_->most <= packed;
      if (fits) bytes.resize(bytes.size() + plain);
      if (!fits ||
          !compressor_->decompress(content.substr(begin, packed), bytes.data() + bytes.size() - plain, plain))
        at(tag).fail("a compressed block of an array is damaged; export the mesh again");
      begin += packed;
    }
    return bytes;
  }

  template <class T>
  std::vector<T> numbers(const XmlTag& tag, std::size_t count, const char* what) const {
    std::vector<T> values;
    const std::string_view type = tag.attribute("type");
    const auto known = std::find_if(number_types.begin(), number_types.end(),
                                    [&](const NumberType& each) { return each.name == type; });
    if (known == number_types.end())
      at(tag).fail("the type " + in_quotes(type) +
                   " of an array is not read; save the mesh with Float64 and Int64");
    if (tag.attribute("format", "ascii") == "ascii") {
      MeshText text = text_.part(tag.end, std::min(whole_.find('<', tag.end), whole_.size()));
      text.require_room(count, what, 2);
      values.reserve(count);
      for (std::size_t i = 0; i < count; ++i) {
        if constexpr (std::is_same_v<T, double>)
          values.push_back(text.number("a coordinate"));
        else
          values.push_back(text.label("a whole number of an array"));
      }
      if (!text.at_end())
        text.fail("an array goes on with " + in_quotes(text.peek()) + " behind its " + std::to_string(count) +
                  " numbers; the file is damaged, so copy or export it again");
      return values;
    }
    if (count > capacity())
      at(tag).fail("the file announces " + std::to_string(count) + " " + what +
                   ", more than it can hold; it is cut off or its header is wrong, so export it again");
    std::string storage;
    const std::string_view bytes = bytes_of(tag, count * known->size, storage);
    values.reserve(count);
    for (std::size_t i = 0; i < count; ++i) values.push_back(value<T>(tag, bytes.data() + i * known->size));
    return values;
  }

  template <class T>
  T value(const XmlTag& tag, const char* bytes) const {
    const std::string_view type = tag.attribute("type");
    if (!type.starts_with("Float")) return converted<T>(type, bytes, swapped_);
    const double real =
        type == "Float32" ? value_from<float>(bytes, swapped_) : value_from<double>(bytes, swapped_);
    if constexpr (!std::is_same_v<T, double>)
      if (!(std::abs(real) < 9e18 && real == std::floor(real)))
        at(tag).fail("an array of whole numbers holds " + to_text(real) +
                     "; correct it or export the mesh again");
    return static_cast<T>(real);
  }

  MeshText text_;
  std::string_view whole_;
  std::string_view appended_;
  std::vector<std::size_t> places_;  ///< where arrays begin in it, and its end
  std::size_t header_size_ = 4;
  std::string_view compressor_name_;             ///< empty where arrays are plain
  const BlockCompressor* compressor_ = nullptr;  ///< null where nobody knows it
  bool appended_base64_ = true, swapped_ = false;
};

}  // namespace

MeshFile read_vtu(const std::string& name, std::string_view text) { return VtuReader(name, text).read(); }

}  // namespace hmax
