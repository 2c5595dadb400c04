/// Starts of runs of structures near a mode, from products with their matrices: on one process, or each on
/// its unknowns.
#pragma once

#include <functional>
#include <span>

#include <Eigen/Core>

#include "bench/limits/mode_start.hpp"

namespace hmax {

/// Products with M and K of a structure, of whose unknowns this process has all or some. Vectors of shape
/// (n), its unknowns.
struct StructureProducts {
  using Vector = Eigen::VectorXd;
  std::function<Vector(const Vector&x)> mass_times, stiffness_times;
  /// Makes sums over these unknowns sums over all; empty where these are all.
  std::function<void(std::span<double>)> add_up = {};

  /// Products of vectors over all unknowns.
  [[nodiscard]] double summed(double own) const {
    if (add_up) add_up({&own, 1});
    return own;
  }
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
