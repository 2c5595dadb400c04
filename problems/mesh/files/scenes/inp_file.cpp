#include "problems/mesh/files/scenes/inp_file.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <iterator>

#include "core/process/whole_file.hpp"
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

std::optional<std::string> InpCard::parameter(const std::string& name) const {
  const auto found = parameters.find(name);
  return found == parameters.end() ? std::nullopt : std::optional(found->second);
}

const std::string* InpCard::unknown_parameter(std::string_view known) const {
  for (const auto& [name, value] : parameters)
    if (!is_listed(name, known) || (name == "OP" && value != "MOD") || (name == "SYSTEM" && value != "R") ||
        (name == "TYPE" && keyword == "BOUNDARY" && value != "DISPLACEMENT"))
      return &name;
  return nullptr;
}

InpFile::InpFile(const std::string& name, std::string_view bytes) : text_(name, bytes) {
  read(text_, bytes, 0, 0);
  find_part();
}

/// @param own_line  of the *INCLUDE in the file itself; 0 of that file
void InpFile::read(MeshText lines, std::string_view bytes, std::int64_t own_line, int depth) {
  const MeshText whole = lines;
  const auto begin = [&](std::int64_t line) {
    stretches_.push_back({.first = place_ + 1, .line = line, .text = whole, .own_line = own_line});
  };
  begin(1);
  std::string_view line;
  for (std::int64_t number = 1; lines.left() > 0; ++number) {
    line = trimmed(lines.line());
    const std::int64_t place = ++place_;
    if (line.empty() || line.starts_with("**")) continue;
    const bool begins = line.starts_with('*');
    std::vector<std::string_view> fields = fields_of(line.substr(begins ? 1 : 0));
    if (begins) {
      cards_.emplace_back().place = place;
      if (fields.empty()) fields.emplace_back();
      cards_.back().keyword = upper(fields.front());
      fields.erase(fields.begin());
      input_.clear();
    } else if (cards_.empty()) {
      fail(place, "an input file begins with a keyword such as *NODE and not with " + in_quotes(line) +
                      "; export it again or correct the extension");
    } else if (!goes_on_) {
      cards_.back().lines.push_back(
          {.place = place, .fields = std::move(fields), .goes_on = line.ends_with(',')});
      continue;
    }
    for (const std::string_view field : fields) {
      const std::size_t equals = std::min(field.find('='), field.size());
      const std::string parameter = upper(trimmed(field.substr(0, equals)));
      const std::string_view value = trimmed(field.substr(std::min(equals + 1, field.size())));
      cards_.back().parameters.emplace(parameter, upper(value));
      if (parameter == "INPUT") input_ = value;
    }
    goes_on_ = line.ends_with(',');
    if (goes_on_ || cards_.back().keyword != "INCLUDE") continue;
    include(cards_.back().place, own_line == 0 ? number : own_line, depth);
    begin(number + 1);
  }
  constexpr std::array<std::string_view, 4> ends{"*END STEP", "*END ASSEMBLY", "*END PART", "*END INSTANCE"};
  if (!bytes.empty() && bytes.back() != '\n' && std::ranges::find(ends, upper(line)) == ends.end())
    fail(place_,
         "the last line has no end; the file is cut off, so copy or export it again, or add a line break");
}

/// Lines of values go on in the included file, and behind it.
void InpFile::include(std::int64_t place, std::int64_t own_line, int depth) {
  constexpr int deepest = 8;
  constexpr std::size_t most = 1000;
  cards_.pop_back();
  std::string name = input_;
  if (name.size() > 1 && (name.front() == '"' || name.front() == '\'') && name.back() == name.front())
    name = name.substr(1, name.size() - 2);
  if (name.empty()) fail(place, "*INCLUDE names no file; write *INCLUDE, INPUT=FILE");
  if (depth == deepest || included_.size() == most)
    fail(place, "files include one another without end; correct *INCLUDE");
  const std::filesystem::path file = std::filesystem::path(text_.name()).parent_path() / name;
  if (std::error_code ignored; !std::filesystem::is_regular_file(file, ignored))
    fail(place, "there is no file " + in_quotes(name) + " to include; correct the name");
  included_.push_back(std::make_unique<const std::string>(read_whole(file, "an input file")));
  const std::string_view bytes = *included_.back();
  read(MeshText(file.string(), bytes), bytes, own_line, depth + 1);
}

void InpFile::find_part() {
  const InpCard *part = nullptr, *instance = nullptr;
  bool is_open = false;
  for (InpCard& card : cards_) {
    const bool is_part = card.keyword == "PART", is_instance = card.keyword == "INSTANCE";
    if (is_part || is_instance) {
      const InpCard*& slot = is_part ? part : instance;
      if (slot)
        fail(card.place, "there is a second *" + card.keyword +
                             ", and one is read; merge all into one part, and export it again");
      slot = &card;
      is_open = true;
    }
    if (card.keyword == "END PART" || card.keyword == "END INSTANCE") is_open = false;
    card.is_in_part = is_open;
  }
  const InpCard* const last = instance ? instance : part;
  if (!last) return;
  if (is_open)
    fail(last->place, "*" + last->keyword + " has no end; the file is cut off, so export it again");
  if (!instance) fail(part->place, "the *PART has no *INSTANCE in an *ASSEMBLY; export the file again");
  if (part && instance->parameter("PART") != part->parameter("NAME"))
    fail(instance->place, "the *INSTANCE is not of the *PART; correct its name");
  for (const InpLine& moved : instance->lines)
    for (std::size_t field = 0; field < moved.fields.size(); ++field)
      if (!moved.fields[field].empty() && number(moved, field, "a translation") != 0)
        fail(moved.place, "the *INSTANCE is moved, which is not read; move the points of the part instead");
  prefix_ = instance->parameter("NAME").value_or("") + ".";
}

const InpFile::Stretch& InpFile::stretch(std::int64_t place) const {
  const auto behind = std::ranges::upper_bound(stretches_, place, {}, &Stretch::first);
  return behind == stretches_.begin() ? stretches_.front() : *std::prev(behind);
}

std::int64_t InpFile::line(std::int64_t place) const {
  const Stretch& of = stretch(place);
  return of.line + place - of.first;
}

std::int64_t InpFile::own_line(std::int64_t place) const {
  const Stretch& of = stretch(place);
  return of.own_line == 0 ? line(place) : of.own_line;
}

MeshText InpFile::at(std::int64_t place) const {
  if (place < 0) return text_;
  MeshText there = stretch(place).text;
  there.about(line(place));
  return there;
}

MeshText InpFile::value(const InpLine& line, std::size_t field, const char* what) const {
  const std::string_view text = field < line.fields.size() ? line.fields[field] : "";
  if (text.empty())
    fail(line.place, std::string("the line has no ") + what + "; add it, or export the file again");
  if (text.find_first_of(" \t") != std::string_view::npos)
    fail(line.place, std::string(what) + " is " + in_quotes(text) + "; write one value between two commas");
  MeshText alone(at(line.place).name(), text);
  alone.about(this->line(line.place));
  return alone;
}

double InpFile::number(const InpLine& line, std::size_t field, const char* what) const {
  return value(line, field, what).number(what);
}

std::int64_t InpFile::integer(const InpLine& line, std::size_t field, const char* what) const {
  return value(line, field, what).integer(what);
}

}  // namespace hmax
