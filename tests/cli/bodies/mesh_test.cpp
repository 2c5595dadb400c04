#include <algorithm>
#include <array>
#include <tuple>

#include "tests/cli/program.hpp"

namespace hmax {
namespace {

using AnyJson = nlohmann::json;

/// Two tetrahedra, of which the second is inverted where asked for, and an idle node.
std::string two_tetrahedra(bool inverted) {
  return std::string(
             "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n6\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 1 1 1\n6 9 9 9\n"
             "$EndNodes\n$Elements\n2\n11 4 2 1 1 1 2 3 4\n12 4 2 2 1 ") +
         (inverted ? "3 2 4 5" : "2 3 4 5") + "\n$EndElements\n";
}

TEST(Mesh, InfoHasTheCountsOfTheStudy) {
  const Shell shell;
  const AnyJson liver = shell.json("mesh info liver");
  EXPECT_EQ(liver.at("points"), 299);
  EXPECT_EQ(liver.at("edges"), 1634);
  EXPECT_EQ(liver.at("tetrahedra"), 1151);
  EXPECT_EQ(liver.at("surface_points"), 187);
  EXPECT_EQ(liver.at("surface_triangles"), 370);
  EXPECT_EQ(liver.at("surface_edges"), 555);
  EXPECT_EQ(liver.at("faces"), 2487);
  EXPECT_EQ(liver.at("components"), 1);
  EXPECT_EQ(liver.at("unused_points"), 0);
  EXPECT_EQ(liver.at("inverted"), 0);
  EXPECT_EQ(liver.at("unit"), 1);
  EXPECT_GT(liver.at("smallest_angle_degrees"), 8);
  EXPECT_GT(liver.at("quality").at("mean"), liver.at("quality").at("min"));
  const Told told = shell.hmax("mesh info phantom");
  EXPECT_TRUE(says(told.out, "unit: metres"));
  EXPECT_TRUE(says(told.out, "volume           0.001 m³"));
}

TEST(Mesh, InfoSaysThatTheUnitOfAFileIsNotStated) {
  const Shell shell;
  write_text(shell / "two.msh", two_tetrahedra(false));
  EXPECT_TRUE(says(shell.hmax("mesh info two.msh").out, "not stated in the file; taken as metres here"));
  const AnyJson without = shell.json("mesh info two.msh");
  EXPECT_TRUE(without.at("unit").is_null());
  EXPECT_TRUE(without.at("status").is_string());
  EXPECT_DOUBLE_EQ(without.at("volume").get<double>(), 0.5);
  const AnyJson stated = shell.json("mesh info two.msh --unit cm");
  EXPECT_NEAR(stated.at("volume").get<double>(), 0.5e-6, 1e-18);
  EXPECT_EQ(stated.at("unused_points"), 1);
  EXPECT_EQ(stated.at("regions").size(), 2U);
  EXPECT_NEAR(stated.at("regions")[1].at("volume").get<double>(), 1e-6 / 3, 1e-18);
  EXPECT_EQ(stated.at("box")[1][0], 0.09);
  expect_refused(shell.hmax("mesh info liver --unit cm"), "the mesh liver is in metres");
  const Told same = shell.hmax("mesh info liver --unit m");
  EXPECT_EQ(same.exit_code, 0) << same.err;
  EXPECT_EQ(same.err, "");
  expect_refused(shell.hmax("mesh info two.msh --unit inch"), "'inch' is no unit of length");
}

TEST(Mesh, CheckNamesWhatIsWrongWithLineAndElement) {
  const Shell shell;
  write_text(shell / "bad.msh", two_tetrahedra(true));
  const Told told = shell.hmax("mesh check bad.msh");
  EXPECT_EQ(told.exit_code, 1);
  EXPECT_TRUE(says(told.out, "bad.msh, line 16: tetrahedron 12 is inverted"));
  EXPECT_TRUE(says(told.out, "1 points are in no tetrahedron"));
  const AnyJson json = shell.hmax("mesh check bad.msh --json").json();
  EXPECT_EQ(json.at("good"), false);
  EXPECT_EQ(json.at("inverted"), AnyJson({12}));
  EXPECT_EQ(shell.json("mesh info bad.msh").at("inverted"), 1);
  EXPECT_EQ(shell.hmax("mesh check liver").exit_code, 0);
}

TEST(Mesh, CheckNamesSlivers) {
  const Shell shell;
  const Told told = shell.hmax("mesh check liver --slivers 60 --json");
  EXPECT_EQ(told.exit_code, 1);
  const AnyJson slivers = told.json().at("slivers");
  ASSERT_GT(slivers.size(), 100U);
  EXPECT_LE(slivers[0].at("angle_degrees"), slivers[1].at("angle_degrees"));
  EXPECT_TRUE(says(shell.hmax("mesh check liver --slivers 60").out, "is a sliver: dihedral angle"));
  expect_refused(shell.hmax("mesh check liver --slivers 80"), "--slivers");
}

TEST(Mesh, ConvertTurnsWhatIsInvertedOnlyWhenAsked) {
  const Shell shell;
  write_text(shell / "bad.msh", two_tetrahedra(true));
  expect_refused(shell.hmax("mesh convert bad.msh good.msh"),
                 "line 16: tetrahedron 12 is inverted; turn it with");
  const std::string told = shell.text("mesh convert bad.msh good.vtu --fix");
  EXPECT_TRUE(says(told, "1 turned"));
  const AnyJson info = shell.json("mesh info good.vtu");
  EXPECT_EQ(info.at("inverted"), 0);
  EXPECT_EQ(info.at("points"), 6);
  EXPECT_DOUBLE_EQ(info.at("volume").get<double>(), 0.5);
  EXPECT_EQ(shell.json("mesh convert good.vtu small.msh --unit mm").at("fixed"), 0);
  EXPECT_NEAR(shell.json("mesh info small.msh").at("volume").get<double>(), 0.5e-9, 1e-21);
}

TEST(Mesh, CheckAndConvertDoNotHideWhatIsTrulyInverted) {
  const Shell shell;
  // The apex of the second tetrahedron lies on the side of the first one.
  write_text(
      shell / "folded.msh",
      "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n5\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0.2 0.2 1\n5 0.3 0.3 0.5\n"
      "$EndNodes\n$Elements\n2\n1 4 2 1 1 1 2 3 4\n2 4 2 1 1 1 2 3 5\n$EndElements\n");
  const Told told = shell.hmax("mesh check folded.msh --slivers 1");
  EXPECT_EQ(told.exit_code, 1);
  EXPECT_TRUE(says(told.out, "line 15: tetrahedron 2 overlaps tetrahedron 1: both lie on the same side"));
  EXPECT_EQ(shell.hmax("mesh check folded.msh --json").json().at("overlaps"), AnyJson::parse("[[2, 1]]"));
  EXPECT_EQ(shell.json("mesh info folded.msh").at("overlaps"), 1);
  for (const char* command : {"mesh convert folded.msh a.msh --fix", "mesh convert folded.msh a.msh",
                              "stability predict --mesh folded.msh --unit m --methods rk4"})
    expect_refused(shell.hmax(command), "tetrahedron 2 overlaps tetrahedron 1");
}

/// A beam whose tetrahedra share points, or each have their own.
std::string beam_text(bool shared) {
  const int cells = 8;
  std::string points, elements;
  int count = 0, made = 0;
  const auto corner = [](int i, int j, int k) { return (i * 2 + j) * 2 + k + 1; };
  const auto point = [&](int number, int i, int j, int k) {
    points += std::to_string(number) + " " + std::to_string(0.025 * i) + " " + std::to_string(0.05 * j) +
              " " + std::to_string(0.05 * k) + "\n";
    ++count;
  };
  if (shared)
    for (int i = 0; i <= cells; ++i)
      for (int j = 0; j < 2; ++j)
        for (int k = 0; k < 2; ++k) point(corner(i, j, k), i, j, k);
  // Kuhn's six tetrahedra of a cell: the corners along the paths from one end of its diagonal to the other.
  for (int i = 0; i < cells; ++i)
    for (const auto& [a, b, even] :
         {std::tuple(0, 1, true), {1, 2, true}, {2, 0, true}, {1, 0, false}, {2, 1, false}, {0, 2, false}}) {
      std::array<int, 3> at{0, 0, 0};
      std::string row = std::to_string(++made) + " 4 2 1 1";
      std::array<int, 4> numbers{};
      for (int step = 0; step < 4; ++step) {
        if (step > 0) ++at[static_cast<std::size_t>(step == 1 ? a : step == 2 ? b : 3 - a - b)];
        numbers[static_cast<std::size_t>(step)] = shared ? corner(i + at[0], at[1], at[2]) : count + 1;
        if (!shared) point(count + 1, i + at[0], at[1], at[2]);
      }
      if (!even) std::swap(numbers[2], numbers[3]);
      for (const int number : numbers) row += " " + std::to_string(number);
      elements += row + "\n";
    }
  return "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n" + std::to_string(count) + "\n" + points +
         "$EndNodes\n$Elements\n" + std::to_string(made) + "\n" + elements + "$EndElements\n";
}

TEST(Mesh, CoincidentPointsAreNamedAndMerged) {
  const Shell shell;
  write_text(shell / "shared.msh", beam_text(true));
  write_text(shell / "own.msh", beam_text(false));
  EXPECT_EQ(shell.hmax("mesh check shared.msh").exit_code, 0) << shell.hmax("mesh check shared.msh").out;
  const Told told = shell.hmax("mesh check own.msh");
  EXPECT_EQ(told.exit_code, 1);
  EXPECT_EQ(told.out.rfind("156 points coincide with another, 156 of them exactly: point ", 0), 0U)
      << told.out;
  EXPECT_LT(std::count(told.out.begin(), told.out.end(), '\n'), 5) << told.out;
  EXPECT_EQ(shell.hmax("mesh check own.msh --json").json().at("coincident").size(), 156U);
  EXPECT_EQ(shell.json("mesh info own.msh").at("coincident_points"), 156);
  EXPECT_EQ(shell.hmax("mesh check own.msh:merge=0").exit_code, 0);
  const Told converted = shell.hmax("mesh convert own.msh merged.msh");
  EXPECT_TRUE(says(converted.out, "36 points, 48 tetrahedra, merged 156 coincident points")) << converted.err;
  EXPECT_EQ(shell.hmax("mesh check merged.msh").exit_code, 0);
  EXPECT_EQ(shell.json("mesh convert own.msh kept.msh --merge off").at("points"), 192);
  expect_refused(shell.hmax("mesh convert own.msh a.msh --merge 0.5"), "give a share of the shortest edge");

  // Step limits are those of the mesh whose tetrahedra share their points.
  const auto limit = [&](const std::string& mesh) {
    return shell
        .json("stability predict --mesh " + mesh +
              " --unit m --set axis=1 --at rest --methods symplectic_euler")
        .at("rows")[0]
        .at("h_max")
        .get<double>();
  };
  const double expected = limit("shared.msh");
  EXPECT_NEAR(limit("own.msh"), expected, 1e-9 * expected);
  EXPECT_NEAR(limit("merged.msh"), expected, 1e-9 * expected);
  EXPECT_LT(limit("own.msh:merge=off"), 0.95 * expected);
  const Told said =
      shell.hmax("stability predict --mesh own.msh --unit m --set axis=1 --at rest --methods rk4");
  EXPECT_TRUE(says(said.err, "merged 156 coincident points of own.msh; :merge=off"));
  // A point that is gone is still called by its number.
  const std::string run =
      "stability predict --unit m --at rest --methods rk4 --json --mesh own.msh --support ";
  EXPECT_EQ(shell.hmax(run + "points:1,2,3").json().at("rows")[0].at("h_max"),
            shell.hmax(run + "points:5,2,3").json().at("rows")[0].at("h_max"));
}

TEST(Mesh, PointsThatNearlyCoincideAreNamedAndNotMergedUnasked) {
  const Shell shell;
  std::string text = beam_text(false);
  const std::size_t at = text.find("\n190 ");
  const std::size_t x = text.find(' ', at) + 1;
  text.replace(x, text.find(' ', x) - x, "0.200005");
  write_text(shell / "near.msh", text);
  const Told told = shell.hmax("mesh check near.msh");
  EXPECT_EQ(told.out.rfind("156 points coincide with another, 155 of them exactly", 0), 0U) << told.out;
  EXPECT_TRUE(says(shell.hmax("mesh convert near.msh a.msh").out, "merged 155 "));
  EXPECT_TRUE(says(shell.hmax("mesh convert near.msh b.msh --merge 1e-3").out, "merged 156 "));
  const Told said =
      shell.hmax("stability predict --mesh near.msh --unit m --set axis=1 --at rest --methods rk4");
  EXPECT_TRUE(
      says(said.err,
           "near.msh has 1 point within 0.001 of an edge from another point, not merged: point 190 beside"));
}

TEST(Mesh, MakeAndRefineWriteWhatOtherProgramsRead) {
  const Shell shell;
  EXPECT_EQ(shell.hmax("mesh make ball:n=3 --output ball.msh").exit_code, 0);
  EXPECT_EQ(shell.hmax("mesh refine ball.msh --times 2 --output fine.vtu").exit_code, 0);
  EXPECT_EQ(shell.json("mesh info fine.vtu").at("tetrahedra"), 64 * 540);
  EXPECT_EQ(shell.json("mesh info ball.msh:refine=2").at("edges"),
            shell.json("mesh info fine.vtu").at("edges"));
  expect_refused(shell.hmax("mesh make ball.msh --output a.msh"), "is a file");
  expect_refused(shell.hmax("mesh make ball --output a.stl"), ".msh, .vtu or .scn");
  expect_refused(shell.hmax("mesh make ball"), "--output");
  expect_refused(shell.hmax("mesh refine ball --times 30 --output a.msh"), "refine less often");
  expect_refused(shell.hmax("mesh refine ball --times -1 --output a.msh"), "--times");
}

TEST(Mesh, InfoSaysWhatWasSmoothed) {
  const Shell shell;
  EXPECT_TRUE(shell.json("mesh info ball:n=2").at("smoothed").is_null());
  const AnyJson document = shell.json("mesh info ball:n=2:refine=1:mend=8");
  const AnyJson mended = document.at("smoothed");
  EXPECT_EQ(document.at("mended"), mended);  // its old name
  EXPECT_GT(mended.at("moved_points"), 0);
  EXPECT_GT(mended.at("farthest"), 0);
  EXPECT_GT(mended.at("least_height_after"), 0.999999 * mended.at("least_height_before").get<double>());
  EXPECT_GE(mended.at("least_mean_height_after"), mended.at("least_mean_height_before"));
  ASSERT_EQ(shell.hmax("mesh make ball:n=2:refine=1:radius=50 --output ball.msh").exit_code, 0);
  const AnyJson of_file = shell.json("mesh info ball.msh:mend=8 --unit mm").at("mended");
  EXPECT_NEAR(of_file.at("least_height_before").get<double>(), mended.at("least_height_before").get<double>(),
              1e-9);
  const Told told = shell.hmax("mesh info ball:n=2:refine=1:mend=8");
  EXPECT_TRUE(says(told.out, " points moved by at most "));
  EXPECT_FALSE(says(shell.hmax("mesh info ball:n=2").out, "smoothed"));
  // What is written is the mended mesh.
  ASSERT_EQ(shell.hmax("mesh convert ball:n=2:refine=1:mend=8 better.msh").exit_code, 0);
  EXPECT_NE(shell.json("mesh info better.msh").at("shortest_edge"),
            shell.json("mesh info ball:n=2:refine=1").at("shortest_edge"));
}

TEST(Mesh, WhatIsNoMeshFileIsToldTheExtensionsThatAreRead) {
  const Shell shell;
  std::filesystem::create_directory(shell / "folder.msh");
  write_text(shell / "a.stl", "solid");
  for (const char* command : {"mesh info ", "mesh check ", "run --unit m --method rk4 --h 1 --mesh "}) {
    expect_refused(shell.hmax(std::string(command) + "folder.msh"),
                   "is a folder; name a file .msh .vtk .vtu .node .ele .mesh .veg .inp .scn .feb .xml in it");
    expect_refused(
        shell.hmax(std::string(command) + "a.stl"),
        "no mesh by its extension; name a file .msh .vtk .vtu .node .ele .mesh .veg .inp .scn .feb .xml");
  }
}

TEST(Mesh, AScenePutsTheTissueOnTheMesh) {
  const Shell shell;
  const Told told = shell.hmax(
      "mesh convert phantom gel.scn --material liver:male_normal --model fem_green --gravity 0,0,-9.81 --h 0.005 "
      "--support -1,1,-1,1,-0.001,0.001");
  EXPECT_EQ(told.exit_code, 0) << told.err;
  const std::string scene = read_text(shell / "gel.scn");
  EXPECT_TRUE(says(scene, "dt=\"0.005\" gravity=\"0 0 -9.81\""));
  EXPECT_TRUE(says(scene, "StVenantKirchhoff"));
  EXPECT_TRUE(says(scene, "totalMass"));
  EXPECT_TRUE(says(scene, "FixedProjectiveConstraint"));
  EXPECT_EQ(told.err, "") << "it has supports and gravity";
  const Told bare = shell.hmax("mesh convert phantom bare.scn");
  EXPECT_EQ(bare.exit_code, 0) << bare.err;
  EXPECT_TRUE(says(bare.err, "no supports and no gravity"));
  EXPECT_TRUE(
      says(shell.hmax("mesh convert phantom light.scn --support -1,1,-1,1,-0.001,0.001").err, "no gravity"));
  write_text(shell / "two.msh", two_tetrahedra(false));
  expect_refused(shell.hmax("mesh convert two.msh two.scn"), "state it with --unit");
  expect_refused(shell.hmax("mesh convert phantom a.vtu --h 0.1"), "belong to a SOFA scene");
  ASSERT_EQ(shell.hmax("mesh convert phantom springs.scn --model mass_spring").exit_code, 0);
  EXPECT_TRUE(says(read_text(shell / "springs.scn"), "StiffSpringForceField"));
  expect_refused(shell.hmax("mesh convert phantom a.scn --model mass_spring --set cubic=10"), "not linear");
  expect_refused(shell.hmax("mesh convert phantom a.scn --support 1,2"), "no group or region '1,2'");
  expect_refused(shell.hmax("mesh convert phantom a.scn --support 5,6,5,6,5,6"), "give a larger box");
  expect_refused(shell.hmax("mesh convert phantom a.scn --h 0"), "step of a SOFA scene is 0");
  expect_refused(shell.hmax("mesh convert phantom a.scn --material steel"), "steel");
}

/// Two tetrahedra with numbers of their own, a region and a surface with names, and an idle node in front.
std::string named_tetrahedra() {
  return "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n2\n2 30 \"capsule\"\n3 20 \"tumour\"\n"
         "$EndPhysicalNames\n$Nodes\n6\n1 9 9 9\n12 0 0 0\n7 1 0 0\n3 0 1 0\n4 0 0 1\n50 1 1 1\n$EndNodes\n"
         "$Elements\n3\n1 2 2 30 1 12 3 7\n11 4 2 20 1 12 7 3 4\n5 4 2 10 2 7 3 4 50\n$EndElements\n";
}

TEST(Mesh, InfoListsRegionsAndGroupsByNameAndNumber) {
  const Shell shell;
  write_text(shell / "two.msh", named_tetrahedra());
  const AnyJson info = shell.json("mesh info two.msh --unit m");
  ASSERT_EQ(info.at("regions").size(), 2U);
  EXPECT_EQ(info.at("regions")[0].at("region"), 10);
  EXPECT_TRUE(info.at("regions")[0].at("name").is_null());
  EXPECT_EQ(info.at("regions")[1].at("name"), "tumour");
  EXPECT_EQ(info.at("regions")[1].at("tetrahedra"), 1);
  EXPECT_NEAR(info.at("regions")[1].at("volume").get<double>(), 1. / 6, 1e-15);
  EXPECT_EQ(info.at("groups"),
            AnyJson::parse(R"([{"kind": "surface", "number": 30, "name": "capsule", "elements": 1,
                                               "points": 3}])"));
  const std::string out = shell.hmax("mesh info two.msh").out;
  for (const char* part : {"20", "tumour", "surface:30", "capsule"}) EXPECT_TRUE(says(out, part));
}

TEST(Mesh, ConvertKeepsNumbersOrderAndNames) {
  const Shell shell;
  write_text(shell / "two.msh", named_tetrahedra());
  EXPECT_EQ(shell.hmax("mesh convert two.msh again.msh").exit_code, 0);
  EXPECT_TRUE(says(read_text(shell / "again.msh"), "\n1 2 2 30 30 12 3 7\n11 4 2 20 20 12 7 3 4\n5 4 2 10"));
  EXPECT_EQ(shell.hmax("mesh convert two.msh two.vtu").exit_code, 0);
  EXPECT_EQ(shell.hmax("mesh convert two.vtu back.msh").exit_code, 0);
  EXPECT_EQ(read_text(shell / "back.msh"), read_text(shell / "again.msh"));
  // Refined, the points of the file come first and keep their numbers.
  EXPECT_EQ(shell.hmax("mesh refine two.msh --output fine.msh").exit_code, 0);
  const std::string fine = read_text(shell / "fine.msh");
  EXPECT_TRUE(says(fine, "\n50 1 1 1\n51 "));
  EXPECT_EQ(shell.json("mesh info fine.msh").at("groups")[0].at("elements"), 4);
  EXPECT_EQ(shell.json("mesh info fine.msh").at("regions")[1].at("name"), "tumour");
}

TEST(Mesh, SecondOrderIsReadWithARemark) {
  const Shell shell;
  write_text(
      shell / "q.msh",
      "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n10\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 .5 0 0\n6 .5 .5 0\n"
      "7 0 .5 0\n8 0 0 .5\n9 .5 0 .5\n10 0 .5 .5\n$EndNodes\n$Elements\n1\n1 11 0 1 2 3 4 5 6 7 8 9 10\n$EndElements\n");
  EXPECT_EQ(shell.json("mesh info q.msh").at("second_order"), 1);
  EXPECT_TRUE(says(shell.hmax("mesh info q.msh").out, "second order are read by their corners"));
  const std::string checked = shell.hmax("mesh check q.msh").out;
  EXPECT_TRUE(says(checked, "6 points are no corner of a tetrahedron"));
  EXPECT_TRUE(says(checked, "with straight sides"));
  EXPECT_TRUE(says(shell.hmax("mesh convert q.msh l.msh").err, "second order are read by their corners"));
}

TEST(Mesh, CheckNamesPartsThatHangOnAPointOrThatNothingHolds) {
  const Shell shell;
  // Tetrahedron 5 shares a point with 11, tetrahedron 8 nothing.
  write_text(
      shell / "parts.msh",
      "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n11\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n15 -1 0 0\n16 0 -1 0\n"
      "17 0 0 -1\n21 5 0 0\n22 6 0 0\n23 5 1 0\n24 5 0 1\n$EndNodes\n$Elements\n3\n11 4 0 1 2 3 4\n5 4 0 1 16 15 17\n"
      "8 4 0 21 22 23 24\n$EndElements\n");
  const Told told = shell.hmax("mesh check parts.msh --support points:2");
  EXPECT_EQ(told.exit_code, 1);
  EXPECT_TRUE(says(told.out, "tetrahedron 5 hangs on point 1 only"));
  EXPECT_TRUE(says(told.out, "tetrahedron 8 is a separate part"));
  EXPECT_TRUE(says(told.out, "tetrahedron 8: no support holds it"));
  const AnyJson json = shell.hmax("mesh check parts.msh --support points:2,24 --json").json();
  EXPECT_EQ(json.at("loose"), AnyJson::array());
  EXPECT_EQ(json.at("parts"), AnyJson::parse(R"([{"tetrahedra": [5], "hinge_points": [1]},
                                             {"tetrahedra": [8], "hinge_points": []}])"));
}

TEST(Mesh, ASceneHasTheMaterialsAndSupportsOfItsRegions) {
  const Shell shell;
  write_text(shell / "two.msh", named_tetrahedra());
  shell.text(
      "mesh convert two.msh two.scn --unit m --set E:tumour=9000 --set E=4000 --set beta=0.01 --gravity 0,-9.81,0 "
      "--support capsule");
  const std::string scene = read_text(shell / "two.scn");
  for (const char* part :
       {"gravity=\"0 -9.81 0\"", "youngModulus=\"9000 4000\"", "rayleighStiffness=\"0.01\"",
        "tetrahedra=\"1 2 3 4 2 3 4 5\"", "indices=\"0 1 2 3\"", "position=\"9 9 9 0 0 0"})
    EXPECT_TRUE(says(scene, part));
  expect_refused(shell.hmax("mesh convert two.msh two.scn --unit m --support all"),
                 "no group or region 'all'");
  expect_refused(shell.hmax("mesh convert two.msh two.scn --unit m --set E:lung=1"), "no region lung");
  EXPECT_EQ(shell.hmax("mesh convert two.msh nu.scn --unit m --set nu:tumour=0.3").exit_code, 0);
  const std::string two_fields = read_text(shell / "nu.scn");
  for (const char* part :
       {"name=\"region_2\"", "poissonRatio=\"0.3\"", "poissonRatio=\"0.45\"", "tetrahedra=\"2 3 4 5\""})
    EXPECT_TRUE(says(two_fields, part));
}

TEST(Mesh, RefusesWhatIsNoMesh) {
  const Shell shell;
  expect_refused(shell.hmax("mesh info livr"), "did you mean 'liver'?");
  expect_refused(shell.hmax("mesh info none.msh"), "there is no file 'none.msh'");
  expect_refused(shell.hmax("mesh info ball:n=0"), "whole number");
  write_text(shell / "surface.msh",
             "$NOD\n3\n1 0 0 0\n2 1 0 0\n3 0 1 0\n$ENDNOD\n$ELM\n1\n1 2 0 0 3 1 2 3\n$ENDELM\n");
  expect_refused(shell.hmax("mesh info surface.msh"), "a surface only; fill it first");
  write_text(shell / "cut.msh", two_tetrahedra(false).substr(0, 120));
  expect_refused(shell.hmax("mesh info cut.msh"), "cut.msh, line");
  expect_refused(shell.hmax("mesh"), "mesh");
}

}  // namespace
}  // namespace hmax
