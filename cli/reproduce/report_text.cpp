#include "cli/reproduce/report_text.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>

#include "core/numbers.hpp"
#include "plots/pages/markdown_text.hpp"
#include "results/json.hpp"

namespace hmax {

namespace {

[[noreturn]] void fail(std::string_view place, std::string_view what) {
  throw std::logic_error(fmt::format("a report has the place {{{{{}}}}}: {}", place, what));
}

/// Text, or what stands between braces.
struct Token {
  char kind;              ///< 't' text, 'p' place, '#', '^', '/'
  std::string_view text;  ///< without the sign
  std::size_t close = 0;  ///< of '#' and '^': the token that ends it
};

/// Whether a tag stands alone on its line; then the line is the tag's.
bool alone(std::string_view text, std::size_t begin, std::size_t end) {
  return (begin == 0 || text[begin - 1] == '\n') && end < text.size() && text[end] == '\n';
}

std::string_view name_of_part(std::string_view tag) { return tag.substr(0, tag.find('|')); }

std::vector<Token> tokens_of(std::string_view text) {
  std::vector<Token> tokens;
  std::vector<std::size_t> open;
  std::size_t at = 0;
  for (std::size_t begin = 0; (begin = text.find("{{", at)) != std::string_view::npos;) {
    const std::size_t end = text.find("}}", begin);
    if (end == std::string_view::npos) fail(text.substr(begin, 20), "it has no end");
    tokens.push_back({'t', text.substr(at, begin - at)});
    std::string_view tag = text.substr(begin + 2, end - begin - 2);
    at = end + 2;
    const bool part = tag.find_first_of("#^/") == 0;
    if (part && alone(text, begin, at)) ++at;
    tokens.push_back({part ? tag.front() : 'p', part ? tag.substr(1) : tag});
    if (!part) continue;
    if (tag.front() != '/') {
      open.push_back(tokens.size() - 1);
    } else {
      if (open.empty() || name_of_part(tokens[open.back()].text) != tag.substr(1))
        fail(tag, "it ends no part that is open");
      tokens[open.back()].close = tokens.size() - 1;
      open.pop_back();
    }
  }
  if (!open.empty()) fail(tokens[open.back()].text, "the part has no end");
  tokens.push_back({'t', text.substr(at)});
  return tokens;
}

std::string number_text(double value, std::string_view format, std::string_view place) {
  if (std::isnan(value)) return "–";
  if (std::isinf(value)) return "unbounded";
  if (format.empty()) return fmt::format("{:g}", value);
  if (const std::size_t digits = format.find(" digits"); digits != std::string_view::npos) {
    const auto count = static_cast<int>(to_number(format.substr(0, digits)).value_or(3));
    return rounded_text(value, count);
  }
  try {
    return fmt::format(fmt::runtime(fmt::format("{{:{}}}", format)), value);
  } catch (const fmt::format_error& error) {
    fail(place, error.what());
  }
}

class Filler {
 public:
  Filler(std::string_view text, const Json& values, const ReportPieces& pieces)
      : tokens_(tokens_of(text)), pieces_(pieces), scopes_{&values} {}

  std::string fill() {
    fill(0, tokens_.size(), true);
    for (const auto& [name, text] : pieces_)
      if (!used_pieces_.contains(name))
        throw std::logic_error(fmt::format("a report has no place for the {}", name));
    require_used(*scopes_.front(), "");
    return std::move(out_);
  }

 private:
  void fill(std::size_t from, std::size_t to, bool shown) {
    for (std::size_t i = from; i < to; ++i) {
      const Token& token = tokens_[i];
      if (token.kind == 't' && shown) out_ += token.text;
      if (token.kind == 'p') {
        const std::string text = place_text(token.text);
        if (shown) out_ += text;
      }
      if (token.kind == '#' || token.kind == '^') {
        fill_part(i, shown);
        i = token.close;
      }
    }
  }

  void fill_part(std::size_t open, bool shown) {
    const Token& token = tokens_[open];
    const std::string_view name = name_of_part(token.text);
    const Json& value = value_of(name);
    const auto inside = [&](bool visible) { fill(open + 1, token.close, shown && visible); };
    const bool inverse = token.kind == '^';
    if (value.is_null()) return;
    if (value.is_boolean()) return inside(value.get<bool>() != inverse);
    if (inverse && value.is_array()) return inside(value.empty());
    if (inverse || !(value.is_array() || value.is_object())) fail(token.text, "its value is no yes or no");
    if (value.is_object()) {
      scopes_.push_back(&value);
      inside(true);
      return scopes_.pop_back();
    }
    const std::string_view separator =
        name.size() < token.text.size() ? token.text.substr(name.size() + 1) : std::string_view();
    bool first = true;
    for (const Json& item : value) {
      if (!first && shown) out_ += separator;
      first = false;
      scopes_.push_back(&item);
      inside(true);
      scopes_.pop_back();
    }
  }

  std::string place_text(std::string_view place) {
    if (const std::size_t space = place.find(' ');
        space != std::string_view::npos && place.find(':') == std::string_view::npos) {
      const Json* named = find(place.substr(space + 1));
      const bool by_value = named && named->is_string();
      const std::string name = fmt::format("{} {}", place.substr(0, space),
                                           by_value ? named->get<std::string>() : place.substr(space + 1));
      const auto piece = pieces_.find(name);
      if (piece == pieces_.end()) fail(place, "there is none");
      used_pieces_.insert(name);
      return piece->second;
    }
    const std::size_t colon = std::min(place.find(':'), place.size());
    const std::string_view format = place.substr(std::min(colon + 1, place.size()));
    const std::size_t star = std::min(place.find('*'), colon);
    const double factor =
        star == colon ? 1 : to_number(place.substr(star + 1, colon - star - 1)).value_or(NAN);
    return value_text(value_of(place.substr(0, star)), factor, format, place);
  }

  static std::string value_text(const Json& value, double factor, std::string_view format,
                                std::string_view place) {
    if (value.is_array()) {
      std::string all;
      for (const Json& item : value)
        all += (all.empty() ? "" : ", ") + value_text(item, factor, format, place);
      return all;
    }
    if (value.is_string() && format.empty()) return markdown_text(value.get<std::string>());
    if (value.is_number_integer() && format.empty() && factor == 1) return value.dump();
    if (!value.is_number()) fail(place, "its value is no number");
    return number_text(factor * value.get<double>(), format, place);
  }

  const Json* find(std::string_view name) {
    const Json* found = name == "." ? scopes_.back() : nullptr;
    for (auto scope = scopes_.rbegin(); !found && scope != scopes_.rend(); ++scope)
      if ((*scope)->is_object())
        if (const auto field = (*scope)->find(name); field != (*scope)->end()) found = &*field;
    used_.insert(found);
    return found;
  }
  const Json& value_of(std::string_view name) {
    const Json* found = find(name);
    if (!found) fail(name, "it has no value");
    return *found;
  }

  void require_used(const Json& value, const std::string& path) const {
    if (value.is_object())
      for (const auto& [name, field] : value.items()) {
        if (!used_.contains(&field))
          throw std::logic_error(fmt::format("a report has no place for the value {}{}", path, name));
        require_used(field, path + name + ".");
      }
    if (value.is_array() && !value.empty()) require_used(value.front(), path);
  }

  std::vector<Token> tokens_;
  const ReportPieces& pieces_;
  std::vector<const Json*> scopes_;
  std::set<const Json*> used_;
  std::set<std::string> used_pieces_;
  std::string out_;
};

}  // namespace

std::string_view report_text(std::string_view name) { return text_of(report_texts(), name); }

std::string filled(std::string_view text, const Json& values, const ReportPieces& pieces) {
  return Filler(text, values, pieces).fill();
}

}  // namespace hmax
