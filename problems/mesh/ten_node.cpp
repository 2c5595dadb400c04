#include "problems/mesh/ten_node.hpp"

#include <cmath>

#include <Eigen/Dense>

#include "problems/cofactors.hpp"
#include "problems/mesh/mesh_quality.hpp"
#include "problems/mesh/topology.hpp"

namespace hmax {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector4d;

Vector4d barycentric(const UnitPlace& at) { return {1 - at.sum(), at[0], at[1], at[2]}; }

/// dL/d(x, y, z), a row for each corner.
Eigen::Matrix<double, 4, 3> barycentric_slopes() {
  Eigen::Matrix<double, 4, 3> slopes;
  slopes << -1, -1, -1, 1, 0, 0, 0, 1, 0, 0, 0, 1;
  return slopes;
}

/// The integral over an element of f(point of the unit tetrahedron), f of degree three: five points, of which
/// the middle has a negative weight [keast1986moderate].
template <class Result, class Integrand>
Result integrated(const Integrand& f) {
  Result sum = (-4. / 5 / 6 * f(UnitPlace(0.25, 0.25, 0.25))).eval();
  for (int k = 0; k < 4; ++k) {
    UnitPlace at(1. / 6, 1. / 6, 1. / 6);
    if (k > 0) at[k - 1] = 0.5;
    sum += 9. / 20 / 6 * f(at);
  }
  return sum;
}

}  // namespace

TenPlaces ten_places(const TetMesh& mesh, Eigen::Index element) {
  return mesh.points(Eigen::all, mesh.ten_node.col(element));
}

const std::array<UnitPlace, 10>& unit_places() {
  static const std::array<UnitPlace, 10> places = [] {
    std::array<UnitPlace, 10> all;
    all[0].setZero();
    for (int k = 0; k < 3; ++k) all[static_cast<std::size_t>(k) + 1] = UnitPlace::Unit(k);
    for (std::size_t e = 0; e < 6; ++e) {
      const auto& [i, j] = tetrahedron_edges[e];
      all[4 + e] = (all[static_cast<std::size_t>(i)] + all[static_cast<std::size_t>(j)]) / 2;
    }
    return all;
  }();
  return places;
}

Eigen::Vector<double, 10> ten_node_values(const UnitPlace& at) {
  const Vector4d L = barycentric(at);
  Eigen::Vector<double, 10> N;
  N.head<4>() = L.array() * (2 * L.array() - 1);
  for (Eigen::Index e = 0; e < 6; ++e) {
    const auto& [i, j] = tetrahedron_edges[static_cast<std::size_t>(e)];
    N[4 + e] = 4 * L[i] * L[j];
  }
  return N;
}

Eigen::Matrix<double, 10, 3> ten_node_slopes(const UnitPlace& at) {
  const Vector4d L = barycentric(at);
  const Eigen::Matrix<double, 4, 3> dL = barycentric_slopes();
  Eigen::Matrix<double, 10, 3> dN;
  for (Eigen::Index k = 0; k < 4; ++k) dN.row(k) = (4 * L[k] - 1) * dL.row(k);
  for (Eigen::Index e = 0; e < 6; ++e) {
    const auto& [i, j] = tetrahedron_edges[static_cast<std::size_t>(e)];
    dN.row(4 + e) = 4 * (L[i] * dL.row(j) + L[j] * dL.row(i));
  }
  return dN;
}

const std::array<UnitPlace, 4>& ten_node_rule() {
  static const std::array<UnitPlace, 4> rule = [] {
    const double far = (5 + 3 * std::sqrt(5.)) / 20, near = (5 - std::sqrt(5.)) / 20;
    std::array<UnitPlace, 4> points;
    points.fill(UnitPlace::Constant(near));
    for (int k = 0; k < 3; ++k) points[static_cast<std::size_t>(k) + 1][k] = far;
    return points;
  }();
  return rule;
}

double ten_node_determinant(const TenPlaces& X, const UnitPlace& at) {
  return Matrix3d(X * ten_node_slopes(at)).determinant();
}

Eigen::Matrix<double, 10, 3> integrated_gradients(const TenPlaces& X) {
  // dN/dX det J = dN/d(x, y, z) (cofactors of J)^T: of degree three.
  return integrated<Eigen::Matrix<double, 10, 3>>([&](const UnitPlace& at) {
    const Eigen::Matrix<double, 10, 3> slopes = ten_node_slopes(at);
    return Eigen::Matrix<double, 10, 3>(slopes * cofactors(Eigen::Matrix3d(X * slopes)).transpose());
  });
}

double ten_node_volume(const TenPlaces& X) {
  // The trace of the sum over the points of X dN/dX is 3.
  const Matrix3d moments = X * integrated_gradients(X);
  return moments.trace() / 3;
}

double element_volume(const TetMesh& mesh, Eigen::Index element) {
  return mesh.has_ten_nodes() ? ten_node_volume(ten_places(mesh, element))
                              : signed_volume(corners_of(mesh, element));
}

double mass_share(const TetMesh& mesh, std::size_t point) {
  if (!mesh.has_ten_nodes()) return 0.25;
  return point < 4 ? 1. / 36 : 4. / 27;
}

}  // namespace hmax
