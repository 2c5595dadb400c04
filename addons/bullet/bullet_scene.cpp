/// Scenes of Bullet as a stepper behind hmax/plugin.h: a child process of hmax opens this module.
#include <LinearMath/btScalar.h>
#include <array>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "addons/bullet/scene.hpp"
#include "addons/stepper.hpp"
#include "analysis/foreign_steps/settling.hpp"
#include "problems/mesh/files/mesh_text.hpp"

namespace hmax::bullet {
namespace {

std::array<char, 200> note{};

/// Its steps without dampers, where it stands still whenever the kinetic energy has passed a peak: dampers of
/// robots are often too strong for steps of 1/240 s, or slow.
class Relaxation final : public SettlingScene {
 public:
  explicit Relaxation(Scene& scene) : scene_(scene), begin_(scene.dim()) { scene.state(begin_.data()); }

  [[nodiscard]] double timestep() const override { return Scene::own_step() / 10; }
  void damp(double) override {}
  bool step(double h) override {
    if (!scene_.relax(h)) return false;
    const double now = scene_.kinetic_energy();
    if (now < energy_) scene_.stop();
    energy_ = now < energy_ ? 0 : now;
    return true;
  }
  [[nodiscard]] double speed() const override { return scene_.speed(); }
  void begin_again() override { scene_.set_state(begin_.data()); }

 private:
  Scene& scene_;
  std::vector<double> begin_;
  double energy_ = 0;
};

/// @returns what becomes of the scene
const char* settle(Scene& scene) {
  Relaxation relaxation(scene);
  if (!scene.has_weight() || comes_to_rest(relaxation, relaxation.timestep())) return "";
  relaxation.begin_again();
  return in_words(Settled::not_at_all);
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
    std::unique_ptr<Scene> scene = lower(file).ends_with(".urdf") ? multibody(file, third) : soft_body(third);
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
