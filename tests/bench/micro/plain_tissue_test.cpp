#include "bench/micro/plain_tissue.hpp"

#include <gtest/gtest.h>

#include "bench/micro/tissue_costs.hpp"
#include "problems/mesh/mesh_generators.hpp"
#include "problems/mesh/topology.hpp"
#include "tests/problems/mesh/meshes.hpp"

namespace hmax {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Lame rubber{.lambda = 3, .mu = 2};

MatrixXd stiffness_at(const TetMesh& mesh, const VectorXd& x) {
  std::vector<TetMesh::Index> free(static_cast<std::size_t>(mesh.point_count()));
  for (std::size_t i = 0; i < free.size(); ++i) free[i] = static_cast<TetMesh::Index>(i);
  const BlockPattern pattern(free, edges_of(mesh));
  BlockPattern::Matrix K;
  pattern.clear(K);
  plain::Green elements(mesh, rubber);
  elements.place(pattern);
  elements.stiffness(x.data(), pattern, K.valuePtr());
  return K;
}

/// K_ab = V (lambda g_a g_b^T + mu (g_b g_a^T + g_a.g_b I)), with the gradients g of the barycentric
/// coordinates: (-1, -1, -1) and the unit vectors.
TEST(PlainStiffness, AtRestIsThatOfLinearElasticity) {
  const TetMesh mesh = unit_tetrahedron();
  const MatrixXd K = stiffness_at(mesh, mesh.points.reshaped());
  Eigen::Matrix<double, 3, 4> g;
  g << -Eigen::Vector3d::Ones(), Matrix3d::Identity();
  for (Index a = 0; a < 4; ++a)
    for (Index b = 0; b < 4; ++b) {
      const Matrix3d expected =
          (rubber.lambda * g.col(a) * g.col(b).transpose() +
           rubber.mu * (g.col(b) * g.col(a).transpose() + g.col(a).dot(g.col(b)) * Matrix3d::Identity())) /
          6;
      EXPECT_LT((K.block<3, 3>(3 * a, 3 * b) - expected).norm(), 1e-13) << a << ' ' << b;
    }
}

/// Minus the derivative of the plain force, which tests/studies/organ_rates_test.cpp holds against the body.
TEST(PlainStiffness, IsMinusTheDerivativeOfTheForceOfADeformedBody) {
  const TetMesh mesh = cube_mesh(1, 2);
  VectorXd x = mesh.points.reshaped();
  for (Index i = 0; i < x.size(); ++i) x[i] += 0.05 * std::sin(static_cast<double>(3 * i));
  const plain::Green elements(mesh, rubber);
  const auto force = [&](Index j, double by) {
    VectorXd moved = x, f = VectorXd::Zero(x.size());
    moved[j] += by;
    elements.force(moved.data(), f.data());
    return f;
  };
  const MatrixXd K = stiffness_at(mesh, x);
  for (Index j = 0; j < x.size(); ++j)
    EXPECT_LT((K.col(j) + (force(j, 1e-5) - force(j, -1e-5)) / 2e-5).norm(), 1e-7 * K.norm()) << j;
}

TEST(TissueCosts, AreTheBytesOfRecordsPointsAndEntries) {
  // Four corners and eleven numbers of each tetrahedron, one end and two numbers of each spring.
  const micro::BodyCounts cube{.points = 8, .edges = 19, .tetrahedra = 6, .entries = 414};
  EXPECT_DOUBLE_EQ(micro::cost_of_force(cube).bytes, 4 * 4 + 11 * 8 + 8 * 96 / 6.0);
  EXPECT_DOUBLE_EQ(micro::cost_of_springs(cube).bytes, 4 + 2 * 8 + 8 * 96 / 19.0);
  EXPECT_DOUBLE_EQ(micro::cost_of_stiffness(cube).bytes,
                   4 * 4 + 11 * 8 + 6 * 4 + (8 * 32 + 19 * 2 * 96 + 414 * 8) / 6.0);
}

}  // namespace
}  // namespace hmax
