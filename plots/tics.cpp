#include "plots/tics.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
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

/// Labels of 1, 2 and 5 times a power of ten, or of 1 and 3 times, that have room where a decade has so many
/// pixels; 2 and 5 without labels where not even the latter have.
struct Multiple {
  int factor;
  bool labelled = true;
};
std::vector<Multiple> multiples_of(double decade, bool across) {
  const double room = across ? 48 : tic_height;
  if (std::log10(2.0) * decade >= room) return {{1}, {2}, {5}};
  if (std::log10(3.0) * decade >= room) return {{1}, {3}};
  return {{1}, {2, false}, {5, false}};
}

/// Tics of a logarithmic axis in equal steps, where its range is so short that no two of its powers and their
/// multiples are in it; empty where these have no room.
std::string short_axis_tics(const Range& range, double length, double room) {
  const double decade = length / std::log10(range.high / range.low);
  const double first_power = std::pow(10, std::floor(std::log10(range.high - range.low)) - 1);
  for (double power = first_power; power <= range.high; power *= 10)
    for (const double step : {power, 2 * power, 5 * power}) {
      const double last = std::floor(range.high / step + 1e-9), first = std::ceil(range.low / step - 1e-9);
      if (last - first < 1) return {};
      if (decade * std::log10(last / (last - 1)) < room) continue;  // the narrowest two
      std::string list;
      for (double k = first; k <= last; ++k)
        list += fmt::format("{}'{:g}' {:g}", list.empty() ? "" : ", ", k * step, k * step);
      return list;
    }
  return {};
}

/// Tics of a logarithmic axis, and how many of them have labels.
std::pair<std::string, int> logarithmic_tics(const Range& range, double length, bool across) {
  const double low = std::log10(range.low) - 1e-9, high = std::log10(range.high) + 1e-9;
  const int first = static_cast<int>(std::floor(low)), last = static_cast<int>(std::floor(high));
  const double most = length / (across ? 45 : tic_height);
  const int step = std::max(1, static_cast<int>(std::ceil((last - first + 1) / most)));
  const std::vector<Multiple> multiples =
      high - low < 2 ? multiples_of(length / (high - low), across) : std::vector<Multiple>{{1}};
  std::string list;
  int labels = 0;
  for (int power = first; power <= last; ++power)
    for (const auto& [multiple, has_label] : multiples) {
      const double at = std::log10(multiple) + power;
      if (at < low || at > high) continue;
      const std::string factor = multiple == 1 ? "" : fmt::format("{}·", multiple);
      const bool labelled = has_label && power % step == 0;
      labels += labelled;
      list += fmt::format("{}'{}' {}e{}{}", list.empty() ? "" : ", ",
                          labelled ? fmt::format("{}10^{{{}}}", factor, power) : "", multiple, power,
                          labelled ? "" : " 1");
    }
  return {std::move(list), labels};
}

}  // namespace

std::string tics(char axis_name, const Axis& axis, const Range& range, double length) {
  const bool across = axis_name == 'x';
  const std::string text = fmt::format("set {}tics out scale 0.5 nomirror ", axis_name);
  if (!axis.names.empty()) {
    // The names themselves are labels: those of tics cannot have underscores.
    std::string places;
    for (std::size_t i = 0; i < axis.names.size(); ++i)
      places += fmt::format("{}'' {}", i == 0 ? "" : ", ", i + 1);
    return text + "(" + places + ")\n";
  }
  // The default format shows as many digits as the ends of the range have.
  if (!axis.logarithmic)
    return fmt::format("set format {} '%g'\n{}{}\n", axis_name, text,
                       across ? fmt::format("{:g}", linear_step(range, length)) : "autofreq");
  auto [list, labels] = logarithmic_tics(range, length, across);
  if (labels < 2)
    if (std::string equal = short_axis_tics(range, length, across ? 60 : tic_height); !equal.empty())
      list = std::move(equal);
  return text + "(" + list + ")\n";
}

double overhang(const Axis& axis, const Range& range, double length) {
  if (axis.logarithmic || !axis.names.empty() || !(range.high > range.low)) return 0;
  const double step = linear_step(range, length), last = step * std::floor(range.high / step + 1e-9);
  const double half = tic_character / 2 * static_cast<double>(fmt::format("{:g}", last).size());
  return std::max(0.0, half - (range.high - last) / (range.high - range.low) * length);
}

std::string drawn_range(char axis_name, const Axis& axis, const Range& range) {
  const double wider = axis.logarithmic ? 1e-9 : 0;
  return fmt::format("set {}range [{}:{}]\n", axis_name, range.low * (1 - wider), range.high * (1 + wider));
}

}  // namespace hmax
