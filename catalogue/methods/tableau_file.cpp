#include "catalogue/methods/tableau_file.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numeric>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/text/split.hpp"
#include "integrators/explicit/user_tableau.hpp"

namespace hmax {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t most_tableau_stages = 40;

/// A decimal such as -0.25, +3, 1e-3 or 1.0D+3.
long double decimal(const TomlDocument& document, std::string_view place, std::string_view written) {
  std::string text(trimmed(written));
  std::replace(text.begin(), text.end(), 'D', 'e');
  std::replace(text.begin(), text.end(), 'd', 'e');
  const bool plus = text.size() > 1 && text[0] == '+' && text[1] != '-';
  long double value = 0;
  const char* const end = text.data() + text.size();
  const auto [stop, problem] = std::from_chars(text.data() + (plus ? 1 : 0), end, value);
  if (problem == std::errc::result_out_of_range)
    document.fail(place, "'{}' is outside the range of numbers", trimmed(written));
  if (problem != std::errc() || stop != end)
    document.fail(place, "'{}' is not a number; write {}", trimmed(written),
                  text.find(',') != std::string::npos
                      ? "the decimal point as '.', 1.5 and not 1,5"
                      : "a decimal such as 0.5 or a fraction such as \"3/40\"");
  return value;
}

/// One coefficient: a number, or in quotes a decimal or a fraction.
long double coefficient(const TomlDocument& document, const std::string& place, const Json& entry) {
  long double value = 0;
  if (entry.is_number_integer()) {
    value = static_cast<long double>(entry.get<long long>());
  } else if (entry.is_number()) {
    value = static_cast<long double>(entry.get<double>());
  } else if (entry.is_string()) {
    const std::string_view text = entry.get_ref<const std::string&>();
    if (text.size() > 200) document.fail(place, "a coefficient of more than 200 characters; shorten it");
    const std::size_t slash = text.find('/');
    value = decimal(document, place, text.substr(0, slash));
    if (slash != std::string_view::npos) {
      const long double divisor = decimal(document, place, text.substr(slash + 1));
      if (divisor == 0) document.fail(place, "the fraction '{}' divides by zero", text);
      value /= divisor;
    }
  } else {
    document.fail(place, "a coefficient must be a number or a fraction in quotes such as \"3/40\"");
  }
  // Also finite as a double: "1e4000" is a long double.
  if (!std::isfinite(static_cast<double>(value)))
    document.fail(place, "a coefficient is not finite; only finite numbers make a tableau");
  return value;
}

std::vector<long double> coefficients(const TomlDocument& document, const std::string& place,
                                      const Json& list) {
  if (!list.is_array()) document.fail(place, "'{}' must be a list of numbers", place.substr(1));
  std::vector<long double> values;
  for (std::size_t i = 0; i < list.size(); ++i)
    values.push_back(coefficient(document, fmt::format("{}/{}", place, i), list[i]));
  return values;
}

const Json& required(const TomlDocument& document, const char* key, const char* shape) {
  const auto found = document.root.find(key);
  if (found == document.root.end())
    document.fail("", "'{}' is missing; a tableau needs {} = {}", key, key, shape);
  return *found;
}

std::string name_of(const TomlDocument& document) {
  auto fits = [](std::string_view name) {
    return !name.empty() && name.size() <= 64 && std::all_of(name.begin(), name.end(), [](char c) {
      return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
             c == '-' || c == '.';
    });
  };
  if (const auto given = document.root.find("name"); given != document.root.end()) {
    if (!given->is_string() || !fits(given->get_ref<const std::string&>()))
      document.fail("/name", "the name must be 1 to 64 letters, digits, '_', '-' or '.', in quotes");
    return given->get<std::string>();
  }
  const std::string stem = std::filesystem::path(document.name).stem().string();
  return fits(stem) ? stem : "tableau";
}

/// The rows of a as one row-major s x s matrix, strictly lower triangular.
std::vector<long double> matrix(const TomlDocument& document, const Json& rows, std::size_t s) {
  if (!rows.is_array()) document.fail("/a", "'a' must be a list of rows, such as [[], [0.5], [-1, 2]]");
  if (rows.size() != s)
    document.fail("/a", "a has {} rows but b has {} weights; each stage needs its row, the first one is []",
                  rows.size(), s);
  std::vector<long double> a(s * s, 0);
  for (std::size_t i = 0; i < s; ++i) {
    const std::string place = fmt::format("/a/{}", i);
    if (!rows[i].is_array())
      document.fail(place, "row {} of a is not a list; write it in brackets, the first one as []", i + 1);
    if (rows[i].size() > s)
      document.fail(place, "row {} of a has {} entries but the method has {} stages", i + 1, rows[i].size(),
                    s);
    const auto row = coefficients(document, place, rows[i]);
    for (std::size_t j = 0; j < row.size(); ++j) {
      if (j >= i && row[j] != 0)
        document.fail(fmt::format("{}/{}", place, j),
                      "row {} of a has a nonzero entry in column {}, on or above the diagonal; only "
                      "explicit tableaux are accepted",
                      i + 1, j + 1);
      a[i * s + j] = row[j];
    }
  }
  return a;
}

std::vector<long double> weights(const TomlDocument& document, const char* key, const Json& list,
                                 std::size_t s) {
  const std::string place = std::string("/") + key;
  auto values = coefficients(document, place, list);
  if (values.size() != s) document.fail(place, "{} has {} entries but b has {}", key, values.size(), s);
  return values;
}

void check_sum(const TomlDocument& document, const char* key, const std::vector<long double>& b) {
  const long double sum = std::accumulate(b.begin(), b.end(), 0.0L);
  if (!(std::fabs(sum - 1) <= tableau_tolerance))
    document.fail(std::string("/") + key,
                  "the weights {} sum to {:.15g} and not to 1, so the method is not consistent; correct "
                  "them, with fractions such as \"1/3\" where decimals were cut short",
                  key, sum);
}

}  // namespace

RuntimeTableau tableau_from(const TomlDocument& document) {
  constexpr std::array<std::string_view, 5> keys{"name", "a", "b", "b_hat", "c"};
  reject_unknown_keys(document, "", keys);
  const Json& b = required(document, "b", "[...]");
  const Json& rows = required(document, "a", "[[], ...]");
  if (b.is_array() && b.empty()) document.fail("/b", "b is empty; a method has at least one stage");
  if (std::max(b.size(), rows.size()) > most_tableau_stages)
    document.fail("/b", "more than {} stages; such a method is refused", most_tableau_stages);

  std::string name = name_of(document);
  std::vector<long double> weights_b = coefficients(document, "/b", b);
  const std::size_t s = weights_b.size();
  check_sum(document, "b", weights_b);
  std::vector<long double> a = matrix(document, rows, s);

  if (const auto given = document.root.find("c"); given != document.root.end()) {
    const std::vector<long double> c = weights(document, "c", *given, s);
    const auto [row, defect] = largest_row_defect(a, c);
    if (!(defect <= tableau_tolerance)) {
      const auto first = a.begin() + static_cast<std::ptrdiff_t>(row * s);
      const long double sum = std::accumulate(first, first + static_cast<std::ptrdiff_t>(s), 0.0L);
      document.fail(fmt::format("/a/{}", row),
                    "row {0} of a sums to {1:.15g} but entry {0} of c is {2:.15g}; correct one of them, or "
                    "leave c out",
                    row + 1, sum, c[row]);
    }
  }
  std::vector<long double> b_hat;
  if (const auto given = document.root.find("b_hat"); given != document.root.end()) {
    b_hat = weights(document, "b_hat", *given, s);
    check_sum(document, "b_hat", b_hat);
    if (b_hat == weights_b)
      document.fail("/b_hat", "b_hat equals b, which makes every error estimate zero; leave b_hat out");
  }
  return completed_tableau(std::move(name), std::move(a), std::move(weights_b), b_hat);
}

RuntimeTableau read_tableau(const std::filesystem::path& path) { return tableau_from(read_toml(path)); }

}  // namespace hmax
