#include "catalogue/models/mesh_choice.hpp"

#include <gtest/gtest.h>

#include "catalogue/models/tissue_problem.hpp"
#include "core/errors.hpp"
#include "problems/mesh/files/mesh_writers.hpp"
#include "problems/mesh/mesh_quality.hpp"
#include "problems/mesh/refine.hpp"
#include "problems/mesh/topology.hpp"
#include "tests/results/scratch.hpp"
#include "tests/says.hpp"

namespace hmax {
namespace {

std::string refusal_of_mesh(const std::string& text, std::optional<double> unit = {}) {
  return error_of<InputError>([&] { load_mesh(text, unit); });
}

TEST(MeshChoice, ASmallMeshByNameKeepsItsOrder) {
  const LoadedMesh loaded = load_mesh("liver");
  EXPECT_TRUE(loaded.origin->file.mesh.points == loaded.mesh.points);
  EXPECT_TRUE(loaded.origin->file.mesh.tetrahedra == loaded.mesh.tetrahedra);
  EXPECT_EQ(loaded.origin->tetrahedron_number(0), 1);
}

TEST(MeshChoice, ALargeMeshByNameIsRenumberedAndKnowsTheWayBack) {
  const TetMesh original = mesh_by_name("liver:refine=1");
  const LoadedMesh loaded = load_mesh("liver:refine=1");
  ASSERT_EQ(loaded.mesh.tetrahedron_count(), 8 * 1151);
  EXPECT_FALSE(loaded.mesh.points == original.points);
  EXPECT_TRUE(loaded.origin->file.mesh.points == original.points);
  EXPECT_TRUE(loaded.origin->on_points(loaded.mesh.points) == original.points);
  // Ends of edges in memory: a third of the points apart in the order of the refinement.
  const auto spread = [](const TetMesh& mesh) {
    return (mesh.tetrahedra.colwise().maxCoeff() - mesh.tetrahedra.colwise().minCoeff()).maxCoeff();
  };
  EXPECT_LT(3 * spread(loaded.mesh), spread(original));
}

TEST(MeshChoice, ANameIsInMetresAndTakesNoOtherUnit) {
  EXPECT_TRUE(says(refusal_of_mesh("liver", 0.01), "leave the unit out"));
  EXPECT_EQ(refusal_of_mesh("liver", unit_in_metres("m")), "");
}

TEST(MeshChoice, AFileIsAskedForItsUnitWithTheSizeOfItsBox) {
  const Scratch folder;
  const std::string file = (folder / "ball.msh").string();
  write_text(file, msh_text(mesh_by_name("ball:n=2:radius=50")));
  const std::string sentence = refusal_of_mesh(file);
  EXPECT_TRUE(says(sentence, "does not say its unit, and a body of 100 x 100 x 100 could be anything"));
  EXPECT_TRUE(says(sentence, "--unit m, cm, mm"));
  const LoadedMesh loaded = load_mesh(file, unit_in_metres("mm"));
  EXPECT_NEAR(quality_of(loaded.mesh).upper(0), 0.05, 0.002);
  const TetMesh original = mesh_by_name("ball:n=2:radius=50");
  EXPECT_TRUE(loaded.origin->on_points(loaded.mesh.points).isApprox(0.001 * original.points));
  EXPECT_EQ(loaded.origin->on_points(loaded.mesh.points), loaded.origin->file.mesh.points);
}

TEST(MeshChoice, AFileIsRefinedAsANameIs) {
  const Scratch folder;
  const std::string file = (folder / "a.msh").string();
  write_text(file, msh_text(mesh_by_name("cube:n=2")));
  const LoadedMesh loaded = load_mesh(file + ":refine=2", 1);
  EXPECT_EQ(loaded.mesh.tetrahedron_count(), 64 * 48);
  EXPECT_EQ(loaded.origin->file.mesh.tetrahedra, refined(mesh_by_name("cube:n=2"), 2).tetrahedra);
  EXPECT_TRUE(says(refusal_of_mesh(file + ":n=2", 1), "takes refine, mend and merge only"));
}

TEST(MeshChoice, AFileIsMendedAsANameIs) {
  const Scratch folder;
  const std::string file = (folder / "a.msh").string();
  write_text(file, msh_text(mesh_by_name("ball:n=2:radius=50")));
  const OpenedMesh opened = open_mesh(file + ":mend=8:refine=1");
  ASSERT_TRUE(opened.mending.has_value());
  EXPECT_FALSE(opened.mending->moved.empty());
  EXPECT_GT(opened.mending->farthest, 0);
  EXPECT_GE(opened.mending->least_mean_height_after, opened.mending->least_mean_height_before);
  const TetMesh fine = open_mesh(file + ":refine=1").file.mesh;
  EXPECT_EQ(opened.file.mesh.points, mended(fine, 8).mesh.points);
  EXPECT_EQ(opened.file.mesh.tetrahedra, fine.tetrahedra);
  EXPECT_FALSE(open_mesh(file + ":mend=0").mending.has_value());
  EXPECT_EQ(load_mesh(file + ":mend=8", 0.001).mesh.tetrahedron_count(), 160);
  EXPECT_TRUE(says(refusal_of_mesh(file + ":mend=0.5", 1), "give a whole number from 0 on"));
}

TEST(MeshChoice, IdlePointsOfAFileAreLeftOutAndCounted) {
  const Scratch folder;
  TetMesh mesh = mesh_by_name("cube:n=1");
  mesh.points.conservativeResize(3, 10);
  mesh.points.rightCols(2).setConstant(7);
  write_text(folder / "a.msh", msh_text(mesh));
  const LoadedMesh loaded = load_mesh((folder / "a.msh").string(), 1);
  EXPECT_EQ(loaded.origin->file.mesh.point_count(), 10);
  EXPECT_EQ(loaded.mesh.point_count(), 8);
}

TEST(MeshChoice, AMistypedNameIsAnsweredWithTheNearest) {
  EXPECT_TRUE(says(refusal_of_mesh("livr"), "did you mean 'liver'?"));
  EXPECT_TRUE(says(refusal_of_mesh(""), "no mesh is given"));
  EXPECT_TRUE(says(refusal_of_mesh("none.msh"), "there is no file 'none.msh'"));
  EXPECT_TRUE(says(refusal_of_mesh("ball:n=0"), "whole number from 1 to 170"));
}

TEST(MeshChoice, WhatModelsCannotUseIsRefused) {
  const Scratch folder;
  TetMesh mesh = mesh_by_name("cube:n=1");
  std::swap(mesh.tetrahedra(0, 3), mesh.tetrahedra(1, 3));
  write_text(folder / "a.msh", msh_text(mesh));
  for (const char* modifier : {"", ":mend=1"})
    EXPECT_TRUE(says(refusal_of_mesh((folder / "a.msh").string() + modifier, 1),
                     "tetrahedron 4 is inverted; turn it with"));
}

TEST(MeshChoice, KnowsACoarserMesh) {
  EXPECT_EQ(coarser_mesh("ball:n=6"), "ball:n=3");
  EXPECT_EQ(coarser_mesh("cube"), "cube:n=2");
  EXPECT_EQ(coarser_mesh("liver"), "");
  EXPECT_EQ(coarser_mesh("liver:refine=1"), "liver");
  EXPECT_EQ(coarser_mesh("ball:n=6:refine=2"), "ball:n=6:refine=1");
  EXPECT_EQ(coarser_mesh("liver:mend=5"), "");
  EXPECT_EQ(coarser_mesh("liver:mend=5:refine=1"), "liver:mend=5");
  EXPECT_EQ(coarser_mesh("ball:mend=5:n=6"), "ball:mend=5:n=3");
  EXPECT_EQ(coarser_mesh("cube:n=1"), "");
  for (const char* text : {"ball:n=6,radius=0.04", "cube:n=8:refine=1"})
    EXPECT_NO_THROW(load_mesh(coarser_mesh(text)));
}

TEST(MeshChoice, UnitsAreNamesOrMetres) {
  EXPECT_EQ(unit_in_metres("m"), 1);
  EXPECT_EQ(unit_in_metres("cm"), 0.01);
  EXPECT_EQ(unit_in_metres("mm"), 0.001);
  EXPECT_EQ(unit_in_metres("0.0254"), 0.0254);
  for (const char* text : {"km", "0", "-1", "inf", "nan", "", "1,5"})
    EXPECT_THROW(unit_in_metres(text), InputError) << text;
}

}  // namespace
}  // namespace hmax
