/// What `hmax stability predict` says of its rows, and of the motion that it looks along.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "problems/mesh/files/mesh_names.hpp"
#include "tests/cli/program.hpp"

namespace hmax {
namespace {

using AnyJson = nlohmann::json;

TEST(StabilityPredict, LooksAlongAWholePeriodOrSaysThatItDoesNot) {
  const Shell shell;
  const std::string line = "stability predict --mesh cube:n=1 --load breathing --methods rk4 ";
  const Told whole = shell.hmax(line);
  EXPECT_TRUE(says(whole.out, "motion to t = 4 s"));
  EXPECT_FALSE(says(whole.out, "before one period"));
  EXPECT_NEAR(
      shell.hmax(line + "--json").json().at("rows").at(0).at("along").at("path").back().at(0).get<double>(),
      4, 1e-9);
  const Told part = shell.hmax(line + "--t-end 1");
  EXPECT_TRUE(says(part.out, "before one period of the load, 4 s"));
  EXPECT_TRUE(says(part.out, "--t-end 4"));
}

TEST(StabilityPredict, PrintsAGapThatRoundsToNothingWithoutASign) {
  const std::string line = "stability predict --problem liver_linear --set c=6 --methods rkc_2 --verify ";
  const double gap = Shell{}.hmax(line + "--json").json().at("rows").at(0).at("gap");
  ASSERT_LT(std::abs(gap), 5e-7);
  const Told told = Shell{}.hmax(line);
  EXPECT_TRUE(says(told.out, " 0.0000 %"));
  EXPECT_FALSE(says(told.out, "+0.0000"));
}

TEST(StabilityPredict, HasNoGapBetweenLimitsOfDifferentStates) {
  const AnyJson rows =
      Shell{}
          .json("stability predict --problem liver_forced --methods explicit_runge_kutta,structural --verify")
          .at("rows");
  int moved = 0;
  for (const AnyJson& row : rows) {
    if (row.at("observed").is_null()) continue;
    const bool away = row.value("status", "").find("moves the model away") != std::string::npos;
    moved += away;
    EXPECT_EQ(row.at("gap").is_null(), away || row.at("observed") == "unbounded") << row;
  }
  EXPECT_GT(moved, 0);
}

TEST(StabilityPredict, SaysThatAStopJustTouches) {
  const Shell shell;
  std::ofstream(shell / "stop.toml") << "[equations]\nx = \"v\"\nv = \"-100*x - (x<0 ? 1e4*x : 0) - 0.2*v\"\n"
                                        "[initial]\nx = 0\nv = 0\n";
  const std::string line = "stability predict --problem stop.toml --methods rk4,newmark";
  const std::string kink =
      "the slopes of the model jump at this state: h_max is the limit of its stiffest side";
  for (const char* along : {"", " --along none"}) {
    const Told told = shell.hmax(line + along);
    EXPECT_TRUE(says(told.out, kink)) << told.out;
    EXPECT_FALSE(says(told.out, "h_max holds for small motions")) << told.out;
  }
  const AnyJson answer = shell.json(line), row = answer.at("rows").at(0);
  EXPECT_TRUE(says(row.at("status").get<std::string>(), kink)) << row;
  EXPECT_EQ(answer.at("models").at(0).at("kink"), true);
  const AnyJson matrices = shell.json("stability matrices --problem stop.toml --output matrices");
  EXPECT_TRUE(says(matrices.at("status").get<std::string>(), "matrices are those of its stiffest side"))
      << matrices;
  // Of the side the code takes it is ten times as long.
  EXPECT_NEAR(row.at("h_max").get<double>(), std::sqrt(8 / 10100.0), 3e-4);
  EXPECT_TRUE(row.at("safe").at("h").is_null()) << row;  // nothing moves from there
}

TEST(StabilityPredict, FailsWhereNothingCouldBeVerified) {
  const Shell shell;
  const std::string line = "stability predict --mesh cube:n=1 --verify --methods ";
  const Told adaptive = shell.hmax(line + "adams_pece");
  EXPECT_EQ(adaptive.exit_code, 1);
  EXPECT_TRUE(says(adaptive.err, "nothing was verified"));
  const Told both = shell.hmax(line + "adams_pece,rk4");
  EXPECT_EQ(both.exit_code, 0) << both.err;
  EXPECT_EQ(both.err, "") << "one row is verified";
  EXPECT_EQ(shell.hmax("stability predict --mesh cube:n=1 --methods adams_pece").exit_code, 0);
}

/// Small meshes keep their order, large ones are renumbered inside.
TEST(StabilityPredict, NamesTheFastestElementByTheNumbersOfTheMesh) {
  for (const std::string name : {"liver", "ball:n=7"}) {
    const TetMesh mesh = mesh_by_name(name);
    const auto has = [&](Eigen::Index tetrahedron, std::int64_t point) {
      return (mesh.tetrahedra.col(tetrahedron).array() == static_cast<TetMesh::Index>(point - 1)).any();
    };
    const std::string line = "stability predict --at rest --methods rk4 --mesh " + name;
    const AnyJson mode = Shell{}.json(line).at("models").at(0).at("fastest_mode");
    const std::vector<std::int64_t> corners = mode.at("points");
    ASSERT_EQ(corners.size(), 4);
    for (const auto corner : corners)
      EXPECT_TRUE(has(mode.at("element").get<Eigen::Index>() - 1, corner)) << mode;

    const std::string springs = line + " --model mass_spring";
    const std::vector<std::int64_t> ends =
        Shell{}.json(springs).at("models").at(0).at("fastest_mode").at("points");
    ASSERT_EQ(ends.size(), 2);
    bool is_edge = false;
    for (Eigen::Index t = 0; t < mesh.tetrahedron_count(); ++t)
      is_edge = is_edge || (has(t, ends[0]) && has(t, ends[1]));
    EXPECT_TRUE(is_edge) << name << ", points " << ends[0] << " and " << ends[1];
    EXPECT_NE(
        Shell{}.hmax(springs).out.find(fmt::format("the spring of points {}, {} has", ends[0], ends[1])),
        std::string::npos);
  }
}

/// A cube whose middle, point 13 of a file that counts from 0, lies near one of its neighbours.
std::string vtk_of_a_misplaced_point() {
  TetMesh mesh = mesh_by_name("cube:n=2");
  mesh.points.col(13) += Eigen::Vector3d(0.038, 0.004, 0.002);
  std::string text =
      fmt::format("# vtk DataFile Version 3.0\ncube\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS {} double\n",
                  mesh.point_count());
  for (const auto& point : mesh.points.colwise())
    text += fmt::format("{} {} {}\n", point[0], point[1], point[2]);
  const auto count = mesh.tetrahedron_count();
  text += fmt::format("CELLS {} {}\n", count, 5 * count);
  for (const auto& corners : mesh.tetrahedra.colwise())
    text += fmt::format("4 {} {} {} {}\n", corners[0], corners[1], corners[2], corners[3]);
  text += fmt::format("CELL_TYPES {}\n", count);
  for (Eigen::Index t = 0; t < count; ++t) text += "10\n";
  return text;
}

TEST(StabilityPredict, NamesAMisplacedPointByTheNumberOfItsFile) {
  const Shell shell;
  write_text(shell / "cube.vtk", vtk_of_a_misplaced_point());
  const std::string line =
      "stability predict --at rest --methods rk4 --mesh cube.vtk --unit m --model fem_cauchy";
  const AnyJson mode = shell.json(line).at("models").at(0).at("fastest_mode");
  EXPECT_EQ(mode.at("gain").at("moved_point"), 13) << mode;
  EXPECT_EQ(std::ranges::count(mode.at("points"), AnyJson(13)), 1) << mode;
  EXPECT_TRUE(says(shell.hmax(line).out, "with point 13 moved towards its neighbours"));
}

TEST(StabilityModes, NameSpringsByTheirPoints) {
  const std::string line =
      "stability modes --mesh ball:n=7 --model mass_spring --at rest --fastest --count 1";
  const std::vector<std::int64_t> ends = Shell{}.json(line).at("modes").at(0).at("points");
  ASSERT_EQ(ends.size(), 2);
  EXPECT_NE(Shell{}.hmax(line).out.find(fmt::format("the spring of points {}, {} with", ends[0], ends[1])),
            std::string::npos);
}

/// Three translations and three rotations strain nothing: they have no frequency and no element.
TEST(StabilityModes, OfABodyThatNothingHoldsBeginWithSixRigidMotions) {
  const AnyJson modes = Shell{}.json("stability modes --mesh cube:n=2 --set support=0 --count 8").at("modes");
  ASSERT_EQ(modes.size(), 8U);
  for (std::size_t i = 0; i < 8; ++i) {
    EXPECT_EQ(modes[i].at("frequency") == 0.0, i < 6) << modes[i];
    EXPECT_EQ(modes[i].at("element").is_null(), i < 6) << modes[i];
  }
}

}  // namespace
}  // namespace hmax
