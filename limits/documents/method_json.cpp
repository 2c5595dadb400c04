#include "limits/documents/method_json.hpp"

#include <cmath>
#include <complex>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "limits/documents/fidelity_json.hpp"
#include "limits/documents/number_json.hpp"

namespace hmax {

namespace {

using Json = nlohmann::ordered_json;

Json complex_or_null(std::complex<double> value) {
  if (!std::isfinite(value.real()) || !std::isfinite(value.imag())) return {};
  return {{"re", value.real()}, {"im", value.imag()}};
}

Json status_json(const ProbedLimit& found) {
  return found.status.empty() ? Json() : Json(fmt::format("{}", fmt::join(found.status, "; ")));
}

}  // namespace

nlohmann::ordered_json method_json(const Method& method) {
  return {{"id", method.id},
          {"aliases", method.aliases},
          {"family", method.family},
          {"order", method.order},
          {"error_order", method.error_order},
          {"stages", method.stages},
          {"explicit", method.is_explicit},
          {"adaptive", method.adaptive()},
          {"fixed_step", method.fixed_step},
          {"needs_jacobian", method.needs_jacobian},
          {"needs_second_order", method.needs_second_order},
          {"needs_split", method.needs_split},
          {"needs_body", static_cast<bool>(method.unsuited)},
          {"linearly_implicit", method.linearly_implicit},
          {"first_same_as_last", method.first_same_as_last},
          {"steps_back", method.steps_back},
          {"parameters", parameters_json(method.parameters)},
          {"a_stable", method.a_stable},
          {"l_stable", method.l_stable},
          {"engine", method.engine},
          {"source", method.source},
          {"note", method.note}};
}

Json limits_json(const Formula& formula, const StabilityLimits& limits) {
  const bool motion = static_cast<bool>(formula.amplification->of_oscillation);
  Json lobes = Json::array();
  for (const Lobe& lobe : limits.lobes)
    lobes.push_back({{"axis", lobe.imaginary ? "imaginary" : "real"},
                     {"from", lobe.from},
                     {"to", number_or_word(lobe.to)}});
  Json document{
      {"method", formula.id},
      {"order", formula.order},
      {"real", motion ? Json() : number_or_word(limits.real)},
      {"imaginary", number_or_word(limits.imaginary)},
      {"imaginary_weak", number_or_word(limits.imaginary_weak)},
      {"alpha_degrees", limits.alpha_degrees ? Json(*limits.alpha_degrees) : Json()},
      {"a_stable", limits.a_stable},
      {"l_stable", limits.l_stable},
      {"at_infinity",
       limits.at_infinity && std::isfinite(*limits.at_infinity) ? Json(*limits.at_infinity) : Json()},
      {"evaluations", formula.evaluations > 0 ? Json(formula.evaluations) : Json()},
      {"derived_from", formula.amplification->measured ? "steps of the code" : "coefficients"},
      {"lobes", lobes}};
  if (motion) {
    document["status"] =
        "steps positions and velocities: `imaginary` is the undamped omega h, and a real eigenvalue alone is "
        "no motion";
    document["critically_damped"] = number_or_word(limits.real);
  }
  if (formula.explicit_half) {
    const StabilityLimits half = stability_limits(*formula.explicit_half);
    document["nothing_stiff"] = {{"real", number_or_word(half.real)},
                                 {"imaginary", number_or_word(half.imaginary)},
                                 {"imaginary_weak", number_or_word(half.imaginary_weak)}};
  }
  return document;
}

Json region_json(const std::string& method, const PlaneWindow& window,
                 const std::vector<RegionCurve>& curves) {
  Json list = Json::array(), about = Json::array();
  for (const RegionCurve& curve : curves) {
    Json points = Json::array();
    for (const Complex z : curve.points) points.push_back({z.real(), z.imag()});
    points.push_back(points.front());
    list.push_back(std::move(points));
    const double area = curve.area();
    about.push_back({{"area", area}, {"hole", area < 0}, {"clipped", curve.clipped}});
  }
  return {{"method", method},
          {"window", {window.re_from, window.re_to, window.im_from, window.im_to}},
          {"curves", std::move(list)},
          {"about", std::move(about)}};
}

Json probe_json(const ProbedLimit& found) {
  Json rows = Json::array();
  for (const StepSpectrum& row : found.rows)
    rows.push_back({{"h", row.h},
                    {"spectral_radius", number_or_word(row.spectral_radius)},
                    {"grows", row.grows},
                    {"growing", row.grows ? complex_or_null(row.multiplier) : Json()},
                    {"tolerance", row.tolerance},
                    {"settles", row.settles ? Json(*row.settles) : Json()},
                    {"settled_moves", number_or_word(row.settled_moves)},
                    {"modes", modes_json(row.modes)}});
  return {{"model", found.model},
          {"dim", found.dim},
          {"state", name_of(found.state)},
          {"smoothness", name_of(found.smoothness)},
          {"rows", rows},
          {"h_max", number_or_word(found.h_max)},
          {"moving", found.moving},
          {"observed", number_or_word(found.observed)},
          {"gap", number_or_word(found.gap)},
          {"steps", found.steps},
          {"contradiction", found.contradiction},
          {"status", status_json(found)}};
}

Json own_step_json(const OwnStep& own) {
  Json owner;
  const auto number = [](double value, const LargestNumber& largest) {
    return Json{{"value", value},
                {"largest", number_or_word(largest.alone)},
                {"largest_of_alike", number_or_word(largest.together)}};
  };
  if (own.owner)
    owner = {{"kind", own.owner->part.kind},
             {"name", own.owner->part.name},
             {"share", own.owner->share},
             {"alike", {{"count", own.owner->alike}, {"share", own.owner->share_of_alike}}},
             {"stiffness", number(own.owner->part.stiffness, own.owner->stiffness)},
             {"damping", number(own.owner->part.damping, own.owner->damping)}};
  return {{"timestep", own.h},
          {"stable", own.stable ? Json(*own.stable) : Json()},
          {"substeps", own.substeps ? Json(*own.substeps) : Json()},
          {"settles", own.settles ? Json(*own.settles) : Json()},
          {"stiffness_shown", number_or_word(own.stiffness_shown)},
          {"owner", owner}};
}

Json comparison_json(const ProbedLimit& found, const Eigen::VectorXd& load) {
  const StepSpectrum &model = found.rows.front(), &row = found.rows.back();
  const bool rests = row.settles.value_or(false) && model.settled.size() > 0;
  return {
      {"model", found.model},
      {"dim", found.dim},
      {"h0", model.h},
      {"h", row.h},
      {"spectral_radius", number_or_word(row.spectral_radius)},
      {"grows", row.grows},
      {"settles", row.settles ? Json(*row.settles) : Json()},
      {"settled_moves", number_or_word(row.settled_moves)},
      {"stiffness_shown",
       rests && load.size() > 0 ? number_or_word(load.dot(model.settled) / load.dot(row.settled)) : Json()},
      {"modes", modes_json(row.modes)},
      {"status", status_json(found)}};
}

}  // namespace hmax
