/// What the readers of scenes share; for their sources only.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>

#include <Eigen/Core>

#include "catalogue/scenes/scene.hpp"
#include "problems/mesh/files/mesh_file.hpp"

namespace hmax {

/// The units of all numbers of a file.
struct SceneUnits {
  double length = 1;  ///< [m]
  double mass = 1;    ///< [kg]
  double time = 1;    ///< [s]
  bool operator==(const SceneUnits&) const = default;
};

/// Makes a scene of numbers in the units of a file.
class SceneBuilder {
 public:
  /// @param units  which must live as long as this; @throws InputError  as read_scene()
  SceneBuilder(std::string_view units, std::string_view ignored);

  Scene scene;

  /// Takes the units of --unit, before any number. @param where  "FILE, line N: "
  /// @param told  the units of the file, "mm,kg,s"; empty: it does not say them
  /// @throws InputError  where these are none, or others than `told`
  void take_units(const std::string& where = {}, std::string_view told = {});
  /// Refuses a part that is not understood, or notes that it is left out.
  /// @param where  "FILE, line N: "; @param what  "*CLOAD is forces at single points, which bodies have not"
  void refuse(std::string_view part, const std::string& where, const std::string& what);
  /// E, nu and density of a region, or of the whole body where its name is empty.
  /// @param where  "FILE, line N"
  void add_material(const std::string& region, double young, double poisson, std::optional<double> density,
                    const std::string& where);
  /// A dead load on one point, which adds to others on it. @param number  of the point in its file
  void add_force(std::int64_t number, const Eigen::Vector3d& force);
  void set_density(const std::string& region, double density, const std::string& where);
  /// Springs on all edges: of one stiffness, or without one by Young's modulus.
  /// @param damper  ratio of damper and stiffness
  void set_springs(std::optional<double> stiffness, double young, double damper);
  /// The mass of the whole body, instead of densities. @param equal  the same at all points
  void set_mass(double mass, bool equal);
  /// Rayleigh damping alpha M + beta K.
  void set_damping(double alpha, double beta);
  void set_gravity(const Eigen::Vector3d& acceleration);
  /// @param group  of vertices of the mesh; empty: nothing is fixed
  void set_support(std::string_view group);
  /// The step in which `integrator` is stepped.
  void set_step(double step) { scene.step = step * units_.time; }
  /// The scene with notes of what was left out.
  /// @throws InputError  for parts of which nothing had to be left out
  Scene finish(const std::string& file);

 private:
  void set_forces();
  void set(std::string name, double value) { scene.settings.parameters.emplace_back(std::move(name), value); }

  std::string_view given_;  ///< of --unit
  SceneUnits units_;
  std::set<std::string> ignored_, left_out_;
  std::map<std::int64_t, Eigen::Vector3d> forces_;  ///< by points [N]
};

/// Refuses tetrahedra of ten nodes. @throws InputError  naming the first one
void require_four_nodes(const MeshFile& mesh);

/// A note that the law of fem_neo_hookean is not that of another program.
std::string neo_hookean_differs(std::string_view theirs);

/// CalculiX's and Abaqus' .inp, SOFA's .scn, FEBio's .feb, MuJoCo's .xml. @throws InputError,
/// std::invalid_argument  as read_scene()
void read_inp_scene(const std::string& file, std::string_view bytes, SceneBuilder& builder);
void read_sofa_scene(const std::string& file, std::string_view bytes, SceneBuilder& builder);
void read_febio_scene(const std::string& file, std::string_view bytes, SceneBuilder& builder);
void read_mujoco_scene(const std::string& file, std::string_view bytes, SceneBuilder& builder);

}  // namespace hmax
