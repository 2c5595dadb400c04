/// The section of `hmax reproduce tissue --scale`.
#include <algorithm>
#include <array>
#include <limits>

#include <fmt/format.h>

#include "cli/reproduce/reproduce_tissue_parts.hpp"
#include "plots/draw.hpp"

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

ReportSection costs_over_size(const std::filesystem::path& folder, const TissueOptions& options,
                              TissueStudy& study,
                              const std::function<void(double, const std::string&)>& progress) {
  const std::vector<std::string> meshes =
      options.quick ? std::vector<std::string>{"ball:n=2", "ball:n=4"} : scale_meshes();
  study.sizes = scale_study(meshes, folder, progress);
  Panel panel{.x = {.label = "tetrahedra [1]", .logarithmic = true},
              .y = {.label = "CPU time for each tetrahedron [ns]", .logarithmic = true}};
  std::string table =
      "| mesh | tetrahedra | degrees of freedom | forces [s] | stiffness [s] | explicit step [s] | implicit step "
      "[s] | eigenvalue [s] | import [s] | memory [GB] |\n"
      "| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |\n";
  int k = 0;
  for (const Cost& cost : costs) {
    Curve curve{.label = cost.name, .style = family_style(k++, true)};
    for (const ScaleRow& row : study.sizes) {
      curve.x.push_back(static_cast<double>(row.tetrahedra));
      curve.y.push_back(1e9 * row.*cost.seconds / static_cast<double>(row.tetrahedra));
    }
    panel.curves.push_back(std::move(curve));
  }
  for (const ScaleRow& row : study.sizes)
    table += fmt::format("| {} | {} | {} | {:.3g} | {:.3g} | {:.3g} | {:.3g} | {:.3g} | {:.3g} | {:.2f} |\n",
                         row.mesh, row.tetrahedra, row.dofs, row.force, row.stiffness, row.explicit_step,
                         row.implicit_step, row.eigenvalue, row.import, 1e-9 * row.peak_memory);
  const Figure figure{.title = "What a tetrahedron costs in meshes of a thousand to a million",
                      .panels = {panel},
                      .footer = "fem_green, one thread; " + options.machine,
                      .panel_height = 380};
  return {
      .title = "Costs over the size of a mesh",
      .text = fmt::format(
          "Balls of finite elements (fem_green, E = 5.5 kPa, nu = 0.45) in their weight, one thread. The explicit step is "
          "that of symplectic Euler, the implicit one of linearly implicit Euler with h = 0.01 s by conjugate "
          "gradients to 1e-6, with its stiffness and preconditioner; the eigenvalue is the largest of M^-1 K, by Lanczos "
          "iteration to 1e-6; a file is one of Gmsh, read, checked and renumbered. Both iterations take more "
          "products on finer meshes. From the smallest to the largest mesh the forces of a tetrahedron cost up to "
          "{:.2g} times the least, an explicit step {:.2g} times. Memory is the most that the process had until then."
          "\n\n{}",
          spread(study.sizes, &ScaleRow::force), spread(study.sizes, &ScaleRow::explicit_step), table),
      .figures = {draw(figure, folder, "costs_over_size")}};
}

}  // namespace hmax
