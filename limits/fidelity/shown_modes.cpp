#include "limits/fidelity/shown_modes.hpp"

#include <algorithm>
#include <cmath>
#include <complex>

#include <Eigen/Eigenvalues>

#include "analysis/spectrum/arnoldi.hpp"
#include "analysis/spectrum/lanczos.hpp"

namespace hmax {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;

/// States in units in which |x|^2 is the energy of a mode of frequency `omega`: x = (omega R q, R v), M = R^T
/// R.
struct EnergyUnits {
  const MassMatrix<double>& mass;
  double omega;

  [[nodiscard]] VectorXd of(const VectorXd& y) const {
    const Eigen::Index n = mass.size();
    VectorXd x(2 * n);
    x << omega * mass.root_times(VectorXd(y.head(n))), mass.root_times(VectorXd(y.tail(n)));
    return x;
  }
  [[nodiscard]] VectorXd back(const VectorXd& x) const {
    const Eigen::Index n = mass.size();
    VectorXd y(2 * n);
    y << mass.root_solve(VectorXd(x.head(n))) / omega, mass.root_solve(VectorXd(x.tail(n)));
    return y;
  }
};

/// What a Ritz vector in energy units has of a shape, relative to all of its displacement.
/// @param scaled  R u, shape (dofs)
double likeness(const VectorXcd& x, const VectorXd& scaled) {
  const VectorXcd q = x.head(scaled.size());
  return std::abs(q.dot(scaled.cast<std::complex<double>>())) / q.norm();
}

/// The real motion x e^(i a) that is most like a shape, with displacements of length 1.
/// @param x  a Ritz vector in energy units
VectorXd real_motion(const VectorXcd& x, const VectorXd& scaled) {
  const std::complex<double> along = x.head(scaled.size()).dot(scaled.cast<std::complex<double>>());
  const VectorXd motion = (x * (along / std::abs(along))).real();
  return motion / motion.head(scaled.size()).norm();
}

/// Modes that steps do not mix with others, as methods with linear equations do not: eigenvalues of the step
/// on the plane of displacements and velocities along one.
/// @param A       the derivative of a step in energy units
/// @param shapes  R u, columns of length 1
std::vector<FoundMode> modes_alone(const LinearOperator& A, const MatrixXd& shapes, double h) {
  constexpr double most_mixed = 1e-4;  // of 1 - lambda
  const Eigen::Index n = shapes.rows();
  std::vector<FoundMode> found(static_cast<std::size_t>(shapes.cols()));
  for (Eigen::Index k = 0; k < shapes.cols(); ++k) {
    MatrixXd plane = MatrixXd::Zero(2 * n, 2);
    plane.col(0).head(n) = plane.col(1).tail(n) = shapes.col(k);
    MatrixXd image(2 * n, 2);
    for (Eigen::Index i = 0; i < 2; ++i) image.col(i) = A(plane.col(i));
    const Eigen::Matrix2d own = plane.transpose() * image;
    const double mixed = (image - plane * own).norm();
    const Eigen::Vector2cd values = own.eigenvalues();
    if (!(mixed <= most_mixed * (1.0 - values.array()).abs().minCoeff())) continue;
    for (const std::complex<double>& value : values)
      if (value.imag() > 0 || (value.imag() == 0 && value.real() > 0))
        found[static_cast<std::size_t>(k)].look(std::log(value) / h, 1, 0);
  }
  return found;
}

/// Looks in a spectrum for each mode that is not known yet, and keeps the oscillation that is most like it.
/// @param scaled  R u, columns of length 1
/// @param known   of modes_alone(): its eigenvalues are in the spectrum too, and would count twice
void look_through(const RitzSpectrum& spectrum, const MatrixXd& scaled, double h,
                  const std::vector<FoundMode>& known, std::vector<FoundMode>& found,
                  std::vector<VectorXd>& oscillations) {
  found = known;
  std::vector<double> likest(found.size(), 0);
  for (std::size_t i = 0; i < spectrum.values.size(); ++i) {
    const std::complex<double> value = spectrum.values[i].value;
    // Of a pair the upper one; a negative number turns about in every step.
    if (value.imag() < 0 || (value.imag() == 0 && value.real() <= 0)) continue;
    const VectorXcd x = spectrum.vector(i);
    for (std::size_t k = 0; k < found.size(); ++k) {
      if (known[k].converged(0)) continue;
      const VectorXd shape = scaled.col(static_cast<Eigen::Index>(k));
      const double like = likeness(x, shape);
      found[k].look(std::log(value) / h, like, spectrum.values[i].residual / std::abs(1.0 - value));
      if (value.imag() == 0 || like <= likest[k]) continue;
      likest[k] = like;
      oscillations[k] = real_motion(x, shape);
    }
  }
}

}  // namespace

StepModes shown_modes(const VectorFunction& step, const VectorXd& q, const VectorXd& sizes, double h,
                      const MassMatrix<double>& mass, const MatrixXd& shapes,
                      const std::vector<ShownMode>& modes, const std::function<void()>& watch) {
  const Eigen::Index n = q.size();
  const EnergyUnits units{mass, modes.empty() ? 0.1 / h : modes.front().omega};
  const MatrixXd scaled = mass.root_times(shapes);
  VectorXd y = VectorXd::Zero(2 * n);
  y.head(n) = q;
  // A ten-thousandth: large beside rounding, small beside curvature.
  const double size = 1e-4 * units.omega * mass.root_times(sizes).norm();
  const LinearOperator A = [&](const VectorXd& x) -> VectorXd {
    if (watch) watch();
    const double length = x.norm();
    if (!(length > 0)) return VectorXd::Zero(2 * n);
    const VectorXd d = size / length * units.back(x);
    return length / (2 * size) * units.of(step(y + d) - step(y - d));
  };
  // The modes, and a little of everything else: what grows may be none of them.
  VectorXd start = VectorXd::Zero(2 * n);
  for (Eigen::Index k = 0; k < shapes.cols(); ++k) start.head(n) += units.omega * scaled.col(k);
  const VectorXd others = start_vector(2 * n);
  start += (modes.empty() ? 1 : 0.02 * start.norm()) / others.norm() * others;

  constexpr double most_curved = 1e-3;
  StepModes shown;
  const VectorXd other = start.reverse(), together = A(start + other), sum = A(start) + A(other);
  shown.linear = (together - sum).norm() <= most_curved * together.norm();
  const std::vector<FoundMode> alone =
      shown.linear ? modes_alone(A, scaled, h) : std::vector<FoundMode>(modes.size());
  std::vector<FoundMode> found = alone;
  std::vector<VectorXd> oscillations(modes.size());
  ArnoldiSettings settings;
  settings.basis = std::min<Eigen::Index>(80, 2 * n);
  settings.kept = std::min<Eigen::Index>(40, std::max<Eigen::Index>(1, settings.basis / 2));
  settings.most_products = 1200;
  constexpr double resolved = 1e-3, tolerance = 1e-5, barely = 1e-5;
  if (shown.linear)
    visit_ritz_spectra(A, start, settings, 20, [&](const RitzSpectrum& spectrum) {
      const RitzValue& largest = spectrum.values.front();
      // Slow and fast motions make the step far from normal: a residual bounds the error of an eigenvalue by
      // its condition alone.
      const double excess = std::abs(largest.value) - 1;
      const bool grows = excess > barely && largest.condition * largest.residual < resolved * excess;
      shown.largest = grows || excess <= barely ? largest.value : 1.0;
      look_through(spectrum, scaled, h, alone, found, oscillations);
      return spectrum.invariant ||
             ((grows || (excess <= barely && largest.residual < resolved)) &&
              std::ranges::all_of(found, [](const FoundMode& each) { return each.converged(tolerance); }));
    });
  for (std::size_t k = 0; k < modes.size(); ++k) shown.modes.push_back(found[k].shown(modes[k]));
  shown.starts = MatrixXd::Zero(2 * n, shapes.cols());
  shown.starts.topRows(n) = shapes;
  constexpr double kept = 0.9999;  // the shape itself has no rounding
  for (std::size_t k = 0; k < modes.size(); ++k)
    if (found[k].oscillates() && oscillations[k].size() > 0 && shown.modes[k].likeness < kept)
      shown.starts.col(static_cast<Eigen::Index>(k)) = units.omega * units.back(oscillations[k]);
  return shown;
}

}  // namespace hmax
