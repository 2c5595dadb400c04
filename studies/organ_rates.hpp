/// What the organs of the thesis cost a step on this machine.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "studies/record.hpp"

namespace hmax {

/// Linearly implicit Euler with the Jacobian of the start, one step a frame.
struct ConstantJacobian {
  std::string mesh, model;
  long tetrahedra = 0, springs = 0;  ///< springs: edges of the mesh
  bool reached_end = false;
  double error =
      0;  ///< largest distance of a point from the motion, relative to the largest displacement [1]
  double p50 = 0, p99 = 0;  ///< CPU time of a step, median and 99 % [s]
  double rate = 0;          ///< 1 / p50 [1/s]
};
HMAX_RECORD(ConstantJacobian, mesh, model, tetrahedra, springs, reached_end, error, p50, p99, rate);
/// Of springs and Green's strain, pressed as `hmax advise` presses a body, at 100 Hz.
/// @param material  of the liver table, "male_normal"
std::vector<ConstantJacobian> constant_jacobians(const std::vector<std::string>& meshes,
                                                 std::string_view material);

/// Newton iterations a second of a pressed body, linear systems solved directly [1/s].
double newton_rate(std::string_view mesh, std::string_view material);

}  // namespace hmax
