/* A model of your own in C for hmax: a pendulum of two masses on stiff springs under gravity, M q'' = force(q, q').
 * q has the displacements of the masses from rest, x and y of each. The argument is the stiffness of the springs in N/m. */
#include <hmax/plugin.h>
#include <math.h>
#include <stdlib.h>

static const double mass_kg = 0.1, length = 0.2, damping_c = 0.02, gravity = 9.81;

typedef struct {
  double k;       /* stiffness [N/m] */
  double rest[2]; /* heights of the masses at rest [m], the support at 0 */
} pendulum;

static int create(const char* argument, void** handle) {
  pendulum* p = malloc(sizeof *p);
  const double weight = mass_kg * gravity;
  if (!p) return 2;
  p->k = *argument ? atof(argument) : 1000;
  p->rest[0] = -(length + 2 * weight / p->k); /* the upper spring carries both masses */
  p->rest[1] = p->rest[0] - (length + weight / p->k);
  *handle = p;
  return HMAX_OK;
}

static void destroy(void* handle) { free(handle); }

static int dimension(void* handle, size_t* n) {
  (void)handle;
  *n = 8; /* the displacements and their velocities */
  return HMAX_OK;
}

/* The lower mass is held 2 cm aside and released. */
static int start(void* handle, double* y0, double* t_end) {
  (void)handle;
  for (int i = 0; i < 8; ++i) y0[i] = 0;
  y0[2] = 0.02;
  *t_end = 2;
  return HMAX_OK;
}

static int mass(void* handle, double* m) {
  (void)handle;
  for (int i = 0; i < 4; ++i) m[i] = mass_kg;
  return HMAX_OK;
}

/* A spring with its ends (dx, dy) apart: the force f on the second end, and K = -d f / d (dx, dy). */
static void spring(double k, double dx, double dy, double f[2], double K[2][2]) {
  const double r = sqrt(dx * dx + dy * dy), s = 1 - length / r, c = (1 - s) / (r * r);
  f[0] = -k * s * dx;
  f[1] = -k * s * dy;
  K[0][0] = k * (s + c * dx * dx);
  K[1][1] = k * (s + c * dy * dy);
  K[0][1] = K[1][0] = k * c * dx * dy;
}

/* The upper spring, from the support, and the lower one, between the masses. */
static void springs(const pendulum* p, const double* q, double f[2][2], double K[2][2][2]) {
  spring(p->k, q[0], p->rest[0] + q[1], f[0], K[0]);
  spring(p->k, q[2] - q[0], p->rest[1] - p->rest[0] + q[3] - q[1], f[1], K[1]);
}

static int force(void* handle, double t, const double* q, const double* v, double* f) {
  double pull[2][2], K[2][2][2];
  (void)t;
  springs(handle, q, pull, K);
  for (int i = 0; i < 2; ++i) {
    f[i] = pull[0][i] - pull[1][i] - damping_c * v[i];
    f[2 + i] = pull[1][i] - damping_c * v[2 + i];
  }
  f[1] -= mass_kg * gravity;
  f[3] -= mass_kg * gravity;
  return HMAX_OK;
}

/* Optional, as damping: hmax takes differences of the forces where a model leaves them out. */
static int stiffness(void* handle, double t, const double* q, const double* v, double* K) {
  double pull[2][2], of[2][2][2];
  (void)t, (void)v;
  springs(handle, q, pull, of);
  for (int j = 0; j < 2; ++j)
    for (int i = 0; i < 2; ++i) {
      K[i + 4 * j] = of[0][i][j] + of[1][i][j];
      K[2 + i + 4 * j] = K[i + 4 * (2 + j)] = -of[1][i][j];
      K[2 + i + 4 * (2 + j)] = of[1][i][j];
    }
  return HMAX_OK;
}

static int damping(void* handle, double t, const double* q, const double* v, double* C) {
  (void)handle, (void)t, (void)q, (void)v;
  for (int i = 0; i < 16; ++i) C[i] = i % 5 == 0 ? damping_c : 0;
  return HMAX_OK;
}

static const hmax_model model = {.object = {.create = create, .destroy = destroy, .dimension = dimension},
                                 .start = start,
                                 .mass = mass,
                                 .force = force,
                                 .stiffness = stiffness,
                                 .damping = damping};
static const hmax_plugin_entry entries[] = {{.name = "pendulum", .note = "two masses on springs", .model = &model}};
static const hmax_plugin plugin = {HMAX_PLUGIN_VERSION, 1, entries};
HMAX_PLUGIN_EXPORT const hmax_plugin* hmax_plugin_get(void) { return &plugin; }
