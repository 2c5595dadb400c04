/// Bodies that a page turns, moves and colours: plots/pages/body_scene*.js draw them with WebGL.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "plots/drawn/painter.hpp"

namespace hmax {

/// How a body moves.
struct SceneMotion {
  std::vector<double> t = {};                               ///< of each frame [s], strictly ascending
  std::vector<std::vector<SpacePoint>> displacements = {};  ///< of each point in each frame [m]
  std::vector<std::vector<double>> energy_density = {};     ///< the same [J/m^3]; empty: not offered
};

/// One mode of vibration.
struct SceneMode {
  std::string words = {};              ///< "fastest mode: it limits explicit steps"
  double frequency = 0;                ///< [Hz]
  std::vector<SpacePoint> shape = {};  ///< of each point, of any scale
  std::vector<std::int32_t> owner =
      {};  ///< points of the element with the largest share of its energy: 2 to 4; may be empty
  std::string owner_words = {};  ///< "tetrahedron 12 has 35 % of its energy"
};

/// A body that a page turns, moves and colours.
struct BodyScene {
  std::string title = {}, caption = {};
  std::vector<SpacePoint> points = {};          ///< at rest [m]
  std::vector<TriangleCorners> triangles = {};  ///< of the surface, counter-clockwise as seen from outside
  std::vector<std::int32_t> held = {};          ///< points that supports hold
  std::string held_as = "fixed";                ///< how, for the legend
  SceneMotion motion = {};                      ///< may be empty
  std::vector<SceneMode> modes = {};            ///< may be empty
};

/// Frames of a motion that `scene_text` keeps at most.
inline constexpr std::size_t most_scene_frames = 60;

/// JSON for scripts and stores, one object:
/// - `version`: 1; `title`, `caption`, `held_as`: texts, the last "fixed" where absent;
/// - `points`: float32, 3 of each point [m]; `triangles`, `held`: indices, uint16, or uint32 beyond 65536
/// points;
/// - `motion`: `{t, largest, displacements, energy_largest, energy_density}` or absent: `t` are numbers [s],
/// the others one text of each frame, int16, where 32767 stands for `largest` [m] or `energy_largest`
/// [J/m^3];
/// - `modes`: `[{words, frequency, shape, owner, owner_words}]`, the shape as int16, 32767 for its largest
/// component. Arrays of one type are base64 of little-endian numbers. There is no '<', so that it may stand
/// in a script element. Only points of triangles and owners are kept, in their order; a held point inside the
/// body is left out. Bytes that are not UTF-8 become U+FFFD.
/// @param most_bytes  frames are left out evenly to stay within it; the first, the last and the one with the
/// largest
///                    displacement are kept. Where two do not fit, the motion is left out, then modes from
///                    the last
/// @throws InputError when lengths or indices do not fit, numbers are not finite, there is no triangle, or
/// the body at
///         rest does not fit into `most_bytes`
std::string scene_text(const BodyScene& scene, std::size_t most_bytes = 1'500'000);

/// The scene back. Points are rounded to float32, displacements, energy densities and shapes to 1/65534 of
/// the largest component; shapes come with a largest component of 1.
/// @throws InputError when the text is malformed: wrong lengths, indices out of range, numbers that are not
/// finite
BodyScene scene_of(std::string_view text);

/// The place of the body in a page: a figure of class "scene" with the data and a picture of `bodies_svg`:
/// the frame with the largest displacement, else the first mode, else at rest. The picture is for print and
/// where there is no WebGL. The page needs `scene_style`, and after its figures `scene_script`.
/// @param scene_json  of `scene_text`
/// @param id          of the figure, unique in the page
/// @throws InputError as `scene_of`
std::string scene_html(std::string_view scene_json, std::string_view id);

/// The style and the script of a page with bodies, each once for any number of them. The style takes the
/// colours of the page from its variables `--page`, `--ink`, `--faint`, `--line`, `--soft` and `--link`; the
/// script has a scope of its own and draws again when `data-theme` of the root or the theme of the system
/// changes.
std::string_view scene_style();
std::string scene_script();

}  // namespace hmax
