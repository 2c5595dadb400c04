/// Numbers as text and back, independent of the locale.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace hmax {

/// The shortest digits that read back as the same double; "nan", "inf", "-inf" for the others, "-0" for minus
/// zero.
std::string to_text(double value);

/// A finite value rounded to `digits` significant digits, without an exponent from a ten-thousandth up to a
/// million: "2210" of 2212.4 and 3.
std::string rounded_text(double value, int digits);

/// The number that fills `text`, apart from blanks around it; Fortran exponents (1.0D+3) and a leading plus
/// are understood. Empty when there is anything else, also for digits beyond the range of double.
std::optional<double> to_number(std::string_view text);

}  // namespace hmax
