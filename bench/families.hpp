/// The families of the catalogue. Each adds its methods, in the order in which they are listed, from a source
/// of its own: that source alone is compiled anew when the family changes.
#pragma once

#include <vector>

#include "bench/catalogue.hpp"

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

}  // namespace hmax
