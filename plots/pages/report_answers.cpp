#include "plots/pages/report_answers.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/errors.hpp"
#include "core/numbers.hpp"
#include "plots/figure.hpp"
#include "plots/pages/answer_words.hpp"
#include "plots/pages/markdown_page.hpp"
#include "plots/pages/markdown_text.hpp"
#include "plots/svg.hpp"

namespace hmax {

namespace {

/// The rows of one question, best first, and where they are.
struct Answer {
  std::span<const AdviceRecord> rows;
  std::size_t store, first;  ///< index of the store; number of the first row in it
};

std::string digits(double value, int count = 4) {
  return std::isnan(value) ? "–" : std::isinf(value) ? "unbounded" : rounded_text(value, count);
}
/// A unit stays on the line of its number.
constexpr const char* no_break = "\u00a0";
std::string ms(double seconds, int count = 4) {
  return std::isfinite(seconds) ? digits(1e3 * seconds, count) + no_break + "ms" : digits(seconds);
}
std::string percent(double share) {
  return std::isfinite(share) ? digits(100 * share, 2) + no_break + "%" : "–";
}

std::string step_of(const AdviceRecord& row) {
  return fmt::format("{} with h = {}, {} step{} per frame", row.words(), ms(row.h, 5),
                     digits(row.steps_per_frame, 6), row.steps_per_frame == 1 ? "" : "s");
}

std::string words_of_limit(const AdviceRecord& row) {
  if (std::isinf(row.h_max)) return "stable at every step size (linearised model)";
  const std::string predicted = std::isnan(row.h_max) ? "none predicted" : ms(row.h_max) + " predicted";
  return std::isnan(row.h_max_observed) ? predicted : predicted + ", " + ms(row.h_max_observed) + " observed";
}

std::string words_of_bound(const std::string& bound) {
  if (bound == "stability") return "stability";
  if (bound == "accuracy") return "accuracy";
  if (bound == "newton") return "Newton's method";
  if (bound == "budget") return "the CPU time of a frame";
  if (bound == "rate") return "the rate: one step per frame suffices";
  return bound.empty() ? "–" : bound;
}

using Facts = std::vector<std::pair<std::string, std::string>>;

Facts facts_of(const AdviceRecord& row) {
  Facts facts{{"step limit", words_of_limit(row)},
              {"limited by", words_of_bound(row.bound)},
              {"error", percent(row.error)}};
  facts.emplace_back("frame times", fmt::format("{} (median), {} (99 %), {} (maximum)", ms(row.frame_p50, 3),
                                                ms(row.frame_p99, 3), ms(row.frame_max, 3)));
  if (std::isfinite(row.frames) && std::isfinite(row.missed))
    facts.emplace_back("late frames", fmt::format("{} of {}", digits(row.missed, 9), digits(row.frames, 9)));
  return facts;
}

/// Other rows that meet the question.
std::string words_of_others(std::span<const AdviceRecord> rows, const AdviceRecord* best) {
  std::vector<std::string> others;
  for (const AdviceRecord& row : rows)
    if (row.suits() && &row != best)
      others.push_back(
          fmt::format("{} at {}{}", row.words(), ms(row.h), row.verdict == "tie" ? " (equally good)" : ""));
  constexpr std::size_t most = 4;
  const std::size_t more = others.size() > most ? others.size() - most : 0;
  others.resize(std::min(others.size(), most));
  return fmt::format("{}{}", fmt::join(others, "; "), more > 0 ? fmt::format("; {} more", more) : "");
}

std::string question_of(const AdviceKey& key) {
  return fmt::format("error at most {}, frames of at most {}; best is {}", percent(key.tolerance),
                     ms(key.budget), key.ranked_by == "error" ? "the smallest error" : "the lowest CPU time");
}

/// What the store keeps of the answer in words; nothing of stores of an earlier hmax, and of words that are
/// damaged.
std::optional<AnswerWords> words_of(const AdviceKey& key, const ReportedStore& store) {
  const auto found = std::ranges::find(store.words, key, &AdviceWords::key);
  if (found == store.words.end()) return std::nullopt;
  try {
    return answer_words_of(found->words);
  } catch (const InputError&) {
    return std::nullopt;
  }
}

/// What is recommended, in the words of the answer where the store has them; or what would help.
Facts facts_of(const AdviceRecord* best, const AnswerWords* words) {
  Facts facts;
  if (words && !words->facts.empty())
    facts = words->facts;
  else if (best)
    facts = facts_of(*best);
  if (!words || best) return facts;
  facts.emplace_back("remedies", words->help);
  for (const std::string& remedy : words->remedies) facts.emplace_back("", remedy);
  return facts;
}

std::string words_of_answer(std::span<const AdviceRecord> rows, const AdviceRecord* best) {
  const bool ended_early = rows.front().is_of_unfinished_search();
  if (best)
    return "Take " + step_of(*best) +
           (ended_early ? ", the best that was known when the search ended early." : ".");
  return ended_early ? "The search ended early: the rows that were finished, and no recommendation."
                     : "No method that was tried meets this.";
}

std::string html_of(const Answer& answer, std::span<const ReportedStore> stores) {
  const AdviceKey& key = answer.rows.front().key;
  const auto best = std::ranges::find(answer.rows, "recommended", &AdviceRecord::verdict);
  const bool found = best != answer.rows.end();
  const std::optional<AnswerWords> words = words_of(key, stores[answer.store]);
  Facts facts{{"model", words ? words->body : ""}, {"question", question_of(key)}, {"motion", key.motion}};
  for (auto& fact : facts_of(found ? &*best : nullptr, words ? &*words : nullptr))
    facts.push_back(std::move(fact));
  if (const std::string others = words_of_others(answer.rows, found ? &*best : nullptr); !others.empty())
    facts.emplace_back("other methods", others);
  const std::size_t number =
      answer.first + (found ? static_cast<std::size_t>(best - answer.rows.begin()) : 0);
  const std::string markdown =
      fmt::format("**{}**\n\n{}[row {} of {}](#{})\n",
                  markdown_text(words_of_answer(answer.rows, found ? &*best : nullptr)),
                  markdown_facts(facts), number, markdown_text(stores[answer.store].name),
                  row_anchor(advice_table, answer.store, number, stores.size()));
  return fmt::format("<article class=\"answer\">\n<h3>{}{}{} at {} Hz</h3>\n{}</article>\n",
                     html_text(title_of(key.problem)), key.material.empty() ? "" : ", ",
                     html_text(key.material), digits(key.rate, 6), markdown_parts(markdown).html);
}

}  // namespace

std::string report_answers(std::span<const ReportedStore> stores) {
  std::string html;
  for (std::size_t s = 0; s < stores.size(); ++s) {
    const std::span<const AdviceRecord> rows = stores[s].advice;
    for (std::size_t begin = 0, end = 0; begin < rows.size(); begin = end) {
      while (end < rows.size() && rows[end].key == rows[begin].key) ++end;
      html += html_of({rows.subspan(begin, end - begin), s, begin + 1}, stores);
    }
  }
  return html;
}

}  // namespace hmax
