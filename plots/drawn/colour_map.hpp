/// Colours for numbers: equal steps of the number are equal steps to the eye.
#pragma once

#include <array>
#include <string>
#include <vector>

namespace hmax {

/// A colour of OKLab, a space in which distances are those that the eye sees.
/// @source  [ottosson2020oklab]
struct OkLab {
  double lightness, a, b;  ///< 0 black to 1 white; green to red; blue to yellow
};

/// "#0072b2" and back; what the screen cannot show is clipped.
OkLab oklab_of(const std::string& hex);
std::string hex_of(const OkLab& colour);

/// A way through colours, walked at even speed.
class ColourMap {
 public:
  /// @param anchors  "#rrggbb", at least two; straight lines of OKLab join them
  explicit ColourMap(const std::vector<std::string>& anchors);

  /// @param share  0 at the first anchor, 1 at the last; clamped
  [[nodiscard]] OkLab at(double share) const;

 private:
  std::vector<OkLab> anchors_;
  std::vector<double> lengths_;  ///< of the way up to each anchor
};

/// For quantities that begin at nothing: from the colour of paper over orange and vermillion to dark violet.
const ColourMap& sequential_colours();
/// For quantities of two signs, pale in the middle: blue, vermillion.
const ColourMap& diverging_colours();

}  // namespace hmax
