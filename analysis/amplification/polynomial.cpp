#include "analysis/amplification/polynomial.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/numbers.hpp"

namespace hmax {

// sum_ and magnitude_ stay of one length: both grow with the product.
void CancellingSum::add(long double sign, const Polynomial& p, const Polynomial& q) {
  hmax::add(sum_, sign, product(p, q));
  const auto sizes = [](Polynomial c) {
    for (long double& x : c) x = std::abs(x);
    return c;
  };
  hmax::add(magnitude_, 1.0L, product(sizes(p), sizes(q)));
}

// A coefficient of at most `rounding` of the sum of its moduli becomes an exact zero.
Polynomial CancellingSum::value(long double rounding) const {
  Polynomial kept = sum_;
  for (std::size_t i = 0; i < kept.size(); ++i)
    if (std::abs(kept[i]) <= rounding * magnitude_[i]) kept[i] = 0;
  return kept;
}

namespace {

/// Splits an interval off its middle, so that a root at a round number is not hit.
constexpr long double split_at = 0.49918273645L;

/// Descartes' rule in Bernstein form: the number of roots in the interval is this number, or less by an
/// even one.
/// @param error  what rounding may have made of each coefficient: what is not larger counts as zero
int changes_of_sign(const Polynomial& b, const Polynomial& error) {
  int changes = 0;
  long double last = 0;
  for (std::size_t i = 0; i < b.size(); ++i) {
    const long double x = b[i];
    if (std::abs(x) <= error[i]) continue;
    if (last != 0 && (x < 0) != (last < 0)) ++changes;
    last = x;
  }
  return changes;
}

/// The halves of de Casteljau: the left one takes the first number of every row, the right one the last.
std::pair<Polynomial, Polynomial> halves(Polynomial b) {
  const std::size_t n = b.size();
  Polynomial left(n), right(n);
  for (std::size_t row = 0; row < n; ++row) {
    left[row] = b[0];
    right[n - 1 - row] = b[n - 1 - row];
    // (1 - split_at) b_i + split_at b_i+1
    for (std::size_t i = 0; i + 1 < n - row; ++i) b[i] += split_at * (b[i + 1] - b[i]);
  }
  return {std::move(left), std::move(right)};
}

/// The roots in (t0, t1) where the polynomial of Bernstein coefficients b changes its sign, in order.
/// @param error  of b; its own halves bound that of the halves of b, so that where the polynomial only
/// touches
///               zero nothing but rounding is left
/// @param value  the polynomial at t
template <class Value>
void add_roots(const Polynomial& b, const Polynomial& error, long double t0, long double t1,
               const Value& value, std::vector<long double>& roots) {
  const int changes = changes_of_sign(b, error);
  if (changes == 0) return;
  constexpr long double finest = 1e-17L;
  if (changes == 1) {
    // One change of sign: exactly one root, so bisection on the polynomial itself.
    const bool negative_left = value(t0) < 0 || (value(t0) == 0 && value(t1) > 0);
    while (t1 - t0 > std::numeric_limits<long double>::epsilon() * t1) {
      const long double middle = t0 + (t1 - t0) / 2;
      if (middle <= t0 || middle >= t1) break;
      ((value(middle) < 0) == negative_left ? t0 : t1) = middle;
    }
    roots.push_back(t0 + (t1 - t0) / 2);
    return;
  }
  // Several roots nearer than 1e-17 count as one where the sign differs, as none where it does not.
  if (t1 - t0 <= finest * std::max(t1, 1e-6L)) {
    if ((value(t0) < 0) != (value(t1) < 0)) roots.push_back(t0);
    return;
  }
  const auto [left, right] = halves(b);
  const auto [left_error, right_error] = halves(error);
  const long double middle = t0 + split_at * (t1 - t0);
  add_roots(left, left_error, t0, middle, value, roots);
  add_roots(right, right_error, middle, t1, value, roots);
}

}  // namespace

// Bernstein form on (0, 1), subdivision until each part has at most one change of sign, bisection there;
// then the sign alternates from root to root, beginning with that of the lowest coefficient.
std::vector<Interval> negative_intervals(std::span<const long double> p, long double scale) {
  // Roots at zero and at infinity are none of ours.
  while (!p.empty() && p.front() == 0) p = p.subspan(1);
  while (!p.empty() && p.back() == 0) p = p.first(p.size() - 1);
  if (p.empty()) return {};

  const std::size_t degree = p.size() - 1;
  Polynomial scaled(p.begin(), p.end()), b(p.size());
  // p(x) (1 - t)^n = sum_j b_j (n over j) t^j (1 - t)^(n-j) with
  //   x = scale t / (1 - t),   b_j = scale^j p_j / (n over j).
  long double power = 1, binomial = 1;
  for (std::size_t j = 0; j <= degree; ++j) {
    scaled[j] *= power;
    b[j] = scaled[j] / binomial;
    power *= scale;
    binomial = binomial * static_cast<long double>(degree - j) / static_cast<long double>(j + 1);
  }
  // (1 - t)^degree p or t^degree p: the sign of p, and finite up to t = 1.
  const auto at = [degree](const Polynomial& c, long double t) {
    long double sum = 0;
    if (t < 0.5L) {
      const long double x = t / (1 - t);
      for (std::size_t j = degree + 1; j-- > 0;) sum = sum * x + c[j];
    } else {
      const long double inverse = (1 - t) / t;
      for (std::size_t j = 0; j <= degree; ++j) sum = sum * inverse + c[j];
    }
    return sum;
  };
  const auto value = [&](long double t) { return at(scaled, t); };
  Polynomial error(b);
  for (long double& e : error) e = 16 * std::numeric_limits<long double>::epsilon() * std::abs(e);
  std::vector<long double> roots;
  add_roots(b, error, 0, 1, value, roots);

  std::vector<Interval> negative;
  bool below = p.front() < 0;
  double since = 0;
  for (const long double t : roots) {
    const auto x = static_cast<double>(scale * t / (1 - t));
    if (below) negative.push_back({since, x});
    below = !below;
    since = x;
  }
  if (below) negative.push_back({since, infinity});
  return negative;
}

}  // namespace hmax
