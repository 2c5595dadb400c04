/// What the bisections with an engine alone share. Nothing of hmax is in it.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdio>

/// Whether a motion grows whose kinetic energy after each further step is energy_after(): where the largest
/// of the last fifth of the steps exceeds that of the second fifth ten times, or what the kick gave `many`
/// times.
template <class EnergyAfter>
bool energy_grows(double kick, double many, int steps, const EnergyAfter& energy_after) {
  double second = 0, last = 0;
  for (int i = 0; i < steps; ++i) {
    const double energy = energy_after();
    if (!std::isfinite(energy)) return true;
    if (5 * i >= steps && 5 * i < 2 * steps) second = std::max(second, energy);
    if (5 * i >= 4 * steps) last = std::max(last, energy);
  }
  return (last > 10 * second && last > kick) || last > many * kick;
}

/// Prints the step size from h0 to h1 from which steps grow: by strides of a tenth of `fine` steps each, then
/// by halves. @returns  the exit code
template <class Grows>
int print_limit(double h0, double h1, int fine, const Grows& grows) {
  const int scan = fine / 10;
  if (grows(h0, scan)) return std::puts("grows at h0"), 1;
  double low = h0, high = h0;
  do {
    low = high;
    high = std::min(h1, 1.05 * high);
  } while (!grows(high, scan) && high < h1);
  if (high == h1 && !grows(h1, fine)) return std::puts("unbounded"), 0;
  low *= 0.95;
  while (high - low > 1e-4 * high) {
    const double middle = (low + high) / 2;
    (grows(middle, fine) ? high : low) = middle;
  }
  std::printf("%.7g\n", (low + high) / 2);
  return 0;
}
