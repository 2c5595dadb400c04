#include "analysis/amplification/amplification.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <type_traits>
#include <utility>

#include "core/numbers.hpp"

namespace hmax {

namespace {

/// Products without the search for infinities that the library's operator makes.
Complex times(Complex a, Complex b) {
  return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}

/// c_0 + x (c_1 + x (c_2 + ...)).
Complex horner(const std::vector<Complex>& c, Complex x) {
  Complex sum = 0;
  for (std::size_t i = c.size(); i-- > 0;) sum = times(sum, x) + c[i];
  return sum;
}

/// All roots of sum_j c_j x^j by the simultaneous iteration of Ehrlich and Aberth; infinite ones where
/// leading coefficients vanish.
/// With p, p' at the root x_i one step is
///   x_i <- x_i - p / (p' - p sum_{j != i} 1 / (x_i - x_j)),
/// cubic convergence to simple roots, linear to multiple ones. Each new root serves the next one at once.
/// At most 200 sweeps; ends when no root moves by more than 1e-18 of the bound.
std::vector<LongComplex> all_roots(std::vector<LongComplex> c) {
  std::vector<LongComplex> infinite;
  while (c.size() > 1 && c.back() == LongComplex(0)) {
    c.pop_back();
    infinite.emplace_back(std::numeric_limits<long double>::infinity());
  }
  std::size_t zeros = 0;
  while (c.size() > 1 && c.front() == LongComplex(0)) {
    c.erase(c.begin());
    ++zeros;
  }
  const std::size_t n = c.size() - 1;
  // max_j |c_j / c_n|^(1 / (n - j)); no root has more than twice this modulus.
  // Cauchy's bound is where the iteration starts, off every symmetry.
  long double bound = 0;
  for (std::size_t j = 0; j < n; ++j)
    bound = std::max(bound, std::pow(std::abs(c[j] / c[n]), 1.0L / static_cast<long double>(n - j)));
  std::vector<LongComplex> roots(n);
  for (std::size_t i = 0; i < n; ++i)
    roots[i] = std::polar(bound + 1e-30L, 0.7L + 6.283185307179586L * static_cast<long double>(i) /
                                                     static_cast<long double>(n));
  for (int iteration = 0; iteration < 200; ++iteration) {
    long double moved = 0;
    for (std::size_t i = 0; i < n; ++i) {
      // Horner's rule for p and p' together.
      LongComplex value = c[n], slope = 0, repulsion = 0;
      for (std::size_t j = n; j-- > 0;) {
        slope = slope * roots[i] + value;
        value = value * roots[i] + c[j];
      }
      if (value == LongComplex(0)) continue;
      for (std::size_t j = 0; j < n; ++j)
        if (j != i && roots[i] != roots[j]) repulsion += 1.0L / (roots[i] - roots[j]);
      const LongComplex step = value / (slope - value * repulsion);
      if (!std::isfinite(std::abs(step))) continue;
      roots[i] -= step;
      moved = std::max(moved, std::abs(step));
    }
    if (moved <= 1e-18L * bound) break;
  }
  roots.resize(n + zeros);
  roots.insert(roots.end(), infinite.begin(), infinite.end());
  return roots;
}

/// The largest modulus; 0 without roots.
double largest(const std::vector<LongComplex>& roots) {
  long double size = 0;
  for (const LongComplex root : roots) size = std::max(size, std::abs(root));
  return static_cast<double>(size);
}

/// Exactly: the polynomials are made of coefficients that vanish by their formula, not by rounding.
bool is_zero(const ComplexPolynomial& p) {
  return std::ranges::all_of(p, [](LongComplex c) { return c == LongComplex(0); });
}

/// For real h the real and imaginary parts of p(h) are the polynomials of those of its coefficients.
Polynomial real_part(const ComplexPolynomial& p) {
  Polynomial real(p.size());
  std::ranges::transform(p, real.begin(), [](LongComplex c) { return c.real(); });
  return real;
}
Polynomial imaginary_part(const ComplexPolynomial& p) {
  Polynomial imaginary(p.size());
  std::ranges::transform(p, imaginary.begin(), [](LongComplex c) { return c.imag(); });
  return imaginary;
}

/// sum of sign p q
Polynomial sum_of(
    std::initializer_list<std::pair<long double, std::pair<const Polynomial*, const Polynomial*>>> terms) {
  CancellingSum sum;
  for (const auto& [sign, factors] : terms) sum.add(sign, *factors.first, *factors.second);
  return sum.value();
}

/// |p|^2 as a polynomial in real h, into `sum`.
void add_square(CancellingSum& sum, long double sign, const ComplexPolynomial& p) {
  const Polynomial re = real_part(p), im = imaginary_part(p);
  sum.add(sign, re, re);
  sum.add(sign, im, im);
}

}  // namespace

// Keeps the coefficients in long double for limits and in double for pictures.
StepPolynomial::StepPolynomial(std::vector<ComplexPolynomial> p) : p_(std::move(p)) {
  // Roots that are always zero say nothing.
  while (p_.size() > 2 && is_zero(p_.front())) p_.erase(p_.begin());
  real_ = std::ranges::all_of(p_, [](const ComplexPolynomial& q) {
    return std::ranges::all_of(q, [](LongComplex c) { return c.imag() == 0; });
  });
  fast_.resize(p_.size());
  for (std::size_t j = 0; j < p_.size(); ++j)
    for (const LongComplex c : p_[j])
      fast_[j].emplace_back(static_cast<double>(c.real()), static_cast<double>(c.imag()));
}

StepPolynomial StepPolynomial::real(const std::vector<Polynomial>& p) {
  std::vector<ComplexPolynomial> complex;
  complex.reserve(p.size());
  for (const Polynomial& q : p) complex.emplace_back(q.begin(), q.end());
  return StepPolynomial(std::move(complex));
}

// p_.size() is the degree in zeta plus one.
double StepPolynomial::spectral_radius(Complex h) const {
  switch (p_.size()) {
    // |zeta| = |p_0| / |p_1|
    case 2: {
      const Complex leading = horner(fast_[1], h), value = horner(fast_[0], h);
      return std::sqrt(std::norm(value) / std::norm(leading));
    }
    case 3: {
      // zeta = -b +- sqrt(b^2 - c), the larger one without cancellation.
      const Complex leading = horner(fast_[2], h);
      const Complex b = horner(fast_[1], h) / (2.0 * leading), c = horner(fast_[0], h) / leading;
      Complex root = std::sqrt(times(b, b) - c);
      if ((std::conj(b) * root).real() < 0) root = -root;
      const double larger = std::abs(b + root);
      // zeta_1 zeta_2 = c gives the smaller root without subtraction.
      return std::max(larger, larger > 0 ? std::abs(c) / larger : 0.0);
    }
    default: {
      std::vector<LongComplex> c;
      c.reserve(p_.size());
      for (const ComplexPolynomial& q : p_) c.push_back(evaluate(q, LongComplex(h)));
      return largest(all_roots(std::move(c)));
    }
  }
}

std::vector<Complex> StepPolynomial::roots(Complex h) const {
  std::vector<LongComplex> c;
  for (const ComplexPolynomial& q : p_) c.push_back(evaluate(q, LongComplex(h)));
  std::vector<Complex> roots;
  for (const LongComplex root : all_roots(std::move(c))) roots.emplace_back(root);
  return roots;
}

// pi(zeta, h) / h^m tends to the polynomial of the coefficients of h^m, and its roots to the roots of that
// one.
double StepPolynomial::radius_at_infinity() const {
  // The highest power of h rules.
  std::size_t power = 0;
  for (const ComplexPolynomial& q : p_)
    for (std::size_t i = 0; i < q.size(); ++i)
      if (q[i] != LongComplex(0)) power = std::max(power, i);
  std::vector<LongComplex> c;
  for (const ComplexPolynomial& q : p_) c.push_back(power < q.size() ? q[power] : LongComplex(0));
  return largest(all_roots(std::move(c)));
}

// One stage costs n complex multiplications twice, the whole test about n^2; no root is computed.
bool roots_are_at_most_one(Complex* c, std::size_t degree) {
  // A circle a hair wider, so that roots on the unit circle are inside.
  // Roots of sum_j c_j (r zeta)^j are those of the given polynomial divided by r = 1 + 1e-9.
  constexpr double wider = 1 + 1e-9;
  double power = 1;
  for (std::size_t j = 0; j <= degree; ++j) {
    c[j] *= power;
    power *= wider;
  }
  for (std::size_t n = degree; n > 0; --n) {
    // |c_0 / c_n| is the product of the moduli of all roots; NaN counts as unstable.
    if (!(std::norm(c[0]) < std::norm(c[n]))) return false;
    const Complex first = c[0], last = std::conj(c[n]);
    const double size = 1 / std::norm(c[n]);
    std::array<Complex, 17> reduced;
    for (std::size_t j = 0; j < n; ++j)
      // Schur's transform, divided by zeta and by |c_n|^2, which keeps the numbers of one size.
      reduced[j] = size * (times(last, c[j + 1]) - times(first, std::conj(c[n - 1 - j])));
    std::copy_n(reduced.begin(), n, c);
  }
  return true;
}

bool StepPolynomial::is_at_most_one(Complex h) const {
  if (fast_.size() == 2) return std::norm(horner(fast_[0], h)) <= std::norm(horner(fast_[1], h)) * (1 + 2e-9);
  std::array<Complex, 17> c;
  for (std::size_t j = 0; j < fast_.size(); ++j) c[j] = horner(fast_[j], h);
  return roots_are_at_most_one(c.data(), fast_.size() - 1);
}

StepPolynomial StepPolynomial::along(Complex lambda) const {
  std::vector<ComplexPolynomial> p = p_;
  for (ComplexPolynomial& q : p) {
    LongComplex power = 1;
    for (LongComplex& c : q) {
      c *= power;
      power *= LongComplex(lambda);
    }
  }
  return StepPolynomial(std::move(p));
}

// Power series of the principal root by undetermined coefficients: pi(zeta(h), h) = 0 power by power of h,
// then the first power of h at which |zeta|^2 differs from one.
bool StepPolynomial::grows_at_origin(LongComplex lambda) const {
  // zeta = sum_m s_m h^m: with s_m = 0 the coefficient of h^m in pi says what s_m has to be.
  constexpr std::size_t terms = 22;
  LongComplex slope = 0;
  // d pi / d zeta at zeta = 1, h = 0: not zero where 1 is a simple root there, as of every zero-stable
  // consistent method.
  for (std::size_t j = 1; j < p_.size(); ++j) slope += static_cast<long double>(j) * p_[j].at(0);
  ComplexPolynomial s{1};
  LongComplex exponential = 1;  // lambda^m / m!
  const auto truncated = [](ComplexPolynomial p, std::size_t size) {
    p.resize(std::min(p.size(), size));
    return p;
  };
  for (std::size_t m = 1; m < terms; ++m) {
    s.emplace_back(0);
    ComplexPolynomial power{1}, sum;
    for (const ComplexPolynomial& q : p_) {
      add(sum, LongComplex(1), truncated(product(power, q), m + 1));
      // sum_j p_j(h) s(h)^j, modulo h^(m+1).
      power = truncated(product(power, s), m + 1);
    }
    sum.resize(m + 1);
    // A change of s_m by d changes the coefficient of h^m in pi by d pi / d zeta d.
    s[m] = -sum[m] / slope;
    exponential *= lambda / static_cast<long double>(m);
    // Up to the order the series is the exponential, but for rounding, which high orders magnify.
    if (std::abs(s[m] - exponential) <= 1e-4L * std::abs(exponential)) s[m] = exponential;
    // |zeta|^2 - 1
    long double c = 0, size = 0;
    for (std::size_t i = 0; i <= m; ++i) {
      c += (s[i] * std::conj(s[m - i])).real();
      size += std::abs(s[i] * s[m - i]);
    }
    if (std::abs(c) > 1e-10L * size) return c > 0;
  }
  return false;
}

// Products of coefficients cancel for methods that keep |zeta| = 1 on an axis: CancellingSum makes exact
// zeros of what is left, so that "stable for every h" is not lost to rounding.
std::optional<std::vector<Polynomial>> StepPolynomial::conditions(double growth) const {
  const std::size_t roots = p_.size() - 1;
  if (roots > 3 || (roots > 1 && !real_)) return std::nullopt;
  const long double scale = 1 + static_cast<long double>(growth);
  if (roots == 1) {
    // |p_1|^2 (1 + growth)^2 - |p_0|^2
    CancellingSum sum;
    add_square(sum, scale * scale, p_[1]);
    add_square(sum, -1, p_[0]);
    return std::vector<Polynomial>{sum.value()};
  }
  const Polynomial one{1};
  // Two or three roots of a real polynomial: with (1 + growth)^j p_j the circle of radius 1 + growth is
  // mapped to the unit circle.
  std::vector<Polynomial> p;
  long double power = 1;
  for (const ComplexPolynomial& q : p_) {
    p.push_back(real_part(q));
    for (long double& c : p.back()) c *= power;
    power *= scale;
  }
  const auto linear = [&](std::initializer_list<long double> signs) {
    CancellingSum sum;
    std::size_t j = 0;
    for (const long double sign : signs) sum.add(sign, p[j++], one);
    return sum.value();
  };
  // The conditions of Schur and Cohn for real polynomials, due to Jury: pi(1) and pi(-1) have the sign they
  // have far out, and the product of the roots is at most one; the leading coefficient is positive.
  // [jury1964theory] Of degree 2: pi(1), pi(-1), p_2 - p_0.
  if (roots == 2)
    return std::vector<Polynomial>{linear({1, 1, 1}), linear({1, -1, 1}), linear({-1, 0, 1}), p[2]};
  // Of degree 3: pi(1), -pi(-1), p_3 -+ p_0, and p_3^2 - p_0^2 - (p_3 p_1 - p_2 p_0), without which a pair
  // of complex roots could be outside.
  using Pair = std::pair<const Polynomial*, const Polynomial*>;
  return std::vector<Polynomial>{linear({1, 1, 1, 1}),
                                 linear({-1, 1, -1, 1}),
                                 linear({-1, 0, 0, 1}),
                                 linear({1, 0, 0, 1}),
                                 sum_of({{1, Pair{&p[3], &p[3]}},
                                         {-1, Pair{&p[3], &p[1]}},
                                         {1, Pair{&p[2], &p[0]}},
                                         {-1, Pair{&p[0], &p[0]}}}),
                                 p[3]};
}

namespace {

/// The intervals of all conditions together.
/// Union of open intervals: one that begins where another ends, to 1e-14, continues it. A step that
/// touches the border between two of them would otherwise be reported as stable.
std::vector<Interval> merged(std::vector<Interval> all) {
  std::ranges::sort(all, {}, &Interval::from);
  std::vector<Interval> merged;
  for (const Interval& next : all) {
    if (!merged.empty() && next.from <= merged.back().to * (1 + 1e-14))
      merged.back().to = std::max(merged.back().to, next.to);
    else
      merged.push_back(next);
  }
  return merged;
}

/// What rounding of the coefficients does to the spectral radius.
constexpr double rounding = 1e-12;

/// A complex number whose product is four multiplications.
template <class Real>
/// std::complex looks for infinities and NaN in its products.
struct Plain {
  Real re = 0, im = 0;
  [[nodiscard]] Real norm() const { return re * re + im * im; }
};

/// Whether all roots of a step polynomial lie in |zeta| < 1 + bound, by the reduction of Schur and Cohn: in
/// double where that is clear, else in long double.
class RootTest {
 public:
  static constexpr std::size_t most_roots = 16;

  /// Coefficients (1 + bound)^j p_j, so that the test circle is the unit circle.
  /// @param bound  how far beyond one a root may be
  RootTest(const StepPolynomial& polynomial, double bound) {
    long double power = 1;
    for (const ComplexPolynomial& p : polynomial.coefficients()) {
      Coefficient& of = coefficients_.emplace_back();
      for (const LongComplex c : p) {
        of.exact.push_back({power * c.real(), power * c.imag()});
        of.fast.push_back({static_cast<double>(power * c.real()), static_cast<double>(power * c.imag())});
      }
      power *= 1 + static_cast<long double>(bound);
    }
  }

  /// Positive where all roots are inside, and continuous where the last of them leaves:
  ///   1 - |a_0|^2 / |a_n|^2    of the first reduced polynomial where that is negative, else of the last.
  /// Of one root it is 1 - |zeta|^2 / (1 + bound)^2. Where double leaves the sign open, by less than 1e-7,
  /// long double decides.
  /// @return  -1 where the polynomial is not finite
  [[nodiscard]] double margin(double h) const {
    constexpr double unclear = 1e-7;
    if (const auto clear = reduced<double>(h, unclear)) return *clear;
    return static_cast<double>(*reduced<long double>(h, 0));
  }

 private:
  /// A coefficient of zeta^j as a polynomial in h, in both precisions.
  struct Coefficient {
    std::vector<Plain<long double>> exact;
    std::vector<Plain<double>> fast;
  };

  template <class Real>
  /// The coefficient at h, by Horner's rule for real h.
  static Plain<Real> value_of(const Coefficient& coefficient, Real h) {
    const auto& c = [&]() -> const auto& {
      if constexpr (std::is_same_v<Real, double>)
        return coefficient.fast;
      else
        return coefficient.exact;
    }
    ();
    Plain<Real> sum;
    for (std::size_t i = c.size(); i-- > 0;) sum = {sum.re * h + c[i].re, sum.im * h + c[i].im};
    return sum;
  }

  /// Nothing when a margin on the way is not clear.
  template <class Real>
  std::optional<Real> reduced(double h, Real unclear) const {
    std::array<Plain<Real>, most_roots + 1> a, next;
    std::size_t n = coefficients_.size() - 1;
    for (std::size_t j = 0; j <= n; ++j) a[j] = value_of<Real>(coefficients_[j], static_cast<Real>(h));
    for (;; --n) {
      // The roots stay inside only while |a_0| < |a_n| in every stage.
      const Real size = a[n].norm(), margin = 1 - a[0].norm() / size;
      if (unclear > 0 && !(std::abs(margin) >= unclear)) return std::nullopt;
      if (std::isnan(margin)) return Real(-1);
      if (n == 1 || !(margin > 0)) return margin;
      // (conj(a_n) a_j+1 - a_0 conj(a_n-1-j)) / |a_n|^2
      const Plain<Real> first = a[0], last{a[n].re / size, -a[n].im / size},
                        scaled{first.re / size, first.im / size};
      for (std::size_t j = 0; j < n; ++j) {
        const Plain<Real> up = a[j + 1], down = a[n - 1 - j];
        next[j] = {last.re * up.re - last.im * up.im - scaled.re * down.re - scaled.im * down.im,
                   last.re * up.im + last.im * up.re - scaled.im * down.re + scaled.re * down.im};
      }
      std::swap(a, next);
    }
  }

  std::vector<Coefficient> coefficients_;
};

/// Between a stable and an unstable step the last stable one, by secants that close in from both sides, and
/// halves where those do not.
/// @param margin  of a step: positive where it is stable
template <class Margin>
double change_between(double stable, double at_stable, double unstable, double at_unstable,
                      const Margin& margin) {
  // Ends at a relative width of 1e-13, or after 200 looks.
  constexpr double close = 1e-13;
  double before = std::abs(unstable - stable);
  for (int iteration = 0; iteration < 200; ++iteration) {
    const double width = std::abs(unstable - stable), size = std::max(stable, unstable);
    if (width <= close * size) break;
    double middle = stable + (unstable - stable) / 2;
    if (iteration % 3 != 2 || width < before / 8) {
      // Regula falsi; every third look halves instead, unless the last three have narrowed the interval
      // eightfold. The secant keeps off both ends by half the tolerance, so that the other end moves too.
      const double secant = stable + (unstable - stable) * at_stable / (at_stable - at_unstable);
      const double least = close * size / 2;
      const double low = std::min(stable, unstable) + least, high = std::max(stable, unstable) - least;
      if (std::isfinite(secant) && low < high) middle = std::clamp(secant, low, high);
    }
    if (iteration % 3 == 2) before = width;
    const double value = margin(middle);
    if (value > 0) {
      stable = middle;
      at_stable = value;
    } else {
      unstable = middle;
      at_unstable = value;
    }
  }
  return stable;
}

/// The step near h at which a root lies on the unit circle, by Newton's method for pi(exp(i theta); h) = 0 in
/// theta and h: where the largest root leaves slowly, h is known to the square root of rounding alone, and
/// less. h itself where the iteration ends elsewhere.
/// The real increments solve the complex equation
///   pi_theta d_theta + pi_h d_h = -pi,   pi_theta = i zeta d pi / d zeta,
/// by Cramer's rule. A change of more than 1e-5 of h is not trusted.
double sharpened(const StepPolynomial& polynomial, double h) {
  const std::vector<Complex> roots = polynomial.roots(h);
  const Complex largest = *std::ranges::max_element(roots, {}, [](Complex root) { return std::abs(root); });
  long double theta = std::arg(largest), step = h;
  for (int k = 0; k < 20; ++k) {
    const LongComplex zeta = std::polar(1.0L, theta);
    LongComplex value = 0, by_zeta = 0, by_step = 0;
    for (std::size_t j = polynomial.coefficients().size(); j-- > 0;) {
      const ComplexPolynomial& p = polynomial.coefficients()[j];
      LongComplex at = 0, slope = 0;
      for (std::size_t i = p.size(); i-- > 0;) {
        // p_j(h) and p_j'(h).
        slope = slope * step + at;
        at = at * step + p[i];
      }
      by_zeta = by_zeta * zeta + value;
      value = value * zeta + at;
      by_step = by_step * zeta + slope;
    }
    // d/d theta of exp(i theta) is i exp(i theta).
    const LongComplex by_theta = LongComplex(0, 1) * zeta * by_zeta;
    // Im(conj(a) b) is the determinant of the real and imaginary parts of a and b.
    const long double determinant = (std::conj(by_theta) * by_step).imag();
    const long double turn = (std::conj(by_step) * value).imag() / determinant,
                      change = -(std::conj(by_theta) * value).imag() / determinant;
    theta += turn;
    step += change;
    constexpr long double far = 1e-5L, there = 1e-15L;
    if (!(std::abs(step - h) <= far * h) || !std::isfinite(theta)) return h;
    if (std::abs(change) <= there * h) return static_cast<double>(step);
  }
  return h;
}

/// Strides outwards from the origin, closer where stability changes.
/// In units x = h / scale: from 1e-4 by 15 % each, up to 5e-3 as far as x = 100, wider beyond. An unstable
/// stretch narrower than a stride may be missed, which is why conditions come first.
/// @param once  stop at the first exit
UnstableSteps sampled(const Growth& growth, double tolerated, bool once) {
  // Without a tolerance the radius may exceed one by its own rounding, 1e-12.
  const double bound = tolerated > 0 ? tolerated : rounding;
  std::optional<RootTest> test;
  if (growth.polynomial) test.emplace(*growth.polynomial, bound);
  const auto margin = [&](double h) { return test ? test->margin(h) : 1 + bound - growth.radius(h); };
  UnstableSteps unstable;
  bool was_stable = true, below_rounding = false;
  if (tolerated == 0 && growth.grows_at_origin) {
    // The exit is the origin itself.
    if (once) return {{{0, infinity}}};
    unstable.intervals.push_back({0, infinity});
    was_stable = false;
    below_rounding = true;
  }
  double before = 0, margin_before = bound;
  // Limits of high orders are small; behind the first hundred only large structures are left.
  for (double x = growth.nearest; x <= growth.farthest;
       x += std::min(std::max(5e-3, 2e-2 * (x - 100)), 0.15 * x)) {
    const double h = x * growth.scale, here = margin(h);
    const bool stable = here > 0;
    // Close to the origin the growth of a mode that leaves at once is less than rounding shows.
    if (below_rounding && !stable) below_rounding = false;
    if (!below_rounding && stable != was_stable) {
      double change = stable ? change_between(h, here, before, margin_before, margin)
                             : change_between(before, margin_before, h, here, margin);
      if (test && tolerated == 0) change = sharpened(*growth.polynomial, change);
      if (stable)
        unstable.intervals.back().to = change;
      else
        unstable.intervals.push_back({change, infinity});
      if (once) return unstable;
    }
    if (!below_rounding) was_stable = stable;
    before = h;
    margin_before = here;
  }
  return unstable;
}

}  // namespace

/// The stable set is where every condition holds, so the unstable one is the union of where one of them is
/// negative.
UnstableSteps unstable_steps(const Growth& growth, double tolerated) {
  if (growth.polynomial) {
    if (const auto conditions = growth.polynomial->conditions(tolerated)) {
      std::vector<Interval> all;
      for (const Polynomial& condition : *conditions) {
        // `scale` is where the roots are expected: the interval (0, infinity) is mapped to (0, 1) with it.
        const std::vector<Interval> here = negative_intervals(condition, growth.scale);
        all.insert(all.end(), here.begin(), here.end());
      }
      return {merged(std::move(all))};
    }
  }
  return sampled(growth, tolerated, false);
}

// The first exit is the smallest beginning of an interval in which a condition is negative.
double first_exit(const Growth& growth, double tolerated) {
  if (growth.polynomial)
    if (const auto conditions = growth.polynomial->conditions(tolerated)) {
      double exit = infinity;
      for (const Polynomial& condition : *conditions)
        if (const auto negative = negative_intervals(condition, growth.scale); !negative.empty())
          exit = std::min(exit, negative.front().from);
      return exit;
    }
  return sampled(growth, tolerated, true).first_exit();
}

}  // namespace hmax
