#include "core/numbers.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <system_error>

namespace hmax {

std::string to_text(double value) {
  if (std::isnan(value)) return "nan";  // to_chars would keep the sign of a NaN: "-nan"
  char digits[32];
  const auto [end, error] = std::to_chars(digits, digits + sizeof digits, value);
  return {digits, end};
}

std::string rounded_text(double value, int digits) {
  char text[64];
  auto [end, error] = std::to_chars(text, text + sizeof text, value, std::chars_format::general, digits);
  double rounded = value;
  std::from_chars(text, end, rounded);
  if (std::abs(rounded) < 1e6 && std::string_view(text, end).find("e+") != std::string_view::npos)
    end = std::to_chars(text, text + sizeof text, rounded, std::chars_format::fixed, 0).ptr;
  return {text, end};
}

std::optional<double> to_number(std::string_view text) {
  constexpr std::string_view blanks = " \t\r";
  const auto first = text.find_first_not_of(blanks);
  if (first == std::string_view::npos) return std::nullopt;
  text = text.substr(first, text.find_last_not_of(blanks) - first + 1);
  if (text.size() > 1 && text[0] == '+' && text[1] != '-' && text[1] != '+') text.remove_prefix(1);

  std::string digits(text);
  const bool has_digit =
      std::any_of(digits.begin(), digits.end(), [](char c) { return c >= '0' && c <= '9'; });
  if (has_digit) {
    for (char& c : digits) {
      if (c == 'd' || c == 'D') c = 'e';
    }
  }
  double value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc() || end != digits.data() + digits.size()) return std::nullopt;
  return value;
}

std::string short_number(double value, int digits) {
  if (std::isnan(value)) return std::string(no_number);
  if (std::isinf(value)) return std::string(value > 0 ? too_large : too_low);
  return rounded_text(value == 0 ? 0.0 : value, digits);  // no "-0"
}

std::string millimetres(double metres) { return short_number(1000 * metres, 3) + " mm"; }

}  // namespace hmax
