/// The sentence with which input is refused.
#pragma once

#include <string>

#include "core/errors.hpp"

namespace hmax {

/// What the InputError of `action()` says; empty where it throws none.
template <class Action>
std::string input_error(Action&& action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

}  // namespace hmax
