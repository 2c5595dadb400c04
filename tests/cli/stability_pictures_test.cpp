#include <cmath>
#include <filesystem>
#include <regex>

#include "tests/cli/program.hpp"

namespace hmax {
namespace {

using Json = nlohmann::json;

Json region(const Shell& shell, const std::string& options) {
  const Told told = shell.hmax("stability region --json --method " + options);
  EXPECT_EQ(told.exit_code, 0) << told.err;
  return told.json();
}

TEST(StabilityPictures, OneMethodIsDrawnFilledSeveralAsOutlines) {
  const Shell shell;
  region(shell, "rk4 --output pictures");
  const std::string one = read_text(shell / "pictures/region_rk4.gp");
  EXPECT_NE(one.find("filledcurves"), std::string::npos);
  EXPECT_NE(one.find("real axis 2.7853, imaginary axis 2.8284'"), std::string::npos);
  region(shell, "explicit_euler,rk4,bdf_2 --output pictures");
  const std::string several = read_text(shell / "pictures/regions.gp");
  EXPECT_EQ(several.find("filledcurves"), std::string::npos);
  for (const char* name : {"'explicit_euler'", "'rk4'", "'bdf_2'"})
    EXPECT_NE(several.find(name), std::string::npos) << name;
  EXPECT_TRUE(std::filesystem::exists(shell / "pictures/regions.dat"));
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
  expect_refused(shell.hmax("stability region --method rk4,bdf_2 --per-evaluation"), "bdf_2");
}

/// Order p means p + 1 fingers of either kind at the origin.
TEST(StabilityPictures, AnOrderStarHasAFingerMoreThanItsOrder) {
  const Shell shell;
  const auto sectors = [&](const std::string& method) {
    const Json document = region(shell, method + " --order-star --window -0.5,0.5,-0.5,0.5 --cells 200");
    // Sign changes around a small circle: crossings of the rims with it.
    int crossings = 0;
    for (const Json& curve : document.at("curves"))
      for (std::size_t i = 0; i + 1 < curve.size(); ++i) {
        const auto radius = [&](const Json& p) { return std::hypot(p[0].get<double>(), p[1].get<double>()); };
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
  EXPECT_NE(read_text(shell / "pictures/field_adams_bashforth_2.gp").find("≤ 0.2"), std::string::npos);
  expect_refused(shell.hmax("stability region --method rk4 --field"), "--output");
  expect_refused(shell.hmax("stability region --method rk4 --field --output x.csv"), "folder");
  expect_refused(shell.hmax("stability region --method rk4 --field --order-star --output x"), "one of them");
}

/// Stormer and Verlet's rule with half steps of damping: omega h from 2 downwards as damping grows.
TEST(StabilityPictures, MethodsOfPositionsAndVelocitiesAreChartedOverTheirDamping) {
  const Shell shell;
  region(shell, "stormer_verlet --output pictures");
  EXPECT_NE(read_text(shell / "pictures/region_stormer_verlet.gp").find("damping ratio"), std::string::npos);
  EXPECT_NE(read_text(shell / "pictures/region_stormer_verlet.dat").find("\n2 0\n"), std::string::npos);
}

TEST(StabilityPictures, RefusesWhatCannotBeDrawn) {
  const Shell shell;
  write_text(shell / "occupied", "a file");
  expect_refused(shell.hmax("stability region --method rk4 --output occupied/folder"), "folder");
  expect_refused(shell.hmax("stability region --method rk44 --output x"), "rk44");
  expect_refused(shell.hmax("stability region --output x"), "no method is given");
  expect_refused(shell.hmax("stability region --method rk4 --window 1,0,0,1"), "no rectangle");
}

}  // namespace
}  // namespace hmax
