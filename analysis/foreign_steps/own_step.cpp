#include "analysis/foreign_steps/own_step.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "core/numbers.hpp"

namespace hmax {
namespace {

constexpr double largest_sought = 1e6, resolution = 1e-3;
constexpr int start_slot = 3;  // probes write those below

/// Whether steps of size h are stable where these parts have a factor; from where the last stable one rests.
bool stands(ForeignStepper& engine, double h, double factor, const ProbeWatch& watch) {
  const std::string detail = "factor " + rounded_text(factor, 4);
  ProbeSettings settings;
  settings.h0 = settings.h1 = h;
  settings.observe = false;
  if (watch) settings.watch = [&](double share, std::string_view) { watch(share, detail); };
  const ProbedLimit found = probe_steps(engine, settings);
  const StepSpectrum& row = found.rows.back();
  if (!row.grows && row.settled.size() > 0) engine.set_state(row.settled);
  return !row.grows;
}

std::optional<LimitOwner> owner_of(ForeignStepper& engine, const ProbedLimit& found, double h,
                                   const ProbeWatch& watch) {
  if (found.shares.empty()) return std::nullopt;
  const std::vector<ScenePart> parts = engine.parts();
  struct Alike {
    double share = 0;
    std::vector<std::size_t> parts;
  };
  std::map<std::tuple<std::string, double, double>, Alike> groups;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    Alike& group = groups[{parts[i].kind, parts[i].stiffness, parts[i].damping}];
    group.share += found.shares[i].sum();
    group.parts.push_back(i);
  }
  const auto share = [](const auto& group) { return group.second.share; };
  const auto& [share_of_alike, alike] = std::ranges::max_element(groups, {}, share)->second;
  if (!(share_of_alike > 0)) return std::nullopt;
  const std::size_t at =
      *std::ranges::max_element(alike, {}, [&](std::size_t i) { return found.shares[i].sum(); });
  LimitOwner owner{.part = parts[at],
                   .share = found.shares[at].sum(),
                   .share_of_alike = share_of_alike,
                   .alike = alike.size(),
                   .stiffness = {},
                   .damping = {}};
  if (found.dim > StepSpectrumSettings{}.eigenvalues_to) return owner;
  const auto largest = [&](double own, bool of_damping) {
    LargestNumber number;
    if (own == 0) return number;
    number.alone = own * largest_factor(engine, {at}, of_damping, h, watch);
    number.together =
        alike.size() == 1 ? number.alone : own * largest_factor(engine, alike, of_damping, h, watch);
    return number;
  };
  owner.stiffness = largest(owner.part.stiffness, false);
  owner.damping = largest(owner.part.damping, true);
  return owner;
}

/// Where steps of h come to rest, and what they show of the slowest mode of h0.
void compare(ForeignStepper& engine, double h0, OwnStep& own, const ProbeWatch& watch) {
  ProbeSettings settings;
  settings.h0 = std::min(h0, own.h);
  settings.h1 = own.h;
  settings.watch = watch;
  const ProbedLimit both = compare_steps(engine, settings);
  const StepSpectrum& row = both.rows.back();
  own.settles = row.settles;
  if (row.modes.empty()) return;
  const double ratio = row.modes.front().omega_shown / row.modes.front().omega;
  own.stiffness_shown = ratio * ratio;
}

/// Whether what was found tells of steps of this size.
bool is_judged(const ProbedLimit& found, double h) {
  // Beyond h1 nobody looked.
  if (std::isnan(found.limit()) || (std::isinf(found.limit()) && h > found.h1 * (1 + 1e-9))) return false;
  if (found.smoothness == StepSmoothness::jump) return true;
  // Between what multipliers and what runs say; with NaN for runs that always grow.
  if (found.contradiction && (std::isnan(found.observed) || (h <= found.h_max) != (h <= found.observed)))
    return false;
  // Where the steps are not smooth differences hide growth.
  const auto hides_growth = [h](const StepSpectrum& row) {
    return row.h <= h && !row.grows && row.spectral_radius > 1.05;
  };
  return std::ranges::none_of(found.rows, hides_growth);
}

/// At a kink growth comes in windows of step sizes, of which h_max is one: the own steps and their substeps
/// are looked at by themselves.
void judge_at_kink(ForeignStepper& engine, OwnStep& own, const ProbeWatch& watch) {
  constexpr std::int64_t tried = 20;
  const Eigen::VectorXd start = engine.state();
  const auto grows = [&](double h) {
    const bool stable = stands(engine, h, 1, watch);
    engine.set_state(start);
    return !stable;
  };
  const bool is_below = *own.stable;
  if (grows(own.h))
    own.stable = false;
  else if (!is_below)
    own.stable.reset();
  std::int64_t n = own.stable.value_or(false) ? 1 : std::max<std::int64_t>(2, *own.substeps);
  const std::int64_t last = n + tried;
  while (n > 1 && n < last && grows(own.h / static_cast<double>(n))) ++n;
  own.substeps = n < last ? std::optional(n) : std::nullopt;
}

}  // namespace

double largest_factor(ForeignStepper& engine, const std::vector<std::size_t>& parts, bool of_damping,
                      double h, const ProbeWatch& watch) {
  const auto scale = [&](double factor) {
    for (const std::size_t part : parts)
      of_damping ? engine.scale_part(part, 1, factor) : engine.scale_part(part, factor, 1);
  };
  const auto is_stable = [&](double factor) {
    scale(factor);
    return stands(engine, h, factor, watch);
  };
  engine.save(start_slot);
  double low = 1, high = 1;
  if (is_stable(1)) {
    while (low < largest_sought && is_stable(2 * low)) low *= 2;
    high = low < largest_sought ? 2 * low : infinity;
  } else {
    while (high > 1 / largest_sought && !is_stable(high / 2)) high /= 2;
    low = high > 1 / largest_sought ? high / 2 : 0;
  }
  while (low > 0 && high < infinity && high - low > resolution * high) {
    const double middle = (low + high) / 2;
    (is_stable(middle) ? low : high) = middle;
  }
  scale(1);
  engine.restore(start_slot);
  return std::isinf(high) ? infinity : low;
}

std::optional<OwnStep> examine_own_step(ForeignStepper& engine, const ProbedLimit& found,
                                        const ProbeWatch& watch) {
  if (!engine.own_step()) return std::nullopt;
  OwnStep own{.h = *engine.own_step()};
  if (is_judged(found, own.h)) {
    const double limit = found.limit();
    own.stable = own.h <= limit;
    own.substeps = std::isinf(limit) ? 1 : static_cast<std::int64_t>(std::ceil(own.h / limit));
    if (found.smoothness == StepSmoothness::kink) judge_at_kink(engine, own, watch);
  }
  if (found.state == ProbedState::motion) return own;
  if (found.dim <= StepSpectrumSettings{}.eigenvalues_to) compare(engine, found.rows.front().h, own, watch);
  own.owner = owner_of(engine, found, own.h, watch);
  return own;
}

}  // namespace hmax
