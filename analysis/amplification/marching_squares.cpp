#include "analysis/amplification/marching_squares.hpp"

#include <algorithm>
#include <array>
#include <unordered_map>
#include <unordered_set>

namespace hmax {
namespace {

/// Each side that the border crosses, and the next one.
class Crossings {
 public:
  Crossings(const GridNodes& nodes, const std::function<bool(int i, int j)>& middle_is_inside)
      : nodes_(nodes), middle_is_inside_(middle_is_inside) {
    for (int j = 0; j + 1 < nodes.cols(); ++j)
      for (int i = 0; i + 1 < nodes.rows(); ++i) link_in_square(i, j);
  }

  std::vector<GridCurve> curves() {
    std::vector<GridCurve> curves;
    for (const bool open : {true, false})
      for (const int start : starts_)
        if (next_.contains(start) && open != reached_.contains(start)) curves.push_back(follow(start));
    return curves;
  }

 private:
  [[nodiscard]] int name_of(int i, int j, bool upward) const {
    return 2 * (j * static_cast<int>(nodes_.rows()) + i) + (upward ? 1 : 0);
  }
  [[nodiscard]] GridSide side_of(int name) const {
    const int columns = static_cast<int>(nodes_.rows());
    return {name / 2 % columns, name / 2 / columns, name % 2 == 1};
  }

  void link_in_square(int i, int j) {
    // Corners counter-clockwise from the lower left one; side e runs from corner e to corner e + 1.
    const std::array<GridNode, 4> corner{nodes_(i, j), nodes_(i + 1, j), nodes_(i + 1, j + 1),
                                         nodes_(i, j + 1)};
    if (std::ranges::find(corner, GridNode::unknown) != corner.end()) return;
    // With the set to its left a curve enters where the corners go out of it and leaves where they go back.
    std::array<std::size_t, 2> entries{}, exits{};
    std::size_t entered = 0, left = 0;
    for (std::size_t e = 0; e < 4; ++e) {
      const GridNode a = corner[e], b = corner[(e + 1) % 4];
      if (a > b) entries[entered++] = e;
      if (a < b) exits[left++] = e;
    }
    const std::array<int, 4> names{name_of(i, j, false), name_of(i + 1, j, true), name_of(i, j + 1, false),
                                   name_of(i, j, true)};
    const auto link = [&](std::size_t from, std::size_t to) {
      next_[names[from]] = names[to];
      reached_.insert(names[to]);
      starts_.push_back(names[from]);
    };
    if (entered == 1) link(entries[0], exits[0]);
    if (entered < 2) return;
    // Around a lone corner inside the curve leaves by the side before, around one outside by the next.
    const bool joined = middle_is_inside_(i, j);
    for (const std::size_t entry : entries) link(entry, (entry + (joined ? 1 : 3)) % 4);
  }

  /// From side to side until the curve comes back or ends.
  GridCurve follow(int start) {
    GridCurve curve;
    int name = start;
    for (auto found = next_.find(name); found != next_.end(); found = next_.find(name)) {
      curve.sides.push_back(side_of(name));
      name = found->second;
      next_.erase(found);
    }
    curve.closed = name == start;
    if (!curve.closed) curve.sides.push_back(side_of(name));
    return curve;
  }

  const GridNodes& nodes_;
  const std::function<bool(int i, int j)>& middle_is_inside_;
  std::unordered_map<int, int> next_;  ///< taken out by follow()
  std::unordered_set<int> reached_;    ///< that are the next of another one
  std::vector<int> starts_;
};

}  // namespace

std::vector<GridCurve> border_of(const GridNodes& nodes,
                                 const std::function<bool(int i, int j)>& middle_is_inside) {
  return Crossings(nodes, middle_is_inside).curves();
}

}  // namespace hmax
