#include "analysis/amplification/structural_amplification.hpp"

#include <array>
#include <cmath>

namespace hmax {

namespace {

Polynomial sum(Polynomial p, const Polynomial& q) {
  add(p, 1.0L, q);
  return p;
}

/// Of a single oscillation the polynomial in zeta  inertia + h gamma (damper + lumped) + h^2 kappa spring.
Amplification of_map(const MotionMap& whole) {
  const MotionMap map{
      .inertia = whole.inertia, .damper = sum(whole.damper, whole.lumped), .spring = whole.spring};
  Amplification amplification;
  amplification.motion = whole;
  amplification.of_oscillation = [map](const MechanicalMode& mode) {
    const std::size_t size = std::max({map.inertia.size(), map.damper.size(), map.spring.size()});
    std::vector<Polynomial> p(size, Polynomial(3));
    const auto collect = [&p](const Polynomial& of, std::size_t power, long double factor) {
      for (std::size_t j = 0; j < of.size(); ++j) p[j][power] = factor * of[j];
    };
    // p_j(h) = inertia_j + gamma damper_j h + kappa spring_j h^2.
    collect(map.inertia, 0, 1);
    collect(map.damper, 1, mode.gamma);
    collect(map.spring, 2, mode.kappa);
    // The faster of oscillation and damping [1/s].
    const double rate = std::max(std::sqrt(std::abs(mode.kappa)), std::abs(mode.gamma) / 2);
    return Growth{.polynomial = StepPolynomial::real(p), .scale = rate > 0 ? 1 / rate : 1};
  };
  amplification.of_eigenmode = [of = amplification.of_oscillation](const Eigenmode& mode) {
    return of(MechanicalMode::of(mode.lambda));
  };
  amplification.stable_at = [map](Complex z) {
    std::array<Complex, 4> c{};
    const auto collect = [&c](const Polynomial& of, double factor) {
      for (std::size_t j = 0; j < of.size(); ++j) c[j] += factor * static_cast<double>(of[j]);
    };
    collect(map.inertia, 1);
    // h gamma = -2 Re z and h^2 kappa = |z|^2 of the pair z, conj(z).
    collect(map.damper, -2 * z.real());
    collect(map.spring, std::norm(z));
    std::size_t degree = 3;
    while (degree > 0 && c[degree] == Complex(0)) --degree;
    return roots_are_at_most_one(c.data(), degree);
  };
  return amplification;
}

// zeta = `one_shift`, s = zeta - 1 and s^2 as polynomials in zeta: q_n+1 - q_n and the second difference, by
// shifts.
const Polynomial one_shift{0, 1}, s{-1, 1}, s_squared{1, -2, 1};

}  // namespace

Amplification symplectic_euler_amplification() {
  // s^2 + h gamma s + h^2 kappa zeta.
  return of_map({.inertia = s_squared, .damper = s, .spring = one_shift});
}

// Velocity Verlet: v_half = v + h/2 a, q_new = q + h v_half, v_new = v_half + h/2 a_new. What differs is
// at which velocity a_new takes its damping.
Amplification kick_drift_kick_amplification(KickDamping damping) {
  // Of (q, v_half) the same steps.
  if (damping == KickDamping::half_step) return symplectic_euler_amplification();
  const Polynomial W{0.5L, 0.5L};
  MotionMap map{.inertia = product(one_shift, s_squared),
                .damper = sum(product(W, s), s_squared),
                .spring = product(one_shift, one_shift)};
  // The new acceleration is that of the predicted velocity, (1 + h/2 gamma) a_new = ... + h/2 gamma a: with
  // a = s^2 it adds  h/2 gamma (zeta - 1) s^2, and of a single oscillation all that stands beside zeta is
  // s^2 + h gamma W s + h^2 kappa zeta.
  if (damping == KickDamping::lumped) map.lumped = {-0.5L, 1.5L, -1.5L, 0.5L};
  return of_map(map);
}

// Balance at alpha-weighted points between the ends of the step: M a + F (gamma v + kappa q) = 0 as
// polynomials in the shift zeta [chung1993time].
Amplification generalized_alpha_amplification(const AlphaParameters& p) {
  // q_n+1 = q + h v + h^2 ((1/2 - beta) a + beta a_new) and v_n+1 = v + h ((1 - gamma) a + gamma a_new), that
  // is
  //   s q = h v + h^2 B a,   s v = h W a   [newmark1959method].
  const Polynomial W{1 - p.gamma, p.gamma}, B{0.5L - p.beta, p.beta};
  const Polynomial F{p.alpha_f, 1 - p.alpha_f}, M{p.alpha_m, 1 - p.alpha_m};
  // M a + F (gamma v + kappa q) = 0 with h^2 a = s^2 x, h v = W s x and q = (W + B s) x.
  return of_map({.inertia = product(M, s_squared),
                 .damper = product(F, product(W, s)),
                 .spring = product(F, sum(W, product(B, s)))});
}

bool is_unconditionally_stable(const Amplification& amplification) {
  // The conditions hold for every h or they do not; between damping ratios they vary slowly.
  for (const double zeta_of_mode : {0.0, 1e-3, 0.01, 0.1, 0.3, 0.6, 1.0, 2.0, 10.0})
    if (!unstable_steps(amplification.of_oscillation({.kappa = 1, .gamma = 2 * zeta_of_mode}))
             .intervals.empty())
      return false;
  return true;
}

bool annihilates_fast_modes(const Amplification& amplification) {
  return amplification.of_oscillation({.kappa = 1, .gamma = 0}).polynomial.value().radius_at_infinity() <
         annihilated;
}

}  // namespace hmax
