#include "cli/advice/advice_page.hpp"

#include <ctime>

#include <fmt/chrono.h>
#include <fmt/format.h>

#include "plots/figure.hpp"
#include "plots/pages/store_report.hpp"
#include "results/build_info.hpp"
#include "results/table.hpp"

namespace hmax {

namespace {

PageSection answer_section(const AdviceText& text) {
  return {
      .title = "Answer", .lead = text.answer, .text = text.help, .facts = text.facts, .list = text.remedies};
}

/// The methods that do not suit, where there are some, and the model.
std::vector<PageSection> sections_after(const AdviceText& text, const AdviceKey& question) {
  std::vector<PageSection> sections;
  PageSection reasons{.title = "Methods that do not suit", .list = text.reasons};
  if (!text.left_out.empty()) reasons.list.push_back(text.left_out);
  if (!reasons.list.empty()) sections.push_back(std::move(reasons));
  if (!text.notes.empty()) sections.push_back({.title = "Missing numbers", .list = text.notes});
  PageSection model{.title = "Model", .facts = {{"model", question.problem}}};
  const auto add = [&](const char* name, const std::string& words) {
    if (!words.empty()) model.facts.emplace_back(name, words);
  };
  add("material", question.material);
  add("parameters", question.parameters);
  add("motion", text.motion);
  sections.push_back(std::move(model));
  return sections;
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
      .before = {answer_section(text)},
      .after = sections_after(text, question),
      .table = text.table};
  write_page(file, answer_report(answer, sections, build_info().version).html);
}

}  // namespace hmax
