/// The section of `hmax reproduce tissue` on the thigh: its springs identified, beside a network, in motion.
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include "cli/reproduce/tissue_page.hpp"
#include "results/json.hpp"
#include "studies/thigh/thigh_study.hpp"

namespace hmax {

namespace {

constexpr Style of_truth{.colour = 6, .dash = 3, .width = 1.4};

std::vector<double> times(const std::vector<double>& values, double factor) {
  std::vector<double> scaled;
  for (const double value : values) scaled.push_back(factor * value);
  return scaled;
}

const char* in_words(Probe probe) { return probe == Probe::indentor ? "indentor" : "surface probe"; }

Panel force_panel(Probe probe) {
  return {.title = in_words(probe), .x = {.label = "penetration [mm]"}, .y = {.label = "force [N]"}};
}

Figure forces_figure(const ThighStudy& study, const std::string& machine) {
  Figure figure{.title = "Forces of the identified thigh", .columns = 2};
  figure.footer =
      "synthetic measurements; points of the deepest, the middle and the shallowest tissue; " + machine;
  for (const Probe probe : {Probe::indentor, Probe::surface}) {
    Panel panel = force_panel(probe);
    std::vector<Curve> truths;  // over everything else
    int k = 0;
    for (const ThighCurve& curve : study.curves) {
      if (curve.probe != probe) continue;
      const auto inside = curve.measured_depth.size() * 2;  // depths of the curve are half as far apart
      const auto first = [inside](const std::vector<double>& values) {
        return std::vector<double>(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(inside));
      };
      const std::string point = fmt::format("point {}", curve.point + 1);
      const std::vector<double> depth = times(first(curve.depth), 1000);
      panel.curves.push_back(
          {.label = point + ", identified", .x = depth, .y = first(curve.springs), .style = {.colour = k}});
      panel.curves.push_back(
          {.label = point + ", measured",
           .x = times(curve.measured_depth, 1000),
           .y = curve.measured_force,
           .style = {.colour = k, .marker = std::array{7, 5, 9}.at(static_cast<std::size_t>(k)), .size = 0.7},
           .line = false});
      truths.push_back({.label = "truth", .x = depth, .y = first(curve.truth), .style = of_truth});
      ++k;
    }
    std::ranges::move(truths, std::back_inserter(panel.curves));
    figure.panels.push_back(std::move(panel));
  }
  return figure;
}

/// Identified over true parameters with their intervals.
Figure parameters_figure(const ThighStudy& study, const std::string& machine) {
  const ThighFit& fit = study.identified().fit;
  const Eigen::VectorXd truth = unknowns(study.truth, study.identified().options.skin);
  const Eigen::Index n = study.truth.points();
  Figure figure{.title = "Identified parameters of the tissue with intervals of 95 %", .columns = 2};
  figure.footer = machine;
  for (const auto& [name, first] : {std::pair{"a", Eigen::Index{0}}, {"b", n}}) {
    Panel panel{.title = name, .x = {.label = "point [1]"}, .y = {.label = "identified over true value [1]"}};
    Curve curve{.label = "identified", .style = {.marker = 7, .width = 1, .size = 0.5}, .line = false};
    for (Eigen::Index i = 0; i < n; ++i) {
      const double right = truth[first + i];
      curve.x.push_back(static_cast<double>(i + 1));
      curve.y.push_back(fit.values[first + i] / right);
      curve.low.push_back(fit.low[first + i] / right);
      curve.high.push_back(fit.high[first + i] / right);
    }
    const auto last = static_cast<double>(n + 1);
    panel.fills.push_back({.label = "within 5 %",
                           .loops = {{{0, 0.95}, {last, 0.95}, {last, 1.05}, {0, 1.05}}},
                           .colour = 7,
                           .shade = 0.2});
    panel.x.range = Range{0, last};
    panel.curves.push_back(std::move(curve));
    panel.curves.push_back({.label = "truth", .x = {0, last}, .y = {1, 1}, .style = of_truth});
    figure.panels.push_back(std::move(panel));
  }
  return figure;
}

/// Springs and network on the shallowest tissue, to beyond the measurements.
Figure network_figure(const ThighStudy& study, const std::string& machine) {
  Figure figure{.title = "Springs and network beyond the measurements", .columns = 2};
  figure.footer = "the shallowest tissue; " + machine;
  for (const Probe probe : {Probe::indentor, Probe::surface}) {
    Panel panel = force_panel(probe);
    const auto last = std::find_if(study.curves.rbegin(), study.curves.rend(),
                                   [&](const ThighCurve& each) { return each.probe == probe; });
    const std::vector<double> depth = times(last->depth, 1000);
    panel.curves.push_back({.label = "springs", .x = depth, .y = last->springs, .style = {.colour = 0}});
    panel.curves.push_back(
        {.label = "network", .x = depth, .y = last->network, .style = {.colour = 1, .dash = 1}});
    panel.curves.push_back({.label = "truth", .x = depth, .y = last->truth, .style = of_truth});
    panel.curves.push_back({.label = "measured",
                            .x = times(last->measured_depth, 1000),
                            .y = last->measured_force,
                            .style = {.colour = 2, .marker = 7, .size = 0.7},
                            .line = false});
    figure.panels.push_back(std::move(panel));
  }
  return figure;
}

std::string name_of(const ThighRun& run) {
  if (run.h == 0) return "reference (" + run.method + ")";
  return run.constant ? fmt::format("the same, constant Jacobian, {:g} ms", 1000 * run.h)
                      : fmt::format("{}, {:g} ms", run.method, 1000 * run.h);
}

Figure motion_figure(const ThighStudy& study, const std::string& machine) {
  Figure figure{.title = "The thigh pressed and released", .footer = machine};
  const double depth = 1000 * study.load.depth;
  Panel panel{.x = {.label = "time [s]"},
              .y = {.label = "penetration [mm]", .range = Range{-0.35 * depth, 1.6 * depth}}};
  int k = 0;
  for (const ThighRun& run : study.runs) {
    const bool is_reference = run.h == 0;
    Curve curve{
        .label = name_of(run),
        .style = is_reference ? Style{.colour = 7, .width = 4, .light = true} : family_style(k++, true)};
    curve.style.size = 0.6;
    for (std::size_t i = 0; i < run.u.size(); ++i) {
      if (std::abs(run.u[i]) > 1.5 * study.load.depth) break;  // it diverges
      curve.x.push_back(run.t[i]);
      curve.y.push_back(1000 * run.u[i]);
    }
    panel.curves.push_back(std::move(curve));
  }
  figure.panels.push_back(std::move(panel));
  return figure;
}

/// What the command tells as JSON. The text shows it too.
Json document_of(const ThighStudy& study) {
  Json fits = Json::array();
  for (const ThighCase& each : study.cases)
    fits.push_back({{"skin", each.skin},
                    {"unknowns", each.fit.values.size()},
                    {"converged", each.fit.converged},
                    {"overall_error", each.overall},
                    {"within_5_percent", each.recovery.within},
                    HMAX_KEYS(each.recovery, largest_error, covered),
                    {"evaluations", each.fit.evaluations}});
  return {{"points", study.truth.points()},
          {"forces", value_count(study.data)},
          {"fits", fits},
          HMAX_KEYS(study, covered, starts, tasks, limits, stable_mass),
          {"constant_jacobian_depth", study.constant_depths.minCoeff()}};
}

/// What the fits show.
void add_fits(Json& values, const ThighStudy& study) {
  const ThighCase &wrong = study.cases.at(2), &every = study.cases.at(3), &two = study.identified();
  values["true_error"] = two.true_overall;
  values["small_error_deceives"] = wrong.overall < 0.05 && wrong.recovery.within < 0.5;
  values["wrong_error"] = wrong.overall;
  values["wrong_within"] = wrong.recovery.within;
  values["skin_is_ambiguous"] = every.recovery.within < two.recovery.within;
  values["every_within"] = every.recovery.within;
  int by_logarithms = 0, by_ratios = 0, tried = 0;  // as many with each
  for (const ThighStarts& each : study.starts) {
    const bool logarithmic = each.misfit == Misfit::logarithmic;
    (logarithmic ? by_logarithms : by_ratios) += each.found;
    if (logarithmic) tried += each.starts;
  }
  values["found_by_logarithms"] = by_logarithms;
  values["found_by_ratios"] = by_ratios;
  values["tried"] = tried;
  values["logarithms_help"] = by_ratios < tried && by_logarithms == tried;
}

/// What the network shows beside the springs.
void add_network(Json& values, const ThighStudy& study) {
  const double gain = study.equilibrium_seconds / study.network_seconds;
  const ThighTask& inside = study.tasks.at(1);
  const ThighTask& other = *std::ranges::max_element(study.tasks, {}, &ThighTask::network);
  values.update({HMAX_KEYS(study, network_seconds, force_seconds, equilibrium_seconds)});
  values["network_is_faster"] = gain > 1;
  values["network_gain"] = gain;
  values["network_extrapolates_badly"] = inside.network < 0.05 && other.network > 4 * inside.network;
  values["network_inside"] = inside.network;
  values["network_worst"] = other.network;
  values["network_worst_at"] = other.forces;
}

/// What the motion shows.
void add_motion(Json& values, const ThighStudy& study) {
  for (const ThighRun& run : study.runs)
    if (run.h > 0)
      values["runs"].push_back({{"run", name_of(run)}, HMAX_KEYS(run, reached_end, error, real_time)});
  const double h = study.limits.front().h_pressed;
  const Eigen::Index stable = (study.constant_depths.array() > 1).count();
  values["point"] = study.load.point + 1;
  values.update({HMAX_KEYS(study.load, depth, mass, damping)});
  values["euler_is_too_slow"] = h < 0.01;  // at 100 Hz
  values["euler_rate"] = 1 / h;
  values["stable_points"] = stable;
  values["stable_everywhere"] = stable == study.constant_depths.size();
  values.update({HMAX_KEYS(study, left, period, period_heavy, sag, sag_heavy)});
}

/// The statements of slides 31 to 38.
void judge_thigh(TissuePage& tissue, const ThighStudy& study, const Json& values) {
  const ThighCase& fit = study.identified();
  tissue.judge("error_below_5_percent", judged(fit.overall < 0.05),
               {{"overall", fit.overall}, {"within", fit.recovery.within}});
  const int lost = values["tried"].get<int>() - values["found_by_ratios"].get<int>();
  tissue.judge("local_minima", judged(lost > 0), {{"lost", lost}, {"tried", values["tried"]}});
  const double h = study.limits.front().h_pressed;
  tissue.judge("euler_in_real_time", judged(h < 0.01 && study.stable_mass > study.load.mass),
               {{"rate", 1 / h}, {"mass", study.stable_mass}, {"own", study.load.mass}});
  tissue.judge("heavy_is_slow", judged(study.period_heavy > 2 * study.period),
               {{"period", study.period}, {"heavy", study.period_heavy}});
  tissue.judge("heavy_sags", judged(study.sag_heavy > 2 * study.sag),
               {{"sag", study.sag}, {"heavy", study.sag_heavy}});
  const bool everywhere = values["stable_everywhere"];
  tissue.judge("constant_jacobian_at_100_hz", judged(everywhere, study.runs.at(2).reached_end),
               {{"stable", values["stable_points"]},
                {"points", values["points"]},
                {"times", study.runs.at(2).real_time}});
  tissue.judge("network_is_very_fast", judged(study.network_seconds < 0.1 * study.equilibrium_seconds),
               {{"gain", values["network_gain"]},
                {"worst", values["network_worst"]},
                {"at", values["network_worst_at"]}});
}

}  // namespace

void identified_thigh(TissuePage& tissue, const std::function<void(const std::string&)>& progress) {
  ThighStudyOptions asked;
  if (tissue.options.quick) asked = {.around = 4, .along = 4, .starts = 2, .repetitions = 5};
  const ThighStudy study = thigh_study(asked, progress);
  Json values = tissue.document["thigh"] = document_of(study);
  add_fits(values, study);
  add_network(values, study);
  add_motion(values, study);
  tissue.page.values["thigh"] = values;
  judge_thigh(tissue, study, values);
  const std::string& machine = tissue.options.machine;
  tissue.page.draw(forces_figure(study, machine), "thigh_forces");
  tissue.page.draw(parameters_figure(study, machine), "thigh_parameters");
  tissue.page.draw(network_figure(study, machine), "thigh_network");
  tissue.page.draw(motion_figure(study, machine), "thigh_motion");
}

}  // namespace hmax
