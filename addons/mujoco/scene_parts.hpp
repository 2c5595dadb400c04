/// The parts of a scene of MuJoCo that give it its time scale.
#pragma once

#include <mujoco/mujoco.h>
#include <string>
#include <vector>

namespace hmax::mujoco {

/// Stiffness and damping are in the units of the file. Those of constraints are the two numbers of a solref
/// in the format (-stiffness, -damping), whatever format the file has.
struct Part {
  enum class Kind {
    joint,
    joint_limit,
    joint_friction,
    tendon,
    tendon_limit,
    tendon_friction,
    actuator,
    filter,
    equality,
    contact,
    pair,
    gravity,
    viscosity
  };
  Kind kind = Kind::joint;
  int id = 0;
  std::string name;  ///< as in the file; its number from 0 and what it belongs to where it has none
  double stiffness = 0, damping = 0;
};

const char* text_of(Part::Kind kind);

/// Those with a stiffness or a damping, up to `most`; joints, tendons and actuators first.
std::vector<Part> parts_of(const mjModel* model, std::size_t most);

/// Gives a part of `model` its stiffness and damping in `original`, times these factors.
void scale(mjModel* model, const mjModel* original, const Part& part, double stiffness, double damping);

}  // namespace hmax::mujoco
