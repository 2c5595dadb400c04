#include "catalogue/models/equilibria/tool_report.hpp"

#include <fmt/format.h>

#include "catalogue/models/tissue_problem.hpp"
#include "core/numbers.hpp"
#include "problems/tissue/body.hpp"

namespace hmax {

nlohmann::ordered_json ToolReport::json() const {
  return {{"depth", reach.depth},
          {"indentation", reach.indentation},
          {"penetration", reach.penetration},
          {"displacement", reach.displacement},
          {"stiffness", stiffness}};
}

std::string ToolReport::words() const {
  return fmt::format("indentation {} of {}, the surface there moves {} along its path",
                     millimetres(reach.indentation), millimetres(reach.depth),
                     millimetres(reach.displacement));
}

std::string ToolReport::warning() const {
  constexpr double enough = 0.9;
  const std::string depth = millimetres(reach.depth);
  if (!(reach.depth > 0)) return {};
  if (reach.penetration == 0)
    return fmt::format("the tool has moved {} and does not touch the surface", depth);
  if (reach.indentation < enough * reach.depth) {
    const std::string what = fmt::format("the tool has moved {} but indents the body by {}", depth,
                                         millimetres(reach.indentation));
    if (reach.penetration > (1 - enough) * reach.depth)
      return fmt::format("{}: the surface is {} inside the tool; raise tool_stiffness from {}", what,
                         millimetres(reach.penetration), short_number(stiffness, 3));
    return what + ": it starts away from the surface; place it nearer with --tool-at";
  }
  // The tool has its way, but the body has gone aside.
  if (reach.displacement < 0.5 * reach.depth)
    return fmt::format(
        "the tool has moved {} but takes the surface only {} along: it slides off; place it with --tool-at or turn it "
        "with --tool-direction",
        depth, millimetres(reach.displacement));
  return {};
}

ToolReport tool_report(const nlohmann::ordered_json& document) {
  return {.reach = {.depth = document["depth"],
                    .indentation = document["indentation"],
                    .penetration = document["penetration"],
                    .displacement = document["displacement"]},
          .stiffness = document["stiffness"]};
}

bool has_tool(const Problem& problem) { return problem.body && !settings_of(problem).tools.empty(); }

std::optional<ToolReport> tool_report(const Problem& problem, double t, const Eigen::VectorXd& y) {
  if (!has_tool(problem)) return std::nullopt;
  const TissueBody& body = *problem.body;
  return ToolReport{.reach = body.tool_reaches(t, y).front(),
                    .stiffness = body.settings().tools.front().stiffness};
}

std::string warning_of_tool(const Problem& problem, double t, const Eigen::VectorXd& y) {
  // A press that has not ended is less deep than was asked.
  constexpr double rounding = 1e-9;
  if (!has_tool(problem) || t < (1 - rounding) * problem.body->steady_from()) return {};
  return tool_report(problem, t, y)->warning();
}

}  // namespace hmax
