#include "bench/plugin/plugin_stepper.hpp"

#include <limits>

#include <fmt/format.h>

#include "results/errors.hpp"

namespace hmax {
namespace {

std::span<const double> numbers_of(const Eigen::VectorXd& y) { return {y.data(), static_cast<std::size_t>(y.size())}; }
std::span<double> numbers_of(Eigen::VectorXd& y) { return {y.data(), static_cast<std::size_t>(y.size())}; }

}  // namespace

PluginStepper::PluginStepper(PluginName plugin, PluginSettings settings) : process_(std::move(plugin), std::move(settings)) {
  if (process_.facts().greeting.is_stepper == 0)
    throw InputError(fmt::format("'{}' of the plugin is a model and has no step of its own; name a stepper",
                                 process_.facts().name));
  // Overlaps are told before anything is computed.
  try {
    StateCoordinates(dim(), quaternions());
  } catch (const std::invalid_argument& error) {
    throw InputError(fmt::format("the plugin: {}", error.what()));
  }
}

std::string PluginStepper::name() const {
  const PluginName& plugin = process_.plugin();
  return plugin.argument.empty() ? process_.facts().name : fmt::format("{}:{}", process_.facts().name, plugin.argument);
}

Eigen::VectorXd PluginStepper::state() {
  Eigen::VectorXd y(dim());
  process_.ask({.ask = PluginAsk::state}, {}, numbers_of(y));
  return y;
}

void PluginStepper::set_state(const Eigen::VectorXd& y) { process_.ask({.ask = PluginAsk::set_state}, numbers_of(y), {}); }

bool PluginStepper::step(double h, std::int64_t count) {
  return process_.ask({.ask = PluginAsk::steps, .count = static_cast<std::uint64_t>(count), .h = h}, {}, {});
}

void PluginStepper::save(int slot) {
  process_.ask({.ask = PluginAsk::save, .slot = static_cast<std::uint32_t>(slot)}, {}, {});
}

void PluginStepper::restore(int slot) {
  process_.ask({.ask = PluginAsk::restore, .slot = static_cast<std::uint32_t>(slot)}, {}, {});
}

Eigen::VectorXd PluginStepper::after(int slot, const Eigen::VectorXd& y, double h, std::int64_t count) {
  Eigen::VectorXd next(dim());
  const PluginRequest request{.ask = PluginAsk::after,
                              .slot = static_cast<std::uint32_t>(slot),
                              .count = static_cast<std::uint64_t>(count),
                              .h = h};
  if (!process_.ask(request, numbers_of(y), numbers_of(next)))
    next.setConstant(std::numeric_limits<double>::quiet_NaN());
  return next;
}

Eigen::VectorXd PluginStepper::advance(int slot, double h) {
  Eigen::VectorXd next(dim());
  const PluginRequest request{.ask = PluginAsk::advance, .slot = static_cast<std::uint32_t>(slot), .count = 1, .h = h};
  if (!process_.ask(request, {}, numbers_of(next))) next.setConstant(std::numeric_limits<double>::quiet_NaN());
  return next;
}

}  // namespace hmax
