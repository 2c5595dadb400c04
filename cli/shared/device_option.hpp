/// The options --device and --precision of `hmax run`.
#pragma once

#include <initializer_list>
#include <string>
#include <utility>

#include <nlohmann/json.hpp>

#include "catalogue/device/device_run.hpp"
#include "cli/shared/options.hpp"

namespace hmax {

struct DeviceChoice {
  std::string name, precision_name;

  void add_to(CLI::App& command);
  [[nodiscard]] bool is_gpu() const { return name == "gpu"; }
  [[nodiscard]] Precision precision() const {
    return precision_name == "single" ? Precision::single_precision : Precision::double_precision;
  }
  /// @param beside  other options, and whether they are given, that a GPU does not take
  /// @throws InputError  for words that are none, a precision without a GPU, for one of these, and for what a
  /// GPU does not run
  void check(std::initializer_list<std::pair<const char*, bool>> beside, const Problem& problem,
             const Method& method, const RunSpec& spec) const;
};

/// What the steps of a run on a device took, and on which: never a CPU time.
struct DeviceTime {
  DeviceFacts facts;
  Precision precision = Precision::double_precision;
  double seconds = 0, flops = 0, bytes = 0;  ///< see DeviceRun

  /// Puts it into the document of a run, whose `cpu_seconds` become null.
  void add_to(nlohmann::ordered_json& document) const;
  [[nodiscard]] std::string words() const;
  [[nodiscard]] const char* precision_word() const {
    return precision == Precision::single_precision ? "single" : "double";
  }
};

}  // namespace hmax
