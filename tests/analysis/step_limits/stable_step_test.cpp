#include "analysis/step_limits/stable_step.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "catalogue/methods/catalogue.hpp"

namespace hmax {
namespace {

// Of a method that chooses its stages by the spectral radius exits are sampled. What is sought alone, the
// least, is that of all; those that are found besides are no other than theirs.
TEST(LargestStableStep, IsTheSameWhereTheLeastExitAloneIsSought) {
  for (const double alpha : {0.5, 4.0, 60.0}) {
    std::vector<Eigenmode> modes;
    for (const double omega : {1.0, 3.0, 10.0, 31.0, 100.0, 310.0, 1000.0}) {
      const Complex lambda(-alpha / 2, std::sqrt(std::max(1e-6, omega * omega - alpha * alpha / 4)));
      modes.emplace_back(lambda).radius = 1100;
    }
    for (const char* method : {"rkc_2", "rkl_2", "rk4"}) {
      const Amplification& amplification = *find_method(method).amplification;
      const StepLimit all = largest_stable_step(amplification, modes),
                      least = largest_stable_step(amplification, modes, Exits::least);
      EXPECT_EQ(least.h_max, all.h_max) << method << " " << alpha;
      EXPECT_EQ(least.limiting, all.limiting) << method << " " << alpha;
      ASSERT_EQ(least.of_modes.size(), modes.size());
      for (std::size_t i = 0; i < modes.size(); ++i) {
        if (!std::isfinite(least.of_modes[i])) continue;
        EXPECT_EQ(least.of_modes[i], all.of_modes[i]) << method << " " << alpha << " " << i;
      }
    }
  }
}

}  // namespace
}  // namespace hmax
