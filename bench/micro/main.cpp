// Measures the explicit methods of hmax and of Boost.Odeint in one process and prints their ratios.
#include <cmath>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include "bench/micro/ratios.hpp"
#include "bench/micro/start.hpp"
#include "problems/oscillator/oscillator_reference.hpp"
#include "results/fingerprint.hpp"

namespace hmax::micro {
namespace {

constexpr double t_end = 100;
constexpr Point start{0.5, 1};
constexpr double fixed_h = 0.005;
constexpr int tolerances_per_decade = 4;

std::vector<double> settings_of(Task task) {
  if (task != Task::dormand_prince_adaptive && task != Task::order_8_adaptive) return {fixed_h};
  std::vector<double> tolerances;
  for (int i = 2 * tolerances_per_decade; i <= 14 * tolerances_per_decade; ++i)
    tolerances.push_back(std::pow(10.0, -static_cast<double>(i) / tolerances_per_decade));
  return tolerances;
}

/// Everything but the time.
Measurement measure(const Engine& engine, double setting, const Oscillator& model,
                    const OscillatorReference& reference) {
  Measurement m{.engine = engine, .setting = setting};
  m.evaluations =
      static_cast<double>(engine.watched(model, t_end, setting, start, [&](double t, const Point& y) {
        if (t == 0) return;
        // The last steps of Odeint may end a rounding error beyond t_end.
        const Eigen::Vector2d exact = reference.at(std::min(t, t_end));
        m.error = std::max({m.error, std::abs(y[0] - exact[0]), std::abs(y[1] - exact[1])});
        ++m.steps;
      }));
  return m;
}

void time_runs(benchmark::State& state, const Measurement& m, const Oscillator& model) {
  for (auto _ : state) {
    Point y = start;
    m.engine.run(model, t_end, m.setting, y);
    benchmark::DoNotOptimize(y);
  }
  state.counters["error"] = m.error;
  state.counters["steps"] = m.steps;
  state.counters["rhs"] = m.evaluations;
}

int main_of(int argc, char** argv) {
  const auto ratios = micro::start(argc, argv, 25, 0.001);
  if (!ratios) return 2;

  const Oscillator model;
  const OscillatorReference reference(model.parameters(), {start[0], start[1]}, t_end);
  std::vector<Engine> engines = hmax_engines();
  for (const Engine& engine : odeint_engines()) engines.push_back(engine);

  std::vector<Measurement> measurements;
  std::vector<std::string> names;
  for (const Engine& engine : engines)
    for (const double setting : settings_of(engine.task)) {
      measurements.push_back(measure(engine, setting, model, reference));
      const bool fixed = setting == fixed_h;
      names.push_back(
          fmt::format("{}/{}/{}:{:.2e}", engine.side, engine.name, fixed ? "h" : "rtol", setting));
    }
  for (std::size_t i = 0; i < names.size(); ++i)
    benchmark::RegisterBenchmark(names[i].c_str(), [&, i](benchmark::State& state) {
      time_runs(state, measurements[i], model);
    })->Unit(benchmark::kMicrosecond);

  Collector collector(*ratios);
  benchmark::RunSpecifiedBenchmarks(&collector);
  benchmark::Shutdown();
  for (std::size_t i = 0; i < names.size(); ++i) measurements[i].seconds = collector.seconds[names[i]];
  fmt::print("\n{}\n{}\nOn top of these flags: hmax {}, Odeint {}.\n", ratio_table(measurements),
             summary(fingerprint()), HMAX_MICRO_OWN_FLAGS, HMAX_MICRO_ODEINT_FLAGS);
  return 0;
}

}  // namespace
}  // namespace hmax::micro

int main(int argc, char** argv) { return hmax::micro::main_of(argc, argv); }
