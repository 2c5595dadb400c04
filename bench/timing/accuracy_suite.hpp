/// The accuracy suite: every method of hmax's own on problems of every kind, at steps and tolerances that
/// show its order, its error estimate, its controllers and its dense output. No times: the same machine gives
/// the same rows.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "catalogue/methods/catalogue.hpp"
#include "catalogue/methods/choice/chosen_methods.hpp"
#include "results/baseline.hpp"

namespace hmax {

/// A run of the suite.
struct AccuracyCase {
  std::size_t problem = 0;  ///< index into AccuracyPlan::problems
  Method method;
  RunSpec spec;
  std::string setting;
};

struct AccuracyPlan {
  std::vector<Problem> problems;
  std::vector<AccuracyCase> cases;
  std::vector<LeftOut> left_out;  ///< methods without a case
};

/// The whole suite, or the cases of some methods (names of choose_methods) and of methods of users.
AccuracyPlan accuracy_plan(const std::vector<std::string>& methods = {"all"},
                           const std::vector<Method>& own = {});

/// Runs it on all cores. Rows are in the order of the plan.
/// @param progress  called by the calling thread with the share that is done and the name of a case; may
/// throw
///                  to end the suite
std::vector<AccuracyRow> run_accuracy_suite(
    const AccuracyPlan& plan, const std::function<void(double, const std::string&)>& progress = {});

}  // namespace hmax
