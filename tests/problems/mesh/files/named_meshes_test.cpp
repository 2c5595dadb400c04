#include <fstream>
#include <numbers>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

#include "problems/mesh/mesh_quality.hpp"
#include "problems/mesh/topology.hpp"
#include "tests/problems/mesh/meshes.hpp"

namespace hmax {
namespace {

/// One of problems/meshes, by a reader that knows nothing but what make.py writes.
TetMesh named_mesh(const std::string& name) {
  std::ifstream file(std::string(HMAX_SOURCE_DIR) + "/problems/meshes/" + name + ".msh");
  const auto skip_to = [&](const char* section) {
    std::string line;
    while (std::getline(file, line))
      if (line == section) return;
    throw std::runtime_error(name + ".msh has no " + section);
  };
  TetMesh mesh;
  Eigen::Index count = 0, number = 0, type = 0, tags = 0, physical = 0, entity = 0;
  skip_to("$Nodes");
  file >> count;
  mesh.points.resize(3, count);
  for (auto point : mesh.points.colwise()) file >> number >> point(0) >> point(1) >> point(2);
  skip_to("$Elements");
  file >> count;
  mesh.tetrahedra.resize(4, count);
  for (auto t : mesh.tetrahedra.colwise()) {
    file >> number >> type >> tags >> physical >> entity >> t(0) >> t(1) >> t(2) >> t(3);
    if (!file || type != 4 || tags != 2) throw std::runtime_error(name + ".msh: not a line of make.py");
  }
  mesh.tetrahedra.array() -= 1;
  return mesh;
}

struct Counts {
  std::string name;
  Eigen::Index points, tetrahedra, edges, surface_points, surface_triangles;
};

const Counts study[] = {{"phantom", 57, 120, 230, 56, 108}, {"liver", 299, 1151, 1634, 187, 370}};

TEST(NamedMeshes, HaveTheCountsOfTheStudy) {
  for (const Counts& wanted : study) {
    const MeshTopology t = topology_of(named_mesh(wanted.name));
    EXPECT_EQ(t.points, wanted.points) << wanted.name;
    EXPECT_EQ(t.tetrahedra, wanted.tetrahedra) << wanted.name;
    EXPECT_EQ(t.edges, wanted.edges) << wanted.name;
    EXPECT_EQ(t.surface_points, wanted.surface_points) << wanted.name;
    EXPECT_EQ(t.surface_triangles, wanted.surface_triangles) << wanted.name;
  }
}

TEST(NamedMeshes, AreSolidsWithoutHandlesOrHollows) {
  for (const Counts& wanted : study) {
    const MeshTopology t = topology_of(named_mesh(wanted.name));
    EXPECT_EQ(t.euler(), 1) << wanted.name;
    EXPECT_EQ(t.surface_euler(), 2) << wanted.name;
    EXPECT_EQ(2 * t.surface_edges, 3 * t.surface_triangles) << wanted.name;
    EXPECT_EQ(2 * t.faces, 4 * t.tetrahedra + t.surface_triangles) << wanted.name;
    EXPECT_EQ(t.components, 1) << wanted.name;
    EXPECT_EQ(t.unused_points, 0) << wanted.name;
    EXPECT_EQ(t.crowded_faces, 0) << wanted.name;
  }
}

TEST(NamedMeshes, HaveTheVolumeTheyAreScaledTo) {
  EXPECT_NEAR(quality_of(named_mesh("phantom")).volume, 1e-3, 1e-10);
  EXPECT_NEAR(1060 * quality_of(named_mesh("liver")).volume, 1.5, 1e-6);  // kg
  for (const Counts& wanted : study) {
    const TetMesh mesh = named_mesh(wanted.name);
    EXPECT_NEAR(enclosed_volume(mesh) / quality_of(mesh).volume, 1, 1e-12) << wanted.name;
    EXPECT_TRUE(all_positive(mesh)) << wanted.name;
  }
}

TEST(NamedMeshes, HoldNoSliver) {
  for (const Counts& wanted : study) {
    const MeshQuality quality = quality_of(named_mesh(wanted.name));
    EXPECT_GT(quality.smallest_angle * 180 / std::numbers::pi, 30) << wanted.name;
    EXPECT_LT(quality.largest_angle * 180 / std::numbers::pi, 135) << wanted.name;
  }
}

}  // namespace
}  // namespace hmax
