/// The faces of a mesh, each with all tetrahedra that have it.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

#include "problems/mesh/tet_mesh.hpp"

namespace hmax {

/// The four faces of a tetrahedron by its own corners, that opposite to corner i at i, counter-clockwise as
/// seen from outside.
inline constexpr std::array<std::array<int, 3>, 4> tetrahedron_faces{
    {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};

/// The corners of a face, counter-clockwise as seen from outside of a positive tetrahedron.
/// @param owner  4 tetrahedron + face of it
inline std::array<TetMesh::Index, 3> face_corners(const TetMesh& mesh, std::int64_t owner) {
  const auto& face = tetrahedron_faces[static_cast<std::size_t>(owner % 4)];
  const auto tetrahedron = mesh.tetrahedra.col(owner / 4);
  return {tetrahedron(face[0]), tetrahedron(face[1]), tetrahedron(face[2])};
}

/// Calls use(owners) once for each different face; its owners are 4 tetrahedron + face of it.
/// The order is that of the points of the faces. Time and memory are in proportion to the tetrahedra.
template <class Use>
void for_faces(const TetMesh& mesh, Use use) {
  struct Face {
    TetMesh::Index middle, upper;
    std::int64_t owner;
  };
  const Eigen::Index count = 4 * mesh.tetrahedron_count();
  // Faces of the lowest point a stand from first[a] on.
  std::vector<std::size_t> first(static_cast<std::size_t>(mesh.point_count()) + 1, 0);
  for (Eigen::Index k = 0; k < count; ++k)
    ++first[static_cast<std::size_t>(std::ranges::min(face_corners(mesh, k)))];
  std::exclusive_scan(first.begin(), first.end(), first.begin(), std::size_t{0});
  std::vector<Face> faces(static_cast<std::size_t>(count));
  std::vector<std::size_t> next = first;
  for (Eigen::Index k = 0; k < count; ++k) {
    auto points = face_corners(mesh, k);
    std::ranges::sort(points);
    faces[next[static_cast<std::size_t>(points[0])]++] = {points[1], points[2], k};
  }
  std::vector<std::int64_t> owners;
  for (std::size_t a = 0; a + 1 < first.size(); ++a) {
    const auto begin = faces.begin() + static_cast<std::ptrdiff_t>(first[a]);
    const auto end = faces.begin() + static_cast<std::ptrdiff_t>(first[a + 1]);
    std::sort(begin, end, [](const Face& one, const Face& other) {
      return std::array<std::int64_t, 3>{one.middle, one.upper, one.owner} <
             std::array<std::int64_t, 3>{other.middle, other.upper, other.owner};
    });
    for (auto it = begin; it != end;) {
      owners.clear();
      for (const Face& same = *it; it != end && it->middle == same.middle && it->upper == same.upper; ++it)
        owners.push_back(it->owner);
      use(std::span<const std::int64_t>(owners));
    }
  }
}

}  // namespace hmax
