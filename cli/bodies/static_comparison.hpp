/// Ways to an equilibrium of forces beside each other: residuals against iterations and against time.
#pragma once

#include <string>
#include <vector>

#include "analysis/statics/static_solution.hpp"
#include "plots/figure.hpp"

namespace hmax {

/// One way, and what came of it.
struct StaticWay {
  StaticMethod method;
  InnerSolver inner;
  StaticSolution solution;

  /// CPU time up to the last iterate [s].
  [[nodiscard]] double seconds() const {
    return solution.history.empty() ? 0 : solution.history.back().seconds;
  }
};

/// Newton's method and the modified one, each with every inner solver, from rest; the rest as in `settings`.
std::vector<StaticWay> all_ways(const StaticModel& model, StaticSettings settings);

/// Of sor and how far linear systems are solved, as for the footer of a figure.
std::string iterations_in_words(const StaticSettings& settings);

/// Their residuals, left against iterations, right against CPU time.
Figure residual_figure(const std::vector<StaticWay>& ways, const std::string& title,
                       const std::string& footer);

}  // namespace hmax
