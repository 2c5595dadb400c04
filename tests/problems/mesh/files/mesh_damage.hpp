/// Files of meshes, damaged anywhere.
#pragma once

#include <initializer_list>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

#include "problems/mesh/files/mesh_file.hpp"
#include "tests/says.hpp"

namespace hmax {

/// How many are refused of those that are cut off, have lost a byte, or have another one of `bytes`: each in
/// one sentence that begins with its name, or, of scenes of SOFA, with that of another file in quotes.
inline std::size_t refused_damages(const std::string& name, const std::string& text,
                                   std::initializer_list<char> bytes) {
  std::size_t refused = 0;
  const auto attempt = [&](const std::string& damaged) {
    const std::string told =
        error_of<std::invalid_argument>([&] { static_cast<void>(read_mesh(name, damaged)); });
    if (told.empty()) return;
    ++refused;
    EXPECT_TRUE(told.starts_with(name) || (name.ends_with(".scn") && told.starts_with("'"))) << told;
    EXPECT_EQ(told.find('\n'), std::string::npos) << told;
  };
  for (std::size_t i = 0; i < text.size(); ++i) {
    attempt(text.substr(0, i));
    attempt(text.substr(i));
    attempt(std::string(text).erase(i, 1));
    for (const char byte : bytes) attempt(std::string(text).replace(i, 1, 1, byte));
  }
  return refused;
}

}  // namespace hmax
