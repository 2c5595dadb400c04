/// Numbers in JSON documents.
#pragma once

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

namespace hmax {

/// A number, "unbounded" for infinity, null for NaN.
inline nlohmann::ordered_json number_or_word(double value) {
  if (std::isinf(value)) return "unbounded";
  return std::isnan(value) ? nullptr : nlohmann::ordered_json(value);
}

/// {name: value}
inline nlohmann::ordered_json parameters_json(const std::vector<std::pair<std::string, double>>& parameters) {
  nlohmann::ordered_json object = nlohmann::ordered_json::object();
  for (const auto& [name, value] : parameters) object[name] = value;
  return object;
}

}  // namespace hmax
