/// --picture of the commands that know bodies on meshes.

#include "tests/cli/program.hpp"

namespace hmax {
namespace {

using AnyJson = nlohmann::json;

TEST(Pictures, OfABodyInEquilibriumShowItsLoadItsSupportsAndItsShapeAtRest) {
  const Shell shell;
  EXPECT_EQ(shell.json("static --mesh phantom --load press --picture new/pressed.svg").at("picture"),
            "new/pressed.svg");
  const std::string svg = read_text(shell / "new/pressed.svg");
  for (const char* part : {"displacement [mm]", ">fixed<", ">at rest<", ">force<", "57 points", "E=5500"})
    EXPECT_TRUE(says(svg, part));
  EXPECT_TRUE(shell.json("static --mesh phantom").at("picture").is_null());
}

TEST(Pictures, ShowEnergiesOfFiniteElementsAndNotOfSprings) {
  const Shell shell;
  ASSERT_EQ(shell.hmax("static --mesh phantom --picture a.svg --colour energy_density").exit_code, 0);
  EXPECT_TRUE(says(read_text(shell / "a.svg"), "energy density [J/m³]"));
  expect_refused(
      shell.hmax("static --mesh phantom --model mass_spring --picture b.svg --colour energy_density"),
      "energy");
  EXPECT_FALSE(std::filesystem::exists(shell / "b.svg"));
}

TEST(Pictures, OfTheEndOfARunShowTheTool) {
  const Shell shell;
  const std::string run =
      "run --mesh phantom --load tool --method linearly_implicit_euler --h 0.05 --t-end 0.5 ";
  shell.text(run + "--picture tool.svg --from 1,-1,0.3");
  const std::string svg = read_text(shell / "tool.svg");
  EXPECT_TRUE(says(svg, "after 0.5 s"));
  ASSERT_EQ(shell.hmax(run + "--picture again.svg").exit_code, 0);
  EXPECT_NE(svg, read_text(shell / "again.svg")) << "from another side";
}

TEST(Pictures, OfAMeshShowTheWorstOfItsElements) {
  const Shell shell;
  const Told told = shell.hmax("mesh info liver --picture liver.svg --json");
  EXPECT_EQ(told.json().at("picture"), "liver.svg");
  const std::string svg = read_text(shell / "liver.svg");
  EXPECT_TRUE(says(svg, "mean ratio of the worst tetrahedron nearby"));
  EXPECT_TRUE(says(svg, "370 triangles on the surface"));
}

TEST(Pictures, AreRefusedBeforeTheWorkIsDone) {
  const Shell shell;
  expect_refused(shell.hmax("static --mesh phantom --picture a.png"), ".svg");
  expect_refused(shell.hmax("static --mesh phantom --colour displacement"), "--picture");
  expect_refused(shell.hmax("static --mesh phantom --picture a.svg --colour red"), "red");
  expect_refused(shell.hmax("static --mesh phantom --picture a.svg --from 0,0,0"), "--from");
  expect_refused(shell.hmax("static --mesh phantom --picture a.svg --frames 3"), "--frames");
}

TEST(Statics, AreComparedInATableAndAFigure) {
  const Shell shell;
  const AnyJson told = shell.json("static --mesh phantom --load press --compare out");
  ASSERT_EQ(told.at("ways").size(), 6U);
  std::size_t newton = 0;
  for (const AnyJson& way : told.at("ways")) {
    EXPECT_EQ(way.at("outcome"), "converged") << way;
    EXPECT_LE(way.at("residual"), 1e-9);
    // The stiffness of each iterate needs fewer of them than that at rest.
    if (way.at("linear") != "direct") continue;
    if (way.at("solver") == "newton") newton = way.at("iterations");
    if (way.at("solver") == "modified_newton") {
      EXPECT_GT(way.at("iterations"), newton);
    }
  }
  EXPECT_TRUE(std::filesystem::exists(shell / "out/residuals.gp"));
}

}  // namespace
}  // namespace hmax
