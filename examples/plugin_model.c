/* A model of your own in C for hmax: a pendulum of two masses on stiff springs under gravity, M q'' = force(q, q').
 * The argument is the stiffness of the springs in N/m. */
#include <hmax/plugin.h>
#include <math.h>
#include <stdlib.h>

static const double mass_kg = 0.1, length = 0.2, damping_c = 0.02, gravity = 9.81;

static int create(const char* argument, void** handle) {
  double* k = malloc(sizeof *k);
  if (!k) return 2;
  *k = *argument ? atof(argument) : 1000;
  *handle = k;
  return HMAX_OK;
}

static void destroy(void* handle) { free(handle); }

static int dimension(void* handle, size_t* n) {
  (void)handle;
  *n = 8; /* x and y of two masses, and their velocities */
  return HMAX_OK;
}

/* At rest below the support, the springs stretched by the weights. */
static int start(void* handle, double* y0, double* t_end) {
  const double k = *(const double*)handle, weight = mass_kg * gravity;
  for (int i = 0; i < 8; ++i) y0[i] = 0;
  y0[1] = -(length + 2 * weight / k);
  y0[3] = y0[1] - (length + weight / k);
  *t_end = 2;
  return HMAX_OK;
}

static int mass(void* handle, double* m) {
  (void)handle;
  for (int i = 0; i < 4; ++i) m[i] = mass_kg;
  return HMAX_OK;
}

/* The force of a spring from a to b on b. */
static void pull(double k, const double* a, const double* b, double* on_b) {
  const double dx = b[0] - a[0], dy = b[1] - a[1], r = sqrt(dx * dx + dy * dy);
  on_b[0] = -k * (r - length) * dx / r;
  on_b[1] = -k * (r - length) * dy / r;
}

static int force(void* handle, double t, const double* q, const double* v, double* f) {
  const double support[2] = {0, 0};
  double upper[2], lower[2];
  (void)t;
  pull(*(const double*)handle, support, q, upper);
  pull(*(const double*)handle, q, q + 2, lower);
  for (int i = 0; i < 2; ++i) {
    f[i] = upper[i] - lower[i] - damping_c * v[i];
    f[2 + i] = lower[i] - damping_c * v[2 + i];
  }
  f[1] -= mass_kg * gravity;
  f[3] -= mass_kg * gravity;
  return HMAX_OK;
}

static const hmax_model model = {
    .object = {.create = create, .destroy = destroy, .dimension = dimension}, .start = start, .mass = mass, .force = force};
static const hmax_plugin_entry entries[] = {{.name = "pendulum", .note = "two masses on springs", .model = &model}};
static const hmax_plugin plugin = {HMAX_PLUGIN_VERSION, 1, entries};
HMAX_PLUGIN_EXPORT const hmax_plugin* hmax_plugin_get(void) { return &plugin; }
