#include "analysis/dynamics/discrete_map.hpp"

#include <algorithm>
#include <cmath>

#include "core/dense_solvers.hpp"

namespace hmax {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// D map at y by central differences: good enough for a step of Newton's method.
MatrixXd rough_jacobian(const VectorFunction& map, const VectorXd& y, const VectorXd& size) {
  MatrixXd D(y.size(), y.size());
  for (Eigen::Index j = 0; j < y.size(); ++j) {
    VectorXd ahead = y, behind = y;
    ahead(j) += 1e-6 * size(j);
    behind(j) -= 1e-6 * size(j);
    D.col(j) = (map(ahead) - map(behind)) / (ahead(j) - behind(j));
  }
  return D;
}

}  // namespace

Multipliers multipliers_of(const MatrixXd& D) {
  if (!D.allFinite()) return Multipliers(static_cast<std::size_t>(D.rows()), std::nan(""));
  Multipliers mu;
  if (D.rows() == 2) {
    for (const auto& value : eigenvalues_2x2(Eigen::Matrix2d(D))) mu.push_back(value);
  } else {
    const Eigen::VectorXcd values = dense_eigenvalues(D);
    mu.assign(values.begin(), values.end());
  }
  std::ranges::stable_sort(mu, [](const auto& a, const auto& b) {
    // A conjugate pair has one modulus, whatever rounding says.
    const double difference = std::abs(a) - std::abs(b);
    return std::abs(difference) > 1e-14 * std::abs(a) ? difference > 0 : a.imag() > b.imag();
  });
  return mu;
}

// Saddle: inside and outside; focus: at least one complex multiplier. A negative real multiplier
// alternates sides and counts as a node.
EquilibriumType classify_map(const Multipliers& multipliers) {
  constexpr double on_circle = 1e-8;
  int inside = 0, outside = 0, on = 0;
  bool turns = false, all_turn = true;
  for (const auto& mu : multipliers) {
    const double modulus = std::abs(mu);
    if (!std::isfinite(modulus)) return EquilibriumType::degenerate;
    // Counts the multipliers on, inside and outside the unit circle.
    (std::abs(modulus - 1) <= on_circle ? on : modulus < 1 ? inside : outside) += 1;
    // Rounding splits a double multiplier into a pair about sqrt(epsilon) apart.
    const bool complex = std::abs(mu.imag()) > 1e-6 * modulus;
    turns = turns || complex;
    all_turn = all_turn && complex;
  }
  if (on > 0)
    return inside + outside == 0 && all_turn ? EquilibriumType::centre : EquilibriumType::degenerate;
  if (inside > 0 && outside > 0) return EquilibriumType::saddle;
  if (inside > 0) return turns ? EquilibriumType::stable_focus : EquilibriumType::stable_node;
  return turns ? EquilibriumType::unstable_focus : EquilibriumType::unstable_node;
}

// g(y) = Phi(y) - y, G = D g; the step d, in sizes of the box, solves G S d = -g in the sense of least
// squares.
std::optional<VectorXd> newton_fixed_point(const VectorFunction& map, const Box& box, const VectorXd& start,
                                           double leash) {
  constexpr int most_steps = 50;
  const VectorXd size = box.size();
  const double longest = std::min(0.3, leash);
  VectorXd y = start;
  double length = 1;
  for (int step = 0; step < most_steps && length > 1e-14; ++step) {
    const VectorXd g = map(y) - y;
    if (!g.allFinite()) return std::nullopt;
    if (g.isZero(0)) {
      length = 0;
      break;
    }
    // D(Phi - id)
    const MatrixXd G = rough_jacobian(map, y, size) - MatrixXd::Identity(y.size(), y.size());
    if (!G.allFinite()) return std::nullopt;
    // In sizes of the box, so that components of different units weigh alike.
    VectorXd d = minimum_norm_solution(G * size.asDiagonal(), -g);
    if (!d.allFinite()) return std::nullopt;
    length = d.norm();
    // A step across the box is a leap into the dark.
    if (length > longest) d *= longest / length;
    y += d.cwiseProduct(size);
    if (!((y - start).cwiseQuotient(size).norm() <= leash)) return std::nullopt;
    // What has left for good does not come back.
    if (((y - box.lower + 2 * size).array() < 0).any() || ((box.upper - y + 2 * size).array() < 0).any())
      return std::nullopt;
  }
  const VectorXd slack = 1e-9 * size;
  const auto residual = [&](const VectorXd& at) -> VectorXd {
    return (map(at) - at).cwiseAbs().cwiseQuotient(size);
  };
  // At a double point the last steps stay at the root of rounding.
  if (!(length < 1e-6) || !(residual(y).maxCoeff() < 1e-10)) return std::nullopt;
  if (((y - box.lower + slack).array() < 0).any() || ((box.upper - y + slack).array() < 0).any())
    return std::nullopt;
  for (Eigen::Index i = 0; i < y.size(); ++i) {  // a coordinate that is zero to rounding is printed as 0
    VectorXd rounded = y;
    rounded(i) = 0;
    if (std::abs(y(i)) < 1e-9 * size(i) && residual(rounded).maxCoeff() <= residual(y).maxCoeff() + 1e-15)
      y = rounded;
  }
  return y;
}

FixedPoint fixed_point_at(const VectorFunction& map, const VectorXd& y, const VectorXd& scale) {
  const Multipliers mu = multipliers_of(differenced_jacobian(map, y, scale));
  return {y, mu, classify_map(mu)};
}

bool is_spurious(const VectorFunction& f, double h, const VectorXd& y, const Box& box) {
  const VectorXd change = h * f(y).cwiseAbs().cwiseQuotient(box.size());
  return !(change.maxCoeff() < 1e-6);
}

}  // namespace hmax
