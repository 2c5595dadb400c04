/// One limit of the work that a command takes on, stated with its estimate before anything is computed.
#pragma once

#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

#include "cli/shared/options.hpp"

namespace hmax {

/// Elapsed time that a command without --max-steps takes on unless --time-limit says otherwise [s].
inline constexpr double default_time_limit = 300;

/// What is asked for, as far as it is known beforehand.
struct Work {
  std::string asked;  ///< "--motion 2147483648 with --h0 0.0001"
  double count = 0;   ///< of steps, or whatever `of` names
  std::string_view of = "steps";
  double seconds_each = 0;                                      ///< elapsed, about [s]
  double most_count = std::numeric_limits<double>::infinity();  ///< no more are taken on, however fast
  double most_seconds = default_time_limit;                     ///< [s]
  std::string remedy;  ///< "take a larger --h0 or a shorter --motion"
};

/// @throws InputError  for more than the limits, naming the estimate and the remedy
void refuse_endless(const Work& work);

/// "3.2 s", "5 min", "2.5 h", "40 days", "3e+03 years"
std::string duration_in_words(double seconds);

/// --time-limit: work that is estimated to take longer is refused.
void add_time_limit(CLI::App& command, std::optional<double>& seconds);
/// The limit that is given, or the default. @throws InputError  unless it is above 0
double time_limit_of(const std::optional<double>& seconds);

/// Elapsed time of a call [s], for estimates.
double seconds_of(const std::function<void()>& call);

}  // namespace hmax
