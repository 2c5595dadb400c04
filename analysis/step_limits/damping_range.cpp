#include "analysis/step_limits/damping_range.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/SparseCore>

#include "analysis/spectrum/davidson.hpp"
#include "analysis/spectrum/lanczos.hpp"
#include "integrators/linear/panel_factor.hpp"

namespace hmax {
namespace {

using Eigen::VectorXd;
using Sparse = Eigen::SparseMatrix<double>;

/// Angles of the tangents, in coordinates where the largest gamma and kappa are one [degrees]. Proportional
/// damping alone makes of the range a line from near the origin to (1, 1): most of them are nearly along it,
/// on the side of little damping, where limits are.
constexpr std::array<double, 17> angles{20,  45,  70,  100, 110, 120, 125, 130, 133,
                                        137, 140, 145, 150, 160, 170, -30, -45};

double radians(std::size_t i) { return angles[i] * std::numbers::pi / 180; }

MechanicalMode between(const MechanicalMode& from, const MechanicalMode& to, double share) {
  return {from.kappa + share * (to.kappa - from.kappa), from.gamma + share * (to.gamma - from.gamma)};
}

std::vector<double> even_shares(double from, double to, int samples) {
  std::vector<double> shares;
  for (int i = 0; i <= samples; ++i) shares.push_back(from + (to - from) * i / samples);
  return shares;
}

/// Shares of an edge, evenly and in proportion to the logarithm from its end of slow modes, which near the
/// origin are many.
std::vector<double> shares_of_edge(const MechanicalMode& from, const MechanicalMode& to, int samples) {
  std::vector<double> shares = even_shares(0, 1, samples);
  for (int i = 1; i < samples; ++i) {
    const double small = std::pow(1e-9, static_cast<double>(i) / samples);
    shares.push_back(from.kappa <= to.kappa ? small : 1 - small);
  }
  std::ranges::sort(shares);
  return shares;
}

bool oscillates(const MechanicalMode& mode) { return mode.gamma * mode.gamma < 4 * mode.kappa; }

/// The largest eigenvalue of a c + b k with its residual, of units in which c and k are one at most. Shifted
/// by one: near the origin lie many modes, which are not told apart.
double largest_of(const ScaledMatrices& scaled, double a, double b) {
  VectorXd damped(scaled.size());
  const LanczosPair pair = largest_eigenpair(
      [&](const VectorXd& x, VectorXd& y) {
        scaled.k.unscaled()(x, y);
        scaled.c.unscaled()(x, damped);
        y = b * y + a * damped + (scaled.mass.is_diagonal() ? x : scaled.mass.times(x));
      },
      scaled.mass, {.tolerance = 1e-3, .most_products = 300, .with_vector = false});
  return pair.value + pair.residual - 1;
}

}  // namespace

void DampingRange::cut(double a, double b, double c) {
  std::vector<MechanicalMode> kept;
  const auto beyond = [&](const MechanicalMode& mode) { return a * mode.gamma + b * mode.kappa - c; };
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const MechanicalMode &here = corners[i], &next = corners[(i + 1) % corners.size()];
    const double first = beyond(here), second = beyond(next);
    if (first <= 0) kept.push_back(here);
    if ((first <= 0) != (second <= 0)) kept.push_back(between(here, next, first / (first - second)));
  }
  corners = std::move(kept);
}

RangeTangents::RangeTangents(std::shared_ptr<const ScaledMatrices> matrices, double gamma_max,
                             double kappa_max)
    : offset_of_(
          [matrices = std::move(matrices)](double a, double b) { return largest_of(*matrices, a, b); }),
      gamma_(gamma_max),
      kappa_(kappa_max),
      tangents_(angles.size()) {}

RangeTangents::RangeTangents(const FindLargestOfSum& find, double gamma_max, double kappa_max)
    : offset_of_([find](double a, double b) {
        const LargestOfSum largest = find(a, b, 1e-3);
        return largest.converged ? largest.value + largest.residual : std::numeric_limits<double>::max();
      }),
      gamma_(gamma_max),
      kappa_(kappa_max),
      tangents_(angles.size()) {}

DampingRange RangeTangents::box() const {
  return {.corners = {{0, 0}, {0, gamma_}, {kappa_, gamma_}, {kappa_, 0}}};
}

std::size_t RangeTangents::size() const { return tangents_.size(); }

void RangeTangents::cut(DampingRange& range, std::size_t i) {
  const double a = std::cos(radians(i)) / gamma_, b = std::sin(radians(i)) / kappa_;
  std::call_once(tangents_[i].once, [&] { tangents_[i].offset = offset_of_(a, b); });
  range.cut(a, b, tangents_[i].offset);
}

double RangeTangents::beyond(std::size_t i, const MechanicalMode& mode,
                             std::span<const MechanicalMode> inside) const {
  const auto along = [&](const MechanicalMode& at) {
    return std::cos(radians(i)) * at.gamma / gamma_ + std::sin(radians(i)) * at.kappa / kappa_;
  };
  double least = std::numeric_limits<double>::infinity();
  for (const MechanicalMode& at : inside) least = std::min(least, along(mode) - along(at));
  return least;
}

double least_damping_per_stiffness(const MechanicalPart& part) {
  if (!is_sparse(part.K) || !is_sparse(part.C)) return 0;
  // Whether C - rho K is definite does not depend on M, whose diagonal makes sizes alike.
  const VectorXd root = part.mass.diagonal().cwiseSqrt().cwiseInverse();
  const Sparse k = root.asDiagonal() * std::get<Sparse>(part.K) * root.asDiagonal(),
               c = root.asDiagonal() * std::get<Sparse>(part.C) * root.asDiagonal();
  Sparse difference = c - 0.5 * k;
  PanelFactor<double> factor;
  factor.analyse(difference);
  const auto holds = [&](double rho) {
    difference = c - rho * k;
    return factor.factor(difference) &&
           std::ranges::none_of(factor.pivots(), [](double pivot) { return pivot < 0; });
  };
  // No more than what a single degree of freedom has.
  const double most = c.diagonal().cwiseQuotient(k.diagonal()).minCoeff();
  if (!(most > 0)) return 0;  // one has no damping
  double high = most, low = most;
  do {
    high = low;
    low /= 2;
    if (!(low >= 1e-4 * most)) return 0;
  } while (!holds(low));
  while (high - low > 1e-3 * high) {
    const double middle = (low + high) / 2;
    (holds(middle) ? low : high) = middle;
  }
  return low;
}

RangeLimit smallest_exit(const DampingRange& range, const ExitsOf& exits, int samples) {
  RangeLimit limit{.h_max = std::numeric_limits<double>::infinity()};
  struct Place {
    std::size_t edge;
    double from, to;
  };
  std::vector<Place> places;
  for (std::size_t edge = 0; edge < range.corners.size(); ++edge) places.push_back({edge, 0, 1});
  constexpr int rounds = 4;
  for (int round = 0; round < rounds && !places.empty(); ++round) {
    std::vector<MechanicalMode> modes;
    std::vector<Place> around;
    for (const Place& place : places) {
      const MechanicalMode &from = range.corners[place.edge],
                           &to = range.corners[(place.edge + 1) % range.corners.size()];
      const std::vector<double> shares =
          round == 0 ? shares_of_edge(from, to, samples) : even_shares(place.from, place.to, samples);
      for (std::size_t i = 0; i < shares.size(); ++i) {
        const MechanicalMode mode = between(from, to, shares[i]);
        if (!oscillates(mode)) continue;
        modes.push_back(mode);
        around.push_back({place.edge, shares[i > 0 ? i - 1 : 0], shares[std::min(i + 1, shares.size() - 1)]});
      }
    }
    if (modes.empty()) break;
    const std::vector<double> h = exits(modes);
    const auto least = static_cast<std::size_t>(std::ranges::min_element(h) - h.begin());
    if (h[least] < limit.h_max) limit = {h[least], modes[least]};
    if (!std::isfinite(limit.h_max) || limit.h_max == 0) break;
    places = {around[least]};
  }
  return limit;
}

}  // namespace hmax
