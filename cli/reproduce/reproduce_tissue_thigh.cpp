/// The section of `hmax reproduce tissue` on the thigh: its springs identified, beside a network, in motion.
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include "cli/reproduce/reproduce_tissue_parts.hpp"
#include "plots/draw.hpp"

namespace hmax {

namespace {

constexpr Style of_truth{.colour = 6, .dash = 3, .width = 1.4};

std::vector<double> times(const std::vector<double>& values, double factor) {
  std::vector<double> scaled;
  for (const double value : values) scaled.push_back(factor * value);
  return scaled;
}

std::string per_cent(double share) {
  return share < 10 ? fmt::format("{:.3g} %", 100 * share) : fmt::format("{:.0f} %", 100 * share);
}

const char* in_words(Probe probe) { return probe == Probe::indentor ? "indentor" : "surface probe"; }
const char* in_words(Misfit misfit) {
  return misfit == Misfit::logarithmic ? "log(F / F_measured)" : "F / F_measured - 1";
}

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

std::string cases_in_words(const ThighStudy& study) {
  std::string table =
      "| stiffness of the skin | unknowns | overall error | within 5 % of the truth | largest error | intervals "
      "that hold the truth | evaluations |\n| --- | ---: | ---: | ---: | ---: | ---: | ---: |\n";
  for (const ThighCase& each : study.cases)
    table += fmt::format("| {} | {} | {} | {} | {} | {} | {}{} |\n", each.skin, each.fit.values.size(),
                         per_cent(each.overall), per_cent(each.recovery.within),
                         per_cent(each.recovery.largest_error), per_cent(each.recovery.covered),
                         each.fit.evaluations, each.fit.converged ? "" : ", not converged");
  const ThighCase &wrong = study.cases.at(2), &every = study.cases.at(3), &two = study.identified();
  table += fmt::format(
      "\nThe overall error is the root of the squared differences to the measured forces over that of the forces; "
      "beside the forces without noise it is {} with two unknown stiffnesses. Over other noises {} of the intervals "
      "of that fit hold the truth.\n\n",
      per_cent(two.true_overall), per_cent(study.covered));
  if (wrong.overall < 0.05 && wrong.recovery.within < 0.5)
    table += fmt::format(
        "A small overall error does not say that the parameters are right: with a skin half as stiff as it is the "
        "forces are within {}, but only {} of the parameters within 5 %. ",
        per_cent(wrong.overall), per_cent(wrong.recovery.within));
  if (every.recovery.within < two.recovery.within)
    table += fmt::format(
        "Two probes do not tell each spring of the skin from its neighbours: with a stiffness for each {} of the "
        "parameters are within 5 %. ",
        per_cent(every.recovery.within));
  return table;
}

std::string starts_in_words(const ThighStudy& study) {
  std::string table =
      "\n\n| misfit | largest factor of a, of b | guesses | ended at the best fit | worst overall error of the "
      "others |\n| --- | ---: | ---: | ---: | ---: |\n";
  std::array<int, 2> found{}, starts{};
  for (const ThighStarts& each : study.starts) {
    table += fmt::format("| {} | {:g}, {:g} | {} | {} | {} |\n", markdown_text(in_words(each.misfit)),
                         each.of_a, each.of_b, each.starts, each.found,
                         each.found < each.starts ? per_cent(each.worst) : "none");
    const std::size_t k = each.misfit == Misfit::logarithmic ? 0 : 1;
    found.at(k) += each.found;
    starts.at(k) += each.starts;
  }
  table += fmt::format(
      "\nGuesses have a = 0.3 N and b = 60 1/m, each times a factor of its own, and a skin three times too stiff. The "
      "misfit of logarithms leads {} of {} to the best fit, that of relative forces {} of {}.",
      found[0], starts[0], found[1], starts[1]);
  if (found[1] < starts[1] && found[0] == starts[0])
    table += " With logarithms the stiffest points of a far guess do not outweigh all others.";
  return table;
}

std::string network_in_words(const ThighStudy& study) {
  std::string table = "\n\n| forces asked for | springs | network |\n| --- | ---: | ---: |\n";
  for (const ThighTask& task : study.tasks)
    table += fmt::format("| {} | {} | {} |\n", task.name, per_cent(task.springs), per_cent(task.network));
  const double ratio = study.equilibrium_seconds / study.network_seconds;
  const ThighTask& inside = study.tasks.at(1);
  const ThighTask& other = *std::ranges::max_element(study.tasks, {}, &ThighTask::network);
  table += fmt::format(
      "\nOverall errors beside the forces without noise, of springs with two unknown stiffnesses of the skin and of a "
      "network with a hidden layer of tanh, a penetration and a force for each point. An evaluation of the network "
      "costs {:.3g} µs; the forces of the springs cost {:.3g} µs, their equilibrium {:.3g} µs: {}.",
      1e6 * study.network_seconds, 1e6 * study.force_seconds, 1e6 * study.equilibrium_seconds,
      ratio > 1 ? fmt::format("the network is {:.2g} times as fast", ratio) : "the network is not faster");
  if (inside.network < 0.05 && other.network > 4 * inside.network)
    table += fmt::format(
        " It is within {} between the depths that it was trained on, and wrong by {} for what it has not seen ({}).",
        per_cent(inside.network), per_cent(other.network), other.name);
  return table;
}

std::string motion_in_words(const ThighStudy& study) {
  constexpr double rate = 100;  // [1/s]
  std::string table = "\n\n| method | h_max at rest [ms] | h_max pressed [ms] |\n| --- | ---: | ---: |\n";
  const auto milliseconds = [](double h) {
    return std::isinf(h) ? std::string("unbounded") : fmt::format("{:.3g}", 1000 * h);
  };
  for (const ThighLimit& limit : study.limits)
    table += fmt::format("| {} | {} | {} |\n", markdown_text(limit.method), milliseconds(limit.at_rest),
                         milliseconds(limit.pressed));
  table += "\n| run | error | times real time |\n| --- | ---: | ---: |\n";
  for (const ThighRun& run : study.runs)
    if (run.h > 0)
      table += fmt::format("| {} | {} | {} |\n", markdown_text(name_of(run)),
                           run.reached_end ? per_cent(run.error) : "diverges",
                           run.reached_end ? fmt::format("{:.3g}", run.real_time) : "");
  const double h = study.limits.front().pressed;
  table += fmt::format(
      "\nThe surface probe presses point {} by {:g} mm; points have {:g} g each and a damping of {:g}/s times their "
      "mass, which are assumptions. ",
      study.load.point + 1, 1000 * study.load.depth, 1000 * study.load.mass, study.load.damping);
  if (h < 1 / rate)
    table +=
        fmt::format("Explicit Euler needs {:.0f} steps a second, or points of {:.3g} g with {:g} of them. ",
                    1 / h, 1000 * study.stable_mass, rate);
  const Eigen::Index all = (study.constant_depths.array() > 1).count();
  if (all == study.constant_depths.size())
    table +=
        "Linearly implicit Euler with the Jacobian of rest is stable at 100 Hz at every point, up to 24 mm.";
  else
    table += fmt::format(
        "Linearly implicit Euler with the Jacobian of rest is stable at 100 Hz up to 24 mm at {} of {} points; at the "
        "stiffest it begins to oscillate beyond {:.1f} mm, since springs under pressure are stiffer than their "
        "Jacobian says.",
        all, study.constant_depths.size(), 1000 * study.constant_depths.minCoeff());
  return table;
}

}  // namespace

ReportSection identified_thigh(const std::filesystem::path& folder, const TissueOptions& options,
                               TissueStudy& tissue, const std::function<void(const std::string&)>& progress) {
  ThighStudyOptions asked;
  if (options.quick) asked = {.around = 4, .along = 4, .starts = 2, .repetitions = 5};
  tissue.thigh = thigh_study(asked, progress);
  const ThighStudy& study = tissue.thigh;
  return {
      .title = "A thigh identified from forces on two probes",
      .text =
          fmt::format(
              "{} points of skin, linear springs between them and under each a spring on the bone with the force "
              "a (exp(b d) - 1). An indentor and a surface probe press each point in steps of 2 mm: {} forces with "
              "2 % of noise. Levenberg-Marquardt finds a and b of every point.\n\n",
              study.truth.points(), value_count(study.data)) +
          cases_in_words(study) + starts_in_words(study) + network_in_words(study) + motion_in_words(study),
      .figures = {draw(forces_figure(study, options.machine), folder, "thigh_forces"),
                  draw(parameters_figure(study, options.machine), folder, "thigh_parameters"),
                  draw(network_figure(study, options.machine), folder, "thigh_network"),
                  draw(motion_figure(study, options.machine), folder, "thigh_motion")},
      .printed =
          "64 points, 10 to 12 forces of each probe; an overall error of less than 5 %, local minima to avoid; "
          "semi-implicit Euler with a constant Jacobian at 100 Hz, explicit Euler with too small steps or a large "
          "mass; a static neural model, very fast.",
      .differs =
          "The measurements are synthetic, from a thigh whose parameters are known: those of the thesis are not "
          "published. Points move on their lines to the bone, and the skin acts by its tension."};
}

}  // namespace hmax
