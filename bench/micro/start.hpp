/// How the programs of this folder begin, and collect their times.
#pragma once

#include <cstring>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

namespace hmax::micro {

/// Hands the command line to Google Benchmark behind defaults, which later flags win over. Repetitions of all
/// measurements are mixed at random: a slow minute of the machine meets both sides.
/// @returns whether --ratios is given, the table alone; nothing when there are flags that nobody knows
inline std::optional<bool> start(int argc, char** argv, int repetitions, double min_seconds) {
  std::vector<std::string> arguments{argv[0], "--benchmark_enable_random_interleaving=true",
                                     "--benchmark_repetitions=" + std::to_string(repetitions),
                                     "--benchmark_min_time=" + std::to_string(min_seconds)};
  bool ratios = false;
  for (int i = 1; i < argc; ++i)
    if (std::strcmp(argv[i], "--ratios") == 0)
      ratios = true;
    else
      arguments.emplace_back(argv[i]);
  std::vector<char*> raw;
  for (std::string& argument : arguments) raw.push_back(argument.data());
  int count = static_cast<int>(raw.size());
  raw.push_back(nullptr);
  benchmark::Initialize(&count, raw.data());
  if (benchmark::ReportUnrecognizedArguments(count, raw.data())) return std::nullopt;
  return ratios;
}

/// Keeps the times of all repetitions; prints them as well unless only the table is wanted.
class Collector : public benchmark::ConsoleReporter {
 public:
  explicit Collector(bool quiet) : quiet_(quiet) {}

  std::map<std::string, std::vector<double>> seconds;  ///< CPU time of a run in each repetition, by benchmark

  bool ReportContext(const Context& context) override {
    return quiet_ || ConsoleReporter::ReportContext(context);
  }
  void ReportRuns(const std::vector<Run>& runs) override {
    for (const Run& run : runs)
      if (run.run_type == Run::RT_Iteration)
        seconds[run.run_name.function_name].push_back(run.cpu_accumulated_time /
                                                      static_cast<double>(run.iterations));
    if (!quiet_) ConsoleReporter::ReportRuns(runs);
  }

 private:
  bool quiet_;
};

}  // namespace hmax::micro
