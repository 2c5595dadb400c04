/// How a scene of an engine is brought to rest before it is probed.
#pragma once

#include <algorithm>
#include <array>

namespace hmax {

/// What settling asks of an engine.
class SettlingScene {
 public:
  virtual ~SettlingScene() = default;

  [[nodiscard]] virtual double timestep() const = 0;  ///< of its own [s]
  /// From now on all motion is damped at this rate [1/s]; 0: as the scene has it.
  virtual void damp(double rate) = 0;
  /// @returns false where the step diverges
  virtual bool step(double h) = 0;
  /// The largest modulus of the velocities.
  [[nodiscard]] virtual double speed() const = 0;
  virtual void begin_again() = 0;
};

constexpr double least_to_settle = 20, longest_to_settle = 60;  // [s]
constexpr int most_to_settle = 100'000;                         // steps

/// By steps of size h for 20 s, or 60 s while it moves, and a hundred thousand of them at most; earlier where
/// nothing moves for a hundred. Where they diverge the scene begins again. @returns whether it is at rest
inline bool comes_to_rest(SettlingScene& scene, double h) {
  constexpr double still = 1e-4, very_still = 1e-10, quite_still = 1e-14;
  constexpr int in_a_row = 100;
  double fastest = 0, speed = 0, time = 0;
  for (int i = 0, resting = 0; i < most_to_settle && resting < in_a_row; ++i) {
    time += h;
    if (time > (speed > very_still * fastest ? longest_to_settle : least_to_settle)) break;
    if (!scene.step(h)) {
      scene.begin_again();
      return false;
    }
    speed = scene.speed();
    fastest = std::max(fastest, speed);
    resting = speed <= quite_still * fastest ? resting + 1 : 0;
  }
  return speed <= still * fastest;
}

enum class Settled { by_own_steps, by_damping, by_shorter_steps, by_longer_steps, not_at_all };

/// By steps of the scene's own size; where these do not bring it to rest, by damped ones, which leave states
/// of rest as they are: what falls lands, and what swings, rolls or slides without end stops. Then by a tenth
/// of the step, where the own one is too long, and by ten times it, where so many of the own ones are short.
/// A scene that none of them bring to rest is where it began.
inline Settled settle(SettlingScene& scene) {
  constexpr double rate = 5;  // [1/s]
  const double h = scene.timestep();
  if (comes_to_rest(scene, h)) return Settled::by_own_steps;
  const auto damped = [&](double size) {
    scene.damp(rate);
    const bool rests = comes_to_rest(scene, size);
    scene.damp(0);
    return rests;
  };
  if (damped(h)) return Settled::by_damping;
  if (damped(h / 10)) return Settled::by_shorter_steps;
  if (h * most_to_settle < least_to_settle && damped(10 * h)) return Settled::by_longer_steps;
  scene.begin_again();
  return Settled::not_at_all;
}

/// What the first line of an answer adds; empty for own steps.
inline const char* in_words(Settled settled) {
  constexpr std::array texts{"", ", brought to rest by damping",
                             ", brought to rest by shorter steps than its own",
                             ", brought to rest by longer steps than its own",
                             ", which does not come to rest: judged where it begins"};
  return texts[static_cast<std::size_t>(settled)];
}

}  // namespace hmax
