/// What FMI 2.0 declares of the functions of a unit, as far as they are called here
/// [blochwitz2012functional].
#pragma once

#include <cstddef>
#include <dlfcn.h>
#include <string>

#include "addons/stepper.hpp"

namespace hmax::fmi {

using engines::Failure;

enum class Status : int { ok, warning, discard, error, fatal, pending };
enum class Type : int { model_exchange, co_simulation };
using Instance = void*;
using Reference = unsigned int;  ///< of a variable
using Boolean = int;

struct Callbacks {
  void (*logger)(void* environment, const char* instance, Status, const char* category, const char* message,
                 ...);
  void* (*allocate)(std::size_t count, std::size_t size);
  void (*release)(void*);
  void (*step_finished)(void* environment, Status);
  void* environment;
};

struct EventInfo {
  Boolean new_discrete_states_needed, terminate_simulation, nominals_changed, states_changed,
      next_time_defined;
  double next_time;
};

/// A function of a library, by its name.
template <class Signature>
class Function;
template <class Result, class... Values>
class Function<Result(Values...)> {
 public:
  Function(void* library, const char* name)
      : name_(name), call_(reinterpret_cast<Result (*)(Values...)>(dlsym(library, name))) {}
  /// @throws Failure  where the library has none
  Result operator()(Values... values) const {
    if (!call_) throw Failure{std::string("its library has no function ") + name_ + "; export it again"};
    return call_(values...);
  }
  [[nodiscard]] const char* name() const { return name_; }

 private:
  const char* name_;
  Result (*call_)(Values...);
};

struct Functions {
  template <class... Values>
  using Of = Function<Status(Instance, Values...)>;
  using Text = const char*;

  void* library;
  Function<Instance(Text name, Type, Text guid, Text resources, const Callbacks*, Boolean visible,
                    Boolean logging)>
      instantiate{library, "fmi2Instantiate"};
  Function<void(Instance)> free_instance{library, "fmi2FreeInstance"};
  /// Whether there is a tolerance, and it; the start time; whether there is a stop time, and it.
  Of<Boolean, double, double, Boolean, double> setup_experiment{library, "fmi2SetupExperiment"};
  Of<> enter_initialization{library, "fmi2EnterInitializationMode"};
  Of<> exit_initialization{library, "fmi2ExitInitializationMode"};
  Of<> reset{library, "fmi2Reset"};
  Of<const Reference*, std::size_t, double*> get_real{library, "fmi2GetReal"};
  Of<const Reference*, std::size_t, const double*> set_real{library, "fmi2SetReal"};

  Of<EventInfo*> new_discrete_states{library, "fmi2NewDiscreteStates"};
  Of<> enter_continuous_time{library, "fmi2EnterContinuousTimeMode"};
  Of<double> set_time{library, "fmi2SetTime"};
  Of<const double*, std::size_t> set_states{library, "fmi2SetContinuousStates"};
  Of<double*, std::size_t> get_states{library, "fmi2GetContinuousStates"};
  Of<double*, std::size_t> get_derivatives{library, "fmi2GetDerivatives"};

  /// From a time on, a step size, and whether no earlier state is set again.
  Of<double, double, Boolean> do_step{library, "fmi2DoStep"};
};

}  // namespace hmax::fmi
