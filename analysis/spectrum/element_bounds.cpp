#include "analysis/spectrum/element_bounds.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/dense_solvers.hpp"

namespace hmax {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Stiffness = Eigen::Ref<const MatrixXd>;

Index count(std::span<const Index> points) { return static_cast<Index>(points.size()); }

/// The part of an element's matrix that belongs to free points, scaled by their share of mass.
/// M_e^-1/2 K_e M_e^-1/2 with zero rows and columns for points that are held; `share` is the mass at each
/// point [kg].
MatrixXd scaled_to_free(std::span<const Index> points, const Stiffness& K, const VectorXd& share) {
  VectorXd inverse_root = VectorXd::Zero(3 * count(points));
  for (Index a = 0; a < count(points); ++a)
    if (points[static_cast<std::size_t>(a)] >= 0)
      inverse_root.segment<3>(3 * a).setConstant(1 / std::sqrt(share[a]));
  return inverse_root.asDiagonal() * K * inverse_root.asDiagonal();
}

}  // namespace

// Two passes over the elements: the first sums weights and diagonal blocks at the points, the second knows
// the shares of mass.
StiffnessBounds stiffness_bounds(const ElementSum& elements, const VectorXd& mass,
                                 std::span<const double> weights, const Eigen::SparseMatrix<double>& K) {
  // By the trace stiff elements get more of the mass of a point, which lowers the largest of their kappa.
  const bool by_trace = weights.empty();
  VectorXd total = VectorXd::Zero(mass.size());  // of the weights at each point
  std::vector<Matrix3d> blocks(static_cast<std::size_t>(mass.size()), Matrix3d::Zero());
  const auto weight = [&](std::size_t e, Index a, const Stiffness& Ke) {
    return by_trace ? Ke.diagonal().segment<3>(3 * a).sum() : weights[e];
  };
  std::size_t e = 0;
  elements([&](std::span<const Index> points, const Stiffness& Ke) {
    for (Index a = 0; a < count(points); ++a)
      if (const Index point = points[static_cast<std::size_t>(a)]; point >= 0) {
        // sum over the elements at a point of their weights, and of p_e K_e(a, a).
        total[point] += weight(e, a, Ke);
        blocks[static_cast<std::size_t>(point)] +=
            // A <= p diag(A_11, ..., A_pp) for A of p x p blocks without negative eigenvalues.
            static_cast<double>(points.size()) * Ke.block<3, 3>(3 * a, 3 * a);
      }
    ++e;
  });

  StiffnessBounds bounds;
  e = 0;
  elements([&](std::span<const Index> points, const Stiffness& Ke) {
    VectorXd share = VectorXd::Ones(count(points));
    for (Index a = 0; a < count(points); ++a)
      if (const Index point = points[static_cast<std::size_t>(a)]; point >= 0) {
        const double own = weight(e, a, Ke);
        // Without stiffness at a point an element needs no mass there.
        // m_a w_e / sum of w over the elements at a: the shares of a point add up to its mass.
        if (own > 0) share[a] = mass[point] * own / total[point];
      }
    const MatrixXd scaled = scaled_to_free(points, Ke, share);
    // No eigenvalue is larger than its norms, which say it of nearly all elements.
    const bool smaller =
        std::min(scaled.norm(), scaled.cwiseAbs().rowwise().sum().maxCoeff()) <= bounds.element;
    if (!smaller) bounds.element = std::max(bounds.element, largest_eigenvalue_of(scaled));
    ++e;
  });

  for (Index point = 0; point < mass.size(); ++point) {
    Eigen::SelfAdjointEigenSolver<Matrix3d> solver;
    solver.computeDirect(blocks[static_cast<std::size_t>(point)], Eigen::EigenvaluesOnly);
    // Eigenvalues of a 3 x 3 matrix in closed form, ascending.
    bounds.nodal = std::max(bounds.nodal, solver.eigenvalues()[2] / mass[point]);
  }

  VectorXd rows = VectorXd::Zero(K.rows());
  for (Index j = 0; j < K.cols(); ++j)
    for (Eigen::SparseMatrix<double>::InnerIterator entry(K, j); entry; ++entry)
      // Row sums of |M^-1/2 K M^-1/2|; the diagonal entry is positive, so centre and radius add up to the
      // whole sum.
      rows[entry.row()] += std::abs(entry.value()) / std::sqrt(mass[entry.row() / 3] * mass[j / 3]);
  bounds.gershgorin = rows.maxCoeff();
  return bounds;
}

// Energies of a mode add up over the elements, kinetic energies over the points.
ModeOwner owner_of(const ElementSum& elements, const VectorXd& mass, const VectorXd& shape) {
  std::vector<double> energy;
  elements([&](std::span<const Index> points, const Stiffness& K) {
    VectorXd u = VectorXd::Zero(K.rows());
    for (Index a = 0; a < count(points); ++a)
      if (const Index point = points[static_cast<std::size_t>(a)]; point >= 0)
        u.segment<3>(3 * a) = shape.segment<3>(3 * point);
    // Twice the strain energy.
    energy.push_back(u.dot(K * u));
  });
  ModeOwner owner;
  const double whole = std::accumulate(energy.begin(), energy.end(), 0.0);
  const auto most = std::ranges::max_element(energy);
  owner.element = most - energy.begin();
  owner.share = *most / whole;
  std::ranges::sort(energy, std::ranges::greater{});
  // The fewest elements that hold nine tenths, the largest first.
  for (double sum = 0; sum < 0.9 * whole && owner.elements < static_cast<Index>(energy.size());)
    sum += energy[static_cast<std::size_t>(owner.elements++)];
  double kinetic = 0, squares = 0;
  for (Index point = 0; point < mass.size(); ++point) {
    const double part = mass[point] * shape.segment<3>(3 * point).squaredNorm();
    kinetic += part;
    squares += part * part;
  }
  // (sum T_a)^2 / sum T_a^2, the participation number.
  owner.moving_points = kinetic * kinetic / squares;
  return owner;
}

}  // namespace hmax
