/// An attempt may be repeated with another step, and its interpolant may be asked for between.
#pragma once

#include <cstring>
#include <initializer_list>

#include <gtest/gtest.h>

#include "integrators/stepper.hpp"

namespace hmax {

/// Rejected attempts of a size of `rejected`, one before every step of 0.1 and looked into before every
/// other, leave no trace in the state after `steps` of them, to the last bit.
template <class StepperT, class Sys, class State>
void expect_no_trace_of_rejected_attempts(const StepperT& fresh, const Sys& system, const State& start,
                                          std::initializer_list<double> rejected, int steps = 3) {
  const auto end_of = [&](double h) {
    StepperT stepper = fresh;
    State y = start, y_new = start, other = start;
    stepper.init(system, 0, y);
    for (int n = 0; n < steps; ++n) {
      const double t = 0.1 * n;
      if (h > 0 && stepper.attempt(system, t, y, h, other) == StepStatus::ok && n % 2 == 1)
        stepper.interpolate(system, t, h, y, other, 0.4, y_new);
      EXPECT_EQ(stepper.attempt(system, t, y, 0.1, y_new), StepStatus::ok);
      stepper.accept(y_new);
      y = y_new;
    }
    return y;
  };
  const State undisturbed = end_of(0);
  for (const double h : rejected) {
    const State y = end_of(h);
    EXPECT_EQ(std::memcmp(y.data(), undisturbed.data(), static_cast<std::size_t>(y.size()) * sizeof y[0]), 0)
        << h;
  }
}

}  // namespace hmax
