/// The thigh of a thesis done again on synthetic measurements: identified, beside a network, in motion.
#pragma once

#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "results/json.hpp"
#include "studies/thigh/thigh_identification.hpp"
#include "studies/thigh/thigh_motion.hpp"
#include "studies/thigh/thigh_network.hpp"

namespace hmax {

struct ThighStudyOptions {
  Eigen::Index around = 8, along = 8;
  int starts = 4;        ///< from far, for each misfit
  int repetitions = 10;  ///< of the measurements, for the share of intervals that hold the truth
};

/// One fit to the same data.
struct ThighCase {
  std::string skin;  ///< what is assumed of it, in words
  FitOptions options;
  ThighFit fit;
  Recovery recovery;
  double overall = 0;       ///< error beside the measured forces [1]
  double true_overall = 0;  ///< the same beside the forces without noise
};

/// Fits from far guesses.
struct ThighStarts {
  Misfit misfit = Misfit::logarithmic;
  double factor_a = 1, factor_b = 1;  ///< largest of the guess
  int starts = 0;
  int found = 0;  ///< ended with the residual of the best fit, to one part in a thousand
  double worst =
      std::numeric_limits<double>::quiet_NaN();  ///< largest overall error of a fit that did not [1]
};
HMAX_RECORD(ThighStarts, misfit, factor_a, factor_b, starts, found, worst);

/// Errors of springs and network beside forces without noise [1], overall.
struct ThighTask {
  std::string forces;  ///< which are asked for
  double springs = 0, network = 0;
};
HMAX_RECORD(ThighTask, forces, springs, network);

/// A point drawn from the inside of its data to deeper presses.
struct ThighCurve {
  Eigen::Index point = 0;
  Probe probe = Probe::indentor;
  std::vector<double> measured_depth, measured_force;  ///< [m], [N]
  std::vector<double> depth, truth, springs, network;  ///< [m], [N]
};

struct ThighStudy {
  Thigh truth;
  std::vector<ForceSeries> data;
  std::vector<ThighCase> cases;  ///< the second, with two stiffnesses of the skin, is used below
  double covered = 0;            ///< share of intervals that hold the truth, over all repetitions
  std::vector<ThighStarts> starts;
  std::vector<ThighTask> tasks;
  std::vector<ThighCurve> curves;  ///< points of deep, middle and shallow tissue by each probe
  double network_seconds = 0, force_seconds = 0, equilibrium_seconds = 0;  ///< CPU time of one evaluation
  ThighLoad load;
  std::vector<ThighLimit> limits;
  double stable_mass = 0;               ///< of a point, with explicit Euler at 100 Hz [kg]
  double left = 0;                      ///< share_left()
  double period = 0, period_heavy = 0;  ///< slowest_period() with either mass [s]
  double sag = 0, sag_heavy = 0;        ///< deepest point under the weight of all points with either mass [m]
  Eigen::VectorXd constant_depths;      ///< of constant_jacobian_depths() at 100 Hz up to 24 mm
  std::vector<ThighRun> runs;

  [[nodiscard]] const ThighCase& identified() const { return cases.at(1); }
};

/// @param progress  told what comes next; may throw to stop
ThighStudy thigh_study(const ThighStudyOptions& options,
                       const std::function<void(const std::string&)>& progress);

}  // namespace hmax
