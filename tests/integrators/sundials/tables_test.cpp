#include "integrators/sundials/tables.hpp"

#include <cmath>
#include <complex>
#include <nvector/nvector_serial.h>
#include <set>

#include <Eigen/Dense>
#include <arkode/arkode_butcher_dirk.h>
#include <arkode/arkode_erkstep.h>
#include <gtest/gtest.h>
#include <sundials/sundials_config.h>

#include "catalogue/methods/catalogue.hpp"
#include "integrators/sundials/solver.hpp"
#include "tests/integrators/stability_function.hpp"

namespace hmax::sundials {
namespace {

Table rk4() {
  Table table(ARKodeButcherTable_Alloc(4, SUNFALSE));
  table->q = 4;
  table->A[1][0] = table->A[2][1] = table->c[1] = table->c[2] = 0.5;
  table->A[3][2] = table->c[3] = 1;
  table->b[0] = table->b[3] = 1.0 / 6;
  table->b[1] = table->b[2] = 1.0 / 3;
  return table;
}

struct Raw {
  double error;
  double evaluations_per_step;
};

/// y' = -y + t, y(0) = 1 over [0, 1] by ERKStep itself, with nothing of ours around it.
Raw run_raw(const Table& table, int steps) {
  SUNContext context = this_context();
  N_Vector y = N_VNew_Serial(1, context);
  NV_Ith_S(y, 0) = 1;
  const ARKRhsFn f = [](double t, N_Vector at, N_Vector out, void*) {
    NV_Ith_S(out, 0) = -NV_Ith_S(at, 0) + t;
    return 0;
  };
  void* memory = ERKStepCreate(f, 0, y, context);
  ERKStepSetTable(memory, table.get());
  ERKStepSetFixedStep(memory, 1.0 / steps);
  ERKStepSetStopTime(memory, 1);
  ERKStepSetMaxNumSteps(memory, -1);
  double t = 0;
  EXPECT_GE(ERKStepEvolve(memory, 1, y, &t, ARK_NORMAL), 0);
  long evaluations = 0, taken = 0;
  ERKStepGetNumRhsEvals(memory, &evaluations);
  ERKStepGetNumSteps(memory, &taken);
  const Raw raw{std::abs(NV_Ith_S(y, 0) - 2 * std::exp(-1.0)),
                static_cast<double>(evaluations) / static_cast<double>(taken)};
  ERKStepFree(&memory);
  N_VDestroy(y);
  return raw;
}

double raw_order(const Table& table) {
  return std::log2(run_raw(table, 20).error / run_raw(table, 40).error);
}

TEST(ErkStepTables, TheLibraryRunsRk4WithThreeEvaluationsAndOrderThree) {
  if (SUNDIALS_VERSION_MAJOR * 100 + SUNDIALS_VERSION_MINOR >= 606)
    GTEST_SKIP() << "mended in SUNDIALS " SUNDIALS_VERSION;
  ASSERT_TRUE(is_taken_for_fsal(*rk4()));
  EXPECT_NEAR(run_raw(rk4(), 100).evaluations_per_step, 3, 0.05);
  EXPECT_NEAR(raw_order(rk4()), 3, 0.1);
}

TEST(ErkStepTables, OneStageMoreMakesRk4WhatItIs) {
  const Table honest = with_honest_last_stage(*rk4());
  EXPECT_FALSE(is_taken_for_fsal(*honest));
  EXPECT_NEAR(run_raw(honest, 100).evaluations_per_step, 4, 0.05);
  EXPECT_NEAR(raw_order(honest), 4, 0.1);
}

TEST(ErkStepTables, TheseTablesOfTheLibraryAreRunWrongly) {
  std::set<int> wrong;
  for (int id = ARKODE_MIN_ERK_NUM; id <= ARKODE_MAX_ERK_NUM; ++id)
    if (is_taken_for_fsal(*Table(ARKodeButcherTable_LoadERK(static_cast<ARKODE_ERKTableID>(id)))))
      wrong.insert(id);
  EXPECT_EQ(wrong, (std::set<int>{ARKODE_HEUN_EULER_2_1_2, ARKODE_ARK324L2SA_ERK_4_2_3,
                                  ARKODE_ARK436L2SA_ERK_6_3_4, ARKODE_SAYFY_ABURUB_6_3_4,
                                  ARKODE_ARK548L2SA_ERK_8_4_5, ARKODE_VERNER_8_5_6, ARKODE_FEHLBERG_13_7_8,
                                  ARKODE_ARK437L2SA_ERK_7_3_4, ARKODE_ARK548L2SAb_ERK_8_4_5}));
}

TEST(ErkStepTables, WhatWeRunIsNeverTakenForSomethingElseAndKeepsItsOrders) {
  for (int id = ARKODE_MIN_ERK_NUM; id <= ARKODE_MAX_ERK_NUM; ++id) {
    const auto name = static_cast<ARKODE_ERKTableID>(id);
    const Table library(ARKodeButcherTable_LoadERK(name)), ours = explicit_table(id);
    EXPECT_FALSE(is_taken_for_fsal(*ours)) << id;
    int q = 0, p = 0, our_q = 0, our_p = 0;
    ARKodeButcherTable_CheckOrder(library.get(), &q, &p, nullptr);
    ARKodeButcherTable_CheckOrder(ours.get(), &our_q, &our_p, nullptr);
    EXPECT_EQ(our_q, q) << id;
    EXPECT_EQ(our_p, p) << id;
  }
}

TEST(Tables, ThatTheLibraryDoesNotHaveAreSaid) {
  EXPECT_THROW(library_erk_table(ARKODE_MAX_ERK_NUM + 1), std::invalid_argument);
  EXPECT_THROW(library_dirk_table(ARKODE_MAX_DIRK_NUM + 1), std::invalid_argument);
  EXPECT_THROW(explicit_table(-1), std::invalid_argument);
}

TEST(DirkTables, AreAsStableAsTheCatalogueSays) {
  const std::pair<const char*, ARKODE_DIRKTableID> listed[]{
      {"arkode_dirk_sdirk_212", ARKODE_SDIRK_2_1_2},
      {"arkode_dirk_billington_332", ARKODE_BILLINGTON_3_3_2},
      {"arkode_dirk_trbdf2_332", ARKODE_TRBDF2_3_3_2},
      {"arkode_dirk_kvaerno_423", ARKODE_KVAERNO_4_2_3},
      {"arkode_dirk_ark324l2sa", ARKODE_ARK324L2SA_DIRK_4_2_3},
      {"arkode_dirk_sdirk_534", ARKODE_SDIRK_5_3_4},
      {"arkode_dirk_kvaerno_534", ARKODE_KVAERNO_5_3_4},
      {"arkode_dirk_ark436l2sa", ARKODE_ARK436L2SA_DIRK_6_3_4},
      {"arkode_dirk_kvaerno_745", ARKODE_KVAERNO_7_4_5},
      {"arkode_dirk_ark548l2sa", ARKODE_ARK548L2SA_DIRK_8_4_5}};
  for (const auto& [id, number] : listed) {
    const Table table(ARKodeButcherTable_LoadDIRK(number));
    const hmax::Method method = find_method(id);
    const auto multiplies_by = [&](std::complex<long double> z) {
      return static_cast<double>(std::abs(stability_function(
          static_cast<std::size_t>(table->stages),
          [&](std::size_t i, std::size_t j) { return z * static_cast<long double>(table->A[i][j]); },
          [&](std::size_t i) { return z * static_cast<long double>(table->b[i]); })));
    };
    double largest = 0;  // on the imaginary axis; the poles lie in the right half plane, since a_ii >= 0
    for (double y = 1e-3; y < 1e4; y *= 1.01) largest = std::max(largest, multiplies_by({0, y}));
    for (int i = 0; i < table->stages; ++i) EXPECT_GE(table->A[i][i], 0) << id;
    EXPECT_EQ(method.a_stable, largest < 1 + 1e-9) << id << " " << largest;
    const double far = multiplies_by(-1e7);
    EXPECT_EQ(method.l_stable, method.a_stable && far < 1e-4) << id << " " << far;
    EXPECT_EQ(method.order, table->q) << id;
    EXPECT_EQ(method.stages, table->stages) << id;
    EXPECT_EQ(method.error_order, std::min(table->q, table->p) + 1) << id;
  }
}

}  // namespace
}  // namespace hmax::sundials
