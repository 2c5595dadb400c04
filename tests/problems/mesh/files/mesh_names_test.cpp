#include "problems/mesh/files/mesh_names.hpp"

#include <stdexcept>

#include <gtest/gtest.h>

#include "tests/problems/mesh/meshes.hpp"
#include "tests/says.hpp"

namespace hmax {
namespace {

std::string refusal_of_name(std::string_view text) {
  return error_of<std::invalid_argument>([&] { mesh_by_name(text); });
}

TEST(MeshNames, EveryNameIsAValidMeshInMetresOfOneRegion) {
  EXPECT_EQ(named_meshes().size(), 5U);
  for (const NamedMesh& named : named_meshes()) {
    const TetMesh mesh = mesh_by_name(named.name);
    EXPECT_TRUE(all_positive(mesh)) << named.name;
    EXPECT_TRUE(mesh.regions.empty()) << named.name;
    EXPECT_EQ(topology_of(mesh).euler(), 1) << named.name;
    const MeshQuality quality = quality_of(mesh);
    const double size = (quality.upper - quality.lower).maxCoeff();
    EXPECT_GT(size, 0.05) << named.name;
    EXPECT_LT(size, 0.3) << named.name;
  }
}

TEST(MeshNames, TheMeshesOfTheStudyNeedNoFile) {
  EXPECT_EQ(mesh_by_name("phantom").tetrahedron_count(), 120);
  EXPECT_EQ(mesh_by_name("liver").tetrahedron_count(), 1151);
  EXPECT_EQ(mesh_by_name("liver:refine=2").tetrahedron_count(), 64 * 1151);
}

TEST(MeshNames, GeneratorsTakeTheirParameters) {
  EXPECT_EQ(mesh_by_name("ball:n=6").tetrahedron_count(), 20 * 216);
  EXPECT_EQ(mesh_by_name("ball:n=1:refine=1").tetrahedron_count(), 160);
  EXPECT_EQ(mesh_by_name("beam").tetrahedron_count(), 24 * 64);
  EXPECT_NEAR(quality_of(mesh_by_name("cube:edge=2:n=1")).volume, 8, 1e-12);
  EXPECT_EQ(quality_of(mesh_by_name("beam:n=1,length=3:height=0.5")).upper, Eigen::Vector3d(3, 0.05, 0.5));
}

TEST(MeshNames, AreMendedAfterTheyAreRefined) {
  const TetMesh fine = mesh_by_name("ball:n=2:refine=1"), both = mesh_by_name("ball:mend=8:n=2:refine=1");
  EXPECT_EQ(both.tetrahedra, fine.tetrahedra);
  EXPECT_NE(both.points, fine.points);
  EXPECT_EQ(both.points, mended(fine, 8).mesh.points);
  EXPECT_EQ(mesh_by_name("ball:n=2:mend=0").points, mesh_by_name("ball:n=2").points);
  // More than there are: until nothing gains.
  EXPECT_TRUE(all_positive(mesh_by_name("ball:n=1:mend=1e12")));
  EXPECT_TRUE(says(refusal_of_name("liver:mend=2.5"),
                   "the parameter mend of the mesh liver is 2.5; give a whole number from 0 on"));
}

TEST(MeshNames, WhatIsUnknownIsRefusedWithWhatIsKnown) {
  EXPECT_TRUE(says(refusal_of_name("kidney"), "known are liver, phantom, beam, cube, ball"));
  EXPECT_TRUE(says(refusal_of_name("ball:m=3"), "no parameter 'm'; it takes refine, mend, merge, n, radius"));
  EXPECT_TRUE(says(refusal_of_name("liver:n=3"), "it takes refine, mend, merge"));
  EXPECT_TRUE(says(refusal_of_name("ball:n=2,radius=x"), "no number"));
  EXPECT_TRUE(says(refusal_of_name("ball:n=2:n=3"), "twice"));
  for (const char* text : {"ball:n=0", "ball:n=1.5", "ball:n=-1", "ball:n=1e9", "ball:n=inf",
                           "ball:n=", "ball:n=2,,", "ball:n=2,radius", "liver:refine=-1", "liver:refine=30",
                           "liver:mend=-1", "liver:mend=2.5", "cube:edge=0", "ball:merge=0.5",
                           "ball:merge=-0.1", "ball:merge=on", "ball:refine=off", ":refine=1", ""})
    EXPECT_NE(refusal_of_name(text), "") << text;
}

TEST(MeshNames, PointsAreMergedWithinAShareOfAnEdgeOrNotAtAll) {
  EXPECT_FALSE(modifiers_of(parse_mesh_request("ball")).merge.has_value());
  EXPECT_EQ(modifiers_of(parse_mesh_request("ball:merge=1e-3")).merge, 1e-3);
  EXPECT_EQ(modifiers_of(parse_mesh_request("a.vtu:merge=off:refine=1")).merge, merge_off);
}

TEST(MeshNames, ARequestKeepsOtherColonsInTheName) {
  const MeshRequest request = parse_mesh_request("C:/a:b=c/liver.msh:refine=2");
  EXPECT_EQ(request.name, "C:/a:b=c/liver.msh");
  EXPECT_EQ(modifiers_of(request).refine, 2);
  EXPECT_EQ(modifiers_of(request).mend, 0);
  EXPECT_EQ(parse_mesh_request("plain.msh").name, "plain.msh");
}

}  // namespace
}  // namespace hmax
