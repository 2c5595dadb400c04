#include "problems/mesh/files/xml_tags.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <utility>
#include <vector>

namespace hmax {

std::string_view XmlTag::attribute(std::string_view wanted, std::string_view otherwise) const {
  for (const auto& [key, value] : attributes)
    if (key == wanted) return value;
  return otherwise;
}

namespace {

/// The character of "&#N;" or "&#xH;" at the begin of the text, in UTF-8, and how long that is; else nothing.
std::pair<std::string, std::size_t> numbered_character(std::string_view text) {
  const std::size_t end = text.find(';');
  if (!text.starts_with("&#") || end == std::string_view::npos) return {};
  const bool is_hex = text.substr(2, 1) == "x";
  const char *const from = text.data() + (is_hex ? 3 : 2), *const to = text.data() + end;
  std::uint32_t code = 0;
  const auto [last, error] = std::from_chars(from, to, code, is_hex ? 16 : 10);
  if (error != std::errc() || last != to || code == 0 || code > 0x10FFFF) return {};
  std::string bytes;
  if (code < 0x80) {
    bytes += static_cast<char>(code);
  } else {
    const int more = code < 0x800 ? 1 : code < 0x10000 ? 2 : 3;
    constexpr std::array<unsigned, 4> first{0, 0xC0, 0xE0, 0xF0};
    bytes += static_cast<char>(first[static_cast<std::size_t>(more)] | code >> (6 * more));
    for (int k = more - 1; k >= 0; --k) bytes += static_cast<char>(0x80U | (code >> (6 * k) & 0x3FU));
  }
  return {bytes, end + 1};
}

}  // namespace

std::string unescaped(std::string_view text) {
  constexpr std::array<std::pair<std::string_view, char>, 5> entities{
      {{"&amp;", '&'}, {"&lt;", '<'}, {"&gt;", '>'}, {"&quot;", '"'}, {"&apos;", '\''}}};
  std::string result;
  while (!text.empty()) {
    if (const auto [bytes, length] = numbered_character(text); length > 0) {
      result += bytes;
      text.remove_prefix(length);
      continue;
    }
    const auto known =
        std::ranges::find_if(entities, [&](const auto& entity) { return text.starts_with(entity.first); });
    result += known == entities.end() ? text.front() : known->second;
    text.remove_prefix(known == entities.end() ? 1 : known->first.size());
  }
  return result;
}

namespace {

constexpr std::string_view blanks = " \t\r\n";

/// The '>' that ends the tag at `begin`, and none in the quotes of a value.
std::size_t end_of_tag(std::string_view whole, std::size_t begin) {
  char quote = 0;
  for (std::size_t at = begin; at < whole.size(); ++at) {
    const char c = whole[at];
    if (quote != 0)
      quote = c == quote ? '\0' : quote;
    else if (c == '"' || c == '\'')
      quote = c;
    else if (c == '>')
      return at;
  }
  return std::string_view::npos;
}

/// An attribute, which XML has once in a tag; empty where there is none.
std::string_view given_twice(const XmlTag& tag) {
  std::vector<std::string_view> names;
  for (const auto& [name, value] : tag.attributes) names.push_back(name);
  std::ranges::sort(names);
  const auto twice = std::ranges::adjacent_find(names);
  return twice == names.end() ? std::string_view() : *twice;
}

}  // namespace

std::size_t behind_comments(std::string_view whole, std::size_t from) {
  while (true) {
    const std::size_t begin = std::min(whole.find_first_not_of(blanks, from), whole.size());
    const std::string_view rest = whole.substr(begin);
    const std::string_view closing = rest.starts_with("<!--") ? "-->" : "?>";
    if (!rest.starts_with("<!--") && !rest.starts_with("<?")) return begin;
    const std::size_t end = whole.find(closing, begin);
    if (end == std::string_view::npos) return begin;
    from = end + closing.size();
  }
}

std::optional<XmlTag> next_tag(const MeshText& text, std::string_view whole, std::size_t from) {
  const auto cut_off = [&](std::size_t at) {
    text.part(at, whole.size()).fail("a tag has no end; the file is cut off, so copy or export it again");
  };
  while (true) {
    const std::size_t begin = whole.find('<', from);
    if (begin == std::string_view::npos) return std::nullopt;
    if (whole.substr(begin).starts_with("<!--")) {
      const std::size_t end = whole.find("-->", begin);
      if (end == std::string_view::npos) cut_off(begin);
      from = end + 3;
      continue;
    }
    if (whole.substr(begin).starts_with("<![CDATA[")) {
      const std::size_t end = whole.find("]]>", begin);
      if (end == std::string_view::npos) cut_off(begin);
      from = end + 3;
      continue;
    }
    const std::size_t end = end_of_tag(whole, begin);
    if (end == std::string_view::npos) cut_off(begin);
    from = end + 1;
    if (whole[begin + 1] == '?' || whole[begin + 1] == '!') continue;
    std::string_view inner = whole.substr(begin + 1, end - begin - 1);
    XmlTag tag{.name = {}, .attributes = {}, .begin = begin, .end = end + 1, .empty = inner.ends_with('/')};
    if (tag.empty) inner.remove_suffix(1);
    std::size_t at = std::min(inner.find_first_of(blanks), inner.size());
    tag.name = inner.substr(0, at);
    const auto damaged = [&] {
      text.part(begin, whole.size())
          .fail("the tag " + in_quotes(tag.name) + " is damaged; copy or export the file again");
    };
    while ((at = inner.find_first_not_of(blanks, at)) != std::string_view::npos) {
      const std::size_t equals = inner.find('=', at);
      if (equals == std::string_view::npos) damaged();
      std::string_view key = inner.substr(at, equals - at);
      key = key.substr(0, key.find_last_not_of(blanks) + 1);
      if (key.find_first_of(" \t\r\n<>\"'/") != std::string_view::npos) damaged();
      const std::size_t open = inner.find_first_of("\"'", equals);
      if (open == std::string_view::npos) damaged();
      const std::size_t close = inner.find(inner[open], open + 1);
      if (close == std::string_view::npos) damaged();
      tag.attributes.emplace_back(key, inner.substr(open + 1, close - open - 1));
      at = close + 1;
    }
    if (const std::string_view twice = given_twice(tag); !twice.empty())
      text.part(begin, whole.size())
          .fail(in_quotes(twice) + " of the tag " + in_quotes(tag.name) + " is given twice; remove one");
    return tag;
  }
}

}  // namespace hmax
