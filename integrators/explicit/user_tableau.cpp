/// Checks of a user's tableau. Each error names the row or entry at fault and the remedy.
#include "integrators/explicit/user_tableau.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <sstream>
#include <stdexcept>
#include <utility>

namespace hmax {
namespace {

/// Order conditions are checked up to this order: 1205 rooted trees have at most 10 nodes.
constexpr int highest_order = 10;

/// @param parts  numbers and words that follow one another in the message, without separators
/// @throws std::invalid_argument  always; the message begins with the name of the tableau
template <class... Parts>
[[noreturn]] void refuse(const TableauRows& rows, const Parts&... parts) {
  // 15 digits show the defect of coefficients that were cut short.
  std::ostringstream sentence;
  sentence.precision(15);
  sentence << "the tableau '" << rows.name << "': ";
  (sentence << ... << parts);
  throw std::invalid_argument(sentence.str());
}

/// Refuses NaN and infinity.
/// @param what  the coefficients as the user calls them: a, b, b_hat or c
void require_finite(const TableauRows& rows, const std::vector<long double>& values, const char* what) {
  // Also finite as doubles: 1e4000 is a long double.
  for (const long double value : values)
    if (!std::isfinite(static_cast<double>(value)))
      refuse(rows, what, " holds a coefficient that is not finite; correct it");
}

/// Refuses weights that are not one finite number for each stage. Nodes c are checked by it too.
void require_weights(const TableauRows& rows, const std::vector<long double>& weights, const char* what) {
  if (weights.size() != rows.b.size())
    refuse(rows, what, " has ", weights.size(), " entries but b has ", rows.b.size(),
           "; give one for each stage");
  require_finite(rows, weights, what);
}

/// Refuses weights that violate the condition of order 1, |sum_i b_i - 1| <= tableau_tolerance. Without it
/// the method does not converge: on y' = 1 the slope is wrong for every h.
void require_consistent(const TableauRows& rows, const std::vector<long double>& weights, const char* what) {
  require_weights(rows, weights, what);
  // Order 1: sum_i b_i = 1.
  const long double sum = std::accumulate(weights.begin(), weights.end(), 0.0L);
  if (!(std::fabs(sum - 1) <= tableau_tolerance))
    refuse(rows, "the weights ", what, " sum to ", sum,
           " and not to 1, so the method is not consistent; correct them, with fractions such as 1 / 3.0L "
           "where decimals were cut short");
}

/// a as one row-major matrix, strictly lower triangular, shape (s, s). Rows may be shorter than s: entries
/// that are not given are zero.
/// @throws std::invalid_argument  unless a has one row for each stage, of at most s entries, with zeros on
///                                and above the diagonal; rows and columns are counted from 1 in messages
std::vector<long double> matrix_of(const TableauRows& rows) {
  const std::size_t s = rows.b.size();
  if (rows.a.size() != s)
    refuse(rows, "a has ", rows.a.size(), " rows but b has ", s,
           " weights; each stage needs its row, the first one is {}");
  std::vector<long double> a(s * s, 0);
  for (std::size_t i = 0; i < s; ++i) {
    const std::vector<long double>& row = rows.a[i];
    require_finite(rows, row, "a");
    if (row.size() > s)
      refuse(rows, "row ", i + 1, " of a has ", row.size(), " entries but the method has ", s,
             " stages; take the rest out");
    // Zeros on and above the diagonal are accepted, as papers print them.
    for (std::size_t j = 0; j < row.size(); ++j) {
      if (j >= i && row[j] != 0)
        refuse(rows, "row ", i + 1, " of a has a nonzero entry in column ", j + 1,
               ", on or above the diagonal; only explicit methods are accepted");
      a[i * s + j] = row[j];
    }
  }
  return a;
}

/// Refuses nodes with |sum_j a_ij - c_i| > tableau_tolerance. The order conditions suppose that rows sum to
/// their nodes [hairer1993solving, II.1].
/// @param a  as matrix_of() made it, shape (s, s)
void require_nodes(const TableauRows& rows, const std::vector<long double>& a) {
  require_weights(rows, rows.c, "c");
  // The largest |sum_j a_ij - c_i|, with its row for the message.
  const auto [row, defect] = largest_row_defect(a, rows.c);
  if (defect <= tableau_tolerance) return;
  const long double sum = std::accumulate(rows.a[row].begin(), rows.a[row].end(), 0.0L);
  refuse(rows, "row ", row + 1, " of a sums to ", sum, " but entry ", row + 1, " of c is ", rows.c[row],
         "; correct one of them, or leave c out");
}

}  // namespace

/// Checks nothing: who calls answers for the coefficients. Taken by value, since a and b are kept.
RuntimeTableau completed_tableau(std::string name, std::vector<long double> a, std::vector<long double> b,
                                 const std::vector<long double>& b_hat) {
  RuntimeTableau tableau;
  tableau.name = std::move(name);
  tableau.a = std::move(a);
  tableau.b = std::move(b);
  const std::size_t s = tableau.b.size();
  // c as the sums themselves, also where it was given with fewer digits: then the stages meet their nodes
  // exactly.
  tableau.c.assign(s, 0);
  for (std::size_t i = 0; i < s; ++i)
    for (std::size_t j = 0; j < i; ++j) tableau.c[i] += tableau.a[i * s + j];
  // At most highest_order, also where the method has a higher one.
  tableau.computed_order = order_of(tableau.a, tableau.b, highest_order, tableau_tolerance);
  // Zeros without an embedded method: then the stepper has no error estimate.
  tableau.b_err.assign(s, 0);
  if (!b_hat.empty()) {
    for (std::size_t i = 0; i < s; ++i) tableau.b_err[i] = tableau.b[i] - b_hat[i];
    tableau.embedded_order = order_of(tableau.a, b_hat, highest_order, tableau_tolerance);
  }
  // First same as last: a_sj = b_j and b_s = 0, compared exactly. c_s = sum_j b_j = 1 follows. A method of
  // one stage has nothing to hand on.
  const auto last = tableau.a.end() - static_cast<std::ptrdiff_t>(s);
  // The stepper then saves one evaluation a step.
  tableau.fsal = s > 1 && tableau.b.back() == 0 && std::equal(tableau.b.begin(), tableau.b.end(), last);
  return tableau;
}

/// Weights first, then a, c and b_hat: b tells how many stages there are.
RuntimeTableau runtime_tableau(const TableauRows& rows) {
  if (rows.b.empty()) refuse(rows, "b is empty; a method has at least one stage");
  require_consistent(rows, rows.b, "b");
  // The shape of a before its sums, so that the first fault is the one that is named.
  std::vector<long double> a = matrix_of(rows);
  if (!rows.c.empty()) require_nodes(rows, a);
  if (!rows.b_hat.empty()) {
    require_consistent(rows, rows.b_hat, "b_hat");
    // The estimate would accept every step.
    if (rows.b_hat == rows.b)
      refuse(rows, "b_hat equals b, which makes every error estimate zero; leave b_hat out");
  }
  return completed_tableau(rows.name, std::move(a), rows.b, rows.b_hat);
}

/// One that runtime_tableau() has made passes; one that was filled in by hand may not.
void require_kept(const RuntimeTableau& tableau) {
  const std::size_t s = tableau.b.size();
  TableauRows rows{.name = tableau.name, .a = {}, .b = tableau.b, .b_hat = {}, .c = tableau.c};
  if (s == 0) refuse(rows, "b is empty; a method has at least one stage");
  if (tableau.a.size() != s * s)
    refuse(rows, "a has ", tableau.a.size(), " entries but b has ", s, "; give ", s * s, ", row by row");
  for (std::size_t i = 0; i < s; ++i) {
    const auto row = tableau.a.begin() + static_cast<std::ptrdiff_t>(i * s);
    rows.a.emplace_back(row, row + static_cast<std::ptrdiff_t>(s));
  }
  require_consistent(rows, rows.b, "b");
  const std::vector<long double> a = matrix_of(rows);
  require_nodes(rows, a);
  const auto require_order = [&](const std::vector<long double>& weights, int named, const char* what) {
    const int checked = std::min(named, highest_order),
              order = order_of(a, weights, checked, tableau_tolerance);
    if (checked < 1 || order < checked)
      refuse(rows, "its ", what, " is said to be ", named, " but is ", order,
             "; leave orders to runtime_tableau(), which computes them");
  };
  require_order(rows.b, tableau.computed_order, "order");
  if (!tableau.has_error()) return;
  require_weights(rows, tableau.b_err, "b_err");
  std::vector<long double> b_hat = rows.b;
  for (std::size_t i = 0; i < s; ++i) b_hat[i] -= tableau.b_err[i];
  require_order(b_hat, tableau.embedded_order, "embedded order");
}

}  // namespace hmax
