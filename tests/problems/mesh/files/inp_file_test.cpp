#include "problems/mesh/files/scenes/inp_file.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>

#include <gtest/gtest.h>

#include "tests/problems/mesh/files/mesh_damage.hpp"
#include "tests/problems/mesh/files/mesh_goldens.hpp"
#include "tests/says.hpp"

namespace hmax {
namespace {

const std::string one_inp =
    "** by hand\n*Heading\n two tetrahedra\n*Node, nset=all\n 10, 0., 0., 0.\n11, 0.5, 0, 0\n12, 0, 5.D-1, 0\n"
    "13, 0, 0, 0.5\n14, 0.5, 0.5, 0.5\n*Element, type=C3D4,\n elset=Body\n3, 10, 11, 12, 13\n5, 11, 12, 13, 14\n"
    "*Nset, nset=low, generate\n10, 12\n*Nset, nset=most\nlow, 13\n*Elset, elset=tip\n5\n*Elset, elset=root\n3,\n"
    "*Solid Section, elset=root, material=a\n*Solid Section, elset=tip, material=b\n"
    "*Boundary\nlow, 1, 2\n10, 3\n11, 3, 6\n*Step\n*Static\n*End Step\n";

std::vector<TetMesh::Index> points_called(const MeshFile& file, std::string_view name) {
  const auto group = std::ranges::find(file.groups, name, &MeshGroup::name);
  return group == file.groups.end() ? std::vector<TetMesh::Index>{} : group->corners;
}

TEST(InpFiles, TellTheSameMeshAsOtherFormats) {
  const MeshFile file = read_mesh("a.inp", one_inp);
  EXPECT_EQ(file.mesh.points, golden_mesh().points);
  EXPECT_EQ(file.mesh.tetrahedra, golden_mesh().tetrahedra);
  EXPECT_EQ(file.mesh.regions, (std::vector<TetMesh::Index>{1, 2}));
  EXPECT_EQ(file.names.at(2), "TIP");
  EXPECT_EQ(file.numbers, (std::vector<std::int64_t>{3, 5}));
  EXPECT_EQ(file.where(1), "a.inp, line 13: tetrahedron 5");
  const auto corners = [&](std::string_view name) { return points_called(file, name); };
  EXPECT_EQ(corners("LOW"), (std::vector<TetMesh::Index>{0, 1, 2}));
  EXPECT_EQ(corners("MOST"), (std::vector<TetMesh::Index>{0, 1, 2, 3}));
  EXPECT_EQ(corners(held_points), (std::vector<TetMesh::Index>{0, 1}));
  EXPECT_EQ(corners(otherwise_held_points), (std::vector<TetMesh::Index>{2}));
  std::string dos = one_inp;
  for (std::size_t at = 0; (at = dos.find('\n', at)) != std::string::npos; at += 2) dos.insert(at, "\r");
  EXPECT_EQ(read_mesh("a.inp", dos).mesh.points, golden_mesh().points);
}

TEST(InpFiles, FixPointsThatAreAlsoHeldOtherwise) {
  using Points = std::vector<TetMesh::Index>;
  const auto held = [](const std::string& what, const std::string& by) {
    const MeshFile file = read_mesh("a.inp", replaced(one_inp, what, by));
    return std::array{points_called(file, held_points), points_called(file, otherwise_held_points)};
  };
  EXPECT_EQ(held("11, 3, 6\n", "11, 3, 6\n10, 1, 1, 0.5\n"), (std::array{Points{0, 1}, Points{0, 2}}));
  EXPECT_EQ(held("11, 3, 6\n", "11, ZSYMM\n10, xsymm\n"), (std::array{Points{0, 1}, Points{2}}));
  // Cards that are not read fix nothing.
  for (const char* parameter : {"type=VELOCITY", "op=NEW"})
    EXPECT_EQ(held("*Boundary\n", std::string("*Boundary, ") + parameter + "\n"),
              (std::array{Points{}, Points{0, 1, 2}}));
  EXPECT_EQ(held("*Step", "*Boundary, op=NEW\n10, ENCASTRE\n*Step"),
            (std::array{Points{0, 1}, Points{0, 2}}));
}

TEST(InpFiles, HaveSetsThatNameEachMemberOnce) {
  const auto tips = [](const std::string& by) {
    return points_called(read_mesh("a.inp", replaced(one_inp, "*Nset, nset=low", by + "\n*Nset, nset=low")),
                         "TIPS");
  };
  EXPECT_EQ(tips("*Nset, nset=tips, elset=tip"), (std::vector<TetMesh::Index>{1, 2, 3, 4}));
  EXPECT_EQ(tips("*Nset, nset=tips\n12, 10\n10"), (std::vector<TetMesh::Index>{0, 2}));
}

TEST(InpFiles, RefuseParametersThatWouldChangeTheMesh) {
  for (const auto& [what, by, named] :
       {std::array{"nset=all", "nset=all, system=C", "line 4: SYSTEM of *NODE"},
        {"type=C3D4,", "type=C3D4, input=a.txt,", "INPUT of *ELEMENT"},
        {"generate", "generate, unknown", "UNKNOWN of *NSET"},
        {"elset=tip\n", "elset=tip, unknown\n", "UNKNOWN of *ELSET"}})
    EXPECT_TRUE(says(error_of<std::invalid_argument>(
                         [&] { static_cast<void>(read_mesh("a.inp", replaced(one_inp, what, by))); }),
                     named));
  EXPECT_EQ(read_mesh("a.inp", replaced(one_inp, "nset=all", "nset=all, system=R")).mesh.points,
            golden_mesh().points);
}

TEST(InpFiles, HaveRegionsOfElementSetsWithoutSections) {
  const std::string text = replaced(one_inp, "5, 11,", "*Element, type=C3D4, elset=End\n5, 11,");
  const MeshFile file = read_mesh("a.inp", text.substr(0, text.find("*Solid")));
  EXPECT_EQ(file.mesh.regions, (std::vector<TetMesh::Index>{1, 2}));
  EXPECT_EQ(file.names.at(1), "BODY");
}

/// Whatever a damaged file says, it is refused in one sentence or is a mesh.
TEST(InpFiles, SurviveDamage) {
  EXPECT_GT(refused_damages("a.inp", one_inp, {',', '*', '-', '=', '9', '\n', '\0', '\xff'}),
            2 * one_inp.size());
  for (const char* huge :
       {"10, 9223372036854775807, 2\n", "9223372036854775806, 9223372036854775807, 9223372036854775807\n",
        "10, 1000000000\n"})
    EXPECT_TRUE(says(error_of<std::invalid_argument>(
                         [&] { static_cast<void>(read_mesh("a.inp", replaced(one_inp, "10, 12\n", huge))); }),
                     "needs node"));
}

}  // namespace
}  // namespace hmax
