#include "limits/documents/stability_json.hpp"

#include <cmath>

#include "limits/documents/number_json.hpp"

namespace hmax {

namespace {
using Json = nlohmann::ordered_json;
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

}  // namespace hmax
