/// How large a step is stable: the whole question as one call, of matrices or of any system.
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>

#include <Eigen/Core>

#include "catalogue/methods/catalogue.hpp"
#include "integrators/explicit/tableaux.hpp"
#include "integrators/explicit/user_tableau.hpp"
#include "integrators/system.hpp"
#include "limits/point/prediction.hpp"
#include "problems/any_system.hpp"
#include "problems/linear_structure.hpp"

namespace hmax {

/// A method: by name ("rk4", "newmark:beta=0.25,gamma=0.5", all of `hmax list methods`), of the catalogue, or
/// of a tableau of your own.
class MethodChoice {
 public:
  // NOLINTBEGIN(google-explicit-constructor): arguments are written as they are at hand
  /// @throws InputError  with the nearest name where there is no such method
  template <class Name>
  requires std::is_convertible_v<const Name&, std::string_view> MethodChoice(const Name& name)
      : method_(find_method(name)) {}
  MethodChoice(Method method) : method_(std::move(method)) {}
  MethodChoice(const RuntimeTableau& tableau) : method_(make_method(tableau)) {}
  /// A struct with `id` and `tableau`, as those of integrators/explicit/tableaux.hpp; one of your own is
  /// checked. @throws std::invalid_argument  as runtime_tableau()
  template <class T>
  requires requires { T::tableau.a; }
  MethodChoice(const T&)
      : method_(is_of_catalogue<T> ? find_method(T::id) : make_method(runtime_tableau<T>())) {}
  // NOLINTEND(google-explicit-constructor)

  [[nodiscard]] const Method& method() const { return method_; }

 private:
  template <class T>
  static constexpr bool is_of_catalogue = []<class... Known>(std::type_identity<std::tuple<Known...>>) {
    return (std::is_same_v<T, Known> || ...);
  }(std::type_identity<tableaux::All>{});

  Method method_;
};

/// The largest stable step of a method, and what sets it.
struct StepAnswer {
  std::string method;  ///< its id
  /// [s]. Infinity: no step is unstable, see `bound`. 0: every step is unstable. NaN: there is no limit, as
  /// `bound` and `status` say.
  double h_max = std::numeric_limits<double>::quiet_NaN();
  Bound bound = Bound::unknown;
  std::optional<Mode> limiting = {};  ///< the mode that sets h_max, or that grows in the model itself
  std::string state_kind = {};        ///< "equilibrium", "motion" or "initial"; see StepOptions
  std::string status = {};            ///< a sentence where something is to be said of the answer, else empty
  /// With StepOptions::verify: the limit that integration with the code of the method shows [s]; nothing
  /// where runs show none, as `status` says.
  std::optional<double> observed = {};
};

/// What else may be asked.
struct StepOptions {
  double t = 0;  ///< the instant at which a system is linearised [s]
  /// Search an equilibrium of the system from y, with time standing still. The limit is that of small motions
  /// about it, and `state_kind` "equilibrium"; where there is none, "initial". Without it the limit is that
  /// of the Jacobian at y, and `state_kind` "motion".
  bool find_equilibrium = false;
  /// Also integrate on both sides of the limit, which takes some thousand steps; of a system together with
  /// find_equilibrium, since runs leave any other state, and where it depends on time only at t = 0.
  bool verify = false;
};

/// Of any system near (t, y).
/// @throws InputError             for numbers that are not finite, and more unknowns than dense methods take
///                                where the model has no sparse second-order form
/// @throws std::invalid_argument  for a state of another size than the system's, verify without
///                                find_equilibrium, and verify at t != 0 of a system that depends on time
StepAnswer largest_stable_step(const MethodChoice& method, const AnySystem& system, const Eigen::VectorXd& y,
                               const StepOptions& options = {});

/// The same of your own struct: System of integrators/system.hpp is all that is needed. A Jacobian is taken
/// from it where it has one, else by differences.
template <System S>
requires(!std::is_same_v<S, AnySystem>) StepAnswer
    largest_stable_step(const MethodChoice& method, const S& system, const typename S::State& y,
                        const StepOptions& options = {}) {
  return largest_stable_step(method, AnySystem(system), Eigen::VectorXd(y.template cast<double>()), options);
}

namespace detail {
StepAnswer step_of_structure(const MethodChoice& method, const AnySystem& structure,
                             const StepOptions& options);
}

/// Of M q'' + K q = 0. All matrices may be dense or sparse Eigen matrices; M may be a vector of lumped
/// masses. Symmetric sparse ones of 100,000 unknowns take seconds.
/// @throws std::invalid_argument  as linear_structure()
template <detail::RealMatrix KType, detail::RealMatrix MType>
StepAnswer largest_stable_step(const MethodChoice& method, const KType& K, const MType& M,
                               const StepOptions& options = {}) {
  return detail::step_of_structure(method, linear_structure(K, M), options);
}

/// Of M q'' + C q' + K q = 0.
template <detail::RealMatrix KType, detail::RealMatrix MType, detail::RealMatrix CType>
StepAnswer largest_stable_step(const MethodChoice& method, const KType& K, const MType& M, const CType& C,
                               const StepOptions& options = {}) {
  return detail::step_of_structure(method, linear_structure(K, M, C), options);
}

/// One sentence: "rk4: h_max = 0.0283 s, limited by stability of the mode omega = 100 rad/s, zeta = 0".
std::string describe(const StepAnswer& answer);

}  // namespace hmax
