/// Tables of ARKODE [reynolds2023arkode], and the correction of those that ERKStep runs wrongly.
#include "integrators/sundials/tables.hpp"

#include <algorithm>
#include <cmath>
#include <new>
#include <stdexcept>
#include <string>

namespace hmax::sundials {

/// c_s = 1, but a_sj != b_j for some j, within 1e-14: coefficients are fractions or have 16 digits, so that
/// two that differ by more are meant to. a_ss = 0, so b_s must be zero too. Others are run rightly.
/// @param table  explicit, of s >= 1 stages
bool is_taken_for_fsal(const ARKodeButcherTableMem& table) {
  constexpr double rounding = 1e-14;
  const int last = table.stages - 1;
  if (std::abs(table.c[last] - 1) > rounding) return false;
  for (int j = 0; j < table.stages; ++j)
    if (std::abs(table.A[last][j] - table.b[j]) > rounding) return true;
  return false;
}

/// (A, b, c) -> ((A, 0; b^T, 0), (b, 0), (c, 1)), d -> (d, 0): stage s + 1 is f(t + h, y_new). Order and
/// embedded order stay, since no weight falls on the new stage.
/// @throws std::bad_alloc
Table with_honest_last_stage(const ARKodeButcherTableMem& table) {
  const int s = table.stages;
  Table longer(ARKodeButcherTable_Alloc(s + 1, table.d != nullptr ? SUNTRUE : SUNFALSE));
  if (!longer) throw std::bad_alloc();
  // q: order; p: embedded order; d: weights of the embedded method, if there is one.
  longer->q = table.q;
  longer->p = table.p;
  for (int i = 0; i < s; ++i) {
    std::copy_n(table.A[i], s, longer->A[i]);
    // Row s is the new stage, counted from 0; the last column of A stays zero.
    longer->A[s][i] = longer->b[i] = table.b[i];
    longer->c[i] = table.c[i];
    if (table.d != nullptr) longer->d[i] = table.d[i];
  }
  // b_(s+1) = d_(s+1) = 0, as allocated.
  longer->c[s] = 1;
  return longer;
}

namespace {
/// A new table, owned by the caller.
/// @param first, last  ids of the kind that the library knows
/// @throws std::invalid_argument  where the library has no table of this id
/// @param load  the function of the library that makes the table
template <class Id>
Table checked(ARKodeButcherTable (*load)(Id), int id, int first, int last, const char* kind) {
  Table table(id >= first && id <= last ? load(static_cast<Id>(id)) : nullptr);
  if (!table)
    throw std::invalid_argument(std::string("SUNDIALS " SUNDIALS_VERSION " has no ") + kind + " table " +
                                std::to_string(id));
  return table;
}
}  // namespace

Table library_erk_table(int id) {
  return checked(ARKodeButcherTable_LoadERK, id, ARKODE_MIN_ERK_NUM, ARKODE_MAX_ERK_NUM, "explicit");
}

Table library_dirk_table(int id) {
  return checked(ARKodeButcherTable_LoadDIRK, id, ARKODE_MIN_DIRK_NUM, ARKODE_MAX_DIRK_NUM, "implicit");
}

Table explicit_table(int id) {
  // Only those that need it: the stage more costs an evaluation of f in each step.
  Table table = library_erk_table(id);
  return is_taken_for_fsal(*table) ? with_honest_last_stage(*table) : std::move(table);
}

}  // namespace hmax::sundials
