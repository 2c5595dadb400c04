// Measures what the stability analysis costs: one prediction, one region, one spectrum.
#include <string>

#include <benchmark/benchmark.h>

#include "analysis/amplification/region.hpp"
#include "analysis/spectrum/lanczos.hpp"
#include "analysis/spectrum/spectrum.hpp"
#include "catalogue/methods/catalogue.hpp"
#include "catalogue/methods/choice/formulas.hpp"
#include "catalogue/models/problems.hpp"
#include "limits/micro/inputs.hpp"
#include "limits/predict.hpp"

namespace hmax {
namespace {

/// Linearisation and prediction of one method on the oscillator; the goal is 50 us.
void predict_one(benchmark::State& state, const std::string& id) {
  const Problem problem = make_problem("liver_linear");
  const Method method = find_method(id);
  for (auto _ : state) {
    const Linearised near = linearised(problem);
    benchmark::DoNotOptimize(predict(method, near));
  }
}

/// The boundary of a region on a grid of 400 x 400; the goal is 50 ms.
void region_of(benchmark::State& state, const std::string& id) {
  const Formula formula = find_formula(id);
  const PlaneWindow window{-6, 1, -3.5, 3.5};
  const StableAt stable = stable_at(*formula.amplification);
  for (auto _ : state) benchmark::DoNotOptimize(region_boundary(stable, window, 400));
}

/// All eigenvalues of a dense matrix; the goal is 1.1 times what Eigen's solver takes alone.
void spectrum_dense(benchmark::State& state) {
  const Eigen::MatrixXd A = some_matrix(state.range(0));
  for (auto _ : state) benchmark::DoNotOptimize(all_eigenvalues(A));
}

/// The largest eigenvalue to a residual of 1e-6 with its vector; the goal is 0.7 of the time of Spectra with
/// the same products, the same start and the same tolerance.
void fastest_mode(benchmark::State& state) {
  const SymmetricProduct A = ball_product(state.range(0));
  const SymmetricOperator product = [&](const Eigen::VectorXd& x, Eigen::VectorXd& y) { A(x, y); };
  for (auto _ : state) benchmark::DoNotOptimize(largest_eigenpair(product, A.rows()).vector.data());
}

BENCHMARK_CAPTURE(predict_one, rk4, "rk4");
BENCHMARK_CAPTURE(predict_one, dormand_prince_54, "dormand_prince_54");
BENCHMARK_CAPTURE(predict_one, adams_bashforth_4, "adams_bashforth_4");
BENCHMARK_CAPTURE(predict_one, newmark, "newmark");
BENCHMARK_CAPTURE(region_of, rk4, "rk4")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(region_of, dop_853, "dop_853")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(region_of, rosenbrock_23, "rosenbrock_23")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(region_of, abm_pece_4, "abm_pece_4")->Unit(benchmark::kMillisecond);
BENCHMARK(fastest_mode)->Arg(4)->Arg(20)->Unit(benchmark::kMillisecond);
BENCHMARK(spectrum_dense)->Arg(40)->Arg(200)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace hmax

BENCHMARK_MAIN();
