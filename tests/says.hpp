/// What texts and errors say.
#pragma once

#include <string>
#include <string_view>

#include <gtest/gtest.h>

namespace hmax {

/// Whether `part` stands in `text`; a failure shows both.
inline testing::AssertionResult says(std::string_view text, std::string_view part) {
  const bool found = text.find(part) != std::string_view::npos;
  return (found ? testing::AssertionSuccess() : testing::AssertionFailure())
         << "'" << part << "' in: " << text;
}

/// What the `Error` of `action()` says; empty where it throws none.
template <class Error, class Action>
std::string error_of(const Action& action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

}  // namespace hmax
