/// What keeps a method from a problem.
#pragma once

#include <string>

namespace hmax {

struct Method;
struct Problem;

/// What a method needs and a problem does not have, "steps positions and velocities, which van_der_pol does
/// not have"; empty where suits() (catalogue/methods/method.hpp) holds.
std::string why_unsuited(const Method& method, const Problem& problem);

}  // namespace hmax
