/// Numbers as text and back, independent of the locale.
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <string_view>

namespace hmax {

inline constexpr double infinity = std::numeric_limits<double>::infinity();

/// The shortest digits that read back as the same double; "nan", "inf", "-inf" for the others, "-0" for minus
/// zero.
std::string to_text(double value);

/// A finite value rounded to `digits` significant digits, without an exponent from a ten-thousandth up to a
/// million: "2210" of 2212.4 and 3.
std::string rounded_text(double value, int digits);

/// What short_number() writes for NaN and for the infinities.
inline constexpr std::string_view no_number = "undefined", too_large = "infinite", too_low = "-infinite";

/// At most `digits` significant digits, for people.
std::string short_number(double value, int digits = 6);

/// "8.66 mm" of a length [m], with three digits.
std::string millimetres(double metres);

/// The number that fills `text`, apart from blanks around it; Fortran exponents (1.0D+3) and a leading plus
/// are understood. Empty when there is anything else, also for digits beyond the range of double.
std::optional<double> to_number(std::string_view text);

}  // namespace hmax
