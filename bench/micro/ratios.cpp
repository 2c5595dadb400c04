#include "bench/micro/ratios.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>

#include <fmt/format.h>

namespace hmax::micro {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

using Statistic = double (*)(std::vector<double>);
double least(std::vector<double> v) { return v.empty() ? nan : *std::min_element(v.begin(), v.end()); }
double median(std::vector<double> v) {
  if (v.empty()) return nan;
  const auto middle = v.begin() + static_cast<std::ptrdiff_t>(v.size() / 2);
  std::nth_element(v.begin(), middle, v.end());
  return *middle;
}

/// The measurements of one engine, by setting.
using Curve = std::vector<const Measurement*>;

double time_per_step(const Curve& curve, Statistic statistic) {
  const Measurement& m = *curve.front();
  return statistic(m.seconds) / m.steps;
}

/// Time at a given global error: a straight line in log-log through the settings whose errors lie within a
/// factor 10^0.75, because the error of single runs scatters around its trend. NaN when they do not enclose
/// it.
double time_at(const Curve& curve, double error, Statistic statistic) {
  constexpr double reach = 0.75;
  double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
  bool below = false, above = false;
  for (const Measurement* m : curve) {
    const double x = std::log10(m->error / error);
    const double y = std::log(statistic(m->seconds));
    if (!(std::abs(x) <= reach) || !std::isfinite(y)) continue;
    (x < 0 ? below : above) = true;
    n += 1, sx += x, sy += y, sxx += x * x, sxy += x * y;
  }
  if (!below || !above || n < 3) return nan;
  const double slope = (n * sxy - sx * sy) / (n * sxx - sx * sx);
  return std::exp((sy - slope * sx) / n);
}

struct Best {
  std::string name = "nothing";
  double time = nan;
};

Best fastest(const std::map<std::string, Curve>& curves, const std::function<double(const Curve&)>& time) {
  Best best;
  for (const auto& [name, curve] : curves)
    if (const double t = time(curve); !(t >= best.time) && t > 0) best = {name, t};
  return best;
}

struct Goal {
  Task task;
  std::string title;
  double ratio;
};
const std::vector<Goal> goals{{Task::rk4_fixed, "RK4, fixed step", 1.05},
                              {Task::dormand_prince_fixed, "Dormand-Prince, fixed step", 0.95},
                              {Task::order_8_fixed, "order 8, fixed step", nan},
                              {Task::dormand_prince_adaptive, "Dormand-Prince, adaptive", 0.9},
                              {Task::order_8_adaptive, "order 8, adaptive", 1.0}};

bool is_fixed(Task task) {
  return task == Task::rk4_fixed || task == Task::dormand_prince_fixed || task == Task::order_8_fixed;
}

}  // namespace

std::string ratio_table(const std::vector<Measurement>& measurements) {
  std::string text =
      "| task | hmax | time | Odeint, model as written | ratio | rearranged | ratio | and flattened | ratio "
      "| goal |\n"
      "| --- | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |\n";
  for (const Goal& goal : goals) {
    std::map<std::string, std::map<std::string, Curve>> sides;
    for (const Measurement& m : measurements)
      if (m.engine.task == goal.task) sides[m.engine.side][m.engine.name].push_back(&m);
    const auto row = [&](const std::string& title, const char* unit, double scale, auto&& time) {
      const auto of_side = [&](const std::string& side, Statistic s) {
        return fastest(sides[side], [&time, s](const Curve& c) { return time(c, s); });
      };
      const Best own = of_side("hmax", median), own_least = of_side("hmax", least);
      if (std::isnan(own.time)) return;
      text += fmt::format("| {} | {} | {:.1f} {} |", title, own.name, own.time * scale, unit);
      for (const char* side : {"odeint, as written", "odeint, rearranged", "odeint, flattened"}) {
        const Best theirs = of_side(side, median);
        text += fmt::format(" {:.1f} {} | **{:.2f}** ({:.2f}) |", theirs.time * scale, unit,
                            own.time / theirs.time, own_least.time / of_side(side, least).time);
      }
      text += std::isnan(goal.ratio) ? " |\n" : fmt::format(" {:.2f} |\n", goal.ratio);
    };
    if (is_fixed(goal.task)) {
      row(goal.title, "ns/step", 1e9, time_per_step);
    } else {
      for (int decade = 4; decade <= 12; ++decade)
        row(fmt::format("{}, error 1e-{}", goal.title, decade), "us", 1e6,
            [&](const Curve& c, Statistic s) { return time_at(c, std::pow(10.0, -decade), s); });
    }
  }
  return text + "\nTimes are medians; ratios are of medians, in brackets of the least times.\n";
}

}  // namespace hmax::micro
