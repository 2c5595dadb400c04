#include "plots/alt_text.hpp"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "plots/gnuplot.hpp"
#include "plots/svg.hpp"
#include "results/table.hpp"

namespace hmax {
namespace {

constexpr std::size_t most_panels = 4, most_entries = 12;

/// The first `most` of the different texts, and how many more there are.
std::string listed(const std::vector<std::string>& texts, std::size_t most, std::string_view separator) {
  std::vector<std::string> different;
  for (const std::string& text : texts)
    if (!text.empty() && std::ranges::find(different, text) == different.end()) different.push_back(text);
  std::string list;
  for (std::size_t i = 0; i < std::min(most, different.size()); ++i)
    list += fmt::format("{}{}", i == 0 ? "" : separator, different[i]);
  if (different.size() > most) list += fmt::format("{}and {} more", separator, different.size() - most);
  return list;
}

std::string axis_in_words(const Axis& axis) {
  return axis.label + (axis.logarithmic ? " (logarithmic)" : "");
}

std::string panel_in_words(const Panel& panel) {
  if (panel.y.label.empty() && panel.x.label.empty()) return panel.title;
  return fmt::format("{}{}{} over {}", panel.title, panel.title.empty() ? "" : ": ", axis_in_words(panel.y),
                     axis_in_words(panel.x));
}

/// "recommended: rk4", or what there is of both.
std::string named(const Mark& mark) {
  return mark.label.empty() ? mark.name : fmt::format("{}: {}", mark.label, mark.name);
}

void replace_element(std::string& text, std::string_view name, const std::string& content) {
  const std::string opening = fmt::format("<{}>", name), closing = fmt::format("</{}>", name);
  const std::size_t from = text.find(opening);
  const std::size_t to = from == std::string::npos ? from : text.find(closing, from);
  if (to == std::string::npos) return;
  text.replace(from + opening.size(), to - from - opening.size(), html_text(content));
}

}  // namespace

std::string alt_text(const Figure& figure) {
  std::vector<std::string> panels, entries;
  for (const Panel& panel : figure.panels) {
    panels.push_back(panel_in_words(panel));
    for (const Curve& curve : panel.curves) entries.push_back(curve.label);
    for (const Mark& mark : panel.marks) entries.push_back(mark.name.empty() ? mark.label : named(mark));
    for (const Area& area : panel.areas) entries.push_back(area.label);
    for (const Fill& fill : panel.fills) entries.push_back(fill.label);
  }
  std::string text;
  const auto sentence = [&](const std::string& words) {
    if (!words.empty()) text += fmt::format("{}{}.", text.empty() ? "" : " ", words);
  };
  sentence(figure.title);
  sentence(listed(panels, most_panels, "; "));
  if (const std::string shown = listed(entries, most_entries, ", "); !shown.empty())
    sentence("Shown: " + shown);
  return one_line(text);
}

void describe_svg(const std::filesystem::path& svg, const std::string& title,
                  const std::string& description) {
  std::ifstream in(svg, std::ios::binary);
  if (!in) return;
  std::string text{std::istreambuf_iterator<char>(in), {}};
  in.close();
  replace_element(text, "title", title);
  replace_element(text, "desc", description);
  if (const std::size_t root = text.find("<svg"); root != std::string::npos)
    text.insert(root + 4, " role=\"img\"");
  write_file(svg, text, "<?xml");
}

}  // namespace hmax
