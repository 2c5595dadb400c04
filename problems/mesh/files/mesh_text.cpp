#include "problems/mesh/files/mesh_text.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace hmax {

namespace {

/// True for digits beyond the range of double that stand for a number too small, such as 1e-400, and not for
/// one too large, such as 1e400.
bool is_tiny(std::string_view digits) {
  const std::size_t exponent = digits.find_first_of("eE");
  if (exponent != std::string_view::npos) return digits.substr(exponent + 1).starts_with('-');
  if (digits.starts_with('-')) digits.remove_prefix(1);
  return digits.starts_with('0') || digits.starts_with('.');
}

}  // namespace

std::string place_in_words(const std::string& name, std::int64_t place, bool byte) {
  return name + (byte ? ", byte " : ", line ") + std::to_string(place) + ": ";
}

std::string in_quotes(std::string_view text) {
  constexpr std::size_t longest = 30;
  std::string shown;
  for (const char c : text.substr(0, longest)) shown += c < ' ' || c > '~' ? '?' : c;
  return "'" + shown + (text.size() > longest ? "..." : "") + "'";
}

std::string lower(std::string_view text) {
  std::string result(text);
  for (char& c : result)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return result;
}

std::string upper(std::string_view text) {
  std::string result(text);
  for (char& c : result)
    if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
  return result;
}

bool same_keyword(std::string_view a, std::string_view b) { return lower(a) == lower(b); }

MeshText MeshText::part(std::size_t begin, std::size_t end) const {
  MeshText result(name_, text_.substr(begin, end - begin), comment_);
  const auto from = text_.begin() + static_cast<std::ptrdiff_t>(std::min(begin, part_)),
             to = text_.begin() + static_cast<std::ptrdiff_t>(std::max(begin, part_));
  part_line_ += (begin < part_ ? -1 : 1) * std::count(from, to, '\n');
  part_ = begin;
  result.line_ = part_line_;
  return result;
}

std::int64_t MeshText::place() {
  if (raw_) return static_cast<std::int64_t>(at_);
  skip_blanks();
  return line_;
}

void MeshText::fail(const std::string& text) const {
  const std::int64_t here = raw_ ? static_cast<std::int64_t>(last_) : line_;
  throw std::invalid_argument(place_in_words(name_, about_ >= 0 ? about_ : here, raw_) + text);
}

void MeshText::fail_at_end(const char* what) const {
  if (in_line_ && at_ < text_.size())
    fail(std::string("the line ends where ") + what +
         " should be; the file is damaged, so copy or export it again");
  fail(std::string("the file ends where ") + what + " should be; it is cut off, so copy or export it again");
}

void MeshText::skip_blanks() {
  while (at_ < text_.size()) {
    const char c = text_[at_];
    if (c == '\n') {
      if (in_line_) return;
      ++line_;
    } else if (comment_ && c == comment_) {
      at_ = std::min(text_.find('\n', at_), text_.size());
      continue;
    } else if (!is_blank(c)) {
      return;
    }
    ++at_;
  }
}

bool MeshText::at_end() {
  skip_blanks();
  return at_ == text_.size();
}

std::string_view MeshText::peek() {
  skip_blanks();
  last_ = at_;
  std::size_t end = at_;
  while (end < text_.size() && !is_blank(text_[end])) ++end;
  return text_.substr(at_, end - at_);
}

std::string_view MeshText::word(const char* what) {
  const std::string_view found = peek();
  if (found.empty()) fail_at_end(what);
  at_ += found.size();
  word_end_ = at_;
  return found;
}

double MeshText::number(const char* what) {
  const std::string_view found = word(what);
  std::string_view digits = found;
  if (digits.starts_with('+')) digits.remove_prefix(1);
  double value = 0;
  auto parsed = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  std::string fortran;
  const auto stop = static_cast<std::size_t>(parsed.ptr - digits.data());
  if (parsed.ec == std::errc{} && stop < digits.size() && (digits[stop] == 'd' || digits[stop] == 'D')) {
    fortran = digits;
    fortran[stop] = 'e';
    digits = fortran;
    parsed = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  }
  if (parsed.ec == std::errc::result_out_of_range) {
    if (is_tiny(digits) && parsed.ptr == digits.data() + digits.size()) return 0;
    fail(std::string(what) + " " + in_quotes(found) + " is beyond the range of double; correct it");
  }
  if (parsed.ec != std::errc{} || parsed.ptr != digits.data() + digits.size())
    fail(std::string(what) + " should be a number and is " + in_quotes(found) +
         "; correct it or export the mesh again");
  if (!std::isfinite(value))
    fail(std::string(what) + " is " + in_quotes(found) +
         ", which is not finite; correct it or export the mesh again");
  return value;
}

std::int64_t MeshText::label(const char* what) {
  const std::string_view found = peek();
  if (found.find_first_of(".eEdD") == std::string_view::npos) return integer(what);
  const double value = number(what);
  constexpr double most = 1LL << 53;
  if (value != std::floor(value) || std::abs(value) > most)
    fail(std::string(what) + " should be a whole number and is " + in_quotes(found) +
         "; correct it or export the mesh again");
  return static_cast<std::int64_t>(value);
}

std::int64_t MeshText::integer(const char* what) {
  const std::string_view found = word(what);
  std::string_view digits = found;
  if (digits.starts_with('+')) digits.remove_prefix(1);
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc{} || end != digits.data() + digits.size())
    fail(std::string(what) + " should be a whole number and is " + in_quotes(found) +
         "; correct it or export the mesh again");
  return value;
}

std::string MeshText::quoted(const char* what) {
  if (!peek().starts_with('"'))
    fail(std::string(what) + " should be in double quotes and is " + in_quotes(peek()) +
         "; export the mesh again");
  const std::size_t begin = at_ + 1, end = text_.find_first_of("\"\n", begin);
  if (end == std::string_view::npos || text_[end] == '\n')
    fail(std::string(what) + " has no closing quote; the file is cut off, so export it again");
  at_ = end + 1;
  return std::string(text_.substr(begin, end - begin));
}

void MeshText::require_room(std::size_t count, const char* what, std::size_t bytes) const {
  if (count > std::size_t{std::numeric_limits<std::int32_t>::max()})
    fail("the file announces " + std::to_string(count) + " " + what +
         ", more than 2147483647; split it or correct its header");
  // The last one needs no separator behind it.
  if (count > (left() + bytes) / bytes)
    fail("the file announces " + std::to_string(count) + " " + what + ", but only " + std::to_string(left()) +
         " bytes are left; it is cut off or its header is wrong, so copy or export it again");
}

std::size_t MeshText::count(const char* what, std::size_t bytes) {
  const std::int64_t value = integer(what);
  if (value < 0) fail("the file announces " + std::to_string(value) + " " + what + "; export the mesh again");
  require_room(static_cast<std::size_t>(value), what, bytes);
  return static_cast<std::size_t>(value);
}

void MeshText::begin_line() {
  skip_blanks();
  in_line_ = true;
}

void MeshText::end_line(const char* what) {
  in_line_ = true;
  if (const std::string_view left = peek(); !left.empty())
    fail("the line of " + std::string(what) + " goes on with " + in_quotes(left) +
         "; the file is damaged, so copy or export it again");
  in_line_ = false;
}

std::size_t MeshText::skip_rest_of_line() {
  in_line_ = true;
  std::size_t words = 0;
  while (!peek().empty()) {
    word("");
    ++words;
  }
  in_line_ = false;
  return words;
}

void MeshText::require_end(bool counted) {
  if (!at_end())
    fail("the file goes on with " + in_quotes(peek()) +
         " where it should end; a count before is wrong, so export the mesh again");
  std::string ends{'\n'};
  if (comment_) ends += comment_;
  if (counted) ends += " \t\r";
  if (text_.find_first_of(ends, word_end_) == std::string_view::npos)
    fail("the last line has no end; the file is cut off, so copy or export it again, or add a line break");
}

std::string_view MeshText::line() {
  const std::size_t end = std::min(text_.find('\n', at_), text_.size());
  std::string_view found = text_.substr(at_, end - at_);
  if (end < text_.size()) ++line_;
  at_ = std::min(end + 1, text_.size());
  if (found.ends_with('\r')) found.remove_suffix(1);
  return found;
}

void MeshText::skip_behind(std::string_view word) {
  const std::size_t found = text_.find(word, at_);
  if (found == std::string_view::npos)
    fail(std::string(word) + " is missing; the file is cut off, so copy or export it again");
  const auto begin = text_.begin() + static_cast<std::ptrdiff_t>(at_);
  at_ = found + word.size();
  line_ += std::count(begin, text_.begin() + static_cast<std::ptrdiff_t>(at_), '\n');
}

std::string_view MeshText::bytes(std::size_t size, const char* what) {
  last_ = at_;
  if (size > left()) fail_at_end(what);
  const std::string_view found = text_.substr(at_, size);
  at_ += size;
  return found;
}

void MeshText::require_line_break() {
  const std::string_view rest = text_.substr(at_);
  const std::size_t length = rest.starts_with("\r\n") ? 2 : 1;
  if (!rest.starts_with('\n') && length == 1)
    fail(
        "no line break is behind the values; bytes of them were lost or added, so copy or export the file again");
  at_ += length;
}

}  // namespace hmax
