/// The families of the catalogue. Each adds its methods, in the order in which they are listed, from a source
/// of its own: that source alone is compiled anew when the family changes.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "bench/catalogue/method.hpp"

namespace hmax {

void add_explicit_rk(std::vector<Method>& all);
void add_adams(std::vector<Method>& all);
void add_diagonally_implicit(std::vector<Method>& all);
void add_radau(std::vector<Method>& all);
void add_stabilised(std::vector<Method>& all);
void add_imex(std::vector<Method>& all);
void add_structural(std::vector<Method>& all);
void add_rosenbrock(std::vector<Method>& all);

/// The foreign engines add nothing where their library is missing.
void add_sundials(std::vector<Method>& all);
void add_odeint(std::vector<Method>& all);

/// The method of order 2 with an implicit table of ARKODE, by the number of the table; why_left_out says of a
/// number that the library does not have that it adds nothing.
void add_arkode_dirk(std::vector<Method>& all, const char* id, int implicit_table);

/// Why add_sundials has left a method out, and what to do: its coefficients are in another version of the
/// library. Empty for all others.
std::string why_left_out(std::string_view id);

}  // namespace hmax
