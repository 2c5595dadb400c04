#include "studies/organ_material.hpp"

#include <cmath>

#include "bench/timing/timing.hpp"
#include "catalogue/methods/catalogue.hpp"
#include "catalogue/models/equilibria/body_balance.hpp"
#include "catalogue/models/problems.hpp"
#include "catalogue/models/tissue_problem.hpp"
#include "limits/linearised_problem.hpp"
#include "limits/predict.hpp"
#include "problems/tissue/forces/elasticity.hpp"
#include "problems/tissue/forces/springs.hpp"

namespace hmax {

namespace {

/// The axial stress where the sides are free: the lateral displacement gradient s with P22 = 0, by bisection
/// between no contraction and one that is larger than any of these laws has.
template <class Law>
double bar_stress(double strain, const Lame& lame) {
  const auto stress = [&](double s) -> Eigen::Matrix3d {
    return Law(Eigen::Vector3d(strain, s, s).asDiagonal(), lame).stress();
  };
  double low = -0.5, high = 0.5;
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2;
    (stress(middle)(1, 1) < 0 ? low : high) = middle;
  }
  return stress((low + high) / 2)(0, 0);
}

double equilibrium_displacement(const Problem& problem) {
  return largest_displacement(
      solve_static(static_model(problem, 1), {.load_steps = 4}, thread_cpu_seconds).q);
}

}  // namespace

std::vector<StressCurve> stress_curves(double young, double poisson) {
  const Lame coefficients = lame(young, poisson);
  std::vector<StressCurve> curves{{"fem_cauchy", {}, {}},
                                  {"fem_green", {}, {}},
                                  {"fem_corotational", {}, {}},
                                  {"fem_neo_hookean", {}, {}},
                                  {"mass_spring, exponential", {}, {}}};
  for (int i = -30; i <= 50; i += 2) {
    const double e = 0.01 * i;
    const double stress[] = {
        bar_stress<SmallStrain>(e, coefficients), bar_stress<GreenStrain>(e, coefficients),
        bar_stress<Corotational>(e, coefficients), bar_stress<StableNeoHookean>(e, coefficients),
        young * ExponentialSpring{.b = 5}.phi(e)};
    for (std::size_t k = 0; k < curves.size(); ++k) {
      curves[k].strain.push_back(e);
      curves[k].stress.push_back(stress[k]);
    }
  }
  return curves;
}

SkinEffect skin_effect(std::string_view mesh, std::string_view material) {
  const auto pressed = [&](double skin) {
    return make_problem(tissue_id("fem_green", mesh, "press"),
                        {.material = std::string(material), .parameters = {{"force", 0.2}, {"skin", skin}}});
  };
  const auto step = [](const Problem& problem) {
    return predict(find_method("symplectic_euler"), linearised(problem, AskedState::rest))
        .h_max.value_or(NAN);
  };
  SkinEffect effect{.relative = 1000};
  const Problem bare = pressed(0), skinned = pressed(effect.relative);
  effect.bare = equilibrium_displacement(bare);
  effect.skinned = equilibrium_displacement(skinned);
  effect.h_bare = step(bare);
  effect.h_skinned = step(skinned);
  return effect;
}

}  // namespace hmax
