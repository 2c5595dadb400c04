/// The cases of the liver oscillator study as data: four named problems, the families its figures vary, its
/// steps. What the study does not publish is chosen here and said so beside the number.
#pragma once

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "problems/oscillator/oscillator.hpp"

namespace hmax {

/// An initial value problem of the oscillator on [0, t_end].
struct LiverProblem {
  std::string_view id;
  OscillatorParameters parameters;
  Eigen::Vector2d y0;     ///< x(0) [m], x'(0) [m/s]
  double t_end;           ///< [s]
  std::string_view note;  ///< one line: which case it is and what we chose
};

/// liver_linear (case 1), liver_cubic (case 2), liver_forced (case 3, the full model), liver_benchmark (a
/// material of the table, male_normal unless `with_material` puts another one in). All start at the published
/// (0.5, 1) and run to t = 100 s.
std::span<const LiverProblem> liver_problems();

/// @throws std::invalid_argument  for an unknown id, naming the known ones
const LiverProblem& liver_problem(std::string_view id);

/// One curve of a figure.
struct LiverFamilyMember {
  std::string label{};  ///< what distinguishes it, with its unit: "m = 1.2 kg", "male_fat"
  OscillatorParameters parameters;
};

/// Curves that are drawn together.
struct LiverFamily {
  std::string_view id;
  int figure;  ///< its number in the study
  std::vector<LiverFamilyMember> members;
  Eigen::Vector2d y0;
  double t_end;           ///< long enough to see the motion settle [s]
  std::string_view note;  ///< which values are published and which are ours
};

/// In the order of the study's figures 1 to 8; figure 1 is the timing experiment, both ways.
std::span<const LiverFamily> liver_families();

/// @throws std::invalid_argument  for an unknown id, naming the known ones
const LiverFamily& liver_family(std::string_view id);

/// The family with the damping c = 2 zeta sqrt(k1 m) of each member's linear part.
LiverFamily damped_as_at_rest(LiverFamily family, double zeta);

/// The step sizes of the study's timing experiment [s].
inline constexpr std::array<double, 9> liver_step_sizes{2,    0.6,   0.2,    0.15,   0.05,
                                                        0.01, 0.005, 0.0005, 0.00005};

}  // namespace hmax
