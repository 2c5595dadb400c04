#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "cli/reproduce/report_text.hpp"
#include "cli/reproduce/reproduce_oscillators.hpp"
#include "core/own_files.hpp"
#include "plots/gnuplot.hpp"
#include "tests/cli/html_links.hpp"
#include "tests/cli/program.hpp"
#include "tests/results/scratch.hpp"

namespace hmax {
namespace {

namespace fs = std::filesystem;

/// Rows as a sweep would store them: five methods at three steps, the largest too large for Euler. Method
/// number k takes (k + 1) / h microseconds a run with the step h.
std::vector<Row> made_up_rows(const std::string& parameters, double t_end) {
  const std::pair<const char*, int> methods[] = {{"explicit_euler", 1},
                                                 {"rosenbrock_23", 2},
                                                 {"trapezoidal", 2},
                                                 {"dormand_prince_54", 5},
                                                 {"adams_pece", 8}};
  std::vector<Row> rows;
  for (const std::string mode : {"fixed", "sampled"})
    for (const double h : {2.0, 0.5, 0.125}) {
      int k = 0;
      for (const auto& [method, order] : methods) {
        const double cost = ++k * 1e-6 / h;
        if (mode == "sampled" && k == 1) continue;  // no error estimate
        if (mode == "fixed" && k == 5) continue;    // no fixed step
        Row row;
        row.key.problem = "liver_forced";
        row.key.parameters = parameters;
        row.key.y0 = "0.5,1";
        row.key.method = method;
        row.key.mode = mode;
        row.key.control = mode == "fixed" ? "none" : "deadband";
        row.key.h = h;
        row.key.rtol = row.key.atol = mode == "fixed" ? 0 : 1e-6;
        row.key.t_end = row.t_reached = t_end;
        row.outcome = "reached_end";
        row.steps = static_cast<std::int64_t>(t_end / h);
        row.rhs = order * row.steps;
        row.cpu_s = {cost * 1.5, cost * 0.9, cost};
        row.error_end = row.error_global = mode == "fixed" ? 1e-3 * std::pow(h, order) : 1e-6;
        if (k == 1 && h == 2) {
          row.outcome = "diverged";
          row.t_reached = 6;
          row.error_end = row.error_global = std::numeric_limits<double>::quiet_NaN();
        }
        rows.push_back(row);
      }
    }
  return rows;
}

std::vector<std::string> reproduce_into(const fs::path& folder) {
  const StudyRows rows{.published_model = made_up_rows("m=1.45 c=2 k1=0.7 k3=0.8 P=0.5 w=0.5", 100),
                       .self_exciting = made_up_rows("m=1.45 c=-2 k1=0.7 k3=0.8 P=0.5 w=0.5", 10),
                       .machine = "no machine, made-up numbers"};
  std::vector<std::string> sections;
  const fs::path page =
      reproduce_oscillators(rows, folder, [&](const std::string& s) { sections.push_back(s); });
  EXPECT_EQ(page, folder / "index.html");
  return sections;
}

/// Every file of a folder and its bytes.
std::map<std::string, std::string> contents(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file()) files[fs::relative(entry.path(), folder).string()] = read_text(entry.path());
  return files;
}

/// Every heading of the text of a part is on its page.
void expect_headings(const std::string& page, std::string_view part) {
  static const std::regex heading("\n## [^\n]*\n");
  const std::string text(report_text(part));
  int count = 0;
  for (std::sregex_iterator it(text.begin(), text.end(), heading), end; it != end; ++it, ++count)
    EXPECT_TRUE(says(page, it->str()));
  EXPECT_GT(count, 2);
}

/// One call draws some twenty figures, so the page is judged as a whole.
TEST(ReproduceOscillators, ShowsEveryFigureAndTableLinksWhatExistsAndRepeatsItsBytes) {
  const Scratch scratch;
  const auto sections = reproduce_into(scratch / "report");
  EXPECT_EQ(sections.size(), 12U);

  const auto files = contents(scratch / "report");
  ASSERT_TRUE(files.contains("README.md"));
  const std::string& page = files.at("README.md");
  for (int figure = 1; figure <= 8; ++figure)
    EXPECT_TRUE(says(page, "\n## Figure " + std::to_string(figure) + ":")) << figure;
  EXPECT_TRUE(says(page, "\n## Table 2:"));
  expect_headings(page, "oscillators");
  EXPECT_TRUE(says(page, "made-up numbers"));

  // h [s] and milliseconds of Euler, ode45, ode23s, ode113, ode23t; a dash where Euler diverged, and where a
  // method has no such run.
  EXPECT_TRUE(says(page, "\n| 2 | – | 0.002 | 0.001 | – | 0.0015 |\n"));
  EXPECT_TRUE(says(page, "\n| 0.125 | 0.008 | 0.032 | 0.016 | – | 0.024 |\n"));
  EXPECT_TRUE(says(page, "\n| 0.125 | – | 0.032 | 0.016 | 0.04 | 0.024 |\n"));

  std::map<std::string, int> linked;  // by extension
  static const std::regex link(R"(\]\(([^)\s]+)\))");
  for (std::sregex_iterator it(page.begin(), page.end(), link), end; it != end; ++it) {
    const std::string target = (*it)[1];
    EXPECT_TRUE(files.contains(target) && !files.at(target).empty()) << target;
    ++linked[fs::path(target).extension().string()];
  }
  EXPECT_GE(linked[".gp"], 15);
  EXPECT_EQ(linked[".dat"], linked[".gp"]);
  EXPECT_EQ(linked[".png"], gnuplot_available() ? linked[".gp"] : 0);

  expect_whole_pages(scratch / "report", 20 + 3 * static_cast<std::size_t>(linked[".gp"]));

  reproduce_into(scratch / "report");
  const auto again = contents(scratch / "report");
  ASSERT_EQ(again.size(), files.size());
  for (const auto& [name, bytes] : files)
    EXPECT_TRUE(again.contains(name) && again.at(name) == bytes) << name;
}

bool is_png(const std::string& bytes) { return bytes.starts_with("\x89PNG") && bytes.size() > 65536; }

TEST(ReproduceSlice, WritesAnySliceAsPng) {
  const Shell shell;
  const nlohmann::json told = shell.json("reproduce slice --at 100,40 --angle -30 --tilt 15 --output a.png");
  EXPECT_EQ(told.at("slice"), "a.png");
  const std::string rest = read_text(shell / "a.png");
  EXPECT_TRUE(is_png(rest));
  ASSERT_EQ(shell.hmax("reproduce slice --at 100,40 --angle -30 --tilt 15 --images").exit_code, 0);
  EXPECT_TRUE(is_png(read_text(shell / "slice.png")));
  EXPECT_NE(read_text(shell / "slice.png"), rest);
  ASSERT_EQ(shell.hmax("reproduce slice --rule bone --press 4").exit_code, 0);  // over its own file
  expect_refused(shell.hmax("reproduce slice --at 300,0"), "the skin has no point 300,0 mm");
  expect_refused(shell.hmax("reproduce slice --at 3"), "--at 3 is no point of the skin");
  expect_refused(shell.hmax("reproduce slice --rule cubic"), "there is no rule 'cubic'");
  expect_refused(shell.hmax("reproduce slice --press 5"), "--press is for a slice that is deformed");
  expect_refused(shell.hmax("reproduce slice --rule bone --press 40"), "the probe presses by 40 mm");
  expect_refused(shell.hmax("reproduce slice --output a.jpg"), "the slice a.jpg would be a PNG");
}

TEST(ReproduceRealTime, ShowsWhatEverySettingMakesOfTheMaterial) {
  const Shell shell;
  const auto rows = shell.json("reproduce real-time --quick --output frames").at("rows");
  ASSERT_GE(rows.size(), 14U);
  std::set<std::string> families;
  for (const auto& row : rows) {
    families.insert(row.at("family"));
    const std::string method = row.at("method");
    ASSERT_TRUE(row.at("error_pressed").is_number()) << method;
    EXPECT_GT(row.at("error_pressed"), 0) << method;
    // Solved equations come to rest where the model does; iterations that end before do not. Stabilised steps
    // grow along the imaginary axis.
    const std::string family = row.at("family");
    if (family != "positions by iterations" && family != "stabilised") {
      EXPECT_NEAR(row.at("stiffness_shown"), 1, 1e-3) << method;
    } else if (method.starts_with("vbd:iterations=10,")) {
      EXPECT_LT(row.at("stiffness_shown"), 0.999) << method;
    }
  }
  EXPECT_EQ(families.size(), 6U);
  const std::string page = read_text(shell / "frames/README.md");
  EXPECT_TRUE(says(page, "| 1 | symplectic\\_euler |"));
  EXPECT_TRUE(says(page, "real_time.svg"));
  expect_whole_pages(shell / "frames", 1);
  EXPECT_TRUE(is_own_file(shell / "frames/real_time.json"));
}

TEST(ReproduceDocket, ComparesVerdictsWithThreads) {
  const Shell shell;
  const nlohmann::json told = shell.json("reproduce docket --output docket");
  const auto reports = told.at("reports");
  ASSERT_GE(reports.size(), 24U);
  EXPECT_GE(10 * told.at("right").get<std::size_t>(), 9 * reports.size());
  const std::string page = read_text(shell / "docket/README.md");
  for (const auto& report : reports)
    EXPECT_TRUE(says(page, "](" + report.at("link").get<std::string>() + ")")) << report.at("name");
  // Each that is wrong is discussed.
  const std::string wrong = page.substr(page.find("## Where hmax is wrong"), page.find("## Reports"));
  for (const auto& report : reports) {
    const std::string title = report.at("title");
    EXPECT_EQ(wrong.find("[" + title + "]") == std::string::npos, report.at("right").get<bool>()) << title;
  }
  expect_whole_pages(shell / "docket", 1);
  EXPECT_TRUE(is_own_file(shell / "docket/docket.json"));
  expect_refused(shell.hmax("reproduce docket --files none.toml --output own"), "none.toml: no such file");
}

/// What the page says of the thesis, and what it draws.
void expect_sentences(const std::string& page, const Shell& shell) {
  // Every statement has its judgement, in the page as in the document of the command.
  EXPECT_TRUE(says(page, "\n| 64 | Global time gain when solving linear system accurately | **"));
  EXPECT_TRUE(says(page, "\n| 63 | Accurate solution (many SOR iterations) does not allow faster solution"));
  EXPECT_TRUE(says(page, "by plain loops"));
  // The title of the regions names those that a larger mass leads into; a path that ends early has its
  // reason.
  EXPECT_TRUE(says(page, "and into the regions of rk2\\_heun and rk4"));
  EXPECT_TRUE(says(page, "\n- mass\\_spring, hanging in its weight, load: no equilibrium was found"));
  // Scenes of figure 9 have the force that is drawn and no weight.
  const std::string scene = read_text(shell / "both/tissue/figure_9_fem_green_k4.3_c6.scn");
  EXPECT_TRUE(says(scene, "<ConstantForceField"));
  EXPECT_TRUE(says(scene, "gravity=\"0 0 0\""));
  EXPECT_TRUE(is_png(read_text(shell / "both/tissue/slice_elements.png")));
}

/// `reproduce all` makes its parts once, links them and those that the folder has already.
void expect_linked(const std::string& tissue, const Shell& shell) {
  expect_refused(shell.hmax("reproduce all --part nothing"), "there is no part 'nothing'");
  const std::string all = "reproduce all --part real-time --quick --output both --json";
  const Told told = shell.hmax(all);
  ASSERT_EQ(told.exit_code, 0) << told.err;
  const auto parts = told.json().at("parts");
  ASSERT_EQ(parts.size(), 1U);
  EXPECT_EQ(parts[0].at("part"), "real-time");
  EXPECT_EQ(parts[0].at("report"), "both/real-time/index.html");
  EXPECT_GT(parts[0].at("rows"), 0);
  const std::string page = read_text(shell / "both/README.md"),
                    made = read_text(shell / "both/real-time/README.md");
  EXPECT_TRUE(says(page, "](real-time/README.md)"));
  EXPECT_TRUE(says(page, "](tissue/README.md#two-meshes)"));
  EXPECT_TRUE(says(page, "| Slide 20 |"));
  EXPECT_TRUE(says(read_text(shell / "both/index.html"), "<a href=\"tissue/index.html#two-meshes\">"));
  expect_whole_pages(shell / "both", 50);
  const Told again = shell.hmax(all);
  EXPECT_EQ(again.json().at("parts"), parts);  // with its seconds: it was not made again
  EXPECT_EQ(read_text(shell / "both/real-time/README.md"), made);
  EXPECT_EQ(read_text(shell / "both/tissue/README.md"), tissue);
}

/// The numbers of the thigh, and the figures of the page.
void expect_identified(const nlohmann::json& thigh, const Shell& shell) {
  ASSERT_EQ(thigh.at("fits").size(), 4U);
  for (const nlohmann::json& fit : thigh.at("fits")) EXPECT_LT(fit.at("overall_error"), 0.05) << fit;
  EXPECT_GT(thigh.at("fits").at(1).at("within_5_percent"), 0.7);
  // With a wrong skin the forces are right and the parameters are not.
  EXPECT_LT(thigh.at("fits").at(2).at("within_5_percent"), 0.5);
  EXPECT_EQ(thigh.at("limits").at(0).at("method"), "explicit_euler");
  EXPECT_LT(thigh.at("limits").at(0).at("h_pressed"), thigh.at("limits").at(0).at("h_rest"));
  for (const char* figure :
       {"limits_under_loads", "thigh_forces", "thigh_parameters", "thigh_network", "thigh_motion"})
    EXPECT_TRUE(std::filesystem::exists(shell / ("both/tissue/" + std::string(figure) + ".gp"))) << figure;
}

TEST(ReproduceTissue, MakesAPageWithItsPicturesWhereEverySolverFindsTheEquilibrium) {
  const Shell shell;
  expect_refused(shell.hmax("reproduce tissue --quick --device gpu"), "is for the costs of --scale");
  const nlohmann::json study = shell.json("reproduce tissue --quick --scale --output both/tissue");
  EXPECT_EQ(study.at("unsolved"), 0);
  EXPECT_GT(study.at("force_ratio"), 1);
  // Springs that resist dilation like nu = 1/4 give way more than elements of nu = 0.45.
  EXPECT_GT(study.at("deflection_springs"), study.at("deflection_elements"));
  // Undamped, symplectic Euler's limit is 2 and RK4's the root of 8 over the same frequency, and explicit
  // Euler has none; E may grow by the square of what a step is too short.
  std::map<std::string, nlohmann::json> undamped;
  for (const nlohmann::json& limit : study.at("particles"))
    if (limit.at("damping") == "none") undamped[limit.at("method")] = limit;
  EXPECT_EQ(undamped.at("explicit_euler").at("h_max"), 0);
  EXPECT_EQ(undamped.at("explicit_euler").at("stiffest"), 0);
  const double rk4 = undamped.at("rk4").at("h_max"), symplectic = undamped.at("symplectic_euler").at("h_max");
  EXPECT_NEAR(rk4 / symplectic, std::sqrt(2), 1e-6);
  EXPECT_NEAR(undamped.at("rk4").at("stiffest").get<double>(), 5300 * std::pow(280 * rk4, 2),
              2e-3 * 5300 * std::pow(280 * rk4, 2));
  EXPECT_GT(study.at("heaviest_particle"), 0);
  // Two loads, in equilibrium and in motion, three models, two methods.
  EXPECT_EQ(study.at("paths").size(), 24U);
  double largest_change = 0;
  std::map<std::string, double> alone;  // the limit of a model and a method
  for (const nlohmann::json& path : study.at("paths")) {
    const double least = path.at("h_min"), at_rest = path.at("h_rest");
    EXPECT_GT(least, 0) << path;
    largest_change = std::max(largest_change, 1 - least / at_rest);
    // Without a load every path begins with the body at rest.
    const std::string what = path.at("model").get<std::string>() +
                             " --material liver:male_normal --set g=0 --methods " +
                             path.at("method").get<std::string>();
    if (!alone.contains(what))
      alone[what] =
          shell.json("stability predict --mesh phantom --model " + what).at("rows").at(0).at("h_max");
    EXPECT_NEAR(at_rest, alone[what], 1e-6 * alone[what]) << path;
  }
  EXPECT_GT(largest_change, 0.001);
  expect_identified(study.at("thigh"), shell);
  EXPECT_TRUE(study.at("device").is_null());
  ASSERT_EQ(study.at("sizes").size(), 2U);
  for (const nlohmann::json& size : study.at("sizes"))
    for (const char* cost : {"force", "stiffness", "explicit_step", "implicit_step", "eigenvalue", "import"})
      EXPECT_GT(size.at(cost), 0) << cost;
  // 20 n^3 tetrahedra.
  EXPECT_EQ(study.at("sizes").at(1).at("tetrahedra"), 1280);
  EXPECT_TRUE(std::filesystem::exists(shell / "both/tissue/costs_over_size.gp"));
  EXPECT_FALSE(std::filesystem::exists(shell / "both/tissue/scale_study.msh"));
  const std::string page = read_text(shell / "both/tissue/README.md");
  EXPECT_TRUE(says(page, "280 steps a second"));
  EXPECT_TRUE(std::filesystem::exists(shell / "both/tissue/particles.gp"));
  for (const char* picture : {"meshes", "springs_and_elements", "modes", "tool"}) {
    EXPECT_TRUE(says(page, std::string("](") + picture + ".svg)")) << picture;
    const auto size = std::filesystem::file_size(shell / (std::string("both/tissue/") + picture + ".svg"));
    EXPECT_GT(size, 10'000U);
    EXPECT_LT(size, 1'000'000U);
  }
  expect_sentences(page, shell);
  expect_linked(page, shell);
}

}  // namespace
}  // namespace hmax
