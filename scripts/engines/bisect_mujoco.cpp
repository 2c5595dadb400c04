/// The step limit of a scene of MuJoCo by bisection with the engine alone: bisect_mujoco SCENE.xml[@KEYFRAME]
/// H0 H1 [KICK]. It settles for twenty seconds with steps of at most H0; the kick is of 1e-6 m/s, and of as
/// much of each activation.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <mujoco/mujoco.h>
#include <random>
#include <string>
#include <vector>

#include "bisect.hpp"

static mjModel* m;
static mjData *rest, *d;
static double kick_size = 1e-6;

static double kinetic_energy() {
  std::vector<double> momentum(std::size_t(m->nv));
  mj_mulM(m, d, momentum.data(), d->qvel);
  double energy = mju_dot(momentum.data(), d->qvel, m->nv) / 2;
  // Of activations as if they were velocities of 1 kg.
  for (int i = 0; i < m->na; ++i) energy += std::pow(d->act[i] - rest->act[i], 2) / 2;
  return energy;
}

static bool grows(double h, int steps) {
  mj_copyData(d, m, rest);
  m->opt.timestep = h;
  std::mt19937 numbers(7);
  std::normal_distribution<double> kick(0, kick_size);
  for (int i = 0; i < m->nv; ++i) d->qvel[i] += kick(numbers);
  for (int i = 0; i < m->na; ++i) d->act[i] += kick(numbers);
  return energy_grows(kinetic_energy(), 1e5, steps, [&] {
    mj_step(m, d);
    for (int w : {mjWARN_BADQPOS, mjWARN_BADQVEL, mjWARN_BADQACC})
      if (d->warning[w].number > rest->warning[w].number) return std::numeric_limits<double>::infinity();
    return kinetic_energy();
  });
}

int main(int count, char** arguments) {
  char reason[500];
  const std::string scene = arguments[1], file = scene.substr(0, scene.find('@'));
  m = mj_loadXML(file.c_str(), nullptr, reason, sizeof reason);
  if (!m) return std::fprintf(stderr, "%s\n", reason), 2;
  rest = mj_makeData(m);
  d = mj_makeData(m);
  if (file != scene)
    mj_resetDataKeyframe(m, rest, mj_name2id(m, mjOBJ_KEY, scene.substr(file.size() + 1).c_str()));
  if (count > 4) kick_size = std::atof(arguments[4]);
  m->opt.timestep = std::min(m->opt.timestep, std::atof(arguments[2]));
  while (rest->time < 20) mj_step(m, rest);
  return print_limit(std::atof(arguments[2]), std::atof(arguments[3]), 40000, grows);
}
