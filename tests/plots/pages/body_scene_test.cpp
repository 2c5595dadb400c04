#include "plots/pages/body_scene.hpp"

#include <cmath>
#include <functional>
#include <limits>
#include <random>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/errors.hpp"
#include "core/text/base64.hpp"
#include "tests/plots/pages/made_scenes.hpp"

namespace hmax {
namespace {

using AnyJson = nlohmann::json;

double largest(const std::vector<SpacePoint>& vectors) {
  double most = 0;
  for (const SpacePoint& v : vectors)
    for (const double x : v) most = std::max(most, std::abs(x));
  return most;
}

/// The largest difference of components of p and `scale` q.
double difference(const std::vector<SpacePoint>& p, const std::vector<SpacePoint>& q, double scale = 1) {
  if (p.size() != q.size()) return std::numeric_limits<double>::infinity();
  double most = 0;
  for (std::size_t i = 0; i < p.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k) most = std::max(most, std::abs(p[i][k] - scale * q[i][k]));
  return most;
}

TEST(BodyScene, ComesBackWithinRounding) {
  const BodyScene scene = made_scene(3, 40), back = scene_of(scene_text(scene));
  EXPECT_EQ(back.title, scene.title);
  EXPECT_EQ(back.caption, scene.caption);
  EXPECT_LE(difference(back.points, scene.points), 1e-7 * largest(scene.points));
  EXPECT_EQ(back.triangles, scene.triangles);
  EXPECT_EQ(back.held, scene.held);
  EXPECT_EQ(back.motion.t, scene.motion.t);
  ASSERT_EQ(back.motion.displacements.size(), 40U);
  double most = 0, most_energy = 0;
  for (const auto& frame : scene.motion.displacements) most = std::max(most, largest(frame));
  for (const auto& frame : scene.motion.energy_density)
    for (const double x : frame) most_energy = std::max(most_energy, x);
  for (std::size_t k = 0; k < 40; ++k) {
    EXPECT_LE(difference(back.motion.displacements[k], scene.motion.displacements[k]), most / 65'530);
    for (std::size_t i = 0; i < scene.points.size(); ++i)
      EXPECT_NEAR(back.motion.energy_density[k][i], scene.motion.energy_density[k][i], most_energy / 65'530);
  }
  ASSERT_EQ(back.modes.size(), 2U);
  for (std::size_t m = 0; m < 2; ++m) {
    EXPECT_EQ(back.modes[m].words, scene.modes[m].words);
    EXPECT_EQ(back.modes[m].frequency, scene.modes[m].frequency);
    EXPECT_LE(difference(back.modes[m].shape, scene.modes[m].shape, 1 / largest(scene.modes[m].shape)),
              1 / 65'530.0);
    EXPECT_EQ(back.modes[m].owner, scene.modes[m].owner);
    EXPECT_EQ(back.modes[m].owner_words, scene.modes[m].owner_words);
  }
  EXPECT_EQ(scene_text(back), scene_text(scene_of(scene_text(back))));
}

TEST(BodyScene, HasOnlyPointsThatAreDrawn) {
  BodyScene scene = made_scene(2, 3);
  const std::size_t inside = scene.points.size() - 1;
  // Before all others, a point inside that nothing refers to but a support.
  BodyScene more = scene;
  const auto shift = [](std::int32_t& index) { ++index; };
  more.points.insert(more.points.begin(), SpacePoint{0.1, 0.03, 0.03});
  for (auto& t : more.triangles) std::ranges::for_each(t, shift);
  std::ranges::for_each(more.held, shift);
  more.held.push_back(0);
  for (auto& frame : more.motion.displacements) frame.insert(frame.begin(), SpacePoint{});
  for (auto& frame : more.motion.energy_density) frame.insert(frame.begin(), 0);
  for (auto& mode : more.modes) {
    mode.shape.insert(mode.shape.begin(), SpacePoint{});
    std::ranges::for_each(mode.owner, shift);
  }
  EXPECT_EQ(scene_text(more), scene_text(scene));
  scene.modes.back().owner.clear();
  EXPECT_EQ(scene_of(scene_text(scene)).points.size(), inside);
}

TEST(BodyScene, HasIndicesOfAnySize) {
  const BodyScene scene = made_bar(56);
  ASSERT_GT(scene.points.size(), 65'536U);
  const BodyScene back = scene_of(scene_text(scene, 10'000'000));
  EXPECT_EQ(back.triangles, scene.triangles);
  EXPECT_EQ(back.held, scene.held);
}

TEST(BodyScene, LeavesOutFrames) {
  const BodyScene scene = made_scene(3, 500);
  const BodyScene back = scene_of(scene_text(scene));
  ASSERT_EQ(back.motion.t.size(), most_scene_frames);
  EXPECT_EQ(back.motion.t.front(), 0);
  EXPECT_EQ(back.motion.t.back(), scene.motion.t.back());
  for (std::size_t k = 1; k < back.motion.t.size(); ++k)
    EXPECT_NEAR(back.motion.t[k] - back.motion.t[k - 1], 1.2 / 59, 1.2 / 59 * 0.7);
  double most = 0, kept = 0;
  for (const auto& frame : scene.motion.displacements) most = std::max(most, largest(frame));
  for (const auto& frame : back.motion.displacements) kept = std::max(kept, largest(frame));
  EXPECT_NEAR(kept, most, 1e-12);
}

TEST(BodyScene, StaysWithinItsBytes) {
  const BodyScene scene = made_scene(3, 500);
  std::size_t last_frames = most_scene_frames, last_modes = 2;
  for (std::size_t most = 120'000; most > 9'000; most -= 1'000) {
    const std::string text = scene_text(scene, most);
    EXPECT_LE(text.size(), most);
    const BodyScene back = scene_of(text);
    EXPECT_LE(back.motion.t.size(), last_frames);
    EXPECT_NE(back.motion.t.size(), 1U);
    EXPECT_LE(back.modes.size(), last_modes);
    last_modes = back.modes.size();
    last_frames = std::max<std::size_t>(back.motion.t.size(), last_modes < 2 ? most_scene_frames : 0);
  }
  EXPECT_LT(scene_of(scene_text(scene, 30'000)).motion.t.size(), 20U);
  EXPECT_GT(scene_of(scene_text(scene, 30'000)).motion.t.size(), 2U);
  EXPECT_THROW(scene_text(scene, 3'000), InputError);
}

TEST(BodyScene, RefusesWhatDoesNotFit) {
  const double nan = std::nan("");
  const std::function<void(BodyScene&)> faults[] = {
      [](BodyScene& s) { s.triangles.clear(); },
      [](BodyScene& s) { s.points.clear(); },
      [](BodyScene& s) { s.points.pop_back(); },
      [](BodyScene& s) {
        s.points.assign(s.points.size(), {1, 2, 3});
      },
      [&](BodyScene& s) { s.points[1][2] = nan; },
      [](BodyScene& s) { s.points[1][2] = 1e40; },
      [](BodyScene& s) { s.triangles[0][1] = -1; },
      [](BodyScene& s) { s.triangles[0][1] = 1000; },
      [](BodyScene& s) { s.held.push_back(1000); },
      [](BodyScene& s) { s.motion.t.pop_back(); },
      [](BodyScene& s) { std::swap(s.motion.t[0], s.motion.t[1]); },
      [](BodyScene& s) { s.motion.t[1] = s.motion.t[0]; },
      [&](BodyScene& s) { s.motion.t[1] = nan; },
      [](BodyScene& s) { s.motion.displacements.pop_back(); },
      [](BodyScene& s) { s.motion.displacements[1].pop_back(); },
      [&](BodyScene& s) { s.motion.displacements[1][2][0] = nan; },
      [](BodyScene& s) { s.motion.energy_density.pop_back(); },
      [](BodyScene& s) { s.motion.energy_density[1].pop_back(); },
      [&](BodyScene& s) { s.motion.energy_density[1][0] = nan; },
      [](BodyScene& s) { s.modes[0].shape.pop_back(); },
      [&](BodyScene& s) { s.modes[0].shape[0][0] = nan; },
      [&](BodyScene& s) { s.modes[0].frequency = nan; },
      [](BodyScene& s) { s.modes[0].frequency = -1; },
      [](BodyScene& s) { s.modes[0].owner = {1}; },
      [](BodyScene& s) {
        s.modes[0].owner = {1, 2, 3, 4, 5};
      },
      [](BodyScene& s) {
        s.modes[0].owner = {1, 1000};
      }};
  for (std::size_t k = 0; k < std::size(faults); ++k) {
    BodyScene scene = made_scene(2, 4);
    faults[k](scene);
    EXPECT_THROW(scene_text(scene), InputError) << "fault " << k;
  }
}

TEST(BodyScene, SaysHowItsPointsAreHeld) {
  BodyScene scene = made_scene(2, 4);
  EXPECT_EQ(scene_of(scene_text(scene)).held_as, "fixed");
  scene.held_as = "held by springs";
  EXPECT_EQ(scene_of(scene_text(scene)).held_as, "held by springs");
}

TEST(BodyScene, RefusesMalformedText) {
  const AnyJson good = AnyJson::parse(scene_text(made_scene(2, 4)));
  const auto refused = [](const AnyJson& json, const std::string& fault) {
    EXPECT_THROW(scene_of(json.dump()), InputError) << fault;
  };
  for (const char* text : {"", "{", "null", "[]", "7", "\"x\"", "{\"version\":1}", "\xff"})
    EXPECT_THROW(scene_of(text), InputError) << text;
  const AnyJson values[] = {
      nullptr,          -1, 1e300, 2.5, "x", "AAAA", "AAAAAAA=", AnyJson::array(), AnyJson::array({nullptr}),
      AnyJson::object()};
  for (const auto& [name, old] : good.items()) {
    AnyJson without = good;
    without.erase(name);
    if (name != "motion") refused(without, "no " + name);
    if (name == "title" || name == "caption") continue;
    for (const AnyJson& value : values) {
      // These say that there is none.
      if (value == AnyJson::array() && name == "modes") continue;
      AnyJson other = good;
      other[name] = value;
      refused(other, name + " " + value.dump());
    }
  }
  for (const char* part : {"/motion/t", "/motion/t/1", "/motion/largest", "/motion/displacements",
                           "/motion/displacements/1", "/motion/energy_largest", "/motion/energy_density/1",
                           "/modes/0/shape", "/modes/0/frequency", "/modes/0/owner", "/modes/1/owner/1"})
    for (const AnyJson& value :
         {AnyJson("AAAB"), AnyJson(nullptr), AnyJson(AnyJson::object()), AnyJson(AnyJson::array({1e6}))}) {
      AnyJson other = good;
      other[AnyJson::json_pointer(part)] = value;
      refused(other, part + (" " + value.dump()));
    }
  for (const AnyJson& value : {AnyJson(1e300), AnyJson(0.5), AnyJson(1LL << 40), AnyJson("x")}) {
    AnyJson other = good;
    other["modes"][1]["owner"][1] = value;
    refused(other, "owner " + value.dump());
  }
  // -32768 is no multiple of the largest.
  AnyJson other = good;
  std::string bytes = *decode_base64(good["motion"]["displacements"][1].get<std::string>());
  bytes[0] = '\0';
  bytes[1] = '\x80';
  other["motion"]["displacements"][1] = encode_base64(bytes);
  refused(other, "-32768");
}

TEST(BodyScene, SurvivesAnyText) {
  const std::string good = scene_text(made_scene(1, 3));
  std::mt19937 random(7);
  const auto any = [&](std::size_t below) {
    return std::uniform_int_distribution<std::size_t>(0, below - 1)(random);
  };
  for (int k = 0; k < 2000; ++k) {
    std::string text = good;
    for (std::size_t i = 0; i <= any(3); ++i) text[any(text.size())] = static_cast<char>(any(128));
    if (k % 4 == 0) text.resize(any(text.size()));
    try {
      EXPECT_NE(scene_html(text, "body"), "");
    } catch (const InputError&) {
    }
  }
}

TEST(BodyScene, HasAPlaceInAPage) {
  BodyScene scene = made_scene(2, 4);
  const std::string evil = "</script><b> & \"q\"\xff";
  scene.title = scene.caption = scene.modes[0].words = scene.modes[1].owner_words = evil;
  const std::string text = scene_text(scene), html = scene_html(text, "\"<b>");
  EXPECT_EQ(text.find('<'), std::string::npos);
  EXPECT_EQ(html.find("<b>"), std::string::npos);
  EXPECT_EQ(html.find("</script>"), html.rfind("</script>"));
  EXPECT_NE(html.find("<figure class=\"scene\" id=\"&quot;&lt;b&gt;\""), std::string::npos);
  EXPECT_NE(html.find("data-towards=\"0.45 -1 0.5\""), std::string::npos);
  EXPECT_NE(html.find("data-colours=\"#fcf3e1 "), std::string::npos);
  EXPECT_EQ(scene_of(text).title, "</script><b> & \"q\"\xef\xbf\xbd");
  // Text of others may have '<' itself.
  AnyJson json = AnyJson::parse(text);
  EXPECT_EQ(scene_html(json.dump(), "x"), scene_html(json.dump(), "x"));
  EXPECT_EQ(scene_html(json.dump(), "x").find("<b>"), std::string::npos);
}

/// The SVG in the figure.
std::string picture_in(const std::string& html) {
  const std::string opening = "image/svg+xml;base64,";
  const std::size_t begin = html.find(opening) + opening.size();
  return decode_base64(html.substr(begin, html.find('"', begin) - begin)).value_or("");
}

TEST(BodyScene, HasAPictureOfTheLargestDisplacement) {
  BodyScene scene = made_scene(2, 40);
  const std::string moved = picture_in(scene_html(scene_text(scene), "x"));
  EXPECT_NE(moved.find("t = 0.2769 s, the largest displacement of the motion: 34.7 mm."), std::string::npos)
      << moved.substr(0, 4000);
  scene.motion = {};
  EXPECT_NE(picture_in(scene_html(scene_text(scene), "x")).find("slowest mode"), std::string::npos);
  scene.modes.clear();
  const std::string still = picture_in(scene_html(scene_text(scene), "x"));
  EXPECT_NE(still.find("<svg"), std::string::npos);
  EXPECT_EQ(still.find("at rest"), std::string::npos);
}

}  // namespace
}  // namespace hmax
