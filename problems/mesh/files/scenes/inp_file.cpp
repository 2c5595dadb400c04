#include "problems/mesh/files/scenes/inp_file.hpp"

#include <algorithm>

namespace hmax {

namespace {

std::string_view without_blanks(std::string_view text) {
  constexpr std::string_view blanks = " \t\r\f\v";
  const std::size_t begin = text.find_first_not_of(blanks);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(blanks) - begin + 1);
}

/// The parts between commas; a comma at the end, after which a list goes on, begins none.
std::vector<std::string_view> between_commas(std::string_view line) {
  std::vector<std::string_view> parts;
  while (!line.empty()) {
    const std::size_t comma = std::min(line.find(','), line.size());
    parts.push_back(without_blanks(line.substr(0, comma)));
    line.remove_prefix(std::min(comma + 1, line.size()));
  }
  return parts;
}

void add_parameters(InpCard& card, const std::vector<std::string_view>& parts, std::size_t first) {
  for (std::size_t i = first; i < parts.size(); ++i) {
    const std::size_t equals = std::min(parts[i].find('='), parts[i].size());
    card.parameters.emplace_back(
        upper(without_blanks(parts[i].substr(0, equals))),
        upper(without_blanks(parts[i].substr(std::min(equals + 1, parts[i].size())))));
  }
}

}  // namespace

std::string upper(std::string_view text) {
  std::string result(text);
  for (char& c : result)
    if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
  return result;
}

std::optional<std::string> InpCard::parameter(std::string_view name) const {
  const auto found = std::ranges::find(parameters, name, &std::pair<std::string, std::string>::first);
  return found == parameters.end() ? std::nullopt : std::optional(found->second);
}

InpFile::InpFile(const std::string& name, std::string_view bytes) : text_(name, bytes) {
  MeshText lines = text_;
  bool goes_on = false;  // a keyword whose parameters are continued on the next line
  for (std::int64_t place = 1; lines.left() > 0; ++place) {
    const std::string_view line = without_blanks(lines.line());
    if (line.empty() || line.starts_with("**")) continue;
    const bool begins = line.starts_with('*');
    if (begins || goes_on) {
      if (begins) cards_.emplace_back().place = place;
      InpCard& card = cards_.back();
      const std::vector<std::string_view> parts = between_commas(line.substr(begins ? 1 : 0));
      if (begins && !parts.empty()) card.keyword = upper(parts.front());
      add_parameters(card, parts, begins ? 1 : 0);
      goes_on = line.ends_with(',');
    } else if (cards_.empty()) {
      fail(place, "an input file begins with a keyword such as *NODE and not with " + in_quotes(line) +
                      "; export it again or correct the extension");
    } else {
      cards_.back().lines.push_back({.place = place, .fields = between_commas(line)});
    }
  }
  if (!bytes.empty() && bytes.back() != '\n')
    lines.fail(
        "the last line has no end; the file is cut off, so copy or export it again, or add a line break");
}

MeshText InpFile::value(const InpLine& line, std::size_t field, const char* what) const {
  if (field >= line.fields.size() || line.fields[field].empty())
    fail(line.place, std::string("the line has no ") + what + "; add it, or export the file again");
  if (line.fields[field].find_first_of(" \t") != std::string_view::npos)
    fail(line.place,
         std::string(what) + " is " + in_quotes(line.fields[field]) + "; write one value between two commas");
  MeshText text(text_.name(), line.fields[field]);
  text.about(line.place);
  return text;
}

double InpFile::number(const InpLine& line, std::size_t field, const char* what) const {
  return value(line, field, what).number(what);
}

std::int64_t InpFile::integer(const InpLine& line, std::size_t field, const char* what) const {
  return value(line, field, what).integer(what);
}

void InpFile::fail(std::int64_t place, const std::string& text) const {
  MeshText there = text_;
  there.about(place);
  there.fail(text);
}

}  // namespace hmax
