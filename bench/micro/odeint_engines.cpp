#include <cmath>
#include <type_traits>

#include <boost/numeric/odeint.hpp>

#include "bench/micro/engine.hpp"

namespace hmax::micro {
namespace {

namespace odeint = boost::numeric::odeint;

/// The model as it is read from the page.
struct AsWritten {
  explicit AsWritten(const Oscillator& model) : p(model.parameters()) {}
  void operator()(const Point& y, Point& dydt, double t) const {
    dydt[0] = y[1];
    dydt[1] = (p.P * std::cos(p.w * t) - p.c * y[1] - p.k1 * y[0] - p.k3 * y[0] * y[0] * y[0]) / p.m;
  }
  OscillatorParameters p;
};

/// The same arithmetic as hmax's own: divided by the mass beforehand, and the velocity, on which the next
/// stage waits, enters last. Faster here than a call of Oscillator::rhs and than numbers written in the text.
struct Rearranged {
  explicit Rearranged(const Oscillator& model) : p(model.parameters()) {
    for (double* coefficient : {&p.c, &p.k1, &p.k3, &p.P}) *coefficient /= p.m;
  }
  void operator()(const Point& y, Point& dydt, double t) const {
    const double x = y[0];
    const double v = y[1];
    dydt[0] = v;
    dydt[1] = (p.P * std::cos(p.w * t) - x * (p.k1 + p.k3 * (x * x))) - p.c * v;
  }
  OscillatorParameters p;
};

template <class F>
struct Counting {
  F f;
  long& evaluations;
  void operator()(const Point& y, Point& dydt, double t) const {
    ++evaluations;
    f(y, dydt, t);
  }
};

/// Steps of one size.
template <class Stepper>
struct Fixed {
  template <class F>
  static void run(const F& f, double t_end, double h, Point& y) {
    Stepper stepper;
    const long n = std::lround(t_end / h);
    for (long i = 0; i < n; ++i) stepper.do_step(f, y, static_cast<double>(i) * h, h);
  }
  template <class F>
  static void watched(const F& f, double t_end, double h, Point& y, const Watcher& watcher) {
    odeint::integrate_n_steps(Stepper(), f, y, 0.0, h, std::lround(t_end / h),
                              [&](const Point& state, double t) { watcher(t, state); });
  }
};

/// Odeint wants to be told; hmax chooses its own.
constexpr double first_step = 0.01;

/// Steps steered by the error; Make turns a tolerance into a stepper.
template <auto Make>
struct Adaptive {
  template <class F>
  static void run(const F& f, double t_end, double tolerance, Point& y) {
    odeint::integrate_adaptive(Make(tolerance), f, y, 0.0, t_end, first_step);
  }
  template <class F>
  static void watched(const F& f, double t_end, double tolerance, Point& y, const Watcher& watcher) {
    odeint::integrate_adaptive(Make(tolerance), f, y, 0.0, t_end, first_step,
                               [&](const Point& state, double t) { watcher(t, state); });
  }
};

/// The same with every call inlined by force: g++ leaves half of Odeint's calls out of line otherwise. An
/// attribute in the caller's source and not a flag, so it is measured apart.
template <class Way>
struct Flattened : Way {
  template <class F>
  [[gnu::flatten]] static void run(const F& f, double t_end, double setting, Point& y) {
    Way::run(f, t_end, setting, y);
  }
};

template <class Way, class F>
Engine engine(const char* side, Task task, const char* stepper, const char* functor) {
  return {task, side, std::string(stepper) + ", " + functor,
          [](const Oscillator& model, double t_end, double setting, Point& y) {
            Way::run(F(model), t_end, setting, y);
          },
          [](const Oscillator& model, double t_end, double setting, Point y, const Watcher& watcher) {
            long evaluations = 0;
            Way::watched(Counting<F>{F(model), evaluations}, t_end, setting, y, watcher);
            return evaluations;
          }};
}

using Rk4 = odeint::runge_kutta4<Point>;
using Rk4Classic = odeint::runge_kutta4_classic<Point>;
using Dopri5 = odeint::runge_kutta_dopri5<Point>;
using Fehlberg78 = odeint::runge_kutta_fehlberg78<Point>;

template <class Stepper>
auto controlled(double tolerance) {
  return odeint::make_controlled(tolerance, tolerance, Stepper());
}
auto dense(double tolerance) { return odeint::make_dense_output(tolerance, tolerance, Dopri5()); }

/// One stepper under one functor, as it is used and flattened.
template <class Way, class F>
void add(std::vector<Engine>& engines, Task task, const char* stepper, const char* functor) {
  constexpr bool as_written = std::is_same_v<F, AsWritten>;
  engines.push_back(
      engine<Way, F>(as_written ? "odeint, as written" : "odeint, rearranged", task, stepper, functor));
  engines.push_back(engine<Flattened<Way>, F>("odeint, flattened", task, stepper, functor));
}

template <class F>
void add_all(std::vector<Engine>& engines, const char* f) {
  add<Fixed<Rk4>, F>(engines, Task::rk4_fixed, "runge_kutta4", f);
  add<Fixed<Rk4Classic>, F>(engines, Task::rk4_fixed, "runge_kutta4_classic", f);
  add<Fixed<Dopri5>, F>(engines, Task::dormand_prince_fixed, "runge_kutta_dopri5", f);
  add<Fixed<Fehlberg78>, F>(engines, Task::order_8_fixed, "runge_kutta_fehlberg78", f);
  add<Adaptive<controlled<Dopri5>>, F>(engines, Task::dormand_prince_adaptive, "runge_kutta_dopri5", f);
  add<Adaptive<dense>, F>(engines, Task::dormand_prince_adaptive, "dense runge_kutta_dopri5", f);
  add<Adaptive<controlled<Fehlberg78>>, F>(engines, Task::order_8_adaptive, "runge_kutta_fehlberg78", f);
}

}  // namespace

std::vector<Engine> odeint_engines() {
  std::vector<Engine> engines;
  add_all<AsWritten>(engines, "as written");
  add_all<Rearranged>(engines, "rearranged");
  return engines;
}

}  // namespace hmax::micro
