/// What sources declare, as their layout shows it.
#pragma once

#include <algorithm>
#include <cctype>
#include <optional>
#include <set>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace hmax::architecture {

/// A name in the first column: of a type, an alias, a function or a variable.
struct Declared {
  std::string name;          ///< with the last namespace that began before it
  std::string meaning = {};  ///< "(types of parameters" of a function, "= type" of an alias, else nothing
  bool hidden = false;       ///< in an anonymous namespace
  bool defined = true;       ///< false: a function without its body
};

namespace detail {

/// The word at the end of a text, with nothing, a space, & or * before it.
inline std::string_view last_word(std::string_view text) {
  std::size_t begin = text.size();
  while (begin > 0 &&
         (std::isalnum(static_cast<unsigned char>(text[begin - 1])) != 0 || text[begin - 1] == '_'))
    --begin;
  const bool is_alone = begin == 0 || std::string_view(" &*").find(text[begin - 1]) != text.npos;
  return is_alone ? text.substr(begin) : std::string_view();
}

/// "(double;const Mesh&;int=;" of the parameters whose bracket opens there: their types, = where they have a
/// default.
inline std::string types_of_parameters(std::string_view head, std::size_t open) {
  std::string types = "(", one;
  int depth = 0;
  for (std::size_t i = open + 1; i < head.size() && depth >= 0; ++i) {
    if (std::string_view("(<[{").find(head[i]) != head.npos) ++depth;
    if (std::string_view(")>]}").find(head[i]) != head.npos) --depth;
    if (depth >= 0 && (depth > 0 || head[i] != ',')) {
      if (head[i] != ' ' || !one.empty()) one += head[i];
      continue;
    }
    const std::size_t value = one.find(" = ");
    one.resize(std::min(one.size(), value));
    if (const std::string_view name = last_word(one); name.size() < one.size())
      one.resize(one.size() - name.size());
    one.resize(one.find_last_not_of(' ') + 1);
    if (one == "const std::string&" || one == "const char*") one = "std::string_view";  // a literal is each
    if (!one.empty()) types += one + (value == std::string::npos ? ";" : "=;");
    one.clear();
  }
  return types;
}

/// Of "Name = type;" or "space::Name;".
inline std::optional<Declared> named_by_using(std::string_view text) {
  const std::size_t value = text.find(" = "), colon = text.rfind(':');
  if (value != text.npos)
    return Declared{.name = std::string(text.substr(0, value)),
                    .meaning = std::string(text.substr(value + 1))};
  if (colon == text.npos || text.find(' ') != text.npos) return std::nullopt;
  return Declared{.name = std::string(text.substr(colon + 1, text.size() - colon - 2)),
                  .meaning = "= " + std::string(text)};
}

/// What a declaration up to its first ; { or } at the end of a line names; nothing for macros and members.
inline std::optional<Declared> named_by(std::string_view head) {
  for (const std::string_view kind : {"struct ", "class ", "enum class ", "enum ", "union "})
    if (head.starts_with(kind)) {
      if (head.find('{') == head.npos) return std::nullopt;
      head.remove_prefix(kind.size());
      return Declared{.name = std::string(head.substr(0, head.find_first_of(" :{<")))};
    }
  if (head.starts_with("using ")) return named_by_using(head.substr(6));
  std::size_t end = 0;
  for (int depth = 0; end < head.size(); ++end) {
    if (depth == 0 && std::string_view("(={;[").find(head[end]) != head.npos) break;
    depth += head[end] == '<' ? 1 : head[end] == '>' ? -1 : 0;
  }
  std::string_view before = head.substr(0, end);
  before = before.substr(0, before.find_last_not_of(' ') + 1);
  const std::string_view name = last_word(before);
  if (name.empty() || name == before || name == "operator" || end == head.size()) return std::nullopt;
  Declared found{.name = std::string(name)};
  const bool is_constant =
      head.starts_with("const") && head.ends_with(';') && before.find('&') == before.npos;
  if (head[end] == '(' && !is_constant) {
    found.meaning = types_of_parameters(head, end);
    found.defined = !head.ends_with(';');
  }
  return found;
}

}  // namespace detail

/// Outside of classes and functions.
inline std::vector<Declared> declared_in(const std::string& text) {
  std::vector<Declared> all;
  std::istringstream in(text);
  bool hidden = false, in_body = false;
  std::string space, head;
  std::vector<std::size_t> outer;  // lengths of `space` around each namespace with a name
  for (std::string line; std::getline(in, line);) {
    if (line == "namespace {") hidden = true;
    const bool opens = line.starts_with("namespace ");
    if (opens && line.ends_with(" {") && line != "namespace {") {
      outer.push_back(space.size());
      space += line.substr(10, line.size() - 12) + "::";
    }
    if (line == "}  // namespace") {
      hidden = in_body = false;
    } else if (line.starts_with('}')) {
      const bool closes_body = std::exchange(in_body, false) && !line.starts_with("}  // namespace ");
      if (!closes_body && !outer.empty()) {
        space.resize(outer.back());
        outer.pop_back();
      }
    }
    if (line.starts_with("[[")) line = line.substr(line.find("]] ") + 3);
    const bool begins = !line.empty() && std::isalpha(static_cast<unsigned char>(line.front())) != 0 &&
                        !opens && !line.starts_with("template ");
    if (head.empty() && !begins) continue;
    line.resize(std::min(line.size(), line.find("  // ")));
    const std::size_t first = line.find_first_not_of(' ');
    if (first == std::string::npos) continue;
    head += (head.empty() ? "" : " ") + line.substr(first);
    if (std::string_view(";{}").find(head.back()) == std::string_view::npos) continue;
    in_body = head.back() == '{';
    if (auto found = detail::named_by(head)) {
      found->name = space + found->name;
      found->hidden = hidden;
      all.push_back(std::move(*found));
    }
    head.clear();
  }
  return all;
}

/// Names of functions outside of anonymous namespaces.
/// @param defined  those with a body, else those without
inline std::set<std::string> free_functions(const std::string& text, bool defined) {
  std::set<std::string> names;
  for (const Declared& found : declared_in(text))
    if (found.meaning.starts_with('(') && !found.hidden && found.defined == defined) names.insert(found.name);
  return names;
}

}  // namespace hmax::architecture
