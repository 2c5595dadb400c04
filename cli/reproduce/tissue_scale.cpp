/// The section of `hmax reproduce tissue --scale`.
#include <algorithm>
#include <array>
#include <limits>

#include "cli/reproduce/tissue_page.hpp"
#include "studies/scale_study.hpp"

namespace hmax {

namespace {

struct Cost {
  const char* name;
  double ScaleRow::*seconds;
};
constexpr std::array<Cost, 6> costs{{{"implicit step, CG", &ScaleRow::implicit_step},
                                     {"import of a file", &ScaleRow::import},
                                     {"largest eigenvalue", &ScaleRow::eigenvalue},
                                     {"stiffness", &ScaleRow::stiffness},
                                     {"explicit step", &ScaleRow::explicit_step},
                                     {"forces", &ScaleRow::force}}};

/// The largest cost of a tetrahedron over the smallest.
double spread(const std::vector<ScaleRow>& rows, double ScaleRow::*seconds) {
  double low = std::numeric_limits<double>::infinity(), high = 0;
  for (const ScaleRow& row : rows) {
    const double each = row.*seconds / static_cast<double>(row.tetrahedra);
    low = std::min(low, each);
    high = std::max(high, each);
  }
  return high / low;
}

}  // namespace

void costs_over_size(TissuePage& tissue, const std::function<void(const std::string&)>& progress) {
  const std::vector<std::string> meshes =
      tissue.options.quick ? std::vector<std::string>{"ball:n=2", "ball:n=4"} : scale_meshes();
  const std::vector<ScaleRow> rows =
      scale_study(meshes, tissue.page.folder, [&](double, const std::string& mesh) { progress(mesh); });
  Panel panel{.x = {.label = "tetrahedra [1]", .logarithmic = true},
              .y = {.label = "CPU time for each tetrahedron [ns]", .logarithmic = true}};
  int k = 0;
  for (const Cost& cost : costs) {
    Curve curve{.label = cost.name, .style = family_style(k++, true)};
    for (const ScaleRow& row : rows) {
      curve.x.push_back(static_cast<double>(row.tetrahedra));
      curve.y.push_back(1e9 * row.*cost.seconds / static_cast<double>(row.tetrahedra));
    }
    panel.curves.push_back(std::move(curve));
  }
  tissue.page.draw({.title = "What a tetrahedron costs in meshes of a thousand to a million",
                    .panels = {panel},
                    .footer = "fem_green, one thread; " + tissue.options.machine,
                    .panel_height = 380},
                   "costs_over_size");
  tissue.document["sizes"] = rows;
  tissue.page.values["sizes"] = {{"meshes", rows},
                                 {"force_spread", spread(rows, &ScaleRow::force)},
                                 {"step_spread", spread(rows, &ScaleRow::explicit_step)}};
}

}  // namespace hmax
