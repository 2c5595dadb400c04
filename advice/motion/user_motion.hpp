/// A motion of the user's own: what acts on some points over time, from a file.
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "advice/motion/probing_motion.hpp"
#include "problems/tissue/loads.hpp"

namespace hmax {

/// Forces on points, or displacements that points are given, along x, y and z.
struct UserMotion {
  enum class Kind { forces, displacements };

  Kind kind = Kind::forces;
  std::string name;                      ///< of the file
  std::vector<TetMesh::Index> points{};  ///< that they act on; forces on none act at the far end of the body
  std::array<std::shared_ptr<const SampledCurve>, 3> along{};  ///< [N], of all points together, or [m]
  double t_end = 0;                                            ///< [s]
};

/// Reads CSV with a column t [s] from 0 on and the columns fx, fy, fz [N] or x, y, z [m]. Between its lines
/// the motion is smooth and does not overshoot.
/// @throws InputError  naming the file and what it lacks
UserMotion read_user_motion(const std::filesystem::path& file);

/// The motion of a body that rests under gravity, or the most of it that has an equilibrium, on which the
/// user's forces act in place of its load, or whose points move as the user says.
/// @throws InputError  for what is no body, and for displacements of no point
ProbingMotion probing_motion(const Problem& problem, const UserMotion& motion, const Watcher& watcher = {});

}  // namespace hmax
