#include "integrators/sundials/tables.hpp"

#include <algorithm>
#include <cmath>
#include <new>

namespace hmax::sundials {

bool is_taken_for_fsal(const ARKodeButcherTableMem& table) {
  constexpr double rounding = 1e-14;
  const int last = table.stages - 1;
  if (std::abs(table.c[last] - 1) > rounding) return false;
  for (int j = 0; j < table.stages; ++j)
    if (std::abs(table.A[last][j] - table.b[j]) > rounding) return true;
  return false;
}

Table with_honest_last_stage(const ARKodeButcherTableMem& table) {
  const int s = table.stages;
  Table longer(ARKodeButcherTable_Alloc(s + 1, table.d != nullptr ? SUNTRUE : SUNFALSE));
  if (!longer) throw std::bad_alloc();
  longer->q = table.q;
  longer->p = table.p;
  for (int i = 0; i < s; ++i) {
    std::copy_n(table.A[i], s, longer->A[i]);
    longer->A[s][i] = longer->b[i] = table.b[i];
    longer->c[i] = table.c[i];
    if (table.d != nullptr) longer->d[i] = table.d[i];
  }
  longer->c[s] = 1;
  return longer;
}

Table explicit_table(ARKODE_ERKTableID id) {
  Table table(ARKodeButcherTable_LoadERK(id));
  if (!table)
    throw std::invalid_argument("this SUNDIALS has no explicit table " +
                                std::to_string(static_cast<int>(id)) +
                                "; build hmax with version 6 or later");
  return is_taken_for_fsal(*table) ? with_honest_last_stage(*table) : std::move(table);
}

}  // namespace hmax::sundials
