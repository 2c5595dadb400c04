/// Robots in URDF as Bullet's multibodies.
#include <BulletDynamics/Featherstone/btMultiBodyConstraintSolver.h>
#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>
#include <BulletDynamics/Featherstone/btMultiBodyJointLimitConstraint.h>
#include <algorithm>
#include <btBulletDynamicsCommon.h>
#include <cmath>
#include <memory>
#include <string>

#include "addons/bullet/scene.hpp"
#include "addons/bullet/urdf_file.hpp"

namespace hmax::bullet {
namespace {

using engines::Failure;

class Multibody final : public Scene {
 public:
  Multibody(const Urdf& robot, bool is_fixed);
  ~Multibody() override;
  Multibody(const Multibody&) = delete;
  Multibody& operator=(const Multibody&) = delete;

  [[nodiscard]] std::size_t dim() const override { return (is_free() ? 13 : 0) + 2 * moving_.size(); }
  void state(double* y) override;
  void set_state(const double* y) override;
  bool step(double h) override;
  bool relax(double h) override;
  void scale_part(std::size_t part, double stiffness, double damping) override;
  [[nodiscard]] std::vector<std::size_t> quaternions() const override {
    return is_free() ? std::vector<std::size_t>{3} : std::vector<std::size_t>{};
  }
  [[nodiscard]] std::string in_words() const override { return words_; }
  [[nodiscard]] bool has_weight() const override { return !is_free(); }
  [[nodiscard]] double speed() override;
  [[nodiscard]] double kinetic_energy() override;
  void stop() override { body_->clearVelocities(); }

 private:
  [[nodiscard]] bool is_free() const { return !body_->hasFixedBase(); }
  void add_joint(const Urdf& robot, int i);
  void add_parts(const Urdf& robot);

  static constexpr double gravity = 9.81;
  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_{&configuration_};
  btDbvtBroadphase broadphase_;
  btMultiBodyConstraintSolver solver_;
  btMultiBodyDynamicsWorld world_{&dispatcher_, &broadphase_, &solver_, &configuration_};
  std::unique_ptr<btMultiBody> body_;
  std::vector<std::unique_ptr<btMultiBodyConstraint>> limits_;
  std::vector<int> moving_;      ///< links whose joints move
  std::vector<double> damping_;  ///< of each of them
  std::vector<int> damped_;      ///< of each part its place among them; -1: gravity, -2: of all links
  double link_damping_ = 0;
  std::string words_;
};

Multibody::Multibody(const Urdf& robot, bool is_fixed)
    : body_(std::make_unique<btMultiBody>(static_cast<int>(robot.joints.size()), robot.links.front().mass,
                                          robot.links.front().inertia, is_fixed, false)) {
  body_->setBaseWorldTransform(robot.links.front().inertial);
  for (std::size_t i = 0; i < robot.joints.size(); ++i) add_joint(robot, static_cast<int>(i));
  body_->finalizeMultiDof();
  body_->setHasSelfCollision(false);
  world_.addMultiBody(body_.get());
  for (std::size_t k = 0; k < moving_.size(); ++k) {
    const Urdf::Joint& joint = robot.joints[static_cast<std::size_t>(moving_[k])];
    if (joint.lower > joint.upper) continue;
    limits_.push_back(
        std::make_unique<btMultiBodyJointLimitConstraint>(body_.get(), moving_[k], joint.lower, joint.upper));
    world_.addMultiBodyConstraint(limits_.back().get());
    limits_.back()->finalizeMultiDof();
  }
  // What falls feels no gravity.
  world_.setGravity(btVector3(0, 0, is_fixed ? -gravity : 0));
  link_damping_ = body_->getLinearDamping();
  add_parts(robot);
  words_ = "multibody of " + std::to_string(moving_.size()) + (moving_.size() == 1 ? " joint" : " joints") +
           (is_fixed ? "" : ", free");
  const auto guessed = std::ranges::count(robot.links, false, &Urdf::Link::has_inertial);
  if (guessed > 0)
    words_ += ", " + std::to_string(guessed) + (guessed == 1 ? " link" : " links") +
              " without <inertial> taken as 1 kg";
}

Multibody::~Multibody() {
  for (const auto& limit : limits_) world_.removeMultiBodyConstraint(limit.get());
  world_.removeMultiBody(body_.get());
}

/// Joint i leads to link i, which in the file is number i + 1, as in Bullet's importer: frames are those of
/// the centres of mass.
void Multibody::add_joint(const Urdf& robot, int i) {
  const Urdf::Joint& joint = robot.joints[static_cast<std::size_t>(i)];
  const Urdf::Link& link = robot.links[static_cast<std::size_t>(i) + 1];
  const btTransform to_joint =
                        robot.links[static_cast<std::size_t>(joint.parent)].inertial.inverse() * joint.origin,
                    to_pivot = link.inertial.inverse();
  const btQuaternion turn = to_pivot.getRotation() * to_joint.inverse().getRotation();
  const btVector3 axis = quatRotate(to_pivot.getRotation(), joint.axis);
  const int parent = joint.parent - 1;
  if (joint.type == Urdf::Type::turning)
    body_->setupRevolute(i, link.mass, link.inertia, parent, turn, axis, to_joint.getOrigin(),
                         -to_pivot.getOrigin(), true);
  else if (joint.type == Urdf::Type::sliding)
    body_->setupPrismatic(i, link.mass, link.inertia, parent, turn, axis, to_joint.getOrigin(),
                          -to_pivot.getOrigin(), true);
  else
    body_->setupFixed(i, link.mass, link.inertia, parent, turn, to_joint.getOrigin(), -to_pivot.getOrigin());
  if (joint.type == Urdf::Type::fixed) return;
  moving_.push_back(i);
  damping_.push_back(joint.damping);
}

void Multibody::add_parts(const Urdf& robot) {
  const auto add = [&](const char* kind, const std::string& name, double stiffness, double damping, int of) {
    if ((stiffness == 0 && damping == 0) || parts_.size() == engines::most_parts) return;
    parts_.push_back({kind, name, stiffness, damping});
    damped_.push_back(of);
  };
  add("gravity", "number 0", world_.getGravity().length(), 0, -1);
  add("link damping", "number 0", 0, link_damping_, -2);
  for (std::size_t k = 0; k < moving_.size(); ++k)
    add("joint", robot.joints[static_cast<std::size_t>(moving_[k])].name, 0, damping_[k],
        static_cast<int>(k));
}

void Multibody::state(double* y) {
  if (is_free()) {
    const btQuaternion turn = body_->getWorldToBaseRot();
    const btVector3 at = body_->getBasePos(), omega = body_->getBaseOmega(), v = body_->getBaseVel();
    for (const double number : {at.x(), at.y(), at.z(), turn.x(), turn.y(), turn.z(), turn.w(), omega.x(),
                                omega.y(), omega.z(), v.x(), v.y(), v.z()})
      *y++ = number;
  }
  for (const int i : moving_) *y++ = body_->getJointPos(i);
  for (const int i : moving_) *y++ = body_->getJointVel(i);
}

void Multibody::set_state(const double* y) {
  if (is_free()) {
    body_->setBasePos({y[0], y[1], y[2]});
    body_->setWorldToBaseRot(btQuaternion(y[3], y[4], y[5], y[6]).normalized());
    body_->setBaseOmega({y[7], y[8], y[9]});
    body_->setBaseVel({y[10], y[11], y[12]});
    y += 13;
  }
  for (const int i : moving_) body_->setJointPos(i, *y++);
  for (const int i : moving_) body_->setJointVel(i, *y++);
  body_->clearForcesAndTorques();
  body_->clearConstraintForces();
}

/// The damping of joints is a torque at the velocity before the step, as PyBullet applies it: the library
/// itself keeps the number and does not use it. Velocities that Bullet clamps have diverged.
bool Multibody::step(double h) {
  for (std::size_t k = 0; k < moving_.size(); ++k)
    body_->addJointTorque(moving_[k], -damping_[k] * body_->getJointVel(moving_[k]));
  return relax(h);
}

bool Multibody::relax(double h) {
  world_.stepSimulation(h, 0);
  return speed() < body_->getMaxCoordinateVelocity();
}

double Multibody::speed() {
  double fastest = 0;
  const btScalar* const v = body_->getVelocityVector();
  for (int i = is_free() ? 0 : 6; i < 6 + body_->getNumDofs(); ++i)
    fastest = std::isnan(v[i]) ? v[i] : std::max(fastest, std::abs(v[i]));
  return fastest;
}

double Multibody::kinetic_energy() {
  const auto links = static_cast<std::size_t>(body_->getNumLinks());
  std::vector<btVector3> omega(links + 1), v(links + 1);
  body_->compTreeLinkVelocities(omega.data(), v.data());
  const auto of = [](double mass, const btVector3& inertia, const btVector3& w, const btVector3& speed) {
    return (mass * speed.length2() + w.dot(inertia * w)) / 2;
  };
  double energy = is_free() ? of(body_->getBaseMass(), body_->getBaseInertia(), omega[0], v[0]) : 0;
  for (std::size_t i = 0; i < links; ++i)
    energy += of(body_->getLinkMass(static_cast<int>(i)), body_->getLinkInertia(static_cast<int>(i)),
                 omega[i + 1], v[i + 1]);
  return energy;
}

void Multibody::scale_part(std::size_t part, double stiffness, double damping) {
  const engines::NamedPart& scaled = parts_.at(part);
  if (damped_[part] == -1)
    world_.setGravity(btVector3(0, 0, -scaled.stiffness * stiffness));
  else if (damped_[part] == -2)
    body_->setLinearDamping(link_damping_ * damping), body_->setAngularDamping(link_damping_ * damping);
  else
    damping_[static_cast<std::size_t>(damped_[part])] = scaled.damping * damping;
}

}  // namespace

std::unique_ptr<Scene> multibody(const std::string& file, const std::string& base) {
  const Urdf robot = read_urdf(file);
  const std::string& own = robot.links.front().name;
  if (!base.empty() && base != own)
    throw Failure{"--support " + base + ": the base of the robot is '" + own +
                  "', and no other link can be fixed"};
  const bool is_fixed = !base.empty() || robot.links.front().mass == 0;
  if (is_fixed &&
      std::ranges::all_of(robot.joints, [](const auto& joint) { return joint.type == Urdf::Type::fixed; }))
    throw Failure{"nothing in the scene moves; give the robot a joint"};
  return std::make_unique<Multibody>(robot, is_fixed);
}

}  // namespace hmax::bullet
