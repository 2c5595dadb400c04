#include "problems/mesh/files/mesh_defects.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>

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

}  // namespace

MeshDefects defects_of(const TetMesh& mesh) {
  MeshDefects defects;
  for (Index t = 0; t < static_cast<Index>(mesh.tetrahedron_count()); ++t) {
    const Corners x = corners_of(mesh, t);
    if (is_degenerate(x))
      defects.degenerate.push_back(t);
    else if (signed_volume(x) < 0)
      defects.inverted.push_back(t);
  }
  defects.duplicates = duplicates_of(mesh);
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

void require_valid(const MeshFile& file) {
  const MeshDefects defects = defects_of(file.mesh);
  const auto all = [](std::size_t count) {
    return count == 1 ? std::string() : " (" + std::to_string(count) + " in all)";
  };
  if (!defects.degenerate.empty())
    throw std::invalid_argument(file.where(defects.degenerate[0]) + " has no volume" +
                                all(defects.degenerate.size()) + "; remove it or mesh the body again");
  if (!defects.duplicates.empty()) {
    const auto [again, first] = defects.duplicates[0];
    throw std::invalid_argument(file.where(again) + " has the same corners as tetrahedron " +
                                std::to_string(file.numbers[static_cast<std::size_t>(first)]) +
                                all(defects.duplicates.size()) + "; remove one of them");
  }
  if (!defects.crowded.empty())
    throw std::invalid_argument(file.where(defects.crowded[0]) + " shares a face with more than one other" +
                                all(defects.crowded.size()) +
                                ", so that parts of the body overlap; mesh it again");
  if (!defects.inverted.empty()) {
    const bool every = static_cast<Eigen::Index>(defects.inverted.size()) == file.mesh.tetrahedron_count();
    throw std::invalid_argument(file.where(defects.inverted[0]) + " is inverted" +
                                (every ? " as all others are" : all(defects.inverted.size())) +
                                "; turn it with `hmax mesh convert FILE OUTPUT --fix`");
  }
}

}  // namespace hmax
