/// The parameters of a thigh identified from forces on two probes, as a thesis does it: least squares between
/// a model of springs and measurements.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "results/json.hpp"
#include "studies/thigh/thigh_model.hpp"

namespace hmax {

/// The forces on a probe that presses one point in steps.
struct ForceSeries {
  Eigen::Index point = 0;
  Probe probe = Probe::indentor;
  std::vector<double> depth;  ///< increasing [m]
  std::vector<double> force;  ///< [N]
};

/// How a thigh is measured: each point by both probes in steps of 2 mm. A series ends after its tenth value
/// once a force exceeds 15 N, else after the twelfth.
struct MeasurementPlan {
  double noise = 0.02;  ///< standard deviation of a force, relative to it [1]
  std::uint64_t seed = 1;
};

std::vector<ForceSeries> measured(const Thigh& thigh, const MeasurementPlan& plan);

/// How many forces there are.
Eigen::Index value_count(std::span<const ForceSeries> data);

/// The forces of a thigh at the depths of the data, and the measured ones, shape (values) [N].
Eigen::VectorXd forces_of(const Thigh& thigh, std::span<const ForceSeries> data);
Eigen::VectorXd forces_of(std::span<const ForceSeries> data);

/// The root of the sum of squared differences over that of the measured forces [1].
double overall_error(const Eigen::VectorXd& forces, const Eigen::VectorXd& measured_forces);

/// Which springs of the skin are unknown besides (a, b) of each point.
enum class UnknownSkin {
  none,          ///< their stiffness is given
  by_direction,  ///< one along and one around the bone
  every_spring,
};

/// The unknowns of a thigh, a before b before the skin [N], [1/m], [N/m].
Eigen::VectorXd unknowns(const Thigh& thigh, UnknownSkin skin);
/// The thigh with other unknowns.
Thigh with_unknowns(Thigh thigh, const Eigen::VectorXd& values, UnknownSkin skin);

/// What is made small. For small errors both are the same; the logarithm does not let the stiffest point of a
/// far guess outweigh all others.
enum class Misfit {
  logarithmic,  ///< log(F / F_measured)
  relative,     ///< F / F_measured - 1
};
NLOHMANN_JSON_SERIALIZE_ENUM(Misfit, {{Misfit::logarithmic, "logarithmic"}, {Misfit::relative, "relative"}})

struct FitOptions {
  UnknownSkin skin = UnknownSkin::by_direction;
  Misfit misfit = Misfit::logarithmic;
};

/// Residuals, shape (values). Where `jacobian` is given, also their derivatives with respect to the
/// logarithms of the unknowns, shape (values, unknowns).
Eigen::VectorXd residuals(const Thigh& thigh, std::span<const ForceSeries> data, const FitOptions& options,
                          Eigen::MatrixXd* jacobian = nullptr);

/// What was identified.
struct ThighFit {
  Thigh thigh;
  Eigen::VectorXd values;     ///< unknowns
  Eigen::VectorXd low, high;  ///< ends of their intervals of 95 %; 0 and infinity where the data tell nothing
  double residual = 0;        ///< root mean square of the residuals [1]
  int evaluations = 0;        ///< of the residuals
  bool converged = false;
};

/// Levenberg-Marquardt [more1978levenberg] for the logarithms of the unknowns, which keeps them positive. The
/// intervals are those of the linear model at the solution: Jacobian, residual variance, Student's t
/// [bates1988nonlinear].
/// @param start  its parameters are the initial guess; stiffnesses that are not unknown stay
/// @throws std::invalid_argument  for fewer forces than unknowns and forces that are not positive
ThighFit identify(const Thigh& start, std::span<const ForceSeries> data, const FitOptions& options = {});

/// A guess without knowledge of the tissue: a = 0.3 N and b = 60 1/m at every point. The skin is that of
/// `thigh`, times `skin_factor`.
Thigh uniform_guess(Thigh thigh, double skin_factor = 1);

/// Every a times a factor of its own between 1 / `of_a` and `of_a`, every b the same, uniform in the
/// logarithm.
Thigh scattered(Thigh thigh, double of_a, double of_b, std::uint64_t seed);

/// Identified parameters beside the truth.
struct Recovery {
  Eigen::VectorXd error;     ///< relative, in the order of unknowns()
  double within = 0;         ///< share of the unknowns with an error of at most 5 %
  double covered = 0;        ///< share whose interval holds the truth
  double largest_error = 0;  ///< [1]
};
Recovery compare(const ThighFit& fit, const Thigh& truth, UnknownSkin skin);

}  // namespace hmax
