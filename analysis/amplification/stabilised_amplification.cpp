#include "analysis/amplification/stabilised_amplification.hpp"

#include <array>

namespace hmax::detail {

/// `two` and `one` are the stages before the last and the last.
Complex stabilised_step(const StabilisedStages& stages, Complex z) {
  Complex two = 1, one = 1.0 + z * stages[0].mu_f;
  for (std::size_t j = 1; j < stages.size(); ++j) {
    const StabilizedStage<double>& c = stages[j];
    const Complex now = c.mu * one + c.nu * two + c.rest + z * (c.mu_f * one + c.gamma_f);
    two = std::exchange(one, now);
  }
  return one;
}

bool stabilised_grows_at_origin(const StabilisedStages& stages) {
  // R = 1 + z + z^2 / 2 + c_3 z^3 + c_4 z^4 + ..., so |R(iy)|^2 = 1 + (1/4 - 2 c_3 + 2 c_4) y^4 + O(y^6).
  using Series = std::array<double, 5>;
  const auto times_z = [](const Series& p) { return Series{0, p[0], p[1], p[2], p[3]}; };
  Series two{1}, one{1, stages[0].mu_f};
  for (std::size_t j = 1; j < stages.size(); ++j) {
    const StabilizedStage<double>& c = stages[j];
    const Series shifted = times_z(one);
    Series now{c.rest, c.gamma_f};
    for (std::size_t i = 0; i < now.size(); ++i)
      now[i] += c.mu * one[i] + c.nu * two[i] + c.mu_f * shifted[i];
    two = std::exchange(one, now);
  }
  // Re(R)^2 + Im(R)^2 with R(iy) = (1 - y^2/2 + c_4 y^4) + i (y - c_3 y^3): the y^2 terms cancel.
  return 0.25 - 2 * one[3] + 2 * one[4] > 0;
}

}  // namespace hmax::detail
