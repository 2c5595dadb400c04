#include "bench/timing/precision.hpp"

#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "analysis/step_limits/stable_step.hpp"
#include "catalogue/models/model.hpp"
#include "catalogue/models/problems.hpp"
#include "core/dense_solvers.hpp"
#include "core/size_limits.hpp"
#include "integrators/implicit/jacobian.hpp"

namespace hmax {

SweepSpec precision_sweep(const PrecisionSpec& spec) {
  SweepSpec sweep;
  sweep.problems = {spec.problem};
  sweep.methods = spec.methods;
  sweep.h.clear();
  sweep.control = spec.control;
  sweep.t_end = spec.t_end;
  sweep.repeats = spec.repeats;
  sweep.budget_s = spec.budget_s;
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

namespace {

/// The eigenvalues of the Jacobian at (t, y) [1/s].
template <System Sys>
Eigen::VectorXcd spectrum_at(const Sys& system, double t, const typename Sys::State& y) {
  JacobianSource<typename Sys::State, jacobian_type<Sys>> source;
  source.init(system);
  jacobian_type<Sys> J;
  source.evaluate(system, t, y, J);
  Eigen::MatrixXd dense;
  if constexpr (detail::is_variant<jacobian_type<Sys>>)
    std::visit([&](const auto& held) { dense = held; }, J);
  else
    dense = J;
  return dense_eigenvalues(dense);
}

}  // namespace

std::string error_in_words(const Problem& problem, ErrorOf which) {
  const std::string of = problem.body ? "any displacement [m] or velocity [m/s]"
                         : problem.units.empty()
                             ? "any state, in its own unit"
                             : fmt::format("any state, {}", fmt::join(states_with_units(problem), " or "));
  return fmt::format("largest error of {}, {}", of,
                     which == ErrorOf::end       ? "at the end"
                     : which == ErrorOf::largest ? "at any accepted step"
                                                 : "root mean square over time");
}

std::optional<double> predicted_step_limit(const Method& method, const Problem& problem,
                                           const Reference& reference, double t_end) {
  constexpr int times = 40;
  // Steps of positions and velocities ask for more than a Jacobian; what is measured takes longer than runs.
  if (!method.amplification || method.amplification->of_oscillation || method.amplification->measured ||
      problem.y0.size() > most_explained_states || reference.valid_until < t_end)
    return std::nullopt;
  return std::visit(
      [&]<class Sys>(const Sys& system) {
        double h = std::numeric_limits<double>::infinity();
        for (int i = 0; i <= times; ++i) {
          const double t = t_end * i / times;
          const Eigen::VectorXcd spectrum = spectrum_at(system, t, typename Sys::State(reference.at(t)));
          const std::span<const Complex> modes(spectrum.data(), static_cast<std::size_t>(spectrum.size()));
          h = std::min(h, largest_stable_step(*method.amplification, modes).h_max);
        }
        return h;
      },
      problem.system);
}

}  // namespace hmax
