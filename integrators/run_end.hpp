/// How a run ended.
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

#include "integrators/control.hpp"
#include "integrators/stats.hpp"
#include "integrators/stepper.hpp"

namespace hmax {

/// How a run ended: at time t, or diverged at time t (the last admissible state is kept).
template <class Real>
struct RunEnd {
  Outcome outcome;  ///< why the run ended
  Real t{};         ///< where it ended or failed
  Stats stats;      ///< steps, rejected and the work of implicit methods; Counted<System> counts evaluations
  std::string_view note{};  ///< why equations were not solved; a foreign engine's own words for a failure
  Real t_state = t;         ///< of the state that is kept: before t where the run diverged
};

/// The note of an adaptive run that fails where f(t, y) is not continuous in t.
inline constexpr std::string_view jump_note = "the right-hand side jumps in time here";

/// For engines that step forwards only.
/// @throws std::invalid_argument  where the span runs backwards
/// @param engine  its name, the subject of the message
template <class Real>
void expect_forwards(Span<Real> span, std::string_view engine) {
  if (span.t_end < span.t0)
    throw std::invalid_argument(std::string(engine) +
                                " runs forwards only: give an end time that is not before the start, or a "
                                "method of hmax");
}

}  // namespace hmax
