#include "catalogue/input/toml_file.hpp"

#include <algorithm>
#include <charconv>
#include <fstream>
#include <iterator>
#include <regex>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "catalogue/input/suggest.hpp"
#include "core/input_error.hpp"
#include "core/own_files.hpp"
#include "core/text/sentences.hpp"
#include "core/text/utf8.hpp"

// The one translation unit that sees toml++. Its assertions guard against what a user can type (a '[' at the
// end of a line), and its own error handling behind them is sound: they are defined away, not turned into
// assumptions, which needs NDEBUG to be unset. Header-only, because the shared library of Debian has them
// compiled in. After the other headers, which keep the NDEBUG of the build.
#undef NDEBUG
#undef TOML_SHARED_LIB
#undef TOML_HEADER_ONLY
#define TOML_HEADER_ONLY 1
#define TOML_ASSERT(expression) static_cast<void>(0)
#define TOML_MAX_NESTED_VALUES 16
#include <toml++/toml.h>

namespace hmax {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t largest_file = 1 << 20;
constexpr int longest_line = 4096;  // bounds the depth of a.b.c. ... keys, which readers walk by recursion

/// One step of a JSON pointer.
std::string step(const std::string& key) { return (Json::json_pointer() / key).to_string(); }

int line_of(const toml::source_region& region) { return static_cast<int>(region.begin.line); }

/// toml++ 3.3 answers some letters beyond ASCII with undefined behaviour wherever it expects a space, also
/// within strings of many lines, so it never sees one: each byte of them, and '~' itself, stands as '~' and
/// two hex digits.
std::string masked(std::string_view text) {
  std::string ascii;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte >= 0x80 || c == '~') {
      ascii += fmt::format("~{:02x}", byte);
    } else {
      ascii += c;
    }
  }
  return ascii;
}

std::string unmasked(std::string_view ascii) {
  std::string text;
  for (std::size_t i = 0; i < ascii.size(); ++i) {
    unsigned byte = 0;
    if (ascii[i] == '~' && i + 2 < ascii.size() &&
        std::from_chars(ascii.data() + i + 1, ascii.data() + i + 3, byte, 16).ptr == ascii.data() + i + 3) {
      text += static_cast<char>(byte);
      i += 2;
    } else {
      text += ascii[i];
    }
  }
  return text;
}

Json converted(const toml::node& node, const std::string& place, TomlDocument& document) {
  if (const auto* table = node.as_table()) {
    // toml++ sorts keys by name; a reader of messages and of results expects the order of the file.
    std::vector<std::pair<const toml::key*, const toml::node*>> entries;
    for (auto&& [key, value] : *table) entries.emplace_back(&key, &value);
    std::stable_sort(entries.begin(), entries.end(), [](const auto& one, const auto& other) {
      const toml::source_position a = one.first->source().begin, b = other.first->source().begin;
      return std::pair(a.line, a.column) < std::pair(b.line, b.column);
    });
    Json object = Json::object();
    auto& members = object.get_ref<Json::object_t&>();
    for (const auto& [key, value] : entries) {
      const std::string name = unmasked(key->str()), inside = place + step(name);
      document.lines[inside] = line_of(key->source());
      // At the end without a search: TOML has no key twice.
      members.emplace_back(name, converted(*value, inside, document));
    }
    return object;
  }
  if (const auto* array = node.as_array()) {
    Json list = Json::array();
    for (auto&& value : *array) {
      const std::string inside = fmt::format("{}/{}", place, list.size());
      document.lines[inside] = line_of(value.source());
      list.push_back(converted(value, inside, document));
    }
    return list;
  }
  if (const auto* text = node.as_string()) return unmasked(text->get());
  if (const auto* integer = node.as_integer()) return integer->get();
  if (const auto* number = node.as_floating_point()) return number->get();
  if (const auto* truth = node.as_boolean()) return truth->get();
  document.fail(place, "a date or a time stands where none is read; write a number or a string in quotes");
}

void check_text(std::string_view text, const std::string& name) {
  if (text.size() > largest_file)
    throw input_error("{}: the file is larger than 1 MiB, which no input of hmax is", name);
  try {
    static_cast<void>(nlohmann::json(text).dump());  // throws where the text is not UTF-8
  } catch (const nlohmann::json::exception&) {
    throw input_error("{}: the file is not UTF-8 text; save it as UTF-8", name);
  }
  int line = 1, column = 0;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    ++column;
    if (c == '\n') {
      ++line;
      column = 0;
    }
    if (column > longest_line)
      throw input_error("{}:{}: the line is longer than {} bytes; break it", name, line, longest_line);
    if ((byte < 0x20 && c != '\n' && c != '\r' && c != '\t') || byte == 0x7f)
      throw input_error("{}:{}: control byte 0x{:02x} in the text; remove it", name, line, byte);
  }
}

/// What to do about syntax errors of people with a decimal comma or with a word processor.
std::string hint(std::string_view text, std::size_t line) {
  for (; line > 1; --line) text.remove_prefix(std::min(text.find('\n'), text.size() - 1) + 1);
  const std::string written(text.substr(0, text.find('\n')));
  if (std::any_of(written.begin(), written.end(),
                  [](char c) { return static_cast<unsigned char>(c) >= 0x80; }))
    return "; letters and signs that are not ASCII may stand only in quotes and in comments";
  static const std::regex decimal_comma(R"(=\s*([+-]?[0-9]+),([0-9]+)\s*(#.*)?\r?$)");
  std::smatch match;
  if (written.size() > 200 || !std::regex_search(written, match, decimal_comma)) return {};
  return fmt::format("; write {}.{} with a decimal point", match.str(1), match.str(2));
}

}  // namespace

int TomlDocument::line(std::string_view place) const {
  while (!place.empty()) {
    if (const auto found = lines.find(std::string(place)); found != lines.end()) return found->second;
    place = place.substr(0, place.rfind('/'));
  }
  return 0;
}

void TomlDocument::fail(std::string_view place, std::string_view message) const {
  const int at = line(place);
  throw InputError(in_one_line(at > 0 ? fmt::format("{}:{}: {}", name, at, message)
                                      : fmt::format("{}: {}", name, message)));
}

TomlDocument parse_toml(std::string_view text, std::string name) {
  text = without_byte_order_mark(text);
  check_text(text, name);
  TomlDocument document{.name = std::move(name), .root = Json::object()};
  try {
    const toml::table table = toml::parse(masked(text));
    document.root = converted(table, "", document);
  } catch (const toml::parse_error& error) {
    const toml::source_position at = error.source().begin;
    throw InputError(in_one_line(fmt::format("{}:{}:{}: {}{}", document.name, at.line, at.column,
                                             unmasked(error.description()), hint(text, at.line))));
  }
  return document;
}

TomlDocument read_toml(const std::filesystem::path& path) {
  const std::string name = path.string();
  std::error_code problem;
  const auto status = std::filesystem::status(path, problem);
  if (!std::filesystem::exists(status)) throw input_error("{}: no such file; check the path", name);
  if (std::filesystem::is_directory(status))
    throw input_error("{}: this is a folder; name a TOML file in it", name);
  note_input(path);
  std::ifstream file(path, std::ios::binary);
  if (!file) throw input_error("{}: the file cannot be opened; check its permissions", name);
  // One byte more than is accepted: a device or a pipe has no size to ask for.
  std::string text(largest_file + 1, '\0');
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(file.gcount()));
  return parse_toml(text, name);
}

void reject_unknown_keys(const TomlDocument& document, std::string_view place,
                         std::span<const std::string_view> allowed) {
  const Json::json_pointer pointer{std::string(place)};
  if (!document.root.contains(pointer)) return;
  const Json& table = document.root.at(pointer);
  std::string title(place.substr(std::min<std::size_t>(1, place.size())));
  std::replace(title.begin(), title.end(), '/', '.');
  if (!table.is_object()) document.fail(place, "'{}' must be a table, [{}]", title, title);
  for (const auto& [key, value] : table.items()) {
    if (std::find(allowed.begin(), allowed.end(), key) != allowed.end()) continue;
    document.fail(std::string(place) + step(key), "unknown key '{}'{}; {}", key,
                  title.empty() ? "" : fmt::format(" in [{}]", title), suggestion(key, allowed));
  }
}

}  // namespace hmax
