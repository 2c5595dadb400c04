/// Tissues as studies have measured them, of bodies and of regions.
#include <gtest/gtest.h>

#include "catalogue/models/problems.hpp"
#include "core/errors.hpp"
#include "problems/tissue/body.hpp"
#include "problems/tissue/materials.hpp"
#include "tests/results/scratch.hpp"
#include "tests/says.hpp"

namespace hmax {
namespace {

/// Two tetrahedra of the regions 1 and 2 on a common face.
constexpr const char* two_regions =
    "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n"
    "$Nodes\n5\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 1 1 1\n$EndNodes\n"
    "$Elements\n2\n1 4 2 1 1 1 2 3 4\n2 4 2 2 2 2 3 4 5\n$EndElements\n";

class PublishedTissueOf : public ::testing::Test {
 protected:
  PublishedTissueOf() { write_text(folder / "two.msh", two_regions); }

  Problem body(const std::string& text, Parameters parameters = {},
               const std::string& model = "fem_green") const {
    // One point is fixed, so that the other tetrahedron is free.
    if (parameters.empty()) parameters = {{"support:points:1", 1}};
    return make_problem(model + "@" + (folder / "two.msh").string(),
                        {.material = text, .parameters = std::move(parameters), .unit = 0.1});
  }
  std::vector<TissueMaterial> materials(const std::string& text, Parameters parameters = {}) const {
    return body(text, std::move(parameters)).body->settings().materials;
  }
  std::string refused(const std::string& text) const {
    return error_of<InputError>([&] { materials(text); });
  }

  const Scratch folder;
};

// [arda2011quantitative] and [samani2007elastic], by hand.
TEST_F(PublishedTissueOf, IsThatOfTheWholeBodyOrOfARegion) {
  for (const TissueMaterial& each : materials("tissue:muscle")) {
    EXPECT_EQ(each.young, 11100);
    EXPECT_EQ(each.density, 1050);
  }
  const auto two = materials("tissue:fat,2=tissue:carcinoma");
  ASSERT_EQ(two.size(), 2U);
  EXPECT_EQ(two[0].young, 3250);
  EXPECT_EQ(two[0].density, 950);
  EXPECT_EQ(two[1].young, 19990);
  EXPECT_EQ(two[1].density, 1020);
  // The rest of the body keeps its own.
  EXPECT_EQ(materials("1=tissue:spleen")[1].young, TissueMaterial{}.young);
}

TEST_F(PublishedTissueOf, IsOverriddenByParameters) {
  const auto two = materials("tissue:fat,2=tissue:carcinoma", {{"E:2", 1000}, {"rho", 1000}});
  EXPECT_EQ(two[1].young, 1000);
  EXPECT_EQ(two[1].density, 1020);
  EXPECT_EQ(two[0].density, 1000);
}

TEST_F(PublishedTissueOf, IsOverriddenByTheNumberOfANamedRegion) {
  const std::string header = "$EndMeshFormat\n";
  std::string text = two_regions;
  text.insert(text.find(header) + header.size(), "$PhysicalNames\n1\n3 2 \"tumour\"\n$EndPhysicalNames\n");
  const std::string file = (folder / "named.msh").string();
  write_text(file, text);
  const auto made = [&](Parameters parameters, const std::string& material) {
    return make_problem("fem_green@" + file,
                        {.material = material, .parameters = std::move(parameters), .unit = 0.1});
  };
  const Problem problem =
      made({{"support:points:1", 1}, {"E:2", 1000}}, "tissue:fat,tumour=tissue:carcinoma");
  EXPECT_EQ(problem.body->settings().materials[1].young, 1000);
  EXPECT_EQ(problem.body->settings().materials[1].density, 1020);
  // What is listed makes the same body.
  EXPECT_EQ(made(problem.parameters, {}).body->settings().materials[1].young, 1000);
  EXPECT_THROW(made({{"E:2", 1000}, {"E:tumour", 2000}}, {}), InputError) << "twice by the user";
}

TEST_F(PublishedTissueOf, OfARegionStandsBesideALiverOfTheStudy) {
  const Problem problem = body("liver:male_normal,2=tissue:fibroadenoma");
  EXPECT_EQ(problem.body->settings().materials[1].young, 6410);
  EXPECT_NEAR(problem.body->point_mass().sum(), 1.45, 1e-12);
  // What is listed of a body makes it again.
  const Problem again = body({}, problem.parameters);
  EXPECT_EQ(again.body->settings().materials[1].young, 6410);
}

TEST_F(PublishedTissueOf, IsRefusedWithTheNearestName) {
  EXPECT_TRUE(says(refused("tissue:muscel"), "tissue:muscle"));
  EXPECT_TRUE(says(refused("2=tissue:bone"), "of the region 2"));
  EXPECT_TRUE(says(refused("9=tissue:fat"), "has no region 9"));
  EXPECT_TRUE(says(refused("tissue:fat,tissue:skin"), "two materials of the whole body"));
  EXPECT_TRUE(says(refused("2=tissue:fat,2=tissue:skin"), "two materials of the region 2"));
  EXPECT_TRUE(says(refused("muscle"), "did you mean tissue:muscle?"));
}

TEST_F(PublishedTissueOf, IsReadWithBlanksAndRefusedWithEmptyParts) {
  EXPECT_EQ(materials("tissue:fat, 2 = tissue:carcinoma")[1].young, materials("2=tissue:carcinoma")[1].young);
  for (const char* text : {"tissue:fat,", ",", "=tissue:skin", "2=", "tissue:fat,,2=tissue:skin"})
    EXPECT_TRUE(says(refused(text), "has an empty part")) << text;
}

TEST(PublishedTissue, HasTheMeanAndTheDeviationOfItsStudy) {
  const auto expect = [](std::string_view id, double mean, double deviation) {
    const PublishedTissue* tissue = find_published_tissue(id);
    ASSERT_TRUE(tissue) << id;
    EXPECT_NEAR(tissue->material.young / mean, 1, 0.005) << id;
    EXPECT_NEAR(tissue->young_low / (mean - deviation), 1, 0.005) << id;
    EXPECT_NEAR(tissue->young_high / (mean + deviation), 1, 0.005) << id;
  };
  expect("tissue:liver", 5490, 1590);
  expect("tissue:muscle", 11100, 4100);
  expect("tissue:brain_grey", 1389, 289);
  expect("tissue:brain_white", 1895, 592);
  expect("tissue:tendon", 1.16e9, 0.15e9);
}

TEST(PublishedTissue, HasARangeAroundItsModulus) {
  for (const PublishedTissue& tissue : published_tissues()) {
    EXPECT_LE(tissue.young_low, tissue.material.young) << tissue.id;
    EXPECT_GE(tissue.young_high, tissue.material.young) << tissue.id;
    EXPECT_LT(tissue.young_low, tissue.young_high) << tissue.id;
  }
}

}  // namespace
}  // namespace hmax
