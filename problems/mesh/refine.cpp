#include "problems/mesh/refine.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>

#include <Eigen/LU>

#include "problems/mesh/topology.hpp"

namespace hmax {

namespace {

using Index = TetMesh::Index;

using Part = std::array<int, 4>;

/// Corners are 0 to 3, the middle of tetrahedron_edges[e] is 4 + e.
constexpr std::array<Part, 4> corner_parts{{{0, 4, 5, 6}, {4, 1, 7, 8}, {5, 7, 2, 9}, {6, 8, 9, 3}}};
constexpr std::array<std::array<int, 2>, 3> diagonals{{{4, 9}, {5, 8}, {6, 7}}};
/// What each diagonal makes of the octahedron. Where corners 0, 1, 2, 3, or 0, 2, 1, 3 if that is the
/// positive order, are the way along three axes through a cell of a grid, so are those of its parts: boxes
/// stay boxes.
constexpr std::array<std::array<Part, 4>, 3> inner_parts{{
    {{{5, 6, 4, 9}, {5, 4, 7, 9}, {4, 9, 6, 8}, {4, 7, 9, 8}}},
    {{{4, 5, 6, 8}, {4, 7, 5, 8}, {5, 6, 8, 9}, {5, 8, 7, 9}}},
    {{{6, 7, 4, 5}, {6, 7, 5, 9}, {6, 7, 9, 8}, {6, 7, 8, 4}}},
}};

/// 6 V of a part of the unit tetrahedron whose edges are 2 long.
constexpr int determinant(const Part& part) {
  constexpr std::array<std::array<int, 3>, 10> points{{{0, 0, 0},
                                                       {2, 0, 0},
                                                       {0, 2, 0},
                                                       {0, 0, 2},
                                                       {1, 0, 0},
                                                       {0, 1, 0},
                                                       {0, 0, 1},
                                                       {1, 1, 0},
                                                       {1, 0, 1},
                                                       {0, 1, 1}}};
  std::array<std::array<int, 3>, 3> d{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t k = 0; k < 3; ++k)
      d[i][k] =
          points[static_cast<std::size_t>(part[i + 1])][k] - points[static_cast<std::size_t>(part[0])][k];
  return d[0][0] * (d[1][1] * d[2][2] - d[1][2] * d[2][1]) -
         d[0][1] * (d[1][0] * d[2][2] - d[1][2] * d[2][0]) +
         d[0][2] * (d[1][0] * d[2][1] - d[1][1] * d[2][0]);
}

constexpr bool all_are_eighths() {
  for (const Part& part : corner_parts)
    if (determinant(part) != 1) return false;
  for (const auto& parts : inner_parts)
    for (const Part& part : parts)
      if (determinant(part) != 1) return false;
  return true;
}
static_assert(all_are_eighths(), "every part is an eighth and oriented as the whole");

}  // namespace

std::array<std::array<Index, 4>, 8> parts_of(const Eigen::Matrix3Xd& points, const TenPoints& own) {
  const auto point = [&](int i) { return own[static_cast<std::size_t>(i)]; };
  const auto is_positive = [&](const Part& part) {
    Eigen::Matrix3d edges;
    for (std::size_t i = 1; i < 4; ++i)
      edges.col(static_cast<Eigen::Index>(i) - 1) = points.col(point(part[i])) - points.col(point(part[0]));
    return edges.determinant() > 0;
  };
  std::size_t chosen = 0;
  double shortest = 0;
  bool good = false;
  for (std::size_t d = 0; d < diagonals.size(); ++d) {
    const double length =
        (points.col(point(diagonals[d][0])) - points.col(point(diagonals[d][1]))).squaredNorm();
    // Curved sides may turn over the parts that a diagonal makes.
    const bool positive = std::ranges::all_of(inner_parts[d], is_positive);
    // What differs by rounding is equal: the choice must not depend on where the mesh lies.
    if (d == 0 || (positive && !good) || (positive == good && length < shortest * (1 - 1e-9))) {
      chosen = d;
      shortest = length;
      good = positive;
    }
  }
  std::array<std::array<Index, 4>, 8> all{};
  auto next = all.begin();
  for (const auto& parts : {corner_parts, inner_parts[chosen]})
    for (const Part& part : parts) {
      std::ranges::transform(part, next->begin(), point);
      ++next;
    }
  return all;
}

TetMesh ten_node_mesh(const TetMesh& mesh) {
  const EdgeTable table = edge_table(mesh);
  const Eigen::Index points = mesh.point_count(), edges = table.edges.cols();
  TetMesh fine;
  fine.points.resize(3, points + edges);
  fine.points.leftCols(points) = mesh.points;
  for (Eigen::Index e = 0; e < edges; ++e)
    fine.points.col(points + e) =
        0.5 * (mesh.points.col(table.edges(0, e)) + mesh.points.col(table.edges(1, e)));
  fine.tetrahedra.resize(4, 8 * mesh.tetrahedron_count());
  fine.ten_node.resize(10, mesh.tetrahedron_count());
  for (Eigen::Index t = 0; t < mesh.tetrahedron_count(); ++t) {
    TenPoints p{};
    for (std::size_t i = 0; i < 4; ++i) p[i] = mesh.tetrahedra(static_cast<Eigen::Index>(i), t);
    for (std::size_t e = 0; e < 6; ++e) {
      const auto& [i, j] = tetrahedron_edges[e];
      p[4 + e] = static_cast<Index>(points) +
                 table.find(p[static_cast<std::size_t>(i)], p[static_cast<std::size_t>(j)]);
    }
    std::ranges::copy(p, fine.ten_node.col(t).begin());
    Eigen::Index column = 8 * t;
    for (const auto& part : parts_of(fine.points, p))
      std::ranges::copy(part, fine.tetrahedra.col(column++).begin());
  }
  fine.regions.reserve(8 * mesh.regions.size());
  for (const Index region : mesh.regions) fine.regions.insert(fine.regions.end(), 8, region);
  return fine;
}

TetMesh refined(const TetMesh& mesh, int times) {
  if (times < 0)
    throw std::invalid_argument("a mesh cannot be refined " + std::to_string(times) +
                                " times; give 0 or more");
  if (static_cast<double>(mesh.tetrahedron_count()) * std::pow(8.0, times) > double(most_tetrahedra)) {
    int most = 0;
    while (static_cast<double>(mesh.tetrahedron_count()) * std::pow(8.0, most + 1) <=
           static_cast<double>(most_tetrahedra))
      ++most;
    throw std::invalid_argument(std::to_string(mesh.tetrahedron_count()) + " tetrahedra refined " +
                                std::to_string(times) + " times make more than " +
                                std::to_string(most_tetrahedra) + "; refine less often, at most " +
                                std::to_string(most) + (most == 1 ? " time" : " times"));
  }
  TetMesh fine = mesh;
  for (int i = 0; i < times; ++i) fine = ten_node_mesh(fine);
  fine.ten_node.resize(10, 0);
  return fine;
}

}  // namespace hmax
