/// How the programs of this folder begin.
#pragma once

#include <cstring>
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

}  // namespace hmax::micro
