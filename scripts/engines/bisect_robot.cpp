/// The step limit of a robot in Bullet by bisection with the engine alone: bisect_robot FILE.urdf H0 H1. The
/// file is read by addons/bullet; Bullet steps. It settles for 40 seconds with steps of H0.
#include <cstdlib>
#include <limits>
#include <random>
#include <vector>

#include "addons/bullet/scene.hpp"
#include "bisect.hpp"

int main(int, char** arguments) {
  const double h0 = std::atof(arguments[2]);
  const auto scene = hmax::bullet::multibody(arguments[1], "");
  if (scene->has_weight())
    for (double t = 0; t < 40; t += h0) scene->step(h0);
  std::vector<double> rest(scene->dim());
  scene->state(rest.data());
  return print_limit(h0, std::atof(arguments[3]), 40000, [&](double h, int steps) {
    scene->set_state(rest.data());
    std::vector<double> y = rest;
    std::mt19937 numbers(7);
    std::normal_distribution<double> kick(0, 1e-6);
    // Velocities are the last half, but for a quaternion.
    const std::size_t joints = (y.size() - (y.size() % 2 == 1 ? 13 : 0)) / 2, first = y.size() - joints;
    for (std::size_t i = first; i < y.size(); ++i) y[i] += kick(numbers);
    scene->set_state(y.data());
    // A robot that has come far from rest may fold and calm down elsewhere.
    const double begin = scene->kinetic_energy(), far = 1e9 * begin;
    return energy_grows(begin, 1e5, steps, [&] {
      const double energy = scene->step(h) ? scene->kinetic_energy() : far;
      return energy < far ? energy : std::numeric_limits<double>::infinity();
    });
  });
}
