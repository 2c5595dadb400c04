/// What one step of a method does to one mode of a linear model: the amplification of every family, and the
/// steps at which it is at most one.
/// Dahlquist's test equation y' = lambda y with z = h lambda [hairer1996solving, IV.2] for methods of
/// first-order systems; q'' + gamma q' + kappa q = 0 for those that step positions and velocities. A step
/// is stable when the spectral radius of its map is at most one.
#pragma once

#include <algorithm>
#include <complex>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "analysis/amplification/polynomial.hpp"
#include "analysis/spectrum/modes.hpp"

namespace hmax {

using Complex = std::complex<double>;

/// A mode y' = lambda y of a first-order model, and how a method is told of it.
struct Eigenmode {
  Complex lambda;  ///< [1/s]
  Complex stiff;   ///< its part in what an implicit-explicit method treats implicitly
  Complex frozen;  ///< what the Jacobian that a linearly implicit method uses says in its place
  double radius;   ///< the spectral radius by which a stabilised method chooses its stages

  /// The whole of lambda is stiff, the Jacobian exact, the mode the fastest of the model.
  /// @param value  lambda [1/s]
  explicit Eigenmode(Complex value) : lambda(value), stiff(value), frozen(value), radius(std::abs(value)) {}
};

/// The characteristic polynomial of the one-step map of a mode,  pi(zeta, h) = sum_j zeta^j p_j(h): the step
/// h is stable when all of its roots zeta lie in |zeta| <= 1. One-step methods have one root, R(h lambda);
/// methods of k steps have k, those of structural dynamics two or three.
class StepPolynomial {
 public:
  /// A factor zeta that all coefficients share (p_0 = 0 everywhere) is divided out: its root is always
  /// zero.
  /// Coefficient i of p_j belongs to h^i zeta^j; its unit is s^-i.
  /// @param p  p[j] = p_j, ascending in zeta; the last is not zero everywhere
  explicit StepPolynomial(std::vector<ComplexPolynomial> p);

  /// Of the same numbers for real modes.
  static StepPolynomial real(const std::vector<Polynomial>& p);

  /// The largest |zeta| at h, which may be complex: with lambda = 1 it stands for z = h lambda.
  /// One root in closed form, two by the quadratic formula, more by the iteration of all roots.
  [[nodiscard]] double spectral_radius(Complex h) const;

  /// All roots zeta at h.
  /// @return  as many as the degree in zeta, in no order; infinite ones where leading coefficients vanish
  [[nodiscard]] std::vector<Complex> roots(Complex h) const;

  /// The largest |zeta| in the limit of large |h|: 0 for methods that annihilate infinitely fast modes.
  /// With h^m the highest power in pi, the roots of the polynomial of the coefficients of h^m; infinity
  /// for explicit methods, whose p_k is a constant.
  [[nodiscard]] double radius_at_infinity() const;

  /// Real polynomials in h, all of which are >= 0 where the spectral radius is at most 1 + growth, and only
  /// there as long as the leading coefficient is positive and, of three roots, the product is below one;
  /// nothing where there is no closed condition (more than one root, unless three at most and real)
  /// [jury1964theory].
  /// With p_j for (1 + growth)^j p_j they are
  ///   one root:    |p_1|^2 - |p_0|^2
  ///   two roots:   pi(1), pi(-1), p_2 - p_0
  ///   three roots: pi(1), -pi(-1), p_3 - p_0, p_3 + p_0, p_3^2 - p_3 p_1 + p_2 p_0 - p_0^2
  /// and, of two and three, the leading coefficient itself.
  [[nodiscard]] std::optional<std::vector<Polynomial>> conditions(double growth) const;

  /// Whether every |zeta| <= 1 but for rounding, in double: for pictures.
  /// At most 16 roots. The circle is wider by 1e-9, so that points on the border count as stable.
  [[nodiscard]] bool is_at_most_one(Complex h) const;

  /// Whether |zeta| > 1 at arbitrarily small h for the root that is 1 at h = 0: by its series, which is that
  /// of exp(lambda h) up to the order of the method.
  /// With zeta(h) = sum_m s_m h^m the first coefficient of |zeta|^2 - 1 that is not zero decides by its
  /// sign; false where the first 21 all vanish. For lambda on the imaginary axis, where the modulus of
  /// exp(lambda h) is one.
  /// @param lambda  of the mode
  [[nodiscard]] bool grows_at_origin(LongComplex lambda) const;

  /// From the polynomial for lambda = 1 to that for lambda: h^j takes the factor lambda^j.
  [[nodiscard]] StepPolynomial along(Complex lambda) const;

  /// p_0 ... p_k, each ascending in h.
  [[nodiscard]] const std::vector<ComplexPolynomial>& coefficients() const { return p_; }

 private:
  std::vector<ComplexPolynomial> p_;        ///< ascending in zeta
  std::vector<std::vector<Complex>> fast_;  ///< the same in double
  bool real_ = false;
};

/// The spectral radius of the one-step map of one mode as a function of the step.
/// Either `polynomial` or `radius` is set.
struct Growth {
  std::optional<StepPolynomial> polynomial;     ///< where the map is rational in h
  std::function<double(double h)> radius = {};  ///< otherwise
  double scale = 1;                             ///< a typical step [s], 1 / |lambda|
  // For what has no closed conditions:
  bool grows_at_origin = false;  ///< at arbitrarily small h
  double nearest = 1e-4;         ///< an exit is sought from h = nearest scale on
  double farthest = 1e6;         ///< up to h = farthest scale

  /// The radius at a step h > 0 [s].
  [[nodiscard]] double spectral_radius(double h) const {
    return polynomial ? polynomial->spectral_radius(h) : radius(h);
  }
};

/// Whether all roots of sum_j c_j zeta^j, j = 0 .. degree, lie in |zeta| <= 1 but for rounding, by the
/// reduction of Schur and Cohn in double.
/// The reduction c_j <- (conj(c_n) c_j+1 - c_0 conj(c_n-1-j)) / |c_n|^2 lowers the degree n by one and
/// keeps the number of roots outside of the circle, as long as |c_0| < |c_n| in each stage
/// @param c  shape (degree + 1), overwritten
/// [jury1964theory].
/// @param degree  at most 16
bool roots_are_at_most_one(Complex* c, std::size_t degree);

/// What is left of an infinitely fast mode counts as nothing below this: coefficients that are published to
/// sixteen digits leave some 1e-11.
inline constexpr double annihilated = 1e-9;

/// Which steps are unstable.
/// The intervals do not overlap; the last one may reach to infinity.
struct UnstableSteps {
  std::vector<Interval> intervals;  ///< [s], ascending, open

  /// The first exit from the origin: every step up to it is stable. 0 when arbitrarily small ones are not,
  /// infinity when there is none.
  [[nodiscard]] double first_exit() const {
    return intervals.empty() ? std::numeric_limits<double>::infinity() : intervals.front().from;
  }
};

/// Where the spectral radius exceeds 1 + growth. From the conditions where there are some, so that "stable
/// for every h" and "for none" are proved, not sampled; else by strides outwards and bisection.
/// @param tolerated  a growth per step that still counts as stable, such as 1e-6 for the weak limit on the
/// imaginary axis; 0: one, but for rounding
UnstableSteps unstable_steps(const Growth& growth, double tolerated = 0);

/// Only the first exit, which needs less.
/// @return  [s]; 0 when arbitrarily small steps are unstable, infinity when no step up to growth.farthest
/// growth.scale (none at all, where there are conditions) is
double first_exit(const Growth& growth, double tolerated = 0);

/// A method that steps positions and velocities, as polynomials in zeta: what it makes of
/// M q'' + C q' + K q = 0 are the motions zeta^n x with
///   (inertia M + h (damper C + lumped diag C) + h^2 spring K) x = 0.
/// Of one oscillation the polynomial in zeta is inertia + h gamma (damper + lumped) + h^2 kappa spring;
/// symplectic Euler for instance has inertia = (zeta - 1)^2, damper = zeta - 1 and spring = zeta.
struct MotionMap {
  Polynomial inertia, damper, spring;
  Polynomial lumped{};  ///< empty unless the diagonal of C is taken otherwise than the rest

  /// The highest power of zeta.
  /// @return  the number of roots zeta of one oscillation, those at zero included
  [[nodiscard]] std::size_t degree() const {
    return std::max({inertia.size(), damper.size(), spring.size(), lumped.size()}) - 1;
  }
};

/// How a method amplifies modes; each family makes its own from the numbers that it steps with.
/// `of_eigenmode` is never empty. An Amplification describes the linear part of a method only: adaptive
/// steps, tolerances of solvers and nonlinear forces are left out.
struct Amplification {
  /// The map of an eigenvalue of y' = f; every family has it. For methods that need positions and velocities
  /// it is the map of the oscillation with that pair of eigenvalues.
  std::function<Growth(const Eigenmode&)> of_eigenmode;
  /// The map of an oscillation; empty where the two eigenvalues say everything.
  std::function<Growth(const MechanicalMode&)> of_oscillation;
  /// The map for lambda = 1 as a function of complex h, which then is z; empty where it is none.
  std::optional<StepPolynomial> in_z;
  /// R(z) of one-step methods on y' = lambda y; empty where one number says too little.
  std::function<Complex(Complex z)> R;
  /// Whether z = h lambda is stable, for pictures; empty where the spectral radius is just as cheap.
  std::function<bool(Complex z)> stable_at;
  /// Of methods that step positions and velocities: for models whose modes cannot be taken one by one.
  std::optional<MotionMap> motion;
  bool measured = false;  ///< from steps of the code, for want of a formula

  /// The spectral radius at z = h lambda.
  [[nodiscard]] double spectral_radius(Complex z) const {
    return in_z ? in_z->spectral_radius(z) : of_eigenmode(Eigenmode(z)).spectral_radius(1);
  }
};

/// To be kept by whatever a method is described by.
/// Its functions change nothing that they hold. A Growth of a stabilised method does: its radius
/// caches the stages, so that only one thread may use it.
inline std::shared_ptr<const Amplification> shared(Amplification amplification) {
  return std::make_shared<const Amplification>(std::move(amplification));
}

}  // namespace hmax
