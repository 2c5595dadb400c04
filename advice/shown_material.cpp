#include "advice/shown_material.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "advice/step_search.hpp"
#include "advice/time_limit.hpp"
#include "catalogue/methods/catalogue.hpp"
#include "catalogue/models/tissue_problem.hpp"
#include "core/errors.hpp"
#include "core/numbers.hpp"
#include "core/text/sentences.hpp"
#include "problems/tissue/body.hpp"

namespace hmax {

namespace {

using Eigen::VectorXd;

/// Whether a step from rest in the equilibrium stays there, to a millionth of the way that the slowest motion
/// goes in one.
bool stays_in_equilibrium(const AdviceRow& row, const FidelityModel& model) {
  const Eigen::Index n = model.equilibrium.size();
  Problem problem = model.problem;
  problem.y0 = VectorXd::Zero(2 * n);
  problem.y0.head(n) = model.equilibrium;
  const RunRecord run = row.candidate.method.bind(problem).run(row.candidate.spec(row.h, row.h), {});
  const double turn = model.modes.empty() ? 0.1 : model.modes.front().omega * row.h;
  return run.outcome == Outcome::reached_end &&
         (run.y.head(n) - model.equilibrium).norm() <=
             1e-6 * std::min(1.0, turn * turn) * model.equilibrium.norm();
}

/// As much work in substeps of one iteration; nothing of methods that know no such work, or do that already.
std::optional<Method> of_single_iterations(const Method& method) {
  const double iterations = method.parameter("iterations").value_or(1);
  const std::optional<double> substeps = method.parameter("substeps");
  if (iterations == 1 || !substeps) return std::nullopt;
  return with_values(method, {{"iterations", 1}, {"substeps", *substeps * iterations}});
}

/// What rows show, each method at each step once.
class ShownMaterial {
 public:
  ShownMaterial(const FidelityModel& model, Watcher watch) : model_(model), watch_(std::move(watch)) {}

  void tell(AdviceRow& row) {
    const Fidelity shown = shown_by(row.candidate.method, row.h);
    row.stiffness_shown = shown.stiffness_shown;
    for (std::size_t k = 0; k < std::min(row.damping_added.size(), shown.modes.size()); ++k) {
      const ShownMode& mode = shown.modes[k];
      row.damping_added[k] = mode.zeta_shown - mode.zeta;
      row.frequency_shift[k] = mode.omega_shown / mode.omega - 1;
    }
    if (!shown.status.empty()) add_sentence(row.status, shown.status);
    if (!shows_other_material(row)) return;
    add_sentence(row.status, fmt::format("stable, but {} your stiffness", in_words(row.stiffness_shown)));
    if (row.stiffness_shown < 1)
      row.stiffness_ceiling =
          stiffness_ceiling(row.candidate.method, model_, {.h = row.h, .watch = watch_}, row.stiffness_shown);
    if (std::isfinite(row.stiffness_ceiling))
      row.status +=
          fmt::format("; at most {} kPa at this setting", short_number(row.stiffness_ceiling / 1e3, 2));
    if (const auto other = of_single_iterations(row.candidate.method))
      if (const double shows = shown_by(*other, row.h).stiffness_shown;
          std::abs(shows - 1) < std::abs(row.stiffness_shown - 1))
        row.status += fmt::format("; {} substeps of one iteration cost the same and show {}",
                                  *other->parameter("substeps"), short_number(shows, 2));
  }

 private:
  static std::string in_words(double shown) {
    return short_number(shown, 2) + (shown < 1 ? " of" : " times");
  }

  const Fidelity& shown_by(const Method& method, double h) {
    const auto known = std::ranges::find_if(
        known_, [&](const Fidelity& each) { return each.method.id == method.id && each.h == h; });
    if (known != known_.end()) return *known;
    return known_.emplace_back(fidelity(method, model_, {.h = h, .watch = watch_}));
  }

  const FidelityModel& model_;
  Watcher watch_;
  std::vector<Fidelity> known_;
};

}  // namespace

bool shows_other_material(const AdviceRow& row) {
  return std::abs(row.stiffness_shown - 1) > unlike_stiffness;
}

std::optional<FidelityModel> material_model(const Problem& problem, const AdviceQuestion& question,
                                            const Advice& advice, const Watcher& watcher) {
  if (!problem.body || question.motion) return std::nullopt;
  const Problem loaded = with_settings(problem, [&](TissueSettings& settings) {
    settings.gravity *= advice.gravity_share;
    for (PressingForce& force : settings.forces) force.force *= advice.load_share;
  });
  try {
    return fidelity_model(loaded, watcher);
  } catch (const InputError&) {  // nothing that settles
    return std::nullopt;
  }
}

void tell_material(std::span<AdviceRow> rows, const FidelityModel& model, double most,
                   const Watcher& watcher) {
  const TimeLimit time(most);
  const Watcher watch = [&] {
    if (watcher) watcher();
    time.require();
  };
  std::vector<AdviceRow*> moved;
  try {
    for (AdviceRow& row : rows) {
      if (!is_suitable(row) && row.verdict != AdviceVerdict::inaccurate) continue;
      watch();
      // Without a formula its slow modes are not known yet.
      if (row.candidate.method.amplification && stays_in_equilibrium(row, model))
        row.stiffness_shown = 1;
      else if (!depends_on_past(row.candidate.method, model.problem))
        moved.push_back(&row);
    }
    ShownMaterial shown(model, watch);
    for (AdviceRow* row : moved) shown.tell(*row);
  } catch (const OutOfTime&) {
    for (AdviceRow* row : moved)
      if (std::isnan(row->stiffness_shown))
        add_sentence(row->status, "what it shows of the stiffness was not sought in time");
  }
}

}  // namespace hmax
