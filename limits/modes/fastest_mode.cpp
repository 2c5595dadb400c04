#include "limits/modes/fastest_mode.hpp"

#include <cmath>
#include <set>

#include "analysis/spectrum/block_product.hpp"
#include "analysis/spectrum/lanczos.hpp"
#include "problems/mesh/mesh_quality.hpp"
#include "problems/mesh/ten_node.hpp"
#include "problems/mesh/topology.hpp"

namespace hmax {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Sparse = Eigen::SparseMatrix<double>;

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

Sparse rest_stiffness(const TissueBody& body) {
  const VectorXd rest = VectorXd::Zero(body.dofs());
  Sparse K;
  body.stiffness(0, rest, rest, K);
  return K;
}

/// The largest eigenvalue of M^-1 K and its eigenvector in coordinates where M = I.
LanczosPair fastest(const Sparse& K, const VectorXd& mass) {
  const SymmetricProduct A(K, mass.cwiseSqrt().cwiseInverse());
  return largest_eigenpair([&](const VectorXd& x, VectorXd& y) { A(x, y); }, mass.size());
}

/// One element with its share of the masses.
struct ModePart {
  std::vector<Index> points;  // free numbers
  MatrixXd K;
  VectorXd share;  // of each point [kg]
};

ModePart part_of(const ElementSum& elements, const VectorXd& mass, std::span<const double> weights,
                 Index which) {
  ModePart part;
  VectorXd total = VectorXd::Zero(mass.size()), own;
  Index e = 0;
  elements([&](std::span<const Index> points, const Eigen::Ref<const MatrixXd>& K) {
    const auto count = static_cast<Index>(points.size());
    VectorXd weight(count);
    for (Index a = 0; a < count; ++a) {
      weight[a] = weights.empty() ? K.diagonal().segment<3>(3 * a).sum() : weights[at(e)];
      if (points[at(a)] >= 0) total[points[at(a)]] += weight[a];
    }
    if (e++ != which) return;
    part.points.assign(points.begin(), points.end());
    part.K = K;
    own = weight;
  });
  part.share = VectorXd::Zero(own.size());
  for (Index a = 0; a < own.size(); ++a)
    if (const Index point = part.points[at(a)]; point >= 0)
      part.share[a] = mass[point] * own[a] / total[point];
  return part;
}

/// The masses of all degrees of freedom with `times` the share of an element more.
VectorXd with_share(VectorXd mass, const ModePart& part, double times) {
  for (Index a = 0; a < part.share.size(); ++a)
    if (const Index point = part.points[at(a)]; point >= 0)
      mass.segment<3>(3 * point).array() += times * part.share[a];
  return mass;
}

Sparse without(Sparse K, const ModePart& part) {
  for (std::size_t a = 0; a < part.points.size(); ++a)
    for (std::size_t b = 0; b < part.points.size(); ++b) {
      if (part.points[a] < 0 || part.points[b] < 0) continue;
      for (Index r = 0; r < 3; ++r)
        for (Index c = 0; c < 3; ++c)
          K.coeffRef(3 * part.points[a] + r, 3 * part.points[b] + c) -=
              part.K(3 * static_cast<Index>(a) + r, 3 * static_cast<Index>(b) + c);
    }
  return K;
}

/// The best move of an inner point of the owner towards the mean of its neighbours; none of elements of ten
/// nodes, whose sides it would bend.
void smooth(const TissueBody& body, FastestMode& mode) {
  const TetMesh& mesh = body.mesh();
  if (mesh.has_ten_nodes()) return;
  const MeshSurface surface = surface_of(mesh);
  const std::set<TetMesh::Index> outer(surface.points.begin(), surface.points.end());
  for (const TetMesh::Index point : mode.points) {
    if (outer.contains(point)) continue;
    std::set<TetMesh::Index> neighbours;
    for (Index t = 0; t < mesh.tetrahedron_count(); ++t)
      if ((mesh.tetrahedra.col(t).array() == point).any())
        neighbours.insert(mesh.tetrahedra.col(t).begin(), mesh.tetrahedra.col(t).end());
    neighbours.erase(point);
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (const TetMesh::Index each : neighbours)
      mean += mesh.points.col(each) / static_cast<double>(neighbours.size());
    for (const double share : {0.25, 0.5, 1.0}) {
      TetMesh moved = mesh;
      moved.points.col(point) += share * (mean - mesh.points.col(point));
      bool valid = true;
      for (Index t = 0; valid && t < moved.tetrahedron_count(); ++t)
        valid = signed_volume(corners_of(moved, t)) > 0;
      if (!valid) continue;
      const TissueBody changed(moved, body.settings());
      const LanczosPair pair = fastest(rest_stiffness(changed), changed.mass());
      if (const double gain = std::sqrt(mode.kappa / pair.value); pair.converged && gain > mode.smoothed) {
        mode.smoothed = gain;
        mode.moved_point = point;
      }
    }
  }
}

}  // namespace

ElementSum elements_of(const TissueBody& body) {
  return [&body, numbers = std::vector<Index>()](const ElementVisitor& visit) mutable {
    body.visit_rest_stiffness(
        [&](std::span<const TissueBody::Index> points, const Eigen::Ref<const MatrixXd>& K) {
          numbers.clear();
          for (const TissueBody::Index point : points) numbers.push_back(body.free_numbers()[at(point)]);
          visit(numbers, K);
        });
  };
}

std::vector<double> mass_weights(const TissueBody& body) {
  const TissueSettings& settings = body.settings();
  std::vector<double> weights;
  const TetMesh& mesh = body.mesh();
  const bool only_elements = body.element_pieces() == at(mesh.element_count()) &&
                             settings.skin.kind == SkinSettings::Kind::none &&
                             settings.elastic_supports.empty();
  if (!only_elements) return weights;
  for (Index e = 0; e < mesh.element_count(); ++e) {
    const std::size_t region = settings.materials.size() > 1 ? at(mesh.region(mesh.first_part(e))) : 0;
    weights.push_back(element_volume(mesh, e) * settings.materials.at(region).density);
  }
  return weights;
}

namespace {

/// @param K     at rest
/// @param pair  the largest eigenvalue of M^-1 K and its eigenvector in coordinates where M = I
FastestMode described(const TissueBody& body, const Sparse& K, const LanczosPair& pair, bool with_gains) {
  FastestMode mode;
  mode.kappa = pair.value;
  mode.residual = pair.residual / pair.value;
  mode.shape = pair.vector.cwiseQuotient(body.mass().cwiseSqrt());
  const ElementSum elements = elements_of(body);
  VectorXd mass(body.dofs() / 3);
  for (Index i = 0; i < mass.size(); ++i) mass[i] = body.mass()[3 * i];
  const std::vector<double> weights = mass_weights(body);
  mode.bounds = stiffness_bounds(elements, mass, weights, K);
  mode.owner = owner_of(elements, mass, mode.shape);
  Index e = 0;
  body.visit_rest_stiffness([&](std::span<const TissueBody::Index> points, const auto&) {
    if (e++ == mode.owner.element) mode.points.assign(points.begin(), points.end());
  });
  mode.centre.setZero();
  for (const auto point : mode.points)
    mode.centre += body.mesh().points.col(point) / static_cast<double>(mode.points.size());
  if (!with_gains) return mode;

  ModePart owner = part_of(elements, mass, weights, mode.owner.element);
  if (mode.points.size() == 1) owner.share.setZero();  // the spring of a support has no mass
  const auto gain = [&](const LanczosPair& changed) { return std::sqrt(mode.kappa / changed.value); };
  // A point that belongs to nothing else has no mass left, and no force: with its old mass it stays.
  const VectorXd less = with_share(body.mass(), owner, -1);
  const Sparse rest = without(K, owner);
  if (rest.norm() > 1e-9 * K.norm())
    mode.without =
        gain(fastest(rest, (less.array() > 1e-9 * body.mass().minCoeff()).select(less, body.mass())));
  mode.with_mass = gain(fastest(K, with_share(body.mass(), owner, 1)));
  mode.added_mass = owner.share.sum() / body.point_mass().sum();
  smooth(body, mode);
  return mode;
}

}  // namespace

FastestMode fastest_mode_of(const TissueBody& body, bool with_gains) {
  const Sparse K = rest_stiffness(body);
  return described(body, K, fastest(K, body.mass()), with_gains);
}

FastestMode fastest_mode_of(const TissueBody& body, const Linearised& near, bool with_gains) {
  if (near.modes.fastest_shape.size() == 0) return fastest_mode_of(body, with_gains);
  const Sparse& K = std::get<Sparse>(near.point.model.mechanical->K);
  const VectorXd root = body.mass().cwiseSqrt();
  LanczosPair pair{.value = near.modes.curve->kappa_max,
                   .vector = root.cwiseProduct(near.modes.fastest_shape)};
  pair.residual = ((K * near.modes.fastest_shape).cwiseQuotient(root) - pair.value * pair.vector).norm();
  return described(body, K, pair, with_gains);
}

}  // namespace hmax
