#include <array>
#include <map>

#include <fmt/format.h>

#include "tests/catalogue/scenes/scene_files.hpp"
#include "tests/growth_of_time.hpp"

namespace hmax {
namespace {

/// Two tetrahedra of two materials, and one free corner of each.
const std::string two_parts =
    "<?xml version=\"1.0\" encoding=\"ISO-8859-1\"?>\n<febio_spec version=\"4.0\">\n<Module type=\"solid\"/>\n"
    "<Control>\n<analysis>DYNAMIC</analysis><time_steps>10</time_steps><step_size>0.1</step_size>\n"
    "<solver type=\"solid\"><rhoi>0.5</rhoi></solver></Control>\n"
    "<Globals><Constants><T>0</T></Constants></Globals>\n<Material>\n"
    "<material id=\"1\" name=\"soft\" type=\"neo-Hookean\"><density>1</density><E>1000</E><v>0.25</v></material>\n"
    "<material id=\"2\" name=\"stiff\" type=\"neo-Hookean\"><density>1</density><E>9000</E><v>0.25</v></material>\n"
    "</Material>\n<Mesh>\n<Nodes name=\"all\">\n<node id=\"1\">0,0,0</node>\n<node id=\"2\">1, 0, 0</node>\n"
    "<node id=\"3\">0,1,0</node>\n<node id=\"14\">0,0,1</node>\n<node id=\"5\">0,0,-1</node>\n</Nodes>\n"
    "<Elements type=\"tet4\" name=\"up\">\n<elem id=\"1\">1,2,3,14</elem>\n</Elements>\n"
    "<Elements type=\"tet4\" name=\"down\">\n<elem id=\"2\">1,3,2,5</elem>\n</Elements>\n"
    "<NodeSet name=\"middle\">1,2,3</NodeSet>\n</Mesh>\n"
    "<MeshDomains><SolidDomain name=\"up\" mat=\"soft\"/><SolidDomain name=\"down\" mat=\"2\"/></MeshDomains>\n"
    "<Boundary>\n<bc type=\"zero displacement\" node_set=\"middle\"><x_dof>1</x_dof><y_dof>1</y_dof>"
    "<z_dof>1</z_dof></bc>\n</Boundary>\n</febio_spec>\n";

class FebioScenes : public SceneFiles {
 protected:
  FebioScenes() : SceneFiles("a.feb", "m,kg,s", two_parts) {}
};

/// V (lambda + 2 mu) / m of a corner that is free, along z: 1200 / 6 / (1 / 24) of the soft one.
TEST_F(FebioScenes, AreBodiesWithTheirMaterialsAndSupports) {
  const Scene scene = read(two_parts);
  EXPECT_EQ(scene.model, "fem_neo_hookean");
  EXPECT_EQ(scene.step, 0.1);
  EXPECT_EQ(scene.method, "generalized_alpha:rho_inf=0.5");
  const auto made = body(scene);
  ASSERT_EQ(made->dofs(), 6);
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(6);
  TissueBody::DofMatrix K;
  made->stiffness(0, zero, zero, K);
  const Eigen::VectorXd squares = Eigen::MatrixXd(K).diagonal().cwiseQuotient(Eigen::VectorXd(made->mass()));
  EXPECT_NEAR(squares.maxCoeff(), 9 * 4800, 1e-6);
  EXPECT_NEAR(squares.minCoeff(), 1600, 1e-6);
  EXPECT_NEAR(made->point_mass().sum(), 1.0 / 3, 1e-12);
}

TEST_F(FebioScenes, TakeTheIntegratorOfTheControl) {
  EXPECT_EQ(read(changed("<rhoi>0.5</rhoi>", "")).method, "newmark:beta=0.25,gamma=0.5");
  EXPECT_EQ(read(changed("<rhoi>0.5</rhoi>", "<rhoi>-1</rhoi>")).method, "newmark");
  EXPECT_EQ(read(changed("DYNAMIC", "STATIC")).method, "");
  EXPECT_EQ(read(changed("<analysis>DYNAMIC</analysis>", "<analysis type=\"dynamic\"/>")).method,
            "generalized_alpha:rho_inf=0.5");
}

TEST_F(FebioScenes, HaveCommentsInValues) {
  const auto young = [&](const std::string& value) {
    return SceneFiles::value(read(changed("<E>1000", "<E>" + value)), "E:up");
  };
  for (const char* value : {"<!-- 3 Pa -->1000", "1000<!-- <Pa> -->", " 10<!----><!-- > -->00 "})
    EXPECT_EQ(young(value), 1000) << value;
  EXPECT_EQ(read(changed("1,2,3,14<", "<!-- 5 -->1,2,3,<!-- a -->14<")).step, 0.1);
}

TEST_F(FebioScenes, NameWhatTheyDoNotUnderstand) {
  const std::map<std::string, std::array<const char*, 2>> cases{
      {"format '3.0'", {"version=\"4.0\"", "version=\"3.0\""}},
      {"module is 'fluid'", {"Module type=\"solid\"", "Module type=\"fluid\""}},
      {"'Contact' is not understood", {"<Boundary>", "<Contact/><Boundary>"}},
      {"material is 'Ogden'", {"name=\"soft\" type=\"neo-Hookean\"", "name=\"soft\" type=\"Ogden\""}},
      {"different laws",
       {"name=\"stiff\" type=\"neo-Hookean\"", "name=\"stiff\" type=\"isotropic elastic\""}},
      {"'k' of a material", {"<E>1000</E>", "<E>1000</E><k>3</k>"}},
      {"does not have E, v and density", {"<v>0.25</v>", ""}},
      {"only tet4 and tet10 are read", {"type=\"tet4\" name=\"up\"", "type=\"hex8\" name=\"up\""}},
      {"has 3 nodes", {"1,2,3,14<", "1,2,3<"}},
      {"needs node 15", {"1,2,3,14<", "1,2,3,15<"}},
      {"2 coordinates", {"0,0,-1<", "0,0<"}},
      {"one SolidDomain of each", {"<SolidDomain name=\"down\" mat=\"2\"/>", ""}},
      {"no Elements 'side'", {"SolidDomain name=\"down\"", "SolidDomain name=\"side\""}},
      {"no material 'hard'", {"mat=\"soft\"", "mat=\"hard\""}},
      {"no NodeSet 'top'", {"node_set=\"middle\"", "node_set=\"top\""}},
      {"--ignore 'Boundary'", {"<z_dof>1</z_dof>", "<z_dof>0</z_dof>"}},
      {"--ignore 'Boundary' ", {"bc type=\"zero displacement\"", "bc type=\"prescribed displacement\""}},
      {"step_size is 0 but", {"<step_size>0.1", "<step_size>0"}},
      {"analysis is 'modal'", {"DYNAMIC", "MODAL"}},
      {"SolidDomain is 'ut4-solid'",
       {"SolidDomain name=\"up\"", "SolidDomain name=\"up\" type=\"ut4-solid\""}},
      {"--ignore 'alpha'",
       {"<SolidDomain name=\"up\" mat=\"soft\"/>",
        "<SolidDomain name=\"up\" mat=\"soft\"><alpha>0.05</alpha></SolidDomain>"}},
      {"'ShellDomain' of a MeshDomains", {"SolidDomain", "ShellDomain"}},
      {"'lc' of E", {"<E>", "<E lc=\"1\">"}},
      {"E is not one number", {"<E>1000", "<E>1000<by/>"}},
      {"solver is 'explicit-solid'", {"solver type=\"solid\"", "solver type=\"explicit-solid\""}},
      {"--ignore 'mass_lumping'", {"<rhoi>", "<mass_lumping>1</mass_lumping><rhoi>"}},
      {"'mode' of a time_stepper",
       {"<solver", "<time_stepper type=\"default\"><mode>1</mode></time_stepper><solver"}},
      {"step_size is given twice", {"<solver", "<step_size>0.2</step_size><solver"}},
      {"density is given twice", {"<density>", "<density>2</density><density>"}},
      {"Control is given twice", {"<Globals>", "<Control/><Globals>"}},
      {"'rigid' of a Boundary", {"<Boundary>", "<Boundary><rigid/>"}},
      {"'febio_spec' has no end", {"</febio_spec>", ""}}};
  for (const auto& [named, change] : cases) expect_refused(change[0], change[1], named);
  EXPECT_EQ(read(changed("<solver type=\"solid\">",
                         "<solver type=\"solid\"><max_refs>25</max_refs><qn_method "
                         "type=\"BFGS\"><max_ups>10</max_ups></qn_method>"))
                .step,
            0.1);
  EXPECT_TRUE(says(read(changed("<Boundary>", "<Contact/><Boundary>"), "contact").notes.back(), "Contact"));
}

TEST_F(FebioScenes, NameLoadsThatTheyDoNotUnderstand) {
  const auto loaded = [](const char* load) { return fmt::format("<Loads>{}</Loads><Boundary>", load); };
  const std::map<std::string, const char*> cases{
      {"'surface_load' of a Loads", "<surface_load/>"},
      {"body_load is 'centrifugal'", "<body_load type=\"centrifugal\"/>"},
      {"nodal_load is 'nodal moment'", "<nodal_load type=\"nodal moment\"/>"},
      {"no NodeSet 'top'",
       "<nodal_load type=\"nodal_force\" node_set=\"top\"><value>1,0,0</value></nodal_load>"},
      {"value has 2 numbers",
       "<nodal_load type=\"nodal_force\" node_set=\"middle\"><value>1,0</value></nodal_load>"},
      {"nodal_load has no scale",
       "<nodal_load type=\"nodal_load\" node_set=\"middle\"><dof>x</dof></nodal_load>"},
      {"a relative nodal_load",
       "<nodal_load type=\"nodal_force\" node_set=\"middle\"><value>1,0,0</value><relative>1</relative></nodal_load>"},
      {"dof of a nodal_load is not x, y or z",
       "<nodal_load type=\"nodal_load\" node_set=\"middle\"><dof>p</dof><scale>1</scale></nodal_load>"}};
  for (const auto& [named, load] : cases) expect_refused("<Boundary>", loaded(load), named, ", line ");
}

TEST_F(FebioScenes, JudgeTheStepThatATimeStepperBeginsWith) {
  const Scene scene = read(changed("<solver",
                                   "<time_stepper type=\"default\"><max_retries>5</max_retries>"
                                   "<dtmax lc=\"1\">0.4</dtmax></time_stepper><solver"));
  EXPECT_EQ(scene.step, 0.1);
  EXPECT_TRUE(says(scene.notes.front(), "the step that is judged is step_size, and dtmax is 0.4"));
}

/// Each of a set of its own, by one load curve.
TEST_F(FebioScenes, OfManyLoadsAreReadInProportionToThem) {
  const auto load = [&](int n) {
    std::string sets, loads;
    for (int i = 0; i < n; ++i) {
      sets += fmt::format("<NodeSet name=\"n{}\">14</NodeSet>\n", i);
      loads += fmt::format(
          "<nodal_load type=\"nodal_load\" node_set=\"n{}\"><dof>z</dof><scale "
          "lc=\"1\">1</scale><relative>0</relative></nodal_load>\n",
          i);
    }
    const std::string text =
        changed("<Boundary>", "<Loads>" + loads +
                                  "</Loads><LoadData><load_controller id=\"1\" type=\"loadcurve\"><points>"
                                  "<pt>0,2</pt></points></load_controller></LoadData><Boundary>");
    EXPECT_EQ(value(read(replaced(text, "</Mesh>", sets + "</Mesh>")), "force_z:points:14"), 2 * n);
  };
  EXPECT_LT(growth_of_time(load, 1000), 8);
}

/// FEBio subtracts body loads; nodal loads push each point of the set.
TEST_F(FebioScenes, HaveForcesOnPointsAndBodyLoads) {
  const std::string loads =
      "<Loads><nodal_load type=\"nodal_load\" node_set=\"tip\"><dof>z</dof><scale lc=\"1\">3</scale></nodal_load>"
      "<nodal_load type=\"nodal_force\" node_set=\"tip\"><value>1,0,-1</value></nodal_load>"
      "<body_load type=\"const\"><z>9.81</z></body_load>"
      "<body_load type=\"body force\"><force lc=\"1\">1,0,0</force></body_load></Loads>";
  const std::string curve =
      "<LoadData><load_controller id=\"1\" type=\"loadcurve\"><points><pt>0,2</pt><pt>1,2</pt></points>"
      "</load_controller></LoadData>";
  const std::string text = replaced(changed("<Boundary>", loads + curve + "<Boundary>"), "</Mesh>",
                                    "<NodeSet name=\"tip\">14</NodeSet></Mesh>");
  const Scene scene = read(text);
  EXPECT_EQ(value(scene, "force_z:points:14"), 5);
  EXPECT_EQ(value(scene, "force_x:points:14"), 1);
  EXPECT_EQ(value(scene, "gz"), -9.81);
  EXPECT_EQ(value(scene, "gx"), -2);
  const std::string ramp = replaced(text, "<pt>0,2</pt>", "<pt>0,0</pt>");
  EXPECT_TRUE(says(error(ramp), "scale follows the load controller 1"));
  EXPECT_EQ(value(read(ramp, "lc"), "force_z:points:14"), 2);
  EXPECT_TRUE(
      says(error(replaced(text, "controller id=\"1\"", "controller id=\"2\"")), "no load_controller '1'"));
}

TEST_F(FebioScenes, FixPointsThatAreAlsoHeldOtherwise) {
  const std::string text =
      changed("</Boundary>", "<bc type=\"prescribed displacement\" node_set=\"middle\"/></Boundary>");
  EXPECT_TRUE(says(SceneFiles::error(text), "--ignore 'Boundary'"));
  EXPECT_EQ(body(read(text, "Boundary"))->dofs(), 6);
}

TEST_F(FebioScenes, HaveConditionsAndLoadsOnSurfaces) {
  const std::string surface = "<Surface name=\"base\"><tri3 id=\"1\">1,3,2</tri3></Surface></Mesh>";
  const std::string text =
      replaced(changed("</Mesh>", surface), "node_set=\"middle\"", "node_set=\"@surface:base\"");
  EXPECT_EQ(body(read(text))->dofs(), 6);
  const std::string load =
      "<Loads><nodal_load type=\"nodal_force\" node_set=\"@surface:base\"><value>1,0,0</value></nodal_load></Loads>";
  EXPECT_EQ(value(read(replaced(changed("</Mesh>", surface), "<Boundary>", load + "<Boundary>")),
                  "force_x:points:1,2,3"),
            1);
  EXPECT_TRUE(says(SceneFiles::error(replaced(text, "@surface:base", "@surface:top")), "no Surface 'top'"));
  const std::string pressed = replaced(changed("</Mesh>", surface), "</Boundary>",
                                       "<bc type=\"normal displacement\" surface=\"base\"/></Boundary>");
  EXPECT_TRUE(says(SceneFiles::error(pressed), "the bc is 'normal displacement'"));
  EXPECT_EQ(body(read(pressed, "Boundary"))->dofs(), 6);
}

TEST_F(FebioScenes, HaveTetrahedraOfFourNodes) {
  std::string nodes;
  for (int i = 21; i <= 26; ++i) nodes += fmt::format("<node id=\"{}\">0,0,{}</node>", i, i);
  const std::string text = replaced(changed("</Nodes>", nodes + "</Nodes>"), "type=\"tet4\" name=\"up\"",
                                    "type=\"tet10\" name=\"up\"");
  EXPECT_TRUE(says(SceneFiles::error(replaced(text, "1,2,3,14<", "1,2,3,14,21,22,23,24,25,26<")),
                   "a.feb, line 21: tetrahedron 1 has ten nodes, and scenes of four are read"));
}

TEST_F(FebioScenes, HaveTheNamesOfElementsBehindEmptyOnes) {
  const std::string text =
      changed("<Elements type=\"tet4\" name=\"up\">",
              "<Elements type=\"tet4\" name=\"none\"></Elements><Elements type=\"tet4\" name=\"up\">");
  EXPECT_EQ(value(read(text), "E:up"), 1000);
  EXPECT_EQ(value(read(text), "E:down"), 9000);
}

TEST_F(FebioScenes, HaveTheUnitsThatTheyTell) {
  const auto told = [this](const std::string& units) {
    return changed("<Module type=\"solid\"/>",
                   "<Module type=\"solid\"><units>" + units + "</units></Module>");
  };
  EXPECT_EQ(SceneFiles::error(told("SI")), "");
  EXPECT_EQ(SceneFiles::error(told("furlongs")), "");
  EXPECT_TRUE(
      says(SceneFiles::error(told("mm-kg-s")), "line 3: the units are mm,kg,s and not --unit m,kg,s"));
  EXPECT_EQ(value(read_in("mm,t,s", told("mm-N-s")), "E:up"), 1e9);
  EXPECT_TRUE(says(error_of<InputError>([&] { read_in("", told("CGS")); }), "give --unit cm,g,s"));
}

TEST_F(FebioScenes, SayThatTheirNeoHookeanLawDiffers) {
  EXPECT_TRUE(says(read(two_parts).notes.front(), "differs from that of FEBio's neo-Hookean"));
}

/// Wherever a file is cut off or damaged, it is refused in one sentence or is a scene.
TEST_F(FebioScenes, SurviveDamage) {
  const auto damage = [](std::size_t i) {
    return std::array{two_parts.substr(0, i), std::string(two_parts).replace(i, 1, "-"),
                      std::string(two_parts).erase(i, 1)};
  };
  EXPECT_GT(refused(two_parts, 7, damage), two_parts.size() / 5);
}

}  // namespace
}  // namespace hmax
