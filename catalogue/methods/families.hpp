/// The families of the catalogue. Each adds its methods from a source of its own, family_NAME.cpp: that
/// source alone is compiled anew when the family changes. A new family is declared and listed here, and
/// nowhere else.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "catalogue/methods/method.hpp"

namespace hmax {

void add_explicit_rk(std::vector<Method>& all);
void add_adams(std::vector<Method>& all);
void add_diagonally_implicit(std::vector<Method>& all);
void add_radau(std::vector<Method>& all);
void add_stabilised(std::vector<Method>& all);
void add_imex(std::vector<Method>& all);
void add_structural(std::vector<Method>& all);
void add_positional(std::vector<Method>& all);
void add_rosenbrock(std::vector<Method>& all);

/// The method of its default parameters, which users may set.
inline Method with_defaults(Method (*make)(const Parameters&), const Parameters& defaults) {
  Method method = make(defaults);
  method.parameters = defaults;
  method.with = make;
  return method;
}

/// The line of a method as far as the struct of its coefficients tells it: the rest is its family's.
template <class T>
Method described() {
  Method method{.id = std::string(T::id),
                .order = T::order,
                .error_order = T::error_order,
                .stages = static_cast<int>(T::tableau.stages),
                .source = std::string(T::source)};
  if constexpr (requires { T::a_stable; }) method.a_stable = T::a_stable;
  if constexpr (requires { T::l_stable; }) method.l_stable = T::l_stable;
  if constexpr (requires { T::aliases; })
    for (const std::string_view alias : T::aliases) method.aliases.emplace_back(alias);
  return method;
}

/// The same of a method that solves equations with the Jacobian.
template <class T>
Method described_implicit() {
  Method method = described<T>();
  method.is_explicit = false;
  method.needs_jacobian = true;
  return method;
}

// The foreign engines add nothing where their library is missing.
void add_cvode(std::vector<Method>& all);
void add_arkode(std::vector<Method>& all);
void add_odeint(std::vector<Method>& all);

/// The library that runs the methods of a family.
struct ForeignLibrary {
  std::string_view prefix;  ///< of the ids of its methods
  std::string_view name, package;
};

struct Family {
  std::string_view id;     ///< as users name it
  std::string_view words;  ///< as figures and tables name it
  void (*add)(std::vector<Method>& all);
  ForeignLibrary library{};  ///< no name: of hmax itself
};

/// In the order in which their methods are listed.
constexpr auto all_families = std::to_array<Family>({
    {"explicit_runge_kutta", "explicit Runge-Kutta", add_explicit_rk},
    {"adams", "Adams", add_adams},
    {"diagonally_implicit", "diagonally implicit", add_diagonally_implicit},
    {"fully_implicit", "fully implicit", add_radau},
    {"stabilised", "stabilised", add_stabilised},
    {"imex", "implicit-explicit", add_imex},
    {"structural", "positions and velocities", add_structural},
    {"positional", "positions by iterations", add_positional},
    {"rosenbrock", "Rosenbrock", add_rosenbrock},
    {"sundials_cvode", "CVODE", add_cvode, {"cvode_", "SUNDIALS", "libsundials-dev"}},
    {"sundials_arkode", "ARKODE", add_arkode, {"arkode_", "SUNDIALS", "libsundials-dev"}},
    {"odeint", "Boost.Odeint", add_odeint, {"odeint_", "Boost.Odeint", "libboost-dev"}},
});

/// The family of a method of the catalogue; null for formulas, which no family holds.
const Family* family_of(const Method& method);

/// The method of order 2 with an implicit table of ARKODE, by the number of the table; why_left_out says of a
/// number that the library does not have that it adds nothing.
void add_arkode_dirk(std::vector<Method>& all, const char* id, int implicit_table);

/// Why add_arkode has left a method out, and what to do: its coefficients are in another version of the
/// library. Empty for all others.
std::string why_left_out(std::string_view id);

}  // namespace hmax
