#include "problems/mesh/files/mesh_file.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <limits>
#include <numeric>
#include <set>
#include <stdexcept>

#include "core/process/whole_file.hpp"
#include "core/text/utf8.hpp"
#include "problems/mesh/files/mesh_readers.hpp"
#include "problems/mesh/topology.hpp"

namespace hmax {

namespace {

namespace fs = std::filesystem;

/// A form of mesh files.
struct MeshFormat {
  std::string_view extension;
  /// From the bytes of one file; null where a mesh takes two. @param name  in errors
  MeshFile (*read)(const std::string& name, std::string_view text);
};
constexpr std::array<MeshFormat, 11> formats{{{".msh", read_gmsh},
                                              {".vtk", read_vtk},
                                              {".vtu", read_vtu},
                                              {".node", nullptr},
                                              {".ele", nullptr},
                                              {".mesh", read_medit},
                                              {".veg", read_vega},
                                              {".inp", read_inp},
                                              {".scn", read_sofa},
                                              {".feb", read_febio},
                                              {".xml", read_mujoco}}};

/// ".msh .vtk .vtu ..."
std::string known_extensions() {
  std::string known;
  for (const MeshFormat& format : formats)
    known += (known.empty() ? "" : " ") + std::string(format.extension);
  return known;
}

std::string lower_extension(const fs::path& file) { return lower(file.extension().string()); }

/// The form of a file by its name; null where there is none.
const MeshFormat* format_of(const fs::path& file) {
  const auto* const found = std::ranges::find(formats, lower_extension(file), &MeshFormat::extension);
  return found == formats.end() ? nullptr : found;
}

/// Room for `more` behind what there is. Room for just these would move all for each of many pieces.
template <class T>
void reserve_more(std::vector<T>& list, std::size_t more) {
  const std::size_t needed = list.size() + more;
  if (needed > list.capacity()) list.reserve(std::max(needed, 2 * list.capacity()));
}

}  // namespace

void ExtraColumns::skip(MeshText& text, const char* row) {
  const std::size_t here = text.skip_rest_of_line();
  if (here != count_.value_or(here))
    text.fail("the line of " + std::string(row) + " has " + std::to_string(here) +
              " numbers too many and the first one " + std::to_string(*count_) +
              "; the file is damaged, so copy or export it again");
  count_ = here;
}

std::string MeshFile::where(Eigen::Index tetrahedron) const {
  const auto t = static_cast<std::size_t>(tetrahedron);
  return place_in_words(name, places[t], places_are_bytes) + "tetrahedron " + std::to_string(numbers[t]);
}

std::string MeshFile::material_left_out() const {
  if (material.empty()) return "";
  return material + "this material is not in a mesh; give one by --set E= or --material" +
         (format == "Vega" ? "" : ", or take the whole file by --scene");
}

std::string MeshFile::region_in_words(TetMesh::Index region) const {
  const auto named = names.find(region);
  return std::to_string(region) + (named == names.end() ? "" : " '" + named->second + "'");
}

void add_points_group(MeshFile& file, std::string_view name, const std::set<TetMesh::Index>& points) {
  if (points.empty()) return;
  const auto behind =
      std::ranges::find_if(file.groups, [](const MeshGroup& group) { return group.dimension > 0; });
  const std::int64_t last = behind == file.groups.begin() ? 0 : std::prev(behind)->number;
  file.groups.insert(behind, {.dimension = 0,
                              .number = std::max<std::int64_t>(last, 0) + 1,  // 0 is no group
                              .name = std::string(name),
                              .corners = {points.begin(), points.end()}});
}

MeshFile counted_from_one(TetMesh mesh, std::string name) {
  MeshFile file{
      .name = std::move(name), .format = "by name", .mesh = std::move(mesh), .numbers = {}, .places = {}};
  file.numbers.resize(static_cast<std::size_t>(file.mesh.tetrahedron_count()));
  file.point_numbers.resize(static_cast<std::size_t>(file.mesh.point_count()));
  file.places.resize(file.numbers.size());
  std::iota(file.numbers.begin(), file.numbers.end(), 1);
  std::iota(file.point_numbers.begin(), file.point_numbers.end(), 1);
  return file;
}

MeshFile read_mesh(const std::string& name, std::string_view text) {
  if (const MeshFormat* format = format_of(name); format != nullptr && format->read != nullptr)
    return format->read(name, without_byte_order_mark(text));
  throw std::invalid_argument("'" + name + "' is no mesh by its extension; name a file " +
                              known_extensions());
}

MeshFile read_mesh_file(const fs::path& file) {
  constexpr std::string_view what = "a mesh file";
  const MeshFormat* format = format_of(file);
  if (format == nullptr || format->read != nullptr) {
    std::error_code ignored;
    if (fs::is_directory(file, ignored))
      throw std::invalid_argument("'" + file.string() + "' is a folder; name a file " + known_extensions() +
                                  " in it");
    if (fs::exists(file, ignored) && format == nullptr)
      return read_mesh(file.string(), "");  // which says what extensions there are
    return within_memory(file, [&] { return read_mesh(file.string(), read_whole(file, what)); });
  }
  fs::path node = file, ele = file;
  if (lower_extension(file) == ".ele")
    node.replace_extension(".node");
  else
    ele.replace_extension(".ele");
  return within_memory(ele, [&] {
    const std::string points = read_whole(node, what);
    return read_tetgen(node.string(), points, ele.string(), read_whole(ele, what));
  });
}

void MeshBuilder::reserve_points(std::size_t points) { reserve_more(points_, 3 * points); }

void MeshBuilder::reserve_tetrahedra(std::size_t tetrahedra) {
  reserve_more(corners_, 4 * tetrahedra);
  reserve_more(regions_, tetrahedra);
  reserve_more(element_numbers_, tetrahedra);
  reserve_more(places_, tetrahedra);
}

void MeshBuilder::add_point(double x, double y, double z) { points_.insert(points_.end(), {x, y, z}); }

void MeshBuilder::add_point(std::int64_t number, double x, double y, double z) {
  by_number_.emplace_back(number, static_cast<Index>(point_count()));
  add_point(x, y, z);
}

void MeshBuilder::number_points(const MeshText& text) {
  std::ranges::sort(by_number_);
  const auto twice = std::ranges::adjacent_find(by_number_, {}, &std::pair<std::int64_t, Index>::first);
  if (twice != by_number_.end())
    text.fail("node " + std::to_string(twice->first) +
              " is given twice; remove one of them or export the mesh again");
  dense_.clear();
  if (by_number_.empty() || by_number_.front().first < 0) return;
  const auto highest = static_cast<std::uint64_t>(by_number_.back().first);
  if (highest > 4 * by_number_.size() + 1000) return;
  dense_.assign(highest + 1, -1);
  for (const auto& [number, point] : by_number_) dense_[static_cast<std::size_t>(number)] = point;
}

MeshBuilder::Index MeshBuilder::numbered_point(std::int64_t number, const MeshText& text,
                                               std::int64_t element, const char* what) const {
  if (!dense_.empty()) {
    if (number >= 0 && number < static_cast<std::int64_t>(dense_.size())) {
      const Index point = dense_[static_cast<std::size_t>(number)];
      if (point >= 0) return point;
    }
  } else {
    const auto found =
        std::ranges::lower_bound(by_number_, number, {}, &std::pair<std::int64_t, Index>::first);
    if (found != by_number_.end() && found->first == number) return found->second;
  }
  text.fail(std::string(what) + " " + std::to_string(element) + " needs node " + std::to_string(number) +
            ", which the file does not have; export the mesh again with all its nodes");
}

MeshBuilder::Index MeshBuilder::counted_point(std::int64_t number, const MeshText& text, std::int64_t element,
                                              const char* what) const {
  const auto count = static_cast<std::int64_t>(point_count());
  if (number < first_ || number >= first_ + count)
    text.fail(std::string(what) + " " + std::to_string(element) + " needs point " + std::to_string(number) +
              (count == 0 ? ", but there are no points before it"
                          : ", but the points are " + std::to_string(first_) + " to " +
                                std::to_string(first_ + count - 1)) +
              "; export the mesh again with all its points");
  return static_cast<Index>(number - first_);
}

void MeshBuilder::add_tetrahedron(const std::array<Index, 4>& corners, std::int64_t number,
                                  std::int64_t place, std::int64_t region, const MeshText& text) {
  corners_.insert(corners_.end(), corners.begin(), corners.end());
  element_numbers_.push_back(number);
  places_.push_back(place);
  regions_.push_back(0);
  set_region(regions_.size() - 1, region, text);
}

void MeshBuilder::add_middles(std::span<const Index, 6> middles, const MiddleOrder& edges) {
  ++second_order_;
  middles_.resize(6 * tetrahedron_count(), -1);
  for (std::size_t k = 0; k < 6; ++k) {
    const auto place = std::ranges::find(tetrahedron_edges, edges[k]) - tetrahedron_edges.begin();
    middles_[middles_.size() - 6 + static_cast<std::size_t>(place)] = middles[k];
  }
}

void MeshBuilder::set_region(std::size_t tetrahedron, std::int64_t region, const MeshText& text) {
  if (region < std::numeric_limits<Index>::min() || region > std::numeric_limits<Index>::max())
    text.fail("tetrahedron " + std::to_string(element_numbers_[tetrahedron]) + " has the region " +
              std::to_string(region) + ", beyond 32 bits; number the regions from 1");
  regions_[tetrahedron] = static_cast<Index>(region);
  if (region != 0) regions_differ_ = true;
}

void MeshBuilder::add_to_group(std::int64_t group, std::span<const Index> corners) {
  if (group == 0) return;
  std::vector<Index>& all = groups_[{static_cast<int>(corners.size()) - 1, group}];
  all.insert(all.end(), corners.begin(), corners.end());
}

void MeshBuilder::name_group(std::int64_t dimension, std::int64_t number, std::string name,
                             const MeshText& text) {
  if (std::ranges::any_of(name, [](char c) { return (c >= 0 && c < ' ') || c == 127; }))
    text.fail("the name " + in_quotes(name) + " of group " + std::to_string(number) +
              " has a control character; rename the group");
  names_[{dimension, number}] = std::move(name);
}

MeshFile MeshBuilder::finish(const MeshText& text, std::string format) {
  if (corners_.empty()) {
    if (triangles_ > 0)
      text.fail("the file holds " + std::to_string(triangles_) +
                " triangles and no tetrahedra, a surface only; fill it first, for instance with "
                "`gmsh -3` or `tetgen -p`");
    text.fail("the file holds no tetrahedra; export the volume elements too");
  }
  MeshFile file;
  file.name = text.name();
  file.format = std::move(format);
  file.mesh.points =
      Eigen::Map<const Eigen::Matrix3Xd>(points_.data(), 3, static_cast<Eigen::Index>(point_count()));
  file.mesh.tetrahedra = Eigen::Map<const TetMesh::Tetrahedra>(
      corners_.data(), 4, static_cast<Eigen::Index>(tetrahedron_count()));
  if (!middles_.empty()) {
    middles_.resize(6 * tetrahedron_count(), -1);
    file.middles = Eigen::Map<const MeshFile::Middles>(middles_.data(), 6, file.mesh.tetrahedron_count());
  }
  if (regions_differ_) file.mesh.regions = std::move(regions_);
  file.numbers = std::move(element_numbers_);
  file.places = std::move(places_);
  file.places_are_bytes = text.counts_bytes();
  file.triangles = static_cast<Eigen::Index>(triangles_);
  file.second_order = static_cast<Eigen::Index>(second_order_);
  file.point_numbers.resize(point_count());
  std::iota(file.point_numbers.begin(), file.point_numbers.end(), first_);
  for (const auto& [number, point] : by_number_) file.point_numbers[static_cast<std::size_t>(point)] = number;
  const std::set<Index> used(file.mesh.regions.begin(), file.mesh.regions.end());
  for (const Index region : used)
    if (const auto named = names_.find({3, region}); named != names_.end())
      file.names[region] = named->second;
  const auto in_words = [&](std::int64_t region) {
    const auto named = names_.find({3, region});
    return std::to_string(region) + (named == names_.end() ? "" : " " + in_quotes(named->second));
  };
  for (const auto& [region, second] : second_regions_)
    file.remarks.push_back(file.name + ": tetrahedra of region " + in_words(region) + " are in " +
                           in_words(second) + " too, which is left out: each has one");
  for (auto& [key, corners] : groups_) {
    const auto named = names_.find(key);
    file.groups.push_back({.dimension = key.first,
                           .number = key.second,
                           .name = named == names_.end() ? "" : named->second,
                           .corners = std::move(corners)});
  }
  return file;
}

void require_readable(CellKind kind, std::int64_t type, std::int64_t element, const MeshText& text) {
  const std::string which = "element " + std::to_string(element) + " is of type " + std::to_string(type);
  if (kind == CellKind::high_order)
    text.fail(which + ", a tetrahedron of order 3 or more; save the mesh with elements of order 1 or 2");
  if (kind == CellKind::other_volume)
    text.fail(which + ", a volume that is no tetrahedron; mesh the body with tetrahedra only");
  if (kind == CellKind::unknown) text.fail(which + ", which nobody knows; export the mesh again");
}

}  // namespace hmax
