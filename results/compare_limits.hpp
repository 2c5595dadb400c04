/// Whether limits of the step differ between two stores.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "results/limit_row.hpp"

namespace hmax {

/// A limit that is not the same in both.
struct LimitChange {
  std::string name;                  ///< as limit_name()
  std::vector<std::string> changes;  ///< "h_max: 0.1 -> 0.2"
};

/// The name of a limit where stores are compared: problem, material, parameters, state, path and method.
std::string limit_name(const LimitRow& row);

struct LimitComparison {
  std::size_t compared = 0;  ///< limits in both
  std::vector<LimitChange> changed;
  std::vector<std::string> only_in_a, only_in_b;
};

/// Limits of the same problem, state, path and method. A changed bound or verdict is a change; predicted
/// numbers are compared to 1e-6 relative, observed ones to 1e-3, since another processor moves their last
/// digits. Where a store has several models of one name, the one that was computed last counts.
LimitComparison compare_limits(std::span<const LimitRow> a, std::span<const LimitRow> b);

}  // namespace hmax
