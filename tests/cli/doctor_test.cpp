#include <algorithm>
#include <utility>
#include <vector>

#include "core/ranks/module.hpp"
#include "tests/cli/program.hpp"

namespace hmax {
namespace {

using AnyJson = nlohmann::json;

TEST(Doctor, NamesEachPartWithItsVersionOrItsPackage) {
  const Shell shell;
  const AnyJson report = shell.hmax("doctor --json").json();
  for (const char* key : {"version", "compiler", "libraries", "optional", "missing", "fingerprint"})
    EXPECT_TRUE(report.contains(key)) << key;
  EXPECT_EQ(report.at("optional").size(), 16U)
      << "Boost, SUNDIALS, Spectra, METIS, Google Benchmark, SLEPc, OpenMPI, MuJoCo, minizip, Bullet, zlib, lz4, lzma, gnuplot, pybind11, musl";
  std::size_t missing = 0;
  for (const AnyJson& part : report.at("optional")) {
    EXPECT_NE(part.at("debian_package"), "");
    EXPECT_EQ(part.at("present"), !part.at("version").is_null());
    missing += part.at("present") ? 0 : 1;
  }
  EXPECT_EQ(report.at("missing").size(), missing);
  const std::string text = shell.hmax("doctor").out;
  for (const char* said :
       {"SUNDIALS", "Google Benchmark", "micro_explicit_rk, micro_tissue, micro_stability"})
    EXPECT_TRUE(says(text, said));
}

TEST(Doctor, SeesThatGnuplotIsGone) {
  const Told told = Shell().line("PATH=/nowhere '" HMAX_PROGRAM "' doctor");
  EXPECT_EQ(told.exit_code, 0);
  EXPECT_TRUE(says(told.out, "gnuplot-nox"));
}

TEST(Info, ShowsTheMachine) {
  const Shell shell;
  EXPECT_TRUE(says(shell.hmax("info").out, "compiler"));
  EXPECT_TRUE(shell.hmax("info --json").json().at("fingerprint").contains("cpu"));
}

TEST(Completion, KnowsCommandsOptionsAndIds) {
  const Shell shell;
  for (const char* name : {"bash", "zsh", "fish"}) {
    const std::string script = shell.hmax(std::string("completion ") + name).out;
    for (const char* word : {"run", "order", "liver_forced", "dop_853", "ode45", "tableau"})
      EXPECT_TRUE(says(script, word)) << name;
  }
  expect_refused(shell.hmax("completion tcsh"), "known are bash, zsh, fish");
}

TEST(Completion, OffersTheNamesThatFitInBash) {
  const Shell shell;
  ASSERT_EQ(shell.line("hmax completion bash >complete.sh").exit_code, 0);
  const auto offered = [&](const std::string& words, int at) {
    return shell
        .line("bash -c '. ./complete.sh; COMP_WORDS=(" + words + "); COMP_CWORD=" + std::to_string(at) +
              "; _hmax; echo \"${COMPREPLY[@]}\"'")
        .out;
  };
  EXPECT_EQ(offered("hmax or", 1), "order\n");
  EXPECT_EQ(offered("hmax run --method dop", 3), "dop_853\n");
  EXPECT_EQ(offered("hmax run --ma", 2), "--matrices --material --max-steps\n");
  EXPECT_EQ(offered("hmax list mat", 2), "materials\n");
  EXPECT_EQ(offered("hmax stability predict --me", 3), "--mesh --methods --method\n");
  EXPECT_EQ(offered("hmax stability pre", 2), "predict\n");
  EXPECT_EQ(offered("hmax stability predict", 2), "predict\n");
  EXPECT_EQ(offered("hmax export study --of l", 4), "limits\n");
  EXPECT_EQ(offered("hmax run --device g", 3), "gpu\n");
  EXPECT_EQ(offered("hmax run --t-end --", 3), "\n") << "a number stands there";
}

/// A program without the modules that lie beside it where everything was built.
TEST(Doctor, NamesModulesThatAreNotBuiltAndTheCommandThatBuildsThem) {
  const Shell shell;
  ASSERT_EQ(shell.line("mkdir -p tree/bin && cp '" HMAX_PROGRAM "' tree/bin/hmax").exit_code, 0);
  const AnyJson report = shell.line("tree/bin/hmax doctor --json").json();
  if (report.at("modules_not_built").empty()) GTEST_SKIP() << "this build has no modules";
  EXPECT_TRUE(report.at("modules").empty());
  const Told installed = shell.line("tree/bin/hmax doctor");
  EXPECT_TRUE(says(installed.out, "Not built: hmax_"));
  EXPECT_FALSE(says(installed.out, "Nothing is missing"));
  write_text(shell / "tree/CMakeCache.txt", "");
  const Told built = shell.line("tree/bin/hmax doctor");
  EXPECT_TRUE(says(built.out, "cmake --build "));
  EXPECT_TRUE(says(built.out, "--target hmax_"));
}

/// The modules of MPI, PETSc, MuJoCo, Bullet and FMI come with the program wherever their libraries are.
TEST(Doctor, FindsTheModulesThatAreBuiltWithTheProgram) {
  const AnyJson report = Shell().hmax("doctor --json").json();
  EXPECT_TRUE(report.at("modules_broken").empty()) << report.at("modules_broken");
  for (const AnyJson& part : report.at("optional"))
    for (const auto& [library, module] : {std::pair{"OpenMPI", "hmax_mpi"},
                                          {"SLEPc", "hmax_petsc"},
                                          {"MuJoCo", "hmax_mujoco"},
                                          {"Bullet", "hmax_bullet"},
                                          {"minizip", "hmax_fmi"}})
      if (part.at("name") == library && part.at("present")) {
        EXPECT_EQ(std::ranges::count(report.at("modules"), AnyJson(module)), 1) << module;
      }
}

/// Files with the names of modules that are none.
TEST(Doctor, OpensEachModuleBeforeItSaysThatNothingIsMissing) {
  const Shell shell;
  const std::vector<AnyJson> expected = shell.hmax("doctor --json").json().at("modules");
  const std::string modules =
      "tree/" + std::filesystem::relative(module_file("."), program_prefix()).string();
  ASSERT_EQ(
      shell.line("mkdir -p tree/bin tree/python/hmax " + modules + " && cp '" HMAX_PROGRAM "' tree/bin/hmax")
          .exit_code,
      0);
  for (const char* file :
       {"hmax_mpi.so", "hmax_petsc.so", "hmax_mujoco.so", "hmax_bullet.so", "hmax_fmi.so", "hmax_cuda.so"})
    write_text(shell / (modules + "/" + file), "no module");
  write_text(shell / "tree/python/hmax/_core.so", "no module");
  write_text(shell / "tree/python/hmax/__init__.py", "from . import _core\n");
  write_text(shell / "tree/CMakeCache.txt", "");
  const AnyJson report = shell.line("tree/bin/hmax doctor --json").json();
  EXPECT_TRUE(report.at("modules").empty());
  EXPECT_TRUE(report.at("modules_not_built").empty());
  std::vector<AnyJson> broken;
  for (const AnyJson& module : report.at("modules_broken")) broken.push_back(module.at("name"));
  for (const AnyJson& module : expected) EXPECT_EQ(std::ranges::count(broken, module), 1) << module;
  if (expected.empty()) GTEST_SKIP() << "this build has no modules";
  const Told told = shell.line("tree/bin/hmax doctor");
  EXPECT_TRUE(says(told.out, "Broken: the "));
  EXPECT_TRUE(says(told.out, "build or install hmax again"));
  EXPECT_FALSE(says(told.out, "Nothing is missing"));
}

}  // namespace
}  // namespace hmax
