/// Scenes of Bullet, for its stepper and for the bisection with the engine alone. Built for float, or with
/// BT_USE_DOUBLE_PRECISION for double. A name, and for some =NUMBER:
///   chain     balls of 0.1 kg on springs of 1000 N/m between two walls; ten, or chain=NUMBER
///   torsion   a box on a torsion spring about each axis
///   hinge     a pendulum of two rods on hinges with torsion springs
///   box       a box that rests on the ground
///   hinges    eight rods on hinges with torsion springs and dampers, which hang; rods have damping
///   damped    five boxes in a row, springs at their corners turn them too; bodies have linear and angular
///   damping six       four boxes between walls, held by springs of btGeneric6DofSpring2Constraint six_old
///   the same with btGeneric6DofSpringConstraint cloth     a deformable cloth of 6 x 6 points, or
///   cloth=NUMBER, held at its corners, which hangs; explicit springs and dampers rope      a rope of
///   btSoftBody, which its solver of positions holds at one end
/// Springs of rigid bodies are forces before each step, but for the constraints.
#pragma once

#include <BulletSoftBody/btDeformableBodySolver.h>
#include <BulletSoftBody/btDeformableMultiBodyConstraintSolver.h>
#include <BulletSoftBody/btDeformableMultiBodyDynamicsWorld.h>
#include <BulletSoftBody/btSoftBody.h>
#include <BulletSoftBody/btSoftBodyHelpers.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>
#include <btBulletDynamicsCommon.h>
#include <memory>
#include <string>
#include <vector>

struct World {
  btSoftBodyRigidBodyCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher{&configuration};
  btDbvtBroadphase broadphase;
  btDeformableBodySolver deformable_solver;
  std::unique_ptr<btSequentialImpulseConstraintSolver> solver;
  std::unique_ptr<btDiscreteDynamicsWorld> world;
  std::vector<std::unique_ptr<btCollisionShape>> shapes;
  std::vector<std::unique_ptr<btRigidBody>> bodies;  // that move
  std::vector<std::unique_ptr<btRigidBody>> fixed;
  std::vector<std::unique_ptr<btTypedConstraint>> joints;
  std::unique_ptr<btDeformableLagrangianForce> elasticity, gravity;
  btSoftBody* soft = nullptr;
  btSoftBodyWorldInfo info;
  std::string scene, reason;

  ~World() {
    if (!world) return;
    if (soft) {
      if (auto* w = dynamic_cast<btDeformableMultiBodyDynamicsWorld*>(world.get()))
        w->removeSoftBody(soft);
      else
        static_cast<btSoftRigidDynamicsWorld*>(world.get())->removeSoftBody(soft);
      delete soft;
    }
    for (auto& joint : joints) world->removeConstraint(joint.get());
    for (auto& body : bodies) world->removeRigidBody(body.get());
    for (auto& body : fixed) world->removeRigidBody(body.get());
  }

  btRigidBody* add(btCollisionShape* shape, btScalar mass, const btVector3& at, bool collides = false) {
    shapes.emplace_back(shape);
    btVector3 inertia(0, 0, 0);
    if (mass > 0) shape->calculateLocalInertia(mass, inertia);
    auto body = std::make_unique<btRigidBody>(mass, nullptr, shape, inertia);
    body->setWorldTransform(btTransform(btQuaternion::getIdentity(), at));
    body->setInterpolationWorldTransform(body->getWorldTransform());
    body->setActivationState(DISABLE_DEACTIVATION);
    world->addRigidBody(body.get(), 1, collides ? 1 : 0);
    auto& owner = mass > 0 ? bodies : fixed;
    owner.push_back(std::move(body));
    return owner.back().get();
  }
  btRigidBody* add_box(btScalar x, btScalar y, btScalar z, btScalar mass, const btVector3& at) {
    return add(new btBoxShape(btVector3(x, y, z)), mass, at);
  }
  void settle(btScalar h, int steps) {
    for (int i = 0; i < steps; ++i) step(h);
  }

  bool build(const std::string& argument) {
    const std::string name = argument.substr(0, argument.find('='));
    const int number = argument == name ? 0 : std::stoi(argument.substr(name.size() + 1));
    scene = name;
    if (name == "cloth") {
      auto* of_deformables = new btDeformableMultiBodyConstraintSolver;
      of_deformables->setDeformableSolver(&deformable_solver);
      solver.reset(of_deformables);
      world = std::make_unique<btDeformableMultiBodyDynamicsWorld>(&dispatcher, &broadphase, of_deformables,
                                                                   &configuration, &deformable_solver);
    } else if (name == "rope") {
      solver = std::make_unique<btSequentialImpulseConstraintSolver>();
      world =
          std::make_unique<btSoftRigidDynamicsWorld>(&dispatcher, &broadphase, solver.get(), &configuration);
    } else {
      solver = std::make_unique<btSequentialImpulseConstraintSolver>();
      world =
          std::make_unique<btDiscreteDynamicsWorld>(&dispatcher, &broadphase, solver.get(), &configuration);
    }
    const bool weightless =
        name == "chain" || name == "torsion" || name == "damped" || name.starts_with("six");
    world->setGravity(btVector3(0, 0, weightless ? 0 : btScalar(-9.81)));
    if (name == "chain") {
      for (int i = 1; i <= (number ? number : 10); ++i)
        add(new btSphereShape(btScalar(0.01)), btScalar(0.1), btVector3(btScalar(0.1) * i, 0, 0));
    } else if (name == "torsion") {
      add_box(btScalar(0.1), btScalar(0.2), btScalar(0.3), 1, btVector3(0, 0, 0));
    } else if (name == "hinge") {
      hang_rods(2, btScalar(0.2), 0, btScalar(0.15));
    } else if (name == "hinges") {
      hang_rods(8, btScalar(0.15), btScalar(0.2), btScalar(0.1));
      settle(btScalar(0.001), 20000);
    } else if (name == "box") {
      add(new btBoxShape(btVector3(1, 1, btScalar(0.5))), 0, btVector3(0, 0, btScalar(-0.5)), true);
      add(new btBoxShape(btVector3(btScalar(0.1), btScalar(0.1), btScalar(0.1))), 1,
          btVector3(0, 0, btScalar(0.1)), true);
      settle(btScalar(0.001), 2000);
    } else if (name == "damped") {
      for (int i = 0; i < 5; ++i) {
        btRigidBody* box = add_box(btScalar(0.05), btScalar(0.05), btScalar(0.05),
                                   btScalar(0.2) + btScalar(0.05) * i, btVector3(btScalar(0.2) * i, 0, 0));
        box->setDamping(btScalar(0.2), btScalar(0.3));
      }
    } else if (name.starts_with("six")) {
      build_six(name == "six");
    } else if (name == "cloth") {
      build_cloth(number ? number : 6);
    } else if (name == "rope") {
      build_rope();
    } else {
      return false;
    }
    return true;
  }

  void hang_rods(int count, btScalar mass, btScalar damping, btScalar half) {
    for (int i = 0; i < count; ++i) {
      btRigidBody* rod =
          add_box(btScalar(0.02), btScalar(0.02), half, mass, btVector3(0, 0, -half * (1 + 2 * i)));
      rod->setDamping(damping, damping);
      const btVector3 top(0, 0, half), axis(0, 1, 0);
      joints.emplace_back(
          i == 0 ? new btHingeConstraint(*rod, top, axis)
                 : new btHingeConstraint(*rod, *bodies[std::size_t(i) - 1], top, -top, axis, axis));
      world->addConstraint(joints.back().get(), true);
    }
  }

  void build_six(bool newer) {
    btRigidBody* before = add_box(btScalar(0.05), btScalar(0.05), btScalar(0.05), 0, btVector3(0, 0, 0));
    for (int i = 1; i <= 5; ++i) {
      btRigidBody* box = add_box(btScalar(0.05), btScalar(0.05), btScalar(0.05), i < 5 ? btScalar(0.4) : 0,
                                 btVector3(btScalar(0.3) * i, 0, 0));
      const btTransform left(btQuaternion::getIdentity(), btVector3(btScalar(0.15), 0, 0)),
          right(btQuaternion::getIdentity(), btVector3(btScalar(-0.15), 0, 0));
      const auto free_with_springs = [](auto* joint, const auto& set) {
        for (int k = 0; k < 6; ++k) {
          joint->setLimit(k, 1, -1);  // free
          joint->enableSpring(k, true);
          set(k, k < 3 ? btScalar(500) : btScalar(3));
        }
        joint->setEquilibriumPoint();
      };
      if (newer) {
        auto* joint = new btGeneric6DofSpring2Constraint(*before, *box, left, right);
        free_with_springs(joint, [&](int k, btScalar stiffness) {
          joint->setStiffness(k, stiffness, false);
          joint->setDamping(k, k < 3 ? btScalar(0.4) : btScalar(0.002), false);
        });
        joints.emplace_back(joint);
      } else {
        auto* joint = new btGeneric6DofSpringConstraint(*before, *box, left, right, true);
        free_with_springs(joint, [&](int k, btScalar stiffness) { joint->setStiffness(k, stiffness); });
        joints.emplace_back(joint);
      }
      world->addConstraint(joints.back().get(), true);
      before = box;
    }
  }

  void build_cloth(int side) {
    auto* deformable = static_cast<btDeformableMultiBodyDynamicsWorld*>(world.get());
    info.m_broadphase = &broadphase;
    info.m_dispatcher = &dispatcher;
    info.m_gravity.setValue(0, 0, btScalar(-9.81));
    info.m_sparsesdf.Initialize();
    const btScalar s = btScalar(0.25);
    soft =
        btSoftBodyHelpers::CreatePatch(info, btVector3(-s, -s, 0), btVector3(s, -s, 0), btVector3(-s, s, 0),
                                       btVector3(s, s, 0), side, side, 1 + 2 + 4 + 8, true);
    soft->setTotalMass(btScalar(0.01) * side * side);
    for (const int corner : {0, side - 1, side * (side - 1), side * side - 1}) soft->setMass(corner, 0);
    soft->m_cfg.collisions = 0;
    soft->m_sleepingThreshold = 0;
    deformable->addSoftBody(soft);
    elasticity = std::make_unique<btDeformableMassSpringForce>(btScalar(150), btScalar(0.05), false);
    gravity = std::make_unique<btDeformableGravityForce>(btVector3(0, 0, btScalar(-9.81)));
    deformable->addForce(soft, elasticity.get());
    deformable->addForce(soft, gravity.get());
    deformable->setImplicit(false);
    soft->setActivationState(DISABLE_DEACTIVATION);
    settle(btScalar(0.001), 20000);
  }

  void build_rope() {
    auto* softs = static_cast<btSoftRigidDynamicsWorld*>(world.get());
    softs->getWorldInfo().m_gravity.setValue(0, 0, btScalar(-9.81));
    softs->getWorldInfo().m_sparsesdf.Initialize();
    soft =
        btSoftBodyHelpers::CreateRope(softs->getWorldInfo(), btVector3(0, 0, 0), btVector3(0, 0, -1), 8, 1);
    soft->setTotalMass(btScalar(0.2));
    soft->m_cfg.kDP = btScalar(0.01);
    soft->m_cfg.piterations = 4;
    soft->m_cfg.collisions = 0;
    softs->addSoftBody(soft);
    soft->setActivationState(DISABLE_DEACTIVATION);
    settle(btScalar(0.01), 5000);
  }

  void step(btScalar h) {
    apply_springs();
    world->stepSimulation(h, 0);
  }

  // The rotation of a body about an axis from its first position, for small angles.
  static btVector3 turned(const btRigidBody& body) {
    const btQuaternion q = body.getOrientation();
    return btVector3(q.x(), q.y(), q.z()) * (q.w() < 0 ? -2 : 2);
  }

  void apply_springs() {
    if (scene == "chain") {
      const btScalar k = 1000;
      const auto off = [&](std::size_t i) {
        return i < 1 || i > bodies.size() ? btVector3(0, 0, 0)
                                          : bodies[i - 1]->getWorldTransform().getOrigin() -
                                                btVector3(btScalar(0.1) * btScalar(i), 0, 0);
      };
      for (std::size_t i = 1; i <= bodies.size(); ++i)
        bodies[i - 1]->applyCentralForce(k * (off(i - 1) + off(i + 1) - 2 * off(i)));
    } else if (scene == "torsion") {
      bodies[0]->applyTorque(-20 * turned(*bodies[0]));
    } else if (scene == "hinge" || scene == "hinges") {
      const btScalar scale = scene == "hinge" ? 10 : 4;
      for (std::size_t i = 0; i < bodies.size(); ++i) {
        const btVector3 none(0, 0, 0), at = i > 0 ? turned(*bodies[i - 1]) : none,
                                       spin = i > 0 ? bodies[i - 1]->getAngularVelocity() : none;
        btVector3 torque = -(i == 0 && scene == "hinge" ? 3 * scale : scale) * (turned(*bodies[i]) - at);
        if (scene == "hinges") torque -= btScalar(0.002) * (bodies[i]->getAngularVelocity() - spin);
        bodies[i]->applyTorque(torque);
        if (i > 0) bodies[i - 1]->applyTorque(-torque);
      }
    } else if (scene == "damped") {
      const btScalar a = btScalar(0.05);
      for (std::size_t i = 0; i + 1 < bodies.size(); ++i)
        for (const btScalar y : {-a, a})
          for (const btScalar z : {-a, a})
            pull(*bodies[i], btVector3(a, y, z), *bodies[i + 1], btVector3(-a, y, -z), 400);
    }
  }

  // A spring between two points of two bodies, without length at rest 0.1 m away along x.
  static void pull(btRigidBody& one, const btVector3& p, btRigidBody& other, const btVector3& q, btScalar k) {
    const btVector3 arm = one.getWorldTransform().getBasis() * p,
                    far = other.getWorldTransform().getBasis() * q;
    const btVector3 rest(btScalar(0.1), 0, q.z() - p.z());
    const btVector3 force =
        k * (other.getWorldTransform().getOrigin() + far - one.getWorldTransform().getOrigin() - arm - rest);
    one.applyForce(force, arm);
    other.applyForce(-force, far);
  }

  void forget_contacts() {
    for (auto& body : bodies)
      broadphase.getOverlappingPairCache()->cleanProxyFromPairs(body->getBroadphaseHandle(), &dispatcher);
    solver->reset();
    for (auto& joint : joints) joint->internalSetAppliedImpulse(0);
  }
};
