/// Explicit Runge-Kutta methods of your own: coefficients checked when the method is made.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "integrators/explicit/runtime_tableau.hpp"
#include "integrators/explicit/tableau.hpp"

namespace hmax {

/// The coefficients of an explicit Runge-Kutta method as they stand in a paper.
struct TableauRows {
  std::string name;  ///< not one of `hmax list methods`
  /// A row for each stage; row i has at most i - 1 entries, or zeros from the diagonal on.
  std::vector<std::vector<long double>> a;
  std::vector<long double> b;           ///< shape (stages)
  std::vector<long double> b_hat = {};  ///< of the embedded method that makes the error estimate, or empty
  std::vector<long double> c = {};      ///< must agree with the sums of the rows of a; computed if empty
};

/// What sums of coefficients may differ from what they have to be: loose enough for coefficients given with
/// 16 digits, far below any real defect.
inline constexpr long double tableau_tolerance = 1e-12L;

/// Checks the coefficients and computes both orders, up to 10.
/// @throws std::invalid_argument  naming the row or entry at fault and the remedy, where the method is not
/// explicit, not consistent (the weights sum to 1, rows of a to c), or its rows have other lengths
RuntimeTableau runtime_tableau(const TableauRows& rows);

/// What follows from coefficients that are right: c, both orders, whether the last stage is the first of the
/// next step.
/// @param a      strictly lower triangular, shape (s, s), row-major
/// @param b_hat  shape (s), or empty
RuntimeTableau completed_tableau(std::string name, std::vector<long double> a, std::vector<long double> b,
                                 const std::vector<long double>& b_hat);

/// A tableau of the compiler, as those of tableaux.hpp, with `id` and `tableau`; its c must be given.
/// @throws std::invalid_argument  as above: your own struct is not proved by the compiler, as those of hmax
/// are
template <class Method>
RuntimeTableau runtime_tableau() {
  const auto& tableau = Method::tableau;
  TableauRows rows{.name = std::string(Method::id), .a = {}, .b = {}};
  for (const auto& row : tableau.a) rows.a.emplace_back(row.begin(), row.end());
  rows.b.assign(tableau.b.begin(), tableau.b.end());
  rows.c.assign(tableau.c.begin(), tableau.c.end());
  if (std::any_of(tableau.b_err.begin(), tableau.b_err.end(), [](long double e) { return e != 0; }))
    for (std::size_t i = 0; i < rows.b.size(); ++i) rows.b_hat.push_back(rows.b[i] - tableau.b_err[i]);
  return runtime_tableau(rows);
}

}  // namespace hmax
