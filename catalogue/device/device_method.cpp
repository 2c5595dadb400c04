#include "catalogue/device/device_method.hpp"

#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>

#include "catalogue/device/body_step.hpp"
#include "integrators/explicit/tableaux.hpp"

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

}  // namespace

void DeviceMethod::append_times(double t, double h, std::optional<double> before,
                                std::vector<double>& times) const {
  if (kind == Kind::kicks) return times.push_back(t + h);
  if (kind == Kind::newton) {
    for (std::int32_t s = 1; s < newton.substeps; ++s) times.push_back(t + s * (h / newton.substeps));
    return times.push_back(t + h);
  }
  times.push_back(first_same_as_last ? before.value_or(t) : t);
  for (std::size_t i = 1; i < rows.size(); ++i) times.push_back(t + static_cast<double>(nodes[i]) * h);
}

std::optional<DeviceMethod> device_method(const Method& method) {
  using Kind = DeviceMethod::Kind;
  if (method.id == "symplectic_euler") return DeviceMethod{.kind = Kind::symplectic_euler};
  for (const auto& [id, damping] : {std::pair{"velocity_verlet", KickDamping::half_step},
                                    std::pair{"stormer_verlet", KickDamping::predicted},
                                    std::pair{"central_difference", KickDamping::lumped}})
    if (method.id == id) return DeviceMethod{.kind = Kind::kicks, .damping = damping};
  if (method.id.substr(0, method.id.find(':')) == "newton_truncated") {
    const auto count = [&](const char* name) {
      return static_cast<std::int32_t>(method.parameter(name).value());
    };
    return DeviceMethod{.kind = Kind::newton,
                        .newton = {count("iterations"), count("substeps"), count("cg")}};
  }
  std::optional<DeviceMethod> found;
  [&]<class... T>(std::type_identity<std::tuple<T...>>) {
    ((method.id == T::id ? void(found = runge_kutta<T>()) : void()), ...);
  }(std::type_identity<tableaux::All>{});
  return found;
}

}  // namespace hmax
