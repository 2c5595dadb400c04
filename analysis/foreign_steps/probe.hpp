/// A probe of an engine at work: what its parts share.
#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "analysis/foreign_steps/observed_steps.hpp"
#include "analysis/foreign_steps/step_derivative.hpp"
#include "analysis/foreign_steps/step_probe.hpp"
#include "analysis/foreign_steps/step_rest.hpp"

namespace hmax {

/// What all parts of a probe need.
class StepProbe {
 public:
  StepProbe(ForeignStepper& engine, const ProbeSettings& settings)
      : engine_(engine), settings_(settings), coordinates_(engine.dim(), engine.quaternions()) {}

  ProbedLimit run();
  ProbedLimit compare();

 private:
  void look_at_start();
  bool only_trembles(double moved);
  void judge_start();
  Eigen::VectorXd balanced(const Eigen::VectorXd& unbalanced, double h);
  void choose_scales(double h);
  void check_smoothness();
  void find_limit();
  [[nodiscard]] int count_of_sizes() const;
  [[nodiscard]] double size_of(int i, int count) const;
  [[nodiscard]] double steps_of_search() const;
  void refuse_endless_search();
  void search();
  void forget_limit();
  bool creeps(double rate);
  double distance_of_step(const Eigen::VectorXd& y, double h) {
    return hmax::distance_of_step(engine_, coordinates_, scale_, home, y, h);
  }
  StepRest rest_near(const Eigen::VectorXd& y, double h, double tolerance) {
    return rest_of_step(engine_, coordinates_, scale_, home, y, h, pattern_, tolerance,
                        1e3 * rest_tolerance());
  }
  Eigen::VectorXd rest_at(double h);
  bool looks_at_kinks(double h);
  [[nodiscard]] bool hides_growth(const StepSpectrum& row) const;
  std::string part_of_kink(const StepKink& kink);
  void say_where_kink_is(const StepKink& kink);
  StepSpectrum across_kink(double h);
  StepSpectrum spectrum_near(const Eigen::VectorXd& y, double h);
  StepSpectrum at(double h);
  void look_where_it_settles(StepSpectrum& row);
  StepSpectrum along_motion(double h);
  void bisect(double low, double high);
  void refuse_equal_steps(double h, double other);
  bool fades(const StepSpectrum& row);
  void explain_growth_at_least();
  void judge_across_kink();
  void look_for_earlier_growth();
  void check_rest_at_limit();
  void check_pattern();
  void name_growing_numbers();
  void find_shares();
  void observe();
  bool runs_grow(double h);
  std::int64_t observed_steps();
  double seconds_of_step();
  [[nodiscard]] double beyond_limit() const;
  void contradict_at_least();
  void bracket(double low, double high);
  void narrow(double low, double high, double resolution);
  void compare_with_runs();
  void observe_beyond_limits();
  void observe_jumping();
  void say_what_is_unresolved();
  void compare_rests();
  void say_what_steps_show();
  /// One of the two limits is wrong, unless runs leave the state that multipliers tell of.
  void contradict(const std::string& runs, const std::string& text) {
    const bool leave = found_.state == ProbedState::initial;
    found_.contradiction = !leave;
    found_.status.push_back(leave ? "runs leave this state, and " + runs : text);
  }

  /// Sizes of numbers at the start.
  [[nodiscard]] Eigen::VectorXd plain_scale() const {
    return coordinates_.scales(engine_.scales().size() > 0 ? engine_.scales() : scales_of(start_));
  }
  /// Between two states, in units of scales.
  [[nodiscard]] double distance(const Eigen::VectorXd& a, const Eigen::VectorXd& b) const {
    return coordinates_.of(a, b).cwiseQuotient(scale_).cwiseAbs().maxCoeff();
  }
  [[nodiscard]] double rest_tolerance() const { return is_single() ? 1e-6 : 1e-9; }
  [[nodiscard]] bool is_single() const { return engine_.is_single_precision(); }
  void tell(double share, std::string_view detail) const {
    if (settings_.watch) settings_.watch(share, detail);
  }
  [[nodiscard]] std::function<void()> watcher() const {
    return [this] { tell(share_, detail_); };
  }
  [[nodiscard]] std::int64_t steps_of_run(double h) const;
  [[nodiscard]] GrowthRun growth_run(double h) const;
  [[nodiscard]] std::int64_t steps_of_motion(double h) const {
    return std::max<std::int64_t>(1, std::llround(*settings_.motion / h));
  }

  static constexpr int home = 0, work = 1, at_rest = 2;  // slots
  static constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  /// ln of 10: a motion that grows by less than this factor more than at h0 is no growth of the steps.
  static constexpr double least_growth = 2.302585092994046;

  ForeignStepper& engine_;
  const ProbeSettings& settings_;
  StateCoordinates coordinates_;
  Eigen::VectorXd start_, scale_;
  Eigen::VectorXd rest_;  // at the step size that was last looked at
  Eigen::VectorXd settled_;
  std::vector<StepMotion> slow_;  // of h0
  bool compares_ = false;
  StepPattern pattern_;
  ProbedLimit found_;
  double base_growth_ = 0, base_run_ = nan;
  double creep_ = 0;  // [1/s]
  bool restart_ = false;
  std::vector<std::string> remarks_;  // before a limit was sought
  double share_ = 0;
  std::string detail_ = "steps";
};

}  // namespace hmax
