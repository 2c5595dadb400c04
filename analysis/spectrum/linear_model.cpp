#include "analysis/spectrum/linear_model.hpp"

#include <array>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "analysis/spectrum/lanczos.hpp"
#include "core/errors.hpp"
#include "core/numbers.hpp"
#include "problems/matrix_entries.hpp"

namespace hmax {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Sparse = Eigen::SparseMatrix<double>;

/// @throws InputError  that names the first degree of freedom whose mass is not positive and finite
void require_masses(const VectorXd& mass) {
  for (Index i = 0; i < mass.size(); ++i)
    if (!(std::isfinite(mass[i]) && mass[i] > 0))
      throw InputError(
          fmt::format("the mass of degree of freedom {} is {}, but every mass must be positive and finite; "
                      "give it a mass in "
                      "kg, or take the degree of freedom out of the model",
                      i + 1, to_text(mass[i])));
}

/// How an entry acts in a product.
enum class As { itself, transposed, modulus };

/// D^-1/2 A D^-1/2 x with D = diag(M), with the transpose or the moduli of A; no matrix is copied.
VectorXd scaled_product(const AnyMatrix& A, const VectorXd& inverse_root, const VectorXd& x, As as) {
  // D^-1/2 (A (D^-1/2 x)).
  const VectorXd scaled = inverse_root.cwiseProduct(x);
  VectorXd product = VectorXd::Zero(x.size());
  each_entry(A, [&](Index i, Index j, double value) {
    // y_i = sum_j A_ij x_j of the scaled x; the transpose swaps the roles.
    if (as == As::transposed) std::swap(i, j);
    product[i] += (as == As::modulus ? std::abs(value) : value) * scaled[j];
  });
  return product.cwiseProduct(inverse_root);
}

/// Classifies by products with a few vectors in general position: an identity of matrices that does not hold
/// fails for almost all of them, and |D x| is the size of D. So no product of matrices is formed, which of a
/// large mesh would take many times its memory.
void classify_damping(double relative, MechanicalPart& part) {
  constexpr Index probes = 3;
  const VectorXd root = part.mass.diagonal().cwiseSqrt().cwiseInverse();
  const Index n = part.mass.size();
  // x -> D^1/2 M^-1 D^1/2 x, which of lumped masses is x.
  const auto between = [&](const VectorXd& x) -> VectorXd {
    if (part.mass.is_diagonal()) return x;
    return part.mass.solve(x.cwiseQuotient(root)).cwiseQuotient(root);
  };
  // Three vectors with components in (-1/2, 1/2), the same in every run.
  const VectorXd numbers = start_vector(probes * n);
  // Beside what rounding of the terms of a product may be.
  const auto vanishes = [&](const VectorXd& difference, const VectorXd& size) {
    return difference.norm() <= relative * size.norm();
  };
  bool damped = false, commute = true;
  for (Index probe = 0; probe < probes; ++probe) {
    const VectorXd x = numbers.segment(probe * n, n), moduli = x.cwiseAbs();
    const auto k = [&](const VectorXd& v, As as = As::itself) { return scaled_product(part.K, root, v, as); };
    const auto c = [&](const VectorXd& v, As as = As::itself) { return scaled_product(part.C, root, v, as); };
    const VectorXd kx = k(x), cx = c(x), size_c = c(moduli, As::modulus);
    damped = damped || size_c.maxCoeff() > 0;
    // |(k - k^T) x| beside | |k| |x| |, what the terms were before they cancelled.
    part.symmetric = part.symmetric && vanishes(kx - k(x, As::transposed), k(moduli, As::modulus)) &&
                     vanishes(cx - c(x, As::transposed), size_c);
    if (!damped || !part.symmetric) break;
    // |(k c - c k) x| beside | |k| |c| |x| |.
    commute = commute && vanishes(k(between(cx)) - c(between(kx)), k(size_c, As::modulus));
  }
  // Without symmetry nothing is proportional.
  part.damping = !damped                     ? Damping::none
                 : part.symmetric && commute ? Damping::proportional
                                             : Damping::general;
}

}  // namespace

std::string_view name_of(JacobianOrigin origin) {
  constexpr std::array<std::string_view, 3> names{"analytic", "central differences",
                                                  "central differences by groups of columns"};
  return names[static_cast<std::size_t>(origin)];
}

std::string_view name_of(Damping damping) {
  constexpr std::array<std::string_view, 3> names{"none", "proportional", "general"};
  return names[static_cast<std::size_t>(damping)];
}

MatrixXd mass_scaled(const MassMatrix<double>& M, const AnyMatrix& A) {
  if (M.is_diagonal()) {
    const VectorXd inverse_root = M.diagonal().cwiseSqrt().cwiseInverse();
    return inverse_root.asDiagonal() * dense(A) * inverse_root.asDiagonal();
  }
  // (R^-T (R^-T A)^T)^T
  const MatrixXd half = M.transposed_root_solve(dense(A)).transpose();
  return M.transposed_root_solve(half).transpose();
}

MatrixXd dense(const AnyMatrix& matrix) {
  if (const auto* full = std::get_if<MatrixXd>(&matrix)) return *full;
  return MatrixXd(std::get<Sparse>(matrix));
}

/// The block I is the same in both: it adds n to the square of the norm and nothing to the difference.
double relative_distance(const LinearModel& A, const LinearModel& B) {
  if (!A.mechanical || !B.mechanical) return relative_distance(A.J(), B.J());
  // Of (0, I; -M^-1 K, -M^-1 C).
  const MechanicalPart &a = *A.mechanical, &b = *B.mechanical;
  // Both have one M; of one that couples its diagonal tells the sizes.
  const VectorXd inverse = a.mass.diagonal().cwiseInverse();
  double difference = 0, size = static_cast<double>(a.mass.size());
  for (const auto& [from, to] : {std::pair{&a.K, &b.K}, std::pair{&a.C, &b.C}}) {
    std::visit(
        [&](const auto& first, const auto& second) {
          using First = std::decay_t<decltype(first)>;
          if constexpr (std::is_same_v<First, std::decay_t<decltype(second)>>)
            // |M^-1 (K_B - K_A)|_F^2, C alike; divided by |J_A|_F^2 = n + |M^-1 K_A|^2 + |M^-1 C_A|^2.
            difference += (inverse.asDiagonal() * First(second - first)).squaredNorm();
          else
            difference += (inverse.asDiagonal() * MatrixXd(MatrixXd(second) - MatrixXd(first))).squaredNorm();
          size += (inverse.asDiagonal() * first).squaredNorm();
        },
        *from, *to);
  }
  return std::sqrt(difference / size);
}

double relative_distance(const AnyMatrix& A, const AnyMatrix& B) {
  if (!is_sparse(A) || !is_sparse(B)) return (dense(A) - dense(B)).norm() / dense(A).norm();
  using Sparse = Eigen::SparseMatrix<double>;
  return Sparse(std::get<Sparse>(A) - std::get<Sparse>(B)).norm() / std::get<Sparse>(A).norm();
}

MechanicalPart mechanical_part(MassMatrix<double> mass, AnyMatrix K, AnyMatrix C, double relative) {
  MechanicalPart part{.mass = std::move(mass), .K = detail::taken(K), .C = detail::taken(C)};
  classify(part, relative);
  return part;
}

// Checks masses and entries, then symmetry and damping; a single degree of freedom is decided by its c
// alone.
void classify(MechanicalPart& part, double relative) {
  require_masses(part.mass.diagonal());
  for (const auto& [matrix, name] : {std::pair{&part.K, "stiffness"}, {&part.C, "damping"}})
    each_entry(*matrix, [&](Index i, Index j, double value) {
      if (!std::isfinite(value))
        throw InputError(
            fmt::format("the {} matrix has {} at row {}, column {} (counted from 1), so there is no linear "
                        "model; choose a state where the force is differentiable",
                        name, to_text(value), i + 1, j + 1));
    });
  if (part.mass.size() == 1) {  // one degree of freedom has nothing to couple with
    double c = 0;
    // kappa = k / m and gamma = c / m of the only mode.
    each_entry(part.C, [&](Index, Index, double value) { c = value; });
    part.damping = c == 0 ? Damping::none : Damping::proportional;
    return;
  }
  classify_damping(relative, part);
  // A body without damping has the pattern of K for it, which is memory for nothing.
  if (part.damping == Damping::none && is_sparse(part.C))
    part.C.emplace<Sparse>(part.mass.size(), part.mass.size());
}

namespace detail {

AnyMatrix taken(AnyMatrix& from) {
  if (!is_sparse(from)) return std::move(from);
  // A swap of pointers, where a move would copy.
  AnyMatrix to{std::in_place_type<Sparse>};
  std::get<Sparse>(to).swap(std::get<Sparse>(from));
  return to;
}

void require_finite(const AnyMatrix& matrix, std::string_view what, double t) {
  each_entry(matrix, [&](Index i, Index j, double value) {
    if (!std::isfinite(value))
      throw InputError(fmt::format(
          "{} has {} at row {}, column {} (counted from 1) at t = {}: the rate of component {} has no finite "
          "slope along component {}; choose a state where the model is differentiable",
          what, to_text(value), i + 1, j + 1, to_text(t), i + 1, j + 1));
  });
}

// Counted from 1 in the message, as models number their components.
void require_finite_state(double t, const VectorXd& y) {
  if (!std::isfinite(t))
    throw InputError(fmt::format("the time of the linear model is {}; give a finite time", to_text(t)));
  for (Index i = 0; i < y.size(); ++i)
    if (!std::isfinite(y[i]))
      throw InputError(
          fmt::format("component {} (counted from 1) of the state to linearise at is {}; give a "
                      "finite state",
                      i + 1, to_text(y[i])));
}

std::pair<AnyMatrix, AnyMatrix> stiffness_and_damping_of(const AnyMatrix& J, const MassMatrix<double>& mass) {
  const Index n = mass.size();
  const Sparse M = mass.matrix();
  if (const auto* full = std::get_if<MatrixXd>(&J))
    return {MatrixXd(-(M * full->bottomLeftCorner(n, n))), MatrixXd(-(M * full->bottomRightCorner(n, n)))};
  std::vector<Eigen::Triplet<double>> stiffness, damping;
  each_entry(J, [&](Index i, Index j, double value) {
    if (i < n) return;
    auto& block = j < n ? stiffness : damping;
    // K = -M J_vq, C = -M J_vv from the lower half; the upper half is (0, I).
    block.emplace_back(static_cast<int>(i - n), static_cast<int>(j % n), -value);
  });
  Sparse K(n, n), C(n, n);
  K.setFromTriplets(stiffness.begin(), stiffness.end());
  C.setFromTriplets(damping.begin(), damping.end());
  return {Sparse(M * K), Sparse(M * C)};
}

}  // namespace detail
}  // namespace hmax
