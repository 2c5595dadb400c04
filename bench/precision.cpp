#include "bench/precision.hpp"

#include <cmath>

namespace hmax {

SweepSpec precision_sweep(const PrecisionSpec& spec) {
  SweepSpec sweep;
  sweep.problems = {spec.problem};
  sweep.methods = spec.methods;
  sweep.h.clear();
  sweep.control = spec.control;
  sweep.t_end = spec.t_end;
  sweep.repeats = spec.repeats;
  std::vector<double> rtol = spec.rtol;
  if (rtol.empty())
    for (int digits = 3; digits <= 12; ++digits) rtol.push_back(std::pow(10.0, -digits));
  for (const double tolerance : rtol)
    sweep.tolerances.push_back({tolerance, tolerance * spec.atol_over_rtol});
  sweep.unsteered_h = spec.h;
  if (spec.h.empty()) {
    const double t_end = spec.t_end.value_or(make_problem(spec.problem.name, spec.problem.settings).t_end);
    for (int doublings = 5; doublings <= 17; doublings += 2)
      sweep.unsteered_h.push_back(std::ldexp(t_end, -doublings));
  }
  return sweep;
}

}  // namespace hmax
