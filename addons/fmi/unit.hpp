/// A unit of FMI 2.0 in use.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "addons/fmi/unit_file.hpp"

namespace hmax::fmi {

/// Its library is loaded, and one instance initialised. States are set as the standard permits: those of
/// model exchange at any time, those of co-simulation before a new initialisation at the time that it has
/// come to.
/// @throws Failure  from every function
class Unit {
 public:
  /// @param type  nothing: co-simulation where the unit is of this type
  Unit(const std::string& file, std::optional<Type> type);
  ~Unit();
  Unit(const Unit&) = delete;
  Unit& operator=(const Unit&) = delete;

  [[nodiscard]] const UnitFile& file() const { return file_; }
  [[nodiscard]] Type type() const { return type_; }
  [[nodiscard]] std::size_t dim() const { return file_.states.size(); }
  [[nodiscard]] double time() const { return t_; }

  void state(double* y);
  void set_state(double t, const double* y);
  /// By its own method, or of model exchange by explicit Euler. @returns whether it can be done
  bool step(double h);
  /// Of model exchange. @returns whether they can be evaluated
  bool derivatives(double t, const double* y, double* dydt);

 private:
  void initialise(double t, const double* y);
  void check_that_states_are_set();
  [[noreturn]] static void fail(const std::string& function, const std::string& how);
  [[nodiscard]] bool is_done(const char* function, Status status);
  /// Calls a function with this instance. @returns whether it can be done with these values
  template <class Call, class... Values>
  [[nodiscard]] bool can(const Call& call, Values... values) {
    return is_done(call.name(), call(instance_, values...));
  }
  /// The same. @throws Failure  where it cannot
  template <class Call, class... Values>
  void must(const Call& call, Values... values) {
    if (!can(call, values...)) fail(call.name(), "failed");
  }

  UnitFile file_;
  Type type_;
  Functions call_;
  Callbacks callbacks_;
  std::string resources_;
  std::vector<Reference> references_;  ///< of the states
  Instance instance_ = nullptr;
  bool is_new_ = true, has_failed_ = false;
  double t_ = 0;
  std::vector<double> y_, rate_;  ///< of model exchange
};

}  // namespace hmax::fmi
