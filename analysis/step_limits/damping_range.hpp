/// Between which damping and stiffness the modes of a structure lie whose damping couples its modes.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "analysis/amplification/curve_limit.hpp"
#include "analysis/spectrum/linear_model.hpp"
#include "analysis/spectrum/modes.hpp"
#include "analysis/spectrum/scaled_matrices.hpp"

namespace hmax {

/// Every eigenvalue of (lambda^2 M + lambda C + K) u = 0 solves
///   lambda^2 + gamma lambda + kappa = 0,  gamma = u* C u, kappa = u* K u, u* M u = 1,
/// and the pairs (gamma, kappa) of all shapes u are a convex set, the numerical range of c + i k
/// [horn1991topics, chapter 1]. This is a polygon around it.
struct DampingRange {
  std::vector<MechanicalMode> corners;  ///< in their order around it

  /// Leaves what has a gamma + b kappa <= c.
  void cut(double a, double b, double c);
};

/// Tangents to the range in some twenty directions, each found when it is asked for, once, by any thread.
/// The tangent in the direction (cos t, sin t) is gamma cos t + kappa sin t <= the largest eigenvalue of c
/// cos t + k sin t, in scaled units, by Lanczos iteration, or Davidson's method where the mass couples;
/// residuals are added to the eigenvalues, so that the half plane contains the range.
class RangeTangents {
 public:
  /// @param matrices              K and C symmetric, without negative eigenvalues
  /// @param gamma_max, kappa_max  no less than the largest of them, and not much more [1/s], [1/s^2]
  RangeTangents(std::shared_ptr<const ScaledMatrices> matrices, double gamma_max, double kappa_max);
  /// The same of matrices that are elsewhere.
  RangeTangents(const FindLargestOfSum& find, double gamma_max, double kappa_max);

  /// gamma and kappa between 0 and the largest.
  [[nodiscard]] DampingRange box() const;
  [[nodiscard]] std::size_t size() const;
  /// Cuts what lies beyond tangent i.
  void cut(DampingRange& range, std::size_t i);
  /// How far beyond those of `inside`, which lie in the range, `mode` lies in the direction of tangent i, in
  /// units of the box: where that is not positive the tangent leaves `mode`.
  [[nodiscard]] double beyond(std::size_t i, const MechanicalMode& mode,
                              std::span<const MechanicalMode> inside) const;

 private:
  struct Tangent {
    std::once_flag once;
    double offset = 0;
  };
  /// No less than the largest eigenvalue of a c + b k.
  std::function<double(double a, double b)> offset_of_;
  double gamma_, kappa_;  ///< the largest [1/s], [1/s^2]
  std::vector<Tangent> tangents_;
};

/// The largest rho to three digits for which gamma >= rho kappa of all shapes [s]: C - rho K has no negative
/// pivot (Sylvester's law of inertia). Tells more than the tangents of slow modes, and takes some ten
/// factors.
/// @return  0 where none is found
double least_damping_per_stiffness(const MechanicalPart& part);

/// The smallest first exit in a range, and where.
struct RangeLimit {
  double h_max = 0;  ///< [s]; infinity without one
  MechanicalMode mode{};
};

/// The smallest first exit of oscillating pairs, gamma^2 < 4 kappa, of the range. An exit falls with the rate
/// of a mode whose ratio of damping is kept, so that it lies on the edge of the range.
RangeLimit smallest_exit(const DampingRange& range, const ExitsOf& exits, int samples = 32);

}  // namespace hmax
