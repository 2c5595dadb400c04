#include "problems/oscillator/oscillator_exact.hpp"

#include <algorithm>
#include <cmath>
#include <complex>

namespace hmax {
namespace {

using Real = long double;
using Complex = std::complex<Real>;
using State = BasicOscillator<Real>::State;

// Linear oscillator. With r1, r2 the roots of r^2 + (c/m) r + k1/m and f[a, b, ..] the divided differences of
// f(z) = e^(zt), the response to an initial state and to a force is
//   x = x0 (f[r1] - r1 f[r1, r2]) + v0 f[r1, r2] + (P/m) Re f[r1, r2, iw].
// Divided differences are smooth functions of their points, so nothing happens where roots meet each other
// (critical damping) or the force (resonance), if only they are evaluated without cancellation.

/// e^z - 1 for complex z, accurate near 0.
Complex expm1(Complex z) {
  const Real half_sine = std::sin(z.imag() / 2);
  return {std::expm1(z.real()) * std::cos(z.imag()) - 2 * half_sine * half_sine,
          std::exp(z.real()) * std::sin(z.imag())};
}

/// f[a, b] = e^(at) (e^((b-a)t) - 1) / (b - a), the larger exponential taken out so that nothing overflows
/// early.
Complex difference(Complex a, Complex b, Real t) {
  if ((a.real() - b.real()) * t < 0) std::swap(a, b);
  const Complex d = b - a;
  return std::exp(a * t) * (d == Complex(0) ? Complex(t) : expm1(d * t) / d);
}

/// f[a, b, c]: the recursion over its two most distant points, or the series
///   f[a, b, c] = t^2 e^(zt) sum_k t^k h_k(a-z, b-z, c-z) / (k+2)!
/// when all points lie within 1/t of their mean z; h_k is the complete homogeneous symmetric polynomial.
Complex difference(Complex a, Complex b, Complex c, Real t) {
  if (std::abs(a - b) < std::abs(a - c)) std::swap(b, c);
  if (std::abs(a - b) < std::abs(b - c)) std::swap(a, c);
  if (std::abs((a - b) * t) > 1) return (difference(a, c, t) - difference(b, c, t)) / (a - b);
  const Complex z = (a + b + c) / Real(3);
  const Complex p[3] = {(a - z) * t, (b - z) * t, (c - z) * t};
  Complex h[3] = {1, 1, 1};  // h_k of the first one, two, three points
  Complex sum = 0;
  Real factor = Real(1) / 2;  // 1 / (k+2)!
  for (int k = 0; k < 30; ++k) {
    sum += factor * h[2];
    factor /= static_cast<Real>(k + 3);
    h[0] *= p[0];
    h[1] = h[0] + p[1] * h[1];
    h[2] = h[1] + p[2] * h[2];
  }
  return t * t * std::exp(z * t) * sum;
}

ExactSolution linear_solution(const OscillatorParameters& p, Real x0, Real v0) {
  const Real m = p.m;
  const Real g = p.c / (2 * m);
  const Real w0_squared = p.k1 / m;
  const Real discriminant = g * g - w0_squared;
  Complex r1, r2;  // Re r1 >= Re r2
  if (discriminant < 0) {
    r1 = Complex(-g, std::sqrt(-discriminant));
    r2 = std::conj(r1);
  } else {
    // The root in which g and the square root add up; the other one from the product of the roots.
    const Real large = -(g + std::copysign(std::sqrt(discriminant), g));
    const Real small = large != 0 ? w0_squared / large : Real(0);
    r1 = std::max(large, small);
    r2 = std::min(large, small);
  }
  const Real force = p.P / m;
  const Complex iw(0, p.w);
  return ExactSolution([=](Real t) -> State {
    const Real s = difference(r1, r2, t).real();
    Real x = x0 * (std::exp(r1 * t) - r1 * s).real() + v0 * s;
    Real v = -x0 * w0_squared * s + v0 * (std::exp(r2 * t) + r1 * s).real();
    if (force != 0) {
      const Complex response = difference(r1, r2, iw, t);
      x += force * response.real();
      v += force * ((iw * response).real() + s);  // (z f)[r1, r2, iw] = iw f[r1, r2, iw] + f[r1, r2]
    }
    return {x, v};
  });
}

/// Jacobi's sn, cn, dn at one argument.
struct Jacobi {
  Real sn, cn, dn;
};

/// Jacobi functions of parameter M = 1 - M1 by the arithmetic-geometric mean and descending Landen
/// transformations [olver2010nist] 22.20(ii). M1 is a parameter of its own because 1 - M loses it near a
/// separatrix.
Jacobi jacobi(Real u, Real M, Real M1) {
  Real a[16], c[16];
  a[0] = 1;
  Real b = std::sqrt(M1);
  c[0] = std::sqrt(M);
  int n = 0;
  while (c[n] > 1e-10L * a[n] &&
         n < 15) {  // the next c would be below the rounding: convergence is quadratic
    a[n + 1] = (a[n] + b) / 2;
    c[n + 1] = (a[n] - b) / 2;
    b = std::sqrt(a[n] * b);
    ++n;
  }
  Real phi = std::ldexp(a[n] * u, n);
  for (; n > 0; --n) phi = (phi + std::asin(c[n] / a[n] * std::sin(phi))) / 2;
  const Real cn = std::cos(phi);
  return {std::sin(phi), cn, std::sqrt(M1 + M * cn * cn)};
}

/// Jacobi functions of u + v from those of u and of v [olver2010nist] 22.8.
Jacobi add(const Jacobi& u, const Jacobi& v, Real M) {
  const Real ss = u.sn * v.sn;
  const Real denominator = 1 - M * ss * ss;
  return {(u.sn * v.cn * v.dn + v.sn * u.cn * u.dn) / denominator,
          (u.cn * v.cn - ss * u.dn * v.dn) / denominator, (u.dn * v.dn - M * ss * u.cn * v.cn) / denominator};
}

/// x'' + a x + b x^3 = 0, b != 0. The initial phase enters through its own sn, cn, dn, known from x0 and v0,
/// and an addition theorem: no elliptic integral has to be inverted. s^2 = a^2 + 4 b E, written without
/// cancellation.
std::optional<ExactSolution> cubic_solution(Real a, Real b, Real x0, Real v0) {
  if (x0 == 0 && v0 == 0) return ExactSolution([](Real) -> State { return {0, 0}; });
  const Real energy = v0 * v0 / 2 + x0 * x0 * (a / 2 + b * x0 * x0 / 4);
  const Real tangent = a + b * x0 * x0;
  const Real speed = std::sqrt(2 * std::abs(b)) * v0;

  if (b > 0 && energy > 0) {  // around all equilibria: x = A cn, Om^2 = s, M = (s - a) / (2 s)
    const Real s = std::hypot(tangent, speed);
    const Real s_minus_a = a > 0 ? 4 * b * energy / (s + a) : s - a;
    const Real s_plus_a = a < 0 ? 4 * b * energy / (s - a) : s + a;
    const Real A = a > 0 ? std::sqrt(4 * energy / (s + a)) : std::sqrt(s_minus_a / b);
    const Real Om = std::sqrt(s), M = s_minus_a / (2 * s), M1 = s_plus_a / (2 * s);
    Jacobi phase{0, x0 / A, 0};
    phase.dn = std::sqrt(M1 + M * phase.cn * phase.cn);
    phase.sn = -v0 / (A * Om * phase.dn);
    return ExactSolution([=](Real t) -> State {
      const auto [sn, cn, dn] = add(jacobi(Om * t, M, M1), phase, M);
      return {A * cn, -A * Om * sn * dn};
    });
  }
  if (b > 0 && energy < 0) {  // inside one of two wells: x = A dn, Om^2 = (s - a) / 2, M = 2 s / (s - a)
    const Real s = std::hypot(tangent, speed);
    const Real A = std::copysign(std::sqrt((s - a) / b), x0);
    const Real Om = std::sqrt((s - a) / 2), M = 2 * s / (s - a), M1 = -4 * b * energy / ((s - a) * (s - a));
    const Real angle = std::atan2(-std::copysign(Real(1), x0) * speed, tangent) / 2;
    const Jacobi phase{std::sin(angle), std::cos(angle), x0 / A};
    return ExactSolution([=](Real t) -> State {
      const auto [sn, cn, dn] = add(jacobi(Om * t, M, M1), phase, M);
      return {A * dn, -A * Om * M * sn * cn};
    });
  }
  if (b < 0 && tangent > std::abs(speed)) {  // softening, below the barrier: x = A sn, Om^2 = (a + s) / 2
    const Real s = std::sqrt((tangent - speed) * (tangent + speed));
    const Real A = std::sqrt(4 * energy / (a + s)), Om = std::sqrt((a + s) / 2);
    const Real M = -4 * b * energy / ((a + s) * (a + s)), M1 = 2 * s / (a + s);
    Jacobi phase{x0 / A, 0, 0};
    phase.dn = std::sqrt(1 - M * phase.sn * phase.sn);
    phase.cn = v0 / (A * Om * phase.dn);
    return ExactSolution([=](Real t) -> State {
      const auto [sn, cn, dn] = add(jacobi(Om * t, M, M1), phase, M);
      return {A * sn, A * Om * cn * dn};
    });
  }
  return std::nullopt;
}

}  // namespace

std::optional<ExactSolution> exact_solution(const OscillatorParameters& parameters,
                                            const Eigen::Vector2d& y0) {
  const BasicOscillator<Real> valid(parameters);
  if (parameters.k3 == 0) return linear_solution(parameters, y0[0], y0[1]);
  if (parameters.c != 0 || parameters.P != 0) return std::nullopt;
  const Real m = parameters.m;
  return cubic_solution(parameters.k1 / m, parameters.k3 / m, y0[0], y0[1]);
}

}  // namespace hmax
