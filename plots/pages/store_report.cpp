#include "plots/pages/store_report.hpp"

#include <algorithm>
#include <set>
#include <vector>

#include <fmt/format.h>

#include "core/errors.hpp"
#include "plots/colours.hpp"
#include "plots/pages/body_scene.hpp"
#include "plots/pages/frame.hpp"
#include "plots/pages/markdown_page.hpp"
#include "plots/pages/markdown_text.hpp"
#include "plots/pages/report_answers.hpp"
#include "plots/pages/report_data.hpp"
#include "plots/svg.hpp"
#include "results/json.hpp"

namespace hmax {

namespace {

/// The scripts of the page in one scope of its own.
std::string script() {
  std::string text = "(() => {\n";
  for (const char* name : {"store_report_tables", "store_report_figures", "store_report"})
    text += page_script(name);
  return text + "})();\n";
}

/// The colours of curves: on dark ground lighter ones, and white for black.
std::string colour_variables() {
  constexpr int count = 8, black = 6;
  constexpr double lighter = 0.78, near_white = 0.08;
  std::string light, dark;
  for (int k = 0; k < count; ++k) {
    light += fmt::format("--c{}:{};", k, colour_name(k));
    dark += fmt::format("--c{}:{};", k, colour_name(k, k == black ? near_white : lighter));
  }
  return fmt::format(
      ":root{{{0}}}\n@media (prefers-color-scheme:dark){{:root:not([data-theme=light]){{{1}}}}}\n:root[data-theme=dark]{{{1}}}\n"
      "@media print{{:root,:root[data-theme]{{{0}}}}}\n",
      light, dark);
}

/// Rows of each kind in all stores.
struct Counts {
  /// Explored ones, those on devices and those with comparable CPU times are among the runs.
  std::size_t runs = 0, explored = 0, on_devices = 0, with_cpu_times = 0, limits = 0, advice = 0;
};

Counts count_rows(std::span<const ReportedStore> stores) {
  Counts counts;
  for (const ReportedStore& store : stores) {
    counts.runs += store.runs.size();
    counts.explored += static_cast<std::size_t>(std::ranges::count_if(store.runs, &Row::explored));
    counts.on_devices += static_cast<std::size_t>(std::ranges::count_if(store.runs, is_on_device));
    counts.with_cpu_times += static_cast<std::size_t>(std::ranges::count_if(store.runs, has_cpu_times));
    counts.limits += store.limits.size();
    counts.advice += store.advice.size();
  }
  return counts;
}

std::string counted(std::size_t count, const char* one, const char* many) {
  return fmt::format("{} {}", count, count == 1 ? one : many);
}

std::string summary_of(std::span<const ReportedStore> stores) {
  const Counts counts = count_rows(stores);
  std::string words;
  const auto add = [&](std::size_t count, const char* one, const char* many) {
    if (count > 0) words += (words.empty() ? "" : ", ") + counted(count, one, many);
  };
  add(counts.advice, "row of advice", "rows of advice");
  add(counts.runs, "run", "runs");
  add(counts.limits, "limit", "limits");
  return fmt::format("{} in {}.", words.empty() ? "No rows" : words,
                     counted(stores.size(), "store", "stores"));
}

/// A part of the page with the places that the script fills.
struct Section {
  std::string_view table;
  const char *title, *words;
  std::vector<std::string_view> figures;
  std::string before = {};
};

/// A page in the making: what its navigation leads to, one after the other.
class Parts {
 public:
  void add(const std::string& id, const std::string& title, const std::string& html) {
    links_.push_back({"#" + id, title});
    main_ += fmt::format("<section>\n<h2 id=\"{}\">{}</h2>\n{}</section>\n", id, html_text(title), html);
  }
  void add_markdown(const std::string& text) {
    const MarkdownParts parts = markdown_parts(text);
    links_.insert(links_.end(), parts.links.begin(), parts.links.end());
    main_ += parts.html;
  }
  [[nodiscard]] const std::vector<PageLink>& links() const { return links_; }
  [[nodiscard]] const std::string& main() const { return main_; }

 private:
  std::vector<PageLink> links_;
  std::string main_;
};

void add(Parts& parts, const Section& section) {
  std::string html;
  if (*section.words != '\0') html += fmt::format("<p>{}</p>\n", section.words);
  html += section.before + "<div class=\"figures\">\n";
  for (const std::string_view figure : section.figures)
    html += fmt::format("<div id=\"figure-{}\"></div>\n", figure);
  html += fmt::format("</div>\n<div id=\"table-{}\"></div>\n", section.table);
  parts.add(fmt::format("{}-section", section.table), section.title, html);
}

/// Where the page is about one answer, this says what its rows are in words.
Section advice_section(std::span<const ReportedStore> stores, const AnswerSections* answer) {
  const std::vector<std::string_view> figures{"advice_error", "frame_times", "frame_tail",
                                              "steps_and_limits"};
  if (!answer)
    return {advice_table, "Advice", "", figures,
            "<div class=\"answers\">\n" + report_answers(stores) + "</div>\n"};
  constexpr const char* title = "All methods";
  return {advice_table, title, "", figures,
          "<noscript>\n" + markdown_parts(answer->table).html + "</noscript>\n"};
}

Section runs_section(const Counts& counts) {
  std::vector<std::string_view> figures{"time_steps"};
  std::string remarks;
  if (counts.on_devices > 0) {
    figures.insert(figures.begin(), "device_work_precision");
    remarks += fmt::format(
        "<p>Times of devices are by their own clocks, in columns and a figure of their own; {} on a device.</p>\n",
        counted(counts.on_devices, "of these runs is", "of these runs are"));
  }
  if (counts.with_cpu_times > 0) figures.insert(figures.begin(), "work_precision");
  if (counts.explored > 0)
    remarks += fmt::format("<p>CPU times of explored runs are rough and not shown; {} explored.</p>\n",
                           counted(counts.explored, "of these was", "of these were"));
  return {runs_table, "Runs", "Runs of <code>hmax sweep</code> and <code>hmax precision</code>.", figures,
          remarks};
}

std::vector<Section> sections_of(std::span<const ReportedStore> stores, const AnswerSections* answer) {
  const Counts counts = count_rows(stores);
  std::vector<Section> sections;
  if (counts.advice > 0) sections.push_back(advice_section(stores, answer));
  if (counts.runs > 0) sections.push_back(runs_section(counts));
  if (counts.limits > 0)
    sections.push_back(
        {limits_table,
         "Limits of the step",
         "Predictions of <code>hmax stability predict</code>, and what runs on both sides showed.",
         {"limits", "gaps"}});
  return sections;
}

/// Sessions of one machine and build that follow one another.
struct Sessions {
  const Session *first, *last;
};

std::vector<Sessions> alike_sessions(const std::vector<Session>& sessions) {
  std::vector<Sessions> groups;
  for (const Session& session : sessions) {
    if (groups.empty() || !differences(groups.back().last->fingerprint, session.fingerprint).empty())
      groups.push_back({&session, &session});
    groups.back().last = &session;
  }
  return groups;
}

std::string html_of(const Sessions& sessions, const std::string& store) {
  const auto& [first, last] = sessions;
  const Fingerprint& machine = last->fingerprint;
  const bool one = first == last;
  std::string libraries;
  for (const auto& [name, version] : machine.libraries)
    libraries += fmt::format("{}{} {}", libraries.empty() ? "" : ", ", name, version);
  std::vector<std::pair<std::string, std::string>> facts{
      {"date (UTC)", one ? first->started : first->started + " to " + last->started},
      HMAX_KEYS(machine, caches, governor, kernel),
      {"load at start", machine.load},
      {"instruction set", machine.instruction_set},
      {"flags", machine.flags},
      {"libraries", libraries}};
  std::erase_if(facts, [](const auto& fact) { return fact.second == "unknown"; });
  return fmt::format(
      "<article class=\"machine\">\n<h3>{}: {}</h3>\n{}</article>\n", html_text(store),
      one ? fmt::format("session {}", first->id) : fmt::format("sessions {} to {}", first->id, last->id),
      markdown_parts(markdown_text(summary(machine)) + "\n\n" + markdown_facts(facts)).html);
}

std::string machines(std::span<const ReportedStore> stores) {
  std::string html = "<p>CPU times belong to the machine of their session.</p>\n";
  for (const ReportedStore& store : stores)
    for (const Sessions& sessions : alike_sessions(store.sessions)) html += html_of(sessions, store.name);
  return html;
}

std::string introduction_of(std::span<const ReportedStore> stores, const AnswerSections* answer,
                            std::size_t left_out) {
  std::string html =
      fmt::format("<p>{}</p>\n", answer ? html_text(answer->introduction) : summary_of(stores));
  if (left_out > 0)
    html += fmt::format(
        "<p>{} left out to keep the page small; <code>hmax export STORE</code> writes every row.</p>\n",
        counted(left_out, "row is", "rows are"));
  return html + "<noscript><p>Figures and sorted tables need JavaScript.</p></noscript>\n";
}

/// The bodies of answers, each once, as long as there is room; how many have none is told.
std::string report_bodies(std::span<const ReportedStore> stores) {
  constexpr std::size_t most_bytes = 3'500'000;  // leaves room for rows on a page of 5 MB
  std::set<std::string_view> shown;
  std::size_t without_room = 0;
  std::string html;
  for (const ReportedStore& store : stores)
    for (const AdviceScene& each : store.scenes) {
      if (!shown.insert(each.scene).second) continue;
      std::string body;
      try {
        body = scene_html(each.scene, fmt::format("body-{}", shown.size()));
      } catch (const InputError& error) {
        body =
            fmt::format("<p>{}: not shown. {}</p>\n", html_text(each.key.problem), html_text(error.what()));
      }
      if (html.size() + body.size() <= most_bytes)
        html += body;
      else
        ++without_room;
    }
  if (without_room > 0)
    html += fmt::format("<p>{} more {} not shown, to keep the page small; name fewer stores.</p>\n",
                        without_room, without_room == 1 ? "body is" : "bodies are");
  return html;
}

/// @param answer  null: the page is about stores
/// @param bodies  of report_bodies()
std::string page_of(std::span<const ReportedStore> stores, const AnswerSections* answer,
                    const std::string& bodies, const std::string& version, const ReportData& data) {
  PageFrame page{.title = answer               ? answer->title
                          : stores.size() == 1 ? "Results: " + stores.front().name
                                               : fmt::format("Results: {} stores", stores.size())};
  page.introduction = introduction_of(stores, answer, data.left_out);
  page.style = std::string(page_style("store_report")) + colour_variables();
  page.script = script();
  Parts parts;
  if (!bodies.empty()) {
    page.style += scene_style();
    page.script += scene_script();
  }
  if (answer) {
    parts.add_markdown(answer->before);
    if (!bodies.empty()) parts.add("bodies", "The body", bodies);
  }
  for (const Section& section : sections_of(stores, answer)) add(parts, section);
  if (answer)
    parts.add_markdown(answer->after);
  else if (!bodies.empty())
    parts.add("bodies", "Bodies", bodies);
  parts.add("machines", answer ? "Machine" : "Machines", machines(stores));
  page.links = parts.links();
  page.main = parts.main();
  page.footer = fmt::format(
      "<p>Written by hmax {}. Row numbers count the rows of a store in the order of <code>hmax export</code>.</p>",
      html_text(version));
  page.data = fmt::format("<script type=\"application/json\" id=\"data\">{}</script>\n", data.json);
  return framed_page(page);
}

StoreReport report_of(std::span<const ReportedStore> stores, const AnswerSections* answer,
                      const std::string& version, std::size_t most_bytes) {
  const Counts counts = count_rows(stores);
  const std::string bodies = report_bodies(stores);
  std::size_t most_rows = std::max({counts.runs, counts.limits, counts.advice});
  for (;;) {
    const ReportData data = report_data(stores, most_rows);
    std::string html = page_of(stores, answer, bodies, version, data);
    if (html.size() <= most_bytes || most_rows <= 1) return {std::move(html), data.left_out};
    // A little less than its share, so that one more round is enough as a rule.
    most_rows =
        std::max<std::size_t>(1, std::min(most_rows - 1, most_rows * most_bytes / html.size() * 19 / 20));
  }
}

}  // namespace

StoreReport store_report(std::span<const ReportedStore> stores, const std::string& version,
                         std::size_t most_bytes) {
  return report_of(stores, nullptr, version, most_bytes);
}

StoreReport answer_report(const ReportedStore& answer, const AnswerSections& sections,
                          const std::string& version, std::size_t most_bytes) {
  return report_of({&answer, 1}, &sections, version, most_bytes);
}

}  // namespace hmax
