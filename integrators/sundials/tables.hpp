/// The Runge-Kutta tables of ARKODE, made fit for its explicit stepper.
#pragma once

#include <cstdio>  // the header of the library needs it
#include <memory>

#include <arkode/arkode_butcher_dirk.h>
#include <arkode/arkode_butcher_erk.h>

namespace hmax::sundials {

/// Frees a table by the function of the library.
struct FreeTable {
  void operator()(ARKodeButcherTable table) const { ARKodeButcherTable_Free(table); }
};
using Table = std::unique_ptr<ARKodeButcherTableMem, FreeTable>;

/// Whether ERKStep of SUNDIALS 6.4.1 runs a table wrongly. It takes c_s = 1 for the sign that the last stage
/// is f(t + h, y_new) and starts the next step from it; that is so only when the last row of A also equals b.
/// For any other such table a step evaluates f once too seldom and loses its order: Heun's method shows order
/// 1, a table of the classical RK4 order 3. Mended in SUNDIALS 6.6.1
/// [https://github.com/LLNL/sundials/issues/311].
bool is_taken_for_fsal(const ARKodeButcherTableMem& table);

/// The table with one stage more, whose row is b, whose node is 1 and whose weight is 0. It is
/// first-same-as-last in truth, has the same solution and the same error estimate, and costs as many
/// evaluations of f a step as the table itself should.
Table with_honest_last_stage(const ARKodeButcherTableMem& table);

/// Tables as the library has them. Those that it lacks it tells on standard error of its own accord, so the
/// range of its ids is looked at first.
/// @param id  of ARKODE_ERKTableID or ARKODE_DIRKTableID, as a number, since it may be none of them
/// @throws std::invalid_argument  where it has none of this id, as another version of it may
Table library_erk_table(int id);
Table library_dirk_table(int id);

/// A table of the library as ERKStep runs it rightly.
/// @throws std::bad_alloc, std::invalid_argument
Table explicit_table(int id);

}  // namespace hmax::sundials
