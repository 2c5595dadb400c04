#include "problems/mesh/files/mesh_import.hpp"

#include <cmath>
#include <numeric>
#include <stdexcept>

#include <gtest/gtest.h>

#include "problems/mesh/files/mesh_defects.hpp"
#include "problems/mesh/files/mesh_writers.hpp"
#include "problems/mesh/refine.hpp"
#include "tests/problems/mesh/files/mesh_goldens.hpp"
#include "tests/problems/mesh/meshes.hpp"
#include "tests/says.hpp"

namespace hmax {
namespace {

MeshFile renumbered_file(const TetMesh& mesh) {
  MeshFile file = counted_from_one(mesh, "body.msh");
  for (std::int64_t& number : file.numbers) number += 99;
  return file;
}

TEST(MeshImport, LeavesIdlePointsOutAndFindsTheWayBack) {
  MeshFile file = renumbered_file(ball_mesh(1, 2));
  TetMesh& mesh = file.mesh;
  mesh.regions.resize(static_cast<std::size_t>(mesh.tetrahedron_count()));
  std::iota(mesh.regions.begin(), mesh.regions.end(), 0);
  // Two idle points, one of them in front.
  Eigen::Matrix3Xd points(3, mesh.point_count() + 2);
  points << Eigen::Vector3d(9, 9, 9), mesh.points, Eigen::Vector3d(8, 8, 8);
  mesh.points = points;
  mesh.tetrahedra.array() += 1;

  const auto [model, origin] = import_mesh(file, 0.01);
  EXPECT_EQ(model.point_count(), mesh.point_count() - 2);
  EXPECT_EQ(topology_of(model).unused_points, 0);
  EXPECT_NEAR(quality_of(model).volume, 1e-6 * quality_of(mesh).volume, 1e-18);
  const Eigen::MatrixXd back = origin.on_points(model.points);
  const Eigen::Index used = mesh.point_count() - 2;
  EXPECT_EQ(back.middleCols(1, used), 0.01 * mesh.points.middleCols(1, used));
  EXPECT_TRUE(back.col(0).isZero());
  EXPECT_TRUE(back.rightCols(1).isZero());
  EXPECT_EQ(origin.file.mesh.points, 0.01 * mesh.points);
  Eigen::RowVectorXd regions(mesh.tetrahedron_count());
  for (Eigen::Index t = 0; t < regions.size(); ++t) regions(t) = model.region(t);
  const Eigen::MatrixXd in_order = origin.on_tetrahedra(regions);
  for (Eigen::Index t = 0; t < regions.size(); ++t) {
    EXPECT_EQ(in_order(0, t), t);
    EXPECT_EQ(origin.tetrahedron_number(t), 100 + model.region(t));
  }
  const std::vector<TetMesh::Index> now = origin.model_points();
  EXPECT_EQ(now.front(), -1);
  EXPECT_EQ(now.back(), -1);
  EXPECT_EQ(model.points.col(now[5]), 0.01 * mesh.points.col(5));
  EXPECT_THROW(origin.on_points(Eigen::MatrixXd(3, 2)), std::invalid_argument);
}

TEST(MeshImport, RegionsAreNumberedFromZero) {
  MeshFile file = renumbered_file(cube_mesh(1, 1));
  file.mesh.regions = {2000000000, 7, 7, -3, 7, 2000000000};
  const auto [mesh, origin] = import_mesh(file, 1);
  EXPECT_EQ(origin.regions, (std::vector<TetMesh::Index>{-3, 7, 2000000000}));
  for (Eigen::Index t = 0; t < 6; ++t)
    EXPECT_EQ(origin.regions[static_cast<std::size_t>(mesh.region(t))],
              file.mesh.region(origin.tetrahedra[static_cast<std::size_t>(t)]));
  file.mesh.regions.assign(6, 7);
  EXPECT_TRUE(import_mesh(file, 1).mesh.regions.empty());
  EXPECT_EQ(import_mesh(file, 1).origin.regions, std::vector<TetMesh::Index>{7});
}

TEST(MeshImport, AUnitIsAPositiveLength) {
  const MeshFile file = renumbered_file(cube_mesh(1, 1));
  for (const double unit : {0.0, -1.0, 1.0 / 0.0})
    EXPECT_THROW(import_mesh(file, unit), std::invalid_argument) << unit;
}

/// The faces of a unit cube on z = 0, its edge along x and its corner at the origin, as groups.
MeshFile cube_with_groups(int n) {
  MeshFile file = counted_from_one(cube_mesh(1, n), "cube.msh");
  const TetMesh& mesh = file.mesh;
  MeshGroup bottom{.dimension = 2, .number = 30, .name = "bottom"}, edge{.dimension = 1, .number = 4},
      corner{.dimension = 0, .number = 5, .name = "corner"};
  const auto on = [&](TetMesh::Index i, int axis) { return mesh.points(axis, i) == 0; };
  const MeshSurface surface = surface_of(mesh);
  for (const auto& t : surface.triangles.colwise())
    if (on(t(0), 2) && on(t(1), 2) && on(t(2), 2))
      bottom.corners.insert(bottom.corners.end(), t.begin(), t.end());
  for (const auto& e : surface.edges.colwise())
    if (on(e(0), 2) && on(e(1), 2) && on(e(0), 1) && on(e(1), 1))
      edge.corners.insert(edge.corners.end(), e.begin(), e.end());
  for (TetMesh::Index i = 0; i < mesh.point_count(); ++i)
    if (on(i, 0) && on(i, 1) && on(i, 2)) corner.corners.push_back(i);
  file.groups = {corner, edge, bottom};
  return file;
}

double area_of(const MeshFile& file, const MeshGroup& group) {
  double area = 0;
  for (std::size_t i = 0; i < group.corners.size(); i += 3) {
    const auto x = [&](std::size_t k) -> Eigen::Vector3d {
      return file.mesh.points.col(group.corners[i + k]);
    };
    area += (x(1) - x(0)).cross(x(2) - x(0)).norm() / 2;
  }
  return area;
}

TEST(MeshImport, GroupsAndNumbersSurviveARefinement) {
  const MeshFile coarse = cube_with_groups(2), fine = refined(coarse, 2);
  EXPECT_EQ(fine.mesh.tetrahedra, refined(coarse.mesh, 2).tetrahedra);
  ASSERT_EQ(fine.groups.size(), 3U);
  EXPECT_EQ(fine.groups[0].corners, coarse.groups[0].corners);
  EXPECT_EQ(fine.groups[1].corners.size(), 4 * coarse.groups[1].corners.size());
  EXPECT_EQ(fine.groups[2].corners.size(), 16 * coarse.groups[2].corners.size());
  EXPECT_EQ(fine.groups[2].name, "bottom");
  EXPECT_NEAR(area_of(fine, fine.groups[2]), 1, 1e-14);
  for (const TetMesh::Index i : fine.groups[2].corners) EXPECT_EQ(fine.mesh.points(2, i), 0);
  for (const TetMesh::Index i : fine.groups[1].corners) EXPECT_EQ(fine.mesh.points(1, i), 0);
  for (std::size_t i = 0; i < fine.point_numbers.size(); ++i)
    EXPECT_EQ(fine.point_numbers[i], static_cast<std::int64_t>(i) + 1);
}

TEST(MeshImport, PointsOfGroupsStayWhereOthersAreMended) {
  MeshFile file = cube_with_groups(2);
  const auto displace = [&](const Eigen::Vector3d& where) {
    TetMesh::Index point = 0;
    while (!file.mesh.points.col(point).isApprox(where)) ++point;
    file.mesh.points.col(point) += Eigen::Vector3d(0.1, 0.06, 0);
    return point;
  };
  const TetMesh::Index bottom = displace({0.5, 0.5, 0}), top = displace({0.5, 0.5, 1});
  const Eigen::Matrix3Xd before = file.mesh.points;
  const Mending mending = mend(file, 10);
  EXPECT_TRUE(std::ranges::binary_search(mending.moved, top));
  EXPECT_NE(file.mesh.points.col(top), before.col(top));
  EXPECT_FALSE(std::ranges::binary_search(mending.moved, bottom));
  for (const MeshGroup& group : file.groups)
    for (const TetMesh::Index i : group.corners) EXPECT_EQ(file.mesh.points.col(i), before.col(i)) << i;
}

TEST(MeshImport, CoincidentPointsBecomeOneAndKeepTheirNumbers) {
  // Two cubes side by side, each with its own points: four of them coincide.
  const MeshFile whole = cube_with_groups(1);
  MeshFile file = whole;
  TetMesh& mesh = file.mesh;
  mesh.points.conservativeResize(3, 16);
  mesh.points.rightCols(8) = whole.mesh.points.colwise() + Eigen::Vector3d(1, 0, 0);
  mesh.tetrahedra.conservativeResize(4, 12);
  mesh.tetrahedra.rightCols(6) = whole.mesh.tetrahedra.array() + 8;
  file.numbers.resize(12);
  file.places.resize(12);
  file.point_numbers.clear();
  for (std::int64_t i = 0; i < 16; ++i) file.point_numbers.push_back(100 + 10 * i);
  MeshGroup right = whole.groups[2];
  for (TetMesh::Index& corner : right.corners) corner += 8;
  right.number = 31;
  file.groups.push_back(right);
  const Eigen::Matrix3Xd before = mesh.points;

  EXPECT_EQ(merge_points(file, 0), 4);
  EXPECT_EQ(file.mesh.point_count(), 12);
  EXPECT_EQ(topology_of(file.mesh).components, 1);
  EXPECT_TRUE(defects_of(file.mesh).none());
  EXPECT_NEAR(quality_of(file.mesh).volume, 2, 1e-14);
  EXPECT_EQ(topology_of(file.mesh).unused_points, 0);
  ASSERT_EQ(file.merged.size(), 4U);
  // Every number of the file leads to the place that it had.
  for (std::size_t i = 0; i < file.point_numbers.size(); ++i)
    EXPECT_EQ(file.mesh.points.col(static_cast<Eigen::Index>(i)),
              before.col((file.point_numbers[i] - 100) / 10));
  for (const auto& [number, point] : file.merged)
    EXPECT_EQ(file.mesh.points.col(point), before.col((number - 100) / 10));
  for (std::size_t i = 0; i < right.corners.size(); ++i)
    EXPECT_EQ(file.mesh.points.col(file.groups[3].corners[i]), before.col(right.corners[i]));
  EXPECT_EQ(merge_points(file, 0), 0);
  // New points of a refinement have numbers that no point of the file had.
  for (const std::int64_t number : refined(file, 1).point_numbers)
    for (const auto& [merged, point] : file.merged) EXPECT_NE(number, merged);
  for (const double tolerance : {-0.1, 0.5, std::nan("")})
    EXPECT_THROW(merge_points(file, tolerance), std::invalid_argument);
}

TEST(MeshImport, GroupsSurviveARenumbering) {
  const MeshFile file = cube_with_groups(2), other = renumbered(file);
  EXPECT_NE(other.mesh.points, file.mesh.points);
  for (std::size_t g = 0; g < file.groups.size(); ++g) {
    ASSERT_EQ(other.groups[g].corners.size(), file.groups[g].corners.size());
    for (std::size_t i = 0; i < file.groups[g].corners.size(); ++i)
      EXPECT_EQ(other.mesh.points.col(other.groups[g].corners[i]),
                file.mesh.points.col(file.groups[g].corners[i]));
  }
}

void expect_same_groups(const std::vector<MeshGroup>& read, const std::vector<MeshGroup>& written) {
  ASSERT_EQ(read.size(), written.size());
  for (std::size_t g = 0; g < read.size(); ++g) {
    EXPECT_EQ(read[g].dimension, written[g].dimension);
    EXPECT_EQ(read[g].number, written[g].number);
    EXPECT_EQ(read[g].name, written[g].name);
    EXPECT_EQ(read[g].corners, written[g].corners);
  }
}

/// Numbers with gaps, and regions of which one has a name.
MeshFile numbered_cube() {
  MeshFile file = cube_with_groups(1);
  for (std::int64_t& number : file.point_numbers) number = 10 * number + 3;
  for (std::int64_t& number : file.numbers) number = 7 * number;
  std::ranges::reverse(file.numbers);
  file.mesh.regions = {10, 20, 10, 10, 20, 10};
  file.names = {{20, "tumour <\"left\"> & more"}};
  return file;
}

TEST(MeshImport, GmshKeepsNumbersRegionsGroupsAndNames) {
  const MeshFile file = numbered_cube(), read = read_mesh("a.msh", msh_text(file));
  EXPECT_EQ(read.mesh.points, file.mesh.points);
  EXPECT_EQ(read.mesh.tetrahedra, file.mesh.tetrahedra);
  EXPECT_EQ(read.mesh.regions, file.mesh.regions);
  EXPECT_EQ(read.point_numbers, file.point_numbers);
  EXPECT_EQ(read.numbers, file.numbers);
  EXPECT_EQ(read.names.at(20), "tumour <'left'> & more");  // Gmsh ends names at a double quote
  expect_same_groups(read.groups, file.groups);
}

TEST(MeshImport, VtkKeepsNumbersRegionsGroupsAndNames) {
  const MeshFile file = numbered_cube();
  for (const VtuEncoding encoding : {VtuEncoding::ascii, VtuEncoding::base64, VtuEncoding::raw}) {
    const std::string text = vtu_text(file, {}, encoding);
    const MeshFile read = read_mesh("a.vtu", text);
    EXPECT_EQ(read.mesh.regions, file.mesh.regions);
    EXPECT_EQ(read.point_numbers, file.point_numbers);
    EXPECT_EQ(read.numbers, file.numbers);
    EXPECT_EQ(read.names, file.names);
    expect_same_groups(read.groups, file.groups);
    EXPECT_EQ(vtu_text(read, {}, encoding), text);
  }
}

TEST(MeshImport, NumbersThatSimplyCountAreLeftToTheFormat) {
  const MeshFile file = counted_from_one(cube_mesh(1, 1));
  EXPECT_FALSE(says(vtu_text(file), "Global"));
  MeshFile from_zero = file;
  for (std::vector<std::int64_t>* numbers : {&from_zero.numbers, &from_zero.point_numbers})
    for (std::int64_t& number : *numbers) --number;
  EXPECT_EQ(vtu_text(from_zero), vtu_text(file));
  EXPECT_EQ(msh_text(from_zero), msh_text(file));
}

}  // namespace
}  // namespace hmax
