/// Advice as it is stored: every method that was tried at its step, for one question.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <string>

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

  bool operator==(const AdviceKey&) const = default;
};

/// Shares of the frames, for the distribution of their times.
inline constexpr std::array<double, 11> frame_shares{0.99, 0.9,  0.75, 0.5,   0.25, 0.1,
                                                     0.05, 0.02, 0.01, 0.005, 0.001};

/// One method with its options at the step that was found. Numbers that do not apply are NaN, limits that no
/// step reaches are infinite.
struct AdviceRecord {
  static constexpr double none = std::numeric_limits<double>::quiet_NaN();

  AdviceKey key;
  std::string method;  ///< method id
  std::string
      options;        ///< what a simulator chooses besides the step: "Jacobian frozen, direct"; may be empty
  std::string bound;  ///< stability | accuracy | newton | budget | rate
  std::string verdict;  ///< recommended | tie | suitable | unstable | inaccurate | too_slow | predicted
  std::string status;   ///< what the verdict rests on, or why a number is missing
  /// CPU times that the first frame_shares of the frames exceed, with spaces between [s]; of so few frames as
  /// to have no such share fewer, empty where none was timed.
  std::string frame_tail;
  /// How far the search was when the answer was stored: done, or where it ended early: predicting | searching
  /// | timing | proving | observing | remedies.
  std::string stage = "done";
  double h = none;  ///< [s]
  double steps_per_frame = none;
  double h_max = none;                                          ///< predicted [s]
  double h_max_observed = none;                                 ///< [s]
  double h_accurate = none;                                     ///< [s]
  double error = none;                                          ///< relative
  double frame_p50 = none, frame_p99 = none, frame_max = none;  ///< CPU time [s]
  double first_frame = none;                                    ///< [s]
  double frames = none, missed = none;
  double newton_per_frame = none;  ///< iterations of Newton's method that 99.9 % of the frames do not exceed
  double linear_per_frame = none;  ///< the same of conjugate gradients
  double memory = none;            ///< [bytes]
  double stiffening = none;
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
