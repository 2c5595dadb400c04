#include "cli/advice/advice_page.hpp"

#include <fmt/format.h>

#include "cli/shared/drawn_svg.hpp"
#include "plots/advice/advice_figures.hpp"
#include "plots/pages/page.hpp"

namespace hmax {

namespace {

namespace fs = std::filesystem;

/// A figure by the name of its files, with the words under it.
struct Shown {
  Figure figure;
  std::string name, caption;
};

/// A page without its figures still has every number.
PagePicture picture_of(const Shown& shown) {
  const DrawnSvg drawn = drawn_svg(shown.figure, shown.name);
  return {.svg = drawn.svg, .caption = shown.caption, .problem = drawn.problem, .alt = drawn.alt};
}

/// One picture each.
std::vector<PagePicture> pictures_of(const std::vector<Shown>& figures) {
  std::vector<PagePicture> pictures;
  for (const Shown& shown : figures) pictures.push_back(picture_of(shown));
  return pictures;
}

std::vector<Shown> figures_of(const AdviceKey& question, const std::vector<AdviceRecord>& rows,
                              const std::string& error_of) {
  std::vector<Shown> figures{
      {advice_cost_figure(question, rows, error_of), "advice_cost",
       "A mark for each row of the table: its error over the median CPU time of a frame"}};
  if (auto steps = advice_step_figure(rows))
    figures.push_back(
        {*std::move(steps), "advice_steps",
         "The step of each row that has a largest stable step, beside that limit, predicted and observed"});
  return figures;
}

PageSection answer_section(const AdviceText& text) {
  return {
      .title = "Answer", .lead = text.answer, .text = text.help, .facts = text.facts, .list = text.remedies};
}

PageSection reasons_section(const AdviceText& text) {
  PageSection section{.title = "Methods that do not suit", .list = text.reasons};
  if (!text.left_out.empty()) section.list.push_back(text.left_out);
  return section;
}

PageSection model_section(const AdviceText& text, const AdviceKey& question) {
  PageSection section{.title = "Model and machine", .facts = {{"model", question.problem}}};
  const auto add = [&](const char* name, const std::string& words) {
    if (!words.empty()) section.facts.emplace_back(name, words);
  };
  add("material", question.material);
  add("parameters", question.parameters);
  add("motion", text.motion);
  add("machine", text.machine);
  return section;
}

}  // namespace

std::string write_advice_page(const fs::path& file, const AdviceText& text, const AdviceKey& question,
                              const std::vector<AdviceRecord>& rows, const std::string& error_of) {
  const std::vector<PagePicture> pictures = pictures_of(figures_of(question, rows, error_of));
  std::vector<PageSection> sections{answer_section(text)};
  sections.push_back({.title = "Error and CPU time", .pictures = {pictures.front()}});
  if (pictures.size() > 1)
    sections.push_back({.title = "Steps and their limits", .pictures = {pictures.back()}});
  sections.push_back({.title = "All methods", .table = text.table});
  if (PageSection reasons = reasons_section(text); !reasons.list.empty())
    sections.push_back(std::move(reasons));
  sections.push_back(model_section(text, question));
  write_page(file, page_text(fmt::format("{} at {} Hz: integrator and step size", text.model,
                                         short_number(question.rate)),
                             "Which integrator, and how large a step? " + text.question, sections));
  for (const PagePicture& picture : pictures)
    if (!picture.problem.empty()) return picture.problem;
  return {};
}

}  // namespace hmax
