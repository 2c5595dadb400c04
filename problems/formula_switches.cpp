#include "problems/formula_switches.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace hmax {
namespace {

using Id = FormulaNodeId;

/// The nodes that the roots depend on; those below a product with zero are left out.
std::vector<bool> acting_below(const FormulaGraph& graph, const std::vector<Id>& roots) {
  std::vector<bool> acting(graph.size(), false);
  for (const Id root : roots) acting[static_cast<std::size_t>(root)] = true;
  for (std::size_t i = acting.size(); i-- > 0;) {
    const auto id = static_cast<Id>(i);
    const FormulaDependence& of = graph.dependence(id);
    if (!of.on_time && !of.on_state) acting[i] = false;
    if (!acting[i]) continue;
    graph[id].each_operand([&](Id operand) { acting[static_cast<std::size_t>(operand)] = true; });
  }
  return acting;
}

/// A node that is constant in pieces, and changes where `id` switches; -1 for operations that do not switch.
Id indicator_of(FormulaGraph& graph, Id id) {
  using enum FormulaOp;
  const FormulaNode n = graph[id];
  if (less <= n.op && n.op <= maximum) return graph.make(sign, graph.make(subtract, n.a, n.b));
  if (n.op == abs || n.op == sign) return graph.make(sign, n.a);
  return n.op == rint ? id : -1;
}

bool oscillates(FormulaOp op) {
  return op == FormulaOp::sin || op == FormulaOp::cos || op == FormulaOp::tan || op == FormulaOp::rint;
}

/// Equal, or both not a number: an indicator without a value does not switch while it has none.
bool same(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }

constexpr double samples_per_half_period = 8, least_samples = 1024, most_samples = 200'000;

}  // namespace

FormulaSwitches::FormulaSwitches(FormulaGraph& graph, const std::vector<Id>& roots, int states)
    : still_(static_cast<std::size_t>(states), 0.0) {
  const std::vector<bool> acting = acting_below(graph, roots);
  std::vector<Id> arguments;
  std::vector<double> scales;
  for (std::size_t i = 0; i < acting.size(); ++i) {
    const auto id = static_cast<Id>(i);
    if (!acting[i] || !graph.dependence(id).on_time || graph.dependence(id).on_state) continue;
    if (const Id indicator = indicator_of(graph, id); indicator >= 0)
      indicators_.emplace_back(graph, std::vector<Id>{indicator}, states);
    if (const FormulaNode n = graph[id]; oscillates(n.op)) {
      arguments.push_back(n.a);
      scales.push_back(n.op == FormulaOp::rint ? 1 : std::numbers::inv_pi);
    }
  }
  if (indicators_.empty()) return;
  const std::vector<Id> slopes = time_slopes(graph, arguments);
  for (std::size_t i = 0; i < slopes.size(); ++i) {
    const Id rate = graph.make(FormulaOp::multiply, slopes[i], graph.constant(scales[i]));
    rates_.emplace_back(graph, std::vector<Id>{rate}, states);
  }
}

double FormulaSwitches::value(const FormulaProgram& program, double t) const {
  double result = 0;
  program.run(t, still_.data(), &result);
  return result;
}

double FormulaSwitches::sampling(double t0, double t1) const {
  double fastest = 0;
  constexpr int looks = 64;
  for (const FormulaProgram& rate : rates_)
    for (int i = 0; i <= looks; ++i) {
      const double here = std::abs(value(rate, t0 + (t1 - t0) * i / looks));
      if (std::isfinite(here)) fastest = std::max(fastest, here);
    }
  return 1 / (samples_per_half_period * fastest + least_samples / (t1 - t0));
}

std::vector<double> FormulaSwitches::between(double t0, double t1) const {
  if (indicators_.empty() || !(t0 < t1) || !std::isfinite(t1 - t0)) return {};
  const double spacing = sampling(t0, t1);
  const double samples = std::min(std::ceil((t1 - t0) / spacing), most_samples);
  std::vector<double> mesh;
  for (double i = 0; i <= samples; ++i)
    mesh.push_back(samples < most_samples ? t0 + (t1 - t0) * (i / samples) : t0 + spacing * i);
  std::vector<double> times;
  for (const FormulaProgram& indicator : indicators_) {
    std::vector<double> found;
    double low = value(indicator, mesh.front());
    for (std::size_t i = 1; i < mesh.size(); ++i) {
      const double high = value(indicator, mesh[i]);
      double before = mesh[i - 1], after = mesh[i];
      while (!same(high, low)) {
        const double middle = before + (after - before) / 2;
        if (!(before < middle && middle < after)) break;
        (same(value(indicator, middle), low) ? before : after) = middle;
      }
      if (!same(high, low)) found.push_back(after);
      low = high;
    }
    // What this one decides may jump there: others are looked at on both sides.
    for (const double t : found) {
      times.push_back(t);
      mesh.push_back(t);
      mesh.push_back(std::nextafter(t, t0));
    }
    std::ranges::sort(mesh);
  }
  std::ranges::sort(times);
  // One switch may be seen as two neighbouring numbers, or at t0.
  std::vector<double> apart;
  const double rounding = 8 * std::numeric_limits<double>::epsilon() * std::max(std::abs(t0), std::abs(t1));
  double last = t0;
  for (const double t : times)
    if (t - last > rounding && t < t1) apart.push_back(last = t);
  return apart;
}

}  // namespace hmax
