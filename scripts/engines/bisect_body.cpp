/// The step limit of a soft body in Bullet by bisection with the engine alone, which reads the mesh itself:
/// bisect_body FILE.vtk H0 H1 FORCE E NU BETA DENSITY PLANE. Points below PLANE z are fixed; FORCE is
/// neo_hookean or linear. Nothing of hmax is in it.
#include <BulletSoftBody/btDeformableBodySolver.h>
#include <BulletSoftBody/btDeformableLinearElasticityForce.h>
#include <BulletSoftBody/btDeformableMultiBodyConstraintSolver.h>
#include <BulletSoftBody/btDeformableMultiBodyDynamicsWorld.h>
#include <BulletSoftBody/btDeformableNeoHookeanForce.h>
#include <BulletSoftBody/btSoftBodyHelpers.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <btBulletDynamicsCommon.h>
#include <cstdlib>
#include <random>
#include <string>

#include "bisect.hpp"

int main(int, char** arguments) {
  const std::string force = arguments[4];
  const double E = std::atof(arguments[5]), nu = std::atof(arguments[6]), beta = std::atof(arguments[7]),
               density = std::atof(arguments[8]), plane = std::atof(arguments[9]);
  btSoftBodyRigidBodyCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher(&configuration);
  btDbvtBroadphase broadphase;
  auto* elastic_solver = new btDeformableBodySolver;
  btDeformableMultiBodyConstraintSolver solver;
  solver.setDeformableSolver(elastic_solver);
  btDeformableMultiBodyDynamicsWorld world(&dispatcher, &broadphase, &solver, &configuration, elastic_solver);
  world.setGravity(btVector3(0, 0, 0));
  world.setImplicit(false);
  btSoftBodyWorldInfo& info = world.getWorldInfo();
  info.m_gravity.setZero();
  btSoftBody* body = btSoftBodyHelpers::CreateFromVtkFile(info, arguments[1]);
  double volume = 0;
  for (int i = 0; i < body->m_tetras.size(); ++i) volume += std::abs(body->m_tetras[i].m_rv) / 6;
  const double mass = density * volume / body->m_nodes.size();
  std::vector<btVector3> rest;
  for (int i = 0; i < body->m_nodes.size(); ++i) {
    rest.push_back(body->m_nodes[i].m_x);
    body->setMass(i, rest.back().z() < plane ? 0 : mass);
  }
  body->m_cfg.collisions = 0;
  body->m_sleepingThreshold = 0;
  world.addSoftBody(body);
  body->setActivationState(DISABLE_DEACTIVATION);
  btDeformableNeoHookeanForce neo_hookean;
  neo_hookean.setYoungsModulus(E);
  neo_hookean.setPoissonRatio(nu);
  neo_hookean.setDamping(beta);
  btDeformableLinearElasticityForce linear;
  linear.setYoungsModulus(E);
  linear.setPoissonRatio(nu);
  linear.setDamping(0, beta);
  if (force == "linear")
    world.addForce(body, &linear);
  else
    world.addForce(body, &neo_hookean);
  const auto energy = [&] {
    double sum = 0;
    for (int i = 0; i < body->m_nodes.size(); ++i) sum += body->m_nodes[i].m_v.length2();
    return sum;
  };
  return print_limit(std::atof(arguments[2]), std::atof(arguments[3]), 4000, [&](double h, int steps) {
    std::mt19937 numbers(7);
    // Undamped below some 1e-5 m/s, see addons/bullet/soft_body.cpp.
    std::normal_distribution<double> kick(0, beta > 0 ? 1e-3 : 1e-6);
    for (int i = 0; i < body->m_nodes.size(); ++i) {
      btSoftBody::Node& node = body->m_nodes[i];
      node.m_x = node.m_q = rest[std::size_t(i)];
      node.m_v = node.m_vn =
          node.m_im > 0 ? btVector3(kick(numbers), kick(numbers), kick(numbers)) : btVector3(0, 0, 0);
    }
    return energy_grows(energy(), beta > 0 ? 30 : 1e3, steps, [&] {
      world.stepSimulation(h, 0);
      return energy();
    });
  });
}
