#include "problems/tissue/sofa_scene.hpp"

#include <map>

#include <Eigen/Eigenvalues>

#include "tests/catalogue/scenes/scene_files.hpp"

namespace hmax {
namespace {

/// The unit tetrahedron with one free corner, of SOFA's own making.
const std::string tetrahedron =
    "<?xml version=\"1.0\"?>\n<!-- by hand -->\n<Node name=\"root\" dt=\"0.02\" gravity=\"0 -9 0\">\n"
    "  <RequiredPlugin name=\"Sofa.Component.Mass\"/>\n  <DefaultAnimationLoop/>\n"
    "  <Node name=\"body\">\n    <EulerExplicitSolver name=\"solver\" />\n"
    "    <TetrahedronSetTopologyContainer name=\"topo\" position=\"0 0 0 1 0 0 0 1 0 0 0 1\" tetrahedra=\"0 1 2 "
    "3\"/>\n"
    "    <MechanicalObject template=\"Vec3\" name=\"dofs\" showObject=\"1\"/>\n"
    "    <UniformMass totalMass=\"4\"/>\n"
    "    <TetrahedronFEMForceField youngModulus=\"1000\" poissonRatio=\"0.25\" method='small'/>\n"
    "    <FixedProjectiveConstraint indices=\"0 1 2\"/>\n"
    "    <Node name=\"look\">\n      <OglModel name=\"seen\" src=\"@../../surface\"/>\n"
    "      <MechanicalObject name=\"spheres\"/>\n      <BarycentricMapping/>\n    </Node>\n  </Node>\n</Node>\n";

class SofaScenes : public SceneFiles {
 protected:
  SofaScenes() : SceneFiles("a.scn", "m,kg,s", tetrahedron) {}
};

/// The squares of the frequencies at rest, sorted.
Eigen::VectorXd frequencies(const TissueBody& body) {
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(body.dofs());
  TissueBody::DofMatrix K;
  body.stiffness(0, zero, zero, K);
  const Eigen::VectorXd scale = Eigen::VectorXd(body.mass()).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = scale.asDiagonal() * Eigen::MatrixXd(K) * scale.asDiagonal();
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(scaled, Eigen::EigenvaluesOnly).eigenvalues();
}

TEST_F(SofaScenes, AreNotWrittenWithoutMassesThatAreAdded) {
  const auto scaled = make_problem("fem_cauchy@ball:n=3", {.parameters = {{"mass_step", 0.01}}}).body;
  EXPECT_THROW(check_sofa_scene(scaled->settings(), {0.005}), std::invalid_argument);
}

TEST_F(SofaScenes, ComeBackFromWhatHmaxWrites) {
  for (const char* model : {"fem_cauchy", "fem_corotational", "fem_green", "fem_neo_hookean"}) {
    for (const bool by_mass : {false, true}) {
      ProblemSettings settings;
      settings.parameters = {{"E", 4000},
                             {"nu", 0.4},
                             {by_mass ? "mass" : "rho", by_mass ? 2 : 900},
                             {"alpha", 3},
                             {"beta", 0.002},
                             {"gx", 1.5},
                             {"gz", -9.81},
                             {"equal_masses", by_mass ? 1 : 0}};
      const auto before = make_problem(tissue_id(model, "ball:n=3", ""), settings).body;
      const Scene scene = read(sofa_text(*before, {0.005}));
      const auto after = body(scene);
      EXPECT_EQ(scene.model, model);
      EXPECT_EQ(scene.method, "linearly_implicit_euler");
      EXPECT_EQ(scene.step, 0.005);
      ASSERT_EQ(after->dofs(), before->dofs());
      const Eigen::VectorXd expected = frequencies(*before);
      EXPECT_LT((frequencies(*after) - expected).norm(), 1e-10 * expected.norm()) << model;
      EXPECT_NEAR(after->point_mass().sum(), before->point_mass().sum(), 1e-12);
      EXPECT_EQ(after->settings().alpha, 3);
      EXPECT_EQ(after->settings().beta, 0.002);
      EXPECT_EQ(after->settings().gravity, Eigen::Vector3d(1.5, 0, -9.81));
    }
  }
}

/// Two tetrahedra of two materials in all that may differ, on springs too; their masses and frequencies.
TEST_F(SofaScenes, ComeBackWithRegionsSpringsLoadsAndSolvers) {
  write_text(
      folder / "two.msh",
      "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n5\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n9 1 1 1.5\n$EndNodes\n"
      "$Elements\n2\n1 4 2 7 1 1 2 3 4\n2 4 2 5 1 2 3 4 9\n$EndElements\n");
  const std::string mesh = (folder / "two.msh").string();
  const std::vector<std::pair<std::string, Parameters>> bodies{
      {"fem_corotational", {{"E:7", 4000}, {"nu:7", 0.3}}},
      {"fem_green", {{"E:7", 4000}, {"nu:7", 0.3}, {"rho:7", 500}}},
      {"mass_spring", {{"E", 700}}},
      {"mass_spring", {{"k", 30}, {"damper", 0.02}}}};
  const Parameters acting{{"support:points:1", 1},
                          {"gx", 1},
                          {"alpha", 3},
                          {"force_z:points:9", 2},
                          {"force_x:points:2,9", -0.5}};
  for (const auto& [model, own] : bodies)
    for (const std::string& method : sofa_methods()) {
      ProblemSettings settings;
      settings.parameters = own;
      settings.parameters.insert(settings.parameters.end(), acting.begin(), acting.end());
      settings.unit = 1;
      const auto before = make_problem(tissue_id(model, mesh, ""), settings).body;
      const Scene scene = read(sofa_text(*before, sofa_step(method, 0.005)));
      EXPECT_EQ(scene.model, model);
      EXPECT_EQ(scene.step, 0.005);
      EXPECT_EQ(scene.method.substr(0, scene.method.find(':')), method);
      const auto after = body(scene);
      ASSERT_EQ(after->dofs(), before->dofs());
      const Eigen::VectorXd expected = frequencies(*before), zero = Eigen::VectorXd::Zero(before->dofs());
      EXPECT_LT((frequencies(*after) - expected).norm(), 1e-9 * expected.norm()) << model << ' ' << method;
      const auto at_rest = [&](const TissueBody& made, const Eigen::VectorXd& v) {
        Eigen::VectorXd force = zero;
        made.force(0, zero, v, force);
        return force;
      };
      const Eigen::VectorXd v = Eigen::VectorXd::LinSpaced(before->dofs(), -1, 1);
      EXPECT_LT((at_rest(*after, zero) - at_rest(*before, zero)).norm(), 1e-9);
      EXPECT_LT((at_rest(*after, v) - at_rest(*before, v)).norm(), 1e-9) << model << ' ' << method;
    }
}

TEST_F(SofaScenes, HaveNoSolverForOtherMethodsAndNoDampingOfExplicitOnes) {
  EXPECT_TRUE(
      says(error_of<InputError>([] { sofa_step("hht_alpha", 1); }), "no solver that steps as hht_alpha"));
  EXPECT_EQ(sofa_step("newmark:beta=0.3,gamma=0.6", 1).gamma, 0.6);
  ProblemSettings settings;
  settings.parameters = {{"beta", 0.1}};
  const auto damped = make_problem("fem_cauchy@cube:n=1", settings).body;
  EXPECT_TRUE(
      says(error_of<std::invalid_argument>([&] { sofa_text(*damped, sofa_step("rk4", 1)); }), "set beta=0"));
  EXPECT_TRUE(says(sofa_text(*damped, sofa_step("newmark", 1)), "rayleighStiffness=\"0.1\""));
}

/// The edges of the unit tetrahedron: three of length 1 and three of sqrt(2).
TEST_F(SofaScenes, HaveSpringsOnTheEdgesOfTetrahedra) {
  const std::string field =
      "TetrahedronFEMForceField youngModulus=\"1000\" poissonRatio=\"0.25\" method='small'";
  const Scene meshed =
      read(changed(field, "MeshSpringForceField tetrahedraStiffness=\"60\" tetrahedraDamping=\"3\""));
  EXPECT_EQ(meshed.model, "mass_spring");
  EXPECT_EQ(value(meshed, "k"), 60);
  EXPECT_EQ(value(meshed, "damper"), 0.05);
  // Along (0, 0, 1), (-1, 0, 1) and (0, -1, 1), with the mass of 1.
  EXPECT_NEAR(frequencies(*body(meshed)).sum(), 3 * 60, 1e-10);
  const std::string listed =
      "0 1 60 3 1 0 2 60 3 1 0 3 60 3 1 1 2 60 3 1.4142135623730951 1 3 60 3 1.4142135623730951 2 3 60 3 "
      "1.4142135623730951";
  const std::string text = changed(field, "StiffSpringForceField spring=\"" + listed + "\"");
  EXPECT_EQ(value(read(text), "k"), 60);
  for (const auto& [what, by, named] :
       {std::array{"0 1 60 3 1 ", "", "an edge of a tetrahedron has no spring"},
        {"0 1 60 3 1 ", "0 1 60 3 1 1 0 60 3 1 ", "points 1 and 0 is not the only one"},
        {"0 1 60 3 1 ", "0 4 60 3 1 ", "points 0 and 4 is not the only one"},
        {"0 1 60 3 1 ", "0 1 60 3 0.9 ", "length 0.9 at rest and not 1"},
        {"0 1 60 3 1 ", "0 1 60 4 1 ", "one ratio"},
        {"0 1 60 3 1 ", "0 1 90 4.5 1 ", "one stiffness"},
        {"0 1 60 3 1 ", "0 1 60 3 ", "not five of each"},
        {"<Fixed", "<TetrahedronFEMForceField youngModulus=\"1\" poissonRatio=\"0\"/><Fixed",
         "springs beside"}})
    EXPECT_TRUE(says(error(replaced(text, what, by)), named));
  EXPECT_TRUE(
      says(error(changed(field, "MeshSpringForceField tetrahedraStiffness=\"60\" linesStiffness=\"50\"")),
           "linesStiffness is not that of tetrahedra"));
}

/// Links name components from the node of the part, and bare ones also in the nodes above.
TEST_F(SofaScenes, FollowLinksAndHaveForcesInNodes) {
  const std::string field =
      "    <TetrahedronFEMForceField youngModulus=\"1000\" poissonRatio=\"0.25\" method='small'/>\n";
  const std::string child = changed(field, "<Node name=\"forces\">" + field + "</Node>");
  EXPECT_NEAR(frequencies(*body(read(child)))[2], 200, 1e-10);
  const std::string points =
      "<MeshTopology name=\"other\" position=\"0 0 0 1 0 0 0 1 0 0 0 1\"/><Node name=\"body\">\n    "
      "<BoxROI name=\"other\" box=\"0 0 0 0 0 0\"/>";
  const auto linked = [&](const std::string& link) {
    return replaced(changed("<Node name=\"body\">", points), "template=\"Vec3\"",
                    "position=\"" + link + "\"");
  };
  EXPECT_NEAR(frequencies(*body(read(linked("@../other.position"))))[2], 200, 1e-10);
  EXPECT_NEAR(frequencies(*body(read(linked("@/other.position"))))[2], 200, 1e-10);
  EXPECT_TRUE(says(error(linked("@./others.position")), "no component has this name there"));
  EXPECT_TRUE(says(error(linked("@./other.position")), "that of 'BoxROI', which is not read"));
  EXPECT_TRUE(says(error(linked("@/body/look/other.position")), "no component has this name there"));
  EXPECT_TRUE(says(error(replaced(linked("@../other.position"), "\"0 0 0 1 0 0 0 1 0 0 0 1\"/>",
                                  "\"0 0 0 1 0 0 0 1 0 0 0 2\"/>")),
                   "not that of its topology"));
  const std::string loaded = changed("<Fixed", "<ConstantForceField indices=\"3\" forces=\"1 0 2\"/><Fixed");
  EXPECT_EQ(value(read(loaded), "force_z:points:3"), 2);
  EXPECT_TRUE(says(error(replaced(loaded, "indices=\"3\"", "indices=\"4\"")), "acts on point 4"));
  EXPECT_TRUE(says(error(replaced(loaded, "1 0 2", "1 0")), "needs indices"));
  EXPECT_EQ(value(read(replaced(loaded, "indices=\"3\" forces", "indices=\"2 3\" totalForce")),
                  "force_z:points:2,3"),
            1);
  EXPECT_TRUE(says(error(changed("<Fixed",
                                 "<DiagonalVelocityDampingForceField "
                                 "dampingCoefficient=\"1\"/><Fixed")),
                   "one ratio to the mass"));
}

TEST_F(SofaScenes, HaveTheModulusOfEachElement) {
  write_text(
      folder / "two.msh",
      "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n5\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 1 1 1\n$EndNodes\n"
      "$Elements\n2\n1 4 2 7 1 1 2 3 4\n2 4 2 5 1 2 3 4 5\n$EndElements\n");
  ProblemSettings settings;
  settings.parameters = {{"E:7", 4000}, {"E:5", 500}, {"support", 0}};
  settings.unit = 1;
  const auto before =
      make_problem(tissue_id("fem_corotational", (folder / "two.msh").string(), ""), settings).body;
  const std::string text = sofa_text(*before, {0.005});
  EXPECT_TRUE(says(text, "youngModulus=\"4000 500\""));
  const auto after = body(read(text));
  const Eigen::VectorXd expected = frequencies(*before);
  EXPECT_LT((frequencies(*after) - expected).norm(), 1e-10 * expected.norm());
  EXPECT_TRUE(says(error(replaced(text, "4000 500", "4000 500 3")), "3 numbers for 2 tetrahedra"));
}

/// V (lambda + 2 mu) / m of the corner along z, V mu / m across.
TEST_F(SofaScenes, AreWhatSofaIntegrates) {
  const Scene scene = read(tetrahedron);
  EXPECT_EQ(scene.integrator, "EulerExplicitSolver");
  EXPECT_EQ(scene.method, "symplectic_euler");
  EXPECT_EQ(scene.step, 0.02);
  const auto made = body(scene);
  ASSERT_EQ(made->dofs(), 3);
  const Eigen::Vector3d squares = frequencies(*made);
  EXPECT_NEAR(squares[0], 400.0 / 6, 1e-10);
  EXPECT_NEAR(squares[2], 1200.0 / 6, 1e-10);
  EXPECT_EQ(made->settings().gravity, Eigen::Vector3d(0, -9, 0));
  for (const char* own : {"position=\"0 0 0 1 0 0 0 1 0 0 0 1\"", "position=\"@topo.position\"",
                          "template=\"Vec3d\"", "position=\"\""})
    EXPECT_EQ(body(read(changed("template=\"Vec3\"", own)))->dofs(), 3) << own;
  // The same numbers in other units: E of 1000 g/(mm ms^2), masses in g, and -9 mm/ms^2.
  const auto other = body(read_in("mm,g,ms", tetrahedron));
  EXPECT_NEAR(frequencies(*other)[2], 1e6 * squares[2], 1e-4);
  EXPECT_NEAR(other->settings().gravity.y(), -9000, 1e-9);
}

TEST_F(SofaScenes, TakeTheSolverAndTheForceField) {
  const auto method = [&](const std::string& solver) {
    return read(changed("EulerExplicitSolver name=\"solver\"", solver)).method;
  };
  EXPECT_EQ(method("EulerExplicitSolver symplectic=\"0\""), "explicit_euler");
  EXPECT_EQ(method("RungeKutta4Solver"), "rk4");
  EXPECT_EQ(method("Object type=\"EulerImplicit\" vdamping=\"0\" firstOrder=\"false\""),
            "linearly_implicit_euler");
  EXPECT_EQ(method("NewmarkImplicitSolver gamma=\"0.6\""), "newmark:beta=0.25,gamma=0.6");
  EXPECT_EQ(method("CGLinearSolver iterations=\"9\""), "");
  const Scene damped = read_in(
      "mm,g,ms",
      changed(
          "EulerExplicitSolver",
          "CGLinearSolver iterations=\"9\"/><EulerImplicitSolver rayleighMass=\"2\" rayleighStiffness=\"0.1\""));
  EXPECT_EQ(damped.gradients, "9");
  const std::map<std::string, double> values(damped.settings.parameters.begin(),
                                             damped.settings.parameters.end());
  EXPECT_DOUBLE_EQ(values.at("alpha"), 2000);
  EXPECT_DOUBLE_EQ(values.at("beta"), 1e-4);
  EXPECT_EQ(read(changed(" method='small'", "")).model, "fem_corotational");
  const Scene neo =
      read(changed("TetrahedronFEMForceField youngModulus=\"1000\" poissonRatio=\"0.25\" method='small'",
                   "TetrahedronHyperelasticityFEMForceField materialName=\"NeoHookean\" ParameterSet=\"400 "
                   "666.6666666666666\""));
  EXPECT_EQ(neo.model, "fem_neo_hookean");
  EXPECT_NEAR(frequencies(*body(neo))[2], 200, 1e-10);
}

TEST_F(SofaScenes, TakeMeshesFromLoadersAndFixPointsInBoxes) {
  write_text(
      folder / "one.msh",
      "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n$EndNodes\n"
      "$Elements\n1\n1 4 0 1 2 3 4\n$EndElements\n");
  std::string text = changed("  <Node name=\"body\">",
                             "<MeshGmshLoader name=\"file\" filename=\"one.msh\"/>\n<Node name=\"body\">");
  text = replaced(text, "position=\"0 0 0 1 0 0 0 1 0 0 0 1\" tetrahedra=\"0 1 2 3\"", "src=\"@../file\"");
  EXPECT_NEAR(frequencies(*body(read(text)))[2], 200, 1e-10);
  const std::string box =
      replaced(text, "<FixedProjectiveConstraint indices=\"0 1 2\"/>",
               "<BoxROI name=\"low\" box=\"0 0 0 1 1 0\"/><FixedConstraint indices=\"@low.indices\"/>");
  EXPECT_NEAR(frequencies(*body(read(box)))[2], 200, 1e-10);
  EXPECT_TRUE(says(error(replaced(text, "one.msh", "two.msh")), "no file"));
  EXPECT_TRUE(says(error(replaced(text, "one.msh", "a.scn")), "a scene is no mesh"));
  EXPECT_TRUE(says(error(replaced(text, "@../file", "@../files")), "no component has this name"));
  EXPECT_TRUE(says(error(replaced(box, "@low", "@dofs")), "only BoxROI is read"));
  EXPECT_TRUE(says(error(replaced(box, "1 1 0\"/>", "1 1\"/>")), "not six of each box"));
}

TEST_F(SofaScenes, NameWhatTheyDoNotUnderstand) {
  expect_refused("<DefaultAnimationLoop/>", "<CollisionPipeline/>",
                 "line 5: 'CollisionPipeline' is not understood");
  expect_refused("UniformMass ", "PointMass ", "'PointMass' is not understood");
  expect_refused("method='small'", "method='small' plasticYieldThreshold=\"1\"",
                 "'plasticYieldThreshold' = '1'");
  expect_refused("method='small'", "method='huge'", "method 'huge'");
  expect_refused("EulerExplicitSolver", "EulerImplicitSolver vdamping=\"0.1\"", "'vdamping' = '0.1'");
  expect_refused("EulerExplicitSolver", "RungeKutta4Solver/><EulerExplicitSolver", "one is read");
  expect_refused("template=\"Vec3\"", "translation=\"0 0 1\"", "'translation' = '0 0 1'");
  expect_refused("template=\"Vec3\"", "template=\"Rigid3d\"", "'Rigid3d', and points of Vec3");
  expect_refused("template=\"Vec3\"", "template=\"Vec2d\"", "'Vec2d', and points of Vec3");
  for (const char* position : {"0 0 0 1 0 0 0 1 0 0 0 2", "0 0 0 1 0 0"})
    expect_refused("template=\"Vec3\"", std::string("position=\"") + position + "\"",
                   "not that of its topology");
  expect_refused("<BarycentricMapping/>", "", "second MechanicalObject");
  expect_refused("<OglModel", "<UniformMass totalMass=\"1\"/><OglModel",
                 "not beside the first MechanicalObject");
  expect_refused("UniformMass totalMass=\"4\"", "MeshMatrixMass massDensity=\"4\"",
                 "without lumping couples points");
  expect_refused("UniformMass totalMass=\"4\"", "DiagonalMass", "has 0 of massDensity");
  expect_refused("UniformMass totalMass=\"4\"", "UniformMass massDensity=\"4\"", "'massDensity' = '4'");
  expect_refused("EulerExplicitSolver", "EulerExplicitSolver symplectic=\"yes\"", "symplectic is 'yes'");
  expect_refused("EulerExplicitSolver", "EulerImplicitSolver gamma=\"0.6\"", "'gamma' = '0.6'");
  expect_refused("UniformMass totalMass=\"4\"", "DiagonalMass vertexMass=\"1 1 1 2\"",
                 "not the same everywhere");
  expect_refused("poissonRatio=\"0.25\"", "", "poissonRatio of TetrahedronFEMForceField is missing");
  expect_refused(" indices=\"0 1 2\"", "", "SOFA fixes point 0");
  expect_refused("indices=\"0 1 2\"", "indices=\"0 1 4\"", "fixes point 4, but there are 4");
  expect_refused("tetrahedra=\"0 1 2 3\"", "tetrahedra=\"0 1 2 4\"", "4");
  expect_refused("tetrahedra=\"0 1 2 3\"", "tetrahedra=\"0 1 2\"", "corner");
  expect_refused(" tetrahedra=\"0 1 2 3\"", "", "has no tetrahedra; grids are not read");
  expect_refused("0 0 1\"", "0 0\"", "not three of each point");
  expect_refused("dt=\"0.02\"", "dt=\"0\"", "dt is 0");
  expect_refused("dt=\"0.02\"", "dt=\"0.02 1\"", "2 numbers of dt");
  expect_refused("youngModulus=\"1000\"", "youngModulus=\"1O00\"", "1O00");
  expect_refused("</Node>\n</Node>", "</Node>", "'Node' has no end");
  expect_refused("</Node>\n</Node>", "</Node>\n</Nodes>", "has no beginning");
  expect_refused("MechanicalObject template", "MechanicalState template",
                 "no TetrahedronSetTopologyContainer beside");
  EXPECT_TRUE(says(error(""), "no Node"));
  EXPECT_TRUE(says(error("<Scene/>"), "one Node"));
  const Scene scene =
      read(changed("<DefaultAnimationLoop/>", "<CollisionPipeline verbose=\"0\"/>"), "collisionpipeline");
  EXPECT_TRUE(says(scene.notes.back(), "left out"));
}

/// Wherever a file is cut off or damaged, it is refused in one sentence or is a scene.
TEST_F(SofaScenes, SurviveDamage) {
  const auto damage = [](std::size_t i) {
    return std::array{tetrahedron.substr(0, i), std::string(tetrahedron).replace(i, 1, "-")};
  };
  EXPECT_GT(refused(tetrahedron, 3, damage), tetrahedron.size() / 3);
}

}  // namespace
}  // namespace hmax
