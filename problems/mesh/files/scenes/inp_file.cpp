#include "problems/mesh/files/scenes/inp_file.hpp"

#include "core/text/split.hpp"

namespace hmax {

namespace {

/// The parts between commas; a comma at the end, after which a list goes on, begins none.
std::vector<std::string_view> fields_of(std::string_view line) {
  std::vector<std::string_view> fields = split(line, ",");
  for (std::string_view& field : fields) field = trimmed(field);
  if (fields.back().empty()) fields.pop_back();
  return fields;
}

}  // namespace

std::string upper(std::string_view text) {
  std::string result(text);
  for (char& c : result)
    if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
  return result;
}

std::optional<std::string> InpCard::parameter(const std::string& name) const {
  const auto found = parameters.find(name);
  return found == parameters.end() ? std::nullopt : std::optional(found->second);
}

InpFile::InpFile(const std::string& name, std::string_view bytes) : text_(name, bytes) {
  MeshText lines = text_;
  bool goes_on = false;  // a keyword whose parameters are continued on the next line
  for (std::int64_t place = 1; lines.left() > 0; ++place) {
    const std::string_view line = trimmed(lines.line());
    if (line.empty() || line.starts_with("**")) continue;
    const bool begins = line.starts_with('*');
    std::vector<std::string_view> fields = fields_of(line.substr(begins ? 1 : 0));
    if (begins) {
      cards_.emplace_back().place = place;
      if (fields.empty()) fields.emplace_back();
      cards_.back().keyword = upper(fields.front());
      fields.erase(fields.begin());
    } else if (cards_.empty()) {
      fail(place, "an input file begins with a keyword such as *NODE and not with " + in_quotes(line) +
                      "; export it again or correct the extension");
    } else if (!goes_on) {
      cards_.back().lines.push_back({.place = place, .fields = std::move(fields)});
      continue;
    }
    for (const std::string_view field : fields) {
      const std::size_t equals = std::min(field.find('='), field.size());
      cards_.back().parameters.emplace(upper(trimmed(field.substr(0, equals))),
                                       upper(trimmed(field.substr(std::min(equals + 1, field.size())))));
    }
    goes_on = line.ends_with(',');
  }
  if (!bytes.empty() && bytes.back() != '\n')
    lines.fail(
        "the last line has no end; the file is cut off, so copy or export it again, or add a line break");
}

MeshText InpFile::at(std::int64_t place) const {
  MeshText there = text_;
  there.about(place);
  return there;
}

MeshText InpFile::value(const InpLine& line, std::size_t field, const char* what) const {
  const std::string_view text = field < line.fields.size() ? line.fields[field] : "";
  if (text.empty())
    fail(line.place, std::string("the line has no ") + what + "; add it, or export the file again");
  if (text.find_first_of(" \t") != std::string_view::npos)
    fail(line.place, std::string(what) + " is " + in_quotes(text) + "; write one value between two commas");
  MeshText alone(name(), text);
  alone.about(line.place);
  return alone;
}

double InpFile::number(const InpLine& line, std::size_t field, const char* what) const {
  return value(line, field, what).number(what);
}

std::int64_t InpFile::integer(const InpLine& line, std::size_t field, const char* what) const {
  return value(line, field, what).integer(what);
}

}  // namespace hmax
