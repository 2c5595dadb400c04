#include "analysis/amplification/principal_root.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace hmax {

namespace {

/// One root, or two that belong together, and the coefficients of the polynomial that they alone have.
struct Branch {
  std::array<Complex, 2> roots{};
  Complex sum, product;

  static Branch of(Complex root) { return {{root, root}, root, 0}; }
  static Branch of(Complex a, Complex b) { return {{a, b}, a + b, a * b}; }
};

bool is_real(const Branch& pair) {
  constexpr double rounding = 1e-7;  // of double roots
  const double size = std::abs(pair.roots[0]) + std::abs(pair.roots[1]);
  return std::abs(pair.sum.imag()) <= rounding * size &&
         std::abs(pair.product.imag()) <= rounding * size * size;
}

double distance(const Branch& a, const Branch& b) {
  const double far = std::abs(a.sum - b.sum) + std::abs(a.product - b.product);
  return std::isnan(far) ? std::numeric_limits<double>::infinity() : far;
}

/// @return  at least one
std::vector<Branch> branches_of(const std::vector<Complex>& roots, bool pairs) {
  std::vector<Branch> branches;
  for (std::size_t i = 0; i < roots.size(); ++i) {
    if (!pairs) branches.push_back(Branch::of(roots[i]));
    // Of a real polynomial two real roots, or one and its conjugate: never a complex one without it.
    for (std::size_t j = i + 1; pairs && j < roots.size(); ++j)
      if (const Branch pair = Branch::of(roots[i], roots[j]); is_real(pair)) branches.push_back(pair);
  }
  if (branches.empty()) branches.push_back(Branch::of(roots[0], roots[1]));  // roots that are not finite
  return branches;
}

/// The branch that is nearest to a prediction.
struct Nearest {
  Branch branch;
  bool clear = false;  ///< no other is near
};

Nearest nearest(const std::vector<Branch>& branches, const Branch& predicted) {
  Nearest found{branches.front()};
  double best = std::numeric_limits<double>::infinity(), next = best;
  for (const Branch& branch : branches) {
    const double here = distance(branch, predicted);
    if (here < best) {
      next = best;
      best = here;
      found.branch = branch;
    } else {
      next = std::min(next, here);
    }
  }
  found.clear = 4 * best < next;
  return found;
}

/// sum + share (sum - sum before), and the same of the product.
Branch extrapolated(const Branch& before, const Branch& now, double share) {
  Branch ahead;
  ahead.sum = now.sum + share * (now.sum - before.sum);
  ahead.product = now.product + share * (now.product - before.product);
  return ahead;
}

/// Whether a mode and its conjugate have one polynomial.
bool is_real(const StepPolynomial& polynomial) {
  for (const ComplexPolynomial& p : polynomial.coefficients())
    for (const LongComplex c : p)
      if (c.imag() != 0) return false;
  return true;
}

/// Rounding of roots that are real.
Complex without_rounding(Complex root) {
  constexpr double rounding = 1e-14;
  return std::abs(root.imag()) <= rounding * std::abs(root) ? Complex(root.real(), 0) : root;
}

/// Of a pair the root with an imaginary part of at least zero; of two real ones the larger, which rules.
Complex shown_of(const Branch& branch) {
  const Complex a = without_rounding(branch.roots[0]), b = without_rounding(branch.roots[1]);
  if (a.imag() == 0 && b.imag() == 0) return std::abs(a) < std::abs(b) ? b : a;
  return a.imag() > b.imag() ? a : b;
}

}  // namespace

PrincipalRoot principal_root(const StepPolynomial& polynomial, Complex lambda, double h) {
  const bool real = is_real(polynomial);
  bool pairs = real && polynomial.coefficients().size() > 2;
  const auto exact = [&](double step) {
    const Complex root = std::exp(step * lambda);
    return pairs ? Branch::of(root, std::conj(root)) : Branch::of(root);
  };
  const auto branches_at = [&](double step) { return branches_of(polynomial.roots(step), pairs); };
  // Close to the origin the principal root is exp(h lambda) to the order of the method, and no other is.
  const double scale = 1 / std::abs(lambda), first = std::min(h, 1e-3 * scale);
  Branch before = exact(0), now = nearest(branches_at(first), exact(first)).branch;
  double at_before = 0, at = first, stride = first;
  PrincipalRoot found{shown_of(now), std::abs(std::arg(shown_of(now)))};
  while (at < h) {
    const double next = at + stride >= h ? h : at + stride;
    const Branch predicted = extrapolated(before, now, (next - at) / (at - at_before));
    const Nearest here = nearest(branches_at(next), predicted);
    // Where two branches meet in earnest no stride tells them apart: the prediction decides.
    constexpr double least = 1e-7;
    if (!here.clear && next - at > least * at) {
      stride = (next - at) / 4;
      continue;
    }
    before = std::exchange(now, here.branch);
    at_before = std::exchange(at, next);
    stride = std::min(1.5 * stride, 0.05 * std::max(at, scale));
    Complex zeta = shown_of(now);
    if (real && zeta.imag() < 0) zeta = std::conj(zeta);
    if (pairs && zeta.imag() == 0) {
      // The pair has parted along the real axis: the larger one goes on alone.
      pairs = false;
      before = now = Branch::of(zeta);
    }
    // With its conjugate a root has both signs of its angle; a single one goes round.
    found.turn = real ? std::abs(std::arg(zeta)) : found.turn + std::arg(zeta / found.zeta);
    found.zeta = zeta;
  }
  return found;
}

}  // namespace hmax
