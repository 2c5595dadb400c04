/// Structs of numbers as JSON objects, for texts and programs.
#pragma once

#include <nlohmann/json.hpp>

/// HMAX_RECORD(Type, field, ...): these fields under their names, in this order; a vector of them is an
/// array.
#define HMAX_RECORD(Type, ...)                                                                \
  inline void to_json(nlohmann::ordered_json& nlohmann_json_j, const Type& nlohmann_json_t) { \
    NLOHMANN_JSON_EXPAND(NLOHMANN_JSON_PASTE(NLOHMANN_JSON_TO, __VA_ARGS__))                  \
  }                                                                                           \
  static_assert(true, "a semicolon follows")
