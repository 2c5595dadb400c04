/// The methods of structural dynamics of the catalogue: they step positions and velocities, M q'' = F(t, q,
/// v).
#include <string>
#include <string_view>

#include "analysis/amplification/structural_amplification.hpp"
#include "catalogue/methods/bind.hpp"
#include "catalogue/methods/families.hpp"
#include "core/input_error.hpp"
#include "core/numbers.hpp"
#include "integrators/structural/generalized_alpha.hpp"
#include "integrators/structural/structural.hpp"

namespace hmax {

namespace {

/// What all of them have in common: one stage, fixed steps, positions and velocities.
Method structural(std::string id, std::vector<std::string> aliases, int order, std::string source) {
  Method method{.id = std::move(id),
                .aliases = std::move(aliases),
                .order = order,
                .stages = 1,
                .source = std::move(source)};
  method.needs_second_order = true;
  return method;
}

template <template <class> class StepperT>
Method explicit_structural(std::string id, std::vector<std::string> aliases, std::string source,
                           Amplification amplification, std::string note = {}) {
  Method method =
      structural(std::move(id), std::move(aliases), StepperT<Eigen::VectorXd>::order, std::move(source));
  method.note = std::move(note);
  method.amplification = shared(std::move(amplification));
  method.bind = bound(0, []<class Sys>(std::type_identity<Sys>) { return StepperT<typename Sys::State>{}; });
  return method;
}

Method implicit_structural(std::string id, std::vector<std::string> aliases, const AlphaParameters& p,
                           std::string source) {
  Method method = structural(std::move(id), std::move(aliases), order_of(p), std::move(source));
  method.is_explicit = p.beta == 0;
  // The equation of motion holds between two steps, and the acceleration at their ends is one of its own.
  if (p.alpha_m != 0 || p.alpha_f != 0) method.carried_acceleration = CarriedAcceleration::always;
  method.needs_jacobian = true;
  method.amplification = shared(generalized_alpha_amplification(p));
  method.a_stable = is_unconditionally_stable(*method.amplification);
  method.l_stable = method.a_stable && annihilates_fast_modes(*method.amplification);
  method.bind = bound(0, [p]<class Sys>(std::type_identity<Sys>) {
    return GeneralizedAlpha<typename Sys::State, typename Sys::Dofs, structure_type<Sys>>(p);
  });
  return method;
}

/// @throws InputError unless low <= value <= high
void require_between(std::string_view method, std::string_view name, double value, double low, double high,
                     std::string_view why) {
  if (!(low <= value && value <= high))
    throw input_error("{0} of {1} is {2} but must lie between {3} and {4}: {5}", name, method, to_text(value),
                      to_text(low), to_text(high), why);
}

Method newmark(const Parameters& values) {
  const double beta = values[0].second, gamma = values[1].second;
  require_between("newmark", "beta", beta, 0, 1,
                  "it is the share of the new acceleration in the position, 1/4 for the trapezoidal rule");
  require_between("newmark", "gamma", gamma, 0, 2,
                  "it is the share of the new acceleration in the velocity, 1/2 for order 2");
  return implicit_structural("newmark", {}, newmark_parameters(beta, gamma), "newmark1959method");
}

Method hht_alpha(const Parameters& values) {
  const double alpha = values[0].second;
  require_between("hht_alpha", "alpha", alpha, -1.0 / 3, 0,
                  "0 is the trapezoidal rule, and -1/3 damps fast modes most");
  return implicit_structural("hht_alpha", {"hht"}, hht_parameters(alpha), "hilber1977improved");
}

Method generalized_alpha(const Parameters& values) {
  const double rho = values[0].second;
  require_between("generalized_alpha", "rho_inf", rho, 0, 1,
                  "it is what one step leaves of infinitely fast modes, 0 nothing and 1 all");
  return implicit_structural("generalized_alpha", {"chung_hulbert"}, generalized_alpha_parameters(rho),
                             "chung1993time");
}

}  // namespace

void add_structural(std::vector<Method>& all) {
  all.push_back(explicit_structural<SymplecticEuler>("symplectic_euler", {}, "hairer2006geometric",
                                                     symplectic_euler_amplification()));
  all.push_back(explicit_structural<VelocityVerlet>("velocity_verlet", {}, "swope1982computer",
                                                    kick_drift_kick_amplification(KickDamping::half_step),
                                                    "takes damping forces at the velocity of the half step"));
  all.back().order_undamped = 2;
  all.back().carried_acceleration = CarriedAcceleration::damped_only;
  all.push_back(explicit_structural<StormerVerlet>("stormer_verlet", {"verlet"}, "hairer2006geometric",
                                                   kick_drift_kick_amplification(KickDamping::predicted),
                                                   "takes damping forces at a predicted velocity"));
  all.back().carried_acceleration = CarriedAcceleration::damped_only;
  all.push_back(explicit_structural<CentralDifference>(
      "central_difference", {}, "hughes2000finite", kick_drift_kick_amplification(KickDamping::lumped),
      "takes damping forces at the new velocity, for the diagonal of the damping matrix"));
  all.push_back(
      implicit_structural("explicit_newmark", {}, newmark_parameters(0, 0.5L), "newmark1959method"));
  all.back().note = "takes damping forces at the new velocity, for all of the damping matrix";
  all.push_back(with_defaults(newmark, {{"beta", 0.25}, {"gamma", 0.5}}));
  all.push_back(with_defaults(hht_alpha, {{"alpha", -0.1}}));
  all.push_back(with_defaults(generalized_alpha, {{"rho_inf", 0.8}}));
}

}  // namespace hmax
