#include "problems/tissue/body.hpp"

#include <cmath>
#include <limits>
#include <stdexcept>

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include "integrators/system.hpp"
#include "tests/problems/tissue/bodies.hpp"

namespace hmax {
namespace {

using namespace tissue_tests;
using Eigen::MatrixXd;
using Eigen::VectorXd;

static_assert(SecondOrderSystem<TissueBody>);
static_assert(BoundedSpectrumSystem<TissueBody>);

/// Displacements of up to 8 % of an edge, velocities, and a moment at which everything moves.
struct Moment {
  explicit Moment(const TissueBody& body)
      : q(random_vector(body.dofs(), 0.004, 1)), v(random_vector(body.dofs(), 0.2, 2)) {}
  double t = 0.8;
  VectorXd q, v;
};

double largest(const MatrixXd& A) { return A.cwiseAbs().maxCoeff(); }

TEST(TissueBody, ForceIsTheGradientOfTheEnergyForEveryModelAndLoad) {
  for (auto [name, settings] : loaded_settings()) {
    const TetMesh mesh = uneven_box_for(settings.model);
    const TissueBody body(mesh, settings);
    const Moment at(body);
    // At rest: the velocities of supports and tool, which the dampers feel, are left out.
    settings.alpha = settings.beta = settings.springs.damper = settings.springs.damper_time = 0;
    settings.tools[0].damping = 0;
    const TissueBody elastic(mesh, settings);
    const VectorXd f = force(elastic, at.t, at.q, VectorXd::Zero(body.dofs()));
    for (Eigen::Index j = 0; j < body.dofs(); ++j) {
      const VectorXd slope = difference(
          [&](const VectorXd& q) { return VectorXd::Constant(1, elastic.energy(at.t, q)); }, at.q, j, 1e-6);
      EXPECT_NEAR(-slope[0], f[j], 1e-7 * largest(f)) << name << ", dof " << j;
    }
  }
}

TEST(TissueBody, StiffnessAndDampingAreTheDerivativesOfTheForceForEveryModelAndLoad) {
  for (const auto& [name, settings] : loaded_settings()) {
    const TetMesh mesh = uneven_box_for(settings.model);
    const TissueBody body(mesh, settings);
    const Moment at(body);
    const MatrixXd K = stiffness(body, at.t, at.q, at.v), C = damping(body, at.t, at.q, at.v);
    for (Eigen::Index j = 0; j < body.dofs(); ++j) {
      const VectorXd k =
          difference([&](const VectorXd& q) { return force(body, at.t, q, at.v); }, at.q, j, 1e-6);
      const VectorXd c =
          difference([&](const VectorXd& v) { return force(body, at.t, at.q, v); }, at.v, j, 1e-3);
      EXPECT_LT(largest(k + K.col(j)), 1e-7 * largest(K)) << name << ", dof " << j;
      EXPECT_LT(largest(c + C.col(j)), 1e-7 * largest(C)) << name << ", dof " << j;
    }
    EXPECT_LT(largest(C - C.transpose()), 1e-14 * largest(C)) << name;
    EXPECT_FALSE(body.has_symmetric_stiffness()) << name;
    EXPECT_FALSE(body.is_autonomous()) << name;
  }
}

TEST(TissueBody, TheRightHandSideIsTheForceOverTheMass) {
  const TetMesh mesh = uneven_box();
  const TissueBody body(mesh, loaded_settings().front().settings);
  const Moment at(body);
  VectorXd y(body.dim()), dydt(body.dim());
  y << at.q, at.v;
  body.rhs(at.t, y, dydt);
  EXPECT_EQ(dydt.head(body.dofs()), at.v);
  EXPECT_EQ(dydt.tail(body.dofs()), force(body, at.t, at.q, at.v).cwiseQuotient(body.mass()));
}

TEST(TissueBody, StiffnessAndDampingKeepOnePatternAndItsMemory) {
  const TetMesh mesh = uneven_box();
  const TissueBody body(mesh, loaded_settings().front().settings);
  const Moment at(body);
  Eigen::SparseMatrix<double> K, C;
  body.stiffness(at.t, at.q, at.v, K);
  body.damping(at.t, at.q, at.v, C);
  ASSERT_EQ(K.nonZeros(), C.nonZeros());
  for (Eigen::Index i = 0; i < K.nonZeros(); ++i) ASSERT_EQ(K.innerIndexPtr()[i], C.innerIndexPtr()[i]);
  const double* before = K.valuePtr();
  const MatrixXd first = K;
  body.stiffness(at.t, 2 * at.q, at.v, K);
  body.stiffness(at.t, at.q, at.v, K);
  EXPECT_EQ(K.valuePtr(), before);
  EXPECT_EQ(first, MatrixXd(K));
  // A matrix of another pattern is given the right one.
  Eigen::SparseMatrix<double> other(K.rows(), K.cols());
  other.setIdentity();
  body.stiffness(at.t, at.q, at.v, other);
  EXPECT_EQ(first, MatrixXd(other));
}

TEST(TissueBody, AFreeBodyHasSixRigidModesAndASymmetricStiffness) {
  for (const auto& [name, settings] : elastic_settings()) {
    const TetMesh mesh = uneven_box_for(settings.model);
    const TissueBody body(mesh, settings);
    const VectorXd rest = VectorXd::Zero(body.dofs());
    const MatrixXd K = stiffness(body, 0, rest, rest);
    EXPECT_LT(largest(K - K.transpose()), 1e-14 * largest(K)) << name;
    EXPECT_TRUE(body.has_symmetric_stiffness());
    const VectorXd omega2 = Eigen::SelfAdjointEigenSolver<MatrixXd>(K, Eigen::EigenvaluesOnly).eigenvalues();
    EXPECT_LT(std::abs(omega2[0]), 1e-12 * omega2.maxCoeff()) << name;
    EXPECT_LT(std::abs(omega2[5]), 1e-12 * omega2.maxCoeff()) << name;
    EXPECT_GT(omega2[6], 1e-6 * omega2.maxCoeff()) << name;
    MatrixXd deformed = stiffness(body, 0, random_vector(body.dofs(), 0.004, 3), rest);
    EXPECT_LT(largest(deformed - deformed.transpose()), 1e-13 * largest(deformed)) << name;
  }
}

TEST(TissueBody, ARigidMotionMeetsNoForce) {
  const Eigen::Matrix3d R =
      Eigen::AngleAxisd(2.1, Eigen::Vector3d(1, -2, 0.5).normalized()).toRotationMatrix();
  for (const auto& [name, settings] : elastic_settings()) {
    const TetMesh mesh = uneven_box_for(settings.model);
    const TissueBody body(mesh, settings);
    const Eigen::Matrix3Xd moved = (R * mesh.points).colwise() + Eigen::Vector3d(0.3, -0.1, 0.2);
    const VectorXd q = (moved - mesh.points).reshaped(), rest = VectorXd::Zero(body.dofs());
    // Against the force of a strain of order one.
    const double scale = largest(stiffness(body, 0, rest, rest)) * 0.05;
    if (settings.model.is_linear) {
      EXPECT_GT(largest(force(body, 0, q, rest)), 0.1 * scale);
    } else {
      EXPECT_LT(largest(force(body, 0, q, rest)), 1e-12 * scale) << name;
    }
    EXPECT_LT(largest(force(body, 0, rest, rest)), 1e-12 * scale) << name;
    EXPECT_NEAR(body.energy(0, rest), 0, 1e-12 * scale * 0.1) << name;
  }
}

TEST(TissueBody, InternalForcesKeepMomentumAndAngularMomentum) {
  for (auto [name, settings] : elastic_settings()) {
    const TetMesh mesh = uneven_box_for(settings.model);
    settings.springs.damper = 0.4;
    const TissueBody body(mesh, settings);
    const Moment at(body);
    const VectorXd f = force(body, 0, at.q, at.v);
    const Eigen::Matrix3Xd rows = f.reshaped(3, f.size() / 3), x = body.positions(0, at.q);
    EXPECT_LT(rows.rowwise().sum().norm(), 1e-13 * f.cwiseAbs().sum()) << name;
    Eigen::Vector3d torque = Eigen::Vector3d::Zero();
    for (Eigen::Index i = 0; i < x.cols(); ++i)
      torque += Eigen::Vector3d(x.col(i)).cross(Eigen::Vector3d(rows.col(i)));
    if (!settings.model.is_linear) {
      EXPECT_LT(torque.norm(), 1e-13 * f.cwiseAbs().sum()) << name;
    }
  }
}

TEST(TissueBody, SmallStrainsAreTheSameInAllFiniteElements) {
  const TetMesh mesh = uneven_box();
  TissueSettings settings;
  settings.materials = two_materials();
  settings.model = tissue_model("fem_cauchy");
  const TissueBody linear(mesh, settings);
  const VectorXd rest = VectorXd::Zero(linear.dofs());
  const MatrixXd K = stiffness(linear, 0, rest, rest);
  for (const TissueModel& model :
       {tissue_model("fem_green"), tissue_model("fem_corotational"), tissue_model("fem_neo_hookean")}) {
    settings.model = model;
    EXPECT_LT(largest(stiffness(TissueBody(mesh, settings), 0, rest, rest) - K), 1e-13 * largest(K));
  }
}

TEST(TissueBody, AveragedPressuresChangeNothingWhereNoVolumePushesAcross) {
  // With lambda = 0 there is nothing to average, and a negative one stays with the elements.
  const TetMesh mesh = uneven_box();
  TissueSettings settings;
  for (const double nu : {0.0, -0.3}) {
    settings.materials = {{5300, nu, 1060}};
    settings.model = tissue_model("fem_neo_hookean");
    const TissueBody alone(mesh, settings);
    settings.model = tissue_model("fem_nodal_pressure");
    const TissueBody averaged(mesh, settings);
    const Moment at(alone);
    EXPECT_LT(largest(stiffness(averaged, 0, at.q, at.v) - stiffness(alone, 0, at.q, at.v)),
              1e-13 * largest(stiffness(alone, 0, at.q, at.v)));
  }
}

TEST(TissueBody, TheElementsAtRestSumToTheStiffnessAtRest) {
  for (auto [name, settings] : elastic_settings()) {
    const TetMesh mesh = uneven_box_for(settings.model);
    settings.supports = {{points_in_box(mesh, {-1, -1, -1}, {0.01, 1, 1})}};
    settings.elastic_supports = {{{0, 9, 20}, {7, 40, 300}}};
    const TissueBody body(mesh, settings);
    const VectorXd rest = VectorXd::Zero(body.dofs());
    MatrixXd all = MatrixXd::Zero(3 * mesh.point_count(), 3 * mesh.point_count());
    body.visit_rest_stiffness(
        [&](std::span<const TetMesh::Index> points, const Eigen::Ref<const MatrixXd>& K) {
          for (std::size_t a = 0; a < points.size(); ++a)
            for (std::size_t b = 0; b < points.size(); ++b)
              all.block<3, 3>(3 * points[a], 3 * points[b]) +=
                  K.block<3, 3>(3 * static_cast<Eigen::Index>(a), 3 * static_cast<Eigen::Index>(b));
        });
    std::vector<Eigen::Index> kept;
    for (const auto point : body.free_points())
      for (int r = 0; r < 3; ++r) kept.push_back(3 * point + r);
    const MatrixXd K = stiffness(body, 0, rest, rest);
    EXPECT_LT(largest(all(kept, kept) - K), 1e-13 * largest(K)) << name;
  }
}

TEST(TissueBody, TheBoundOfTheSpectrumHolds) {
  for (auto [name, settings] : loaded_settings()) {
    const TetMesh mesh = uneven_box_for(settings.model);
    const TissueBody body(mesh, settings);
    const Moment at(body);
    const Eigen::Index n = body.dofs();
    MatrixXd J = MatrixXd::Zero(2 * n, 2 * n);
    J.topRightCorner(n, n).setIdentity();
    const VectorXd per_mass = -body.mass().cwiseInverse();
    J.bottomLeftCorner(n, n) = per_mass.asDiagonal() * stiffness(body, at.t, at.q, at.v);
    J.bottomRightCorner(n, n) = per_mass.asDiagonal() * damping(body, at.t, at.q, at.v);
    const double exact = J.eigenvalues().cwiseAbs().maxCoeff();
    VectorXd y(2 * n);
    y << at.q, at.v;
    EXPECT_GE(body.spectral_radius(at.t, y), exact) << name;
    EXPECT_LT(body.spectral_radius(at.t, y), 5 * exact) << name;
  }
}

TEST(TissueBody, MassIsThatOfTheMaterialsOrAsGiven) {
  const TetMesh mesh = box_mesh({0.2, 0.1, 0.1}, {4, 2, 2});
  TissueSettings settings;
  settings.materials = {{5000, 0.45, 1100}};
  EXPECT_NEAR(TissueBody(mesh, settings).point_mass().sum(), 2.2, 1e-13);
  settings.total_mass = 1.5;
  EXPECT_NEAR(TissueBody(mesh, settings).point_mass().sum(), 1.5, 1e-14);
  settings.equal_masses = true;
  const TissueBody body(mesh, settings);
  EXPECT_NEAR(body.mass().minCoeff(), 1.5 / 45, 1e-15);
  EXPECT_NEAR(body.mass().maxCoeff(), 1.5 / 45, 1e-15);
  EXPECT_NEAR(body.kinetic_energy(VectorXd::Ones(body.dofs())), 1.5 * 3 / 2, 1e-13);
}

TEST(TissueBody, RaisedMassesAllowTheStepAndHaveNoWeight) {
  for (const char* model : {"fem_green", "fem_quadratic"}) {
    SCOPED_TRACE(model);
    TissueSettings settings{.model = tissue_model(model), .materials = two_materials()};
    const TetMesh mesh = uneven_box_for(settings.model);
    settings.gravity = {0, 0, -9.81};
    settings.supports = {{points_in_box(mesh, {-1, -1, -1}, {0.01, 1, 1})}};
    const TissueBody before(mesh, settings);
    const VectorXd rest = VectorXd::Zero(before.dofs());
    const auto largest_step = [&](const TissueBody& body) {
      const VectorXd roots = body.mass().cwiseSqrt().cwiseInverse();
      const MatrixXd scaled = roots.asDiagonal() * stiffness(body, 0, rest, rest) * roots.asDiagonal();
      return 2 / std::sqrt(Eigen::SelfAdjointEigenSolver<MatrixXd>(scaled, Eigen::EigenvaluesOnly)
                               .eigenvalues()
                               .maxCoeff());
    };
    settings.mass_step = 2 * largest_step(before);
    const TissueBody after(mesh, settings);
    EXPECT_GE(largest_step(after), settings.mass_step);
    EXPECT_LT(largest_step(after), 2 * settings.mass_step);
    EXPECT_GT(after.added_mass().sum(), 0);
    EXPECT_EQ(before.added_mass().sum(), 0);
    EXPECT_EQ(force(after, 0, rest, rest), force(before, 0, rest, rest));
    settings.mass_step = -1;
    EXPECT_THROW(TissueBody(mesh, settings), std::invalid_argument);
  }
}

TEST(SampledCurve, HasAHarmonicMeanOfItsSecantsAsSlope) {
  // Secants 2 and 1/2 over widths 1 and 2: 3 (1 + 2) / ((2 * 2 + 1) / 2 + (2 + 2 * 1) / (1/2)) = 6/7.
  const SampledCurve curve({0, 1, 3}, {0, 2, 3});
  EXPECT_NEAR(curve.rate(1), 6.0 / 7, 1e-14);
  // Half way between flat and that: (0 + 2) / 2 - 1 * (6/7) / 8.
  EXPECT_NEAR(curve.value(0.5), 1 - 6.0 / 56, 1e-14);
}

TEST(SampledCurve, MeetsItsValuesSmoothlyAndDoesNotOvershoot) {
  const std::vector<double> t{0, 0.1, 0.4, 0.5, 0.9}, v{0, 1, 1.5, 1.5, -2};
  const SampledCurve curve(t, v);
  for (std::size_t i = 0; i < t.size(); ++i) EXPECT_NEAR(curve.value(t[i]), v[i], 1e-15) << i;
  EXPECT_EQ(curve.value(-1), 0);
  EXPECT_EQ(curve.value(7), -2);
  EXPECT_EQ(curve.rate(7), 0);
  for (double at = 0.005; at < 0.9; at += 0.01) {
    EXPECT_NEAR(curve.rate(at), (curve.value(at + 1e-6) - curve.value(at - 1e-6)) / 2e-6, 1e-5) << at;
    EXPECT_LE(curve.value(at), 1.5 + 1e-15) << at;
    EXPECT_GE(curve.value(at), -2) << at;
  }
  for (const double knot : t) EXPECT_NEAR(curve.rate(knot - 1e-9), curve.rate(knot + 1e-9), 1e-5) << knot;
  EXPECT_THROW(SampledCurve({0}, {1}), std::invalid_argument);
  EXPECT_THROW(SampledCurve({0, 0}, {1, 1}), std::invalid_argument);
  EXPECT_THROW(SampledCurve({0, 1}, {1, std::nan("")}), std::invalid_argument);
}

TEST(TissueBody, SupportsOfTheSamePointsAddUp) {
  const TetMesh mesh = box_mesh({0.2, 0.1, 0.1}, {4, 2, 2});
  TissueSettings settings;
  const auto points = points_in_box(mesh, {0, 0, 0}, {0, 1, 1});
  const TimeProfile ramp{.kind = TimeProfile::Kind::ramp, .start = 0, .rise = 1};
  settings.supports = {{points, {0.01, 0, 0}, ramp}, {points, {0, 0.02, 0}, ramp}};
  const TissueBody body(mesh, settings);
  const Eigen::Matrix3Xd x = body.positions(0.5, VectorXd::Zero(body.dofs()));
  EXPECT_NEAR(x(0, 0) - mesh.points(0, 0), 0.005, 1e-16);
  EXPECT_NEAR(x(1, 0) - mesh.points(1, 0), 0.01, 1e-16);
}

TEST(TissueBody, SupportsHoldTheirPointsOrMoveThem) {
  const TetMesh mesh = box_mesh({0.2, 0.1, 0.1}, {4, 2, 2});
  TissueSettings settings;
  settings.supports = {
      {points_in_box(mesh, {0, 0, 0}, {0, 1, 1}), {0.01, 0, 0}, {TimeProfile::Kind::ramp, 0, 1}},
      {points_in_box(mesh, {0.2, 0, 0}, {0.2, 1, 1})}};
  const TissueBody body(mesh, settings);
  EXPECT_EQ(body.dofs(), 3 * (45 - 18));
  const Eigen::Matrix3Xd x = body.positions(0.5, VectorXd::Zero(body.dofs()));
  EXPECT_NEAR(x(0, 0) - mesh.points(0, 0), 0.005, 1e-16);
  EXPECT_EQ(x.col(44), mesh.points.col(44));
  EXPECT_FALSE(body.is_autonomous());
  EXPECT_EQ(body.least_volume(0, VectorXd::Zero(body.dofs())).first, 1);
}

TEST(TissueBody, SaysWhatIsWrongWithItsSettings) {
  const TetMesh mesh = box_mesh({0.2, 0.1, 0.1}, {1, 1, 1});
  const auto refuses = [&](const auto& change) {
    TissueSettings settings;
    change(settings);
    EXPECT_THROW(TissueBody(mesh, settings), std::invalid_argument);
  };
  refuses([](TissueSettings& s) { s.materials[0].young = -1; });
  refuses([](TissueSettings& s) { s.materials[0].poisson = 0.5; });
  refuses([](TissueSettings& s) { s.materials[0].density = 0; });
  refuses([](TissueSettings& s) { s.materials.clear(); });
  refuses([](TissueSettings& s) { s.total_mass = -1; });
  refuses([](TissueSettings& s) { s.alpha = std::numeric_limits<double>::quiet_NaN(); });
  refuses([](TissueSettings& s) { s.supports = {{{8}}}; });
  refuses([](TissueSettings& s) { s.supports = {{{0, 1, 2, 3, 4, 5, 6, 7}}}; });
  refuses([](TissueSettings& s) { s.forces = {{{}, {0, 0, 1}}}; });
  refuses([](TissueSettings& s) { s.forces = {{{0, 1}, {0, 0, 1}, {1}}}; });
  refuses([](TissueSettings& s) { s.skin = {SkinSettings::Kind::membrane, 1e6, 0.45, 0}; });
  refuses([](TissueSettings& s) {
    s.model = tissue_model("mass_spring");
    s.springs.damper = -1;
  });
  TetMesh idle = mesh;
  idle.points.conservativeResize(3, 9);
  idle.points.col(8).setConstant(1);
  EXPECT_THROW(TissueBody(idle, {}), std::invalid_argument);
  EXPECT_THROW(tissue_model("fem_blue"), std::invalid_argument);
  for (const char* id : {"mass_spring", "fem_cauchy", "fem_green", "fem_corotational", "fem_neo_hookean"})
    EXPECT_EQ(tissue_model(id).id, id);
}

}  // namespace
}  // namespace hmax
