/// The sentences of the liver oscillator study that can be tested, each with what runs show.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "catalogue/methods/method.hpp"
#include "integrators/stats.hpp"
#include "problems/oscillator/oscillator.hpp"
#include "results/json.hpp"
#include "results/row.hpp"

namespace hmax {

/// The forced model of the study with other parameters, from y0 = (x, v).
Problem forced_liver(const OscillatorParameters& parameters, const Eigen::Vector2d& y0);

/// What a test says of a sentence.
struct Judged {
  static constexpr std::string_view holds = "holds", holds_in_part = "holds in part",
                                    does_not_hold = "does not hold";
};
std::string_view judged(bool whole, bool in_part = false);

/// Sentences that can be tested, by names of ours: {"judgement": ..., and the numbers of runs that it rests
/// on}. Their words stand in the text of the report.
using Claims = Json;

/// How many there are and how many of them hold, hold in part and do not hold.
Claims counts_of(const Claims& claims);

/// What it says of the motion, sections 3.3 A to D: damping, stiffness, mass, force. Runs of dop_853, the
/// same on every machine but for rounding. Lengths in m, times in s, shares of 1.
Claims claims_on_motion();

/// An adaptive run of liver_forced.
struct SolverWork {
  std::string method;
  double rtol = 0, atol = 0;
  Stats stats = {};
  double error = 0;  ///< largest |x| or |v| off the motion at any step [m], [m/s]
};

/// The solvers of the study that choose their steps, with MATLAB's defaults (rtol 1e-3, atol 1e-6, its step
/// size control) and with rtol = atol = 1e-6 and the control of hmax.
std::vector<SolverWork> work_at_defaults();

/// What it says of the five solvers, sections 2.2, 2.4 and 3.1. Sentences on accuracy are judged at the
/// tolerances that were in force, MATLAB's defaults.
/// @param rows  of liver_forced: both readings of the step sizes of the study, its five solvers at least.
///              Times are those of the machine that measured them
/// @param work  of work_at_defaults()
Claims claims_on_solvers(const std::vector<Row>& rows, const std::vector<SolverWork>& work);

}  // namespace hmax
