#include "cli/shared/work_limit.hpp"

#include <fmt/format.h>

#include "bench/timing/timing.hpp"
#include "cli/shared/console.hpp"
#include "core/errors.hpp"
#include "core/numbers.hpp"

namespace hmax {

std::string duration_in_words(double seconds) {
  constexpr double minute = 60, hour = 60 * minute, day = 24 * hour, year = 365.25 * day;
  if (seconds < 1.5 * minute) return short_number(seconds, 2) + " s";
  if (seconds < 1.5 * hour) return fmt::format("{:.0f} min", seconds / minute);
  if (seconds < 2 * day) return fmt::format("{:.1f} h", seconds / hour);
  if (seconds < 2 * year) return fmt::format("{:.0f} days", seconds / day);
  return short_number(seconds / year, 2) + " years";
}

void refuse_endless(const Work& work) {
  const double seconds = work.count * work.seconds_each;
  const bool is_many = !(work.count <= work.most_count);
  if (!is_many && !(seconds > work.most_seconds)) return;
  throw InputError(fmt::format(
      "{} asks for {} {}{}, more than the limit of {}; {}", work.asked, short_number(work.count, 3), work.of,
      work.seconds_each > 0 ? ", about " + duration_in_words(seconds) : "",
      is_many ? short_number(work.most_count, 3) : duration_in_words(work.most_seconds), work.remedy));
}

void add_time_limit(CLI::App& command, std::optional<double>& seconds) {
  add_number(
      command, "--time-limit", seconds,
      fmt::format("Refuse work that is estimated to take longer [s]; {} by default", default_time_limit));
}

double time_limit_of(const std::optional<double>& seconds) {
  if (seconds && !(*seconds > 0))
    throw InputError(fmt::format("--time-limit is {} but must be above 0, for instance {}", to_text(*seconds),
                                 default_time_limit));
  return seconds.value_or(default_time_limit);
}

double seconds_of(const std::function<void()>& call) {
  const double start = elapsed_seconds();
  call();
  return elapsed_seconds() - start;
}

}  // namespace hmax
