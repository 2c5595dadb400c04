/// The step limit of a scene of MuJoCo by bisection with the engine alone: bisect_mujoco SCENE.xml H0 H1.
/// The kick is of 1e-6 m/s.
#include <cstdlib>
#include <limits>
#include <mujoco/mujoco.h>
#include <random>
#include <vector>

#include "bisect.hpp"

static mjModel* m;
static mjData *rest, *d;

static double kinetic_energy() {
  std::vector<double> momentum(std::size_t(m->nv));
  mj_mulM(m, d, momentum.data(), d->qvel);
  return mju_dot(momentum.data(), d->qvel, m->nv) / 2;
}

static bool grows(double h, int steps) {
  mj_copyData(d, m, rest);
  m->opt.timestep = h;
  std::mt19937 numbers(7);
  std::normal_distribution<double> kick(0, 1e-6);
  for (int i = 0; i < m->nv; ++i) d->qvel[i] += kick(numbers);
  return energy_grows(kinetic_energy(), 1e5, steps, [&] {
    mj_step(m, d);
    for (int w : {mjWARN_BADQPOS, mjWARN_BADQVEL, mjWARN_BADQACC})
      if (d->warning[w].number > rest->warning[w].number) return std::numeric_limits<double>::infinity();
    return kinetic_energy();
  });
}

int main(int, char** arguments) {
  char reason[500];
  m = mj_loadXML(arguments[1], nullptr, reason, sizeof reason);
  if (!m) return std::fprintf(stderr, "%s\n", reason), 2;
  rest = mj_makeData(m);
  d = mj_makeData(m);
  while (rest->time < 20) mj_step(m, rest);
  return print_limit(std::atof(arguments[2]), std::atof(arguments[3]), 40000, grows);
}
