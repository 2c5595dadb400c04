/// The step limit of a scene of Bullet by bisection with the engine alone: bisect_bullet SCENE H0 H1 [STEPS].
/// Nothing of hmax is in it. After a kick the kinetic energy is watched over windows of steps; it grows where
/// the largest of the last fifth exceeds that of the second fifth ten times, or what the kick gave a thousand
/// times.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>

#include "bullet_scenes.hpp"

static double energy_of(const World& scene) {
  double energy = 0;
  for (const auto& body : scene.bodies)
    energy += body->getLinearVelocity().length2() + 0.01 * body->getAngularVelocity().length2();
  if (scene.soft)
    for (int i = 0; i < scene.soft->m_nodes.size(); ++i) energy += scene.soft->m_nodes[i].m_v.length2();
  return energy;
}

static bool grows(const char* name, double h, int steps) {
  World scene;
  if (!scene.build(name)) std::exit(2);
  std::mt19937 numbers(7);
  std::normal_distribution<double> normal(0, sizeof(btScalar) == 4 ? 1e-3 : 1e-6);
  const auto kick = [&] {
    return btVector3(btScalar(normal(numbers)), btScalar(normal(numbers)), btScalar(normal(numbers)));
  };
  for (auto& body : scene.bodies) {
    body->setLinearVelocity(body->getLinearVelocity() + kick());
    body->setAngularVelocity(body->getAngularVelocity() + 10 * kick());
  }
  if (scene.soft)
    for (int i = 0; i < scene.soft->m_nodes.size(); ++i)
      if (scene.soft->m_nodes[i].m_im > 0) scene.soft->m_nodes[i].m_v += kick();
  const double first = energy_of(scene);
  double second = 0, last = 0;
  for (int i = 0; i < steps; ++i) {
    scene.step(btScalar(h));
    const double energy = energy_of(scene);
    if (!std::isfinite(energy)) return true;
    if (5 * i >= steps && 5 * i < 2 * steps) second = std::max(second, energy);
    if (5 * i >= 4 * steps) last = std::max(last, energy);
  }
  return (last > 10 * second && last > first) || last > 1000 * first;
}

int main(int count, char** arguments) {
  const char* name = arguments[1];
  const double h0 = std::atof(arguments[2]), h1 = std::atof(arguments[3]);
  const int fine = count > 4 ? std::atoi(arguments[4]) : 20000, scan = fine / 10;
  if (grows(name, h0, scan)) return std::puts("grows at h0"), 1;
  double low = h0, high = h0;
  do {
    low = high;
    high = std::min(h1, 1.05 * high);
  } while (!grows(name, high, scan) && high < h1);
  if (high == h1 && !grows(name, h1, fine)) return std::puts("unbounded"), 0;
  low *= 0.95;
  while (high - low > 1e-4 * high) {
    const double middle = (low + high) / 2;
    (grows(name, middle, fine) ? high : low) = middle;
  }
  std::printf("%.7g\n", (low + high) / 2);
}
