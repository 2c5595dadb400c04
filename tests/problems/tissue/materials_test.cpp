#include "problems/tissue/materials.hpp"

#include <stdexcept>

#include <gtest/gtest.h>

#include "problems/oscillator/liver_materials.hpp"
#include "tests/problems/tissue/bodies.hpp"
#include "tests/says.hpp"

namespace hmax {
namespace {

TEST(TissueMaterials, HaveThePublishedStiffnessAsAModulusTheMassOfTheOrganAndItsDamping) {
  const TissueSettings s = with_tissue_material({}, "liver:male_normal");
  EXPECT_EQ(s.materials.at(0).young, 5300);
  EXPECT_EQ(s.materials.at(0).poisson, 0.45);
  EXPECT_DOUBLE_EQ(s.total_mass.value(), 1.45);
  EXPECT_DOUBLE_EQ(s.alpha, 6 / 1.45);
  EXPECT_EQ(s.beta, 0);
  EXPECT_DOUBLE_EQ(with_tissue_material({}, "liver:female_fat:light").total_mass.value(), 1.2);
  EXPECT_DOUBLE_EQ(with_tissue_material({}, "liver:female_fat:heavy").alpha, 8 / 1.4);
}

TEST(TissueMaterials, KeepWhatTheyDoNotSay) {
  TissueSettings base;
  base.model = tissue_model("mass_spring");
  base.beta = 0.01;
  base.gravity = {0, 0, -9.81};
  const TissueSettings s = with_tissue_material(base, "liver:male_slim");
  EXPECT_EQ(s.model, tissue_model("mass_spring"));
  EXPECT_EQ(s.beta, 0.01);
  EXPECT_EQ(s.gravity, base.gravity);
}

TEST(TissueMaterials, AFallingBodyIsDampedLikeTheOscillator) {
  const TetMesh mesh = tissue_tests::uneven_box();
  for (const std::string& id : tissue_material_ids()) {
    const TissueBody body(mesh, with_tissue_material({}, id));
    const LiverMaterial& published = liver_material(id.substr(6));
    Eigen::VectorXd v = Eigen::VectorXd::Zero(body.dofs());
    for (Eigen::Index i = 0; i < v.size(); i += 3) v[i] = 2;
    const Eigen::VectorXd f = tissue_tests::force(body, 0, Eigen::VectorXd::Zero(body.dofs()), v);
    EXPECT_NEAR(f.sum(), -2 * published.damping, 1e-10) << id;
    EXPECT_NEAR(body.point_mass().sum(), published.mass_middle(), 1e-13) << id;
  }
}

TEST(TissueMaterials, UnknownNamesAreRefusedWithTheKnownOnes) {
  EXPECT_EQ(tissue_material_ids().size(), 6U);
  for (const char* id : {"male_normal", "liver:", "liver:male", "liver:male_fat:huge", "spleen:male_fat", ""})
    EXPECT_THROW(with_tissue_material({}, id), std::invalid_argument) << id;
  EXPECT_TRUE(says(error_of<std::invalid_argument>([] { with_tissue_material({}, "male_fat"); }),
                   "liver:female_slim"));
}

}  // namespace
}  // namespace hmax
