/// What this build of hmax was made of: part of every fingerprint, and what `hmax doctor` prints.
#pragma once

#include <string>
#include <vector>

namespace hmax {

/// A library or program that hmax uses.
struct Part {
  std::string name;            ///< as its own project writes it
  std::string version;         ///< version at configuration; empty when it was not found
  std::string needed_for;      ///< what is missing without it
  std::string debian_package;  ///< the package that provides it
};

/// Facts fixed when hmax was configured and compiled.
struct BuildInfo {
  std::string version;               ///< of hmax
  std::string compiler;              ///< name and version
  std::string build_type;            ///< Release, RelWithDebInfo, Debug
  std::string flags;                 ///< compiler flags that numbers and times depend on
  std::string git_revision;          ///< full hash, "unknown" when built outside a checkout
  bool git_dirty = false;            ///< tracked files differed from git_revision
  bool sanitized = false;            ///< address and undefined-behaviour sanitizers are in
  std::vector<Part> libraries;       ///< required ones
  std::vector<Part> optional_parts;  ///< an empty version marks those this build is without
};

/// The facts of the running build; made once, valid for the whole run.
const BuildInfo& build_info();

}  // namespace hmax
