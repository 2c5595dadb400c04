#include "cli/shared/device_option.hpp"

#include <array>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "catalogue/device/device_method.hpp"
#include "catalogue/methods/catalogue.hpp"
#include "cli/shared/console.hpp"
#include "core/errors.hpp"
#include "core/numbers.hpp"

namespace hmax {

namespace {
constexpr std::array<std::string_view, 2> device_names{"cpu", "gpu"}, precision_names{"single", "double"};

/// Whether a GPU steps the problem by the method as it is asked to.
bool runs_on_device(const Problem& problem, const Method& method, const DeviceChoice& choice, bool adaptive) {
  if (!suits(method, problem) || !unsuited_for_device(problem, method).empty()) return false;
  if (adaptive && !method.adaptive()) return false;
  try {
    device_method(method)->check(choice.precision() == Precision::double_precision, choice.bodies(),
                                 adaptive);
    return true;
  } catch (const InputError&) {
    return false;
  }
}

/// The methods that a GPU runs in place of another, in words; empty without one.
std::string others_on_device(const Problem& problem, const DeviceChoice& choice, bool adaptive) {
  const auto runs = [&](const char* id) {
    return runs_on_device(problem, find_method(id), choice, adaptive);
  };
  std::vector<std::string> others;
  for (const char* id : {"symplectic_euler", "velocity_verlet", "stormer_verlet", "central_difference",
                         "rkc_2", "rkl_2", "newton_truncated", "vbd", "xpbd", "pbd"})
    if (runs(id)) others.emplace_back(id);
  std::string words = fmt::format("{}", fmt::join(others, ", "));
  if (const char* id = adaptive ? "ode45" : "rk4"; runs(id))
    words +=
        fmt::format("{}an explicit Runge-Kutta method of hmax such as {}", words.empty() ? "" : " or ", id);
  return words;
}

}  // namespace

void DeviceChoice::add_to(CLI::App& command, std::string_view what) {
  add_text(
      command, "--device", name,
      fmt::format("Where {} run: cpu or gpu, with the same bits and times of its own; cpu by default", what),
      "NAME");
}

void DeviceChoice::add_kinds_to(CLI::App& command) {
  add_text(command, "--precision", precision_name,
           "Numbers of --device gpu: single, which err by some 1e-6 to 1e-5, or double; double by default",
           "NAME");
  add_text(command, "--bodies", bodies_text,
           "Copies of the body that --device gpu steps at the same time; 1 by default", "NUMBER");
}

std::int32_t DeviceChoice::bodies() const {
  constexpr std::int64_t most = 1'000'000;
  if (bodies_text.empty()) return 1;
  const std::int64_t count = parse_count("--bodies", bodies_text, 1);
  if (count > most) throw InputError(fmt::format("--bodies takes up to {}; give a smaller number", most));
  return static_cast<std::int32_t>(count);
}

std::unique_ptr<Device> DeviceChoice::open() const { return is_gpu() ? open_gpu() : nullptr; }

std::shared_ptr<Device> DeviceChoice::place(const std::vector<Problem>& problems,
                                            std::vector<Method>& methods,
                                            std::vector<LeftOut>& left_out) const {
  std::vector<Method*> run;
  for (Method& method : methods) {
    std::string why;
    for (const Problem& problem : problems) {
      if (why.empty() && method.unsuited) why = method.unsuited(problem);
      if (why.empty()) why = unsuited_for_device(problem, method);
    }
    if (why.empty())
      run.push_back(&method);
    else
      left_out.push_back({method.id, std::move(why)});
  }
  if (run.empty())
    throw InputError(
        fmt::format("--device gpu runs none of these methods: {} {}; leave --device out, or name others",
                    left_out.front().id, left_out.front().why));
  std::shared_ptr<Device> device = open_gpu();
  for (Method* const method : run) *method = on_device(std::move(*method), device);
  return device;
}

void DeviceChoice::check(std::initializer_list<std::pair<const char*, bool>> beside) const {
  if (!name.empty()) parse_choice("--device", name, device_names);
  if (!precision_name.empty()) parse_choice("--precision", precision_name, precision_names);
  if (precision() == Precision::single_precision && !is_gpu())
    throw InputError("--precision single is for --device gpu; leave it out, or give both");
  if (bodies() > 1 && !is_gpu()) throw InputError("--bodies is for --device gpu; leave it out, or give both");
  if (!is_gpu()) return;
  for (const auto& [option, given] : beside)
    if (given) throw InputError(fmt::format("--device gpu does not take {}; leave one of them out", option));
}

void DeviceChoice::check(std::initializer_list<std::pair<const char*, bool>> beside, const Problem& problem,
                         const Method& method, bool adaptive) const {
  check(beside);
  if (!is_gpu()) return;
  const std::string why = unsuited_for_device(problem, method);
  if (why.empty())
    return device_method(method)->check(precision() == Precision::double_precision, bodies(), adaptive);
  const std::string others = others_on_device(problem, *this, adaptive);
  throw InputError(fmt::format("{} {}; leave --device out{}", method.id, why,
                               others.empty() ? "" : fmt::format(", or take {}", others)));
}

void DeviceTime::add_to(Json& document) const {
  if (document.contains("cpu_seconds")) document["cpu_seconds"] = nullptr;
  document["device"] = facts.name;
  document["clock_mhz"] = facts.clock_mhz;
  document["driver"] = facts.driver;
  document["precision"] = precision_word();
  document["device_seconds"] = seconds;
  if (bodies > 1) document["bodies"] = bodies;
  if (flops > 0)
    document["roofline"] = {
        {"flops_per_step", flops},
        {"bytes_per_step", bytes},
        {"flops_per_second", precision == Precision::single_precision ? facts.single_flops : facts.flops},
        {"bytes_per_second", facts.bytes}};
}

std::string DeviceTime::words() const {
  return fmt::format("   device {} s on {}, {} MHz, {}, {} precision{}", short_number(seconds, 3), facts.name,
                     short_number(facts.clock_mhz, 4), facts.driver, precision_word(),
                     bodies > 1 ? fmt::format(", {} bodies at a time", bodies) : "");
}

}  // namespace hmax
