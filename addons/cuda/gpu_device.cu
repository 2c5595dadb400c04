/// The device of a GPU by CUDA: memory, launches, graphs and events.
#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <cuda_runtime.h>

#include "addons/cuda/motion_kernels.cuh"
#include "catalogue/device/device.hpp"
#include "core/errors.hpp"

namespace hmax {
namespace {

constexpr int threads = 256;
constexpr std::size_t launches_of_a_graph = 64;  // or more, where steps that follow one another are more

void check(cudaError_t error, const char* what) {
  if (error == cudaSuccess) return;
  static_cast<void>(cudaGetLastError());  // it is told here, and not of what comes after it
  throw InputError(std::string("the GPU ") + what + ": " + cudaGetErrorString(error) +
                     "; see nvidia-smi, or leave out --device");
}

struct CudaBlock {
  template <class F>
  __device__ void each(std::int32_t count, const F& f) const {
    for (std::int32_t n = static_cast<std::int32_t>(threadIdx.x); n < count;
         n += static_cast<std::int32_t>(blockDim.x))
      f(n);
  }
  __device__ void barrier() const { __syncthreads(); }
};

template <TetLaw law, class Real>
__global__ void __launch_bounds__(threads) body_steps(const BodyStep<Real> step) {
  extern __shared__ double shared[];
  body_step<law>(CudaBlock{}, step, static_cast<std::int32_t>(blockIdx.x), reinterpret_cast<Real*>(shared));
}

template <class Real>
__global__ void __launch_bounds__(threads) first_kick_drifts(const BodyStep<Real> step) {
  const std::int32_t p = static_cast<std::int32_t>(blockIdx.x) * threads + static_cast<std::int32_t>(threadIdx.x);
  if (p < step.body.free) first_kick_drift(step, static_cast<std::int32_t>(blockIdx.y), p);
}

/// The program of a law.
template <class Real>
auto* body_steps_of(TetLaw law) {
  if (law == TetLaw::small_strain) return body_steps<TetLaw::small_strain, Real>;
  return law == TetLaw::neo_hookean ? body_steps<TetLaw::neo_hookean, Real> : body_steps<TetLaw::green, Real>;
}

/// Steps as a graph, with the bytes that a block shares.
template <class Real>
struct StepGraph {
  std::vector<BodyStep<Real>> of;
  std::size_t bytes = 0;
  cudaGraphExec_t graph = nullptr;

  StepGraph() = default;
  StepGraph(StepGraph&& other) noexcept { *this = std::move(other); }
  StepGraph& operator=(StepGraph&& other) noexcept {
    std::swap(of, other.of);
    std::swap(bytes, other.bytes);
    std::swap(graph, other.graph);
    return *this;
  }
  ~StepGraph() {
    if (graph) cudaGraphExecDestroy(graph);
  }
};
template <class Real>
using Graphs = std::array<StepGraph<Real>, 2>;

__global__ void count_evaluations(std::int64_t* evaluated, std::int64_t more) { *evaluated += more; }

/// Freed at its end; errors come with the next call.
struct FreeMemory {
  void operator()(void* memory) const { cudaFree(memory); }
};

class Gpu final : public Device {
 public:
  Gpu() {
    int cards = 0;
    if (cudaGetDeviceCount(&cards) != cudaSuccess || cards == 0)
      throw InputError("there is no GPU that CUDA can use; see nvidia-smi, or leave out --device");
    check(cudaGetDeviceProperties(&card_, 0), "is not known");
    check(cudaStreamCreate(&stream_), "cannot be used");
    check(cudaEventCreate(&begin_), "cannot be used");
    check(cudaEventCreate(&end_), "cannot be used");
  }
  ~Gpu() override {
    cudaEventDestroy(begin_);
    cudaEventDestroy(end_);
    cudaStreamDestroy(stream_);
  }

  [[nodiscard]] DeviceFacts facts() const override {
    int driver = 0, runtime = 0, khz = 0, memory_khz = 0, ratio = 0;
    check(cudaDriverGetVersion(&driver), "has no driver");
    check(cudaRuntimeGetVersion(&runtime), "has no run time");
    check(cudaDeviceGetAttribute(&khz, cudaDevAttrClockRate, 0), "does not tell its clock");
    check(cudaDeviceGetAttribute(&memory_khz, cudaDevAttrMemoryClockRate, 0), "does not tell its memory clock");
    check(cudaDeviceGetAttribute(&ratio, cudaDevAttrSingleToDoublePrecisionPerfRatio, 0), "does not tell its speed");
    // 128 single-precision units in a multiprocessor; 64 in those of 6.0, 7 and 8.0.
    const int kind = card_.major * 10 + card_.minor;
    const double units = kind == 60 || card_.major == 7 || kind == 80 ? 64 : 128;
    return {.name = card_.name,
            .clock_mhz = khz / 1e3,
            .driver = "CUDA " + version(driver) + ", run time " + version(runtime),
            .flops = card_.multiProcessorCount * units / ratio * khz * 1e3,
            .single_flops = card_.multiProcessorCount * units * khz * 1e3,
            .bytes = 2.0 * memory_khz * 1e3 * card_.memoryBusWidth / 8,
            .shared_memory = card_.sharedMemPerBlockOptin};
  }

  [[nodiscard]] void* allocate(std::size_t bytes) override {
    void* memory = nullptr;
    check(cudaMalloc(&memory, bytes), "has too little memory");
    memory_.emplace_back(memory);
    return memory;
  }
  void release(void* memory) override {
    std::erase_if(memory_, [&](const auto& each) { return each.get() == memory; });
  }
  void write(void* to, const void* from, std::size_t bytes) override { move(to, from, bytes, cudaMemcpyHostToDevice); }
  void read(void* to, const void* from, std::size_t bytes) override { move(to, from, bytes, cudaMemcpyDeviceToHost); }
  void copy(void* to, const void* from, std::size_t bytes) override { move(to, from, bytes, cudaMemcpyDeviceToDevice); }

  void run(std::span<const BodyStep<double>> steps, std::size_t shared, std::int64_t times,
           std::int64_t* evaluated) override {
    run_all(steps, graphs_, shared, times, evaluated);
  }
  void run(std::span<const BodyStep<float>> steps, std::size_t shared, std::int64_t times,
           std::int64_t* evaluated) override {
    run_all(steps, single_graphs_, shared, times, evaluated);
  }
  void begin(const BodyStep<double>& step) override { begin_all(step); }
  void begin(const BodyStep<float>& step) override { begin_all(step); }

  void run(const AdaptiveMotions& motions) override {
    timed([&] { hmax::launch(motions.steady ? adaptive_motions<true> : adaptive_motions<false>, motions, stream_); });
  }
  void run(const SharedMotions& motions) override { run_fixed(motions); }
  void run(const OwnMotions& motions) override { run_fixed(motions); }

  [[nodiscard]] double seconds() override { return std::exchange(milliseconds_, 0.0) / 1e3; }

 private:
  template <class Motions>
  void run_fixed(const Motions& motions) {
    with_explicit_method(motions.method, [&]<class Method>(const Method&) {
      timed([&] { hmax::launch(fixed_motions<Method, Motions>, motions, stream_); });
    });
  }

  static std::string version(int number) {
    return std::to_string(number / 1000) + "." + std::to_string(number % 1000 / 10);
  }

  void move(void* to, const void* from, std::size_t bytes, cudaMemcpyKind kind) {
    check(cudaMemcpyAsync(to, from, bytes, kind, stream_), "does not copy");
    check(cudaStreamSynchronize(stream_), "does not copy");
  }

  template <class Real>
  void run_all(std::span<const BodyStep<Real>> steps, Graphs<Real>& graphs, std::size_t shared, std::int64_t times,
               std::int64_t* evaluated) {
    const std::size_t bytes = shared * sizeof(Real);
    check(cudaFuncSetAttribute(body_steps_of<Real>(steps.front().body.law), cudaFuncAttributeMaxDynamicSharedMemorySize,
                               static_cast<int>(bytes)),
          "has too little shared memory");
    const auto of_graph = static_cast<std::int64_t>(std::max<std::size_t>(1, launches_of_a_graph / steps.size()));
    const cudaGraphExec_t graph = times >= of_graph ? graph_of(steps, graphs, bytes, of_graph, evaluated) : nullptr;
    timed([&] {
      for (; times >= of_graph; times -= of_graph) check(cudaGraphLaunch(graph, stream_), "does not step");
      launch(steps, bytes, times, evaluated);
    });
  }

  template <class Real>
  void begin_all(const BodyStep<Real>& step) {
    const dim3 blocks(static_cast<unsigned>((step.body.free + threads - 1) / threads), 3);
    timed([&] { first_kick_drifts<<<blocks, threads, 0, stream_>>>(step); });
  }

  template <class Real>
  void launch(std::span<const BodyStep<Real>> steps, std::size_t bytes, std::int64_t times, std::int64_t* evaluated) {
    std::int32_t before = 0;
    for (std::int64_t n = 0; n < times; ++n, before += static_cast<std::int32_t>(steps.size()))
      for (BodyStep<Real> step : steps) {
        step.evaluation += before;
        body_steps_of<Real>(step.body.law)<<<static_cast<unsigned>(step.body.patches), threads, bytes, stream_>>>(step);
      }
    if (before > 0) count_evaluations<<<1, 1, 0, stream_>>>(evaluated, before);
  }

  /// The graph of these steps, one of the two that are kept where it is there: displacements end in either of two
  /// places, and the next steps begin there.
  template <class Real>
  cudaGraphExec_t graph_of(std::span<const BodyStep<Real>> steps, Graphs<Real>& graphs, std::size_t bytes,
                           std::int64_t times, std::int64_t* evaluated) {
    const auto is_it = [&](const StepGraph<Real>& each) {
      return each.graph && each.bytes == bytes && std::equal(steps.begin(), steps.end(), each.of.begin(), each.of.end());
    };
    if (is_it(graphs[0])) return graphs[0].graph;
    std::swap(graphs[0], graphs[1]);
    if (is_it(graphs[0])) return graphs[0].graph;
    StepGraph<Real>& kept = graphs[0];
    if (kept.graph) cudaGraphExecDestroy(std::exchange(kept.graph, nullptr));
    cudaGraph_t graph = nullptr;
    check(cudaStreamBeginCapture(stream_, cudaStreamCaptureModeThreadLocal), "makes no graph");
    launch(steps, bytes, times, evaluated);
    check(cudaStreamEndCapture(stream_, &graph), "makes no graph");
    const cudaError_t made = cudaGraphInstantiate(&kept.graph, graph, 0);
    cudaGraphDestroy(graph);
    check(made, "makes no graph");
    kept.of.assign(steps.begin(), steps.end());
    kept.bytes = bytes;
    return kept.graph;
  }

  template <class Work>
  void timed(const Work& work) {
    check(cudaEventRecord(begin_, stream_), "does not step");
    work();
    check(cudaGetLastError(), "does not step");
    check(cudaEventRecord(end_, stream_), "does not step");
    check(cudaEventSynchronize(end_), "does not step");
    float milliseconds = 0;
    check(cudaEventElapsedTime(&milliseconds, begin_, end_), "tells no times");
    milliseconds_ += milliseconds;
  }

  cudaDeviceProp card_{};
  cudaStream_t stream_ = nullptr;
  cudaEvent_t begin_ = nullptr, end_ = nullptr;
  Graphs<double> graphs_;
  Graphs<float> single_graphs_;
  std::vector<std::unique_ptr<void, FreeMemory>> memory_;
  double milliseconds_ = 0;
};

}  // namespace
}  // namespace hmax

// NOLINTNEXTLINE(readability-identifier-naming): found by its name
extern "C" __attribute__((visibility("default"))) std::unique_ptr<hmax::Device> hmax_make_device() {
  return std::make_unique<hmax::Gpu>();
}
