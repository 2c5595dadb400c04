/// hmax probe and --plugin on units of FMI 2.0, where their module was built.
#include <filesystem>
#include <fstream>
#include <iterator>

#include <gtest/gtest.h>

#include "core/ranks/module.hpp"
#include "tests/cli/program.hpp"
#include "tests/results/scratch.hpp"

namespace hmax {
namespace {

/// What a unit of tested_unit.cpp says of itself.
struct Described {
  std::string guid, type = "ModelExchange", attributes = {}, version = "2.0";
  int states = 1;
  std::string initial = "initial=\"exact\"", experiment = "stepSize=\"0.005\" stopTime=\"2\"";
};

std::string description_of(const Described& unit) {
  return "<?xml version=\"1.0\"?>\n<fmiModelDescription fmiVersion=\"" + unit.version + "\" guid=\"" +
         unit.guid + "\"><" + unit.type + " modelIdentifier=\"tested_unit\" " + unit.attributes +
         "/><DefaultExperiment " + unit.experiment +
         "/><ModelVariables>"
         "<ScalarVariable name=\"x\" valueReference=\"7\" " +
         unit.initial +
         "><Real start=\"1\"/></ScalarVariable>"
         "<ScalarVariable name=\"v\" valueReference=\"8\" " +
         unit.initial +
         "><Real start=\"0\"/></ScalarVariable>"
         "<ScalarVariable name=\"der(x)\" valueReference=\"17\"><Real derivative=\"1\"/></ScalarVariable>"
         "<ScalarVariable name=\"der(v)\" valueReference=\"18\"><Real derivative=\"2\"/></ScalarVariable>"
         "</ModelVariables><ModelStructure><Derivatives>" +
         (unit.states > 0 ? "<Unknown index=\"3\"/>" : "") +
         (unit.states > 1 ? "<Unknown index=\"4\"/>" : "") +
         "</Derivatives></ModelStructure></fmiModelDescription>";
}

const Described oscillator{.guid = "oscillator", .type = "CoSimulation", .states = 2};

class ProbeUnit : public testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(module_file("hmax_fmi.so")))
      GTEST_SKIP() << "this build has no module for FMI: libminizip-dev was missing";
    ASSERT_EQ(
        shell_.line("mkdir -p binaries/linux64 tmp && cp '" TESTED_UNIT "' binaries/linux64/tested_unit.so")
            .exit_code,
        0);
  }
  void TearDown() override {
    std::error_code none;
    EXPECT_TRUE(!std::filesystem::exists(shell_ / "tmp", none) ||
                std::filesystem::is_empty(shell_ / "tmp", none))
        << "a folder is left";
  }
  void pack(const Described& unit, const std::string& files = "modelDescription.xml binaries") const {
    write_text(shell_ / "modelDescription.xml", description_of(unit));
    ASSERT_EQ(shell_.line("'" HMAX_CMAKE "' -E tar cf unit.fmu --format=zip " + files).exit_code, 0);
  }
  [[nodiscard]] Told hmax(const std::string& arguments) const {
    return shell_.line("TMPDIR=\"$PWD/tmp\" hmax " + arguments);
  }
  [[nodiscard]] Told probe(const Described& unit, const std::string& rest = "") const {
    pack(unit);
    return hmax("probe unit.fmu " + rest);
  }
  [[nodiscard]] nlohmann::json found(const Described& unit, const std::string& rest = "") const {
    const Told told = probe(unit, rest + " --json");
    EXPECT_EQ(told.exit_code, 0) << told.err;
    return told.json();
  }
  Shell shell_;
};

TEST_F(ProbeUnit, ModelExchangeIsSteppedByExplicitEuler) {
  const nlohmann::json all = found({.guid = "decay"});
  EXPECT_EQ(all["model"], "unit.fmu");
  EXPECT_EQ(all["engine"], "FMI 2.0, model exchange by explicit Euler");
  EXPECT_NEAR(all["h_max"].get<double>(), 0.002, 1e-6);
  EXPECT_NEAR(all["observed"].get<double>(), 0.002, 1e-5);
  EXPECT_EQ(all["timestep"], 0.005);
  EXPECT_EQ(all["stable"], false);
  EXPECT_EQ(all["substeps"], 3);
  // Beyond its bounds the unit fails, and begins again.
  EXPECT_NEAR(found({.guid = "bounded"})["observed"].get<double>(), 0.002, 1e-5);
}

TEST_F(ProbeUnit, CoSimulationStepsItself) {
  // Semi-implicit Euler: omega h = 2.
  const nlohmann::json all = found(oscillator);
  EXPECT_EQ(all["engine"], "FMI 2.0, co-simulation");
  EXPECT_EQ(all["dim"], 2);
  EXPECT_NEAR(all["h_max"].get<double>(), 0.02, 2e-6);
  EXPECT_NEAR(all["observed"].get<double>(), 0.02, 2e-5);
  EXPECT_EQ(all["stable"], true);
  // Without a step of its own the sizes are asked for.
  Described unit = oscillator;
  unit.experiment = "";
  expect_refused(probe(unit), "give the step sizes to look at");
  EXPECT_FALSE(found(unit, "--h0 1e-4 --h1 0.1").contains("timestep"));
}

TEST_F(ProbeUnit, RunsShowWhatOneStepOfAUnitWithInnerStepsDoesNot) {
  // Inner steps of 0.03 s grow, and none of them is made in the first 0.02 s.
  Described unit = oscillator;
  unit.guid = "inner";
  const Told told = probe(unit, "--h0 0.005 --h1 0.02 --json");
  EXPECT_EQ(told.exit_code, 1);
  EXPECT_EQ(told.json()["h_max"], "unbounded");
  EXPECT_EQ(told.json()["contradiction"], true);
  // Longer ones show it.
  EXPECT_NEAR(found(unit, "--h0 0.02 --h1 0.05 --no-runs")["h_max"].get<double>(), 0.03, 1e-5);
}

TEST_F(ProbeUnit, StepsThatAreRefusedAreNoSteps) {
  for (const char* guid : {"discard", "error"}) {
    Described unit = oscillator;
    unit.guid = guid;
    const nlohmann::json all = found(unit);
    EXPECT_NEAR(all["h_max"].get<double>(), 0.01, 1e-5) << guid;
    EXPECT_NEAR(all["observed"].get<double>(), 0.01, 1e-5) << guid;
  }
}

TEST_F(ProbeUnit, EquationsAreAModelForEveryMethod) {
  pack({.guid = "decay"});
  const Told told =
      hmax("stability predict --plugin unit.fmu --methods explicit_euler,rk4 --along none --json");
  ASSERT_EQ(told.exit_code, 0) << told.err;
  const nlohmann::json rows = told.json()["rows"];
  EXPECT_NEAR(rows[0]["h_max"].get<double>(), 0.002, 1e-9);
  EXPECT_NEAR(rows[1]["h_max"].get<double>(), 2.785293563e-3, 1e-9);
  EXPECT_TRUE(says(rows[0]["problem"].get<std::string>(), "tested_unit#"));
  const Told words = hmax("stability predict --plugin unit.fmu --methods rk4 --along none");
  EXPECT_TRUE(says(words.out, "Jacobian central differences"));
  // The states have the names of the unit.
  EXPECT_TRUE(says(hmax("run --plugin unit.fmu --method rk4 --h 1e-4 --t-end 1e-3").out, "\n  x   0.36787"));
  // Time begins where the experiment does: x' = -1000 x + t from t = 3.
  pack({.guid = "forced", .experiment = "startTime=\"3\" stopTime=\"5\""});
  const nlohmann::json run = hmax("run --plugin unit.fmu --method rk4 --h 1e-3 --json").json();
  EXPECT_EQ(run["t"], 2);
  EXPECT_NEAR(run["y"][0].get<double>(), 5e-3 - 1e-6, 1e-10);
  pack(oscillator);
  expect_refused(hmax("stability predict --plugin unit.fmu --methods rk4"),
                 "it is of co-simulation alone, without equations to call");
  EXPECT_NEAR(hmax("probe --plugin unit.fmu --json").json()["h_max"].get<double>(), 0.02, 2e-6);
}

TEST_F(ProbeUnit, ReadsItsResources) {
  ASSERT_EQ(shell_.line("mkdir resources && echo 500 > resources/rate.txt").exit_code, 0);
  pack({.guid = "resource"}, "modelDescription.xml binaries resources");
  EXPECT_NEAR(hmax("probe unit.fmu --json").json()["h_max"].get<double>(), 0.004, 2e-6);
}

TEST_F(ProbeUnit, RefusesWhatCannotBeProbed) {
  Described unit = oscillator;
  unit.initial = "initial=\"calculated\"";
  expect_refused(probe(unit), "unit.fmu: its state 'x' is calculated at the start and cannot be set");
  unit = oscillator;
  unit.guid = "stuck";
  expect_refused(probe(unit), "its state 'x' does not take the start value that is set");
  unit.states = 0;
  expect_refused(probe(unit), "it lists no continuous states");
  unit = oscillator;
  unit.attributes = "needsExecutionTool=\"true\"";
  expect_refused(probe(unit), "it runs in the program that exported it alone");
  expect_refused(probe({.guid = "refuses"}),
                 "fmi2Instantiate() made no instance: the guid 'refuses' is of another unit");
  expect_refused(probe({.guid = "ends"}), "it ends at its start");
  expect_refused(probe({.guid = "decay", .version = "3.0"}), "it is of version '3.0' of FMI");
  expect_refused(probe({.guid = "decay", .type = "Other"}), "neither of model exchange nor of co-simulation");
  expect_refused(probe({.guid = "decay", .experiment = "startTime=\"3\" stopTime=\"2\""}),
                 "DefaultExperiment");
  expect_refused(probe({.guid = "decay"}, "--keyframe home"), "--keyframe is one of a scene of MuJoCo");
}

TEST_F(ProbeUnit, RefusesDamagedFiles) {
  pack({.guid = "decay"}, "modelDescription.xml");
  expect_refused(hmax("probe unit.fmu"), "it has no binaries/linux64/tested_unit.so");
  pack({.guid = "decay"}, "binaries");
  expect_refused(hmax("probe unit.fmu"), "it has no modelDescription.xml");
  write_text(shell_ / "binaries/linux64/tested_unit.so", "no library");
  expect_refused(probe({.guid = "decay"}), "its library cannot be loaded");
  pack({.guid = "decay\"<"});
  expect_refused(hmax("probe unit.fmu"), "modelDescription.xml, line 2: ");
  write_text(shell_ / "unit.fmu", "no archive");
  expect_refused(hmax("probe unit.fmu"), "the archive (zip) is damaged or none");
  write_text(shell_ / "unit.fmu", "");
  expect_refused(hmax("probe unit.fmu"), "unit.fmu: ");
}

TEST_F(ProbeUnit, NeverWritesOutsideOfItsFolder) {
  ASSERT_EQ(shell_.line("mkdir -p aa/resources && echo evil > aa/resources/evil.txt").exit_code, 0);
  pack({.guid = "decay"}, "modelDescription.xml binaries aa");
  std::ifstream in(shell_ / "unit.fmu", std::ios::binary);
  const std::string whole{std::istreambuf_iterator<char>(in), {}};
  for (const std::string name : {"..", "/a"}) {
    std::string changed = whole;
    for (std::size_t at = 0; (at = changed.find("aa/resources", at)) != changed.npos; at += 2)
      changed.replace(at, 2, name);
    write_text(shell_ / "unit.fmu", changed);
    expect_refused(hmax("probe unit.fmu"), "would lie outside of it");
  }
}

TEST_F(ProbeUnit, CrashesAndHangsAreErrors) {
  Described unit = oscillator;
  unit.guid = "crash";
  expect_refused(probe(unit), "the unit crashed in step(");
  unit.guid = "fatal";
  expect_refused(probe(unit), "no licence for 2 steps");
  unit.guid = "hang";
  expect_refused(probe(unit, "--timeout 0.2"), "the unit did not return within 0.2 s in step(");
}

}  // namespace
}  // namespace hmax
