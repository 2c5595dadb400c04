#include "limits/query/limit_question.hpp"

#include <algorithm>

#include "catalogue/models/model.hpp"
#include "core/errors.hpp"
#include "limits/along/trajectory_limit.hpp"

namespace hmax {

namespace {

/// States whose steps, or whose runs from a start, are done within a minute or two.
constexpr Eigen::Index soon = 2000;
/// States whose runs from a start are done at once.
constexpr Eigen::Index at_once = 30;

/// Whether the limits of one state do not tell of the motion, or nobody knows that they do.
bool changes_along_motion(const Problem& problem) {
  if (problem.body) return has_moving_load(problem);
  return linearity_of(problem) != Linearity::linear;
}

}  // namespace

double LimitQuestion::end_of(const Problem& problem) const {
  return t_end ? problem.shown.own_time(*t_end) : end_of_motion(problem);
}

bool LimitQuestion::seeks_in_steps(const Method& method, const Problem& problem) const {
  return problem.y0.size() <= soon || std::ranges::find(named, method.id) != named.end();
}

LimitQuestion with_path(LimitQuestion question, const std::string& path, const Problem& problem) {
  question.path_by_default =
      path.empty() && !question.options && changes_along_motion(problem) && question.at != AskedState::rest;
  question.path = question.path_by_default ? "motion" : path == "none" ? "" : path;
  if (question.t_end && question.path != "motion")
    throw InputError(
        "--t-end ends the motion of --along, which is not asked for; add --along or leave it out");
  const Eigen::Index states = problem.y0.size();
  const bool is_large = problem.body || states > soon;
  if (question.path != "motion" || (question.path_by_default && is_large)) return question;
  if (question.verify)
    question.run_steps = thorough_search;
  else if (!problem.body && states <= at_once)
    question.run_steps = quick_search / static_cast<double>(std::max<Eigen::Index>(1, states / 2));
  return question;
}

std::vector<std::string> named_one_by_one(const std::vector<std::string>& names,
                                          const std::vector<Method>& methods) {
  std::vector<std::string> ids;
  for (const std::string& name : names)
    for (const Method& method : methods)
      if (method.id == name || std::ranges::find(method.aliases, name) != method.aliases.end())
        ids.push_back(method.id);
  return ids;
}

}  // namespace hmax
