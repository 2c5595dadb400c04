#include "cli/stability/fastest_mode_words.hpp"

#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "catalogue/models/equilibria/body_balance.hpp"
#include "core/numbers.hpp"

namespace hmax {

namespace {

using Json = nlohmann::ordered_json;

/// "2.8 % larger", or "no larger" where less than 0.01 % comes of it.
std::string growth_in_words(double factor) {
  const double percent = 100 * (factor - 1), size = std::abs(percent);
  if (size < 0.01) return "no larger";
  return fmt::format("{} % {}", size < 10 ? short_number(size, 2) : fmt::format("{:.0f}", size),
                     percent > 0 ? "larger" : "smaller");
}

}  // namespace

std::string fastest_mode_in_words(const Json& mode) {
  const auto pessimism = [&](const char* bound) {
    return short_number(mode["bounds"][bound]["pessimism"].get<double>(), 4);
  };
  const std::string kind = mode["element_kind"];
  const NamedElement owner{.kind = kind, .number = mode["element"], .points = mode["points"]};
  const std::string fastest = fmt::format(
      "fastest mode at rest {} rad/s: {} has {} % of its energy, {} points move; bounds are larger by {} "
      "(elements), {} (points), {} (Gershgorin)\n",
      short_number(mode["omega"].get<double>()), in_words(owner),
      short_number(100 * mode["energy_share"].get<double>(), 3),
      short_number(mode["moving_points"].get<double>(), 3), pessimism("element"), pessimism("nodal"),
      pessimism("gershgorin"));
  const Json& gain = mode["gain"];
  if (gain.is_null()) return fastest;
  const Json& moved = gain["moved_point"];
  return fmt::format(
      "{}the undamped h_max would be {} without that element, {} with twice its mass ({} % of the body), {} with {}\n",
      fastest, growth_in_words(gain["without_element"]), growth_in_words(gain["double_mass"]),
      short_number(100 * gain["added_mass"].get<double>(), 3), growth_in_words(gain["smoothed"]),
      moved.is_null() ? "its points moved"
                      : fmt::format("point {} moved towards its neighbours", moved.get<std::int64_t>()));
}

}  // namespace hmax
