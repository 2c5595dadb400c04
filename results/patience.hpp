/// How long stores wait for another process that has locked them.
#pragma once

#include <string_view>

namespace hmax {

struct Patience {
  int milliseconds = 2000;                        ///< after which a call gives up
  void (*tell)(std::string_view text) = nullptr;  ///< called once for each wait of more than a second
};

/// From now on, for every store of the program.
void set_patience(Patience patience);

}  // namespace hmax
