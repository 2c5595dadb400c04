#include "limits/rows/model_digest.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <vector>

#include "catalogue/models/matrix_problem.hpp"
#include "core/text/digest.hpp"
#include "integrators/system.hpp"

namespace hmax {

namespace {

void add(Digest& digest, const Eigen::VectorXd& numbers) {
  for (double number : numbers) {
    // One NaN, whichever sign and payload it has.
    if (std::isnan(number)) number = std::nan("");
    digest.add({reinterpret_cast<const char*>(&number), sizeof number});
  }
}

/// A state up to `size` away, in another direction for each component, so that no part of a body moves
/// rigidly.
Eigen::VectorXd moved(const Eigen::VectorXd& y, double size) {
  Eigen::VectorXd state = y;
  for (Eigen::Index i = 0; i < y.size(); ++i)
    state[i] += size * (2 * std::fmod(0.618033988749895 * static_cast<double>(i + 1), 1.0) - 1);
  return state;
}

/// How far from y0 the rates are looked at: near one, and of formulas, which take any state, where states are
/// much larger or smaller near them.
std::vector<double> sizes_about(const Problem& problem) {
  std::vector<double> sizes{0.0, 1e-6, 1e-4, 1e-2, 1.0, -1.0, 10.0, -10.0};
  const auto* system = std::get_if<AnySystem>(&problem.system);
  if (!system || !system->formulas()) return sizes;
  const double scale = problem.y0.size() == 0 ? 0 : problem.y0.lpNorm<Eigen::Infinity>();
  if (scale > 10 || (scale > 0 && scale < 1e-6))
    for (const double share : {1e-2, 1.0, -1.0, 10.0, -10.0}) sizes.push_back(share * scale);
  return sizes;
}

}  // namespace

std::string model_digest(const Problem& problem) {
  Digest digest;
  add(digest, problem.y0);
  std::vector<double> times{0.0, 0.1, 0.25, 0.5, 1.0, 3.0, 10.0, problem.t_end};
  std::ranges::copy(times_of_matrices(problem), std::back_inserter(times));
  const std::vector<double> sizes = sizes_about(problem);
  std::visit(
      [&]<class Sys>(const Sys& system) {
        // What does not depend on time is computed once, and added at each.
        std::map<double, std::vector<typename Sys::State>> at_all_times;
        for (const double t : times)
          for (const double size : sizes) {
            std::vector<typename Sys::State>& known = at_all_times[size];
            if (known.empty() || !is_autonomous(system)) {
              const typename Sys::State y(moved(problem.y0, size));
              known.assign(1, y);
              system.rhs(t, y, known.front());
              if constexpr (SplitSystem<Sys>)
                if (hmax::has_split(problem)) {
                  known.push_back(y);
                  system.rhs_stiff(t, y, known.back());
                }
            }
            for (const auto& f : known) add(digest, f);
          }
      },
      problem.system);
  return digest.text();
}

}  // namespace hmax
