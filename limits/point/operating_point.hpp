/// A problem near a state: where limits are asked for.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "analysis/amplification/curve_limit.hpp"
#include "analysis/spectrum/linear_model.hpp"
#include "analysis/spectrum/spectrum.hpp"
#include "problems/linearity.hpp"

namespace hmax {

/// Degrees of freedom up to which all modes are computed, where their motion decouples.
inline constexpr Eigen::Index most_dense_modes = 1500;

class SlowEnd;
struct ModeRange;

/// Which state of a body its linear model is asked for.
enum class AskedState { equilibrium, rest };

/// The state that a model was linearised at.
enum class StateKind {
  equilibrium,
  rest,      ///< of a body: without displacement
  initial,   ///< of other problems: no equilibrium was found
  matrices,  ///< of matrices of a user, which hold in every state
  motion,    ///< a state that was given
};

constexpr std::string_view name_of(StateKind kind) {
  constexpr std::array<std::string_view, 5> names{"equilibrium", "rest", "initial", "matrices", "motion"};
  return names.at(static_cast<std::size_t>(kind));
}

/// Called with |F| / |F(0)| of each iterate while a static equilibrium is searched for.
using EquilibriumWatcher = std::function<void(double residual)>;

/// A problem near a state: its linear model, which state it is, and what else a limit depends on.
struct OperatingPoint {
  std::string problem = {}, material = {};  ///< as Problem has them
  std::vector<std::pair<std::string, double>> parameters = {};
  bool is_body = false;
  LinearModel model;
  StateKind kind = StateKind::motion;
  bool at_equilibrium = false;
  std::string state = {};    ///< in words: which state, whose Jacobian
  std::string status = {};   ///< why it is not the state that was asked for
  bool at_kink = false;      ///< the slopes jump at this state; the model is that of the stiffest side
  std::string missing = {};  ///< says that a tool does not touch the body in this state
  /// Of the problem, from its structure (catalogue/models/model.hpp).
  Linearity linearity = Linearity::unknown;
  /// The bound of the spectral radius here that the system has [1/s]; null where it has none. It takes a
  /// while for a large body, and few methods ask for it.
  std::function<double()> radius_bound = {};
  /// The linear model at another state and the same time, shape (dim). Asked for where `linearity` is
  /// unknown, by methods that solve nonlinear equations.
  std::function<LinearModel(const Eigen::VectorXd& y)> model_at = {};
};

/// What is known of the modes of a linear model.
struct ModeSet {
  Spectrum spectrum = {};  ///< all of it, or with `curve` the modes at its ends
  /// Of proportionally damped models of more than most_dense_modes degrees of freedom.
  std::optional<DampingCurve> curve = {};
  /// Where the slow end of the curve is only bounded by 0, what finds it.
  std::shared_ptr<SlowEnd> slow_end = {};
  /// Of the fastest mode of a body at rest with a curve, of length 1 in the norm of M, shape (dofs); else
  /// empty.
  Eigen::VectorXd fastest_shape = {};
  /// Of models whose damping couples more degrees of freedom than most_dense_coupled; `spectrum` then lists
  /// the largest eigenvalues.
  std::shared_ptr<ModeRange> range = {};
  /// A negative stiffness that the few digits of K may have made, and that counts as 0 without its shape
  /// being known, as a share of the largest one; 0 where there is none.
  double rounded = 0;
};

/// An operating point and its modes: what limits are predicted from.
struct Linearised {
  OperatingPoint point;
  ModeSet modes = {};
};

/// Degrees of freedom of a mesh up to which a factor of K takes less than a second.
inline constexpr Eigen::Index most_cheaply_factored = 20'000;

}  // namespace hmax
