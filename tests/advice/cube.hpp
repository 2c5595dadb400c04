/// A small body and a question about it.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "advice/advise.hpp"
#include "catalogue/methods/catalogue.hpp"
#include "catalogue/models/problems.hpp"

namespace hmax {

inline Problem cube(const std::string& load, std::vector<std::pair<std::string, double>> parameters = {}) {
  return make_problem("fem_green/" + load + "@cube:n=2", {.parameters = std::move(parameters)});
}

inline AdviceQuestion question(double rate, const std::vector<std::string>& names, const Problem& problem) {
  AdviceQuestion asked;
  asked.rate = rate;
  asked.frames = 50;
  asked.proof = 5;
  asked.methods = choose_methods(names, {problem});
  return asked;
}

}  // namespace hmax
