#include "limits/predict.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "analysis/amplification/amplification.hpp"
#include "analysis/dynamics/coupled_motion.hpp"
#include "core/text/sentences.hpp"
#include "integrators/spectral_radius.hpp"
#include "integrators/structural/structural.hpp"
#include "limits/jacobian_changes.hpp"
#include "limits/modes/mode_curve.hpp"
#include "limits/modes/mode_range.hpp"
#include "problems/linearity.hpp"

namespace hmax {

namespace {

/// The amplification as far as the method can be analysed on this model, or why not.
std::string obstacle(const Method& method, const LinearModel& model) {
  if (method.needs_second_order && !model.mechanical)
    return "the method steps positions and velocities, which the problem does not have";
  if (method.needs_split && !model.J_stiff) return "the problem declares no stiff part";
  const std::optional<MotionMap>& motion = method.amplification->motion;
  if (motion && !motion->lumped.empty() && model.mechanical && !model.mechanical->mass.is_diagonal() &&
      model.mechanical->damping != Damping::none)
    return fmt::format("the method {}", needs_lumped_masses);
  return {};
}

/// A mode for each eigenvalue, of conjugates for the upper one only: methods and models are real.
std::vector<Mode> modes_of(const Spectrum& spectrum) {
  std::vector<Mode> modes;
  for (std::size_t i = 0; i < spectrum.lambda.size(); ++i) {
    const Complex lambda = spectrum.lambda[i];
    if (lambda.imag() < 0) continue;
    // Where the motion decouples the partner of a real one is known.
    modes.push_back(spectrum.mechanical.empty() ? mode_of(lambda) : mode_of(spectrum.mechanical[i / 2]));
    modes.back().lambda = lambda;
  }
  return modes;
}

std::vector<Complex> lambda_of(const std::vector<Mode>& modes) {
  std::vector<Complex> lambda;
  for (const Mode& mode : modes) lambda.push_back(mode.lambda);
  return lambda;
}

constexpr std::string_view other_modes = "; h_max is the limit of its other modes";

constexpr const char* without_common_modes =
    "the stiff part and the rest of this model have no common modes here, so that no mode alone says what a step "
    "makes of it; at rest without load (g of 0) or with linear tissue both are one, an implicit method has no such "
    "parts, and `hmax run` with --method and --h shows whether a step holds";

/// Beyond this many rows parts of a Jacobian are not looked into for common modes.
constexpr Eigen::Index most_dense_parts = 400;

/// Whether the part that is declared stiff is the whole.
bool is_all_stiff(const LinearModel& model) { return relative_distance(model.J(), model.J_stiff()) <= 1e-13; }

/// The share of every eigenvalue that is declared stiff. Where both parts have the same eigenvectors the
/// Rayleigh quotient with them says it.
std::optional<std::vector<Complex>> stiff_parts(const LinearModel& model,
                                                const std::vector<Complex>& lambda) {
  if (is_all_stiff(model)) return lambda;
  if (model.y.size() > most_dense_parts) return std::nullopt;
  const Eigen::MatrixXd J = dense(model.J()), stiff = dense(model.J_stiff());
  if ((J * stiff - stiff * J).norm() > 1e-10 * J.norm() * stiff.norm()) return std::nullopt;
  const Eigenvectors vectors = eigenvectors_of(model);
  if (vectors.defective) return std::nullopt;
  std::vector<Complex> parts;
  for (const Complex each : lambda) {
    const auto at =
        std::ranges::min_element(vectors.lambda, {}, [&](Complex l) { return std::abs(l - each); });
    const auto i = static_cast<Eigen::Index>(at - vectors.lambda.begin());
    parts.push_back((vectors.left.row(i) * stiff.cast<Complex>() * vectors.right.col(i)).value());
  }
  return parts;
}

/// The spectral radius by which a stabilised method chooses its stages: the bound of the system, or what the
/// estimate of the stepper comes to. Others do not ask for it.
double radius_told(const Method& method, const OperatingPoint& point, const ModeSet& modes) {
  if (!method.stages_by_radius) return std::numeric_limits<double>::quiet_NaN();
  if (point.radius_bound) return point.radius_bound();
  double radius = 0;
  for (const Complex lambda : modes.spectrum.lambda) radius = std::max(radius, std::abs(lambda));
  return SpectralRadius<Eigen::VectorXd>::margin * radius;
}

/// Whether equations of implicit steps are linear, as far as that is known here.
bool has_linear_equations(const OperatingPoint& point) {
  if (point.linearity != Linearity::unknown) return is_affine(point.linearity);
  return !depends_on_state(point.model, point.model_at);
}

/// What sets the step where no step is unstable.
Bound bound_without_limit(const Method& method, const OperatingPoint& point) {
  return method.solves_nonlinear_equations() && !has_linear_equations(point) ? Bound::newton
                                                                             : Bound::accuracy;
}

/// An oscillation named by the one of its eigenvalues that grows faster.
Mode growing_of(const MechanicalMode& oscillation) {
  Mode mode = mode_of(oscillation);
  mode.lambda = eigenvalues_of(oscillation)[0];
  return mode;
}

/// The one of modes that grow, given by their numbers, that grows fastest.
std::size_t fastest_of(const std::vector<std::size_t>& growing, const std::vector<Complex>& lambda) {
  return *std::ranges::max_element(growing, {}, [&](std::size_t i) { return lambda[i].real(); });
}

/// The end of a curve of modes that grows, of both the one that grows faster: no mode between grows faster
/// still.
std::optional<MechanicalMode> growing_end(const MechanicalPart& part, const ModeSet& modes) {
  DampingCurve curve = *modes.curve;
  if (modes.slow_end && curve.alpha < 0) curve.kappa_min = modes.slow_end->of(part, curve);
  const std::array<MechanicalMode, 2> ends{curve.at(curve.kappa_min), curve.at(curve.kappa_max)};
  std::vector<Complex> lambda;
  for (const MechanicalMode& end : ends)
    for (const Complex each : eigenvalues_of(end)) lambda.push_back(each);
  if (const auto growing = growing_modes(lambda); !growing.empty())
    return ends.at(fastest_of(growing, lambda) / 2);
  if (curve.kappa_min < 0) return ends[0];
  return std::nullopt;
}

/// The part of a curve whose modes do not grow, kappa >= 0 and alpha + beta kappa >= 0; nothing where there
/// is none.
std::optional<ModeSet> without_growth(ModeSet modes) {
  DampingCurve& curve = *modes.curve;
  if (curve.alpha < 0 && curve.beta <= 0) return std::nullopt;
  curve.kappa_min = std::max(curve.kappa_min, curve.alpha < 0 ? -curve.alpha / curve.beta : 0.0);
  if (curve.beta < 0) curve.kappa_max = std::min(curve.kappa_max, curve.alpha / -curve.beta);
  if (!(curve.kappa_max > 0 && curve.kappa_min <= curve.kappa_max)) return std::nullopt;
  modes.slow_end = nullptr;
  return modes;
}

/// Of a model of which no mode has a limit that means anything.
void is_of_growing_model(Prediction& row, const Mode& mode) {
  row.growing = mode;
  row.limiting = mode;
  row.bound = Bound::model;
}

/// Names what limits the step: nothing, or a mode.
void conclude(Prediction& row, double h_max, const Mode& mode, const Method& method,
              const OperatingPoint& point) {
  row.h_max = h_max;
  if (std::isinf(h_max)) {
    row.bound = bound_without_limit(method, point);
    return;
  }
  row.limiting = mode;
  row.bound = h_max > 0 ? Bound::stability : Bound::every_step;
  if (h_max == 0) row.note = "a mode that the model keeps is amplified by every step, however small";
}

/// Where only the ends of a spectrum are known the limit is the least along the curve of all modes between.
void predict_on_curve(Prediction& row, const Method& method, const OperatingPoint& point,
                      const ModeSet& modes) {
  std::optional<ModeSet> calm = modes;
  if (const auto growing = growing_end(*point.model.mechanical, modes)) {
    calm = without_growth(modes);
    if (!calm) return is_of_growing_model(row, growing_of(*growing));
    row.growing = growing_of(*growing);
  }
  LimitOnCurve limit = limit_on_curve(*method.amplification, *point.model.mechanical, *calm,
                                      radius_told(method, point, modes));
  row.modes = std::move(limit.modes);
  conclude(row, limit.h_max, limit.mode, method, point);
  if (row.note.empty()) row.note = limit.note;
}

/// From which step on the modes that are known, the fastest ones, are unstable.
StepLimit look_at_known(Prediction& row, const Method& method, const OperatingPoint& point,
                        const ModeSet& modes) {
  std::vector<Mode> all = modes_of(modes.spectrum);
  std::vector<Eigenmode> told;
  for (const Mode& mode : all) told.emplace_back(mode.lambda).radius = radius_told(method, point, modes);
  StepLimit limit = largest_stable_step(*method.amplification, told);
  for (std::size_t i = 0; i < all.size(); ++i) row.modes.push_back({all[i], limit.of_modes[i], told[i]});
  row.unstable_from = limit.h_max;
  return limit;
}

/// Where only the largest eigenvalues are known, and between which damping and stiffness all modes lie.
void predict_in_range(Prediction& row, const Method& method, const OperatingPoint& point,
                      const ModeSet& modes) {
  if (modes.range->growing) {
    is_of_growing_model(row, mode_of(*modes.range->growing));
    const double from = look_at_known(row, method, point, modes).h_max;
    row.note = std::isinf(from) ? "none of its fastest modes limits the step"
                                : fmt::format("its fastest modes are unstable from {:.6g} s on", from);
    return;
  }
  if (method.needs_split && !is_all_stiff(point.model)) {
    row.note = without_common_modes;
    return;
  }
  LimitInRange limit = limit_in_range(*method.amplification, *point.model.mechanical, modes,
                                      radius_told(method, point, modes));
  row.modes = std::move(limit.modes);
  row.unstable_from = limit.unstable_from;
  const std::string found =
      !row.unstable_from || std::isinf(*row.unstable_from)
          ? "none of the fastest modes limits the step"
          : fmt::format("the fastest modes are unstable from {:.6g} s on", *row.unstable_from);
  if (row.unstable_from && limit.h_max == 0) {
    row.note = fmt::format("damping couples the modes, and no bound of their limits is known; {}", found);
    return;
  }
  conclude(row, limit.h_max, limit.mode, method, point);
  if (!row.unstable_from) return;
  row.limiting.reset();
  row.note =
      fmt::format("a lower bound: damping couples the modes, and no step below h_max is unstable; {}", found);
}

/// Where the largest eigenvalues alone are known: from which step on these are unstable.
void predict_from_largest(Prediction& row, const Method& method, const OperatingPoint& point,
                          const ModeSet& modes) {
  if (method.needs_split && !is_all_stiff(point.model)) {
    row.note = without_common_modes;
    return;
  }
  const StepLimit limit = look_at_known(row, method, point, modes);
  if (!limit.growing.empty()) {
    std::vector<Complex> lambda;
    for (const ModeMargin& margin : row.modes) lambda.push_back(margin.mode.lambda);
    is_of_growing_model(row, row.modes[fastest_of(limit.growing, lambda)].mode);
  }
  row.note = fmt::format(
      "only the fastest modes of {} states without symmetric matrices are known; {}, and `hmax run` with --method and "
      "--h shows whether a step holds",
      point.model.y.size(),
      std::isinf(limit.h_max) ? std::string("none of them limits the step")
                              : fmt::format("they are unstable from {:.6g} s on", limit.h_max));
}

/// "; take explicit_newmark or symplectic_euler, which need no search": without the method itself.
std::string methods_without_search(const Method& method) {
  std::vector<std::string_view> others{"explicit_newmark", "symplectic_euler"};
  std::erase(others, method.id);
  return fmt::format("; take {}, which need{} no search", fmt::join(others, " or "),
                     others.size() == 1 ? "s" : "");
}

/// Where the steps couple modes the whole model has one limit.
void predict_coupled(Prediction& row, const Method& method, const OperatingPoint& point,
                     const ModeSet& modes) {
  row.state += "; the steps couple the modes, so that all of them are taken together";
  const std::vector<Mode> all = modes_of(modes.spectrum);
  for (const Mode& mode : all)
    row.modes.push_back({mode, std::numeric_limits<double>::quiet_NaN(), Eigenmode(mode.lambda)});
  const std::vector<Complex> lambda = lambda_of(all);
  if (modes.range && modes.range->growing)
    row.growing = mode_of(*modes.range->growing);
  else if (const auto growing = growing_modes(lambda); !growing.empty())
    row.growing = all[fastest_of(growing, lambda)];
  const MechanicalPart& part = *point.model.mechanical;
  const MotionMap& map = *method.amplification->motion;
  if (row.growing) {
    // Growth leaves at zeta = +1, and steps that are too long at -1, which is where P(-1, h) is singular.
    row.coupled = proved_first_exit(map, part, *method.amplification);
    if (!row.coupled) return is_of_growing_model(row, *row.growing);
    return conclude(row, row.coupled->h_max, mode_of(row.coupled->shape), method, point);
  }
  if (modes.range) row.coupled = modes.range->first_exit(*method.amplification, part);
  const bool elsewhere = modes.range && modes.range->find;
  if (!row.coupled && !elsewhere && part.mass.size() <= most_dense_modes)
    row.coupled = CoupledMotion(map, part).first_exit(*method.amplification);
  if (!row.coupled) {
    const std::string others = methods_without_search(method);
    row.note =
        elsewhere
            ? fmt::format(
                  "damping couples the modes, and a limit of this method would take a search among all of them{}",
                  others)
            : fmt::format(
                  "{} degrees of freedom whose modes are coupled are too many to look for the limit of this "
                  "method{}{} fewer degrees of freedom, or damping that couples nothing",
                  part.mass.size(), others, others.empty() ? "; take" : ", or take");
    return;
  }
  conclude(row, row.coupled->h_max, mode_of(row.coupled->shape), method, point);
}

/// The mode with the least limit of those that neither grow nor belong to an oscillation that does; nothing
/// where none of them moves.
/// @param growing  numbers of those that grow
std::optional<std::size_t> limiting_beside_growth(const std::vector<ModeMargin>& modes,
                                                  const std::vector<std::size_t>& growing) {
  std::optional<std::size_t> limiting;
  for (std::size_t i = 0; i < modes.size(); ++i) {
    const Mode& mode = modes[i].mode;
    const bool grows = std::ranges::any_of(
        growing, [&](std::size_t k) { return k == i || (mode.rates && modes[k].mode.rates == mode.rates); });
    if (grows || mode.lambda == 0.0) continue;
    if (!limiting || modes[i].h_max < modes[*limiting].h_max) limiting = i;
  }
  return limiting;
}

/// From all modes, one by one.
void predict_by_modes(Prediction& row, const Method& method, const OperatingPoint& point,
                      const ModeSet& modes) {
  const Amplification& amplification = *method.amplification;
  const bool of_oscillations = static_cast<bool>(amplification.of_oscillation);
  std::vector<Mode> all;
  if (of_oscillations)
    for (const MechanicalMode& oscillation : modes.spectrum.mechanical) all.push_back(mode_of(oscillation));
  else
    all = modes_of(modes.spectrum);
  const std::vector<Complex> lambda = lambda_of(all);
  std::vector<Eigenmode> told(lambda.begin(), lambda.end());
  if (!of_oscillations) {
    const double radius = radius_told(method, point, modes);
    for (Eigenmode& mode : told) mode.radius = radius;
    if (method.needs_split) {
      const auto parts = stiff_parts(point.model, lambda);
      if (!parts) {
        row.note = without_common_modes;
        return;
      }
      for (std::size_t i = 0; i < told.size(); ++i) told[i].stiff = (*parts)[i];
    }
  }
  // Both eigenvalues of an oscillation share its limit.
  const StepLimit limit = of_oscillations ? largest_stable_step(amplification, modes.spectrum.mechanical)
                                          : largest_stable_step(amplification, told);
  for (std::size_t i = 0; i < all.size(); ++i) row.modes.push_back({all[i], limit.of_modes[i], told[i]});
  if (limit.growing.empty()) return conclude(row, limit.h_max, all[limit.limiting], method, point);
  std::vector<Complex> faster = lambda;
  if (of_oscillations)
    std::ranges::transform(modes.spectrum.mechanical, faster.begin(),
                           [](const MechanicalMode& each) { return eigenvalues_of(each)[0]; });
  const std::size_t at = fastest_of(limit.growing, faster);
  const Mode fastest = of_oscillations ? growing_of(modes.spectrum.mechanical[at]) : all[at];
  const std::optional<std::size_t> limiting = limiting_beside_growth(row.modes, limit.growing);
  if (!limiting) return is_of_growing_model(row, fastest);
  row.growing = fastest;
  conclude(row, limit.of_modes[*limiting], all[*limiting], method, point);
}

/// Of steps of so many equal parts, for which the row was; the motions of `coupled` stay those of one part.
void is_of_parts(Prediction& row, double parts) {
  if (row.h_max) *row.h_max *= parts;
  if (row.unstable_from) *row.unstable_from *= parts;
  for (ModeMargin& margin : row.modes) margin.h_max *= parts;
  if (row.coupled) row.coupled->h_max *= parts;
}

}  // namespace

std::string growth_in_words(const Mode& growing, const OperatingPoint& point) {
  const double rate = growing.lambda.real(), twice = std::numbers::ln2 / rate;
  if (point.is_body && point.at_equilibrium && growing.lambda.imag() == 0)
    return fmt::format(
        "the body buckles: its stiffness at this equilibrium has a negative eigenvalue, and it leaves the equilibrium as "
        "exp({:.4g} t) whatever the step, doubling in {:.4g} s; take less load, `--along load` shows up to which share it "
        "does not",
        rate, twice);
  const bool of_matrices = point.kind == StateKind::matrices;
  return fmt::format(
      "the model itself grows as exp({:.4g} t){}, doubling in {:.4g} s: an eigenvalue has a positive real part, which no "
      "step changes; {}",
      rate, of_matrices ? "" : " here", twice,
      of_matrices ? "check whether the matrices are those of a stable state"
                  : "the limits that steps have are those along its motion, of --along motion");
}

Prediction predict(const Method& method, const OperatingPoint& point, const ModeSet& modes) {
  if (method.part) {
    Prediction row = predict(*method.part, point, modes);
    is_of_parts(row, method.parts);
    row.method = method.id;
    return row;
  }
  Prediction row;
  row.problem = point.problem;
  row.material = point.material;
  row.method = method.id;
  row.parameters = point.parameters;
  row.state_kind = point.kind;
  row.state = point.state;
  if (!method.amplification) {
    if (!method.fixed_step) row.bound = Bound::error_control;
    row.note =
        !method.fixed_step
            ? "the method chooses its steps as it runs"
            : "its iterations couple all points, so that no mode alone tells what a step makes of it; `hmax fidelity` tells";
    return row;
  }
  row.note = obstacle(method, point.model);
  if (!row.note.empty()) return row;

  const std::optional<MotionMap>& motion = method.amplification->motion;
  if (modes.curve && method.needs_split && !is_all_stiff(point.model))
    row.note = without_common_modes;
  else if (modes.curve && motion && couples_modes(*motion, *point.model.mechanical))
    row.note =
        "the method solves for the diagonal of the damping alone, which couples the modes of this model; take "
        "explicit_newmark, which solves for all of it, fewer degrees of freedom, or alpha in place of beta";
  else if (modes.curve)
    predict_on_curve(row, method, point, modes);
  else if (modes.range && modes.range->open && motion && point.model.mechanical)
    row.note = fmt::format(
        "the matrices are not symmetric, so that the steps of this method couple all of {} modes, which are too many; `hmax "
        "run` with --method and --h shows whether a step holds",
        point.model.y.size());
  else if (modes.range && modes.range->open)
    predict_from_largest(row, method, point, modes);
  else if (motion && couples_modes(*motion, *point.model.mechanical))
    predict_coupled(row, method, point, modes);
  else if (modes.range)
    predict_in_range(row, method, point, modes);
  else
    predict_by_modes(row, method, point, modes);
  if (row.growing) {
    std::string words = growth_in_words(*row.growing, point);
    if (row.h_max) words += other_modes;
    row.note = joined(words, row.note);
  }
  return row;
}

}  // namespace hmax
