#include "catalogue/models/model.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "catalogue/methods/method.hpp"
#include "catalogue/models/matrix_problem.hpp"
#include "catalogue/models/tissue_choice.hpp"
#include "catalogue/models/tissue_problem.hpp"
#include "core/input_error.hpp"
#include "core/text/digest.hpp"
#include "problems/tissue/body.hpp"

namespace hmax {

namespace {

const OscillatorParameters& parameters_of(const Problem& oscillator) {
  return std::get<Oscillator>(oscillator.system).parameters();
}

bool is_driven(const OscillatorParameters& oscillator) { return oscillator.P != 0 && oscillator.w != 0; }

/// Whether f is seen to change with time.
bool is_seen_driven(const AnySystem& system, const Eigen::VectorXd& y0, double t_end) {
  const Eigen::VectorXd scale = y0.cwiseAbs().cwiseMax(0.1);
  Eigen::VectorXd y = y0, f = y, later = y;
  for (const double u : {0.0, 0.7, -1.3})
    for (const double v : {0.0, 1.1, -0.6}) {
      for (Eigen::Index k = 0; k < y.size(); ++k) y[k] = y0[k] + (k % 2 == 0 ? u : v) * scale[k];
      system.rhs(0, y, f);
      for (int i = 1; i < 8; ++i) {
        // Multiples of the golden ratio hit no common period.
        system.rhs(i * std::numbers::phi * t_end / 13, y, later);
        if (f.allFinite() && later.allFinite() && later != f) return true;
      }
    }
  return false;
}

/// The lowest frequency of the loads of a body [rad/s]; infinity where none is periodic.
double slowest_load(const TissueSettings& settings) {
  double slowest = std::numeric_limits<double>::infinity();
  const auto look_at = [&](const auto& loads) {
    for (const auto& load : loads)
      if (load.profile.kind == TimeProfile::Kind::sine && load.profile.omega != 0)
        slowest = std::min(slowest, std::abs(load.profile.omega));
  };
  look_at(settings.supports);
  look_at(settings.forces);
  look_at(settings.tools);
  return slowest;
}

/// Empty where it is not known.
std::string_view unit_of(const Problem& problem, std::string_view parameter) {
  using Unit = std::pair<std::string_view, std::string_view>;
  static constexpr Unit of_oscillators[] = {{"m", "kg"},    {"c", "N s/m"}, {"k1", "N/m"},
                                            {"k3", "N/m³"}, {"P", "N"},     {"w", "rad/s"}};
  switch (problem.kind()) {
    case ModelKind::body:
      return unit_of_tissue_parameter(parameter);
    case ModelKind::matrices:
      return parameter == "alpha" ? "1/s" : "s";
    case ModelKind::oscillator:
      if (const auto* const known = std::ranges::find(of_oscillators, parameter, &Unit::first);
          known != std::end(of_oscillators))
        return known->second;
      return "1";
    default:
      return {};
  }
}

}  // namespace

const TissueBody& require_body(const Problem& problem, std::string_view otherwise) {
  if (problem.body) return *problem.body;
  throw input_error("{} is no body on a mesh, {}", problem.id, otherwise);
}

bool can_be_copied(const Problem& problem) { return problem.body || problem.again; }

Problem copy_for_thread(const Problem& problem) { return problem.body ? problem : problem.again(); }

Linearity linearity_of(const Problem& problem) {
  switch (problem.kind()) {
    case ModelKind::oscillator:
      return parameters_of(problem).k3 == 0 ? Linearity::linear : Linearity::nonlinear;
    case ModelKind::matrices:
      return times_of_matrices(problem).empty() ? Linearity::linear : Linearity::time_varying;
    default:
      return std::get<AnySystem>(problem.system).linearity();
  }
}

bool is_driven(const Problem& problem) {
  if (problem.kind() == ModelKind::oscillator) return is_driven(parameters_of(problem));
  if (problem.body) return has_moving_load(problem);
  const AnySystem& system = std::get<AnySystem>(problem.system);
  if (system.is_autonomous()) return false;
  // What says how it depends on the state says of time what is true: no comparison of instants, which may
  // miss the one.
  return system.linearity() != Linearity::unknown || is_seen_driven(system, problem.y0, problem.t_end);
}

bool has_moving_load(const Problem& problem) { return problem.body && !problem.body->is_autonomous(); }

std::optional<double> period_of_load(const Problem& problem) {
  double slowest = std::numeric_limits<double>::infinity();
  if (problem.body)
    slowest = slowest_load(problem.body->settings());
  else if (problem.kind() == ModelKind::oscillator && is_driven(problem))
    slowest = std::abs(parameters_of(problem).w);
  if (std::isinf(slowest)) return std::nullopt;
  return 2 * std::numbers::pi / slowest;
}

double end_of_motion(const Problem& problem) {
  constexpr double most_ends = 100;
  const double period = period_of_load(problem).value_or(0);
  return period <= most_ends * problem.t_end ? std::max(period, problem.t_end) : problem.t_end;
}

Eigen::Index unknowns_of(const Problem& problem) {
  return problem.body ? problem.body->dofs() : problem.y0.size();
}

double largest_change(const Problem& problem, const Eigen::Ref<const Eigen::VectorXd>& moved) {
  if (problem.body) return largest_displacement(moved.head(problem.body->dofs()));
  return moved.size() == 0 ? 0 : moved.cwiseAbs().maxCoeff();
}

std::string start_in_words(const Problem& problem) {
  constexpr Eigen::Index most_listed = 64;
  if (problem.body) return "rest";
  if (!problem.matrices || problem.y0.size() <= most_listed) return describe(problem.shown.state(problem.y0));
  Digest digest;
  digest.add({reinterpret_cast<const char*>(problem.y0.data()),
              sizeof(double) * static_cast<std::size_t>(problem.y0.size())});
  return fmt::format("{} numbers, {}", problem.y0.size(), digest.text());
}

std::vector<std::string> states_with_units(const Problem& problem) {
  std::vector<std::string> names = problem.states;
  for (std::size_t i = 0; i < problem.units.size(); ++i) names[i] += fmt::format(" [{}]", problem.units[i]);
  return names;
}

std::string with_unit(const Problem& problem, std::string_view parameter) {
  const std::string_view unit = unit_of(problem, parameter);
  return unit.empty() ? std::string(parameter) : fmt::format("{} [{}]", parameter, unit);
}

}  // namespace hmax
