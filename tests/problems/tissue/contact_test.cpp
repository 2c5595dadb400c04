/// Contact of a tool with a surface. Forces and stiffness of bodies with a tool are held against differences
/// in body_test.cpp.
#include "problems/tissue/contact.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "tests/problems/tissue/bodies.hpp"

namespace hmax {
namespace {

using namespace tissue_tests;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

/// A tool that stands in the middle of the upper side of a box, `depth` deep.
SphereTool tool_on(const TetMesh& box, double radius, double depth) {
  const Vector3d high = box.points.rowwise().maxCoeff(), low = box.points.rowwise().minCoeff();
  return {.radius = radius,
          .start = {(low[0] + high[0]) / 2 + 0.003, (low[1] + high[1]) / 2 - 0.002, high[2] + radius},
          .travel = {0, 0, -depth},
          .stiffness = 3e7};
}

TEST(ToolContact, IntegratesThePressureOverWhateverTriangles) {
  const double radius = 0.02, depth = 0.006, rim = radius - depth;
  // The plane at a distance `rim` of the centre: integral of k (R - r)^(3/2) rim / r over its disc.
  const double k = 3e7, exact = 2 * std::numbers::pi * k * rim * 0.4 * std::pow(depth, 2.5);
  for (const int cells : {1, 3, 20}) {
    const TetMesh mesh = box_mesh({0.1, 0.1, 0.05}, {cells, cells, 1});
    const ToolContact contact(mesh.points, surface_of(mesh).triangles, tool_on(mesh, radius, depth));
    const NodeRows x = node_rows(mesh.points);
    NodeRows f(x.size()), v(x.size());
    contact.add_force(0, x, v, f);
    Vector3d sum = Vector3d::Zero();
    for (const NodeRow& row : f) sum += as_vector(row);
    EXPECT_NEAR(sum[2], -exact, 0.02 * exact) << cells;
    EXPECT_LT(sum.head<2>().norm(), 0.02 * exact) << cells;
    const ToolContact::Reach reach = contact.reach(0, x);
    EXPECT_DOUBLE_EQ(reach.depth, depth);
    EXPECT_NEAR(reach.penetration, depth, 0.03 * depth) << cells;
    EXPECT_NEAR(contact.gap(), 0, 0.03 * depth) << cells;
    EXPECT_EQ(reach.displacement, 0) << cells;
  }
}

TEST(ToolContact, HasASymmetricStiffnessWithoutDamping) {
  const TetMesh mesh = uneven_box();
  TissueSettings settings;
  settings.tools = {tool_on(mesh, 0.02, 0.01)};
  const TissueBody body(mesh, settings);
  settings.tools.clear();
  const TissueBody alone(mesh, settings);
  const VectorXd q = random_vector(body.dofs(), 0.002, 4), v = VectorXd::Zero(body.dofs());
  const MatrixXd K = stiffness(body, 0, q, v), contact = K - stiffness(alone, 0, q, v);
  EXPECT_TRUE(body.has_symmetric_stiffness());
  EXPECT_GT(contact.cwiseAbs().maxCoeff(), 1);
  EXPECT_LT((K - K.transpose()).cwiseAbs().maxCoeff(), 1e-13 * K.cwiseAbs().maxCoeff());
}

/// The energy of a body that swings against a tool is kept, and with damping of the contact falls by the work
/// of its forces: d/dt (T + E) = (f(v) - f(0)) . v.
TEST(ToolContact, KeepsTheEnergyOrTakesTheWorkOfItsDamping) {
  const TetMesh mesh = uneven_box();
  for (const double damping : {0.0, 2.0}) {
    TissueSettings settings;
    settings.tools = {tool_on(mesh, 0.02, 0.012)};
    settings.tools.front().damping = damping;
    const TissueBody body(mesh, settings);
    const VectorXd zero = VectorXd::Zero(body.dofs());
    VectorXd q = zero, v = zero, f(body.dofs()), still(body.dofs());
    const double start = body.energy(0, q), h = 2e-5;
    double work = 0, lost_before = 0, most_kinetic = 0;
    // Velocity Verlet, whose energy is kept to h^2; the power of damping by the trapezoidal rule.
    body.force(0, q, v, f);
    for (int n = 0; n < 2000; ++n) {
      const VectorXd half = v + 0.5 * h * f.cwiseQuotient(body.mass());
      q += h * half;
      body.force(0, q, half, f);
      v = half + 0.5 * h * f.cwiseQuotient(body.mass());
      body.force(0, q, v, f);
      body.force(0, q, zero, still);
      const double lost = (f - still).dot(v);
      EXPECT_LE(lost, 1e-12);
      work += 0.5 * h * (lost + lost_before);
      lost_before = lost;
      most_kinetic = std::max(most_kinetic, body.kinetic_energy(v));
    }
    const double change = body.energy(0, q) + body.kinetic_energy(v) - start;
    EXPECT_GT(most_kinetic, 0.1 * start) << "it has moved";
    EXPECT_NEAR(change, work, 2e-3 * start) << damping;
    EXPECT_EQ(damping > 0, work < -0.01 * start) << work / start;
  }
}

TEST(ToolContact, TurnsWithTheBodyAndTheTool) {
  const TetMesh mesh = uneven_box();
  const Eigen::Matrix3d R = Eigen::AngleAxisd(1.3, Vector3d(1, 2, -0.5).normalized()).toRotationMatrix();
  TetMesh turned = mesh;
  turned.points = R * mesh.points;
  SphereTool tool = tool_on(mesh, 0.02, 0.01);
  TissueSettings settings;
  settings.tools = {tool};
  const TissueBody body(mesh, settings);
  tool.start = R * tool.start;
  tool.travel = R * tool.travel;
  settings.tools = {tool};
  const TissueBody other(turned, settings);
  const VectorXd q = random_vector(body.dofs(), 0.002, 5), v = VectorXd::Zero(body.dofs());
  const VectorXd Rq = (R * q.reshaped(3, q.size() / 3)).reshaped();
  const VectorXd f = force(body, 0, q, v), expected = (R * f.reshaped(3, f.size() / 3)).reshaped();
  EXPECT_LT((force(other, 0, Rq, v) - expected).norm(), 1e-12 * expected.norm());
  EXPECT_NEAR(other.energy(0, Rq), body.energy(0, q), 1e-12 * body.energy(0, q));
  EXPECT_GT(body.tool_reaches(0, q).front().penetration, 0.004);
}

}  // namespace
}  // namespace hmax
