/// How the time of work grows with its size, on any machine.
#pragma once

#include <algorithm>
#include <ctime>
#include <limits>

namespace hmax {

/// The least CPU time of `work(4 n)` over that of `work(n)`, of three runs of each in turn: some 4 where the
/// time is proportional to the size, 16 where each part meets each.
template <class Work>
double growth_of_time(const Work& work, int n) {
  constexpr double none = std::numeric_limits<double>::infinity();
  double small = none, large = none;
  const auto time = [&](double& least, int size) {
    const std::clock_t begun = std::clock();
    work(size);
    least = std::min(least, static_cast<double>(std::clock() - begun));
  };
  for (int run = 0; run < 3; ++run) {
    time(small, n);
    time(large, 4 * n);
  }
  return large / std::max(small, 1.0);
}

}  // namespace hmax
