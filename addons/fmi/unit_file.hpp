/// A file of FMI 2.0: an archive with a description and a library.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "addons/fmi/fmi2.hpp"

namespace hmax::fmi {

/// What modelDescription.xml says of one of both types of a unit.
struct Offer {
  std::string identifier;  ///< names the library; empty where the unit is not of this type
  bool needs_tool = false;
};

struct UnitFile {
  std::filesystem::path folder;  ///< in which it is unpacked
  std::string guid;
  std::array<Offer, 2> offers;  ///< by Type
  struct State {
    std::string name;
    Reference reference = 0;
    bool has_start = false;  ///< a value that may be set before the unit is initialised
  };
  std::vector<State> states;            ///< continuous ones
  double start = 0, end = 1, step = 0;  ///< of the default experiment [s]; step 0 where it names none

  [[nodiscard]] const Offer& offer(Type type) const { return offers.at(static_cast<std::size_t>(type)); }
};

/// Unpacks what Linux needs of it into a folder of its own where temporary files go, up to 1 GB in 10,000
/// files, and reads the description.
/// @throws Failure  where the file is damaged, or an entry would lie outside of that folder
UnitFile open_unit(const std::string& file);

}  // namespace hmax::fmi
