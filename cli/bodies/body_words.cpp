#include "cli/bodies/body_words.hpp"

#include <cmath>

#include <fmt/format.h>

#include "catalogue/models/body_summary.hpp"
#include "catalogue/models/equilibria/tool_report.hpp"
#include "catalogue/models/free_parts.hpp"
#include "catalogue/models/matrix_problem.hpp"
#include "catalogue/models/mesh_choice.hpp"
#include "catalogue/models/tissue_problem.hpp"
#include "core/numbers.hpp"

namespace hmax {

std::string body_in_words(const Problem& problem) {
  if (problem.matrices) return problem.note;
  return problem.body ? fmt::format("{}\n{}", problem.note, in_words(summary_of(*problem.body))) : "";
}

void remark_unusual(Console& console, const Problem& problem) {
  for (const std::string& sentence : matrix_remarks(problem)) console.remark(sentence);
  if (!problem.body) return;
  if (const MeshOrigin* origin = problem.body->origin().get()) {
    for (const std::string& sentence : remarks_on_mesh(origin->file)) console.remark(sentence);
    if (const std::string left_out = origin->file.material_left_out();
        problem.material_by_default && !left_out.empty())
      console.remark(left_out);
  }
  for (const std::string& sentence : unusual_values(summary_of(*problem.body))) console.remark(sentence);
  // Who holds nothing at all knows that.
  if (!settings_of(problem).supports.empty())
    if (const std::string free = free_parts_in_words(problem); !free.empty()) console.remark(free);
  if (!problem.material.empty() && settings_of(problem).model.is_of_springs())
    console.remark(
        fmt::format("the Poisson's ratio of {} does not act: springs have 1/4 whatever the material says",
                    problem.material));
}

void warn_of_tool(Console& console, const Problem& problem, double t, const Eigen::VectorXd& y) {
  if (const std::string warning = warning_of_tool(problem, t, y); !warning.empty()) console.remark(warning);
}

std::string damping_in_words(double zeta) {
  return std::isnan(zeta) ? "-" : std::abs(zeta) < 1e-6 ? "0" : short_number(zeta, 2);
}

}  // namespace hmax
