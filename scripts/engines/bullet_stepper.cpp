/// A stepper for `hmax probe`: scenes of Bullet, see bullet_scenes.hpp; the name of one is the argument.
/// Compiled with BT_USE_DOUBLE_PRECISION it computes in double. Contacts begin anew from a state that is set
/// or restored.
#include <hmax/plugin.h>

#include "bullet_scenes.hpp"

namespace {

constexpr std::size_t per_body = 13;  // position, rotation x, y, z, w, velocity, angular velocity
constexpr std::size_t per_node = 6;   // position, velocity

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
// Points of a soft body that move.
template <class Use>
void each_node(World& world, const Use& use) {
  if (!world.soft) return;
  for (int i = 0; i < world.soft->m_nodes.size(); ++i)
    if (btSoftBody::Node& node = world.soft->m_nodes[i]; node.m_im > 0) use(node);
}
int dimension(void* handle, size_t* n) {
  *n = per_body * of(handle).bodies.size();
  each_node(of(handle), [&](auto&) { *n += per_node; });
  return HMAX_OK;
}

int get(void* handle, double* y) {
  for (auto& body : of(handle).bodies) {
    const btVector3 x = body->getWorldTransform().getOrigin(), v = body->getLinearVelocity(),
                    w = body->getAngularVelocity();
    const btQuaternion q = body->getOrientation();
    for (const double number :
         {x.x(), x.y(), x.z(), q.x(), q.y(), q.z(), q.w(), v.x(), v.y(), v.z(), w.x(), w.y(), w.z()})
      *y++ = number;
  }
  each_node(of(handle), [&](auto& node) {
    for (const btVector3& each : {node.m_x, node.m_v})
      for (int i = 0; i < 3; ++i) *y++ = each[i];
  });
  return HMAX_OK;
}
int set(void* handle, const double* y) {
  for (auto& body : of(handle).bodies) {
    const auto at = [&](int i) { return btScalar(y[i]); };
    const btTransform transform(btQuaternion(at(3), at(4), at(5), at(6)).normalized(),
                                btVector3(at(0), at(1), at(2)));
    body->setWorldTransform(transform);
    body->setInterpolationWorldTransform(transform);
    body->setLinearVelocity(btVector3(at(7), at(8), at(9)));
    body->setAngularVelocity(btVector3(at(10), at(11), at(12)));
    body->clearForces();
    y += per_body;
  }
  each_node(of(handle), [&](auto& node) {
    node.m_x = node.m_q = btVector3(btScalar(y[0]), btScalar(y[1]), btScalar(y[2]));
    node.m_v = node.m_vn = btVector3(btScalar(y[3]), btScalar(y[4]), btScalar(y[5]));
    node.m_f = node.m_splitv = btVector3(0, 0, 0);
    y += per_node;
  });
  of(handle).forget_contacts();
  return HMAX_OK;
}
int step(void* handle, double h) {
  of(handle).step(btScalar(h));
  return HMAX_OK;
}
int quaternions(void* handle, size_t* count, size_t* first) {
  *count = of(handle).bodies.size();
  for (std::size_t i = 0; first && i < *count; ++i) first[i] = per_body * i + 3;
  return HMAX_OK;
}

const hmax_stepper stepper{{create, destroy, error_text, dimension},
                           sizeof(btScalar) == 4 ? HMAX_SINGLE_PRECISION : 0u,
                           get,
                           set,
                           step,
                           nullptr,
                           nullptr,
                           nullptr,
                           quaternions,
                           nullptr};
const hmax_plugin_entry entries[]{{"bullet", "a scene of Bullet", nullptr, &stepper}};
const hmax_plugin plugin{HMAX_PLUGIN_VERSION, 1, entries};

}  // namespace

HMAX_PLUGIN_EXPORT const hmax_plugin* hmax_plugin_get(void) { return &plugin; }
