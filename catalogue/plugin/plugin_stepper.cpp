#include "catalogue/plugin/plugin_stepper.hpp"

#include <array>
#include <limits>

#include <fmt/format.h>

#include "core/input_error.hpp"

namespace hmax {
namespace {

std::span<const double> numbers_of(const Eigen::VectorXd& y) {
  return {y.data(), static_cast<std::size_t>(y.size())};
}
std::span<double> numbers_of(Eigen::VectorXd& y) { return {y.data(), static_cast<std::size_t>(y.size())}; }

}  // namespace

PluginStepper::PluginStepper(PluginName plugin, PluginSettings settings)
    : process_(std::move(plugin), std::move(settings)) {
  if (process_.facts().greeting.is_stepper == 0)
    throw input_error("'{}' of {} is a model and has no step of its own; name a stepper",
                      process_.facts().name, process_.plugin().subject);
  // Overlaps are told before anything is computed.
  try {
    if (!quaternions().empty()) StateCoordinates(dim(), quaternions());
  } catch (const std::invalid_argument& error) {
    throw input_error("{}: {}", process_.plugin().subject, error.what());
  }
}

std::string PluginStepper::name() const {
  const PluginName& plugin = process_.plugin();
  return plugin.argument.empty() ? process_.facts().name
                                 : fmt::format("{}:{}", process_.facts().name, plugin.argument);
}

Eigen::SparseMatrix<double> PluginStepper::pattern() const {
  const PluginFacts& facts = process_.facts();
  if (facts.groups.empty()) return {};
  std::vector<Eigen::Triplet<double>> entries;
  for (Eigen::Index i = 0; i < dim(); ++i) entries.emplace_back(i, i, 1);
  for (const auto& [one, other] : facts.couplings) {
    entries.emplace_back(one, other, 1);
    entries.emplace_back(other, one, 1);
  }
  using Sparse = Eigen::SparseMatrix<double>;
  Sparse neighbours(dim(), dim()), members(dim(), dim());
  neighbours.setFromTriplets(entries.begin(), entries.end(), [](double, double) { return 1.0; });
  entries.clear();
  for (Eigen::Index i = 0; i < dim(); ++i)
    entries.emplace_back(i, facts.groups[static_cast<std::size_t>(i)], 1);
  members.setFromTriplets(entries.begin(), entries.end());
  // What a step reaches of a group; half of all saves nothing any more.
  const double n = static_cast<double>(dim());
  Sparse reached = neighbours;
  for (double crossed = 1; crossed < facts.reach; ++crossed) {
    const Eigen::Index before = reached.nonZeros();
    reached = Sparse(reached * neighbours).unaryExpr([](double) { return 1.0; });
    if (reached.nonZeros() == before) break;
    if (static_cast<double>(reached.nonZeros()) > n * n / 2) return {};
  }
  return members * reached * Sparse(members.transpose());
}

Eigen::VectorXd PluginStepper::state() {
  Eigen::VectorXd y(dim());
  process_.ask({.ask = PluginAsk::state}, {}, numbers_of(y));
  return y;
}

void PluginStepper::set_state(const Eigen::VectorXd& y) {
  process_.ask({.ask = PluginAsk::set_state}, numbers_of(y), {});
}

bool PluginStepper::step(double h, std::int64_t count) {
  return process_.ask({.ask = PluginAsk::steps, .count = static_cast<std::uint64_t>(count), .h = h}, {}, {});
}

void PluginStepper::scale_part(std::size_t part, double stiffness, double damping) {
  const std::array<double, 2> factors{stiffness, damping};
  process_.ask({.ask = PluginAsk::scale_part, .count = part}, factors, {});
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
  const PluginRequest request{
      .ask = PluginAsk::advance, .slot = static_cast<std::uint32_t>(slot), .count = 1, .h = h};
  if (!process_.ask(request, {}, numbers_of(next)))
    next.setConstant(std::numeric_limits<double>::quiet_NaN());
  return next;
}

}  // namespace hmax
