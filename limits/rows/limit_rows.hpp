/// Predictions as rows that are stored, exported and shown.
#pragma once

#include <string>
#include <vector>

#include "limits/along/trajectory_limit.hpp"
#include "limits/point/operating_point.hpp"
#include "limits/point/prediction.hpp"
#include "results/limit_row.hpp"
#include "results/store.hpp"

namespace hmax {

/// The key of the state that is asked for.
/// @param path   motion | load, or empty
/// @param t_end  of that motion [s]; 0 without one
OperatingPointKey operating_point_key(const Problem& problem, AskedState asked, std::string path,
                                      double t_end);

/// A prediction with all that is a number or a word of it; LimitRow::point and LimitRow::details are left.
/// @param verified  whether runs were asked for
LimitRow limit_row(const Prediction& prediction, bool verified = false);

/// Puts the limit along a path into its row.
/// @param note  why the path ends early; may be empty
void add_path(LimitRow& row, const TrajectoryLimit& along, const std::string& note);
/// Puts the limit of runs from the start into its row.
void add_start(LimitRow& row, const StartLimit& limit);

/// What a stored limit must have to answer a question.
struct WantedLimit {
  bool verified = false;    ///< runs on both sides, where there is something to run
  bool from_start = false;  ///< runs from the start of the motion
  bool details = false;     ///< the margins of the modes
};

/// The limits near this state that the store has from this very program and that answer the question; others
/// are to be computed again.
std::vector<LimitRow> stored_limits(const Store& store, const OperatingPointKey& key,
                                    const WantedLimit& wanted);

}  // namespace hmax
