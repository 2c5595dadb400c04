/// A body of soft tissue for methods that move one point, or the points of one constraint, at a time.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "core/positional.hpp"
#include "problems/tissue/body.hpp"
#include "problems/tissue/positional/point_forces.hpp"
#include "problems/tissue/positional/tissue_constraints.hpp"

namespace hmax {

/// What a method asks of a body.
enum class PositionalVerbs {
  forces,       ///< as any method: the body itself
  points,       ///< point_force() and point_colours()
  constraints,  ///< constraints() and constraint_colours()
  weights,      ///< weights()
};

/// A TissueBody with verbs for one point and one constraint (integrators/positional/positional_system.hpp).
/// Copies share what they are made of. The order of points, of springs and of tetrahedra is that of the mesh,
/// and so are the colours: the same mesh gives the same bits.
class PositionalBody {
 public:
  using State = TissueBody::State;
  using Dofs = TissueBody::Dofs;
  using DofMatrix = TissueBody::DofMatrix;
  using Index = TetMesh::Index;

  /// Why a body has no such verbs, "has a tool, which ..."; empty where it has.
  static std::string why_not(const TissueBody& body, PositionalVerbs verbs);

  /// The same of what any verbs but `forces` need, whatever the model is: a tool, a skin.
  static std::string why_no_pieces(const TissueBody& body);

  /// The constraints of a body that has them. Their points are numbers of free ones.
  static TissueConstraints constraints_of(const TissueBody& body);

  /// What moves the points of a body that is moved by points.
  static PointPieces pieces_of(const TissueBody& body);

  /// @throws std::invalid_argument  where why_not() says so
  PositionalBody(std::shared_ptr<const TissueBody> body, PositionalVerbs verbs);

  [[nodiscard]] Eigen::Index dim() const { return body_->dim(); }
  [[nodiscard]] Eigen::Index dofs() const { return body_->dofs(); }
  void rhs(double t, const State& y, State& dydt) const { body_->rhs(t, y, dydt); }
  [[nodiscard]] const Dofs& mass() const { return body_->mass(); }
  void force(double t, const Dofs& q, const Dofs& v, Dofs& f) const { body_->force(t, q, v, f); }
  void stiffness(double t, const Dofs& q, const Dofs& v, DofMatrix& K) const { body_->stiffness(t, q, v, K); }
  void damping(double t, const Dofs& q, const Dofs& v, DofMatrix& C) const { body_->damping(t, q, v, C); }
  [[nodiscard]] bool admits(const State& y) const { return body_->admits(y); }

  /// Rayleigh's coefficients: alpha [1/s], beta [s].
  [[nodiscard]] double mass_damping() const { return body_->settings().alpha; }
  [[nodiscard]] double stiffness_damping() const { return body_->settings().beta; }
  /// f = weight and dead loads [N] at t, shape (dofs).
  void loads(double t, Dofs& f) const;

  [[nodiscard]] const Colours& point_colours() const;
  /// The rows of a free point of force(t, q, v), and the blocks on the diagonals of stiffness() and
  /// damping().
  void point_force(double t, const Dofs& q, const Dofs& v, std::int32_t point, PointForce& at) const;

  [[nodiscard]] const Colours& constraint_colours() const;
  void constraints(const Dofs& q, std::span<const std::int32_t> numbers,
                   std::span<CompliantConstraint> at) const;

  /// W with q^T (W (x) I) q = sum k |q_a - q_b|^2 of springs of stiffness k, k |q_a|^2 of those that hold a
  /// point, and w V |dF|^2 of tetrahedra, w = 2 mu + 3/2 lambda: the mean of what they have against shear, 2
  /// mu, and against dilatation, 2 mu + 3 lambda. Of the stiffness at rest it is at least half, so that
  /// iterations with it converge there. Shape (points, points) [N/m].
  [[nodiscard]] const std::shared_ptr<const Eigen::SparseMatrix<double>>& weights() const;

 private:
  struct Parts;
  std::shared_ptr<const TissueBody> body_;
  std::shared_ptr<const Parts> parts_;
};

}  // namespace hmax
