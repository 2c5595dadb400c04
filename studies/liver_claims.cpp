#include "studies/liver_claims.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "catalogue/methods/catalogue.hpp"
#include "catalogue/models/problems.hpp"
#include "catalogue/models/series.hpp"
#include "problems/oscillator/liver_problems.hpp"

namespace hmax {

namespace {

/// The points of a motion every 10 ms.
struct Motion {
  std::vector<double> t, x, v, a;
};

Motion motion_of(const OscillatorParameters& p, const Eigen::Vector2d& y0, double t_end) {
  Table table = motion(forced_liver(p, y0), find_method("dop_853"), 1e-10, t_end, 0.01);
  auto& columns = table.values;
  return {std::move(columns[0]), std::move(columns[1]), std::move(columns[2]), std::move(columns[3])};
}

double damping_ratio(const OscillatorParameters& p) { return p.c / (2 * std::sqrt(p.k1 * p.m)); }

double largest(const std::vector<double>& values) {
  double most = 0;
  for (const double value : values) most = std::max(most, std::abs(value));
  return most;
}

/// The first instant after which |x| stays below a twentieth of its largest [s]; infinity where it does not.
double settling_time(const Motion& motion) {
  const double bound = 0.05 * largest(motion.x);
  std::size_t last = motion.x.size();
  while (last > 0 && std::abs(motion.x[last - 1]) < bound) --last;
  return last == motion.x.size() ? std::numeric_limits<double>::infinity() : motion.t[last];
}

/// How often x changes its sign before it has settled.
int crossings(const Motion& motion) {
  const double end = settling_time(motion);
  int count = 0;
  for (std::size_t i = 1; i < motion.x.size() && motion.t[i] < end; ++i)
    if (motion.x[i] * motion.x[i - 1] < 0) ++count;
  return count;
}

/// The amplitude over the last period of the force.
double lasting(const std::vector<double>& values, const OscillatorParameters& p) {
  const auto period = static_cast<std::size_t>(2 * std::numbers::pi / p.w / 0.01);
  const auto from = values.end() - static_cast<std::ptrdiff_t>(std::min(values.size(), period));
  const auto [low, high] = std::minmax_element(from, values.end());
  return (*high - *low) / 2;
}

/// x(t) between the points.
double displacement_at(const Motion& motion, double t) {
  const double place = t / 0.01;
  const auto i = std::min(static_cast<std::size_t>(place), motion.x.size() - 2);
  const double share = place - static_cast<double>(i);
  return (1 - share) * motion.x[i] + share * motion.x[i + 1];
}

/// The distance of two motions at the instant t, relative to that at the start, in x and v.
double distance_left(const Motion& a, const Motion& b, double t) {
  const auto at = [&](std::size_t i) { return std::hypot(a.x[i] - b.x[i], a.v[i] - b.v[i]); };
  return at(static_cast<std::size_t>(std::lround(t / 0.01))) / at(0);
}

bool ascends(const std::vector<double>& values) { return std::ranges::is_sorted(values, std::less<>()); }
bool descends(const std::vector<double>& values) { return std::ranges::is_sorted(values, std::greater<>()); }

/// One number of each member of a family.
template <class Measure>
std::vector<double> of_each(const LiverFamily& family, double t_end, const Measure& measure) {
  std::vector<double> numbers;
  for (const LiverFamilyMember& member : family.members)
    numbers.push_back(measure(motion_of(member.parameters, family.y0, t_end)));
  return numbers;
}

std::vector<double> damping_ratios(const LiverFamily& family) {
  std::vector<double> ratios;
  for (const LiverFamilyMember& member : family.members) ratios.push_back(damping_ratio(member.parameters));
  return ratios;
}

// Long enough for the least damped of the linear models to settle.
constexpr double settled_by = 200;  // [s]

Claims always_settles() {
  std::vector<double> ratios, times;
  for (const char* id : {"linear_mass", "linear_stiffness", "linear_damping"}) {
    const LiverFamily& family = liver_family(id);
    for (const double ratio : damping_ratios(family)) ratios.push_back(ratio);
    for (const double time : of_each(family, settled_by, settling_time)) times.push_back(time);
  }
  OscillatorParameters other = liver_problem("liver_linear").parameters;
  const double critical = 2 * std::sqrt(other.k1 * other.m);
  // The largest displacement of the second half of a minute over that of the first.
  const auto peak_ratio = [&](double c) {
    other.c = c;
    const Motion motion = motion_of(other, {0.5, 1}, 60);
    const auto half = motion.x.begin() + static_cast<std::ptrdiff_t>(motion.x.size() / 2);
    return largest({half, motion.x.end()}) / largest({motion.x.begin(), half});
  };
  const double undamped = peak_ratio(0), growing = peak_ratio(-0.2);
  other.c = 2 * critical;
  const int swings = crossings(motion_of(other, {0.5, 1}, 60));
  const double slowest = *std::ranges::max_element(times);
  return {{"judgement", judged(undamped < 0.95 && growing < 0.95 && swings > 0, std::isfinite(slowest))},
          {"models", times.size()},
          {"slowest", slowest},
          {"least_ratio", *std::ranges::min_element(ratios)},
          {"largest_ratio", *std::ranges::max_element(ratios)},
          {"critical", critical},
          {"undamped", undamped},
          {"growing", growing},
          {"overdamped", 2 * critical},
          {"swings", swings}};
}

Claims claims_on_linear() {
  const LiverFamily &masses = liver_family("linear_mass"), &stiffnesses = liver_family("linear_stiffness"),
                    &dampings = liver_family("linear_damping");
  const auto peak = [](const Motion& motion) { return largest(motion.x); };
  const auto swing = [](const Motion& motion) { return static_cast<double>(crossings(motion)); };
  const std::vector<double> by_mass = of_each(masses, settled_by, settling_time),
                            by_damping = of_each(dampings, settled_by, settling_time),
                            by_stiffness = of_each(stiffnesses, settled_by, settling_time),
                            peaks = of_each(stiffnesses, 30, peak),
                            swings = of_each(dampings, settled_by, swing);
  const Motion least = motion_of(dampings.members.front().parameters, {0.5, 1}, 30);
  const double left = largest({least.x.end() - 700, least.x.end()}) / largest(least.x);
  return {{"always_settles", always_settles()},
          {"mass_prolongs",
           {{"judgement", judged(ascends(by_mass), by_mass.back() > by_mass.front())}, {"times", by_mass}}},
          {"stiffness_lowers",
           {{"judgement", judged(descends(peaks))}, {"peaks", peaks}, {"times", by_stiffness}}},
          {"damping_stops", {{"judgement", judged(descends(by_damping))}, {"times", by_damping}}},
          {"least_damping_swings", {{"judgement", judged(descends(swings))}, {"swings", swings}}},
          {"never_rests",
           {{"judgement", judged(std::isinf(by_damping.front()), left > 0.05)},
            {"left", left},
            {"time", by_damping.front()}}}};
}

/// The part of the points of an orbit at which the phase point turns clockwise about the origin: x v' - v x'
/// < 0.
double clockwise_share(const Motion& motion) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < motion.x.size(); ++i)
    if (motion.x[i] * motion.a[i] - motion.v[i] * motion.v[i] < 0) ++count;
  return static_cast<double>(count) / static_cast<double>(motion.x.size());
}

/// With critical damping and with twice as much: the share of the largest displacement that is left, and that
/// of clockwise motion.
Claims claims_on_figure_5() {
  std::array<double, 2> left{}, clockwise{1, 1};
  for (const std::size_t i : {0U, 1U}) {
    const LiverFamily family = damped_as_at_rest(liver_family("cubic_stiffness"), i == 0 ? 1 : 2);
    for (const LiverFamilyMember& member : family.members) {
      const Motion motion = motion_of(member.parameters, family.y0, family.t_end);
      left[i] = std::max(left[i], std::abs(motion.x.back()) / largest(motion.x));
      clockwise[i] = std::min(clockwise[i], clockwise_share(motion));
    }
  }
  return {{"damped_is_stable",
           {{"judgement", judged(left[0] < 0.05 && left[1] < 0.05)},
            {"t_end", liver_family("cubic_stiffness").t_end},
            {"critical", left[0]},
            {"overdamped", left[1]}}},
          {"clockwise",
           {{"judgement", judged(clockwise[0] > 0.999 && clockwise[1] > 0.999, clockwise[0] > 0.999)},
            {"critical", clockwise[0]},
            {"overdamped", clockwise[1]}}}};
}

/// x(t_end) of the cubic family with its damping, relative to the largest of the first ten seconds.
std::vector<double> growth_of_cubic() {
  return of_each(liver_family("cubic_damping"), 80, [](const Motion& motion) {
    return largest({motion.x.end() - 1000, motion.x.end()}) /
           largest({motion.x.begin(), motion.x.begin() + 1000});
  });
}

Claims claims_on_cubic() {
  const std::vector<double> growth = growth_of_cubic();
  const OscillatorParameters& stiff = liver_family("cubic_damping").members.back().parameters;
  const double root = std::sqrt(stiff.c * stiff.c - 4 * stiff.k1 * stiff.m);
  return {
      {"negative_damping", {{"judgement", judged(growth[0] > 1.05)}, {"growth", growth[0]}}},
      {"no_damping", {{"judgement", judged(false, std::abs(growth[1] - 1) < 0.01)}, {"growth", growth[1]}}},
      {"damping_of_2", {{"judgement", judged(growth[2] < 0.05)}, {"growth", growth[2]}}},
      {"damping_of_10",
       {{"judgement", judged(!(growth[3] < 1))},
        {"slow", (-stiff.c + root) / (2 * stiff.m)},
        {"fast", (-stiff.c - root) / (2 * stiff.m)},
        {"growth", growth[3]}}}};
}

Claims claims_on_force() {
  const LiverFamily& family = liver_family("forced_amplitude");
  constexpr double t_end = 200;
  std::vector<double> left, v, a, off, apart;
  for (const LiverFamilyMember& member : family.members) {
    const OscillatorParameters& p = member.parameters;
    const Motion motion = motion_of(p, family.y0, t_end);
    left.push_back(distance_left(motion, motion_of(p, {0, 0}, t_end), 5));
    v.push_back(lasting(motion.v, p));
    a.push_back(lasting(motion.a, p));
    const double before = displacement_at(motion, t_end - 2 * std::numbers::pi / p.w);
    off.push_back(std::abs(motion.x.back() - before) / lasting(motion.x, p));
    for (const Eigen::Vector2d& start :
         {Eigen::Vector2d(0, 0), Eigen::Vector2d(-2, 0), Eigen::Vector2d(2, -2)})
      apart.push_back(distance_left(motion, motion_of(p, start, t_end), 40));
  }
  const double zeta = damping_ratio(family.members.front().parameters);
  const double farthest = *std::ranges::max_element(apart);
  return {
      {"forced_critically",
       {{"judgement", judged(zeta == 1, zeta > 0.95 && *std::ranges::max_element(left) < 0.1)},
        {"ratio", zeta},
        {"left", left}}},
      {"forced_periodically", {{"judgement", judged(*std::ranges::max_element(off) < 0.01)}, {"off", off}}},
      {"force_enlarges",
       {{"judgement", judged(v[1] > v[0] && a[1] > a[0])},
        {"v_ratio", v[1] / v[0]},
        {"v", v},
        {"a_ratio", a[1] / a[0]},
        {"a", a}}},
      {"forced_converges", {{"judgement", judged(false, farthest < 0.01)}, {"farthest", farthest}}}};
}

Claims claims_on_benchmark() {
  const LiverFamily &free = liver_family("benchmark_unforced"), &forced = liver_family("benchmark_forced");
  std::vector<double> left, lasts;
  for (const LiverFamilyMember& member : free.members)
    left.push_back(
        distance_left(motion_of(member.parameters, free.y0, 2), motion_of(member.parameters, {0, 0}, 2), 1));
  const std::vector<double> settle = of_each(free, 60, settling_time), ratios = damping_ratios(free);
  for (const LiverFamilyMember& member : forced.members)
    lasts.push_back(lasting(motion_of(member.parameters, forced.y0, 100).x, member.parameters));
  const auto [low, high] = std::ranges::minmax(ratios);
  const auto [least_left, most_left] = std::ranges::minmax(left);
  const bool rests = std::isfinite(*std::ranges::max_element(settle)), swings = std::ranges::min(lasts) > 0;
  return {
      {"benchmark_critically",
       {{"judgement", judged(most_left < 0.05 && low > 0.9 && high < 1.2)},
        {"low", low},
        {"high", high},
        {"least", least_left},
        {"most", most_left}}},
      {"benchmark_rests", {{"judgement", judged(rests && swings)}, {"times", settle}, {"lasting", lasts}}},
      {"benchmark_is_overdamped",
       {{"judgement", Judged::does_not_hold},
        {"overdamped", std::ranges::count_if(ratios, [](double zeta) { return zeta > 1; })}}}};
}

}  // namespace

Problem forced_liver(const OscillatorParameters& parameters, const Eigen::Vector2d& y0) {
  ProblemSettings settings{.y0 = {y0[0], y0[1]}};
  for (const auto& [name, value] : oscillator_parameter_names)
    settings.parameters.emplace_back(std::string(name), parameters.*value);
  return make_problem("liver_forced", settings);
}

std::string_view judged(bool whole, bool in_part) {
  return whole ? Judged::holds : in_part ? Judged::holds_in_part : Judged::does_not_hold;
}

Claims counts_of(const Claims& claims) {
  const auto count = [&](std::string_view judgement) {
    return std::ranges::count(claims, Claims(judgement),
                              [](const Claims& claim) { return claim["judgement"]; });
  };
  return {{"sentences", claims.size()},
          {"hold", count(Judged::holds)},
          {"hold_in_part", count(Judged::holds_in_part)},
          {"do_not_hold", count(Judged::does_not_hold)}};
}

Claims claims_on_motion() {
  Claims claims;
  for (const Claims& part : {claims_on_linear(), claims_on_figure_5(), claims_on_cubic(), claims_on_force(),
                             claims_on_benchmark()})
    claims.update(part);
  return claims;
}

}  // namespace hmax
