/// The multipliers of one step of an engine, or of its steps along a motion, at one step size.
#pragma once

#include <complex>
#include <functional>
#include <limits>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "analysis/dynamics/shown_mode.hpp"
#include "analysis/foreign_steps/foreign_stepper.hpp"
#include "analysis/foreign_steps/step_pattern.hpp"

namespace hmax {

struct StepSpectrumSettings {
  Eigen::Index eigenvalues_to = 300;  ///< up to so many coordinates all eigenvalues of the matrix
  Eigen::Index matrix_to = 1000;      ///< up to so many the matrix, and its largest eigenvalue by Arnoldi
                                      ///< iteration; above that products alone, or the matrix by a pattern
  double creep = 0;                   ///< [1/s]: what grows at most at this rate counts as rest
  std::function<void()> watch = {};   ///< called now and then; may throw
};

/// What a step makes of a motion that oscillates or decays.
struct StepMotion {
  std::complex<double> rate;  ///< log(multiplier) / h [1/s], not below the real axis
  double error = 0;           ///< of the multiplier, beside its distance from 1
  Eigen::VectorXcd shape;     ///< in units of scales, of length 1, shape (coordinates)
};

/// What a step of size h makes of small differences of states.
struct StepSpectrum {
  double h = 0;                ///< [s]
  double spectral_radius = 0;  ///< infinity where a step cannot be done, or leaves the range of numbers
  /// That grows most, or the largest one where none grows; NaN along motions.
  std::complex<double> multiplier{};
  /// Of |multiplier|: how far it may be off by differences. A multiplier of modulus 1 to this accuracy does
  /// not grow. Of a step that is not resolved the growth that may be there unseen.
  double tolerance = 0;
  double increment = 0;  ///< of the differences, in units of scales
  bool grows = false;
  bool resolved = true;      ///< false: growth of less than `tolerance` a step may be there unseen
  Eigen::VectorXd motion{};  ///< that grows, as numbers of the state; shape (dim), its largest number 1
  std::vector<StepMotion> motions{};  ///< all of them, where all eigenvalues were computed

  // Of a probe (step_probe.hpp):
  std::optional<bool> settles{};  ///< whether steps have a state of rest and nothing grows near it
  Eigen::VectorXd settled{};      ///< that state, shape (dim); empty where none was found
  /// |settled - that of the smallest step| / |that of the smallest step|
  double settled_moves = std::numeric_limits<double>::quiet_NaN();
  std::vector<ShownMode> modes{};  ///< near it: the slowest of the smallest step, and what this one shows
};

/// About the state of the engine in `slot`. Each eigenvalue has a tolerance of its own, as
/// multiplier_tolerance(): of modulus 1 are all multipliers of undamped motions under symplectic methods,
/// pairs of them meet, and those of rigid motions are defective.
/// @param pattern  of the step, in coordinates; where it pays the matrix is made by its groups at any size.
/// It is learned
///                 where a matrix is made without it
StepSpectrum spectrum_of_step(ForeignStepper& engine, const StateCoordinates& coordinates,
                              const Eigen::VectorXd& scale, int slot, const Eigen::VectorXd& y, double h,
                              StepPattern& pattern, const StepSpectrumSettings& settings = {});

/// A motion in scaled coordinates as numbers of the state, shape (dim), the largest of them 1.
Eigen::VectorXd motion_on_state(const Eigen::VectorXd& motion, const StateCoordinates& coordinates,
                                const Eigen::VectorXd& scale, Eigen::Index dim);

/// Whether what grows at two step sizes is one motion of the model, as one that leaves an unstable state: it
/// grows at the same rate in time, to a fifth, and is slow beside the steps.
bool is_growth_of_model(const StepSpectrum& a, const StepSpectrum& b);

/// ln of the factor by which `steps` steps from the state in `slot` stretch the difference of two neighbours:
/// the product of the derivatives of the steps, applied twice to a vector, the second time to what the first
/// one made of it.
/// @param work  a slot that is written
/// @return infinity where a step cannot be done or leaves the range of numbers
double growth_along_motion(ForeignStepper& engine, const StateCoordinates& coordinates,
                           const Eigen::VectorXd& scale, int slot, int work, double h, std::int64_t steps,
                           double increment, const std::function<void()>& watch);

}  // namespace hmax
