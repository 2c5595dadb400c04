/// A body of soft tissue as a mechanical system M q'' = F(t, q, v).
#pragma once

#include <cmath>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "problems/mesh/tet_mesh.hpp"
#include "problems/tissue/contact.hpp"
#include "problems/tissue/forces/block_pattern.hpp"
#include "problems/tissue/forces/elements.hpp"
#include "problems/tissue/forces/membrane.hpp"
#include "problems/tissue/forces/node_rows.hpp"
#include "problems/tissue/forces/springs.hpp"
#include "problems/tissue/tissue_settings.hpp"

namespace hmax {

struct MeshOrigin;  // problems/mesh/files/mesh_import.hpp

/// A tetrahedral mesh with one elastic model, damping, supports and loads.
///
/// q holds the displacements [m] of the free points, x, y, z of one after the other in the order of the mesh,
/// shape (dofs), v their velocities [m/s], and y = (q, v) the first-order state, shape (2 dofs). Supported
/// points are no unknowns. The forces are
///   F = elastic(x) + skin(x) - k u + m g + loads(t) + contact(t, x, v) - dampers(x) v - (alpha M + beta K0)
///   v,
/// with k of elastic supports, which are a part of K0.
/// Forces of 8000 elements of the kernels or 32,000 springs of a linear or cubic law and the stiffness
/// of 1600 elements take the threads of parallel_for(), with the same bits for any number. On one thread only
/// the first call allocates.
class TissueBody {
 public:
  using State = Eigen::VectorXd;
  using Dofs = Eigen::VectorXd;
  using DofMatrix = Eigen::SparseMatrix<double>;
  using Index = TetMesh::Index;

  /// @param mesh  valid, without unused points; of ten nodes where the model takes them
  /// @throws std::invalid_argument  when the settings do not fit the mesh or each other, or a number is out
  /// of
  ///         range
  /// @param origin  of the mesh, for those who write results in the order of its file
  TissueBody(const TetMesh& mesh, TissueSettings settings,
             std::shared_ptr<const MeshOrigin> origin = nullptr);

  [[nodiscard]] Eigen::Index dofs() const { return mass_.size(); }
  [[nodiscard]] Eigen::Index dim() const { return 2 * dofs(); }
  [[nodiscard]] bool is_autonomous() const { return steady_from_ == 0; }
  /// The instant from which on no load changes with time [s], as after a ramp; infinity where one always
  /// does.
  [[nodiscard]] double steady_from() const { return steady_from_; }
  /// Times in (t0, t1) where a load, a support or a tool begins or ceases to move [s], rising.
  [[nodiscard]] std::vector<double> breakpoints(double t0, double t1) const;
  /// The state at rest: the body as the mesh has it.
  [[nodiscard]] State y0() const { return State::Zero(dim()); }
  /// (|X|, 0) of the free points, shape (dim): springs, skins and tools meet positions X + q, with their
  /// rounding; 0 where there are elements alone, which meet displacements.
  void offset(State& X) const;

  void rhs(double t, const State& y, State& dydt) const;
  /// Lumped: a mass_share() of each element at each of its points (problems/mesh/ten_node.hpp), shape (dofs)
  /// [kg].
  [[nodiscard]] const Dofs& mass() const { return mass_; }
  /// F(t, q, v), shape (dofs) [N].
  void force(double t, const Dofs& q, const Dofs& v, Dofs& f) const;
  /// K = -dF/dq [N/m] and C = -dF/dv [N s/m], shape (dofs, dofs), in one pattern of 3 x 3 blocks. A matrix
  /// that has it is written in place.
  void stiffness(double t, const Dofs& q, const Dofs& v, DofMatrix& K) const;
  void damping(double t, const Dofs& q, const Dofs& v, DofMatrix& C) const;
  /// False when a moving damper or a tool that damps may make K unsymmetric.
  [[nodiscard]] bool has_symmetric_stiffness() const { return !needs_velocities(); }
  /// Where beta is not 0: alpha M + beta K0, what damping() has of it; else empty.
  [[nodiscard]] const DofMatrix& rayleigh() const { return rayleigh_; }

  /// Elastic energy and the potentials of gravity, loads and contact [J], of which the forces at rest are the
  /// gradient. Zero at q = 0 without contact.
  [[nodiscard]] double energy(double t, const Dofs& q) const;
  /// v^T M v / 2 [J].
  [[nodiscard]] double kinetic_energy(const Dofs& v) const;

  /// A bound of the absolute values of the eigenvalues of the Jacobian [1/s]. For an eigenvector with
  /// positions x, |x| = 1 in the norm of M, l^2 + l x*Cx + x*Kx = 0; the two products are bounded by c and k
  /// of bound_of(), so that
  ///   |l| <= (c + sqrt(c^2 + 4 k)) / 2.
  /// Allocates K and C one after the other.
  [[nodiscard]] double spectral_radius(double t, const State& y) const;
  [[nodiscard]] static double radius_of_bounds(double k, double c) {
    return (c + std::sqrt(c * c + 4 * k)) / 2;
  }
  /// A bound of |x*Ax| for |x| = 1, A = M^(-1/2) matrix M^(-1/2): |A| <= sqrt(|A|_1 |A|_inf), of the largest
  /// sums of absolute values over a column and a row (Gershgorin).
  [[nodiscard]] double bound_of(const DofMatrix& matrix) const;
  [[nodiscard]] static double bound_of_sums(double column, double row) { return std::sqrt(column * row); }

  /// False where displacements differ by more than ten thousand times the size of the body: no tissue holds
  /// together there, and a run that comes so far has diverged.
  [[nodiscard]] bool admits(const State& y) const;

  [[nodiscard]] const TetMesh& mesh() const { return mesh_; }
  /// Where the mesh comes from; null where it was made in memory.
  [[nodiscard]] const std::shared_ptr<const MeshOrigin>& origin() const { return origin_; }
  [[nodiscard]] const TissueSettings& settings() const { return settings_; }
  /// Supports of the same points that follow one another, whose motions add up: where each lot ends among the
  /// supports. A point of several lots moves with the last.
  [[nodiscard]] const std::vector<std::size_t>& support_ends() const { return support_ends_; }
  /// Of each support what it drags the free points with, beta K0 times its travel, shape (dofs).
  [[nodiscard]] const std::vector<Dofs>& support_drag() const { return support_drag_; }
  /// A free point that a spring holds.
  struct Anchor {
    Index point;
    Eigen::Index dof;  ///< the first of the three
    double stiffness;  ///< [N/m]
  };
  [[nodiscard]] const std::vector<Anchor>& anchors() const { return anchors_; }
  /// The points that q moves, in its order.
  [[nodiscard]] const std::vector<Index>& free_points() const { return free_points_; }
  /// Of each point of the mesh its number among them, -1 of held ones.
  [[nodiscard]] const std::vector<Index>& free_numbers() const { return pattern_.free(); }
  /// Mass of every point, supported ones included, shape (points) [kg].
  [[nodiscard]] const Eigen::VectorXd& point_mass() const { return point_mass_; }
  /// The part of it that has weight, shape (points) [kg].
  [[nodiscard]] const Eigen::VectorXd& heavy_mass() const { return heavy_mass_; }
  /// What TissueSettings::mass_step has added to each point, shape (points) [kg].
  [[nodiscard]] Eigen::VectorXd added_mass() const { return point_mass_ - heavy_mass_; }
  /// Positions of all points [m], shape (3, points).
  [[nodiscard]] Eigen::Matrix3Xd positions(double t, const Dofs& q) const;
  /// How far each tool has come, and what it has done to the surface.
  /// @param y  shape (dim), or (dofs): its velocities are not read
  [[nodiscard]] std::vector<ToolContact::Reach> tool_reaches(double t, const State& y) const;
  /// Elastic energy density of each tetrahedron [J/m^3], shape (tetrahedra); of finite elements alone.
  /// @throws std::invalid_argument  for springs
  [[nodiscard]] Eigen::VectorXd energy_densities(double t, const Dofs& q) const;
  /// Its mean over the tetrahedra at each point by their volumes [J/m^3], shape (points).
  [[nodiscard]] Eigen::VectorXd point_energy_densities(double t, const Dofs& q) const;
  /// The least volume of a tetrahedron relative to that at rest, and the tetrahedron; below 0 it is inverted.
  /// Of elements of ten nodes: of their parts.
  [[nodiscard]] std::pair<double, Eigen::Index> least_volume(double t, const Dofs& q) const;

  /// Calls visit(points, K) with the stiffness at rest of each piece of the elements, spring, triangle of the
  /// skin and spring of an elastic support, which has one point:
  /// `points` of the mesh, K of shape (3 points, 3 points). Their sum over the free points is the stiffness
  /// at q = 0 without contact.
  void visit_rest_stiffness(const StiffnessVisitor& visit) const;
  /// How many of these come from finite elements: first the elements of the mesh, then what acts on several
  /// of them.
  [[nodiscard]] std::size_t element_pieces() const { return elements_ ? elements_->pieces() : 0; }
  /// Elements::parts() of the model.
  [[nodiscard]] ElementParts element_parts() const { return elements_ ? elements_->parts() : ElementParts{}; }
  /// The springs of a model of springs, then those of a skin of springs.
  [[nodiscard]] const std::vector<SpringSet>& spring_sets() const { return springs_; }
  /// The skin of triangles; null where there is none.
  [[nodiscard]] const Membrane* membrane() const { return membrane_ ? &*membrane_ : nullptr; }
  /// Of each tool.
  [[nodiscard]] const std::vector<ToolContact>& contacts() const { return contacts_; }

 private:
  struct Scratch {
    NodeRows u, x, v, f;
  };
  static Scratch& scratch();

  void check_points(std::span<const Index> points, const char* what) const;
  void check_elastic_supports() const;
  void number_free_points();
  void distribute_mass();
  void build_elastic_parts();
  void raise_masses();
  void build_rayleigh_damping();

  /// Calls visit(i, u) with the displacement of every point; the supported stand where their motion has them.
  template <class Of, class Visit>
  void for_moved_supports(const Of& of, const Visit& visit) const;
  template <class Visit>
  void visit_displacements(double t, Eigen::Ref<const Dofs> q, const Visit& visit) const;
  void displace(double t, Eigen::Ref<const Dofs> q, NodeRows& u) const;
  /// The displacements u that elements need, and the positions x that springs, skins and tools need.
  void place(double t, Eigen::Ref<const Dofs> q, Scratch& rows) const;
  [[nodiscard]] Scratch rest() const;
  void move(double t, Eigen::Ref<const Dofs> v, NodeRows& rows) const;
  void total_force(double t, Eigen::Ref<const Dofs> q, Eigen::Ref<const Dofs> v, Eigen::Ref<Dofs> f) const;
  void write_elastic_stiffness(const Scratch& rows, double* values) const;
  [[nodiscard]] bool needs_positions() const { return !springs_.empty() || membrane_ || !contacts_.empty(); }
  [[nodiscard]] bool needs_velocities() const { return has_dampers_ || tools_damp_; }

  TetMesh mesh_;
  std::shared_ptr<const MeshOrigin> origin_;
  TissueSettings settings_;
  double steady_from_ = 0;
  double size_ = 0;  ///< the diagonal of the box around the mesh [m]
  bool has_dampers_ = false, tools_damp_ = false;
  std::vector<Index> free_points_;
  Eigen::VectorXd point_mass_;
  Eigen::VectorXd heavy_mass_;  ///< the part of it that has weight
  Dofs mass_;
  BlockPattern pattern_;
  std::shared_ptr<const Elements> elements_;  ///< null: the model is of springs
  std::vector<SpringSet> springs_;
  std::optional<Membrane> membrane_;
  std::vector<ToolContact> contacts_;
  std::vector<Anchor> anchors_;
  DofMatrix rayleigh_;  ///< alpha M + beta K0; empty without damping
  std::vector<std::size_t> support_ends_;
  std::vector<Dofs> support_drag_;
};

}  // namespace hmax
