/// Predicted against observed step limits of every method on every model of the liver study.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "bench/timing/sweep.hpp"
#include "catalogue/methods/method.hpp"
#include "results/limit_row.hpp"
#include "results/store.hpp"

namespace hmax {

/// A model of the study.
struct LimitCase {
  std::string label;  ///< "male_slim:light", "forced, c = 10 N s/m"; each once
  std::string family;
  Problem problem;
  bool linear = true;
};

/// The six material sets at both ends of their masses, then every curve of the study's figures 2 to 7 with
/// numbers of its own.
std::vector<LimitCase> limit_cases();

struct StudyRow {
  std::size_t which;  ///< case
  LimitRow limit;     ///< verified; of cases that are not linear also along the motion and from its start
};

/// Which cases a study takes.
enum class CaseKind { linear, nonlinear };

/// Every method on every case of a kind that suits it, cases first, on all cores.
/// @param store  where rows are looked up and kept; nullptr for nowhere
/// @param progress  told the share that is done; from the calling thread
/// @param interrupted  asked between rows; rows that are finished are kept and returned, of motions whole
/// cases
/// @param shard  only every `count`-th row is looked at; all shards together are the study
std::vector<StudyRow> limit_study(const std::vector<LimitCase>& cases, CaseKind kind,
                                  const std::vector<Method>& methods, Store* store,
                                  const std::function<void(double)>& progress,
                                  const std::function<bool()>& interrupted, Shard shard = {});

}  // namespace hmax
