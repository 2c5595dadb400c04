#include "problems/tissue/spring_sets.hpp"

#include <algorithm>
#include <array>
#include <numeric>
#include <ranges>
#include <stdexcept>
#include <string>

#include <Eigen/Dense>

#include "core/sort_unique.hpp"
#include "problems/digits.hpp"

namespace hmax {
namespace {

using Index = TetMesh::Index;

/// A simplex that lacks one of its points, by its other points in ascending order.
template <std::size_t k>
struct Side {
  std::array<Index, k> shared;
  Index opposite;
  auto operator<=>(const Side&) const = default;  // NOLINT(modernize-use-nullptr)
};

/// The points opposite to each other across a side that two simplices share.
template <std::size_t k>
MeshEdges opposite_pairs(std::vector<Side<k>> sides) {
  std::sort(sides.begin(), sides.end());
  std::vector<std::array<Index, 2>> pairs;
  for (std::size_t i = 0; i + 1 < sides.size(); ++i)
    if (sides[i].shared == sides[i + 1].shared)
      pairs.push_back({std::min(sides[i].opposite, sides[i + 1].opposite),
                       std::max(sides[i].opposite, sides[i + 1].opposite)});
  sort_unique(pairs);
  MeshEdges all(2, static_cast<Eigen::Index>(pairs.size()));
  for (std::size_t i = 0; i < pairs.size(); ++i)
    all.col(static_cast<Eigen::Index>(i)) << pairs[i][0], pairs[i][1];
  return all;
}

/// The sides of all columns of a table of simplices with k + 1 points.
template <std::size_t k, class Simplices>
MeshEdges opposite_in(const Simplices& simplices) {
  std::vector<Side<k>> sides;
  for (const auto& simplex : simplices.colwise())
    for (std::size_t corner = 0; corner <= k; ++corner) {
      Side<k> side{{}, simplex[static_cast<Eigen::Index>(corner)]};
      for (std::size_t i = 0, at = 0; i <= k; ++i)
        if (i != corner) side.shared[at++] = simplex[static_cast<Eigen::Index>(i)];
      std::sort(side.shared.begin(), side.shared.end());
      sides.push_back(side);
    }
  return opposite_pairs(std::move(sides));
}

void require_not_negative(double value, const char* what) {
  if (!(value >= 0))
    throw std::invalid_argument(std::string(what) + " is " + shortest_digits(value) +
                                " but may not be negative");
}

}  // namespace

MeshEdges bending_pairs(const MeshSurface& surface) { return opposite_in<2>(surface.triangles); }

MeshEdges second_ring_pairs(const TetMesh& mesh) { return opposite_in<3>(mesh.tetrahedra); }

std::vector<SpringSet::Spring> tissue_springs(const TetMesh& mesh, const EdgeTable& edges,
                                              const MeshSurface& surface, const TissueSettings& settings) {
  const SpringSettings& choice = settings.springs;
  require_not_negative(choice.stiffness, "the stiffness of the springs");
  require_not_negative(choice.damper, "the damper of the springs");
  require_not_negative(choice.damper_time, "the damper time of the springs");
  require_not_negative(choice.surface_bending, "the relative stiffness of surface bending");
  require_not_negative(choice.second_ring, "the relative stiffness of the second ring");
  require_not_negative(choice.doubled_skin, "the relative stiffness of the doubled skin");

  std::vector<double> young;
  for (const TissueMaterial& material : settings.materials) young.push_back(material.young);
  if (young.size() == 1 && !mesh.regions.empty())
    young.assign(static_cast<std::size_t>(*std::max_element(mesh.regions.begin(), mesh.regions.end())) + 1,
                 young.front());
  const std::vector<double> k =
      choice.stiffness > 0
          ? std::vector<double>(static_cast<std::size_t>(edges.edges.cols()), choice.stiffness)
          : edge_stiffness(mesh, edges, young);
  const double mean = std::accumulate(k.begin(), k.end(), 0.0) / static_cast<double>(k.size());

  std::vector<SpringSet::Spring> springs;
  const auto add = [&](Index a, Index b, double stiffness) {
    springs.push_back({{a, b}, stiffness, choice.damper + choice.damper_time * stiffness});
  };
  for (Eigen::Index e = 0; e < edges.edges.cols(); ++e)
    add(edges.edges(0, e), edges.edges(1, e), k[static_cast<std::size_t>(e)]);
  const auto add_all = [&](const MeshEdges& pairs, double stiffness) {
    for (const auto& pair : pairs.colwise()) add(pair[0], pair[1], stiffness);
  };
  if (choice.surface_bending > 0) add_all(bending_pairs(surface), choice.surface_bending * mean);
  if (choice.second_ring > 0) add_all(second_ring_pairs(mesh), choice.second_ring * mean);
  if (choice.doubled_skin > 0)
    for (const auto& pair : surface.edges.colwise())
      add(pair[0], pair[1], choice.doubled_skin * k[static_cast<std::size_t>(edges.find(pair[0], pair[1]))]);
  return springs;
}

std::vector<SpringSet::Spring> skin_springs(const TetMesh& mesh, const MeshSurface& surface,
                                            const SkinSettings& skin) {
  const auto place = [&](Index a, Index b) {
    const auto ends = [&](Eigen::Index edge) {
      return std::array{surface.edges(0, edge), surface.edges(1, edge)};
    };
    return static_cast<std::size_t>(
        *std::ranges::lower_bound(std::views::iota(Eigen::Index{0}, surface.edges.cols()),
                                  std::array{std::min(a, b), std::max(a, b)}, {}, ends));
  };
  std::vector<SpringSet::Spring> springs;
  for (const auto& edge : surface.edges.colwise()) springs.push_back({{edge[0], edge[1]}, 0});
  for (const auto& triangle : surface.triangles.colwise()) {
    const Eigen::Vector3d u = mesh.points.col(triangle[1]) - mesh.points.col(triangle[0]),
                          w = mesh.points.col(triangle[2]) - mesh.points.col(triangle[0]);
    const double stiff = skin.young * skin.thickness * u.cross(w).norm() / 2;
    for (Eigen::Index a = 0; a < 3; ++a) {
      const Index i = triangle[a], j = triangle[(a + 1) % 3];
      springs[place(i, j)].stiffness += stiff / (mesh.points.col(j) - mesh.points.col(i)).squaredNorm();
    }
  }
  return springs;
}

}  // namespace hmax
