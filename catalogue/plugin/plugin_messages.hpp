/// What hmax and the child process with the plugin say to each other.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace hmax {

/// Functions of the plugin, and where the child is before and after them.
enum class PluginCall : std::uint32_t {
  none,
  load,
  create,
  dimension,
  get_state,
  set_state,
  step,
  saved_size,
  save,
  restore,
  quaternions,
  scales,
  start,
  rhs,
  jacobian,
  mass,
  force,
  stiffness,
  damping,
  destroy,
  couplings,
  own_step,
  parts,
  scale_part,
  state_name
};

inline constexpr std::array<std::string_view, 25> plugin_call_names{
    "between calls", "loading", "create",     "dimension",   "get_state", "set_state", "step",
    "saved_size",    "save",    "restore",    "quaternions", "scales",    "start",     "rhs",
    "jacobian",      "mass",    "force",      "stiffness",   "damping",   "destroy",   "couplings",
    "own_step",      "parts",   "scale_part", "state_name"};

enum class PluginAsk : std::uint32_t {
  state,       ///< -> y
  set_state,   ///< y ->
  steps,       ///< h, count ->
  save,        ///< slot ->
  restore,     ///< slot ->
  after,       ///< slot, h, count, y -> y: restore, set_state, steps, state
  advance,     ///< slot, h -> y: restore, step, save, state
  scale_part,  ///< count is the part; two factors ->
  rhs,         ///< h is t; y -> dydt
  jacobian,    ///< y -> J; this and the matrices below by differences where the plugin does not give them
  force,       ///< (q, v) -> f
  stiffness,   ///< (q, v) -> K
  damping,     ///< (q, v) -> C
  quit
};

struct PluginRequest {
  PluginAsk ask = PluginAsk::state;
  std::uint32_t slot = 0;
  std::uint64_t count = 0;
  double h = 0;
};

struct PluginReply {
  /// diverged: the step says that it cannot be done.
  enum class Kind : std::uint32_t { done, failed, diverged };
  Kind kind = Kind::done;
  std::uint64_t numbers = 0, characters = 0;  ///< that come with it
  std::uint64_t digest = 0;                   ///< of the text, by std::hash
};

/// The first reply begins with these numbers; the quaternions, and where they are there the scales, the
/// groups and pairs of couplings, stiffness and damping of each part, or y0 and the mass of a model, follow.
/// Behind them are name and note, and a line `KIND<tab>NAME` for each part. The parts of a model are its
/// states, where it names them.
struct PluginGreeting {
  double is_stepper = 0, dimension = 0, single_precision = 0, has_save = 0, quaternions = 0, has_scales = 0;
  double has_rhs = 0, has_force = 0, t_end = 0;
  double has_couplings = 0, pairs = 0, reach = 1;
  double own_step = 0, parts = 0;
  double has_jacobian = 0, has_stiffness = 0,
         has_damping = 0;  ///< which the plugin gives; others are differences
};
inline constexpr std::size_t greeting_size = sizeof(PluginGreeting) / sizeof(double);

/// Of numbers in shared memory that only a plugin can have put there.
inline constexpr std::string_view plugin_destroyed =
    " destroyed the memory of its process; check the bounds of its arrays";

/// States of more numbers are taken for an error of the plugin.
inline constexpr std::size_t most_plugin_states = 10'000'000;
/// Parts of a scene, and characters of a name of one that are read.
inline constexpr std::size_t most_plugin_parts = 10'000, most_part_characters = 80;

}  // namespace hmax
