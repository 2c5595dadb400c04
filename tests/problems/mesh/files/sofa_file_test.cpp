#include "problems/mesh/files/scenes/sofa_file.hpp"

#include <array>
#include <stdexcept>

#include <gtest/gtest.h>

#include "tests/growth_of_time.hpp"
#include "tests/problems/mesh/files/mesh_damage.hpp"
#include "tests/problems/mesh/files/mesh_goldens.hpp"
#include "tests/results/scratch.hpp"
#include "tests/says.hpp"

namespace hmax {
namespace {

const std::string one_scn =
    "<?xml version=\"1.0\"?>\n<!-- by hand -->\n<Node name=\"root\">\n<Object type='MechanicalObject' "
    "position='0 0 0 .5 0 0 0 .5 0 0 0 .5 .5 .5 .5'/>\n<BoxROI name=\"low\" box=\"0 0 0 1 1 0  9 9 9 8 8 8\"/>\n"
    "<MeshTopology tetrahedra=\"0 1 2 3  1 2 3 4\"></MeshTopology>\n"
    "<TetrahedronFEMForceField youngModulus=\"4 2\"/>\n<FixedConstraint indices=\"@./low.indices\"/>\n"
    "<FixedProjectiveConstraint indices=\"4 0\"/>\n</Node>\n";

TEST(SofaFiles, TellTheSameMeshAsOtherFormats) {
  const MeshFile file = read_mesh("a.scn", one_scn);
  EXPECT_EQ(file.mesh.points, golden_mesh().points);
  EXPECT_EQ(file.mesh.tetrahedra, golden_mesh().tetrahedra);
  EXPECT_EQ(file.mesh.regions, (std::vector<TetMesh::Index>{2, 1}));
  EXPECT_EQ(file.where(1), "a.scn, line 6: tetrahedron 1");
  ASSERT_EQ(file.groups.size(), 1U);
  EXPECT_EQ(file.groups[0].name, fixed_points_of_sofa);
  EXPECT_EQ(file.groups[0].corners, (std::vector<TetMesh::Index>{0, 1, 2, 4}));
}

TEST(SofaFiles, SayThatTheFileOfTheirMeshIsMissing) {
  for (const std::string& name : {std::string("none"), std::string(300, 'n')}) {
    const std::string text = "<Node name=\"root\">\n<MeshGmshLoader name=\"file\" filename=\"" + name +
                             ".msh\"/>\n<TetrahedronSetTopologyContainer src=\"@file\"/>\n"
                             "<MechanicalObject/>\n</Node>\n";
    EXPECT_TRUE(says(error_of<std::invalid_argument>([&] { static_cast<void>(read_mesh("a.scn", text)); }),
                     "there is no file"));
  }
}

TEST(SofaFiles, AreScaledAndMovedByTheirLoader) {
  const Scratch folder;
  write_text(
      folder / "a.vtk",
      "# vtk DataFile Version 2.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 double\n0 0 0 1 0 0 0 1 0\n"
      "0 0 1\nCELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\n");
  const auto read = [&](const std::string& loader, const std::string& state) {
    write_text(folder / "a.scn",
               "<Node name=\"root\">\n<MeshVTKLoader name=\"file\" filename=\"a.vtk\" " + loader +
                   "/>\n<TetrahedronSetTopologyContainer src=\"@file\"/>\n<MechanicalObject " + state +
                   "/>\n</Node>\n");
    return read_mesh_file(folder / "a.scn");
  };
  const Eigen::Matrix3Xd plain = read("", "translation=\"0 0 0\" scale=\"1\"").mesh.points;
  const Eigen::Vector3d scale(0.002, 0.002, 0.004), by(5, 0, -1);
  EXPECT_EQ(read("translation=\"5 0 -1\" scale3d=\".001 .001 .002\" scale=\"2\" rotation=\"0 0 0\"", "")
                .mesh.points,
            Eigen::Matrix3Xd((scale.asDiagonal() * plain).colwise() + by));
  for (const auto& [loader, state, named] :
       {std::array{"rotation=\"0 90 0\"", "", "line 2: 'rotation' = '0 90 0' of MeshVTKLoader is not read"},
        {"scale=\"0\"", "", "a scale is not positive"},
        {"", "scale3d=\".1 1 1\"", "line 4: 'scale3d' = '.1 1 1' of MechanicalObject is not read"},
        {"", "dx=\"3\"", "'dx' = '3'"}})
    EXPECT_TRUE(says(error_of<std::invalid_argument>([&] { read(loader, state); }), named));
}

/// The body of each part once was looked for anew.
TEST(SofaFiles, MayHaveNodesInNodesWithoutEnd) {
  const auto read = [](int depth) {
    std::string text =
        "<Node name=\"root\"><MechanicalObject position=\"0 0 0 1 0 0 0 1 0 0 0 1\"/>"
        "<MeshTopology tetrahedra=\"0 1 2 3\"/>";
    for (int i = 0; i < depth; ++i) text += "<Node><OglModel/>";
    for (int i = 0; i < depth; ++i) text += "</Node>";
    EXPECT_EQ(read_mesh("a.scn", text + "</Node>").mesh.tetrahedron_count(), 1);
  };
  EXPECT_LT(growth_of_time(read, 750), 12);  // so short that the pages of the larger one are seen
}

/// Whatever a damaged file says, it is refused in one sentence or is a mesh.
TEST(SofaFiles, SurviveDamage) {
  EXPECT_GT(refused_damages("a.scn", one_scn, {'<', '>', '"', '/', '@', '-', '9', '\0', '\xff'}),
            4 * one_scn.size());
}

}  // namespace
}  // namespace hmax
