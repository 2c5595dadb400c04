/// A body in a browser: what its script does when a user turns, plays, chooses; the picture where there is no
/// WebGL. Skipped without chromium.
#include <map>

#include <gtest/gtest.h>

#include "plots/pages/body_scene.hpp"
#include "tests/plots/pages/browser.hpp"
#include "tests/plots/pages/made_scenes.hpp"

namespace hmax {
namespace {

/// Before the script of the page: frames come in the time of the page, which does not wait for the screen,
/// and what is drawn can be read.
constexpr const char* time_and_pixels =
    "window.requestAnimationFrame = act => setTimeout(() => act(performance.now()), 16);\n"
    "const get_context = HTMLCanvasElement.prototype.getContext;\n"
    "HTMLCanvasElement.prototype.getContext = function(kind, choices) {\n"
    "  return get_context.call(this, kind, {...choices, preserveDrawingBuffer: true});\n"
    "};\n";

/// @param options  of the browser
std::map<std::string, std::string> findings(const std::string& options) {
  BodyScene scene = made_scene(4, 30);
  scene.title = "<i class=\"evil\">bar</i>";
  scene.modes.front().words = "</script><i class=\"evil\">x</i>";
  const std::string page =
      made_page(scene_html(scene_text(scene), "body"), scene_style(), time_and_pixels + scene_script());
  return findings_on(page, "body_scene_actions.js", browser(), options);
}

TEST(BodySceneInABrowser, TurnsMovesAndColours) {
  if (browser().empty())
    GTEST_SKIP() << "chromium is not installed, so the page is not driven; apt-get install chromium";
  const auto found = findings("--use-angle=swiftshader --enable-unsafe-swiftshader");
  if (const auto live = found.find("WebGL"); live != found.end() && live->second == "false")
    GTEST_SKIP() << "this chromium has no WebGL, so the body is not driven";
  const std::map<std::string, std::string> expected{
      {"WebGL", "true"},
      {"picture", "false"},
      {"picture has pixels", "true"},
      {"note", ""},
      {"painted", "true"},
      {"arrow turns", "true"},
      {"Home returns", "true"},
      {"plus zooms", "true"},
      {"button zooms", "true"},
      {"Shift shifts", "true"},
      {"Reset returns", "true"},
      {"drag turns", "true"},
      {"wheel alone", "true"},
      {"wheel with Ctrl", "true"},
      {"mesh", "true"},
      {"theme", "true"},
      {"time at first", "t = 0.29&nbsp;s, largest displacement 34.5&nbsp;mm"},
      {"time at start", "t = 0.00&nbsp;s, largest displacement 0.0&nbsp;mm"},
      {"words for the slider", "true"},
      {"deformation", "true"},
      {"colour", "true elastic energy density [kJ/m\u00b3]"},
      {"colours", "displacement [mm]"},
      {"plays", "true true"},
      {"pauses", "true"},
      {"mode plays", "true"},
      {"mode moves", "true"},
      {"words",
       "Fastest mode: it limits explicit steps. Frequency 812.4&nbsp;Hz, period 1.23&nbsp;ms. Tetrahedron 12 has 35 % "
       "of its energy. Its largest displacement is drawn as a tenth of the body's diagonal."},
      {"without time", "true"},
      {"Space pauses", "true"},
      {"element", "true"},
      {"motion waits", "true"},
      {"picture when lost", "true"},
      {"back again", "true"},
      {"markup", "0"},
      {"without names", "0"},
      {"reached by keyboard", "true"},
      {"wider than a phone", "nothing"},
      {"errors", "none"}};
  EXPECT_EQ(found, expected);
}

TEST(BodySceneInABrowser, ShowsThePictureWithoutWebGL) {
  if (browser().empty())
    GTEST_SKIP() << "chromium is not installed, so the page is not driven; apt-get install chromium";
  const std::map<std::string, std::string> expected{
      {"WebGL", "false"},
      {"picture", "true"},
      {"picture has pixels", "true"},
      {"note", "This browser offers no WebGL: a picture is shown instead of the body that turns."},
      {"markup", "0"},
      {"without names", "0"},
      {"reached by keyboard", "true"},
      {"wider than a phone", "nothing"},
      {"errors", "none"}};
  EXPECT_EQ(findings("--disable-gpu --disable-3d-apis"), expected);
}

}  // namespace
}  // namespace hmax
