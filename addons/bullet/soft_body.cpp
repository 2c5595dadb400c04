/// Soft bodies of tetrahedra as Bullet's deformable bodies.
#include <BulletCollision/BroadphaseCollision/btDbvtBroadphase.h>
#include <BulletSoftBody/btDeformableBodySolver.h>
#include <BulletSoftBody/btDeformableLinearElasticityForce.h>
#include <BulletSoftBody/btDeformableMultiBodyConstraintSolver.h>
#include <BulletSoftBody/btDeformableMultiBodyDynamicsWorld.h>
#include <BulletSoftBody/btDeformableNeoHookeanForce.h>
#include <BulletSoftBody/btSoftBody.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <memory>
#include <sstream>
#include <string>

#include "addons/bullet/scene.hpp"

namespace hmax::bullet {
namespace {

using engines::Failure;
using Node = btSoftBody::Node;

/// What problems/tissue/bullet_body.hpp writes.
struct Body {
  std::string force;
  double young = 0, poisson = 0, alpha = 0, beta = 0;
  double mass = 0;  ///< of all points [kg]
  btVector3 gravity;
  std::vector<btVector3> points;
  std::vector<double> masses;  ///< [kg]; 0 where the point is fixed
  std::vector<std::array<int, 4>> tetrahedra;
};

Body read(const std::string& text) {
  std::istringstream in(text);
  Body body;
  std::size_t points = 0, tetrahedra = 0;
  in >> body.force >> body.young >> body.poisson >> body.alpha >> body.beta;
  for (int k = 0; k < 3; ++k) in >> body.gravity[k];
  if (!(in >> points >> tetrahedra))
    throw Failure{"a mesh alone is no scene; ask hmax probe FILE, without --plugin"};
  body.points.resize(points);
  body.masses.resize(points);
  body.tetrahedra.resize(tetrahedra);
  for (std::size_t i = 0; i < points; ++i) {
    bool is_fixed = false;
    in >> body.points[i][0] >> body.points[i][1] >> body.points[i][2] >> body.masses[i] >> is_fixed;
    body.mass += body.masses[i];
    if (is_fixed) body.masses[i] = 0;
  }
  for (std::array<int, 4>& each : body.tetrahedra)
    for (int& point : each) in >> point;
  return body;
}

btSoftBody::TetraScratch at_rest() {
  btSoftBody::TetraScratch scratch;
  for (btMatrix3x3* each : {&scratch.m_F, &scratch.m_cofF, &scratch.m_corotation}) each->setIdentity();
  scratch.m_trace = 3;
  scratch.m_J = 1;
  return scratch;
}

/// Bullet's solver of the damping ends at a residual of 1e-8 N s, below which nothing is damped. Here it goes
/// on, so that small motions are damped as larger ones are.
struct ElasticSolver final : btDeformableBodySolver {
  ElasticSolver() { m_cr.setTolerance(1e-30); }
};

class SoftBody final : public Scene {
 public:
  explicit SoftBody(const Body& body);
  ~SoftBody() override;
  SoftBody(const SoftBody&) = delete;
  SoftBody& operator=(const SoftBody&) = delete;

  [[nodiscard]] std::size_t dim() const override { return 6 * free_.size(); }
  void state(double* y) override;
  void set_state(const double* y) override;
  bool step(double h) override;
  void scale_part(std::size_t part, double stiffness, double damping) override;
  [[nodiscard]] std::string in_words() const override { return words_; }
  [[nodiscard]] bool has_weight() const override { return !gravity_->m_gravity.isZero(); }
  [[nodiscard]] double speed() override;
  [[nodiscard]] double kinetic_energy() override;
  void stop() override;

 private:
  void set_elasticity(double stiffness, double damping);

  btSoftBodyRigidBodyCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_{&configuration_};
  btDbvtBroadphase broadphase_;
  btDeformableMultiBodyConstraintSolver solver_;
  // Its world deletes this one.
  btDeformableBodySolver* const elastic_solver_ = new ElasticSolver;
  std::unique_ptr<btDeformableMultiBodyDynamicsWorld> world_;
  btSoftBodyWorldInfo info_;
  std::unique_ptr<btSoftBody> soft_;
  std::unique_ptr<btDeformableNeoHookeanForce> neo_hookean_;
  std::unique_ptr<btDeformableLinearElasticityForce> linear_;
  std::unique_ptr<btDeformableGravityForce> gravity_;
  Body body_;
  std::vector<int> free_;  ///< points that move
  double size_ = 0;        ///< [m]
  std::string words_;
};

SoftBody::SoftBody(const Body& body) : body_(body) {
  solver_.setDeformableSolver(elastic_solver_);
  world_ = std::make_unique<btDeformableMultiBodyDynamicsWorld>(&dispatcher_, &broadphase_, &solver_,
                                                                &configuration_, elastic_solver_);
  info_.m_broadphase = &broadphase_;
  info_.m_dispatcher = &dispatcher_;
  info_.m_gravity.setZero();
  info_.m_sparsesdf.Initialize();
  const auto count = static_cast<int>(body.points.size());
  soft_ = std::make_unique<btSoftBody>(&info_, count, body.points.data(), body.masses.data());
  for (const std::array<int, 4>& each : body.tetrahedra)
    soft_->appendTetra(each[0], each[1], each[2], each[3]);
  soft_->m_tetraScratches.resize(soft_->m_tetras.size(), at_rest());
  soft_->m_tetraScratchesTn.resize(soft_->m_tetras.size(), at_rest());
  soft_->initializeDmInverse();
  soft_->m_cfg.collisions = 0;
  soft_->m_sleepingThreshold = 0;
  world_->addSoftBody(soft_.get());
  soft_->setActivationState(DISABLE_DEACTIVATION);
  world_->setImplicit(false);
  world_->setGravity(btVector3(0, 0, 0));
  for (int i = 0; i < count; ++i)
    if (body.masses[static_cast<std::size_t>(i)] > 0) free_.push_back(i);
  // What falls feels no gravity.
  const bool is_held = free_.size() < body.points.size();
  gravity_ = std::make_unique<btDeformableGravityForce>(is_held ? body.gravity : btVector3(0, 0, 0));
  world_->addForce(soft_.get(), gravity_.get());
  if (body.force == "neo_hookean")
    world_->addForce(soft_.get(), (neo_hookean_ = std::make_unique<btDeformableNeoHookeanForce>()).get());
  else
    world_->addForce(soft_.get(), (linear_ = std::make_unique<btDeformableLinearElasticityForce>()).get());
  set_elasticity(1, 1);
  parts_ = {{"elasticity", body.force, body.young, body.beta * body.young}};
  if (has_weight()) parts_.push_back({"gravity", "number 0", gravity_->m_gravity.length(), 0});
  btVector3 low, high;
  soft_->getAabb(low, high);
  size_ = (high - low).length();
  std::array<char, 100> material{};
  std::snprintf(material.data(), material.size(), " of E %.4g Pa, nu %.4g, %.4g kg", body.young, body.poisson,
                body.mass);
  words_ = "deformable body" + std::string(material.data()) + ", " +
           (neo_hookean_ ? "btDeformableNeoHookeanForce" : "btDeformableLinearElasticityForce") +
           ", explicit" + (is_held ? "" : ", free");
}

SoftBody::~SoftBody() {
  world_->removeSoftBody(soft_.get());
  soft_.reset();
}

/// As Bullet takes E and nu. Of its neo-Hookean force the shear modulus at rest is three quarters of mu.
void SoftBody::set_elasticity(double stiffness, double damping) {
  if (neo_hookean_) {
    neo_hookean_->setYoungsModulus(body_.young);
    neo_hookean_->setPoissonRatio(body_.poisson);
    neo_hookean_->setDamping(body_.beta * damping);
    neo_hookean_->setLameParameters(neo_hookean_->m_mu * stiffness, neo_hookean_->m_lambda * stiffness);
  } else {
    linear_->setYoungsModulus(body_.young * stiffness);
    linear_->setPoissonRatio(body_.poisson);
    linear_->setDamping(body_.alpha, body_.beta * damping / stiffness);
  }
}

void SoftBody::state(double* y) {
  for (const int i : free_)
    for (const btVector3& each : {soft_->m_nodes[i].m_x, soft_->m_nodes[i].m_v})
      for (int k = 0; k < 3; ++k) *y++ = each[k];
}

void SoftBody::set_state(const double* y) {
  for (const int i : free_) {
    Node& node = soft_->m_nodes[i];
    node.m_x = node.m_q = {y[0], y[1], y[2]};
    node.m_v = node.m_vn = {y[3], y[4], y[5]};
    node.m_f.setZero();
    node.m_splitv.setZero();
    y += 6;
  }
}

bool SoftBody::step(double h) {
  world_->stepSimulation(h, 0);
  // Further out Bullet takes the body out of the world.
  constexpr double most_sizes = 1e4;
  for (const int i : free_) {
    const btVector3 moved = soft_->m_nodes[i].m_x - body_.points[static_cast<std::size_t>(i)];
    if (!(moved.length() < most_sizes * size_) || !std::isfinite(soft_->m_nodes[i].m_v.length()))
      return false;
  }
  return true;
}

double SoftBody::speed() {
  double fastest = 0;
  for (const int i : free_) fastest = std::max(fastest, soft_->m_nodes[i].m_v.length());
  return fastest;
}

double SoftBody::kinetic_energy() {
  double energy = 0;
  for (const int i : free_)
    energy += body_.masses[static_cast<std::size_t>(i)] * soft_->m_nodes[i].m_v.length2() / 2;
  return energy;
}

void SoftBody::stop() {
  for (const int i : free_) soft_->m_nodes[i].m_v = soft_->m_nodes[i].m_vn = btVector3(0, 0, 0);
}

void SoftBody::scale_part(std::size_t part, double stiffness, double damping) {
  if (part == 0) return set_elasticity(stiffness, damping);
  gravity_->m_gravity = body_.gravity * stiffness;
}

}  // namespace

std::unique_ptr<Scene> soft_body(const std::string& text) { return std::make_unique<SoftBody>(read(text)); }

}  // namespace hmax::bullet
