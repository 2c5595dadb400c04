#include "bench/models/parameter_units.hpp"

#include <algorithm>
#include <span>
#include <utility>

#include <fmt/format.h>

namespace hmax {

namespace {

using Unit = std::pair<std::string_view, std::string_view>;

constexpr Unit of_oscillators[] = {{"m", "kg"},    {"c", "N s/m"}, {"k1", "N/m"},
                                   {"k3", "N/m³"}, {"P", "N"},     {"w", "rad/s"}};

// What is a share or a direction has the unit 1.
constexpr Unit of_bodies[] = {{"E", "Pa"},
                              {"rho", "kg/m³"},
                              {"mass", "kg"},
                              {"alpha", "1/s"},
                              {"beta", "s"},
                              {"damper", "s"},
                              {"g", "m/s²"},
                              {"gx", "m/s²"},
                              {"gy", "m/s²"},
                              {"gz", "m/s²"},
                              {"force", "N"},
                              {"depth", "m"},
                              {"period", "s"},
                              {"tool_radius", "m"},
                              {"tool_stiffness", "Pa/m^1.5"},
                              {"tool_damping", "s/m"},
                              {"tool_x", "m"},
                              {"tool_y", "m"},
                              {"tool_z", "m"},
                              {"skin_thickness", "m"},
                              {"k", "N/m"},
                              {"xmin", "m"},
                              {"xmax", "m"},
                              {"ymin", "m"},
                              {"ymax", "m"},
                              {"zmin", "m"},
                              {"zmax", "m"}};

}  // namespace

std::string with_unit(const Problem& problem, std::string_view parameter) {
  const std::string_view name = parameter.substr(0, parameter.find(':'));
  const bool body = problem.body != nullptr;
  if (!body && !std::holds_alternative<Oscillator>(problem.system)) return std::string(parameter);
  const std::span<const Unit> units = body ? std::span<const Unit>(of_bodies) : of_oscillators;
  const auto known = std::ranges::find(units, name, &Unit::first);
  return fmt::format("{} [{}]", parameter, known == units.end() ? "1" : known->second);
}

}  // namespace hmax
