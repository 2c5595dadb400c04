/// Fibres in finite elements against closed forms. Derivatives, momentum and pieces of bodies with fibres are
/// tested beside those of all models (tests/problems/tissue/body_test.cpp).
#include "problems/tissue/forces/fibres.hpp"

#include <cmath>
#include <stdexcept>
#include <string>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "tests/problems/tissue/bodies.hpp"
#include "tests/says.hpp"

namespace hmax {
namespace {

using namespace tissue_tests;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double E_around = 5000, E_fibres = 20e3;

TissueSettings settings_of(const TissueModel& model, double poisson, const Vector3d& direction,
                           double fibre_young = E_fibres) {
  TissueSettings settings{.model = model};
  settings.materials = {{.young = E_around,
                         .poisson = poisson,
                         .density = 1000,
                         .fibre_young = fibre_young,
                         .fibre_x = direction[0],
                         .fibre_y = direction[1],
                         .fibre_z = direction[2]}};
  return settings;
}

template <class Visit>
void for_finite_elements(const Visit& visit) {
  for (const TissueModel& model : tissue_models())
    if (!model.is_of_springs()) visit(model);
}

VectorXd moved(const TetMesh& mesh, const Matrix3d& F) { return (F * mesh.points - mesh.points).reshaped(); }

double stored(const TissueBody& body, const Matrix3d& F) { return body.energy(0, moved(body.mesh(), F)); }

TEST(Fibres, AddTheirModulusToTheStiffnessAtRestAlongThem) {
  // One strain e along x everywhere: q.K q = V e^2 (lambda + 2 mu + E_f).
  TetMesh box = uneven_box();
  box.regions.clear();
  const double nu = 0.3, longitudinal = E_around * (1 - nu) / ((1 + nu) * (1 - 2 * nu));
  for_finite_elements([&](const TissueModel& model) {
    const TetMesh mesh = mesh_for(model, box);
    for (const double share : {1.0, 0.0}) {  // along them and across
      const TissueBody body(mesh,
                            settings_of(model, nu, share == 1 ? Vector3d(-3, 0, 0) : Vector3d(0, 0.2, 0)));
      const VectorXd rest = VectorXd::Zero(body.dofs());
      VectorXd q = rest;
      for (Eigen::Index i = 0; i < mesh.point_count(); ++i) q[3 * i] = mesh.points(0, i);
      const double volume = body.point_mass().sum() / 1000;
      EXPECT_NEAR(q.dot(stiffness(body, 0, rest, rest) * q) / (volume * (longitudinal + share * E_fibres)), 1,
                  1e-12)
          << model.id;
    }
  });
}

TEST(Fibres, HaveTheEnergyOfTheirStretchAndNoneWhenTheyBuckle) {
  TetMesh box = uneven_box();
  box.regions.clear();
  const Vector3d a(1, -2, 0.5);
  Matrix3d F;
  F << 1.2, 0.05, -0.02, 0.03, 1.1, 0.04, -0.06, 0.02, 1.05;
  const double stretch = (F * a).norm() / a.norm();
  ASSERT_GT(stretch, 1.05);
  for_finite_elements([&](const TissueModel& model) {
    if (model.is_linear) return;
    const TetMesh mesh = mesh_for(model, box);
    const TissueBody bare(mesh, settings_of(model, 0.3, a, 0)), body(mesh, settings_of(model, 0.3, a));
    const double volume = body.point_mass().sum() / 1000, W = E_fibres / 2 * std::pow(stretch - 1, 2);
    EXPECT_NEAR((stored(body, F) - stored(bare, F)) / (volume * W), 1, 1e-10) << model.id;
    const VectorXd taut = body.energy_densities(0, moved(mesh, F)) - bare.energy_densities(0, moved(mesh, F));
    EXPECT_LT((taut.array() - W).abs().maxCoeff(), 1e-10 * W) << model.id;

    const Matrix3d pressed = 0.9 * Matrix3d::Identity();
    const VectorXd q = moved(mesh, pressed), still = VectorXd::Zero(q.size());
    EXPECT_EQ(stored(body, pressed), stored(bare, pressed)) << model.id;
    EXPECT_EQ(force(body, 0, q, still), force(bare, 0, q, still)) << model.id;
    EXPECT_EQ(stiffness(body, 0, q, still), stiffness(bare, 0, q, still)) << model.id;
  });
}

TEST(Fibres, OfSmallStrainPushAsTheyPull) {
  const TetMesh mesh = box_mesh({0.1, 0.1, 0.1}, {1, 1, 1});
  const Vector3d a = Vector3d(1, 1, 0).normalized();
  const TissueModel& model = tissue_model("fem_cauchy");
  const TissueBody bare(mesh, settings_of(model, 0.3, a, 0)), body(mesh, settings_of(model, 0.3, a));
  Matrix3d H;
  H << -0.1, 0.05, 0.3, 0.01, 0.02, 0.1, 0.2, -0.4, 0.3;
  const double strain = a.dot(H * a);
  ASSERT_LT(strain, 0);
  for (const double sign : {1.0, -1.0}) {
    const Matrix3d F = Matrix3d::Identity() + sign * H;
    EXPECT_NEAR(stored(body, F) - stored(bare, F), 1e-3 * E_fibres / 2 * strain * strain, 1e-12);
  }
}

TEST(Fibres, TurnWithTheBody) {
  // Mesh, fibres and displacements turned alike have forces turned alike; a turn of the body alone has none.
  const Matrix3d R = Eigen::AngleAxisd(1.1, Vector3d(1, -0.4, 2).normalized()).toRotationMatrix();
  const Vector3d a(0.3, 1, -2);
  for_finite_elements([&](const TissueModel& model) {
    const TetMesh mesh = uneven_box_for(model);
    TetMesh turned = mesh;
    turned.points = R * mesh.points;
    const TissueBody body(mesh, settings_of(model, 0.3, a)), other(turned, settings_of(model, 0.3, R * a));
    const VectorXd q = random_vector(body.dofs(), 0.004, 5), still = VectorXd::Zero(body.dofs());
    const MatrixXd moved_too = R * q.reshaped(3, q.size() / 3);
    const VectorXd f = force(body, 0, q, still);
    const MatrixXd expected = R * f.reshaped(3, f.size() / 3);
    EXPECT_LT((force(other, 0, moved_too.reshaped(), still) - expected.reshaped()).norm(), 1e-11 * f.norm())
        << model.id;
    if (model.is_linear) return;
    const VectorXd rigid = moved(mesh, R);
    EXPECT_LT(force(body, 0, rigid, still).norm(), 1e-12 * f.norm()) << model.id;
    // And they are as taut as at rest.
    const MatrixXd K = stiffness(body, 0, still, still), there = stiffness(body, 0, rigid, still);
    EXPECT_NEAR(there.trace(), K.trace(), 1e-11 * K.trace()) << model.id;
  });
}

TEST(Fibres, StretchAPulledBarLessAlongThemAndNotAcross) {
  // nu = 0, clamped end: the corotational bar and its fibres both have the nominal stress of their modulus
  // times l - 1, for a large stretch l too: F = (E + E_f) A (l - 1). Across, fibres keep their length.
  const TetMesh mesh = box_mesh({0.1, 0.03, 0.02}, {4, 1, 1});
  const auto end = points_in_box(mesh, {0.1, 0, 0}, {0.1, 1, 1});
  for (const char* model : {"fem_corotational", "fem_cauchy"})
    for (const bool along : {true, false}) {
      const double stretch = 1.3, modulus = along ? E_around + E_fibres : E_around;
      TissueSettings settings =
          settings_of(tissue_model(model), 0, along ? Vector3d(2, 0, 0) : Vector3d(0, 1, 0));
      settings.supports = {{points_in_box(mesh, {0, 0, 0}, {0, 1, 1})}};
      settings.forces = {{end, {modulus * 6e-4 * (stretch - 1), 0, 0}, area_shares(mesh, end)}};
      const TissueBody body(mesh, settings);
      const VectorXd q = equilibrium(body);
      for (std::size_t i = 0; i < body.free_points().size(); ++i) {
        const double x = mesh.points(0, body.free_points()[i]);
        EXPECT_LT((q.segment<3>(3 * static_cast<Eigen::Index>(i)) - Vector3d((stretch - 1) * x, 0, 0)).norm(),
                  1e-10)
            << model;
      }
    }
}

TEST(Fibres, LieInTheirRegionAlone) {
  const TetMesh mesh = uneven_box();
  TissueSettings settings;
  settings.materials = two_materials();
  const TissueBody bare(mesh, settings);
  settings.materials[1].fibre_young = E_fibres;
  settings.materials[1].fibre_x = 1;
  const TissueBody body(mesh, settings);
  const VectorXd q = moved(mesh, Vector3d(1.1, 1, 1).asDiagonal());
  const VectorXd added = body.energy_densities(0, q) - bare.energy_densities(0, q);
  for (Eigen::Index t = 0; t < mesh.tetrahedron_count(); ++t)
    EXPECT_NEAR(added[t], mesh.region(t) == 1 ? E_fibres / 2 * 0.01 : 0, 1e-9);
}

TEST(Fibres, NeedADirectionAndElements) {
  const auto refusal = [](const TissueSettings& settings) -> std::string {
    return error_of<std::invalid_argument>([&] { const TissueBody body(uneven_box(), settings); });
  };
  const TissueModel& green = tissue_model("fem_green");
  EXPECT_TRUE(says(refusal(settings_of(green, 0.3, Vector3d::Zero())), "fibre_x=1"));
  EXPECT_TRUE(says(refusal(settings_of(green, 0.3, Vector3d(1, 0, 0), -5)), "fibre_E is -5"));
  EXPECT_TRUE(
      says(refusal(settings_of(tissue_model("mass_spring"), 0.3, Vector3d(1, 0, 0))), "finite elements"));
  EXPECT_EQ(refusal(settings_of(green, 0.3, Vector3d::Zero(), 0)), "");
}

}  // namespace
}  // namespace hmax
