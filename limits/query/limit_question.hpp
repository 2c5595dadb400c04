/// What is asked about the step limits of models.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "catalogue/methods/method.hpp"
#include "limits/by_steps/step_map.hpp"
#include "limits/point/operating_point.hpp"

namespace hmax {

struct LimitQuestion {
  AskedState at = AskedState::equilibrium;
  bool verify = false;           ///< integrate on both sides of each limit
  std::string path = {};         ///< also along: motion | load; empty for one state alone
  bool path_by_default = false;  ///< nobody named it
  double run_steps = 0;  ///< of the runs from the start of a motion that show which step is safe, for each
                         ///< method; 0: none are made
  std::optional<double> t_end = std::nullopt;  ///< of that motion, as users count time [s]; nothing:
                                               ///< end_of_motion()
  std::optional<StepChoices> options = {};     ///< of linearly implicit methods; nothing: nobody asked
  std::vector<std::string> named = {};  ///< methods that were asked for one by one, not by family or all

  /// The end of that motion, as runs count time.
  [[nodiscard]] double end_of(const Problem& problem) const;
  /// Whether a path that is not found is an error: somebody named it, or an end of the motion.
  [[nodiscard]] bool requires_path() const { return !path_by_default || t_end.has_value(); }
  /// Whether a limit may be sought in the steps of a method, which takes minutes on large models.
  [[nodiscard]] bool seeks_in_steps(const Method& method, const Problem& problem) const;
};

/// The question with the path that is looked along where nobody says: loads of bodies and matrices that
/// change with time, and other models that are not known to be linear, are looked at along the motion unless
/// the state at rest or options of steps are asked for. Runs from the start of a motion, some hundred, are
/// made of models of few states, and some thousand where --verify asks for them; of bodies and large models
/// only where that and the motion were asked for.
/// @param path  motion | load | none; empty where nobody says
/// @throws InputError  for an end of a motion that is not looked at
LimitQuestion with_path(LimitQuestion question, const std::string& path, const Problem& problem);

/// Ids of the methods that `names` has by id or alias, not by a family or "all".
std::vector<std::string> named_one_by_one(const std::vector<std::string>& names,
                                          const std::vector<Method>& methods);

}  // namespace hmax
