/// Worlds of Bullet that can be stepped from any state.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "addons/stepper.hpp"

namespace hmax::bullet {

/// Its state is all that the next step depends on: bodies do not sleep, nothing collides, and what Bullet
/// keeps from step to step is set with the state.
class Scene {
 public:
  virtual ~Scene() = default;
  [[nodiscard]] virtual std::size_t dim() const = 0;
  virtual void state(double* y) = 0;
  virtual void set_state(const double* y) = 0;
  /// @returns false where it leaves all bounds
  virtual bool step(double h) = 0;
  virtual void scale_part(std::size_t part, double stiffness, double damping) = 0;
  [[nodiscard]] virtual std::vector<std::size_t> quaternions() const { return {}; }
  /// "multibody of 6 joints".
  [[nodiscard]] virtual std::string in_words() const = 0;

  // Of coming to rest.
  /// A step that dampers do not slow.
  virtual bool relax(double h) { return step(h); }
  [[nodiscard]] virtual bool has_weight() const = 0;  ///< false: it is at rest where it begins
  [[nodiscard]] virtual double speed() = 0;
  [[nodiscard]] virtual double kinetic_energy() = 0;  ///< [J]
  virtual void stop() = 0;

  [[nodiscard]] const std::vector<engines::NamedPart>& parts() const { return parts_; }
  /// That of PyBullet, which no file says.
  [[nodiscard]] static double own_step() { return 1.0 / 240; }

 protected:
  std::vector<engines::NamedPart> parts_;
};

/// A robot in URDF as a btMultiBody. @param base  the name of its base, where that is fixed; else empty
/// @throws engines::Failure
std::unique_ptr<Scene> multibody(const std::string& file, const std::string& base);

/// A body as a btSoftBody. @param text  of problems/tissue/bullet_body.hpp
std::unique_ptr<Scene> soft_body(const std::string& text);

}  // namespace hmax::bullet
