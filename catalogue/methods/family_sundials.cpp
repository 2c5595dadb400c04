/// The methods of CVODE and ARKODE in the catalogue, as peers of hmax's own.
#include "catalogue/methods/families.hpp"

#if HMAX_HAVE_SUNDIALS

#include <cmath>
#include <stdexcept>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "analysis/amplification/one_step_amplification.hpp"
#include "catalogue/methods/bind.hpp"
#include "core/input_error.hpp"
#include "core/numbers.hpp"
#include "integrators/sundials/integrate.hpp"
#include "integrators/sundials/tables.hpp"

namespace hmax {

namespace {

using sundials::Package;

constexpr std::string_view engine_name = "SUNDIALS " SUNDIALS_VERSION;

/// SUNDIALS as an engine of the catalogue.
struct SundialsEngine {
  sundials::Method method;
  static constexpr bool is_cheap = false;

  template <System Sys, class Observer>
  RunEnd<double> operator()(const Sys& system, Span<double> span, typename Sys::State& y, const RunSpec& spec,
                            Observer&& observer) const {
    const sundials::Settings settings{.adaptive = spec.adaptive,
                                      .h = spec.h,
                                      .rtol = spec.rtol,
                                      .atol = spec.atol,
                                      .h_first = spec.h_first,
                                      .h_max = spec.h_max,
                                      .jacobian = spec.jacobian};
    return sundials::integrate(method, settings, system, span, y, observer, spec.max_steps);
  }
};

/// What else distinguishes a method: the facts of the catalogue.
struct SundialsFacts {
  const char* id;
  int order, error_order, stages;
  bool a_stable = false, l_stable = false;
};

Method with_number(Method method, const sundials::Method& choice) {
  method.bind = [choice](const Problem& problem) {
    return bind_engine(problem, [&](auto) { return SundialsEngine{choice}; });
  };
  return method;
}

/// cvode_bdf:klu=0 solves sparse equations by hmax's own solver.
void let_choose_klu(Method& method, const sundials::Method& choice) {
  method.parameters = {{"klu", 1}};
  method.with = [method, choice](const Parameters& parameters) {
    const double klu = parameters.front().second;
    if (klu != 0 && klu != 1)
      throw input_error(
          "klu is {} but must be 1 (KLU solves sparse equations) or 0 (hmax does); write {}:klu=0",
          to_text(klu), method.id);
    sundials::Method changed = choice;
    changed.klu = klu == 1;
    return with_number(method, changed);
  };
}

/// arkode_mri:fast=50 takes 50 steps of the stiff part in each of the other.
void let_choose_fast_steps(Method& method, const sundials::Method& choice) {
  static constexpr int most = 1'000'000;
  method.parameters = {{"fast", choice.fast_steps}};
  method.with = [method, choice](const Parameters& parameters) {
    const double fast = parameters.front().second;
    if (!(fast >= 1 && fast <= most && fast == std::floor(fast)))
      throw input_error("fast is {} but must be a whole number of steps from 1 to {}; write {}:fast=20",
                        to_text(fast), most, method.id);
    sundials::Method changed = choice;
    changed.fast_steps = static_cast<int>(fast);
    return with_number(method, changed);
  };
}

/// The coefficients of a table of the library.
struct Coefficients {
  std::vector<long double> a, b;

  explicit Coefficients(const sundials::Table& table) {
    const int s = table->stages;
    for (int i = 0; i < s; ++i) a.insert(a.end(), table->A[i], table->A[i] + s);
    b.assign(table->b, table->b + s);
  }
};

/// From the tables that the library steps with; null where a method is more than tables.
/// @throws std::invalid_argument  where the library lacks one of them
std::shared_ptr<const Amplification> amplification_of(const sundials::Method& choice, int order) {
  const auto implicit = [&] { return Coefficients(sundials::library_dirk_table(choice.implicit_table)); };
  const auto explicit_part = [&] { return Coefficients(sundials::library_erk_table(choice.explicit_table)); };
  switch (choice.package) {
    case Package::erk: {
      const Coefficients table = explicit_part();
      return shared(runge_kutta_amplification(table.a, table.b, order));
    }
    case Package::dirk: {
      const Coefficients table = implicit();
      return shared(runge_kutta_amplification(table.a, table.b, order));
    }
    case Package::imex: {
      const Coefficients nonstiff = explicit_part(), stiff = implicit();
      return shared(additive_amplification(nonstiff.a, nonstiff.b, stiff.a, stiff.b, order));
    }
    default:
      return nullptr;
  }
}

Method line(const SundialsFacts& facts, const sundials::Method& choice) {
  const bool is_cvode = choice.package == Package::cvode_adams || choice.package == Package::cvode_bdf;
  Method method{.id = facts.id,
                .order = facts.order,
                .error_order = facts.error_order,
                .stages = facts.stages,
                .is_explicit = choice.package == Package::erk || choice.package == Package::mri,
                .needs_jacobian = sundials::solves_equations(choice.package),
                .a_stable = facts.a_stable,
                .l_stable = facts.l_stable,
                .engine = std::string(engine_name),
                .source = is_cvode ? "hindmarsh2005sundials" : "reynolds2023arkode",
                .fixed_step = !is_cvode,
                .own_control = true,
                .needs_split = choice.package == Package::imex || choice.package == Package::mri};
  method = with_number(method, choice);
  method.amplification = amplification_of(choice, facts.order);
  if (method.needs_jacobian) let_choose_klu(method, choice);
  if (choice.package == Package::mri) let_choose_fast_steps(method, choice);
  return method;
}

/// Methods without their tables, and which these are.
std::vector<std::pair<std::string, std::string>>& left_out() {
  static std::vector<std::pair<std::string, std::string>> methods;
  return methods;
}

/// Versions of the library differ in their tables: a method that is not there must not cost the others.
void add(std::vector<Method>& all, const SundialsFacts& facts, const sundials::Method& choice) {
  try {
    all.push_back(line(facts, choice));
  } catch (const std::invalid_argument& missing) {
    left_out().emplace_back(facts.id, missing.what());
  }
}

}  // namespace

void add_arkode_dirk(std::vector<Method>& all, const char* id, int implicit_table) {
  add(all, {id, 2, 2, 2}, {.package = Package::dirk, .implicit_table = implicit_table});
}

std::string why_left_out(std::string_view id) {
  for (const auto& [method, missing] : left_out())
    if (method == id)
      return fmt::format(
          "{} needs a table that this build lacks: {}; take another method, or build hmax with another "
          "version of SUNDIALS",
          method, missing);
  return {};
}

void add_cvode(std::vector<Method>& all) {
  add(all, {"cvode_adams", 0, 2, 1}, {.package = Package::cvode_adams});
  add(all, {"cvode_bdf", 0, 2, 1}, {.package = Package::cvode_bdf});
}

void add_arkode(std::vector<Method>& all) {
  const auto erk = [&](const SundialsFacts& facts, ARKODE_ERKTableID table) {
    add(all, facts, {.package = Package::erk, .explicit_table = table});
  };
  erk({"arkode_erk_heun_euler_212", 2, 2, 2}, ARKODE_HEUN_EULER_2_1_2);
  erk({"arkode_erk_bogacki_shampine_423", 3, 3, 4}, ARKODE_BOGACKI_SHAMPINE_4_2_3);
  erk({"arkode_erk_zonneveld_534", 4, 4, 5}, ARKODE_ZONNEVELD_5_3_4);
  erk({"arkode_erk_sayfy_aburub_634", 4, 4, 6}, ARKODE_SAYFY_ABURUB_6_3_4);
  erk({"arkode_erk_cash_karp_645", 5, 5, 6}, ARKODE_CASH_KARP_6_4_5);
  erk({"arkode_erk_fehlberg_645", 5, 5, 6}, ARKODE_FEHLBERG_6_4_5);
  erk({"arkode_erk_dormand_prince_745", 5, 5, 7}, ARKODE_DORMAND_PRINCE_7_4_5);
  erk({"arkode_erk_verner_856", 6, 6, 8}, ARKODE_VERNER_8_5_6);
  erk({"arkode_erk_fehlberg_13_7_8", 8, 8, 13}, ARKODE_FEHLBERG_13_7_8);

  const auto dirk = [&](const SundialsFacts& facts, ARKODE_DIRKTableID table) {
    add(all, facts, {.package = Package::dirk, .implicit_table = table});
  };
  dirk({"arkode_dirk_sdirk_212", 2, 2, 2, true}, ARKODE_SDIRK_2_1_2);
  dirk({"arkode_dirk_billington_332", 2, 3, 3, true, true}, ARKODE_BILLINGTON_3_3_2);
  dirk({"arkode_dirk_trbdf2_332", 2, 3, 3, true, true}, ARKODE_TRBDF2_3_3_2);
  dirk({"arkode_dirk_kvaerno_423", 3, 3, 4, true, true}, ARKODE_KVAERNO_4_2_3);
  dirk({"arkode_dirk_ark324l2sa", 3, 3, 4, true, true}, ARKODE_ARK324L2SA_DIRK_4_2_3);
  dirk({"arkode_dirk_sdirk_534", 4, 4, 5, true, true}, ARKODE_SDIRK_5_3_4);
  dirk({"arkode_dirk_kvaerno_534", 4, 4, 5, true}, ARKODE_KVAERNO_5_3_4);
  dirk({"arkode_dirk_ark436l2sa", 4, 4, 6, true, true}, ARKODE_ARK436L2SA_DIRK_6_3_4);
  dirk({"arkode_dirk_kvaerno_745", 5, 5, 7, true, true}, ARKODE_KVAERNO_7_4_5);
  dirk({"arkode_dirk_ark548l2sa", 5, 5, 8, true, true}, ARKODE_ARK548L2SA_DIRK_8_4_5);

  const auto imex = [&](const SundialsFacts& facts, ARKODE_DIRKTableID implicit_table,
                        ARKODE_ERKTableID explicit_table) {
    add(all, facts,
        {.package = Package::imex, .explicit_table = explicit_table, .implicit_table = implicit_table});
  };
  // Their stability is that of the half that is declared stiff.
  imex({"arkode_imex_ark324l2sa", 3, 3, 4, true, true}, ARKODE_ARK324L2SA_DIRK_4_2_3,
       ARKODE_ARK324L2SA_ERK_4_2_3);
  imex({"arkode_imex_ark436l2sa", 4, 4, 6, true, true}, ARKODE_ARK436L2SA_DIRK_6_3_4,
       ARKODE_ARK436L2SA_ERK_6_3_4);
  imex({"arkode_imex_ark548l2sa", 5, 5, 8, true, true}, ARKODE_ARK548L2SA_DIRK_8_4_5,
       ARKODE_ARK548L2SA_ERK_8_4_5);

  add(all, {"arkode_mri", 3, 0, 3}, {.package = Package::mri});
}

}  // namespace hmax

#else

namespace hmax {
void add_cvode(std::vector<Method>&) {}
void add_arkode(std::vector<Method>&) {}
void add_arkode_dirk(std::vector<Method>&, const char*, int) {}
std::string why_left_out(std::string_view) { return {}; }
}  // namespace hmax

#endif
