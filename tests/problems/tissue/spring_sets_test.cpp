/// Which points springs join, and how stiff they are.
#include "problems/tissue/spring_sets.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <set>

#include <gtest/gtest.h>

#include "tests/problems/mesh/meshes.hpp"
#include "tests/problems/tissue/bodies.hpp"

namespace hmax {
namespace {

using tissue_tests::uneven_box;

std::vector<SpringSet::Spring> springs_of(const TetMesh& mesh, const TissueSettings& settings) {
  return tissue_springs(mesh, edge_table(mesh), surface_of(mesh), settings);
}

/// One tetrahedron with sides of length 1.
TetMesh unit_regular_tetrahedron() {
  TetMesh mesh = regular_tetrahedron();
  mesh.points /= std::sqrt(2.0);
  return mesh;
}

using Pairs = std::set<std::array<TetMesh::Index, 2>>;

/// The two points that two simplices do not share, of all that share the others.
template <class Simplices>
Pairs opposite(const Simplices& simplices) {
  Pairs pairs;
  for (Eigen::Index i = 0; i < simplices.cols(); ++i)
    for (Eigen::Index j = 0; j < i; ++j) {
      const std::set<TetMesh::Index> one(simplices.col(i).begin(), simplices.col(i).end()),
          other(simplices.col(j).begin(), simplices.col(j).end());
      std::vector<TetMesh::Index> apart;
      std::ranges::set_symmetric_difference(one, other, std::back_inserter(apart));
      if (apart.size() == 2) pairs.insert({apart[0], apart[1]});
    }
  return pairs;
}

TEST(TissueSprings, OfOneMaterialAreThoseOfTheMeshWithoutRegions) {
  TetMesh mesh = uneven_box();
  mesh.regions[5] = 3;
  TetMesh plain = mesh;
  plain.regions.clear();
  const auto of_regions = springs_of(mesh, {}), expected = springs_of(plain, {});
  ASSERT_EQ(of_regions.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_EQ(of_regions[i].points, expected[i].points) << i;
    EXPECT_EQ(of_regions[i].stiffness, expected[i].stiffness) << i;
  }
}

TEST(TissueSprings, OfARegularTetrahedronShareItsStiffness) {
  // k = E V / L^2 with V = L^3 / (6 sqrt 2) [vangelder1998approximate].
  TissueSettings settings;
  settings.springs.damper = 0.5;
  settings.springs.damper_time = 0.01;
  const auto springs = springs_of(unit_regular_tetrahedron(), settings);
  ASSERT_EQ(springs.size(), 6U);
  for (const SpringSet::Spring& spring : springs) {
    EXPECT_NEAR(spring.stiffness, 5500 / (6 * std::sqrt(2.0)), 1e-9);
    EXPECT_NEAR(spring.damper, 0.5 + 0.01 * spring.stiffness, 1e-12);
  }
}

TEST(TissueSprings, OfFurtherSetsJoinWhatIsOppositeAndTakeTheirShareOfTheMean) {
  const TetMesh mesh = uneven_box();
  const MeshSurface surface = surface_of(mesh);
  TissueSettings settings;
  const auto edges = springs_of(mesh, settings);
  double mean = 0;
  for (const SpringSet::Spring& spring : edges) mean += spring.stiffness / static_cast<double>(edges.size());
  const auto expect_added = [&](const Pairs& pairs, double stiffness) {
    const auto all = springs_of(mesh, settings);
    Pairs added;
    for (std::size_t i = edges.size(); i < all.size(); ++i) {
      added.insert(all[i].points);
      EXPECT_NEAR(all[i].stiffness, stiffness, 1e-12 * mean) << i;
    }
    EXPECT_EQ(added, pairs);
    EXPECT_EQ(all.size(), edges.size() + pairs.size());
  };
  settings.springs.surface_bending = 0.3;
  expect_added(opposite(surface.triangles), 0.3 * mean);
  settings.springs.surface_bending = 0;
  settings.springs.second_ring = 0.2;
  expect_added(opposite(mesh.tetrahedra), 0.2 * mean);
  settings.springs.second_ring = 0;
  settings.springs.doubled_skin = 5;
  const auto skin = springs_of(mesh, settings);
  ASSERT_EQ(skin.size(), edges.size() + static_cast<std::size_t>(surface.edges.cols()));
  for (std::size_t i = edges.size(); i < skin.size(); ++i) {
    const auto twin = std::ranges::find(edges, skin[i].points, &SpringSet::Spring::points);
    ASSERT_NE(twin, edges.end()) << i;
    EXPECT_EQ(skin[i].stiffness, 5 * twin->stiffness) << i;
  }
}

TEST(SkinSprings, OfARegularTetrahedronShareTheStiffnessOfItsTriangles) {
  // k = sum of Y h A / L^2 over two triangles with A = sqrt(3) / 4 L^2.
  const TetMesh mesh = unit_regular_tetrahedron();
  const auto springs = skin_springs(mesh, surface_of(mesh), {SkinSettings::Kind::springs, 5e6, 0.45, 1e-4});
  ASSERT_EQ(springs.size(), 6U);
  for (const SpringSet::Spring& spring : springs)
    EXPECT_NEAR(spring.stiffness, std::sqrt(3.0) / 2 * 5e6 * 1e-4, 1e-9);
}

}  // namespace
}  // namespace hmax
