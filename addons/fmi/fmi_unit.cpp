/// Units of FMI 2.0 as a stepper and as a model behind hmax/plugin.h: a child process of hmax opens this
/// module.
#include <algorithm>
#include <cctype>
#include <limits>
#include <memory>
#include <optional>
#include <string>

#include "addons/fmi/unit.hpp"
#include "addons/stepper.hpp"

namespace hmax::fmi {
namespace {

using engines::guarded;

char name[65] = "unit";

struct Stepper : Unit {
  using Unit::Unit;
  void set_state(const double* y) { Unit::set_state(time(), y); }
  [[nodiscard]] double own_step() const { return file().step; }
  /// The time, and the state.
  [[nodiscard]] std::size_t saved_size() const { return 1 + dim(); }
  void save(double* numbers) {
    numbers[0] = time();
    state(numbers + 1);
  }
  void restore(const double* numbers) { Unit::set_state(numbers[0], numbers + 1); }
};
using Calls = engines::StepperCalls<Stepper>;

extern hmax_stepper stepper;
extern hmax_plugin_entry entries[2];

/// The entries of this process get the name of the unit, and what it does without is taken out of its table.
int create(const char* file, std::optional<Type> type, void** handle) {
  return guarded([&] {
    auto unit = std::make_unique<Stepper>(file, type);
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

int start(void* handle, double* y0, double* t_end) {
  *t_end = Calls::of(handle).file().end - Calls::of(handle).file().start;
  return Calls::state(handle, y0);
}
const char* state_name(void* handle, std::size_t i) {
  return Calls::of(handle).file().states[i].name.c_str();
}
/// Beyond where the unit can be evaluated, nothing is a number.
int rhs(void* handle, double t, const double* y, double* dydt) {
  return guarded([&] {
    Unit& unit = Calls::of(handle);
    if (!unit.derivatives(unit.file().start + t, y, dydt))
      std::fill_n(dydt, unit.dim(), std::numeric_limits<double>::quiet_NaN());
    return true;
  });
}

hmax_stepper stepper = Calls::table(create_stepper);
const hmax_model model{.object = {create_model, Calls::destroy, Calls::error_text, Calls::dimension},
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
