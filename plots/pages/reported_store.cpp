#include "plots/pages/reported_store.hpp"

#include <utility>

#include <fmt/format.h>

namespace hmax {

ReportedStore reported_store(const Store& store, std::string name) {
  return {.name = std::move(name),
          .runs = store.rows(),
          .limits = store.limits(),
          .advice = store.advice(),
          .scenes = store.scenes(),
          .words = store.advice_words(),
          .sessions = store.sessions()};
}

std::string row_anchor(std::string_view table, std::size_t store, std::size_t number, std::size_t stores) {
  return stores > 1 ? fmt::format("{}-{}-{}", table, store + 1, number) : fmt::format("{}-{}", table, number);
}

}  // namespace hmax
