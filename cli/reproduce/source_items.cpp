#include "cli/reproduce/source_items.hpp"

#include <array>
#include <map>

#include <fmt/format.h>

#include "plots/pages/markdown_page.hpp"
#include "plots/pages/report.hpp"

namespace hmax {

namespace {

constexpr const char *o = "oscillators", *s = "stability", *t = "tissue", *none = "";
constexpr const char* sentences = "The sentences of the study, tested";

constexpr std::array study{
    SourceItem{"Abstract", "ode45 is the fastest of five solvers", o, sentences, ""},
    SourceItem{"Introduction", "1500 nodes or 3000 elements represent an organ", none, "",
               "a citation without a measure of what is represented"},
    SourceItem{"Equations 2.1 to 2.3", "linear, cubic and forced model", o, "Figure 2",
               "the models liver_linear, liver_cubic and liver_forced"},
    SourceItem{"Equations 2.4 to 2.8", "the full model with its numbers, as two equations of first order", o,
               "Figure 1", ""},
    SourceItem{"Equation 2.9", "Euler's method from x = x' = 0", o, "Equations 2.5 and 2.9", ""},
    SourceItem{"Section 2.2, 2.4", "explicit and implicit methods, order of ode113", o, sentences, ""},
    SourceItem{"Section 2.5", "timing set: damping -2, internal stiffness 0.8", o, "Equations 2.5 and 2.9",
               "its two readings"},
    SourceItem{"Table 1", "slim, normal and fat livers, male and female", o, "Figure 8", ""},
    SourceItem{"Figure 1", "CPU time against the step", o, "Figure 1", ""},
    SourceItem{"Table 2", "execution times", o, "Table 2", "running totals"},
    SourceItem{"Section 3.1", "speed, accuracy and stability of the solvers", o, sentences, ""},
    SourceItem{"Section 3.1", "stability of the solvers as step limits", s, "Predicted and observed", ""},
    SourceItem{"Equations 3.1 to 3.3", "the three cases", o, "Figure 2", ""},
    SourceItem{"Figure 2", "mass varied", o, "Figure 2", ""},
    SourceItem{"Figure 3", "stiffness varied", o, "Figure 3", ""},
    SourceItem{"Figure 4", "damping varied", o, "Figure 4", ""},
    SourceItem{"Figure 5", "phase plane, critically damped and overdamped", o, "Figure 5", ""},
    SourceItem{"Figure 6", "phase planes, c = -0.2, 0, 2, 10", o, "Figure 6", ""},
    SourceItem{"Figure 7", "force varied", o, "Figure 7", ""},
    SourceItem{"Figure 8", "benchmark livers with and without force", o, "Figure 8", ""},
    SourceItem{"Section 3.3", "settling, oscillation, critical damping", o, sentences, ""},
    SourceItem{"Figure 9", "a deformed liver drawn by SOFA", t, "Figure 9 of the liver study",
               "the parameters of the picture are not printed"},
};

constexpr std::array thesis{
    SourceItem{"Slide 6", "phantom: 57 points, 120 tetrahedra, 230 edges", t, "Two meshes", ""},
    SourceItem{"Slides 7 to 9", "springs, small and Green's strain", t, "The same load on springs", ""},
    SourceItem{"Slides 10 to 12", "elements cost four times as much as springs", t,
               "What finite elements cost", ""},
    SourceItem{"Slides 11, 12", "dilatation may be controlled", t, "Dilatation", ""},
    SourceItem{"Slide 16", "pre-inverted linear model", t, "The linear model: pre-inverted", ""},
    SourceItem{"Slide 16", "no rotation, no large strain", t, "Rotation", ""},
    SourceItem{"Slides 17, 18, 62", "Newton's method and the modified one", t, "Static solvers", ""},
    SourceItem{"Slide 20", "order against stages", t, "Explicit methods: order against stages", ""},
    SourceItem{"Slides 21, 59, 71", "stability of explicit methods by eigenvalues", t,
               "Stability regions with the eigenvalues", ""},
    SourceItem{"Slide 22", "implicit methods: no limit of the step, constant Jacobian at 100 Hz", t,
               "Linearly implicit Euler with a constant Jacobian", ""},
    SourceItem{"Slides 26 to 33", "thigh measured by two probes, its springs identified", t,
               "A thigh identified", "from synthetic measurements; those of the thesis are not printed"},
    SourceItem{"Slides 34, 35", "thigh at 100 Hz, explicit Euler needs small steps or a large mass", t,
               "A thigh identified", ""},
    SourceItem{"Slides 36 to 38", "neural static model", t, "A thigh identified",
               "trained on the same measurements"},
    SourceItem{"Slides 41, 42", "collision by penalty forces", t, "A tool", ""},
    SourceItem{"Slides 43 to 45", "haptics at 1 kHz by a local model", t, "Force feedback at 1 kHz", ""},
    SourceItem{"Slides 47 to 49", "echographic images", none, "", "images, no equations"},
    SourceItem{"Slide 56", "liver: 299 points, 1151 tetrahedra, 1634 edges", t, "Two meshes", ""},
    SourceItem{"Slide 57", "stress against strain of skin and parenchyma", t, "Force against displacement",
               "one material; a skin is an option of every body"},
    SourceItem{"Slide 58", "280 steps per second with particles of 5 g", t, "Steps a second against the mass",
               ""},
    SourceItem{"Slide 60", "150 Hz; explicit integration is not stable", t,
               "Linearly implicit Euler with a constant Jacobian", ""},
    SourceItem{"Slides 61 to 64", "inner systems: accurate or not", t, "How far to solve", ""},
    SourceItem{"Slides 65, 66", "pseudo-dynamic, 60 iterations a second", t, "Pseudo-dynamic", ""},
    SourceItem{"Slide 66", "rotational invariance", t, "Rotation", ""},
};

/// The heading of a page that begins like this; empty where there is none.
std::string heading_of(const std::string& page, const std::string& beginning) {
  const std::size_t at = page.find("\n## " + beginning);
  if (at == std::string::npos) return {};
  return page.substr(at + 4, page.find('\n', at + 4) - at - 4);
}

}  // namespace

std::span<const SourceItem> study_items() { return study; }
std::span<const SourceItem> thesis_items() { return thesis; }

std::string items_table(std::span<const SourceItem> items,
                        const std::function<std::string(const std::string& part)>& page) {
  std::map<std::string, std::string> pages;
  std::string table = "| printed | what it says | redone |\n| --- | --- | --- |\n";
  for (const SourceItem& item : items) {
    const std::string part = item.part;
    std::string where = "not redone";
    if (!part.empty()) {
      if (!pages.contains(part)) pages[part] = page(part);
      const std::string heading = heading_of(pages[part], item.section);
      where = pages[part].empty()
                  ? fmt::format("not made here; `--part {}` makes it: {}", part, markdown_text(item.section))
              : heading.empty() ? fmt::format("{}: {}", part, markdown_text(item.section))
                                : fmt::format("[{}]({}/README.md#{})", markdown_text(heading), part,
                                              heading_anchor(heading));
    }
    if (*item.note) where += fmt::format("; {}", markdown_text(item.note));
    table += fmt::format("| {} | {} | {} |\n", item.item, markdown_text(item.says), where);
  }
  return table;
}

}  // namespace hmax
