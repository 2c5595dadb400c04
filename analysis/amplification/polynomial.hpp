/// Real and complex polynomials in long double: arithmetic, and where a real one is negative.
#pragma once

#include <complex>
#include <span>
#include <vector>

namespace hmax {

using LongComplex = std::complex<long double>;

/// Coefficients in ascending powers: c[0] + c[1] x + ...; empty is zero.
using Polynomial = std::vector<long double>;
using ComplexPolynomial = std::vector<LongComplex>;

/// c(x) by Horner's rule; Number is what both coefficients and x convert to.
template <class Number, class Coefficients>
Number evaluate(const Coefficients& c, Number x) {
  Number sum(0);
  for (std::size_t i = c.size(); i-- > 0;) sum = sum * x + Number(c[i]);
  return sum;
}

/// The coefficients of p q: r_k = sum_i p_i q_k-i, degree p + degree q + 1 of them; empty where p or q is
/// zero.
template <class Number>
std::vector<Number> product(const std::vector<Number>& p, const std::vector<Number>& q) {
  if (p.empty() || q.empty()) return {};
  std::vector<Number> r(p.size() + q.size() - 1, Number(0));
  for (std::size_t i = 0; i < p.size(); ++i)
    for (std::size_t j = 0; j < q.size(); ++j) r[i + j] += p[i] * q[j];
  return r;
}

/// p += factor q
/// p grows to the length of q where it is shorter.
template <class Number>
void add(std::vector<Number>& p, const Number& factor, const std::vector<Number>& q) {
  if (p.size() < q.size()) p.resize(q.size(), Number(0));
  for (std::size_t i = 0; i < q.size(); ++i) p[i] += factor * q[i];
}

/// A sum of products that knows how large its terms were: a coefficient that is all cancellation is zero.
class CancellingSum {
 public:
  /// sum += sign p q
  /// Also adds |p| |q|, coefficient by coefficient, to the sizes that value() compares with.
  void add(long double sign, const Polynomial& p, const Polynomial& q);

  /// The sum, without the coefficients that are less than `rounding` of the terms they were made from.
  [[nodiscard]] Polynomial value(long double rounding = 1e-15L) const;

 private:
  Polynomial sum_, magnitude_;
};

/// An open interval of positive numbers; `to` may be infinity.
struct Interval {
  double from = 0, to = 0;
};

/// The intervals of (0, infinity) in which p is negative, in ascending order.
/// The Bernstein coefficients of p on (0, infinity), x = scale t / (1 - t), are its coefficients over
/// binomials; their changes of sign bound the number of roots (Descartes), and the interval is halved until
/// each part has one root or none [rouillier2004efficient]. Roots of even order, where p only touches zero,
/// do not count.
/// Root counting is certain but for coefficients that rounding may have made, which count as zero; the
/// ends of the intervals are bisected to the last bit of long double and rounded to double.
/// @param p      coefficients in ascending powers of x
/// @param scale  a typical x
std::vector<Interval> negative_intervals(std::span<const long double> p, long double scale = 1);

}  // namespace hmax
