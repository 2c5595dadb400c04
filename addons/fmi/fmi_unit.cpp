/// Units of FMI 2.0 as a stepper and as a model behind hmax/plugin.h: a child process of hmax opens this
/// module.
#include <algorithm>
#include <cctype>
#include <exception>
#include <limits>
#include <memory>
#include <string>

#include "addons/fmi/unit.hpp"
#include "catalogue/plugin/plugin.h"

namespace hmax::fmi {
namespace {

constexpr int failed = 2;

std::string reason;
char name[65] = "unit";

template <class Calls>
int guarded(const Calls& calls) {
  try {
    return calls() ? HMAX_OK : HMAX_DIVERGED;
  } catch (const Failure& failure) {
    reason = failure.text;
  } catch (const std::exception& error) {
    reason = error.what();
  }
  return failed;
}
Unit& of(void* handle) { return *static_cast<Unit*>(handle); }

int own_step(void* handle, double* h) {
  *h = of(handle).file().step;
  return HMAX_OK;
}

extern hmax_stepper stepper;
extern hmax_plugin_entry entries[2];

/// The entries of this process get the name of the unit, and what it does without is taken out of its table.
int create(const char* file, std::optional<Type> type, void** handle) {
  return guarded([&] {
    auto unit = std::make_unique<Unit>(file, type);
    const std::string& identifier = unit->file().offer(unit->type()).identifier;
    char* const end = name + identifier.copy(name, sizeof name - 1);
    *end = '\0';
    std::replace_if(
        name, end, [](unsigned char letter) { return !std::isalnum(letter); }, '_');
    if (!(unit->file().step > 0)) stepper.own_step = nullptr;
    entries[0].note = unit->type() == Type::co_simulation ? "FMI 2.0, co-simulation"
                                                          : "FMI 2.0, model exchange by explicit Euler";
    *handle = unit.release();
    return true;
  });
}
int create_stepper(const char* file, void** handle) { return create(file, std::nullopt, handle); }
int create_model(const char* file, void** handle) { return create(file, Type::model_exchange, handle); }
void destroy(void* handle) { delete &of(handle); }
const char* error_text(void*) { return reason.c_str(); }
int dimension(void* handle, std::size_t* n) {
  *n = of(handle).dim();
  return HMAX_OK;
}

int get_state(void* handle, double* y) {
  return guarded([&] { return of(handle).state(y), true; });
}
int set_state(void* handle, const double* y) {
  return guarded([&] { return of(handle).set_state(of(handle).time(), y), true; });
}
int step(void* handle, double h) {
  return guarded([&] { return of(handle).step(h); });
}

/// The time, and the state.
std::size_t saved_size(void* handle) { return sizeof(double) * (1 + of(handle).dim()); }
int save(void* handle, void* blob) {
  auto* const numbers = static_cast<double*>(blob);
  numbers[0] = of(handle).time();
  return get_state(handle, numbers + 1);
}
int restore(void* handle, const void* blob, std::size_t) {
  const auto* const numbers = static_cast<const double*>(blob);
  return guarded([&] { return of(handle).set_state(numbers[0], numbers + 1), true; });
}

int start(void* handle, double* y0, double* t_end) {
  *t_end = of(handle).file().end - of(handle).file().start;
  return get_state(handle, y0);
}
const char* state_name(void* handle, std::size_t i) { return of(handle).file().states[i].name.c_str(); }
/// Beyond where the unit can be evaluated, nothing is a number.
int rhs(void* handle, double t, const double* y, double* dydt) {
  return guarded([&] {
    Unit& unit = of(handle);
    if (!unit.derivatives(unit.file().start + t, y, dydt))
      std::fill_n(dydt, unit.dim(), std::numeric_limits<double>::quiet_NaN());
    return true;
  });
}

hmax_stepper stepper{.object = {create_stepper, destroy, error_text, dimension},
                     .flags = 0,
                     .get_state = get_state,
                     .set_state = set_state,
                     .step = step,
                     .saved_size = saved_size,
                     .save = save,
                     .restore = restore,
                     .quaternions = nullptr,
                     .scales = nullptr,
                     .couplings = nullptr,
                     .own_step = own_step,
                     .parts = nullptr,
                     .scale_part = nullptr};
const hmax_model model{.object = {create_model, destroy, error_text, dimension},
                       .start = start,
                       .rhs = rhs,
                       .jacobian = nullptr,
                       .mass = nullptr,
                       .force = nullptr,
                       .stiffness = nullptr,
                       .damping = nullptr,
                       .state_name = state_name};
hmax_plugin_entry entries[2]{
    {.name = name, .note = "", .model = nullptr, .stepper = &stepper},
    {.name = name, .note = "FMI 2.0, model exchange", .model = &model, .stepper = nullptr}};
const hmax_plugin plugin{HMAX_PLUGIN_VERSION, 2, entries};

}  // namespace
}  // namespace hmax::fmi

HMAX_PLUGIN_EXPORT const hmax_plugin* hmax_plugin_get(void) { return &hmax::fmi::plugin; }
