/// What a body of soft tissue is made of, and what acts on it.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "problems/tissue/forces/springs.hpp"
#include "problems/tissue/loads.hpp"
#include "problems/tissue/tissue_model.hpp"

namespace hmax {

/// The material of one region of a mesh. The defaults are those of liver: stiffness of healthy ones by
/// elastography, nearly incompressible.
/// @source  [roulot2008liver] for E
struct TissueMaterial {
  double young = 5500;    ///< E [Pa]
  double poisson = 0.45;  ///< nu [1]; springs have 1/4 whatever it says
  double density = 1060;  ///< [kg/m^3]
  // Of fibres in finite elements (problems/tissue/forces/fibres.hpp).
  double fibre_young = 0;                        ///< [Pa]; 0: there are none
  double fibre_x = 0, fibre_y = 0, fibre_z = 0;  ///< where they run at rest, of any length
};

/// The springs of a model of springs: one on every edge of the mesh, and further sets on demand.
struct SpringSettings {
  SpringLaw law = LinearSpring{};
  double stiffness = 0;    ///< k of every edge [N/m]; 0: from Young's modulus by edge_stiffness
  double damper = 0;       ///< c of every spring [N s/m]
  double damper_time = 0;  ///< [s], adds damper_time * k to the damper of each spring
  // Further sets, each with its stiffness relative to the mean of the edges; 0: none.
  double surface_bending = 0;  ///< between the points opposite to an edge of the surface
  double second_ring = 0;      ///< between the points opposite to an inner triangle
  double doubled_skin = 0;     ///< on the edges of the surface once more, relative to each of them
};

/// A skin on the whole surface, such as Glisson's capsule. It shares the mass of the body.
struct SkinSettings {
  enum class Kind {
    none,
    membrane,  ///< triangles in plane stress
    springs    ///< on the edges of the surface, k = sum of Y h A / L^2 over its triangles
               ///< [vangelder1998approximate]
  };
  Kind kind = Kind::none;
  double young = 5.5e6;     ///< Y [Pa]
  double poisson = 0.45;    ///< of the membrane
  double thickness = 1e-4;  ///< h [m]
};

struct TissueSettings {
  TissueModel model = tissue_models().front();
  std::vector<TissueMaterial> materials =
      std::vector<TissueMaterial>(1);     ///< of each region; one serves them all
  std::optional<double> total_mass = {};  ///< [kg]; scales all densities
  bool equal_masses = false;              ///< every point has the same mass, whatever its volume
  /// Masses of points are raised until explicit steps of an undamped body at rest are stable up to this one
  /// [s]; 0: they stay. What is added is inert: gravity does not pull it.
  double mass_step = 0;

  /// Rayleigh damping, forces -(alpha M + beta K0) v with the stiffness K0 at rest. K0 rather than the
  /// tangent: C stays constant and symmetric, positive where the tangent is not, and the force needs no
  /// derivative of the stiffness; in return a body that turns far is damped as if it were strained.
  double alpha = 0;  ///< [1/s]
  double beta = 0;   ///< [s]

  Eigen::Vector3d gravity = Eigen::Vector3d::Zero();  ///< [m/s^2]
  SpringSettings springs = {};                        ///< of a model of springs
  SkinSettings skin = {};
  std::vector<Support> supports = {};
  std::vector<ElasticSupport> elastic_supports = {};
  std::vector<PressingForce> forces = {};
  std::vector<SphereTool> tools = {};
};

/// The same after its ramps: what they move stands where they end.
TissueSettings after_ramps(TissueSettings settings);

}  // namespace hmax
