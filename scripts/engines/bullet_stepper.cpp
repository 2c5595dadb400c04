/// A stepper for `hmax probe`: scenes of Bullet, which computes in float. The argument is one of
///   chain    balls of 0.1 kg on springs of 1000 N/m between two walls; ten, or chain=NUMBER
///   torsion  a box on a torsion spring about each axis
///   hinge    a pendulum of two rods on hinges with torsion springs
///   box      a box that rests on the ground
/// Springs are forces before each step. Contacts begin anew from a state that is set or restored.
#include <btBulletDynamicsCommon.h>
#include <cstring>
#include <hmax/plugin.h>
#include <memory>
#include <string>
#include <vector>

namespace {

struct World {
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher{&configuration};
  btDbvtBroadphase broadphase;
  btSequentialImpulseConstraintSolver solver;
  btDiscreteDynamicsWorld world{&dispatcher, &broadphase, &solver, &configuration};
  std::vector<std::unique_ptr<btCollisionShape>> shapes;
  std::vector<std::unique_ptr<btRigidBody>> bodies;  // that move
  std::vector<std::unique_ptr<btRigidBody>> fixed;
  std::vector<std::unique_ptr<btTypedConstraint>> joints;
  std::string scene, reason;

  ~World() {
    for (auto& joint : joints) world.removeConstraint(joint.get());
    for (auto& body : bodies) world.removeRigidBody(body.get());
    for (auto& body : fixed) world.removeRigidBody(body.get());
  }

  btRigidBody* add(btCollisionShape* shape, btScalar mass, const btVector3& at, bool collides) {
    shapes.emplace_back(shape);
    btVector3 inertia(0, 0, 0);
    if (mass > 0) shape->calculateLocalInertia(mass, inertia);
    auto body = std::make_unique<btRigidBody>(mass, nullptr, shape, inertia);
    body->setWorldTransform(btTransform(btQuaternion::getIdentity(), at));
    body->setInterpolationWorldTransform(body->getWorldTransform());
    body->setActivationState(DISABLE_DEACTIVATION);
    world.addRigidBody(body.get(), 1, collides ? 1 : 0);
    auto& owner = mass > 0 ? bodies : fixed;
    owner.push_back(std::move(body));
    return owner.back().get();
  }

  bool build(const std::string& argument) {
    const std::string name = argument.substr(0, argument.find('='));
    scene = name;
    world.setGravity(btVector3(0, 0, name == "chain" || name == "torsion" ? 0 : -9.81F));
    if (name == "chain") {
      const int count = argument == name ? 10 : std::stoi(argument.substr(name.size() + 1));
      for (int i = 1; i <= count; ++i) add(new btSphereShape(0.01F), 0.1F, btVector3(0.1F * btScalar(i), 0, 0), false);
    } else if (name == "torsion") {
      add(new btBoxShape(btVector3(0.1F, 0.2F, 0.3F)), 1, btVector3(0, 0, 0), false);
    } else if (name == "hinge") {
      for (int i = 0; i < 2; ++i) {
        btRigidBody* rod = add(new btBoxShape(btVector3(0.02F, 0.02F, 0.15F)), 0.2F, btVector3(0, 0, -0.15F - 0.3F * btScalar(i)), false);
        const btVector3 top(0, 0, 0.15F), axis(0, 1, 0);
        joints.emplace_back(i == 0 ? new btHingeConstraint(*rod, top, axis)
                                   : new btHingeConstraint(*rod, *bodies[0], top, -top, axis, axis));
        world.addConstraint(joints.back().get(), true);
      }
    } else if (name == "box") {
      add(new btBoxShape(btVector3(1, 1, 0.5F)), 0, btVector3(0, 0, -0.5F), true);
      add(new btBoxShape(btVector3(0.1F, 0.1F, 0.1F)), 1, btVector3(0, 0, 0.1F), true);
      for (int i = 0; i < 2000; ++i) world.stepSimulation(0.001F, 0);
    } else {
      return false;
    }
    return true;
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
                                          : bodies[i - 1]->getWorldTransform().getOrigin() - btVector3(0.1F * btScalar(i), 0, 0);
      };
      for (std::size_t i = 1; i <= bodies.size(); ++i)
        bodies[i - 1]->applyCentralForce(k * (off(i - 1) + off(i + 1) - 2 * off(i)));
    } else if (scene == "torsion") {
      bodies[0]->applyTorque(-20 * turned(*bodies[0]));
    } else if (scene == "hinge") {
      const btVector3 first = 30 * turned(*bodies[0]), second = 10 * (turned(*bodies[1]) - turned(*bodies[0]));
      bodies[0]->applyTorque(second - first);
      bodies[1]->applyTorque(-second);
    }
  }

  void forget_contacts() {
    for (auto& body : bodies)
      broadphase.getOverlappingPairCache()->cleanProxyFromPairs(body->getBroadphaseHandle(), &dispatcher);
    solver.reset();
    for (auto& joint : joints) joint->internalSetAppliedImpulse(0);
  }
};

constexpr std::size_t per_body = 13;  // position, rotation x, y, z, w, velocity, angular velocity

World& of(void* handle) { return *static_cast<World*>(handle); }

int create(const char* argument, void** handle) {
  auto* world = new World;
  *handle = world;
  if (world->build(*argument ? argument : "chain")) return HMAX_OK;
  world->reason = "there is no scene " + std::string(argument);
  return 2;
}
void destroy(void* handle) { delete &of(handle); }
const char* error_text(void* handle) { return of(handle).reason.c_str(); }
int dimension(void* handle, size_t* n) { return *n = per_body * of(handle).bodies.size(), HMAX_OK; }

int get(void* handle, double* y) {
  for (auto& body : of(handle).bodies) {
    const btVector3 x = body->getWorldTransform().getOrigin(), v = body->getLinearVelocity(), w = body->getAngularVelocity();
    const btQuaternion q = body->getOrientation();
    for (const double number : {x.x(), x.y(), x.z(), q.x(), q.y(), q.z(), q.w(), v.x(), v.y(), v.z(), w.x(), w.y(), w.z()})
      *y++ = number;
  }
  return HMAX_OK;
}
int set(void* handle, const double* y) {
  for (auto& body : of(handle).bodies) {
    const auto at = [&](int i) { return btScalar(y[i]); };
    const btTransform transform(btQuaternion(at(3), at(4), at(5), at(6)).normalized(), btVector3(at(0), at(1), at(2)));
    body->setWorldTransform(transform);
    body->setInterpolationWorldTransform(transform);
    body->setLinearVelocity(btVector3(at(7), at(8), at(9)));
    body->setAngularVelocity(btVector3(at(10), at(11), at(12)));
    body->clearForces();
    y += per_body;
  }
  of(handle).forget_contacts();
  return HMAX_OK;
}
int step(void* handle, double h) {
  of(handle).apply_springs();
  of(handle).world.stepSimulation(btScalar(h), 0);
  return HMAX_OK;
}
int quaternions(void* handle, size_t* count, size_t* first) {
  *count = of(handle).bodies.size();
  for (std::size_t i = 0; first && i < *count; ++i) first[i] = per_body * i + 3;
  return HMAX_OK;
}

const hmax_stepper stepper{{create, destroy, error_text, dimension}, HMAX_SINGLE_PRECISION, get, set, step, nullptr, nullptr,
                           nullptr, quaternions, nullptr};
const hmax_plugin_entry entries[]{{"bullet", "a scene of Bullet", nullptr, &stepper}};
const hmax_plugin plugin{HMAX_PLUGIN_VERSION, 1, entries};

}  // namespace

HMAX_PLUGIN_EXPORT const hmax_plugin* hmax_plugin_get(void) { return &plugin; }
