/// The steppers of Boost.Odeint in the catalogue, as peers of hmax's own.
#include "catalogue/methods/families.hpp"

#if HMAX_HAVE_BOOST

#include <algorithm>
#include <concepts>
#include <stdexcept>
#include <string>
#include <string_view>

#include <boost/version.hpp>
#include <fmt/format.h>

#include "catalogue/methods/bind.hpp"
#include "integrators/odeint/explicit_peers.hpp"
#include "integrators/odeint/implicit_peers.hpp"
#include "integrators/odeint/integrate.hpp"

namespace hmax {

namespace {

namespace native = boost::numeric::odeint;

template <class Sys>
using Values = odeint::values_of<typename Sys::State>;
template <class Sys>
using Real = real_of<typename Sys::State>;

template <class Sys>
using Euler = odeint::FixedPeer<Sys, native::euler<Values<Sys>, Real<Sys>>>;
template <class Sys>
using Rk4 = odeint::FixedPeer<Sys, native::runge_kutta4<Values<Sys>, Real<Sys>>>;
template <class Sys>
using Dopri5 = odeint::FixedPeer<Sys, native::runge_kutta_dopri5<Values<Sys>, Real<Sys>>>;
template <class Sys>
using Fehlberg78Stepper = native::runge_kutta_fehlberg78<Values<Sys>, Real<Sys>>;
template <class Sys>
using Fehlberg78 = odeint::FixedPeer<Sys, Fehlberg78Stepper<Sys>>;
template <class Sys>
using ControlledFehlberg78 = odeint::ControlledPeer<Sys, Fehlberg78Stepper<Sys>>;
constexpr std::size_t adams_steps = 4;
template <class Sys>
using OdeintAdams =
    odeint::FixedPeer<Sys, native::adams_bashforth_moulton<adams_steps, Values<Sys>, Real<Sys>>>;

/// In the place of steps that a method does not take.
template <class Sys>
struct None {};

/// Boost.Odeint as an engine of the catalogue: a peer for fixed steps, one for steps that it steers, or both.
template <template <class> class Fixed, template <class> class Steered>
struct OdeintEngine {
  int error_order;
  static constexpr bool is_cheap = true;

  template <System Sys, class Observer>
  RunEnd<double> operator()(const Sys& system, Span<double> span, typename Sys::State& y, const RunSpec& spec,
                            Observer&& observer) const {
    constexpr bool takes_fixed = !std::same_as<Fixed<Sys>, None<Sys>>;
    constexpr bool steers = !std::same_as<Steered<Sys>, None<Sys>>;
    if constexpr (steers)
      if (spec.adaptive || !takes_fixed)
        return odeint::integrate_adaptive<Steered<Sys>>(system, span, y, spec.rtol, spec.atol, error_order,
                                                        observer, spec.max_steps, spec.h_first, spec.h_max);
    if constexpr (takes_fixed)
      return odeint::integrate_fixed<Fixed<Sys>>(system, span, y, spec.h, observer, spec.max_steps);
  }
};

struct OdeintFacts {
  const char* id;
  std::string_view same_as;  ///< the method of hmax with these coefficients: it has the same amplification
  int order, error_order, stages;
  bool is_implicit = false, l_stable = false;
  bool in_long_double = true;  ///< false: its coefficients are written in double
  bool linearly_implicit = false;
  int steps_back = 0;
};

/// @param all  the methods of hmax
/// @throws std::logic_error  where none of them is called OdeintFacts::same_as
template <template <class> class Fixed, template <class> class Steered>
Method line(const std::vector<Method>& all, const OdeintFacts& facts) {
  Method method{.id = facts.id,
                .order = facts.order,
                .error_order = facts.error_order,
                .stages = facts.stages,
                .is_explicit = !facts.is_implicit,
                .needs_jacobian = facts.is_implicit,
                .a_stable = facts.l_stable,
                .l_stable = facts.l_stable,
                .engine = "Boost.Odeint " + std::to_string(BOOST_VERSION / 100000) + "." +
                          std::to_string(BOOST_VERSION / 100 % 1000),
                .source = "ahnert2011odeint",
                .fixed_step = !std::same_as<Fixed<ExtendedSystem>, None<ExtendedSystem>>,
                .own_control = true,
                .linearly_implicit = facts.linearly_implicit,
                .dense_equations = facts.is_implicit,
                .steps_back = facts.steps_back};
  if (!facts.same_as.empty()) {
    const auto own = std::ranges::find(all, facts.same_as, &Method::id);
    if (own == all.end())
      throw std::logic_error(fmt::format("{} is given the amplification of {}, which no method is called",
                                         facts.id, facts.same_as));
    method.amplification = own->amplification;
    method.note = own->note;
  }
  const OdeintEngine<Fixed, Steered> engine{method.error_order};
  method.bind = [engine, extends = facts.in_long_double](const Problem& problem) {
    Runner runner = bind_engine(problem, [&](auto) { return engine; });
    if constexpr (!std::same_as<Fixed<ExtendedSystem>, None<ExtendedSystem>>)
      if (extends && problem.extended)
        runner.end_state_extended = [system = *problem.extended, y0 = problem.y0](double h, double t_end) {
          ExtendedSystem::State y = y0.template cast<long double>();
          odeint::integrate_fixed<Fixed<ExtendedSystem>>(
              system, Span<long double>{0, static_cast<long double>(t_end)}, y, static_cast<long double>(h),
              ObserveNothing{}, std::numeric_limits<std::int64_t>::max());
          return y;
        };
    return runner;
  };
  return method;
}

}  // namespace

void add_odeint(std::vector<Method>& all) {
  all.push_back(line<Euler, None>(all, {"odeint_euler", "explicit_euler", 1, 0, 1}));
  all.push_back(line<Rk4, None>(all, {"odeint_rk4", "rk4", 4, 0, 4}));
  all.push_back(line<Dopri5, odeint::Dopri5Peer>(all, {"odeint_dopri5", "dormand_prince_54", 5, 5, 7}));
  all.push_back(line<Fehlberg78, ControlledFehlberg78>(all, {"odeint_fehlberg78", "fehlberg_78", 8, 8, 13}));
  all.push_back(line<OdeintAdams, None>(all, {.id = "odeint_adams_bashforth_moulton",
                                              .same_as = "abm_pece_4",
                                              .order = 4,
                                              .error_order = 0,
                                              .stages = 2,
                                              .steps_back = static_cast<int>(adams_steps) - 1}));
  all.push_back(line<None, odeint::BulirschStoerPeer>(all, {"odeint_bulirsch_stoer", {}, 0, 5, 0}));
  all.push_back(
      line<None, odeint::BulirschStoerDensePeer>(all, {"odeint_bulirsch_stoer_dense", {}, 0, 5, 0}));
  all.push_back(line<odeint::Rosenbrock4Peer, odeint::Rosenbrock4Peer>(
      all, {"odeint_rosenbrock4", "rodas_4", 4, 4, 6, true, true, false, true}));
  all.push_back(line<odeint::ImplicitEulerPeer, None>(
      all, {"odeint_implicit_euler", "implicit_euler", 1, 0, 1, true, true}));
}

}  // namespace hmax

#else

namespace hmax {
void add_odeint(std::vector<Method>&) {}
}  // namespace hmax

#endif
