#include "limits/by_steps/old_jacobian.hpp"

#include <memory>
#include <utility>

namespace hmax {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Sparse = Eigen::SparseMatrix<double>;

/// Matrices that never change, and the slopes that need not be theirs.
template <class MatrixT>
struct FirstOrder {
  using State = VectorXd;
  using Jacobian = MatrixT;
  static constexpr bool linear_stiff_part = true;

  struct Parts {
    Index n = 0;
    MatrixT J, J_stiff;
    RightHandSide rhs, stiff;
    bool autonomous = true;
  };
  std::shared_ptr<const Parts> parts;

  [[nodiscard]] Index dim() const { return parts->n; }
  [[nodiscard]] bool is_autonomous() const { return parts->autonomous; }
  void rhs(double t, const State& y, State& dydt) const { parts->rhs(t, y, dydt); }
  void jacobian(double, const State&, Jacobian& J) const { J = parts->J; }
  void rhs_stiff(double t, const State& y, State& dydt) const {
    if (parts->stiff)
      parts->stiff(t, y, dydt);
    else
      dydt.setZero();
  }
  void rhs_nonstiff(double t, const State& y, State& dydt) const {
    State stiff(y.size());
    rhs_stiff(t, y, stiff);
    rhs(t, y, dydt);
    dydt -= stiff;
  }
  void jacobian_stiff(double, const State&, Jacobian& J) const { J = parts->J_stiff; }
};

/// The same of a structure with sparse matrices.
struct SparseStructure : FirstOrder<Sparse> {
  using Dofs = VectorXd;
  using DofMatrix = Sparse;

  struct Matrices {
    MassMatrix<double> mass;
    Sparse K, C;
    Sparse K_stiff, C_stiff;  // empty where there is no stiff part, or one that is no structure
  };
  std::shared_ptr<const Matrices> matrices;

  [[nodiscard]] Index dofs() const { return matrices->mass.size(); }
  [[nodiscard]] const Dofs& mass() const { return matrices->mass.lumped(); }
  [[nodiscard]] const MassMatrix<double>& mass_matrix() const { return matrices->mass; }
  void force(double t, const Dofs& q, const Dofs& v, Dofs& f) const {
    State y(2 * q.size()), dydt(2 * q.size());
    y << q, v;
    rhs(t, y, dydt);
    f = matrices->mass.times(dydt.tail(q.size()));
  }
  void stiffness(double, const Dofs&, const Dofs&, DofMatrix& K) const { K = matrices->K; }
  void damping(double, const Dofs&, const Dofs&, DofMatrix& C) const { C = matrices->C; }
  [[nodiscard]] bool has_stiff_structure() const { return matrices->K_stiff.size() > 0; }
  void stiffness_stiff(DofMatrix& K) const { K = matrices->K_stiff; }
  void damping_stiff(DofMatrix& C) const { C = matrices->C_stiff; }
};

/// Whether J is that of a structure, (0, I; ...): otherwise it has no K and C.
bool moves_by_velocities(const Sparse& J) {
  const Index n = J.rows() / 2;
  Sparse upper = J.topRows(n);
  for (Index i = 0; i < n; ++i) upper.coeffRef(i, n + i) -= 1;
  return upper.norm() == 0;
}

template <class MatrixT>
MatrixT as(const AnyMatrix& matrix) {
  if constexpr (std::is_same_v<MatrixT, MatrixXd>)
    return dense(matrix);
  else
    return std::get<Sparse>(matrix);
}

template <class MatrixT>
std::shared_ptr<const typename FirstOrder<MatrixT>::Parts> parts_of(const LinearModel& model,
                                                                    const RightHandSide& rhs, bool autonomous,
                                                                    const RightHandSide& stiff) {
  typename FirstOrder<MatrixT>::Parts parts;
  parts.n = model.y.size();
  parts.J = as<MatrixT>(model.J());
  if (stiff) parts.J_stiff = as<MatrixT>(model.J_stiff());
  parts.rhs = rhs;
  parts.stiff = stiff;
  parts.autonomous = autonomous;
  return std::make_shared<const typename FirstOrder<MatrixT>::Parts>(std::move(parts));
}

bool is_sparse_structure(const LinearModel& model) {
  return model.mechanical && is_sparse(model.mechanical->K) && is_sparse(model.mechanical->C);
}

RightHandSide product_with(AnyMatrix matrix) {
  return [matrix = std::make_shared<const AnyMatrix>(std::move(matrix))](double, const VectorXd& y,
                                                                         VectorXd& dydt) {
    std::visit([&](const auto& held) { dydt.noalias() = held * y; }, *matrix);
  };
}

}  // namespace

AnySystem with_jacobian_of(const LinearModel& model, const RightHandSide& rhs, bool autonomous,
                           const RightHandSide& stiff) {
  if (!is_sparse_structure(model)) {
    const bool sparse = is_sparse(model.J());
    if (sparse) return AnySystem(FirstOrder<Sparse>{parts_of<Sparse>(model, rhs, autonomous, stiff)});
    return AnySystem(FirstOrder<MatrixXd>{parts_of<MatrixXd>(model, rhs, autonomous, stiff)});
  }
  const MechanicalPart& part = *model.mechanical;
  SparseStructure::Matrices matrices{part.mass, std::get<Sparse>(part.K), std::get<Sparse>(part.C), {}, {}};
  SparseStructure structure{{parts_of<Sparse>(model, rhs, autonomous, stiff)}, {}};
  if (const Sparse& J_stiff = structure.parts->J_stiff; J_stiff.size() > 0 && moves_by_velocities(J_stiff)) {
    auto [K, C] = detail::stiffness_and_damping_of(J_stiff, part.mass);
    matrices.K_stiff = std::get<Sparse>(K);
    matrices.C_stiff = std::get<Sparse>(C);
    matrices.K_stiff.makeCompressed();
    matrices.C_stiff.makeCompressed();
  }
  structure.matrices = std::make_shared<const SparseStructure::Matrices>(std::move(matrices));
  return AnySystem(std::move(structure));
}

RightHandSide linear_part(const LinearModel& model) {
  if (!is_sparse_structure(model)) return product_with(model.J());
  struct Matrices {
    MassMatrix<double> mass;
    Sparse K, C;
  };
  const MechanicalPart& part = *model.mechanical;
  const auto held = std::make_shared<const Matrices>(
      Matrices{part.mass, std::get<Sparse>(part.K), std::get<Sparse>(part.C)});
  return [held](double, const VectorXd& y, VectorXd& dydt) {
    const Index n = held->mass.size();
    dydt.head(n) = y.tail(n);
    dydt.tail(n).noalias() = -(held->K * y.head(n));
    dydt.tail(n).noalias() -= held->C * y.tail(n);
    dydt.tail(n) = held->mass.solve(dydt.tail(n));
  };
}

RightHandSide linear_stiff_part(const LinearModel& model) {
  return model.J_stiff ? product_with(model.J_stiff()) : RightHandSide{};
}

}  // namespace hmax
