#include "problems/mesh/files/mesh_writers.hpp"

#include <cstdint>
#include <numeric>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "problems/mesh/files/mesh_import.hpp"
#include "problems/tissue/sofa_scene.hpp"
#include "tests/problems/mesh/files/mesh_goldens.hpp"
#include "tests/problems/mesh/meshes.hpp"
#include "tests/says.hpp"

namespace hmax {
namespace {

/// Coordinates with all their digits, and regions.
TetMesh awkward_mesh() {
  TetMesh mesh = ball_mesh(1. / 3, 2);
  mesh.points.array() += 1e-9;
  mesh.points(0, 0) = -5e-324;
  mesh.regions.resize(static_cast<std::size_t>(mesh.tetrahedron_count()));
  std::iota(mesh.regions.begin(), mesh.regions.end(), -3);
  return mesh;
}

void expect_same(const TetMesh& read, const TetMesh& written) {
  EXPECT_EQ(read.points, written.points);
  EXPECT_EQ(read.tetrahedra, written.tetrahedra);
  EXPECT_EQ(read.regions, written.regions);
}

TEST(MeshWriters, GmshReadsBackBitForBit) {
  expect_same(read_mesh("a.msh", msh_text(awkward_mesh())).mesh, awkward_mesh());
  EXPECT_TRUE(read_mesh("a.msh", msh_text(cube_mesh(1, 2))).mesh.regions.empty());
}

TEST(MeshWriters, VtkReadsBackBitForBitInEveryEncoding) {
  const TetMesh mesh = awkward_mesh();
  MeshFields fields;
  fields.points.push_back({"displacement <m>", Eigen::MatrixXd::Random(3, mesh.point_count())});
  fields.tetrahedra.push_back({"energy", Eigen::MatrixXd::Random(1, mesh.tetrahedron_count())});
  for (const VtuEncoding encoding : {VtuEncoding::ascii, VtuEncoding::base64, VtuEncoding::raw}) {
    const std::string text = vtu_text(counted_from_one(mesh), fields, encoding);
    expect_same(read_mesh("a.vtu", text).mesh, mesh);
    EXPECT_TRUE(says(text, "Name=\"displacement &lt;m&gt;\" NumberOfComponents=\"3\""));
  }
}

TEST(MeshWriters, EveryGoldenGoesThroughBothWriters) {
  for (const GoldenMesh& golden : golden_meshes()) {
    const TetMesh mesh = golden.read().mesh;
    expect_same(read_mesh("a.msh", msh_text(mesh)).mesh, mesh);
    expect_same(read_mesh("a.vtu", vtu_text(counted_from_one(mesh))).mesh, mesh);
  }
}

/// The values of a field stand where its offset points: eight bytes of length, then the doubles.
TEST(MeshWriters, FieldsStandBehindTheirOffsets) {
  const TetMesh mesh = unit_tetrahedron();
  MeshFields fields;
  fields.points.push_back({"u", Eigen::MatrixXd(2, 4)});
  fields.points[0].values << 1, 3, 5, 7, 2, 4, 6, 8;
  const std::string text = vtu_text(counted_from_one(mesh), fields);
  const std::string tag = "Name=\"u\" NumberOfComponents=\"2\" format=\"appended\" offset=\"";
  const std::size_t offset = std::stoul(text.substr(text.find(tag) + tag.size()));
  EXPECT_EQ(text.substr(text.find("\n_") + 2 + offset, 72),
            Bytes().longs({64}).reals({1, 2, 3, 4, 5, 6, 7, 8}).str());
}

TEST(MeshWriters, GmshCountsElementsOfSurfacesAroundTheNumbersOfTetrahedra) {
  MeshFile file = counted_from_one(unit_tetrahedron());
  file.groups.push_back({.dimension = 2, .number = 7, .corners = {0, 1, 2, 0, 1, 3, 0, 2, 3, 1, 2, 3}});
  const auto numbers = [&](std::int64_t of_the_tetrahedron) {
    file.numbers = {of_the_tetrahedron};
    const std::string text = msh_text(file), begin = "$Elements\n5\n";
    std::istringstream lines(text.substr(text.find(begin) + begin.size()));
    std::vector<std::int64_t> found;
    for (std::string line; std::getline(lines, line) && line != "$EndElements";)
      found.push_back(std::stoll(line));
    return found;
  };
  EXPECT_EQ(numbers(1), (std::vector<std::int64_t>{2, 3, 4, 5, 1}));
  EXPECT_EQ(numbers(3), (std::vector<std::int64_t>{1, 2, 4, 5, 3}));
  EXPECT_EQ(numbers(9), (std::vector<std::int64_t>{1, 2, 3, 4, 9}));
}

TEST(MeshWriters, AFieldOfAnotherMeshIsRefused) {
  MeshFields fields;
  fields.points.push_back({"u", Eigen::MatrixXd::Zero(3, 5)});
  EXPECT_THROW(vtu_text(counted_from_one(unit_tetrahedron()), fields), std::invalid_argument);
}

TEST(MeshWriters, ASeriesNamesItsFramesWithTheirTimes) {
  const std::vector<std::pair<double, std::string>> frames{{0, "liver_0000.vtu"}, {0.1, "a&b.vtu"}};
  const std::string text = pvd_text(frames);
  EXPECT_TRUE(says(text, "<DataSet timestep=\"0\" file=\"liver_0000.vtu\"/>"));
  EXPECT_TRUE(says(text, "<DataSet timestep=\"0.1\" file=\"a&amp;b.vtu\"/>"));
  EXPECT_TRUE(says(text, "type=\"Collection\""));
}

TissueSettings liver_settings() {
  TissueSettings settings;
  settings.model = tissue_model("fem_corotational");
  settings.materials[0] = {.young = 2600, .poisson = 0.3, .density = 1000};
  settings.gravity = {0, 0, -9.81};
  settings.supports = {{.points = {2, 0}}, {.points = {2}}};
  return settings;
}

TEST(SofaScenes, HoldMeshMaterialSupportsAndStep) {
  TissueSettings settings = liver_settings();
  const std::string text = sofa_text(TissueBody(unit_tetrahedron(), settings), {0.02});
  for (const char* part :
       {"dt=\"0.02\" gravity=\"0 0 -9.81\"", "position=\"0 0 0 1 0 0 0 1 0 0 0 1\" tetrahedra=\"0 1 2 3\"",
        "youngModulus=\"2600\" poissonRatio=\"0.3\" method=\"polar\"", "massDensity=\"1000\"",
        "indices=\"0 2\""})
    EXPECT_TRUE(says(text, part));
  EXPECT_EQ(std::count(text.begin(), text.end(), '<'), std::count(text.begin(), text.end(), '>'));
  settings.total_mass = 1.5;
  EXPECT_TRUE(says(sofa_text(TissueBody(unit_tetrahedron(), settings), {0.02}), "totalMass=\"1.5\""));
}

TEST(SofaScenes, HoldElasticSupports) {
  TissueSettings settings = liver_settings();
  settings.supports = {};
  settings.elastic_supports = {{.points = {3, 1}, .stiffness = {20, 0.5}}};
  const std::string text = sofa_text(TissueBody(unit_tetrahedron(), settings), {0.02});
  EXPECT_TRUE(
      says(text, "<RestShapeSpringsForceField template=\"Vec3d\" points=\"3 1\" stiffness=\"20 0.5\"/>"));
  EXPECT_TRUE(says(text, "Sofa.Component.SolidMechanics.Spring"));
  EXPECT_FALSE(says(text, "FixedProjectiveConstraint"));
}

/// The scene of two tetrahedra of regions 9 and 4, in a file with an idle point in front.
std::string scene_of_two_regions(const TissueModel& model, double nu_of_4, double nu_of_9) {
  TetMesh mesh;
  mesh.points.resize(3, 6);
  mesh.points << 7, 0, 1, 0, 0, 1, 7, 0, 0, 1, 0, 1, 7, 0, 0, 0, 1, 1;
  mesh.tetrahedra.resize(4, 2);
  mesh.tetrahedra << 1, 2, 2, 3, 3, 4, 4, 5;
  mesh.regions = {9, 4};
  MeshImport import = import_mesh(counted_from_one(mesh), 1);
  TissueSettings settings = liver_settings();
  settings.model = model;
  settings.materials = {{.young = 400, .poisson = nu_of_4, .density = 4},
                        {.young = 900, .poisson = nu_of_9, .density = 9}};
  settings.supports = {};
  const TissueBody body(import.mesh, settings, std::make_shared<const MeshOrigin>(import.origin));
  return sofa_text(body, {0.01});
}

TEST(SofaScenes, HoldTheMaterialsOfRegionsInTheOrderOfTheFile) {
  const std::string text = scene_of_two_regions(tissue_model("fem_corotational"), 0.3, 0.3);
  EXPECT_FALSE(says(text, "name=\"part\""));
  // Volumes 1/6 and 1/3: a quarter of each at its points.
  const double a = 9. / 24, b = 4. / 12;
  for (const std::string& part :
       {std::string("tetrahedra=\"1 2 3 4 2 3 4 5\""), std::string("youngModulus=\"900 400\""),
        std::string("position=\"7 7 7 0 0 0"), std::string("FixedProjectiveConstraint indices=\"0\"")})
    EXPECT_TRUE(says(text, part));
  const std::string tag = "vertexMass=\"";
  std::istringstream read(text.substr(text.find(tag) + tag.size()));
  for (const double mass : {0., a, a + b, a + b, a + b, b}) {
    double found = -1;
    read >> found;
    EXPECT_NEAR(found, mass, 1e-14);
  }
}

/// The positions of a text in a scene ascend: each stands behind the one before.
void expect_in_order(const std::string& scene, std::initializer_list<const char*> parts) {
  std::size_t at = 0;
  for (const char* part : parts) {
    at = scene.find(part, at);
    ASSERT_NE(at, std::string::npos) << part << "\n" << scene;
  }
}

TEST(SofaScenes, GiveEachRegionAForceFieldWhereOneCannotHoldTheMaterials) {
  const std::string linear = scene_of_two_regions(tissue_model("fem_corotational"), 0.3, 0.45);
  expect_in_order(linear, {"<TetrahedronSetTopologyContainer name=\"mesh\"", "tetrahedra=\"1 2 3 4 2 3 4 5\"",
                           "<MechanicalObject", "<DiagonalMass", "<Node name=\"region_1\">",
                           "name=\"part\" position=\"@../mesh.position\" tetrahedra=\"2 3 4 5\"",
                           "youngModulus=\"400\" poissonRatio=\"0.3\" method=\"polar\"", "</Node>",
                           "<Node name=\"region_2\">", "tetrahedra=\"1 2 3 4\"",
                           "youngModulus=\"900\" poissonRatio=\"0.45\" method=\"polar\"", "</Node>"});
  // One state of motion, and no field on all tetrahedra beside those of the regions.
  EXPECT_EQ(linear.find("<MechanicalObject"), linear.rfind("<MechanicalObject"));
  EXPECT_LT(linear.find("region_1"), linear.find("<TetrahedronFEMForceField"));
  // mu = E / (2 (1 + nu)), lambda = 2 mu nu / (1 - 2 nu).
  const std::string green = scene_of_two_regions(tissue_model("fem_green"), 0.25, 0.25);
  expect_in_order(green, {"tetrahedra=\"2 3 4 5\"", "ParameterSet=\"160 160\"", "tetrahedra=\"1 2 3 4\"",
                          "ParameterSet=\"360 360\""});
}

/// E = 2600, nu = 0.3: mu = 1000, lambda = 1500, bulk modulus 2166.67.
TEST(SofaScenes, TranslateTheMaterial) {
  const auto scene = [](const TissueModel& model) {
    TissueSettings settings = liver_settings();
    settings.model = model;
    return sofa_text(TissueBody(unit_tetrahedron(), settings), {0.01});
  };
  EXPECT_TRUE(says(scene(tissue_model("fem_green")), "ParameterSet=\"1000 1500"));
  EXPECT_TRUE(says(scene(tissue_model("fem_green")), "StVenantKirchhoff"));
  EXPECT_TRUE(says(scene(tissue_model("fem_neo_hookean")), "ParameterSet=\"1000 2166.6666666666"));
  EXPECT_TRUE(says(scene(tissue_model("fem_cauchy")), "method=\"small\""));
}

TEST(SofaScenes, HaveEverySpring) {
  TissueSettings settings = liver_settings();
  settings.model = tissue_model("mass_spring");
  settings.springs.stiffness = 12;
  settings.springs.damper = 0.5;
  const std::string text = sofa_text(TissueBody(unit_tetrahedron(), settings), {0.01});
  // Six edges: three of length 1, three of sqrt 2.
  for (const char* part :
       {"Sofa.Component.SolidMechanics.Spring", "spring=\"0 1 12 0.5 1 ", "2 3 12 0.5 1.414213562373095"})
    EXPECT_TRUE(says(text, part));
  EXPECT_FALSE(says(text, "FEM"));
}

TEST(SofaScenes, RefuseWhatTheyCannotSay) {
  const auto refused = [](auto change, double step = 0.01) {
    TissueSettings settings = liver_settings();
    change(settings);
    EXPECT_THROW(sofa_text(TissueBody(unit_tetrahedron(), settings), {step}), std::invalid_argument);
  };
  refused([](TissueSettings& s) { s.materials[0].young = 0; });
  refused([](TissueSettings& s) { s.materials[0].poisson = 0.5; });
  refused([](TissueSettings& s) { s.materials[0].density = -1; });
  refused([](TissueSettings& s) {
    s.model = tissue_model("mass_spring");
    s.springs.law = ExponentialSpring{};
  });
  refused([](TissueSettings& s) { s.beta = -1; });
  refused([](TissueSettings& s) { s.supports[0].points = {4}; });
  refused([](TissueSettings& s) { s.supports[0].travel = {0, 0, 0.1}; });
  refused([](TissueSettings& s) { s.skin.kind = SkinSettings::Kind::membrane; });
  refused([](TissueSettings& s) {
    s.materials[0].fibre_young = 1e4;
    s.materials[0].fibre_x = 1;
  });
  refused([](TissueSettings& s) {
    s.forces = {{.points = {1}, .force = {1, 0, 0}, .profile = {.kind = TimeProfile::Kind::ramp}}};
  });
  refused([](TissueSettings&) {}, 0);
}

TEST(SofaScenes, HaveDeadLoadsByTheirShares) {
  TissueSettings settings = liver_settings();
  settings.forces = {{.points = {1, 3}, .force = {0, 0, 2}},
                     {.points = {1, 3}, .force = {4, 0, 0}, .shares = {0.25, 0.75}}};
  const std::string text = sofa_text(TissueBody(unit_tetrahedron(), settings), {0.01});
  for (const char* part : {"Sofa.Component.MechanicalLoad", "indices=\"1 3\" forces=\"0 0 1 0 0 1\"",
                           "indices=\"1 3\" forces=\"1 0 0 3 0 0\""})
    EXPECT_TRUE(says(text, part));
  settings.forces.clear();
  EXPECT_FALSE(says(sofa_text(TissueBody(unit_tetrahedron(), settings), {0.01}), "MechanicalLoad"));
}

}  // namespace
}  // namespace hmax
