/// Advice as it is stored: every method that was tried at its step, for one question.
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <limits>
#include <string>

#include "results/fields.hpp"

namespace hmax {

/// What identifies a question.
struct AdviceKey {
  std::string problem;     ///< catalogue id, or the name a user's file gives itself
  std::string material;    ///< material id, empty when the problem has none
  std::string parameters;  ///< all parameters, as RowKey::parameters
  std::string y0;          ///< initial state, as RowKey::y0
  std::string model;       ///< digest of the right-hand side
  std::string motion;      ///< the motion by which steps are judged, in words
  std::string ranked_by;   ///< cost | error
  double rate = 0;         ///< frames a second [Hz]
  double tolerance = 0;    ///< relative error
  double budget = 0;       ///< CPU time of a frame [s]

  auto operator<=>(const AdviceKey&) const = default;
};

inline constexpr Field<AdviceKey> advice_key_fields[] = {
    HMAX_FIELDS(AdviceKey, problem, material, parameters, y0, model, motion, ranked_by, rate, tolerance),
    {"budget_s", &AdviceKey::budget}};

/// Shares of the frames, for the distribution of their times.
inline constexpr std::array<double, 11> frame_shares{0.99, 0.9,  0.75, 0.5,   0.25, 0.1,
                                                     0.05, 0.02, 0.01, 0.005, 0.001};

/// What was found of a method at its step. Numbers that do not apply are NaN, limits that no
/// step reaches are infinite.
struct StepFindings {
  static constexpr double none = std::numeric_limits<double>::quiet_NaN();

  double h = none;               ///< [s]
  double h_max = none;           ///< predicted, the least along the motion [s]; infinity: no step is unstable
  double h_max_observed = none;  ///< on the motion, to 0.25 % [s], of rows that suit
  double h_accurate = none;      ///< the longest step tried that meets the tolerance [s]
  double error = none;           ///< relative to the largest displacement, no less than that of the reference
  double first_frame = none;     ///< CPU time with what is done once, such as the first factors [s]
  double newton_per_frame = none;  ///< iterations of Newton's method that 99.9 % of the frames do not exceed
  double linear_per_frame = none;  ///< the same of conjugate gradients
  double stiffening = none;        ///< how many times stiffer the model may become before h is unstable
  std::string status;              ///< what the verdict rests on, or why a number is missing
};

/// One method with its options at the step that was found.
struct AdviceRecord : StepFindings {
  AdviceKey key;
  std::string method;  ///< method id
  std::string
      options;        ///< what a simulator chooses besides the step: "Jacobian frozen, direct"; may be empty
  std::string bound;  ///< stability | accuracy | newton | budget | rate
  std::string verdict;  ///< recommended | tie | suitable | unstable | inaccurate | too_slow | predicted
  /// CPU times that the first frame_shares of the frames exceed, with spaces between [s]; of so few frames as
  /// to have no such share fewer, empty where none was timed.
  std::string frame_tail;
  /// How far the search was when the answer was stored: done, or where it ended early: predicting | searching
  /// | timing | proving | observing | remedies.
  std::string stage = "done";
  double steps_per_frame = none;
  double frame_p50 = none, frame_p99 = none, frame_max = none;  ///< CPU time [s]
  double frames = none, missed = none;
  double memory = none;      ///< [bytes]
  std::int64_t session = 0;  ///< session that computed it; set by the store, 0 before

  /// Stable, accurate and in time.
  [[nodiscard]] bool suits() const {
    return verdict == "recommended" || verdict == "tie" || verdict == "suitable";
  }
  /// Whether the search was interrupted before its rows could be judged against one another.
  [[nodiscard]] bool is_of_unfinished_search() const { return stage != "done" && stage != "remedies"; }
  /// "rk4", "linearly_implicit_euler, Jacobian frozen, direct"
  [[nodiscard]] std::string words() const { return options.empty() ? method : method + ", " + options; }
};

inline constexpr Field<AdviceRecord> advice_fields[] = {
    HMAX_FIELDS(AdviceRecord, method, options, bound, verdict, status),
    {"frame_tail_s", &AdviceRecord::frame_tail},
    HMAX_FIELDS(AdviceRecord, stage, h, steps_per_frame, h_max, h_max_observed, h_accurate, error),
    {"frame_p50_s", &AdviceRecord::frame_p50},
    {"frame_p99_s", &AdviceRecord::frame_p99},
    {"frame_max_s", &AdviceRecord::frame_max},
    {"first_frame_s", &AdviceRecord::first_frame},
    HMAX_FIELDS(AdviceRecord, frames, missed, newton_per_frame, linear_per_frame),
    {"memory_bytes", &AdviceRecord::memory},
    {"stiffening", &AdviceRecord::stiffening}};

/// The body that a question is about, to look at.
struct AdviceScene {
  AdviceKey key;
  std::string scene;         ///< JSON, as scene_text() of plots/pages writes it; never read here
  std::int64_t session = 0;  ///< as AdviceRecord::session
};

/// What is said of an answer beside its rows.
struct AdviceWords {
  AdviceKey key;
  std::string words;         ///< JSON, as answer_text() of plots/pages writes it; never read here
  std::int64_t session = 0;  ///< as AdviceRecord::session
};

}  // namespace hmax
