/// Sections of `hmax reproduce tissue` on contact, materials, contraction and what is identified from motion.
#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "cli/reproduce/tissue_page.hpp"
#include "plots/curves.hpp"
#include "results/json.hpp"
#include "studies/contraction.hpp"
#include "studies/motion_identification.hpp"
#include "studies/organ_material.hpp"
#include "studies/tool_contact.hpp"

namespace hmax {

void found_by_a_view(TissuePage& tissue) {
  const ViewSearch search = view_search("liver", study_material);
  constexpr double haptic_period = 1e-3;  // [s]
  tissue.page.values["view"] = search;
  tissue.judge("view_finds", judged(search.missed == 0 && search.seconds < haptic_period, search.missed == 0),
               {HMAX_KEYS(search, found, touched, missed, seconds)});
}

void penalties(TissuePage& tissue) {
  const std::vector<PenaltyContact> all = penalty_contacts(tissue.options.mesh(), study_material, 0.008);
  const PenaltyContact &by_default = all.at(all.size() - 2), &stiff = all.back();
  const double more = stiff.force / by_default.force, shorter = stiff.h_pressed / stiff.h_rest;
  tissue.page.values["penalties"] = {
      {"mesh", tissue.options.mesh()}, {"contacts", all}, {"saturated", more < 1.2}};
  tissue.judge("penalties_are_large", judged(more > 1.5, shorter < 0.9),
               {{"more", more},
                {"by_default", by_default.penetration},
                {"stiff", stiff.penetration},
                {"force", stiff.force},
                {"shorter", shorter}});
}

void stress_and_strain(TissuePage& tissue) {
  constexpr double young = 5300, poisson = 0.45, relative = 1000;  // of the study's liver, of a capsule
  constexpr double skin_thickness = 1e-4, layer = 0.01;            // [m]
  Figure figure{.title = "Parenchyma and skin: what a bar and a layer hold against a strain", .columns = 2};
  figure.footer = fmt::format(
      "nu = {:g}, sides free; parenchyma E = {:g} kPa, skin {:g} times as stiff, Green's strain on the right",
      poisson, young / 1000, relative);
  Panel bar{
      .title = "a bar of parenchyma", .x = {.label = "strain [1]"}, .y = {.label = "nominal stress [kPa]"}};
  Panel layers{.title = "layers side by side", .x = bar.x, .y = {.label = "force over width [N/m]"}};
  int k = 0;
  for (const StressCurve& curve : stress_curves(young, poisson)) {
    const auto times = [&](double factor) {
      std::vector<double> scaled = curve.stress;
      for (double& stress : scaled) stress *= factor;
      return scaled;
    };
    bar.curves.push_back(
        {.label = curve.law, .x = curve.strain, .y = times(1e-3), .style = family_style(k++)});
    // The corotational law is the same where nothing turns.
    if (curve.law == "fem_cauchy") bar.curves.back().style = {.colour = 7, .width = 5, .light = true};
    if (curve.law != "fem_green") continue;
    layers.curves.push_back({.label = fmt::format("skin of {:g} mm", 1000 * skin_thickness),
                             .x = curve.strain,
                             .y = times(relative * skin_thickness),
                             .style = {.colour = 6}});
    layers.curves.push_back({.label = fmt::format("parenchyma of {:g} mm", 1000 * layer),
                             .x = curve.strain,
                             .y = times(layer),
                             .style = {.colour = 5, .dash = 1}});
  }
  figure.panels = {bar, layers};
  tissue.page.draw(figure, "stress_and_strain");
  const SkinEffect skin = skin_effect(tissue.options.mesh(), study_material);
  tissue.page.values["skin"] = skin;
  tissue.judge("skin_matters", judged(skin.skinned < 0.9 * skin.bare),
               {{"stiffer", skin.bare / skin.skinned}, {"shorter", skin.h_skinned / skin.h_bare}});
}

void contraction_of_methods(TissuePage& tissue) {
  const std::vector<Contraction> all = contractions(
      {"implicit_euler", "implicit_midpoint", "radau_iia_5", "trapezoidal", "linearly_implicit_euler"});
  const auto of = [&](const char* method) { return *std::ranges::find(all, method, &Contraction::method); };
  tissue.page.values["contraction"] = {{"methods", all}};
  const Contraction semi = of("linearly_implicit_euler");
  tissue.judge(
      "euler_is_b_stable", judged(of("implicit_euler").nearer),
      {{"trapezoidal", of("trapezoidal").cubic}, {"semi_implicit", std::max(semi.cubic, semi.arctan)}});
}

void body_from_its_motion(TissuePage& tissue) {
  const IdentifiedMotion found = identified_motion("phantom");
  const FittedMotion &right = found.fits.front(), &springs = found.fits.back();
  Json& shown = tissue.page.values["backwards"] = found;
  shown["springs_differ"] = springs.misfit > 2 * right.misfit;
  const double off =
      std::max(std::abs(right.young / found.young - 1), std::abs(right.alpha / found.alpha - 1));
  tissue.judge(
      "found_backwards", judged(off < 0.05),
      {{"off", off}, {"misfit", right.misfit}, {"springs", springs.misfit}, {"young", springs.young}});
}

}  // namespace hmax
