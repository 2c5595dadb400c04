/// The step limit of a unit of FMI 2.0 by bisection with its library alone: bisect_unit LIBRARY.so GUID
/// STATES H0 H1. Steps are those of fmi2DoStep, of the unit `rod` explicit Euler with fmi2GetDerivatives.
#include <cstdlib>
#include <dlfcn.h>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include "bisect.hpp"

template <class Signature>
static Signature* function(void* library, const char* name) {
  return reinterpret_cast<Signature*>(dlsym(library, name));
}

int main(int, char** arguments) {
  void* const library = dlopen(arguments[1], RTLD_NOW);
  if (!library) return std::fprintf(stderr, "%s\n", dlerror()), 2;
  const std::string guid = arguments[2];
  const auto states = std::size_t(std::atoi(arguments[3]));
  const auto instantiate = function<void*(const char*, int, const char*, const char*, const void*, int, int)>(
      library, "fmi2Instantiate");
  const auto set = function<int(void*, const unsigned*, std::size_t, const double*)>(library, "fmi2SetReal");
  const auto get = function<int(void*, const unsigned*, std::size_t, double*)>(library, "fmi2GetReal");
  const auto step = function<int(void*, double, double, int)>(library, "fmi2DoStep");
  const auto derivatives = function<int(void*, double*, std::size_t)>(library, "fmi2GetDerivatives");
  void* const unit = instantiate("unit", 1, guid.c_str(), "", nullptr, 0, 0);
  std::vector<unsigned> all(states);
  std::iota(all.begin(), all.end(), 0U);
  std::vector<double> y(states), rate(states);
  const auto square = [&] {
    double sum = 0;
    for (const double each : y) sum += each * each;
    return sum;
  };
  return print_limit(std::atof(arguments[4]), std::atof(arguments[5]), 40000, [&](double h, int steps) {
    std::mt19937 numbers(7);
    std::normal_distribution<double> kick(0, 1e-6);
    for (double& each : y) each = kick(numbers);
    set(unit, all.data(), states, y.data());
    double t = 0;
    return energy_grows(square(), 1e9, steps, [&] {
      if (guid == "rod") {
        derivatives(unit, rate.data(), states);
        for (std::size_t i = 0; i < states; ++i) y[i] += h * rate[i];
        set(unit, all.data(), states, y.data());
      } else {
        step(unit, t, h, 0);
        t += h;
        get(unit, all.data(), states, y.data());
      }
      return square();
    });
  });
}
