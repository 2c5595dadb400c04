#include "studies/liver_claims.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

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
  ProblemSettings settings;
  for (const auto& [name, value] : oscillator_parameter_names)
    settings.parameters.emplace_back(std::string(name), p.*value);
  settings.y0 = {y0[0], y0[1]};
  Table table = motion(make_problem("liver_forced", settings), find_method("dop_853"), 1e-10, t_end, 0.01);
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

std::string listed(const std::vector<double>& values, const char* unit) {
  std::vector<std::string> words;
  for (const double value : values)
    words.push_back(std::isfinite(value) ? fmt::format("{:.3g}", value) : "never");
  return fmt::format("{} {}", fmt::join(words, ", "), unit);
}

bool ascends(const std::vector<double>& values) { return std::ranges::is_sorted(values, std::less<>()); }
bool descends(const std::vector<double>& values) { return std::ranges::is_sorted(values, std::greater<>()); }

Judgement judged(bool holds, bool in_part = false) {
  return holds ? Judgement::holds : in_part ? Judgement::holds_in_part : Judgement::does_not_hold;
}

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

Claim always_settles() {
  std::vector<double> ratios, times;
  for (const char* id : {"linear_mass", "linear_stiffness", "linear_damping"}) {
    const LiverFamily& family = liver_family(id);
    for (const double ratio : damping_ratios(family)) ratios.push_back(ratio);
    for (const double time : of_each(family, settled_by, settling_time)) times.push_back(time);
  }
  OscillatorParameters other = liver_problem("liver_linear").parameters;
  const double critical = 2 * std::sqrt(other.k1 * other.m);
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
  return {
      "3.3 A",
      "no matter how large or small the value of the parameters, the system will always oscillate to a stabilized "
      "state",
      fmt::format(
          "The {} models that are drawn do, within {:.3g} s: damping ratios {:.3f} to {:.3f}. It needs "
          "0 < c < 2 sqrt(k m) = {:.3g} N s/m: with c = 0 the second half of a minute is {:.3g} times as "
          "large as the first, with c = -0.2 {:.3g} times, and with c = {:.3g} the displacement changes its "
          "sign {} times.",
          times.size(), slowest, *std::ranges::min_element(ratios), *std::ranges::max_element(ratios),
          critical, undamped, growing, 2 * critical, swings),
      judged(undamped < 0.95 && growing < 0.95 && swings > 0, std::isfinite(slowest))};
}

std::vector<Claim> claims_on_linear() {
  const std::vector<double> by_mass = of_each(liver_family("linear_mass"), settled_by, settling_time),
                            by_damping = of_each(liver_family("linear_damping"), settled_by, settling_time),
                            peaks = of_each(liver_family("linear_stiffness"), 30,
                                            [](const Motion&motion) { return largest(motion.x); }),
                            by_stiffness =
                                of_each(liver_family("linear_stiffness"), settled_by, settling_time),
                            swings = of_each(
                                liver_family("linear_damping"), settled_by,
                                [](const Motion&motion) { return static_cast<double>(crossings(motion)); });
  const Motion least = motion_of(liver_family("linear_damping").members.front().parameters, {0.5, 1}, 30);
  const double left = largest({least.x.end() - 700, least.x.end()}) / largest(least.x);
  return {
      always_settles(),
      {"3.3 A", "When the mass of the body is large, time taken to stop the oscillation is prolonged.",
       fmt::format("m = 1.2, 1.3, 1.4, 1.5 kg settle to 5 % after {}; the envelope is exp(-c t / (2 m)).",
                   listed(by_mass, "s")),
       judged(ascends(by_mass), by_mass.back() > by_mass.front())},
      {"3.3 A", "as the stiffness increases, the amplitude of the system decreases",
       fmt::format(
           "k = 4.6, 5.3, 6.0, 6.6 N/m reach {}. They settle to 5 % after {}: the envelope does not depend on k.",
           listed(peaks, "m"), listed(by_stiffness, "s")),
       judged(descends(peaks))},
      {"3.3 A", "the larger the damping coefficient, the system will stop oscillating faster",
       fmt::format(
           "c = 0.1, 0.3, 0.8, 1.0 N s/m settle to 5 % after {}. Above the critical damping the return becomes "
           "slower again.",
           listed(by_damping, "s")),
       judged(descends(by_damping))},
      {"3.3 A", "the lowest damping coefficient (c=0.1) oscillated the most",
       fmt::format("x changes its sign {} times before it has settled.",
                   listed(swings, "").substr(0, listed(swings, "").size() - 1)),
       judged(descends(swings))},
      {"3.3 A",
       "[with c=0.1] The body seems to displace to-and-fro position and never reach a resting point.",
       fmt::format("At t = 30 s {:.0f} % of the amplitude are left; 5 % are after {:.3g} s.", 100 * left,
                   by_damping.front()),
       judged(std::isinf(by_damping.front()), left > 0.05)}};
}

/// The part of the points of an orbit at which the phase point turns clockwise about the origin: x v' - v x'
/// < 0.
double clockwise_share(const Motion& motion) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < motion.x.size(); ++i)
    if (motion.x[i] * motion.a[i] - motion.v[i] * motion.v[i] < 0) ++count;
  return static_cast<double>(count) / static_cast<double>(motion.x.size());
}

std::vector<Claim> claims_on_figure_5() {
  std::array<double, 2> left{}, clockwise{1, 1};
  for (const std::size_t i : {0U, 1U}) {
    const LiverFamily family = damped_as_at_rest(liver_family("cubic_stiffness"), i == 0 ? 1 : 2);
    for (const LiverFamilyMember& member : family.members) {
      const Motion motion = motion_of(member.parameters, family.y0, family.t_end);
      left[i] = std::max(left[i], std::abs(motion.x.back()) / largest(motion.x));
      clockwise[i] = std::min(clockwise[i], clockwise_share(motion));
    }
  }
  return {
      {"3.3 B, figure 5",
       "even though the system is either critically damped (red) or overdamped (blue), the system is still stable",
       fmt::format(
           "After {:.3g} s at most {:.2g} % of the largest displacement are left with critical damping, "
           "{:.2g} % with twice as much: the phase point comes to rest at 0.",
           liver_family("cubic_stiffness").t_end, 100 * left[0], 100 * left[1]),
       judged(left[0] < 0.05 && left[1] < 0.05)},
      {"3.3 B, figure 5", "converging to zero in a clockwise direction",
       fmt::format(
           "x v' - v x' = -(m v² + c x v + k1 x² + k3 x⁴) / m is negative for all x and v as long as "
           "c² <= 4 k1 m: along the orbits {:.0f} % of the time with critical damping, {:.0f} % with twice as "
           "much, where the orbit ends along its slow direction.",
           100 * clockwise[0], 100 * clockwise[1]),
       judged(clockwise[0] > 0.999 && clockwise[1] > 0.999, clockwise[0] > 0.999)}};
}

/// x(t_end) of the cubic family with its damping, relative to the largest of the first ten seconds.
std::vector<double> growth_of_cubic() {
  return of_each(liver_family("cubic_damping"), 80, [](const Motion& motion) {
    return largest({motion.x.end() - 1000, motion.x.end()}) /
           largest({motion.x.begin(), motion.x.begin() + 1000});
  });
}

std::vector<Claim> claims_on_cubic() {
  const std::vector<double> growth = growth_of_cubic();
  const OscillatorParameters& stiff = liver_family("cubic_damping").members.back().parameters;
  const double root = std::sqrt(stiff.c * stiff.c - 4 * stiff.k1 * stiff.m);
  std::vector<Claim> claims = claims_on_figure_5();
  const auto ten_seconds = [&](std::size_t i) {
    return fmt::format(
        "The largest displacement of the last ten of 80 s is {:.2g} times that of the first ten", growth[i]);
  };
  claims.push_back({"3.3 B, figure 6(i)",
                    "[with c=-0.2] the direction field is diverged from zero [...] the system is instable",
                    ten_seconds(0) + "; the eigenvalues at 0 have positive real parts.",
                    judged(growth[0] > 1.05)});
  claims.push_back(
      {"3.3 B, figure 6(ii)",
       "When c= 0 [...] the system is unconditionally stable, however it is not pointing towards zero",
       ten_seconds(1) +
           ": a centre, stable in the sense of Lyapunov and not asymptotically. \"Unconditionally "
           "stable\" is a word for methods; here any c < 0 ends it.",
       judged(false, std::abs(growth[1] - 1) < 0.01)});
  claims.push_back({"3.3 B, figure 6(iii)", "where c=2, the system is stable [...] it is converging to zero",
                    ten_seconds(2) + ".", judged(growth[2] < 0.05)});
  claims.push_back(
      {"3.3 B, figure 6(iv)", "where c=10, the system is conditionally stable",
       fmt::format(
           "There is no condition: the energy falls as -c v² from every start, and both eigenvalues at 0, {:.3g} "
           "and {:.3g} 1/s, are negative. {}: the return is slow.",
           (-stiff.c + root) / (2 * stiff.m), (-stiff.c - root) / (2 * stiff.m), ten_seconds(3)),
       judged(!(growth[3] < 1))});
  return claims;
}

std::vector<Claim> claims_on_force() {
  const LiverFamily& family = liver_family("forced_amplitude");
  constexpr double t_end = 200;
  std::vector<double> left, v, a, periodic, apart;
  for (const LiverFamilyMember& member : family.members) {
    const OscillatorParameters& p = member.parameters;
    const Motion motion = motion_of(p, family.y0, t_end);
    left.push_back(100 * distance_left(motion, motion_of(p, {0, 0}, t_end), 5));
    v.push_back(lasting(motion.v, p));
    a.push_back(lasting(motion.a, p));
    const double before = displacement_at(motion, t_end - 2 * std::numbers::pi / p.w);
    periodic.push_back(100 * std::abs(motion.x.back() - before) / lasting(motion.x, p));
    for (const Eigen::Vector2d& start :
         {Eigen::Vector2d(0, 0), Eigen::Vector2d(-2, 0), Eigen::Vector2d(2, -2)})
      apart.push_back(distance_left(motion, motion_of(p, start, t_end), 40));
  }
  const double zeta = damping_ratio(family.members.front().parameters);
  const double farthest = *std::ranges::max_element(apart);
  return {
      {"3.3 C, figure 7",
       "When the external force of 0.1N (blue) is exerted [...] critical damping within 0-5 seconds",
       fmt::format(
           "The damping ratio of the linear part is {:.4f}, just below critical, with every force. Two starts, "
           "(0.5, 1) and (0, 0), have {} of their distance left after 5 s (P = 0.1 and 1 N).",
           zeta, listed(left, "%")),
       judged(zeta == 1, zeta > 0.95 && *std::ranges::max_element(left) < 10)},
      {"3.3 C, figure 7", "the body started to oscillate periodically after the critical damping",
       fmt::format(
           "At the end of {:.3g} s a period later the displacement is the same within {} of the amplitude.",
           t_end, listed(periodic, "%")),
       judged(*std::ranges::max_element(periodic) < 1)},
      {"3.3 C, figure 7",
       "As the exerted external force is large, the amplitude of the velocity and acceleration increases.",
       fmt::format(
           "From P = 0.1 to 1 N the lasting amplitude of v grows {:.3g} times ({}), that of a {:.3g} times ({}); "
           "a linear liver's would grow ten times.",
           v[1] / v[0], listed(v, "m/s"), a[1] / a[0], listed(a, "m/s²")),
       judged(v[1] > v[0] && a[1] > a[0])},
      {"3.3 C, figure 8", "forced nonlinear MSM is converging but it is conditionally stable",
       fmt::format(
           "It converges: after 40 s three other starts, up to (2, -2), are within {:.1g} of their first "
           "distance. No condition is seen.",
           farthest),
       judged(false, farthest < 0.01)}};
}

std::vector<Claim> claims_on_benchmark() {
  const LiverFamily &free = liver_family("benchmark_unforced"), &forced = liver_family("benchmark_forced");
  std::vector<double> left, lasts;
  for (const LiverFamilyMember& member : free.members)
    left.push_back(100 * distance_left(motion_of(member.parameters, free.y0, 2),
                                       motion_of(member.parameters, {0, 0}, 2), 1));
  const std::vector<double> settle = of_each(free, 60, settling_time), ratios = damping_ratios(free);
  for (const LiverFamilyMember& member : forced.members)
    lasts.push_back(1000 * lasting(motion_of(member.parameters, forced.y0, 100).x, member.parameters));
  const auto [low, high] = std::ranges::minmax(ratios);
  const auto [least_left, most_left] = std::ranges::minmax(left);
  return {
      {"3.3 D, figure 8",
       "regardless on the existence of the forces, each [...] undergoes critical damping within 0-1 seconds",
       fmt::format(
           "The six damping ratios are {:.3f} to {:.3f}. After 1 s {:.0f} to {:.0f} % of the distance of two "
           "starts are left, with and without force: the models are linear.",
           low, high, least_left, most_left),
       judged(most_left<5, low> 0.9 && high < 1.2)},
      {"3.3 D, figure 8",
       "the unforced nonlinear liver model came to a rest state relatively fast. The forced nonlinear liver model on the "
       "other hand keep oscillate periodically",
       fmt::format(
           "Without force they settle to 5 % after {}; with it they keep swinging by {}. The table has no "
           "cubic stiffness: these livers are linear.",
           listed(settle, "s"), listed(lasts, "mm")),
       judged(std::isfinite(*std::ranges::max_element(settle)) && *std::ranges::min_element(lasts) > 0)},
      {"3.3 D, figure 8",
       "the acceleration undergoes overdamped where unforced nonlinear liver model is more overdamped than the forced",
       fmt::format(
           "A force changes neither the damping ratio nor the eigenvalues of a linear model; {} of the six are "
           "overdamped.",
           std::ranges::count_if(ratios, [](double zeta) { return zeta > 1; })),
       Judgement::does_not_hold}};
}

}  // namespace

std::string_view name_of(Judgement judgement) {
  switch (judgement) {
    case Judgement::holds:
      return "holds";
    case Judgement::holds_in_part:
      return "holds in part";
    case Judgement::does_not_hold:
      break;
  }
  return "does not hold";
}

std::vector<Claim> claims_on_motion() {
  std::vector<Claim> claims;
  for (const auto& part : {claims_on_linear(), claims_on_cubic(), claims_on_force(), claims_on_benchmark()})
    claims.insert(claims.end(), part.begin(), part.end());
  return claims;
}

}  // namespace hmax
