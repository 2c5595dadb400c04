/// A stepper for `hmax probe`: a scene of MuJoCo, whose file is the argument. It settles for twenty seconds
/// first. The state is qpos, qvel and the activations; hidden are the start of the solver and the time.
#include <algorithm>
#include <hmax/plugin.h>
#include <mujoco/mujoco.h>

struct Scene {
  mjModel* m;
  mjData* d;
};
static char reason[500];
static Scene& of(void* handle) { return *static_cast<Scene*>(handle); }

static int create(const char* argument, void** handle) {
  mjModel* m = mj_loadXML(argument, nullptr, reason, sizeof reason);
  if (!m) return 2;
  mjData* d = mj_makeData(m);
  while (d->time < 20) mj_step(m, d);
  *handle = new Scene{m, d};
  return HMAX_OK;
}
static void destroy(void* handle) {
  mj_deleteData(of(handle).d);
  mj_deleteModel(of(handle).m);
  delete &of(handle);
}
static const char* error_text(void*) { return reason; }
static int dimension(void* handle, size_t* n) {
  return *n = of(handle).m->nq + of(handle).m->nv + of(handle).m->na, HMAX_OK;
}
static int get(void* handle, double* y) {
  auto& [m, d] = of(handle);
  y = std::copy(d->qvel, d->qvel + m->nv, std::copy(d->qpos, d->qpos + m->nq, y));
  std::copy(d->act, d->act + m->na, y);
  return HMAX_OK;
}
static int set(void* handle, const double* y) {
  auto& [m, d] = of(handle);
  std::copy(y, y + m->nq, d->qpos);
  std::copy(y + m->nq, y + m->nq + m->nv, d->qvel);
  std::copy(y + m->nq + m->nv, y + m->nq + m->nv + m->na, d->act);
  return HMAX_OK;
}
// MuJoCo resets what diverges, and counts it.
static int resets(const mjData* d) {
  return d->warning[mjWARN_BADQPOS].number + d->warning[mjWARN_BADQVEL].number +
         d->warning[mjWARN_BADQACC].number;
}
static int step(void* handle, double h) {
  auto& [m, d] = of(handle);
  m->opt.timestep = h;
  const int before = resets(d);
  mj_step(m, d);
  return resets(d) > before ? HMAX_DIVERGED : HMAX_OK;
}
static size_t saved_size(void* handle) {
  return 8 * (of(handle).m->nq + 2 * of(handle).m->nv + of(handle).m->na + 1);
}
static int save(void* handle, void* blob) {
  auto& [m, d] = of(handle);
  auto* to = static_cast<double*>(blob);
  get(handle, to);
  *std::copy(d->qacc_warmstart, d->qacc_warmstart + m->nv, to + m->nq + m->nv + m->na) = d->time;
  return HMAX_OK;
}
static int restore(void* handle, const void* blob, size_t) {
  auto& [m, d] = of(handle);
  auto* from = static_cast<const double*>(blob);
  set(handle, from);
  from += m->nq + m->nv + m->na;
  std::copy(from, from + m->nv, d->qacc_warmstart);
  d->time = from[m->nv];
  return HMAX_OK;
}
static int quaternions(void* handle, size_t* count, size_t* first) {
  const mjModel* m = of(handle).m;
  *count = 0;
  for (int j = 0; j < m->njnt; ++j)
    if (m->jnt_type[j] == mjJNT_FREE || m->jnt_type[j] == mjJNT_BALL) {
      if (first) first[*count] = m->jnt_qposadr[j] + (m->jnt_type[j] == mjJNT_FREE ? 3 : 0);
      ++*count;
    }
  return HMAX_OK;
}
static const hmax_stepper stepper{{create, destroy, error_text, dimension},
                                  0,
                                  get,
                                  set,
                                  step,
                                  saved_size,
                                  save,
                                  restore,
                                  quaternions,
                                  nullptr};
static const hmax_plugin_entry entries[]{{"mujoco", "a scene of MuJoCo", nullptr, &stepper}};
static const hmax_plugin plugin{HMAX_PLUGIN_VERSION, 1, entries};
HMAX_PLUGIN_EXPORT const hmax_plugin* hmax_plugin_get(void) { return &plugin; }
