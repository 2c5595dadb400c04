#include "tests/cli/program.hpp"

namespace hmax {
namespace {

using Json = nlohmann::json;

TEST(Doctor, NamesEachPartWithItsVersionOrItsPackage) {
  const Shell shell;
  const Json report = shell.hmax("doctor --json").json();
  for (const char* key : {"version", "compiler", "libraries", "optional", "missing", "fingerprint"})
    EXPECT_TRUE(report.contains(key)) << key;
  EXPECT_EQ(report.at("optional").size(), 12U)
      << "Boost, SUNDIALS, Spectra, METIS, SLEPc, OpenMPI, zlib, lz4, lzma, gnuplot, pybind11, musl";
  std::size_t missing = 0;
  for (const Json& part : report.at("optional")) {
    EXPECT_NE(part.at("debian_package"), "");
    EXPECT_EQ(part.at("present"), !part.at("version").is_null());
    missing += part.at("present") ? 0 : 1;
  }
  EXPECT_EQ(report.at("missing").size(), missing);
  EXPECT_NE(shell.hmax("doctor").out.find("SUNDIALS"), std::string::npos);
}

TEST(Doctor, SeesThatGnuplotIsGone) {
  const Told told = Shell().line("PATH=/nowhere '" HMAX_PROGRAM "' doctor");
  EXPECT_EQ(told.exit_code, 0);
  EXPECT_NE(told.out.find("gnuplot-nox"), std::string::npos) << told.out;
}

TEST(Info, ShowsTheMachine) {
  const Shell shell;
  EXPECT_NE(shell.hmax("info").out.find("compiler"), std::string::npos);
  EXPECT_TRUE(shell.hmax("info --json").json().at("fingerprint").contains("cpu"));
}

TEST(Completion, KnowsCommandsOptionsAndIds) {
  const Shell shell;
  for (const char* name : {"bash", "zsh", "fish"}) {
    const std::string script = shell.hmax(std::string("completion ") + name).out;
    for (const char* word : {"run", "order", "liver_forced", "dop_853", "ode45", "tableau"})
      EXPECT_NE(script.find(word), std::string::npos) << name << " " << word;
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
}

/// A program without the modules that lie beside it where everything was built.
TEST(Doctor, NamesModulesThatAreNotBuiltAndTheCommandThatBuildsThem) {
  const Shell shell;
  ASSERT_EQ(shell.line("mkdir -p tree/bin && cp '" HMAX_PROGRAM "' tree/bin/hmax").exit_code, 0);
  const Json report = shell.line("tree/bin/hmax doctor --json").json();
  if (report.at("modules_not_built").empty()) GTEST_SKIP() << "this build has no modules";
  EXPECT_TRUE(report.at("modules").empty());
  const Told installed = shell.line("tree/bin/hmax doctor");
  EXPECT_NE(installed.out.find("Not built: hmax_"), std::string::npos) << installed.out;
  EXPECT_EQ(installed.out.find("Nothing is missing"), std::string::npos) << installed.out;
  write_text(shell / "tree/CMakeCache.txt", "");
  const Told built = shell.line("tree/bin/hmax doctor");
  EXPECT_NE(built.out.find("cmake --build "), std::string::npos) << built.out;
  EXPECT_NE(built.out.find("--target hmax_"), std::string::npos) << built.out;
}

}  // namespace
}  // namespace hmax
