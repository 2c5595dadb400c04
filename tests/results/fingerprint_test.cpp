#include "results/fingerprint.hpp"

#include <gtest/gtest.h>

#include "core/errors.hpp"
#include "tests/results/scratch.hpp"
#include "tests/says.hpp"

namespace hmax {
namespace {

void put(const std::filesystem::path& file, const std::string& text) {
  std::filesystem::create_directories(file.parent_path());
  write_text(file, text);
}

TEST(Fingerprint, ReadsTheMachineFromProcAndSys) {
  Scratch root;
  const std::string processor =
      "model name\t: Intel(R) Xeon(R) Processor @ 2.50GHz\nflags\t\t: fpu vme hypervisor lahf_lm\n";
  put(root / "proc/cpuinfo", "processor\t: 0\n" + processor + "\nprocessor\t: 1\n" + processor);
  put(root / "proc/loadavg", "0.25 0.50 0.75 1/100 4242\n");
  const auto cpu0 = root / "sys/devices/system/cpu/cpu0";
  const char* caches[][3] = {{"1", "Data", "32K"},
                             {"1", "Instruction", "32K"},
                             {"2", "Unified", "1024K"},
                             {"3", "Unified", "36608K"}};
  for (int i = 0; i < 4; ++i) {
    const auto cache = cpu0 / "cache" / ("index" + std::to_string(i));
    put(cache / "level", caches[i][0]);
    put(cache / "type", caches[i][1]);
    put(cache / "size", caches[i][2]);
  }
  put(cpu0 / "cpufreq/scaling_governor", "performance\n");
  put(root / "sys/devices/system/clocksource/clocksource0/available_clocksource", "tsc kvm-clock acpi_pm\n");

  const Fingerprint print = fingerprint(root.folder());
  EXPECT_EQ(print.cpu, "Intel(R) Xeon(R) Processor @ 2.50GHz");
  EXPECT_EQ(print.cores, "2");
  EXPECT_EQ(print.caches, "L1d 32 KiB, L1i 32 KiB, L2 1 MiB, L3 35.8 MiB");
  EXPECT_EQ(print.governor, "performance");
  EXPECT_EQ(print.virtualisation, "KVM");
  EXPECT_EQ(print.load, "0.25 0.50 0.75");
}

TEST(Fingerprint, NamesTheHypervisorByFirmwareOrElseByItsClock) {
  const auto named = [](const std::string& flags, const std::string& vendor, const std::string& product,
                        const std::string& clocks) {
    Scratch root;
    put(root / "proc/cpuinfo", "processor\t: 0\nmodel name\t: x\nflags\t\t: " + flags + "\n");
    put(root / "sys/class/dmi/id/sys_vendor", vendor + "\n");
    put(root / "sys/class/dmi/id/product_name", product + "\n");
    put(root / "sys/devices/system/clocksource/clocksource0/available_clocksource", clocks + "\n");
    return fingerprint(root.folder()).virtualisation;
  };
  EXPECT_EQ(named("fpu", "QEMU", "", "tsc kvm-clock"), "none");
  EXPECT_EQ(named("hypervisor", "QEMU", "Standard PC", "tsc"), "KVM");
  EXPECT_EQ(named("hypervisor", "Microsoft Corporation", "Virtual Machine", "tsc"), "Hyper-V");
  EXPECT_EQ(named("hypervisor", "innotek GmbH", "VirtualBox", "tsc kvm-clock"), "VirtualBox");
  EXPECT_EQ(named("hypervisor", "Dell", "x", "tsc kvm-clock"), "KVM");
  EXPECT_EQ(named("hypervisor", "Dell", "x", "hyperv_clocksource_tsc_page"), "Hyper-V");
  EXPECT_EQ(named("hypervisor", "Dell", "x", "tsc"), "virtual machine");
}

TEST(Fingerprint, SaysUnknownWhereTheSystemDoesNotTell) {
  Scratch root;
  const Fingerprint print = fingerprint(root.folder());
  for (const std::string& text :
       {print.cpu, print.cores, print.caches, print.governor, print.virtualisation, print.load}) {
    EXPECT_EQ(text, "unknown");
  }
}

TEST(Fingerprint, SummaryFitsTheFootOfAFigure) {
  Fingerprint print;
  print.cpu = "Intel(R) Xeon(R) Processor @ 2.50GHz";
  print.cores = "2";
  print.virtualisation = "KVM";
  print.compiler = "g++ 12.2";
  print.flags = "-O3 -DNDEBUG -ffp-contract=off";
  print.build_type = "Release";
  print.git = "abc123";
  EXPECT_EQ(summary(print), "Intel Xeon 2.50 GHz, 2 cores, KVM; g++ 12.2 -O3, Release, git abc123");
  print.debug_build = true;
  EXPECT_TRUE(says(summary(print), "DEBUG BUILD"));
  EXPECT_EQ(summary({}), "unknown processor; unknown compiler");
}

TEST(Fingerprint, JsonComesBackAndToleratesOtherVersions) {
  Fingerprint print = fingerprint();
  print.cpu = "quotes \" and \\ and \xc3\xa4";
  print.debug_build = true;
  EXPECT_EQ(fingerprint_from_json(to_json(print)), print);
  EXPECT_EQ(fingerprint_from_json(R"({"colour": "blue", "cores": 3})"), Fingerprint{});
  EXPECT_THROW(fingerprint_from_json("nonsense"), InputError);
}

TEST(Fingerprint, DifferencesNameWhatChangedButNotTheLoad) {
  Fingerprint a, b;
  a.load = "0 0 0";
  b.load = "9 9 9";
  EXPECT_TRUE(differences(a, b).empty());
  a.kernel = "5";
  b.kernel = "6";
  b.libraries["fmt"] = "9.1";
  EXPECT_EQ(differences(a, b), (std::vector<std::string>{"kernel: 5 -> 6", "fmt: unknown -> 9.1"}));
}

}  // namespace
}  // namespace hmax
