/// Limits of the step as they are stored: predictions, what verified them, and the states they hold near.
/// Another column is another layout, see Store::schema_version.
#pragma once

#include <cmath>
#include <compare>
#include <cstdint>
#include <limits>
#include <string>

#include "results/fields.hpp"

namespace hmax {

/// What identifies a state of a model near which limits are asked for.
struct OperatingPointKey {
  std::string problem;     ///< catalogue id, or the name a user's file gives itself
  std::string material;    ///< material id, empty when the problem has none
  std::string parameters;  ///< all parameters, as RowKey::parameters
  std::string y0;          ///< initial state, as RowKey::y0
  std::string model;       ///< digest of the right-hand side, so that a changed file is another model
  std::string asked;       ///< the state that was asked for: equilibrium | rest
  std::string path{};      ///< what limits are also looked for along: motion | load; empty for nothing
  double t_end = 0;        ///< end of that motion [s]; 0 without one

  auto operator<=>(const OperatingPointKey&) const = default;
};

inline constexpr Field<OperatingPointKey> point_key_fields[] = {
    HMAX_FIELDS(OperatingPointKey, problem, material, parameters, y0, model, asked, path, t_end)};

/// A state near which a model was linearised.
struct OperatingPointRow {
  OperatingPointKey key;
  std::string document;  ///< facts of the model and of the state, a JSON object
};

/// The limit of one method near an operating point. Numbers that do not apply are NaN, limits that no step
/// reaches are infinite.
struct LimitRow {
  static constexpr double none = std::numeric_limits<double>::quiet_NaN();

  OperatingPointKey point;
  std::string method;        ///< method id
  std::string bound;         ///< stability | accuracy | newton | model | every_step | error_control | unknown
  std::string state_kind;    ///< equilibrium | rest | initial | motion
  std::string state;         ///< in words: which state, whose Jacobian
  std::string note;          ///< why there is no limit, or what it holds for; may be empty
  double h_max = none;       ///< [s]
  double h_unstable = none;  ///< where h_max is a lower bound: unstable from here on [s]
  double re = none, im = none, omega = none, zeta = none;  ///< of the limiting mode [1/s, 1/s, rad/s, 1]
  double rate_slow = none, rate_fast = none;               ///< of one that does not oscillate [1/s]

  double newton_h = none;            ///< where Newton's method sets the step: solved up to here [s]
  std::string newton;                ///< "limit" where the next step tried is not solved, else "at_least"
  double newton_error = none;        ///< error of that step [m]
  double newton_error_bound = none;  ///< of the error itself [m]

  /// Of runs on both sides: confirmed | excused | contradicted | not_run; empty where nobody asked for runs.
  std::string verdict;
  double observed = none;     ///< [s]
  double gap = none;          ///< (observed - h_max) / h_max
  double steps_used = none;   ///< steps of each run
  double step_defect = none;  ///< distance of the steps of the code from what is analysed

  double along_least = none;        ///< the least limit along the path [s]
  double along_at = none;           ///< where it occurs: time [s], or share of the load
  double along_growing = none;      ///< share of the path where the tangent itself grows
  double along_grows_from = none;   ///< where it first does
  std::string path_note;            ///< why the path ends early; may be empty
  double from_start = none;         ///< the largest step below the first whose run leaves its motion [s]
  double from_start_stride = none;  ///< relative stride in which it was sought; 0: it could not be

  /// The least limit that is known [s]: of small motions, of the states along the motion, and the first step
  /// whose run left it. Infinite: no step is unstable; nothing: it is not known whether one is.
  [[nodiscard]] double known_limit() const {
    const double least = std::fmin(h_max, along_least),
                 limit = std::isfinite(from_start) ? std::fmin(least, from_start) : least;
    return std::isnan(h_max) && std::isinf(limit) ? none : limit;
  }

  /// The largest step that is known to be safe for the motion [s]: below the limits of small motions and of
  /// the states along it, and below the first step whose run failed. Nothing where no run showed it.
  [[nodiscard]] double safe() const {
    return std::isnan(from_start) ? none : std::fmin(longest_run(), std::fmin(h_max, along_least));
  }
  /// The longest step whose run held, as did all shorter ones; where none failed a tenth of the motion.
  [[nodiscard]] double longest_run() const { return std::isinf(from_start) ? point.t_end / 10 : from_start; }

  std::string details;       ///< JSON object: margins of the modes, limits along the path
  std::int64_t session = 0;  ///< session that computed it; set by the store, 0 before

  /// Whether it is of a body at rest, since the equilibrium that was asked for was not found.
  [[nodiscard]] bool lacks_equilibrium() const {
    return point.asked == "equilibrium" && state_kind == "rest";
  }
  /// Whether runs showed something.
  [[nodiscard]] bool is_observed() const { return !verdict.empty() && verdict != "not_run"; }
};

inline constexpr Field<LimitRow> limit_fields[] = {
    HMAX_FIELDS(LimitRow, method, bound, state_kind, state, newton, verdict, path_note, note, details, h_max,
                h_unstable, re, im, omega, zeta, rate_slow, rate_fast, newton_h, newton_error,
                newton_error_bound, observed, gap, steps_used, step_defect, along_least, along_at,
                along_growing, along_grows_from, from_start, from_start_stride)};

}  // namespace hmax
