#include "catalogue/models/support_sets.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <fstream>
#include <limits>
#include <optional>

#include <fmt/format.h>

#include "catalogue/input/suggest.hpp"
#include "core/input_error.hpp"
#include "core/numbers.hpp"
#include "core/own_files.hpp"
#include "core/sort_unique.hpp"
#include "core/text/split.hpp"
#include "core/text/utf8.hpp"
#include "problems/tissue/loads.hpp"

namespace hmax {

namespace {

using Index = TetMesh::Index;

std::optional<std::int64_t> whole_number(std::string_view text) {
  std::int64_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return number;
}

/// The points of a mesh by the numbers of its file.
class NumberedPoints {
 public:
  explicit NumberedPoints(const LoadedMesh& mesh) : mesh_(mesh), model_points_(mesh.origin->model_points()) {
    const std::vector<std::int64_t>& numbers = mesh.origin->file.point_numbers;
    for (std::size_t i = 0; i < numbers.size(); ++i)
      by_number_.emplace_back(numbers[i], static_cast<Index>(i));
    for (const auto& [number, point] : mesh.origin->file.merged) by_number_.emplace_back(number, point);
    std::ranges::sort(by_number_);
  }

  /// @param where  what names the point, for the error
  [[nodiscard]] Index find(std::string_view text, std::string_view where) const {
    const auto number = whole_number(text);
    if (!number)
      throw input_error("{} has '{}', which is no number of a point; write whole numbers like 1,5,9", where,
                        text);
    const auto found = std::ranges::lower_bound(by_number_, *number, {}, &Entry::first);
    if (found == by_number_.end() || found->first != *number)
      throw input_error("{} names point {}, but the points of {} are numbered from {} to {}{}", where,
                        *number, mesh_.name, by_number_.front().first, by_number_.back().first,
                        dense() ? "; correct it" : " with gaps; correct it");
    const Index point = model_points_[static_cast<std::size_t>(found->second)];
    if (point < 0)
      throw input_error("{} names point {}, which is in no tetrahedron; leave it out", where, *number);
    return point;
  }

 private:
  using Entry = std::pair<std::int64_t, Index>;
  [[nodiscard]] bool dense() const {
    return by_number_.back().first - by_number_.front().first + 1 ==
           static_cast<std::int64_t>(by_number_.size());
  }
  const LoadedMesh& mesh_;
  std::vector<Index> model_points_;
  std::vector<Entry> by_number_;
};

/// @param set  points:1,5,9
std::vector<Index> listed_points(std::string_view set, const NumberedPoints& points) {
  constexpr std::size_t most_shown = 60;
  const std::string where =
      set.size() <= most_shown ? std::string(set) : fmt::format("{}...", set.substr(0, most_shown));
  std::vector<Index> found;
  for (const std::string_view part : split(set.substr(set.find(':') + 1), ","))
    found.push_back(points.find(part, where));
  return found;
}

std::vector<Index> points_in_file(const std::string& file, const NumberedPoints& points) {
  note_input(file);
  std::ifstream in(file);
  if (!in)
    throw input_error("there is no file '{}' with the points of a support; correct the name behind @", file);
  std::vector<Index> found;
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    const std::string_view text = number == 1 ? without_byte_order_mark(line) : line;
    for (const std::string_view word : split(text.substr(0, text.find('#')), " \t\r,"))
      if (!word.empty()) found.push_back(points.find(word, fmt::format("{}, line {}", file, number)));
  }
  return found;
}

/// Points with those that were inserted between two of them: nobody can name these, and between points of
/// four-node tetrahedra that are held nothing moves.
std::vector<Index> with_inserted(std::vector<Index> points, const LoadedMesh& mesh) {
  const MeshOrigin& origin = *mesh.origin;
  if (origin.file.inserted.empty()) return points;
  std::vector<char> is_in(static_cast<std::size_t>(mesh.mesh.point_count()), 0);
  for (const Index point : points) is_in[static_cast<std::size_t>(point)] = 1;
  const std::vector<Index> model_points = origin.model_points();
  const auto model_point = [&](Index i) { return model_points[static_cast<std::size_t>(i)]; };
  const auto has = [&](Index i) { return is_in[static_cast<std::size_t>(model_point(i))] != 0; };
  for (const auto& [point, one, other] : origin.file.inserted)
    if (has(one) && has(other)) points.push_back(model_point(point));
  return points;
}

/// Six numbers with commas between them; nothing where the text is none.
std::optional<std::array<double, 6>> box_of(const std::string& text) {
  const std::vector<std::string_view> parts = split(text, ",");
  std::array<double, 6> box{};
  if (parts.size() != box.size()) return std::nullopt;
  for (std::size_t i = 0; i < box.size(); ++i) {
    const auto side = to_number(parts[i]);
    if (!side || std::isnan(*side)) return std::nullopt;
    box[i] = *side;
  }
  return box;
}

/// One side of a plane across an axis, with the plane.
struct HalfSpace {
  int axis;
  bool below;
  double bound;  ///< [m]

  [[nodiscard]] std::vector<Index> points(const TetMesh& mesh) const {
    std::vector<Index> inside;
    for (Index i = 0; i < mesh.point_count(); ++i)
      if (const double x = mesh.points(axis, i); below ? x <= bound : x >= bound) inside.push_back(i);
    return inside;
  }
};

/// "z<0.01", "x >= -0.2"; nothing where the text does not begin like that.
/// @throws InputError  where no number follows
std::optional<HalfSpace> half_space_of(const std::string& text) {
  constexpr std::string_view axes = "xyz", blanks = " \t";
  const std::size_t sign = text.find_first_of("<>"), name = text.find_first_not_of(blanks);
  if (sign == std::string::npos || name >= sign || axes.find(text[name]) == std::string_view::npos ||
      text.find_first_not_of(blanks, name + 1) != sign)
    return std::nullopt;
  const std::size_t number = sign + (text.substr(sign + 1, 1) == "=" ? 2 : 1);
  const auto bound = to_number(text.substr(number));
  if (!bound || std::isnan(*bound))
    throw input_error("the support '{}' is not one axis and one number of metres; write it like z<0.01",
                      text);
  return HalfSpace{static_cast<int>(axes.find(text[name])), text[sign] == '<', *bound};
}

/// The groups and regions that are called by `id`, of one kind or, without one, by their names alone.
struct Called {
  std::vector<const MeshGroup*> groups;
  std::vector<Index> regions;  ///< numbers of the file
  std::vector<std::string> known;

  Called(const MeshOrigin& origin, const std::string& id, std::optional<int> kind) {
    // Groups have no such number.
    constexpr std::int64_t none = std::numeric_limits<std::int64_t>::min();
    const std::int64_t number = kind ? whole_number(id).value_or(none) : none;
    const auto is_called = [&](int dimension, std::int64_t its_number, const std::string& name) {
      if (kind && *kind != dimension) return false;
      known.push_back(!kind && !name.empty()
                          ? name
                          : fmt::format("{}:{}", group_kinds[static_cast<std::size_t>(dimension)],
                                        name.empty() ? std::to_string(its_number) : name));
      return (!name.empty() && name == id) || number == its_number;
    };
    for (const MeshGroup& group : origin.file.groups)
      if (is_called(group.dimension, group.number, group.name)) groups.push_back(&group);
    for (const Index region : origin.regions) {
      const auto named = origin.file.names.find(region);
      if (is_called(3, region, named == origin.file.names.end() ? "" : named->second))
        regions.push_back(region);
    }
  }
};

std::vector<Index> called_points(const std::string& set, const LoadedMesh& mesh) {
  const MeshOrigin& origin = *mesh.origin;
  const std::size_t colon = set.find(':');
  const auto kind = std::ranges::find(group_kinds, std::string_view(set).substr(0, colon));
  const bool has_kind = colon != std::string::npos && kind != group_kinds.end();
  const Called called(origin, has_kind ? set.substr(colon + 1) : set,
                      has_kind ? std::optional(static_cast<int>(kind - group_kinds.begin())) : std::nullopt);
  const std::size_t count = called.groups.size() + called.regions.size();
  if (count == 0)
    throw input_error("{} has no group or region '{}'; {}", mesh.name, set,
                      called.known.empty() || set.find_first_of("<>=") != std::string::npos
                          ? "hold a box, z<0.01, points:1,5,9 or @FILE instead"
                          : suggestion(set, called.known));
  if (count > 1)
    throw input_error(
        "'{}' is the name of {} groups and regions of {}; write its kind and its number, like surface:30",
        set, count, mesh.name);
  std::vector<Index> points;
  if (!called.groups.empty()) {
    const std::vector<Index> model_points = origin.model_points();
    for (const Index corner : called.groups.front()->corners)
      if (const Index point = model_points[static_cast<std::size_t>(corner)]; point >= 0)
        points.push_back(point);
    return called.groups.front()->dimension == 0 ? with_inserted(std::move(points), mesh) : points;
  }
  const auto region = std::ranges::find(origin.regions, called.regions.front()) - origin.regions.begin();
  for (Eigen::Index t = 0; t < mesh.mesh.tetrahedron_count(); ++t)
    if (mesh.mesh.region(t) == region)
      points.insert(points.end(), mesh.mesh.tetrahedra.col(t).begin(), mesh.mesh.tetrahedra.col(t).end());
  return points;
}

/// "the mesh reaches from 0 to 0.1 m along z" of a half-space; nothing of other sets.
std::string range_along(const std::string& set, const TetMesh& mesh) {
  const auto half = box_of(set) ? std::nullopt : half_space_of(set);
  if (!half) return "";
  return fmt::format("the mesh reaches from {} to {} m along {}",
                     short_number(mesh.points.row(half->axis).minCoeff(), 4),
                     short_number(mesh.points.row(half->axis).maxCoeff(), 4), "xyz"[half->axis]);
}

/// @param numbered  made for the first set that asks for numbers
std::vector<Index> points_of_set(const std::string& set, const LoadedMesh& mesh,
                                 std::optional<NumberedPoints>& numbered) {
  const bool is_list = set.starts_with("points:"), is_file = set.starts_with('@');
  if ((is_list || is_file) && !numbered) numbered.emplace(mesh);
  std::vector<Index> points;
  if (is_list)
    points = with_inserted(listed_points(set, *numbered), mesh);
  else if (is_file)
    points = with_inserted(points_in_file(set.substr(1), *numbered), mesh);
  else if (const auto box = box_of(set))
    points = points_in_box(mesh.mesh, {(*box)[0], (*box)[2], (*box)[4]}, {(*box)[1], (*box)[3], (*box)[5]});
  else if (const auto half = half_space_of(set))
    points = half->points(mesh.mesh);
  else
    points = called_points(set, mesh);
  if (points.empty()) {
    const std::string range = range_along(set, mesh.mesh);
    throw input_error("no point of {} is in the support '{}'; {}", mesh.name, set,
                      !range.empty() ? range
                      : box_of(set)  ? "give a larger box, in metres"
                                     : "name another set");
  }
  sort_unique(points);
  return points;
}

}  // namespace

std::vector<std::vector<TetMesh::Index>> points_of_each(const std::vector<std::string>& sets,
                                                        const LoadedMesh& mesh) {
  std::optional<NumberedPoints> numbered;
  std::vector<std::vector<Index>> points;
  for (const std::string& set : sets) points.push_back(points_of_set(set, mesh, numbered));
  return points;
}

std::vector<TetMesh::Index> union_of_sets(const std::vector<std::string>& sets, const LoadedMesh& mesh) {
  std::vector<Index> points;
  for (const std::vector<Index>& more : points_of_each(sets, mesh))
    points.insert(points.end(), more.begin(), more.end());
  sort_unique(points);
  return points;
}

std::vector<TetMesh::Index> points_of_sets(const std::vector<std::string>& sets, const LoadedMesh& mesh) {
  std::vector<Index> points = union_of_sets(sets, mesh);
  if (static_cast<Eigen::Index>(points.size()) == mesh.mesh.point_count()) {
    const std::string range = range_along(sets.front(), mesh.mesh);
    throw input_error("the supports hold every point of {}, so that nothing moves; {}", mesh.name,
                      range.empty() ? "hold fewer" : range);
  }
  return points;
}

}  // namespace hmax
