#include "plots/pages/reported_store.hpp"

#include <fmt/format.h>

namespace hmax {

std::string row_anchor(std::string_view table, std::size_t store, std::size_t number, std::size_t stores) {
  return stores > 1 ? fmt::format("{}-{}-{}", table, store + 1, number) : fmt::format("{}-{}", table, number);
}

}  // namespace hmax
