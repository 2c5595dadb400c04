/// A stepper of your own for `hmax probe`: masses on damped springs, the damping implicit and iterated.
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <hmax/plugin.h>
#include <vector>

struct Chain {
  std::size_t n;
  std::vector<double> all;  // x [m], v [m/s], and the velocities w that the last step ended with
};
static Chain& of(void* handle) { return *static_cast<Chain*>(handle); }
static double apart(const double* u, std::size_t i, std::size_t n) {
  return 2 * u[i] - (i > 0 ? u[i - 1] : 0) - (i + 1 < n ? u[i + 1] : 0);
}
// m (w - v) = -h (k apart(x) + c apart(w)) by Gauss and Seidel, v = w, x += h v
static int step(void* handle, double h) {
  constexpr double m = 0.01, k = 1000, c = 0.05;  // kg, N/m, N s/m
  const std::size_t n = of(handle).n;
  double *x = of(handle).all.data(), *v = x + n, *w = v + n, change = 1, size = 0;
  for (int sweep = 0; sweep < 500 && change > 1e-13 * size; ++sweep) {
    change = size = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const double by = (m * (v[i] - w[i]) - h * (k * apart(x, i, n) + c * apart(w, i, n))) / (m + 2 * h * c);
      w[i] += by;
      change = std::fmax(change, std::fabs(by)), size = std::fmax(size, std::fabs(w[i]));
    }
  }
  for (std::size_t i = 0; i < n; ++i) x[i] += h * (v[i] = w[i]);
  return std::isfinite(size) ? HMAX_OK : HMAX_DIVERGED;
}
static int create(const char* argument, void** handle) {  // the argument is the number of masses
  const std::size_t n = *argument ? std::strtoul(argument, nullptr, 10) : 20;
  return n == 0 ? 2 : (*handle = new Chain{n, std::vector<double>(3 * n)}, HMAX_OK);
}
static void destroy(void* handle) { delete &of(handle); }
static int dimension(void* handle, size_t* n) { return *n = 2 * of(handle).n, HMAX_OK; }
static size_t saved_size(void* handle) { return sizeof(double) * of(handle).all.size(); }
static int copied(void* to, const void* from, size_t bytes) { return std::memcpy(to, from, bytes), HMAX_OK; }
static int get(void* handle, double* y) { return copied(y, of(handle).all.data(), 16 * of(handle).n); }
static int set(void* handle, const double* y) { return copied(of(handle).all.data(), y, 16 * of(handle).n); }
static int save(void* handle, void* to) { return copied(to, of(handle).all.data(), saved_size(handle)); }
static int restore(void* handle, const void* from, size_t n) {
  return copied(of(handle).all.data(), from, n);
}
static const hmax_stepper stepper{
    {create, destroy, nullptr, dimension}, 0, get, set, step, saved_size, save, restore, nullptr, nullptr};
static const hmax_plugin_entry entries[]{{"chain", "masses on damped springs", nullptr, &stepper}};
static const hmax_plugin plugin{HMAX_PLUGIN_VERSION, 1, entries};
HMAX_PLUGIN_EXPORT const hmax_plugin* hmax_plugin_get(void) { return &plugin; }
