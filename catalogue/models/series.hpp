/// Stored curves of the oscillator: what figures of motion are drawn from.
#pragma once

#include "catalogue/methods/method.hpp"
#include "results/table.hpp"

namespace hmax {

/// The motion of an oscillator on [0, t_end], read off the method's dense output every `every` seconds:
/// columns "t [s]", "x [m]", "v [m/s]", "a [m/s^2]"; the acceleration is the right-hand side at the point.
/// The notes say problem, parameters, start, method, tolerance and outcome. A run that ends early gives a
/// shorter table.
/// @throws InputError  when check() refuses the run, or the problem is no oscillator
Table motion(const Problem& problem, const Method& method, double tolerance, double t_end, double every);

}  // namespace hmax
