// uBLAS checks itself in debug builds, and Odeint does not pass: all builds shall behave alike.
#define BOOST_UBLAS_NDEBUG 1
#include "integrators/odeint/implicit_steppers.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <boost/numeric/odeint/stepper/implicit_euler.hpp>
#include <boost/numeric/odeint/stepper/rosenbrock4.hpp>
#include <boost/numeric/odeint/stepper/rosenbrock4_controller.hpp>

namespace hmax::odeint {

namespace native = boost::numeric::odeint;
namespace ublas = boost::numeric::ublas;

namespace {

/// What Odeint's implicit steppers compute in: dense and row by row, as ublas::matrix is by default.
template <class Real>
using Vector = ublas::vector<Real>;
template <class Real>
using Matrix = ublas::matrix<Real>;

/// The first number of a vector; vectors are contiguous.
template <class Real>
const Real* data(const Vector<Real>& v) {
  return &*v.begin();
}
template <class Real>
Real* data(Vector<Real>& v) {
  return &*v.begin();
}

/// f in the form of Odeint, which copies its functions: three pointers to functions and one to the system.
template <class Real>
struct Rhs {
  SystemCalls<Real> calls;
  void operator()(const Vector<Real>& y, Vector<Real>& dydt, Real t) const {
    calls.rhs(calls.system, t, data(y), data(dydt));
  }
};

/// df/dy and df/dt in the form that Odeint's Rosenbrock stepper calls. J has shape (n, n) by then.
/// @throws NotSolved  where df/dy is not finite, since Odeint would factor it all the same
template <class Real>
struct Jacobian {
  SystemCalls<Real> calls;
  void operator()(const Vector<Real>& y, Matrix<Real>& J, Real t, Vector<Real>& dfdt) const {
    calls.jacobian(calls.system, t, data(y), &*J.data().begin());
    for (const Real entry : J.data())
      if (!std::isfinite(entry)) throw NotSolved();
    calls.time_derivative(calls.system, t, data(y), data(dfdt));
  }
};

/// The coefficients of RODAS with d_4 < 0 as published; Boost 1.74 has it positive, and order 1 on every
/// system that depends on time.
template <class Real>
struct Coefficients : native::default_rosenbrock_coefficients<Real> {
  /// Hides d4 of the base: the stepper reads it from its type of coefficients.
  const Real d4 = static_cast<Real>(-0.0362);
};

/// RODAS with Odeint's step control; components are weighed by atol + rtol max(|y_i|, |y_new,i|). With the
/// root mean square err of the weighed estimate a step stands where err <= 1, and
///   h_next = h min(6, max(1/5, 0.9 err^(-1/4))),
/// after accepted steps at most what their two last errors foretell.
template <class Real>
using Controlled = native::rosenbrock4_controller<native::rosenbrock4<Real, Coefficients<Real>>>;

}  // namespace

/// What the header hides from C++20: the system and the work vectors in uBLAS, shape (n). `out` is for dense
/// output; the other two take copies of the caller's arrays, which uBLAS cannot refer to.
template <class Real>
struct Rosenbrock4<Real>::Memory {
  std::pair<Rhs<Real>, Jacobian<Real>> system;
  Vector<Real> y, y_new, out;
  Controlled<Real> controlled;
};

/// Odeint's controller takes the tolerances in the order atol, rtol.
template <class Real>
Rosenbrock4<Real>::Rosenbrock4(const SystemCalls<Real>& calls, std::size_t n, Real rtol, Real atol)
    : memory_(new Memory{{{calls}, {calls}},
                         Vector<Real>(n),
                         Vector<Real>(n),
                         Vector<Real>(n),
                         Controlled<Real>(atol, rtol)}) {}
template <class Real>
Rosenbrock4<Real>::~Rosenbrock4() = default;

/// Afterwards h is that of the next attempt, whatever the result. Odeint adds h to the copy of t here. An
/// attempt costs one Jacobian, one factorisation of I / (h / 4) - J, and six evaluations of f and six
/// substitutions, for six stages. y_new is written also where the attempt is rejected.
/// @throws NotSolved  where df/dy is not finite; y_new stays as it was
template <class Real>
bool Rosenbrock4<Real>::try_step(const Real* y, Real t, Real* y_new, Real& h) {
  Memory& m = *memory_;
  std::copy_n(y, m.y.size(), m.y.begin());
  const bool stands = m.controlled.try_step(m.system, m.y, t, m.y_new, h) == native::success;
  std::copy(m.y_new.begin(), m.y_new.end(), y_new);
  return stands;
}

/// The stepper inside the controller, without its error test; Odeint computes the estimate all the same.
/// @throws NotSolved  where df/dy is not finite; y_new stays as it was
template <class Real>
void Rosenbrock4<Real>::step(const Real* y, Real t, Real* y_new, Real h) {
  Memory& m = *memory_;
  std::copy_n(y, m.y.size(), m.y.begin());
  m.controlled.stepper().do_step(m.system, m.y, t, m.y_new, h);
  std::copy(m.y_new.begin(), m.y_new.end(), y_new);
}

/// Odeint computes the coefficients of dense output only when it is asked for them, from the stages of the
/// last attempt: so no step may lie between that and this call. With s = (t - t0) / (t1 - t0)
///   y(t) = (1 - s) y0 + s (y1 + (1 - s) (p + s q)),   cubic in s.
template <class Real>
void Rosenbrock4<Real>::inside(const Real* y0, Real t0, const Real* y1, Real t1, Real t, Real* out) {
  Memory& m = *memory_;
  std::copy_n(y0, m.y.size(), m.y.begin());
  std::copy_n(y1, m.y.size(), m.y_new.begin());
  m.controlled.stepper().prepare_dense_output();
  m.controlled.stepper().calc_state(t, m.out, m.y, t0, m.y_new, t1);
  std::copy(m.out.begin(), m.out.end(), out);
}

/// `rehearsed` is the copy on which a factorisation is tried, shape (n, n); y holds the start of a step, then
/// its end.
template <class Real>
struct ImplicitEuler<Real>::Memory {
  SystemCalls<Real> calls;
  Vector<Real> y;
  Matrix<Real> rehearsed;
  native::implicit_euler<Real> stepper;
};

/// The iteration ends where |d|_2 <= tolerance, an absolute one: Odeint has no relative one here.
template <class Real>
ImplicitEuler<Real>::ImplicitEuler(const SystemCalls<Real>& calls, std::size_t n)
    : memory_(new Memory{calls, Vector<Real>(n), Matrix<Real>(n, n),
                         native::implicit_euler<Real>(static_cast<Real>(tolerance))}) {}
template <class Real>
ImplicitEuler<Real>::~ImplicitEuler() = default;

/// Odeint's simplified Newton method: with J at (t + h, y), d = (h J - I)^-1 (y + h f(t + h, Y) - Y), Y -=
/// d. Only the first d has this matrix: later ones have what Odeint makes of it by factoring it again. That
/// changes how fast the iteration converges, not what it converges to.
/// @throws NotSolved  on a singular matrix, after most_iterations, or where the iteration leaves the numbers;
/// y_new stays as it was
template <class Real>
void ImplicitEuler<Real>::step(const Real* y, Real t, Real* y_new, Real h) {
  Memory& m = *memory_;
  // Begins as the identity and is used for all rehearsals of a step, as Odeint uses its own.
  ublas::permutation_matrix<std::size_t> pivots(m.y.size());
  // A factorisation of the copy in the place of Odeint's own, which would end the process.
  const auto rehearse = [&] {
    if (ublas::lu_factorize(m.rehearsed, pivots) != 0) throw NotSolved();
  };
  int iterations = 0;
  // Odeint calls f once an iteration: the count and the second factorisation of a matrix happen here.
  const auto f = [&](const Vector<Real>& at, Vector<Real>& dydt, Real time) {
    if (++iterations > most_iterations) throw NotSolved();
    m.calls.rhs(m.calls.system, time, data(at), data(dydt));
    if (iterations > 1) rehearse();
  };
  // Odeint factors h J - I.
  const auto J = [&](const Vector<Real>& at, Matrix<Real>& matrix, Real time) {
    m.calls.jacobian(m.calls.system, time, data(at), &*matrix.data().begin());
    m.rehearsed = matrix;
    m.rehearsed *= h;
    m.rehearsed -= ublas::identity_matrix<Real>(at.size());
    rehearse();
  };
  std::copy_n(y, m.y.size(), m.y.begin());
  // In place: m.y is y before and y_new after.
  m.stepper.do_step(std::make_pair(f, J), m.y, t, h);
  // Odeint ends at an increment that is no number as at a small one.
  if (!std::all_of(m.y.begin(), m.y.end(), [](Real value) { return std::isfinite(value); }))
    throw NotSolved();
  std::copy(m.y.begin(), m.y.end(), y_new);
}

/// The types that the catalogue runs.
template class Rosenbrock4<double>;
template class Rosenbrock4<long double>;
template class ImplicitEuler<double>;
template class ImplicitEuler<long double>;

}  // namespace hmax::odeint
