#include "problems/matrices/multipliers.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <stdexcept>

#include "core/symmetry.hpp"
#include "problems/matrices/condensation.hpp"
#include "problems/matrix_entries.hpp"

namespace hmax {
namespace {

using Sparse = Eigen::SparseMatrix<double>;
using Triplets = std::vector<Eigen::Triplet<double>>;
using NameOf = std::function<std::string(Eigen::Index)>;

/// What of a sum is rounding, beside the largest of its terms.
constexpr double rounding = 1e-10;
/// A pivot is at least this share of the largest entry of its row.
constexpr double pivot_share = 0.1;
/// Products beyond which Z^T K Z takes gigabytes.
constexpr double most_products = 60e6;

/// A coefficient, and the largest of the terms that it is a sum of.
struct Coefficient {
  double value = 0, largest = 0;
};
using Row = std::map<Eigen::Index, Coefficient>;

/// row += factor * other, without what is left of entries that cancel.
void add(Row& row, double factor, const Row& other) {
  for (const auto& [j, coefficient] : other) {
    const double term = factor * coefficient.value;
    Coefficient& sum = row[j];
    sum.largest = std::max({sum.largest, std::abs(term), std::abs(sum.value)});
    sum.value += term;
    if (std::abs(sum.value) <= rounding * sum.largest) row.erase(j);
  }
}

/// Constraints as rows q_p + sum_k r_k q_k = 0, in which no other p occurs.
class Elimination {
 public:
  Elimination(Eigen::Index unknowns, const std::vector<char>& massless)
      : massless_(massless), followed_by_(static_cast<std::size_t>(unknowns)) {}

  /// Takes in one more constraint. False where it follows from those before.
  /// @throws std::invalid_argument  where the rows become too long
  bool take(const Row& constraint) {
    Row row = constraint;
    for (const auto& [j, coefficient] : constraint)
      if (const auto known = rows_.find(j); known != rows_.end()) {
        row.erase(j);
        add(row, -coefficient.value, known->second);
      }
    if (row.empty()) return false;
    const Eigen::Index p = pivot_of(row);
    const double scale = 1 / row[p].value;
    row.erase(p);
    for (auto& [k, coefficient] : row)
      coefficient = {coefficient.value * scale, std::abs(coefficient.value * scale)};
    // The new pivot leaves the rows before.
    const std::set<Eigen::Index> with_p = std::move(followed_by_[static_cast<std::size_t>(p)]);
    for (const Eigen::Index other : with_p) {
      Row& changed = rows_[other];
      const double factor = changed[p].value;
      changed.erase(p);
      for (const auto& [k, coefficient] : changed) followed_by_[static_cast<std::size_t>(k)].erase(other);
      add(changed, -factor, row);
      for (const auto& [k, coefficient] : changed) followed_by_[static_cast<std::size_t>(k)].insert(other);
      products_ += static_cast<double>(row.size());
    }
    for (const auto& [k, coefficient] : row) followed_by_[static_cast<std::size_t>(k)].insert(p);
    products_ += static_cast<double>(row.size()) * static_cast<double>(row.size());
    if (products_ > most_products)
      throw std::invalid_argument(
          "the Lagrange multipliers couple too many unknowns to be eliminated; use constraints of fewer unknowns each, or "
          "a penalty");
    rows_.emplace(p, std::move(row));
    return true;
  }

  [[nodiscard]] const std::map<Eigen::Index, Row>& rows() const { return rows_; }

 private:
  /// Of the entries that are large enough: one without mass, else one that few rows have.
  [[nodiscard]] Eigen::Index pivot_of(const Row& row) const {
    double largest = 0;
    for (const auto& [j, coefficient] : row) largest = std::max(largest, std::abs(coefficient.value));
    Eigen::Index best = -1;
    const auto rank = [&](Eigen::Index j) {
      const auto i = static_cast<std::size_t>(j);
      return std::pair(massless_[i] ? 0 : 1, followed_by_[i].size());
    };
    for (const auto& [j, coefficient] : row)
      if (std::abs(coefficient.value) >= pivot_share * largest && (best < 0 || rank(j) < rank(best)))
        best = j;
    return best;
  }

  const std::vector<char>& massless_;
  std::map<Eigen::Index, Row> rows_;                 ///< by their p
  std::vector<std::set<Eigen::Index>> followed_by_;  ///< of each unknown, the p of the rows that it occurs in
  double products_ = 0;
};

/// The rows of B in the order of their lengths, short ones first, with their multipliers.
std::vector<std::pair<Eigen::Index, Row>> constraints_of(const Sparse& K,
                                                         const std::vector<Eigen::Index>& multipliers) {
  std::map<Eigen::Index, Row> rows;
  for (const Eigen::Index i : multipliers) rows[i] = {};
  each_entry(K, [&](Eigen::Index i, Eigen::Index j, double value) {
    if (value == 0) return;
    if (const auto row = rows.find(i); row != rows.end()) row->second[j] = {value, std::abs(value)};
  });
  std::vector<std::pair<Eigen::Index, Row>> sorted(rows.begin(), rows.end());
  std::ranges::stable_sort(sorted, {}, [](const auto& row) { return row.second.size(); });
  return sorted;
}

/// @throws std::invalid_argument  unless the multipliers act on what they hold
void require_transposes(const Sparse& K, const std::vector<Eigen::Index>& multipliers,
                        const NameOf& name_of) {
  std::vector<Eigen::Index> all(static_cast<std::size_t>(K.rows()));
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<Eigen::Index>(i);
  const Sparse B = block_of(K, multipliers, all);
  const Sparse difference = B - Sparse(block_of(K, all, multipliers).transpose());
  Eigen::VectorXd largest = Eigen::VectorXd::Zero(B.rows());
  each_entry(B, [&](Eigen::Index i, Eigen::Index, double value) {
    largest(i) = std::max(largest(i), std::abs(value));
  });
  each_entry(difference, [&](Eigen::Index i, Eigen::Index, double value) {
    if (std::abs(value) > rounding * largest(i))
      throw std::invalid_argument(
          "the column of the Lagrange multiplier " + name_of(multipliers[static_cast<std::size_t>(i)]) +
          " is not the transpose of its row; export the stiffness again, or give it a mass");
  });
}

}  // namespace

std::vector<Eigen::Index> multiplier_rows(const Sparse& K, const std::vector<char>& massless) {
  const auto n = static_cast<std::size_t>(K.rows());
  const Eigen::VectorXd diagonal = K.diagonal();
  std::vector<char> candidate(n, 0), coupled(n, 0), filled(n, 0);
  for (std::size_t i = 0; i < n; ++i)
    candidate[i] = massless[i] && diagonal[static_cast<Eigen::Index>(i)] == 0 ? 1 : 0;
  each_entry(K, [&](Eigen::Index i, Eigen::Index j, double value) {
    if (i == j || value == 0) return;
    const auto a = static_cast<std::size_t>(i), b = static_cast<std::size_t>(j);
    filled[a] = 1;
    if (candidate[a] && candidate[b]) coupled[a] = coupled[b] = 1;
  });
  std::vector<Eigen::Index> rows;
  for (std::size_t i = 0; i < n; ++i)
    if (candidate[i] && filled[i] && !coupled[i]) rows.push_back(static_cast<Eigen::Index>(i));
  return rows;
}

ConstrainedMotions constrained_motions(const Sparse& K, const std::vector<Eigen::Index>& multipliers,
                                       const std::vector<char>& massless, const NameOf& name_of) {
  require_transposes(K, multipliers, name_of);
  ConstrainedMotions motions;
  Elimination elimination(K.rows(), massless);
  for (const auto& [multiplier, row] : constraints_of(K, multipliers))
    if (!elimination.take(row)) motions.redundant.push_back(multiplier);
  std::ranges::sort(motions.redundant);
  std::vector<Eigen::Index> place(static_cast<std::size_t>(K.rows()), 0);
  for (const Eigen::Index i : multipliers) place[static_cast<std::size_t>(i)] = -1;
  for (const auto& [p, row] : elimination.rows()) place[static_cast<std::size_t>(p)] = -1;
  for (std::size_t i = 0; i < place.size(); ++i) {
    if (place[i] < 0) continue;
    place[i] = static_cast<Eigen::Index>(motions.kept.size());
    motions.kept.push_back(static_cast<Eigen::Index>(i));
  }
  if (motions.kept.empty())
    throw std::invalid_argument(
        "the Lagrange multipliers hold every unknown, so nothing moves; remove some of them");
  Triplets entries;
  for (std::size_t p = 0; p < motions.kept.size(); ++p)
    entries.emplace_back(static_cast<int>(motions.kept[p]), static_cast<int>(p), 1.0);
  for (const auto& [p, row] : elimination.rows())
    for (const auto& [k, coefficient] : row)
      entries.emplace_back(static_cast<int>(p), static_cast<int>(place[static_cast<std::size_t>(k)]),
                           -coefficient.value);
  motions.Z.resize(K.rows(), static_cast<Eigen::Index>(motions.kept.size()));
  motions.Z.setFromTriplets(entries.begin(), entries.end());
  return motions;
}

Sparse projected(const Sparse& A, const Sparse& Z) {
  const Sparse AZ = A * Z;
  Sparse result = Sparse(Z.transpose()) * AZ;
  result.prune(0.0, 0.0);
  return is_symmetric(A) ? symmetrised(result) : result;
}

}  // namespace hmax
