/// The step limit of a scene of Bullet by bisection with the engine alone: bisect_bullet SCENE H0 H1 [STEPS].
#include <cstdlib>
#include <random>

#include "bisect.hpp"
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
  return energy_grows(energy_of(scene), 1000, steps, [&] {
    scene.step(btScalar(h));
    return energy_of(scene);
  });
}

int main(int count, char** arguments) {
  return print_limit(std::atof(arguments[2]), std::atof(arguments[3]),
                     count > 4 ? std::atoi(arguments[4]) : 20000,
                     [&](double h, int steps) { return grows(arguments[1], h, steps); });
}
