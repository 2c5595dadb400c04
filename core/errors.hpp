/// Errors that reach a user.
#pragma once

#include <stdexcept>

namespace hmax {

/// Bad input or usage, told in one sentence that names what is wrong and the remedy. The command exits
/// with 2.
struct InputError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// What `make` returns; what it refuses as lower floors do, for the user.
template <class Make>
auto told_to_user(const Make& make) {
  try {
    return make();
  } catch (const std::invalid_argument& error) {
    throw InputError(error.what());
  }
}

}  // namespace hmax
