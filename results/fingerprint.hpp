/// On which machine and with which build a number was measured.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace hmax {

/// Everything that a CPU time depends on besides the code. Texts are "unknown" and numbers NaN where the
/// system does not tell.
struct Fingerprint {
  std::string cpu = "unknown";     ///< model name as the kernel gives it
  std::string cores = "unknown";   ///< logical processors on line
  std::string caches = "unknown";  ///< of the first processor, "L1d 32 KiB, L1i 32 KiB, L2 1 MiB, L3 36 MiB"
  std::string governor = "unknown";         ///< frequency governor of the first processor
  std::string virtualisation = "unknown";   ///< none, or the name of the hypervisor
  std::string kernel = "unknown";           ///< name, release and architecture
  std::string load = "unknown";             ///< load averages over 1, 5 and 15 minutes when the session began
  std::string compiler = "unknown";         ///< "g++ 12.2"
  std::string instruction_set = "unknown";  ///< of the kernels: portable, avx2 or avx512
  std::string flags = "unknown";            ///< compiler flags of the build type
  std::string build_type = "unknown";       ///< Release, Debug, ...
  std::string git = "unknown";              ///< commit, with "-dirty" when the tree had changes
  std::string program = "unknown";  ///< digest of the executable: tells builds apart that git does not
  std::map<std::string, std::string> libraries;  ///< name, version
  bool debug_build = false;  ///< assertions on, or sanitizers: times are marked and never published

  bool operator==(const Fingerprint&) const = default;
};

/// The fingerprint of this process.
/// @param root  where /proc and /sys are looked for; another folder only in tests
Fingerprint fingerprint(const std::filesystem::path& root = "/");

/// One JSON object, one key per member.
std::string to_json(const Fingerprint& fingerprint);

/// Inverse of to_json; keys that are missing stay unknown, keys that are new are passed over.
/// @throws InputError when `json` is not an object
Fingerprint fingerprint_from_json(std::string_view json);

/// One line for the foot of a figure: "Intel Xeon 2.50 GHz, 2 cores, KVM; g++ 12.2 -O3, Release, git abc123".
std::string summary(const Fingerprint& fingerprint);

/// What differs between two fingerprints and can change a time, one clause per member, "kernel: A -> B"; the
/// load and the program are left out. Empty when times may be compared.
std::vector<std::string> differences(const Fingerprint& before, const Fingerprint& after);

}  // namespace hmax
