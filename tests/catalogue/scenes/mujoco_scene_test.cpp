#include <array>
#include <cmath>
#include <map>
#include <set>

#include <fmt/format.h>

#include "problems/mesh/files/mesh_file.hpp"
#include "problems/mesh/files/mesh_writers.hpp"
#include "problems/mesh/topology.hpp"
#include "tests/catalogue/scenes/scene_files.hpp"

namespace hmax {
namespace {

/// A corner of 1 kg above three pinned ones.
const std::string corner =
    "<mujoco model=\"corner\">\n<!-- <flexcomp/> -->\n<compiler angle=\"radian\"/>\n"
    "<option timestep=\"0.001\" integrator=\"implicitfast\" solver=\"CG\" gravity=\"0 0 0\"/>\n<worldbody>\n"
    "<light pos=\"0 0 3\"/>\n<body name=\"around\" pos=\"0 0 1\">\n"
    "<flexcomp name=\"soft\" type=\"direct\" dim=\"3\" mass=\"4\" point=\"0 0 0 1 0 0 0 1 0 0 0 1\" "
    "element=\"0 1 2 3\">\n<elasticity young=\"1000\" poisson=\"0.25\" damping=\"0.01\"/>\n"
    "<contact selfcollide=\"none\"/>\n<pin id=\"0 1\" range=\"2 2\"/>\n</flexcomp>\n</body>\n</worldbody>\n"
    "</mujoco>\n";

std::string grid(const std::string& attributes, const std::string& parts = "") {
  return "<mujoco><worldbody><flexcomp dim=\"3\" " + attributes + "><elasticity young=\"1000\"/>" + parts +
         "</flexcomp></worldbody></mujoco>";
}

class MujocoScenes : public SceneFiles {
 protected:
  MujocoScenes() : SceneFiles("a.xml", "m,kg,s", corner) {}
};

TEST_F(MujocoScenes, AreBodiesWithTheirElasticityAndPins) {
  const Scene scene = read(corner);
  EXPECT_EQ(scene.model, "fem_green");
  EXPECT_EQ(scene.step, 0.001);
  EXPECT_EQ(scene.integrator, "implicitfast");
  EXPECT_EQ(scene.method, "symplectic_euler");
  EXPECT_EQ(value(scene, "beta"), 0.01);
  EXPECT_EQ(value(scene, "g"), 0);
  const auto made = body(scene);
  ASSERT_EQ(made->dofs(), 3);
  // V (lambda + 2 mu) along z, V mu along x and y.
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(3);
  TissueBody::DofMatrix K;
  made->stiffness(0, zero, zero, K);
  EXPECT_NEAR(K.coeff(2, 2), 1200.0 / 6, 1e-9);
  EXPECT_NEAR(K.coeff(0, 0), 400.0 / 6, 1e-9);
  EXPECT_NEAR(made->mass()[0], 1, 1e-12);
}

TEST_F(MujocoScenes, TakeTheOptions) {
  EXPECT_EQ(read(changed("implicitfast", "RK4")).method, "rk4");
  EXPECT_EQ(read(changed("implicitfast", "discrete")).method, "linearly_implicit_euler");
  EXPECT_EQ(read(changed("integrator=\"implicitfast\"", "")).method, "symplectic_euler");
  const std::string option =
      corner.substr(corner.find("<option"), corner.find("<worldbody") - corner.find("<option"));
  const Scene without = read(changed(option, ""));
  EXPECT_EQ(without.step, 0.002);
  EXPECT_EQ(without.integrator, "Euler");
  EXPECT_EQ(value(without, "gz"), -9.81);
  EXPECT_EQ(value(read(changed(option, "<option><flag gravity=\"disable\"/></option>")), "g"), 0);
}

/// Boxes share the diagonals of their faces, so that the surface has two triangles of each face of the grid.
TEST_F(MujocoScenes, GridsAreBoxesOfSixTetrahedra) {
  read(grid("type=\"grid\" count=\"3 4 5\" spacing=\"0.1 0.2 0.3\"",
            "<pin grid=\"2 3 4\" gridrange=\"0 0 0 0 3 1\"/>"));
  const MeshFile file = read_mesh_file(folder / "a.xml");
  const TetMesh& mesh = file.mesh;
  ASSERT_EQ(mesh.point_count(), 60);
  ASSERT_EQ(mesh.tetrahedron_count(), 6 * 2 * 3 * 4);
  double volume = 0;
  for (Eigen::Index t = 0; t < mesh.tetrahedron_count(); ++t) {
    const auto x = [&](int k) { return Eigen::Vector3d(mesh.points.col(mesh.tetrahedra(k, t))); };
    const double each = (x(1) - x(0)).cross(x(2) - x(0)).dot(x(3) - x(0)) / 6;
    EXPECT_NEAR(each, 0.1 * 0.2 * 0.3 / 6, 1e-15);
    volume += each;
  }
  EXPECT_NEAR(volume, 0.2 * 0.6 * 1.2, 1e-12);
  EXPECT_EQ(surface_of(mesh).triangles.cols(), 2 * 2 * (2 * 3 + 3 * 4 + 2 * 4));
  // Points along z come first.
  EXPECT_NEAR((mesh.points.col(1) - mesh.points.col(0) - Eigen::Vector3d(0, 0, 0.3)).norm(), 0, 1e-15);
  EXPECT_NEAR((mesh.points.col(0) + mesh.points.col(59)).norm(), 0, 1e-15);
  const std::vector<TetMesh::Index>& pinned = file.groups.front().corners;
  EXPECT_EQ(std::set(pinned.begin(), pinned.end()),
            (std::set<TetMesh::Index>{0, 1, 5, 6, 10, 11, 15, 16, 59}));
}

TEST_F(MujocoScenes, StandWhereTheirBodiesAre) {
  const double half = std::sqrt(0.5);
  read(replaced(changed("pos=\"0 0 1\"", fmt::format("pos=\"0 0 1\" quat=\"{} {} 0 0\"", half, half)),
                "mass=\"4\"", "mass=\"4\" scale=\"1 2 1\" pos=\"0 0 5\""));
  const Eigen::Matrix3Xd x = read_mesh_file(folder / "a.xml").mesh.points;
  // A quarter turn about x takes y to z and z to -y.
  EXPECT_NEAR((x.col(2) - Eigen::Vector3d(0, -5, 3)).norm(), 0, 1e-12);
  EXPECT_NEAR((x.col(3) - Eigen::Vector3d(0, -6, 1)).norm(), 0, 1e-12);
}

/// MuJoCo removes points in no tetrahedron, and the others share the mass.
TEST_F(MujocoScenes, HaveMassAtThePointsOfTetrahedra) {
  const Scene scene = read(changed("0 0 1\" element", "0 0 1 7 7 7\" element"));
  EXPECT_NEAR(body(scene)->mass()[0], 1, 1e-12);
}

TEST_F(MujocoScenes, LoadMeshesOfGmsh) {
  read(grid("count=\"3 3 3\""));
  const MeshFile mesh = read_mesh_file(folder / "a.xml");
  std::string text =
      fmt::format("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{}\n", mesh.mesh.point_count());
  for (Eigen::Index i = 0; i < mesh.mesh.point_count(); ++i)
    text += fmt::format("{} {} {} {}\n", i + 1, mesh.mesh.points(0, i), mesh.mesh.points(1, i),
                        mesh.mesh.points(2, i));
  text += fmt::format("$EndNodes\n$Elements\n{}\n", mesh.mesh.tetrahedron_count());
  for (Eigen::Index t = 0; t < mesh.mesh.tetrahedron_count(); ++t)
    text += fmt::format("{} 4 2 0 1 {} {} {} {}\n", t + 1, mesh.mesh.tetrahedra(0, t) + 1,
                        mesh.mesh.tetrahedra(1, t) + 1, mesh.mesh.tetrahedra(2, t) + 1,
                        mesh.mesh.tetrahedra(3, t) + 1);
  std::filesystem::create_directory(folder / "meshes");
  write_text(folder / "meshes/b.msh", text + "$EndElements\n");
  const Scene scene = read(replaced(grid("type=\"gmsh\" file=\"b.msh\"", "<pin id=\"0 1 2\"/>"),
                                    "<worldbody>", "<compiler meshdir=\"meshes\"/><worldbody>"));
  EXPECT_EQ(body(scene)->dofs(), 3 * 24);
  for (const std::string& name : {std::string("b"), std::string(300, 'b')})
    EXPECT_TRUE(says(error(grid("type=\"gmsh\" file=\"" + name + ".msh\"")), "there is no file"));
  EXPECT_TRUE(says(error(grid("type=\"gmsh\" file=\"a.xml\"")), "takes a .msh"));
}

TEST_F(MujocoScenes, NameWhatTheyDoNotUnderstand) {
  const std::map<std::string, std::array<const char*, 2>> cases{
      {"a second flexcomp", {"<light", "<flexcomp/><light"}},
      {"dim '2'", {" dim=\"3\"", ""}},
      {"of type 'box'", {"\"direct\"", "\"box\""}},
      {"dof is 'trilinear'", {"dim=\"3\"", "dim=\"3\" dof=\"trilinear\""}},
      {"a body that moves", {"<flexcomp name", "<freejoint/><flexcomp name"}},
      {"--ignore 'geom'", {"<light", "<geom type=\"plane\" size=\"1 1 1\"/><light"}},
      {"--ignore 'body'", {"<light", "<body/><light"}},
      {"--ignore 'include'", {"<worldbody", "<include file=\"scene.xml\"/><worldbody"}},
      {"--ignore 'equality'", {"<worldbody", "<equality/><worldbody"}},
      {"--ignore 'edge'", {"<contact", "<edge equality=\"true\"/><contact"}},
      {"springs besides", {"<contact", "<edge stiffness=\"3\"/><contact"}},
      {"a plugin gives", {"<contact", "<plugin plugin=\"mujoco.elasticity.solid\"/><contact"}},
      {"no elasticity with a positive young", {"young=\"1000\"", ""}},
      {"integrator is 'verlet'", {"implicitfast", "verlet"}},
      {"timestep is not positive", {"\"0.001\"", "\"0\""}},
      {"viscosity is there", {"solver=\"CG\"", "viscosity=\"1\""}},
      {"spring is disabled", {"gravity=\"0 0 0\"/>", "><flag spring=\"disable\"/></option>"}},
      {"settotalmass", {"angle=\"radian\"", "settotalmass=\"3\""}},
      {"euler of body is not read", {"pos=\"0 0 1\"", "euler=\"0 0 1\""}},
      {"no point 4 to pin", {"id=\"0 1\"", "id=\"0 4\""}},
      {"no point -1 to pin", {"range=\"2 2\"", "range=\"-1 2\""}},
      {"first and a last place", {"range=\"2 2\"", "range=\"2\""}},
      {"range ends before it begins", {"range=\"2 2\"", "range=\"2 1\""}},
      {"elasticity is given twice", {"<contact", "<elasticity/><contact"}},
      {"of type grid; pin by id", {"range=\"2 2\"", "grid=\"0 0 0\""}},
      {"mass is not positive", {"mass=\"4\"", "mass=\"-4\""}},
      {"10 numbers, which are not three",
       {"point=\"0 0 0 1 0 0 0 1 0 0 0 1\"", "point=\"0 0 0 1 0 0 0 1 0 1\""}},
      {"'skin' is not understood", {"<worldbody", "<skin/><worldbody"}},
      {"'colour' of flexcomp", {"dim=\"3\"", "dim=\"3\" colour=\"1\""}}};
  for (const auto& [named, change] : cases) expect_refused(change[0], change[1], named, ", line ");
  EXPECT_TRUE(says(error("<mujoco/>"), "there is no flexcomp"));
  EXPECT_TRUE(says(
      read(changed("<light", "<geom type=\"plane\" size=\"1 1 1\"/><light"), "geom").notes.back(), "geom"));
  EXPECT_EQ(error(changed("<light", "<geom contype=\"0\" conaffinity=\"0\" size=\"1\"/><light")), "");
}

TEST_F(MujocoScenes, HavePinsThatOtherFormatsKeep) {
  read(corner);
  const MeshFile file = read_mesh_file(folder / "a.xml");
  ASSERT_EQ(file.groups.size(), 1U);
  for (const auto& [name, text] : {std::pair("a.msh", msh_text(file)), {"a.vtu", vtu_text(file)}}) {
    const MeshFile back = read_mesh(name, text);
    ASSERT_EQ(back.groups.size(), 1U) << name;
    EXPECT_EQ(back.groups.front().name, "pin");
    EXPECT_EQ(back.groups.front().corners, (std::vector<TetMesh::Index>{0, 1, 2}));
  }
}

TEST_F(MujocoScenes, RefuseEndlessGrids) {
  for (const char* count :
       {"1000000000 1000000000 1000000000", "9223372036854775807 2 2", "1 4 4", "-3 4 4", "3 4"})
    EXPECT_TRUE(says(error(grid(fmt::format("count=\"{}\"", count))), "count")) << count;
  EXPECT_TRUE(says(error(grid("count=\"3 3 3\"", "<pin range=\"0 9223372036854775807\"/>")), "no point"));
  EXPECT_TRUE(says(error(grid("count=\"3 3 3\"", "<pin gridrange=\"0 0 0 3 1 1\"/>")), "outside of count"));
}

TEST_F(MujocoScenes, AreRefusedInOneSentenceWhereverTheyAreDamaged) {
  const std::size_t count = refused(corner, 3, [](std::size_t i) {
    return std::array{corner.substr(0, i), corner.substr(0, i) + "\"" + corner.substr(i),
                      corner.substr(0, i) + corner.substr(std::min(corner.size(), i + 4))};
  });
  EXPECT_GT(count, corner.size() / 3);
}

}  // namespace
}  // namespace hmax
