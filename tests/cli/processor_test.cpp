/// The processor decides how fast hmax is, not what it computes.
#include "core/instructions/instruction_set.hpp"
#include "tests/cli/program.hpp"

namespace hmax {
namespace {

using AnyJson = nlohmann::json;

/// Begins a line: glibc takes its variants for processors without FMA and AVX2.
constexpr const char* plain_processor = "export GLIBC_TUNABLES=glibc.cpu.hwcaps=-FMA,-FMA4,-AVX2; ";

bool has_elementary_functions(const Shell& shell) {
  const AnyJson report = shell.json("doctor");
  for (const AnyJson& part : report.at("optional"))
    if (part.at("name") == "musl") return part.at("present");
  ADD_FAILURE() << "hmax doctor does not know musl";
  return false;
}

TEST(Processor, DoesNotChangeABitOfTheAccuracySuite) {
  const Shell shell;
  if (!has_elementary_functions(shell)) GTEST_SKIP() << "built without musl";
  const std::string check = "hmax check --update --baseline ";
  ASSERT_EQ(shell.line(check + "here.csv").exit_code, 0);
  ASSERT_EQ(shell.line(plain_processor + check + "plain.csv").exit_code, 0);
  EXPECT_EQ(read_text(shell / "here.csv"), read_text(shell / "plain.csv"));
}

TEST(Processor, DoesNotChangeABitOfFormulas) {
  const Shell shell;
  if (!has_elementary_functions(shell)) GTEST_SKIP() << "built without musl";
  write_text(shell / "swing.toml",
             "[problem]\nt_end = 10\n[equations]\nangle = \"rate\"\n"
             "rate = \"-9.81*sin(angle) - 0.1*exp(cos(t))*rate + ln(2 + t^0.3)\"\n"
             "[initial]\nangle = 1\nrate = 0.5\n");
  const std::string run = "hmax run --problem swing.toml --method rodas_4 --rtol 1e-6 --atol 1e-9 --json";
  const Told here = shell.line(run), plain = shell.line(plain_processor + run);
  ASSERT_EQ(here.exit_code, 0) << here.err;
  EXPECT_EQ(here.json().at("y"), plain.json().at("y"));
  EXPECT_EQ(here.json().at("stats"), plain.json().at("stats"));
}

TEST(Processor, DoesNotChangeABitOfTissue) {
  const Shell shell;
  const std::string body = "--mesh phantom --material liver:male_normal --model ";
  const auto end_of = [&](const std::string& line) {
    const AnyJson run = shell.line(line).json();
    return AnyJson{run.at("y"), run.at("stats")};
  };
  for (const char* method :
       {"fem_green --method newmark --h 0.01", "fem_green --method rodas_4 --rtol 1e-4 --atol 1e-6",
        "fem_neo_hookean --method vbd --h 0.01", "fem_corotational --method vbd --h 0.01",
        "fem_neo_hookean --method xpbd --h 0.01"}) {
    const std::string run = "hmax run " + body + method + " --t-end 0.1 --full --json";
    const AnyJson here = end_of(run);
    for (const InstructionSet set : instruction_sets())
      EXPECT_EQ(here, end_of("export HMAX_KERNELS=" + std::string(to_string(set)) + "; " + run))
          << to_string(set) << " " << method;
  }
}

TEST(Processor, KernelsAreChosenByTheEnvironmentAndNamed) {
  const Shell shell;
  for (const InstructionSet set : instruction_sets()) {
    const std::string name(to_string(set)), choice = "export HMAX_KERNELS=" + name + "; ";
    EXPECT_EQ(shell.line(choice + "hmax doctor --json").json().at("fingerprint").at("instruction_set"), name);
    EXPECT_TRUE(says(shell.line(choice + "hmax doctor").out, "kernels: " + name));
  }
}

TEST(Processor, KernelsThatItDoesNotHaveAreRefused) {
  expect_refused(Shell().line("export HMAX_KERNELS=sse9; hmax list methods"), "sse9");
}

}  // namespace
}  // namespace hmax
