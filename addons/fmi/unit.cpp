#include "addons/fmi/unit.hpp"

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <dlfcn.h>
#include <utility>

namespace hmax::fmi {
namespace {

/// The last message of the unit.
std::string said;

void log(void*, const char*, Status status, const char*, const char* message, ...) {
  if (status == Status::ok || !message) return;
  char text[300];
  va_list values;
  va_start(values, message);
  std::vsnprintf(text, sizeof text, message, values);
  va_end(values);
  said = text;
  std::ranges::replace(said, '\n', ' ');
}

Type type_of(const UnitFile& file, std::optional<Type> wanted) {
  const bool exchanges = !file.offer(Type::model_exchange).identifier.empty(),
             steps = !file.offer(Type::co_simulation).identifier.empty();
  const Type type = wanted.value_or(steps ? Type::co_simulation : Type::model_exchange);
  if (file.offer(type).identifier.empty())
    throw Failure{steps ? "it is of co-simulation alone, without equations to call; use `hmax probe` for it"
                        : "it is neither of model exchange nor of co-simulation; export it again"};
  if (file.offer(type).needs_tool)
    throw Failure{"it runs in the program that exported it alone; export it without (needsExecutionTool)"};
  for (const UnitFile::State& each : file.states)
    if (type == Type::co_simulation && !each.has_start)
      throw Failure{"its state '" + each.name + "' is calculated at the start and cannot be set; " +
                    (exchanges ? "ask of its equations: hmax stability predict --plugin UNIT.fmu"
                               : "export it with a start value, or for model exchange")};
  return type;
}

void* library_of(const UnitFile& file, Type type) {
  const std::string name = file.offer(type).identifier + ".so";
  const std::filesystem::path library = file.folder / "binaries" / "linux64" / name;
  if (name.find('/') != name.npos || !std::filesystem::exists(library))
    throw Failure{"it has no binaries/linux64/" + name + "; export it for Linux, 64 bits"};
  void* const opened = dlopen(library.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (!opened) throw Failure{"its library cannot be loaded: " + std::string(dlerror())};
  return opened;
}

}  // namespace

Unit::Unit(const std::string& file, std::optional<Type> type)
    : file_(open_unit(file)),
      type_(type_of(file_, type)),
      call_{library_of(file_, type_)},
      callbacks_{log, std::calloc, std::free, nullptr, nullptr},
      resources_("file://" + (file_.folder / "resources").string()),
      y_(dim()),
      rate_(dim()) {
  for (const UnitFile::State& each : file_.states) references_.push_back(each.reference);
  std::filesystem::create_directories(file_.folder / "resources");
  instance_ = call_.instantiate("hmax", type_, file_.guid.c_str(), resources_.c_str(), &callbacks_, 0, 0);
  if (!instance_) fail(call_.instantiate.name(), "made no instance");
  initialise(file_.start, nullptr);
  if (type_ == Type::co_simulation)
    check_that_states_are_set();
  else
    must(call_.get_states, y_.data(), dim());
}

Unit::~Unit() { call_.free_instance(instance_); }

void Unit::fail(const std::string& function, const std::string& how) {
  throw Failure{function + "() " + how + (said.empty() ? "" : ": " + said)};
}

/// After an error it takes a new initialisation to go on.
bool Unit::is_done(const char* function, Status status) {
  if (status == Status::ok || status == Status::warning) return true;
  if (status == Status::error) has_failed_ = true;
  if (status != Status::error && status != Status::discard)
    fail(function, "ended with status " + std::to_string(static_cast<int>(status)));
  return false;
}

/// [blochwitz2012functional]. @param y  nothing: the start values of the unit
void Unit::initialise(double t, const double* y) {
  if (!std::exchange(is_new_, false)) must(call_.reset);
  has_failed_ = false;
  must(call_.setup_experiment, 0, 0, t, 0, 0);
  if (y) must(call_.set_real, references_.data(), dim(), y);
  must(call_.enter_initialization);
  must(call_.exit_initialization);
  t_ = t;
  if (type_ == Type::co_simulation) return;
  EventInfo event{};
  constexpr int most_rounds = 1000;
  for (int round = 0; round == 0 || event.new_discrete_states_needed; ++round) {
    must(call_.new_discrete_states, &event);
    if (event.terminate_simulation || round == most_rounds)
      throw Failure{"it ends at its start, or finds no discrete states there"};
  }
  must(call_.enter_continuous_time);
}

void Unit::check_that_states_are_set() {
  constexpr double rounding = 1e-6;  // of a unit that computes in float
  state(y_.data());
  std::vector<double> moved = y_, there(dim());
  for (double& each : moved) each += 1e-3 * std::max(1.0, std::abs(each));
  initialise(file_.start, moved.data());
  state(there.data());
  for (std::size_t i = 0; i < dim(); ++i)
    if (!(std::abs(there[i] - moved[i]) <= rounding * std::max(1.0, std::abs(moved[i]))))
      throw Failure{"its state '" + file_.states[i].name + "' does not take the start value that is set; " +
                    "export it for model exchange"};
  initialise(file_.start, y_.data());
}

void Unit::state(double* y) {
  if (type_ == Type::co_simulation)
    must(call_.get_real, references_.data(), dim(), y);
  else
    std::ranges::copy(y_, y);
}

void Unit::set_state(double t, const double* y) {
  if (type_ == Type::co_simulation) return initialise(t, y);
  t_ = t;
  std::copy_n(y, dim(), y_.begin());
}

bool Unit::step(double h) {
  if (type_ == Type::co_simulation) {
    if (!can(call_.do_step, t_, h, 0)) return false;
  } else {
    if (!derivatives(t_, y_.data(), rate_.data())) return false;
    for (std::size_t i = 0; i < dim(); ++i) y_[i] += h * rate_[i];
  }
  t_ += h;
  return true;
}

bool Unit::derivatives(double t, const double* y, double* dydt) {
  if (has_failed_) initialise(t, nullptr);
  return can(call_.set_time, t) && can(call_.set_states, y, dim()) && can(call_.get_derivatives, dydt, dim());
}

}  // namespace hmax::fmi
