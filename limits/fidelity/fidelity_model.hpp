/// A model in its static equilibrium: what the steps of a method are compared with.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "analysis/dynamics/differences.hpp"
#include "analysis/dynamics/shown_mode.hpp"
#include "catalogue/methods/method.hpp"
#include "core/mass_matrix.hpp"

namespace hmax {

/// M q'' = F(q, q') in its static equilibrium. Displacements are those from the initial position q(0), of a
/// body its mesh; the load is the force that acts there on the model at rest and does not change with time.
struct FidelityModel {
  Problem problem;
  Eigen::VectorXd start{};  ///< q(0), shape (dofs); zero of a body [m]
  /// M, shape (dofs, dofs) [kg]; of formulas, which tell accelerations, one that makes K symmetric.
  MassMatrix<double> mass{};
  Eigen::VectorXd load{};  ///< f = F(q(0), 0) [N], shape (dofs): of a body the weight and the dead loads
  Eigen::VectorXd equilibrium{};   ///< displacement [m], shape (dofs); zero where nothing loads the model
  Eigen::VectorXd sizes{};         ///< displacements as large as those that matter, shape (dofs), not zero
  double volume = 0;               ///< of a body there [m^3]
  std::vector<ShownMode> modes{};  ///< the slowest ones near it, not yet shown by anything
  std::string why_no_modes{};      ///< a sentence where there is none
  Eigen::MatrixXd shapes{};        ///< of these, columns of length 1 in the norm of M, shape (dofs, modes)
  double fastest = 0;              ///< omega of the fastest mode [rad/s]; 0 where damping couples the modes
  double fastest_zeta = 0;         ///< its damping ratio, as far as it oscillates

  [[nodiscard]] bool is_loaded() const { return load.dot(equilibrium) > 0; }
};

/// @param watch  called now and then; may throw
/// @param modes  how many of the slowest; fewer where damping couples them or only the ends are known
/// @throws InputError  for a load that never settles, where no equilibrium is found, and for a model without
///                     positions and velocities or without stiffness
FidelityModel settled_model(const Problem& problem, const std::function<void()>& watch = {},
                            std::size_t modes = 3);
/// The same of a load that measures stiffness.
/// @throws InputError  also for a body that nothing loads, and a tool
FidelityModel fidelity_model(const Problem& problem, const std::function<void()>& watch = {},
                             std::size_t modes = 3);

/// (q, v) -> Phi(q, v), one step of length h [s] of a method on the model made of `problem`, q displacements,
/// shape (2 dofs). One thread at a time.
/// @param problem  that of the model, or one that differs in loads and stiffness
/// @throws InputError  as one_step_map()
VectorFunction step_of_model(const Method& method, const FidelityModel& model, const Problem& problem,
                             double h);

/// E of the first region [Pa]: what ceilings and moduli are given in.
double young_of(const Problem& problem);

/// The same body with all stiffnesses of tissue, springs, fibres and skin times `factor`. Supports and
/// damping stay.
Problem with_stiffness(const Problem& problem, double factor);

/// @param q  shape (dofs) [m] @return  [m^3]
double volume_of(const TissueBody& body, const Eigen::VectorXd& q);

}  // namespace hmax
