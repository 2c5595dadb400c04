/// What a tool has done to a body: how deep it is, and how deep the surface has followed.
#pragma once

#include <optional>
#include <string>

#include <nlohmann/json.hpp>

#include "catalogue/methods/method.hpp"
#include "problems/tissue/contact.hpp"

namespace hmax {

/// The tool of a body in one state.
struct ToolReport {
  ToolContact::Reach reach;
  double stiffness;  ///< k [Pa/m^1.5]

  /// {depth, indentation, penetration, displacement, stiffness}
  [[nodiscard]] nlohmann::ordered_json json() const;
  /// "indentation 9.6 mm of 10 mm, the surface there moves 9.1 mm along its path".
  [[nodiscard]] std::string words() const;
  /// Why the indentation is less than nine tenths of the depth, or the surface less than half of it
  /// displaced, and what to do; empty where neither is so.
  [[nodiscard]] std::string warning() const;
};

bool has_tool(const Problem& problem);

/// Of ToolReport::json().
ToolReport tool_report(const nlohmann::ordered_json& document);
/// Nothing where the problem has no tool.
/// @param y  the state, or the displacements alone
std::optional<ToolReport> tool_report(const Problem& problem, double t, const Eigen::VectorXd& y);

/// The warning, if there is one; empty before the press has ended.
std::string warning_of_tool(const Problem& problem, double t, const Eigen::VectorXd& y);

}  // namespace hmax
