#include "catalogue/methods/choice/chosen_methods.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "catalogue/methods/catalogue.hpp"
#include "catalogue/methods/unsuited.hpp"
#include "core/input_error.hpp"

namespace hmax {

void add_methods(const std::string& name, const std::vector<Problem>& problems, ChosenMethods& chosen) {
  const std::vector<std::string> families = method_families();
  if (name != "all" && std::ranges::find(families, name) == families.end())
    return add_once(chosen.methods, find_method(name));
  for (const Method& method : methods()) {
    if (name != "all" && method.family != name) continue;
    const auto unsuited = std::ranges::find_if(problems, [&](const Problem& p) { return !suits(method, p); });
    if (unsuited == problems.end())
      add_once(chosen.methods, method);
    else if (name != "all" || !method.unsuited || unsuited->body)  // nobody misses those of bodies elsewhere
      add_once(chosen.left_out, LeftOut{method.id, why_unsuited(method, *unsuited)});
  }
}

void require_any(const ChosenMethods& chosen, const std::vector<std::string>& names) {
  if (chosen.methods.empty() && !chosen.left_out.empty())
    throw input_error(
        "no method of {} can be taken: {}; name other methods, `hmax list methods` shows all of them",
        fmt::join(names, ","), fmt::join(in_words(chosen.left_out), "; "));
}

ChosenMethods chosen_methods(const std::vector<std::string>& names, const std::vector<Problem>& problems) {
  ChosenMethods chosen;
  for (const std::string& name : names) add_methods(name, problems, chosen);
  require_any(chosen, names);
  return chosen;
}

std::vector<Method> choose_methods(const std::vector<std::string>& names,
                                   const std::vector<Problem>& problems) {
  return chosen_methods(names, problems).methods;
}

std::vector<std::string> in_words(const std::vector<LeftOut>& left_out) {
  std::vector<std::string> lines;
  std::vector<const LeftOut*> rest;
  for (const LeftOut& one : left_out) rest.push_back(&one);
  while (!rest.empty()) {
    const std::string& why = rest.front()->why;
    std::vector<std::string> ids;
    for (const LeftOut* one : rest)
      if (one->why == why) ids.push_back(one->id);
    lines.push_back(fmt::format("{}: {}", fmt::join(ids, ", "), why));
    std::erase_if(rest, [why](const LeftOut* one) { return one->why == why; });
  }
  return lines;
}

}  // namespace hmax
