#include <charconv>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <stdexcept>

#include "problems/matrices/matrix_readers.hpp"
#include "problems/mesh/files/mesh_text.hpp"

namespace hmax {

bool MatrixLines::next() {
  while (at_ < text_.size()) {
    const std::size_t end = std::min(text_.find('\n', at_), text_.size());
    line_ = text_.substr(at_, end - at_);
    at_ = std::min(end + 1, text_.size());
    ++number_;
    words_ = 0;
    for (std::size_t i = 0; i < line_.size();) {
      while (i < line_.size() && is_blank(line_[i])) ++i;
      const std::size_t begin = i;
      while (i < line_.size() && !is_blank(line_[i])) ++i;
      if (i == begin) continue;
      if (words_ < word_.size()) word_[words_] = line_.substr(begin, i - begin);
      ++words_;
    }
    if (words_ > 0 && (comment_ == 0 || word_[0].front() != comment_)) return true;
  }
  return false;
}

std::int64_t MatrixLines::integer(std::size_t i, const char* what, std::int64_t least,
                                  std::int64_t most) const {
  std::string_view digits = word_.at(i);
  if (digits.starts_with('+')) digits.remove_prefix(1);
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error == std::errc::result_out_of_range ||
      (error == std::errc{} && end == digits.data() + digits.size() && (value < least || value > most)))
    fail(std::string(what) + " is " + in_quotes(word_.at(i)) + " but must lie between " +
         std::to_string(least) + " and " + std::to_string(most) +
         "; indices count from 1, so correct it or export the matrix again");
  if (error != std::errc{} || end != digits.data() + digits.size())
    fail(std::string(what) + " should be a whole number and is " + in_quotes(word_.at(i)) +
         "; correct it or export the matrix again");
  return value;
}

double MatrixLines::number(std::size_t i, const char* what) const {
  const double value = number_in(word_.at(i));
  if (std::isfinite(value)) return value;
  fail(std::string(what) + " is " + in_quotes(word_.at(i)) +
       " but must be a finite number; correct it or export the matrix again");
}

void MatrixLines::fail(const std::string& text) const {
  throw std::invalid_argument(name_ + ", line " + std::to_string(number_) + ": " + text);
}
void MatrixLines::fail_at_end(const std::string& text) const {
  throw std::invalid_argument(name_ + ": " + text);
}

double number_in(std::string_view word) {
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  constexpr std::size_t longest = 80;
  if (word.starts_with('+')) word.remove_prefix(1);
  if (word.empty() || word.starts_with('+') || word.size() > longest) return none;
  double value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error == std::errc{} && end == word.data() + word.size()) return value;
  // Fortran: D, d, Q or q for the exponent, or none where it has three digits.
  std::string text;
  for (std::size_t i = 0; i < word.size(); ++i) {
    const char c = word[i];
    const bool of_digits = (c >= '0' && c <= '9') || c == '.';
    if (c == 'D' || c == 'd' || c == 'Q' || c == 'q')
      text += 'e';
    else if ((c == '+' || c == '-') && i > 0 &&
             ((word[i - 1] >= '0' && word[i - 1] <= '9') || word[i - 1] == '.'))
      text += std::string("e") + c;
    else if (of_digits || c == '+' || c == '-' || c == 'e' || c == 'E')
      text += c;
    else
      return none;
  }
  char* stop = nullptr;
  value = std::strtod(text.c_str(), &stop);
  return stop == text.c_str() + text.size() && stop != text.c_str() ? value : none;
}

}  // namespace hmax
