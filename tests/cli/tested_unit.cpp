/// A unit of FMI 2.0 with known limits and faults, which its guid chooses. What the standard declares is
/// written once more here, so that a mistake in that of hmax is seen.
#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstring>
#include <fstream>
#include <string>
#include <unistd.h>

namespace {

constexpr int ok = 0, discard = 2, error = 3, fatal = 4, co_simulation = 1;
constexpr double omega = 100;

struct Callbacks {
  void (*logger)(void*, const char*, int, const char*, const char*, ...);
  void* (*allocateMemory)(size_t, size_t);
  void (*freeMemory)(void*);
  void (*stepFinished)(void*, int);
  void* componentEnvironment;
};

struct EventInfo {
  int newDiscreteStatesNeeded, terminateSimulation, nominalsOfContinuousStatesChanged,
      valuesOfContinuousStatesChanged, nextEventTimeDefined;
  double nextEventTime;
};

/// Of the two types: x' = -rate x, and x'' = -omega^2 x.
struct Unit {
  std::string kind;
  Callbacks callbacks{};
  double rate = 1000, t = 0, y[2] = {1, 0}, behind = 0;
  int phase = 0;  ///< new, in its initialisation, in its use, in error
  bool continuous = false;

  [[nodiscard]] bool is(const char* wanted) const { return kind == wanted; }
  void inner_step(double h) {
    y[1] -= h * omega * omega * y[0];
    y[0] += h * y[1];
  }
};

Unit& of(void* unit) { return *static_cast<Unit*>(unit); }
/// Calls in another order than that of the standard are errors.
int enter(void* unit, int from, int to) {
  if (of(unit).phase != from) return error;
  of(unit).phase = to;
  return ok;
}

}  // namespace

extern "C" {

const char* fmi2GetVersion() { return "2.0"; }

void* fmi2Instantiate(const char* name, int type, const char* guid, const char* resources,
                      const Callbacks* callbacks, int visible, int) {
  if (std::strcmp(guid, "refuses") == 0) {
    callbacks->logger(nullptr, name, error, "error", "the guid '%s' is of another %s", guid, "unit");
    return nullptr;
  }
  auto* const unit = new Unit{.kind = guid, .callbacks = *callbacks};
  if (type == co_simulation) unit->rate = 0;
  if (unit->is("resource"))
    std::ifstream(std::string(resources).substr(std::strlen("file://")) + "/rate.txt") >> unit->rate;
  return visible ? nullptr : unit;
}
void fmi2FreeInstance(void* unit) { delete &of(unit); }
int fmi2SetupExperiment(void* unit, int, double, double start, int, double) {
  of(unit).t = start;
  return of(unit).phase == 0 ? ok : error;
}
int fmi2EnterInitializationMode(void* unit) { return enter(unit, 0, 1); }
int fmi2ExitInitializationMode(void* unit) { return enter(unit, 1, 2); }
int fmi2Reset(void* unit) {
  Unit& all = of(unit);
  all = {.kind = all.kind, .callbacks = all.callbacks, .rate = all.rate};
  return ok;
}
int fmi2GetReal(void* unit, const unsigned int* of_what, size_t count, double* to) {
  for (size_t i = 0; i < count; ++i) to[i] = of(unit).y[of_what[i] - 7];
  return of(unit).phase == 2 ? ok : error;
}
int fmi2SetReal(void* unit, const unsigned int* of_what, size_t count, const double* from) {
  if (of(unit).phase > 1) return error;
  for (size_t i = 0; i < count; ++i)
    if (!of(unit).is("stuck")) of(unit).y[of_what[i] - 7] = from[i];
  return ok;
}

int fmi2NewDiscreteStates(void* unit, EventInfo* event) {
  *event = {.newDiscreteStatesNeeded = !of(unit).continuous,
            .terminateSimulation = of(unit).is("ends"),
            .nominalsOfContinuousStatesChanged = 0,
            .valuesOfContinuousStatesChanged = 0,
            .nextEventTimeDefined = 0,
            .nextEventTime = 0};
  of(unit).continuous = true;
  return of(unit).phase == 2 ? ok : error;
}
int fmi2EnterContinuousTimeMode(void* unit) { return of(unit).continuous ? enter(unit, 2, 3) : error; }
int fmi2SetTime(void* unit, double t) {
  of(unit).t = t;
  return of(unit).phase == 3 ? ok : error;
}
int fmi2SetContinuousStates(void* unit, const double* y, size_t n) {
  std::copy_n(y, n, of(unit).y);
  return of(unit).phase == 3 ? ok : error;
}
int fmi2GetContinuousStates(void* unit, double* y, size_t n) {
  std::copy_n(of(unit).y, n, y);
  return of(unit).phase == 3 ? ok : error;
}
int fmi2GetDerivatives(void* unit, double* dydt, size_t) {
  Unit& at = of(unit);
  if (at.is("bounded") && std::abs(at.y[0]) > 2) return enter(unit, 3, 4) == ok ? error : fatal;
  dydt[0] = -at.rate * at.y[0];
  if (at.is("forced")) dydt[0] += at.t;
  return at.phase == 3 ? ok : error;
}

int fmi2DoStep(void* unit, double t, double h, int) {
  Unit& at = of(unit);
  if (at.phase != 2 || std::abs(t - at.t) > 1e-9) return error;
  if (at.is("crash")) std::raise(SIGSEGV);
  if (at.is("hang"))
    while (true) pause();
  if (at.is("fatal")) {
    at.callbacks.logger(nullptr, "hmax", fatal, "", "no licence for %d steps", 2);
    return fatal;
  }
  if (at.is("discard") && h > 0.01) return discard;
  if (at.is("error") && h > 0.01) return at.phase = 4, error;
  at.t += h;
  if (!at.is("inner")) return at.inner_step(h), ok;
  // Steps of its own, and what is left of the time for the next call.
  constexpr double own = 0.03;
  for (at.behind += h; at.behind >= own; at.behind -= own) at.inner_step(own);
  return ok;
}
}
