/// The texts of reports: Markdown files with places for what is computed.
#pragma once

#include <map>
#include <span>
#include <string>
#include <string_view>

#include "core/embedded_text.hpp"
#include "results/json.hpp"

namespace hmax {

/// cli/reproduce/texts/*.md, sorted by name; made at configuration by cmake/embed.cmake.
std::span<const EmbeddedText> report_texts();

/// @throws std::logic_error  where there is none of this name
std::string_view report_text(std::string_view name);

/// Figures, tables and links in Markdown, by "figure NAME", "table NAME" and "link NAME".
using ReportPieces = std::map<std::string, std::string>;

/// Fills the places of a text, whose values are an object:
/// - {{name}} a value: a number with six digits, a word with the signs of Markdown escaped, an array with
///   commas between its items. Infinity is "unbounded", NaN a dash.
/// - {{name:.3g}} a number in a format of fmt; {{name:3 digits}} with that many significant digits and no
///   exponent from 1000 on; {{name*1000:.3g}} times a factor.
/// - {{figure name}}, {{table name}}, {{link name}} a piece. Where a word has this name, it names the piece.
/// - {{#name}} ... {{/name}} once for each item of an array, with {{#name|, }} a separator; for an object;
///   where the value is true. Names are looked up in the item or object first. {{.}} is the item itself.
/// - {{^name}} ... {{/name}} where the value is false, or an array without items.
/// A line with nothing but one of the last two vanishes. What is null is left out without a look inside.
/// @throws std::logic_error  for a place without a value, also in a part that is not shown, a value or piece
/// without a place, and a value that does not suit its place
std::string filled(std::string_view text, const Json& values, const ReportPieces& pieces);

}  // namespace hmax
