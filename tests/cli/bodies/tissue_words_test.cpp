/// What the program says of bodies on meshes when numbers, meshes or options are not what it can use.
#include <cmath>

#include "tests/cli/program.hpp"

namespace hmax {
namespace {

using AnyJson = nlohmann::json;

/// Whether a word that is no number stands in a text.
bool holds_no_number(const std::string& text) {
  const auto is_letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; };
  for (const std::string word : {"nan", "inf"})
    for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1))
      if ((at == 0 || !is_letter(text[at - 1])) &&
          (at + word.size() == text.size() || !is_letter(text[at + word.size()])))
        return true;
  return false;
}

TEST(TissueWords, NameTheParameterThatLeavesTheRangeOfNumbers) {
  for (const char* command : {"run --method rk4 --h 0.001 --t-end 0.01", "static",
                              "stability predict --methods rk4", "stability modes", "order --method rk4"})
    for (const char* odd : {"mass=1e300", "mass=1e-300", "E=1e300", "alpha=1e300", "rho=1e300", "g=-1e300"})
      expect_refusal(std::string(command) + " --mesh phantom --set " + odd, "range of numbers");
}

TEST(TissueWords, SayWhichMeshesThereAre) {
  const auto of_mesh = [](const std::string& mesh, const std::string& named) {
    expect_refusal("run --method rk4 --h 0.001 --mesh " + mesh, named);
  };
  of_mesh("cube:n=1e9", "the parameter n of the mesh cube is 1e+09; give a whole number from 1 to 255");
  of_mesh("ball:n=1e6", "from 1 to 170");
  of_mesh("beam:n=0", "from 1 to 160");
  of_mesh("liver:refine=30", "at most 5 times");
  of_mesh("liver:refine=1e9", "at most 5 times");
  of_mesh("liver:refine=0.5", "whole number from 0 on");
  of_mesh("liver:mend=-1", "the parameter mend of the mesh liver is -1; give a whole number from 0 on");
  of_mesh("cube:edge=1e300", "from 1e-12 to 1e+12");
  of_mesh("cube:edge=1e-300", "from 1e-12 to 1e+12");
  of_mesh("ball:N=3", "'N=3' is no parameter; write them in small letters like ball:n=4,radius=0.05");
  of_mesh("ball:refine", "'refine' is no parameter");
  of_mesh("ball:", "leave the colon out");
  of_mesh("liver:fine", "like liver:refine=1");
}

TEST(TissueWords, NameUnitsAndLengthsThatNoBodyHas) {
  const Shell shell;
  ASSERT_EQ(shell.hmax("mesh make cube:n=1 --output a.msh").exit_code, 0);
  for (const char* unit : {"1e300", "1e-300", "0", "nan", "ft"})
    expect_refused(shell.hmax(std::string("static --mesh a.msh --unit ") + unit), "is no unit of length");
  // Points so far apart that volumes are no numbers.
  ASSERT_EQ(shell.line("sed 's/0\\.1/1e200/g' a.msh > far.msh").exit_code, 0);
  const std::string told = shell.text("mesh info far.msh");
  EXPECT_FALSE(holds_no_number(told)) << told;
  const AnyJson found = shell.json("mesh info far.msh");
  EXPECT_TRUE(found.at("volume").is_null());
  EXPECT_TRUE(says(found.at("status").get<std::string>(), "beyond the range of numbers: volume"));
}

TEST(TissueWords, EndAMotionWhereItIsThatOfNoBody) {
  const std::string run = "run --mesh phantom --model fem_cauchy --method rk4 --h 0.05 --t-end 50 ";
  const Told told = Shell{}.hmax(run);
  EXPECT_EQ(told.exit_code, 1);
  EXPECT_FALSE(holds_no_number(told.out)) << told.out;
  EXPECT_TRUE(says(told.out, "diverged at t = 0.15 s"));
  EXPECT_TRUE(says(told.out, "before that, at t = 0.1 s"));
  const AnyJson found = Shell{}.hmax(run + "--json").json();
  EXPECT_TRUE(found.at("energy").is_number());
  EXPECT_LT(found.at("max_displacement"), 1e4);
  EXPECT_TRUE(says(found.at("status").get<std::string>(), "diverged"));
}

TEST(TissueWords, RemarkOnABodyThatHasMovedFartherThanAnyDoes) {
  const Told told = Shell{}.hmax("run --mesh phantom --model fem_cauchy --method rk4 --h 0.01 --t-end 0.07");
  EXPECT_EQ(told.exit_code, 0);
  EXPECT_TRUE(says(told.err, "times its size"));
  EXPECT_TRUE(says(told.err, "smaller --h"));
  EXPECT_EQ(Shell{}.hmax("run --mesh phantom --method rk4 --h 0.001 --t-end 0.1").err, "");
}

TEST(TissueWords, HaveADashWhereARunHasNoError) {
  const std::string told = Shell{}.text("precision --mesh phantom --methods rk4 --h 0.1,0.001 --t-end 0.3");
  EXPECT_TRUE(says(told, "diverged"));
  EXPECT_FALSE(says(told, "undefined"));
}

TEST(TissueWords, TellHowToGetAPictureOfWhatHasDiverged) {
  const Shell shell;
  const Told told =
      shell.hmax("run --mesh phantom --method explicit_euler --h 0.1 --t-end 5 --picture a.svg");
  EXPECT_EQ(told.exit_code, 1);
  EXPECT_TRUE(says(told.err, "smaller --h"));
  EXPECT_FALSE(std::filesystem::exists(shell / "a.svg"));
}

/// Beyond the load at which a beam buckles Newton's method alone stays on the way that is no longer stable.
TEST(TissueWords, SayThatAnEquilibriumIsASaddle) {
  const Shell shell;
  const std::string beam = "static --mesh beam:n=2 --load press --model fem_neo_hookean --set force=0.6 ";
  const Told saddle = shell.hmax(beam + "--no-line-search --picture saddle.svg --json");
  EXPECT_EQ(saddle.exit_code, 0);
  EXPECT_TRUE(says(saddle.err, "this equilibrium is a saddle"));
  const AnyJson found = saddle.json();
  EXPECT_EQ(found.at("stable"), false);
  EXPECT_TRUE(says(found.at("status").get<std::string>(), "take a line search")) << found;
  EXPECT_TRUE(says(read_text(shell / "saddle.svg"), "unstable equilibrium"));
  const Told buckled = shell.hmax(beam + "--json");
  EXPECT_EQ(buckled.err, "");
  EXPECT_EQ(buckled.json().at("stable"), true);
  EXPECT_LT(buckled.json().at("energy"), found.at("energy"));
  EXPECT_TRUE(says(shell.hmax(beam + "--no-line-search").out, "converged: this equilibrium is a saddle"));
  EXPECT_TRUE(shell.json("static --mesh beam:n=2 --solver linear").at("stable").is_null());
  EXPECT_EQ(shell.hmax("static --mesh phantom --load press --no-line-search --json").err, "");
}

TEST(TissueWords, SayThatABodyBucklesAndWhatToDo) {
  const std::string beam =
      "stability predict --mesh beam:n=2 --load press --set force=0.46 --methods rk4,symplectic_euler ";
  const std::string told = Shell{}.text(beam);
  EXPECT_TRUE(says(told, "rk4, symplectic_euler: the body buckles"));
  EXPECT_TRUE(says(told, "take less load, `--along load`"));
  const AnyJson rows = Shell{}.hmax(beam + "--json").json().at("rows");
  for (const AnyJson& row : rows) {
    EXPECT_EQ(row.at("bound"), "stability") << "of the modes that do not grow";
    const double limit = row.at("method") == "rk4" ? std::sqrt(8) : 2;
    EXPECT_NEAR(row.at("h_max").get<double>() * row.at("limiting").at("omega").get<double>(), limit, 1e-6);
    EXPECT_TRUE(says(row.at("status").get<std::string>(), "buckles"));
    const AnyJson& growth = row.at("growth");
    EXPECT_GT(growth.at("re"), 0) << "the eigenvalue that grows is named, not its partner";
    EXPECT_NEAR(growth.at("doubling_time").get<double>() * growth.at("re").get<double>(), std::log(2), 1e-9);
  }
  const Told along = Shell{}.hmax(beam + "--along load");
  EXPECT_TRUE(says(along.out, "the body buckles between 0.9 and 0.925 of the load"));
  const AnyJson path = Shell{}.json(beam + "--along load").at("rows").at(0).at("along");
  EXPECT_TRUE(says(path.at("status").get<std::string>(), "buckles between 0.9 and 0.925"));
  EXPECT_GT(path.at("growing_share").get<double>(), 0);
  EXPECT_TRUE(says(Shell{}.hmax(beam + "--along").out, "the tangent grows on"));
}

TEST(TissueWords, OfTitlesFitIntoTheirPicture) {
  const Shell shell;
  const std::string
      folder = "a_folder_of_somebody/whose_names_are/longer_than_the_title/of_a_picture_has_room_for/",
      name = "the_liver_of_patient_number_seventeen_at_forty_cells.msh";
  ASSERT_EQ(shell.hmax("mesh make cube:n=1 --output " + folder + name).exit_code, 0);
  EXPECT_EQ(shell
                .hmax("static --mesh " + folder + name +
                      " --unit m --model fem_corotational --load press --solver "
                      "linear --material liver:female_normal:heavy --picture a.svg")
                .exit_code,
            0);
  const std::string svg = read_text(shell / "a.svg");
  EXPECT_FALSE(says(svg, "a_folder_of_somebody"));
  EXPECT_TRUE(says(svg, name));
  std::size_t titles = 0;
  for (std::size_t at = svg.find("font-size=\"16\""); at != std::string::npos;
       at = svg.find("font-size=\"16\"", at + 1)) {
    ++titles;
    const std::size_t from = svg.find('>', at) + 1;
    EXPECT_LE(svg.find('<', from) - from, 90U) << svg.substr(from, 200);
  }
  EXPECT_EQ(titles, 2U);
}

TEST(TissueWords, SayThatNothingLoadsABody) {
  for (const char* set : {"press --set force=0", "gravity --set g=0"})
    expect_refusal(std::string("stability predict --mesh phantom --methods rk4 --along load --load ") + set,
                   "nothing loads fem_green");
}

TEST(TissueWords, RefuseOptionsOfStaticEquilibriaThatHaveNoSay) {
  const auto refused = [](const std::string& options, const std::string& option) {
    expect_refusal("static --mesh phantom --load press " + options, option);
  };
  refused("--relaxation 1.2", "--relaxation is of sor");
  refused("--relaxation 1.2 --linear cg", "--relaxation is of sor");
  refused("--linear-tolerance 1e-3", "--linear-tolerance is of iterative");
  for (const char* option : {"--load-steps 3", "--iterations 3", "--tolerance 1e-3", "--no-line-search"})
    refused(std::string("--solver linear ") + option, "cannot be combined with --solver linear");
  refused("--compare out --solver newton", "--solver cannot be combined with --compare");
  refused("--compare out --linear direct", "--linear cannot be combined with --compare");
  refused("--compare out --output a.csv", "--output writes the residuals of one solver");
  refused("--compare out --pseudo-dynamic 2", "choose one");
  refused("--frames 3 --output a.csv", "--output writes the residuals of one equilibrium");
  refused("--frames 3 --load-steps 3", "--load-steps cannot be combined with frames");
  refused("--pseudo-dynamic 2 --iterations 3", "--iterations cannot be combined with frames");
  refused("--pseudo-dynamic 2 --no-line-search", "--no-line-search is always on in frames");
  refused("--frames 3 --solver linear", "--solver linear solves one system, and frames iterate");
  refused("--load-scale 1e300", "--load-scale is 1e+300 but must be a number between");
  refused("--output a.svg", "FILE.csv");
  refused("--model mass_spring --picture a.svg --colour energy_density", "springs have no energy density");
}

TEST(TissueWords, RefuseOptionsOfOtherProblems) {
  const std::string body = "run --mesh phantom --method newmark --h 0.01 --t-end 0.1 ",
                    two = "run --problem liver_linear --method newmark --h 0.01 --t-end 0.1 ";
  expect_refusal(body + "--full", "--json");
  expect_refusal(two + "--full --json", "shows all its states without --full");
  expect_refusal(two + "--linear cg", "leave --linear out");
  expect_refusal(two + "--unit mm", "--unit is of a mesh file");
  for (const AnyJson& method : Shell{}.json("list methods"))
    if (method.at("engine") != "hmax" && method.at("needs_jacobian") && method.at("fixed_step"))
      expect_refusal("run --mesh phantom --h 0.01 --t-end 0.1 --linear cg --method " +
                         method.at("id").get<std::string>(),
                     "leave --linear out");
  expect_refusal("sweep --problem liver_linear --methods rk4 --h 0.1 --fixed --unit mm --t-end 1",
                 "leave it out");
  expect_refusal(body + "--output a.svg", "FILE.pvd");
  EXPECT_EQ(Shell{}.hmax("mesh info --mesh phantom").exit_code, 0) << "as other commands name it";
  EXPECT_EQ(Shell{}.hmax("precision --mesh phantom --methods rk4 --h 1e-3 --t-end 0.01").exit_code, 0);
  expect_refusal("stability map --mesh phantom --method rk4 --rayleigh --x alpha=0:10:3 --y beta=0:0.1:3",
                 "leave --rayleigh out");
  expect_refusal("mesh convert phantom a.vtu --model fem_green", "--model");
  // Before the hour of integrating, not after it.
  expect_refusal(
      "run --mesh phantom --model mass_spring --method rk4 --h 1e-6 --t-end 1000 --picture a.svg --colour "
      "energy_density",
      "springs have no energy density");
}

}  // namespace
}  // namespace hmax
