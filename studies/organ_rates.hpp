/// What the organs of the thesis cost a step on this machine.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "results/json.hpp"

namespace hmax {

/// Linearly implicit Euler with the Jacobian of the start, one step a frame.
struct ConstantJacobian {
  std::string mesh, model;
  long tetrahedra = 0, springs = 0;  ///< springs: of the model, or edges of the mesh
  double asked = 0;                  ///< steps a second of the thesis: 1 / h [1/s]
  bool reached_end = false;
  double error =
      0;  ///< largest distance of a point from the motion, relative to the largest displacement [1]
  double p50 = 0, p99 = 0;  ///< CPU time of a step, median and 99 % [s]
  double rate = 0;          ///< 1 / p50 [1/s]
};
HMAX_RECORD(ConstantJacobian, mesh, model, tetrahedra, springs, asked, reached_end, error, p50, p99, rate);
/// Of springs and Green's strain at 100 Hz, and of springs across faces and edges as well at 150 Hz, pressed
/// as `hmax advise` presses a body.
/// @param material  of the liver table, "male_normal"
std::vector<ConstantJacobian> constant_jacobians(const std::vector<std::string>& meshes,
                                                 std::string_view material);

/// What springs and finite elements cost beside each other.
struct ModelCost {
  std::string mesh, model;
  double force = 0;  ///< CPU time of the forces [s]
  double plain = 0;  ///< of the same forces by plain scalar loops [s]
  double step = 0;   ///< of a step of linearly implicit Euler [s]
};
HMAX_RECORD(ModelCost, mesh, model, force, plain, step);
/// Of springs, then of Green's strain, on each mesh at rest; the least of seven samples each.
std::vector<ModelCost> model_costs(const std::vector<std::string>& meshes, std::string_view material);

/// Newton iterations a second of a pressed body, linear systems solved directly [1/s].
double newton_rate(std::string_view mesh, std::string_view material);

}  // namespace hmax
