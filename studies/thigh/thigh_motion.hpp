/// A thigh that moves while a probe presses it: linearly implicit Euler with a constant Jacobian beside
/// explicit methods.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "catalogue/methods/method.hpp"
#include "results/json.hpp"
#include "studies/thigh/thigh_model.hpp"

namespace hmax {

/// What moves, and what moves it. Masses and damping are assumptions.
struct ThighLoad {
  double mass = 0.01;   ///< of a point [kg]
  double damping = 50;  ///< force over velocity and mass [1/s]
  Eigen::Index point = 0;
  Probe probe = Probe::surface;
  double depth = 0.016;  ///< of the pressed points in equilibrium under the whole force [m]
  double rise = 0.1;     ///< the force grows, stays for two such times, falls and leaves the thigh free [s]
};

/// What acts on a thigh that moves.
struct ThighDrive {
  double mass, damping;                   ///< as in ThighLoad
  Eigen::VectorXd force;                  ///< f, shape (points) [N]
  std::function<double(double t)> share;  ///< g [1]
  Eigen::VectorXd springs;                ///< k of each point to where it rests, shape (points) [N/m]
};

/// M u'' = g(t) f - k u - r(u) - c M u', u as in Thigh, y = (u, u'), from rest.
Problem driven_thigh(const Thigh& thigh, ThighDrive drive, double t_end);

/// A thigh whose f holds it at load.depth without further springs, while g rises and falls as half a cosine.
/// To six times load.rise.
/// @throws std::invalid_argument  for masses, dampings, depths and times that are not positive
Problem moving_thigh(const Thigh& thigh, const ThighLoad& load);

/// The largest stable steps of a method for small motions at rest and under the whole force [s]; 0 where
/// every step is unstable, infinity where none is.
struct ThighLimit {
  std::string method;
  double h_rest = 0, h_pressed = 0;
};
HMAX_RECORD(ThighLimit, method, h_rest, h_pressed);
std::vector<ThighLimit> thigh_limits(const std::vector<std::string>& methods, const Thigh& thigh,
                                     const ThighLoad& load);

/// The mass of a point [kg] from which a method is stable with steps of `h` under the whole force, to one
/// part in a hundred, with the same damping of a mass; the mass of `load` where that is enough, infinity
/// where a million times as much is not.
double stable_mass(const std::string& method, const Thigh& thigh, ThighLoad load, double h);

/// The depth of the point that sinks deepest when the same force acts inwards on every point, as weight does
/// [m].
double deepest_under(const Thigh& thigh, double force);

/// How much of its largest depth the pressed point has left at the end of a run of the load [1].
double share_left(const Thigh& thigh, const ThighLoad& load);

/// The period of the slowest motion at rest without damping, for points of some mass [s].
double slowest_period(const Thigh& thigh, double mass);

/// How deep the probe may press each point until steps of `h` of linearly implicit Euler with the Jacobian of
/// rest are unstable, shape (points) [m]; infinity where they are stable up to `most`. With K at the depth
/// and K0 at rest a step is (M + h C + h^2 K0) v' = M v - h K x, x' = x + h v', stable
/// where 4 M + 2 h C + 2 h^2 K0 - h^2 K is positive definite.
Eigen::VectorXd constant_jacobian_depths(const Thigh& thigh, const ThighLoad& load, double h, double most);

/// The motion of the pressed point, sampled every 10 ms. A run that ends early has no error and no time.
struct ThighRun {
  std::string method;
  double h = 0;           ///< [s]
  bool constant = false;  ///< the Jacobian is that of the start
  bool reached_end = false;
  std::vector<double> t, u;  ///< [s], [m]
  double error = 0;          ///< largest difference to the reference over its largest value [1]; else NaN
  double real_time = 0;      ///< simulated over CPU time; else NaN
};

/// The reference, by an adaptive method of order 8 with rtol 1e-9, then linearly implicit Euler at 100 Hz
/// with a new Jacobian in each step and with that of the start, then explicit Euler at 100 Hz and symplectic
/// Euler at 1 kHz.
std::vector<ThighRun> thigh_runs(const Thigh& thigh, const ThighLoad& load);

}  // namespace hmax
