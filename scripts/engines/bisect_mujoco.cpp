/// The step limit of a scene of MuJoCo by bisection with the engine alone: bisect_mujoco SCENE.xml H0 H1.
/// Nothing of hmax is in it. After a kick of 1e-6 m/s the kinetic energy is watched over windows of steps; it
/// grows where the largest of the last fifth exceeds that of the second fifth ten times, or what the kick
/// gave 1e5 times.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <mujoco/mujoco.h>
#include <random>
#include <vector>

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
  const double first = kinetic_energy();
  double second = 0, last = 0;
  for (int i = 0; i < steps; ++i) {
    mj_step(m, d);
    for (int w : {mjWARN_BADQPOS, mjWARN_BADQVEL, mjWARN_BADQACC})
      if (d->warning[w].number > rest->warning[w].number) return true;
    const double energy = kinetic_energy();
    if (!std::isfinite(energy)) return true;
    if (5 * i >= steps && 5 * i < 2 * steps) second = std::max(second, energy);
    if (5 * i >= 4 * steps) last = std::max(last, energy);
  }
  return (last > 10 * second && last > first) || last > 1e5 * first;
}

int main(int, char** arguments) {
  char reason[500];
  m = mj_loadXML(arguments[1], nullptr, reason, sizeof reason);
  if (!m) return std::fprintf(stderr, "%s\n", reason), 2;
  rest = mj_makeData(m);
  d = mj_makeData(m);
  while (rest->time < 20) mj_step(m, rest);
  const double h0 = std::atof(arguments[2]), h1 = std::atof(arguments[3]);
  const int scan = 4000, fine = 40000;
  if (grows(h0, scan)) return std::puts("grows at h0"), 1;
  double low = h0, high = h0;
  do {
    low = high;
    high = std::min(h1, 1.05 * high);
  } while (!grows(high, scan) && high < h1);
  if (high == h1 && !grows(h1, fine)) return std::puts("unbounded"), 0;
  low *= 0.95;
  while (high - low > 1e-4 * high) {
    const double middle = (low + high) / 2;
    (grows(middle, fine) ? high : low) = middle;
  }
  std::printf("%.7g\n", (low + high) / 2);
}
