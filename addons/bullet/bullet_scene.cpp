/// Scenes of Bullet as a stepper behind hmax/plugin.h: a child process of hmax opens this module.
#include <LinearMath/btScalar.h>
#include <array>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "addons/bullet/scene.hpp"
#include "addons/settle.hpp"
#include "addons/stepper.hpp"

namespace hmax::bullet {
namespace {

std::array<char, 200> note{};

/// What engines::comes_to_rest() needs.
struct Relaxation {
  bool step(double h) { return scene.relax(h); }
  double speed() { return scene.speed(); }
  double kinetic_energy() { return scene.kinetic_energy(); }
  void stop() { scene.stop(); }

  Scene& scene;
};

/// By relaxation alone: dampers of robots are often too strong for steps of 1/240 s, or slow.
/// @returns what becomes of the scene
const char* settle(Scene& scene) {
  std::vector<double> begin(scene.dim());
  scene.state(begin.data());
  Relaxation relaxation{scene};
  if (!scene.has_weight() || engines::comes_to_rest(relaxation, Scene::own_step(), true)) return "";
  scene.set_state(begin.data());
  return ", which does not come to rest";
}

/// FILE, "start" where it stays as it is there, and the base of a robot or the text of a body: lines, the
/// last one of many.
int create(const char* argument, void** handle) {
  return engines::guarded([&] {
    const std::string text = argument, file = text.substr(0, text.find('\n'));
    const auto rest_of = [](const std::string& of) {
      const std::size_t end = of.find('\n');
      return end == of.npos ? std::string() : of.substr(end + 1);
    };
    const std::string second = rest_of(text), third = rest_of(second);
    std::unique_ptr<Scene> scene = file.ends_with(".urdf") ? multibody(file, third) : soft_body(third);
    const char* const outcome = second.starts_with("start") ? "" : settle(*scene);
    std::snprintf(note.data(), note.size(), "Bullet %d.%d, %s%s", BT_BULLET_VERSION / 100,
                  BT_BULLET_VERSION % 100, scene->in_words().c_str(), outcome);
    *handle = scene.release();
    return true;
  });
}

const hmax_stepper stepper = engines::StepperCalls<Scene>::table(create);
const hmax_plugin_entry entries[]{
    {.name = "bullet", .note = note.data(), .model = nullptr, .stepper = &stepper}};
const hmax_plugin plugin{HMAX_PLUGIN_VERSION, 1, entries};

}  // namespace
}  // namespace hmax::bullet

HMAX_PLUGIN_EXPORT const hmax_plugin* hmax_plugin_get(void) { return &hmax::bullet::plugin; }
