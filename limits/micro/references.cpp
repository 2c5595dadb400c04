// The other sides of micro_stability: Eigen's and Spectra's solvers. Their templates take twenty seconds to
// compile, so that the test command leaves them out.
#include <Eigen/Eigenvalues>
#include <benchmark/benchmark.h>

#include "analysis/spectrum/lanczos.hpp"
#include "limits/micro/inputs.hpp"

#if HMAX_HAVE_SPECTRA
#include <Spectra/SymEigsSolver.h>
#endif

namespace hmax {
namespace {

void spectrum_of_eigen(benchmark::State& state) {
  const Eigen::MatrixXd A = some_matrix(state.range(0));
  for (auto _ : state)
    benchmark::DoNotOptimize(Eigen::EigenSolver<Eigen::MatrixXd>(A, false).eigenvalues().eval());
}
BENCHMARK(spectrum_of_eigen)->Arg(40)->Arg(200)->Unit(benchmark::kMicrosecond);

#if HMAX_HAVE_SPECTRA
struct SpectraProduct {
  using Scalar = double;
  const SymmetricProduct& A;
  [[nodiscard]] Eigen::Index rows() const { return A.rows(); }
  [[nodiscard]] Eigen::Index cols() const { return A.rows(); }
  void perform_op(const double* x, double* y) const { A.apply(x, y); }
};
void fastest_mode_of_spectra(benchmark::State& state) {
  const SymmetricProduct A = ball_product(state.range(0));
  const Eigen::VectorXd start = start_vector(A.rows());
  SpectraProduct product{A};
  for (auto _ : state) {
    Spectra::SymEigsSolver<SpectraProduct> solver(product, 1, state.range(1));
    solver.init(start.data());
    solver.compute(Spectra::SortRule::LargestAlge, 2000, 1e-6);
    benchmark::DoNotOptimize(solver.eigenvectors().eval().data());
  }
}
BENCHMARK(fastest_mode_of_spectra)->ArgsProduct({{4, 20}, {8, 20}})->Unit(benchmark::kMillisecond);
#endif

}  // namespace
}  // namespace hmax
