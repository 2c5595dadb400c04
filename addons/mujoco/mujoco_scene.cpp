/// Scenes of MuJoCo as a stepper behind hmax/plugin.h: a child process of hmax opens this module.
#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <csetjmp>
#include <cstdio>
#include <memory>
#include <mujoco/mujoco.h>
#include <string>
#include <vector>

#include "addons/mujoco/scene_parts.hpp"
#include "catalogue/plugin/plugin.h"

namespace hmax::mujoco {
namespace {

constexpr int failed = 2;
constexpr std::size_t most_parts = 10'000;

std::string reason;
char note[120];
std::jmp_buf at_error;

/// MuJoCo ends the process with an error, unless this function does not return.
[[noreturn]] void leave(const char* message) {
  reason = std::string("MuJoCo: ") + message;
  std::longjmp(at_error, 1);
}

/// Calls of MuJoCo, whose errors jump here: nothing in them needs a destructor.
template <class Calls>
int guarded(const Calls& calls) {
  mju_user_error = leave;
  // Warnings would be written to a file in the folder of the user.
  mju_user_warning = [](const char*) {};
  if (setjmp(at_error)) return failed;
  calls();
  return HMAX_OK;
}

struct Scene {
  Scene() = default;
  ~Scene() {
    mj_deleteData(d);
    mj_deleteData(begin);
    mj_deleteModel(m);
    mj_deleteModel(original);
  }
  Scene(const Scene&) = delete;
  Scene& operator=(const Scene&) = delete;

  mjModel *m = nullptr, *original = nullptr;
  mjData *d = nullptr, *begin = nullptr;  ///< `begin`: with the controls of the scene
  std::vector<Part> parts;
};
Scene& of(void* handle) { return *static_cast<Scene*>(handle); }

/// FILE, the name or number of a keyframe, and whether it stays as it is there: lines.
struct Argument {
  std::string file, keyframe;
  bool settles = true;
};

Argument parse(const std::string& text) {
  Argument argument;
  const std::size_t first = text.find('\n');
  argument.file = text.substr(0, first);
  if (first == text.npos) return argument;
  const std::size_t second = text.find('\n', first + 1);
  argument.keyframe = text.substr(first + 1, second == text.npos ? second : second - first - 1);
  argument.settles = second == text.npos;
  return argument;
}

/// What MuJoCo writes in several lines.
std::string in_one_line(std::string text) {
  while (!text.empty() && std::isspace(static_cast<unsigned char>(text.back()))) text.pop_back();
  std::ranges::replace(text, '\n', ' ');
  return text;
}

/// @returns -1 with a reason where there is none
int number_of_keyframe(const mjModel* m, const std::string& name) {
  const int named = mj_name2id(m, mjOBJ_KEY, name.c_str());
  if (named >= 0) return named;
  for (int k = 0; k < m->nkey; ++k)
    if (name == std::to_string(k)) return k;
  reason = "there is no keyframe '" + name + "'; ";
  if (m->nkey == 0) reason += "the file has none";
  for (int k = 0; k < m->nkey; ++k) {
    const char* own = mj_id2name(m, mjOBJ_KEY, k);
    reason += (k > 0 ? ", " : "the file has ") + (own && *own ? std::string(own) : std::to_string(k));
  }
  return -1;
}

/// What diverges MuJoCo resets, and counts.
int resets(const mjData* d) {
  return d->warning[mjWARN_BADQPOS].number + d->warning[mjWARN_BADQVEL].number +
         d->warning[mjWARN_BADQACC].number;
}

/// Steps of the file's own size, or a tenth of them in which the velocities are zero whenever the kinetic
/// energy has passed a peak: that ends at rest without damping too. They go on for twenty seconds, or up to
/// sixty while something moves, and end earlier where nothing does for a hundred of them.
/// @returns whether it has come to rest
bool comes_to_rest(mjModel* m, mjData* d, bool relax) {
  constexpr double least = 20, longest = 60, still = 1e-4, very_still = 1e-10, quite_still = 1e-14;
  constexpr int most = 100'000, in_a_row = 100;
  const mjOption given = m->opt;
  if (relax) {
    m->opt.timestep /= 10;
    m->opt.enableflags |= mjENBL_ENERGY;
  }
  const int before = resets(d);
  double fastest = 0, energy = 0, speed = 0, time = 0;
  for (int i = 0, resting = 0; i < most && resting < in_a_row && resets(d) == before; ++i) {
    time += m->opt.timestep;
    if (time > (speed > very_still * fastest ? longest : least)) break;
    mj_step(m, d);
    speed = 0;
    for (int k = 0; k < m->nv; ++k) speed = std::max(speed, std::abs(d->qvel[k]));
    fastest = std::max(fastest, speed);
    resting = speed <= quite_still * fastest ? resting + 1 : 0;
    if (!relax) continue;
    const double now = d->energy[1];
    if (now < energy) std::fill_n(d->qvel, m->nv, 0.0);
    energy = now < energy ? 0 : now;
  }
  m->opt = given;
  return resets(d) == before && speed <= still * fastest;
}

/// A scene that the file's own steps do not bring to rest, as they are too long or nothing damps it, is
/// brought to it by others; if they cannot, it is left where it begins. @returns what becomes of it
const char* settle(mjModel* m, mjData* d, const mjData* begin) {
  if (comes_to_rest(m, d, false)) return "";
  if (resets(d) > resets(begin)) mj_copyData(d, m, begin);
  if (comes_to_rest(m, d, true)) return ", brought to rest by shorter steps than its own";
  mj_copyData(d, m, begin);
  return ", which does not come to rest";
}

int create(const char* text, void** handle) {
  const Argument argument = parse(text);
  auto scene = std::make_unique<Scene>();
  std::string message(1000, '\0');
  if (guarded([&] {
        scene->m =
            mj_loadXML(argument.file.c_str(), nullptr, message.data(), static_cast<int>(message.size()));
      }) != HMAX_OK)
    return failed;
  if (!scene->m) {
    reason = in_one_line(message.c_str());
    return failed;
  }
  if (scene->m->nv == 0) {
    reason = "nothing in the scene moves; give a body a joint";
    return failed;
  }
  if (!(scene->m->opt.timestep > 0)) {
    reason = "the timestep is not positive; write one like 0.002";
    return failed;
  }
  const int keyframe = argument.keyframe.empty() ? -1 : number_of_keyframe(scene->m, argument.keyframe);
  if (!argument.keyframe.empty() && keyframe < 0) return failed;
  scene->parts = parts_of(scene->m, most_parts);
  const char* outcome = "";
  const int code = guarded([&] {
    scene->original = mj_copyModel(nullptr, scene->m);
    scene->d = mj_makeData(scene->m);
    if (keyframe >= 0) mj_resetDataKeyframe(scene->m, scene->d, keyframe);
    scene->begin = mj_copyData(nullptr, scene->m, scene->d);
    if (argument.settles) outcome = settle(scene->m, scene->d, scene->begin);
  });
  static constexpr std::array<const char*, 3> integrators{"Euler", "RK4", "implicit"};
  std::snprintf(note, sizeof note, "MuJoCo %s, %s%s", mj_versionString(),
                integrators.at(static_cast<std::size_t>(scene->m->opt.integrator)), outcome);
  if (code == HMAX_OK) *handle = scene.release();
  return code;
}
void destroy(void* handle) { delete &of(handle); }
const char* error_text(void*) { return reason.c_str(); }

/// qpos, qvel and the activations.
int dimension(void* handle, std::size_t* n) {
  const mjModel* m = of(handle).m;
  *n = static_cast<std::size_t>(m->nq + m->nv + m->na);
  return HMAX_OK;
}
int get_state(void* handle, double* y) {
  const mjModel* m = of(handle).m;
  const mjData* d = of(handle).d;
  y = std::copy_n(d->qpos, m->nq, y);
  y = std::copy_n(d->qvel, m->nv, y);
  std::copy_n(d->act, m->na, y);
  return HMAX_OK;
}
int set_state(void* handle, const double* y) {
  const mjModel* m = of(handle).m;
  mjData* d = of(handle).d;
  std::copy_n(y, m->nq, d->qpos);
  std::copy_n(y + m->nq, m->nv, d->qvel);
  std::copy_n(y + m->nq + m->nv, m->na, d->act);
  return HMAX_OK;
}
int step(void* handle, double h) {
  mjModel* m = of(handle).m;
  mjData* d = of(handle).d;
  m->opt.timestep = h;
  const int before = resets(d);
  const int code = guarded([&] { mj_step(m, d); });
  if (code != HMAX_OK || resets(d) == before) return code;
  // It was put back to the start of the file, without the controls of a keyframe.
  mj_copyData(d, m, of(handle).begin);
  return HMAX_DIVERGED;
}

/// The state, the start of the solver and the time.
std::size_t saved_size(void* handle) {
  const mjModel* m = of(handle).m;
  return sizeof(double) * static_cast<std::size_t>(m->nq + 2 * m->nv + m->na + 1);
}
int save(void* handle, void* blob) {
  const mjModel* m = of(handle).m;
  const mjData* d = of(handle).d;
  auto* to = static_cast<double*>(blob);
  get_state(handle, to);
  *std::copy_n(d->qacc_warmstart, m->nv, to + m->nq + m->nv + m->na) = d->time;
  return HMAX_OK;
}
int restore(void* handle, const void* blob, std::size_t) {
  const mjModel* m = of(handle).m;
  mjData* d = of(handle).d;
  const auto* from = static_cast<const double*>(blob);
  set_state(handle, from);
  from += m->nq + m->nv + m->na;
  std::copy_n(from, m->nv, d->qacc_warmstart);
  d->time = from[m->nv];
  return HMAX_OK;
}
int quaternions(void* handle, std::size_t* count, std::size_t* first) {
  const mjModel* m = of(handle).m;
  *count = 0;
  for (int j = 0; j < m->njnt; ++j)
    if (m->jnt_type[j] == mjJNT_FREE || m->jnt_type[j] == mjJNT_BALL) {
      if (first)
        first[*count] = static_cast<std::size_t>(m->jnt_qposadr[j] + (m->jnt_type[j] == mjJNT_FREE ? 3 : 0));
      ++*count;
    }
  return HMAX_OK;
}

int own_step(void* handle, double* h) {
  *h = of(handle).original->opt.timestep;
  return HMAX_OK;
}
int parts(void* handle, std::size_t* count, hmax_part* to) {
  const std::vector<Part>& all = of(handle).parts;
  *count = all.size();
  if (!to) return HMAX_OK;
  for (const Part& part : all) *to++ = {text_of(part.kind), part.name.c_str(), part.stiffness, part.damping};
  return HMAX_OK;
}
int scale_part(void* handle, std::size_t part, double stiffness, double damping) {
  const Scene& scene = of(handle);
  scale(scene.m, scene.original, scene.parts.at(part), stiffness, damping);
  return HMAX_OK;
}

const hmax_stepper stepper{.object = {create, destroy, error_text, dimension},
                           .flags = 0,
                           .get_state = get_state,
                           .set_state = set_state,
                           .step = step,
                           .saved_size = saved_size,
                           .save = save,
                           .restore = restore,
                           .quaternions = quaternions,
                           .scales = nullptr,
                           .couplings = nullptr,
                           .own_step = own_step,
                           .parts = parts,
                           .scale_part = scale_part};
const hmax_plugin_entry entries[]{{.name = "mujoco", .note = note, .model = nullptr, .stepper = &stepper}};
const hmax_plugin plugin{HMAX_PLUGIN_VERSION, 1, entries};

}  // namespace
}  // namespace hmax::mujoco

HMAX_PLUGIN_EXPORT const hmax_plugin* hmax_plugin_get(void) { return &hmax::mujoco::plugin; }
