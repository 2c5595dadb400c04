/// Where runs begin that look for the growth of one mode, and how far from rest they are then.
#pragma once

#include "analysis/amplification/amplification.hpp"
#include "analysis/dynamics/growth.hpp"
#include "bench/limits/operating_point.hpp"
#include "core/size_limits.hpp"

namespace hmax {

/// A start and what measures what becomes of it.
struct ModeStart {
  Eigen::VectorXd rest;          ///< shape (dim)
  Eigen::VectorXd displacement;  ///< from rest: the mode and a little of everything else, shape (dim)
  Distance distance;
  Distance amplitude =
      {};  ///< of the mode alone, which takes no notice of others; empty where it is not known
  /// Of a structure for a mode of shape u, u^T M u = 1: its velocity u^T M v and what its displacement is a step of size h,
  /// u^T M q / h. No other mode has a part in them where the motion decouples; and little, where u is the shape that begins to
  /// grow of a structure whose steps couple its modes. Empty for others.
  std::function<MotionOf(double h)> motion = {};
  /// The share that others may have in `motion`.
  double disturbance = 1e-6;
  /// The distance of everything but that mode from rest: of y less u (u^T M q, u^T M v); empty where `motion` is.
  Distance beside = {};
  bool defective = false;  ///< the mode shares its eigenvector with another
  /// The rest is so little of the distance that growth of the mode shows at once, without waiting for it to
  /// die away.
  bool mode_alone = false;
  bool large = false;  ///< a step takes a hundredth of a second or more: runs are as short as they may be
};

/// Near the eigenvalue `wanted`, with a hundredth of everything else. The distance is that in the modes of
/// the model, where it has a full set of them, or in a norm like energy.
/// @param fastest  |lambda| of the fastest mode [1/s]
ModeStart start_from_mode(const Linearised& near, const Eigen::VectorXd& rest, Complex wanted,
                          double fastest);

/// From a displacement x of shape (dofs) that changes its sign in every step h, with the velocity 2 x / h
/// that this takes and a hundredth of its energy in everything else; the distance is in energy. Without
/// velocity strong damping would leave nearly all of it to creep.
ModeStart start_from_shape(const MechanicalPart& part, const Eigen::VectorXd& rest,
                           const Eigen::VectorXd& shape, double h);

/// The shape of a mode of a structure whose motion decouples, u^T M u = 1, shape (dofs).
Eigen::VectorXd shape_of_mode(const Linearised& near, const MechanicalMode& mode);

/// The oscillation of `near` that has an eigenvalue nearest to lambda.
MechanicalMode oscillation_of(const Linearised& near, Complex lambda);

}  // namespace hmax
