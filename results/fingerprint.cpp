#include "results/fingerprint.hpp"

#include <fstream>
#include <set>
#include <sstream>
#include <sys/utsname.h>
#include <unistd.h>
#include <utility>

#include <fmt/format.h>

#include "core/errors.hpp"
#include "core/instructions/instruction_set.hpp"
#include "core/numbers.hpp"
#include "core/text/digest.hpp"
#include "core/text/split.hpp"
#include "results/build_info.hpp"
#include "results/json.hpp"

#ifdef __GLIBC__
#include <gnu/libc-version.h>
#endif

namespace hmax {

namespace {

namespace fs = std::filesystem;

/// The first line of a file of /proc or /sys, "unknown" when there is none.
std::string first_line(const fs::path& file) {
  std::ifstream in(file);
  std::string line;
  std::getline(in, line);
  line = trimmed(line);
  return line.empty() ? "unknown" : line;
}

struct CpuInfo {
  std::string model = "unknown";
  int processors = 0;
  bool hypervisor = false;
};

CpuInfo read_cpuinfo(const fs::path& file) {
  CpuInfo info;
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    const auto colon = line.find(':');
    if (colon == std::string::npos) continue;
    const std::string key(trimmed(line.substr(0, colon))), value(trimmed(line.substr(colon + 1)));
    if (key == "processor") ++info.processors;
    if (key == "model name" && info.model == "unknown" && !value.empty()) info.model = value;
    if (key == "flags" && (" " + value + " ").find(" hypervisor ") != std::string::npos)
      info.hypervisor = true;
  }
  return info;
}

/// "32K" of /sys as "32 KiB"; whole MiB are written as such.
std::string cache_size(std::string text) {
  if (text.empty() || text.back() != 'K') return text;
  text.pop_back();
  const auto kib = to_number(text);
  if (!kib) return text + "K";
  return *kib >= 1024 ? fmt::format("{:.3g} MiB", *kib / 1024) : fmt::format("{:.0f} KiB", *kib);
}

std::string read_caches(const fs::path& folder) {
  std::string caches;
  for (int index = 0; index < 8; ++index) {
    const fs::path cache = folder / fmt::format("index{}", index);
    const std::string level = first_line(cache / "level"), type = first_line(cache / "type"),
                      size = first_line(cache / "size");
    if (level == "unknown" || size == "unknown") continue;
    const std::string suffix = type == "Data" ? "d" : type == "Instruction" ? "i" : "";
    caches += fmt::format("{}L{}{} {}", caches.empty() ? "" : ", ", level, suffix, cache_size(size));
  }
  return caches.empty() ? "unknown" : caches;
}

/// The hypervisor's name from the firmware tables or Xen's own entry; "virtual machine" when only the
/// processor's flag tells that there is one.
std::string read_virtualisation(const fs::path& root, const CpuInfo& info) {
  const std::string xen = first_line(root / "sys/hypervisor/type");
  if (xen == "xen") return "Xen";
  if (info.processors == 0) return "unknown";
  if (!info.hypervisor) return "none";
  const std::string firmware = first_line(root / "sys/class/dmi/id/sys_vendor") + " " +
                               first_line(root / "sys/class/dmi/id/product_name");
  const std::pair<const char*, const char*> names[] = {{"QEMU", "KVM"},          {"KVM", "KVM"},
                                                       {"Amazon EC2", "KVM"},    {"Google", "KVM"},
                                                       {"VMware", "VMware"},     {"VirtualBox", "VirtualBox"},
                                                       {"Microsoft", "Hyper-V"}, {"Parallels", "Parallels"}};
  for (const auto& [word, name] : names) {
    if (firmware.find(word) != std::string::npos) return name;
  }
  // Guests without firmware tables: the clock that the hypervisor offers names it.
  const std::string clocks =
      first_line(root / "sys/devices/system/clocksource/clocksource0/available_clocksource");
  if (clocks.find("kvm-clock") != std::string::npos) return "KVM";
  if (clocks.find("hyperv") != std::string::npos) return "Hyper-V";
  return "virtual machine";
}

std::string digest_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) return "unknown";
  Digest digest;
  for (char bytes[1 << 16]; in.read(bytes, sizeof bytes), in.gcount() > 0;)
    digest.add({bytes, static_cast<std::size_t>(in.gcount())});
  return digest.text();
}

std::string read_load(const fs::path& file) {
  std::istringstream in(first_line(file));
  std::string one, five, fifteen;
  return in >> one >> five >> fifteen ? one + " " + five + " " + fifteen : "unknown";
}

std::string read_kernel() {
  utsname name{};
  return uname(&name) == 0 ? fmt::format("{} {} {}", name.sysname, name.release, name.machine) : "unknown";
}

void read_build(Fingerprint& print) {
  const BuildInfo& build = build_info();
  const auto set = [](std::string& member, const std::string& text) {
    if (!text.empty()) member = text;
  };
  set(print.compiler, build.compiler);
  if (print.compiler.starts_with("GNU ")) print.compiler.replace(0, 3, "g++");
  if (print.compiler.starts_with("Clang ")) print.compiler.replace(0, 5, "clang++");
  set(print.flags, build.flags);
  set(print.build_type, build.build_type);
  if (!build.git_revision.empty() && build.git_revision != "unknown") {
    print.git = build.git_revision.substr(0, 12) + (build.git_dirty ? "-dirty" : "");
  }
  for (const std::vector<Part>* parts : {&build.libraries, &build.optional_parts}) {
    for (const Part& part : *parts) {
      if (!part.version.empty()) print.libraries[part.name] = part.version;
    }
  }
#ifdef __GLIBC__
  print.libraries["glibc"] = gnu_get_libc_version();
#endif
#ifndef NDEBUG
  print.debug_build = true;
#endif
  if (build.sanitized || build.build_type == "Debug") print.debug_build = true;
}

/// "Intel(R) Xeon(R) Processor @ 2.50GHz" as "Intel Xeon 2.50 GHz".
std::string short_model(std::string model) {
  for (const std::string word : {"(R)", "(TM)", "(tm)", " CPU", " Processor", " @"}) {
    for (auto at = model.find(word); at != std::string::npos; at = model.find(word))
      model.erase(at, word.size());
  }
  if (const auto at = model.find("GHz"); at != std::string::npos && at > 0 && model[at - 1] != ' ')
    model.insert(at, " ");
  std::string result;
  for (const char c : model) {
    if (c != ' ' || (!result.empty() && result.back() != ' ')) result += c;
  }
  return std::string(trimmed(result));
}

/// The member of every text, under the name it has in JSON.
constexpr std::pair<const char*, std::string Fingerprint::*> texts[] = {
    HMAX_FIELDS(Fingerprint, cpu, cores, caches, governor, virtualisation, kernel, load, compiler,
                instruction_set, flags, build_type, git, program)};

}  // namespace

Fingerprint fingerprint(const fs::path& root) {
  Fingerprint print;
  const CpuInfo info = read_cpuinfo(root / "proc/cpuinfo");
  const fs::path cpu0 = root / "sys/devices/system/cpu/cpu0";
  print.cpu = info.model;
  if (info.processors > 0) print.cores = std::to_string(info.processors);
  print.caches = read_caches(cpu0 / "cache");
  print.governor = first_line(cpu0 / "cpufreq/scaling_governor");
  print.virtualisation = read_virtualisation(root, info);
  print.kernel = read_kernel();
  print.instruction_set = to_string(instruction_sets().front());
  print.load = read_load(root / "proc/loadavg");
  read_build(print);
  // Some ten megabytes, which do not change while they run.
  static const std::string program = digest_of("/proc/self/exe");
  print.program = program;
  return print;
}

std::string to_json(const Fingerprint& fingerprint) {
  Json json;
  for (const auto& [name, member] : texts) json[name] = fingerprint.*member;
  json["libraries"] = fingerprint.libraries;
  json["debug_build"] = fingerprint.debug_build;
  return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

Fingerprint fingerprint_from_json(std::string_view text) {
  const nlohmann::json json = nlohmann::json::parse(text, nullptr, false);
  if (!json.is_object()) {
    throw InputError(
        "A machine fingerprint is not a JSON object: the store was edited; restore a copy of it.");
  }
  Fingerprint print;
  for (const auto& [name, member] : texts) {
    if (json.contains(name) && json[name].is_string()) print.*member = json[name].get<std::string>();
  }
  if (json.contains("libraries") && json["libraries"].is_object()) {
    for (const auto& [name, version] : json["libraries"].items()) {
      if (version.is_string()) print.libraries[name] = version.get<std::string>();
    }
  }
  if (json.contains("debug_build") && json["debug_build"].is_boolean())
    print.debug_build = json["debug_build"];
  return print;
}

std::string summary(const Fingerprint& fingerprint) {
  const auto known = [](const std::string& text) { return !text.empty() && text != "unknown"; };
  std::string machine = known(fingerprint.cpu) ? short_model(fingerprint.cpu) : "unknown processor";
  if (known(fingerprint.cores))
    machine += fmt::format(", {} {}", fingerprint.cores, fingerprint.cores == "1" ? "core" : "cores");
  if (known(fingerprint.virtualisation) && fingerprint.virtualisation != "none")
    machine += ", " + fingerprint.virtualisation;

  std::string build = known(fingerprint.compiler) ? fingerprint.compiler : "unknown compiler";
  // Only the optimisation flags: the rest is in the store.
  std::istringstream flags(fingerprint.flags);
  for (std::string flag; flags >> flag;) {
    if (flag.starts_with("-O") || flag.starts_with("-march") || flag.starts_with("-ffast"))
      build += " " + flag;
  }
  if (known(fingerprint.build_type)) build += ", " + fingerprint.build_type;
  if (known(fingerprint.git)) build += ", git " + fingerprint.git;
  if (fingerprint.debug_build) build += ", DEBUG BUILD";
  return machine + "; " + build;
}

std::vector<std::string> differences(const Fingerprint& before, const Fingerprint& after) {
  std::vector<std::string> clauses;
  const auto compare = [&](const std::string& name, const std::string& a, const std::string& b) {
    if (a != b) clauses.push_back(fmt::format("{}: {} -> {}", name, a, b));
  };
  for (const auto& [name, member] : texts) {
    // Every build has another program; what of it can change a time is compared by itself.
    if (member != &Fingerprint::load && member != &Fingerprint::program)
      compare(name, before.*member, after.*member);
  }
  std::set<std::string> names;
  for (const auto* libraries : {&before.libraries, &after.libraries}) {
    for (const auto& [name, version] : *libraries) names.insert(name);
  }
  const auto version_in = [](const Fingerprint& print, const std::string& name) {
    const auto found = print.libraries.find(name);
    return found == print.libraries.end() ? std::string("unknown") : found->second;
  };
  for (const std::string& name : names) compare(name, version_in(before, name), version_in(after, name));
  compare("debug build", before.debug_build ? "yes" : "no", after.debug_build ? "yes" : "no");
  return clauses;
}

}  // namespace hmax
