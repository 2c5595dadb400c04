/// What a body on a mesh was taken to be, in units, so that a slip in them shows.
#pragma once

#include <array>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "problems/tissue/body.hpp"

namespace hmax {

struct BodySummary {
  /// The least and the largest over the regions.
  using Span = std::array<double, 2>;
  Span young{};                 ///< E [Pa]
  Span poisson{};               ///< nu [1]
  Span density{};               ///< as it results where the mass is given [kg/m^3]
  Span fibre_young{};           ///< of fibres [Pa]; 0: there are none
  bool of_elements = true;      ///< tetrahedra; false: springs
  double spring = 0;            ///< stiffness of each spring [N/m]; 0: it follows from E
  bool locks = true;            ///< near nu = 1/2
  bool from_mass = false;       ///< densities result from a mass that is given
  double most_compression = 0;  ///< that the model carries under uniaxial stress where E is least [Pa]; 0: no
                                ///< bound is known
  /// rho g L of what stands above the support [Pa], which a column has there; bending adds to it.
  double weight_compression = 0;
  double skin = 0;  ///< Young's modulus of the skin [Pa]; 0: there is none
  std::size_t regions = 1;
  double mass = 0;                                    ///< of all points, without what mass_step adds [kg]
  double added_mass = 0;                              ///< by mass_step [kg]
  Eigen::Index heavier = 0;                           ///< points that it is added to
  Eigen::Vector3d size = Eigen::Vector3d::Zero();     ///< sides of the box around the body [m]
  Eigen::Index points = 0, held = 0;                  ///< all points, and those that supports hold
  Eigen::Index on_springs = 0;                        ///< those that springs hold, of elastic supports
  Eigen::Vector3d gravity = Eigen::Vector3d::Zero();  ///< [m/s^2]
  double travel = 0;                                  ///< the longest of tools and moved supports [m]
  double tool_radius = 0;                             ///< the largest [m]
  double force = 0;                                   ///< the largest that presses or pulls [N]
};

BodySummary summary_of(const TissueBody& body);
/// The same of what a body is made of, without what mass_step adds.
BodySummary summary_of(const TetMesh& mesh, const TissueSettings& settings);

/// Mass scaling that adds more than this share of the mass gets a warning: explicit codes advise a few per
/// cent at most, and frequencies fall by up to 2.4 % with it.
inline constexpr double usual_added_mass = 0.05;
/// From this Poisson's ratio on linear tetrahedra get a warning. The tip of a cantilever sags by w = rho g
/// L^4 / (8 E I) whatever nu is; that of `beam:n=8` loses a quarter of what it has with nu 0.3, that of
/// `beam:n=4` 44 %, and 12 % and 24 % with nu 0.45.
inline constexpr double locking_from = 0.48;
/// By which share frequencies of motions of the whole body fall where its mass grows by a share: 1 - 1 /
/// sqrt(1 + share).
double slowed_by(double added_share);

/// "E 5500 Pa, nu 0.45, 1060 kg/m^3; 1.52 kg in a box of 220 x 148 x 160 mm; 12 of 181 nodes fixed".
std::string in_words(const BodySummary& summary);

/// A sentence for each value that no tissue and no tool has, as slips in units make them, with the unit that
/// is expected; and where mass scaling changes the body, linear tetrahedra lock, or the weight is more than
/// the model carries.
std::vector<std::string> unusual_values(const BodySummary& summary);

}  // namespace hmax
