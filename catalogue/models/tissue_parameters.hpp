/// What users may set of a body on a mesh.
#pragma once

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/numbers.hpp"
#include "problems/tissue/tissue_settings.hpp"

namespace hmax {

/// "fem_green/press@liver" in its parts; the load may be missing.
struct TissueId {
  std::string model, load, mesh;

  /// @throws InputError  for an unknown model or load
  explicit TissueId(const std::string& id);

  [[nodiscard]] bool is_of_springs() const { return tissue_model(model).is_of_springs(); }
};

/// What a user may set of a body on a mesh.
struct TissueParameters {
  double E = TissueMaterial{}.young, nu = TissueMaterial{}.poisson, rho = TissueMaterial{}.density;
  double mass = 0;             ///< of the whole body [kg]; 0: by the density
  double alpha = 0, beta = 0;  ///< Rayleigh [1/s], [s]
  double damper = 0;           ///< of springs: c / k [s]
  double fibre_E = 0;          ///< of fibres along (fibre_x, fibre_y, fibre_z) [Pa]; 0: none
  double fibre_x = 0, fibre_y = 0, fibre_z = 0;
  double g = 9.81;                ///< along -z [m/s^2], under the load gravity; 0 where gx, gy or gz is set
  double gx = 0, gy = 0, gz = 0;  ///< gravity in other directions [m/s^2]
  double force = 0.5;             ///< towards the held end or away from it, of press and pull [N]
  double depth = 0.01;     ///< that the tool moves into the body in its first half second, or that the held
                           ///< end moves to and fro, of breathing [m]
  double period = 4;       ///< of breathing [s]
  double tool_radius = 0;  ///< [m]; 0: a twentieth of the diagonal of the mesh
  double tool_stiffness = 0;  ///< [Pa/m^1.5] (problems/tissue/loads.hpp); 0: from E and the depth
  double tool_damping = 0;    ///< chi of Hunt and Crossley [s/m]
  /// Where the foremost point of the tool starts [m]; infinite: at the free end, as seen along its direction,
  /// where the surface faces it.
  double tool_x = infinity, tool_y = infinity, tool_z = infinity;
  double tool_dx = 0, tool_dy = 0, tool_dz = 0;  ///< where the tool moves [1]; 0: towards the held end
  double support = 0.1;                          ///< share of the body along the axis that is held
  double axis = 3;               ///< 1, 2, 3: held at its low end along x, y, z; -1, -2, -3: at its high end
  double support_stiffness = 0;  ///< of springs that hold the supports, per area [Pa/m]; 0: they are fixed
  double equal_masses = 0;       ///< 1: every point has the same mass
  double mass_step = 0;  ///< masses are raised until explicit steps are stable up to it [s]; 0: they stay
  // What a body has only when it is asked for.
  double inclusion = 0;                    ///< E of every region of the mesh but the first, over E
  double skin = 0, skin_thickness = 1e-4;  ///< E of a skin over E, [m]
  double k = 0;                            ///< of the springs on the edges; 0: from E [N/m]
  double cubic = 0, exponential = 0;       ///< b of such springs
  double bending = 0, second_ring = 0, doubled_skin = 0;  ///< further springs, relative to the edges
  /// Box whose points are held, instead of a share of an end [m].
  double xmin = -infinity, xmax = infinity, ymin = -infinity, ymax = infinity, zmin = -infinity,
         zmax = infinity;

  /// Of one region, by the name or the number that its file gives it: `E:tumour=8000`, `nu:3=0.4`.
  struct OfRegion {
    double TissueMaterial::*what;
    std::string region;
    double value;
    bool from_material = false;  ///< which a number that the user sets overrides
  };
  std::vector<OfRegion> of_regions{};
  /// Sets of held points (catalogue/models/support_sets.hpp), instead of a share of an end:
  /// `support:capsule=1`.
  std::vector<std::string> supports{};
  /// A force on each point of a set (catalogue/models/support_sets.hpp) along x, y or z, beside the load:
  /// `force_z:points:7=0.5`.
  struct NodalForce {
    int axis;
    std::string set;
    double value;  ///< [N]
  };
  std::vector<NodalForce> nodal_forces{};
  /// Points (strain, phi) of a law of springs by table (problems/tissue/forces/springs.hpp): `phi:0.1=0.14`.
  /// (0, 0) is always one.
  std::vector<std::pair<double, double>> table{};

  [[nodiscard]] bool holds_nothing() const { return support == 0 && !has_box() && supports.empty(); }
  [[nodiscard]] bool has_box() const {
    return std::ranges::any_of(std::array{-xmin, xmax, -ymin, ymax, -zmin, zmax},
                               [](double side) { return side < infinity; });
  }
};

/// What stands before the colon of a parameter that holds a set of points.
inline constexpr std::string_view support_name = "support";

/// The parameters that hold a vector each: "gx", "gy", "gz" and so on.
inline constexpr std::array<std::string_view, 3> gravity_names{"gx", "gy", "gz"};
inline constexpr std::array<std::string_view, 3> nodal_force_names{"force_x", "force_y", "force_z"};
inline constexpr std::array<std::string_view, 3> tool_place_names{"tool_x", "tool_y", "tool_z"};
inline constexpr std::array<std::string_view, 3> tool_direction_names{"tool_dx", "tool_dy", "tool_dz"};

}  // namespace hmax
