#include <algorithm>
#include <array>
#include <map>

#include <gtest/gtest.h>

#include "catalogue/models/problems.hpp"
#include "catalogue/models/tissue_problem.hpp"
#include "catalogue/scenes/scene.hpp"
#include "core/errors.hpp"
#include "problems/tissue/body.hpp"
#include "tests/results/scratch.hpp"
#include "tests/says.hpp"

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

class FebioScenes : public ::testing::Test {
 protected:
  Scene read(const std::string& text, const std::string& ignored = "") {
    write_text(folder / "a.feb", text);
    return read_scene((folder / "a.feb").string(), "m,kg,s", ignored);
  }
  /// What of the text is replaced by what: the error that reading tells.
  std::string error(const std::string& what, const std::string& by) {
    return error_of<InputError>([&] { read(changed(what, by)); });
  }
  static std::string changed(const std::string& what, const std::string& by) {
    std::string text = two_parts;
    const std::size_t at = text.find(what);
    EXPECT_NE(at, std::string::npos) << what;
    return text.replace(at, what.size(), by);
  }

  Scratch folder;
};

/// V (lambda + 2 mu) / m of a corner that is free, along z: 1200 / 6 / (1 / 24) of the soft one.
TEST_F(FebioScenes, AreBodiesWithTheirMaterialsAndSupports) {
  const Scene scene = read(two_parts);
  EXPECT_EQ(scene.model, "fem_neo_hookean");
  EXPECT_EQ(scene.step, 0.1);
  EXPECT_EQ(scene.method, "generalized_alpha:rho_inf=0.5");
  const auto made =
      make_problem(tissue_id(scene.model, (folder / "a.feb").string(), ""), scene.settings).body;
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
    const auto values = read(changed("<E>1000", "<E>" + value)).settings.parameters;
    return std::ranges::find(values, "E:up", &std::pair<std::string, double>::first)->second;
  };
  for (const char* value : {"<!-- 3 Pa -->1000", "1000<!-- <Pa> -->", " 10<!----><!-- > -->00 "})
    EXPECT_EQ(young(value), 1000) << value;
  EXPECT_EQ(read(changed("1,2,3,14<", "<!-- 5 -->1,2,3,<!-- a -->14<")).step, 0.1);
}

TEST_F(FebioScenes, NameWhatTheyDoNotUnderstand) {
  const std::map<std::string, std::array<const char*, 2>> cases{
      {"format '3.0'", {"version=\"4.0\"", "version=\"3.0\""}},
      {"module is 'fluid'", {"Module type=\"solid\"", "Module type=\"fluid\""}},
      {"'Loads' is not understood", {"<Boundary>", "<Loads/><Boundary>"}},
      {"material is 'Ogden'", {"name=\"soft\" type=\"neo-Hookean\"", "name=\"soft\" type=\"Ogden\""}},
      {"different laws",
       {"name=\"stiff\" type=\"neo-Hookean\"", "name=\"stiff\" type=\"isotropic elastic\""}},
      {"'k' of a material", {"<E>1000</E>", "<E>1000</E><k>3</k>"}},
      {"does not have E, v and density", {"<v>0.25</v>", ""}},
      {"only tet4 is read", {"type=\"tet4\" name=\"up\"", "type=\"hex8\" name=\"up\""}},
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
      {"'time_stepper' of a Control", {"<solver", "<time_stepper type=\"default\"/><solver"}},
      {"step_size is given twice", {"<solver", "<step_size>0.2</step_size><solver"}},
      {"density is given twice", {"<density>", "<density>2</density><density>"}},
      {"Control is given twice", {"<Globals>", "<Control/><Globals>"}},
      {"'rigid' of a Boundary", {"<Boundary>", "<Boundary><rigid/>"}},
      {"'febio_spec' has no end", {"</febio_spec>", ""}}};
  for (const auto& [named, change] : cases) {
    const std::string told = error(change[0], change[1]) + " ";
    EXPECT_TRUE(says(told, named));
    EXPECT_TRUE(says(told, "a.feb"));
    EXPECT_EQ(told.find('\n'), std::string::npos) << told;
  }
  EXPECT_EQ(read(changed("<solver type=\"solid\">",
                         "<time_stepper/><solver type=\"solid\"><max_refs>25</max_refs><qn_method "
                         "type=\"BFGS\"><max_ups>10</max_ups></qn_method>"),
                 "time_stepper")
                .step,
            0.1);
  EXPECT_TRUE(says(read(changed("<Boundary>", "<Loads/><Boundary>"), "loads").notes.back(), "Loads"));
}

/// Wherever a file is cut off or damaged, it is refused in one sentence or is a scene.
TEST_F(FebioScenes, SurviveDamage) {
  std::size_t refused = 0;
  for (std::size_t i = 0; i < two_parts.size(); i += 7) {
    for (const std::string& damaged : {two_parts.substr(0, i), std::string(two_parts).replace(i, 1, "-"),
                                       std::string(two_parts).erase(i, 1)}) {
      const std::string told = error_of<InputError>([&] { read(damaged); });
      EXPECT_EQ(told.find('\n'), std::string::npos) << told;
      refused += told.empty() ? 0 : 1;
    }
  }
  EXPECT_GT(refused, two_parts.size() / 5);
}

}  // namespace
}  // namespace hmax
