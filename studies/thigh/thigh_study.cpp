#include "studies/thigh/thigh_study.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "bench/timing/timing.hpp"

namespace hmax {

namespace {

constexpr double step = 0.002;  // of the measurements [m]

ThighCase fitted(const ThighStudy& study, const std::vector<ForceSeries>& exact, std::string skin,
                 double factor, UnknownSkin unknown) {
  const FitOptions options{.skin = unknown};
  ThighFit fit = identify(uniform_guess(study.truth, factor), study.data, options);
  const Recovery recovery = compare(fit, study.truth, unknown);
  const double overall = overall_error(forces_of(fit.thigh, study.data), forces_of(study.data));
  const double true_overall = overall_error(forces_of(fit.thigh, exact), forces_of(exact));
  return {std::move(skin), options, std::move(fit), recovery, overall, true_overall};
}

double share_covered(const Thigh& truth, int repetitions) {
  double covered = 0;
  for (int k = 1; k <= repetitions; ++k) {
    const auto data = measured(truth, {.seed = 100 + static_cast<std::uint64_t>(k)});
    covered += compare(identify(truth, data), truth, UnknownSkin::by_direction).covered;
  }
  return covered / repetitions;
}

ThighStarts started(const ThighStudy& study, Misfit misfit, double of_a, double of_b, int starts) {
  // The least of both misfits is that of the same fit but for terms of higher order in the noise.
  const FitOptions options{.misfit = misfit};
  const double best = identify(study.identified().fit.thigh, study.data, options).residual;
  ThighStarts found{.misfit = misfit, .factor_a = of_a, .factor_b = of_b, .starts = starts};
  for (int k = 1; k <= starts; ++k) {
    const Thigh guess = scattered(uniform_guess(study.truth, 3), of_a, of_b, static_cast<std::uint64_t>(k));
    const ThighFit fit = identify(guess, study.data, options);
    if (fit.residual <= 1.001 * best)
      ++found.found;
    else
      found.worst =
          std::fmax(found.worst, overall_error(forces_of(fit.thigh, study.data), forces_of(study.data)));
  }
  return found;
}

/// The data at other depths, or by another probe, with forces without noise.
std::vector<ForceSeries> asked(const ThighStudy& study,
                               const std::function<void(ForceSeries&, std::vector<double>&)>& change) {
  std::vector<ForceSeries> changed;
  for (ForceSeries series : study.data) {
    std::vector<double> depths;
    change(series, depths);
    if (depths.empty()) continue;
    series.depth = std::move(depths);
    series.force.clear();
    for (const PressedThigh& at :
         press(study.truth, pressed_points(study.truth, series.point, series.probe), series.depth))
      series.force.push_back(at.force);
    changed.push_back(std::move(series));
  }
  return changed;
}

std::vector<ThighTask> tasks_of(const ThighStudy& study, const ThighNetwork& network) {
  const auto task = [&](const char* name, const auto& change) -> ThighTask {
    const auto data = asked(study, change);
    const Eigen::VectorXd truth = forces_of(data);
    return {name, overall_error(forces_of(study.identified().fit.thigh, data), truth),
            overall_error(forces_of(network, study.truth, data), truth)};
  };
  return {task("at the measured depths",
               [](ForceSeries& series, std::vector<double>& depths) { depths = series.depth; }),
          task("between them",
               [](ForceSeries& series, std::vector<double>& depths) {
                 for (const double depth : series.depth) depths.push_back(depth - step / 2);
               }),
          task("2 to 6 mm deeper",
               [](ForceSeries& series, std::vector<double>& depths) {
                 for (int k = 1; k <= 3; ++k) depths.push_back(series.depth.back() + k * step);
               }),
          task("surface probe turned by a right angle", [](ForceSeries& series, std::vector<double>& depths) {
            if (series.probe != Probe::surface) return;
            series.probe = Probe::across;
            depths = series.depth;
          })};
}

std::vector<ThighCurve> curves_of(const ThighStudy& study, const ThighNetwork& network) {
  std::vector<Eigen::Index> points(static_cast<std::size_t>(study.truth.points()));
  std::iota(points.begin(), points.end(), 0);
  std::ranges::sort(points, {}, [&](Eigen::Index p) { return study.truth.b[p]; });  // b falls with the depth
  std::vector<ThighCurve> curves;
  for (const Probe probe : {Probe::indentor, Probe::surface})
    for (const std::size_t at : {std::size_t{0}, points.size() / 2, points.size() - 1}) {
      const ForceSeries& series = *std::ranges::find_if(study.data, [&](const ForceSeries& each) {
        return each.point == points[at] && each.probe == probe;
      });
      ThighCurve curve{.point = points[at],
                       .probe = probe,
                       .measured_depth = series.depth,
                       .measured_force = series.force,
                       .depth{},
                       .truth{},
                       .springs{},
                       .network{}};
      ForceSeries fine{.point = curve.point, .probe = probe, .depth{}, .force{}};
      for (double depth = step / 2; depth < series.depth.back() + 3.1 * step; depth += step / 2)
        fine.depth.push_back(depth);
      fine.force.assign(fine.depth.size(), 0);
      curve.depth = fine.depth;
      const auto values = [](const Eigen::VectorXd& forces) {
        return std::vector<double>(forces.begin(), forces.end());
      };
      curve.truth = values(forces_of(study.truth, {&fine, 1}));
      curve.springs = values(forces_of(study.identified().fit.thigh, {&fine, 1}));
      curve.network = values(forces_of(network, study.truth, {&fine, 1}));
      curves.push_back(std::move(curve));
    }
  return curves;
}

void measure_costs(ThighStudy& study, const ThighNetwork& network) {
  const Thigh& thigh = study.identified().fit.thigh;
  const std::vector<Eigen::Index> pressed = pressed_points(thigh, study.load.point, study.load.probe);
  constexpr std::array depth{0.01};
  Eigen::VectorXd u = Eigen::VectorXd::Zero(thigh.points());
  for (const Eigen::Index p : pressed) u[p] = depth.front();
  volatile double used = 0;
  const std::vector<std::function<void(std::int64_t)>> tasks{
      repeated([&] { used = network.forces(u)[0]; }), repeated([&] { used = thigh.forces(u)[0]; }),
      repeated([&] { used = press(thigh, pressed, depth).front().force; })};
  const auto timings = time_interleaved(tasks, {.repetitions = 7, .min_sample_s = 2e-3});
  study.network_seconds = timings[0].least();
  study.force_seconds = timings[1].least();
  study.equilibrium_seconds = timings[2].least();
}

}  // namespace

ThighStudy thigh_study(const ThighStudyOptions& options,
                       const std::function<void(const std::string&)>& progress) {
  ThighStudy study;
  progress("thigh, identification");
  study.truth = true_thigh(options.around, options.along);
  study.data = measured(study.truth, {});
  const auto exact = measured(study.truth, {.noise = 0});
  study.cases.push_back(fitted(study, exact, "known", 1, UnknownSkin::none));
  study.cases.push_back(fitted(study, exact, "unknown, one stiffness along and one around the bone", 3,
                               UnknownSkin::by_direction));
  study.cases.push_back(fitted(study, exact, "taken for half as stiff as it is", 0.5, UnknownSkin::none));
  study.cases.push_back(fitted(study, exact, "unknown, each spring its own", 3, UnknownSkin::every_spring));
  progress("thigh, intervals");
  study.covered = share_covered(study.truth, options.repetitions);
  for (const Misfit misfit : {Misfit::logarithmic, Misfit::relative}) {
    progress("thigh, far guesses");
    study.starts.push_back(started(study, misfit, 3, 2, options.starts));
    progress("thigh, farther guesses");
    study.starts.push_back(started(study, misfit, 10, 4, options.starts));
  }
  progress("thigh, network");
  const ThighNetwork network = train(study.truth, study.data);
  study.tasks = tasks_of(study, network);
  study.curves = curves_of(study, network);
  study.load.point = options.along * (options.around / 2 - 1) + options.along / 2 - 1;
  measure_costs(study, network);
  progress("thigh, motion");
  const Thigh& thigh = study.identified().fit.thigh;
  study.limits = thigh_limits({"explicit_euler", "symplectic_euler", "rk4", "linearly_implicit_euler"}, thigh,
                              study.load);
  study.stable_mass = stable_mass("explicit_euler", thigh, study.load, 0.01);
  ThighLoad heavy = study.load;
  heavy.mass = study.stable_mass;
  constexpr double g = 9.81;  // [m/s^2]
  study.left = share_left(thigh, study.load);
  study.period = slowest_period(thigh, study.load.mass);
  study.period_heavy = slowest_period(thigh, heavy.mass);
  study.sag = deepest_under(thigh, g * study.load.mass);
  study.sag_heavy = deepest_under(thigh, g * heavy.mass);
  study.constant_depths = constant_jacobian_depths(thigh, study.load, 0.01, 0.024);
  study.runs = thigh_runs(thigh, study.load);
  return study;
}

}  // namespace hmax
