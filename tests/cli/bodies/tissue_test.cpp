/// Bodies on meshes at the command line.
#include <algorithm>
#include <cstring>
#include <fstream>
#include <set>
#include <string>
#include <vector>

#include "problems/mesh/files/mesh_writers.hpp"
#include "results/table.hpp"
#include "tests/cli/program.hpp"

namespace hmax {
namespace {

using AnyJson = nlohmann::json;

TEST(TissueRun, SaysHowFarTheBodyMovedAndWithFullWhere) {
  const std::string common =
      "run --mesh phantom --model fem_green --material liver:male_normal --method linearly_implicit_euler --h "
      "0.01 --t-end 0.1";
  const AnyJson brief = Shell{}.json(common);
  EXPECT_EQ(brief.at("problem"), "fem_green@phantom");
  EXPECT_EQ(brief.at("material"), "liver:male_normal");
  EXPECT_EQ(brief.at("outcome"), "reached_end");
  EXPECT_GT(brief.at("max_displacement").get<double>(), 1e-4);
  EXPECT_TRUE(brief.at("energy").is_number());
  EXPECT_FALSE(brief.contains("y"));
  const AnyJson full = Shell{}.json(common + " --full");
  EXPECT_EQ(full.at("y").size(), 2 * full.at("dofs").get<std::size_t>());
  EXPECT_EQ(full.at("max_displacement"), brief.at("max_displacement"));
}

TEST(TissueRun, WritesHowFarABodyMovesAndASeriesForParaView) {
  const Shell shell;
  const std::string run =
      "run --mesh phantom --load breathing --method symplectic_euler --h 0.002 --t-end 1 --every 0.25 ";
  EXPECT_EQ(shell.hmax(run + "--set depth=0.02 --output motion.csv").exit_code, 0);
  const Table motion = read_csv(shell / "motion.csv");
  EXPECT_EQ(motion.columns, (std::vector<std::string>{"t [s]", "largest displacement [m]", "energy [J]"}));
  ASSERT_EQ(motion.values[0].size(), 5U);
  EXPECT_EQ(motion.values[1].front(), 0);
  EXPECT_GT(motion.values[1].back(), 0.01);

  EXPECT_EQ(shell.json(run + "--set depth=0.02 --output series/motion.pvd").at("points"), 5);
  const std::string series = read_text(shell / "series/motion.pvd");
  EXPECT_TRUE(says(series, "timestep=\"0.25\""));
  EXPECT_TRUE(says(series, "motion_00004.vtu"));
  // The held end itself is where the sine puts it: a quarter of the period of 4 s has passed.
  const Told info = shell.hmax("mesh info series/motion_00004.vtu --unit m --json");
  EXPECT_EQ(info.json().at("tetrahedra"), 120) << info.err;
  expect_refused(shell.hmax("run --problem liver_linear --method rk4 --h 0.1 --output a.pvd"), "--mesh");
  expect_refused(shell.hmax(run + "--output a.vtu"), "FILE.pvd");
}

/// A column of tetrahedra whose points are numbered from top to bottom and back, with an idle point in front:
/// an order that nobody would choose for locality.
TEST(TissueRun, WritesResultsInTheOrderOfTheFile) {
  const Shell shell;
  ASSERT_EQ(shell.hmax("mesh make beam:n=2 --output beam.msh").exit_code, 0);
  MeshFile file = read_mesh_file(shell / "beam.msh");
  const Eigen::Index n = file.mesh.point_count();
  Eigen::Matrix3Xd points(3, n + 1);
  points.col(0).setConstant(7);
  for (Eigen::Index i = 0; i < n; ++i) points.col(1 + (i * 17) % n) = file.mesh.points.col(i);
  for (TetMesh::Index& corner : file.mesh.tetrahedra.reshaped())
    corner = 1 + static_cast<TetMesh::Index>((corner * 17) % n);
  file.mesh.points = points;
  file.mesh.regions.assign(static_cast<std::size_t>(file.mesh.tetrahedron_count()), 40);
  file.mesh.regions[3] = 70;
  write_text(shell / "odd.msh", msh_text(counted_from_one(file.mesh)));

  const std::string common = "--mesh odd.msh --unit m --set axis=1 ";
  EXPECT_EQ(
      shell.hmax("run --method symplectic_euler --h 0.001 --t-end 0.01 --every 0.01 --output s.pvd " + common)
          .exit_code,
      0);
  EXPECT_EQ(shell.hmax("stability modes --count 1 --output modes.vtu " + common).exit_code, 0);
  for (const char* name : {"s_00001.vtu", "modes.vtu"}) {
    const MeshFile written = read_mesh_file(shell / name);
    EXPECT_EQ(written.mesh.points, file.mesh.points) << name;
    EXPECT_EQ(written.mesh.tetrahedra, file.mesh.tetrahedra) << name;
    EXPECT_EQ(written.mesh.regions, file.mesh.regions) << name;
  }
  // What falls is not held and not idle: the displacement stands beside its point. The state has this order
  // too.
  const std::string frame = read_text(shell / "s_00001.vtu");
  const std::string tag = "Name=\"displacement\" NumberOfComponents=\"3\" format=\"appended\" offset=\"";
  const std::size_t begin = frame.find("\n_") + 10 + std::stoul(frame.substr(frame.find(tag) + tag.size()));
  const AnyJson state = shell.json("run --method symplectic_euler --h 0.001 --t-end 0.01 --full " + common);
  std::size_t dof = 0;
  for (Eigen::Index i = 0; i <= n; ++i) {
    Eigen::Vector3d u;
    std::memcpy(u.data(), frame.data() + begin + 24 * static_cast<std::size_t>(i), 24);
    const bool free = i > 0 && points(0, i) > 0.1 * points.rightCols(n).row(0).maxCoeff();
    EXPECT_EQ(u(2) < 0, free) << i;
    for (int k = 0; free && k < 3; ++k) EXPECT_NEAR(state.at("y").at(dof++).get<double>(), u(k), 1e-15) << i;
  }
  EXPECT_EQ(2 * dof, state.at("y").size());
}

TEST(TissueRun, TakesAllNodesOfTetrahedraOfSecondOrder) {
  const Shell shell;
  const auto file = [](const char* middle) {
    return "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n10\n1 0 0 0\n2 .1 0 0\n3 0 .1 0\n4 0 0 .1\n5 " +
           std::string(middle) +
           "\n6 .05 .05 0\n7 0 .05 0\n8 0 0 .05\n9 0 .05 .05\n10 .05 0 .05\n$EndNodes\n$Elements\n2\n"
           "1 9 2 3 1 1 2 3 5 6 7\n7 11 2 1 1 1 2 3 4 5 6 7 8 9 10\n$EndElements\n";
  };
  write_text(shell / "q.msh", file(".05 -.01 0"));
  const std::string body = "--mesh q.msh --unit m --model fem_quadratic --load gravity ";
  const AnyJson predicted =
      shell.json("stability predict " + body + "--support surface:3 --methods rk4").at("models")[0];
  EXPECT_EQ(predicted.at("fastest_mode").at("element"), 7);
  EXPECT_EQ(predicted.at("fastest_mode").at("points").size(), 10U);
  EXPECT_EQ(predicted.at("body").at("points"), 10);
  EXPECT_EQ(predicted.at("body").at("fixed"), 6) << "three corners and what lies between them";
  // 1060 (1/6 - (dy + dz)/6) kg of a middle of the unit tetrahedron that is moved by d, scaled.
  EXPECT_NEAR(predicted.at("body").at("mass").get<double>(), 1060 * 1e-3 * (1 + 0.1) / 6, 1e-12);
  shell.text("run " + body +
             "--support surface:3 --method rk4 --h 0.0005 --t-end 0.01 --every 0.01 --output s/m.pvd");
  const AnyJson written = shell.json("mesh info s/m_00001.vtu --unit m");
  EXPECT_EQ(written.at("points"), 10);
  EXPECT_EQ(written.at("tetrahedra"), 8);
  expect_refused(shell.hmax("mesh convert q.msh q.scn --unit m --model fem_quadratic"),
                 "SOFA has no force field of the model fem_quadratic");
  write_text(shell / "q.msh", file(".05 .09 0"));
  expect_refused(shell.hmax("static " + body), "q.msh, line 20: tetrahedron 7 has a part without volume");
  EXPECT_EQ(shell.hmax("static --mesh q.msh --unit m --load gravity --set E=50000").exit_code, 0);
}

TEST(TissueRun, HoldsTheSetsOfPointsThatAreNamed) {
  const std::string common = "run --mesh cube:n=2 --method symplectic_euler --h 0.001 --t-end 0.01 ";
  // The nine points at the bottom, point 1 among them, and the one above it.
  EXPECT_EQ(Shell{}.json(common + "--support points:1,2 --support -1,1,-1,1,-0.001,0.001").at("dofs"),
            3 * (27 - 10));
  EXPECT_EQ(Shell{}.json(common + "--support points:1,2").at("parameters").at("support:points:1,2"), 1);
  expect_refusal("run --mesh cube:n=2 --method rk4 --h 0.001 --support top", "no group or region 'top'");
  expect_refusal("run --problem liver_linear --method rk4 --h 0.001 --support top", "--support");
  const AnyJson fallen = Shell{}.json(common + "--gravity 0,-9.81,0 --full --set support=0");
  EXPECT_LT(fallen.at("y").at(1).get<double>(), -1e-5);
  EXPECT_NEAR(fallen.at("y").at(2).get<double>(), 0, 1e-12);
  expect_refusal("run --mesh cube --method rk4 --h 0.001 --gravity 0,1", "a vector of three");
  expect_refusal("run --mesh cube --method rk4 --h 0.001 --gravity 0,0,-1 --set gz=9.81",
                 "--gravity and --set gz=9.81 say the same; give one of them");
  expect_refusal("run --mesh cube --method rk4 --h 0.001 --alpha 0.1 --set alpha=0.2",
                 "--alpha and --set alpha=0.2 say the same");
  expect_refusal("run --mesh cube --method rk4 --h 0.001 --load tool --tool-at 0,0,9", "meets nothing");
}

TEST(TissueRun, RefusesWhatBelongsToOtherProblems) {
  expect_refusal("run --mesh phantom --problem liver_linear --method rk4 --h 0.1", "choose one");
  expect_refusal("run --model fem_green --method rk4 --h 0.1", "--mesh");
  expect_refusal("run --mesh phantom --method rk4 --h 0.001 --linear cg", "--linear");
  expect_refusal("run --mesh phantom --method newmark --h 0.001 --linear cgg", "cg");
}

TEST(Static, HasTheKeysOfTheContract) {
  const AnyJson found = Shell{}.json(
      "static --mesh phantom --model fem_green --material liver:male_normal --load press --solver newton --linear "
      "direct");
  for (const char* key : {"outcome", "iterations", "residuals", "seconds", "max_displacement"})
    EXPECT_TRUE(found.contains(key)) << key;
  EXPECT_EQ(found.at("outcome"), "converged");
  EXPECT_EQ(found.at("residuals").size(), found.at("iterations").get<std::size_t>() + 1);
  EXPECT_LE(found.at("residuals").back().get<double>(), 1e-9);
}

TEST(Static, NamesWhatIsCrushedWhereABodyCollapses) {
  const Told told = Shell{}.hmax("static --mesh ball:n=2 --load-scale 3 --json");
  EXPECT_EQ(told.exit_code, 1);
  const AnyJson found = told.json();
  EXPECT_EQ(found.at("outcome"), "collapsed");
  EXPECT_GT(found.at("least_volume"), 0.0);
  EXPECT_LT(found.at("least_volume"), 0.05);
  EXPECT_TRUE(says(found.at("status").get<std::string>(), "fem_neo_hookean"));
  EXPECT_EQ(Shell{}.json("static --mesh ball:n=2 --load-scale 0.5").at("outcome"), "converged");
  // Each solver says the same of it.
  const AnyJson ways =
      Shell{}.hmax("static --mesh ball:n=2 --load-scale 3 --compare out --json").json().at("ways");
  EXPECT_EQ(ways.at(0).at("outcome"), "collapsed");
  EXPECT_TRUE(says(ways.at(0).at("status").get<std::string>(), "tetrahedron"));
  // What is known at rest is still said of it.
  const Told predicted = Shell{}.hmax("stability predict --mesh ball:n=2 --set g=30 --method rk4");
  EXPECT_TRUE(says(predicted.out, "no equilibrium was found: tetrahedron"));
  EXPECT_EQ(predicted.exit_code, 1) << "these are not the limits that were asked for";
  EXPECT_FALSE(says(predicted.out, "load steps"));
}

TEST(Static, BringsALoadOnInStepsWhereAllAtOnceIsTooMuch) {
  const std::string pressed = "static --mesh ball:n=3 --model fem_neo_hookean --load press --load-scale 8";
  const AnyJson found = Shell{}.json(pressed);
  EXPECT_EQ(found.at("outcome"), "converged");
  EXPECT_TRUE(says(found.at("status").get<std::string>(), "ten steps"));
  const Shell shell;
  shell.hmax(pressed + " --picture pressed.svg");
  EXPECT_TRUE(says(read_text(shell / "pressed.svg"), "10 load steps"));
  EXPECT_GT(found.at("least_volume"), 0.05);
  // Who says how many steps gets so many.
  EXPECT_EQ(Shell{}.hmax(pressed + " --load-steps 1 --json").json().at("outcome"), "collapsed");
}

TEST(Static, FindsEquilibriaOfSmallLoadsAndStiffBodiesToRounding) {
  for (const char* body : {"--mesh beam:n=2 --set E=2e11 --set rho=7800", "--mesh liver --set E=1e7",
                           "--mesh phantom --load press --set force=0.001"}) {
    EXPECT_EQ(Shell{}.json(std::string("static ") + body).at("outcome"), "converged") << body;
    const Told told = Shell{}.hmax(std::string("stability predict --method rk4 ") + body);
    EXPECT_TRUE(says(told.out, ": equilibrium of"));
  }
}

TEST(Static, SaysThatALoadIsWithinTheRoundingOfStiffSprings) {
  const AnyJson answer = Shell{}.json("static --mesh cube:n=2 --set axis=-3 --set support_stiffness=1e25");
  EXPECT_TRUE(says(answer.at("status").get<std::string>(), "within the rounding of the forces"))
      << answer.at("status");
  EXPECT_EQ(Shell{}.json("static --mesh cube:n=2 --set g=0").at("status"), "");
}

TEST(Static, GoesOnWithWhatSorHasNotSolvedToItsTolerance) {
  const std::string liver = "static --mesh liver --load press --linear sor --solver ";
  EXPECT_EQ(Shell{}.json(liver + "modified_newton").at("outcome"), "converged");
  const Told linear = Shell{}.hmax(liver + "linear --json");
  EXPECT_EQ(linear.exit_code, 1);
  EXPECT_TRUE(says(linear.json().at("status").get<std::string>(), "relaxation of 1.5"));
}

TEST(Static, SaysWhatALinearSolutionLeaves) {
  const AnyJson linear = Shell{}.json("static --mesh liver --load press --solver linear");
  EXPECT_EQ(linear.at("outcome"), "converged");
  EXPECT_TRUE(says(linear.at("status").get<std::string>(), "leave 0.971 of the load"));
  EXPECT_EQ(Shell{}.json("static --mesh liver --model fem_cauchy --load press --solver linear").at("status"),
            "");
  expect_refusal("static --mesh phantom --load tool --solver linear", "no contact");
}

TEST(Static, ComparesSorAtItsBestRelaxation) {
  const std::string compare = "static --mesh liver --load press --set force=0.1 --json --compare c";
  const AnyJson best = Shell{}.hmax(compare).json();
  EXPECT_EQ(best.at("relaxation"), 1.9);
  EXPECT_TRUE(best.at("linear_tolerance").is_null());
  EXPECT_EQ(Shell{}.hmax(compare + " --relaxation 1.7").json().at("relaxation"), 1.7);
}

TEST(Static, KeepsToLoadStepsAndIterationsWithATool) {
  const std::string tool = "static --mesh phantom --load tool ";
  const Told stopped = Shell{}.hmax(tool + "--load-steps 1 --iterations 1 --json");
  EXPECT_EQ(stopped.exit_code, 1);
  EXPECT_TRUE(says(stopped.json().at("status").get<std::string>(), "more iterations"));
  EXPECT_LT(Shell{}.json(tool + "--load-steps 5").at("iterations"), Shell{}.json(tool).at("iterations"));
}

TEST(Static, CountsIterationsAndNotTheStartsOfSearches) {
  const Shell shell;
  for (const char* searched : {"--mesh phantom --load press --load-steps 5", "--mesh phantom --load tool",
                               "--mesh ball:n=3 --model fem_neo_hookean --load press --load-scale 8"}) {
    const AnyJson found = shell.json(std::string("static --output h.csv ") + searched);
    const std::vector<double> numbers = read_csv(shell / "h.csv").values[0];
    EXPECT_EQ(numbers.front(), 0) << searched;
    EXPECT_EQ(numbers.back(), found.at("iterations")) << searched;
    EXPECT_GT(numbers.size(), numbers.back() + 1) << searched;
    EXPECT_TRUE(std::ranges::is_sorted(numbers)) << searched;
  }
}

TEST(Static, HasTheEnergyOfTheLoadThatActs) {
  const auto energy = [](const std::string& scale) {
    return Shell{}
        .json("static --mesh phantom --model fem_cauchy --load press --load-scale " + scale)
        .at("energy")
        .get<double>();
  };
  EXPECT_NEAR(energy("2"), 4 * energy("1"), 1e-9 * std::abs(energy("1")));
  EXPECT_LT(energy("1"), 0);
}

TEST(Static, SaysFromWhichLoadFramesHaveNoEquilibriumToBeHeldAgainst) {
  const Told told =
      Shell{}.hmax("static --mesh ball:n=2 --load-scale 3 --pseudo-dynamic 3 --frames 10 --json");
  EXPECT_EQ(told.exit_code, 1);
  EXPECT_EQ(told.json().at("outcome"), "not_converged");
  EXPECT_TRUE(says(told.json().at("status").get<std::string>(), "of the load"));
  const AnyJson last = told.json().at("frames").back();
  EXPECT_TRUE(last.at("error").is_null());
  EXPECT_TRUE(says(last.at("status").get<std::string>(), "no equilibrium"));
}

TEST(RunOnAMesh, SaysThatElementsHaveEndedInsideOut) {
  const std::string pressed =
      "run --mesh phantom --load press --set force=100 --set alpha=20 --method linearly_implicit_euler --h 0.01 ";
  const Told told = Shell{}.hmax(pressed + "--json");
  ASSERT_LE(told.json().at("least_volume"), 0.0);
  EXPECT_TRUE(says(Shell{}.hmax(pressed).err, "is inverted"));
  EXPECT_GT(Shell{}.json("run --mesh phantom --method linearly_implicit_euler --h 0.01").at("least_volume"),
            0.5);
}

TEST(StabilityMap, HasNoLimitWhereABodyHasNoEquilibrium) {
  const Shell shell;
  const AnyJson map =
      shell.json("stability map --mesh ball:n=2 --method rk4 --x g=1:40:2 --y E=5500:6000:2 --output map");
  EXPECT_TRUE(map.at("h_max").at(0).at(0).is_number());
  EXPECT_TRUE(map.at("h_max").at(0).at(1).is_null());
  EXPECT_TRUE(says(map.at("status").get<std::string>(), "no equilibrium"));
  // Grey up to the point that has one, not white.
  EXPECT_TRUE(says(read_text(shell / "map/map.dat"), "the model has no rest: x, y"));
  EXPECT_TRUE(says(read_text(shell / "map/map.gp"), "'g [m/s²]'"));
}

TEST(Static, SaysThatNothingHoldsABody) {
  const Told told = Shell{}.hmax("static --mesh phantom --set support=0 --json");
  EXPECT_EQ(told.exit_code, 1);
  EXPECT_TRUE(says(told.json().at("status").get<std::string>(), "supports"));
  for (const char* asked : {" --compare out", " --frames 3", " --pseudo-dynamic 1"})
    expect_refusal(std::string("static --mesh phantom --set support=0") + asked,
                   "the supports hold no point");
}

TEST(Static, EndsWithOneWhenThereIsNoEquilibrium) {
  const Told result = Shell{}.hmax("static --mesh phantom --load press --load-scale 1e4 --json");
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.json().at("outcome"), "converged");
  EXPECT_NE(result.json().at("status"), "");
  expect_refusal("static --problem liver_linear", "--mesh");
  expect_refusal("static --mesh phantom --load breathing", "time");
  expect_refusal("static --mesh phantom --load tool --load-scale 2", "depth");
}

TEST(Static, RunAndPredictSayHowDeepAToolIndents) {
  const AnyJson pressed = Shell{}.json("static --mesh phantom --load tool").at("tool");
  EXPECT_DOUBLE_EQ(pressed.at("depth"), 0.01);
  EXPECT_GE(pressed.at("indentation"), 0.009);
  EXPECT_LT(pressed.at("penetration"), 0.001);
  const std::string run =
      "run --mesh phantom --load tool --method linearly_implicit_euler --h 0.01 --t-end 1";
  EXPECT_GE(Shell{}.json(run).at("tool").at("indentation"), 0.009);
  EXPECT_EQ(Shell{}.hmax(run).err, "");
  const Told soft = Shell{}.hmax(run + " --set tool_stiffness=1e5");
  EXPECT_TRUE(says(soft.out, "indentation"));
  EXPECT_TRUE(says(soft.err, "raise tool_stiffness"));
  const std::string predict = "stability predict --mesh phantom --load tool --methods rk4";
  EXPECT_GE(Shell{}.json(predict).at("models").at(0).at("tool").at("indentation"), 0.009);
  EXPECT_TRUE(says(Shell{}.hmax(predict + " --at rest").err, "does not touch"));
}

TEST(Static, WarnsOfAShallowToolOnlyOnceItsPressHasEnded) {
  const std::string run =
      "run --mesh phantom --load tool --method linearly_implicit_euler --h 0.01 --set "
      "tool_stiffness=1e5 --t-end ";
  EXPECT_EQ(Shell{}.hmax(run + "0.1").err, "");
  EXPECT_EQ(Shell{}.hmax(run + "0.49").err, "");
  EXPECT_TRUE(says(Shell{}.hmax(run + "0.5").err, "raise tool_stiffness"));
}

TEST(Static, ShowsTheErrorOfFramesThatHaveNoTime) {
  const AnyJson frames = Shell{}.json("static --mesh phantom --load press --pseudo-dynamic 1 --frames 10");
  EXPECT_EQ(frames.at("frames").size(), 10u);
  const AnyJson slower = Shell{}.json("static --mesh phantom --load press --pseudo-dynamic 3 --frames 10");
  EXPECT_LT(slower.at("largest_error").get<double>(), frames.at("largest_error").get<double>());
}

TEST(Static, HasNoErrorOfFramesWhoseEquilibriumIsNotKnown) {
  const std::string frames = "static --mesh phantom --load press --pseudo-dynamic 1 --frames 3 --set force=";
  const Told lost = Shell{}.hmax(frames + "50 --json");
  EXPECT_EQ(lost.exit_code, 1);
  EXPECT_TRUE(lost.json().at("largest_error").is_null()) << lost.out;
  EXPECT_FALSE(says(lost.out, "beyond the range of numbers")) << lost.out;
  EXPECT_TRUE(says(Shell{}.hmax(frames + "50").out, "largest error undefined"));
  // As of one equilibrium of a body that nothing loads.
  const AnyJson unloaded = Shell{}.json(frames + "0");
  EXPECT_EQ(unloaded.at("outcome"), "converged");
  EXPECT_TRUE(says(unloaded.at("status").get<std::string>(), "nothing loads the body"));
}

TEST(Static, TellsTheFactorOfTheLoadBesideTheLoad) {
  const Shell shell;
  const std::string pressed = "static --mesh phantom --load press --load-scale 3 ",
                    factor = "force=0.5 support=0.1 axis=3, load x 3";
  EXPECT_TRUE(says(shell.text(pressed + "--output h.csv --picture p.svg"), factor));
  for (const char* file : {"h.csv", "p.svg"}) EXPECT_TRUE(says(read_text(shell / file), "load x 3")) << file;
  for (const char* asked : {"--compare out", "--frames 3"}) {
    EXPECT_TRUE(says(shell.text(pressed + asked), factor)) << asked;
    EXPECT_EQ(shell.json(pressed + asked).at("load_scale"), 3) << asked;
  }
  EXPECT_FALSE(says(shell.text("static --mesh phantom --load press"), "load x"));
}

/// Rows of matrices are in hmax's order, which is another than that of a large mesh.
TEST(TissueMatrices, NameTheirRowsByTheNumbersOfTheMesh) {
  const Shell shell;
  ASSERT_EQ(shell.hmax("mesh convert ball:n=7 --matrices out").exit_code, 0);
  std::ifstream file(shell / "out/stiffness.dof");
  std::string line;
  std::getline(file, line);  // a comment
  std::vector<std::string> rows;
  while (std::getline(file, line)) rows.push_back(line);
  ASSERT_GT(rows.size(), 3 * 1000U);
  EXPECT_NE(rows.front(), "1.1");
  EXPECT_EQ(std::set<std::string>(rows.begin(), rows.end()).size(), rows.size());
  for (const char* row : {"1.1", "1.2", "1.3"}) EXPECT_EQ(std::ranges::count(rows, row), 1) << row;
}

}  // namespace
}  // namespace hmax
