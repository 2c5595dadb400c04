/// The options --device, --precision and --bodies.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "catalogue/device/device_run.hpp"
#include "catalogue/methods/choice/chosen_methods.hpp"
#include "cli/shared/options.hpp"
#include "results/json.hpp"

namespace hmax {

struct DeviceChoice {
  std::string name, precision_name, bodies_text;

  /// @param what  in its help: "fixed steps of a body"
  void add_to(CLI::App& command, std::string_view what);
  [[nodiscard]] bool is_gpu() const { return name == "gpu"; }
  /// --precision and --bodies of it
  void add_kinds_to(CLI::App& command);
  [[nodiscard]] Precision precision() const {
    return precision_name == "single" ? Precision::single_precision : Precision::double_precision;
  }
  /// How many run at a time. @throws InputError  for what is no such number
  [[nodiscard]] std::int32_t bodies() const;
  /// The first card; null where steps stay on the processor. @throws InputError as open_gpu()
  [[nodiscard]] std::unique_ptr<Device> open() const;
  /// Opens the card, and puts methods on it that it runs on all of the problems; the others stay where they
  /// are.
  /// @param left_out  becomes these, with the reason
  /// @throws InputError  as open_gpu(), and where it runs none of them
  [[nodiscard]] std::shared_ptr<Device> place(const std::vector<Problem>& problems,
                                              std::vector<Method>& methods,
                                              std::vector<LeftOut>& left_out) const;
  /// @throws InputError  for words that are none, a precision or bodies without a GPU, and for an option
  /// beside it that a GPU does not take
  void check(std::initializer_list<std::pair<const char*, bool>> beside) const;
  /// @param beside  other options, and whether they are given, that a GPU does not take
  /// @param adaptive  whether steps are chosen by their error
  /// @throws InputError  for words that are none, a precision or bodies without a GPU, for one of these, and
  /// for what a GPU does not run
  void check(std::initializer_list<std::pair<const char*, bool>> beside, const Problem& problem,
             const Method& method, bool adaptive) const;
};

/// What the steps of a run on a device took, and on which: never a CPU time.
struct DeviceTime {
  DeviceFacts facts;
  double seconds = 0, flops = 0, bytes = 0;  ///< see DeviceRun; of motions in the plane the seconds alone
  Precision precision = Precision::double_precision;
  std::int32_t bodies = 1;  ///< that it has stepped at a time

  /// Puts it into a document, whose `cpu_seconds`, if there are, become null.
  void add_to(Json& document) const;
  [[nodiscard]] std::string words() const;
  [[nodiscard]] const char* precision_word() const {
    return precision == Precision::single_precision ? "single" : "double";
  }
};

}  // namespace hmax
