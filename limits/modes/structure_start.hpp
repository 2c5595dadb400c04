/// Starts of runs of structures near a mode, from products with their matrices: on one process, or each on
/// its unknowns.
#pragma once

#include <functional>
#include <span>

#include <Eigen/Core>

#include "analysis/dynamics/growth.hpp"

namespace hmax {

/// A start and what measures what becomes of it.
struct ModeStart {
  Eigen::VectorXd rest;          ///< shape (dim)
  Eigen::VectorXd displacement;  ///< from rest: the mode and a little of everything else, shape (dim)
  Distance distance;
  Distance amplitude =
      {};  ///< of the mode alone, which takes no notice of others; empty where it is not known
  /// Of a structure for a mode of shape u, u^T M u = 1: its velocity u^T M v and what its displacement is a
  /// step of size h, u^T M q / h. No other mode has a part in them where the motion decouples; and little,
  /// where u is the shape that begins to grow of a structure whose steps couple its modes. Empty for others.
  std::function<MotionOf(double h)> motion = {};
  /// The share that others may have in `motion`.
  double disturbance = 1e-6;
  /// The distance of everything but that mode from rest: of y less u (u^T M q, u^T M v); empty where `motion`
  /// is.
  Distance beside = {};
  bool defective = false;  ///< the mode shares its eigenvector with another
  /// The rest is so little of the distance that growth of the mode shows at once, without waiting for it to
  /// die away.
  bool mode_alone = false;
  bool large = false;  ///< a step takes a hundredth of a second or more: runs are as short as they may be
};

/// Products with M and K of a structure, of whose unknowns this process has all or some. Vectors of shape
/// (n), its unknowns.
struct StructureProducts {
  using Vector = Eigen::VectorXd;
  std::function<Vector(const Vector&x)> mass_times, stiffness_times;
  /// Makes sums over these unknowns sums over all; empty where these are all.
  std::function<void(std::span<double>)> add_up = {};

  /// Products of vectors over all unknowns.
  [[nodiscard]] double summed(double own) const;
};

/// (v^T M v + q^T K q)^1/2 of the distance from rest, which no undamped motion changes.
Distance energy_from(const Eigen::VectorXd& rest, const StructureProducts& products);

/// From the displacement q and the velocity v, with velocities along `noise` of a hundredth of their energy
/// norm, all to the length 1; the distance is in energy.
ModeStart energy_start(const StructureProducts& products, const Eigen::VectorXd& rest,
                       const Eigen::VectorXd& q, const Eigen::VectorXd& v, const Eigen::VectorXd& noise);

/// |u^T ((lambda M + C) q + M v)|: for symmetric M, C, K that row is the left eigenvector of the mode, so
/// that no other takes part.
/// @param of_position, of_velocity  (lambda M + C) u and M u, shape (n)
Distance amplitude_from(const Eigen::VectorXd& rest, const Eigen::VectorXcd& of_position,
                        const Eigen::VectorXcd& of_velocity, const StructureProducts& products);

/// Follows the motion of a shape, u^T M u = 1.
void follow(ModeStart& start, const StructureProducts& products, const Eigen::VectorXd& shape);

}  // namespace hmax
