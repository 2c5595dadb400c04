/// Limits of the step where the model does not stay near rest: along a motion or under a growing load, and
/// from a start of its own.
#pragma once

#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "catalogue/methods/method.hpp"
#include "limits/along/motion_run.hpp"

namespace hmax {

/// States that a model passes.
struct Path {
  std::vector<double> at{};          ///< the instant of each [s], or its share of the load
  std::vector<Eigen::VectorXd> y{};  ///< shape (dim) each
  std::string note = {};             ///< why it ends early; empty when it does not
  MotionTolerances tolerances = {};  ///< of a motion
};

/// The times up to t_end at which matrices of a user are given, with the state zero, as a linear model is the
/// same in all of them; t = 0 alone where they do not change. Nothing for other problems.
/// @throws InputError  when t_end is not positive
std::optional<Path> path_of_matrices(const Problem& problem, double t_end);

/// The motion from y0 to t_end by dormand_prince_54 at motion_tolerances(), looked at `points` times; of a
/// body as far as none of its elements is turned inside out; of matrices path_of_matrices(). Of other
/// problems that are not linear also at the accepted steps between two instants at which the trace of J or of
/// J^2 goes beyond theirs, and on both sides of the breakpoints of the system, so that no short event is
/// passed over.
/// @throws InputError  when t_end is no end of a run, or the motion does not reach it within
/// most_observed_steps attempts
Path motion_path(const Problem& problem, double t_end, int points = 400, const Watcher& watcher = {});

/// Strides of the load that users are told of.
inline constexpr int load_strides = 40;
/// The equilibria of a body under shares of its load from 0 to 1 in `points` equal strides, as far as there
/// are any.
/// @throws InputError  for what is no body, and for loads that change with time
Path load_path(const Problem& problem, int points = load_strides, const Watcher& watcher = {});

/// h_max of the tangent frozen at the points of a path: for stability at each of them it is necessary, for
/// the motion it proves nothing. A step longer than the least may be stable where a motion passes that point
/// quickly, and a shorter one unstable where modes turn into one another. Runs tell, see limit_from_start().
struct TrajectoryLimit {
  std::vector<double> t,  ///< as Path::at
      h_max{};  ///< [s], of the modes that do not grow; NaN without an answer, infinity where nothing limits
  double least = 0;  ///< the smallest of them; infinity when nothing limits, NaN when no point has an answer
  double t_least = 0;                                            ///< where it occurs, as Path::at
  Eigen::VectorXd y_least{};                                     ///< the state there, shape (dim)
  double growing = 0;                                            ///< share of the points whose tangent grows
  double grows_from = std::numeric_limits<double>::quiet_NaN();  ///< the first of them, as Path::at
  std::string note = {};             ///< why points have no answer; empty where all have one, or only grow
  bool constant = true;              ///< the Jacobian is the same at all points, to what it is known to
  MotionTolerances tolerances = {};  ///< of a motion
};

/// Of each method; nothing for those without an amplification, or that the problem does not suit. Of bodies
/// with more than small_enough_for_dense degrees of freedom the slowest and the fastest mode of each tangent
/// are computed, and the limit is the least on the curve of damping between them.
std::vector<std::optional<TrajectoryLimit>> limits_along(std::span<const Method> methods,
                                                         const Problem& problem, const Path& path,
                                                         const Watcher& watcher = {});

/// The same of one method and the motion from y0.
std::optional<TrajectoryLimit> limit_along(const Method& method, const Problem& problem, double t_end,
                                           int points = 400);

/// How far a motion goes from the origin, in parts that have one unit each, and where it is.
struct MotionSize {
  double positions = 0;                 ///< the largest |q|; of problems that are not mechanical |y|
  double velocities = 0;                ///< the largest |v|; 0 for those
  std::vector<double> t = {};           ///< instants, rising [s]; none: the size alone is known
  std::vector<Eigen::VectorXd> y = {};  ///< the motion there, linear between them; shape (dim) each
};

/// Of the motion from y0 to t_end, looked at after every step; of the states as many are kept as fill 64 MB.
/// @throws InputError  as motion_path()
MotionSize size_of_motion(const Problem& problem, double t_end, const Watcher& watcher = {});

/// Where to begin a search for the step whose run leaves its motion [s]: at the least limit along the motion,
/// else at that of one state, else far below the motion; at most a twentieth of the motion, so that its runs
/// have some steps.
double guess_from_start(double along_least, double h_max, double t_end);

/// Steps of all runs of a search together that takes a blink, and of one that takes a quarter of a second,
/// both of an oscillator.
inline constexpr double quick_search = 5e4, thorough_search = 2e6;

/// Below the first step whose run leaves its motion.
struct StartLimit {
  double h;       ///< the largest step below it whose run was seen to stay [s]; infinity where none fails
  double stride;  ///< relative; a window of failures that is narrower may have been passed over
};

/// The first step, upwards from a tenth of `guess`, whose run at fixed step from y0 to t_end is farther from
/// the true motion at the same time than three times its size, positions and velocities apart, to one part in
/// ten thousand. Three sizes, because a run that stays on the orbit may be two away by its phase. Steps that
/// fail come in windows, between which longer ones stay: the strides are as short as so many steps in all
/// allow, from 2 % down to 0.01 %, and 2 % beyond a hundred guesses. Infinity when steps up to a tenth of
/// the run stay; nothing when the first one already does not, or the run is shorter than twenty guesses, or
/// even strides of 2 % take 25 times as many steps, or the motion stays at its start, as every run does.
/// @param size   of that motion, the same for every method
/// @param steps  of all runs together
std::optional<StartLimit> limit_from_start(const Method& method, const Problem& problem, double t_end,
                                           double guess, const MotionSize& size,
                                           double steps = thorough_search, const Watcher& watcher = {});

}  // namespace hmax
