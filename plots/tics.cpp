#include "plots/tics.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

namespace hmax {

namespace {

/// Width and, with the space around it, height of a label of an axis.
constexpr double tic_character = 6.8, tic_height = 30, tic_gap = 12;

/// The step of a linear axis, 1, 2 or 5 times a power of ten, the least whose labels have room beside each
/// other.
double linear_step(const Range& range, double length) {
  const double span = range.high - range.low;
  if (!(span > 0)) return 1;
  for (double power = std::pow(10, std::floor(std::log10(span / length)));; power *= 10)
    for (const double step : {power, 2 * power, 5 * power}) {
      std::size_t longest = 0;
      const double last = std::floor(range.high / step);
      if (last - std::ceil(range.low / step) > length / tic_gap) continue;
      for (double k = std::ceil(range.low / step); k <= last; ++k)
        longest = std::max(longest, fmt::format("{:g}", k * step).size());
      if (step / span * length >= tic_character * static_cast<double>(longest) + tic_gap) return step;
    }
}

}  // namespace

std::string tics(char axis_name, const Axis& axis, const Range& range, double length) {
  const bool across = axis_name == 'x';
  const std::string text = fmt::format("set {}tics out scale 0.5 nomirror ", axis_name);
  // The default format shows as many digits as the ends of the range have.
  if (!axis.logarithmic)
    return fmt::format("set format {} '%g'\n{}{}\n", axis_name, text,
                       across ? fmt::format("{:g}", linear_step(range, length)) : "autofreq");
  const double low = std::log10(range.low) - 1e-9, high = std::log10(range.high) + 1e-9;
  const int first = static_cast<int>(std::floor(low)), last = static_cast<int>(std::floor(high));
  const double most = length / (across ? 45 : tic_height);
  const int step = std::max(1, static_cast<int>(std::ceil((last - first + 1) / most)));
  std::vector<int> multiples{1};
  if (high - low < 2) {
    const double decade = length / (high - low), room = across ? 48 : tic_height;
    multiples = std::log10(2.0) * decade >= room   ? std::vector{1, 2, 5}
                : std::log10(3.0) * decade >= room ? std::vector{1, 3}
                                                   : multiples;
  }
  std::string list;
  for (int power = first; power <= last; ++power)
    for (const int multiple : multiples) {
      const double at = std::log10(multiple) + power;
      if (at < low || at > high) continue;
      const std::string factor = multiple == 1 ? "" : fmt::format("{}·", multiple);
      const bool labelled = power % step == 0;
      list += fmt::format("{}'{}' {}e{}{}", list.empty() ? "" : ", ",
                          labelled ? fmt::format("{}10^{{{}}}", factor, power) : "", multiple, power,
                          labelled ? "" : " 1");
    }
  return text + "(" + list + ")\n";
}

std::string drawn_range(char axis_name, const Axis& axis, const Range& range) {
  const double wider = axis.logarithmic ? 1e-9 : 0;
  return fmt::format("set {}range [{}:{}]\n", axis_name, range.low * (1 - wider), range.high * (1 + wider));
}

}  // namespace hmax
