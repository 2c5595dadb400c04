/// hmax stability region
#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "cli/shared/options.hpp"
#include "cli/shared/outputs.hpp"
#include "cli/stability/stability.hpp"
#include "cli/stability/stability_parts.hpp"
#include "cli/stability/stability_pictures.hpp"
#include "core/errors.hpp"
#include "core/numbers.hpp"
#include "core/parallel_for.hpp"
#include "core/text/counted.hpp"
#include "limits/documents/method_json.hpp"
#include "plots/draw.hpp"
#include "results/json.hpp"
#include "results/table.hpp"

namespace hmax {

namespace {

struct RegionOptions {
  MethodsChoice methods;
  PartsChoice parts;
  std::string window, output;
  int cells = 400;
  bool per_evaluation = false, field = false, order_star = false;

  [[nodiscard]] bool wants_figure() const { return !output.empty() && !output.ends_with(".csv"); }
};

PlaneLook look_of(const RegionOptions& options) {
  PlaneLook look{.per_evaluation = options.per_evaluation, .cells = options.cells};
  if (options.field && options.order_star)
    throw InputError("--field and --order-star are two pictures; ask for one of them at a time");
  if (options.field && !options.wants_figure())
    throw InputError("--field is a picture; say into which folder with --output, like --output results/runs");
  if (options.field) look.view = PlaneView::field;
  if (options.order_star) look.view = PlaneView::order_star;
  if (options.window.empty()) return look;
  const auto [re_from, re_to, im_from, im_to] =
      parse_window("--window", options.window, "re_from,re_to,im_from,im_to", "-4,1,-4,4");
  look.window = PlaneWindow{re_from, re_to, im_from, im_to};
  return look;
}

constexpr std::string_view csv_header = "method,curve,re,im\n";

/// One method and the numbers it is told besides.
std::vector<PartRegion> parts_of(const std::vector<Formula>& formulas, const RegionOptions& options) {
  if (!options.parts.any()) return {};
  if (formulas.size() > 1)
    throw InputError("--fast and --ratios show one method; name one of them with --method");
  if (options.field || options.order_star || options.per_evaluation)
    throw InputError(
        "--fast and --ratios are pictures of their own; leave out --field, --order-star and --per-evaluation");
  return part_regions(formulas.front(), options.parts);
}

/// One formula, or one method told one number.
struct DrawnRegion {
  Formula formula;
  PlaneWindow window;
  std::vector<RegionCurve> curves;
};

struct RegionStudy {
  std::vector<Formula> chosen;
  std::vector<PartRegion> parts;  ///< of the one method, where it is told numbers
  std::vector<DrawnRegion> regions;
  std::optional<std::string> figure;

  [[nodiscard]] std::vector<Formula> formulas() const {
    std::vector<Formula> formulas;
    for (const PartRegion& part : parts) formulas.push_back(part.formula);
    return parts.empty() ? chosen : formulas;
  }
};

RegionStudy study_of(const RegionOptions& options, const PlaneLook& look, Console& console) {
  RegionStudy study;
  study.chosen = options.methods.formulas(console);
  study.parts = parts_of(study.chosen, options);
  std::optional<PlaneWindow> window_of_parts;
  if (!study.parts.empty()) window_of_parts = window_of(study.parts, look);
  const std::vector<Formula> formulas = study.formulas();
  for (const Formula& formula : formulas) expect_look(formula, look);
  study.regions = parallel_map(formulas.size(), [&](std::size_t i) {
    const PlaneWindow window = window_of_parts ? *window_of_parts : window_of(formulas[i], look);
    return DrawnRegion{formulas[i], window, curves_of(formulas[i], look, window)};
  });
  return study;
}

std::string drawn(const RegionStudy& study, const RegionOptions& options, const PlaneLook& look,
                  Console& console) {
  const NamedFigure picture = study.parts.empty() ? picture_of(study.chosen, look)
                                                  : picture_of(study.chosen.front(), study.parts, look);
  return drawn_svg(picture.figure, options.output, picture.name, console);
}

std::string csv_of(const RegionStudy& study) {
  std::string csv(csv_header);
  for (const DrawnRegion& region : study.regions)
    for (std::size_t i = 0; i < region.curves.size(); ++i)
      for (const Complex z : region.curves[i].points)
        csv += fmt::format("{},{},{},{}\n", region.formula.id, i, to_text(z.real()), to_text(z.imag()));
  return csv;
}

Json to_json(const RegionStudy& study, const RegionOptions& options) {
  Json documents = Json::array();
  for (std::size_t i = 0; i < study.regions.size(); ++i) {
    const DrawnRegion& region = study.regions[i];
    Json document = region_json(study.parts.empty() ? region.formula.id : study.chosen.front().id,
                                region.window, region.curves);
    if (!options.parts.fast.empty())
      document["fast"] = {study.parts[i].fast.real(), study.parts[i].fast.imag()};
    if (!options.parts.ratios.empty()) document["ratio"] = study.parts[i].ratio;
    if (study.figure) document["figure"] = json_or_null(*study.figure);
    documents.push_back(std::move(document));
  }
  return documents.size() == 1 ? documents.front() : documents;
}

std::string in_words(const DrawnRegion& region) {
  const PlaneWindow& window = region.window;
  std::string text = fmt::format("{}: {} in [{}, {}] x i [{}, {}]\n", region.formula.id,
                                 counted(region.curves.size(), "closed curve"),
                                 short_number(window.re_from, 4), short_number(window.re_to, 4),
                                 short_number(window.im_from, 4), short_number(window.im_to, 4));
  for (const RegionCurve& curve : region.curves) {
    const double area = curve.area();
    text += fmt::format("  {} of area {}, {} points{}\n", area < 0 ? "hole" : "outline",
                        short_number(std::abs(area)), curve.points.size(),
                        curve.clipped ? ", closed along the edge of the window" : "");
  }
  return text;
}

void region(const RegionOptions& options, Console& console) {
  const PlaneLook look = look_of(options);
  if (!options.wants_figure()) refuse_style_without_figure("--output FOLDER");
  RegionStudy study = study_of(options, look, console);
  const bool wants_points = !options.output.empty() && !options.wants_figure();
  if (options.wants_figure()) study.figure = drawn(study, options, look, console);
  if (wants_points) write_file(options.output, csv_of(study), csv_header);
  std::string text;
  for (const DrawnRegion& each : study.regions) text += in_words(each);
  if (study.figure && !study.figure->empty()) text += fmt::format("The figure: {}\n", *study.figure);
  if (wants_points) text += fmt::format("The points: {}\n", options.output);
  console.show(to_json(study, options), text);
}

}  // namespace

void add_stability_region(CLI::App& stability, Console& console) {
  const auto [command, options] = add_command(
      stability, console, "region", "Compute and draw the boundary of the stability region",
      {"hmax stability region --method dormand_prince_54",
       "hmax stability region --method rk4 --window -4,1,-4,4 --json",
       "hmax stability region --method explicit_euler,rk4,adams_bashforth_2 --output results/runs/stability",
       "hmax stability region --method rk4 --order-star --output results/runs/stability",
       "hmax stability region --method imex_ark_324 --fast 0,-1,-3,-10 --output results/runs/stability",
       "hmax stability region --method rosenbrock_23 --ratios 1,1.5,2,4 --output results/runs/stability"},
      region);
  options.methods.add_to(command);
  options.parts.add_to(command);
  add_text(command, "--window", options.window,
           "Part of the plane, re_from,re_to,im_from,im_to; fitted to the region by default", "NUMBERS");
  add_count(command, "--cells", options.cells, 2, 4000,
            "Cells along the longer side of the grid; 400 by default");
  add_text(
      command, "--output", options.output,
      "Draw into this folder, one method filled, several as outlines; or write the points of the curves to "
      "FILE.csv",
      "FOLDER");
  add_flag(command, "--per-evaluation", options.per_evaluation,
           "Divide the plane by the evaluations of f of a step; explicit methods only");
  add_flag(command, "--field", options.field, "Draw also levels of the spectral radius");
  add_flag(command, "--order-star", options.order_star,
           "Draw the order star, |R(z) e^-z| > 1; one-step methods only");
  add_force(command);
  add_jobs(command);
  add_figure_style(command);
}

}  // namespace hmax
