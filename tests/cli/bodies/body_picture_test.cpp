/// --picture of the commands that know bodies on meshes.
#include <algorithm>
#include <cmath>
#include <map>

#include "tests/cli/program.hpp"

namespace hmax {
namespace {

using Json = nlohmann::json;

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
  const Json told = shell.json("static --mesh phantom --load press --compare out");
  ASSERT_EQ(told.at("ways").size(), 6U);
  std::size_t newton = 0;
  for (const Json& way : told.at("ways")) {
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

/// The numbers of the thigh, and the figures of the page.
void expect_identified(const Json& thigh, const Shell& shell) {
  ASSERT_EQ(thigh.at("fits").size(), 4U);
  for (const Json& fit : thigh.at("fits")) EXPECT_LT(fit.at("overall_error"), 0.05) << fit;
  EXPECT_GT(thigh.at("fits").at(1).at("within_5_percent"), 0.7);
  // With a wrong skin the forces are right and the parameters are not.
  EXPECT_LT(thigh.at("fits").at(2).at("within_5_percent"), 0.5);
  EXPECT_EQ(thigh.at("limits").at(0).at("method"), "explicit_euler");
  EXPECT_LT(thigh.at("limits").at(0).at("h_pressed"), thigh.at("limits").at(0).at("h_rest"));
  for (const char* figure :
       {"limits_under_loads", "thigh_forces", "thigh_parameters", "thigh_network", "thigh_motion"})
    EXPECT_TRUE(std::filesystem::exists(shell / ("out/" + std::string(figure) + ".gp"))) << figure;
}

TEST(ReproduceTissue, MakesAPageWithItsPicturesWhereEverySolverFindsTheEquilibrium) {
  const Shell shell;
  const Json study = shell.json("reproduce tissue --quick --scale --output out");
  EXPECT_EQ(study.at("unsolved"), 0);
  EXPECT_GT(study.at("force_ratio"), 1);
  // Springs that resist dilation like nu = 1/4 give way more than elements of nu = 0.45.
  EXPECT_GT(study.at("deflection_springs"), study.at("deflection_elements"));
  // Undamped, symplectic Euler's limit is 2 and RK4's the root of 8 over the same frequency, and explicit
  // Euler has none; E may grow by the square of what a step is too short.
  std::map<std::string, Json> undamped;
  for (const Json& limit : study.at("particles"))
    if (limit.at("damping") == "none") undamped[limit.at("method")] = limit;
  EXPECT_EQ(undamped.at("explicit_euler").at("h_max"), 0);
  EXPECT_EQ(undamped.at("explicit_euler").at("stiffest"), 0);
  const double rk4 = undamped.at("rk4").at("h_max"), symplectic = undamped.at("symplectic_euler").at("h_max");
  EXPECT_NEAR(rk4 / symplectic, std::sqrt(2), 1e-6);
  EXPECT_NEAR(undamped.at("rk4").at("stiffest").get<double>(), 5300 * std::pow(280 * rk4, 2),
              2e-3 * 5300 * std::pow(280 * rk4, 2));
  EXPECT_GT(study.at("heaviest_particle"), 0);
  // Two loads, in equilibrium and in motion, three models, two methods.
  EXPECT_EQ(study.at("paths").size(), 24U);
  double largest_change = 0;
  for (const Json& path : study.at("paths")) {
    const double least = path.at("h_min"), at_rest = path.at("h_rest");
    EXPECT_GT(least, 0) << path;
    largest_change = std::max(largest_change, 1 - least / at_rest);
    // Without a load every path begins with the body at rest.
    const double alone =
        shell
            .json("stability predict --mesh phantom --model " + path.at("model").get<std::string>() +
                  " --material liver:male_normal --set g=0 --methods " + path.at("method").get<std::string>())
            .at("rows")
            .at(0)
            .at("h_max");
    EXPECT_NEAR(at_rest, alone, 1e-6 * alone) << path;
  }
  EXPECT_GT(largest_change, 0.001);
  expect_identified(study.at("thigh"), shell);
  ASSERT_EQ(study.at("sizes").size(), 2U);
  for (const Json& size : study.at("sizes"))
    for (const char* cost : {"force", "stiffness", "explicit_step", "implicit_step", "eigenvalue", "import"})
      EXPECT_GT(size.at(cost), 0) << cost;
  // 20 n^3 tetrahedra.
  EXPECT_EQ(study.at("sizes").at(1).at("tetrahedra"), 1280);
  EXPECT_TRUE(std::filesystem::exists(shell / "out/costs_over_size.gp"));
  EXPECT_FALSE(std::filesystem::exists(shell / "out/scale_study.msh"));
  const std::string page = read_text(shell / "out/README.md");
  EXPECT_TRUE(says(page, "280 steps a second"));
  EXPECT_TRUE(std::filesystem::exists(shell / "out/particles.gp"));
  for (const char* picture : {"meshes", "springs_and_elements", "modes", "tool"}) {
    EXPECT_TRUE(says(page, std::string("](") + picture + ".svg)")) << picture;
    const auto size = std::filesystem::file_size(shell / (std::string("out/") + picture + ".svg"));
    EXPECT_GT(size, 10'000U);
    EXPECT_LT(size, 1'000'000U);
  }
}

}  // namespace
}  // namespace hmax
