#include "cli/bodies/body_words.hpp"

#include <fmt/format.h>

#include "bench/models/body_summary.hpp"
#include "bench/models/free_parts.hpp"

namespace hmax {

using Json = nlohmann::ordered_json;

std::string body_in_words(const Problem& problem) {
  return problem.body ? fmt::format("{}\n{}", problem.note, in_words(summary_of(*problem.body))) : "";
}

Json body_json(const Problem& problem) {
  if (!problem.body) return nullptr;
  const BodySummary body = summary_of(*problem.body);
  const auto span = [](const BodySummary::Span& of) { return of[0] == of[1] ? Json(of[0]) : Json(of); };
  return {{"E", span(body.young)},
          {"nu", span(body.poisson)},
          {"rho", span(body.density)},
          {"regions", body.regions},
          {"mass", body.mass},
          {"size", {body.size.x(), body.size.y(), body.size.z()}},
          {"points", body.points},
          {"held", body.held},
          {"gravity", {body.gravity.x(), body.gravity.y(), body.gravity.z()}},
          {"unusual", unusual_values(body)}};
}

void remark_unusual(Console& console, const Problem& problem) {
  if (!problem.body) return;
  for (const std::string& sentence : unusual_values(summary_of(*problem.body))) console.remark(sentence);
  // Who holds nothing at all knows that.
  if (!problem.body->settings().supports.empty())
    if (const std::string free = free_parts_in_words(problem); !free.empty()) console.remark(free);
  if (!problem.material.empty() && problem.body->settings().model.is_of_springs())
    console.remark(
        fmt::format("the Poisson's ratio of {} does not act: springs have 1/4 whatever the material says",
                    problem.material));
}

}  // namespace hmax
