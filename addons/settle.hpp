/// A scene is brought to rest by its own engine.
#pragma once

#include <algorithm>

namespace hmax::engines {

/// Steps of size h, or a tenth of it in which the velocities are zero whenever the kinetic energy has passed
/// a peak: that ends at rest without damping too. They go on for twenty seconds, or up to sixty while
/// something moves, and end earlier where nothing does for a hundred of them.
/// @return whether it has come to rest
template <class Scene>
bool comes_to_rest(Scene& scene, double h, bool relax) {
  constexpr double least = 20, longest = 60, still = 1e-4, very_still = 1e-10, quite_still = 1e-14;
  constexpr int most = 100'000, in_a_row = 100;
  if (relax) h /= 10;
  double fastest = 0, energy = 0, speed = 0, time = 0;
  for (int i = 0, resting = 0; i < most && resting < in_a_row; ++i) {
    time += h;
    if (time > (speed > very_still * fastest ? longest : least)) break;
    if (!scene.step(h)) return false;
    speed = scene.speed();
    fastest = std::max(fastest, speed);
    resting = speed <= quite_still * fastest ? resting + 1 : 0;
    if (!relax) continue;
    const double now = scene.kinetic_energy();
    if (now < energy) scene.stop();
    energy = now < energy ? 0 : now;
  }
  return speed <= still * fastest;
}

/// A scene that steps of h, its own, do not bring to rest, as they are too long or nothing damps it, is
/// brought to it by others; if they cannot, it is left where it begins.
/// @param scene  step(h), false where
/// it diverges; speed(), the largest of its velocities;
///               kinetic_energy(), of relaxed steps; stop(), which makes it stand; begin_again()
/// @return what becomes of it
template <class Scene>
const char* settle(Scene& scene, double h) {
  if (comes_to_rest(scene, h, false)) return "";
  if (scene.has_diverged()) scene.begin_again();
  if (comes_to_rest(scene, h, true)) return ", brought to rest by shorter steps than its own";
  scene.begin_again();
  return ", which does not come to rest";
}

}  // namespace hmax::engines
