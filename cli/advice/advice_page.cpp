#include "cli/advice/advice_page.hpp"

#include <ctime>

#include <fmt/chrono.h>
#include <fmt/format.h>

#include "plots/figure.hpp"
#include "plots/pages/markdown_text.hpp"
#include "plots/pages/store_report.hpp"
#include "results/build_info.hpp"
#include "results/table.hpp"

namespace hmax {

namespace {

std::string answer_section(const AdviceText& text) {
  std::string markdown = fmt::format("## Answer\n\n**{}**\n\n", markdown_text(text.answer));
  if (!text.help.empty()) markdown += markdown_text(text.help) + "\n\n";
  return markdown + markdown_facts(text.facts) + markdown_list(text.remedies);
}

/// The methods that do not suit, where there are some, and the model.
std::string sections_after(const AdviceText& text, const AdviceKey& question) {
  std::string markdown;
  std::vector<std::string> reasons = text.reasons;
  if (!text.left_out.empty()) reasons.push_back(text.left_out);
  if (!reasons.empty()) markdown += "## Methods that do not suit\n\n" + markdown_list(reasons);
  if (!text.notes.empty()) markdown += "## Missing numbers\n\n" + markdown_list(text.notes);
  return markdown + "## Model\n\n" +
         markdown_facts({{"model", question.problem},
                         {"material", question.material},
                         {"parameters", question.parameters},
                         {"motion", text.motion}});
}

std::vector<AdviceRecord> with_key(std::vector<AdviceRecord> rows, const AdviceKey& key) {
  for (AdviceRecord& row : rows) {
    row.key = key;
    row.session = 1;
  }
  return rows;
}

}  // namespace

void write_advice_page(const std::filesystem::path& file, const AdviceText& text, const AdviceKey& question,
                       const std::vector<AdviceRecord>& rows, const std::string& scene) {
  const std::string now = fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr)));
  ReportedStore answer{.name = "this answer",
                       .advice = with_key(rows, question),
                       .sessions = {{.id = 1, .started = now, .fingerprint = fingerprint()}}};
  if (!scene.empty()) answer.scenes.push_back({.key = question, .scene = scene, .session = 1});
  const AnswerSections sections{
      .title =
          fmt::format("{}{}{} at {} Hz: integrator and step size", title_of(question.problem),
                      question.material.empty() ? "" : ", ", question.material, short_number(question.rate)),
      .introduction = (text.body.empty() ? "" : text.body + ". ") +
                      "Which integrator, and how large a step? " + text.question,
      .before = answer_section(text),
      .after = sections_after(text, question),
      .table = markdown_rows(text.table)};
  write_file(file, answer_report(answer, sections, build_info().version).html);
}

}  // namespace hmax
