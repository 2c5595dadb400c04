/// What is known of a model before its candidates are tried: the motion, its reference, and the limits along
/// it.
#pragma once

#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "advice/motion/candidate.hpp"
#include "advice/motion/probing_motion.hpp"
#include "limits/linearised_problem.hpp"

namespace hmax {

/// The predicted limit of one candidate.
struct CandidateLimit {
  double h_max =
      std::numeric_limits<double>::quiet_NaN();  ///< [s]; infinity: no step is unstable, NaN: not known
  std::string status{};                          ///< why it is not known
  bool of_start = false;                         ///< of the start alone: none is known along the motion
  bool pending = false;                          ///< not sought yet: pending_limit() does
};

struct AnalysedModel {
  ProbingMotion motion;
  ReferenceMotion reference;
  Linearised near;  ///< at the start of the motion
  /// The same, as much stiffer as stiffer() (advice/motion/uncertainty.hpp) makes it.
  std::optional<Linearised> stiffer;
  /// The start with its stiffness times a factor; null where that cannot be made.
  std::function<std::optional<Linearised>(double factor)> with_stiffness = {};
  Path path;                           ///< where limits are looked for
  std::vector<Linearised> elsewhere;   ///< of bodies where the motion makes them stiffest, of small problems
                                       ///< along it; may be empty
  std::vector<CandidateLimit> limits;  ///< of each candidate
  double stiffened =
      1;               ///< times the square of the fastest frequency at the start: the most along the motion
  double fastest = 0;  ///< the fastest undamped frequency at the start [rad/s]; 0: not known
  std::vector<std::pair<double, double>>
      slow;  ///< at most three slowest oscillations at the start [rad/s], damping ratios
};

/// Fills AnalysedModel::limits, and what the motion makes of the model: the least limits at the start and at
/// ten states of the reference, five of the largest bodies, of models without a mesh at 3 to 50 of them, the
/// fewer the larger they are, and of up to 20 states that are not stiff at 400 states of the motion. Limits
/// that no mode tells, of Jacobians that are frozen, of truncated iterations and of implicit-explicit steps,
/// come from the maps of their steps, of models up to 2000 states: at the start and where the body is
/// stiffest, or of small problems at ten states and where the central difference has its least limit. Of more
/// than 20 states these take seconds each and are left pending, as are bodies' limits of methods that choose
/// their stages by a spectral radius. Of larger bodies frozen Jacobians have that of an undamped spring which
/// stiffens as much as the fastest mode.
/// @param progress  called with the number of each candidate before its turn
void predict_limits(AnalysedModel& model, const std::vector<Candidate>& all, const Watcher& watcher,
                    const std::function<void(std::size_t)>& progress = {});

/// The limit of a candidate that predict_limits() left pending.
CandidateLimit pending_limit(const Candidate& candidate, const AnalysedModel& model, const Watcher& watcher);

/// How many times stiffer than on the motion the model may become before steps of h are unstable: of frozen
/// Jacobians from the maps of their steps where the motion makes the model stiffest, infinity from 64 on, or
/// of the largest bodies as predict_limits(). Of other methods (h_max / h)^(-1 / e), where e = d ln h_max / d
/// ln K comes from AnalysedModel::stiffer, of small models from the factor itself, and is -1/2 of undamped
/// models without it. NaN where no limit is known, of models without a stiffness, where stiffness is not what
/// limits steps, the Jacobian is of every tenth step, the iteration truncated or the method
/// implicit-explicit.
/// @param h_max  of the candidate, as CandidateLimit
double stiffening_margin(const Candidate& candidate, double h_max, const AnalysedModel& model, double h,
                         const Watcher& watcher);

}  // namespace hmax
