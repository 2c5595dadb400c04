#include "catalogue/models/support_sets.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "catalogue/models/problems.hpp"
#include "core/errors.hpp"
#include "problems/tissue/body.hpp"
#include "tests/results/scratch.hpp"
#include "tests/says.hpp"

namespace hmax {
namespace {

/// Two tetrahedra of the regions 7 (core) and 9 on a common face, points 2, 4, ... 12 of which the last is
/// idle, the surface 30 (skin) on points 2, 6, 4, and a point of group 5.
constexpr const char* two =
    "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n"
    "$PhysicalNames\n3\n2 30 \"skin\"\n3 7 \"core\"\n0 5 \"core\"\n$EndPhysicalNames\n"
    "$Nodes\n6\n2 0 0 0\n4 1 0 0\n6 0 1 0\n8 0 0 1\n10 1 1 1\n12 9 9 9\n$EndNodes\n"
    "$Elements\n5\n1 2 2 30 1 2 6 4\n2 15 2 5 1 10\n3 15 2 6 1 12\n4 4 2 7 1 2 4 6 8\n5 4 2 9 2 4 6 8 10\n"
    "$EndElements\n";

class SupportSets : public ::testing::Test {
 protected:
  SupportSets() {
    write_text(folder / "two.msh", two);
    mesh = load_mesh((folder / "two.msh").string(), 0.1);
  }

  /// The points of a set by the numbers of the file.
  std::vector<std::int64_t> held(const std::string& set) const {
    std::vector<std::int64_t> numbers;
    for (const TetMesh::Index i : union_of_sets({set}, mesh))
      numbers.push_back(mesh.origin->file.point_numbers.at(
          static_cast<std::size_t>(mesh.origin->points.at(static_cast<std::size_t>(i)))));
    std::ranges::sort(numbers);
    numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
    return numbers;
  }
  std::string refusal(const std::string& set) const {
    return error_of<InputError>([&] { union_of_sets({set}, mesh); });
  }
  Problem body(std::vector<std::pair<std::string, double>> parameters) const {
    return make_problem("fem_green@" + (folder / "two.msh").string(),
                        {.parameters = std::move(parameters), .unit = 0.1});
  }

  const Scratch folder;
  LoadedMesh mesh;
};

/// The same with a point in the middle of each of the nine edges, numbered on from 13.
class SupportSetsOfTenNodes : public SupportSets {
 protected:
  SupportSetsOfTenNodes() { mesh = load_mesh((folder / "two.msh").string(), 0.1, ElementNodes::ten); }

  /// How many middles a set has, all of which must lie between two corners of the set.
  int middles(const std::string& set) const {
    const std::vector<TetMesh::Index> points = union_of_sets({set}, mesh);
    const auto has = [&](TetMesh::Index i) { return std::ranges::find(points, i) != points.end(); };
    const auto now = mesh.origin->model_points();
    int count = 0;
    for (const auto& [point, one, other] : mesh.origin->file.inserted) {
      const auto at = [&](TetMesh::Index i) { return now.at(static_cast<std::size_t>(i)); };
      if (!has(at(point))) continue;
      ++count;
      EXPECT_TRUE(has(at(one)) && has(at(other))) << set;
    }
    return count;
  }
};

using Numbers = std::vector<std::int64_t>;

TEST_F(SupportSets, AreGroupsAndRegionsByNameOrByKindAndNumber) {
  EXPECT_EQ(held("skin"), (Numbers{2, 4, 6}));
  EXPECT_EQ(held("surface:skin"), (Numbers{2, 4, 6}));
  EXPECT_EQ(held("surface:30"), (Numbers{2, 4, 6}));
  EXPECT_EQ(held("region:core"), (Numbers{2, 4, 6, 8}));
  EXPECT_EQ(held("region:9"), (Numbers{4, 6, 8, 10}));
  EXPECT_EQ(held("vertices:core"), Numbers{10});
}

TEST_F(SupportSetsOfTenNodes, HaveTheMiddlesOfTheirEdges) {
  ASSERT_EQ(mesh.mesh.point_count(), 5 + 9);
  EXPECT_EQ(middles("skin"), 3);
  EXPECT_EQ(middles("region:core"), 6);
  EXPECT_EQ(middles("region:9"), 6);
  EXPECT_EQ(middles("z<0.001"), 3);
  EXPECT_EQ(middles("points:2,4,6"), 3);
  EXPECT_EQ(middles("points:2,10"), 0) << "no edge";
  EXPECT_EQ(middles("vertices:core"), 0);
  EXPECT_EQ(held("points:13"), Numbers{13});
  EXPECT_EQ(middles("points:4,10"), 1);
}

TEST_F(SupportSets, ArePointsByTheirNumbersBoxesAndFiles) {
  EXPECT_EQ(held("points:10,4"), (Numbers{4, 10}));
  EXPECT_EQ(held("-1,1,-1,1,-0.001,0.001"), (Numbers{2, 4, 6}));
  EXPECT_EQ(held("-inf,inf,-inf,inf,0.05,inf"), (Numbers{8, 10}));
  EXPECT_EQ(held("z<0.001"), (Numbers{2, 4, 6}));
  EXPECT_EQ(held("z<=0"), (Numbers{2, 4, 6}));
  EXPECT_EQ(held(" z >= 0.05"), (Numbers{8, 10}));
  EXPECT_EQ(held("x>0.1"), (Numbers{4, 10}));
  EXPECT_EQ(held("y<inf"), (Numbers{2, 4, 6, 8, 10}));
  EXPECT_TRUE(says(refusal("z<-1"), "the mesh reaches from 0 to 0.1 m along z"));
  EXPECT_TRUE(says(error_of<InputError>([&] { points_of_sets({"z<1"}, mesh); }),
                   "nothing moves; the mesh reaches from 0 to 0.1 m along z"));
  for (const char* wrong : {"z<low", "z<0.01,x<1", "z<", "z<0.1<0.2"})
    EXPECT_TRUE(says(refusal(wrong), "is not one axis and one number of metres")) << wrong;
  for (const char* wrong : {"w<1", "z=0", "0.01>x"})
    EXPECT_TRUE(says(refusal(wrong), "hold a box, z<0.01,")) << wrong;
  write_text(folder / "held.txt", "# the left side\n2 8\n\n 6,10 # and one more\n");
  EXPECT_EQ(held("@" + (folder / "held.txt").string()), (Numbers{2, 6, 8, 10}));
  write_text(folder / "held.txt",
             "\xEF\xBB\xBF"
             "2 8\n6 10\n");
  EXPECT_EQ(held("@" + (folder / "held.txt").string()), (Numbers{2, 6, 8, 10}));
}

TEST_F(SupportSets, WhatTheMeshDoesNotHaveIsRefused) {
  EXPECT_TRUE(says(refusal("skn"), "did you mean 'skin'?"));
  EXPECT_TRUE(says(refusal("surface:31"), "surface:skin"));
  EXPECT_TRUE(says(refusal("core"), "the name of 2 groups and regions"));
  EXPECT_TRUE(says(refusal("points:5"), "names point 5, but the points of"));
  EXPECT_TRUE(says(refusal("points:5"), "from 2 to 12 with gaps"));
  EXPECT_TRUE(says(refusal("points:12"), "point 12, which is in no tetrahedron"));
  EXPECT_TRUE(says(refusal("points:"), "no number of a point"));
  EXPECT_TRUE(says(refusal("points:1.5"), "'1.5'"));
  EXPECT_TRUE(says(refusal("vertices:6"), "no point of"));
  EXPECT_TRUE(says(refusal("5,6,5,6,5,6"), "larger box, in metres"));
  EXPECT_TRUE(says(refusal(""), "no group or region ''"));
  EXPECT_TRUE(says(refusal("@none.txt"), "no file 'none.txt'"));
  write_text(folder / "held.txt", "2\n4 x\n");
  EXPECT_TRUE(says(refusal("@" + (folder / "held.txt").string()), "held.txt, line 2 has 'x'"));
  write_text(folder / "held.txt", "# nothing\n");
  EXPECT_TRUE(says(refusal("@" + (folder / "held.txt").string()), "no point of"));
}

TEST_F(SupportSets, HoldABodyTogetherAndInsteadOfItsEnd) {
  EXPECT_EQ(body({{"support:skin", 1}}).body->dofs(), 6);
  const Problem held = body({{"support:points:2", 1}, {"support:points:2,10", 1}});
  EXPECT_EQ(held.body->dofs(), 9);
  // What is listed of a body makes it again.
  EXPECT_EQ(body(held.parameters).body->settings().supports.front().points,
            held.body->settings().supports.front().points);
  EXPECT_THROW(body({{"support:skin", 1}, {"support:points:8,10", 1}}), InputError);  // everything is held
  EXPECT_THROW(body({{"support:skin", 1}, {"support", 0.2}}), InputError);
  EXPECT_THROW(body({{"support:skin", 1}, {"xmin", 0}}), InputError);
  EXPECT_THROW(body({{"support:skin", 2}}), InputError);
}

TEST_F(SupportSets, RegionsHaveMaterialsByNameToo) {
  const auto materials = [&](const std::string& name) {
    return body({{name, 9000}}).body->settings().materials;
  };
  EXPECT_EQ(materials("E:core")[0].young, 9000);
  EXPECT_EQ(materials("E:core")[1].young, 5500);
  EXPECT_EQ(materials("E:9")[1].young, 9000);
  EXPECT_TRUE(says(error_of<InputError>([&] { materials("E:cor"); }), "no region cor; it has 7 'core', 9"));
}

TEST(SupportSetsOfNamedMeshes, PointsCountFromOne) {
  const LoadedMesh cube = load_mesh("cube:n=2");
  EXPECT_EQ(union_of_sets({"points:1,27"}, cube), (std::vector<TetMesh::Index>{0, 26}));
  EXPECT_THROW(union_of_sets({"points:0"}, cube), InputError);
  EXPECT_THROW(union_of_sets({"points:28"}, cube), InputError);
}

}  // namespace
}  // namespace hmax
