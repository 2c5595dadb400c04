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
#include "addons/stepper.hpp"
#include "analysis/foreign_steps/settling.hpp"

namespace hmax::mujoco {
namespace {

using engines::Failure;

std::string error;
char note[200];
std::jmp_buf at_error;

/// MuJoCo ends the process with an error, unless this function does not return.
[[noreturn]] void leave(const char* message) {
  error = std::string("MuJoCo: ") + message;
  std::longjmp(at_error, 1);
}

/// Calls of MuJoCo, whose errors jump here: nothing in them needs a destructor.
/// @throws Failure
template <class Calls>
void guarded(const Calls& calls) {
  mju_user_error = leave;
  // Warnings would be written to a file in the folder of the user.
  mju_user_warning = [](const char*) {};
  if (setjmp(at_error)) throw Failure{error};
  calls();
}

/// What diverges MuJoCo resets, and counts.
int resets(const mjData* d) {
  return d->warning[mjWARN_BADQPOS].number + d->warning[mjWARN_BADQVEL].number +
         d->warning[mjWARN_BADQACC].number;
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

  /// qpos, qvel and the activations.
  [[nodiscard]] std::size_t dim() const {
    return static_cast<std::size_t>(m->nq) + static_cast<std::size_t>(m->nv) +
           static_cast<std::size_t>(m->na);
  }
  void state(double* y) const {
    y = std::copy_n(d->qpos, m->nq, y);
    y = std::copy_n(d->qvel, m->nv, y);
    std::copy_n(d->act, m->na, y);
  }
  void set_state(const double* y) const {
    std::copy_n(y, m->nq, d->qpos);
    std::copy_n(y + m->nq, m->nv, d->qvel);
    std::copy_n(y + m->nq + m->nv, m->na, d->act);
  }
  bool step(double h) const {
    m->opt.timestep = h;
    const int before = resets(d);
    guarded([&] { mj_step(m, d); });
    if (resets(d) == before) return true;
    // It was put back to the start of the file, without the controls of a keyframe.
    mj_copyData(d, m, begin);
    return false;
  }
  [[nodiscard]] double own_step() const { return original->opt.timestep; }
  /// The state, the start of the solver and the time.
  [[nodiscard]] std::size_t saved_size() const { return dim() + static_cast<std::size_t>(m->nv) + 1; }
  void save(double* to) const {
    state(to);
    *std::copy_n(d->qacc_warmstart, m->nv, to + dim()) = d->time;
  }
  void restore(const double* from) const {
    set_state(from);
    from += dim();
    std::copy_n(from, m->nv, d->qacc_warmstart);
    d->time = from[m->nv];
  }
  [[nodiscard]] std::vector<std::size_t> quaternions() const {
    std::vector<std::size_t> first;
    for (int j = 0; j < m->njnt; ++j)
      if (m->jnt_type[j] == mjJNT_FREE || m->jnt_type[j] == mjJNT_BALL)
        first.push_back(static_cast<std::size_t>(m->jnt_qposadr[j] + (m->jnt_type[j] == mjJNT_FREE ? 3 : 0)));
    return first;
  }
  /// Lengths as large as the bodies, angles and all others as 1: those of the start may be zero but for
  /// rounding.
  void scales(double* scale) const {
    std::fill_n(scale, dim(), 1.0);
    for (int j = 0; j < m->njnt; ++j) {
      const int count = m->jnt_type[j] == mjJNT_FREE ? 3 : m->jnt_type[j] == mjJNT_SLIDE ? 1 : 0;
      std::fill_n(scale + m->jnt_qposadr[j], count, m->stat.meansize);
      std::fill_n(scale + m->nq + m->jnt_dofadr[j], count, m->stat.meansize);
    }
  }
  [[nodiscard]] const std::vector<engines::NamedPart>& parts() const { return named; }
  void scale_part(std::size_t part, double stiffness, double damping) const {
    scale(m, original, own.at(part), stiffness, damping);
  }

  mjModel *m = nullptr, *original = nullptr;
  mjData *d = nullptr, *begin = nullptr;  ///< `begin`: with the controls of the scene
  std::vector<Part> own;
  std::vector<engines::NamedPart> named;
};

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

/// @throws Failure  where there is none
int number_of_keyframe(const mjModel* m, const std::string& name) {
  const int named = mj_name2id(m, mjOBJ_KEY, name.c_str());
  if (named >= 0) return named;
  for (int k = 0; k < m->nkey; ++k)
    if (name == std::to_string(k)) return k;
  std::string reason = "there is no keyframe '" + name + "'; ";
  if (m->nkey == 0) reason += "the file has none";
  for (int k = 0; k < m->nkey; ++k) {
    const char* own = mj_id2name(m, mjOBJ_KEY, k);
    reason += (k > 0 ? ", " : "the file has ") + (own && *own ? std::string(own) : std::to_string(k));
  }
  throw Failure{reason};
}

class Settling final : public SettlingScene {
 public:
  explicit Settling(const Scene& scene) : scene_(scene), resets_(resets(scene.d)) {}

  [[nodiscard]] double timestep() const override { return scene_.original->opt.timestep; }
  void damp(double rate) override {
    for (int k = 0; k < scene_.m->nv; ++k)
      scene_.m->dof_damping[k] = scene_.original->dof_damping[k] + rate * scene_.m->dof_M0[k];
  }
  bool step(double h) override {
    scene_.m->opt.timestep = h;
    mj_step(scene_.m, scene_.d);
    return resets(scene_.d) == resets_;
  }
  [[nodiscard]] double speed() const override {
    double most = 0;
    for (int k = 0; k < scene_.m->nv; ++k) most = std::max(most, std::abs(scene_.d->qvel[k]));
    return most;
  }
  void begin_again() override { mj_copyData(scene_.d, scene_.m, scene_.begin); }

 private:
  const Scene& scene_;
  int resets_;
};

std::unique_ptr<Scene> scene_of(const Argument& argument) {
  auto scene = std::make_unique<Scene>();
  std::array<char, 1000> told{};
  guarded([&] {
    scene->m = mj_loadXML(argument.file.c_str(), nullptr, told.data(), static_cast<int>(told.size()));
  });
  const std::string message = told.data();
  if (!scene->m)
    throw Failure{
        in_one_line(message) +
        (message.find("'flexcomp'") == message.npos
             ? ""
             : "; this MuJoCo has no flexes, `hmax stability predict --scene FILE` reads one as a body")};
  if (scene->m->nv == 0) throw Failure{"nothing in the scene moves; give a body a joint"};
  if (!(scene->m->opt.timestep > 0)) throw Failure{"the timestep is not positive; write one like 0.002"};
  const int keyframe = argument.keyframe.empty() ? -1 : number_of_keyframe(scene->m, argument.keyframe);
  scene->own = parts_of(scene->m, engines::most_parts);
  for (const Part& part : scene->own)
    scene->named.push_back({text_of(part.kind), part.name, part.stiffness, part.damping});
  Settled outcome = Settled::by_own_steps;
  guarded([&] {
    scene->original = mj_copyModel(nullptr, scene->m);
    scene->d = mj_makeData(scene->m);
    if (keyframe >= 0) mj_resetDataKeyframe(scene->m, scene->d, keyframe);
    scene->begin = mj_copyData(nullptr, scene->m, scene->d);
  });
  Settling settling(*scene);
  guarded([&] {
    if (argument.settles) outcome = settle(settling);
    scene->m->opt.timestep = scene->original->opt.timestep;
  });
  static constexpr std::array<const char*, 3> integrators{"Euler", "RK4", "implicit"};
  std::snprintf(note, sizeof note, "MuJoCo %s, %s%s", mj_versionString(),
                integrators.at(static_cast<std::size_t>(scene->m->opt.integrator)), in_words(outcome));
  return scene;
}

int create(const char* text, void** handle) {
  return engines::guarded([&] { return *handle = scene_of(parse(text)).release(), true; });
}

const hmax_stepper stepper = engines::StepperCalls<Scene>::table(create);
const hmax_plugin_entry entries[]{{.name = "mujoco", .note = note, .model = nullptr, .stepper = &stepper}};
const hmax_plugin plugin{HMAX_PLUGIN_VERSION, 1, entries};

}  // namespace
}  // namespace hmax::mujoco

HMAX_PLUGIN_EXPORT const hmax_plugin* hmax_plugin_get(void) { return &hmax::mujoco::plugin; }
