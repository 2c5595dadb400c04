/// Units of FMI 2.0 for `hmax probe`, which their guid chooses; all rest at zero. Nothing of hmax is in it.
///   suspension   a quarter of a car, co-simulation by semi-implicit Euler
///   drive        a motor with a soft shaft, co-simulation by Heun's method
///   rod          heat in a rod of thirty cells of two materials, model exchange
#include <string>
#include <vector>

namespace {

using Vector = std::vector<double>;

struct Unit {
  std::string kind;
  Vector y;

  [[nodiscard]] Vector rates(const Vector& x) const {
    if (kind == "suspension") {  // body and wheel: positions, velocities
      const double spring = 18000 * (x[1] - x[0]) + 1100 * (x[3] - x[2]);
      return {x[2], x[3], spring / 320, (-spring - 190000 * x[1]) / 38};
    }
    if (kind == "drive") {  // current, angles of rotor and load, their velocities
      const double torque = 55 * (x[1] - x[2]) + 0.004 * (x[3] - x[4]);
      return {(-1.3 * x[0] - 0.09 * x[3]) / 0.0011, x[3], x[4], (0.09 * x[0] - torque) / 6e-5,
              torque / 9e-4 - 2 * x[4]};
    }
    Vector flow(x.size());
    const auto conductivity = [&](std::size_t i) { return i < x.size() / 2 ? 1.1e-4 : 1.7e-5; };
    for (std::size_t i = 0; i < x.size(); ++i) {
      const double left = i > 0 ? x[i - 1] : 0, right = i + 1 < x.size() ? x[i + 1] : x[i];
      flow[i] = (conductivity(i) * (left - x[i]) + conductivity(i + 1) * (right - x[i])) / (0.01 * 0.01) -
                0.02 * x[i];
    }
    return flow;
  }
  void step(double h) {
    const Vector first = rates(y);
    if (kind == "suspension") {
      for (const int i : {2, 3}) y[i] += h * first[i];
      for (const int i : {0, 1}) y[i] += h * y[i + 2];
      return;
    }
    Vector ahead = y;
    for (std::size_t i = 0; i < y.size(); ++i) ahead[i] += h * first[i];
    const Vector second = rates(ahead);
    for (std::size_t i = 0; i < y.size(); ++i) y[i] += h / 2 * (first[i] + second[i]);
  }
};
Unit& of(void* unit) { return *static_cast<Unit*>(unit); }

}  // namespace

extern "C" {
const char* fmi2GetVersion() { return "2.0"; }
void* fmi2Instantiate(const char*, int, const char* guid, const char*, const void*, int, int) {
  const std::string kind = guid;
  return new Unit{kind, Vector(kind == "suspension" ? 4 : kind == "drive" ? 5 : 30)};
}
void fmi2FreeInstance(void* unit) { delete &of(unit); }
int fmi2SetupExperiment(void*, int, double, double, int, double) { return 0; }
int fmi2EnterInitializationMode(void*) { return 0; }
int fmi2ExitInitializationMode(void*) { return 0; }
int fmi2Reset(void* unit) { return of(unit).y.assign(of(unit).y.size(), 0), 0; }
int fmi2GetReal(void* unit, const unsigned* which, std::size_t count, double* values) {
  for (std::size_t i = 0; i < count; ++i) values[i] = of(unit).y[which[i]];
  return 0;
}
int fmi2SetReal(void* unit, const unsigned* which, std::size_t count, const double* values) {
  for (std::size_t i = 0; i < count; ++i) of(unit).y[which[i]] = values[i];
  return 0;
}
int fmi2DoStep(void* unit, double, double h, int) { return of(unit).step(h), 0; }
int fmi2NewDiscreteStates(void*, int* event) { return event[0] = 0, event[1] = 0; }
int fmi2EnterContinuousTimeMode(void*) { return 0; }
int fmi2SetTime(void*, double) { return 0; }
int fmi2SetContinuousStates(void* unit, const double* y, std::size_t n) {
  return of(unit).y.assign(y, y + n), 0;
}
int fmi2GetContinuousStates(void* unit, double* y, std::size_t n) {
  for (std::size_t i = 0; i < n; ++i) y[i] = of(unit).y[i];
  return 0;
}
int fmi2GetDerivatives(void* unit, double* rate, std::size_t n) {
  const Vector rates = of(unit).rates(of(unit).y);
  for (std::size_t i = 0; i < n; ++i) rate[i] = rates[i];
  return 0;
}
}
