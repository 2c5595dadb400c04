#include "plots/pages/body_scene.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <limits>
#include <type_traits>
#include <utility>

#include <fmt/format.h>

#include "core/errors.hpp"
#include "core/text/base64.hpp"
#include "plots/drawn/bodies.hpp"
#include "plots/drawn/colour_map.hpp"
#include "plots/pages/frame.hpp"
#include "plots/svg.hpp"
#include "results/json.hpp"

namespace hmax {

namespace {

constexpr int version = 1;
constexpr double most_int16 = 32767;
/// Far beyond any body; the square of a length still is a double, and the length itself a float.
constexpr double most_number = 1e30;
/// Share of the diagonal of the body that a mode moves it; body_scene_drawing.js has the same.
constexpr double mode_share = 0.1;
/// Points whose indices have 16 bits.
constexpr std::size_t most_short = 65'536;

// ---- Checks

[[noreturn]] void reject(const std::string& what) { throw InputError("body scene: " + what); }

void check_numbers(const std::vector<double>& values, const std::string& name) {
  for (const double x : values)
    if (!(std::abs(x) <= most_number))
      reject(fmt::format("{} has the value {}; every value must be finite and at most 1e30", name, x));
}

void check_vectors(const std::vector<SpacePoint>& vectors, std::size_t size, const std::string& name) {
  if (vectors.size() != size)
    reject(fmt::format("{} has {} entries for {} points", name, vectors.size(), size));
  for (const SpacePoint& v : vectors) check_numbers({v.begin(), v.end()}, name);
}

void check_index(std::int32_t index, std::size_t size, const char* name) {
  if (index < 0 || static_cast<std::size_t>(index) >= size)
    reject(fmt::format("{} refers to point {}; there are {} points", name, index, size));
}

void check(const SceneMotion& motion, std::size_t size) {
  const std::size_t frames = motion.t.size();
  if (motion.displacements.size() != frames)
    reject(fmt::format("{} times for {} frames of displacements", frames, motion.displacements.size()));
  if (!motion.energy_density.empty() && motion.energy_density.size() != frames)
    reject(fmt::format("{} times for {} frames of energy density", frames, motion.energy_density.size()));
  check_numbers(motion.t, "the time of the frames");
  if (std::ranges::adjacent_find(motion.t, std::greater_equal<>{}) != motion.t.end())
    reject("the times of the frames are not ascending");
  for (std::size_t k = 0; k < frames; ++k)
    check_vectors(motion.displacements[k], size, fmt::format("the displacement of frame {}", k));
  for (std::size_t k = 0; k < motion.energy_density.size(); ++k) {
    const std::vector<double>& energy = motion.energy_density[k];
    if (energy.size() != size)
      reject(
          fmt::format("the energy density of frame {} has {} entries for {} points", k, energy.size(), size));
    check_numbers(energy, fmt::format("the energy density of frame {}", k));
  }
}

void check(const SceneMode& mode, std::size_t size) {
  check_vectors(mode.shape, size, "a mode");
  if (!(mode.frequency >= 0 && mode.frequency <= most_number))
    reject(fmt::format("a mode has the frequency {} Hz", mode.frequency));
  if (!mode.owner.empty() && (mode.owner.size() < 2 || mode.owner.size() > 4))
    reject(fmt::format("the element of a mode has {} points; it must have 2 to 4", mode.owner.size()));
  for (const std::int32_t index : mode.owner) check_index(index, size, "the element of a mode");
}

double diagonal_of(const std::vector<SpacePoint>& points) {
  SpacePoint low = points.front(), high = low;
  for (const SpacePoint& p : points)
    for (std::size_t k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], p[k]);
      high[k] = std::max(high[k], p[k]);
    }
  return std::hypot(high[0] - low[0], high[1] - low[1], high[2] - low[2]);
}

void check(const BodyScene& scene) {
  const std::size_t size = scene.points.size();
  check_vectors(scene.points, size, "the points");
  if (scene.triangles.empty() || size == 0) reject("the surface has no triangle");
  for (const TriangleCorners& t : scene.triangles)
    for (const std::int32_t corner : t) check_index(corner, size, "a triangle");
  for (const std::int32_t index : scene.held) check_index(index, size, "a support");
  if (!(diagonal_of(scene.points) > 0)) reject("all points coincide");
  check(scene.motion, size);
  for (const SceneMode& mode : scene.modes) check(mode, size);
}

// ---- Numbers as text

template <class Number>
using Bits = std::conditional_t<sizeof(Number) == 4, std::uint32_t, std::uint16_t>;

template <class Number>
std::string packed(const std::vector<Number>& numbers) {
  std::string bytes;
  bytes.reserve(numbers.size() * sizeof(Number));
  for (const Number number : numbers)
    for (std::size_t k = 0; k < sizeof(Number); ++k)
      bytes += static_cast<char>(
          static_cast<unsigned char>(std::bit_cast<Bits<Number>>(number) >> (8 * k) & 0xffU));
  return encode_base64(bytes);
}

template <class Number>
std::vector<Number> unpacked(const std::string& text) {
  const auto bytes = decode_base64(text);
  if (!bytes || bytes->size() % sizeof(Number) != 0) reject("an array is not base64 of whole numbers");
  std::vector<Number> numbers(bytes->size() / sizeof(Number));
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < sizeof(Number); ++k)
      bits |= std::uint32_t{static_cast<unsigned char>((*bytes)[i * sizeof(Number) + k])} << (8 * k);
    numbers[i] = std::bit_cast<Number>(static_cast<Bits<Number>>(bits));
  }
  return numbers;
}

std::string packed_indices(const std::vector<std::int32_t>& indices, std::size_t points) {
  if (points <= most_short) return packed(std::vector<std::uint16_t>(indices.begin(), indices.end()));
  return packed(indices);
}

std::vector<std::int32_t> unpacked_indices(const std::string& text, std::size_t points) {
  if (points > most_short) return unpacked<std::int32_t>(text);
  const auto indices = unpacked<std::uint16_t>(text);
  return {indices.begin(), indices.end()};
}

/// @param largest  absolute value of any of the values, which becomes 32767
std::string rounded(const std::vector<double>& values, double largest) {
  std::vector<std::int16_t> numbers(values.size(), 0);
  if (largest > 0)
    std::ranges::transform(values, numbers.begin(), [&](double x) {
      return static_cast<std::int16_t>(std::lround(x / largest * most_int16));
    });
  return packed(numbers);
}

std::vector<double> restored(const std::string& text, double largest) {
  const auto numbers = unpacked<std::int16_t>(text);
  if (std::ranges::find(numbers, std::numeric_limits<std::int16_t>::min()) != numbers.end())
    reject("a number is beyond the largest");
  std::vector<double> values(numbers.size());
  std::ranges::transform(numbers, values.begin(), [&](std::int16_t x) { return x / most_int16 * largest; });
  return values;
}

std::vector<double> flat(const std::vector<SpacePoint>& vectors) {
  std::vector<double> values;
  values.reserve(3 * vectors.size());
  for (const SpacePoint& v : vectors) values.insert(values.end(), v.begin(), v.end());
  return values;
}

template <class Vector, class Number>
std::vector<Vector> in_threes(const std::vector<Number>& values) {
  if (values.size() % 3 != 0)
    reject("an array of vectors or triangles has a length that is no multiple of 3");
  std::vector<Vector> vectors(values.size() / 3);
  for (std::size_t i = 0; i < vectors.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k) vectors[i][k] = values[3 * i + k];
  return vectors;
}

double largest_of(const std::vector<double>& values) {
  double largest = 0;
  for (const double x : values) largest = std::max(largest, std::abs(x));
  return largest;
}

// ---- The scene as text

double length(const SpacePoint& v) { return std::hypot(v[0], v[1], v[2]); }

double longest(const std::vector<SpacePoint>& vectors) {
  double most = 0;
  for (const SpacePoint& v : vectors) most = std::max(most, length(v));
  return most;
}

/// The first frame with the largest displacement of any point; there is at least one frame.
std::size_t largest_frame(const SceneMotion& motion) {
  std::vector<double> sizes;
  for (const auto& frame : motion.displacements) sizes.push_back(longest(frame));
  return static_cast<std::size_t>(std::ranges::max_element(sizes) - sizes.begin());
}

/// The points that are drawn, of all that a body has.
class DrawnPoints {
 public:
  explicit DrawnPoints(const BodyScene& scene) : now_(scene.points.size(), -1) {
    std::vector<bool> drawn(now_.size(), false);
    for (const TriangleCorners& t : scene.triangles)
      for (const std::int32_t corner : t) drawn[static_cast<std::size_t>(corner)] = true;
    surface_ = drawn;
    for (const SceneMode& mode : scene.modes)
      for (const std::int32_t index : mode.owner) drawn[static_cast<std::size_t>(index)] = true;
    for (std::size_t i = 0; i < now_.size(); ++i)
      if (drawn[i]) {
        now_[i] = static_cast<std::int32_t>(kept_.size());
        kept_.push_back(i);
      }
  }

  [[nodiscard]] std::size_t size() const { return kept_.size(); }
  [[nodiscard]] bool on_surface(std::int32_t index) const {
    return surface_[static_cast<std::size_t>(index)];
  }
  [[nodiscard]] std::int32_t now(std::int32_t index) const { return now_[static_cast<std::size_t>(index)]; }

  template <class Value>
  std::vector<Value> of(const std::vector<Value>& values) const {
    std::vector<Value> kept;
    kept.reserve(kept_.size());
    for (const std::size_t i : kept_) kept.push_back(values[i]);
    return kept;
  }

 private:
  std::vector<std::int32_t> now_;
  std::vector<std::size_t> kept_;
  std::vector<bool> surface_;
};

Json json_at_rest(const BodyScene& scene, const DrawnPoints& drawn) {
  std::vector<float> coordinates;
  for (const double x : flat(drawn.of(scene.points))) coordinates.push_back(static_cast<float>(x));
  std::vector<std::int32_t> corners, held;
  for (const TriangleCorners& t : scene.triangles)
    for (const std::int32_t corner : t) corners.push_back(drawn.now(corner));
  for (const std::int32_t index : scene.held)
    if (drawn.on_surface(index)) held.push_back(drawn.now(index));
  Json json = {{"version", version},
               HMAX_KEYS(scene, title, caption),
               {"points", packed(coordinates)},
               {"triangles", packed_indices(corners, drawn.size())},
               {"held", packed_indices(held, drawn.size())}};
  if (scene.held_as != BodyScene{}.held_as) json["held_as"] = scene.held_as;
  return json;
}

Json json_of(const SceneMode& mode, const DrawnPoints& drawn) {
  const std::vector<double> shape = flat(drawn.of(mode.shape));
  std::vector<std::int32_t> owner;
  for (const std::int32_t index : mode.owner) owner.push_back(drawn.now(index));
  return {HMAX_KEYS(mode, words, frequency),
          {"shape", rounded(shape, largest_of(shape))},
          {"owner", owner},
          {"owner_words", mode.owner_words}};
}

/// `count` frames, evenly from the first to the last, one of them moved to the frame with the largest
/// displacement.
/// @param count  1 to the number of frames
std::vector<std::size_t> kept_frames(const SceneMotion& motion, std::size_t count) {
  if (count == 1) return {0};
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < count; ++i)
    kept.push_back((2 * i * (motion.t.size() - 1) + count - 1) / (2 * (count - 1)));
  const std::size_t peak = largest_frame(motion);
  if (count == 2 || peak == 0 || peak + 1 == motion.t.size()) return kept;
  const auto after = std::ranges::lower_bound(kept, peak);
  const bool nearer_before = peak - *(after - 1) < *after - peak;
  const auto moved =
      (nearer_before && after - 1 != kept.begin()) || after + 1 == kept.end() ? after - 1 : after;
  *moved = peak;
  return kept;
}

/// @param frames  that are kept
Json json_of(const SceneMotion& motion, const std::vector<std::size_t>& frames, const DrawnPoints& drawn) {
  const bool with_energy = !motion.energy_density.empty();
  std::vector<double> t;
  std::vector<std::vector<double>> displacements, energies;
  double largest = 0, energy_largest = 0;
  for (const std::size_t k : frames) {
    t.push_back(motion.t[k]);
    displacements.push_back(flat(drawn.of(motion.displacements[k])));
    largest = std::max(largest, largest_of(displacements.back()));
    if (with_energy) energies.push_back(drawn.of(motion.energy_density[k]));
    if (with_energy) energy_largest = std::max(energy_largest, largest_of(energies.back()));
  }
  Json json{{"t", t}, {"largest", largest}, {"displacements", Json::array()}};
  for (const auto& values : displacements) json["displacements"].push_back(rounded(values, largest));
  if (!with_energy) return json;
  json["energy_largest"] = energy_largest;
  json["energy_density"] = Json::array();
  for (const auto& values : energies) json["energy_density"].push_back(rounded(values, energy_largest));
  return json;
}

std::string text_of(const Json& json) {
  const std::string plain = json.dump(-1, ' ', false, Json::error_handler_t::replace);
  std::string text;
  for (const char c : plain) text += c == '<' ? "\\u003c" : std::string(1, c);
  return text;
}

/// Frames that fit into `bytes`.
std::size_t frames_within(std::size_t bytes, const SceneMotion& motion, std::size_t points) {
  constexpr std::size_t names = 150, number = 25, quotes = 3;
  const auto encoded = [](std::size_t n) { return (n + 2) / 3 * 4 + quotes; };
  const std::size_t frame =
      encoded(6 * points) + number + (motion.energy_density.empty() ? 0 : encoded(2 * points));
  return bytes <= names ? 0 : std::min({(bytes - names) / frame, motion.t.size(), most_scene_frames});
}

// ---- The scene of a text

/// The entry `name`, which is an array.
const Json& array_in(const Json& json, const char* name) {
  const Json& array = json.at(name);
  if (!array.is_array()) reject(fmt::format("{} is no array", name));
  return array;
}

SceneMotion motion_of(const Json& json) {
  SceneMotion motion;
  motion.t = json.at("t").get<std::vector<double>>();
  const auto largest = json.at("largest").get<double>();
  for (const Json& frame : array_in(json, "displacements"))
    motion.displacements.push_back(in_threes<SpacePoint>(restored(frame.get<std::string>(), largest)));
  if (!json.contains("energy_density")) return motion;
  const auto energy_largest = json.at("energy_largest").get<double>();
  for (const Json& frame : array_in(json, "energy_density"))
    motion.energy_density.push_back(restored(frame.get<std::string>(), energy_largest));
  return motion;
}

std::vector<std::int32_t> owner_in(const Json& mode) {
  std::vector<std::int32_t> owner;
  for (const Json& each : array_in(mode, "owner")) {
    const bool is_whole = each.is_number_integer() && std::in_range<std::int32_t>(each.get<std::int64_t>());
    if (!is_whole) reject("the element of a mode has a point that is no whole number");
    owner.push_back(each.get<std::int32_t>());
  }
  return owner;
}

SceneMode mode_of(const Json& json) {
  return {.words = json.at("words").get<std::string>(),
          .frequency = json.at("frequency").get<double>(),
          .shape = in_threes<SpacePoint>(restored(json.at("shape").get<std::string>(), 1)),
          .owner = owner_in(json),
          .owner_words = json.at("owner_words").get<std::string>()};
}

BodyScene scene_of(const Json& json) {
  if (json.at("version") != version) reject("this version of hmax does not know its version; write it again");
  BodyScene scene;
  scene.title = json.at("title").get<std::string>();
  scene.caption = json.at("caption").get<std::string>();
  scene.points = in_threes<SpacePoint>(unpacked<float>(json.at("points").get<std::string>()));
  const std::size_t size = scene.points.size();
  scene.triangles =
      in_threes<TriangleCorners>(unpacked_indices(json.at("triangles").get<std::string>(), size));
  scene.held = unpacked_indices(json.at("held").get<std::string>(), size);
  scene.held_as = json.value("held_as", scene.held_as);
  if (json.contains("motion")) scene.motion = motion_of(json.at("motion"));
  for (const Json& mode : array_in(json, "modes")) scene.modes.push_back(mode_of(mode));
  return scene;
}

// ---- The picture

/// The body moved by `factor` times `displacements`, coloured by `unit` times their lengths.
void move(BodyView& view, const std::vector<SpacePoint>& displacements, double factor, double unit) {
  view.rest = view.points;
  for (std::size_t i = 0; i < view.points.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) view.points[i][k] += factor * displacements[i][k];
    view.values.push_back(unit * length(displacements[i]));
  }
}

std::string picture_of(const BodyScene& scene) {
  BodyPicture picture;
  BodyView view{
      .points = scene.points, .triangles = scene.triangles, .held = scene.held, .held_as = scene.held_as};
  const SceneMotion& motion = scene.motion;
  if (!motion.t.empty()) {
    const std::size_t k = largest_frame(motion);
    move(view, motion.displacements[k], 1, 1e3);
    picture.colours.quantity = "displacement [mm]";
    picture.caption = fmt::format("t = {:.4g} s, the largest displacement of the motion: {:.3g} mm.",
                                  motion.t[k], 1e3 * longest(motion.displacements[k]));
  } else if (!scene.modes.empty()) {
    const SceneMode& mode = scene.modes.front();
    const double most = std::max(longest(mode.shape), 1e-300);
    move(view, mode.shape, mode_share * diagonal_of(scene.points) / most, 1 / most);
    picture.colours = {.quantity = "displacement, relative to the largest", .range = Range{0, 1}};
    picture.caption = fmt::format("{}; {:.4g} Hz. {}", mode.words, mode.frequency, mode.owner_words);
  }
  picture.views.push_back(std::move(view));
  picture.coarse = true;
  return bodies_svg(picture);
}

/// The colours at even steps, for the script.
std::string stops_text() {
  std::string text;
  for (const Rgb& colour : colour_stops) text += (text.empty() ? "" : " ") + hex_of(colour);
  return text;
}

}  // namespace

std::string scene_text(const BodyScene& scene, std::size_t most_bytes) {
  check(scene);
  const DrawnPoints drawn(scene);
  Json json = json_at_rest(scene, drawn);
  Json& modes = json["modes"] = Json::array();
  for (const SceneMode& mode : scene.modes) modes.push_back(json_of(mode, drawn));
  std::string text = text_of(json);
  while (text.size() > most_bytes && !modes.empty()) {
    modes.erase(modes.size() - 1);
    text = text_of(json);
  }
  if (text.size() > most_bytes)
    reject(fmt::format("the surface of {} points and {} triangles takes {} bytes, more than {}", drawn.size(),
                       scene.triangles.size(), text.size(), most_bytes));
  const std::size_t frames = frames_within(most_bytes - text.size(), scene.motion, drawn.size());
  if (frames == 0 || (frames == 1 && scene.motion.t.size() > 1)) return text;
  json["motion"] = json_of(scene.motion, kept_frames(scene.motion, frames), drawn);
  return text_of(json);
}

BodyScene scene_of(std::string_view text) {
  try {
    BodyScene scene = scene_of(Json::parse(text));
    check(scene);
    return scene;
  } catch (const nlohmann::json::exception&) {
    reject("the text is not JSON of a scene; write it again");
  }
}

std::string scene_html(std::string_view scene_json, std::string_view id) {
  const BodyScene scene = scene_of(scene_json);
  const SpacePoint towards = BodyPicture{}.towards;
  // In JSON, '<' stands in texts only.
  std::string data;
  for (const char c : scene_json) data += c == '<' ? "\\u003c" : std::string(1, c);
  return fmt::format(
      "<figure class=\"scene\" id=\"{}\" data-towards=\"{} {} {}\" data-colours=\"{}\">\n<figcaption>{}</figcaption>\n"
      "<div class=\"scene-picture\"><img alt=\"{}\" src=\"data:image/svg+xml;base64,{}\"></div>\n"
      "<p class=\"scene-caption\">{}</p>\n<script type=\"application/json\">{}</script>\n</figure>\n",
      html_text(id), towards[0], towards[1], towards[2], stops_text(), html_text(scene.title),
      html_text("Picture of the body: " + scene.title), encode_base64(picture_of(scene)),
      html_text(scene.caption), data);
}

std::string_view scene_style() { return page_style("body_scene"); }

std::string scene_script() {
  std::string text = "(() => {\n";
  for (const char* name : {"body_scene_drawing", "body_scene"}) text += page_script(name);
  return text + "})();\n";
}

}  // namespace hmax
