#include "catalogue/device/device_method.hpp"

#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>

#include "catalogue/device/programs/body_step.hpp"
#include "core/errors.hpp"
#include "integrators/explicit/tableaux.hpp"
#include "integrators/positional/compliant_constraints.hpp"

namespace hmax {

namespace {

template <class Method>
DeviceMethod runge_kutta() {
  constexpr const auto& tableau = Method::tableau;
  constexpr std::size_t S = tableau.stages;
  static_assert(S <= StageSum<double>::most);
  DeviceMethod method{.kind = DeviceMethod::Kind::runge_kutta, .first_same_as_last = is_fsal(tableau)};
  for (std::size_t i = 1; i < S; ++i) method.rows.emplace_back(tableau.a[i].begin(), tableau.a[i].end());
  method.nodes.assign(tableau.c.begin(), tableau.c.end());
  // The last row is b where the last stage is the first of the next step.
  if (!method.first_same_as_last) method.rows.emplace_back(tableau.b.begin(), tableau.b.end());
  method.error_order = Method::error_order;
  if (has_error_estimate(tableau)) method.errors.emplace_back(tableau.b_err.begin(), tableau.b_err.end());
  if constexpr (requires { Method::b_err_low; })
    method.errors.emplace_back(Method::b_err_low.begin(), Method::b_err_low.end());
  return method;
}

template <class Polynomials>
DeviceMethod stabilised() {
  return {.kind = DeviceMethod::Kind::stabilised,
          .first_same_as_last = true,
          .errors = {{}},  // that of stabilized_error()
          .error_order = 3,
          .by_radius = {.choose = choose_stages<Polynomials, double>,
                        .longest_step = longest_stabilized_step<Polynomials, double>}};
}

/// Implicit Euler by a fixed number of iterations.
std::optional<DeviceMethod> iterated_method(const Method& method) {
  using Kind = DeviceMethod::Kind;
  const std::string_view family = std::string_view(method.id).substr(0, method.id.find(':'));
  const auto value = [&](const char* name) { return method.parameter(name).value(); };
  const auto count = [&](const char* name) { return static_cast<std::int32_t>(value(name)); };
  DeviceMethod made{.kind = Kind::constraints};
  if (family == "newton_truncated")
    made.kind = Kind::newton;
  else if (family == "vbd")
    made.kind = Kind::points;
  else if (family != "xpbd" && family != "pbd")
    return {};
  made.iterated = {.iterations = count("iterations"), .substeps = count("substeps")};
  if (family == "newton_truncated") {
    made.iterated.gradients = count("cg");
    made.iterated.frozen = value("frozen") == 1;
  }
  if (family == "vbd") made.iterated.rho = value("rho");
  if (family == "xpbd") made.iterated.resets = value("reset") == 1;
  if (family == "pbd")
    made.iterated.share = CompliantConstraints::share_of(value("stiffness"), value("iterations"));
  return made;
}

}  // namespace

void DeviceMethod::append_times(double t, double h, std::optional<double> before,
                                std::vector<double>& times) const {
  if (kind == Kind::kicks) return times.push_back(t + h);
  if (is_iterated()) {
    for (std::int32_t s = 1; s < iterated.substeps; ++s) times.push_back(t + s * (h / iterated.substeps));
    return times.push_back(t + h);
  }
  times.push_back(first_same_as_last ? before.value_or(t) : t);
  for (std::size_t i = 1; i < static_cast<std::size_t>(instants()); ++i)
    times.push_back(t + static_cast<double>(nodes[i]) * h);
}

std::optional<DeviceMethod> device_method(const Method& method) {
  using Kind = DeviceMethod::Kind;
  if (method.id == "symplectic_euler") return DeviceMethod{.kind = Kind::symplectic_euler};
  for (const auto& [id, damping] : {std::pair{"velocity_verlet", KickDamping::half_step},
                                    std::pair{"stormer_verlet", KickDamping::predicted},
                                    std::pair{"central_difference", KickDamping::lumped}})
    if (method.id == id) return DeviceMethod{.kind = Kind::kicks, .damping = damping};
  if (std::optional<DeviceMethod> iterated = iterated_method(method)) return iterated;
  if (method.id == Rkc2::id) return stabilised<Rkc2>();
  if (method.id == Rkl2::id) return stabilised<Rkl2>();
  std::optional<DeviceMethod> found;
  [&]<class... T>(std::type_identity<std::tuple<T...>>) {
    ((method.id == T::id ? void(found = runge_kutta<T>()) : void()), ...);
  }(std::type_identity<tableaux::All>{});
  return found;
}

void DeviceMethod::check(bool is_double, std::int32_t bodies, bool adaptive) const {
  const bool is_alone = kind == Kind::stabilised || is_iterated();
  const std::string steps = kind == Kind::stabilised ? "stabilised methods" : "methods of iterations";
  if (is_alone && !is_double)
    throw InputError(steps + " run on a GPU in double precision; leave --precision out");
  if (is_alone && bodies > 1)
    throw InputError(steps + " step one body at a time on a GPU; leave --bodies out");
  if (adaptive && (!is_double || bodies > 1))
    throw InputError(
        "a GPU chooses steps of one body in double precision; leave --precision and --bodies out, or give --h");
}

}  // namespace hmax
