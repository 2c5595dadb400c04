#include "problems/mesh/files/mesh_defects.hpp"

#include <algorithm>
#include <array>
#include <span>
#include <stdexcept>

#include "problems/mesh/faces.hpp"
#include "problems/mesh/mesh_quality.hpp"
#include "problems/mesh/topology.hpp"

namespace hmax {

namespace {

using Index = TetMesh::Index;

std::vector<std::pair<Index, Index>> duplicates_of(const TetMesh& mesh) {
  std::vector<std::pair<std::array<Index, 4>, Index>> keys(
      static_cast<std::size_t>(mesh.tetrahedron_count()));
  for (std::size_t t = 0; t < keys.size(); ++t) {
    for (int i = 0; i < 4; ++i)
      keys[t].first[static_cast<std::size_t>(i)] = mesh.tetrahedra(i, static_cast<Eigen::Index>(t));
    std::ranges::sort(keys[t].first);
    keys[t].second = static_cast<Index>(t);
  }
  std::ranges::sort(keys);
  std::vector<std::pair<Index, Index>> duplicates;
  for (std::size_t i = 1, first = 0; i < keys.size(); ++i) {
    if (keys[i].first == keys[first].first)
      duplicates.emplace_back(keys[i].second, keys[first].second);
    else
      first = i;
  }
  std::ranges::sort(duplicates);
  return duplicates;
}

/// True when two triangles of the same points run round in the same sense.
bool same_turn(const std::array<Index, 3>& a, const std::array<Index, 3>& b) {
  const auto place = std::ranges::find(b, a[0]) - b.begin();
  return b[static_cast<std::size_t>((place + 1) % 3)] == a[1];
}

/// Two tetrahedra lie on the same side of their common face where it looks outward from both or inward from
/// both. That is combinatorial but for the signs of the volumes, which rounding cannot change where the
/// volume is not that of rounding.
/// @param sign  of the volume of each tetrahedron, 0 of flat ones
std::vector<std::pair<Index, Index>> overlaps_of(const TetMesh& mesh, const std::vector<int>& sign) {
  std::vector<std::pair<Index, Index>> overlaps;
  for_faces(mesh, [&](std::span<const std::int64_t> owners) {
    if (owners.size() != 2) return;
    const auto first = static_cast<Index>(owners[0] / 4), again = static_cast<Index>(owners[1] / 4);
    const auto apex = [&](std::int64_t owner) { return mesh.tetrahedra(owner % 4, owner / 4); };
    if (apex(owners[0]) == apex(owners[1])) return;  // the same tetrahedron twice
    const int turn = same_turn(face_corners(mesh, owners[0]), face_corners(mesh, owners[1])) ? 1 : -1;
    const int side = turn * sign[static_cast<std::size_t>(first)] * sign[static_cast<std::size_t>(again)];
    if (side > 0) overlaps.emplace_back(again, first);
  });
  std::ranges::sort(overlaps);
  return overlaps;
}

std::string all_in_words(std::size_t count) {
  return count == 1 ? std::string() : " (" + std::to_string(count) + " in all)";
}

void require_no_overlap(const MeshFile& file, const MeshDefects& defects) {
  if (defects.overlaps.empty()) return;
  const auto [again, first] = defects.overlaps[0];
  const auto inverted = [&](Index t) { return std::ranges::binary_search(defects.inverted, t); };
  const bool alike = inverted(again) == inverted(first);
  const Index named = !alike && inverted(first) ? first : again, other = named == again ? first : again;
  throw std::invalid_argument(
      file.where(named) + (alike ? " overlaps tetrahedron " : " is inverted and overlaps tetrahedron ") +
      std::to_string(file.numbers[static_cast<std::size_t>(other)]) + all_in_words(defects.overlaps.size()) +
      ": both lie on the same side of their common face; move its points or mesh the body again, since another order "
      "of corners does not help");
}

}  // namespace

MeshDefects defects_of(const TetMesh& mesh) {
  MeshDefects defects;
  std::vector<int> sign(static_cast<std::size_t>(mesh.tetrahedron_count()), 0);
  for (Index t = 0; t < static_cast<Index>(mesh.tetrahedron_count()); ++t) {
    const Corners x = corners_of(mesh, t);
    if (is_degenerate(x)) {
      defects.degenerate.push_back(t);
      continue;
    }
    const bool inverted = signed_volume(x) < 0;
    sign[static_cast<std::size_t>(t)] = inverted ? -1 : 1;
    if (inverted) defects.inverted.push_back(t);
  }
  defects.duplicates = duplicates_of(mesh);
  defects.overlaps = overlaps_of(mesh, sign);
  defects.crowded = surface_of(mesh).crowded;
  return defects;
}

Eigen::Index fix_orientation(TetMesh& mesh) {
  Eigen::Index fixed = 0;
  for (Eigen::Index t = 0; t < mesh.tetrahedron_count(); ++t) {
    const Corners x = corners_of(mesh, t);
    if (is_degenerate(x) || signed_volume(x) > 0) continue;
    std::swap(mesh.tetrahedra(1, t), mesh.tetrahedra(2, t));
    ++fixed;
  }
  return fixed;
}

void require_no_overlap(const MeshFile& file) { require_no_overlap(file, defects_of(file.mesh)); }

void require_valid(const MeshFile& file) {
  const MeshDefects defects = defects_of(file.mesh);
  const auto all = all_in_words;
  if (!defects.degenerate.empty())
    throw std::invalid_argument(file.where(defects.degenerate[0]) + " has no volume" +
                                all(defects.degenerate.size()) + "; remove it or mesh the body again");
  if (!defects.duplicates.empty()) {
    const auto [again, first] = defects.duplicates[0];
    const TetMesh::Index one = file.mesh.region(first), other = file.mesh.region(again);
    throw std::invalid_argument(
        file.where(again) + " has the same corners as tetrahedron " +
        std::to_string(file.numbers[static_cast<std::size_t>(first)]) + all(defects.duplicates.size()) +
        (one == other
             ? ""
             : ", in the regions " + file.region_in_words(other) + " and " + file.region_in_words(one)) +
        "; remove one of them");
  }
  if (!defects.crowded.empty())
    throw std::invalid_argument(file.where(defects.crowded[0]) + " shares a face with more than one other" +
                                all(defects.crowded.size()) +
                                ", so that parts of the body overlap; mesh it again");
  require_no_overlap(file, defects);
  if (!defects.inverted.empty()) {
    const bool every = static_cast<Eigen::Index>(defects.inverted.size()) == file.mesh.tetrahedron_count();
    throw std::invalid_argument(file.where(defects.inverted[0]) + " is inverted" +
                                (every ? " as all others are" : all(defects.inverted.size())) +
                                "; turn it with `hmax mesh convert FILE OUTPUT --fix`");
  }
}

}  // namespace hmax
