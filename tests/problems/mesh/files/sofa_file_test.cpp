#include "problems/mesh/files/scenes/sofa_file.hpp"

#include <stdexcept>

#include <gtest/gtest.h>

#include "tests/problems/mesh/files/mesh_damage.hpp"
#include "tests/problems/mesh/files/mesh_goldens.hpp"
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

/// Whatever a damaged file says, it is refused in one sentence or is a mesh.
TEST(SofaFiles, SurviveDamage) {
  EXPECT_GT(refused_damages("a.scn", one_scn, {'<', '>', '"', '/', '@', '-', '9', '\0', '\xff'}),
            4 * one_scn.size());
}

}  // namespace
}  // namespace hmax
