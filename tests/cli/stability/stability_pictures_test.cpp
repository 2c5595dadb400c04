#include <cmath>
#include <filesystem>
#include <regex>

#include "tests/cli/html_links.hpp"
#include "tests/cli/program.hpp"

namespace hmax {
namespace {

using AnyJson = nlohmann::json;

AnyJson region(const Shell& shell, const std::string& options) {
  return shell.json("stability region --method " + options);
}

TEST(StabilityPictures, OneMethodIsDrawnFilledSeveralAsOutlines) {
  const Shell shell;
  region(shell, "rk4 --output pictures");
  const std::string one = read_text(shell / "pictures/region_rk4.gp");
  EXPECT_TRUE(says(one, "filledcurves"));
  EXPECT_TRUE(says(one, "real axis 2.785, imaginary axis 2.828'"));
  region(shell, "explicit_euler,rk4,bdf_2 --output pictures");
  const std::string several = read_text(shell / "pictures/regions.gp");
  EXPECT_FALSE(says(several, "filledcurves"));
  for (const char* name : {"'explicit_euler'", "'rk4'", "'bdf_2'"}) EXPECT_TRUE(says(several, name));
  EXPECT_TRUE(std::filesystem::exists(shell / "pictures/regions.dat"));
}

TEST(StabilityPictures, SayWhatIsLeftAtInfinityOfMethodsThatKeepSomethingAlone) {
  const Shell shell;
  for (const auto& [method, words] : {std::pair{"trapezoidal", "order 2, A-stable, 1 at infinity'"},
                                      {"bdf_3", "order 3, A(86.03°)-stable, 0 at infinity'"},
                                      {"implicit_euler", "order 1, A- and L-stable'"},
                                      {"rk4", "order 4'"}}) {
    region(shell, std::string(method) + " --output pictures");
    const std::string told = read_text(shell / ("pictures/region_" + std::string(method) + ".gp"));
    EXPECT_TRUE(says(told, words)) << method;
  }
}

TEST(StabilityPictures, AFileOfPointsIsStillWritten) {
  const Shell shell;
  region(shell, "rk4 --output points.csv");
  EXPECT_EQ(read_text(shell / "points.csv").rfind("method,curve,re,im\nrk4,0,", 0), 0U);
}

TEST(StabilityPictures, EqualWorkDividesThePlane) {
  const Shell shell;
  const double whole = region(shell, "rk4").at("about")[0].at("area");
  const double shared = region(shell, "rk4 --per-evaluation").at("about")[0].at("area");
  EXPECT_NEAR(shared, whole / 16, 1e-6);
  // The seventh stage of Dormand and Prince is the first of the next step.
  const double pair = region(shell, "dormand_prince_54").at("about")[0].at("area");
  const double pair_shared = region(shell, "dormand_prince_54 --per-evaluation").at("about")[0].at("area");
  EXPECT_NEAR(pair_shared, pair / 36, 1e-6);
  expect_refused(shell.hmax("stability region --method rk4,bdf_2 --per-evaluation"), "bdf_2");
}

/// Order p means p + 1 fingers of either kind at the origin.
TEST(StabilityPictures, AnOrderStarHasAFingerMoreThanItsOrder) {
  const Shell shell;
  const auto sectors = [&](const std::string& method) {
    const AnyJson document = region(shell, method + " --order-star --window -0.5,0.5,-0.5,0.5 --cells 200");
    // Sign changes around a small circle: crossings of the rims with it.
    int crossings = 0;
    for (const AnyJson& curve : document.at("curves"))
      for (std::size_t i = 0; i + 1 < curve.size(); ++i) {
        const auto radius = [&](const AnyJson& p) {
          return std::hypot(p[0].get<double>(), p[1].get<double>());
        };
        crossings += (radius(curve[i]) < 0.4) != (radius(curve[i + 1]) < 0.4);
      }
    return crossings / 2;
  };
  EXPECT_EQ(sectors("explicit_euler"), 2);
  EXPECT_EQ(sectors("rk2_heun"), 3);
  EXPECT_EQ(sectors("implicit_euler"), 2);
  expect_refused(shell.hmax("stability region --method bdf_3 --order-star"), "one-step");
  expect_refused(shell.hmax("stability region --method newmark --order-star"), "one-step");
}

TEST(StabilityPictures, AFieldShowsLevelsAndNeedsAFolder) {
  const Shell shell;
  region(shell, "adams_bashforth_2 --field --cells 60 --output pictures");
  EXPECT_TRUE(says(read_text(shell / "pictures/field_adams_bashforth_2.gp"), "≤ 0.2"));
  expect_refused(shell.hmax("stability region --method rk4 --field"), "--output");
  expect_refused(shell.hmax("stability region --method rk4 --field --output x.csv"), "folder");
  expect_refused(shell.hmax("stability region --method rk4 --field --order-star --output x"), "one of them");
}

/// Stormer and Verlet's rule with half steps of damping: omega h from 2 downwards as damping grows.
TEST(StabilityPictures, MethodsOfPositionsAndVelocitiesAreChartedOverTheirDamping) {
  const Shell shell;
  region(shell, "stormer_verlet --output pictures");
  EXPECT_TRUE(says(read_text(shell / "pictures/region_stormer_verlet.gp"), "damping ratio"));
  EXPECT_TRUE(says(read_text(shell / "pictures/region_stormer_verlet.dat"), "\n2 0\n"));
}

TEST(StabilityPictures, TheGalleryIsOnePageWithAllMethodsThatAreAskedFor) {
  const Shell shell;
  const AnyJson told = shell.json("stability gallery --methods bdf_2,newmark,rk4 --output gallery");
  EXPECT_EQ(told.at("methods"), 3);
  EXPECT_EQ(told.at("page"), "gallery/index.html");
  const std::string page = read_text(shell / "gallery/index.html");
  for (const char* text :
       {"<td>bdf_2</td>", "<td>newmark</td>", "<td>rk4</td>", ">2.785294</td>", "data:image/svg+xml,"})
    EXPECT_TRUE(says(page, text));
  // Nothing is fetched from elsewhere.
  const std::string words = without_pictures(page);
  for (const char* text : {"http://", "https://", "<script src", "<td>rk4_38</td>"})
    EXPECT_FALSE(says(words, text));
}

/// On the negative real axis RK4 ends at 2.785293563: the step at which the fastest mode of a liver gets
/// there is the one that `predict` tells.
TEST(StabilityPictures, TheSlidingSpectraTellTheStepsThatPredictTells) {
  const Shell shell;
  ASSERT_EQ(shell.hmax("stability gallery --methods rk4 --output gallery").exit_code, 0);
  const std::string moving = read_text(shell / "gallery/sliding_rk4.svg");
  EXPECT_LT(moving.size(), 100000U);
  EXPECT_TRUE(says(moving, "<animate "));
  EXPECT_FALSE(says(moving, "<script"));
  for (const std::string material : {"male_slim", "male_fat", "female_normal"}) {
    const double h =
        shell.json("stability predict --methods rk4 --problem liver_benchmark --materials " + material)
            .at("rows")[0]
            .at("h_max");
    std::smatch match;
    const std::regex line(material + "</text>\\s*<text[^>]*>([0-9.]+) s<");
    ASSERT_TRUE(std::regex_search(moving, match, line)) << material;
    EXPECT_NEAR(std::stod(match[1]), h, 6e-3 * h) << material;
  }
}

TEST(StabilityPictures, RefusesWhatCannotBeDrawn) {
  const Shell shell;
  write_text(shell / "occupied", "a file");
  expect_refused(shell.hmax("stability region --method rk4 --output occupied/folder"), "folder");
  expect_refused(shell.hmax("stability region --method rk44 --output x"), "rk44");
  expect_refused(shell.hmax("stability gallery --methods rk4 --output occupied/folder"), "folder");
  expect_refused(shell.hmax("stability gallery --methods rk44 --output x"), "rk44");
  expect_refused(shell.hmax("stability gallery"), "--output");
  expect_refused(shell.hmax("stability region --output x"), "no method is given");
  expect_refused(shell.hmax("stability region --method rk4 --window 1,0,0,1"), "no rectangle");
  // Widths and areas of these are no numbers.
  for (const char* output : {"", " --output x", " --output x --field", " --output x --order-star"}) {
    expect_refused(
        shell.hmax(std::string("stability region --method rk4 --window=-1e308,1e308,-1e308,1e308") + output),
        "--window holds -1e+308; give numbers within +-1e+150");
    expect_refused(
        shell.hmax(std::string("stability region --method rk4 --window=-8e307,8e307,-1,1") + output),
        "--window holds -8e+307");
  }
}

}  // namespace
}  // namespace hmax
