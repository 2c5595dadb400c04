#include "analysis/amplification/one_step_amplification.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace hmax {

namespace {

/// The stages of a method on a linear mode,
///   (1 - h d_i) S_i = 1 + h sum_{j < i} c_ij S_j,    y_new / y = 1 + h sum_j w_j S_j.
struct LinearStages {
  ComplexPolynomial d, w;  ///< shape (s) [1/s]
  ComplexPolynomial c;     ///< row-major, shape (s, s) [1/s]
};

/// Coefficients of the powers up to `order` are those of D(h) exp(lambda h); what rounding of the tableau
/// makes of them is put right, what is really different is left alone.
/// A method of order p has N(h) - D(h) exp(lambda h) = O(h^(p+1)) [hairer1996solving, IV.3].
void match_exponential(ComplexPolynomial& numerator, const ComplexPolynomial& denominator, LongComplex lambda,
                       int order) {
  for (std::size_t j = 0; j <= static_cast<std::size_t>(order) && j < numerator.size(); ++j) {
    LongComplex exact = 0, power = 1;
    long double size = 0;
    for (std::size_t k = 0; k <= j; ++k) {
      if (j - k < denominator.size()) {
        // sum_k D_j-k lambda^k / k!
        exact += denominator[j - k] * power;
        size += std::abs(denominator[j - k] * power);
      }
      power *= lambda / static_cast<long double>(k + 1);
    }
    if (std::abs(exact) <= 1e-15L * size) exact = 0;
    // 1e-10 of the terms: more than the rounding of tableaux published to sixteen digits, less than an
    // error of the order.
    if (std::abs(numerator[j] - exact) <= 1e-10L * size) numerator[j] = exact;
  }
}

/// Highest powers that are rounding only are dropped: they decide what happens at infinity.
void drop_rounding(ComplexPolynomial& p) {
  long double largest = 0;
  for (const LongComplex c : p) largest = std::max(largest, std::abs(c));
  while (p.size() > 1 && std::abs(p.back()) <= 1e-15L * largest) p.pop_back();
}

/// pi = D(h) zeta - N(h) of the stages by forward substitution over a common denominator.
/// N / D is y_new / y, so zeta = N / D; D = prod (1 - h d_j) over the stages in use.
StepPolynomial step_polynomial(const LinearStages& stages, LongComplex lambda, int order) {
  const std::size_t s = stages.d.size();
  // A stage that nobody uses, such as one of the error estimate, would only be a factor of both.
  std::vector<bool> used(s);
  for (std::size_t i = s; i-- > 0;) {
    used[i] = stages.w[i] != LongComplex(0);
    for (std::size_t later = i + 1; later < s; ++later)
      used[i] = used[i] || (used[later] && stages.c[later * s + i] != LongComplex(0));
  }
  // S_i = n_i / product_{j <= i} (1 - h d_j)
  std::vector<ComplexPolynomial> n(s);
  const auto factor = [&](std::size_t i) { return ComplexPolynomial{1, -stages.d[i]}; };
  const ComplexPolynomial h{0, 1};
  ComplexPolynomial before{1};
  // sum_j weight_j n_j over the product of the factors up to stage `end`
  const auto over_common = [&](std::size_t end, const auto& weight) {
    ComplexPolynomial sum;
    for (std::size_t j = 0; j < end; ++j) {
      if (!used[j]) continue;
      // Brings what was summed so far over the next factor.
      if (stages.d[j] != LongComplex(0)) sum = product(sum, factor(j));
      add(sum, weight(j), n[j]);
    }
    return sum;
  };
  for (std::size_t i = 0; i < s; ++i) {
    if (!used[i]) continue;
    n[i] = before;
    // (1 - h d_i) S_i = 1 + h sum_j c_ij S_j, over the product of the factors before i.
    add(n[i], LongComplex(1), product(h, over_common(i, [&](std::size_t j) { return stages.c[i * s + j]; })));
    if (stages.d[i] != LongComplex(0)) before = product(before, factor(i));
  }
  // y_new / y = 1 + h sum_j w_j S_j.
  ComplexPolynomial numerator = before;
  add(numerator, LongComplex(1), product(h, over_common(s, [&](std::size_t j) { return stages.w[j]; })));
  match_exponential(numerator, before, lambda, order);
  drop_rounding(numerator);
  for (LongComplex& c : numerator) c = -c;
  return StepPolynomial({std::move(numerator), std::move(before)});
}

/// A typical step 1 / |lambda| [s]; 1 of a mode that stands still.
double scale_of(Complex lambda) {
  const double size = std::abs(lambda);
  return size > 0 ? 1 / size : 1;
}

/// R(z) = N(z) / D(z)
std::function<Complex(Complex)> ratio(const StepPolynomial& in_z) {
  std::vector<Complex> numerator, denominator;
  for (const LongComplex c : in_z.coefficients()[0]) numerator.emplace_back(-c);
  for (const LongComplex c : in_z.coefficients()[1]) denominator.emplace_back(c);
  return [=](Complex z) { return evaluate(numerator, z) / evaluate(denominator, z); };
}

/// An amplification whose map depends on h lambda alone.
Amplification of_polynomial(StepPolynomial in_z) {
  Amplification amplification;
  amplification.R = ratio(in_z);
  amplification.of_eigenmode = [in_z](const Eigenmode& mode) {
    return Growth{.polynomial = in_z.along(mode.lambda), .scale = scale_of(mode.lambda)};
  };
  amplification.in_z = std::move(in_z);
  return amplification;
}

/// A copy, for functions that outlive the tableau.
std::vector<long double> owned(std::span<const long double> numbers) {
  return {numbers.begin(), numbers.end()};
}

}  // namespace

Amplification runge_kutta_amplification(std::span<const long double> a, std::span<const long double> b,
                                        int order) {
  const std::size_t s = b.size();
  // lambda = 1: d_i = a_ii, c_ij = a_ij, w = b, with the stage values S_i.
  LinearStages stages{ComplexPolynomial(s), ComplexPolynomial(b.begin(), b.end()), {a.begin(), a.end()}};
  for (std::size_t i = 0; i < s; ++i) stages.d[i] = a[i * s + i];
  return of_polynomial(step_polynomial(stages, 1, order));
}

// R = det(I - z A + z 1 b^T) / det(I - z A) [hairer1996solving, IV.3]; with M the matrix, det(I - z M) =
// sum_k c_k z^k.
Amplification full_runge_kutta_amplification(std::span<const long double> a, std::span<const long double> b,
                                             int order) {
  const std::size_t s = b.size();
  // det(I - z M) by Faddeev and LeVerrier: c_k = -trace(M P_k-1) / k, P_k = M P_k-1 + c_k I.
  const auto determinant = [s](const std::vector<long double>& M) {
    std::vector<long double> P(s * s);
    for (std::size_t i = 0; i < s; ++i) P[i * s + i] = 1;
    ComplexPolynomial c{1};
    for (std::size_t k = 1; k <= s; ++k) {
      std::vector<long double> MP(s * s);
      for (std::size_t i = 0; i < s; ++i)
        for (std::size_t j = 0; j < s; ++j)
          for (std::size_t l = 0; l < s; ++l) MP[i * s + j] += M[i * s + l] * P[l * s + j];
      long double trace = 0;
      for (std::size_t i = 0; i < s; ++i) trace += MP[i * s + i];
      c.emplace_back(-trace / static_cast<long double>(k));
      P = std::move(MP);
      for (std::size_t i = 0; i < s; ++i) P[i * s + i] += c.back().real();
    }
    return c;
  };
  // det(I - z A), then det(I - z (A - 1 b^T)).
  std::vector<long double> M = owned(a);
  ComplexPolynomial denominator = determinant(M);
  for (std::size_t i = 0; i < s; ++i)
    for (std::size_t j = 0; j < s; ++j) M[i * s + j] -= b[j];
  ComplexPolynomial numerator = determinant(M);
  match_exponential(numerator, denominator, 1, order);
  drop_rounding(numerator);
  for (LongComplex& c : numerator) c = -c;
  return of_polynomial(StepPolynomial({std::move(numerator), std::move(denominator)}));
}

/// In the variables S_i = k_i / (h lambda) the stages are
///   (1 - h lambda0 gamma_ii) S_i = 1 + h sum_{j < i} (lambda alpha_ij + lambda0 gamma_ij) S_j,
/// and y_new / y = 1 + h lambda sum_i b_i S_i.
Amplification rosenbrock_amplification(std::span<const long double> alpha, std::span<const long double> gamma,
                                       std::span<const long double> b, int order) {
  const auto polynomial = [alpha = owned(alpha), gamma = owned(gamma), b = owned(b), order](
                              LongComplex lambda, LongComplex frozen) {
    const std::size_t s = b.size();
    LinearStages stages{ComplexPolynomial(s), ComplexPolynomial(s), ComplexPolynomial(s * s)};
    for (std::size_t i = 0; i < s; ++i) {
      stages.d[i] = frozen * gamma[i * s + i];
      stages.w[i] = lambda * b[i];
      for (std::size_t j = 0; j < i; ++j)
        stages.c[i * s + j] = lambda * alpha[i * s + j] + frozen * gamma[i * s + j];
    }
    return step_polynomial(stages, lambda, order);
  };
  Amplification amplification = of_polynomial(polynomial(1, 1));
  amplification.of_eigenmode = [polynomial, exact = amplification.of_eigenmode](const Eigenmode& mode) {
    if (mode.frozen == mode.lambda) return exact(mode);
    // h^j takes the factor size^j afterwards, by along().
    // In units of the faster of the two, so that no coefficient is small for its unit.
    const double size = std::max(std::abs(mode.lambda), std::abs(mode.frozen));
    return Growth{
        .polynomial =
            polynomial(LongComplex(mode.lambda / size), LongComplex(mode.frozen / size)).along(size),
        .scale = 1 / size};
  };
  return amplification;
}

// In units of the faster of the two parts, as for a foreign Jacobian above.
Amplification additive_amplification(std::span<const long double> a_nonstiff,
                                     std::span<const long double> b_nonstiff,
                                     std::span<const long double> a_stiff,
                                     std::span<const long double> b_stiff, int order) {
  const auto polynomial = [aE = owned(a_nonstiff), bE = owned(b_nonstiff), aI = owned(a_stiff),
                           bI = owned(b_stiff), order](LongComplex nonstiff, LongComplex stiff) {
    const std::size_t s = bE.size();
    LinearStages stages{ComplexPolynomial(s), ComplexPolynomial(s), ComplexPolynomial(s * s)};
    for (std::size_t i = 0; i < s; ++i) {
      // Y_i = S_i: the stage values themselves.
      stages.d[i] = stiff * aI[i * s + i];
      stages.w[i] = nonstiff * bE[i] + stiff * bI[i];
      for (std::size_t j = 0; j < i; ++j)
        stages.c[i * s + j] = nonstiff * aE[i * s + j] + stiff * aI[i * s + j];
    }
    return step_polynomial(stages, nonstiff + stiff, order);
  };
  // All of it stiff: the implicit half alone.
  Amplification amplification = of_polynomial(polynomial(0, 1));
  amplification.of_eigenmode = [polynomial, implicit = amplification.of_eigenmode](const Eigenmode& mode) {
    if (mode.stiff == mode.lambda) return implicit(mode);
    const Complex nonstiff = mode.lambda - mode.stiff;
    const double size = std::max(std::abs(nonstiff), std::abs(mode.stiff));
    return Growth{
        .polynomial = polynomial(LongComplex(nonstiff / size), LongComplex(mode.stiff / size)).along(size),
        .scale = 1 / size};
  };
  return amplification;
}

}  // namespace hmax
