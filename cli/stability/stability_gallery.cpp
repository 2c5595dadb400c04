/// hmax stability gallery: every region on one page, and the liver's eigenvalues on their way out of three.
#include <algorithm>
#include <tuple>

#include <fmt/format.h>

#include "analysis/amplification/limits.hpp"
#include "catalogue/methods/choice/formulas.hpp"
#include "catalogue/models/problems.hpp"
#include "cli/shared/choices.hpp"
#include "cli/shared/options.hpp"
#include "cli/shared/outputs.hpp"
#include "cli/stability/stability.hpp"
#include "cli/stability/stability_parts.hpp"
#include "cli/stability/stability_pictures.hpp"
#include "core/errors.hpp"
#include "core/parallel_for.hpp"
#include "limits/linearised_problem.hpp"
#include "plots/draw.hpp"
#include "plots/drawn/sliding.hpp"
#include "plots/pages/report.hpp"
#include "problems/oscillator/liver_materials.hpp"
#include "results/json.hpp"

namespace hmax {

namespace {

namespace fs = std::filesystem;

/// Formulas that are shown together, each of which has a panel of its own too.
struct Chapter {
  std::string title, text, stem;
  std::vector<Formula> formulas = {};
  bool by_cost = false;  ///< compared for equal work too
};

struct FormulaGroup {
  const char *title, *text, *stem;
  std::vector<std::string> names;
  bool by_cost = false;
};

std::vector<std::string> numbered(const std::string& prefix, std::initializer_list<int> numbers) {
  std::vector<std::string> names;
  for (const int number : numbers) names.push_back(prefix + std::to_string(number));
  return names;
}

std::vector<std::string> stabilised() {
  std::vector<std::string> names = numbered("rkc_2:stages=", {3, 5, 10});
  for (std::string& name : numbered("rkl_2:stages=", {3, 5, 10})) names.push_back(std::move(name));
  return names;
}

std::vector<FormulaGroup> formula_groups() {
  const auto k = {1, 2, 3, 4, 5, 6};
  return {
      {"Explicit Runge-Kutta methods",
       "Regions grow with the stages; divided by the evaluations of f that a step costs they shrink.",
       "explicit_runge_kutta",
       {"explicit_runge_kutta"},
       true},
      {"Adams-Bashforth methods", "One evaluation a step, and the less room the higher the order.",
       "adams_bashforth", numbered("adams_bashforth_", k)},
      {"Adams predictor and corrector, PECE",
       "The second evaluation buys back some of the room that the order takes.", "abm_pece",
       numbered("abm_pece_", k), true},
      {"Adams predictor and corrector, PEC", "Without the second evaluation.", "abm_pec",
       numbered("abm_pec_", k)},
      {"The pair of ode113 held at one order", "Predictor of order K, corrector of order K + 1.",
       "adams_pece", numbered("adams_pece:order=", k)},
      {"Adams-Moulton formulas", "The corrector solved exactly: A-stable up to order 2.", "adams_moulton",
       numbered("adams_moulton_", k)},
      {"Backward differentiation",
       "Stable outside of the curves. From order 3 on part of the left half-plane is lost: A(alpha).", "bdf",
       numbered("bdf_", k)},
      {"Stabilised explicit methods",
       "A strip along the real axis whose length grows with the square of the stages.", "stabilised",
       stabilised()},
      {"Diagonally and fully implicit Runge-Kutta methods",
       "Stable outside of the curves.",
       "implicit",
       {"diagonally_implicit", "fully_implicit"}},
      {"Rosenbrock methods",
       "With the exact Jacobian; stable outside of the curves.",
       "rosenbrock",
       {"rosenbrock"}},
      {"Implicit-explicit pairs", "All of f declared stiff.", "imex", {"imex"}},
      {"Methods of structural dynamics",
       "The largest stable omega h of an oscillation over its damping ratio: stable left of the curve.",
       "structural",
       {"structural"}},
  };
}

/// The chapters of the formulas that are asked for; what no group holds is told by family at the end.
std::vector<Chapter> chapters_of(const std::string& names, Console& console) {
  const bool all = names == "all";
  ChosenFormulas chosen = chosen_formulas(parse_names("--methods", names));
  warn_of_left_out(console, chosen.left_out);
  std::vector<Formula> left = std::move(chosen.formulas);
  std::vector<Chapter> chapters;
  for (const FormulaGroup& group : formula_groups()) {
    Chapter chapter{.title = group.title, .text = group.text, .stem = group.stem, .by_cost = group.by_cost};
    for (Formula& formula : choose_formulas(group.names)) {
      const auto same = [&](const Formula& other) { return other.id == formula.id; };
      if (all || std::ranges::any_of(left, same)) chapter.formulas.push_back(formula);
      std::erase_if(left, same);
    }
    if (!chapter.formulas.empty()) chapters.push_back(std::move(chapter));
  }
  for (const Formula& formula : left) {
    const std::string family = formula.method ? formula.method->family : "other formulas";
    auto place =
        std::ranges::find_if(chapters, [&](const Chapter& c) { return c.stem == file_stem(family); });
    if (place == chapters.end()) {
      Chapter further{.title = "Further methods: " + family, .text = "", .stem = file_stem(family)};
      if (formula.method && formula.method->is_foreign())
        further.text = "A foreign engine; where it shows no coefficients, its steps are measured.";
      place = chapters.insert(chapters.end(), std::move(further));
    }
    place->formulas.push_back(formula);
  }
  return chapters;
}

std::vector<std::vector<std::string>> limits_table(const std::vector<Formula>& formulas) {
  std::vector<std::vector<std::string>> rows{{"method", "order", "real axis", "imaginary axis",
                                              "|R| <= 1 + 1e-6", "alpha [deg]", "A", "L", "at infinity"}};
  for (const Formula& formula : formulas) {
    std::vector<std::string>& row = rows.emplace_back(std::vector{formula.id, std::to_string(formula.order)});
    const std::vector<std::string> cells = limit_cells(formula, stability_limits(*formula.amplification), 7);
    row.insert(row.end(), cells.begin(), cells.end());
  }
  return rows;
}

/// A heading, a text, figures below it, and a table in Markdown.
struct PageSection {
  std::string title, text;
  std::vector<FigureFiles> figures = {};
  std::string table = {};
};

std::string markdown_of(const PageSection& section, const fs::path& folder) {
  std::string markdown = fmt::format("## {}\n\n{}\n\n", section.title, section.text);
  for (const FigureFiles& figure : section.figures) markdown += figure_markdown(figure, folder) + "\n\n";
  return markdown + section.table + (section.table.empty() ? "" : "\n");
}

PageSection section_of(const Chapter& chapter, const fs::path& folder) {
  PageSection section{.title = chapter.title, .text = chapter.text};
  const auto coarse = [](const Formula& formula) { return formula.amplification->measured; };
  // Steps of the code cost a thousand times what a formula costs.
  const bool measured = std::ranges::any_of(chapter.formulas, coarse);
  if (chapter.formulas.size() > 1 && !measured) {
    const NamedFigure together = picture_of(chapter.formulas, {});
    section.figures.push_back(draw(together.figure, folder, "regions_" + chapter.stem));
    if (chapter.by_cost) {
      const NamedFigure cost = picture_of(chapter.formulas, {.per_evaluation = true});
      section.figures.push_back(draw(cost.figure, folder, "regions_" + chapter.stem + "_per_evaluation"));
    }
  }
  Figure each{.title = chapter.title, .columns = 2, .panel_height = 300};
  each.panels = parallel_map(chapter.formulas.size(), [&](std::size_t i) {
    const Formula& formula = chapter.formulas[i];
    return panel_of(formula, {.cells = coarse(formula) ? 120 : 300}, 2, 300, 300);
  });
  section.figures.push_back(draw(each, folder, "each_" + chapter.stem));
  for (const auto& [parts, stem, caption] :
       {std::tuple{PartsChoice{.fast = "0,-1,-3,-10"}, "beside_stiff_",
                   "beside a stiff part: the region of what is not stiff, and how far it may swing"},
        {PartsChoice{.ratios = "1.2,2"}, "old_jacobian_",
         "with a frozen Jacobian, z = hλ being so many times what it says"}}) {
    Figure told{.title = fmt::format("{} {}", chapter.title, caption), .columns = 2, .panel_height = 300};
    const auto panels = parallel_map(chapter.formulas.size(), [&](std::size_t i) -> std::vector<Panel> {
      const Formula& formula = chapter.formulas[i];
      // What external integrators step with an old Jacobian is not known.
      const bool own = formula.method && !formula.method->is_foreign();
      if (!own || !(parts.fast.empty() ? formula.method->linearly_implicit : formula.method->needs_split))
        return {};
      return panels_of(formula, part_regions(formula, parts), {.cells = 160}, 300);
    });
    for (const std::vector<Panel>& of_formula : panels)
      told.panels.insert(told.panels.end(), of_formula.begin(), of_formula.end());
    if (told.panels.empty()) continue;
    section.figures.push_back(draw(told, folder, stem + chapter.stem));
  }
  section.table = markdown_rows(limits_table(chapter.formulas));
  return section;
}

/// The spectra of the six materials in the region of a method.
SlidingPicture sliding_picture(const std::string& id) {
  const Formula formula = find_formula(id);
  const Amplification& amplification = *formula.amplification;
  SlidingPicture picture;
  double largest = 0;
  for (const LiverMaterial& material : liver_materials()) {
    ProblemSettings settings;
    settings.material = material.id;
    const Linearised near = linearised(make_problem("liver_benchmark", settings));
    SlidingSpectrum spectrum{.label = std::string(material.id)};
    for (const Complex lambda : near.modes.spectrum.lambda)
      spectrum.points.push_back(
          {lambda.real(), lambda.imag(), first_exit(amplification.of_eigenmode(Eigenmode(lambda)))});
    largest = std::max(largest, spectrum.largest_step());
    picture.spectra.push_back(std::move(spectrum));
  }
  picture.end = 1.15 * largest;
  const PlaneWindow window = window_of(amplification);
  picture.re = {1.25 * window.re_from, window.re_to};
  picture.im = {window.im_from, window.im_to};
  for (const RegionCurve& curve : region_boundary(stable_at(amplification), window, 300)) {
    picture.region.emplace_back();
    for (const Complex z : curve.points) picture.region.back().push_back({z.real(), z.imag()});
  }
  picture.title = fmt::format("The step grows: eigenvalues of six livers leave the region of {}", id);
  return picture;
}

/// A picture that gnuplot does not draw.
FigureFiles kept(const std::string& svg, const fs::path& folder, const std::string& name,
                 const std::string& alt) {
  const fs::path file = folder / (name + ".svg");
  write_file(file, svg);
  return {.base = folder / name, .made = {file}, .alt = alt};
}

PageSection sliding_section(const fs::path& folder) {
  PageSection section{
      .title = "The largest stable step, seen",
      .text =
          "Each eigenvalue of the model, times the step, runs along a ray from the origin as the step "
          "grows. The first that leaves the region sets the largest stable step of its liver."};
  for (const std::string id : {"explicit_euler", "rk4", "dormand_prince_54"}) {
    const SlidingPicture picture = sliding_picture(id);
    section.figures.push_back(
        kept(sliding_svg(picture), folder, "sliding_" + id, fmt::format("{}: h grows", id)));
    std::vector<double> steps;
    for (const double share : {0.15, 0.3, 0.5, 0.75, 1.0}) steps.push_back(share * picture.end);
    section.figures.push_back(kept(sliding_frames_svg(picture, steps), folder, "sliding_" + id + "_frames",
                                   fmt::format("{}: five steps of it", id)));
  }
  return section;
}

/// The opening section and those of all chapters, drawn on all cores.
std::vector<PageSection> sections_of(const std::vector<Chapter>& chapters, const std::string& folder,
                                     Console& console) {
  const auto& interrupted = interrupt_flag();
  std::vector<PageSection> sections(chapters.size() + 1);
  sections[0] = sliding_section(folder);
  Progress progress(console, "gallery");
  parallel_for(
      chapters.size(), [&](std::size_t i, std::size_t) { sections[i + 1] = section_of(chapters[i], folder); },
      [&](std::size_t done) {
        progress.update(static_cast<double>(done) / static_cast<double>(chapters.size()));
      },
      [&] { return interrupted.load(); });
  if (interrupted) throw Interrupted{};
  return sections;
}

struct GalleryOptions {
  std::string methods = "all", output;
};

void gallery(const GalleryOptions& options, Console& console) {
  const auto& [names, output] = options;
  if (output.empty()) throw InputError("no folder is given; say where the page goes, like --output gallery");
  check_report_place(output);
  const std::vector<Chapter> chapters = chapters_of(names, console);
  const std::vector<PageSection> sections = sections_of(chapters, output, console);
  std::size_t shown = 0;
  for (const Chapter& chapter : chapters) shown += chapter.formulas.size();
  Json files = Json::array();
  std::string problem;
  for (const PageSection& section : sections)
    for (const FigureFiles& figure : section.figures)
      if (figure.drawn())
        files.push_back(figure.base.string() + ".svg");
      else
        problem = figure.problem;
  if (!problem.empty()) console.remark(problem);
  std::string text =
      "# Stability regions\n\nz = h lambda, the step times an eigenvalue of the model: a step is stable where "
      "the method's amplification is at most 1. The curves come from the coefficients that the methods step "
      "with, or from steps of external integrators that show none. Scales are equal on both axes.\n\n";
  for (const PageSection& section : sections) text += markdown_of(section, output);
  const fs::path page = write_report(text, output);
  console.show(
      {{"page", page.string()}, {"methods", shown}, {"figures", files}},
      fmt::format("The page: {} with {} methods in {} sections\n", page.string(), shown, chapters.size()));
}

}  // namespace

void add_stability_gallery(CLI::App& stability, Console& console) {
  const auto [command, options] =
      add_command(stability, console, "gallery", "Draw a page with the stability regions of all methods",
                  {"hmax stability gallery --methods bdf_2,newmark --output results/runs/gallery"}, gallery);
  add_text(command, "--method,--methods", options.methods, words_of_formulas() + "; all by default", "A,B");
  add_text(command, "--output", options.output, "Folder of the page and its figures", "FOLDER");
  add_force(command);
  add_jobs(command);
  add_figure_style(command);
}

}  // namespace hmax
