#include "analysis/amplification/limits.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "analysis/amplification/structural_amplification.hpp"
#include "core/numbers.hpp"

namespace hmax {

namespace {

/// The map on the ray z = h direction, |direction| = 1, so that h is |z|.
Growth along(const Amplification& amplification, Complex direction) {
  return amplification.of_eigenmode(Eigenmode(direction));
}

/// A lobe is what lies between two unstable intervals, or behind the last one if that ends.
void add_lobes(const UnstableSteps& unstable, bool imaginary, std::vector<Lobe>& lobes) {
  for (std::size_t i = 0; i < unstable.intervals.size(); ++i) {
    const double from = unstable.intervals[i].to;
    if (std::isinf(from)) continue;
    lobes.push_back(
        {imaginary, from, i + 1 < unstable.intervals.size() ? unstable.intervals[i + 1].from : infinity});
  }
}

/// The smallest angle between the negative real axis and the curve z(theta) on which some |zeta| = 1, from
/// pi(exp(i theta), z) = 0 of methods that are linear in z; 90 degrees when it keeps to the right half-plane.
double wedge_of_locus(const StepPolynomial& in_z) {
  const auto angle = [&](double theta) {
    // pi(zeta, z) = constant(zeta) + z linear(zeta) = rho(zeta) - z sigma(zeta): the root locus
    // curve is z = rho / sigma.
    LongComplex constant = 0, linear = 0, power = 1;
    const LongComplex zeta = std::polar(1.0L, static_cast<long double>(theta));
    for (const ComplexPolynomial& q : in_z.coefficients()) {
      constant += power * q.at(0);
      if (q.size() > 1) linear += power * q[1];
      power *= zeta;
    }
    const LongComplex z = -constant / linear;
    // Points on the imaginary axis by rounding do not narrow the wedge.
    if (!(z.real() < -1e-14L * std::abs(z))) return std::numbers::pi / 2;
    return static_cast<double>(std::atan2(std::abs(z.imag()), -z.real()));
  };
  constexpr int parts = 2000;
  double best = std::numbers::pi / 2, at = 0;
  for (int i = 1; i < parts; ++i) {
    const double theta = std::numbers::pi * i / parts;
    if (const double here = angle(theta); here < best) {
      best = here;
      at = theta;
    }
  }
  // The minimum lies between the neighbours of the best of the samples.
  // Golden section around the smallest.
  double low = at - std::numbers::pi / parts, high = at + std::numbers::pi / parts;
  for (int i = 0; i < 60 && at > 0; ++i) {
    const double left = high - (high - low) / std::numbers::phi,
                 right = low + (high - low) / std::numbers::phi;
    if (angle(left) < angle(right))
      high = right;
    else
      low = left;
    best = std::min(best, angle((low + high) / 2));
  }
  return best * 180 / std::numbers::pi;
}

/// The wedge of a method whose stability on a ray is known as such, by bisection over the ray.
double wedge_of_rays(const Amplification& amplification) {
  const auto is_stable = [&](double degrees) {
    return std::isinf(first_exit(along(amplification, -std::polar(1.0, degrees * std::numbers::pi / 180))));
  };
  double inside = 0, outside = 90;
  // A ray is stable when it has no exit; the first unstable one in steps of two degrees brackets the
  // wedge.
  for (double degrees = 2; degrees < 90; degrees += 2) {
    if (!is_stable(degrees)) {
      outside = degrees;
      break;
    }
    inside = degrees;
  }
  while (outside - inside > 1e-9) {
    const double middle = (inside + outside) / 2;
    (is_stable(middle) ? inside : outside) = middle;
  }
  return inside;
}

/// Whether no pole lies in the left half-plane or on its edge.
/// The poles of R(z) = N(z) / D(z) are the roots of D, the coefficient of the highest power of zeta.
bool is_analytic_on_the_left(const StepPolynomial& in_z) {
  // The roots of D(z) are those of a polynomial in zeta whose coefficients are the numbers of D.
  std::vector<ComplexPolynomial> poles;
  for (const LongComplex c : in_z.coefficients().back()) poles.push_back({c});
  while (poles.size() > 1 && poles.back()[0] == LongComplex(0)) poles.pop_back();
  if (poles.size() < 2) return true;
  const std::vector<Complex> roots = StepPolynomial(poles).roots(0);
  return std::ranges::all_of(roots, [](Complex root) { return root.real() > 0; });
}

}  // namespace

// Three questions: the two axes, infinity, and the wedge in between, which is asked only where the whole
// negative real axis is stable.
StabilityLimits stability_limits(const Amplification& amplification) {
  StabilityLimits limits;
  const Growth real = along(amplification, -1), imaginary = along(amplification, Complex(0, 1));
  const UnstableSteps on_real = unstable_steps(real), on_imaginary = unstable_steps(imaginary);
  limits.real = on_real.first_exit();
  limits.imaginary = on_imaginary.first_exit();
  limits.imaginary_weak = first_exit(imaginary, 1e-6);
  add_lobes(on_real, false, limits.lobes);
  add_lobes(on_imaginary, true, limits.lobes);

  const std::optional<StepPolynomial>& in_z = amplification.in_z;
  if (in_z)
    limits.at_infinity = in_z->radius_at_infinity();
  else if (amplification.of_oscillation)
    limits.at_infinity =
        amplification.of_oscillation({.kappa = 1, .gamma = 0}).polynomial->radius_at_infinity();

  // Two coefficients in zeta: one root.
  const bool is_one_step = in_z && in_z->coefficients().size() == 2;
  if (std::isinf(limits.real)) {
    // Nothing larger on the edge, and analytic inside: nothing larger inside either.
    limits.a_stable = on_imaginary.intervals.empty() && (!is_one_step || is_analytic_on_the_left(*in_z));
    if (in_z && !is_one_step)
      limits.alpha_degrees = wedge_of_locus(*in_z);
    else
      limits.alpha_degrees = limits.a_stable ? 90 : wedge_of_rays(amplification);
    // The maps of oscillations are not analytic in z: both axes do not speak for what is between them.
    if (amplification.of_oscillation) {
      limits.a_stable = is_unconditionally_stable(amplification);
      if (!limits.a_stable && limits.alpha_degrees == 90) limits.alpha_degrees = wedge_of_rays(amplification);
    }
  }
  limits.l_stable = limits.a_stable && limits.at_infinity && *limits.at_infinity < annihilated;
  return limits;
}

}  // namespace hmax
