#include "analysis/foreign_steps/step_shares.hpp"

#include <cmath>
#include <complex>

#include "analysis/foreign_steps/step_derivative.hpp"
#include "analysis/spectrum/lanczos.hpp"
#include "core/dense_solvers.hpp"

namespace hmax {
namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Complex = std::complex<double>;

/// The relative change of a part, or of the step size.
constexpr double change = 0.01;

/// Eigenvectors of J for a multiplier, shape (n, m), and their left ones with L V = 1, shape (m, n).
struct Eigenspace {
  MatrixXcd V, L;
};

/// Columns that span the same, of length 1 and orthogonal.
void orthonormalise(MatrixXcd& V) {
  for (Index k = 0; k < V.cols(); ++k)
    for (int pass = 0; pass < 2; ++pass) {
      for (Index j = 0; j < k; ++j) V.col(k) -= V.col(j) * V.col(j).dot(V.col(k));
      V.col(k).normalize();
    }
}

/// By inverse iteration beside the multiplier.
Eigenspace eigenspace_of(const MatrixXd& J, Complex multiplier, Index count) {
  const Index n = J.rows();
  const MatrixXcd shifted = J.cast<Complex>() - (1 + 1e-9) * multiplier * MatrixXcd::Identity(n, n);
  const Eigen::PartialPivLU<MatrixXcd> factors(shifted);
  MatrixXcd V(n, count);
  for (Index k = 0; k < count; ++k) V.col(k) = start_vector(n + 7 * k).tail(n).cast<Complex>();
  MatrixXcd W = V;
  for (int k = 0; k < 4; ++k) {
    V = factors.solve(V).eval();
    W = factors.adjoint().solve(W).eval();
    orthonormalise(V);
    orthonormalise(W);
  }
  return {.V = V, .L = (W.adjoint() * V).eval().partialPivLu().solve(W.adjoint())};
}

/// How many multipliers are there, those of symmetric scenes: counted up to the size of which all are found.
Index multiplicity(const MatrixXd& J, Complex multiplier) {
  if (J.rows() > StepSpectrumSettings{}.eigenvalues_to) return 1;
  const double near = 1e-6 * std::abs(multiplier);
  return std::max<Index>(1, ((dense_eigenvalues(J).array() - multiplier).abs() < near).count());
}

/// J V by differences of steps.
MatrixXcd product(const StepDerivative& J, const MatrixXcd& V) {
  MatrixXcd JV(V.rows(), V.cols());
  for (Index k = 0; k < V.cols(); ++k) {
    JV.col(k).real() = J.product(V.col(k).real());
    JV.col(k).imag() = J.product(V.col(k).imag());
  }
  return JV;
}

}  // namespace

std::vector<PartShare> shares_of_limit(ForeignStepper& engine, const StateCoordinates& coordinates,
                                       const Eigen::VectorXd& scale, int slot, const Eigen::VectorXd& y,
                                       const StepSpectrum& critical, const std::function<void()>& watch) {
  const StepDerivative derivative(engine, coordinates, scale, slot, y, critical.h);
  StepPattern pattern;
  const MatrixXd J = derivative.matrix(pattern, [&](double) { watch(); });
  const Complex mu = critical.multiplier;
  Eigenspace space = eigenspace_of(J, mu, multiplicity(J, mu));
  // What is real is asked for once.
  if (mu.imag() == 0) space.V.imag().setZero(), space.L.imag().setZero();
  const auto rate = [&](const MatrixXcd& ahead, const MatrixXcd& behind) {
    const Complex trace = (space.L * (ahead - behind)).trace();
    return (trace / (mu * static_cast<double>(space.V.cols()))).real() / (2 * change);
  };
  const auto at_step = [&](double factor) {
    return product(StepDerivative(engine, coordinates, scale, slot, y, factor * critical.h), space.V);
  };
  const double of_step = rate(at_step(1 + change), at_step(1 - change));
  if (!(of_step > 1e-6)) return {};
  const std::vector<ScenePart> parts = engine.parts();
  std::vector<PartShare> shares(parts.size());
  for (std::size_t i = 0; i < parts.size(); ++i) {
    watch();
    const auto with = [&](double stiffness, double damping) {
      engine.scale_part(i, stiffness, damping);
      return product(derivative, space.V);
    };
    if (parts[i].stiffness != 0)
      shares[i].of_stiffness = 2 * rate(with(1 + change, 1), with(1 - change, 1)) / of_step;
    if (parts[i].damping != 0)
      shares[i].of_damping = rate(with(1, 1 + change), with(1, 1 - change)) / of_step;
    engine.scale_part(i, 1, 1);
  }
  return shares;
}

}  // namespace hmax
